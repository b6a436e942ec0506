"""Units in definitions: every number has the dimension of its place, as far as the expressions tell.

Numbers are converted to SI where they are read (:meth:`substructures.loads.scope.Scope.read`); here it is checked that
they may stand where they stand, and noted what was converted.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from typing import Any

from substructures.documents.units import NUMBER, Dimension
from substructures.errors import Fault
from substructures.expr.steps import measured
from substructures.expr.units.angles import angle_warnings
from substructures.expr.units.dimensions import Dimensioned, Inferred
from substructures.expr.units.unit_check import Place, UnitCheck, dimension_of
from substructures.loads.friction import FRICTION
from substructures.loads.units import (
    ANGLE,
    ANGULAR_DAMPING,
    ANGULAR_STIFFNESS,
    COORDINATE,
    DAMPING,
    LENGTH,
    RATE,
    STIFFNESS,
    dimension,
    fields_of,
    of_kind,
    vector,
)
from substructures.part.definition import Definition, InertiaTensor, Input, Joint, Parameter, PartClosure, Placement
from substructures.part.topology import CHAINS, Topology

MASS, INERTIA, ACCELERATION = dimension("kg"), dimension("kg m^2"), dimension("m/s^2")
#: fields of joints by coordinate
JOINT: dict[str, tuple[Dimension, Dimension]] = {
    "stiffness": (ANGULAR_STIFFNESS, STIFFNESS),
    "damping": (ANGULAR_DAMPING, DAMPING),
    "armature": (INERTIA, MASS),
    "rest": COORDINATE,
    "limits": COORDINATE,
}
#: of what reactions add to it
FRICTION_LOAD: dict[str, tuple[Dimension, Dimension]] = {
    "coefficient": (NUMBER, NUMBER),
    **dict.fromkeys(("radius", "axial_radius"), (LENGTH, LENGTH)),
}
#: of end stops: stiffness, and damping of a rate for a depth
STOP: dict[str, tuple[Dimension, Dimension]] = {
    "stiffness": JOINT["stiffness"],
    "damping": (dimension("N m s/rad^2"), dimension("N s/m^2")),
}
#: of relations, by how many metres for radians the multiplier has
MULTIPLIER = {0: NUMBER, 1: dimension("m/rad"), -1: dimension("rad/m")}
ROW = {"psi": ANGLE, "theta": ANGLE, "phi": ANGLE, "d": LENGTH, "sigma": LENGTH, "tau": LENGTH}


def check_units(definition: Definition, topology: Topology) -> UnitCheck:
    """The units of a definition against their places, and pairs of limits that are of no coordinate."""
    names = {name: dimension_of(each.unit) for name, each in (definition.parameters | definition.inputs).items()}
    places = _Places(definition, topology)
    moving: dict[str, Inferred] = {"t": Dimensioned(dimension("s"), sure=False)}
    for joint in topology.joints:
        moving[joint.coordinate] = Dimensioned(COORDINATE[joint.s], sure=False)
        moving[f"{joint.coordinate}'"] = Dimensioned(RATE[joint.s], sure=False)
    check = UnitCheck(lambda name: names.get(name, "unknown"))
    check.check(parameter_places(definition.parameters), True)
    check.check(input_places(definition.inputs), True)
    check.check(places.bodies(), True)
    check.check(places.poses(), True)
    check.warnings += angle_warnings(places.bodies(), definition.parameters)
    # from here on: what moves may stand in loads alone, and is unknown in the numbers above
    check.names = lambda name: names[name] if name in names else moving.get(name) or dimension_of_measure(name)
    check.check(places.loads(), False)
    # here, since what is stored has only a warning of it: older versions did not look at pairs beyond the last
    check.faults += _limits_of_none(definition)
    return check


def _limits_of_none(definition: Definition) -> Iterator[Fault]:
    for i, body in enumerate(definition.bodies):
        given, n = body.joint.limits, len(CHAINS[body.joint.type])
        if given and isinstance(given[0], tuple) and len(given) > n:
            message = f"{len(given)} pairs of limits for the {n} coordinate(s) of a {body.joint.type} joint"
            yield Fault(f"/bodies/{i}/joint/limits", "wrong-length", message)


def parameter_places(parameters: Mapping[str, Parameter]) -> Iterator[Place]:
    """The values of parameters, which have the dimensions of their units."""
    for name, each in parameters.items():
        found = dimension_of(each.unit)
        yield f"/parameters/{name}/value", each.value, found.dimension if isinstance(found, Dimensioned) else None


def input_places(inputs: Mapping[str, Input]) -> Iterator[Place]:
    """The defaults of inputs, which have the dimensions of their units."""
    for name, each in inputs.items():
        found = dimension_of(each.unit)
        if each.default is not None:
            yield f"/inputs/{name}/default", each.default, found.dimension if isinstance(found, Dimensioned) else None


@dataclass(frozen=True)
class _Places:
    """The numbers of a definition with their places."""

    definition: Definition
    topology: Topology

    def bodies(self) -> Iterator[Place]:
        """Joints, masses, inertias, ports and closures."""
        kinds: dict[int, list[int]] = {}
        for entry in self.topology.joints:
            kinds.setdefault(entry.body, []).append(entry.s)
        for i, body in enumerate(self.definition.bodies):
            pointer = f"/bodies/{i}"
            yield from _joint(f"{pointer}/joint", body.joint, kinds.get(i, []))
            yield f"{pointer}/mass", body.mass, MASS
            yield from vector(f"{pointer}/com", body.com, LENGTH)
            for name in InertiaTensor.model_fields:
                if name != "about":
                    yield f"{pointer}/inertia/{name}", getattr(body.inertia, name), INERTIA
        s_of = {entry.coordinate: entry.s for entry in self.topology.joints}
        for i, each in enumerate(self.definition.relations):
            s, mover = s_of[each.coordinate], s_of[each.of]
            # q^d = mu q^i: 1 is m of rad, as of a screw, -1 rad of m, as of a pinion
            yield f"/relations/{i}/multiplier", each.multiplier, MULTIPLIER[s - mover]
            yield f"/relations/{i}/offset", each.offset, COORDINATE[s]
        for i, port in enumerate(self.definition.ports):
            yield from vector(f"/ports/{i}/position", port.position, LENGTH)
            yield from vector(f"/ports/{i}/rotation/rpy", port.rotation.rpy, ANGLE)
        yield from closure_places(self.definition.closures)

    def poses(self) -> Iterator[Place]:
        """Values of coordinates."""
        kinds = {entry.coordinate: entry.s for entry in self.topology.joints}
        kinds |= {name: 1 for ball in self.topology.balls for name in ball.place}
        for pose, given in self.definition.poses.items():
            for name, value in given.items():
                yield f"/poses/{pose}/{name}", value, COORDINATE[kinds[name]]

        for name, value in self.definition.start.items():
            yield f"/start/{name}", value, COORDINATE[kinds[name]]
        for name, ends in self.definition.ranges.items():
            yield from vector(f"/ranges/{name}", ends, COORDINATE[kinds[name]])

    def loads(self) -> Iterator[Place]:
        """Forces, torques, springs, bushings, joint loads, friction and potentials."""
        kinds = {entry.coordinate: entry.s for entry in self.topology.joints}
        for i, load in enumerate(self.definition.loads):
            yield from load.places(f"/loads/{i}", kinds)


def placement_places(pointer: str, placement: Placement) -> Iterator[Place]:
    """A constant offset."""
    yield from vector(f"{pointer}/position", placement.position, LENGTH)
    yield from vector(f"{pointer}/rpy", placement.rpy, ANGLE)


def closure_places(closures: Sequence[PartClosure]) -> Iterator[Place]:
    """Closures of a definition or of a tree."""
    for i, closure in enumerate(closures):
        yield from placement_places(f"/closures/{i}/placement", closure.placement)
        yield from vector(f"/closures/{i}/axis", closure.axis or (), None)
        yield f"/closures/{i}/length", closure.length, LENGTH


def _joint(pointer: str, joint: Joint, kinds: Sequence[int]) -> Iterator[Place]:
    """A joint with one coordinate or more; ``kinds``: 1 of prismatic ones."""
    for name, expected in ROW.items():
        yield f"{pointer}/{name}", getattr(joint, name), expected
    if joint.placement is not None:
        yield from placement_places(f"{pointer}/placement", joint.placement)
    yield from vector(f"{pointer}/axis", joint.axis or (), None)
    for name, dimensions in JOINT.items():
        yield from _by_coordinate(f"{pointer}/{name}", getattr(joint, name), dimensions, kinds, name == "limits")
    yield from _laws(f"{pointer}/limits_act", joint.limits_act, STOP, kinds)
    yield from _laws(f"{pointer}/friction", joint.friction, FRICTION, kinds)


def _laws(
    pointer: str, given: Any, fields: Mapping[str, tuple[Dimension, Dimension]], kinds: Sequence[int]
) -> Iterator[Place]:
    """What has several numbers by name, one for all coordinates of a joint, or one for each."""
    for step, s in enumerate(kinds):
        law, place = given, pointer
        if isinstance(given, tuple):
            law, place = (given[step], f"{pointer}/{step}") if step < len(given) else (None, pointer)
        if law is not None:
            yield from fields_of(place, law, of_kind(fields, s))
            if getattr(law, "load", None) is not None:
                yield from fields_of(f"{place}/load", law.load, of_kind(FRICTION_LOAD, s))


def _by_coordinate(
    pointer: str, given: Any, dimensions: tuple[Dimension, Dimension], kinds: Sequence[int], is_pair: bool
) -> Iterator[Place]:
    """One number (or pair) for all coordinates of a joint, or one for each."""
    is_list = isinstance(given, tuple) and (not is_pair or (bool(given) and isinstance(given[0], tuple)))
    for step, s in enumerate(kinds):
        if is_list and step >= len(given):
            return  # told elsewhere
        value, place = (given[step], f"{pointer}/{step}") if is_list else (given, pointer)
        if isinstance(value, tuple):
            yield from vector(place, value, dimensions[s])
        else:
            yield place, value, dimensions[s]


def dimension_of_measure(name: str) -> Inferred:
    """Of a measure of two frames, or of its rate."""
    found = measured(name)
    if found is None:
        return "unknown"
    dimensions = RATE if found[0].endswith("'") else COORDINATE
    # as coordinates: a distance like a prismatic one, in m, all others like a revolute one, in rad
    return Dimensioned(dimensions[found[0].startswith("distance")], sure=False)
