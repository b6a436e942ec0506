"""A robot that was read as the definition of a substructure: bodies, ports, parameters, and what was called how.

Bodies carry the names of links, coordinates those of joints. Links on fixed joints are merged into the link that
carries them (or kept as bodies), their frames stay as ports. Several joints of one link are a chain of massless bodies.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field, replace
from typing import Any

from substructures.interchange.bindings import relations_of
from substructures.interchange.files.wanted import Options
from substructures.interchange.merge import Seat, minus, plus, together
from substructures.interchange.names import Names, library_name, title_of
from substructures.interchange.numbers import ONE, ORIGIN, ZERO, Number, Triple, is_zero
from substructures.interchange.report import Place, refuse
from substructures.interchange.robot import Inertial, Link, Loop, Mimic, Motion, Robot
from substructures.interchange.turning import is_turning, turning_joint
from substructures.part.definition import MAX_BODIES
from substructures.part.topology import BASE

MAX_PORTS = 500
_MOMENTS = ("xx", "yy", "zz", "xy", "xz", "yz")
_UNITS = {"m": "kg", "c": "m", "I": "kg m^2", "p": "m", "r": "rad"}


@dataclass(frozen=True)
class PartOfFile:
    """A definition as plain data; ``names``: what links, joints and frames of the file are called here."""

    definition: dict[str, Any]
    names: dict[str, str]
    coordinates: dict[str, str]  #: of every motion
    loop_ports: list[tuple[str, str | None]]  #: of every loop the ports of its ends, None: the world
    unbound: tuple[Mimic, ...] = ()  #: bindings to joints of other parts
    seats: Mapping[str, tuple[str, Seat]] = field(default_factory=dict)  #: of every link its body, and where in it


def as_part(
    robot: Robot,
    options: Options = Options(),  # noqa: B008 -- frozen
    name: str | None = None,
) -> PartOfFile:
    """The definition of a robot. Raises InvalidDocument for more bodies than a definition may have."""
    return _Builder(robot, options).part(name)


@dataclass
class _Body:
    """A body that is being put together: what is fixed in it, each in its frame."""

    name: str
    parent: str
    joint: dict[str, Any]
    place: Place
    inertias: list[Inertial] = field(default_factory=list)


class _Builder:
    """Goes through the links, parents first."""

    def __init__(self, robot: Robot, options: Options) -> None:
        self.robot, self.options = robot, options
        self.links, self.joints = Names(), Names()
        self.bodies: dict[str, _Body] = {}
        self.ports: list[dict[str, Any]] = []
        self.loads: list[dict[str, Any]] = []
        self.parameters: dict[str, dict[str, Any]] = {}
        self.velocities: dict[str, str] = {}  #: the names of rates that are no derivatives, by joint
        #: of every link the body that it is fixed in, and where
        self.seats: dict[str, tuple[str, Seat]] = {}

    def part(self, name: str | None) -> PartOfFile:
        """Everything together."""
        for link in self._links():
            self._add(link)
        for frame in self.robot.frames:
            self._port(f"frame {frame.name}", frame.link, Seat(frame.position, frame.rpy))
        for tendon in self.robot.tendons:
            self.loads += tendon.loads(self.joints.given, lambda link, at: place_of(self.seats, link, at))
        loop_ports = [self._loop(loop) for loop in self.robot.loops]
        if len(self.ports) > MAX_PORTS:
            message = f"{len(self.ports)} fixed frames; a part has at most {MAX_PORTS} ports: the others are left out"
            self.robot.report.warning(self.robot.links[0].place, message, "topology")
        if len(self.bodies) > MAX_BODIES:
            first = list(self.bodies.values())[MAX_BODIES]
            message = f"{len(self.bodies)} bodies; a part has at most {MAX_BODIES}: cut it into several (cut=LINK)"
            raise refuse(first.place, "too-many-bodies", message)
        relations, left = relations_of(self.robot.mimics, self.joints.given, self.robot.report)
        self.symbols = Names(self.joints.given.values())
        self.symbols_taken()
        document: dict[str, Any] = {
            "name": library_name(name or self.robot.name),
            "title": title_of(self.robot.name),
            "bodies": [self._document(body) for body in self.bodies.values()],
            "ports": self.ports[:MAX_PORTS],
            "loads": self.loads,
            "parameters": self.parameters,
            "relations": relations,
            "left_out": [mimic.left_out for mimic in left],
        }
        return PartOfFile(
            {key: x for key, x in document.items() if x},
            {**self.links.given, **self._joint_names(), **self.velocities},
            self.joints.given,
            loop_ports,
            tuple(left),
            self.seats,
        )

    def _joint_names(self) -> dict[str, str]:
        """What the coordinates of every joint of the file that moves are called, in order."""
        found: dict[str, str] = {}
        for link in self._links():
            own = [self.joints.given[motion.name] for motion in link.motions]
            if link.joint and own:
                found[f"joint {link.joint}"] = ", ".join(own)
            else:
                found |= {f"joint {motion.name}": name for motion, name in zip(link.motions, own, strict=True)}
        return found

    def symbols_taken(self) -> None:
        """Names of coordinates may not be those of parameters."""
        for body in self.bodies.values():
            coordinates = body.joint.get("coordinate", [])
            own = [coordinates] if isinstance(coordinates, str) else coordinates
            for c in (*own, *body.joint.get("velocities", ())):
                self.symbols.of(c)

    def _links(self) -> Iterator[Link]:
        """With roots that move freely, if they are to."""
        for link in self.robot.links:
            if link.unweighed is not None and self.options.base == "floating":
                message = "the mass of a mesh needs its file: give the body an <inertial>, or the geom mass='0'"
                raise refuse(link.unweighed, "mesh-inertia", message)
            if link.parent is None and not link.motions and self.options.base == "floating":
                yield replace(link, motions=(Motion(f"{link.name}_free", "free", link.place),))
            else:
                yield link

    def _add(self, link: Link) -> None:
        carrier, seat = (BASE, Seat()) if link.parent is None else self.seats[link.parent]
        here = seat.beyond(Seat(link.position, link.rpy))
        if link.motions:
            self._moving(link, carrier, here)
        elif carrier == BASE or self.options.fixed == "bodies":
            self._body(link, self.links.of(link.name), carrier, {"type": "fixed", **_placement(here)})
            self.seats[link.name] = self.links.of(link.name), Seat()
            self.bodies[self.links.of(link.name)].inertias.append(link.inertial)
        else:
            self.seats[link.name] = carrier, here
            self.bodies[carrier].inertias.append(here.inertial(link.inertial))
            self.robot.report.merged(link.place, f"fixed to '{carrier}', and counted with it")
            if self.options.fixed == "ports":
                self._port(f"link {link.name}", link.name, Seat())

    def _moving(self, link: Link, carrier: str, here: Seat) -> None:
        """A chain of joints; the frame of a body is at the anchor of its joint, in the axes of the link."""
        before: Triple = ORIGIN
        for k, motion in enumerate(link.motions):
            last = k == len(link.motions) - 1
            anchored = Seat(plus(motion.anchor, minus(before)))
            name = self.links.of(link.name) if last else self.links.new(f"{link.name}_{k + 1}")
            self._body(link, name, carrier, self._joint(motion, here.beyond(anchored)))
            carrier, here, before = name, Seat(), motion.anchor
        own = Seat(minus(before))
        self.seats[link.name] = carrier, own
        self.bodies[carrier].inertias.append(own.inertial(link.inertial))
        if own.position != ORIGIN:
            self._port(f"frame {link.name}_frame", link.name, Seat())

    def _body(self, link: Link, name: str, parent: str, joint: dict[str, Any]) -> None:
        self.bodies[name] = _Body(name, parent, joint, link.place)

    def _joint(self, motion: Motion, seat: Seat) -> dict[str, Any]:
        """The joint of a body as a document."""
        if is_turning(motion):
            turning, loads = turning_joint(motion, self.options.rotations, self.joints.new)
            self.joints.given[motion.name] = ", ".join(turning["coordinate"])
            if "velocities" in turning:
                self.velocities[f"velocities {motion.name}"] = ", ".join(turning["velocities"])
            self.loads += loads
            return turning | _placement(seat)
        joint: dict[str, Any] = {"type": motion.type, **_placement(seat)}
        joint["coordinate"] = self.joints.of(motion.name)
        if motion.axis != (ZERO, ZERO, ONE):
            joint["axis"] = list(motion.axis)
            joint.setdefault("placement", {})
        laws = {"stiffness": motion.stiffness, "rest": motion.rest, "damping": motion.damping}
        laws |= {"armature": motion.armature}
        joint |= {key: x for key, x in laws.items() if not is_zero(x)}
        if not is_zero(motion.offset):
            joint["phi" if motion.type == "revolute" else "tau"] = minus((motion.offset, ZERO, ZERO))[0]
        if motion.limits is not None:
            joint["limits"] = list(motion.limits)
        return joint

    def _port(self, name: str, link: str, seat: Seat, first: bool = False) -> str:
        """A frame of a link as a port of its body; of what is fixed to the interface, too."""
        body, own = self.seats[link]
        here = own.beyond(seat)
        kind, _, plain = name.partition(" ")
        key = plain if kind == "link" else name
        self.links.given[key] = self.links.given.get(key) or self.links.new(plain)
        port: dict[str, Any] = {"name": self.links.given[key], "body": body}
        if not all(map(is_zero, here.position)):
            port["position"] = list(here.position)
        if here.is_turned:
            port["rotation"] = {"rpy": list(here.rpy)}
        self.ports.insert(0 if first else len(self.ports), port)
        return str(port["name"])

    def _loop(self, loop: Loop) -> tuple[str, str | None]:
        """Ports where a loop is cut; they come first, so that none is left out."""
        self.links.given[f"loop {loop.name}"] = self.links.new(loop.name)
        start = self._port(f"frame {loop.name}_from", loop.link, Seat(loop.position, loop.rpy), first=True)
        if loop.other is None:
            return start, None
        return start, self._port(
            f"frame {loop.name}_to", loop.other, Seat(loop.other_position, loop.other_rpy), first=True
        )

    def _document(self, body: _Body) -> dict[str, Any]:
        """A body with its numbers, or parameters in place of them."""
        own = together(body.inertias)
        plain: dict[str, Any] = {"name": body.name, "parent": body.parent, "joint": body.joint}
        inertial = self.options.parameters != "none"
        if self.options.parameters == "all" and "placement" in body.joint:
            self._geometry(body)
        if not is_zero(own.mass):
            plain["mass"] = self._named("m", body.name, "", own.mass, inertial)
        if not all(map(is_zero, own.com)):
            plain["com"] = [self._named("c", body.name, e, x, inertial) for e, x in zip("xyz", own.com, strict=True)]
        if not all(map(is_zero, own.inertia)):
            entries = zip(_MOMENTS, own.inertia, strict=True)
            plain["inertia"] = {e: self._named("I", body.name, e, x, inertial) for e, x in entries if not is_zero(x)}
        return plain

    def _geometry(self, body: _Body) -> None:
        placement = body.joint["placement"]
        for key, letter, parts in (("position", "p", "xyz"), ("rpy", "r", ("roll", "pitch", "yaw"))):
            if key in placement:
                pairs = zip(parts, placement[key], strict=True)
                placement[key] = [self._named(letter, body.name, part, x, True) for part, x in pairs]

    def _named(self, letter: str, body: str, part: str, x: Number, is_parameter: bool) -> Number:
        """The name of a parameter with this default; the number itself where it is zero, or a multiple of pi."""
        if not is_parameter or is_zero(x) or isinstance(x, str):
            return x
        name = self.symbols.new(f"{letter}{part}_{body}")
        self.parameters[name] = {"value": x, "unit": _UNITS[letter]}
        return name


def place_of(seats: Mapping[str, tuple[str, Seat]], link: str | None, at: Triple) -> dict[str, Any]:
    """A point of a link, None: of what carries all, as that of a body."""
    body, seat = (BASE, Seat()) if link is None else seats[link]
    return {"frame": body, "at": list(seat.point(at))}


def _placement(seat: Seat) -> dict[str, Any]:
    """As a field of a joint; nothing where nothing is displaced."""
    placement: dict[str, Any] = {}
    if not all(map(is_zero, seat.position)):
        placement["position"] = list(seat.position)
    if seat.is_turned:
        placement["rpy"] = list(seat.rpy)
    return {"placement": placement} if placement else {}
