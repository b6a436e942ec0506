"""The span of a motion, and the times in it where states are wanted."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Any

import numpy as np

from substructures.analysis.arguments import Numbers, positive, reals, whole
from substructures.analysis.motion.signals import require_increasing
from substructures.array import Array
from substructures.errors import InvalidArgument

MAX_OUTPUTS = 1_000_000
#: results where nothing says how many
COUNT = 101


@dataclass(frozen=True)
class OutputTimes:
    """``span`` (start, end) [s] and at most one of: ``times`` (K,) [s]; a time every ``step`` [s] and the end;
    ``count`` times of equal distance (default 101). Raises InvalidArgument.
    """

    span: tuple[float, float]
    times: Numbers | None = None
    step: float | None = None
    count: int | None = None

    def __post_init__(self) -> None:
        start, end = self._span()
        object.__setattr__(self, "span", (start, end))
        if self.times is not None:
            object.__setattr__(self, "times", reals(self.times, "/times"))
        if self.step is not None:
            object.__setattr__(self, "step", positive(self.step, "step"))
        if self.count is not None:
            object.__setattr__(self, "count", whole(self.count, "count", 2, MAX_OUTPUTS))
        if sum(x is not None for x in (self.times, self.step, self.count)) > 1:
            given = "times" if self.times is not None else "step"
            raise InvalidArgument.at(f"/{given}", "one-grid", "give one of 'times', 'step' and 'count'")
        if end <= start:
            raise InvalidArgument.at("/span", "empty-span", "the span must end after it begins")
        if self.step is not None and (end - start) / self.step > MAX_OUTPUTS:
            message = "more than a million results; take a larger 'step'"
            raise InvalidArgument.at("/step", "too-many-outputs", message)
        self._check_times()

    def _span(self) -> tuple[float, float]:
        given: Any = self.span
        span = reals(given, "/span")
        if len(span) != 2:
            raise InvalidArgument.at("/span", "wrong-length", f"a start and an end are needed, found {len(span)} times")
        return span[0], span[1]

    def _check_times(self) -> None:
        times = self.times
        if times is None or not len(times):
            return
        if len(times) > MAX_OUTPUTS:
            raise InvalidArgument.at("/times", "too-long", "more than a million results; take fewer 'times'")
        require_increasing(times)
        if not self.span[0] <= times[0] <= times[-1] <= self.span[1]:
            raise InvalidArgument.at("/times", "outside", "'times' must lie in the span")

    def grid(self) -> Array:
        """The times where states are wanted (K,) [s]."""
        start, end = self.span
        if self.times is not None:
            return np.array(self.times, dtype=np.float64)
        if self.step is not None:
            # t_k = start + k h; the end is one of them where rounding alone keeps it off the grid
            most = math.floor((end - start) / self.step * (1 + 1e-12))
            grid = start + self.step * np.arange(most + 1)
            return np.minimum(grid, end) if end - grid[-1] < 1e-9 * self.step else np.append(grid, end)
        return np.linspace(start, end, self.count or COUNT)
