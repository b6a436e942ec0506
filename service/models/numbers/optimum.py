"""Best parameters of a tree."""

from __future__ import annotations

from service.models.numbers.analysis import Analysis
from service.models.source import Source
from service.schemas.analyses.optimum import OptimalParametersRequest
from substructures.analysis.motion.integrators.progress import ProgressReport
from substructures.sweeps.optimum import Aim, BestParameters, optimal_parameters


def _optimum(source: Source, request: OptimalParametersRequest, report: ProgressReport) -> BestParameters:
    aim = Aim(request.minimise, request.vary, request.columns, request.where, request.starts, request.seed)
    return optimal_parameters(source.sources, aim, request.parameters, report)


ANALYSES = {
    "optimal-parameters": Analysis(
        OptimalParametersRequest,
        _optimum,
        needs_parts=True,
    ),
}
