"""Joints without singular angles, `ball` and `floating`, over any scalar (notation.md, section 14).

Such a joint is a chain of one degree of freedom joints in the axes of the body that it carries, all of them at zero:
what they do there are its rates. Before them stands the turn of a quaternion Q (w, x, y, z), of a floating one also the
place of the body's origin. Formulas in rates are those of the chain, but for accelerations, since the rates w of
turning and v of sliding are no derivatives of coordinates:

    q''_x = w_x' - w_y w_z,  q''_y = w_y' + w_x w_z,  q''_z = w_z' - w_x w_y        turning about x, y, z, in this order
    q'' = v' + w x v                                                              sliding

so that Gamma~_abc = Gamma_abc + 1/2 c_ibc g_ai, symmetric in b and c, and not those of the metric alone (Boltzmann and
Hamel).
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from typing import NamedTuple

from substructures.mechanics.linear3 import Matrix, Scalar

#: outputs that rates b, c multiply twice, with what an acceleration multiplies there, and the place of b in the index
BILINEAR = {"christoffel": ("metric", 1), "F": ("f", 0), "N": ("n", 0)}
Elements = dict[tuple[int, ...], Scalar]


class Turned(NamedTuple):
    """q''^i = ... + ``sign`` v^b v^c, b < c."""

    b: int
    c: int
    i: int
    sign: int


@dataclass(frozen=True, slots=True)
class BallJoint:
    """A ball joint, or with a place a floating one.

    ``body``: that it carries, by its index in the definition; ``first``: the first one of its joints, three that turn,
    or three that slide and three that turn; ``positions``: the names of its place (x, y, z), if it has one, and of its
    quaternion (w, x, y, z), which turns from the axes of the body to those before the joint.
    """

    body: int
    first: int
    positions: tuple[str, ...]

    @property
    def place(self) -> tuple[str, ...]:
        """The names of x, y, z; empty of a ball joint."""
        return self.positions[:-4]

    @property
    def quaternion(self) -> tuple[str, ...]:
        """The names of w, x, y, z."""
        return self.positions[-4:]

    @property
    def turning(self) -> int:
        """The first one of the joints that turn."""
        return self.first + len(self.place)

    @property
    def joints(self) -> range:
        """All joints."""
        return range(self.first, self.turning + 3)

    def mounted(self, first: int, prefix: str = "") -> BallJoint:
        """The same in a tree, in which the first joint of its part has the index ``first``."""
        return replace(self, first=self.first + first, positions=tuple(prefix + x for x in self.positions))

    def turned(self) -> Iterator[Turned]:
        """What accelerations are more than the derivatives of rates."""
        x, y, z = range(self.turning, self.turning + 3)
        yield from (Turned(y, z, x, -1), Turned(x, z, y, 1), Turned(x, y, z, -1))
        for i, j, k in ((0, 1, 2), (1, 2, 0), (2, 0, 1)) if self.place else ():
            # (w x v)_i = w_j v_k - w_k v_j
            yield Turned(self.first + k, self.turning + j, self.first + i, 1)
            yield Turned(self.first + j, self.turning + k, self.first + i, -1)


def accelerations(balls: Iterable[BallJoint], rates: Sequence[Scalar], second: Sequence[Scalar]) -> list[Scalar]:
    """q'' of all joints from the rates v and their derivatives v'; of other joints these are q' and q''."""
    result = list(second)
    for b, c, i, sign in (each for ball in balls for each in ball.turned()):
        product = rates[b] * rates[c]
        result[i] = result[i] + product if sign > 0 else result[i] - product
    return result


def at_constant_rates(balls: Sequence[BallJoint], rates: Sequence[Scalar]) -> list[Scalar]:
    """q'' of all joints where v' = 0; nothing where there are no balls."""
    return accelerations(balls, rates, [0] * len(rates)) if balls else []


def in_rates(balls: Iterable[BallJoint], halves: Mapping[tuple[int, ...], Scalar], place: int) -> Elements:
    """What is added to a quantity that rates multiply twice, at [..., b, c, ...] with b < c at ``place`` of the index.

    ``halves``: of what accelerations multiply, at [..., i, ...].
    """
    of: dict[int, list[Turned]] = {}
    for each in (each for ball in balls for each in ball.turned()):
        of.setdefault(each.i, []).append(each)
    result: Elements = {}
    for index, x in halves.items():
        for b, c, _, sign in of.get(index[place], ()):
            at, term = (*index[:place], b, c, *index[place + 1 :]), x if sign > 0 else -x
            result[at] = result[at] + term if at in result else term
    return result


def turned_by(quaternion: Sequence[Scalar], half_square: Scalar) -> Matrix:
    """E: components in the axes before the joint -> components in those of the body; ``half_square``: 2 / (Q . Q).

    Of any quaternion that is not zero: that of unit length has the same direction.
    """
    w, x, y, z = quaternion
    # R = 1 + 2 (w [r]x + [r]x^2) / (Q . Q),  E = R^T
    a, b, c = half_square * x, half_square * y, half_square * z
    xx, yy, zz, xy, xz, yz = a * x, b * y, c * z, a * y, a * z, b * z
    wx, wy, wz = a * w, b * w, c * w
    return (
        (1 - (yy + zz), xy + wz, xz - wy),
        (xy - wz, 1 - (xx + zz), yz + wx),
        (xz + wy, yz - wx, 1 - (xx + yy)),
    )


def displacement_rates(rates: Sequence[Scalar]) -> dict[tuple[int, int], Scalar]:
    """R of d' = dv + R d, for displacements d of a ball joint in the axes of its body: of place, if it has one, and the
    rotation vector, as the ``rates`` v and w are.

        d_turn' = dw - w x d_turn        d_place' = dv - w x d_place - v x d_turn
    """
    m = len(rates) - 3
    result: dict[tuple[int, int], Scalar] = {}
    blocks = [(m, m, rates[m:]), *([(0, 0, rates[m:]), (0, m, rates[:m])] if m else [])]
    for row, column, x in blocks:
        for i, j, k in ((0, 1, 2), (1, 2, 0), (2, 0, 1)):
            # -(x x d)_i = x_k d_j - x_j d_k
            result[row + i, column + j], result[row + i, column + k] = x[k], -x[j]
    return result


def quaternion_rates(quaternion: Sequence[Scalar], rates: Sequence[Scalar], half: Scalar) -> list[Scalar]:
    """Q' = 1/2 Q (0, w); ``rates``: w."""
    w, x, y, z = quaternion
    a, b, c = (half * rate for rate in rates)
    return [-(x * a + y * b + z * c), w * a + y * c - z * b, w * b + z * a - x * c, w * c + x * b - y * a]
