"""Base inertial parameters out of measured motions."""

from __future__ import annotations

from typing import Any

from service.models.formulas import base_of
from service.models.numbers.analysis import Analysis
from service.models.source import Source
from service.schemas.measurements import ExcitationRequest, IdentificationRequest
from substructures.analysis.identification.fit import excitation, identify
from substructures.analysis.motion.integrators.progress import ProgressReport


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


ANALYSES = {
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
