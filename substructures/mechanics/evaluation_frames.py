"""Metric and Christoffel symbols in evaluation frames, over any scalar (notation.md, section 5).

U . p + Omega . H is the power of a wrench on a twist: any frame and point will do. For every joint c a carrier e(c) on
its path is chosen, and the momentum (p, H, K) is carried there instead of all columns to c. What a joint on the way
does is then its own component: in frame k the column of joint k is its axis.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field

from substructures.mechanics.composite_form import JointMomentum, christoffel_block, pairing
from substructures.mechanics.kinematics import Columns, Link, Twist, fixed_columns
from substructures.mechanics.linear3 import (
    E3,
    ZERO,
    Matrix,
    Scalar,
    Vector,
    add,
    apply,
    cross,
    dot,
    exactly,
    scale,
    subtract,
)

#: e(c) for every joint c
Frames = Sequence[int]
#: scalars by index
Entries = dict[tuple[int, ...], Scalar]


def momentum_before(link: Link, p: Vector, H: Vector) -> tuple[Vector, Vector]:
    """p and H, given about O_k in frame k, about O_p in frame p."""
    # p^e = R p,   H^e = R H + r x p^e
    back = link.rotation.back(p)
    return back, add(link.rotation.back(H), cross(link.Z, back))


def form_before(link: Link, p: Vector, K: Matrix) -> Matrix:
    """K about O_p in frame p; ``p``: the momentum, turned into frame p already."""
    # K^e = R K R^T - skew(r) skew(p^e),   skew(r) skew(p) = p r^T - (r . p) 1
    K = link.rotation.back_matrix(K)
    if all(exactly(x, 0) for x in link.Z):
        return K
    x, y, z = (scale(component, link.Z) for component in p)
    both = dot(link.Z, p)
    return subtract(K, ((x[0] - both, x[1], x[2]), (y[0], y[1] - both, y[2]), (z[0], z[1], z[2] - both)))


def twist_before(link: Link, twist: Twist) -> Twist:
    """A twist about O_k in frame k, about O_p in frame p."""
    Omega = link.rotation.back(twist.Omega)
    return Twist(add(link.rotation.back(twist.U), cross(link.Z, Omega)), Omega)


def axis(s: int) -> Twist:
    """What joint k does in frame k: U = s e3, Omega = (1 - s) e3."""
    return Twist(E3 if s else ZERO, ZERO if s else E3)


@dataclass
class InertialEntries:
    """g_ac and Gamma_abc by indices of the coordinates, a < c, b <= c.

    ``columns``: of the carriers, by coordinate; ``frames``: e(c).
    """

    chain: Sequence[Link]
    columns: Mapping[int, Columns]
    frames: Frames
    #: the twist of joint a at O_e in frame e, by (a, e), for a > e
    _axes: dict[tuple[int, int], Twist] = field(default_factory=dict)

    def metric(self, c: int, momentum: JointMomentum, known: int | None = None) -> Entries:
        """g_ac for all a <= c; ``known``: leave out the coordinates from this one on."""
        columns, g = self._columns_to(c, known), Entries()
        if known is not None and not columns:
            return g
        p, H, k, e = momentum.p, momentum.H, c, self.frames[c]
        # g_cc = p_3 = m (prismatic) or H_3 (revolute), and so for every joint on the way to e
        while True:
            if known is None or k < known:
                g[k, c] = p[2] if self.chain[k].s else H[2]
            if k == e:
                break
            p, H = momentum_before(self.chain[k], p, H)
            k = self.chain[k].parent
        # g_ac = U_ea . p + Omega_ea . H
        g |= {(a, c): pairing(twist, p, H) for a, twist in columns.items()}
        return g

    def _columns_to(self, c: int, known: int | None) -> Columns:
        """The columns at e(c) but that of e itself, and but known ones."""
        e = self.frames[c]
        return {a: twist for a, twist in self.columns[e].items() if a != e and (known is None or a < known)}

    def christoffel(self, c: int, momentum: JointMomentum, known: int | None = None) -> Entries:
        """Gamma_abc = U_a . (Omega_b x p) + Omega_a^T K Omega_b for a < c, b <= c, all in frame e(c).

        ``known``: leave out the pairs of coordinates from this one on.
        """
        e = self.frames[c]
        if known is not None and not self._columns_to(c, known):
            return {}
        if e == c:
            return christoffel_block(c, self.columns[c], momentum.p, momentum.moment, known)
        p, K, k = momentum.p, momentum.matrix(), c
        while k != e:
            p = self.chain[k].rotation.back(p)
            K = form_before(self.chain[k], p, K)
            k = self.chain[k].parent
        return christoffel_block(c, self.twists(c, e), p, lambda Omega: apply(K, Omega), known)

    def twists(self, c: int, e: int) -> Columns:
        """Of all joints on the path to c at O_e in frame e: columns up to e, axes beyond."""
        result, a = fixed_columns(self.chain, self.columns, e), c
        while a != e:
            result = {**result, a: self._axis(a, e)}
            a = self.chain[a].parent
        return result

    def _axis(self, a: int, e: int) -> Twist:
        if (a, e) not in self._axes:
            twist, k = axis(self.chain[a].s), a
            while k != e:
                twist = twist_before(self.chain[k], twist)
                k = self.chain[k].parent
            self._axes[a, e] = twist
        return self._axes[a, e]
