"""What says whether values of a tree are plausible: the interface of :mod:`substructures.tree.plausibility`."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any, Protocol

from substructures.array import Array

#: pointer, code, message
Notice = dict[str, str]


class Judge(Protocol):
    """``given``: values of parameters, others are at their defaults; ``first``: what states ``q`` are counted from."""

    @property
    def mass(self) -> float | None:
        """Of all bodies in kg where no parameter is given; None where that of one is not known then."""

    @property
    def at_defaults(self) -> tuple[Notice, ...]:
        """:meth:`inertias` where no parameter is given."""

    @property
    def limiting(self) -> frozenset[str]:
        """The parameters that limits depend on."""

    @property
    def limits_at_defaults(self) -> dict[str, tuple[Any, Any, str]]:
        """:meth:`limits` where no parameter is given."""

    @property
    def has_relations(self) -> bool:
        """Whether relations move joints of its parts."""

    def masses(self, given: Mapping[str, Any]) -> Any:
        """Of all bodies in kg; NaN without a value."""

    def inertias(self, given: Mapping[str, Any], first: int = 0) -> list[Notice]:
        """Bodies and rotors that there cannot be."""

    def limits(self, given: Mapping[str, Any]) -> dict[str, tuple[Any, Any, str]]:
        """Lowest and highest value of every coordinate that has limits, and its unit."""

    def left(self, coordinates: tuple[str, ...], q: Array, given: Mapping[str, Any], first: int = 0) -> list[Notice]:
        """Coordinates beyond their limits."""

    def apart(self, coordinates: Sequence[str], q: Array, first: int = 0) -> list[Notice]:
        """Relations that definitions leave out and states do not fit."""
