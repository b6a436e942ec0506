"""Simulation of a model: a request as plain data in, a judged trajectory out; trees, closed loops, rolling bodies."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path
from typing import Any

from substructures.analysis.closed.simulation import simulate_closed
from substructures.analysis.motion.progress import ProgressReport
from substructures.analysis.motion.rolling import simulate_rolling
from substructures.analysis.motion.simulation import simulate_tree
from substructures.analysis.motion.trajectory import Trajectory
from substructures.tree.model import Model


def simulate(
    model: Model, request: Mapping[str, Any], progress: ProgressReport | None = None, folder: Path | None = None
) -> Trajectory:
    """The motion of any model from a start over a span of time, with its judges.

    A request with ``constraints`` is for simulate_rolling; else, of a model with closures or with ``prescribed``
    coordinates, for simulate_closed; else for simulate_tree. The fields of SpanRequest are common to all. ``progress``
    is told the finished share of the span and stops by False; ``folder``: where compiled kernels are kept.
    Raises InvalidDocument (pointers into the request), MissingValue, and TooLarge.
    """
    if isinstance(request, Mapping) and request.get("constraints"):
        return simulate_rolling(model, request, progress, folder)
    if model.closures or (isinstance(request, Mapping) and request.get("prescribed")):
        return simulate_closed(model, request, progress, folder)
    return simulate_tree(model, request, progress, folder)
