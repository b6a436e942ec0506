"""Quaternions in the states of ball and floating joints."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from substructures.array import Array
from substructures.errors import InvalidArgument
from substructures.mechanics.balls import quaternion_rates, turned_by
from substructures.mechanics.state_names import BallRow

#: how far the norm of a quaternion that is given may be from 1
TOLERANCE = 1e-6
#: turns [rad] below which a series is taken
SMALL = 1e-4


def with_unit_quaternions(positions: Sequence[str], balls: Sequence[BallRow], rows: Array, place: str = "/q") -> Array:
    """States (N, n) of a model, with the quaternions of its balls over their norms.

    Raises InvalidArgument for a norm that is off by more than TOLERANCE.
    """
    if not balls:
        return rows
    result = rows.copy()
    for ball, some in zip(balls, quaternions_in(positions, balls), strict=True):
        norms = np.linalg.norm(rows[:, some], axis=1)
        wrong = np.flatnonzero(np.abs(norms - 1) > TOLERANCE)
        if len(wrong):
            names = ", ".join(ball["positions"][-4:])
            message = f"the norm of the quaternion {names} is {norms[wrong[0]]:.9g} in state {wrong[0]}, not 1"
            raise InvalidArgument.at(place, "not-a-unit-quaternion", f"{message}: 1, 0, 0, 0 turns nothing")
        result[:, some] = rows[:, some] / norms[:, None]
    return result


def quaternions_in(positions: Sequence[str], balls: Sequence[BallRow]) -> list[list[int]]:
    """The places (w, x, y, z) of all quaternions in a state q."""
    return [[positions.index(name) for name in ball["positions"][-4:]] for ball in balls]


def at_zero(positions: Sequence[str], balls: Sequence[BallRow]) -> Array:
    """The state q (m,) of zeros, whose quaternions turn nothing."""
    result = np.zeros(len(positions))
    result[[some[0] for some in quaternions_in(positions, balls)]] = 1
    return result


def moved_on(
    positions: Sequence[str], coordinates: Sequence[str], balls: Sequence[BallRow], q: Array, d: Array
) -> Array:
    """Where a state q (m,) comes at constant rates, d (n,) in all: Q exp(w/2), and p + R (int_0^1 exp(s [w]x) ds) v."""
    result, moved = (dict(zip(names, x.tolist(), strict=True)) for names, x in ((positions, q), (coordinates, d)))
    result |= {name: result[name] + x for name, x in moved.items() if name in result}
    for ball in balls:
        names, rates = ball["positions"], np.array([moved[name] for name in ball["velocities"]])
        old, w, angle = [result[name] for name in names[-4:]], rates[-3:], float(np.linalg.norm(rates[-3:]))
        sinc = float(np.sinc(angle / 2 / np.pi))
        new = np.cos(angle / 2) * np.array(old) + np.array(quaternion_rates(old, w.tolist(), sinc / 2))
        result |= dict(zip(names[-4:], new.tolist(), strict=True))
        if len(names) > len(old):
            across = np.cross(w, v := rates[:3])
            third = (1 - float(np.sinc(angle / np.pi))) / angle**2 if angle > SMALL else 1 / 6
            way = np.array(turned_by(old, 2.0)).T @ (v + sinc**2 / 2 * across + third * np.cross(w, across))
            result |= {name: result[name] + x for name, x in zip(names[:3], way.tolist(), strict=True)}
    return np.array([result[name] for name in positions])


def by_displacements(positions: Sequence[str], coordinates: Sequence[str], balls: Sequence[BallRow], q: Array) -> Array:
    """Displacements (n, m) of the changes of the m numbers of a state q, in the axes of bodies as rates are."""
    columns, rows = ({name: i for i, name in enumerate(some)} for some in (positions, coordinates))
    result = np.zeros((len(coordinates), len(positions)))
    own = [name for name in coordinates if name in columns]
    result[[rows[name] for name in own], [columns[name] for name in own]] = 1
    for ball in balls:
        at, moved = [columns[name] for name in ball["positions"]], [rows[name] for name in ball["velocities"]]
        quaternion, square = q[at[-4:]].tolist(), float(q[at[-4:]] @ q[at[-4:]])
        # d = 2 Q^-1 dQ, and R^T dp
        turns = [quaternion_rates(quaternion, e, 2.0 / square) for e in np.eye(3).tolist()]
        result[np.ix_(moved[-3:], at[-4:])] = np.array(turns)
        if len(at) > len(quaternion):
            result[np.ix_(moved[:3], at[:3])] = np.array(turned_by(quaternion, 2 / square))
    return result
