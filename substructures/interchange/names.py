"""Names of files as names of definitions: other characters become ``_``, what is taken gets a number; names in the
expressions of tables as parameters.
"""

from __future__ import annotations

import re
from collections.abc import Iterable
from dataclasses import dataclass, field
from typing import Any

from substructures.documents.fields import shown
from substructures.errors import InvalidDocument, listed
from substructures.expr.graph import Expr, Graph
from substructures.expr.parse import parse
from substructures.expr.steps import RESERVED
from substructures.interchange.numbers import is_number
from substructures.part.topology import BASE

_LONGEST = 60
_NO_NAMES = frozenset(("nan", "inf", "infinity", "none", "null", "true", "false"))


class Names:
    """Gives every name of a file a name of its own; ``given``: the mapping, in the order of the file."""

    def __init__(self, taken: Iterable[str] = ()) -> None:
        self._taken = {BASE, *RESERVED, *taken}
        self.given: dict[str, str] = {}

    def of(self, name: str) -> str:
        """The name for one of the file, always the same."""
        if name not in self.given:
            self.given[name] = self.new(name)
        return self.given[name]

    def new(self, wanted: str) -> str:
        """A name that nothing has, like the one that is wanted."""
        plain = re.sub(r"[^A-Za-z0-9_]", "_", wanted)[:_LONGEST]
        plain = plain if re.match(r"[A-Za-z]", plain) else f"x{plain}"[:_LONGEST]
        found, k = plain, 1
        while found in self._taken:
            k += 1
            found = f"{plain[: _LONGEST - 4]}_{k}"
        self._taken.add(found)
        return found


def library_name(wanted: str, otherwise: str = "imported") -> str:
    """A name of a substructure: small letters, digits and hyphens."""
    plain = re.sub(r"[^a-z0-9]+", "-", wanted.lower()).strip("-")[:64].strip("-")
    return plain or otherwise


def symbols_in(text: str) -> list[str] | None:
    """The names in an expression; None of a number, and of what is no expression.

    >>> symbols_in("L1 + pi/2"), symbols_in("0.5"), symbols_in("3OO")
    (['L1'], None, None)
    """
    graph = Graph()
    found: dict[str, None] = {}

    def seen(name: str) -> Expr:
        """A symbol, whose name is noted."""
        found[name] = None
        return graph.symbol(name)

    if is_number(text) or text.strip().lower() in _NO_NAMES:
        return None
    try:
        parse(graph, text.strip(), seen)
    except (ValueError, ArithmeticError, InvalidDocument):
        return None
    return list(found)


def title_of(text: str) -> str:
    """A name in a file as the title of a definition."""
    return shown(text)[:200]


@dataclass
class Symbols:
    """The parameters of a table with their units: of a symbol that stands alone in a cell, that of its column."""

    _units: dict[str, set[str]] = field(default_factory=dict)

    def add(self, names: Iterable[str], text: str, unit: str) -> None:
        """The names in a cell."""
        for name in names:
            self._units.setdefault(name, set()).update({unit} if unit and text.strip() == name else ())

    def parameters(self, coordinates: Iterable[str]) -> dict[str, dict[str, Any]]:
        """As a field of a definition. Raises InvalidDocument for names of coordinates."""
        both = sorted(set(coordinates) & self._units.keys())
        if both:
            message = f"{listed(both)} stands for a coordinate, and in a cell where nothing moves: give it another name"
            raise InvalidDocument.at("", "duplicate-name", message)
        return {name: {"unit": next(iter(some))} if len(some) == 1 else {} for name, some in self._units.items()}
