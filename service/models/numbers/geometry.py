"""The curvature of the configuration space."""

from __future__ import annotations

from typing import Any

from service.models.formulas import curvature_of
from service.models.numbers.analysis import Analysis, check_size
from service.models.requests import arguments
from service.models.source import Source
from service.schemas.measurements import CurvatureRequest
from substructures.analysis.equations.curvature import curvature_values
from substructures.analysis.motion.integrators.progress import ProgressReport
from substructures.quantities.numbers.states import read_states


def _curvature(source: Source, read: CurvatureRequest, _: ProgressReport) -> Any:
    n = source.model.dof
    states = read_states(source.model, {"q": read.q, "parameters": read.parameters}, source.limits.states).count
    check_size(source, states, n**4 + n**3 + 2 * n * n + 1)
    tools: dict[str, Any] = {"engine": source.engine, "formulas": curvature_of(source)}
    return curvature_values(source.model, **arguments(read), limit=source.limits.states, **tools)


ANALYSES = {
    "curvatures": Analysis(CurvatureRequest, _curvature),
}
