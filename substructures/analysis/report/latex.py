"""The report as a document that plain LaTeX compiles: texlive-latex-base, no further packages."""

from __future__ import annotations

import re
from collections.abc import Sequence

from substructures.analysis.report.report import (
    CONCLUSIONS,
    QUANTITIES,
    SECTIONS,
    Coordinate,
    Printed,
    Report,
    SymbolRow,
    percent,
    some_terms,
    told_sizes,
)
from substructures.analysis.report.statements import MARK, Statement
from substructures.analysis.report.words import DERIVATION, REFERENCE
from substructures.printers.latex_document import LatexDocument
from substructures.printers.names import latex_names, latex_of
from substructures.printers.pages import BREAK, LINE, sized, width
from substructures.printers.render import LIMIT

HEAD = r"""\documentclass[a4paper]{article}
\usepackage{amsmath,longtable,color}
\usepackage[margin=25mm]{geometry}
\allowdisplaybreaks
\setlength{\parindent}{0pt}
\setlength{\parskip}{2pt plus 1pt}
\setlength{\emergencystretch}{6em}
\sloppy
\begin{document}"""
#: points that a symbol in a table may be wide
WIDEST = 60
END = r"\end{document}"
#: what stands for itself: printable ASCII, and letters of Latin-1 that the fonts of plain LaTeX have
_PLAIN = frozenset(map(chr, range(32, 127))) | frozenset(map(chr, range(0xC0, 0x100))) - frozenset(
    "\xd0\xd7\xde\xf0\xf7\xfe"
)
_SPECIAL = {c: "\\" + c for c in "{}$&#%_"} | {
    "^": r"\^{}",
    "~": r"\~{}",
    "\\": r"\textbackslash{}",
    "<": "$<$",
    ">": "$>$",
}


def latex_report(found: Report, picture: str = "", document: bool = True, limit: int = LIMIT) -> str:
    """Title, picture (of :func:`substructures.pictures.latex.latex_picture`), coordinates, symbols, derivation,
    formulas, statements, sizes of terms, sources; ``document``: False leaves head and end away. Raises TooLarge.
    """
    heading = found.heading
    lines = [HEAD] if document else []
    lines += [rf"\section*{{{words(heading.title or heading.name)}}}"]
    lines += [_text(x) for x in (heading.description, *heading.notes) if x]
    lines += [r"\begin{center}", picture, r"\end{center}"] if picture else []
    lines += [_title("Coordinates"), *_coordinates(found.coordinates)]
    lines += [_title("Symbols"), *_symbols(found.symbols)]
    lines += [_title("Derivation")]
    for said, equation, _ in DERIVATION:
        lines += [_named(said), rf"\begin{{equation*}}{equation}\end{{equation*}}"]
    printed = {name: found.printed(name, LatexDocument, limit) for name in QUANTITIES if name in found.shown}
    for name, each in printed.items():
        lines += _quantity(found, name, each)
    for about in CONCLUSIONS:
        lines += _statements(found, about)
    lines += _sizes(found, printed["metric"])
    lines += [_title("Sources")]
    lines += [_text(f"{s.instance}: {s.title or s.name}. {s.source} {s.license}") for s in found.sources]
    lines += [f"{words(REFERENCE)}."]
    return "\n".join([*lines, *([END] if document else [])]) + "\n"


def _title(text: str) -> str:
    return rf"\subsection*{{{text}}}"


def words(text: str) -> str:
    """Text of any length and characters in paragraphs; what plain LaTeX has no letter for is <U+....>."""
    return "".join(_SPECIAL.get(c) or (c if c in _PLAIN else f"$<$U+{ord(c):04X}$>$") for c in " ".join(text.split()))


def _text(text: str) -> str:
    return words(text) + "\n"


def _kept(text: str) -> str:
    """Words with the spaces around them."""
    return f"{' ' * text.startswith(' ')}{words(text)}{' ' * text.endswith(' ')}"


def _named(text: str) -> str:
    """Words with names of quantities between marks."""
    return "".join(f"${latex_of(x)}$" if n % 2 else _kept(x) for n, x in enumerate(text.split(MARK)))


def _coordinates(rows: Sequence[Coordinate]) -> list[str]:
    named = latex_names(each.called for each in rows)
    lines = [r"\begin{longtable}[l]{@{}lp{40mm}lll@{}}", r"symbol & name & joint & unit & limits \\ \hline"]
    for written, each in zip(named, rows, strict=True):
        ends = [f"{x:.4g}" if x is not None else r"\ldots" for x in (each.low, each.high)]
        limits = "" if each.low is each.high is None else f"{ends[0]} to {ends[1]}"
        lines.append(rf"{_symbol(written, 5)} & {_cell(each.name)} & {each.joint} & {each.unit} & {limits} \\")
    return [*lines, r"\end{longtable}"]


def _symbols(rows: Sequence[SymbolRow]) -> list[str]:
    named = latex_names(each.called for each in rows)
    lines = [r"\begin{longtable}[l]{@{}lp{28mm}lp{15mm}rp{38mm}@{}}"]
    lines.append(r"symbol & name & kind & unit & value & meaning \\ \hline")
    for written, each in zip(named, rows, strict=True):
        value = "" if each.value is None else f"{each.value:.6g}"
        cells = (
            _symbol(written, 6),
            _cell(each.name),
            each.kind,
            _unit(each.unit),
            value,
            words(each.description[:90]),
        )
        lines.append(" & ".join(cells) + r" \\")
    return [*lines, r"\end{longtable}"]


def _symbol(written: str, columns: int) -> str:
    """What is written for a symbol, in a row of its own if it is too wide for its column of the table."""
    if width(written) < WIDEST:
        return f"${written}$"
    return rf"\multicolumn{{{columns}}}{{@{{}}l}}{{${written}$}} \\*" + "\n" if width(written) < LINE else r"\ldots"


def _cell(text: str) -> str:
    r"""A name in a table, which may end a line behind a sign."""
    return re.sub(r"(\.|/|\\_)", r"\1\\allowbreak ", words(text[:60]))


def _unit(text: str) -> str:
    """A unit in a table: kg m^2 with a raised 2, for kg*m^2."""
    raised = re.sub(r"\\\^\{\}(-?[0-9]+)", r"$^{\1}$", words(text[:60]))
    return raised.replace("*", " ").replace("/", r"/\allowbreak ")


def _quantity(found: Report, name: str, each: Printed) -> list[str]:
    """The formulas of a quantity, and what is said of them."""
    language = each.language
    if not isinstance(language, LatexDocument):
        raise TypeError("a LaTeX document is expected")
    lines = language.formulas(each.listing)
    return [*(f"{words(x)}.\n" for x in each.said), *lines, *_statements(found, name)]


def _told(each: Statement) -> str:
    """A statement and what tells more, whose path may end a line behind a slash."""
    more = rf" More: {words(each.request)}".replace("/", r"/\allowbreak ") if each.request else ""
    return _named(each.marked) + more


def _statements(found: Report, about: str) -> list[str]:
    said = [_told(each) for each in found.statements if each.about == about]
    if not said:
        return []
    return [_title(SECTIONS[about]), r"\begin{itemize}", *(rf"\item {text}" for text in said), r"\end{itemize}"]


def _sizes(found: Report, metric: Printed) -> list[str]:
    sizes, reason = found.sizes(metric)
    lines = [_title("Sizes of the terms of the mass matrix")]
    if not sizes or metric.terms is None:
        return [*lines, words(f"Not told: {reason or 'all elements are one term'}.")]
    lines.append(_named(told_sizes(found)))
    for each in sizes:
        shown, rest = some_terms(each)
        lines.append(rf"\paragraph{{$g_{{{','.join(str(i + 1) for i in each.index)}}}$}}")
        for t in shown:
            small = " (small)" if t.is_small else ""
            lines.append(
                rf"\par\hangindent=2em {words(percent(t.share))}{small}: ${_inline(metric.terms.text(t.term))}$"
            )
        lines += [rf"\par {words(rest)}."] if rest else []
    return lines


def _inline(text: str) -> str:
    """A formula in a paragraph: lines may end before the signs of sums and between factors."""
    plain = sized(text.replace(BREAK, " "))
    return plain.replace(r" \, ", r" \, \allowbreak ")
