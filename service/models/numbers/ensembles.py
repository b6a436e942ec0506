"""Many motions of one tree at once."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

from service.models.numbers.analysis import Analysis, check_size
from service.models.requests import arguments
from service.models.source import Source
from service.schemas.analyses.ensembles import EnsembleRequest
from substructures.analysis.from_fields import reduced_kind
from substructures.analysis.motion.integrators.progress import ProgressReport
from substructures.analysis.motion.problems.kinds import ConstrainedMotion, TreeMotion
from substructures.analysis.motion.problems.output_times import OutputTimes
from substructures.analysis.motion.problems.problem import Integrator
from substructures.ensembles.ensemble import Ensemble, simulate_ensemble
from substructures.ensembles.one_by_one import UNTIED
from substructures.ensembles.sampled import with_samples
from substructures.errors import InvalidArgument
from substructures.quantities.numbers.states import longest

#: fields that say in which velocities motions with constraints are
QUASI_VELOCITIES = ("constraints", "velocities", "independent", "v")


def _ensemble(source: Source, request: EnsembleRequest, report: ProgressReport) -> Ensemble:
    model = source.model
    asked = arguments(request)
    fields = {name: x for name, x in asked.items() if name in QUASI_VELOCITIES}
    constrained = reduced_kind(model, fields)
    given = with_samples(model, request.samples, request.members(), constrained)
    kind: ConstrainedMotion | TreeMotion = TreeMotion(contacts=asked.get("contacts", ()))
    if constrained is not None:
        if request.contacts:
            raise InvalidArgument.at("/contacts", "not-supported", UNTIED)
        kind = replace(constrained, v=given["v"])
    states = not request.columns if request.states is None else request.states
    times = len(OutputTimes(request.span, request.grid()).grid())
    check_size(source, longest(given), len(request.columns) + 1 + 2 * model.dof * times * states)
    integrator = Integrator(
        request.method,
        request.relative_tolerance,
        request.absolute_tolerance,
        request.max_step,
        request.max_steps,
        request.drift_limit,
        report,
        source.folder,
    )
    q = given.pop("q")
    given.pop("v")
    how: dict[str, Any] = {"columns": request.columns, "grid": request.grid(), "states": states}
    how |= {"kind": kind, "events": asked.get("events", ())}
    return simulate_ensemble(source.sources, q, request.span, integrator=integrator, **how, **given)


ANALYSES = {
    "ensembles": Analysis(EnsembleRequest, _ensemble),
}
