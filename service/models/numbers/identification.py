"""Base inertial parameters out of measured motions."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

from service.models.formulas import base_of
from service.models.numbers.analysis import Analysis
from service.models.source import Source
from service.schemas.measurements import ExcitationRequest, IdentificationRequest
from substructures.analysis.identification.base_parameters import BaseParameters, base_parameters
from substructures.analysis.identification.consistent import consistent_inertia
from substructures.analysis.identification.findings import Identification
from substructures.analysis.identification.fit import excitation, identify
from substructures.analysis.identification.new_versions import new_versions
from substructures.analysis.motion.integrators.progress import ProgressReport
from substructures.tree.model import Model


def _excitation(source: Source, read: ExcitationRequest, _: ProgressReport) -> Any:
    found = excitation(_base(source, read.drives), **_motion(read), closed=_closed(source))
    return {**vars(found), "is_good": found.is_good, "advice": found.advice}


def _identification(source: Source, read: IdentificationRequest, _: ProgressReport) -> Any:
    model, base = source.model if read.known else None, _base(source, read.drives)
    found = identify(
        base,
        **_motion(read),
        tau=read.tau,
        model=model,
        closed=_closed(source),
        held_out=read.held_out,
        error_limit=read.error_limit,
    )
    return _with_parts(source, read, base, found) if read.consistent else found


def _with_parts(source: Source, read: IdentificationRequest, base: BaseParameters, found: Identification) -> Any:
    """With consistent inertia and the next versions of the parts."""
    if source.parts is None:
        raise TypeError("parts expected")
    regressor, d = source.regressor(), read.prior_deviation
    inertia = consistent_inertia(base, regressor, found, parameters=read.parameters, prior_deviation=d)
    parts = new_versions(*source.parts(), inertia)
    return replace(found, inertia=inertia, parts=parts, checks=(*found.checks, *inertia.checks))


def _base(source: Source, drives: tuple[str, ...]) -> BaseParameters:
    """Those of the tree without closures and velocity constraints."""
    if not source.model.closures:
        return base_of(source, drives)
    return base_parameters(replace(source.regressor(), closures=()), drives)


def _closed(source: Source) -> Model | None:
    return source.model if source.model.closures or source.model.velocity_constraints else None


def _motion(read: ExcitationRequest) -> dict[str, Any]:
    return {name: getattr(read, name) for name in ("q", "qd", "qdd", "parameters")}


ANALYSES = {
    "excitations": Analysis(
        ExcitationRequest,
        _excitation,
        needs_parts=True,
    ),
    "identifications": Analysis(
        IdentificationRequest,
        _identification,
        needs_parts=True,
    ),
}
