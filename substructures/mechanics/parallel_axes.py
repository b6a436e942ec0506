"""Runs of parallel axes by absolute angles, over any scalar (notation.md, section 5).

Revolute joints with parallel axes, one after the other, turn what they carry by the sum of their angles. With the lump
of joint j, what it carries by itself and the masses that hang on it gathered where their joints are, of first moments
S_j about O_j, every pair of joints i < j has one number A_ij = d_i . R S_j, R by the angles between, and metric,
Christoffel symbols and gravity forces are sums of such numbers. Prismatic joints along the same direction belong to the
run: they do not turn.
"""

from __future__ import annotations

from collections.abc import Callable, Collection, Mapping, Sequence
from dataclasses import dataclass, field, replace
from functools import cache

from substructures.mechanics.composite_form import Inertia, JointMomentum
from substructures.mechanics.evaluation_frames import Entries
from substructures.mechanics.kinematics import INTERFACE, Link, path
from substructures.mechanics.linear3 import ZERO, Planar, Rotation, Scalar, Vector, add, dot

#: revolute joints on a path up to which absolute angles are taken for metric and Christoffel symbols. They need more
#: sines and cosines, n (n - 1) in place of 2 (n - 1), each of which counts three operations, what the addition theorem
#: takes: of four joints 51 in place of 58, of five 90 in place of 94, 86 with base parameters
MOST = 4
#: one turn after the other about the third axis
Joined = Callable[[Planar, Planar], Planar]


def one_after_the_other(first: Planar, second: Planar) -> Planar:
    """By the addition theorem: cos(a + b) = c c' - s s', sin(a + b) = s c' + c s'."""
    c, s = second.c, second.s
    return Planar(2, first.c * c - first.s * s, first.s * c + first.c * s)


def parallel(link: Link) -> bool:
    """Whether the axis of a joint is known to be parallel to that of its parent."""
    return link.parent != INTERFACE and link.rotation.keeps_third_axis


def absolute(chain: Sequence[Link]) -> frozenset[int]:
    """Joints whose metric and Christoffel symbols take fewer operations by absolute angles: of trees with parallel axes
    alone, two of them revolute, and no more than MOST on a path.
    """
    roots: list[int] = []
    revolute: list[int] = []
    spatial = set[int]()
    for k, link in enumerate(chain):
        is_root = link.parent == INTERFACE
        roots.append(k if is_root else roots[link.parent])
        revolute.append((not link.s) + (0 if is_root else revolute[link.parent]))
        if not is_root and not parallel(link):
            spatial.add(roots[k])
    most = dict.fromkeys(roots, 0)
    for root, count in zip(roots, revolute, strict=True):
        most[root] = max(most[root], count)
    return frozenset(k for k, root in enumerate(roots) if root not in spatial and 1 < most[root] <= MOST)


@dataclass(frozen=True, slots=True)
class Arm:
    """From a revolute joint of a run to the next one: the joint before (INTERFACE: none), E and Z from its frame."""

    parent: int
    turn: Planar | None
    Z: Vector


@dataclass(frozen=True)
class ByAngles:
    """What absolute angles give: g_ac and Gamma_abc of some joints c; of others, by joint, the moment of gravity on
    their lumps about their axes, and the parallel joints ``beyond``.
    """

    joints: frozenset[int] = frozenset()
    metric: Entries = field(default_factory=dict)
    christoffel: Entries = field(default_factory=dict)
    lumps: Mapping[int, Scalar] = field(default_factory=dict)
    beyond: Mapping[int, Sequence[int]] = field(default_factory=dict)

    def gravity(self, gamma: Sequence[Vector], momenta: Sequence[JointMomentum]) -> list[Scalar]:
        """Q_c of gravity; ``gamma``: in frame c."""
        Q: list[Scalar] = [0] * len(momenta)
        for c in reversed(range(len(momenta))):
            if c in self.lumps:
                # the moment about the axis of c is that of its lump and those about the parallel axes beyond
                Q[c] = self.lumps[c]
                for k in self.beyond[c]:
                    Q[c] = Q[c] + Q[k]
            else:
                # Q_c = gamma_c . p_c
                Q[c] = dot(gamma[c], momenta[c].p)
        return Q


class ParallelAxes:
    """The lumps of a tree and what follows from them.

    ``body``: what is fixed in the carrier of a joint k, about O_k in frame k; ``joined``: how turns are joined. Nothing
    is formed that is not needed: of equal formulas the first one stays.
    """

    def __init__(
        self, chain: Sequence[Link], body: Callable[[int], Inertia], joined: Joined = one_after_the_other
    ) -> None:
        self.chain, self.body, self.joined = chain, cache(body), joined
        self.children: list[list[int]] = [[] for _ in chain]
        for k, link in enumerate(chain):
            if link.parent != INTERFACE:
                self.children[link.parent].append(k)
        self._masses: dict[int, Scalar] = {}
        self._lumps: dict[int, Inertia] = {}
        #: of revolute joints
        self.arms = self._arms()
        self.beyond: dict[int, list[int]] = {k: [] for k in self.arms}
        for k, arm in self.arms.items():
            if arm.parent != INTERFACE:
                self.beyond[arm.parent].append(k)

    def mass(self, k: int) -> Scalar:
        """Of everything that a joint carries."""
        order = [k]
        for joint in order:
            order += [child for child in self.children[joint] if child not in self._masses]
        for joint in reversed(order):
            if joint not in self._masses:
                m = self.body(joint).m
                for child in reversed(self.children[joint]):
                    m = m + self._masses[child]
                self._masses[joint] = m
        return self._masses[k]

    def _arms(self) -> dict[int, Arm]:
        arms: dict[int, Arm] = {}
        # from the frame of the revolute joint before, of prismatic joints as well
        ways: list[Arm] = []
        for k, link in enumerate(self.chain):
            way = Arm(INTERFACE, None, ZERO)
            if parallel(link):
                before = ways[link.parent]
                if not self.chain[link.parent].s:
                    before = Arm(link.parent, None, ZERO)
                if before.parent != INTERFACE:
                    Z = link.Z if before.turn is None else before.turn.back(link.Z)
                    way = Arm(before.parent, self._turned(before.turn, link.rotation), add(before.Z, Z))
            ways.append(way)
            if not link.s:
                arms[k] = way
        return arms

    def _turned(self, turn: Planar | None, rotation: Rotation) -> Planar | None:
        """A turn and the one of a link with a parallel axis."""
        for factor in rotation.factors:
            if isinstance(factor, Planar):
                turn = factor if turn is None else self.joined(turn, factor)
        return turn

    def _constant(self) -> list[bool]:
        """Whether the lump of a joint does not depend on the state: axes that it carries are parallel to its own."""
        result = [True] * len(self.chain)
        for k in reversed(range(len(self.chain))):
            link = self.chain[k]
            if link.parent != INTERFACE and not (parallel(link) and (result[k] or not link.s)):
                result[link.parent] = False
        return result

    def lump(self, k: int) -> Inertia:
        """What a joint carries without the revolute joints of its run beyond, their masses where the joints are."""
        order = [k]
        for joint in order:
            order += [child for child in self.children[joint] if self.chain[child].s and child not in self._lumps]
        for joint in reversed(order):
            if joint not in self._lumps:
                total = self.body(joint)
                for child in self.children[joint]:
                    total = total + self._hanging(child)
                self._lumps[joint] = total
        return self._lumps[k]

    def _hanging(self, k: int) -> Inertia:
        """What joint k adds to the lump of its parent; that of a prismatic joint is known."""
        link = self.chain[k]
        if not link.s:
            return Inertia(self.mass(k), polar=0).shifted(link.Z)
        lump = self._lumps[k]
        return replace(lump.turned_back(link.rotation), polar=lump.about_third_axis).shifted(link.Z)

    def _gravity(self, before: Mapping[int, Vector]) -> Mapping[int, Scalar]:
        """gamma . (e3 x R S_k) of revolute joints with constant lumps in runs that begin at the world, or where nothing
        before turns.
        """
        found: dict[int, Scalar] = {}
        bases: dict[int, tuple[Vector, Planar | None]] = {}
        at_rest: dict[int, Vector] = {}
        constant = self._constant()
        for k, link in enumerate(self.chain):
            gamma = before[k] if link.parent == INTERFACE else at_rest.get(link.parent)
            if gamma is not None and link.s:
                at_rest[k] = link.rotation.forward(gamma)
            elif gamma is not None:
                bases[k] = _before_the_turn(link, gamma)
            elif not link.s and self.arms[k].parent in bases:
                base, turn = bases[self.arms[k].parent]
                arm = self.arms[k].turn
                bases[k] = base, turn if arm is None else arm if turn is None else self.joined(turn, arm)
            is_alone = not link.s and self.arms[k].parent == INTERFACE and not self.beyond[k]
            if k in bases and not is_alone and constant[k]:
                found[k] = _moment(*bases[k], self.lump(k).s)
        return found

    def by_angles(
        self, joints: frozenset[int], christoffel: bool, gravity: Mapping[int, Vector] | None = None
    ) -> ByAngles:
        """Metric and, if wanted, Christoffel symbols of joints c of which all axes are parallel, and gravity.

        ``gravity``: by root, in the frame from which its link leads.
        """
        gamma = self.christoffel(joints) if christoffel else {}
        lumps = {} if gravity is None else self._gravity(gravity)
        return ByAngles(joints, self.metric(joints), gamma, lumps, self.beyond)

    def metric(self, joints: Collection[int]) -> Entries:
        """g_ac for all a <= c, of joints c of which all axes are parallel."""
        g: Entries = {(a, c): self._sliding(a, c) for c in sorted(joints) for a in path(self.chain, c)}
        sums = self._sums(joints, _with)
        for b in sorted(sums, reverse=True):
            # g_bb = A_bb + sum over joints k beyond b of g_bk + T_bk,   T_ib: the sum of A_ij over j >= b
            g[b, b] = self.lump(b).about_third_axis
            for k in self.beyond[b]:
                g[b, b] = g[b, b] + (g[b, k] + sums[k][b])
            # g_ab = g_bb + sum of T_ib over a <= i < b
            total = g[b, b]
            for i in self._before(b):
                total = total + sums[b][i]
                g[i, b] = total
        return g

    def christoffel(self, joints: Collection[int]) -> Entries:
        """Gamma_abc for a < c, b <= c, of the same."""
        gamma: Entries = {
            (a, b, c): 0 for c in sorted(joints) for a in path(self.chain, c)[:-1] for b in path(self.chain, c)
        }
        for c, of_c in self._sums(joints, _beside).items():
            total: Scalar = 0
            # Gamma_abc = sum of B_ij over a <= i < c and j >= c: the same for all b
            for a in self._before(c):
                total = total + of_c[a]
                for b in [*self._before(c), c]:
                    gamma[a, b, c] = total
        return gamma

    def _sliding(self, a: int, c: int) -> Scalar:
        """g_ac of prismatic joints: the mass that both move."""
        return self.mass(c) if self.chain[a].s and self.chain[c].s else 0

    def _before(self, b: int) -> list[int]:
        """The revolute joints before b in its run, the next one first."""
        found = list[int]()
        while self.arms[b].parent != INTERFACE:
            b = self.arms[b].parent
            found.append(b)
        return found

    def _sums(
        self, joints: Collection[int], product: Callable[[Vector, Planar | None, Vector], Scalar]
    ) -> dict[int, dict[int, Scalar]]:
        """By b and i < b: the sum over j >= b of the product of d_i and S_j."""
        sums: dict[int, dict[int, Scalar]] = {}
        for b in sorted((k for k in joints if not self.chain[k].s), reverse=True):
            S, turn, at, sums[b] = self.lump(b).s, self.arms[b].turn, b, {}
            for i in self._before(b):
                total = product(self.arms[at].Z, turn, S)
                for k in self.beyond[b]:
                    total = total + sums[k][i]
                sums[b][i] = total
                at, arm = i, self.arms[i].turn
                turn = arm if turn is None else turn if arm is None else self.joined(arm, turn)
        return sums


def _before_the_turn(link: Link, gamma: Vector) -> tuple[Vector, Planar | None]:
    """gamma in the axes from which a joint turns, and its turn; in its own axes where the two are not apart."""
    *others, last = link.rotation.factors or (None,)
    if isinstance(last, Planar) and last.axis == 2:
        return Rotation(tuple(x for x in others if x is not None)).forward(gamma), last
    return link.rotation.forward(gamma), None


def _moment(gamma: Vector, turn: Planar | None, S: Vector) -> Scalar:
    """gamma . (e3 x R S): products of gamma and S first, which are constant."""
    x, y = gamma[1] * S[0] - gamma[0] * S[1], gamma[1] * S[1] + gamma[0] * S[0]
    return x if turn is None else turn.c * x - turn.s * y


def _with(d: Vector, turn: Planar | None, S: Vector) -> Scalar:
    """A = d . R S."""
    x, y = d[0] * S[0] + d[1] * S[1], d[1] * S[0] - d[0] * S[1]
    return x if turn is None else turn.c * x + turn.s * y


def _beside(d: Vector, turn: Planar | None, S: Vector) -> Scalar:
    """B = d . (e3 x R S), the derivative of A by the angle."""
    x, y = d[0] * S[0] + d[1] * S[1], d[1] * S[0] - d[0] * S[1]
    return y if turn is None else turn.c * y - turn.s * x
