"""Units in definitions: every number has the dimension of its place, as far as the expressions tell.

Numbers are converted to SI where they are read (:meth:`substructures.part.scope.Scope.read`); here it is checked that
they may stand where they stand, and noted what was converted.
"""

from __future__ import annotations

from collections.abc import Callable, Collection, Iterator, Mapping, Sequence
from contextlib import suppress
from dataclasses import dataclass, field
from functools import lru_cache
from typing import Any

from substructures.documents.fields import Quantity, in_si
from substructures.documents.units import NUMBER, Dimension, UnknownUnitError, read_unit, si_text
from substructures.errors import Fault, InvalidDocument
from substructures.expr.dimensions import Dimensioned, DimensionError, Inference, Inferred
from substructures.expr.syntax import ExpressionError, Step, read
from substructures.part.definition import (
    Definition,
    ForceLoad,
    InertiaTensor,
    Joint,
    JointLoad,
    Load,
    Parameter,
    Placement,
    PotentialLoad,
    SpringLoad,
    TorqueLoad,
)
from substructures.part.topology import Topology

#: pointer, code, message
Notice = dict[str, str]
#: (pointer, number of a document, dimension of the place; None where there is none)
Place = tuple[str, Any, Dimension | None]


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
#: of end stops: stiffness, and damping of a rate for a depth
STOP: dict[str, tuple[Dimension, Dimension]] = {
    "stiffness": JOINT["stiffness"],
    "damping": (_dimension("N m s/rad^2"), _dimension("N s/m^2")),
}
ENERGY = _dimension("J")
ROW = {"psi": ANGLE, "theta": ANGLE, "phi": ANGLE, "d": LENGTH, "sigma": LENGTH, "tau": LENGTH}
SPRING = {"stiffness": _dimension("N/m"), "damping": _dimension("N s/m"), "length": LENGTH}


@dataclass
class UnitCheck:
    """Checks numbers of a document against their places; collects what is wrong, doubtful, or was converted.

    ``names``: dimensions of the names that expressions may use.
    """

    names: Callable[[str], Inferred]
    faults: list[Fault] = field(default_factory=list)
    warnings: list[Notice] = field(default_factory=list)
    converted: list[dict[str, Any]] = field(default_factory=list)

    def require(self) -> None:
        """Raises InvalidDocument for contradictions."""
        if self.faults:
            raise InvalidDocument(self.faults)

    def check(self, places: Iterator[Place], tells_doubts: bool) -> None:
        """Look at all numbers; ``tells_doubts``: also say where numbers in expressions would need a unit."""
        for pointer, value, expected in places:
            if isinstance(value, Quantity):
                self._quantity(pointer, value, expected)
            elif isinstance(value, str):
                self._expression(pointer, value, expected, tells_doubts)

    def _quantity(self, pointer: str, value: Quantity, expected: Dimension | None) -> None:
        unit = value.measure
        if isinstance(value.value, str) and any(step.op == "name" for step in _steps(value.value)):
            message = f"'{value.value[:80]}': what has a unit is constant: names in it have units of their own"
            self.faults.append(Fault(pointer, "unit-of-expression", message))
        elif expected is not None and unit.dimension != expected:
            message = f"{si_text(expected)} expected, found {value}"
            self.faults.append(Fault(pointer, "unit-mismatch", message))
        elif not unit.is_si:
            self.converted.append({"pointer": pointer, **value.model_dump(), "si": value.si, "si_unit": unit.si})

    def _expression(self, pointer: str, text: str, expected: Dimension | None, tells_doubts: bool) -> None:
        inference = Inference(self.names)
        try:
            found = inference.of(_steps(text))
            if expected is not None:
                inference.require(found, expected)
        except DimensionError as error:
            self.faults.append(Fault(pointer, "unit-mismatch", f"'{text[:80]}': {error}"))
            return
        for doubt in inference.doubts if tells_doubts else ():
            message = f"'{text[:80]}': {doubt}, unless numbers in it have units"
            self.warnings.append({"pointer": pointer, "code": "unit-doubtful", "message": message})


@lru_cache(maxsize=10_000)
def _steps(text: str) -> tuple[Step, ...]:
    """The steps of an expression; of one that cannot be read a number, since the fault is told elsewhere."""
    try:
        return read(text)
    except ExpressionError:
        return read("0")


def dimension_of(unit: str) -> Inferred:
    """What is known of a quantity by its unit: nothing where it has none, or one of old that is not known."""
    try:
        return Dimensioned(read_unit(unit).dimension) if unit else "unknown"
    except UnknownUnitError:
        return "unknown"


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
    check.check(places.bodies(), True)
    check.names = lambda name: names[name] if name in names else moving.get(name, "unknown")
    check.check(places.loads(), False)
    return check


def parameter_places(parameters: Mapping[str, Parameter]) -> Iterator[Place]:
    """The values of parameters, which have the dimensions of their units."""
    for name, each in parameters.items():
        found = dimension_of(each.unit)
        yield f"/parameters/{name}/value", each.value, found.dimension if isinstance(found, Dimensioned) else None


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
        """Forces, torques, springs, joint loads and potentials."""
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
    for step, s in enumerate(kinds):
        stops, place = joint.limits_act, f"{pointer}/limits_act"
        if isinstance(stops, tuple):
            stops, place = (stops[step], f"{place}/{step}") if step < len(stops) else (None, place)
        if stops is not None:
            for name, dimensions in STOP.items():
                yield f"{place}/{name}", getattr(stops, name), dimensions[s]


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
    if isinstance(load, ForceLoad):
        yield from vector(f"{pointer}/at", load.at, LENGTH)
        yield from vector(f"{pointer}/vector", load.vector, FORCE)
    elif isinstance(load, TorqueLoad):
        yield from vector(f"{pointer}/vector", load.vector, TORQUE)
    elif isinstance(load, SpringLoad):
        for key, end in (("from", load.from_), ("to", load.to)):
            yield from vector(f"{pointer}/{key}/at", end.at, LENGTH)
        for name, dimension in SPRING.items():
            yield f"{pointer}/{name}", getattr(load, name), dimension
    elif isinstance(load, PotentialLoad):
        yield f"{pointer}/potential", load.potential, ENERGY
    elif isinstance(load, JointLoad) and load.coordinate in kinds:
        yield f"{pointer}/force", load.force, EFFORT[kinds[load.coordinate]]


def si_unit(unit: str) -> str:
    """The SI unit of what was given in a unit; a text of old that is no unit stays as it is."""
    try:
        return read_unit(unit).si if unit else unit
    except UnknownUnitError:
        return unit


def described(parameters: Mapping[str, Parameter]) -> dict[str, dict[str, Any]]:
    """Value and unit of parameters in SI, description; ``given`` is what was given in another unit."""
    return {name: _described(each) for name, each in parameters.items()}


def _described(parameter: Parameter) -> dict[str, Any]:
    value, unit = parameter.value, parameter.unit
    plain = {"value": in_si(value), "unit": unit, "description": parameter.description}
    if isinstance(value, Quantity):
        return plain if value.measure.is_si else plain | {"given": value.model_dump()}
    written = si_unit(unit) if value is None else unit
    return plain if written == unit else plain | {"unit": written, "given": {"unit": unit}}


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
    """The parameters that limits of joints depend on."""
    limits = [x for body in definition.bodies for x in _flat(body.joint.limits) if isinstance(x, str)]
    return {str(step.value) for text in limits for step in _steps(text) if step.op == "name"}


def _flat(given: Any) -> Iterator[Any]:
    for x in given or ():
        yield from _flat(x) if isinstance(x, tuple) else (in_si(x),)
