"""Lyapunov exponents: the mean rates at which neighbouring motions part, by QR factors of the variational equations.

S(t_k+1) Q_k = Q_k+1 R_k+1, lambda_i = sum_k log R_k,ii / T (G. Benettin, L. Galgani, A. Giorgilli, J.-M. Strelcyn,
Lyapunov characteristic exponents for smooth dynamical systems, Meccanica 15, 1980).
"""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass
from itertools import pairwise
from typing import Literal

import numpy as np

from substructures.analysis.arguments import in_range, positive, whole
from substructures.analysis.motion.problems.output_times import OutputTimes
from substructures.analysis.motion.problems.problem import Integrator
from substructures.analysis.motion.problems.signals import Signal
from substructures.analysis.motion.problems.start import Start, StateVector
from substructures.analysis.motion.tree_problem import TreeProblem
from substructures.analysis.orbits.flow import EndsEarlyError, Flow
from substructures.analysis.verdict import Check, verdict
from substructures.array import Array
from substructures.tree.model import Model

DEFAULT = Integrator(relative_tolerance=1e-10, absolute_tolerance=1e-12)
#: parts of the time whose means are compared, and intervals between two factorisations in each
PARTS, INTERVALS = 20, 10
#: times within an interval, for the integral of the divergence
NODES, WEIGHTS = np.polynomial.legendre.leggauss(6)
#: a largest exponent is one of chaos beyond so many deviations, and so many times what a regular motion may show
SURE, REGULAR = 4.0, 4.0
DIVERGENCE = 1e-5

Character = Literal["chaotic", "regular", "unknown"]


@dataclass(frozen=True)
class LyapunovExponents:
    """``exponents`` [1/s], 2n or as many as a state has freedoms, the largest first, with their ``deviations``:
    standard errors of the means over parts of the time. ``history`` (K, 2n): the means up to the times ``t`` (K,) [s].
    ``threshold``: what a regular motion of this length may show, log(T)/T of a linear growth, some times.

    ``character``: chaotic, where the largest exponent is beyond all doubt; regular, where none is beyond the threshold;
    otherwise unknown, and a longer time says more. ``status`` is ``failed`` where a motion does not come to its end.
    """

    exponents: Array
    deviations: Array
    t: Array
    history: Array
    threshold: float
    character: Character
    reason: str
    status: Literal["finished", "failed"]
    message: str
    checks: tuple[Check, ...]

    @property
    def is_right(self) -> bool | None:
        """Whether all checks hold; None where the motion failed."""
        return verdict(self.checks, self.status == "finished")


def lyapunov_exponents(
    model: Model,
    q: StateVector | None,
    duration: float,
    *,
    qd: StateVector | None = None,
    inputs: Mapping[str, Signal] | None = None,
    parameters: Mapping[str, float] | None = None,
    transient: float = 0.0,
    intervals: int = PARTS * INTERVALS,
    integrator: Integrator = DEFAULT,
) -> LyapunovExponents:
    """The exponents of a motion of a tree from ``q``, ``qd`` over a ``duration`` [s], after a
    ``transient`` [s] that does not count; ``intervals``: between factorisations, of each part of the time as many.

    ``inputs``: numbers, tables or expressions in t alone. Raises InvalidInput (pointers start with names of arguments)
    and MissingValue.
    """
    duration, transient = positive(duration, "duration"), in_range(transient, "transient", 0, math.inf)
    count = max(PARTS, whole(intervals, "intervals", PARTS, 1_000_000) // PARTS * PARTS)
    start = Start(q, qd, parameters or {}, inputs or {})
    end = transient + duration
    problem = TreeProblem(model=model, start=start, times=OutputTimes((0.0, end)), integrator=integrator)
    flow = Flow(problem, "lyapunov-exponents")
    try:
        grown, volumes = _grown(flow, transient, duration, count, integrator)
    except EndsEarlyError as error:
        none, rows = np.zeros(0), np.zeros((0, flow.chart.width))
        return LyapunovExponents(none, none, none, rows, 0.0, "unknown", "", "failed", str(error), ())
    return _told(grown, volumes, duration)


def _grown(flow: Flow, transient: float, duration: float, count: int, integrator: Integrator) -> tuple[Array, Array]:
    """log R_ii (K, width) of each interval, and the integral of the divergence (K,)."""
    x, Q = flow.start, np.eye(flow.chart.width)
    if transient > 0:
        states, slopes = flow.move(x, Q, (0.0, transient), np.array([0.0, transient]))
        x, Q = states[-1], np.linalg.qr(slopes[-1])[0]
    ends = transient + duration * np.arange(count + 1) / count
    grown, volumes = np.zeros((count, flow.chart.width)), np.zeros(count)
    for k, (begin, end) in enumerate(pairwise(ends.tolist())):
        inner = begin + (end - begin) * (NODES + 1) / 2
        states, slopes = flow.move(x, Q, (begin, end), np.concatenate([inner, [end]]))
        Q, R = np.linalg.qr(slopes[-1])
        grown[k] = np.log(np.abs(np.diag(R)))
        volumes[k] = (end - begin) / 2 * (WEIGHTS @ flow.divergence(inner, states[:-1]))
        x = states[-1]
        if integrator.progress is not None and integrator.progress((k + 1) / count) is False:
            raise EndsEarlyError("it was cancelled")
    return grown, volumes


def _told(grown: Array, volumes: Array, duration: float) -> LyapunovExponents:
    count = len(grown)
    t = duration * np.arange(1, count + 1) / count
    history = np.cumsum(grown, axis=0) / t[:, None]
    parts = grown.reshape(PARTS, -1, grown.shape[1]).sum(axis=1) / (duration / PARTS)
    order = np.argsort(-history[-1], kind="stable")
    exponents, deviations = history[-1][order], (parts.std(axis=0, ddof=1) / np.sqrt(PARTS))[order]
    threshold = REGULAR * float(np.log(max(duration, math.e)) / duration)
    # log det: sum_i log R_ii = integral of tr f_x
    reason = "the exponents add up to the mean divergence of the flow"
    scale = float(np.abs(exponents).sum()) or 1.0
    gap = (np.cumsum(grown.sum(axis=1)) - np.cumsum(volumes)) / duration
    checks = (Check.of(("sum", "accurate", reason, "1/s"), gap, t, max(scale, threshold), DIVERGENCE),)
    character = _character(exponents, deviations, threshold)
    found = exponents, deviations, t, history[:, order], threshold
    return LyapunovExponents(*found, *character, "finished", "", checks)


def _character(exponents: Array, deviations: Array, threshold: float) -> tuple[Character, str]:
    largest, deviation = float(exponents[0]), float(deviations[0])
    told = f"the largest exponent is {largest:.4g} +- {deviation:.2g} 1/s"
    if largest > threshold and largest > SURE * deviation:
        return "chaotic", f"{told}; a regular motion of this length shows at most {threshold:.2g}"
    if largest + SURE * deviation < threshold:
        return "regular", f"{told}, no more than the {threshold:.2g} that a regular motion of this length may show"
    return "unknown", f"{told}, beside {threshold:.2g} of a regular motion: a longer time says more"
