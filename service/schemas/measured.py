"""Numbers of requests that have a dimension: each may come with a unit, ``{"value": 30, "unit": "deg"}``.

A field says in its type what stands there, as in ``Annotated[Positive, SECONDS]``; before the field is read its numbers
are converted to SI and checked, names against the model about which the request is (:func:`read_measured`).
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Annotated, Any, TypeVar

from pydantic import BaseModel, GetCoreSchemaHandler, GetJsonSchemaHandler, ValidationInfo
from pydantic_core import CoreSchema, PydanticCustomError, core_schema

from substructures.documents import escape, read_model
from substructures.documents.fields import Real
from substructures.documents.units import Dimension, si_text
from substructures.errors import Fault, InvalidArgument
from substructures.expr.steps import ExpressionError
from substructures.expr.syntax import read
from substructures.expr.units.dimensions import Dimensioned, DimensionError, Inference, Inferred
from substructures.expr.units.unit_check import UnitCheck, dimension_of
from substructures.mechanics.state_names import EFFORTS
from substructures.quantities.measured import PlaceUnits, si_values
from substructures.tree.model import Model

Plain = Mapping[str, Any]
#: of the model, the fields of the request that were read before, and what was given: what stands there
Place = Callable[[Model, Plain, Any], PlaceUnits]
M = TypeVar("M", bound=BaseModel)
MOMENTA = {"R": "N m s", "P": "N s"}


def read_measured(schema: type[M], body: Any, model: Model | None) -> M:
    """A body of a request about a model, if it is known. Raises InvalidDocument with pointers."""
    return read_model(schema, body, context=None if model is None else {"model": model})


@dataclass(frozen=True)
class WithUnits:
    """A field whose numbers may have units, which are looked at where they are used."""

    def __get_pydantic_json_schema__(self, schema: CoreSchema, handler: GetJsonSchemaHandler) -> dict[str, Any]:
        """Every number may be one with a unit."""
        return with_units(handler(schema))


@dataclass(frozen=True)
class Measured(WithUnits):
    """What stands in a field: a ``unit``, or what a ``place`` says, where a model is known."""

    unit: str = ""
    place: Place | None = None

    def _converted(self, given: Any, info: ValidationInfo) -> Any:
        model = (info.context or {}).get("model")
        units: PlaceUnits = self.unit
        if self.place is not None:
            units = {} if model is None else self.place(model, info.data or {}, given)
        try:
            found = si_values(given, units, "")
        except InvalidArgument as error:
            raise _told(error.faults) from None
        if model is not None:
            check = UnitCheck(lambda name: _dimension(model, name))
            check.check(_texts(found, units), False)
            if check.faults:
                raise _told(check.faults)
        return found

    def __get_pydantic_core_schema__(self, source: Any, handler: GetCoreSchemaHandler) -> CoreSchema:
        """Converted first, then read as what it is."""
        return core_schema.with_info_before_validator_function(self._converted, handler(source))


def _told(faults: Sequence[Fault]) -> PydanticCustomError:
    context = {"message": faults[0].message, "below": faults[0].pointer}
    return PydanticCustomError(faults[0].code, "{message}", context)


def _texts(given: Any, units: PlaceUnits) -> Iterator[tuple[str, str, Dimension | None]]:
    """Expressions with the dimensions of their places."""
    if isinstance(given, Mapping) and isinstance(units, Mapping):
        for name, x in given.items():
            for below, text, expected in _texts(x, units.get(name, "")):
                yield f"/{escape(name)}{below}", text, expected
    elif isinstance(given, str) and isinstance(units, str):
        place = dimension_of(units)
        yield "", given, place.dimension if isinstance(place, Dimensioned) else None


def with_units(schema: Mapping[str, Any]) -> dict[str, Any]:
    """A JSON schema in which each number, and each list of numbers, may have a unit."""
    plain = dict(schema)
    if plain.get("type") == "number":
        about = _taken(plain)
        return {**about, "anyOf": [plain, quantity_of(plain)]}
    if isinstance(plain.get("additionalProperties"), Mapping):
        plain["additionalProperties"] = with_units(plain["additionalProperties"])
    for name in ("anyOf", "oneOf"):
        if name in plain:
            plain[name] = [x for each in plain[name] for x in _alternatives(with_units(each), name)]
    if plain.get("type") != "array":
        return plain
    about = _taken(plain)
    lists = quantity_of(plain)
    for name in ("items", "prefixItems"):
        if name in plain:
            some = plain[name]
            plain[name] = [with_units(x) for x in some] if isinstance(some, list) else with_units(some)
    return {**about, "anyOf": [plain, lists]}


def _taken(schema: dict[str, Any]) -> dict[str, Any]:
    """What a schema says of the place, taken out of it."""
    return {name: schema.pop(name) for name in ("title", "default", "description") if name in schema}


def _alternatives(schema: Mapping[str, Any], name: str) -> Iterator[Mapping[str, Any]]:
    """What a schema is one of: alternatives in alternatives are as many more."""
    if schema.keys() == {name}:
        yield from schema[name]
    else:
        yield schema


def quantity_of(schema: Mapping[str, Any]) -> dict[str, Any]:
    """The JSON schema of what has a unit."""
    properties = {"value": dict(schema), "unit": {"type": "string", "maxLength": 64}}
    return {"type": "object", "properties": properties, "required": ["value", "unit"], "additionalProperties": False}


def _varied_units(model: Model) -> dict[str, str]:
    """Of parameters, coordinates and velocities."""
    states = model.state_units
    return {**model.units, **states["q"], **{f"{name}'": unit for name, unit in states["qd"].items()}}


def _steady_units(model: Model, read_before: Plain) -> Mapping[str, str]:
    """Of parameters, and of the rates of coordinates, or their momenta where these are given."""
    kinds = zip(model.coordinates, model.joints, strict=True)
    moving = {name: MOMENTA[kind] for name, kind in kinds} if read_before.get("momenta") is not None else {}
    return {**model.units, **model.state_units["qd"], **moving, "precession": "rad/s"}


def _in_order(units: Mapping[str, str]) -> Place:
    """By the kind of a coordinate's joint, for all coordinates."""
    return lambda model, _, __: {name: units[kind] for name, kind in zip(model.coordinates, model.joints, strict=True)}


def _signals(units: Mapping[str, str], given: Any) -> PlaceUnits:
    """Of functions of time: a table has times, and values."""
    tables = given if isinstance(given, Mapping) else {}
    return {
        name: {"times": "s", "values": unit} if _is_table(tables.get(name)) else unit for name, unit in units.items()
    }


def _is_table(given: Any) -> bool:
    return isinstance(given, Mapping) and "values" in given


def expression_unit(model: Model, text: Any) -> str:
    """The SI unit of an expression in coordinates, velocities, parameters, inputs and t; empty if it is not known."""
    try:
        found = Inference(lambda name: _dimension(model, name)).of(read(str(text)))
    except (ExpressionError, DimensionError):
        return ""
    return si_text(found.dimension) if isinstance(found, Dimensioned) else ""


def _dimension(model: Model, name: str) -> Inferred:
    """Of a name in an expression; coordinates, velocities and t have implied factors, as in loads."""
    moving = {**model.state_units["q"], "t": "s"} | {f"{c}'": unit for c, unit in model.state_units["qd"].items()}
    found = dimension_of(moving.get(name) or model.units.get(name, ""))
    return replace(found, sure=False) if name in moving and isinstance(found, Dimensioned) else found


def _of_symbols(model: Model) -> PlaceUnits:
    """Of coordinates and their rates, the time, parameters and inputs."""
    moving = zip(("", "'", "''"), model.state_units.values(), strict=True)
    rates = {f"{name}{primes}": unit for primes, units in moving for name, unit in units.items()}
    return {**model.units, **rates, "t": "s"}


def _quasi_velocities(model: Model, read_before: Plain, _: Any) -> PlaceUnits:
    """Of quasi-velocities by name: of the expressions that they are, or rates of coordinates."""
    given = read_before.get("velocities")
    chosen = read_before.get("independent") or ()
    rates = model.state_units["qd"]
    named = {name: rates.get(name, "") for name in chosen}
    return {name: expression_unit(model, text) for name, text in given.items()} if given else {**rates, **named}


SECONDS, METRES, RADIANS_PER_SECOND = Measured("s"), Measured("m"), Measured("rad/s")
METRES_PER_SECOND = Measured("m/s")
COORDINATES = Measured(place=lambda model, _, __: model.state_units["q"])
VELOCITIES = Measured(place=lambda model, _, __: model.state_units["qd"])
ACCELERATIONS = Measured(place=lambda model, _, __: model.state_units["qdd"])
EFFORTS_OF_ACTUATORS = Measured(place=_in_order(EFFORTS))
MOMENTA_OF_COORDINATES = Measured(place=_in_order(MOMENTA))
#: parameters or inputs by name
BY_NAME = Measured(place=lambda model, _, __: model.units)
#: of coordinates and velocities by name
STATES = Measured(place=lambda model, _, __: _varied_units(model))
#: of everything that a formula may depend on, by name
RANGES = Measured(place=lambda model, _, __: _of_symbols(model))
INPUT_SIGNALS = Measured(place=lambda model, _, given: _signals(model.units, given))
COORDINATE_SIGNALS = Measured(place=lambda model, _, given: _signals(model.state_units["q"], given))
EXPRESSION = Measured(place=lambda _, __, ___: "")
EXPRESSIONS = Measured(place=lambda _, __, given: dict.fromkeys(given if isinstance(given, Mapping) else (), ""))
OF_VARIED = Measured(place=lambda model, before, _: _varied_units(model).get(str(before.get("vary")), ""))
OF_STEADY = Measured(place=lambda model, before, _: _steady_units(model, before).get(str(before.get("vary")), ""))
OF_PARAMETER = Measured(place=lambda model, before, _: model.units.get(str(before.get("parameter")), ""))
OF_QUANTITY = Measured(place=lambda model, before, _: expression_unit(model, before.get("quantity", "")))
QUASI_VELOCITIES = Measured(place=_quasi_velocities)
#: numbers by name
Values = Annotated[dict[str, Real], BY_NAME]
#: of tables: what their signal is, which is known where that is read
OF_SIGNAL = Measured()
