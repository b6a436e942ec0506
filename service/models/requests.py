"""Bodies of requests, of every face (HTTP, jobs, command line), are read here, and become arguments of functions."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from pydantic import BaseModel

from service.schemas.analyses.motions import AnySimulationRequest, ClosedRequest, RollingRequest, SimulationRequest
from service.schemas.logs import Logged
from service.schemas.measured import read_measured
from service.schemas.parts import RequestPart
from substructures.documents import escape, require_object
from substructures.errors import Fault, InvalidArgument
from substructures.tree.model import Model


def read_request(schema: type[BaseModel], body: Any, model: Model | None = None) -> BaseModel:
    """The body of a request about a tree, numbers in SI; without the model names are not looked at.

    Raises InvalidInput with pointers.
    """
    require_object(body)
    if issubclass(schema, Logged):
        read = read_measured(schema, schema.unfolded(body), model)
        read.require_motion()
        return read
    if schema is not AnySimulationRequest:
        return read_measured(schema, body, model)
    chosen = _motion(body, model)
    _require_fields_of(chosen, body)
    return read_measured(chosen, body, model)


#: the simulations that there are, and what makes a request one of them
MOTIONS: dict[type[BaseModel], str] = {
    SimulationRequest: "of trees without closures",
    ClosedRequest: "with closures or 'prescribed' coordinates",
    RollingRequest: "with velocity constraints",
}


def _require_fields_of(chosen: type[BaseModel], body: Mapping[str, Any]) -> None:
    """Raises InvalidArgument for fields that only other simulations have, and says which."""
    faults = []
    for name in body:
        others = [what for schema, what in MOTIONS.items() if name in schema.model_fields]
        if others and name not in chosen.model_fields:
            message = f"'{name}' is a field of simulations {' and '.join(others)}, not of those {MOTIONS[chosen]}"
            faults.append(Fault(f"/{escape(name)}", "extra-forbidden", message))
    if faults:
        raise InvalidArgument(faults)


def _motion(body: Mapping[str, Any], model: Model | None) -> type[BaseModel]:
    """Which of the requests for simulations it is, as :func:`substructures.analysis.simulate.simulate` chooses."""
    if body.get("constraints") or (model is not None and model.velocity_constraints):
        return RollingRequest
    return ClosedRequest if (model is not None and model.closures) or body.get("prescribed") else SimulationRequest


def arguments(request: BaseModel) -> dict[str, Any]:
    """The fields that were given, by name, with values of the science; it has the same defaults for all others."""
    return {name: _value(getattr(request, name), f"/{name}") for name in request.model_fields_set}


def _value(given: Any, place: str) -> Any:
    if isinstance(given, RequestPart):
        return given.value()
    if isinstance(given, dict):
        return {name: _value(item, f"{place}/{escape(name)}") for name, item in given.items()}
    if isinstance(given, tuple) and given and isinstance(given[0], RequestPart):
        return tuple(_item(item, f"{place}/{i}") for i, item in enumerate(given))
    return given


def _item(given: RequestPart, place: str) -> Any:
    try:
        return given.value()
    except InvalidArgument as error:
        raise error.below(place) from None
