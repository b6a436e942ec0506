"""Motions from flat fields, as HTTP sends them: tests keep starts and settings in one mapping."""

from typing import Any

from substructures.analysis.from_fields import motion_arguments
from substructures.analysis.motion.trajectory import Trajectory
from substructures.analysis.simulate import simulate
from substructures.tree.model import Model


def simulated(model: Model, *start: Any, **fields: Any) -> Trajectory:
    """The motion of these fields; ``start``: q and span."""
    return simulate(model, *start, **motion_arguments(model, **fields))
