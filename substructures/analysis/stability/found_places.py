"""What searches for equilibria and for steady motions give: different places, each with its verdict and its check."""

from __future__ import annotations

from collections import Counter
from dataclasses import dataclass, field
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
    """All that were found, in the order of their coordinates; ``message``: advice when nothing was found, and what was
    left out.
    """

    found: tuple[P, ...]
    message: str = field(default="", kw_only=True)

    @property
    def checks(self) -> tuple[Check, ...]:
        """One for each place."""
        return tuple(place.check() for place in self.found)

    @property
    def is_right(self) -> bool | None:
        """Whether all that were found are what was looked for; None where there are none."""
        return verdict(self.checks)

    def _shown(self, **about: tuple[str, ...]) -> str:
        """Two lines: how many were found, with ``about``, and their verdicts."""
        verdicts = Counter(place.verdict for place in self.found)
        finding = ", ".join(f"{count} {verdict}" for verdict, count in verdicts.most_common())
        names = "".join(f", {name}={list(coordinates)}" for name, coordinates in about.items())
        return f"{type(self).__name__}(found={len(self.found)}{names})\n{self.message or finding}"


def still(name: str, reason: str, qdd: Array, M: Array, K: Array) -> Check:
    """That accelerations q'' vanish beside those that a unit displacement causes, M^-1 K, or beside 1."""
    about: About = (name, "zero", reason, "rad/s^2, m/s^2")
    return Check.at(about, float(np.abs(qdd).max(initial=0)), 0.0, unit_accelerations(K, M), AT_REST)
