"""Equilibria of many parameter sets at once, by Newton's method: Q(q, 0) = 0, K = -dQ/dq (notation.md, section 7)."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from substructures.analysis.equations.formulas import require_moving, unsteady
from substructures.analysis.equations.perturbation import perturbation, require_smooth
from substructures.analysis.stability.operating_point import AT_REST
from substructures.array import Array
from substructures.errors import InvalidArgument, among
from substructures.quantities.numbers.evaluation import EvaluationOptions, evaluate
from substructures.quantities.numbers.quaternions import moved_on
from substructures.quantities.numbers.states import known_values, read_states
from substructures.sweeps.document import EquilibriumColumn
from substructures.sweeps.grouped import alike, check_fields, inside
from substructures.sweeps.shapes import Shape
from substructures.tree.cuts import require_open

STATE = ("q", "qd", "inputs", "t")
MATRICES = ("metric", "damping", "stiffness")
STEPS, LONGEST = 60, 0.5  # of Newton's method; rad or m
#: relative to the largest; smaller singular values of K are of coordinates that nothing holds
FREE = 1e-12


@dataclass(frozen=True)
class AtRest:
    """What ``at`` says of the rows of a shape, without velocities."""

    shape: Shape
    at: Mapping[str, Any]
    parameters: Mapping[str, Any]
    rows: int

    @property
    def start(self) -> Array:
        """The state (rows, m) of ``at``. Raises InvalidInput."""
        model = self.shape.model
        require_open(model.closures, "sweep other columns")
        require_moving(model, "columns of equilibria and linearisations")
        require_smooth(model)
        check_fields(self.at, STATE)
        if why := unsteady(model, self.at.get("inputs") or {}):
            raise InvalidArgument.at("", "not-steady", f"{why}: sweep other columns")
        states = read_states(model, self.at, 1)
        if states.qd.any():
            raise InvalidArgument.at("/qd", "not-at-rest", "an equilibrium is at rest: leave 'qd' out")
        return np.broadcast_to(states.q, (self.rows, len(model.positions)))

    @property
    def still(self) -> Array:
        """No rates (rows, n)."""
        return np.zeros((self.rows, self.shape.model.dof))

    def accelerations(self, q: Array) -> Array:
        """q'', or changes of rates, (rows, n) [rad/s^2, m/s^2]: g^-1 Q."""
        more = {name: self.at[name] for name in ("inputs", "t") if name in self.at}
        options = EvaluationOptions(evaluator=self.shape.evaluate)
        sources, zero = self.shape.sources, self.still
        found = evaluate(sources, "forward_dynamics", q, zero, parameters=self.parameters, options=options, **more)
        return np.asarray(found["forward_dynamics"]).reshape(self.rows, -1)

    def matrices(self, q: Array, qdd: Array) -> tuple[Array, Array, Array]:
        """M, D, K (rows, n, n) of M dq'' + D dq' + K dq = 0 about q, with the forces that hold it there; of ball joints
        dq has displacements and rotation vectors in the axes of bodies.
        """
        model = self.shape.model
        states = read_states(model, {"q": q, "qd": self.still, "qdd": np.nan_to_num(qdd)}, None)
        values = known_values(model, {**self.at, "parameters": self.parameters}, states, model.parameters)
        found = self.shape.evaluate(perturbation(model), values, list(MATRICES), self.rows)
        M, D, K = (np.asarray(found[name]) for name in MATRICES)
        return M, D, K

    def is_rest(self, q: Array, qdd: Array, M: Array, K: Array) -> NDArray[np.bool_]:
        """Where accelerations are rounding beside what a unit displacement causes, as for one state."""
        good: NDArray[np.bool_] = np.asarray(np.isfinite(q).all(axis=1) & np.isfinite(qdd).all(axis=1))
        for matrix in (M, K):
            good = good & np.isfinite(matrix).all(axis=(1, 2))
        good = good & (np.linalg.slogdet(np.where(good[:, None, None], M, 1.0))[0] != 0)  # a determinant may underflow
        if good.any():
            unit = np.abs(np.linalg.solve(M[good], K[good])).max(axis=2, initial=0)
            good[good] = (np.abs(qdd[good]) <= AT_REST * np.fmax(1.0, unit)).all(axis=1)
        return good

    def settled(self) -> Array:
        """The equilibrium (rows, m) that Newton's method finds from ``at``; NaN where it finds none."""
        # M dq'' = Q and K dq = Q: dq = K^+ M q'' (free coordinates stay), no longer than LONGEST
        q, model = np.array(self.start), self.shape.model
        found, runs = np.full_like(q, np.nan), np.ones(self.rows, dtype=np.bool_)
        for _ in range(STEPS):
            qdd = self.accelerations(q)
            M, _, K = self.matrices(q, self.still)
            runs &= np.isfinite(qdd).all(axis=1) & np.isfinite(K).all(axis=(1, 2))
            if not runs.any():
                break
            there = runs & self.is_rest(q, qdd, M, K)
            force = M[runs] @ qdd[runs][:, :, None]
            step = (np.linalg.pinv(K[runs], rcond=FREE) @ force)[:, :, 0]
            size = np.abs(step).max(axis=1, keepdims=True)
            step *= np.minimum(1.0, LONGEST / np.fmax(size, LONGEST))
            q[runs] = moved_on(model.positions, model.coordinates, model.balls, q[runs], step)
            found[there] = q[there]  # one step beyond what counts as rest: down to rounding
            runs &= ~there
        return found


def equilibrium_columns(
    shape: Shape, columns: Mapping[str, EquilibriumColumn], parameters: Mapping[str, Any], rows: int
) -> dict[str, Array]:
    """The coordinates, or positions of ball joints, of equilibria (rows,) [rad, m], NaN where none is found.

    Raises InvalidInput, MissingValue.
    """
    found, names = dict[str, Array](), shape.model.positions
    for same in alike({name: column.at for name, column in columns.items()}):
        for name in same:
            of = columns[name].of
            if of not in names:
                message = f"unknown coordinate '{of[:80]}'{among(of, names)}"
                raise InvalidArgument.at(f"/columns/{name}/of", "unknown-coordinate", message)
        with inside(f"/columns/{same[0]}/at"):
            q = AtRest(shape, columns[same[0]].at, parameters, rows).settled()
        found |= {name: q[:, names.index(columns[name].of)] for name in same}
    return found


ANALYSES = {"equilibrium": equilibrium_columns}
