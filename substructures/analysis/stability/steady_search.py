"""The search for steady motions: E_x = Gamma_xbc w^b w^c - Q_x at x' = 0 and its Jacobian, and what linearises them."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from substructures.analysis.equations.kernels import program_kernel
from substructures.analysis.equations.steady import steady_formulas
from substructures.analysis.stability.equilibrium_search import RestConditions, RestSearch, SearchRange
from substructures.array import Array
from substructures.expr.program import Program
from substructures.quantities.states import read_states, symbol_values
from substructures.tree.model import Model

NEEDS = ("metric", "bias", "forces")
#: least eigenvalue of a metric with ones on its diagonal; places are found to about the root of it
SINGULAR = 1e-7


@dataclass(frozen=True)
class SteadyMatrices:
    """M, D, K (r, r) at a steady motion, ``rates`` and ``momenta`` (m,) of the moving coordinates."""

    M: Array
    D: Array
    K: Array
    rates: Array
    momenta: Array


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
        turning = [model.joints[a] == "R" for a in self.still]
        self.size = np.where(turning, np.pi, within.reach)
        self.turning = np.zeros(self.n, dtype=bool)
        self.turning = np.array([t and self._is_periodic(a) for a, t in enumerate(turning)], dtype=bool)

    def _of_all(self, rows: Array) -> Array:
        return rows[:, self.still]

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
        """E_x and its Jacobian by x, at constant rates or momenta, whichever are given."""
        found, _ = self._found(x)
        slope = found["by_position"]
        if self.of_momenta:
            # w = g_ss^-1 p, so that dw = -g_ss^-1 N dx
            slope = slope - found["by_rate"] @ self._solved(found, found["momenta_by_position"])
        return found["residual"], slope

    def matrices(self, x: Array, at_momenta: bool) -> SteadyMatrices:
        """M, D, K of a disturbed motion at constant momenta, or rates."""
        found, rates = self._found(x)
        g, x_, s_ = found["metric"], self.still, list(self.moving)
        M, D, K, N = g[np.ix_(x_, x_)], found["by_velocity"], found["by_position"], found["momenta_by_position"]
        if at_momenta:
            # ds' = -g_ss^-1 (g_sx dx' + N dx)
            coupling, slope = self._solved(found, g[np.ix_(s_, x_)]), self._solved(found, N)
            M = M - g[np.ix_(x_, s_)] @ coupling
            D = D - g[np.ix_(x_, s_)] @ slope - found["by_rate"] @ coupling
            K = K - found["by_rate"] @ slope
        return SteadyMatrices(M, D, K, np.array(rates), found["momenta"])

    def _solved(self, found: dict[str, Array], right: Array) -> Array:
        """g_ss^-1 right."""
        s = list(self.moving)
        try:
            return np.asarray(np.linalg.solve(found["metric"][np.ix_(s, s)], right), dtype=np.float64)
        except np.linalg.LinAlgError:
            return np.full_like(right, np.nan)

    def _compile(self, source: Program) -> None:
        """The functions as a kernel of x and the rates; all other symbols keep their values."""
        names = [self.model.coordinates[a] for a in self.still]
        rates = [f"{self.model.coordinates[s]}'" for s in self.moving]
        constant = {name: x for name, x in self.known.items() if name not in (*names, *rates)}
        self.x, self.w = np.zeros((1, len(names))), np.zeros((1, len(rates)))
        self.outputs = {name: np.zeros((1, *output.shape)) for name, output in source.outputs.items()}
        columns = [(some, column) for some, column in ((names, self.x), (rates, self.w)) if some]
        self.run = program_kernel(source).bind(self.outputs, constant, columns=columns)

    def _found(self, x: Array) -> tuple[dict[str, Array], list[float]]:
        """All functions at x, and the rates there."""
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
