"""Which evaluation frames need the fewest operations: the recursion itself, over scalars that count.

What matters of a scalar is whether it is 0, 1, a constant or a function of the state, and that of the joints alone is
enough: every body is taken to have all ten inertial parameters. Then the frames are found by dynamic programming from
the leaves to the roots: e(c) is not before e(p) of its parent p, because inertias of leaves are carried over the same
links as those of their parents.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass, field, replace
from functools import lru_cache, partial

from substructures.mechanics.composite_form import Inertia, JointMomentum, joint_momentum, pairing
from substructures.mechanics.evaluation_frames import axis, form_before, momentum_before, twist_before
from substructures.mechanics.kinematics import INTERFACE, Link, Twist, carried, own_twist, path
from substructures.mechanics.linear3 import (
    Planar,
    Rotation,
    Scalar,
    Turn,
    Vector,
    apply,
    cross,
    exactly,
)

#: joints that an evaluation frame may be away from the joint whose momentum is carried there
REACH = 6
#: how much metric and Christoffel symbols together count beside the metric alone, which is asked for as well
BOTH = 2
#: whether a scalar is 0, 1 (or -1), a constant, or a function of the state
ZERO_, ONE, CONSTANT, STATE = range(4)
#: K omega
Moment = Callable[[Vector], Vector]
#: kinds of the scalars of a link: parent, s, its factors, Z
Shape = tuple[int, int, tuple[tuple[int, ...], ...], tuple[int, int, int]]


@dataclass(slots=True, unsafe_hash=True)  # a frozen one takes twice the time to make
class Count:
    """A scalar of which the kind is known, and what it was made of in how many operations per state.

    ``index``: its place among the operations of its tally, by which it is known; -1 - kind where it is none.
    """

    index: int
    kind: int
    tally: Tally = field(repr=False, compare=False)

    def __add__(self, other: Scalar) -> Count:
        y = other if type(other) is Count else self.tally.of(other)
        return y if self.kind == ZERO_ else self if y.kind == ZERO_ else self.tally.joined(self, y)

    __radd__ = __sub__ = __rsub__ = __add__

    def __mul__(self, other: Scalar) -> Count:
        y = other if type(other) is Count else self.tally.of(other)
        if self.kind <= ONE or y.kind == ZERO_:
            return y if self.kind == ONE else self.tally.scalars[ZERO_]
        return self if y.kind == ONE else self.tally.joined(self, y)

    __rmul__ = __mul__

    def __neg__(self) -> Count:
        return self


class Tally:
    """The scalars that no operation made, one of each kind, and all operations per state by their operands."""

    def __init__(self) -> None:
        self.operations: list[tuple[int, int]] = []
        self.scalars = tuple(Count(-1 - kind, kind, self) for kind in range(4))

    def of(self, x: Scalar) -> Count:
        """A scalar of this tally; integers stand for themselves."""
        if isinstance(x, Count):
            return x
        return self.scalars[ZERO_ if exactly(x, 0) else ONE if exactly(x, 1) or exactly(x, -1) else CONSTANT]

    def joined(self, x: Count, y: Count) -> Count:
        """The result of an operation that does not fold away: of constants it is one, and costs nothing per state."""
        if x.kind < STATE and y.kind < STATE:
            return self.scalars[CONSTANT]
        self.operations.append((x.index, y.index))
        return Count(len(self.operations) - 1, STATE, self)

    def plain(self, twist: Twist) -> Twist:
        """A twist of which nothing but the kinds is known: what it takes to form it is counted elsewhere."""
        (x, y, z), (u, v, w) = ([self.scalars[self.of(x).kind] for x in v] for v in (twist.U, twist.Omega))
        return Twist((x, y, z), (u, v, w))

    def needed(self, results: Iterable[Scalar], first: int, end: int) -> int:
        """How many of the operations from ``first`` to before ``end`` these results need."""
        wanted = [False] * (len(self.operations) - first)
        for x in results:
            if isinstance(x, Count) and x.index >= first:
                wanted[x.index - first] = True
        for i in reversed(range(len(wanted))):
            if wanted[i]:
                a, b = self.operations[first + i]
                if a >= first:
                    wanted[a - first] = True
                if b >= first:
                    wanted[b - first] = True
        return sum(wanted[: end - first])


def shape(link: Link, moves: bool) -> Shape:
    """What of a link matters; ``moves``: whether Z depends on the state, because the parent slides."""
    turning = CONSTANT if link.s else STATE

    def kind(x: Scalar, other: int) -> int:
        """Zero, one, or as the ``other`` says."""
        return ZERO_ if exactly(x, 0) else ONE if exactly(x, 1) or exactly(x, -1) else other

    factors = list[tuple[int, ...]]()
    for factor in link.rotation.factors:
        if isinstance(factor, Planar):
            # a turn about the third axis is the joint's own, a tilt is a constant
            own = turning if factor.axis == 2 else CONSTANT
            factors.append((factor.axis, kind(factor.c, own), kind(factor.s, own)))
        else:
            factors.append(tuple([kind(x, turning) for row in factor.e for x in row]))
    x, y, z = (kind(component, CONSTANT) for component in link.Z)
    return link.parent, link.s, tuple(factors), (x, y, STATE if moves else z)


def evaluation_frames(chain: Sequence[Link], christoffel: bool = True) -> tuple[int, ...]:
    """e(c) for the fewest operations of metric and Christoffel symbols (see BOTH), or of the metric alone."""
    return _chosen(
        tuple(shape(link, link.parent != INTERFACE and bool(chain[link.parent].s)) for link in chain), christoffel
    )


@lru_cache(maxsize=256)
def _chosen(shapes: tuple[Shape, ...], christoffel: bool) -> tuple[int, ...]:
    choice = _Choice(shapes, christoffel)
    found = choice.frames()
    choice.tally.operations.clear()  # tally and scalars refer to each other: Python's collector would look at them all
    return found


class _Choice:
    """Costs by joint and frame, and the cheapest frames."""

    def __init__(self, shapes: Sequence[Shape], christoffel: bool) -> None:
        self.tally, self.christoffel = Tally(), christoffel
        self.chain = [self._link(each) for each in shapes]
        self.paths = [path(self.chain, c) for c in range(len(shapes))]
        self._axes: dict[tuple[int, int], tuple[Twist, int]] = {}
        self.columns, self.of_columns = self._columns()

    def _link(self, given: Shape) -> Link:
        """A link of counting scalars."""
        parent, s, factors, Z = given
        of, rotations = self.tally.scalars, list[Planar | Turn]()
        for factor in factors:
            if len(factor) == 3:
                rotations.append(Planar(factor[0], of[factor[1]], of[factor[2]]))
            else:
                x, y, z = ((of[factor[i]], of[factor[i + 1]], of[factor[i + 2]]) for i in (0, 3, 6))
                rotations.append(Turn((x, y, z)))
        return Link(parent, s, Rotation(tuple(rotations)), (of[Z[0]], of[Z[1]], of[Z[2]]))

    def _columns(self) -> tuple[list[Counter[Twist]], list[int]]:
        """The columns of every carrier by kind (its own one apart), and what it takes to carry them there."""
        columns: list[Counter[Twist]] = []
        costs: list[int] = []
        for link in self.chain:
            here, cost = Counter[Twist](), 0
            for twist, number in self._fixed(columns, link.parent).items():
                before = len(self.tally.operations)
                here[self.tally.plain(carried(twist, link))] += number
                cost += number * (len(self.tally.operations) - before)
            columns.append(here)
            costs.append(cost)
        return columns, costs

    def _fixed(self, columns: Sequence[Counter[Twist]], carrier: int) -> Counter[Twist]:
        """All columns of what is fixed in a carrier, its own one with them."""
        if carrier == INTERFACE:
            return Counter()
        return columns[carrier] + Counter([self.tally.plain(axis(self.chain[carrier].s))])

    def frames(self) -> tuple[int, ...]:
        """The cheapest, from the leaves to the roots, and back."""
        n = len(self.chain)
        below: list[list[int]] = [[] for _ in range(n)]
        for c, link in enumerate(self.chain):
            if link.parent != INTERFACE:
                below[link.parent].append(c)
        #: of a joint in frame e with all that it carries; of its children, the frames that go with it
        best: list[dict[int, int]] = [{} for _ in range(n)]
        after: dict[tuple[int, int], int] = {}
        for c in reversed(range(n)):
            for e, cost in self._costs(c).items():
                for d in below[c]:
                    least = min((best[d][f] + self._change(d, e, f), f) for f in best[d] if f >= e)
                    cost, after[d, e] = cost + least[0], least[1]
                best[c][e] = cost
        result: list[int] = []
        for c, link in enumerate(self.chain):
            root = link.parent == INTERFACE
            result.append(c if root else after[c, result[link.parent]])
        return tuple(result)

    def _costs(self, c: int) -> dict[int, int]:
        """By frame e: carrying the momentum of joint c there, and the products with the columns."""
        tally, result = self.tally, dict[int, int]()
        # constants of a body that carries nothing, functions of the state of others
        momentum = self._momentum(c, STATE if any(link.parent == c for link in self.chain) else CONSTANT)
        p, H, K, moment = momentum.p, momentum.H, momentum.matrix(), momentum.moment
        start, found = len(tally.operations), [H[2]]
        for e in self.paths[c][::-1][: REACH + 1]:
            ready, link = len(tally.operations), self.chain[e]
            cost, results = self._metric(e, p, H)
            results += found
            result[e] = cost + tally.needed(results, start, ready)
            if self.christoffel:
                more, entries = self._products(c, e, p, moment)
                result[e] += BOTH * (cost + more + tally.needed([*results, *entries], start, ready))
            if e == c:
                link, turned = self._without_turn(link)
                if turned:
                    momentum = self._momentum(c, STATE)
                    p, H, K = momentum.p, momentum.H, momentum.matrix()
            back, H = momentum_before(link, p, H)
            if self.christoffel:
                K = form_before(link, back, K)
            p, moment = back, partial(apply, K)
            found.append(H[2])
        return result

    def _momentum(self, c: int, kind: int) -> JointMomentum:
        """Of joint c, with moments of this kind."""
        x = self.tally.scalars[kind]
        return joint_momentum(self.chain[c].s, Inertia(self.tally.scalars[CONSTANT], (x, x, x), (x, x, x, x, x, x)))

    def _without_turn(self, link: Link) -> tuple[Link, bool]:
        """A link without the turn of its joint, which the composites go through as well: skew(e3) commutes with it."""
        *others, last = link.rotation.factors or (None,)
        if isinstance(last, Planar) and last.axis == 2:
            return replace(link, rotation=Rotation(tuple(x for x in others if x is not None))), True
        return link, False

    def _metric(self, e: int, p: Vector, H: Vector) -> tuple[int, list[Scalar]]:
        """U . p + Omega . H of columns at e: operations, as often as there are columns, a result of each kind."""
        total, results, operations = 0, list[Scalar](), self.tally.operations
        for twist, number in self.columns[e].items():
            before = len(operations)
            results.append(pairing(twist, p, H))
            total += number * (len(operations) - before)
        return total, results

    def _products(self, c: int, e: int, p: Vector, moment: Moment) -> tuple[int, list[Scalar]]:
        """U_a . (Omega_b x p) + Omega_a^T K Omega_b for a < c, b <= c: as in :meth:`_metric`."""
        total, results, operations = 0, list[Scalar](), self.tally.operations
        others = self.columns[e] + Counter(self._axis(a, e)[0] for a in self.paths[c] if e <= a < c)
        own = self.tally.plain(own_twist(self.chain[c].s)) if e == c else self._axis(c, e)[0]
        for twist, number in (others + Counter([own])).items():
            before = len(operations)
            F, N, entries = cross(twist.Omega, p), moment(twist.Omega), list[Scalar]()
            formed = len(operations)
            for other, many in others.items():
                first = len(operations)
                entries.append(pairing(other, F, N))
                total += number * many * (len(operations) - first)
            total += number * self.tally.needed(entries, before, formed)
            results += entries
        return total, results

    def _axis(self, a: int, e: int) -> tuple[Twist, int]:
        """The kinds of the twist of joint a in frame e, and what it takes."""
        if (a, e) not in self._axes:
            before, twist, k = len(self.tally.operations), axis(self.chain[a].s), a
            while k != e:
                twist, k = twist_before(self.chain[k], twist), self.chain[k].parent
            self._axes[a, e] = self.tally.plain(twist), len(self.tally.operations) - before
        return self._axes[a, e]

    def _change(self, d: int, e: int, f: int) -> int:
        """From frame e of the parent to frame f of joint d: columns on the way, axes beyond."""
        columns = sum(self.of_columns[k] for k in self.paths[d] if e < k <= f)
        if not self.christoffel:
            return columns
        beyond = [d] if e == f else [a for a in self.paths[d] if a > f]
        return columns + BOTH * (columns + sum(self._axis(a, f)[1] for a in beyond))
