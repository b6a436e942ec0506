"""What is wanted of a motion: when, and what beside coordinates and velocities."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field

from substructures.analysis.arguments import NumberOrExpression, by_name, values_of
from substructures.analysis.motion.problems.events import Event
from substructures.analysis.motion.problems.output_times import OutputGrid
from substructures.quantities.part_models import PowerModel, ReactionModel


@dataclass(frozen=True)
class Outputs(OutputGrid):
    """Results at ``times``, every ``step`` or ``count`` of them (see OutputGrid).

    ``series``: expressions in coordinates, velocities, parameters and t to be followed, by name (``"-2*x.q1'"``);
    ``events``: crossings that are noted, or stop the motion. ``reactions``: those that are wanted as further series
    (not with velocity constraints). ``powers``: those of all loads and joints as a further series, and the check
    ``power`` that they add up to dT/dt (not with velocity constraints, nor of a geodesic).
    """

    series: Mapping[str, NumberOrExpression] = field(default_factory=dict)
    events: Sequence[Event] = ()
    reactions: ReactionModel | None = None
    powers: PowerModel | None = None

    def __post_init__(self) -> None:
        super().__post_init__()
        object.__setattr__(self, "series", dict(by_name(self.series, "series")))
        object.__setattr__(self, "events", values_of(self.events, "events", Event))


@dataclass(frozen=True)
class SensitivityOutputs(OutputGrid):
    """Derivatives at ``times``, every ``step`` or ``count`` of them; ``of_start``: also those by the start."""

    of_start: bool = False
