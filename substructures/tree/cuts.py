"""Closures of a tree as they are read: what they equate, and the coordinates in which closed parts move."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from typing import Any

from substructures.errors import InvalidDocument
from substructures.expr.graph import Expr
from substructures.mechanics.linear3 import Matrix, Vector


@dataclass(frozen=True, slots=True)
class ClosureRows:
    """What a closure is and its rows, in the order of the outputs."""

    name: str
    type: str
    start: str
    end: str
    rows: tuple[str, ...]

    def plain(self) -> dict[str, Any]:
        """As JSON data."""
        return {"name": self.name, "type": self.type, "from": self.start, "to": self.end, "rows": list(self.rows)}

    @classmethod
    def read(cls, plain: Mapping[str, Any]) -> ClosureRows:
        """From JSON data."""
        return cls(plain["name"], plain["type"], plain["from"], plain["to"], tuple(plain["rows"]))


@dataclass(frozen=True)
class Reduction:
    """``independent``: coordinates by whose rates all others are given, empty where the parts do not say all;
    ``start``: near a closed position; ``ranges``: lowest and highest values. By name; constants in SI as texts.
    """

    independent: tuple[str, ...] = ()
    start: Mapping[str, str] = field(default_factory=dict)
    ranges: Mapping[str, tuple[str, str]] = field(default_factory=dict)

    def __bool__(self) -> bool:
        """Whether anything is said."""
        return bool(self.independent or self.start or self.ranges)

    def plain(self) -> dict[str, Any]:
        """As JSON data."""
        ranges = {name: list(ends) for name, ends in self.ranges.items()}
        return {"independent": list(self.independent), "start": dict(self.start), "ranges": ranges}

    @classmethod
    def read(cls, plain: Mapping[str, Any]) -> Reduction:
        """From JSON data."""
        ranges = {name: (low, high) for name, (low, high) in plain["ranges"].items()}
        return cls(tuple(plain["independent"]), dict(plain["start"]), ranges)


@dataclass(frozen=True, slots=True)
class ClosureEnd:
    """A frame of a mounted part (or of the WORLD) with a constant placement in it."""

    part: int
    frame: int
    E: Matrix
    position: Vector


@dataclass(frozen=True, slots=True)
class Cut:
    """A closure with its frames read."""

    rows: ClosureRows
    start: ClosureEnd
    end: ClosureEnd
    length: Expr


def require_open(closures: Sequence[ClosureRows], instead: str) -> None:
    """Raises InvalidDocument (``has-closures``) where closed loops would be ignored; ``instead``: what takes them."""
    if closures:
        names = ", ".join(f"'{rows.name}'" for rows in closures)
        message = (
            f"the closures {names} make the coordinates depend on each other, which is not taken into account here: "
            f"{instead}, or leave the closures out"
        )
        raise InvalidDocument.at("", "has-closures", message)
