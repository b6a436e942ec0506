"""The formulas of the equations in quasi-velocities that :mod:`.quasi_velocities` names."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

from substructures.analysis.equations.cofactors import MatrixRows
from substructures.expr.differentiate import gradient
from substructures.expr.graph import Expr
from substructures.expr.program import Entries, Formulas, array, program
from substructures.expr.replay import replay
from substructures.quantities.numbers.workspace import Workspace

ENERGIES = ("T_2", "T_1", "T_0")
DYNAMICS = ("metric", "christoffel", "bias", "forces", "potential_energy")


class QuasiEquations:
    """The outputs, from Y, its inverse, and b (nothing where it is zero)."""

    def __init__(
        self, f: Workspace, names: Sequence[str], Y: MatrixRows, inverted: MatrixRows, given: Sequence[Expr]
    ) -> None:
        self.f, self.n, self.p, self.Y, self.given = f, f.n, len(names), Y, given
        self.T = [row[: self.p] for row in inverted]
        self.S = [row[self.p :] for row in inverted]
        self.v = [f.graph.symbol(name) for name in names]
        self.dv = [f.graph.symbol(f"{name}'") for name in names]
        self.rates = self._times(self.T, self.v)
        if given:
            # r = -S b
            self.r = [-x for x in self._times(self.S, given)]
            self.rates = [x + y for x, y in zip(self.rates, self.r, strict=True)]
        bound = {f"{name}'": x for name, x in zip(f.model.coordinates, self.rates, strict=True)}
        self.model = f.outputs([*DYNAMICS, *(ENERGIES if f.model.driven else ())], bound)
        #: dT[a][i][b] = d T^a_i / dq^b
        self.dT = [gradient(row, f.model.coordinates) for row in self.T]
        #: dr[a][b] = d r^a / dq^b, and the last d r^a / dt
        self.dr = gradient(self.r, [*f.model.coordinates, "t"]) if given else []
        #: of given motions, d T^a_i / dt
        self.T_t = [[x for (x,) in gradient(row, ["t"])] for row in self.T] if f.model.driven else []

    def outputs(self) -> dict[str, Formulas]:
        """All of the table but the gaps."""
        n, p = self.n, self.p
        g, Q = self.model["metric"], self._vector("forces")
        gT = [[self._sum(g.get((a, b), 0) * self.T[b][i] for b in range(n)) for i in range(p)] for a in range(n)]
        # g*_ij = T^a_i g_ab T^b_j, p_a = g_ab q'^b
        reduced = [[self._sum(self.T[a][i] * gT[a][j] for a in range(n)) for j in range(p)] for i in range(p)]
        momentum = self._times(gT, self.v)
        if self.given:
            momentum = _added(momentum, self._product(g, self.r))
        # g (T' v + r') + Gamma q'q'
        carried = self._product(g, self._turning())
        inertial = _added(carried, self._vector("bias"))
        # g q'' + Gamma q'q' - Q with q'' = T v' + T' v + r'
        missing = [self._sum(gT[a][i] * self.dv[i] for i in range(p)) + inertial[a] - Q[a] for a in range(n)]
        structure = self._structure()
        B = self.Y[p:]
        # T* = p_a q'^a / 2, of given motions T_2 - T_0
        energy = self._sum(m * x for m, x in zip(momentum, self.rates, strict=True)) / 2 - self._scalar("T_0")
        multipliers = [self._column(self.S, k, missing) for k in range(n - p)]
        return {
            "constraints": array((n - p, n), lambda k, a: B[k][a]),
            "T": array((n, p), lambda a, i: self.T[a][i]),
            "rates": array((n,), lambda a: self.rates[a]),
            "metric": Formulas((p, p), {(i, j): reduced[i][j] for i in range(p) for j in range(i, p)}, "symmetric"),
            "bias": array((p,), lambda i: self._column(self.T, i, inertial)),
            **self._hamel_bias(momentum, carried, structure),
            "forces": array((p,), lambda i: self._column(self.T, i, Q)),
            "structure": Formulas((n, p, p), structure),
            "multipliers": array((n - p,), lambda k: multipliers[k]),
            "kinetic_energy": array((), lambda: energy),
            "potential_energy": Formulas((), self.model["potential_energy"]),
            "lost_power": array((), lambda: self._lost_power(Q)),
            **self._work_of_constraints(multipliers),
        }

    def _turning(self) -> list[Expr]:
        """T' v + r' with T'^a_i = d_b T^a_i q'^b and r' = d_b r q'^b + d_t r."""
        turning = [self._sum(self._slope(a, i) * self.v[i] for i in range(self.p)) for a in range(self.n)]
        return _added(turning, self._times(self.dr, [*self.rates, self.f.graph.one])) if self.given else turning

    def _work_of_constraints(self, multipliers: Sequence[Expr]) -> dict[str, Formulas]:
        """b and lambda_k B_ka q'^a = -lambda_k b_k; nothing where b is zero."""
        if not self.given:
            return {}
        power = -self._sum(x * y for x, y in zip(multipliers, self.given, strict=True))
        return {
            "given": array((len(self.given),), lambda k: self.given[k]),
            "constraint_power": array((), lambda: power),
        }

    def _hamel_bias(self, momentum: Sequence[Expr], carried: Sequence[Expr], structure: Entries) -> dict[str, Formulas]:
        """Nothing with given motions, which add to the momenta."""
        if self.f.model.driven:
            return {}
        hamel = self._hamel(momentum, carried, structure)
        return {"hamel_bias": array((self.p,), lambda i: hamel[i])}

    def _hamel(self, momentum: Sequence[Expr], carried: Sequence[Expr], structure: Entries) -> list[Expr]:
        """(g*' v + (T^T g r)')_i - X_i(T*) - c^k_ji v^j p_k; ``carried`` = g (T' v + r')."""
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
            # T'^a_i p_a + T^a_i (g' q' + g (T' v + r'))_a
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
            if self.given:
                twist = twist + self._twist_of_given(i, momentum, p_all)
            result.append(growing - along - twist)
        return result

    def _twist_of_given(self, i: int, momentum: Sequence[Expr], p_all: Sequence[Expr]) -> Expr:
        """X_i(r^a) p_a of X_i(T*), and c^k_0i p_k with [X_0, X_i] = (X_0(T^a_i) - X_i(r^a)) d_a."""
        n = self.n
        changed = [self._sum(self.T[b][i] * self.dr[a][b] for b in range(n)) for a in range(n)]
        bracket = [self._sum(self.dT[a][i][b] * self.r[b] for b in range(n)) - changed[a] for a in range(n)]
        twist = self._sum(p * x for p, x in zip(p_all, self._times(self.Y, bracket), strict=True))
        return twist + self._sum(p * x for p, x in zip(momentum, changed, strict=True))

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
        """T'^a_i = d_b T^a_i q'^b + d_t T^a_i."""
        found = self._sum(self.dT[a][i][b] * self.rates[b] for b in range(self.n))
        return found + self.T_t[a][i] if self.T_t else found

    def _lost_power(self, Q: Sequence[Expr]) -> Expr:
        potential = self.f.graph.zero + self.model["potential_energy"].get((), 0)
        # (Q_a + dV/dq^a) q'^a + dV/dt
        ((*slopes, rate),) = gradient([potential], [*self.f.model.coordinates, "t"])
        power = rate + self._sum((q + s) * x for q, s, x in zip(Q, slopes, self.rates, strict=True))
        return power - self._rate_of_given() if self.f.model.driven else power

    def _rate_of_given(self) -> Expr:
        """d_t (T_2 + T_1 + T_0) at fixed q, q': what given motions change of T."""
        found = self.f.outputs(ENERGIES)
        ((rate,),) = gradient([self._sum(found[name].get((), 0) for name in ENERGIES)], ["t"])
        made = program(self.f.graph, {"x": Formulas((), {(): rate})}, self.f.symbols)
        bound = {f"{name}'": x for name, x in zip(self.f.model.coordinates, self.rates, strict=True)}
        return self.f.graph.lift(replay(made, self.f.graph, bound)["x"].entries.get((), 0))

    def _scalar(self, name: str) -> Expr:
        """An output without axes; 0 where the model has none."""
        return self.f.graph.zero + self.model.get(name, {}).get((), 0)

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


def _added(x: Sequence[Expr], y: Sequence[Expr]) -> list[Expr]:
    return [a + b for a, b in zip(x, y, strict=True)]
