"""Cyclic coordinates that a tree ignores at constant momenta: Routh's reduced system (notation.md, section 13).

With c the ignored coordinates, a, b, d those that are left, and the momenta p_c that are given,

    q'^c = K^c_a q'^a + w^c     K = -g_cc^-1 g_ca     w = g_cc^-1 p     q' = P q'_a + w,  P = (1, K)

the outputs of all coordinates become those of the ones that are left, x*_a = P_ia x_i along every axis of coordinates,
at these velocities; P^T g has no entry at c, so that accelerations of c and derivatives of P drop out. Routh's function
R = T - V - p_c q'^c has the form of T - V with given motions, and so have its equations:

    R = 1/2 g*_ab q'^a q'^b + g_a0 q'^a + 1/2 g_00 - V        g_a0 = w^c g_ca        g_00 = -p_c w^c
    g*_ab q''^b + Gamma*_abd q'^b q'^d + 2 Gamma_ab0 q'^b + Gamma_a00 = Q*_a
    Gamma_ab0 = P_ia P_jb w^c Gamma_ijc     Gamma_a00 = P_ia w^c w^d Gamma_icd

2 Gamma_ab0 is skew (gyroscopic forces), Gamma_a00 the gradient of 1/2 p g_cc^-1 p, which the amended potential adds to
V. ``T_2``, ``T_1``, ``T_0`` are the terms of R + V, the kinetic energy is T_2 - T_0, and ``ignored_rates`` are q'^c.
Positions, and whatever else depends on q^c, are those of q^c = 0: relative to what moves with them.
(E. J. Routh, Stability of a given state of motion, 1877; J. E. Marsden, Lectures on mechanics, 1992, chapter 3.)
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from typing import Any

from substructures.documents import escape
from substructures.errors import InvalidDocument, among, listed
from substructures.expr.calculus.corners import VanishingOnAllSides
from substructures.expr.differentiate import directional, gradient
from substructures.expr.graph import Expr, Graph
from substructures.expr.program import Formulas, array
from substructures.expr.walk import reachable, transfer
from substructures.mechanics.factorisation import Factors, factorised
from substructures.part.relations import OF_COORDINATES
from substructures.tree.assembly import Assembly
from substructures.tree.given.projection import Column, Entries, Projection

#: what may not be of a coordinate that is ignored, or depend on it
FRICTION = ("friction", "friction_load")
EQUATIONS = ("metric", "christoffel", "forces", "bias", "potential_energy", "friction")
#: what changes where the motion is known but for the coordinates that are left
MOTIONS = {"linear_momentum": 0, "angular_momentum": 0, "U": 1, "Omega": 1}


def ignored_names(assembly: Assembly, names: Iterable[str]) -> tuple[str, ...]:
    """Those whose momentum is given; ``names``: of all coordinates, in order."""
    return tuple(name for name in names if name in assembly.reading.spec.ignored)


def ignore(assembly: Assembly, names: Sequence[str], outputs: Mapping[str, Formulas]) -> dict[str, Formulas]:
    """Outputs of all coordinates, with these ``names``, as those of the ones that are left.

    Raises InvalidDocument (``/ignored/name``) for unknown coordinates, for those that are not cyclic or have no
    inertia, for momenta that cannot be read; and where the tree has given motions, closures or velocity constraints.
    """
    momenta = _momenta(assembly, names)
    if not momenta:
        return dict(outputs)
    at_rest = _at_rest(assembly, names, outputs, list(momenta))
    reduction = _Reduction(assembly.scope.graph, names, momenta, at_rest)
    return reduction.outputs()


def at_momenta(
    assembly: Assembly, names: Sequence[str], outputs: Mapping[str, Formulas], whole: Mapping[str, Formulas]
) -> dict[str, Formulas]:
    """Outputs without axes of coordinates, where ignored coordinates are 0, at their velocities and at accelerations
    q''^c, the derivatives of these by time. ``whole``: the equations of all coordinates. Raises as :func:`ignore`.
    """
    graph, momenta = assembly.scope.graph, _momenta(assembly, names)
    reduction = _Reduction(graph, names, momenta, _at_rest(assembly, names, whole, list(momenta)))
    seeds: dict[str, Expr] = {}
    for a, rate in zip(reduction.rest, reduction.rates, strict=True):
        seeds |= {names[a]: rate, f"{names[a]}'": graph.symbol(f"{names[a]}''")}
    values = {f"{prefix}{name}": graph.zero for name in momenta for prefix in ("tau.", "")}
    # q''^c = d/dt (K q'_a + w): along q' in positions and q'' in rates; no q^c is in it, and p is constant
    for k, second in enumerate(directional(reduction.moving, seeds)):
        name = list(momenta)[k]
        values |= {f"{name}'": reduction.moving[k], f"{name}''": second}
    return _substituted(graph, outputs, values)


def at_zero(assembly: Assembly, outputs: Mapping[str, Formulas]) -> dict[str, Formulas]:
    """Outputs where ignored coordinates are 0, without those that depend on their rates."""
    names = assembly.reading.spec.ignored
    if not names:
        return dict(outputs)
    unknown = {f"{name}{primes}" for name in names for primes in ("'", "''")}
    found = _substituted(assembly.scope.graph, outputs, dict.fromkeys(names, assembly.scope.graph.zero))
    return {name: x for name, x in found.items() if not unknown & _symbols(x.entries.values())}


def _momenta(assembly: Assembly, names: Sequence[str]) -> dict[str, Expr]:
    """p_c by name."""
    reading, scope, spec = assembly.reading, assembly.scope, assembly.reading.spec
    for name in sorted(spec.ignored.keys() - set(names)):
        message = f"there is no coordinate '{name}'{among(name, names)}"
        scope.fault(f"/ignored/{escape(name)}", "unknown-coordinate", message)
    others = {"driven": spec.driven, "closures": assembly.cuts, "velocity_constraints": spec.velocity_constraints}
    others |= {"contacts": spec.contacts}
    for field, given in others.items():
        if spec.ignored and given:
            message = f"'ignored' and '{field}' do not go together: leave one of them out"
            scope.fault("/ignored", "not-supported", message)
    found = {
        name: scope.read(spec.ignored[name], f"/ignored/{escape(name)}", reading.parameter)
        for name in ignored_names(assembly, names)
    }
    scope.finish()
    return found


def _at_rest(
    assembly: Assembly, names: Sequence[str], outputs: Mapping[str, Formulas], cyclic: Sequence[str]
) -> dict[str, Formulas]:
    """The outputs without actuators and accelerations of cyclic coordinates, where these are 0. Raises InvalidDocument
    for coordinates that are not cyclic.
    """
    graph = assembly.scope.graph
    still = {f"{prefix}{name}{mark}": graph.zero for name in cyclic for prefix, mark in (("tau.", ""), ("", "''"))}
    # q^c is still a symbol here: that nothing depends on it is what has to be shown before it is 0
    moving = _substituted(graph, outputs, still)
    vanishes = VanishingOnAllSides(graph)
    for name in cyclic:
        why = _not_cyclic(moving, names, name, vanishes)
        if why:
            message = f"'{name}' is not cyclic, so that its momentum is not constant: {why}"
            assembly.scope.fault(f"/ignored/{escape(name)}", "not-cyclic", message)
    assembly.scope.finish()
    return _substituted(graph, moving, dict.fromkeys(cyclic, graph.zero))


def _not_cyclic(outputs: Mapping[str, Formulas], names: Sequence[str], name: str, vanishes: VanishingOnAllSides) -> str:
    """Why a coordinate is not cyclic; empty where it is."""
    c = names.index(name)
    if any(index[0] == c for law in FRICTION if law in outputs for index in outputs[law].entries):
        return "its joint has dry friction"
    force = outputs["forces"].entries.get((c,), 0)
    if isinstance(force, Expr) and not vanishes(force):
        by = listed(sorted(_symbols([force])))
        return f"a force acts on it, {f'which depends on {by}' if by else 'a constant one'}"
    for output in EQUATIONS:
        if output in outputs:
            some = [x for x in outputs[output].entries.values() if isinstance(x, Expr)]
            slopes = (row[0] for row in gradient([x for x in some if name in _symbols([x])], [name]))
            if not all(map(vanishes, slopes)):
                return f"'{output}' depends on it"
    return ""


def _symbols(exprs: Iterable[Any]) -> set[str]:
    found = reachable([x for x in exprs if isinstance(x, Expr)])
    return {str(node.value) for node in found if node.op == "sym"}


def _substituted(graph: Graph, outputs: Mapping[str, Formulas], values: Mapping[str, Expr]) -> dict[str, Formulas]:
    roots = [graph.lift(x) for each in outputs.values() for x in each.entries.values()]
    found = iter(transfer(roots, graph, dict(values)))
    return {
        name: Formulas(each.shape, {i: next(found) for i in each.entries}, each.symmetry)
        for name, each in outputs.items()
    }


class _Reduction:
    """P, w and what is formed with them; ``outputs``: of all coordinates, where the ignored ones are 0."""

    def __init__(
        self, graph: Graph, names: Sequence[str], momenta: Mapping[str, Expr], outputs: Mapping[str, Formulas]
    ) -> None:
        self.graph, self.p, zero = graph, list(momenta.values()), graph.zero
        cyclic = [names.index(name) for name in momenta]
        self.rest = [a for a in range(len(names)) if a not in cyclic]
        self.rates = [graph.symbol(f"{names[a]}'") for a in self.rest]
        self.g: Entries = dict(outputs["metric"].expanded())
        factors = _factors(names, cyclic, self.g)
        self.w = dict(zip(cyclic, factors.solve(self.p), strict=True))
        self.P = []
        for a in self.rest:
            # K_ca = -(g_cc^-1 g_ca): the factors of g_cc serve K and w
            column = factors.solve([-(zero + self.g.get((c, a), 0)) for c in cyclic])
            self.P.append({a: graph.one, **{c: x for c, x in zip(cyclic, column, strict=True) if not x.is_zero}})
        self.projection = Projection(graph, self.P, self.rest)
        # q'^c = K^c_a q'^a + w^c
        pairs = list(zip(self.P, self.rates, strict=True))
        self.moving = [self.w[c] + graph.sum(x[c] * v for x, v in pairs if c in x) for c in cyclic]
        speeds = {f"{names[c]}'": v for c, v in zip(cyclic, self.moving, strict=True)}
        # what velocities are in (bias, forces) is at the q'^c that the momenta make
        self.found = _substituted(graph, outputs, speeds)

    def outputs(self) -> dict[str, Formulas]:
        """All that there are, and those of Routh's function."""
        along = {name: self._reduced(name, each) for name, each in self.found.items()}
        more = {f"{name}_0": self._at_no_rate(name, axis) for name, axis in MOTIONS.items() if name in self.found}
        return along | more | self._routhian(along["metric"])

    def _reduced(self, name: str, each: Formulas) -> Formulas:
        """P along all axes of coordinates."""
        axes = OF_COORDINATES.get(name, ())
        return self.projection.along(name, each, axes, dict(each.expanded())) if axes else each

    def _along(self, entries: Entries, axis: int, column: Column) -> Entries:
        """x_..i.. v^i, without the axis."""
        return self.projection.sums(
            (index[:axis] + index[axis + 1 :], x * column[index[axis]])
            for index, x in entries.items()
            if index[axis] in column
        )

    def _at_no_rate(self, name: str, axis: int) -> Formulas:
        """x_..c.. w^c: what moves while the coordinates that are left do not."""
        each = self.found[name]
        return Formulas(each.shape[:axis] + each.shape[axis + 1 :], self._along(dict(each.expanded()), axis, self.w))

    def _routhian(self, metric: Formulas) -> dict[str, Formulas]:
        """The terms of R + V, and what they add to the equations."""
        n, graph = len(self.rest), self.graph
        place = {a: i for i, a in enumerate(self.rest)}
        mixed: Entries = {(place[a],): x for (a,), x in self._along(self.g, 0, self.w).items() if a in place}
        # g_00 = -p_c w^c, negative: V - 1/2 g_00 is the amended potential
        last = -graph.sum(p * x for p, x in zip(self.p, self.w.values(), strict=True))
        own = graph.sum(x * self.rates[a] * self.rates[b] for (a, b), x in metric.expanded().items())
        found = {
            "g_a0": Formulas((n,), mixed),
            "g_00": Formulas((), {(): last}),
            "T_2": Formulas((), {(): own / 2}),
            "T_1": Formulas((), {(): graph.sum(x * self.rates[a] for (a,), x in mixed.items())}),
            "T_0": Formulas((), {(): last / 2}),
            "ignored_rates": array((len(self.moving),), lambda c: self.moving[c]),
        }
        if "christoffel" in self.found:
            gamma = self.projection.contracted(self._along(dict(self.found["christoffel"].expanded()), 2, self.w), 0)
            found["Gamma_ab0"] = Formulas((n, n), self.projection.contracted(gamma, 1))
            found["Gamma_a00"] = Formulas((n,), self._along(gamma, 1, self.w))
        return found


def _factors(names: Sequence[str], cyclic: Sequence[int], metric: Entries) -> Factors[Expr]:
    """Of g_cc. Raises InvalidDocument for a coordinate without inertia."""
    block: Entries = {
        (i, j): metric[a, b] for i, a in enumerate(cyclic) for j, b in enumerate(cyclic) if i <= j and (a, b) in metric
    }
    try:
        return factorised(len(cyclic), block)
    except ZeroDivisionError:
        among_them = listed(f"'{names[c]}'" for c in cyclic)
        message = f"of {among_them} one has no inertia: give the bodies that it moves mass or inertia"
        raise InvalidDocument.at("/ignored", "singular-metric", message) from None
