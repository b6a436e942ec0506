"""Units in trees: gravity, placements, closures and bindings against their places (see part.units)."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from decimal import Decimal

from substructures.documents.units import Dimension
from substructures.expr.dimensions import Dimensioned
from substructures.part.part import Part
from substructures.part.units import (
    ACCELERATION,
    LENGTH,
    Notice,
    Place,
    UnitCheck,
    dimension_of,
    parameter_places,
    placement_places,
    vector,
)
from substructures.tree.document import TreeSpec


def check_tree_units(spec: TreeSpec, parts: Mapping[str, Part]) -> UnitCheck:
    """The units of a tree against their places; names are ``g`` of the tree and ``arm.l1`` of instances."""
    units = {name: each.unit for name, each in spec.parameters.items()}
    for name, part in parts.items():
        units |= {f"{name}.{parameter}": str(each["unit"]) for parameter, each in part.parameters.items()}
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


def bare_numbers(spec: TreeSpec, parts: Mapping[str, Part]) -> list[Notice]:
    """Warnings about numbers without a unit for parameters that their definition gives in another unit than SI."""
    message = "the number has no unit and is taken in {unit} (SI); the definition gives '{name}' in {given}"
    return [
        {
            "pointer": f"/instances/{i}/parameters/{name}",
            "code": "unit-assumed",
            "message": message.format(unit=described["unit"], name=name, given=described["given"]["unit"]),
        }
        for i, instance in enumerate(spec.instances)
        for name, value in instance.parameters.items()
        for described in (parts[instance.name].parameters.get(name, {}),)
        if "given" in described and isinstance(value, int | Decimal)
    ]
