"""An MJCF document as a robot: settings, bodies, loops, gravity, and what is left out."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace

from substructures.interchange.known.mjcf import MJCF
from substructures.interchange.mjcf.actuators import rotor_laws
from substructures.interchange.mjcf.bodies import Bodies
from substructures.interchange.mjcf.loops import bindings_of, equalities, loops_of
from substructures.interchange.mjcf.meshes import Meshes
from substructures.interchange.mjcf.replicate import written_out
from substructures.interchange.mjcf.settings import Compiler, Defaults
from substructures.interchange.mjcf.springs import with_springs
from substructures.interchange.mjcf.tendons import tendons_of
from substructures.interchange.numbers import ORIGIN, Triple, decimal_of, number_of, triple, value
from substructures.interchange.report import Place, Report, refuse
from substructures.interchange.robot import Inertial, Link, Robot, in_order
from substructures.interchange.xml import Node, read_xml

GRAVITY = "0 0 -9.81"
_READ = ("compiler", "option", "default", "worldbody", "equality", "include", "actuator", "tendon")
_IGNORED = {
    "size": "memory", "statistic": "statistics", "visual": "how it looks", "asset": "how it looks",
    "contact": "contacts", "sensor": "sensors", "keyframe": "states", "custom": "user data",
}  # fmt: skip
_MOST_INCLUDES = 100


def read_mjcf(root: Node, included: Mapping[str, bytes] | None = None) -> Robot:
    """The robot of an MJCF document. ``included``: contents of files by the names in <include>, and of meshes by their
    paths.

    Raises InvalidDocument with line and element.
    """
    if root.tag != "mujoco":
        raise refuse(root.place, "not-mjcf", "the root of an MJCF file is <mujoco>")
    files = {} if included is None else included
    root = _with_included(root, files, [])
    report = Report()
    MJCF.tell(root, report)
    defaults = Defaults(root)
    compiler = Compiler.of(root)
    bodies = Bodies(compiler, defaults, Meshes(root, compiler, defaults, files, report), report)
    bodies.armatures, bodies.dampings = rotor_laws(root, defaults, report)
    for node in root.all("worldbody"):
        bodies.world(written_out(node, bodies.compiler))
    if not bodies.links:
        raise refuse(root.place, "no-links", "the file has no <body>")
    _tell_of_others(root, report)
    gravity, place = _gravity(root, report)
    links = _with_total_mass(in_order(bodies.links), bodies.compiler.settotalmass)
    points = {name: (link, seat.position) for name, (link, seat) in bodies.sites.items()}
    bound = equalities(root, defaults)
    robot = Robot(
        root.attributes.get("model", ""),
        links,
        report,
        frames=tuple(bodies.frames),
        mimics=bindings_of(bound, links, report),
        loops=loops_of(bound, links, bodies.sites, report),
        tendons=tendons_of(root, links, points, defaults, report),
        gravity=gravity,
        gravity_place=place,
    )
    return with_springs(robot, bodies.springdampers)


def _with_included(node: Node, included: Mapping[str, bytes], above: list[str]) -> Node:
    """With the children of other files' roots in the place of <include>. Raises InvalidDocument for files not given."""
    children: list[Node] = []
    for child in node.children:
        if child.tag != "include":
            children.append(_with_included(child, included, above))
            continue
        name = child.text_of("file")
        if name not in included or name in above or len(above) > _MOST_INCLUDES:
            message = f"the file '{name[:80]}' is not followed: put its content here"
            raise refuse(child.place, "external-file", message)
        children += _with_included(read_xml(included[name], name), included, [*above, name]).children
    return replace(node, children=children)


def _gravity(root: Node, report: Report) -> tuple[Triple, Place | None]:
    """The last one that is given, and where; that of the format without any. Of flags the last counts, too."""
    found, place = GRAVITY.split(), None
    disabled: dict[str, Place] = {}
    for node in root.all("option"):
        if "gravity" in node.attributes:
            found, place = node.attributes["gravity"].split(), node.place
        for name in ("density", "viscosity"):
            if name in node.attributes and value(node.number(name)):
                report.lost(node.place, f"forces of a fluid ({name}) are left out")
        for flag in node.all("flag"):
            disabled = {name: at for name, at in disabled.items() if name not in flag.attributes}
            disabled |= {name: flag.place for name, given in flag.attributes.items() if given == "disable"}
    for name in ("passive", "spring", "damper"):
        if name in disabled:
            report.lost(disabled[name], f"{name}='disable' is not read: springs and dampers of joints act here")
    if "gravity" in disabled:
        return ORIGIN, disabled["gravity"]
    here = root.place if place is None else place
    if len(found) != 3:
        raise refuse(here, "wrong-length", "gravity needs 3 numbers")
    return triple(tuple(number_of(x, here, "gravity") for x in found)), place


def _tell_of_others(root: Node, report: Report) -> None:
    for node in root.children:
        if node.tag in _READ:
            continue
        if node.tag in _IGNORED:
            report.ignored(node.place, f"{_IGNORED[node.tag]}: no influence on the equations of motion")
        elif node.tag == "deformable":
            raise refuse(node.place, "not-read", "deformable bodies have no relative coordinates")
        elif node.tag == "extension":
            for plugin in node.children:
                report.lost(plugin.place, "what a plugin does is not known here: its forces are left out")


def _with_total_mass(links: tuple[Link, ...], total: float) -> tuple[Link, ...]:
    """All masses and moments scaled to a total mass, where one is asked for."""
    if total <= 0:
        return links
    for link in links:
        if link.unweighed is not None:
            message = "the mass of a mesh needs its file, as all masses are scaled by settotalmass: give an <inertial>"
            raise refuse(link.unweighed, "mesh-inertia", message)
    mass = sum(value(link.inertial.mass) for link in links)
    if mass <= 0:
        raise refuse(links[0].place, "no-mass", "no body has a mass, so that settotalmass has nothing to scale")
    factor = total / mass
    scaled = []
    for link in links:
        own = link.inertial
        six = tuple(decimal_of(value(x) * factor) for x in own.inertia)
        scaled.append(replace(link, inertial=Inertial(decimal_of(value(own.mass) * factor), own.com, six)))
    return tuple(scaled)
