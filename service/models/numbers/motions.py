"""Motions, and how they vary."""

from __future__ import annotations

from typing import Any

from service.models.numbers.analysis import Analysis, check_size, without
from service.models.requests import arguments
from service.models.source import Source
from service.schemas.analyses.motions import (
    AnySimulationRequest,
    SensitivityRequest,
    SimulationRequest,
    SpanRequest,
    WithPowers,
    WithReactions,
)
from substructures.analysis.from_fields import motion_arguments, sensitivity_arguments
from substructures.analysis.motion.integrators.progress import ProgressReport
from substructures.analysis.motion.parameter_sensitivity import sensitivities
from substructures.analysis.simulate import simulate
from substructures.errors import Fault, InvalidArgument
from substructures.quantities.part_models import PowerModel, ReactionModel, read_joints
from substructures.quantities.quantity import POWERS, REACTIONS

#: fields of motions that are not differentiated
SMOOTH = ("events", "fixed_step", "series", "reactions", "powers", "geodesic", "contacts")


def _simulation(source: Source, request: SpanRequest, report: ProgressReport) -> Any:
    model, n, given = source.model, source.model.dof, arguments(request)
    rows = sum(len(closure.rows) for closure in model.closures)
    numbers = 6 * n + rows + 10 + len(request.series) + len(request.inputs)
    transmitted = _transmitted(source, request)
    if transmitted is not None:
        numbers += 12 * len(transmitted.rows)
    by_load = _powers(source, request)
    if by_load is not None:
        numbers += len(by_load.rows) + n
    touching = len(request.contacts) if isinstance(request, SimulationRequest) else 0
    if touching or model.contacts:
        numbers += 4 * (touching + len(model.contacts)) + n
    check_size(source, len(request.output_times().grid()), numbers)
    rest = without(given, "q", "reactions", "powers")
    if isinstance(request, SimulationRequest) and request.friction == "loaded":
        rest["bearings"] = _reactions(source, "/friction")
    tools: dict[str, Any] = {"progress": report, "folder": source.folder}
    rest = motion_arguments(model, **rest, reactions=transmitted, powers=by_load, **tools)
    return simulate(model, request.q, **rest)


def _powers(source: Source, request: SpanRequest) -> PowerModel | None:
    """The powers, where they are wanted along a motion. Raises InvalidArgument."""
    if not (isinstance(request, WithPowers) and request.powers):
        return None
    found: PowerModel = _of_parts(source, POWERS, "/powers")
    return found


def _transmitted(source: Source, request: SpanRequest) -> ReactionModel | None:
    """The reactions that are wanted along a motion. Raises InvalidArgument (``/reactions/i``)."""
    wanted = request.reactions if isinstance(request, WithReactions) else False
    if wanted is False:
        return None
    found = _reactions(source, "/reactions")
    return found if wanted is True else found.of(read_joints(wanted, found.rows, "/reactions"))


def _reactions(source: Source, pointer: str) -> ReactionModel:
    """All reactions of a tree. Raises InvalidArgument."""
    found: ReactionModel = _of_parts(source, REACTIONS, pointer)
    return found


def _of_parts(source: Source, name: str, pointer: str) -> Any:
    """What is derived of the parts of a tree. Raises InvalidArgument."""
    try:
        return source.sources.of(name)
    except InvalidArgument as error:
        raise error.moved(lambda place: pointer if place == "/quantities" else place) from None


def _sensitivities(source: Source, request: SensitivityRequest, report: ProgressReport) -> Any:
    n, given = source.model.dof, arguments(request)
    faults = [
        Fault(f"/{name}", "not-supported", f"sensitivities are computed without '{name}'")
        for name in SMOOTH
        if getattr(request, name)
    ]
    if request.friction != "regularised":
        faults.append(Fault("/friction", "not-supported", "sensitivities are of the smooth law of friction alone"))
    if faults:
        raise InvalidArgument(faults)
    columns = len(request.by) + (2 * n if request.of_start else 0)
    check_size(source, len(request.output_times().grid()), 2 * n * (columns + 1))
    rest = without(given, "q", "friction", *SMOOTH)
    rest = sensitivity_arguments(source.model, **rest, progress=report, folder=source.folder)
    return sensitivities(source.model, request.q, **rest)


ANALYSES = {
    "simulations": Analysis(
        AnySimulationRequest,
        _simulation,
    ),
    "sensitivities": Analysis(SensitivityRequest, _sensitivities),
}
