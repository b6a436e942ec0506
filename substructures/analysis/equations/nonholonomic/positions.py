"""Starts of motions with constraints in numbers: positions on closures, and quasi-velocities."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np

from substructures.analysis.equations.nonholonomic.quasi_velocities import QuasiVelocities
from substructures.array import Array
from substructures.errors import InvalidArgument, among
from substructures.expr.interpret import interpret, interpret_in_blocks
from substructures.quantities.measured import numeric

#: what may be left of closures [m, 1]; steps of Newton's method onto them
CLOSED, STEPS = 1e-9, 30


def closure_rows(equations: QuasiVelocities) -> list[int]:
    """Which of the constraints are rows of closures."""
    names = _rows_of_closures(equations)
    return [k for k, name in enumerate(equations.constraints) if name in names]


def _rows_of_closures(equations: QuasiVelocities) -> set[str]:
    return {f"{closure.name}.{row}" for closure in equations.model.closures for row in closure.rows}


def closed_positions(
    equations: QuasiVelocities, values: Mapping[str, Any], q: Array, kept: Sequence[int] = ()
) -> Array:
    """Positions (M, n) moved onto the closures by Newton's steps of least length, in which the coordinates ``kept``
    stay; ``values``: of all other symbols, numbers or (M,). Raises InvalidArgument (``/q``, ``open-closure``) where
    they stay open.
    """
    names, rows = _rows_of_closures(equations), closure_rows(equations)
    gaps = [k for k, name in enumerate(equations.gaps) if name in names]
    if not gaps:
        return q
    q = q.copy()
    for _ in range(STEPS):
        found = at_rest(equations, values, q, ["gaps", "constraints"])
        opened = np.nan_to_num(found["gaps"][:, gaps], nan=np.inf)
        if np.abs(opened).max(initial=0) < CLOSED * 1e-3 or not np.isfinite(opened).all():
            break
        # gaps also of rows that follow from others, whose motion these have
        moving = found["constraints"][:, rows].copy()
        moving[:, :, list(kept)] = 0
        q -= (np.linalg.pinv(moving, rcond=1e-9) @ _held(opened, gaps, rows, equations))[:, :, 0]
    worst = np.abs(opened).max(axis=1, initial=0)
    if (wrong := ~(worst < CLOSED)).any():
        k = int(np.argmax(wrong))
        message = f"the closures of member {k} stay open by {worst[k]:.3g} near its start: give a closed position"
        raise InvalidArgument.at("/q", "open-closure", message)
    return q


def _held(opened: Array, gaps: list[int], rows: list[int], equations: QuasiVelocities) -> Array:
    """What is open in the rows of B."""
    places = [gaps.index(equations.gaps.index(equations.constraints[k])) for k in rows]
    return opened[:, places, None]


def at_rest(equations: QuasiVelocities, values: Mapping[str, Any], q: Array, names: list[str]) -> dict[str, Array]:
    """Outputs (M, ...) of the equations at rest in positions (M, n); ``values``: of all other symbols."""
    at = {**values, **dict.fromkeys(equations.velocities, 0.0)}
    at |= dict(zip(equations.model.coordinates, q.T, strict=True))
    found = interpret_in_blocks(equations.program, at, names, len(q))
    return {n: np.broadcast_to(x, (len(q), *equations.program.outputs[n].shape)) for n, x in found.items()}


def start_velocities(equations: QuasiVelocities, place: Mapping[str, Any], qd: Any, v: Any) -> Array:
    """The quasi-velocities (p,) that ``v`` gives, (p,) or by name, or velocities ``qd`` (n,) that meet the constraints;
    0 by default. ``place``: values of coordinates, parameters and t. Raises InvalidArgument.
    """
    names = equations.velocities
    if v is not None and qd is not None:
        raise InvalidArgument.at("/v", "two-velocities", "give either 'v' or 'qd'")
    found = interpret(equations.program, {**place, **dict.fromkeys(names, 0.0)}, ["T", "rates"])
    T, given = found["T"], found["rates"]
    if not np.isfinite(T).all():
        message = f"the velocities {', '.join(names)} do not describe the motion at this start; take others"
        raise InvalidArgument.at("/q", "singular-start", message)
    if qd is None:
        return _by_name(v, names)
    # q' = T v + r, in the sense of least squares, and exact for velocities that meet B q' + b = 0
    found_v = np.asarray(np.linalg.lstsq(T, qd - given)[0], dtype=np.float64)
    left = np.abs(T @ found_v + given - qd).max(initial=0)
    if left > 1e-9 * max(1.0, np.abs(qd).max(initial=0)):
        message = f"these velocities violate the constraints by {left:.3g}; give 'v' ({', '.join(names)}) instead"
        raise InvalidArgument.at("/qd", "violated", message)
    return found_v


def _by_name(given: Any, names: tuple[str, ...]) -> Array:
    if given is None:
        return np.zeros(len(names))
    if isinstance(given, Mapping):
        unknown = [name for name in given if name not in names]
        if unknown:
            message = f"unknown velocity '{str(unknown[0])[:80]}'{among(unknown[0], names)}"
            raise InvalidArgument.at("/v", "unknown-velocity", message)
        given = [given.get(name, 0) for name in names]
    v = numeric(given, "/v")
    if v.shape != (len(names),):
        message = f"shape {v.shape} found, ({len(names)},) expected: {', '.join(names)}"
        raise InvalidArgument.at("/v", "wrong-length", message)
    return v
