"""Analyses in numbers, by the names of their endpoints: the body of a request in, a result out."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import Any

from pydantic import BaseModel

from service.analyses.abbreviations import abbreviated
from service.analyses.formulas import base_of, curvature_of
from service.analyses.requests import arguments, read_request
from service.analyses.results import DRAWN, JSON, PLAIN, TRAJECTORY, Answered, trajectory_of
from service.analyses.source import Source
from service.analyses.warnings import warnings_of
from service.schemas.abbreviations import AbbreviationRequest
from service.schemas.control import GradientRequest, OptimalControlRequest
from service.schemas.measurements import CurvatureRequest, ExcitationRequest, IdentificationRequest
from service.schemas.motions import (
    AnySimulationRequest,
    LoopRequest,
    SensitivityRequest,
    SimulationRequest,
    SpanRequest,
    WithReactions,
)
from service.schemas.stability import (
    EquilibriaRequest,
    LinearisationRequest,
    RootLocusRequest,
    SteadyMotionsRequest,
)
from substructures.analysis.closed.loops import loop_state
from substructures.analysis.control.cost_gradient import cost_gradient
from substructures.analysis.control.optimal_control import optimal_control
from substructures.analysis.equations.curvature import curvature_values
from substructures.analysis.identification.fit import excitation, identify
from substructures.analysis.motion.parameter_sensitivity import sensitivities
from substructures.analysis.motion.progress import ProgressReport
from substructures.analysis.simulate import simulate
from substructures.analysis.stability.equilibria import equilibria
from substructures.analysis.stability.linearise import linearise
from substructures.analysis.stability.root_locus import root_locus
from substructures.analysis.stability.steady_motions import steady_motions
from substructures.errors import Fault, InvalidArgument, TooLarge
from substructures.quantities.powers import PowerModel
from substructures.quantities.quantity import POWERS, REACTIONS
from substructures.quantities.reactions import ReactionModel, read_joints
from substructures.quantities.states import read_states
from substructures.tree.model import Model


@dataclass(frozen=True)
class Analysis:
    """``schema``: of the body; ``follow``: computes the result of a body that was read; ``media``: what the result can
    be; ``text``: what it is; ``needs_parts``: of the tree, beside its formulas.
    """

    schema: type[BaseModel]
    follow: Callable[[Source, Any, ProgressReport], Any]
    text: str
    media: tuple[str, ...] = PLAIN
    needs_parts: bool = False

    def read(self, body: Any, model: Model) -> BaseModel:
        """The body of a request about a tree. Raises InvalidInput with pointers."""
        return read_request(self.schema, body, model)

    def compute(self, source: Source, body: Any, report: ProgressReport) -> Answered:
        """The result for the body of a request, with warnings about it. Raises InvalidInput with pointers into it,
        MissingValue, TooLarge.
        """
        request = self.read(body, source.model)
        result = self.follow(source, request, report)
        return Answered(result, warnings_of(source, request, trajectory_of(result)))


def _check_size(source: Source, states: int, numbers: int) -> None:
    size = 8 * states * numbers
    if size > source.limits.binary_bytes:
        raise TooLarge("the answer (in bytes)", size, source.limits.binary_bytes)


def _without(given: Mapping[str, Any], *names: str) -> dict[str, Any]:
    return {name: value for name, value in given.items() if name not in names}


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
    _check_size(source, len(request.output_times().grid()), numbers)
    rest = _without(given, "q", "reactions", "powers")
    if isinstance(request, SimulationRequest) and request.friction == "loaded":
        rest["bearings"] = _reactions(source, "/friction")
    tools: dict[str, Any] = {"progress": report, "folder": source.folder}
    return simulate(model, request.q, **rest, reactions=transmitted, powers=by_load, **tools)


def _powers(source: Source, request: SpanRequest) -> PowerModel | None:
    """The powers, where they are wanted along a motion. Raises InvalidArgument."""
    if not (isinstance(request, WithReactions) and request.powers):
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
        for name in ("events", "fixed_step", "series", "reactions", "powers", "geodesic")
        if getattr(request, name)
    ]
    if request.friction != "regularised":
        faults.append(Fault("/friction", "not-supported", "sensitivities are of the smooth law of friction alone"))
    if faults:
        raise InvalidArgument(faults)
    columns = len(request.by) + (2 * n if request.of_start else 0)
    _check_size(source, len(request.output_times().grid()), 2 * n * (columns + 1))
    rest = _without(given, "q", "events", "fixed_step", "series", "reactions", "powers", "friction", "geodesic")
    return sensitivities(source.model, request.q, **rest, progress=report, folder=source.folder)


def _loop_state(source: Source, request: LoopRequest, _: ProgressReport) -> Any:
    return loop_state(source.model, request.q, **_without(arguments(request), "q"), folder=source.folder)


def _linearisation(source: Source, read: LinearisationRequest, _: ProgressReport) -> Any:
    n = source.model.dof
    inputs = len(source.model.input_names)
    given = {"q": read.q, "qd": read.qd, "qdd": read.qdd}
    states = read_states(source.model, given, source.limits.states).count
    _check_size(source, states, 7 * n * n + 3 * n * inputs + len(read.outputs) * (2 * n + inputs))
    return linearise(source.model, **arguments(read))


def _curvature(source: Source, read: CurvatureRequest, _: ProgressReport) -> Any:
    n = source.model.dof
    states = read_states(source.model, {"q": read.q, "parameters": read.parameters}, source.limits.states).count
    _check_size(source, states, n**4 + n**3 + 2 * n * n + 1)
    tools: dict[str, Any] = {"engine": source.engine, "formulas": curvature_of(source)}
    return curvature_values(source.model, **arguments(read), limit=source.limits.states, **tools)


def _optimal_control(source: Source, read: OptimalControlRequest, report: ProgressReport) -> Any:
    def told(iteration: int, _cost: float, _violation: float) -> None:
        """The share of the iterations that are done at most."""
        report(min(1.0, iteration / read.iterations))

    return optimal_control(source.model, **arguments(read), progress=told)


def _excitation(source: Source, read: ExcitationRequest, _: ProgressReport) -> Any:
    found = excitation(base_of(source, read.drives), **_motion(read))
    return {**vars(found), "is_good": found.is_good, "advice": found.advice}


def _identification(source: Source, read: IdentificationRequest, _: ProgressReport) -> Any:
    model = source.model if read.known else None
    return identify(
        base_of(source, read.drives), **_motion(read), tau=read.tau, model=model, error_limit=read.error_limit
    )


def _motion(read: ExcitationRequest) -> dict[str, Any]:
    return {name: getattr(read, name) for name in ("q", "qd", "qdd", "parameters")}


ANALYSES: dict[str, Analysis] = {
    "abbreviations": Analysis(
        AbbreviationRequest,
        abbreviated,
        "A quantity with what is negligible over given ranges left out, and a proven bound of the error",
        (JSON,),
        needs_parts=True,
    ),
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
        lambda source, read, _: equilibria(source.model, **arguments(read)),
        "All equilibria that are found, each with its vibrations and stability; also of closed loops",
    ),
    "steady-motions": Analysis(
        SteadyMotionsRequest,
        lambda source, read, _: steady_motions(source.model, **arguments(read)),
        "Steady motions: cyclic coordinates at constant rates, all others still; each with its stability and why",
    ),
    "root-loci": Analysis(
        RootLocusRequest,
        lambda source, read, _: root_locus(source.model, **arguments(read)),
        "Eigenvalues of an equilibrium over a parameter",
        DRAWN,
    ),
    "curvatures": Analysis(CurvatureRequest, _curvature, "Riemann's tensor of the configuration space, Ricci, scalar"),
    "cost-gradients": Analysis(
        GradientRequest,
        lambda source, read, _: cost_gradient(source.model, **arguments(read)),
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
        _loop_state,
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
