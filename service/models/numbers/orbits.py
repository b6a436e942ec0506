"""Orbits that come back, and how fast neighbours part."""

from __future__ import annotations

from typing import Any

from service.models.numbers.analysis import Analysis, check_size, without
from service.models.requests import arguments
from service.models.source import Source
from service.schemas.analyses.orbits import LyapunovRequest, PeriodicOrbitRequest, PoincareSectionRequest
from substructures.analysis.motion.integrators.progress import ProgressReport
from substructures.analysis.motion.problems.problem import Integrator
from substructures.analysis.orbits.families import MOST
from substructures.analysis.orbits.lyapunov import lyapunov_exponents
from substructures.analysis.orbits.periodic import Shooting, periodic_orbits
from substructures.analysis.orbits.search import TIMES
from substructures.analysis.orbits.sections import poincare_section
from substructures.quantities.numbers.states import read_states

STATE = ("qd", "inputs", "parameters")


def _state(given: dict[str, Any]) -> dict[str, Any]:
    return {name: given[name] for name in STATE if name in given}


def _integrator(
    source: Source, request: PeriodicOrbitRequest | PoincareSectionRequest | LyapunovRequest, report: ProgressReport
) -> Integrator:
    relative, absolute = request.relative_tolerance, request.absolute_tolerance
    return Integrator(relative_tolerance=relative, absolute_tolerance=absolute, progress=report, folder=source.folder)


def _orbits(source: Source, request: PeriodicOrbitRequest, report: ProgressReport) -> Any:
    model = source.model
    count = MOST * request.steps if request.between else max(1, len(request.values))
    check_size(source, count, 3 * model.dof * TIMES)
    state = {name: getattr(request, name) for name in ("q", "qd")}
    read = read_states(model, state, 1)
    given = _state(arguments(request)) | {"qd": read.qd[0]}
    section = None if request.section is None else request.section.value()
    period = request.period if isinstance(request.period, str | None) else float(request.period)
    shooting = Shooting(period, request.fixed, request.hold, request.turns, section)
    family: dict[str, Any] = {"vary": request.vary, "values": request.values}
    family |= {"between": request.between, "steps": request.steps}
    family["events"] = [event.value() for event in request.events]
    return periodic_orbits(
        model, read.q[0], shooting, **given, **family, integrator=_integrator(source, request, report)
    )


def _section(source: Source, request: PoincareSectionRequest, report: ProgressReport) -> Any:
    check_size(source, request.count, 2 * source.model.dof + 1)
    given = without(arguments(request), "q", "relative_tolerance", "absolute_tolerance")
    return poincare_section(source.model, request.q, **given, integrator=_integrator(source, request, report))


def _exponents(source: Source, request: LyapunovRequest, report: ProgressReport) -> Any:
    check_size(source, request.intervals, 4 * source.model.dof + 1)
    integrator = _integrator(source, request, report)
    given = _state(arguments(request))
    times: dict[str, Any] = {"transient": request.transient or 0.0, "intervals": request.intervals}
    return lyapunov_exponents(source.model, request.q, request.duration, **given, **times, integrator=integrator)


ANALYSES = {
    "periodic-orbits": Analysis(PeriodicOrbitRequest, _orbits),
    "poincare-sections": Analysis(
        PoincareSectionRequest,
        _section,
    ),
    "lyapunov-exponents": Analysis(
        LyapunovRequest,
        _exponents,
    ),
}
