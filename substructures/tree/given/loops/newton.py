"""Loops of any kind: dependent coordinates z by Newton's method, step after step in the formulas.

Along the straight line from the start y_0 to y, with phi = 0 what the closures demand,

    z_k+1 = z_k - phi_z(z_k, y_k)^-1 phi(z_k, y_k)      y_k = y_0 + min(k/n, 1) (y - y_0)      k = 0 ... n + LAST

from z_0 = the start. n is the least power of two by which z is that of many more steps, within the ranges of y. There
is no number where the rows are not met, or where det phi_z has another sign than at the start, beyond a dead centre.
"""

from __future__ import annotations

import random
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from fractions import Fraction
from itertools import product
from typing import NamedTuple

import numpy as np
import scipy
from flint import arb, ctx
from numpy.typing import NDArray

from substructures.array import Array
from substructures.certificate.stored import operations_in_balls
from substructures.expr.differentiate import gradient
from substructures.expr.graph import Expr, Graph
from substructures.expr.interpret import interpret
from substructures.expr.operations import Symbol
from substructures.expr.program import array, program
from substructures.expr.walk import symbols_in, transfer
from substructures.mechanics.cut_joints import PLACE, ROWS, TURNS
from substructures.mechanics.kinematics import Pose
from substructures.mechanics.linear3 import IDENTITY, Vector, apply, dot, multiply, sub, transpose
from substructures.part.frames import CutFrames
from substructures.tree.given.loops.dependent import NotReduced
from substructures.tree.given.loops.linear import determinant, solver

#: steps at y itself; the most before; and those that positions are compared with
LAST, MOST, MANY = 5, 16, 64
#: sum of (row / its lengths)^2 before the last three steps, which square what is left of it each, and difference from
#: MANY steps, that are none
OPEN, SAME = Fraction(1, 10**10), 1e-10
#: rad^2, of all steps of angles: less than a turn at once
TURNED = 10
#: beside 1 it is less than all digits of floats
LITTLE = Fraction(1, 10**30)
#: random positions within the ranges, beside at most so many corners
PLACES, CORNERS = 100, 64
#: bits in which rows are met, and of those that count
EXACT, MET = 256, 80
Ranges = Mapping[str, tuple[float, float]]


class Rows(NamedTuple):
    """``zero``: what is zero where closures are closed; ``scale``: squares of the lengths of its terms."""

    zero: tuple[Expr, ...]
    scale: tuple[Expr, ...]

    def without_what_cancels(self, names: Iterable[str]) -> Rows:
        """At 0 of coordinates that move both ends alike."""
        graph, names = self.zero[0].graph, sorted(symbols_in(self.zero) & {*names})
        columns = zip(names, zip(*gradient(self.zero, names), strict=True), strict=True)
        zeros = {name: graph.zero for name, column in columns if all(x.is_zero for x in column)}
        return Rows(*(tuple(transfer(some, graph, zeros)) for some in self))


def rows_of(graph: Graph, type_: str, cut: CutFrames, A: Pose, B: Pose) -> Rows:
    """Of a closure between two frames, as seen from what carries both (notation.md, section 10)."""
    lift, gap, names = graph.lift, sub(B.r, A.r), ROWS[type_]
    if names == ("length",):
        L2 = cut.length * cut.length
        return Rows((lift(dot(gap, gap) - L2) / 2,), (L2 * L2,))
    # three rows of places: along the axes of the carrier as well as along those of A
    d: Vector = gap if set(PLACE) <= set(names) else apply(A.R, gap)
    axes, length2 = multiply(B.R, transpose(A.R)), lift(dot(A.r, A.r) + dot(B.r, B.r))
    found = [
        (lift(d[PLACE.index(name)]), length2)
        if name in PLACE
        else (lift(dot(axes[TURNS[name][0]], IDENTITY[TURNS[name][1]])), graph.one)
        for name in names
    ]
    # a row that is zero in all positions tells nothing
    return Rows(tuple(x for x, _ in found if not x.is_zero), tuple(s for x, s in found if not x.is_zero))


class Group(NamedTuple):
    """Closures that are met together, by name, and their unknown coordinates."""

    closures: tuple[str, ...]
    z: frozenset[str]
    rows: Rows


def groups_of(every: Iterable[Group]) -> list[Group]:
    """Closures that have unknown coordinates in common, directly or by others, in one group."""
    found: list[Group] = []
    for group in every:
        linked = [each for each in found if each.z & group.z]
        found = [each for each in found if not each.z & group.z]
        some = [*linked, group]
        closures = tuple(name for each in some for name in each.closures)
        rows = Rows(*(tuple(x for each in some for x in each.rows[k]) for k in range(2)))
        found.append(Group(closures, frozenset().union(*(each.z for each in some)), rows))
    return found


@dataclass(frozen=True)
class Newton:
    """Closures that are met together; ``start``: of coordinates, ``y`` those beside ``z`` that they depend on.

    ``rows`` are formulas of z and of y, which are independent; ``angles``: those of z that turn.
    """

    graph: Graph
    rows: Rows
    z: tuple[str, ...]
    y: tuple[str, ...]
    start: Mapping[str, Expr]
    angles: frozenset[str]

    @property
    def terms(self) -> list[Expr]:
        """phi, the squares of its lengths, and phi_z."""
        slopes = gradient(self.rows.zero, self.z)
        return [*self.rows.zero, *self.rows.scale, *(x for row in slopes for x in row)]

    def values(self, n: int, chosen: Sequence[int]) -> dict[str, Expr]:
        """z by n steps; ``chosen``: rows of which det phi_z is taken."""
        graph, terms, m = self.graph, self.terms, len(self.rows.zero)
        z, first, open_, turns = [self.start[q] for q in self.z], graph.one, graph.zero, list[Expr]()
        for k in range(n + LAST + 1):
            share = graph.number(min(k, n)) / n
            at = {q: self.start[q] + (graph.symbol(q) - self.start[q]) * share for q in self.y}
            found = transfer(terms, graph, at | dict(zip(self.z, z, strict=True)))
            phi, scale = found[:m], found[m : 2 * m]
            slopes = [found[k : k + len(z)] for k in range(2 * m, len(found), len(z))]
            first = determinant([slopes[i] for i in chosen]) if k == 0 else first
            steps = solver(slopes, again=False)(phi)
            turns += [dx * dx for q, dx in zip(self.z, steps, strict=True) if q in self.angles]
            z = [x - dx for x, dx in zip(z, steps, strict=True)]
            if k == n + LAST - 2:
                open_ = graph.sum(x * x / s for x, s in zip(phi, scale, strict=True))
        side = determinant([slopes[i] for i in chosen]) / first
        # nothing beside 1 where all roots are numbers, and smooth
        roots = [graph.sqrt(x) for x in (1 - open_ / OPEN, side, 1 - graph.sum(turns) / TURNED)]
        is_there = 1 + LITTLE * graph.sum(roots)
        return {q: x * is_there for q, x in zip(self.z, z, strict=True)}


def require_consistent(loop: Newton, values: Mapping[str, Expr], numbers: Mapping[str, float]) -> None:
    """Raises NotReduced where rows, more than unknown coordinates, are met together to the digits of numbers alone."""
    if len(loop.rows.zero) == len(loop.z):
        return
    zero = transfer(loop.rows.zero, loop.graph, values)
    symbols = {name: Symbol(name, "parameter", "") for name in symbols_in(zero)}
    made = program(loop.graph, {"x": array((len(zero),), lambda i: zero[i])}, symbols)
    with ctx.workprec(EXACT):
        found = operations_in_balls(made, {name: arb(numbers[name]) for name in symbols})
        if any(bool(found[entry].abs_upper() > arb(2) ** -MET) for entry in made.outputs["x"].entries):
            message = "rows, more than unknown coordinates, are met to the digits of numbers alone"
            raise NotReduced(f"{message}: give formulas of these")


class Sample:
    """Closures at positions within the ranges of what they depend on, in numbers: of parameters, and of the start."""

    def __init__(self, loop: Newton, numbers: Mapping[str, float], ranges: Ranges) -> None:
        terms = loop.terms
        names = symbols_in(terms)
        symbols = {name: Symbol(name, "parameter", "") for name in names}
        self.program = program(loop.graph, {"x": array((len(terms),), lambda i: terms[i])}, symbols)
        self.loop, self.numbers = loop, {name: x for name, x in numbers.items() if name in names}
        self.begin = np.array([numbers[q] for q in loop.y])
        self.first = np.array([numbers[q] for q in loop.z])
        if missing := [q for q in loop.y if q not in ranges]:
            raise NotReduced(f"its positions depend on '{missing[0]}', which has no 'ranges'")
        ends, source = [ranges[q] for q in loop.y], random.Random(0)  # noqa: S311 -- the same for everybody
        corners = list(product(*ends)) if 2 ** len(ends) <= CORNERS else []
        self.places = np.array([*corners, *([source.uniform(*each) for each in ends] for _ in range(PLACES))])
        slopes = self._at(self.first[None], self.begin[None])[2][0]
        _, r, order = scipy.linalg.qr(slopes.T, pivoting=True)
        sizes = np.abs(np.diag(r))
        if len(sizes) < len(loop.z) or sizes.min() <= 1e-9 * sizes.max():
            raise NotReduced("it does not tell the coordinates that are unknown, near the start")
        self.chosen = sorted(int(k) for k in order[: len(loop.z)])

    def steps(self) -> int:
        """The least n. Raises NotReduced, which names a position."""
        wanted, is_right = self.moved(MANY)
        if not is_right.all():
            wrong = self.places[~is_right]
            nearest = wrong[np.abs(wrong - self.begin).sum(axis=1).argmin()]
            at = ", ".join(f"{q} = {x:.6g}" for q, x in zip(self.loop.y, nearest, strict=True))
            raise NotReduced(f"within the ranges it is open, or beyond a dead centre, at {at}")
        for n in (1, 2, 4, 8, MOST):
            z, is_right = self.moved(n)
            if is_right.all() and np.abs(z - wanted).max() < SAME * (1 + np.abs(wanted).max()):
                return n
        raise NotReduced(f"within the ranges it takes more than {MOST} steps from the start: give narrower ones")

    def moved(self, n: int) -> tuple[Array, NDArray[np.bool_]]:
        """z by n steps, and whether it is closed then, and on the side of the start on the whole way."""
        z, is_right = np.tile(self.first, (len(self.places), 1)), np.ones(len(self.places), dtype=bool)
        first, turns = is_right.astype(np.float64), np.zeros(len(z))
        angles, open_ = [q in self.loop.angles for q in self.loop.z], np.zeros(len(z))
        with np.errstate(all="ignore"):
            for k in range(n + LAST + 1):
                phi, scale, slopes = self._at(z, self.begin + min(k / n, 1) * (self.places - self.begin))
                side = np.linalg.det(slopes[:, self.chosen])
                first = first if k else side
                is_right &= side * first > 0
                step = np.einsum("snm,sm->sn", np.linalg.pinv(np.nan_to_num(slopes)), phi)
                z, turns = z - step, turns + (step[:, angles] ** 2).sum(axis=1)
                open_ = (phi**2 / scale).sum(axis=1) if k == n + LAST - 2 else open_
            return z, is_right & (open_ < float(OPEN)) & (turns < TURNED)

    def _at(self, z: Array, y: Array) -> tuple[Array, Array, Array]:
        """phi, the squares of its lengths, and phi_z at positions."""
        moving = dict(zip((*self.loop.z, *self.loop.y), (*z.T, *y.T), strict=True))
        found = interpret(self.program, self.numbers | moving)["x"]
        m, n = len(self.loop.rows.zero), len(self.loop.z)
        phi, scale, slopes = np.split(np.broadcast_to(found, (len(z), found.shape[-1])), [m, 2 * m], axis=1)
        return phi, scale, slopes.reshape(-1, m, n)
