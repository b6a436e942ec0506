"""The search for positions of rest: forces and their Jacobian, compiled, and Newton's method from many starts."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Annotated, Any

import numpy as np
from pydantic import Field
from scipy.optimize import least_squares

from substructures.analysis.equations.kernels import program_kernel
from substructures.analysis.equations.perturbation import perturbation
from substructures.array import Array
from substructures.documents import DocumentPart
from substructures.documents.fields import Positive, Real
from substructures.errors import InvalidDocument
from substructures.quantities.states import numeric, read_states, symbol_values
from substructures.tree.model import Model

#: forces left over, relative to the largest entry of K times 1 rad or 1 m
RESIDUAL = 1e-10
NEEDS = ("metric", "forces")


class EquilibriaRequest(DocumentPart):
    """Where to look: ``starts`` (N, n), and ``count`` random ones in +-pi for angles, +-``reach`` for distances."""

    starts: Any = None
    count: Annotated[int, Field(ge=0, le=10_000)] = 32
    reach: Positive = Field(1.0, description="m")
    seed: Annotated[int, Field(ge=0)] = 0
    t: Real = 0.0
    parameters: dict[str, Real] = Field({}, description="in place of their defaults")
    inputs: dict[str, Real] = Field({}, description="constant; 0 by default")


class RestSearch:
    """Forces of a tree and their Jacobian at rest, compiled."""

    def __init__(self, model: Model, read: EquilibriaRequest) -> None:
        n = model.dof
        self.model, self.read = model, read
        states = read_states(model, {"q": np.zeros(n)}, None)
        given = {"parameters": read.parameters, "inputs": read.inputs, "t": read.t}
        values = {name: float(np.ravel(x)[0]) for name, x in symbol_values(model, given, states, NEEDS).items()}
        values |= {f"{name}''": 0.0 for name in model.coordinates}
        self.q, self.F, self.K = np.zeros((1, n)), np.zeros((1, n)), np.zeros((1, n, n))
        outputs, columns = self._also()
        outputs |= {"residual": self.F, "stiffness": self.K}
        columns.append((list(model.coordinates), self.q))
        self.run = program_kernel(perturbation(model)).bind(outputs, values, columns=columns)
        turning = [kind == "R" for kind in model.joints]
        self.size = np.where(turning, np.pi, read.reach)
        self.turning = np.array([t and self._is_periodic(a) for a, t in enumerate(turning)], dtype=bool)

    def _also(self) -> tuple[dict[str, Array], list[tuple[list[str], Array]]]:
        """Further outputs and columns of the kernel."""
        return {}, []

    def _is_periodic(self, a: int) -> bool:
        """Whether a full turn changes nothing (no spring in the joint)."""
        q = np.linspace(0.3, 0.9, self.model.dof)
        before, turned = (self._judged(q + x * np.eye(len(q))[a]) for x in (0, 2 * np.pi))
        return bool(np.abs(turned - before).max() <= 1e-9 * max(1.0, float(np.abs(before).max())))

    def _judged(self, q: Array) -> Array:
        """What must be zero."""
        return self.at(q)[0]

    def starts(self) -> Array:
        """Those given, zero, and random ones, (N, n)."""
        n, rng = self.model.dof, np.random.default_rng(self.read.seed)
        rows = [np.zeros((1, n)), rng.uniform(-1, 1, (self.read.count, n)) * self.size]
        if self.read.starts is not None:
            given = np.atleast_2d(numeric(self.read.starts, "/starts"))
            if given.ndim != 2 or given.shape[1] != n:
                message = f"shape {given.shape} found, (N, {n}) expected"
                raise InvalidDocument.at("/starts", "wrong-length", message)
            rows.insert(0, given)
        return np.concatenate(rows)

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
            q[moving] = x
            F, K = self.at(q)
            return F, K[:, moving]

        if len(moving):
            with np.errstate(all="ignore"):
                q[moving] = least_squares(
                    lambda x: both(x)[0], start[moving], lambda x: both(x)[1], xtol=1e-15, ftol=1e-15, gtol=1e-15
                ).x
            q[moving] += self._last_step(q, moving)
        F, K = self.at(q)
        if not np.abs(F).max(initial=0) <= RESIDUAL * max(1.0, float(np.abs(K).max(initial=0))):
            return None
        return self._wound(q)

    def _wound(self, q: Array) -> Array:
        """Angles in (-pi, pi]."""
        return np.where(self.turning, np.pi - np.mod(np.pi - q, 2 * np.pi), q)

    def _last_step(self, q: Array, moving: Sequence[int]) -> Array:
        """One step of Newton's method, of least size where K is singular."""
        F, K = self.at(q)
        if not (np.isfinite(F).all() and np.isfinite(K).all()):
            return np.zeros(len(moving))
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
