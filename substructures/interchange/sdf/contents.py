"""What the models of an SDF file have: links, joints and frames by their full names, ``model::link``."""

from __future__ import annotations

from collections import ChainMap
from dataclasses import dataclass, field

import numpy as np

from substructures.interchange.known.check import acting
from substructures.interchange.report import Report, refuse
from substructures.interchange.sdf.frames import Framed, Frames, by_placement, framed
from substructures.interchange.sdf.merging import canonical_link
from substructures.interchange.xml import Node

#: elements that are mechanics and are not read, and the values with which they are none
_ACTING: dict[str, tuple[str, ...]] = {
    **dict.fromkeys(("static", "kinematic", "must_be_base_link", "enable_wind"), ("0", "false")),
    **dict.fromkeys(("linear", "angular"), ("0", "0.0")),
    "gravity": ("1", "true"), "linear_bushing_rpy": (), "ball_constraint": (),
}  # fmt: skip


@dataclass
class Contents:
    """Of a model with those nested in it; what acts and is not read is told."""

    report: Report
    frames: Frames = field(default_factory=Frames)
    links: dict[str, Node] = field(default_factory=dict)
    joints: list[tuple[str, Node]] = field(default_factory=list)  #: with the prefix of names in their models
    attached: dict[str, str] = field(default_factory=dict)  #: of frames what they are attached to
    #: of models their canonical links, of joints their children
    _canonical: dict[str, str] = field(default_factory=dict)
    _resolved: dict[str, str | None] = field(default_factory=dict)

    def enter(self, model: Node, prefix: str, placed: Framed) -> None:
        """All frames of a model: its own, and those of links, joints, frames and models in it."""
        base = f"{prefix}__model__"
        self.frames.add(base, by_placement(placed, model, prefix))
        link = canonical_link(model)
        if link is not None:
            self._canonical |= dict.fromkeys(filter(None, (base, prefix.removesuffix("::"))), prefix + link)
        for node in model.children:
            if node.tag in ("link", "joint", "frame", "model"):
                self._named(node, prefix, base)
            elif node.tag != "pose":
                self._tell(node, "model")

    def _tell(self, node: Node, holder: str) -> None:
        """What acts and is not read."""
        for each in acting(node, _ACTING):
            message = f"<{each.tag}> in <{holder}> is not read: what it says of the mechanics is left out"
            self.report.lost(each.place, message)

    def _named(self, node: Node, prefix: str, base: str) -> None:
        name = prefix + node.text_of("name")
        if node.tag == "link":
            self.links[name] = node
            for child in node.children:
                if child.tag not in ("pose", "inertial", "visual", "collision"):
                    self._tell(child, "link")
            self.frames.add(name, framed(node.one("pose"), prefix, node.place, base))
        elif node.tag == "joint":
            self.joints.append((prefix, node))
            self._canonical[name] = prefix + text_in(node, "child")
            self.frames.add(name, framed(node.one("pose"), prefix, node.place, self._canonical[name]))
        elif node.tag == "frame":
            attached = node.attributes.get("attached_to")
            at = prefix + attached if attached else base
            self.attached[name] = at
            placed = framed(node.one("pose"), prefix, node.place, at)
            self.frames.add(name, by_placement(placed, node, prefix))
        else:
            inner = f"{name}::"
            self.enter(node, inner, framed(node.one("pose"), prefix, node.place, base))
            self.frames.add(name, Framed(f"{inner}__model__", np.eye(3), np.zeros(3), node.place))

    def link_of(self, name: str) -> str | None:
        """The link that a frame is attached to, perhaps over other frames; None for the model itself."""
        chain: dict[str, None] = {}
        held = ChainMap(self.attached, self._canonical)
        while name not in self._resolved and name in held and name not in chain:
            chain[name] = None
            name = held[name]
        found = self._resolved.get(name, name if name in self.links else None)
        self._resolved |= dict.fromkeys(chain, found)
        return found


def text_in(node: Node, tag: str) -> str:
    """What a child says, or the link that it names."""
    found = node.one(tag)
    name = "" if found is None else found.text.strip() or found.attributes.get("link", "")
    if not name:
        raise refuse(node.place, "missing-element", f"<{tag}> is needed")
    return name
