"""Positions of motions with constraints in numbers: on the closures, whose rows are among those of B."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import numpy as np

from substructures.analysis.equations.nonholonomic.quasi_velocities import QuasiVelocities
from substructures.array import Array
from substructures.errors import InvalidArgument
from substructures.expr.interpret import interpret_in_blocks

#: what may be left of closures [m, 1]; steps of Newton's method onto them
CLOSED, STEPS = 1e-9, 30


def closed_positions(equations: QuasiVelocities, values: Mapping[str, Any], q: Array) -> Array:
    """Positions (M, n) moved onto the closures by Newton's steps of least length; ``values``: of all other symbols,
    numbers or (M,). Raises InvalidArgument (``/q``, ``open-closure``) where they stay open.
    """
    names = {f"{closure.name}.{row}" for closure in equations.model.closures for row in closure.rows}
    gaps = [k for k, name in enumerate(equations.gaps) if name in names]
    rows = [k for k, name in enumerate(equations.constraints) if name in names]
    if not gaps:
        return q
    q = q.copy()
    for _ in range(STEPS):
        found = at_rest(equations, values, q, ["gaps", "constraints"])
        opened = np.nan_to_num(found["gaps"][:, gaps], nan=np.inf)
        if np.abs(opened).max(initial=0) < CLOSED * 1e-3 or not np.isfinite(opened).all():
            break
        # gaps also of rows that follow from others, whose motion these have
        q -= (np.linalg.pinv(found["constraints"][:, rows], rcond=1e-9) @ _held(opened, gaps, rows, equations))[:, :, 0]
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
