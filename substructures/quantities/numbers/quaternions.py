"""Quaternions in the states of ball and floating joints."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from substructures.array import Array
from substructures.errors import InvalidArgument
from substructures.mechanics.state_names import BallRow

#: how far the norm of a quaternion that is given may be from 1
TOLERANCE = 1e-6


def with_unit_quaternions(positions: Sequence[str], balls: Sequence[BallRow], rows: Array, place: str = "/q") -> Array:
    """States (N, n) of a model, with the quaternions of its balls over their norms.

    Raises InvalidArgument for a norm that is off by more than TOLERANCE.
    """
    if not balls:
        return rows
    result = rows.copy()
    for ball in balls:
        names = ball["positions"][-4:]
        some = [positions.index(name) for name in names]
        norms = np.linalg.norm(rows[:, some], axis=1)
        wrong = np.flatnonzero(~(np.abs(norms - 1) <= TOLERANCE))
        if len(wrong):
            message = (
                f"the norm of the quaternion {', '.join(names)} is {norms[wrong[0]]:.9g} in state {wrong[0]}, not 1"
            )
            raise InvalidArgument.at(place, "not-a-unit-quaternion", f"{message}: 1, 0, 0, 0 turns nothing")
        result[:, some] = rows[:, some] / norms[:, None]
    return result
