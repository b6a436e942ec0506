"""Times of alternating works: what a noisy machine lets one compare."""

from __future__ import annotations

import gc
from collections.abc import Callable, Mapping
from statistics import median
from time import thread_time
from typing import Any

#: seconds of a turn, at least
TURN = 5e-3
#: what to do, and for how many states it does it
Work = tuple[Callable[[], Any], int]


def alternating(
    works: Mapping[str, Work], rounds: int, clock: Callable[[], float] = thread_time
) -> dict[str, list[float]]:
    """Seconds per state of every work (with its number of states) in every round.

    Every turn is repeated to take some milliseconds; the works alternate, so that drifts of the machine cancel.
    ``clock``: by default the time that this thread has computed; what else runs on the machine does not count.
    """
    times: dict[str, list[float]] = {name: [] for name in works}
    repeat = {}
    for name, (work, _) in works.items():
        work()
        start = clock()
        work()
        repeat[name] = max(1, round(TURN / (clock() - start)))
    gc.collect()
    for _ in range(rounds):
        for name, (work, count) in works.items():
            start = clock()
            for _ in range(repeat[name]):
                work()
            times[name].append((clock() - start) / repeat[name] / count)
    return times


def ratio(a: list[float], b: list[float]) -> float:
    """Median of the ratios of the rounds."""
    return median(x / y for x, y in zip(a, b, strict=True))
