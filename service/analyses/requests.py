"""Bodies of requests, of every face (HTTP, jobs, command line), are read here, and become arguments of functions."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from pydantic import BaseModel

from service.schemas.motions import AnySimulationRequest, ClosedRequest, RollingRequest, SimulationRequest
from service.schemas.parts import RequestPart
from substructures.documents import pointer_step, read_model
from substructures.errors import InvalidDocument
from substructures.quantities.states import NO_UNITS, si_numbers


def read_request(
    schema: type[BaseModel], body: Any, is_closed: bool = False, units: Mapping[str, str] = NO_UNITS
) -> BaseModel:
    """The body of a request about a tree, ``is_closed``: with closures, ``units``: of its parameters and inputs in SI.

    Raises InvalidInput with pointers.
    """
    if not isinstance(body, Mapping):
        raise InvalidDocument.at("", "object-expected", "expected a JSON object")
    body = {**body, **{field: _in_si(body[field], field, units) for field in ("parameters", "inputs") if field in body}}
    return read_model(_motion(body, is_closed) if schema is AnySimulationRequest else schema, body)


def _in_si(given: Any, field: str, units: Mapping[str, str]) -> Any:
    """Values by name, those with a unit converted."""
    if not isinstance(given, Mapping):
        return given
    return {
        name: si_numbers(x, units.get(name, ""), f"/{field}{pointer_step(name)}") if _has_unit(x) else x
        for name, x in given.items()
    }


def _has_unit(given: Any) -> bool:
    return isinstance(given, Mapping) and "unit" in given


def _motion(body: Mapping[str, Any], is_closed: bool) -> type[BaseModel]:
    """Which of the requests for simulations it is, as :func:`substructures.analysis.simulate.simulate` chooses."""
    if body.get("constraints"):
        return RollingRequest
    return ClosedRequest if is_closed or body.get("prescribed") else SimulationRequest


def arguments(request: BaseModel) -> dict[str, Any]:
    """The fields that were given, by name, with values of the science; it has the same defaults for all others."""
    return {name: _value(getattr(request, name)) for name in request.model_fields_set}


def _value(given: Any) -> Any:
    if isinstance(given, RequestPart):
        return given.value()
    if isinstance(given, dict):
        return {name: _value(item) for name, item in given.items()}
    if isinstance(given, tuple) and given and isinstance(given[0], RequestPart):
        return tuple(_value(item) for item in given)
    return given
