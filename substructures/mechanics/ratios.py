"""Joints that move with the coordinate of another one: q'^a = mu_a y'^i(a), over any scalar (notation.md, section 6).

The coordinates y of a mechanism are those of the joints that depend on no other. With N_ai = mu_a for i = i(a), else 0,
everything that has an index of a joint gets one of a coordinate: Q*_i = N_ai Q_a, g*_ij = N_ai N_bj g_ab,
Gamma*_ijk = N_ai N_bj N_ck Gamma_abc, since N is constant.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass

from substructures.mechanics.linear3 import Scalar, exactly

#: scalars by index
Elements = dict[tuple[int, ...], Scalar]
_ONE: Scalar = 1


@dataclass(frozen=True)
class Ratios:
    """By joint: the coordinate ``of`` that moves it, and mu; 1 where the coordinate is its own.

    ``movers``: by coordinate, the joint whose own it is.
    """

    of: tuple[int, ...]
    multipliers: tuple[Scalar, ...]
    movers: tuple[int, ...]

    @property
    def count(self) -> int:
        """The number of coordinates."""
        return len(self.movers)

    @property
    def is_identity(self) -> bool:
        """Whether every joint has a coordinate of its own."""
        return len(self.movers) == len(self.of)

    def rates(self, rates: Sequence[Scalar]) -> list[Scalar]:
        """q'^a, or q''^a, of all joints from those of the coordinates."""
        if self.is_identity:
            return list(rates)
        return [_times(rates[i], mu) for i, mu in zip(self.of, self.multipliers, strict=True)]

    def reduced(self, elements: Mapping[tuple[int, ...], Scalar], axes: Iterable[int]) -> Elements:
        """The elements with coordinates in place of joints along these axes."""
        result: Elements = {}
        for index, x in elements.items():
            place, factor = list(index), _ONE
            for axis in axes:
                a = index[axis]
                place[axis], factor = self.of[a], _times(self.multipliers[a], factor)
            at, term = tuple(place), _times(x, factor)
            result[at] = result[at] + term if at in result else term
        return result


def _times(x: Scalar, factor: Scalar) -> Scalar:
    return x if exactly(factor, 1) else factor if exactly(x, 1) else x * factor
