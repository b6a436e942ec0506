"""What a reader has to say about a file: faults that refuse it, and remarks with line and element."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, field
from typing import Any, Literal

from substructures.errors import Fault, InvalidDocument

#: what became of something in the file
Level = Literal["ignored", "merged", "warning"]
#: what a remark is about: the form of the file, how links hang together, what no body can be
Tier = Literal["schema", "topology", "physics"]
TIERS: tuple[Tier, ...] = ("schema", "topology", "physics")
#: so many remarks are listed
MOST_REMARKS = 1000


@dataclass(frozen=True, slots=True)
class Place:
    """Where something is in a file: its line (from 1, 0 for none) and the element or cell, as people write it."""

    line: int
    element: str

    def __str__(self) -> str:
        return f"line {self.line}: {self.element}" if self.line else self.element


@dataclass(frozen=True, slots=True)
class Remark:
    """Something that the reader left out, merged, or finds hardly meant."""

    place: Place
    level: Level
    tier: Tier
    message: str

    def plain(self) -> dict[str, Any]:
        """As JSON data."""
        return {
            "place": str(self.place),
            "line": self.place.line,
            "element": self.place.element,
            "level": self.level,
            "check": self.tier,
            "message": self.message,
        }


@dataclass
class Report:
    """Collects remarks; what is wrong raises."""

    remarks: list[Remark] = field(default_factory=list)

    def ignored(self, place: Place, message: str) -> None:
        """Something that has no influence on the equations of motion."""
        self._add(Remark(place, "ignored", "schema", message))

    def merged(self, place: Place, message: str) -> None:
        """Something that is there in another form."""
        self._add(Remark(place, "merged", "topology", message))

    def warning(self, place: Place, message: str, tier: Tier = "schema") -> None:
        """Something that has an influence, or that is hardly meant."""
        self._add(Remark(place, "warning", tier, message))

    def _add(self, remark: Remark) -> None:
        if len(self.remarks) < MOST_REMARKS and remark not in self.remarks[-20:]:
            self.remarks.append(remark)

    def plain(self) -> list[dict[str, Any]]:
        """As JSON data, in the order of the file."""
        return [r.plain() for r in sorted(self.remarks, key=lambda r: r.place.line)]

    def checks(self) -> dict[str, dict[str, Any]]:
        """For every tier whether there were warnings; a file with faults has no report."""
        return {tier: _told(list(self._warnings(tier))) for tier in TIERS}

    def _warnings(self, tier: Tier) -> Iterator[Remark]:
        return (r for r in self.remarks if r.tier == tier and r.level == "warning")


def _told(warnings: list[Remark]) -> dict[str, Any]:
    return {"passed": not warnings, "warnings": len(warnings)}


def refuse(place: Place, code: str, message: str) -> InvalidDocument:
    """The exception for what cannot be read: where, what, and the remedy."""
    return InvalidDocument([Fault("", code, f"{place}: {message}")])
