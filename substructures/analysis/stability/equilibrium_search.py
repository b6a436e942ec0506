"""The search for positions of rest: forces and their Jacobian, compiled, and Newton's method from many starts.

Of a tree -Q_a(q, q' = 0) = 0, with the Jacobian K = -dQ/dq. With closures (ClosedSearch) -Q_a - lambda_k G_ka = 0 and
phi_k = 0 for q and lambda together, with the Jacobian [K -G^T; G 0] and K = -dQ/dq - lambda_k d2phi_k; where closures
depend on each other the steps are of least size.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np
from scipy.optimize import least_squares

from substructures.analysis.arguments import positive, real, whole
from substructures.analysis.closed.constrained import Constrained
from substructures.analysis.closed.projection import consistent_state
from substructures.analysis.equations.formulas import multipliers_of
from substructures.analysis.equations.kernels import program_kernel
from substructures.analysis.equations.perturbation import perturbation
from substructures.analysis.given import numbers
from substructures.analysis.motion.problem import Start
from substructures.array import Array
from substructures.errors import InvalidArgument
from substructures.quantities.measured import numeric
from substructures.quantities.states import read_states, symbol_values
from substructures.tree.model import Model

#: forces left over, relative to the largest entry of K times 1 rad or 1 m
RESIDUAL = 1e-10
NEEDS = ("metric", "forces")
MAX_STARTS = 10_000
MAX_SEED = 2**1000
#: of the search from one start
STEPS = 200
#: of a start on a corner of a force [rad, m]
BESIDE = 1e-6
TOLERANCES = dict.fromkeys(("xtol", "ftol", "gtol"), 1e-15)


@dataclass(frozen=True)
class SearchRange:
    """Where positions of rest are looked for: ``starts`` (N, n) that are given, zero, and ``count`` random ones in
    +-pi for angles, +-``reach`` [m] for distances. Raises InvalidArgument.
    """

    starts: Sequence[float] | Sequence[Sequence[float]] | Array | None = None
    count: int = 32
    reach: float = 1.0
    seed: int = 0

    def __post_init__(self) -> None:
        whole(self.count, "count", 0, MAX_STARTS)
        object.__setattr__(self, "reach", positive(self.reach, "reach"))
        whole(self.seed, "seed", 0, MAX_SEED)


@dataclass(frozen=True)
class RestConditions:
    """What holds at rest: the time [s], ``parameters`` in place of their defaults, constant ``inputs`` [N m, N].

    Raises InvalidArgument.
    """

    t: float
    parameters: Mapping[str, float]
    inputs: Mapping[str, float]

    def __post_init__(self) -> None:
        object.__setattr__(self, "t", real(self.t, "/t"))
        object.__setattr__(self, "parameters", numbers(self.parameters, "parameters"))
        object.__setattr__(self, "inputs", numbers(self.inputs, "inputs"))


class RestSearch:
    """Forces of a tree and their Jacobian at rest, compiled."""

    def __init__(self, model: Model, within: SearchRange, conditions: RestConditions) -> None:
        n = self.n = model.dof
        self.model, self.within, self.conditions = model, within, conditions
        states = read_states(model, {"q": np.zeros(n)}, None)
        known = symbol_values(model, vars(conditions), states, NEEDS)
        values = {name: float(np.ravel(x)[0]) for name, x in known.items()}
        values |= {f"{name}''": 0.0 for name in model.coordinates}
        self.q, self.F, self.K = np.zeros((1, n)), np.zeros((1, n)), np.zeros((1, n, n))
        outputs, columns = self._also()
        outputs |= {"residual": self.F, "stiffness": self.K}
        columns.append((list(model.coordinates), self.q))
        self.run = program_kernel(perturbation(model)).bind(outputs, values, columns=columns)
        # places in +-pi for angles, +-reach for distances
        turning = [kind == "R" for kind in model.joints]
        self.size = np.where(turning, np.pi, within.reach)
        self.turning = np.array([t and self._is_periodic(a) for a, t in enumerate(turning)], dtype=bool)

    def _also(self) -> tuple[dict[str, Array], list[tuple[list[str], Array]]]:
        """Further outputs and columns of the kernel."""
        return {}, []

    def _is_periodic(self, a: int) -> bool:
        """Whether a full turn changes nothing (no spring in the joint)."""
        q = np.linspace(0.3, 0.9, self.n)
        before, turned = (self._judged(q + x * np.eye(len(q))[a]) for x in (0, 2 * np.pi))
        return bool(np.abs(turned - before).max() <= 1e-9 * max(1.0, float(np.abs(before).max())))

    def _judged(self, q: Array) -> Array:
        """What must be zero."""
        return self.at(q)[0]

    def starts(self) -> Array:
        """Those given, zero, and random ones, (N, n)."""
        rng = np.random.default_rng(self.within.seed)
        rows = [np.zeros((1, self.n)), rng.uniform(-1, 1, (self.within.count, self.n)) * self.size]
        if self.within.starts is not None:
            n, given = self.model.dof, np.atleast_2d(numeric(self.within.starts, "/starts"))
            if given.ndim != 2 or given.shape[1] != n:
                message = f"shape {given.shape} found, (N, {n}) expected"
                raise InvalidArgument.at("/starts", "wrong-length", message)
            rows.insert(0, self._of_all(given))
        return np.concatenate(rows)

    def _of_all(self, rows: Array) -> Array:
        """Of rows (N, n) for all coordinates those that are looked for."""
        return rows

    def at(self, q: Array) -> tuple[Array, Array]:
        """-Q and its Jacobian at rest."""
        self.q[0] = q
        self.run()
        return self.F[0].copy(), self.K[0].copy()

    def held(self, starts: Array) -> list[int]:
        """Coordinates on which nothing depends."""
        sizes = np.array([np.abs(self._slopes(q)).max(axis=0) for q in starts[:: max(1, len(starts) // 8)]]).max(axis=0)
        return np.flatnonzero(sizes <= 1e-13 * sizes.max(initial=0)).tolist()

    def _slopes(self, q: Array) -> Array:
        """Derivatives of what must be zero."""
        return self.at(q)[1]

    def solve(self, start: Array, moving: Sequence[int]) -> Array | None:
        """An equilibrium near a start; None when there is none in reach."""
        q = start.copy()

        def both(x: Array) -> tuple[Array, Array]:
            """Forces and their Jacobian at free coordinates x."""
            q[moving] = x
            F, K = self.at(q)
            # a corner of a force, as of an end stop, has no derivative: any will do on the way
            return F, np.where(np.isfinite(K[:, moving]), K[:, moving], 0)

        if len(moving):
            if not np.isfinite(self.at(q)[1]).all():
                q[moving] += BESIDE
            with np.errstate(all="ignore"):
                q[moving] = least_squares(lambda x: both(x)[0], q[moving].copy(), lambda x: both(x)[1], **TOLERANCES).x
            q[moving] += self._last_step(q, moving)
        F, K = self.at(q)
        # |Q| <= 1e-10 max(1, |K|)
        if not np.abs(F).max(initial=0) <= RESIDUAL * max(1.0, float(np.abs(K).max(initial=0))):
            return None
        return self._wound(q)

    def _wound(self, q: Array) -> Array:
        """Angles in (-pi, pi]."""
        # pi - (pi - q mod 2 pi)
        return np.where(self.turning, np.pi - np.mod(np.pi - q, 2 * np.pi), q)

    def _last_step(self, q: Array, moving: Sequence[int]) -> Array:
        """One step of Newton's method, of least size where K is singular."""
        F, K = self.at(q)
        if not (np.isfinite(F).all() and np.isfinite(K).all()):
            return np.zeros(len(moving))
        # K dq = Q, with F = -Q
        step = np.linalg.lstsq(K[:, moving], -F, rcond=1e-10)[0]
        return np.asarray(step if np.abs(step).max(initial=0) < 1e-3 else np.zeros(len(moving)))

    def distance(self, p: Array, q: Array) -> float:
        """Largest difference of coordinates, of angles by the shorter way."""
        d = np.abs(p - q)
        return float(np.where(self.turning, np.minimum(d, np.abs(2 * np.pi - d)), d).max(initial=0))

    def advice(self, q: Array, held: Sequence[int]) -> str:
        """Why there is none."""
        F, _ = self.at(q)
        names = ", ".join(f"'{self.model.coordinates[a]}'" for a in held if abs(F[a]) > RESIDUAL)
        if names:
            return f"nothing balances the constant force on {names}: change gravity or inputs, or add a spring"
        return "no equilibrium was found: give 'starts' near one, or raise 'count' and 'reach'"


class ClosedSearch(RestSearch):
    """Forces, closures and their Jacobians at rest, compiled."""

    def __init__(self, model: Model, within: SearchRange, conditions: RestConditions) -> None:
        super().__init__(model, within, conditions)
        start = Start([0.0] * model.dof, parameters=conditions.parameters, inputs=conditions.inputs)
        self.s = Constrained(model, start, (conditions.t, conditions.t))
        self.open = ""

    def _also(self) -> tuple[dict[str, Array], list[tuple[list[str], Array]]]:
        names = multipliers_of(self.model)
        m, n = len(names), self.model.dof
        self.multipliers, self.phi, self.G = np.ones((1, m)), np.zeros((1, m)), np.zeros((1, m, n))
        return {"closure.residual": self.phi, "closure.jacobian": self.G}, [(list(names), self.multipliers)]

    def _judged(self, q: Array) -> Array:
        return np.concatenate((self.at(q)[0], self.phi[0]))

    def _slopes(self, q: Array) -> Array:
        return np.concatenate((self.at(q)[1], self.G[0]))

    def solve(self, start: Array, moving: Sequence[int]) -> Array | None:
        """A closed equilibrium near a start; None when there is none in reach."""
        rest = np.zeros(len(start))
        state = consistent_state(self.s, self.conditions.t, start, rest)
        if not state.found:
            self.open = state.message
            return None
        q, k = state.q.copy(), len(moving)
        self.multipliers[:] = 0
        F, K = self.at(q)
        scale = max(1.0, float(np.abs(K).max(initial=0)))

        def both(x: Array) -> tuple[Array, Array]:
            """Residuals and their Jacobian at free coordinates and multipliers."""
            q[moving], self.multipliers[0] = x[:k], x[k:]
            F, K = self.at(q)
            G = self.G[0]
            # F = -Q - lambda G and phi, by q and lambda; phi in the units of forces
            K = np.where(np.isfinite(K), K, 0)
            J = np.block([[K[:, moving], -G.T], [scale * G[:, moving], np.zeros((len(G), len(G)))]])
            return np.concatenate((F, scale * self.phi[0])), J

        # lambda_0 of least squares: G^T lambda = -Q
        x = np.concatenate((q[moving], np.linalg.lstsq(self.G[0].T, F, rcond=1e-8)[0]))
        with np.errstate(all="ignore"):
            x = least_squares(lambda x: both(x)[0], x, lambda x: both(x)[1], max_nfev=STEPS, **TOLERANCES).x
        residual, J = both(x)
        if np.isfinite(residual).all() and np.isfinite(J).all():
            step = np.linalg.lstsq(J, -residual, rcond=1e-10)[0]
            residual, J = both(x + step if np.abs(step[:k]).max(initial=0) < 1e-3 else x)
        size = float(np.abs(self.K[np.isfinite(self.K)]).max(initial=0))
        if not np.abs(residual).max(initial=0) <= RESIDUAL * max(scale, size):
            return None
        self.s.move(self.conditions.t, q, rest)
        return None if self.s.upside_down() else self._wound(q)

    def advice(self, q: Array, held: Sequence[int]) -> str:
        """Why there is none."""
        return self.open or super().advice(q, held)
