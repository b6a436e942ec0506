"""How far a simulation has come: told as a share of its span."""

from __future__ import annotations

from collections.abc import Callable

from substructures.analysis.motion.integration import Progress

#: told (time reached - start) / span; False stops
Report = Callable[[float], bool | None]


def share_of(span: tuple[float, float], report: Report | None) -> Progress | None:
    """A progress that is told times, for a report that is told shares of the span."""
    if report is None:
        return None
    return lambda t: report((t - span[0]) / (span[1] - span[0]))
