"""Linear equations about states, equilibria, steady motions and their stability."""

from __future__ import annotations

from typing import Any

from service.models.numbers.analysis import Analysis, check_size
from service.models.requests import arguments
from service.models.source import Source
from service.schemas.analyses.stability import (
    EquilibriaRequest,
    FrequencyResponseRequest,
    LinearisationRequest,
    RegulatorRequest,
    RootLocusRequest,
    SteadyMotionsRequest,
)
from substructures.analysis.from_fields import linearisation_arguments
from substructures.analysis.motion.integrators.progress import ProgressReport
from substructures.analysis.stability.equilibria import equilibria
from substructures.analysis.stability.frequency_response import COUNT, frequency_response
from substructures.analysis.stability.linearise import linearise
from substructures.analysis.stability.regulator import regulator
from substructures.analysis.stability.root_locus import root_locus
from substructures.analysis.stability.steady_motions import steady_motions
from substructures.quantities.numbers.states import read_states


def _linearisation(source: Source, read: LinearisationRequest, _: ProgressReport) -> Any:
    n = source.model.dof
    inputs = len(source.model.input_names)
    given = {"q": read.q, "qd": read.qd, "qdd": read.qdd}
    states = read_states(source.model, given, source.limits.states).count
    check_size(source, states, 7 * n * n + 3 * n * inputs + len(read.outputs) * (2 * n + inputs))
    return linearise(source.model, **linearisation_arguments(source.model, **arguments(read)))


def _response(source: Source, read: FrequencyResponseRequest, _: ProgressReport) -> Any:
    model = source.model
    outputs = len(read.outputs) or len(model.positions)
    check_size(source, len(read.frequencies or ()) or COUNT, 4 * outputs * len(model.input_names))
    return frequency_response(model, **arguments(read))


def _steady(source: Source, read: SteadyMotionsRequest, _: ProgressReport) -> Any:
    n = source.model.dof
    check_size(source, 1 if read.vary is None else 20 * read.steps, 5 * n * n + 5 * n)
    return steady_motions(source.model, **arguments(read))


ANALYSES = {
    "linearisations": Analysis(
        LinearisationRequest,
        _linearisation,
    ),
    "frequency-responses": Analysis(
        FrequencyResponseRequest,
        _response,
    ),
    "regulators": Analysis(
        RegulatorRequest,
        lambda source, read, _: regulator(source.model, **arguments(read)),
    ),
    "equilibria": Analysis(
        EquilibriaRequest,
        lambda source, read, _: equilibria(source.model, **arguments(read)),
    ),
    "steady-motions": Analysis(
        SteadyMotionsRequest,
        _steady,
    ),
    "root-loci": Analysis(
        RootLocusRequest,
        lambda source, read, _: root_locus(source.model, **arguments(read)),
    ),
}
