"""Steps of machine code that were made together, taken together where nothing looks at them one by one."""

from __future__ import annotations

from bisect import bisect_right
from collections.abc import Callable, Sequence
from typing import Any

import numpy as np

from substructures.analysis.motion.integrators.compiled_steps import CompiledStepper
from substructures.analysis.motion.integrators.integrated_motion import Stretch
from substructures.compile.motion import HEAD


def taken_at_once(
    solver: Any,
    outputs: Sequence[float],
    first: int,
    least: float,
    most: int,
    goes_on: Callable[[float], bool] | None,
) -> Stretch | None:
    """At most so many further steps of a stepper, and the results at the ``outputs`` in them, from the ``first`` on.
    ``goes_on``: told where each step ends, and false where it is the last one.

    None where one is to be taken by itself: a stepper of other kind or one that is watched, a step shorter than
    ``least`` or to what is not finite, a result that is not reached.
    """
    if not isinstance(solver, CompiledStepper) or solver.is_watched:
        return None
    rows = solver.ahead()[: max(most, 0)]
    t, x = np.append(solver.t, rows[:, 0]), np.concatenate([solver.y[None], rows[:, HEAD:]])
    good = np.isfinite(x[1:]).all(axis=1) & (np.diff(t) >= least)
    count = len(rows) if good.all() else int(good.argmin())
    if not count:
        return None
    if goes_on is not None:
        count = next((k for k, at in enumerate(t[1 : count + 1].tolist(), 1) if not goes_on(at)), count)
    wanted = outputs[first : bisect_right(outputs, float(t[count]), first)]
    # of each result the step to it, or over it
    places = np.searchsorted(t[1 : count + 1], wanted)
    states = x[places + 1]
    within = t[places + 1] != wanted
    if within.any():
        starts, ends = t[places[within]], np.array(wanted)[within]
        ways = np.stack([starts, ends - starts, ends], axis=1)
        states[within], is_reached = solver.reach(ways, x[places[within]])
        if not is_reached.all():
            return None
    solver.take(count)
    return Stretch(t[1 : count + 1], x[1 : count + 1], wanted, states)
