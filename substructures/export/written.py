"""Formulas to be read, a file for every quantity: text, a LaTeX document, a page of MathML; what they were made from
stands in comments at their beginning."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace

from substructures.export.exported import Exported
from substructures.export.languages.code import head
from substructures.export.software import SOFTWARE
from substructures.printers.render import FORMS, write

Commented = Callable[[str], str]
Files = dict[str, bytes]


def written(format_: str, suffix: str, exported: Exported, limit: int, commented: Commented) -> Files:
    """``NAME_quantity.suffix`` for every function, in one of the formats of :mod:`substructures.printers`.

    ``commented``: a line as a comment. Raises TooLarge for more than ``limit`` nodes.
    """
    found = {}
    for function in exported.functions:
        called = exported.called(function)
        alone = replace(exported, functions=(replace(function, glossary=None),))
        about = "\n".join(map(commented, head(alone, 1, SOFTWARE)))
        first, line, rest = write(function.program, format_, FORMS[0], called, limit).partition("\n")
        declared = first + line if first.startswith("<?xml") else ""
        text = f"{declared}{about}\n{rest if declared else first + line + rest}"
        found[f"{called}.{suffix}"] = text.encode()
    return found


def text(exported: Exported, limit: int) -> Files:
    """Plain text."""
    return written("text", "txt", exported, limit, lambda line: f"# {line}".rstrip())


def latex(exported: Exported, limit: int) -> Files:
    """Documents that plain LaTeX compiles."""
    return written("latex-document", "tex", exported, limit, lambda line: f"% {line}".rstrip())


def mathml(exported: Exported, limit: int) -> Files:
    """Pages of XHTML."""
    return written("mathml", "xhtml", exported, limit, lambda line: f"<!-- {line.replace('--', '- -')} -->")
