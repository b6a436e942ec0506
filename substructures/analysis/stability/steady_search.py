"""The search for steady motions: E_x = Gamma_xbc w^b w^c - Q_x at x' = 0 and its Jacobian, and what linearises them."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np
import scipy

from substructures.analysis.closed.constrained import Constrained
from substructures.analysis.closed.loops import independent_coordinates
from substructures.analysis.equations.formulas import multipliers_of
from substructures.analysis.equations.kernels import program_kernel
from substructures.analysis.equations.steady import steady_formulas
from substructures.analysis.motion.problems.start import Start
from substructures.analysis.stability.closed_search import is_met, multiplier_units
from substructures.analysis.stability.equilibrium_search import STEPS, TOLERANCES, RestSearch, SearchRange
from substructures.analysis.stability.operating_point import RestConditions
from substructures.array import Array
from substructures.expr.interpret import interpret
from substructures.expr.program import Program
from substructures.quantities.numbers.reaction_numbers import least_norm
from substructures.quantities.numbers.states import read_states, symbol_values
from substructures.tree.model import Model

NEEDS = ("metric", "bias", "forces")
#: least eigenvalue of a metric with ones on its diagonal; places are found to about the root of it
SINGULAR = 1e-7


@dataclass(frozen=True)
class SteadyMatrices:
    """M, D, K (r, r) at a steady motion, ``rates`` and ``momenta`` (m,) of the moving coordinates; ``tangent`` (k, r):
    dx = N dy of the k coordinates that keep still, in the ``independent`` ones among them.
    """

    M: Array
    D: Array
    K: Array
    rates: Array
    momenta: Array
    tangent: Array
    independent: tuple[int, ...]


class SteadySearch(RestSearch):
    """Places x (r,) of steady motions, with ``wanted`` (m,) rates or momenta of the coordinates ``moving``."""

    def __init__(
        self,
        model: Model,
        moving: Sequence[int],
        within: SearchRange,
        conditions: RestConditions,
        wanted: Array,
        of_momenta: bool,
    ) -> None:
        self.model, self.within, self.conditions = model, within, conditions
        self.moving, self.wanted, self.of_momenta = tuple(moving), wanted, of_momenta
        self.still = [a for a in range(model.dof) if a not in moving]
        self.n = len(self.still)
        states = read_states(model, {"q": np.zeros(model.dof)}, None)
        known = symbol_values(model, vars(conditions), states, NEEDS)
        self.known = {name: float(np.ravel(x)[0]) for name, x in known.items()}
        self._compile(steady_formulas(model, moving))
        self._sized([model.state_units["q"][model.coordinates[a]] for a in self.still])

    def _of_all(self, rows: Array) -> Array:
        return rows[:, self.still]

    def _without_rounding(self, sizes: Array) -> Array:
        return sizes

    def put(self, name: str, value: float) -> None:
        """Another value of a parameter, or of what is wanted of a moving coordinate."""
        if name in self.model.coordinates:
            self.wanted[self.moving.index(self.model.coordinates.index(name))] = value
            return
        self.known[name] = value
        self.constant[name][0] = value
        self.conditions = replace(self.conditions, parameters={**self.conditions.parameters, name: value})

    def whole(self, x: Array) -> Array:
        """All coordinates (n,), 0 where they move."""
        q = np.zeros(self.model.dof)
        q[self.still] = x
        return q

    def values(self, x: Array) -> dict[str, float]:
        """Values of all symbols in the steady motion."""
        rates = self._found(x)[1]
        named: dict[str, Any] = dict(zip(self.model.coordinates, self.whole(x).tolist(), strict=True))
        named |= {f"{name}'": 0.0 for name in self.model.coordinates}
        return (
            self.known | named | {f"{self.model.coordinates[s]}'": w for s, w in zip(self.moving, rates, strict=True)}
        )

    def at(self, x: Array) -> tuple[Array, Array]:
        """E_x and its Jacobian by x, at constant rates or momenta, whichever are given, over the units."""
        found, _ = self._found(x)
        return found["residual"] / self.unit, self._slope(found) / self.unit[:, None]

    def equations(self, x: Array) -> tuple[Array, Array]:
        """What is zero in a steady motion (k,), over its units, and the Jacobian (k, r) there."""
        return self.at(x)

    def _slope(self, found: dict[str, Array]) -> Array:
        """dE_x/dx."""
        if not self.of_momenta:
            return found["by_position"]
        # w = g_ss^-1 p, so that dw = -g_ss^-1 N dx
        return found["by_position"] - found["by_rate"] @ self._solved(found, found["momenta_by_position"])

    def matrices(self, x: Array, at_momenta: bool) -> SteadyMatrices:
        """M, D, K of a disturbed motion at constant momenta, or rates."""
        found, rates = self._found(x)
        g, x_, s_ = found["metric"], self.still, list(self.moving)
        M, D, K = g[np.ix_(x_, x_)], found["by_velocity"], found["by_position"]
        if at_momenta:
            # ds' = -g_ss^-1 (g_sx dx' + d(g_ss w)/dx dx)
            coupling = self._solved(found, g[np.ix_(s_, x_)])
            slope = self._solved(found, found["momenta_by_position"])
            M = M - g[np.ix_(x_, s_)] @ coupling
            D = D - g[np.ix_(x_, s_)] @ slope - found["by_rate"] @ coupling
            K = K - found["by_rate"] @ slope
        N, independent = self._tangent(found)
        M, D, K = (N.T @ each @ N for each in (M, D, K))
        return SteadyMatrices(M, D, K, np.array(rates), found["momenta"], N, tuple(independent))

    def accelerations(self, x: Array, at: SteadyMatrices) -> Array:
        """y'' (r,) in the motion itself, by the equations of motion of the model; nan where they have no solution."""
        found = interpret(self.model.program, self.values(x), ["forces", "bias"])
        # M y'' = N^T (Q - Gamma q'q'), as closures do no work along N
        left = (found["forces"] - found["bias"])[self.still]
        try:
            return np.asarray(np.linalg.solve(at.M, at.tangent.T @ left), dtype=np.float64)
        except np.linalg.LinAlgError:
            return np.full(len(at.M), np.nan)

    def _tangent(self, _: dict[str, Array]) -> tuple[Array, list[int]]:
        """N of dx = N dy, and the coordinates y."""
        return np.eye(self.n), list(self.still)

    def _solved(self, found: dict[str, Array], right: Array) -> Array:
        """g_ss^-1 right."""
        s = list(self.moving)
        try:
            return np.asarray(np.linalg.solve(found["metric"][np.ix_(s, s)], right), dtype=np.float64)
        except np.linalg.LinAlgError:
            return np.full_like(right, np.nan)

    def _compile(self, source: Program) -> None:
        """The functions as a kernel of x, the rates and multipliers; all other symbols keep their values."""
        groups = (
            [self.model.coordinates[a] for a in self.still],
            [f"{self.model.coordinates[s]}'" for s in self.moving],
            list(multipliers_of(self.model)),
        )
        # arrays are read in place
        self.constant = {name: np.full(1, x) for name, x in self.known.items() if not any(name in g for g in groups)}
        self.x, self.w, self.multipliers = (np.zeros((1, len(some))) for some in groups)
        self.outputs = {name: np.zeros((1, *output.shape)) for name, output in source.outputs.items()}
        pairs = zip(groups, (self.x, self.w, self.multipliers), strict=True)
        columns = [(some, column) for some, column in pairs if some]
        self.run = program_kernel(source).bind(self.outputs, self.constant, columns=columns)

    def _found(self, x: Array) -> tuple[dict[str, Array], list[float]]:
        """All functions at x with the multipliers that were put down, and the rates there."""
        self.x[0], self.w[0] = x, self.wanted
        self.run()
        if self.of_momenta:
            # the metric does not depend on rates: w = g_ss^-1 p
            self.w[0] = self._solved({name: found[0] for name, found in self.outputs.items()}, self.wanted)
            self.run()
        return {name: found[0].copy() for name, found in self.outputs.items()}, self.w[0].tolist()

    def is_singular(self, x: Array) -> bool:
        """Whether the coordinates fail here: the metric, with ones on its diagonal, is as good as singular."""
        g = self._found(x)[0]["metric"]
        sizes = np.sqrt(np.abs(np.diagonal(g)))
        scaled = g / np.outer(sizes, sizes) if sizes.all() else g
        return not np.isfinite(scaled).all() or bool(np.linalg.eigvalsh(scaled)[0] < SINGULAR)


class ClosedSteadySearch(SteadySearch):
    """The same with closures: E_x - G_kx lambda_k = 0 and phi_k = 0 for x and lambda together."""

    def __init__(
        self, model: Model, moving: Sequence[int], within: SearchRange, conditions: RestConditions, *rest: Any
    ) -> None:
        start = Start([0.0] * model.dof, parameters=conditions.parameters, inputs=conditions.inputs)
        self.s = Constrained(model, start, (conditions.t, conditions.t))
        super().__init__(model, moving, within, conditions, *rest)

    def _judged(self, q: Array) -> Array:
        return np.concatenate((self.at(q)[0], self.outputs["closure.residual"][0]))

    def _found(self, x: Array) -> tuple[dict[str, Array], list[float]]:
        """With the multipliers of least squares: G^T lambda = E."""
        self.multipliers[:] = 0
        found, _ = super()._found(x)
        self.multipliers[0] = least_norm(found["closure.jacobian"], self.s.reach, found["residual"])
        return super()._found(x)

    def equations(self, x: Array) -> tuple[Array, Array]:
        """E_x - lambda_k G_kx with lambda of least squares, and phi_k over their widths."""
        found, _ = self._found(x)
        # the rest is P E with P = N (N^T N)^-1 N^T; its derivative is P (E_x,y - lambda_k G_kx,y) where it is zero
        Q = np.linalg.qr(self._tangent(found)[0])[0]
        E, K = found["residual"] / self.unit, Q @ Q.T @ self._slope(found) / self.unit[:, None]
        phi, G = found["closure.residual"] / self.s.width, found["closure.jacobian"] / self.s.width[:, None]
        return np.concatenate((E, phi)), np.concatenate((K, G))

    def _tangent(self, found: dict[str, Array]) -> tuple[Array, list[int]]:
        G = found["closure.jacobian"] / self.s.reach[:, None]
        y = independent_coordinates(G)
        others = np.setdiff1d(np.arange(self.n), y)
        N = np.zeros((self.n, len(y)))
        N[y] = np.eye(len(y))
        # G_z N_z = -G_y for the other coordinates z; closures that depend on each other agree about it
        N[others] = -_least(G[:, others], G[:, y])
        return N, [self.still[a] for a in y]

    def solve(self, start: Array, moving: Sequence[int]) -> Array | None:
        """A closed steady motion near a start, all coordinates ``moving``; None when there is none in reach."""
        start = start[moving]
        first, _ = self._found(start)
        k, width = self.n, self.s.width
        length = np.append(self.length, np.ones(len(width)))
        force = multiplier_units(first["closure.jacobian"], self.s.reach, self.unit)

        def both(z: Array) -> tuple[Array, Array]:
            """Residuals and their Jacobian at z = (x, lambda), each over its unit."""
            self.multipliers[0] = force * z[k:]
            found, _ = SteadySearch._found(self, z[:k])
            K, G = self._slope(found) / self.unit[:, None], found["closure.jacobian"]
            J = np.block(
                [
                    [np.where(np.isfinite(K), K, 0), -(G * force[:, None] / self.unit).T],
                    [G / width[:, None], np.zeros((len(G), len(G)))],
                ]
            )
            return np.concatenate((found["residual"] / self.unit, found["closure.residual"] / width)), J

        z = np.concatenate((start, self.multipliers[0] / force))
        with np.errstate(all="ignore"):
            z = scipy.optimize.least_squares(
                lambda z: both(z)[0], z, lambda z: both(z)[1], max_nfev=STEPS, x_scale=length, **TOLERANCES
            ).x
        residual, J = both(z)
        if not np.isfinite(residual).all():
            return None
        step = _least(J * length, -residual)
        residual, J = both(z + step * length if np.abs(step[:k]).max(initial=0) < 1e-3 else z)
        if not is_met(residual, J[:k, :k] * length[:k]):
            return None
        x = self.x[0].copy()
        self.s.move(self.conditions.t, self.whole(x), np.zeros(self.model.dof))
        return None if self.s.upside_down() else self.wound(x)


def _least(matrix: Array, right: Array) -> Array:
    """The solution of least squares and of least size."""
    return np.asarray(np.linalg.lstsq(matrix, right, rcond=1e-10)[0], dtype=np.float64)
