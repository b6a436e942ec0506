"""What tests of closed motions share: the two reductions, checks, and a slider-crank in closed form."""

from __future__ import annotations

from typing import Any

import numpy as np

from substructures.analysis.motion.trajectory import Trajectory

METHODS = ["projection", "partitioning"]


def right(motion: Trajectory) -> None:
    """Finished, and all checks hold; the energy drifts by less than a tenth of what is allowed."""
    assert motion.status == "finished", motion.message
    assert motion.is_right, motion.checks
    assert next(check for check in motion.checks if check.name == "energy").relative < 1e-8
    assert motion.series["position_residual"].max() < 1e-9
    assert motion.series["velocity_residual"].max() < 1e-9


def piston(a: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """x, dx/da, d2x/da2 of a slider-crank with r = 0.04, l = 0.14."""
    r, length = 0.04, 0.14
    root = np.sqrt(length**2 - (r * np.sin(a)) ** 2)
    droot = -(r**2) * np.sin(a) * np.cos(a) / root
    ddroot = -(r**2) * np.cos(2 * a) / root - droot**2 / root
    return r * np.cos(a) + root, -r * np.sin(a) + droot, -r * np.cos(a) + ddroot


def crank_inertia(a: np.ndarray) -> np.ndarray:
    """J(a) with T = J a'^2 / 2: crank, rod (its angle from sin b = -r sin a / l) and piston."""
    r, length, c = 0.04, 0.14, 0.045
    _, dx, _ = piston(a)
    db = -r * np.cos(a) / np.sqrt(length**2 - (r * np.sin(a)) ** 2)
    b = np.arcsin(-r * np.sin(a) / length)
    vx, vy = -r * np.sin(a) - c * np.sin(b) * db, r * np.cos(a) + c * np.cos(b) * db
    crank = 0.005 + 2 * 0.01**2
    return crank + 0.5 * (vx**2 + vy**2) + 0.0015 * db**2 + 0.4 * dx**2


def slope(f: Any, a: np.ndarray, h: float = 1e-3) -> np.ndarray:
    return np.asarray((8 * (f(a + h) - f(a - h)) - (f(a + 2 * h) - f(a - 2 * h))) / (12 * h))
