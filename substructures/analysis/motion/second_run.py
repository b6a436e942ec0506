"""A second run of an integration, for motions that no first integral judges: its difference is the stated error.

With tolerances of a tenth and steps at most half as long as the longest of the first run, the error of the second run
is small beside that of the first, and the difference of the two is the error of the first; half the steps, because
where 'max_step' or the span is what limits them, tolerances alone would give the same run again. Near the least
tolerance that doubles allow it is ten times looser instead, so that the difference is more than the error.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass, replace

import numpy as np

from substructures.analysis.motion.integrators.integrated_motion import IntegratedMotion
from substructures.analysis.motion.integrators.progress import ProgressReport
from substructures.analysis.motion.problems.problem import Integrator
from substructures.analysis.verdict import About, Check
from substructures.array import Array

#: of the tolerances; below LEAST they cannot be tightened
TIGHTER, LEAST = 0.1, 1e-12
#: of numbers that are zero but for it
ROUNDING = 1e-12
#: so many more steps than the first run may take
MORE = 10
#: integrates anew: (span, times of results, integrator)
Again = Callable[[tuple[float, float], Array, Integrator], IntegratedMotion]


@dataclass(frozen=True)
class TwoRuns:
    """States ``one`` and ``two`` (J, N) of both runs at times ``t`` (J,), or the ``message`` why there are none;
    ``about``: how the second run was made.
    """

    t: Array
    one: Array
    two: Array
    about: str
    message: str = ""


def second_run(first: IntegratedMotion, choice: Integrator, again: Again) -> TwoRuns:
    """The states of a first run at its results and at its end, and those of a second, more careful run."""
    t, x, results = first.judged()
    places = np.append(results, len(t) - 1)
    places = places[np.unique(t[places], return_index=True)[1]]
    times, one = t[places], x[places]
    careful, about = _careful(first, choice)
    none = np.zeros((0, x.shape[1]))
    if first.status == "failed" or first.cancelled or times[-1] <= t[0]:
        return TwoRuns(np.zeros(0), none, none, about, "the motion did not come to its end")
    second = again((float(t[0]), float(times[-1])), times, careful)
    if second.status != "finished" or len(second.t) != len(times):
        return TwoRuns(np.zeros(0), none, none, about, f"the second run did not come to its end: {second.message}")
    return TwoRuns(times, one, np.array(second.x), about)


def _careful(first: IntegratedMotion, choice: Integrator) -> tuple[Integrator, str]:
    """Other tolerances and shorter steps, in words, too."""
    tight = choice.relative_tolerance >= LEAST
    factor = TIGHTER if tight else 1 / TIGHTER
    steps = np.diff(first.step_t)
    half = float(steps.max(initial=0)) / first.stride / 2 or None
    relative, absolute = factor * choice.relative_tolerance, min(factor * choice.absolute_tolerance, 0.1)
    most = min(MORE * choice.max_steps, 100_000_000)
    limited = half if choice.max_step is None or half is None else min(half, choice.max_step / 2)
    fixed = choice.fixed_step
    words = f"a second run with tolerances {'ten times tighter' if tight else 'ten times looser'}"
    changed = replace(
        choice,
        method=choice.method if fixed is None else fixed.halved(),
        relative_tolerance=relative,
        absolute_tolerance=absolute,
        max_step=limited if fixed is None else None,
        max_steps=most,
    )
    return changed, f"{words} and steps at most half as long"


def accurate(runs: TwoRuns, groups: Mapping[str, tuple[slice, str, slice]], limit: float) -> tuple[Check, ...]:
    """A check for every group of columns of the states, ``name: (columns, unit, columns they move with)``: the two
    runs agree.

    The difference is relative to the largest number of its group at any time; ROUNDING of what they move with is none.
    """
    if runs.message:
        return tuple(Check.left_out(name, "accurate", runs.message, needed=True) for name in groups)
    checks = []
    for name, (columns, unit, whole) in groups.items():
        one, two = runs.one[:, columns], runs.two[:, columns]
        noise = ROUNDING * float(np.abs(runs.two[:, whole]).max(initial=0))
        error, scale = np.abs(one - two).max(axis=1, initial=0), float(np.abs(two).max(initial=0))
        about: About = (name, "accurate", f"{runs.about} finds the same: its difference is the error", unit)
        checks.append(Check.of(about, error, runs.t, scale, limit, noise))
    return tuple(checks)


def state_groups(n: int, p: int, velocities: str = "qd") -> dict[str, tuple[slice, str, slice]]:
    """Groups of states (q, velocities, ...) with n and p numbers."""
    both = slice(n + p)
    return {"q": (slice(n), "rad, m", both), velocities: (slice(n, n + p), "rad/s, m/s", both)}


def at_end(report: ProgressReport | None) -> ProgressReport | None:
    """The progress of a second run that nobody expected: done, but whoever watches may still stop it."""
    return None if report is None else lambda _: report(1.0)


def halves(report: ProgressReport | None) -> tuple[ProgressReport | None, ProgressReport | None]:
    """The first and the second half of a progress, for two runs."""
    if report is None:
        return None, None
    return (lambda share: report(share / 2)), (lambda share: report((1 + share) / 2))
