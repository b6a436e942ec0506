"""The span of a motion, and the times in it where states are wanted."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Any

import numpy as np

from substructures.analysis.arguments import Numbers, positive, reals, whole
from substructures.analysis.motion.problems.signals import require_increasing
from substructures.array import Array
from substructures.errors import InvalidArgument

MAX_OUTPUTS = 1_000_000
#: results where nothing says how many
COUNT = 101


@dataclass(frozen=True)
class OutputGrid:
    """Where results are wanted, at most one of: ``times`` (K,) [s]; a time every ``step`` [s] and the end; ``count``
    times of equal distance (default 101). Raises InvalidArgument.
    """

    times: Numbers | None = None
    step: float | None = None
    count: int | None = None

    def __post_init__(self) -> None:
        if self.times is not None:
            object.__setattr__(self, "times", reals(self.times, "/times"))
            if len(self.times) > MAX_OUTPUTS:
                raise InvalidArgument.at("/times", "too-long", "more than a million results; take fewer 'times'")
            if len(self.times):
                require_increasing(self.times)
        if self.step is not None:
            object.__setattr__(self, "step", positive(self.step, "step"))
        if self.count is not None:
            object.__setattr__(self, "count", whole(self.count, "count", 2, MAX_OUTPUTS))
        if sum(x is not None for x in (self.times, self.step, self.count)) > 1:
            given = "times" if self.times is not None else "step"
            raise InvalidArgument.at(f"/{given}", "one-grid", "give one of 'times', 'step' and 'count'")


#: no grid is asked for
EVEN = OutputGrid()


@dataclass(frozen=True)
class OutputTimes:
    """The span of a motion (start, end) [s], and where in it results are wanted. Raises InvalidArgument."""

    span: tuple[float, float]
    outputs: OutputGrid = EVEN

    def __post_init__(self) -> None:
        start, end = self._span()
        object.__setattr__(self, "span", (start, end))
        if end <= start:
            raise InvalidArgument.at("/span", "empty-span", "the span must end after it begins")
        step, times = self.outputs.step, self.outputs.times
        if step is not None and (end - start) / step > MAX_OUTPUTS:
            message = "more than a million results; take a larger 'step'"
            raise InvalidArgument.at("/step", "too-many-outputs", message)
        if times is not None and len(times) and not start <= times[0] <= times[-1] <= end:
            raise InvalidArgument.at("/times", "outside", "'times' must lie in the span")

    def _span(self) -> tuple[float, float]:
        given: Any = self.span
        span = reals(given, "/span")
        if len(span) != 2:
            raise InvalidArgument.at("/span", "wrong-length", f"a start and an end are needed, found {len(span)} times")
        return span[0], span[1]

    def grid(self) -> Array:
        """The times where states are wanted (K,) [s]."""
        (start, end), step = self.span, self.outputs.step
        if self.outputs.times is not None:
            return np.array(self.outputs.times, dtype=np.float64)
        if step is not None:
            # t_k = start + k h; the end is one of them where rounding alone keeps it off the grid
            most = math.floor((end - start) / step * (1 + 1e-12))
            grid = start + step * np.arange(most + 1)
            return np.minimum(grid, end) if end - grid[-1] < 1e-9 * step else np.append(grid, end)
        return np.linspace(start, end, self.outputs.count or COUNT)
