"""What all file formats are read into: links on parents, the motions between them, and frames.

A link hangs on its parent (None: the world) at a constant placement, and moves from there by its motions in order,

    T_link = T_parent  T(position, rpy)  T(anchor_1) J_1(q_1) T(-anchor_1)  T(anchor_2) J_2(q_2) T(-anchor_2) ...

with anchors and axes in the axes of the link. A link without motions is fixed.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from typing import Literal

from substructures.errors import among
from substructures.interchange.numbers import ORIGIN, ZERO, Number, Triple, decimal_of, is_zero, value
from substructures.interchange.report import LONGEST, Place, Report, refuse

MotionType = Literal["revolute", "prismatic", "spherical", "free"]


@dataclass(frozen=True)
class Motion:
    """One joint. ``offset``: q at which nothing is moved (MJCF ``ref``); rest, limits: values of q."""

    name: str
    type: MotionType
    place: Place
    axis: Triple = (ZERO, ZERO, ZERO)
    anchor: Triple = ORIGIN
    offset: Number = ZERO
    stiffness: Number = ZERO
    rest: Number = ZERO
    damping: Number = ZERO
    armature: Number = ZERO
    limits: tuple[Number, Number] | None = None

    def turning_damping(self, coordinates: list[str]) -> list[dict[str, object]]:
        """The moment -c omega of a joint that turns by yaw, pitch, roll, as loads on its coordinates.

        omega^2 = yaw'^2 + pitch'^2 + roll'^2 - 2 yaw' roll' sin(pitch), and Q_a = -c/2 d(omega^2)/dq'^a.
        """
        if is_zero(self.damping):
            return []
        yaw, pitch, roll = coordinates
        forces = {
            yaw: f"-({self.damping})*({yaw}' - {roll}'*sin({pitch}))",
            pitch: f"-({self.damping})*{pitch}'",
            roll: f"-({self.damping})*({roll}' - {yaw}'*sin({pitch}))",
        }
        return _on(forces)

    def turning_spring(self, coordinates: list[str]) -> list[dict[str, object]]:
        """The moment -k theta n of a joint that turns by yaw, pitch, roll, theta n its rotation vector, |theta| <= pi.

        theta n = 2 f v of the quaternion (w, v), f = atan(s/w)/s with s = |v|, which is 0/0 at rest, with the limit 1.
        For small s it is 1 + s^2/6, so that s = sqrt(v^2 + 1e-18) in place of |v| changes it by less than 1e-18: there
        is a number everywhere, and a derivative, but at half a turn, where the moment changes its sign.
        Q_a = -k theta n . omega_a, omega_a = e_z, (-sin(yaw), cos(yaw), 0) and, as R n = n, e_x in the body.
        """
        if is_zero(self.stiffness):
            return []
        (cy, sy), (cp, sp), (cr, sr) = ((f"cos({q}/2)", f"sin({q}/2)") for q in coordinates)
        w = f"({cr}*{cp}*{cy} + {sr}*{sp}*{sy})"
        x = f"({sr}*{cp}*{cy} - {cr}*{sp}*{sy})"
        y = f"({cr}*{sp}*{cy} + {sr}*{cp}*{sy})"
        z = f"({cr}*{cp}*{sy} - {sr}*{sp}*{cy})"
        s = f"sqrt({x}^2 + {y}^2 + {z}^2 + 1e-18)"
        moment = f"-2*({self.stiffness})*atan({s}/{w})/{s}"
        yaw, pitch, roll = coordinates
        ways = {yaw: z, pitch: f"(cos({yaw})*{y} - sin({yaw})*{x})", roll: x}
        return _on({q: f"{moment}*{way}" for q, way in ways.items()})


@dataclass(frozen=True)
class Inertial:
    """Mass [kg], mass centre in the link's frame [m], tensor about it in the link's axes (xx, yy, zz, xy, xz, yz)."""

    mass: Number = ZERO
    com: Triple = ORIGIN
    inertia: tuple[Number, ...] = (ZERO,) * 6

    @property
    def is_nothing(self) -> bool:
        """Whether there is neither mass nor moment of inertia."""
        return all(map(is_zero, (self.mass, *self.inertia)))


@dataclass(frozen=True)
class Link:
    """A body with its placement on its parent and the motions in between.

    ``joint``: the one of the file that carries it, where its motions are parts of this; ``has_shape``: whether it is
    seen; ``unweighed``: where something is whose mass is not known.
    """

    name: str
    parent: str | None
    place: Place
    position: Triple = ORIGIN
    rpy: Triple = ORIGIN
    motions: tuple[Motion, ...] = ()
    inertial: Inertial = field(default_factory=Inertial)
    joint: str = ""
    has_shape: bool = False
    unweighed: Place | None = None


@dataclass(frozen=True)
class NamedFrame:
    """A frame fixed in a link."""

    name: str
    link: str
    position: Triple = ORIGIN
    rpy: Triple = ORIGIN


@dataclass(frozen=True)
class Mimic:
    """q = multiplier * (q of the joint ``of``) + offset."""

    joint: str
    of: str
    multiplier: Number
    offset: Number
    place: Place

    @property
    def message(self) -> str:
        """What is said of it."""
        return (
            f"'{self.joint}' = {self.multiplier} * '{self.of}' + {self.offset}: both coordinates are free here; add "
            "the velocity constraint that is told in 'bindings' to simulations and velocity-equations"
        )

    @property
    def left_out(self) -> dict[str, object]:
        """As a field of a definition."""
        return {"message": f"{self.place}: {self.message}"[:LONGEST]}

    def plain(self, coordinate: str, of: str) -> dict[str, object]:
        """As JSON data, with the names that both coordinates have here, and as a constraint q' - k q_of' = 0."""
        expression = f"{coordinate}' - ({self.multiplier})*{of}'"
        constraint = {"type": "linear", "name": coordinate.replace(".", "_"), "expression": expression}
        told = {"coordinate": coordinate, "of": of, "multiplier": self.multiplier, "offset": self.offset}
        return {**told, "constraint": constraint}


def _on(forces: Mapping[str, str]) -> list[dict[str, object]]:
    """Forces on coordinates as loads."""
    return [{"type": "joint", "coordinate": q, "force": force} for q, force in forces.items()]


@dataclass(frozen=True)
class Loop:
    """A cut joint: ``kind`` of a closure of frames fixed in links (None: the world), whose third axes are its own."""

    name: str
    kind: Literal["ball", "weld", "pin", "slider", "universal"]
    link: str
    other: str | None
    position: Triple
    rpy: Triple
    other_position: Triple
    other_rpy: Triple


@dataclass(frozen=True)
class Tendon:
    """A spring and damper on a length: L = sum k_i q_i of ``joints``, or the one along ``points`` of links.

    Its tension is k p + c L' with p = L - high beyond ``rest`` = (low, high), L - low below, and 0 within.
    """

    name: str
    place: Place
    stiffness: Number
    damping: Number
    rest: tuple[Number, Number]
    joints: tuple[tuple[str, Number], ...] = ()
    points: tuple[tuple[str | None, Triple], ...] = ()  #: by links, None: the world

    def loads(self, names: Mapping[str, str], point: Callable[[str | None, Triple], object]) -> list[dict[str, object]]:
        """As loads; ``names``: of coordinates, by joints; ``point``: a point of a link, as cables have them."""
        if self.joints:
            return [*self._potential(names), *self._dampers(names)]
        return self._cables([point(*each) for each in self.points])

    def _potential(self, names: Mapping[str, str]) -> list[dict[str, object]]:
        """V = k/2 p^2, as k/4 x (x + |x|) of x = L - high and x = low - L where it is slack in between."""
        if is_zero(self.stiffness):
            return []
        length = " + ".join(f"({k})*{names[joint]}" for joint, k in self.joints)
        low, high = self.rest
        if low == high:
            return [{"type": "potential", "potential": f"({self.stiffness})/2*({length} - ({low}))^2"}]
        sides = (f"({length} - ({high}))", f"(({low}) - ({length}))")
        squares = " + ".join(f"{x}*({x} + abs({x}))" for x in sides)
        return [{"type": "potential", "potential": f"({self.stiffness})/4*({squares})"}]

    def _dampers(self, names: Mapping[str, str]) -> list[dict[str, object]]:
        """Q_a = -c L' dL/dq^a."""
        if is_zero(self.damping):
            return []
        rate = " + ".join(f"({k})*{names[joint]}'" for joint, k in self.joints)
        return [
            {"type": "joint", "coordinate": names[joint], "force": f"-({self.damping})*({k})*({rate})"}
            for joint, k in self.joints
        ]

    def _cables(self, along: list[object]) -> list[dict[str, object]]:
        """One; where it is slack between two lengths k (L - low) - k max(0, L - low) + k max(0, L - high)."""
        low, high = self.rest
        cable: dict[str, object] = {"type": "cable", "along": along}
        whole = cable | {"stiffness": self.stiffness, "damping": self.damping, "length": low}
        if low == high or is_zero(self.stiffness):
            return [whole]
        beyond = cable | {"stiffness": self.stiffness, "length": high, "slack": True}
        if value(low) > 0:
            back = decimal_of(-value(self.stiffness))
            return [whole, cable | {"stiffness": back, "length": low, "slack": True}, beyond]
        return [beyond] if is_zero(self.damping) else [cable | {"damping": self.damping}, beyond]


@dataclass(frozen=True)
class Robot:
    """A file, read: links with parents before children. ``gravity``: where the file, or its format, gives it;
    ``gravity_place``: where the file does.
    """

    name: str
    links: tuple[Link, ...]
    report: Report
    frames: tuple[NamedFrame, ...] = ()
    mimics: tuple[Mimic, ...] = ()
    loops: tuple[Loop, ...] = ()
    tendons: tuple[Tendon, ...] = ()
    gravity: Triple | None = None
    gravity_place: Place | None = None


def tell_of_missing_masses(robot: Robot, floats: bool = False) -> None:
    """A warning for every link that moves without any mass, alone or with what is fixed to it, and is seen or carries
    nothing: its mass is not in the file. ``floats``: whether roots move.
    """
    group: dict[str, str] = {}  # of every link the one that moves it
    for link in robot.links:
        group[link.name] = link.name if link.motions or link.parent is None else group[link.parent]
    weighed = {group[link.name] for link in robot.links if not link.inertial.is_nothing}
    carrying = {group[link.parent] for link in robot.links if link.motions and link.parent is not None}
    shown = {group[link.name] for link in robot.links if link.has_shape}
    for link in robot.links:
        moves = link.motions or (floats and link.parent is None)
        if moves and link.name not in weighed and (link.name in shown or link.name not in carrying):
            message = "the link moves and no mass is given for it: it is taken as massless"
            robot.report.lost(link.place, message, "physics")


def in_order(links: list[Link]) -> tuple[Link, ...]:
    """The order given, with parents before children. Raises InvalidDocument: unknown parents, duplicates, cycles."""
    by_name: dict[str, Link] = {}
    joints: set[str] = set()
    for link in links:
        for motion in link.motions:
            if motion.name in joints:
                message = f"a second joint '{motion.name}': give it another name"
                raise refuse(motion.place, "duplicate-name", message)
            joints.add(motion.name)
        if link.name in by_name:
            raise refuse(link.place, "duplicate-name", f"a second link '{link.name}': give it another name")
        by_name[link.name] = link
    order: dict[str, Link] = {}
    for link in links:
        for each in reversed(_ancestors(link, by_name, order)):
            order[each.name] = each
    return tuple(order.values())


def _ancestors(link: Link, by_name: Mapping[str, Link], known: Mapping[str, Link]) -> list[Link]:
    """The link and those before it that are not known yet, from the leaf to the root."""
    found: dict[str, Link] = {}
    here: Link | None = link
    while here is not None and here.name not in known:
        if here.name in found:
            raise refuse(link.place, "cycle", f"the link '{link.name}' is on or behind a cycle of joints")
        found[here.name] = here
        if here.parent is not None and here.parent not in by_name:
            message = f"the parent '{here.parent}' is not in the file{among(here.parent, by_name)}"
            raise refuse(here.place, "unknown-link", message)
        here = None if here.parent is None else by_name[here.parent]
    return list(found.values())
