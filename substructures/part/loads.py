"""Applied forces of a substructure: wrenches on bodies, what acts between frames, joint laws (the contract, section 1).

Springs, bushings and joint laws act between parts of the substructure, so that they do no work in a motion of the
interface: their generalised forces are complete without a host (:mod:`substructures.part.applied_forces`). Forces and
torques act on the host, too: kept as wrenches (:mod:`substructures.part.wrenches`), as are those between two frames in
the axes of the world.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, field
from typing import Any

from substructures.errors import among
from substructures.expr.graph import Expr
from substructures.expr.syntax import measured
from substructures.mechanics.linear3 import ZERO, Vector, apply, sub, transpose
from substructures.part.definition import (
    BushingLoad,
    ForceBetween,
    ForceLoad,
    JointLoad,
    PotentialLoad,
    SpringLoad,
    TorqueBetween,
    TorqueLoad,
)
from substructures.part.frames import Frame
from substructures.part.load_names import names_in, velocity_in
from substructures.part.mechanism import Mechanism
from substructures.part.own_names import OwnNames
from substructures.part.pair_laws import LEFT_OUT, BushingLaw, potential_forces
from substructures.part.pairs import Reach
from substructures.part.scope import ExprVector
from substructures.part.wrenches import AppliedWrench


@dataclass(frozen=True)
class Spring:
    """Spring and damper between two points fixed in carriers (body frames); ``measured``: its law names measures."""

    ends: tuple[tuple[int, Vector], tuple[int, Vector]]
    stiffness: Expr
    damping: Expr
    length: Expr
    pointer: str
    measured: bool = False


@dataclass(frozen=True)
class Between:
    """What acts between two own frames: a bushing, or on ``to`` at a point a force or a moment in axes of a frame.

    ``at``: the point [m] in the frame ``to``. ``steady``: whether stiffness and angular stiffness do not move.
    """

    start: Frame
    end: Frame
    law: BushingLaw | PairVector
    pointer: str
    at: Vector = ZERO
    steady: tuple[bool, bool] = (True, True)


@dataclass(frozen=True)
class PairVector:
    """A force or a moment in the axes of ``from`` or of ``to``."""

    moment: bool
    of_start: bool
    vector: Vector


@dataclass
class Loads:
    """All applied loads, read: wrenches in order, springs, what acts between frames, extra joint forces by coordinate
    index, potentials; ``measured``: forces and energies of potentials that depend on measures of frames.

    ``joint_terms``: the terms of the joint forces as they are written, but for those of measures.
    """

    wrenches: list[AppliedWrench] = field(default_factory=list)
    springs: list[Spring] = field(default_factory=list)
    between: list[Between] = field(default_factory=list)
    joint_forces: dict[int, Expr] = field(default_factory=dict)
    joint_terms: dict[int, list[Expr]] = field(default_factory=dict)
    potentials: list[Expr] = field(default_factory=list)
    measured: list[tuple[Reach, Expr]] = field(default_factory=list)


def read_loads(m: Mechanism) -> Loads:
    """Read the loads; expressions may name parameters, coordinates, velocities (q'), inputs, the time t and measures of
    frames.
    """
    names, found = OwnNames(m), Loads()
    for i, load in enumerate(m.definition.loads):
        reader = _READERS.get(type(load))
        if reader is not None:
            reader(names, load, f"/loads/{i}", found)
    m.scope.finish()
    return found


def _body(m: Mechanism, body: str, pointer: str) -> Frame | None:
    frame = m.bodies.get(body)
    if frame is None:
        m.scope.fault(pointer, "unknown-body", f"unknown body '{body}'{among(body, m.bodies, len(m.scope.faults))}")
    return frame


def _wrench(names: OwnNames, load: ForceLoad | TorqueLoad, pointer: str, found: Loads) -> None:
    m = names.m
    frame = _body(m, load.body, f"{pointer}/body")
    if frame is None:
        return
    vector: Vector = _vector(names, load.vector, f"{pointer}/vector")
    at = ZERO
    if isinstance(load, ForceLoad):
        at = frame.point(m.scope.vector(load.at, f"{pointer}/at"))
    world = load.frame == "world"
    if not world:
        # from the axes of the body to those of its carrier: E^T v
        vector = apply(transpose(frame.E), vector)
    found.wrenches.append(AppliedWrench(frame.carrier, isinstance(load, TorqueLoad), world, at, vector))


def _vector(names: OwnNames, values: Sequence[Any], pointer: str) -> ExprVector:
    x, y, z = (names.m.scope.read(x, f"{pointer}/{i}", names.at(f"{pointer}/{i}")) for i, x in enumerate(values))
    return x, y, z


def _ends(names: OwnNames, load: BushingLoad | ForceBetween | TorqueBetween, pointer: str) -> list[Frame]:
    """Both frames; fewer with faults."""
    ends = names.frame(load.from_, f"{pointer}/from"), names.frame(load.to, f"{pointer}/to")
    return [frame for frame in ends if frame is not None]


def _pair(names: OwnNames, load: ForceBetween | TorqueBetween, pointer: str, found: Loads) -> None:
    """A force or a moment between two frames; in the axes of the world as two wrenches."""
    ends = _ends(names, load, pointer)
    vector = _vector(names, load.vector, f"{pointer}/vector")
    moment = isinstance(load, TorqueBetween)
    at: Vector = ZERO if isinstance(load, TorqueBetween) else names.m.scope.vector(load.at, f"{pointer}/at")
    if len(ends) < 2:
        return
    start, end = ends
    if load.axes != "world":
        law = PairVector(moment, load.axes == "from", vector)
        found.between.append(Between(start, end, law, pointer, at))
        return
    at = ZERO if moment else end.point(at)
    found.wrenches.append(AppliedWrench(end.carrier, moment, True, at, vector))
    point_of = None if moment or start.carrier == end.carrier else end.carrier
    found.wrenches.append(AppliedWrench(start.carrier, moment, True, at, sub(ZERO, vector), point_of))


def _bushing(names: OwnNames, load: BushingLoad, pointer: str, found: Loads) -> None:
    ends = _ends(names, load, pointer)
    fields = ("stiffness", "damping", "angular_stiffness", "angular_damping")
    law = BushingLaw(*(_vector(names, getattr(load, name), f"{pointer}/{name}") for name in fields))
    steady = names.is_steady(*load.stiffness), names.is_steady(*load.angular_stiffness)
    if len(ends) == 2:
        found.between.append(Between(ends[0], ends[1], law, pointer, steady=steady))


def _spring(names: OwnNames, load: SpringLoad, pointer: str, found: Loads) -> None:
    m, ends = names.m, []
    for key, end in (("from", load.from_), ("to", load.to)):
        frame = _body(m, end.body, f"{pointer}/{key}/body")
        if frame is None:
            return
        ends.append((frame.carrier, frame.point(m.scope.vector(end.at, f"{pointer}/{key}/at"))))
    fields = ("stiffness", "damping", "length")
    law = [m.scope.read(getattr(load, name), f"{pointer}/{name}", names.at(f"{pointer}/{name}")) for name in fields]
    is_measured = names.measures_in(load.stiffness, load.length)
    found.springs.append(Spring((ends[0], ends[1]), law[0], law[1], law[2], pointer, is_measured))


def _potential(names: OwnNames, load: PotentialLoad, pointer: str, found: Loads) -> None:
    """V(q, s, u, t) as given; a velocity in it is a fault, since then -d_a V would not be the force."""
    m, place = names.m, f"{pointer}/potential"
    energy = m.scope.read(load.potential, place, names.measures.standing_in)
    used = names_in(load.potential)
    rates = {name for name in used if measured(name) and "'" in name} | {velocity_in(m.topology, [energy]) or ""}
    for rate in sorted(rates - {""}):
        message = f"a potential depends on coordinates, not on velocities: '{rate}' is one"
        m.scope.fault(place, "velocity-in-potential", message)
    if not names.measures_in(load.potential):
        found.potentials.append(energy)
        return
    measures = {name: names.measures.measure(name, place) for name in used if measured(name)}
    if m.scope.faults:
        return
    known = {name: each for name, each in measures.items() if each is not None}
    moving = sorted(name for name in used if name in known or name in m.topology.coordinates)
    coordinates = {name: a for a, name in enumerate(m.topology.coordinates)}
    try:
        found.measured.append(potential_forces(m.graph, energy, moving, coordinates, known))
    except ZeroDivisionError:
        m.scope.fault(place, "division-by-zero", "the derivative of this potential has no value anywhere")


def _joint_force(names: OwnNames, load: JointLoad, pointer: str, found: Loads) -> None:
    m, place = names.m, f"{pointer}/force"
    if load.coordinate not in m.topology.coordinates:
        like = among(load.coordinate, m.topology.coordinates, len(m.scope.faults))
        message = f"unknown coordinate '{load.coordinate}'{like}"
        m.scope.fault(f"{pointer}/coordinate", "unknown-coordinate", message)
        return
    a, lookup = m.topology.coordinates.index(load.coordinate), names.at(place)
    found.joint_forces[a] = found.joint_forces.get(a, m.graph.zero) + m.scope.read(load.force, place, lookup)
    if names.measures_in(load.force):
        message = f"this force measures frames, and no potential of it is looked for: {LEFT_OUT}"
        m.scope.notices.append({"pointer": place, "code": "no-potential", "message": message})
    else:
        found.joint_terms.setdefault(a, []).extend(m.scope.terms(load.force, place, lookup))


#: by type; friction is a law of the joint (:mod:`substructures.part.mechanism`)
_READERS: dict[type, Callable[[OwnNames, Any, str, Loads], None]] = {
    ForceLoad: _wrench,
    TorqueLoad: _wrench,
    ForceBetween: _pair,
    TorqueBetween: _pair,
    BushingLoad: _bushing,
    SpringLoad: _spring,
    PotentialLoad: _potential,
    JointLoad: _joint_force,
}
