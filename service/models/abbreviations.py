"""Abbreviated formulas as an analysis: the program, the formulas as text, and what is certain about them."""

from __future__ import annotations

from typing import Any

import orjson

from service.models.source import Source
from service.schemas.analyses.abbreviations import AbbreviationRequest
from substructures.abbreviation.abbreviate import Abbreviation, ElementError, abbreviate
from substructures.analysis.motion.integrators.progress import ProgressReport
from substructures.export import interface_of_model, render
from substructures.tree.model import Model

#: what is proven, in words
CRITERION = (
    "for all values in 'ranges' no element of the quantity is wrong by more than its 'bound', which is at most "
    "'simplify' times the largest absolute value of the same element there; 'attained' does not exceed that value"
)


def abbreviated(source: Source, read: AbbreviationRequest, report: ProgressReport) -> dict[str, Any]:
    """The answer to a request. Raises InvalidArgument with pointers into the request, TooLarge."""
    model = source.grouped()
    found = abbreviate(model, read.quantity, read.simplify, read.ranges, read.parameters, report)
    return {
        "quantity": found.quantity,
        "simplify": found.simplify,
        "operations_before": found.operations_before,
        "operations": found.operations,
        "bound": found.bound,
        "criterion": CRITERION,
        "errors": [_error(each) for each in found.errors],
        "ranges": {name: [float(x.low), float(x.high)] for name, x in found.ranges.items()},
        "values": {name: str(x) for name, x in found.values.items()},
        "program": orjson.loads(found.program.to_bytes()),
        "formulas": _text(source, model, found, read),
    }


def _error(error: ElementError) -> dict[str, Any]:
    neglected = [_fields(part) for part in error.neglected]
    return {**_fields(error), "index": list(error.index), "neglected": neglected}


def _fields(value: Any) -> dict[str, Any]:
    """The fields of a value by name."""
    return dict(vars(value))


def _text(source: Source, model: Model, found: Abbreviation, read: AbbreviationRequest) -> str | None:
    """The formulas in the format chosen; a function takes what is not fixed to a number (section 8)."""
    if read.format is None:
        return None
    interface = interface_of_model(model, digest=source.digest)
    fixed = [name for name in found.values if name in model.parameters]
    return render(found.program, read.format, read.form, interface=interface.bound(fixed), quantity=found.quantity)
