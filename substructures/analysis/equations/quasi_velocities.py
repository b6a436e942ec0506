"""Equations of motion in quasi-velocities: Voronets and Boltzmann-Hamel (notation.md, section 7), as formulas.

With p quasi-velocities v and m constraints, Y q' = (v, 0): the first p rows of Y define v, the others are B. The
columns of Y^-1 are T (q' = T v) and S (B S = 1). Both forms are g* v' + bias = forces with g* = T^T g T:

    Voronets          bias = T^T (g T' v + Gamma q'q')
    Boltzmann-Hamel   bias_i = (g*' v)_i - X_i(T*) - c^k_ji v^j p_k,  p = (T S)^T g q',  X_i = T^a_i d/dq^a,
                      [X_i, X_j] = c^k_ij X_k: the structure coefficients, formed from T
                      (G. Hamel, Theoretische Mechanik, 1949; A. M. Bloch, J. E. Marsden, D. V. Zenkov, Dynamical
                      Systems 24, 2009)

====================  =====  ==============================================================================
output                shape  meaning (n coordinates, p quasi-velocities, m constraints)
====================  =====  ==============================================================================
constraints           m n    B
T                     n p    q' = T v
rates                 n      T v
metric                p p    T^T g T
bias                  p      of Voronets' form
hamel_bias            p      of the Boltzmann-Hamel form
forces                p      T^T Q
structure             n p p  c^k_ij at [k, i, j]
multipliers           m      lambda in g q'' + Gamma q'q' = Q + B^T lambda; needs v' (``name'``): S^T (g q'' + ... - Q)
kinetic_energy               T* = v^T g* v / 2 [J]
potential_energy             of gravity and springs [J]
lost_power                   power of the forces without potential, and dV/dt of springs that change with time [W]
gaps                  k      constant [m, 1]: distances of rolling bodies from planes, residuals of closures
====================  =====  ==============================================================================
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

from substructures.analysis.arguments import exact
from substructures.analysis.equations.cofactors import inverse
from substructures.analysis.equations.quasi_choice import MatrixRows, independent_rows, quasi_velocity_rows, vanishing
from substructures.analysis.equations.velocity_constraints import Closed, Constraint, velocity_rows
from substructures.certificate.derived.quasi import Quasi
from substructures.errors import InvalidArgument, listed
from substructures.expr.differentiate import gradient
from substructures.expr.graph import Expr
from substructures.expr.program import Entries, Formulas, Program, array, program
from substructures.quantities.certificate import DYNAMICS as CERTIFIED
from substructures.quantities.certificate import certified
from substructures.quantities.numbers.workspace import Workspace
from substructures.tree.model import Model
from substructures.tree.model_outputs import KINEMATICS

DYNAMICS = ("metric", "christoffel", "bias", "forces", "potential_energy")


@dataclass(frozen=True)
class QuasiVelocities:
    """The equations (the table above) with names: quasi-velocities v, constraint rows, gaps; rows left out because
    they follow from others (``dependent``). ``singular``: where this formula is zero they do not describe the motion;
    empty where none is known.
    """

    model: Model
    program: Program
    velocities: tuple[str, ...]
    constraints: tuple[str, ...]
    gaps: tuple[str, ...]
    dependent: tuple[str, ...]
    singular: str = ""

    def __repr__(self) -> str:
        return (
            f"QuasiVelocities: {listed(self.velocities)} of {self.model.dof} coordinates; "
            f"constraints: {listed(self.constraints) or 'none'}\n"
            f"gaps: {listed(self.gaps) or 'none'}; dependent: {listed(self.dependent) or 'none'}; "
            f"{len(self.program)} operations"
        )


def quasi_velocity_equations(
    model: Model,
    constraints: Sequence[Constraint] = (),
    *,
    velocities: Mapping[str, str] | None = None,
    independent: Sequence[str] | None = None,
    near: Mapping[str, float] | None = None,
) -> QuasiVelocities:
    """The equations of a model with velocity constraints, all formulas.

    The quasi-velocities: ``velocities``, as many as the constraints leave free, by name, each an expression linear in
    the velocities; or those of the coordinates ``independent``; default: those that the parts name, where closures are
    the only constraints and nothing is ``near``, else chosen for short formulas that describe the motion well ``near``
    these values of coordinates and parameters.

    Raises InvalidInput (pointers start with names of arguments): constraints that are not linear, quasi-velocities that
    do not determine the velocities; TooLarge.
    """
    if (
        velocities is None
        and independent is None
        and near is None
        and all(isinstance(each, Closed) for each in constraints)
    ):
        independent = model.reduction.independent or None
    f = Workspace(model)
    given = velocity_rows(f, constraints)
    rows, dependent = independent_rows(f, given)
    names, own = quasi_velocity_rows(f, rows, velocities, independent, near)
    # Y q' = (v, 0), Y^-1 = [T S]
    Y = [*own, *rows.rows]
    inverted = inverse(Y)
    if inverted is None:
        pointer = "/independent" if velocities is None else "/velocities"
        message = "these velocities and the constraints do not determine the velocities of all coordinates"
        raise InvalidArgument.at(pointer, "dependent", message)
    equations = _Equations(f, names, Y, inverted)
    outputs = equations.outputs()
    gaps = list(rows.gaps.values())
    if gaps:
        outputs["gaps"] = array((len(gaps),), lambda k: gaps[k])
    result = program(f.graph, outputs, f.symbols)
    texts = {name: name for name in names} if velocities is None else dict(velocities)
    plain = {c.name: {key: _exact(x) for key, x in vars(c).items()} for c in constraints}
    closed = [f"{each.name}.{row}" for each in model.closures for row in each.rows]
    expectation = Quasi(result, texts, rows.labels, list(rows.gaps), plain, model.frames, closed)
    kinds = {s.name: s.kind for s in f.symbols.values()}
    needs = (*CERTIFIED, *KINEMATICS)
    result = certified(result, model, expectation, "velocity equations", needs=needs, more=kinds)
    labels = tuple(rows.labels), tuple(rows.gaps), tuple(dependent)
    return QuasiVelocities(model, result, tuple(names), *labels, vanishing(f, Y))


def _exact(given: Any) -> Any:
    """Numbers and texts of a constraint without rounding."""
    return [exact(x, "") for x in given] if isinstance(given, (list, tuple)) else exact(given, "")


class _Equations:
    """The outputs, from Y and its inverse."""

    def __init__(self, f: Workspace, names: Sequence[str], Y: MatrixRows, inverted: MatrixRows) -> None:
        self.f, self.n, self.p, self.Y = f, f.n, len(names), Y
        self.T = [row[: self.p] for row in inverted]
        self.S = [row[self.p :] for row in inverted]
        self.v = [f.graph.symbol(name) for name in names]
        self.dv = [f.graph.symbol(f"{name}'") for name in names]
        self.rates = self._times(self.T, self.v)
        bound = {f"{name}'": x for name, x in zip(f.model.coordinates, self.rates, strict=True)}
        self.model = f.outputs(DYNAMICS, bound)
        #: dT[a][i][b] = d T^a_i / dq^b
        self.dT = [gradient(row, f.model.coordinates) for row in self.T]

    def outputs(self) -> dict[str, Formulas]:
        """All of the table but the gaps."""
        n, p = self.n, self.p
        g, Q = self.model["metric"], self._vector("forces")
        gT = [[self._sum(g.get((a, b), 0) * self.T[b][i] for b in range(n)) for i in range(p)] for a in range(n)]
        # g*_ij = T^a_i g_ab T^b_j, p_a = g_ab T^b_i v^i
        reduced = [[self._sum(self.T[a][i] * gT[a][j] for a in range(n)) for j in range(p)] for i in range(p)]
        momentum = self._times(gT, self.v)
        # T' v with T'^a_i = d_b T^a_i q'^b
        turning = [self._sum(self._slope(a, i) * self.v[i] for i in range(p)) for a in range(n)]
        # g T' v + Gamma q'q'
        carried = self._product(g, turning)
        inertial = [x + y for x, y in zip(carried, self._vector("bias"), strict=True)]
        # g q'' + Gamma q'q' - Q with q'' = T v' + T' v
        missing = [self._sum(gT[a][i] * self.dv[i] for i in range(p)) + inertial[a] - Q[a] for a in range(n)]
        structure = self._structure()
        hamel = self._hamel(momentum, carried, structure)
        B = self.Y[p:]
        # T* = p_a q'^a / 2
        energy = self._sum(m * x for m, x in zip(momentum, self.rates, strict=True)) / 2
        return {
            "constraints": array((n - p, n), lambda k, a: B[k][a]),
            "T": array((n, p), lambda a, i: self.T[a][i]),
            "rates": array((n,), lambda a: self.rates[a]),
            "metric": Formulas((p, p), {(i, j): reduced[i][j] for i in range(p) for j in range(i, p)}, "symmetric"),
            "bias": array((p,), lambda i: self._column(self.T, i, inertial)),
            "hamel_bias": array((p,), lambda i: hamel[i]),
            "forces": array((p,), lambda i: self._column(self.T, i, Q)),
            "structure": Formulas((n, p, p), structure),
            "multipliers": array((n - p,), lambda k: self._column(self.S, k, missing)),
            "kinetic_energy": array((), lambda: energy),
            "potential_energy": Formulas((), self.model["potential_energy"]),
            "lost_power": array((), lambda: self._lost_power(Q)),
        }

    def _hamel(self, momentum: Sequence[Expr], carried: Sequence[Expr], structure: Entries) -> list[Expr]:
        """g*' v - X_i(T*) - c^k_ji v^j p_k; ``carried`` = g T' v."""
        n, p, v = self.n, self.p, self.v
        christoffel = self.model["christoffel"]
        zero = self.f.graph.zero
        # (g' q')_a = (Gamma_abc + Gamma_bac) q'^b q'^c and d_b T at fixed velocities = Gamma_acb q'^a q'^c
        changing, sloping = [zero] * n, [zero] * n
        for (a, b, c), gamma in christoffel.items():
            changing[a] = changing[a] + gamma * (self.rates[b] * self.rates[c])
            changing[b] = changing[b] + gamma * (self.rates[a] * self.rates[c])
            sloping[c] = sloping[c] + gamma * (self.rates[a] * self.rates[b])
        # p of all n quasi-velocities, the constrained ones included
        p_all = [self._column(self.T, i, momentum) for i in range(p)]
        p_all += [self._column(self.S, k, momentum) for k in range(n - p)]
        result = []
        for i in range(p):
            # (g*' v)_i = T'^a_i p_a + T^a_i (g' q' + g T' v)_a
            growing = self._sum(self._slope(a, i) * momentum[a] for a in range(n))
            growing = growing + self._column(self.T, i, [x + y for x, y in zip(changing, carried, strict=True)])
            # X_i(T*) = T^b_i (d_b T at fixed q' + p_a d_b T^a_j v^j)
            along = self._column(self.T, i, sloping)
            along = along + self._sum(
                self.T[b][i] * (momentum[a] * self.dT[a][j][b] * v[j])
                for b in range(n)
                for a in range(n)
                for j in range(p)
                if not self.dT[a][j][b].is_zero
            )
            # c^k_ji v^j p_k
            twist = self._sum(c * v[j] * p_all[k] for (k, j, i2), c in structure.items() if i2 == i)
            result.append(growing - along - twist)
        return result

    def _structure(self) -> Entries:
        """c^k_ij = Y^k_a (T^b_i d_b T^a_j - T^b_j d_b T^a_i)."""
        n, p = self.n, self.p
        result: Entries = {}
        for i in range(p):
            for j in range(i + 1, p):
                bracket = [self._along(i, a, j) - self._along(j, a, i) for a in range(n)]
                for k in range(n):
                    c = self._sum(self.Y[k][a] * bracket[a] for a in range(n))
                    if not c.is_zero:
                        result[k, i, j], result[k, j, i] = c, -c
        return result

    def _along(self, i: int, a: int, j: int) -> Expr:
        """X_i(T^a_j)."""
        return self._sum(self.T[b][i] * self.dT[a][j][b] for b in range(self.n))

    def _slope(self, a: int, i: int) -> Expr:
        """T'^a_i = d_b T^a_i q'^b."""
        return self._sum(self.dT[a][i][b] * self.rates[b] for b in range(self.n))

    def _lost_power(self, Q: Sequence[Expr]) -> Expr:
        potential = self.f.graph.zero + self.model["potential_energy"].get((), 0)
        # (Q_a + dV/dq^a) q'^a + dV/dt
        ((*slopes, rate),) = gradient([potential], [*self.f.model.coordinates, "t"])
        return rate + self._sum((q + s) * x for q, s, x in zip(Q, slopes, self.rates, strict=True))

    def _sum(self, terms: Any) -> Expr:
        return self.f.graph.sum(self.f.graph.zero + x for x in terms)

    def _vector(self, name: str) -> list[Expr]:
        return [self.f.graph.zero + self.model[name].get((a,), 0) for a in range(self.n)]

    def _times(self, matrix: MatrixRows, x: Sequence[Expr]) -> list[Expr]:
        return [self._sum(m * y for m, y in zip(row, x, strict=True)) for row in matrix]

    def _product(self, g: Entries, x: Sequence[Expr]) -> list[Expr]:
        return [self._sum(g.get((a, b), 0) * x[b] for b in range(self.n)) for a in range(self.n)]

    def _column(self, matrix: MatrixRows, i: int, x: Sequence[Expr]) -> Expr:
        """M^T x at i."""
        return self._sum(row[i] * y for row, y in zip(matrix, x, strict=True))
