"""What is told of parameters: in SI, as they were given, as older versions meant them, without effect."""

from __future__ import annotations

from collections.abc import Collection, Iterator, Mapping
from contextlib import suppress
from typing import Any

from substructures.documents.fields import Quantity, in_si
from substructures.documents.units import UnknownUnitError, read_unit, si_unit
from substructures.expr.units.unit_check import Notice, steps_of
from substructures.loads.friction import FrictionLaw, FrictionLoad
from substructures.part.definition import BearingFriction, Definition, Input, Parameter


def described(parameters: Mapping[str, Parameter]) -> dict[str, dict[str, Any]]:
    """Value and unit of parameters in SI, description; ``given`` is what was given in another unit."""
    return {name: _described(each) for name, each in parameters.items()}


def _described(parameter: Parameter) -> dict[str, Any]:
    value, unit = parameter.value, parameter.unit
    plain = {"value": in_si(value), "unit": unit, "description": parameter.description}
    if isinstance(value, Quantity):
        return plain if value.measure.is_si else plain | {"given": value.model_dump()}
    return plain if parameter.si_unit == unit else plain | {"unit": parameter.si_unit, "given": {"unit": unit}}


def described_inputs(inputs: Mapping[str, Input]) -> dict[str, dict[str, Any]]:
    """Unit of inputs in SI and description; where there is one, the ``default`` in SI, and what was ``given``."""
    return {name: _described_input(each) for name, each in inputs.items()}


def _described_input(given: Input) -> dict[str, Any]:
    plain: dict[str, Any] = {"unit": si_unit(given.unit), "description": given.description}
    if given.default is None:
        return plain
    plain["default"] = in_si(given.default)
    if isinstance(given.default, Quantity) and not given.default.measure.is_si:
        plain["given"] = given.default.model_dump()
    return plain


def counted(definition: dict[str, Any]) -> dict[str, Any]:
    """A definition that was stored when units were texts, as plain data that mean the same today.

    Its numbers are SI whatever their unit says, so that a unit which would change them now becomes words.
    """
    kinds = [kind for kind in ("parameters", "inputs") if kind in definition]
    return definition | {kind: {name: _counted(x) for name, x in definition[kind].items()} for kind in kinds}


def _counted(given: dict[str, Any]) -> dict[str, Any]:
    text = given.get("unit", "")
    if not text or isinstance(given.get("value"), Mapping):
        return given
    with suppress(UnknownUnitError):
        # no number that the unit would change
        if read_unit(text).is_si or given.get("value") is None:
            return given
    return given | {"unit": "", "description": f"{given.get('description', '')} [{text}]".strip()[:2000]}


def uncounted(parameters: Mapping[str, Mapping[str, Any]]) -> list[Notice]:
    """Warnings about units of parameters that were stored when units were texts: their numbers are taken as SI."""
    message = "'{}' was no unit that counts when this was stored: the number is taken as SI"
    return [
        {"pointer": f"/parameters/{name}/unit", "code": "unit-not-counted", "message": message.format(each["unit"])}
        for name, each in parameters.items()
        if "unit" in _counted(dict(each)) and _counted(dict(each))["unit"] != each["unit"]
    ]


def without_effect(definition: Definition, used: Collection[str]) -> list[Notice]:
    """Warnings about parameters and inputs on which neither a formula depends, ``used``: on these, nor a limit."""
    named = names_in_limits(definition).union(used)
    return [
        {"pointer": f"/{kind}s/{name}", "code": "no-effect", "message": f"no formula depends on the {kind} '{name}'"}
        for kind, names in (("parameter", definition.parameters), ("input", definition.inputs))
        for name in names
        if name not in named
    ]


def names_in_limits(definition: Definition) -> set[str]:
    """The parameters that limits and friction of joints, relations and closures depend on."""
    given: list[Any] = [(body.joint.limits, body.joint.friction) for body in definition.bodies]
    given.append(tuple(load for load in definition.loads if isinstance(load, FrictionLoad)))
    given += [(each.multiplier, each.offset) for each in definition.relations]
    given += [(*each.placement.position, *each.placement.rpy, each.length or 0) for each in definition.closures]
    return {str(step.value) for x in _flat(given) if isinstance(x, str) for step in steps_of(x) if step.op == "name"}


def _flat(given: Any) -> Iterator[Any]:
    for x in given or ():
        if isinstance(x, FrictionLaw | BearingFriction):
            yield from _flat(tuple(each for _, each in x))
        else:
            yield from _flat(x) if isinstance(x, tuple) else (in_si(x),)
