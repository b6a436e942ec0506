"""Controls of least cost, and gradients of costs."""

from __future__ import annotations

from typing import Any

from service.models.numbers.analysis import Analysis
from service.models.requests import arguments
from service.models.source import Source
from service.schemas.analyses.control import GradientRequest, OptimalControlRequest
from substructures.analysis.control.cost_gradient import cost_gradient
from substructures.analysis.control.from_fields import control_arguments
from substructures.analysis.control.optimal_control import optimal_control
from substructures.analysis.motion.integrators.progress import ProgressReport


def _optimal_control(source: Source, read: OptimalControlRequest, report: ProgressReport) -> Any:
    def told(iteration: int, _cost: float, _violation: float) -> None:
        """The share of the iterations that are done at most."""
        report(min(1.0, iteration / read.iterations))

    return optimal_control(source.model, **control_arguments(**arguments(read)), progress=told)


ANALYSES = {
    "cost-gradients": Analysis(
        GradientRequest,
        lambda source, read, _: cost_gradient(source.model, **control_arguments(**arguments(read))),
    ),
    "optimal-controls": Analysis(
        OptimalControlRequest,
        _optimal_control,
    ),
}
