"""What a read expression consists of: steps in postfix order, tables, the words that the grammar knows; and the order
in which names are evaluated whose expressions name each other.
"""

from __future__ import annotations

import re
from collections.abc import Callable, Iterable
from dataclasses import dataclass
from decimal import Decimal
from fractions import Fraction
from typing import Literal

MAX_DIGITS = 400  # of a number, its exponent included
FUNCTIONS = ("sin", "cos", "tan", "sqrt")
RESERVED = frozenset((*FUNCTIONS, "pi", "t"))
#: words after the knots of a table
CURVES = ("monotone", "smooth")
#: measures of two frames
MEASURES = ("distance", "angle")
_MEASURE = re.compile(r"((?:distance|angle)'?)\(([A-Za-z0-9_.]+), ([A-Za-z0-9_.]+)\)", re.ASCII)
#: further functions and how many arguments they have; only names before a parenthesis, so that names stay free
LAWS = {
    **dict.fromkeys(("abs", "sign", "exp", "log", "tanh", "asin", "acos", "atan"), 1),
    **dict.fromkeys(("min", "max", "atan2"), 2),
    "step": 3,
}
#: operations without operands
LEAVES = frozenset(("number", "name", "pi"))


class ExpressionError(ValueError):
    """An expression that cannot be read; ``column`` counts from 1, ``name`` is the unknown name, if any."""

    def __init__(self, message: str, column: int, name: str | None = None) -> None:
        self.column, self.name = column, name
        super().__init__(f"{message} (column {column})")


@dataclass(frozen=True, slots=True)
class Knots:
    """A table: places x, which rise, and values y. Outside it has the first or the last value; in between it is linear,
    or ``monotone``: cubics that rise and fall where the values do (F. N. Fritsch and J. Butland, 1984), or ``smooth``:
    the cubic spline, whose second derivative is continuous, with slope 0 at both ends.
    """

    x: tuple[Fraction, ...]
    y: tuple[Fraction, ...]
    kind: Literal["linear", "monotone", "smooth"]


@dataclass(frozen=True, slots=True)
class Step:
    """One step of an expression in postfix order; operands are the results of the steps before it.

    ``op`` with its number of operands, and what ``value`` is: ``number`` 0 (the exact value), ``name`` 0 (the name),
    ``pi`` 0, ``neg`` 1, ``add sub mul div`` 2, ``pow`` 1 (the integer exponent), ``power`` 2 (any other exponent),
    ``call`` 1 or as :data:`LAWS` say (the function's name), ``table`` 1 (the table). ``column``: where it stands in the
    text, from 1.
    """

    op: str
    value: Fraction | str | int | Knots | None
    column: int

    @property
    def exponent(self) -> int:
        """Of an integer power, else 0."""
        return self.value if isinstance(self.value, int) else 0

    @property
    def operands(self) -> int:
        """How many results before it are taken."""
        if self.op == "call":
            return LAWS.get(str(self.value), 1)
        return 0 if self.op in LEAVES else 2 if self.op in ("add", "sub", "mul", "div", "power") else 1


def decimal_number(text: str) -> Fraction:
    """The exact value of a decimal literal of at most 400 digits (exponent included). Raises ValueError."""
    value = Decimal(text)
    exponent = value.as_tuple().exponent
    if not isinstance(exponent, int) or len(value.as_tuple().digits) + abs(exponent) > MAX_DIGITS:
        raise ValueError(f"number has more than {MAX_DIGITS} digits")
    return Fraction(value)


def measured(name: str) -> tuple[str, str, str] | None:
    """The measure with its mark, and the frames, of the name of a measure; None of any other name.

    >>> measured("angle'(a.base, b.base)"), measured("a.q1'")
    (("angle'", 'a.base', 'b.base'), None)
    """
    found = _MEASURE.fullmatch(name)
    return (found[1], found[2], found[3]) if found else None


def needed_first(name: str, named: Callable[[str], Iterable[str]]) -> list[str]:
    """All that a name needs, itself last, each once and after what it names unless that leads in a circle; however many
    there are, nothing is nested. ``named``: what the expression of a name names.

    >>> needed_first("a", {"a": "bc", "b": "c", "c": ""}.__getitem__)
    ['c', 'b', 'a']
    """
    order, open_, seen = list[str](), [(name, iter(named(name)))], {name}
    while open_:
        last, names = open_[-1]
        following = next((x for x in names if x not in seen), None)
        if following is None:
            order.append(last)
            open_.pop()
        else:
            seen.add(following)
            open_.append((following, iter(named(following))))
    return order
