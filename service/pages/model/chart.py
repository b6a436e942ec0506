"""What sliders are of states: coordinates, and of ball and floating joints a place and a rotation vector.

The rotation vector theta n, |theta| <= pi, has the quaternion (cos(theta/2), sin(theta/2) n).
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from functools import cached_property
from math import atan2, cos, hypot, sin

from substructures.mechanics.state_names import BallRow, positions_of


@dataclass(frozen=True)
class Chart:
    """``coordinates``: that matrices go by, as many as there are sliders; ``balls``: with their positions and rates."""

    coordinates: tuple[str, ...]
    balls: tuple[BallRow, ...] = ()

    @cached_property
    def positions(self) -> tuple[str, ...]:
        """What states q are."""
        return positions_of(self.coordinates, self.balls)

    @cached_property
    def turns(self) -> list[tuple[int, int, bool]]:
        """Of every quaternion the number of its first slider and of its first position, and whether it floats."""
        return [
            (
                self.coordinates.index(ball["velocities"][-3]),
                self.positions.index(ball["positions"][-4]),
                len(ball["positions"]) > len(ball["positions"][-4:]),
            )
            for ball in self.balls
        ]

    @property
    def labels(self) -> tuple[str, ...]:
        """Names of sliders: of positions, of rotation vectors those of the rates."""
        turning = {name for ball in self.balls for name in ball["positions"][-4:]}
        named = {ball["positions"][-4]: ball["velocities"][-3:] for ball in self.balls}
        return tuple(x for name in self.positions for x in named.get(name, () if name in turning else (name,)))

    def values(self, q: Sequence[float]) -> tuple[float, ...]:
        """Where sliders are in a state."""
        return tuple(self._values(q))

    def _values(self, q: Sequence[float]) -> Iterator[float]:
        first, i = {position for _, position, _ in self.turns}, 0
        while i < len(q):
            if i in first:
                yield from rotation_vector(q[i : i + 4])
            else:
                yield q[i]
            i += 4 if i in first else 1

    def state(self, values: Sequence[float]) -> tuple[float, ...]:
        """The state in which sliders are there."""
        return tuple(self._state(values))

    def _state(self, values: Sequence[float]) -> Iterator[float]:
        first, k = {slider for slider, _, _ in self.turns}, 0
        while k < len(values):
            if k in first:
                yield from quaternion(values[k : k + 3])
            else:
                yield values[k]
            k += 3 if k in first else 1

    @property
    def rest(self) -> tuple[float, ...]:
        """The state in which all sliders are at 0."""
        return self.state([0.0] * len(self.coordinates))


def quaternion(vector: Sequence[float]) -> tuple[float, ...]:
    """w, x, y, z of a rotation vector."""
    theta = hypot(*vector)
    # sin(theta/2)/theta is 1/2 to rounding where theta^2 is lost beside 1
    scale = sin(theta / 2) / theta if theta > 1e-8 else 0.5
    return cos(theta / 2), *(scale * x for x in vector)


def rotation_vector(turned: Sequence[float]) -> tuple[float, ...]:
    """theta n of a quaternion w, x, y, z."""
    w, *vector = turned if turned[0] >= 0 else [-x for x in turned]
    s = hypot(*vector)
    scale = 2 * atan2(s, w) / s if s > 1e-8 else 2.0
    return tuple(scale * x for x in vector)
