"""How far a simulation has come: told as a share of its span."""

from __future__ import annotations

from collections.abc import Callable

from substructures.analysis.motion.integrators.integration import TimeReport

#: told (time reached - start) / span; False stops
ProgressReport = Callable[[float], bool | None]


def share_of(span: tuple[float, float], report: ProgressReport | None) -> TimeReport | None:
    """A progress that is told times, for a report that is told shares of the span."""
    if report is None:
        return None
    return lambda t: report((t - span[0]) / (span[1] - span[0]))
