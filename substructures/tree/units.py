"""Units in trees: gravity, placements, closures and bindings against their places (see part.units)."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from decimal import Decimal
from typing import Any

from substructures.documents.units import Dimension
from substructures.expr.dimensions import Dimensioned
from substructures.expr.program import Program
from substructures.expr.unit_check import Notice, Place, UnitCheck, dimension_of
from substructures.part.parameters import names_in_limits
from substructures.part.part import Part
from substructures.part.units import ACCELERATION, LENGTH, parameter_places, placement_places, vector
from substructures.tree.document import TreeSpec

#: parameters of a definition by name, with their SI units
DescribedParameters = Mapping[str, Mapping[str, Any]]


def check_tree_units(spec: TreeSpec, parameters: Mapping[str, DescribedParameters]) -> UnitCheck:
    """The units of a tree against their places; ``parameters``: those of the part of every instance that is known.

    Names are ``g`` of the tree and ``arm.l1`` of instances.
    """
    units = {name: each.unit for name, each in spec.parameters.items()}
    for instance, described in parameters.items():
        units |= {f"{instance}.{name}": str(each["unit"]) for name, each in described.items()}
    known = {name: dimension_of(unit) for name, unit in units.items()}
    check = UnitCheck(lambda name: known.get(name, "unknown"))
    check.check(parameter_places(spec.parameters), True)
    check.check(_places(spec), True)
    dimensions = {name: x.dimension for name, x in known.items() if isinstance(x, Dimensioned)}
    check.check(_bindings(spec, dimensions), True)
    return check


def _places(spec: TreeSpec) -> Iterator[Place]:
    yield from vector("/gravity", spec.gravity, ACCELERATION)
    for i, instance in enumerate(spec.instances):
        yield from placement_places(f"/instances/{i}/placement", instance.placement)
    for i, closure in enumerate(spec.closures):
        yield from placement_places(f"/closures/{i}/placement", closure.placement)
        yield from vector(f"/closures/{i}/axis", closure.axis or (), None)
        yield f"/closures/{i}/length", closure.length, LENGTH


def _bindings(spec: TreeSpec, dimensions: Mapping[str, Dimension]) -> Iterator[Place]:
    """What parameters of instances are bound to has the dimension of the parameter."""
    for i, instance in enumerate(spec.instances):
        for name, value in instance.parameters.items():
            yield f"/instances/{i}/parameters/{name}", value, dimensions.get(f"{instance.name}.{name}")


def tree_warnings(spec: TreeSpec, parts: Mapping[str, Part], program: Program, moves: bool) -> list[Notice]:
    """Gravity that was not given, parameters and bindings without effect, bindings whose unit is only assumed."""
    notices = []
    if moves and "gravity" not in spec.model_fields_set:
        notices.append(_notice("/gravity", "gravity-not-given", "gravity is not given and is taken as zero"))
    used = {symbol.name for symbol in program.symbols}
    for name in spec.parameters:
        if name not in used:
            message = f"no formula depends on the parameter '{name}'"
            notices.append(_notice(f"/parameters/{name}", "no-effect", message))
    for i, instance in enumerate(spec.instances):
        part = parts[instance.name]
        needed = {symbol.name for symbol in part.program.symbols} | names_in_limits(part.definition)
        for name, value in instance.parameters.items():
            pointer, given = f"/instances/{i}/parameters/{name}", part.parameters[name].get("given")
            if name not in needed:
                message = f"no formula of '{instance.name}' depends on the parameter '{name}'"
                notices.append(_notice(pointer, "no-effect", message))
            elif given and isinstance(value, int | Decimal):
                unit = part.parameters[name]["unit"]
                message = (
                    f"{value} has no unit and is taken in {unit} (SI); the definition gives '{name}' in {given['unit']}"
                )
                notices.append(_notice(pointer, "unit-assumed", message))
    return notices


def _notice(pointer: str, code: str, message: str) -> Notice:
    return {"pointer": pointer, "code": code, "message": message}
