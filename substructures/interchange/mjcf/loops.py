"""Equality constraints between bodies as closures: connect and weld; others are told of."""

from __future__ import annotations

from collections.abc import Collection, Iterable, Mapping
from dataclasses import replace

import numpy as np

from substructures.array import Array
from substructures.errors import among, meant
from substructures.interchange.bindings import joints_of, mimic_of
from substructures.interchange.merge import Seat, vector
from substructures.interchange.mjcf.settings import Defaults, name_of, names_of
from substructures.interchange.numbers import ONE, ORIGIN, ZERO, decimal_of, value
from substructures.interchange.report import Report, refuse
from substructures.interchange.robot import Link, Loop, Mimic, Motion
from substructures.interchange.rotations import from_axis_angle, from_quaternion, from_rpy, to_rpy
from substructures.interchange.xml import SHOWN, Node

WORLD = "world"
#: R and position in the world
Pose = tuple[Array, Array]
#: links (None: the world) and what is placed in them, by the names of sites
Sites = Mapping[str, tuple[str | None, Seat]]


def equalities(root: Node, defaults: Defaults) -> list[Node]:
    """The constraints of all <equality>, with what defaults say of them (``active``)."""
    found = [node for section in root.all("equality") for node in section.children]
    return [replace(defaults.applied(replace(node, tag="equality"), None), tag=node.tag) for node in found]


def loops_of(nodes: Collection[Node], links: tuple[Link, ...], sites: Sites, report: Report) -> tuple[Loop, ...]:
    """The closures of all active <connect> and <weld>; frames coincide where no joint has moved, or are of sites."""
    found: list[Loop] = []
    poses, names = poses_of(links, {}), names_of(nodes)
    for node in nodes:
        if node.attributes.get("active", "true") == "false":
            report.ignored(node.place, "an equality constraint that is not active")
        elif node.tag == "joint":
            continue  # see bindings_of
        elif node.tag not in ("connect", "weld"):
            message = f"the equality constraint <{node.tag[:40]}> is left out: add a velocity constraint for it"
            report.lost(node.place, message, "topology")
        else:
            found.append(_loop(node, name_of(node, f"loop{len(found) + 1}", names), poses, sites))
    return tuple(found)


def bindings_of(nodes: Iterable[Node], links: tuple[Link, ...], report: Report) -> tuple[Mimic, ...]:
    """The linear <joint> constraints that are active: q1 - ref1 = c0 + c1 (q2 - ref2)."""
    found: list[Mimic] = []
    refs = {motion.name: value(motion.offset) for link in links for motion in link.motions}
    known = joints_of(links)
    for node in nodes:
        if node.tag != "joint" or node.attributes.get("active", "true") == "false":
            continue
        first, second = node.text_of("joint1"), node.attributes.get("joint2")
        c = [*(value(x) for x in node.numbers("polycoef", None, (ZERO, ONE))), 0.0, 0.0, 0.0, 0.0, 0.0][:5]
        if second is None or any(c[2:]):
            message = "a joint held at a number, or bound by a polynomial, is left out: add a prescribed motion for it"
            report.lost(node.place, message, "topology")
            continue
        shift = refs.get(first, 0.0) + c[0] - c[1] * refs.get(second, 0.0)
        factors = decimal_of(c[1]), decimal_of(shift)
        found += mimic_of(first, second, factors, node.place, known, report)
    return tuple(found)


def poses_of(links: tuple[Link, ...], q: Mapping[str, float]) -> dict[str | None, Pose]:
    """Where the bodies are at the start; ``q``: of joints of one coordinate that are elsewhere."""
    still = np.eye(3), np.zeros(3)
    poses: dict[str | None, Pose] = {None: still, WORLD: still}
    for link in links:
        R, r = poses[link.parent]
        pose = R @ from_rpy(link.rpy), r + R @ [value(x) for x in link.position]
        for motion in link.motions:
            pose = _moved(pose, motion, q.get(motion.name, value(motion.offset)) - value(motion.offset))
        poses[link.name] = pose
    return poses


def _moved(pose: Pose, motion: Motion, by: float) -> Pose:
    """Beyond a joint of one coordinate."""
    if not by:
        return pose
    (R, r), axis, anchor = pose, np.array([value(x) for x in motion.axis]), [value(x) for x in motion.anchor]
    if motion.type == "prismatic":
        return R, r + R @ axis * (by / np.linalg.norm(axis))
    turned = R @ from_axis_angle(list(axis), by)
    return turned, r + R @ anchor - turned @ anchor


def _loop(node: Node, name: str, poses: dict[str | None, Pose], sites: Sites) -> Loop:
    if "site1" in node.attributes or "site2" in node.attributes:
        return _between_sites(node, name, sites)
    first, second = node.text_of("body1"), node.attributes.get("body2", WORLD)
    for body in (first, second):
        if body not in poses:
            raise refuse(node.place, "unknown-link", f"there is no body '{body}'{among(body, filter(None, poses))}")
    _require_two(node, first, second)
    if node.tag == "connect":
        anchor = np.array([value(x) for x in node.numbers("anchor", 3)])
        found = _ball(name, first, second, anchor, poses)
    else:
        found = _weld(node, name, first, second, poses)
    return _to_world(found)


def _between_sites(node: Node, name: str, sites: Sites) -> Loop:
    """Two sites coincide, of <weld> with their axes, wherever they are at the start."""
    ends: list[tuple[str, Seat]] = []
    for site in (node.text_of("site1"), node.text_of("site2")):
        if site not in sites:
            raise refuse(node.place, "unknown-site", f"there is no site '{site[:SHOWN]}'{meant(site, sites)}")
        link, seat = sites[site]
        ends.append((WORLD if link is None else link, seat))
    (first, one), (second, two) = ends
    _require_two(node, first, second)
    if node.tag == "connect":
        return _to_world(Loop(name, "ball", first, second, one.position, ORIGIN, two.position, ORIGIN))
    return _to_world(Loop(name, "weld", first, second, one.position, one.rpy, two.position, two.rpy))


def _require_two(node: Node, first: str, second: str) -> None:
    if first == second:
        raise refuse(node.place, "same-body", f"both bodies are '{first}': name two")


def _to_world(loop: Loop) -> Loop:
    """With the world, which is no link, as the other end."""
    if loop.link != WORLD:
        return replace(loop, other=None) if loop.other == WORLD else loop
    here, there = (loop.position, loop.rpy), (loop.other_position, loop.other_rpy)
    return Loop(loop.name, loop.kind, str(loop.other), None, *there, *here)


def _ball(name: str, first: str, second: str, anchor: Array, poses: dict[str | None, Pose]) -> Loop:
    """The anchor is given in the first body."""
    (R1, r1), (R2, r2) = poses[first], poses[second]
    other = R2.T @ (r1 + R1 @ anchor - r2)
    return Loop(name, "ball", first, second, vector(anchor), ORIGIN, vector(other), ORIGIN)


def _weld(node: Node, name: str, first: str, second: str, poses: dict[str | None, Pose]) -> Loop:
    """The pose of the second body in the first one: as given, or what it is at the start."""
    (R1, r1), (R2, r2) = poses[first], poses[second]
    R, r = R1.T @ R2, R1.T @ (r2 - r1)
    given = [value(x) for x in node.numbers("relpose", 7)] if "relpose" in node.attributes else [0.0] * 7
    if any(given[3:]):
        R, r = from_quaternion(given[3:]), np.array(given[:3])
    return Loop(name, "weld", first, second, vector(r), to_rpy(R), ORIGIN, ORIGIN)
