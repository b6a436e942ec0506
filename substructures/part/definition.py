"""The JSON form of a substructure definition (the HTTP contract, section 1), checked for structure only.

Meaning is checked when formulas are derived: names and expressions by :mod:`substructures.part.topology`,
:mod:`substructures.part.forces.applied_forces`, physics by :mod:`substructures.part.physics`.
"""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any, Literal, Self

from pydantic import ConfigDict, Field, ValidationInfo, field_validator, model_validator
from pydantic_core import PydanticCustomError

from substructures.documents import Document, DocumentPart
from substructures.documents.fields import LibraryName, Name, Number, NumberVector, Quantity, TagName, Words, unit_of
from substructures.documents.tables import with_points
from substructures.documents.units import UnknownUnitError, read_unit, si_unit
from substructures.errors import InvalidDocument
from substructures.loads.friction import FrictionLaw
from substructures.loads.kinds import LoadOfPart
from substructures.part.balls import JointType

MAX_BODIES = 500


class Measured(DocumentPart):
    """Something with a unit. In what was stored before units counted, a unit is any text, and numbers are SI."""

    unit: str = Field("", max_length=64, description="unit; of numbers without one it is the SI unit of this dimension")

    @field_validator("unit")
    @classmethod
    def _known(cls, unit: str, info: ValidationInfo) -> str:
        if unit and not is_stored(info):
            unit_of(unit)
        return unit


class Parameter(Measured):
    """A named constant; without a value it has to be given with every evaluation.

    ``{"value": 1200, "unit": "mm"}`` is kept as ``{"value": {"value": 1200, "unit": "mm"}, "unit": "m"}``: what was
    given, and the unit of the symbol that stands for it in formulas, which is always SI.
    """

    value: Number | None = Field(None, description="default; a number or a constant expression")
    description: Words = Field("", max_length=2000)

    @model_validator(mode="before")
    @classmethod
    def _with_given_unit(cls, data: Any, info: ValidationInfo) -> Any:
        return data if is_stored(info) else _in_its_unit(data, "value")

    @property
    def si_unit(self) -> str:
        """The unit of its symbol."""
        return si_unit(self.unit) if self.value is None else self.unit


def _in_its_unit(data: Any, field: str) -> Any:
    """What is declared, with the unit of its number in ``field`` put to it where that is not SI."""
    if not isinstance(data, Mapping) or data.get(field) is None:
        return data
    value, text = data[field], data.get("unit", "")
    try:
        unit = read_unit(text) if text else None
        if isinstance(value, Mapping | Quantity):
            given = value["unit"] if isinstance(value, Mapping) else value.unit
            unit = unit or read_unit(given)
            return {**data, "unit": text if text and unit.is_si else unit.si}
    except (UnknownUnitError, LookupError, TypeError, AttributeError):
        return data  # the fields say what is wrong with them
    if unit is None or unit.is_si:
        return data
    return {**data, field: {"value": value, "unit": text}, "unit": unit.si}


def is_stored(info: ValidationInfo) -> bool:
    """Whether what is read comes out of the store, where it was checked when it went in."""
    return bool(info.context and info.context.get("stored"))


class Placement(DocumentPart):
    """A constant offset: position of the origin, then fixed-axis roll, pitch, yaw (URDF)."""

    position: NumberVector = Field((0, 0, 0), description="m")
    rpy: NumberVector = Field((0, 0, 0), description="rad")


class PortRotation(DocumentPart):
    """Rotation of a port by fixed-axis roll, pitch, yaw."""

    rpy: NumberVector = Field((0, 0, 0), description="rad")


class LimitStop(DocumentPart):
    """End stops at the limits of a joint: a spring and damper that acts beyond them only, p beyond: (k + c p') p."""

    stiffness: Number = Field(description="N m/rad or N/m")
    damping: Number = Field(0, description="N m s/rad^2 or N s/m^2; of a rate of 1, for 1 rad or 1 m beyond the limit")


class BearingFriction(DocumentPart):
    """What the force R that a joint transmits adds to F_c: of a revolute joint mu (r |R beside the axis| +
    r_a |R along it|), of a prismatic one mu |R beside its axis|. In simulations with ``friction: loaded`` alone.
    """

    coefficient: Number = Field(description="mu")
    radius: Number | None = Field(None, description="r of a revolute joint's journal; m")
    axial_radius: Number | None = Field(None, description="r_a of its thrust bearing; m")


class JointFriction(FrictionLaw):
    """Dry friction as a field of a joint."""

    load: BearingFriction | None = Field(None, description="what the reactions of the joint add")


class Joint(DocumentPart):
    """Joint row psi, theta, d, sigma, phi, tau (Maisser 1988; modified Denavit-Hartenberg), or a placement."""

    type: JointType
    coordinate: Name | tuple[Name, ...] | None = Field(None, description="coordinate name(s); rad or m")
    velocities: tuple[Name, ...] | None = Field(None, description="rates of `ball`, `floating`; rad/s or m/s")
    psi: Number = Field(0, description="rad")
    theta: Number = Field(0, description="rad")
    d: Number = Field(0, description="m")
    sigma: Number = Field(0, description="m")
    phi: Number = Field(0, description="rad; offset (revolute) or constant (prismatic)")
    tau: Number = Field(0, description="m; constant (revolute) or offset (prismatic)")
    placement: Placement | None = None
    axis: tuple[Number, Number, Number] | None = Field(None, description="joint axis in the placed frame (constant)")
    stiffness: Number | tuple[Number, ...] = Field(0, description="N m/rad or N/m")
    rest: Number | tuple[Number, ...] = Field(0, description="rad or m; where the joint spring is at rest")
    damping: Number | tuple[Number, ...] = Field(0, description="N m s/rad or N s/m")
    armature: Number | tuple[Number, ...] = Field(0, description="kg m^2 or kg; rotor inertia seen at the joint")
    limits: tuple[Number, Number] | tuple[tuple[Number, Number], ...] | None = Field(None, description="rad or m")
    limits_act: LimitStop | tuple[LimitStop, ...] | None = Field(None, description="end stops at the limits")
    friction: JointFriction | tuple[JointFriction | None, ...] | None = Field(None, description="dry friction")


class InertiaTensor(DocumentPart):
    """Entries of the inertia tensor; xy = -integral of x y dm."""

    xx: Number = Field(0, description="kg m^2")
    yy: Number = Field(0, description="kg m^2")
    zz: Number = Field(0, description="kg m^2")
    xy: Number = Field(0, description="kg m^2")
    xz: Number = Field(0, description="kg m^2")
    yz: Number = Field(0, description="kg m^2")
    about: Literal["com", "origin"] = "com"


class Body(DocumentPart):
    """A rigid body and the joint that carries it; mass centre and inertia in the body frame."""

    name: Name
    parent: Name
    joint: Joint
    mass: Number = Field(0, description="kg")
    com: NumberVector = Field((0, 0, 0), description="m")
    inertia: InertiaTensor = InertiaTensor()


class Port(DocumentPart):
    """A frame fixed in a body, on which other substructures may be mounted."""

    name: Name
    body: Name
    position: NumberVector = Field((0, 0, 0), description="m")
    rotation: PortRotation = PortRotation()
    interface: Words = Field("", max_length=200, description="what fits on it, as `ISO 9409-1-50-4-M6`")


class Mount(DocumentPart):
    """The base of a substructure, as a host sees it."""

    interface: Words = Field("", max_length=200, description="what it fits on, as `ISO 9409-1-50-4-M6`")


class Input(Measured):
    """A named input of the loads. Where it is not given it has its default, 0 without one; a default is kept with its
    unit as the value of a parameter.
    """

    default: Number | None = Field(None, description="where it is not given; a number or a constant expression")
    description: Words = Field("", max_length=2000)

    @model_validator(mode="before")
    @classmethod
    def _with_given_unit(cls, data: Any, info: ValidationInfo) -> Any:
        return data if is_stored(info) else _in_its_unit(data, "default")


class Relation(DocumentPart):
    """q = multiplier * (q of the coordinate ``of``) + offset: of a mimic joint, a gear, a rack or a screw."""

    coordinate: Name
    of: Name
    multiplier: Number = Field(1, description="constant; of a screw m/rad, of a pinion on a rack rad/m")
    offset: Number = Field(0, description="constant; rad or m")


class PartClosure(DocumentPart):
    """A loop of the mechanism: a joint that is cut. It equates two frames as far as the joint demands, whose third axis
    is its axis. Others are named twice, ``pin`` is ``revolute``; of a ``rod`` the origins keep the distance ``length``.
    """

    name: Name
    type: Literal[
        "pin", "revolute", "slider", "prismatic", "ball", "spherical", "weld", "fixed", "cylindrical", "universal",
        "planar", "rod",
    ]  # fmt: skip
    from_: Name = Field(alias="from", description="port or body")
    to: Name = Field("base", description="port, body or base")
    placement: Placement = Field(Placement(), description="where the joint is in the frame 'to'")
    axis: tuple[Number, Number, Number] | None = Field(
        None, description="joint axis in the frame 'from' and in the placed frame 'to' (constant; default: the third)"
    )
    length: Number | None = Field(None, description="m; of a rod")

    model_config = ConfigDict(frozen=True, extra="forbid", serialize_by_alias=True)

    @model_validator(mode="after")
    def _fitting(self) -> Self:
        if (self.type == "rod") != (self.length is not None):
            raise PydanticCustomError("rod-length", "a rod has a 'length', and only a rod")
        if self.axis is not None and self.type in ("ball", "spherical", "weld", "fixed", "rod"):
            raise PydanticCustomError("no-axis", "this type of closure has no 'axis'")
        return self


class LeftOut(DocumentPart):
    """Something that the source of a definition says and its equations do not have: part and trees are warned of it.

    ``relation``: between two coordinates that are both free here; states that do not fit it are told.
    """

    message: str = Field(max_length=2000)
    relation: Relation | None = None


class WithTables(Document):
    """A document with curves as CSV text, whose points it has from then on in the place of their names."""

    tables: dict[Name, str] = Field(
        {}, max_length=500, description="CSV of x and y by name, for table(q1; name); kept as their points in the laws"
    )

    @model_validator(mode="before")
    @classmethod
    def _with_points(cls, data: Any) -> Any:
        try:
            return with_points(data)
        except InvalidDocument as error:
            told = {"message": error.faults[0].message, "below": error.faults[0].pointer}
            raise PydanticCustomError(error.faults[0].code, "{message}", told) from None


class Definition(WithTables):
    """A substructure: bodies on a tree of joints that hangs on the interface frame ``base``, with ports and loads."""

    name: LibraryName
    title: Words = Field("", max_length=200)
    description: Words = Field("", max_length=20_000)
    tags: tuple[TagName, ...] = Field((), max_length=32)
    license: Words = Field("", max_length=200)
    source: Words = Field("", max_length=4000)
    parameters: dict[Name, Parameter] = Field({}, max_length=5000)
    inputs: dict[Name, Input] = Field({}, max_length=500)
    bodies: tuple[Body, ...] = Field((), max_length=MAX_BODIES)
    ports: tuple[Port, ...] = Field((), max_length=500)
    mount: Mount | None = Field(None, description="of its base")
    relations: tuple[Relation, ...] = Field((), max_length=1000, description="joints that move with another one")
    closures: tuple[PartClosure, ...] = Field((), max_length=500, description="loops, each between two of its frames")
    independent: tuple[Name, ...] = Field((), max_length=500, description="coordinates that move all others of it")
    start: dict[Name, Number] = Field({}, max_length=500, description="near a closed position (constant; rad or m)")
    ranges: dict[Name, tuple[Number, Number]] = Field({}, max_length=500, description="of independent ones (constant)")
    loads: tuple[LoadOfPart, ...] = Field((), max_length=1000)
    poses: dict[Name, dict[Name, Number]] = Field(
        {},
        max_length=50,
        description="coordinates by name of the pose (constant; rad or m; 0 where left out); pictures show `home`",
    )
    left_out: tuple[LeftOut, ...] = Field((), max_length=1000, description="what the source says beside the equations")

    def __repr__(self) -> str:
        """Two lines: its name and title, and the names in it."""
        bodies, ports = ", ".join(b.name for b in self.bodies), ", ".join(p.name for p in self.ports)
        return (
            f"Definition '{self.name}'{': ' if self.title else ''}{self.title}\n"
            f"bodies {bodies or 'none'}; ports {ports or 'none'}; parameters {', '.join(self.parameters) or 'none'}"
        )

    __str__ = __repr__
