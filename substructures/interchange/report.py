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
#: characters of a message that a definition keeps
LONGEST = 2000
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
    """Something that the reader left out, merged, or finds hardly meant; ``is_loss``: what is stored tells it, too."""

    place: Place
    level: Level
    tier: Tier
    message: str
    is_loss: bool = False

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

    def lost(self, place: Place, message: str, tier: Tier = "schema") -> None:
        """Something that has an influence and is left out: a warning here, and of what is stored of the file."""
        self._add(Remark(place, "warning", tier, message, is_loss=True))

    def losses(self) -> list[dict[str, Any]]:
        """What is left out, as a field of a definition; the same at several places once."""
        found: dict[str, list[Place]] = {}
        for remark in self.remarks:
            if remark.is_loss:
                found.setdefault(remark.message, []).append(remark.place)
        return [
            {"message": f"{places[0]}{f' and {len(places) - 1} more' if places[1:] else ''}: {message}"[:LONGEST]}
            for message, places in found.items()
        ]

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
