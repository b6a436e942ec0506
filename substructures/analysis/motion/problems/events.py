"""Events: quantities whose zeros along a motion are looked for."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Literal

from substructures.analysis.arguments import NumberOrExpression, one_of, real, whole

#: sign of the slope at the zeros that count; 0: any
DIRECTIONS = {"rising": 1, "falling": -1, "both": 0}
ACTIONS = ("stop", "record")
#: crossings that are waited for
MOST = 1_000_000_000


@dataclass(frozen=True)
class Event:
    """``quantity`` (an expression in coordinates, velocities, parameters and t, its unit) crosses ``level``.

    ``direction``: which crossings count; ``action``: whether the motion stops there, at the ``count``-th. ``reset``:
    coordinates and velocities (``q'``) that jump there, each to an expression in the state before: the motion goes on.
    All crossings in a step of the integrator are found, but for a pair that is less than 1/256 of the step apart.
    Raises InvalidArgument.
    """

    name: str
    quantity: NumberOrExpression
    level: float = 0.0
    direction: Literal["rising", "falling", "both"] = "both"
    action: Literal["stop", "record"] = "stop"
    reset: Mapping[str, NumberOrExpression] = field(default_factory=dict)
    count: int = 1

    def __post_init__(self) -> None:
        object.__setattr__(self, "level", real(self.level, "/level"))
        one_of(self.direction, "direction", tuple(DIRECTIONS))
        one_of(self.action, "action", ACTIONS)
        object.__setattr__(self, "count", whole(self.count, "count", 1, MOST))
