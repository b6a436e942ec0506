"""What searches for equilibria and for steady motions give: different places, each with its verdict and its check."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, field, replace
from typing import Generic, Protocol, TypeVar

import numpy as np

from substructures.analysis.stability.operating_point import AT_REST, unit_accelerations
from substructures.analysis.verdict import About, Check, verdict
from substructures.array import Array


class Place(Protocol):
    """An equilibrium or a steady motion."""

    @property
    def verdict(self) -> str:
        """Of its stability; ``failed`` where there is none."""

    def check(self) -> Check:
        """That it is one, by equations that the search had not."""


P = TypeVar("P", bound=Place, covariant=True)


@dataclass(frozen=True, repr=False)
class FoundPlaces(Generic[P]):
    """All that were ``found``, one after the other, in the order of their coordinates; ``message``: advice when nothing
    was found, and what was left out. Each place has a check, and a verdict, of its own; there is none that a check
    contradicts.
    """

    found: tuple[P, ...]
    message: str = field(default="", kw_only=True)

    def __len__(self) -> int:
        return len(self.found)

    def __iter__(self) -> Iterator[P]:
        return iter(self.found)

    def __getitem__(self, k: int) -> P:
        return self.found[k]

    @property
    def checks(self) -> tuple[Check, ...]:
        """One for each place."""
        return tuple(place.check() for place in self.found)

    @property
    def is_right(self) -> bool | None:
        """Whether those that could be judged are what was looked for; None where there are none."""
        return verdict(replace(check, needed=False) for check in self.checks)

    def _shown(self, **about: tuple[str, ...]) -> str:
        """Two lines: how many were found, with ``about``, and their verdicts."""
        verdicts = Counter(place.verdict for place in self.found)
        finding = ", ".join(f"{count} {verdict}" for verdict, count in verdicts.most_common())
        names = "".join(f", {name}={list(coordinates)}" for name, coordinates in about.items())
        return f"{type(self).__name__}(found={len(self.found)}{names})\n{self.message or finding}"


def still(name: str, reason: str, qdd: Array, M: Array, K: Array) -> Check:
    """That accelerations q'' vanish, each beside those that a unit displacement causes there, M^-1 K, or beside 1."""
    about: About = (name, "zero", reason, "rad/s^2, m/s^2")
    if not len(qdd):
        return Check.at(about, 0.0, 0.0, 1.0, AT_REST)
    units = unit_accelerations(K, M)
    worst = int(np.nan_to_num(np.abs(qdd) / units, nan=np.inf).argmax())
    return Check.at(about, float(np.abs(qdd[worst])), 0.0, float(units[worst]), AT_REST)


def confirmed(places: Sequence[P]) -> tuple[tuple[P, ...], str]:
    """Those that their checks do not contradict, and what is to be said of the others."""
    checks = [place.check() for place in places]
    kept = tuple(place for place, check in zip(places, checks, strict=True) if check.holds is not False)
    others = [check.worst for check in checks if check.holds is False]
    if not others:
        return kept, ""
    count = "1 place was" if len(others) == 1 else f"{len(others)} places were"
    return kept, (
        f"{count} left out where accelerations up to {max(others):.3g} (rad/s^2, m/s^2) remain: the search came to a "
        "position beside which the closures lose rank, or forces are not smooth"
    )
