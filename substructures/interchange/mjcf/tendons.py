"""Tendons of an MJCF file that are springs and dampers: sums of coordinates, and lengths along sites.

Without ``springlength`` they rest at their length where all joints are at their ``springref``. What wraps around a geom
has no length of straight pieces, and what a pulley divides is no sum of cables: both are left out, as limits are.
Source: https://mujoco.readthedocs.io/en/stable/XMLreference.html#tendon
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass, replace
from itertools import pairwise

import numpy as np

from substructures.errors import meant
from substructures.interchange.bindings import joints_of
from substructures.interchange.mjcf.loops import poses_of
from substructures.interchange.mjcf.settings import Compiler, Defaults, name_of, names_of, range_of
from substructures.interchange.numbers import ONE, ZERO, Number, Triple, decimal_of, value
from substructures.interchange.report import Report, refuse
from substructures.interchange.robot import Link, Tendon
from substructures.interchange.xml import SHOWN, Node
from substructures.loads.cable import MOST

_LEFT_OUT = ("armature", "frictionloss", "springyield")
_AT_REST: tuple[Number, ...] = (-ONE, -ONE)
#: points of links (None: the world) by the names of sites
Sites = Mapping[str, tuple[str | None, Triple]]


def tendons_of(
    root: Node, links: tuple[Link, ...], sites: Sites, defaults: Defaults, report: Report
) -> tuple[Tendon, ...]:
    """Those with stiffness or damping. Raises InvalidDocument for joints and sites that are not there."""
    reader = _Reader(links, sites, Compiler.of(root), report)
    found: list[Tendon] = []
    nodes = [each for section in root.all("tendon") for each in section.children]
    names = names_of(nodes)
    for node in nodes:
        given = replace(defaults.applied(replace(node, tag="tendon"), None), tag=node.tag)
        found += reader.read(given, name_of(node, f"tendon{len(found) + 1}", names))
    return tuple(found)


@dataclass(frozen=True)
class _Reader:
    """Of tendons over ``links``."""

    links: tuple[Link, ...]
    sites: Sites
    compiler: Compiler
    report: Report

    def read(self, node: Node, name: str) -> Iterator[Tendon]:
        """The tendon, if it acts and can be said; else what is left out is told."""
        laws = {law: node.numbers(law, None, (ZERO,)) or (ZERO,) for law in ("stiffness", "damping")}
        acting = [law for law, numbers in laws.items() if any(map(value, numbers))]
        lost = [law for law in _LEFT_OUT if any(value(x) for x in node.numbers(law, None, (ZERO,)))]
        lost += ["range"] if range_of(node, self.compiler) is not None else []
        obstacle = self._obstacle(node, laws)
        lost = [*acting, *lost] if obstacle else lost
        if lost:
            because = f", {obstacle}" if obstacle and acting else ""
            self.report.lost(node.place, f"{', '.join(lost)} of a tendon is left out{because}: add a load for it")
        elif not acting:
            message = "a tendon without stiffness and damping has no influence on the equations of motion"
            self.report.ignored(node.place, message)
        if acting and not obstacle:
            joints = tuple(map(self._joint, node.children)) if node.tag == "fixed" else ()
            points = () if node.tag == "fixed" else tuple(map(self._point, node.children))
            if not joints and len(points) < 2:
                raise refuse(
                    node.place, "too-few", "a tendon needs a joint, if it is fixed, or else two sites at least"
                )
            k, c = laws["stiffness"][0], laws["damping"][0]
            yield Tendon(name, node.place, k, c, self._rest(node, joints, points), joints, points)

    def _obstacle(self, node: Node, laws: Mapping[str, tuple[Number, ...]]) -> str:
        """Why no load says it; empty where one does."""
        for child in node.children if node.tag != "fixed" else ():
            if child.tag == "geom":
                around = child.attributes.get("geom", "")[:SHOWN]
                return f"which wraps around the geom '{around}' (give sites in its place, and it is a cable)"
            if child.tag == "pulley":
                return "which is divided by a pulley"
        if any(value(x) for numbers in laws.values() for x in numbers[1:]):
            return "which is a polynomial"
        return f"which has more than {MOST} sites" if len(node.children) > MOST else ""

    def _joint(self, node: Node) -> tuple[str, Number]:
        name, known = node.text_of("joint"), joints_of(self.links)
        if not known.get(name):
            message = f"there is no joint '{name[:60]}' of one coordinate{meant(name, known)}"
            raise refuse(node.place, "unknown-joint", message)
        return name, node.number("coef")

    def _point(self, node: Node) -> tuple[str | None, Triple]:
        name = node.text_of("site")
        if name not in self.sites:
            raise refuse(node.place, "unknown-site", f"there is no site '{name[:60]}'{meant(name, self.sites)}")
        return self.sites[name]

    def _rest(
        self, node: Node, joints: tuple[tuple[str, Number], ...], points: tuple[tuple[str | None, Triple], ...]
    ) -> tuple[Number, Number]:
        """The lengths between which it is slack."""
        given = node.numbers("springlength", None, _AT_REST)
        if not 1 <= len(given) <= 2 or value(given[0]) > value(given[-1]):
            raise refuse(node.place, "bad-value", "springlength is one length, or two of which the first is not longer")
        if any(value(x) != -1 for x in given):
            return given[0], given[-1]
        q = {m.name: value(m.rest) for link in self.links for m in link.motions if m.type in ("revolute", "prismatic")}
        if joints:
            length = sum(value(k) * q[joint] for joint, k in joints)
        else:
            poses = poses_of(self.links, q)
            places = [poses[link][1] + poses[link][0] @ [value(x) for x in at] for link, at in points]
            length = sum(float(np.linalg.norm(b - a)) for a, b in pairwise(places))
        if not np.isfinite(length):
            raise refuse(node.place, "bad-value", "the length at rest is no finite number: give springlength")
        return decimal_of(length), decimal_of(length)
