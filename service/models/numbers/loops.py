"""Consistent states of closed loops, and their equations in independent coordinates."""

from __future__ import annotations

from typing import Any

from service.models.numbers.analysis import Analysis, without
from service.models.requests import arguments
from service.models.source import Source
from service.schemas.analyses.motions import LoopRequest, ReducedRequest
from substructures.analysis.closed.loops import loop_state
from substructures.analysis.closed.reduced import reduced_equations
from substructures.analysis.motion.integrators.progress import ProgressReport


def _loop_state(source: Source, request: LoopRequest, _: ProgressReport) -> Any:
    return loop_state(source.model, request.q, **without(arguments(request), "q"), folder=source.folder)


def _reduced(source: Source, request: ReducedRequest, _: ProgressReport) -> Any:
    return reduced_equations(source.model, request.q, **without(arguments(request), "q"), folder=source.folder)


ANALYSES = {
    "loop-states": Analysis(
        LoopRequest,
        _loop_state,
        "A consistent state of closed loops: mobility, redundancy, accelerations, reaction forces",
    ),
    "reduced-equations": Analysis(
        ReducedRequest,
        _reduced,
        "Equations of motion of closed loops in independent coordinates: metric, Christoffel symbols, forces",
    ),
}
