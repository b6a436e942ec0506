"""Warnings about requests for analyses: impossible bodies, parameters without effect, limits and relations left."""

from __future__ import annotations

from typing import Any

import numpy as np
from pydantic import BaseModel

from service.models.source import Source
from substructures.analysis.motion.trajectory import Trajectory
from substructures.certificate.agreement import not_judged_warnings
from substructures.quantities.certificate import DYNAMICS
from substructures.quantities.numbers.states import read_states
from substructures.quantities.numbers.warnings import Notice, value_warnings

#: requests whose coordinates are only where something is looked for
NEAR = ("EquilibriaRequest", "RootLocusRequest", "ReducedRequest")


def warnings_of(source: Source, request: BaseModel, motion: Trajectory | None) -> list[Notice]:
    """What is hardly meant about the parameters and states of a request, or about the motion that followed from it."""
    given, inputs = (getattr(request, name, None) or {} for name in ("parameters", "inputs"))
    # a motion has told of the limits itself, which it may also leave between its results
    told = type(request).__name__ in NEAR or motion is not None
    q: Any = None if told else getattr(request, "q", None)
    states = np.zeros((0, len(source.model.positions))) if q is None else read_states(source.model, {"q": q}, None).q
    notices = value_warnings(source.sources, given, inputs, states)
    notices += not_judged_warnings(name for name in DYNAMICS if name in source.model.of_shape.program.not_judged)
    if getattr(request, "friction", None) == "loaded":
        notices = [each for each in notices if each["code"] != "friction-left-out"]
    # a model with its definitions has told of relations itself
    judge = source.sources.judge if motion is not None and source.model.plausibility is None else None
    if motion is not None and judge is not None:
        notices += judge.apart(source.model.positions, motion.q)
    return [*notices, *(motion.warnings if motion else ())]
