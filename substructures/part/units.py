"""Units in definitions: every number has the dimension of its place, as far as the expressions tell.

Numbers are converted to SI where they are read (:meth:`substructures.part.scope.Scope.read`); here it is checked that
they may stand where they stand, and noted what was converted.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from typing import Any

from substructures.documents import DocumentPart
from substructures.documents.units import NUMBER, Dimension, read_unit
from substructures.expr.syntax import measured
from substructures.expr.units.dimensions import Dimensioned, Inferred
from substructures.expr.units.unit_check import Place, UnitCheck, dimension_of
from substructures.part.angles import angle_warnings
from substructures.part.definition import (
    Definition,
    FrictionLaw,
    FrictionLoad,
    InertiaTensor,
    Input,
    Joint,
    JointLoad,
    Load,
    Parameter,
    Placement,
    SpringLoad,
)
from substructures.part.topology import Topology


def _dimension(text: str) -> Dimension:
    return read_unit(text).dimension


ANGLE = NUMBER
LENGTH, MASS, INERTIA = _dimension("m"), _dimension("kg"), _dimension("kg m^2")
FORCE, TORQUE, ACCELERATION = _dimension("N"), _dimension("N m"), _dimension("m/s^2")
#: of a revolute and of a prismatic coordinate
COORDINATE = (ANGLE, LENGTH)
RATE = (_dimension("rad/s"), _dimension("m/s"))
EFFORT = (TORQUE, FORCE)
#: fields of joints by coordinate
JOINT: dict[str, tuple[Dimension, Dimension]] = {
    "stiffness": (_dimension("N m/rad"), _dimension("N/m")),
    "damping": (_dimension("N m s/rad"), _dimension("N s/m")),
    "armature": (INERTIA, MASS),
    "rest": COORDINATE,
    "limits": COORDINATE,
}
#: of dry friction
FRICTION: dict[str, tuple[Dimension, Dimension]] = {
    **dict.fromkeys(("coulomb", "static"), EFFORT),
    **dict.fromkeys(("stribeck", "velocity"), RATE),
}
#: of what reactions add to it
FRICTION_LOAD: dict[str, tuple[Dimension, Dimension]] = {
    "coefficient": (NUMBER, NUMBER),
    **dict.fromkeys(("radius", "axial_radius"), (LENGTH, LENGTH)),
}
#: of end stops: stiffness, and damping of a rate for a depth
STOP: dict[str, tuple[Dimension, Dimension]] = {
    "stiffness": JOINT["stiffness"],
    "damping": (_dimension("N m s/rad^2"), _dimension("N s/m^2")),
}
ENERGY = _dimension("J")
ROW = {"psi": ANGLE, "theta": ANGLE, "phi": ANGLE, "d": LENGTH, "sigma": LENGTH, "tau": LENGTH}
SPRING = {"stiffness": _dimension("N/m"), "damping": _dimension("N s/m"), "length": LENGTH}
#: dimensions of the numbers of a load by its type; those of a joint load and of friction depend on the coordinate
LOADS: dict[str, dict[str, Dimension]] = {
    "spring": SPRING,
    "bushing": {
        "stiffness": SPRING["stiffness"],
        "damping": SPRING["damping"],
        "angular_stiffness": _dimension("N m/rad"),
        "angular_damping": _dimension("N m s/rad"),
    },
    "force": {"at": LENGTH, "vector": FORCE},
    "torque": {"vector": TORQUE},
    "joint": {},
    "friction": {},
    "potential": {"potential": ENERGY},
}


def check_units(definition: Definition, topology: Topology) -> UnitCheck:
    """The units of a definition against their places."""
    names = {name: dimension_of(each.unit) for name, each in (definition.parameters | definition.inputs).items()}
    places = _Places(definition, topology)
    moving: dict[str, Inferred] = {"t": Dimensioned(_dimension("s"), sure=False)}
    for joint in topology.joints:
        moving[joint.coordinate] = Dimensioned(COORDINATE[joint.s], sure=False)
        moving[f"{joint.coordinate}'"] = Dimensioned(RATE[joint.s], sure=False)
    check = UnitCheck(lambda name: names.get(name, "unknown"))
    check.check(parameter_places(definition.parameters), True)
    check.check(input_places(definition.inputs), True)
    check.check(places.bodies(), True)
    check.warnings += angle_warnings(places.bodies(), definition.parameters)
    check.names = lambda name: names[name] if name in names else moving.get(name) or dimension_of_measure(name)
    check.check(places.loads(), False)
    return check


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
        """Joints, masses, inertias and ports."""
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
        for i, port in enumerate(self.definition.ports):
            yield from vector(f"/ports/{i}/position", port.position, LENGTH)
            yield from vector(f"/ports/{i}/rotation/rpy", port.rotation.rpy, ANGLE)

    def loads(self) -> Iterator[Place]:
        """Forces, torques, springs, bushings, joint loads, friction and potentials."""
        kinds = {entry.coordinate: entry.s for entry in self.topology.joints}
        for i, load in enumerate(self.definition.loads):
            yield from _load(f"/loads/{i}", load, kinds)


def vector(pointer: str, values: Sequence[Any], dimension: Dimension | None) -> Iterator[Place]:
    """The elements of a vector."""
    for i, value in enumerate(values):
        yield f"{pointer}/{i}", value, dimension


def placement_places(pointer: str, placement: Placement) -> Iterator[Place]:
    """A constant offset."""
    yield from vector(f"{pointer}/position", placement.position, LENGTH)
    yield from vector(f"{pointer}/rpy", placement.rpy, ANGLE)


def _joint(pointer: str, joint: Joint, kinds: Sequence[int]) -> Iterator[Place]:
    """A joint with one coordinate or more; ``kinds``: 1 of prismatic ones."""
    for name, dimension in ROW.items():
        yield f"{pointer}/{name}", getattr(joint, name), dimension
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
            yield from _fields(place, law, fields, s)
            if getattr(law, "load", None) is not None:
                yield from _fields(f"{place}/load", law.load, FRICTION_LOAD, s)


def _fields(pointer: str, law: Any, fields: Mapping[str, tuple[Dimension, Dimension]], s: int) -> Iterator[Place]:
    for name, dimensions in fields.items():
        if getattr(law, name) is not None:
            yield f"{pointer}/{name}", getattr(law, name), dimensions[s]


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


def _load(pointer: str, load: Load, kinds: Mapping[str, int]) -> Iterator[Place]:
    if isinstance(load, SpringLoad):
        for key, end in (("from", load.from_), ("to", load.to)):
            yield from vector(f"{pointer}/{key}/at", end.at, LENGTH)
    elif isinstance(load, JointLoad) and load.coordinate in kinds:
        yield f"{pointer}/force", load.force, EFFORT[kinds[load.coordinate]]
    elif isinstance(load, FrictionLoad) and load.coordinate in kinds:
        yield from friction_places(pointer, load, kinds[load.coordinate])
    yield from fields_of(pointer, load, LOADS[load.type])


def fields_of(pointer: str, load: DocumentPart, fields: Mapping[str, Dimension]) -> Iterator[Place]:
    """The numbers and vectors of a load that have one dimension each."""
    for name, dimension in fields.items():
        value = getattr(load, name, None)
        if isinstance(value, tuple):
            yield from vector(f"{pointer}/{name}", value, dimension)
        elif value is not None:
            yield f"{pointer}/{name}", value, dimension


def friction_places(pointer: str, load: FrictionLaw, kind: int) -> Iterator[Place]:
    """The numbers of friction on a revolute (0) or prismatic (1) coordinate."""
    for name, dimensions in FRICTION.items():
        if getattr(load, name) is not None:
            yield f"{pointer}/{name}", getattr(load, name), dimensions[kind]


def dimension_of_measure(name: str) -> Inferred:
    """Of a measure of two frames, or of its rate."""
    found = measured(name)
    if found is None:
        return "unknown"
    dimensions = RATE if found[0].endswith("'") else COORDINATE
    return Dimensioned(dimensions[found[0].startswith("distance")], sure=False)
