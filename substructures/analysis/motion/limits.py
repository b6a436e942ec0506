"""What a motion makes of the limits of its joints, and of relations that definitions leave out: it is told which limits
there are, and warned of each that it leaves.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace

from substructures.analysis.motion.trajectory import Trajectory
from substructures.quantities.numbers.levels import dependent_left, loop_warnings, ranges_left
from substructures.quantities.numbers.limits import joint_limits, reached
from substructures.tree.model import Model


def with_limits(model: Model, parameters: Mapping[str, float] | None, motion: Trajectory) -> Trajectory:
    """The motion with limits and warnings. Nothing holds a coordinate within its limits but end stops (``limits_act``).

    ``parameters``: in place of their defaults. Looked at are all steps, or where those were not kept the results; of
    dependent coordinates the results.
    """
    limits = joint_limits(model, parameters)
    lowest, highest = motion.reached or reached(motion.t, motion.q, motion.qd)
    judge = model.plausibility
    apart = [] if judge is None else judge.apart(model.positions, motion.q)
    if model.reduced:
        is_wrong = motion.status == "failed" or motion.is_right is False
        beyond = dependent_left(model, judge, motion.q, {**(parameters or {}), "t": motion.t})
        apart = [*apart, *ranges_left(model, lowest, highest), *beyond, *(loop_warnings(model) if is_wrong else ())]
    return replace(motion, limits=limits.plain(), warnings=(*limits.warnings(lowest, highest), *apart))
