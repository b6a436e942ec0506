"""Constant directions c of the configuration space along which nothing changes (Noether): screws, gears, joint moves.

With constant c^e the metric is the same along c where L_c g = c^e d_e g_ab = 0, and the power of the forces on c is
zero where c^e Q_e = 0; closures and velocity constraints allow c where c^e G_ke = 0. Then c^a g_ab q'^b is constant.
These are linear dependencies between the columns e of the functions

    d_e g_ab = Gamma_abe + Gamma_bae,        Q_e,        G_ke

found exactly by :mod:`substructures.analysis.equations.dependencies`; the c^e are formulas in the parameters.
"""

from __future__ import annotations

from collections.abc import Callable, Collection, Iterator, Mapping, Sequence
from contextlib import suppress
from dataclasses import dataclass, replace
from functools import cached_property, partial
from itertools import chain
from typing import TypeVar

import numpy as np

from substructures.analysis.equations.dependencies import Dependencies, Functions, dependencies
from substructures.analysis.equations.formulas import ModelFormulas
from substructures.errors import TooLarge
from substructures.expr.calculus.corners import corners
from substructures.expr.differentiate import gradient
from substructures.expr.graph import Expr, Graph
from substructures.expr.interpret import interpret
from substructures.expr.program import Entries, Formulas, Program, program
from substructures.expr.replay import replay
from substructures.expr.rings.expand import Expanded, expand
from substructures.expr.rings.generators import times_power
from substructures.expr.rings.modular import Field, NoSquareRoot
from substructures.expr.walk import transfer
from substructures.quantities.numbers.field_state import FieldState

X = TypeVar("X", int, Expr)

#: operations of the functions whose dependencies are looked for
LIMIT = 50_000
#: states at which a direction has to be free before it is looked for exactly, and how free
STATES, FREE = 6, 1e-9
#: random points that are tried, and fields
TRIALS, FIELDS = 64, 32
#: terms of a coefficient that is written in its canonical form
READABLE = 50


@dataclass(frozen=True)
class Direction:
    """A constant direction: c^a by coordinate index, formulas in the parameters in a graph of their own, so that none
    is written in the coordinates of an equal formula.
    """

    components: Mapping[int, Expr]

    def of(self, values: Mapping[int, Expr] | Sequence[Expr], graph: Graph) -> Expr:
        """c^a x_a in another graph; what is not given is zero."""
        known = range(len(values)) if isinstance(values, Sequence) else values
        acting = [a for a in self.components if a in known]
        c = transfer([self.components[a] for a in acting], graph, {})
        return graph.sum(x * values[a] for x, a in zip(c, acting, strict=True))


def varied(f: ModelFormulas, vanishes: Callable[[Expr], bool]) -> set[int]:
    """The coordinates on which the metric, what holds the motion, or drives depend."""
    # d_c g_ab, dphi_k/dq^c = G_kc or B_kc, and derivatives of what motions are given: one that is not 0 is enough
    by = [(index[-1], x) for some in (f.metric_slopes, f.constraint_rows) for index, x in some.items()]
    by += [pair for row in gradient(f.drives, f.model.coordinates) for pair in enumerate(row)]
    return {c for c in range(f.n) if any(e == c and not vanishes(x) for e, x in by)}


def directions(
    f: ModelFormulas,
    moving: Collection[int],
    cyclic: Collection[int],
    vanishes: Callable[[Expr], bool],
    state: FieldState | None,
) -> list[Direction]:
    """All that are not along one coordinate; ``moving``: coordinates that the metric varies with, ``cyclic``: those
    that are directions by themselves; ``state``: one of a field that tells all. None are found where the functions take
    too long, or their values are not known.
    """
    left = [e for e in range(f.n) if e not in cyclic]
    if len(left) < 2:
        return []
    search = _Search(f, moving)
    with suppress(TooLarge, ArithmeticError):
        if state is not None:
            return _free(dependencies(search.in_field(state))) if len(state.bending.needed) <= LIMIT else []
        if len(search.program) > LIMIT or not search.may_be_free(left):
            return []
        # c^e F_e = 0 in all rows proves it
        found = _free(dependencies(search.functions()))
        return [c for c in found if all(vanishes(c.of(row, f.graph)) for row in search.rows)]
    return []


def _free(found: Dependencies) -> list[Direction]:
    """The directions along which functions that depend on each other do not change."""
    return [direction_of(j, coefficients) for j, coefficients in found.others.items() if coefficients]


def _rows(
    slopes: Mapping[tuple[int, int, int], X], forces: Mapping[int, X], constraints: Mapping[tuple[int, ...], X]
) -> list[dict[int, X]]:
    """Functions that depend on each other where there is a symmetry: by row and by column e."""
    rows: dict[tuple[object, ...], dict[int, X]] = {}
    for (a, b, e), x in slopes.items():
        rows.setdefault(("metric", a, b), {})[e] = x
    if forces:
        rows["forces",] = dict(forces)
    for (k, e), x in constraints.items():
        rows.setdefault(("constraint", k), {})[e] = x
    return list(rows.values())


def direction_of(j: int, coefficients: Mapping[int, Expr], most: int = READABLE) -> Direction:
    """F_j = sum c_b F_b: one unit along j and -c_b along every b, times what the c_b divide by.

    A parameter that is zero must not make the direction infinite. ``most``: terms of a canonical form.
    """
    graph = Graph()
    simple = {b: _readable(c, graph, most) for b, c in sorted(coefficients.items())}
    divisor = graph.one
    for c in simple.values():
        # of c = n/d in lowest terms, with what other components divide by already put in
        divisor = divisor * _denominator(c * divisor, most)
    components = {b: -c for b, c in simple.items()} | {j: graph.one}
    own = Graph()
    return Direction({a: _readable(c * divisor, own, most) for a, c in components.items()})


def _denominator(x: Expr, most: int) -> Expr:
    """What the canonical form of a formula divides by; 1 where that is too large."""
    form = _form(x, most)
    if form is None:
        return x.graph.one
    powers: dict[Expr, int] = {}
    for term in form.terms:
        for atom, n in term.powers:
            powers[atom] = max(powers.get(atom, 0), -n)
    result = Expanded(form.denominator).to_expr(x.graph) if form.denominator else x.graph.one
    for atom, n in powers.items():
        result = times_power(result, atom, n)
    return result


def _readable(x: Expr, graph: Graph, most: int) -> Expr:
    """The canonical form where it is small, in another graph (in its own it would be the node it came from)."""
    form = _form(x, most)
    return transfer([x], graph, {})[0] if form is None else form.to_expr(graph)


def _form(x: Expr, most: int) -> Expanded | None:
    """The canonical form, without cosines and sines that numerator and denominator share; None if it is too large."""
    try:
        form = expand(x, most)
        for trig, angle in {(t.trig, t.angle) for t in form.denominator if t.trig}:
            # n = c d with c free of the angle: c is the ratio of what multiplies the same cosine or sine
            over, under = (
                Expanded(tuple(replace(t, trig="", angle=()) for t in some if (t.trig, t.angle) == (trig, angle)))
                for some in (form.terms, form.denominator)
            )
            graph = Graph()
            ratio = over.to_expr(graph) / under.to_expr(graph)
            # fingerprints of all graphs are values at one point
            if ratio.fp == x.fp:
                return expand(ratio, most)
    except TooLarge:
        return None
    return form


class _Search:
    """The functions as a program, and their values: floats, elements of a field, formulas at exact points."""

    def __init__(self, f: ModelFormulas, moving: Collection[int]) -> None:
        self.f, self.moving = f, moving

    @cached_property
    def rows(self) -> list[dict[int, Expr]]:
        """As formulas."""
        slopes = {index: x for index, x in self.f.metric_slopes.items() if index[2] in self.moving}
        forces = {e: x for e, x in enumerate(self.f.vector("forces")) if not x.is_zero}
        return _rows(slopes, forces, self.f.constraint_rows)

    @cached_property
    def program(self) -> Program:
        """All rows."""
        entries: Entries = {(r, e): x for r, row in enumerate(self.rows) for e, x in row.items()}
        return program(self.f.graph, {"rows": Formulas((len(self.rows), self.f.n), entries)}, self.f.symbols)

    @cached_property
    def fixed(self) -> list[str]:
        """Symbols that are the same in all states."""
        return [s.name for s in self.program.symbols if s.kind == "parameter"]

    @cached_property
    def varied(self) -> list[str]:
        """Whatever varies along a motion counts as a coordinate here."""
        return [s.name for s in self.program.symbols if s.kind != "parameter"]

    def may_be_free(self, left: Sequence[int]) -> bool:
        """Whether floats leave a direction among these columns free, or cannot tell."""
        rng = np.random.default_rng(0)
        values = {name: rng.uniform(0.5, 1.5) for name in self.fixed}
        more = {name: rng.uniform(-2, 2, STATES) for name in self.varied}
        rows = interpret(self.program, values | more | {"_batch": np.zeros(STATES)}, ["rows"])["rows"]
        stacked = rows[..., left].reshape(-1, len(left))
        if not np.isfinite(stacked).all():
            # a corner |x| has two sides, and a field none: floats may rule a direction out, nothing proves it
            return not corners(x for row in self.rows for x in row.values())
        # columns of one size, so that units do not matter
        sizes = np.abs(stacked).max(axis=0, initial=0)
        singular = np.linalg.svd(stacked / np.where(sizes > 0, sizes, 1), compute_uv=False)
        return len(singular) < len(left) or bool(singular[-1] <= FREE * singular[0])

    def in_field(self, state: FieldState) -> Functions:
        """For the exact search, from states of a field that tells all; formulas are made where it needs them."""
        states = chain([state], iter(state.another, None))
        samples = (_rows(some.slopes, some.forces, {}) for some in states)
        needed = {x for name in ("christoffel", "forces") for x in self.f.model.program.needs([name])}
        return self._functions(sorted(needed - {*state.fixed} - self.f.zero), state.field, samples, state.fixed)

    def functions(self) -> Functions:
        """For the exact search, in a field that holds the square roots of the parameters. Raises TooLarge."""
        for _ in range(FIELDS):
            field = Field([self.program])
            symbols = {name: field.draw() for name in self.fixed}
            with suppress(TooLarge):
                sample = partial(self._random, field, symbols)
                return self._functions(self.varied, field, chain([sample()], iter(sample, None)), symbols)
        raise TooLarge("the search for a field with all square roots (in primes)", FIELDS + 1, FIELDS)

    def _functions(
        self, varied: Sequence[str], field: Field, samples: Iterator[list[dict[int, int]]], symbols: Mapping[str, int]
    ) -> Functions:
        """Of the symbols that vary; exact samples are formulas."""
        angles = {
            name for name, joint in zip(self.f.model.coordinates, self.f.model.joints, strict=True) if joint == "R"
        }
        angular = [name in angles for name in varied]
        return Functions(self.f.n, angular, field, partial(next, samples), partial(self._exact, varied), symbols)

    def _random(self, field: Field, symbols: Mapping[str, int]) -> list[dict[int, int]]:
        """Values at a random point of the field, one that has the square roots there are. Raises TooLarge."""
        for _ in range(TRIALS):
            with suppress(NoSquareRoot, ZeroDivisionError):
                point = {name: field.draw() for name in self.varied}
                found = field.evaluate(self.program, {**symbols, **point}, "rows")
                return self._by_row(found)
        raise TooLarge("the search for a point with all square roots (in points)", TRIALS + 1, TRIALS)

    def _exact(self, varied: Sequence[str], graph: Graph, point: Sequence[Expr]) -> list[dict[int, Expr]]:
        """Formulas in the parameters at an exact point; nothing where they divide by zero there."""
        try:
            found = replay(self.program, graph, dict(zip(varied, point, strict=True)), ["rows"])["rows"].entries
        except (ZeroDivisionError, ValueError):
            return []
        return self._by_row({i: graph.lift(x) for i, x in found.items()})

    def _by_row(self, found: Mapping[tuple[int, ...], X]) -> list[dict[int, X]]:
        rows: list[dict[int, X]] = [{} for _ in self.rows]
        for (r, e), x in found.items():
            rows[r][e] = x
        return rows
