"""Units in trees: gravity, placements, closures and bindings against their places (see part.units)."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping, Sequence
from decimal import Decimal
from typing import Any

from substructures.documents import escape
from substructures.documents.units import NUMBER, read_unit
from substructures.expr.program import Program
from substructures.expr.units.angles import RAD, angle_warnings
from substructures.expr.units.dimensions import Dimensioned, Inferred
from substructures.expr.units.unit_check import Notice, Place, UnitCheck, dimension_of
from substructures.loads.units import COORDINATE, LENGTH, RATE, vector
from substructures.part.definition import Definition
from substructures.part.parameters import names_in_limits
from substructures.part.part import Part
from substructures.part.relations import left_out_warnings, weightless_warnings
from substructures.part.topology import topology
from substructures.part.units import (
    ACCELERATION,
    closure_places,
    dimension_of_measure,
    input_places,
    parameter_places,
    placement_places,
)
from substructures.tree.document import TreeSpec
from substructures.tree.given.ties import RollingConstraint

TIME = read_unit("s").dimension
#: of revolute and prismatic coordinates
MOMENTUM = tuple(read_unit(unit).dimension for unit in ("kg*m^2/s", "kg*m/s"))
#: parameters of a definition by name, with their SI units
DescribedParameters = Mapping[str, Mapping[str, Any]]


def check_tree_units(
    spec: TreeSpec, parameters: Mapping[str, DescribedParameters], definitions: Mapping[str, Definition]
) -> UnitCheck:
    """The units of a tree against their places; ``parameters``: those of the part of every instance that is known,
    ``definitions``: likewise, what coordinates and inputs of loads belong to.

    Names are ``g`` of the tree and ``arm.l1`` of instances.
    """

    def unit(name: str) -> str | None:
        """Of a parameter of the tree or of an instance; None of what is none."""
        if name in spec.parameters:
            return spec.parameters[name].unit
        instance, _, of_part = name.partition(".")
        found = parameters.get(instance, {}).get(of_part)
        return None if found is None else str(found["unit"])

    def dimension(name: str) -> Inferred | None:
        """Of a parameter; None of what is none."""
        given = unit(name)
        return None if given is None else dimension_of(given)

    check = UnitCheck(lambda name: dimension(name) or "unknown")
    check.check(parameter_places(spec.parameters), True)
    check.check(input_places(spec.inputs), True)
    places = list(_places(spec))
    check.check(places, True)
    check.check(_bindings(spec, dimension), True)
    radians = _bindings(spec, lambda name: Dimensioned(NUMBER) if unit(name) == RAD else None)
    check.warnings += angle_warnings([*places, *radians], spec.parameters)
    if spec.loads or spec.driven or spec.ignored:
        kinds = _kinds(definitions)
        moving = _moving(spec, definitions, kinds)
        # constants first: in the numbers above what moves is unknown
        check.names = lambda name: dimension(name) or moving.get(name) or dimension_of_measure(name)
        check.check(_loads(spec, kinds), False)
        check.check(_driven(spec, kinds), False)
        check.check(_ignored(spec, kinds), False)
    return check


def _kinds(definitions: Mapping[str, Definition]) -> dict[str, int]:
    """1 of prismatic and 0 of revolute coordinates."""
    return {
        f"{instance}.{joint.coordinate}": joint.s
        for instance, definition in definitions.items()
        for joint in topology(definition).joints
    }


def _moving(spec: TreeSpec, definitions: Mapping[str, Definition], kinds: Mapping[str, int]) -> dict[str, Inferred]:
    """The dimensions of inputs, coordinates, velocities and the time."""
    inputs = {name: each.unit for name, each in spec.inputs.items()}
    inputs |= {f"{i}.{name}": each.unit for i, d in definitions.items() for name, each in d.inputs.items()}
    result = {name: dimension_of(unit) for name, unit in inputs.items()}
    result["t"] = Dimensioned(TIME, sure=False)
    for name, s in kinds.items():
        result[name] = Dimensioned(COORDINATE[s], sure=False)
        result[f"{name}'"] = Dimensioned(RATE[s], sure=False)
    return result


def _loads(spec: TreeSpec, kinds: Mapping[str, int]) -> Iterator[Place]:
    """The numbers of loads."""
    for i, load in enumerate(spec.loads):
        yield from load.places(f"/loads/{i}", kinds)


def _driven(spec: TreeSpec, kinds: Mapping[str, int]) -> Iterator[Place]:
    """Given motions have the dimension of their coordinate."""
    for name, motion in spec.driven.items():
        if name in kinds:
            yield f"/driven/{escape(name)}", motion, COORDINATE[kinds[name]]


def _ignored(spec: TreeSpec, kinds: Mapping[str, int]) -> Iterator[Place]:
    """Given momenta."""
    for name, momentum in spec.ignored.items():
        if name in kinds:
            yield f"/ignored/{escape(name)}", momentum, MOMENTUM[kinds[name]]


def _places(spec: TreeSpec) -> Iterator[Place]:
    yield from vector("/gravity", spec.gravity, ACCELERATION)
    for i, instance in enumerate(spec.instances):
        yield from placement_places(f"/instances/{i}/placement", instance.placement)
    yield from closure_places(spec.closures)
    for i, each in enumerate(spec.velocity_constraints):
        if isinstance(each, RollingConstraint):
            yield f"/velocity_constraints/{i}/radius", each.radius, LENGTH
    for i, contact in enumerate(spec.contacts):
        if contact.rest_velocity is not None:
            yield f"/contacts/{i}/rest_velocity", contact.rest_velocity, RATE[1]


def _bindings(spec: TreeSpec, dimension: Callable[[str], Inferred | None]) -> Iterator[Place]:
    """What parameters of instances are bound to has the dimension of the parameter."""
    for i, instance in enumerate(spec.instances):
        for name, value in instance.parameters.items():
            found = dimension(f"{instance.name}.{name}")
            known = found.dimension if isinstance(found, Dimensioned) else None
            yield f"/instances/{i}/parameters/{name}", value, known


def tree_warnings(spec: TreeSpec, parts: Mapping[str, Part], program: Program, names: Sequence[str]) -> list[Notice]:
    """Gravity that was not given, coordinates (``names``) without mass, flanges that do not fit, what parts leave out,
    parameters and bindings without effect, bindings whose unit is only assumed.
    """
    notices: list[Notice] = []
    if names and "gravity" not in spec.model_fields_set:
        notices.append(_notice("/gravity", "gravity-not-given", "gravity is not given and is taken as zero"))
    if "friction_load" in program.outputs:
        message = "friction by the load of joints acts in simulations with 'friction': 'loaded' alone"
        notices.append(_notice("", "friction-left-out", f"{message}; formulas and other numbers leave it out"))
    used = {symbol.name for symbol in program.symbols}
    for name in spec.parameters:
        if name not in used:
            message = f"no formula depends on the parameter '{name}'"
            notices.append(_notice(f"/parameters/{name}", "no-effect", message))
    notices += [
        _notice(f"/inputs/{name}", "no-effect", f"no formula depends on the input '{name}'")
        for name in spec.inputs
        if name not in used
    ]
    notices += weightless_warnings(program, names)
    notices += differing_interfaces(spec, {name: part.definition for name, part in parts.items()})
    for i, instance in enumerate(spec.instances):
        part = parts[instance.name]
        told = left_out_warnings(part.definition)
        notices += [_notice(f"/instances/{i}", x["code"], f"instance '{instance.name}': {x['message']}") for x in told]
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


def differing_interfaces(spec: TreeSpec, definitions: Mapping[str, Definition]) -> Iterator[Notice]:
    """A notice for every instance whose mount has another interface than the port of its host; by instance the
    ``definitions``. Where one of them names none, everything fits.
    """
    for i, instance in enumerate(spec.instances):
        host, _, name = instance.at.partition(".")
        mount = definitions[instance.name].mount
        ports = {port.name: port.interface for port in definitions[host].ports} if host in definitions else {}
        given = ports.get(name, "")
        if mount is not None and mount.interface and given and mount.interface != given:
            message = f"'{instance.at}' is a '{given}', and '{instance.name}' is made for a '{mount.interface}'"
            yield _notice(f"/instances/{i}/at", "interfaces-differ", message)


def _notice(pointer: str, code: str, message: str) -> Notice:
    return {"pointer": pointer, "code": code, "message": message}
