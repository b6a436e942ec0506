"""Consistent states of closed loops, and their equations in independent coordinates."""

from __future__ import annotations

from typing import Any

from service.models.numbers.analysis import Analysis, check_size, without
from service.models.requests import arguments
from service.models.source import Source
from service.schemas.analyses.motions import LoopRequest, ReducedRequest
from substructures.analysis.closed.loops import loop_state
from substructures.analysis.closed.reduced import reduced_equations
from substructures.analysis.motion.integrators.progress import ProgressReport


def _loop_state(source: Source, request: LoopRequest, _: ProgressReport) -> Any:
    return loop_state(source.model, request.q, **without(arguments(request), "q"), folder=source.folder)


def _reduced(source: Source, request: ReducedRequest, _: ProgressReport) -> Any:
    states = max((len(x) for x in (*request.q.values(), *request.qd.values()) if isinstance(x, list)), default=1)
    r = len(source.model.reduction.independent if request.independent is None else request.independent)
    check_size(source, states, (source.model.dof + r) * (r + 1) ** 2 + 3 * source.model.dof)
    return reduced_equations(source.model, request.q, **without(arguments(request), "q"), folder=source.folder)


ANALYSES = {
    "loop-states": Analysis(
        LoopRequest,
        _loop_state,
    ),
    "reduced-equations": Analysis(
        ReducedRequest,
        _reduced,
    ),
}
