"""What all file formats are read into: links on parents, the motions between them, and frames.

A link hangs on its parent (None: the world) at a constant placement, and moves from there by its motions in order,

    T_link = T_parent  T(position, rpy)  T(anchor_1) J_1(q_1) T(-anchor_1)  T(anchor_2) J_2(q_2) T(-anchor_2) ...

with anchors and axes in the axes of the link. A link without motions is fixed.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Literal

from substructures.errors import among
from substructures.interchange.numbers import ORIGIN, ZERO, Number, Triple, is_zero
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

    def left_out(self, names: Mapping[str, str]) -> dict[str, object]:
        """As a field of a definition with the coordinates ``names`` by joints; as words where it has not got both."""
        told: dict[str, object] = {"message": f"{self.place}: {self.message}"[:LONGEST]}
        if {self.joint, self.of} <= names.keys():
            factors = {"multiplier": self.multiplier, "offset": self.offset}
            told["relation"] = {"coordinate": names[self.joint], "of": names[self.of], **factors}
        return told

    def plain(self, coordinate: str, of: str) -> dict[str, object]:
        """As JSON data, with the names that both coordinates have here, and as a constraint q' - k q_of' = 0."""
        expression = f"{coordinate}' - ({self.multiplier})*{of}'"
        constraint = {"type": "linear", "name": coordinate.replace(".", "_"), "expression": expression}
        told = {"coordinate": coordinate, "of": of, "multiplier": self.multiplier, "offset": self.offset}
        return {**told, "constraint": constraint}


@dataclass(frozen=True)
class Loop:
    """A cut joint: ``kind`` of a closure between points fixed in links (None: the world), axes of the second one."""

    name: str
    kind: Literal["ball", "weld"]
    link: str
    other: str | None
    position: Triple
    rpy: Triple
    other_position: Triple
    other_rpy: Triple


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
    gravity: Triple | None = None
    gravity_place: Place | None = None


def tell_of_missing_masses(robot: Robot) -> None:
    """A warning for every link that moves without any mass, alone or with what is fixed to it, and is seen or carries
    nothing: its mass is not in the file.
    """
    group: dict[str, str] = {}  # of every link the one that moves it
    for link in robot.links:
        group[link.name] = link.name if link.motions or link.parent is None else group[link.parent]
    weighed = {group[link.name] for link in robot.links if not link.inertial.is_nothing}
    carrying = {group[link.parent] for link in robot.links if link.motions and link.parent is not None}
    shown = {group[link.name] for link in robot.links if link.has_shape}
    for link in robot.links:
        if link.motions and link.name not in weighed and (link.name in shown or link.name not in carrying):
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
