"""Members with constraints: starts that meet them, x = (q, v), and what such states are in coordinates."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import numpy as np

from substructures.analysis.equations.kernels import program_kernel
from substructures.analysis.equations.nonholonomic.positions import at_rest, closed_positions
from substructures.analysis.equations.nonholonomic.quasi_velocities import QuasiVelocities, quasi_velocity_equations
from substructures.analysis.equations.nonholonomic.solved import SECOND, solved
from substructures.analysis.motion.judges.states import Condition
from substructures.analysis.motion.problems.kinds import ConstrainedMotion
from substructures.array import Array
from substructures.documents import escape
from substructures.errors import InvalidArgument, among
from substructures.expr.interpret import interpret_in_blocks
from substructures.quantities.measured import numeric
from substructures.tree.model import Model

#: what may be left of q' - T v - r, relative to the largest velocity
MET = 1e-9


def rows_of(v: Any) -> int:
    """How many members quasi-velocities are of: (p,) or (M, p), or by name a number or (M,)."""
    if isinstance(v, Mapping):
        return max((len(x) for x in v.values() if np.ndim(x)), default=1)
    return len(v) if np.ndim(v) > 1 else 1


def constrained_start(
    model: Model, kind: ConstrainedMotion, values: Mapping[str, Any], q: Array, qd: Array | None
) -> tuple[QuasiVelocities, Array]:
    """The equations, in velocities that describe the first member well, and (q, v) (M, n+p) of the positions ``q``
    (M, n), which are moved onto the closures that are nearest, and velocities ``qd`` (M, n) that meet the constraints,
    or quasi-velocities ``kind.v``, 0 by default. ``values``: of all other symbols, numbers or (M,).

    Raises InvalidArgument (``/qd``, ``/v``, ``/q``) for a member that does not meet the constraints.
    """
    if kind.v is not None and qd is not None:
        raise InvalidArgument.at("/v", "two-velocities", "give either 'v' or 'qd'")
    first = {name: float(np.ravel(x)[0]) for name, x in values.items()}
    place = first | dict(zip(model.coordinates, q[0].tolist(), strict=True))
    equations = quasi_velocity_equations(
        model, kind.constraints, velocities=kind.velocities, independent=kind.independent, near=place
    )
    q = closed_positions(equations, values, q)
    v = np.zeros((len(q), len(equations.velocities)))
    if kind.v is not None:
        v[:] = _given(kind.v, equations.velocities, len(q))
    elif qd is not None:
        v = _of_velocities(equations, values, q, qd)
    return equations, np.concatenate([q, v], axis=1)


def full_states(equations: QuasiVelocities, values: Mapping[str, Any], x: Array) -> Array:
    """(q, q') (K, 2n) of (q, v) (K, n+p); ``values``: of all other symbols, numbers or (K,)."""
    n = equations.model.dof
    at = {**values, **dict(zip(equations.model.coordinates, x[:, :n].T, strict=True))}
    at |= dict(zip(equations.velocities, x[:, n:].T, strict=True))
    rates = interpret_in_blocks(equations.program, at, ["rates"], len(x))["rates"]
    return np.concatenate([x[:, :n], np.broadcast_to(rates, (len(x), n))], axis=1)


def accelerations(equations: QuasiVelocities, values: Mapping[str, Any], x: Array) -> Array:
    """q'' (M K, n) of (q, v) (M, K, n+p); ``values``: of all other symbols, numbers or (M, K)."""
    flat = {name: np.ravel(v) if np.ndim(v) else v for name, v in values.items()}
    state = np.ascontiguousarray(x).reshape(-1, x.shape[-1])
    names = [*equations.model.coordinates, *equations.velocities]
    return program_kernel(solved(equations)).evaluate(flat, [SECOND], columns=[(names, state)])[SECOND]


def kept_gaps(equations: QuasiVelocities, values: Mapping[str, Any], states: Array) -> list[Condition]:
    """That gaps are constant along motions (M, K, 2n): one condition, or none; ``values``: of all other symbols."""
    if not equations.gaps:
        return []
    count, times = states.shape[:2]
    flat = {name: np.ravel(v) if np.ndim(v) else v for name, v in values.items()}
    position = np.ascontiguousarray(states).reshape(count * times, -1)[:, : equations.model.dof]
    found = at_rest(equations, flat, position, ["gaps"])["gaps"].reshape(count, times, -1)
    drift = np.abs(found - found[:, :1]).max(axis=-1, initial=0)
    reason = "integrals of constraints: rolling bodies keep their distance from the plane, loops stay closed"
    everywhere = np.ones(count, dtype=bool)
    return [Condition(("gaps", "constant", reason, "m"), drift, np.ones(count), np.zeros(count), everywhere)]


def _given(v: Any, names: tuple[str, ...], count: int) -> Array:
    if isinstance(v, Mapping):
        for i, name in enumerate(v):
            if name not in names:
                message = f"unknown velocity '{str(name)[:80]}'{among(name, names, i)}"
                raise InvalidArgument.at(f"/v/{escape(name)}", "unknown-velocity", message)
        columns = [np.broadcast_to(numeric(v.get(name, 0.0), f"/v/{escape(name)}"), count) for name in names]
        return np.stack(columns, axis=1) if columns else np.zeros((count, 0))
    found = numeric(v, "/v")
    if found.shape not in ((len(names),), (1, len(names)), (count, len(names))):
        expected = f"({len(names)},) or ({count}, {len(names)})"
        message = f"shape {found.shape} found, {expected} expected: {', '.join(names)}"
        raise InvalidArgument.at("/v", "wrong-length", message)
    return found


def _of_velocities(equations: QuasiVelocities, values: Mapping[str, Any], q: Array, qd: Array) -> Array:
    """v with q' = T v + r. Raises InvalidArgument (``/qd``, ``/q``)."""
    found = at_rest(equations, values, q, ["T", "rates"])
    T, given = found["T"], found["rates"]
    if not np.isfinite(T).all():
        message = (
            f"the velocities {', '.join(equations.velocities)} do not describe the motion at all starts; take others"
        )
        raise InvalidArgument.at("/q", "singular-start", message)
    v = (np.linalg.pinv(T) @ (qd - given)[:, :, None])[:, :, 0]
    left = np.abs((T @ v[:, :, None])[:, :, 0] + given - qd).max(axis=1, initial=0)
    wrong = left > MET * np.fmax(1.0, np.abs(qd).max(axis=1, initial=0))
    if wrong.any():
        k = int(np.argmax(wrong))
        message = f"the velocities of member {k} violate the constraints by {left[k]:.3g}; give 'v' instead"
        raise InvalidArgument.at("/qd", "violated", f"{message} ({', '.join(equations.velocities)})")
    return np.asarray(v, dtype=np.float64)
