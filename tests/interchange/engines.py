"""Robot files in other engines: the same quantities as ours at the same states, in the order of our coordinates.

A joint that is free or spherical has there a quaternion, and here positions and yaw, pitch, roll: with v = T q',
M_ours = T^T M T and so on (velocity_map).
"""

# ruff: noqa: N803, N806 -- symbols of the notation

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np

Array = Any


def euler_matrix(yaw: float, pitch: float, roll: float) -> Array:
    """R = Rz(yaw) Ry(pitch) Rx(roll)."""
    cy, sy, cp, sp, cr, sr = (f(x) for x in (yaw, pitch, roll) for f in (np.cos, np.sin))
    return np.array(
        [
            [cy * cp, cy * sp * sr - sy * cr, cy * sp * cr + sy * sr],
            [sy * cp, sy * sp * sr + cy * cr, sy * sp * cr - cy * sr],
            [-sp, cp * sr, cp * cr],
        ]
    )


def euler_rates(pitch: float, roll: float, dpitch: float, droll: float) -> tuple[Array, Array]:
    """B with omega (in the turned frame) = B (yaw', pitch', roll'), and its time derivative."""
    cp, sp, cr, sr = np.cos(pitch), np.sin(pitch), np.cos(roll), np.sin(roll)
    B = np.array([[-sp, 0, 1], [cp * sr, cr, 0], [cp * cr, -sr, 0]])
    dB = np.array(
        [
            [-cp * dpitch, 0, 0],
            [-sp * dpitch * sr + cp * cr * droll, -sr * droll, 0],
            [-sp * dpitch * cr - cp * sr * droll, -cr * droll, 0],
        ]
    )
    return B, dB


def quaternion(R: Array) -> Array:
    """(w, x, y, z) of a rotation that is no half turn."""
    w = np.sqrt(max(1 + np.trace(R), 0)) / 2
    return np.array([w, (R[2, 1] - R[1, 2]) / (4 * w), (R[0, 2] - R[2, 0]) / (4 * w), (R[1, 0] - R[0, 1]) / (4 * w)])


@dataclass
class Place:
    """A joint there: its kind (one, ball, free), first index of positions and velocities; ours: indices here."""

    kind: str
    q: int
    v: int
    ours: list[int]


@dataclass
class Numbers:
    """M, forces of gravity, bias, inverse dynamics of q, q', q'' and forward dynamics of zero forces of actuators."""

    metric: Array
    gravity: Array
    bias: Array
    inverse_dynamics: Array
    forward_dynamics: Array | None  #: None where the metric is singular


class Reduced:
    """Another engine with joints that follow others: q = N y + q_0 of our coordinates y; ``positions``: N of states q
    that are no coordinates.
    """

    def __init__(self, twin: Any, N: Array, q0: Array, positions: Array | None = None) -> None:
        self.twin, self.N, self.q0, self.positions = twin, N, q0, N if positions is None else positions

    def numbers(self, q: Array, qd: Array, qdd: Array) -> Numbers:
        """At a state of ours."""
        N = self.N
        found = self.twin.numbers(self.positions @ q + self.q0, N @ qd, N @ qdd)
        M, needed = N.T @ found.metric @ N, N.T @ found.inverse_dynamics
        is_regular = np.linalg.matrix_rank(M) == len(qd)
        forward = qdd - np.linalg.solve(M, needed) if is_regular else None
        return Numbers(M, N.T @ found.gravity, N.T @ found.bias, needed, forward)


def velocity_map(places: list[Place], nv: int, q: Array, qd: Array, local: bool) -> tuple[Array, Array]:
    """T and T' with v = T q'; of free joints v is the velocity of the origin in the world, or (local) in the body."""
    n = len(q)
    T, dT = np.zeros((nv, n)), np.zeros((nv, n))
    for place in places:
        if place.kind == "one":
            T[place.v, place.ours[0]] = 1
            continue
        turning, v = place.ours[-3:], place.v
        B, dB = euler_rates(q[turning[1]], q[turning[2]], qd[turning[1]], qd[turning[2]])
        if place.kind == "free":
            at = np.ix_(range(v, v + 3), place.ours[:3])
            T[at] = np.eye(3)
            if local:
                x, y, z = B @ qd[turning]
                T[at] = euler_matrix(*q[turning]).T
                dT[at] = -np.array([[0, -z, y], [z, 0, -x], [-y, x, 0]]) @ T[at]
            v += 3
        T[np.ix_(range(v, v + 3), turning)] = B
        dT[np.ix_(range(v, v + 3), turning)] = dB
    return T, dT


def is_singular(metric: Array) -> bool:
    """Whether the metric, scaled to a unit diagonal, has no inverse in doubles: massless links that move."""
    diagonal = np.diag(metric)
    if (diagonal <= 0).any():
        return True
    scale = 1 / np.sqrt(diagonal)
    return len(metric) > 0 and bool(np.linalg.cond(metric * scale * scale[:, None]) > 1e13)


def in_our_coordinates(
    T: Array, dT: Array, qd: Array, M: Array, gravity: Array, bias: Array, passive: Array, qdd: Array
) -> Numbers:
    """From M, forces of gravity, bias (M-weighted velocity forces) and passive joint forces in their velocities."""
    metric = T.T @ M @ T
    # v' = T q'' + T' q'
    velocity = T.T @ (bias + M @ (dT @ qd))
    forces = T.T @ (gravity + passive)
    return Numbers(
        metric,
        T.T @ gravity,
        velocity,
        metric @ qdd + velocity - forces,
        None if is_singular(metric) else np.linalg.solve(metric, forces - velocity),
    )


def deviation(found: Any, expected: Numbers, state: int) -> float:
    """The largest deviation of all quantities, each relative to its largest element; NaN is infinitely large."""
    worst = 0.0
    # what cancels has no scale of its own
    least = {name: 1e-4 * np.abs(expected.inverse_dynamics).max(initial=0) for name in ("gravity", "bias")}
    for name in ("metric", "gravity", "bias", "inverse_dynamics", "forward_dynamics"):
        ours, theirs = found[name][state], getattr(expected, name)
        if theirs is None:
            continue
        error = np.abs(ours - theirs).max(initial=0) / max(np.abs(theirs).max(initial=0), least.get(name, 0), 1e-6)
        worst = max(worst, float(error) if np.isfinite(error) else np.inf)
    return worst
