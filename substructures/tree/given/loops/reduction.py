"""Dependent coordinates of a part as functions of its independent ones.

In closed form those of the planar four-bar family: one closure after the other may leave three motions unknown
(:mod:`.triangle`), until all coordinates but the independent ones y are known. What is left is met together, by steps
(:mod:`.newton`). With phi = 0 what a closure demands, z its unknown coordinates,

    q' = N y'           N_z = -phi_z^-1 phi_other N_other
    q'' = N y'' + H y' y'     H_z = -phi_z^-1 (phi_other H_other + phi_ab N_a N_b)
"""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from functools import lru_cache
from itertools import combinations_with_replacement
from typing import Any

from substructures.expr.differentiate import gradient
from substructures.expr.graph import Expr, Graph
from substructures.expr.interpret import interpret
from substructures.expr.known import Known
from substructures.expr.operations import Symbol
from substructures.expr.program import array, program
from substructures.expr.trigonometry import cos, sin
from substructures.expr.walk import symbols_in
from substructures.loads.scope import Scope, no_names
from substructures.part.definition import PartClosure
from substructures.part.frames import constant, cut_frames
from substructures.part.outputs import over_formulas
from substructures.part.part import Part
from substructures.tree.given.loops.dependent import Dependent, NotReduced, Sum
from substructures.tree.given.loops.linear import solver
from substructures.tree.given.loops.newton import Group, Newton, Rows, Sample, groups_of, require_consistent, rows_of
from substructures.tree.given.loops.planar import Chains, Loop, loop_of
from substructures.tree.given.loops.triangle import Complex, Solution, solutions, times

#: relative difference of distances from the start that tells no branch
SAME = 1e-6
#: relative difference of two positions that is none: S = sqrt(S^2), of which rounding leaves the root of 1e-16
MEETING = 1e-7


def dependent(part: Part) -> Dependent | str:
    """What coordinates of a part depend on, where it names independent ones; or why there are no formulas of it.

    >>> from substructures import derive
    >>> dependent(derive("delta-robot")).loops
    {('bars1', 'bars2', 'bars3'): ('x', 'y', 'z')}
    """
    return _dependent(Known(f"{part.definition.digest} {part.program.digest}", part))


@lru_cache(maxsize=256)
def _dependent(known: Known) -> Dependent | str:
    try:
        return _Solver(known.source).solve()
    except NotReduced as why:
        return str(why)
    except (ZeroDivisionError, ValueError):
        return "its loops cannot be closed, or are singular, in every position"


class _Solver:
    """Closures of a part, one after the other."""

    def __init__(self, part: Part) -> None:
        self.part, self.definition, self.graph = part, part.definition, Graph()
        run = over_formulas(self.graph)
        self.chains = Chains(self.graph, part, run(part, {}, tuple(part.program.outputs)))
        self.found = Dependent(self.graph, tuple(q for q in part.coordinates if q in self.definition.independent))
        one = self.graph.one
        self.found.N = {q: {q: one} for q in self.found.independent}
        self.found.H = {q: {} for q in self.found.independent}
        self.start = {q: self._constant(x) for q, x in self.definition.start.items()}
        self.numbers = {q: self.start.get(q, 0.0) for q in self.found.independent}
        self.numbers |= {
            # branches are told apart at numbers: 1 for what has no default
            name: 1.0 if p.value is None else self._constant(p.value)
            for name, p in self.definition.parameters.items()
        }

    def _constant(self, given: Any) -> float:
        return constant(Scope(Graph()).read(given, "", no_names))

    def solve(self) -> Dependent:
        """All of them. Raises NotReduced."""
        waiting, why = list(self.definition.closures), ""
        while waiting:
            for closure in waiting:
                try:
                    self._close(closure)
                except NotReduced as reason:
                    why = why or f"the closure '{closure.name}': {reason}"
                else:
                    # from the first one again: this one may bring an earlier one down to three unknown motions
                    waiting.remove(closure)
                    why = ""
                    break
            else:
                break
        if waiting and not self.definition.ranges:
            raise NotReduced(f"{why}; loops like that take the 'ranges' of the independent coordinates")
        for group in groups_of(map(self._group, waiting)):
            self._follow(group)
        left = [q for q in self.part.coordinates if q not in self.found.N]
        if left:
            raise NotReduced(f"no closure tells '{left[0]}' from the independent coordinates")
        return self.found

    def _group(self, closure: PartClosure) -> Group:
        """A closure that is not met by itself. Raises NotReduced for one that tells nothing."""
        cut = cut_frames(Scope(self.graph), closure, "", self.graph.symbol)
        ways, ends = self.chains.ways(closure.from_, closure.to, cut)
        A, B = (self.chains.pose(way, end) for way, end in zip(ways, ends, strict=True))
        rows = rows_of(self.graph, closure.type, cut, A, B)
        unknown = symbols_in(rows.zero) & ({*self.part.coordinates} - self.found.N.keys())
        if not unknown:
            raise NotReduced(f"the closure '{closure.name}': of the coordinates around it 0 are unknown")
        return Group((closure.name,), frozenset(unknown), rows.without_what_cancels(self.part.coordinates))

    def _follow(self, group: Group) -> None:
        """Closures that are met together, by Newton's method. Raises NotReduced."""
        found, rows = self.found, group.rows
        rows = Rows(tuple(found.put_in(rows.zero)), tuple(found.put_in(rows.scale)))
        z = tuple(q for q in self.part.coordinates if q in group.z)
        y = tuple(q for q in found.independent if q in symbols_in(rows.zero))
        scope = Scope(self.graph)
        start = {q: scope.read(self.definition.start.get(q, 0), "", no_names) for q in (*z, *y)}
        ranges = {q: (self._constant(low), self._constant(high)) for q, (low, high) in self.definition.ranges.items()}
        angles = frozenset(joint.coordinate for joint in self.part.topology.joints if not joint.s)
        loop = Newton(self.graph, rows, z, y, start, angles)
        try:
            sample = Sample(loop, self.numbers | {q: self.start.get(q, 0.0) for q in z}, ranges)
            found.branches.append(sample.steps())
            values = loop.values(found.branches[-1], sample.chosen)
            require_consistent(loop, values, self.numbers)
        except NotReduced as why:
            raise NotReduced(f"{', '.join(map(repr, group.closures))}: {why}") from None
        found.values |= values
        found.loops[group.closures] = z
        found.followed += group.closures
        self._move(z, group.rows.zero)

    def _close(self, closure: Any) -> None:
        """One more. Raises NotReduced."""
        scope = Scope(self.graph)
        cut = cut_frames(scope, closure, "", self.graph.symbol)
        loop = loop_of(self.chains, (closure.type, closure.from_, closure.to), cut, self.found.N)
        try:
            found = [self._known(loop, each) for each in solutions(loop.motions, loop.K, loop.known)]
        except (ZeroDivisionError, ValueError):
            raise NotReduced("points that have to be apart coincide") from None
        # chosen at numbers, the branch is that of all positions that are reached without a dead centre
        best = self._nearest([self._numbers(values) for values, _ in found])
        values, angles = found[best]
        self.found.branches.append(best)
        self.numbers |= self._numbers(values)
        self.found.values |= values
        self.found.angles |= angles
        self.found.loops[closure.name,] = tuple(values)
        self._move(tuple(values), loop.rows)
        for name in values:
            self._straighten(name, angles)

    def _straighten(self, name: str, angles: Mapping[Sum, Complex]) -> None:
        """An angle that is a sum of independent ones, with numbers, and of right angles, written so."""
        graph, N = self.graph, self.found.N[name]
        own = [(x[0], x[1] * sign) for sign in (1, -1) for known, x in angles.items() if known == {(name, sign)}]
        if not own or not all(n.is_number for n in N.values()):
            return
        along = graph.sum(graph.symbol(y) * n for y, n in N.items())
        for k in range(4):
            angle = along + graph.pi * k / 2
            if (cos(angle) - own[0][0]).is_zero and (sin(angle) - own[0][1]).is_zero:
                # from now on cos and sin of it are those of independent angles, without quotients and roots
                self.found.sums[name] = angle
                self.found.angles = {s: a for s, a in self.found.angles.items() if name not in dict(s)}

    def _known(self, loop: Loop, each: Solution) -> tuple[dict[str, Expr], dict[Sum, Complex]]:
        """Values and angles of the unknown coordinates of a loop, without dependent ones."""
        values, angles, unknown = dict[str, Expr](), dict[Sum, Complex](), loop.unknown
        for places, (c, s) in each.turns.items():
            if max(places) < len(unknown):
                # of the turns by sign * q: where the signs are -1, of the opposite sum
                names: Sum = frozenset((unknown[k].coordinate, unknown[k].sign) for k in places)
                angles[names] = self._written((c, s))
        for k, x in enumerate(unknown):
            if k in each.slides:
                values[x.coordinate] = self.found.put_in([each.slides[k] * x.sign])[0]
            else:
                values[x.coordinate] = self._angle(x.coordinate, x.sign, angles[frozenset(((x.coordinate, x.sign),))])
        return values, angles

    def _written(self, x: Complex) -> Complex:
        c, s = self.found.put_in(x)
        return c, s

    def _angle(self, name: str, sign: int, x: Complex) -> Expr:
        """Between -pi and pi of where it starts."""
        graph = self.graph
        at = Scope(graph).read(self.definition.start.get(name, 0), "", no_names)
        c, s = times((x[0], x[1] * sign), (cos(at), -sin(at)))
        # the jump of atan2 is half a turn away from the start
        return at + graph.function("atan2", s, c)

    def _numbers(self, values: Mapping[str, Expr]) -> dict[str, float]:
        """At the start of independent coordinates, with default values of parameters."""
        names = list(values)
        symbols = {name: Symbol(name, "parameter", "") for name in self.numbers}
        made = program(self.graph, {"v": array((len(names),), lambda i: values[names[i]])}, symbols)
        numbers = {symbol.name: self.numbers.get(symbol.name, 1.0) for symbol in made.symbols}
        return dict(zip(names, map(float, interpret(made, numbers)["v"]), strict=True))

    def _gap(self, position: Mapping[str, float]) -> float:
        """How far a position is from the start; nan where there is none."""
        return sum(abs(x - self.start.get(name, 0.0)) for name, x in position.items())

    def _nearest(self, positions: Sequence[Mapping[str, float]]) -> int:
        """Which one of one or two positions, nan where there is none, is nearest to the start. Raises NotReduced."""
        gaps = [self._gap(each) for each in positions]
        best = min(range(len(gaps)), key=lambda k: math.inf if math.isnan(gaps[k]) else gaps[k])
        if math.isnan(gaps[best]):
            raise NotReduced("it does not close at the start of the independent coordinates, at default values")
        if len(positions) > 1:
            if abs(gaps[0] - gaps[1]) < SAME * max(gaps):
                raise NotReduced("two positions are as near to the start as each other: give it near a closed one")
            # both branches go through it, and N has no value there: the start tells neither of them
            if _meet(*(list(each.values()) for each in positions)):
                raise NotReduced("its two positions meet at the start, a dead centre: give one away from it")
        return best

    def _move(self, z: Sequence[str], rows: Sequence[Expr]) -> None:
        """N and H of the unknown coordinates z of rows that are zero."""
        names = [*z, *self.found.N]
        N, H = self.found.N, self.found.H
        slopes = gradient(rows, names)
        bent = [gradient(row, names) for row in slopes]
        solve = solver([row[: len(z)] for row in slopes])
        graph, y = self.graph, self.found.independent

        def solved(columns: Sequence[Expr]) -> list[Expr]:
            """-phi_z^-1 x, as a number where it is one."""
            found = [-x for x in solve(columns)]
            # the ratio of bars that stay parallel is a number on closed positions alone: z(y) is put in to see it
            return [w if w.is_number else x for x, w in zip(found, self.found.put_in(found), strict=True)]

        others = list(enumerate(names))[len(z) :]
        for j in y:
            pushed = [graph.sum(row[k] * N[q][j] for k, q in others if j in N[q]) for row in slopes]
            for q, x in zip(z, solved(pushed), strict=True):
                N.setdefault(q, {}).update({} if x.is_zero else {j: x})
        # after all N: phi_ab N_a N_b runs over the unknown coordinates, too
        for j, k in combinations_with_replacement(y, 2):
            terms = []
            for row, bend in zip(slopes, bent, strict=True):
                along = [row[i] * H[q][j, k] for i, q in others if (j, k) in H[q]]
                along += [
                    bend[a][b] * N[p][j] * N[q][k]
                    for a, p in enumerate(names)
                    for b, q in enumerate(names)
                    if j in N[p] and k in N[q]
                ]
                terms.append(graph.sum(along))
            for q, x in zip(z, solved(terms), strict=True):
                H.setdefault(q, {}).update({} if x.is_zero else {(j, k): x})


def _meet(one: Sequence[float], other: Sequence[float]) -> bool:
    return sum(abs(x - y) for x, y in zip(one, other, strict=True)) <= MEETING * sum(map(abs, (*one, *other)))
