"""The error that the size of the steps makes: the same controls once more, with steps half as long.

The gradient of the discrete adjoint is exact for the cost that was computed, whatever the steps; how far that cost, its
motion and its gradient are from those of the equations of motion is what two runs tell. The error of a Runge-Kutta
scheme of order 4 falls by 16 when its steps are halved: the difference of both runs is 15/16 of it.
"""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from substructures.analysis.control.path_limits import PathLimits
from substructures.analysis.control.problem import MAX_NUMBERS
from substructures.analysis.control.rollout import Rollout, Slope
from substructures.analysis.control.shooting import Shooting
from substructures.analysis.verdict import Check
from substructures.array import Array

HOW = "a second run with steps half as long finds the same: its difference is the error"
WITHIN = "by how much it leaves its limits, between the nodes, too: more 'intervals' make it less"
CLOSED = "the closures stay closed, which is not enforced: how far they open is an error of the steps"
HELD = "the velocity constraints are met, which is not enforced: how far they are violated is an error of the steps"
LARGE = "a second run with steps half as long would need too much memory: take fewer 'steps' or 'intervals'"
#: of numbers that are zero but for it, beside the others
ROUNDING = 1e-12
ABRUPT = "the motion is not finite"


def motion_checks(
    shooting: Shooting, run: Rollout, start: Array, limit: float, path: PathLimits | None = None, least: float = 0.0
) -> tuple[Check, ...]:
    """Cost and motion of ``run`` are those of a run with half the steps from ``start`` (2 n,), in one piece, which
    keeps the limits of the ``path`` at all its steps. The cost counts as ``least`` where it is less.
    """
    reason, names = _unable(shooting, run), () if path is None else path.texts
    if reason:
        return _left_out(("cost", "q", "qd", *names), reason)
    finer = shooting.refined()
    two = finer.run(start[None], run.controls)
    kept = () if path is None else _kept(finer, two, path, limit)
    return (*_motion(shooting, run, two, limit, least), *_closed(shooting, run, limit), *kept)


def _kept(finer: Shooting, two: Rollout, path: PathLimits, limit: float) -> Iterator[Check]:
    """Each expression stays within its limits, up to a part of the largest number of both."""
    t = np.asarray(finer.problem.t + finer.h * np.arange(len(two.states)), dtype=np.float64)
    value, _ = path.at(finer.values, two.states, finer.controls_at_steps(two.controls), t)
    outside = path.excess(value)
    for i, text in enumerate(path.texts):
        sizes = [float(np.abs(value[:, i]).max(initial=0)), *(abs(x) for x in (path.low[i], path.high[i]))]
        scale = max(x for x in (*sizes, 0.0) if np.isfinite(x))
        yield Check.of((text, "zero", WITHIN, ""), outside[:, i], t, scale, limit)


def gradient_checks(shooting: Shooting, run: Rollout, slope: Slope, limit: float) -> tuple[Check, ...]:
    """Cost, motion and gradient are those of steps half as long, relative to the largest number of each."""
    names = ("gradient by controls", "gradient by q", "gradient by qd", "gradient by parameters")
    reason = _unable(shooting, run)
    if reason:
        return _left_out(("cost", "q", "qd", *names), reason)
    m, finer = shooting.m, shooting.refined()
    two = finer.run(run.states[:1], run.controls)
    careful = finer.pullback(two, np.zeros((1, 1, shooting.size)), np.ones(1))
    pairs = [(slope.controls, careful.controls)]
    pairs += [(slope.start[..., part], careful.start[..., part]) for part in (slice(m), slice(m, None))]
    pairs.append((slope.parameters, careful.parameters))
    begin = np.full(1, shooting.problem.t)
    noise = ROUNDING * max(abs(two.cost), *(float(np.abs(b).max(initial=0)) for _, b in pairs))
    # a gradient belongs to the whole motion, and so to its start
    derivatives = (
        _compared(name, "", begin, a.reshape(1, -1), b.reshape(1, -1), limit, noise)
        for name, (a, b) in zip(names, pairs, strict=True)
    )
    return (*_motion(shooting, run, two, limit), *_closed(shooting, run, limit), *derivatives)


def _motion(shooting: Shooting, run: Rollout, two: Rollout, limit: float, least: float = 0.0) -> Iterator[Check]:
    m, problem = shooting.m, shooting.problem
    end = np.full(1, problem.t + problem.horizon)
    yield _compared("cost", "", end, np.full((1, 1), run.cost), np.full((1, 1), two.cost), limit, limit * least)
    one, other = run.states, two.states[::2]
    noise = ROUNDING * float(np.abs(other).max(initial=0))
    t = np.asarray(problem.t + shooting.h * np.arange(len(one)), dtype=np.float64)
    yield _compared("q", "rad, m", t, one[:, :m], other[:, :m], limit, noise)
    yield _compared("qd", "rad/s, m/s", t, one[:, m:], other[:, m:], limit, noise)


def _closed(shooting: Shooting, run: Rollout, limit: float) -> Iterator[Check]:
    """Closures stay closed by their accelerations alone: what the steps open is their error."""
    s, n, held = shooting.start.closed, shooting.model.dof, shooting.start.held
    if held is not None:
        t = np.asarray(shooting.problem.t + shooting.h * np.arange(len(run.states)), dtype=np.float64)
        B, speeds = held(run.states[:, :n]), run.states[:, n:]
        slipping = np.abs(np.einsum("tka,ta->tk", B, speeds)).max(axis=1)
        size = float(np.einsum("tka,ta->tk", np.abs(B), np.abs(speeds)).max(initial=0)) or 1.0
        yield Check.of(("constraints", "zero", HELD, "m/s, rad/s"), slipping, t, size, limit)
    if s is None:
        return
    t = np.asarray(shooting.problem.t + shooting.h * np.arange(len(run.states)), dtype=np.float64)
    opened = np.empty(len(t))
    for k, x in enumerate(run.states):
        s.move(float(t[k]), x[:n], x[n:])
        opened[k] = s.opening
    size = max(1.0, float(np.abs(run.states[:, :n]).max(initial=0)))
    yield Check.of(("closures", "zero", CLOSED, "1"), opened, t, size, limit)


def _compared(name: str, unit: str, t: Array, one: Array, two: Array, limit: float, noise: float = 0.0) -> Check:
    with np.errstate(invalid="ignore", over="ignore"):
        error, scale = np.abs(one - two).max(axis=1, initial=0), float(np.abs(two).max(initial=0))
    # a second run that is not finite confirms nothing
    if not np.isfinite(scale + noise):
        error, scale, noise = np.full_like(error, np.inf), 1.0, 0.0
    return Check.of((name, "accurate", HOW, unit), error, t, scale, limit, noise)


def _unable(shooting: Shooting, run: Rollout) -> str:
    """Why no second run is made."""
    n, steps = shooting.model.dof, len(run.states) - 1
    if not (np.isfinite(run.states).all() and np.isfinite(run.cost)):
        return ABRUPT
    return LARGE if 2 * steps * 4 * n * (n + 3) > MAX_NUMBERS else ""


def _left_out(names: tuple[str, ...], reason: str) -> tuple[Check, ...]:
    return tuple(Check.left_out(name, "accurate", reason, needed=True) for name in names)
