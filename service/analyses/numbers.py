"""Analyses in numbers, by the names of their endpoints: a request as plain data in, a result out."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import Any

from pydantic import BaseModel

from service.analyses.formulas import base_of, curvature_of
from service.analyses.requests import (
    AnySimulationRequest,
    CurvatureRequest,
    ExcitationRequest,
    IdentificationRequest,
    SensitivityRequest,
)
from service.analyses.results import DRAWN, PLAIN, TRAJECTORY
from service.analyses.source import Source
from substructures.analysis.closed.loops import analyse_loops
from substructures.analysis.control.cost_gradient import GradientRequest, cost_gradient
from substructures.analysis.control.nonlinear_program import OptimalControlRequest
from substructures.analysis.control.optimal_control import optimal_control
from substructures.analysis.equations.curvature import curvature_values
from substructures.analysis.identification.fit import excitation, identify
from substructures.analysis.motion.parameter_sensitivity import sensitivities
from substructures.analysis.motion.progress import ProgressReport
from substructures.analysis.motion.requests import (
    ClosedRequest,
    LoopRequest,
    RollingRequest,
    SimulationRequest,
    SpanRequest,
)
from substructures.analysis.simulate import simulate
from substructures.analysis.stability.equilibria import equilibria
from substructures.analysis.stability.equilibrium_search import EquilibriaRequest
from substructures.analysis.stability.linearisation import LinearisationRequest
from substructures.analysis.stability.linearise import linearise
from substructures.analysis.stability.root_locus import RootLocusRequest, root_locus
from substructures.documents import read_model
from substructures.errors import Fault, InvalidDocument, TooLarge
from substructures.quantities.states import read_states

Request = Mapping[str, Any]


@dataclass(frozen=True)
class Analysis:
    """``schema``: of the request; ``media``: what the result can be; ``text``: what it is; ``needs_parts``: of the
    tree, beside its formulas.
    """

    schema: type[BaseModel]
    compute: Callable[[Source, Request, ProgressReport], Any]
    text: str
    media: tuple[str, ...] = PLAIN
    needs_parts: bool = False


def require_object(request: Any) -> Request:
    """Raises InvalidDocument unless the request is an object."""
    if not isinstance(request, Mapping):
        raise InvalidDocument.at("", "object-expected", "expected a JSON object")
    return request


def _check_size(source: Source, states: int, numbers: int) -> None:
    size = 8 * states * numbers
    if size > source.limits.binary_bytes:
        raise TooLarge("the answer (in bytes)", size, source.limits.binary_bytes)


def check_request(name: str, request: Any, is_closed: bool) -> None:
    """Check the shape of a request about a tree, ``is_closed``: with closures. Raises InvalidDocument."""
    given = require_object(request)
    read_model(_motion_schema(given, is_closed) if name == "simulations" else ANALYSES[name].schema, given)


def _motion_schema(request: Request, is_closed: bool) -> type[SpanRequest]:
    """As :func:`substructures.analysis.simulate.simulate` chooses."""
    if request.get("constraints"):
        return RollingRequest
    return ClosedRequest if is_closed or request.get("prescribed") else SimulationRequest


def _simulation(source: Source, request: Request, report: ProgressReport) -> Any:
    model, n = source.model, source.model.dof
    read = read_model(_motion_schema(request, bool(model.closures)), request)
    rows = sum(len(closure.rows) for closure in model.closures)
    _check_size(source, len(read.outputs()), 4 * n + rows + 10 + len(getattr(read, "series", ())) + len(read.inputs))
    return simulate(model, request, report, source.folder)


def _sensitivities(source: Source, request: Request, report: ProgressReport) -> Any:
    read = read_model(SensitivityRequest, request)
    n, known = source.model.dof, source.model.parameters
    faults = [
        Fault(f"/by/{i}", "unknown-parameter", f"unknown parameter '{name[:80]}'")
        for i, name in enumerate(read.by)
        if name not in known
    ]
    if faults:
        raise InvalidDocument(faults)
    columns = len(read.by) + (2 * n if read.of_start else 0)
    _check_size(source, len(read.outputs()), 2 * n * (columns + 1))
    rest = {name: value for name, value in request.items() if name not in ("by", "of_start")}
    return sensitivities(source.model, rest, read.by, read.of_start, report, source.folder)


def _linearisation(source: Source, request: Request, _: ProgressReport) -> Any:
    read, n = read_model(LinearisationRequest, request), source.model.dof
    inputs = sum(s.kind == "input" for s in source.model.program.symbols)
    states = len(read_states(source.model, {"q": read.q}, source.limits.states).q)
    _check_size(source, states, 7 * n * n + 3 * n * inputs + len(read.outputs) * (2 * n + inputs))
    return linearise(source.model, request)


def _curvature(source: Source, request: Request, _: ProgressReport) -> Any:
    read, n = read_model(CurvatureRequest, request), source.model.dof
    states = len(read_states(source.model, {"q": read.q}, source.limits.states).q)
    _check_size(source, states, n**4 + n**3 + 2 * n * n + 1)
    return curvature_values(source.model, request, source.limits.states, source.engine, curvature_of(source))


def _optimal_control(source: Source, request: Request, report: ProgressReport) -> Any:
    most = read_model(OptimalControlRequest, request).iterations

    def told(iteration: int, _cost: float, _violation: float) -> None:
        report(min(1.0, iteration / most))

    return optimal_control(source.model, request, told)


def _excitation(source: Source, request: Request, _: ProgressReport) -> Any:
    drives = read_model(ExcitationRequest, request).drives
    found = excitation(base_of(source, drives), _without(request, "drives"))
    return {**vars(found), "is_good": found.is_good, "advice": found.advice}


def _identification(source: Source, request: Request, _: ProgressReport) -> Any:
    read = read_model(IdentificationRequest, request)
    data = _without(request, "drives", "known")
    return identify(base_of(source, read.drives), data, source.model if read.known else None)


def _without(request: Request, *names: str) -> Request:
    return {name: value for name, value in request.items() if name not in names}


ANALYSES: dict[str, Analysis] = {
    "simulations": Analysis(
        AnySimulationRequest,
        _simulation,
        "The motion from a start, with the drift of all first integrals as judge",
        TRAJECTORY,
    ),
    "sensitivities": Analysis(
        SensitivityRequest, _sensitivities, "A motion and its derivatives by parameters and by the start", TRAJECTORY
    ),
    "linearisations": Analysis(
        LinearisationRequest,
        _linearisation,
        "Perturbation equations M, D, K, F and state space A, B, C, D about states; modes and stability at equilibria; "
        "of closed loops in independent coordinates, about one state",
    ),
    "equilibria": Analysis(
        EquilibriaRequest,
        lambda source, request, _: equilibria(source.model, request),
        "All equilibria that are found, each with its vibrations and stability; also of closed loops",
    ),
    "root-loci": Analysis(
        RootLocusRequest,
        lambda source, request, _: root_locus(source.model, request),
        "Eigenvalues of an equilibrium over a parameter",
        DRAWN,
    ),
    "curvatures": Analysis(CurvatureRequest, _curvature, "Riemann's tensor of the configuration space, Ricci, scalar"),
    "cost-gradients": Analysis(
        GradientRequest,
        lambda source, request, _: cost_gradient(source.model, request),
        "The cost of a motion under given controls and its gradient by the adjoint",
        TRAJECTORY,
    ),
    "optimal-controls": Analysis(
        OptimalControlRequest,
        _optimal_control,
        "Controls of least cost, judged by the necessary conditions",
        TRAJECTORY,
    ),
    "loop-states": Analysis(
        LoopRequest,
        lambda source, request, _: analyse_loops(source.model, request, source.folder),
        "A consistent state of closed loops: mobility, redundancy, accelerations, reaction forces",
    ),
    "excitations": Analysis(
        ExcitationRequest,
        _excitation,
        "How well a motion excites the base inertial parameters",
        needs_parts=True,
    ),
    "identifications": Analysis(
        IdentificationRequest,
        _identification,
        "Base inertial parameters from a measured motion",
        needs_parts=True,
    ),
}
