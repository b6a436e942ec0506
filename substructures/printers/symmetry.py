"""The rules by which the independent elements of an output determine the others."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence

from substructures.expr.program import Output

_RULES = {
    "symmetric": "{x}[a, b] = {x}[b, a]",
    "christoffel": "{x}[a, b, c] = {x}[a, c, b], and {x}[c, b, a] = -{x}[a, b, c] for b <= a",
    "connection": "{x}[a, b, c] = {x}[a, c, b]",
}


def symmetry_rule(symmetry: str, name: str = "x") -> str:
    """The rule in words, e.g. ``x[a, b] = x[b, a]; all other elements are 0``."""
    rule = _RULES.get(symmetry)
    return (rule.format(x=name) + "; " if rule else "") + "all other elements are 0"


def elements_rule(array: Output, name: str = "x") -> str:
    """What is said of the elements that are not written; of an array without any that there are none."""
    return symmetry_rule(array.symmetry, name) if array.index else "all elements are 0"


def assignments(
    array: Output, texts: Sequence[str], element: Callable[[tuple[int, ...]], str]
) -> Iterator[tuple[str, str]]:
    """(element, formula) of every non-zero element; the formula of a dependent one copies the first one written."""
    formulas = dict(reversed(list(zip(array.entries, texts, strict=True))))
    written: dict[int, str] = {}
    for index, entry, sign in array.expanded():
        name = element(index)
        yield name, ("-" if sign < 0 else "") + written.get(entry, formulas[entry])
        written.setdefault(entry, name)
