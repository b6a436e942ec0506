"""The period of a tree of one coordinate by a quadrature of its energy, which knows nothing of its motion.

With E = 1/2 g q'^2 + U(q), where U = V, or V - T_0 of what is given,

    T = closed integral of sqrt(g / (2 (E - U))) dq

between the places where E = U, or over whole turns. With q = m + h cos s there the integrand is a smooth periodic
function of s, of which the midpoint rule takes in every digit as points become more (L. D. Landau and E. M. Lifshitz,
Mechanics, 1976, section 11; L. N. Trefethen and J. A. C. Weideman, SIAM Review 56, 2014).
"""

from __future__ import annotations

from collections.abc import Callable, Mapping

import numpy as np
import scipy

from substructures.analysis.motion.trajectory import Trajectory
from substructures.array import Array
from substructures.expr.interpret import interpret_in_blocks
from substructures.tree.model import Model

#: most points, and what may change from half as many, relative
MOST, SAME = 2**14, 1e-11
#: the way beyond the last result in which a turning point is looked for, relative to the range
NEAR = 0.1


def period_by_quadrature(
    model: Model, values: Mapping[str, float], motion: Trajectory, turns: float = 0.0
) -> float | None:
    """T [s] of the orbit of a motion over a period of it; None where the energy at rest does not tell, as near a
    separatrix. ``values``: of parameters and inputs; ``turns``: what the coordinate gains in a period [rad].
    """

    def at(q: Array) -> tuple[Array, Array]:
        """g and U."""
        names = ["metric", "potential_energy", *(("T_0",) if model.given else ())]
        found = interpret_in_blocks(model.program, {**values, model.coordinates[0]: q}, names, len(q))
        drives = found["T_0"] if model.given else 0.0
        return np.ravel(found["metric"]), np.ravel(found["potential_energy"] - drives)

    q, qd = motion.q[:, 0], motion.qd[:, 0]
    g, U = at(q[:1])
    E = float(g[0] * qd[0] ** 2 / 2 + U[0])
    if turns:
        middle, half, ways = float(q[0] + turns / 2), abs(turns) / 2, 1
    else:
        ends = [_turning(lambda x: E - float(at(np.array([x]))[1][0]), q, sign) for sign in (-1, 1)]
        if None in ends:
            return None
        low, high = (float(x) for x in ends if x is not None)
        middle, half, ways = (low + high) / 2, (high - low) / 2, 2

    def integral(count: int) -> float:
        """Over s from 0 to pi, or over a turn."""
        s = (np.arange(count) + 0.5) / count
        x, slope = (middle + half * (2 * s - 1), 2 * half) if turns else (
            middle + half * np.cos(np.pi * s), np.pi * half * np.sin(np.pi * s))  # fmt: skip
        g, U = at(x)
        with np.errstate(invalid="ignore", divide="ignore"):
            return ways * float(np.mean(slope * np.sqrt(g / (2 * (E - U)))))

    return _settled(integral)


def _turning(left: Callable[[float], float], q: Array, sign: int) -> float | None:
    """The place beyond the outermost result where nothing is left of E - U."""
    inner, reach = float(np.median(q)), float(np.ptp(q)) * NEAR
    outer = float(q.max() if sign > 0 else q.min())
    # within the orbit something is left; at the outermost result next to nothing
    for part in (1e-6, 1e-4, 1e-2, 1.0):
        beyond = outer + sign * reach * part
        if left(beyond) < 0 < left(inner):
            found: float = scipy.optimize.brentq(left, inner, beyond, xtol=1e-15, rtol=1e-15)
            return found
    return None


def _settled(integral: Callable[[int], float]) -> float | None:
    """The value, when twice as many points give no other."""
    before, count = integral(32), 64
    while count <= MOST:
        now = integral(count)
        if abs(now - before) <= SAME * abs(now):
            return now
        before, count = now, 2 * count
    return None
