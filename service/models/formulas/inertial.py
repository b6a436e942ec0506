"""Base inertial parameters and their regressor."""

from __future__ import annotations

from typing import Any

from service.models.formulas.entry import Made, Options, Quantity
from service.models.source import Source
from substructures.analysis.identification.base_parameters import base_parameters
from substructures.errors import TooLarge


def _base_parameters(source: Source, options: Options) -> Made:
    found = base_parameters(source.regressor(), options.get("drives", ()))
    members: dict[str, Any] = {
        "standard": list(found.standard),
        "units": list(found.units),
        "base": list(found.names),
        "unseen": list(found.unseen),
        "drives": list(found.drives),
    }
    try:
        members["combinations"] = found.combinations()
    except TooLarge:
        members["combinations"] = None
    return Made(found.program, members, found)


QUANTITIES = {
    "base_parameters": Quantity(_base_parameters, ("drives",), ("grouping", "base_parameters"), needs_parts=True),
    "base_regressor": Quantity(_base_parameters, ("drives",), ("base_regressor",), needs_parts=True),
}
