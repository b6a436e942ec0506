"""Quaternions in the states of ball and floating joints."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np

from substructures.array import Array
from substructures.errors import InvalidArgument
from substructures.mechanics.balls import quaternion_rates, turned_by
from substructures.mechanics.linear3 import add, apply, cross, dot, scale, transpose
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
    """Where states q (..., m) come at constant rates, d (..., n) in all: Q exp(w/2), and p + R (int_0^1 exp(s [w]x) ds)
    v.
    """
    columns, rows = ({name: i for i, name in enumerate(some)} for some in (positions, coordinates))
    own, result = [name for name in coordinates if name in columns], q.copy()
    result[..., [columns[name] for name in own]] += d[..., [rows[name] for name in own]]
    for ball in balls:
        at, moved = [columns[name] for name in ball["positions"]], [rows[name] for name in ball["velocities"]]
        old, w = [q[..., k] for k in at[-4:]], (d[..., moved[-3]], d[..., moved[-2]], d[..., moved[-1]])
        square: Any = dot(w, w)
        angle = np.sqrt(square)
        sinc, c = np.sinc(angle / 2 / np.pi), np.cos(angle / 2)
        turned = quaternion_rates(old, w, sinc / 2)
        for k, x, dx in zip(at[-4:], old, turned, strict=True):
            result[..., k] = c * x + dx
        if len(at) > len(old):
            v = d[..., moved[0]], d[..., moved[1]], d[..., moved[2]]
            across = cross(w, v)
            third = np.where(angle > SMALL, (1 - np.sinc(angle / np.pi)) / np.fmax(square, SMALL**2), 1 / 6)
            way = add(v, add(scale(sinc**2 / 2, across), scale(third, cross(w, across))))
            turns = transpose(turned_by(old, 2 / sum(x * x for x in old)))
            moved_by: Any = apply(turns, way)
            result[..., at[:3]] += np.stack(moved_by, axis=-1)
    return result


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
