"""Constant directions c of the configuration space along which nothing changes (Noether): screws, gears, joint moves.

With constant c^e the metric is the same along c where L_c g = c^e d_e g_ab = 0, and the power of the forces on c is
zero where c^e Q_e = 0; closures and velocity constraints allow c where c^e G_ke = 0. Then c^a g_ab q'^b is constant.
These are linear dependencies between the columns e of the functions

    d_e g_ab = Gamma_abe + Gamma_bae,        Q_e,        G_ke

found exactly by :mod:`substructures.analysis.equations.dependencies`; the c^e are formulas in the parameters.
"""

from __future__ import annotations

from collections.abc import Callable, Collection, Mapping, Sequence
from contextlib import suppress
from dataclasses import dataclass, replace
from functools import cached_property, partial
from itertools import chain
from typing import TypeVar

import numpy as np

from substructures.analysis.equations.dependencies import Functions, dependencies
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
    slopes: Mapping[tuple[int, int, int], Expr],
    cyclic: Collection[int],
    vanishes: Callable[[Expr], bool],
) -> list[Direction]:
    """All that are not along one coordinate; ``slopes``: d_e g_ab by (a, b, e) for a <= b, ``cyclic``: coordinates that
    are directions by themselves. None are found where the functions take too long, or their values are not known.
    """
    rows = _rows(f, slopes)
    left = [e for e in range(f.n) if e not in cyclic]
    if len(left) < 2 or not rows:
        return []
    search = _Search(f, rows)
    if len(search.program) > LIMIT or not search.may_be_free(left):
        return []
    with suppress(TooLarge, ArithmeticError):
        found = dependencies(search.functions())
        candidates = [direction_of(j, coefficients) for j, coefficients in found.others.items() if coefficients]
        # c^e F_e = 0 in all rows proves it
        return [c for c in candidates if all(vanishes(c.of(row, f.graph)) for row in rows)]
    return []


def _rows(f: ModelFormulas, slopes: Mapping[tuple[int, int, int], Expr]) -> list[dict[int, Expr]]:
    """Functions that depend on each other where there is a symmetry: by row and by column e."""
    rows: dict[tuple[object, ...], dict[int, Expr]] = {}
    for (a, b, e), x in slopes.items():
        rows.setdefault(("metric", a, b), {})[e] = x
    forces = {e: x for e, x in enumerate(f.vector("forces")) if not x.is_zero}
    if forces:
        rows["forces",] = forces
    for (k, e), x in f.constraint_rows.items():
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

    def __init__(self, f: ModelFormulas, rows: Sequence[Mapping[int, Expr]]) -> None:
        entries: Entries = {(r, e): x for r, row in enumerate(rows) for e, x in row.items()}
        self.f, self.rows, self.size = f, rows, (len(rows), f.n)
        self.program: Program = program(f.graph, {"rows": Formulas(self.size, entries)}, f.symbols)
        # whatever varies along a motion counts as a coordinate here
        self.fixed = [s.name for s in self.program.symbols if s.kind == "parameter"]
        self.varied = [s.name for s in self.program.symbols if s.kind != "parameter"]

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

    def functions(self) -> Functions:
        """For the exact search, in a field that holds the square roots of the parameters. Raises TooLarge."""
        angular = [name in self._angles for name in self.varied]
        for _ in range(FIELDS):
            field = Field([self.program])
            symbols = {name: field.draw() for name in self.fixed}
            with suppress(TooLarge):
                sample = partial(self._random, field, symbols)
                samples = chain([sample()], iter(sample, None))
                return Functions(self.f.n, angular, field, partial(next, samples), self._exact, symbols)
        raise TooLarge("the search for a field with all square roots (in primes)", FIELDS + 1, FIELDS)

    @cached_property
    def _angles(self) -> set[str]:
        names = self.f.model.coordinates
        return {name for name, joint in zip(names, self.f.model.joints, strict=True) if joint == "R"}

    def _random(self, field: Field, symbols: Mapping[str, int]) -> list[dict[int, int]]:
        """Values at a random point of the field, one that has the square roots there are. Raises TooLarge."""
        for _ in range(TRIALS):
            with suppress(NoSquareRoot, ZeroDivisionError):
                point = {name: field.draw() for name in self.varied}
                found = field.evaluate(self.program, {**symbols, **point}, "rows")
                return self._by_row(found)
        raise TooLarge("the search for a point with all square roots (in points)", TRIALS + 1, TRIALS)

    def _exact(self, graph: Graph, point: Sequence[Expr]) -> list[dict[int, Expr]]:
        """Formulas in the parameters at an exact point; nothing where they divide by zero there."""
        try:
            found = replay(self.program, graph, dict(zip(self.varied, point, strict=True)), ["rows"])["rows"].entries
        except (ZeroDivisionError, ValueError):
            return []
        return self._by_row({i: graph.lift(x) for i, x in found.items()})

    def _by_row(self, found: Mapping[tuple[int, ...], X]) -> list[dict[int, X]]:
        rows: list[dict[int, X]] = [{} for _ in range(self.size[0])]
        for (r, e), x in found.items():
            rows[r][e] = x
        return rows
