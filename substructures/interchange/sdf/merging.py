"""<include merge="true"> of an SDF file: what a model has, in the model that includes it.

Of the model there remains a frame, ``_merged__NAME__model__``, attached to its canonical link: what was given relative
to the model is given relative to this frame. Names stay as they are, so that two of one name are refused.
Source: http://sdformat.org/tutorials?tut=merge_include_proposal
"""

from __future__ import annotations

from dataclasses import replace

from substructures.interchange.report import refuse
from substructures.interchange.sdf.frames import is_true
from substructures.interchange.xml import Node

MODEL = "__model__"
FLAG = "use_parent_model_frame"
_POSED = ("link", "model")
_REFERRING = {"pose": ("relative_to", "frame"), "xyz": ("expressed_in",), "frame": ("attached_to",)}
_ENDS = ("parent", "child")


def merged(model: Node, in_model_frame: bool) -> list[Node]:
    """The children of a model, with the frame that stands for it; ``in_model_frame``: axes are given in it by default.

    Raises InvalidDocument for a model without a link.
    """
    proxy = f"_merged__{model.text_of('name')}{MODEL}"
    link = canonical_link(model)
    if link is None:
        message = f"the model has no link that '{proxy}' could be attached to: leave merge out"
        raise refuse(model.place, "no-links", message)
    pose = model.one("pose")
    own = Node("pose", {}, model.line, file=model.file) if pose is None else pose
    given = own.attributes.get("relative_to") or own.attributes.get("frame") or MODEL
    attributes = {"name": proxy, "attached_to": link}
    if "placement_frame" in model.attributes:
        attributes["placement_frame"] = model.attributes["placement_frame"]
    placed = replace(own, attributes={**own.attributes, "relative_to": given})
    frame = Node("frame", attributes, model.line, [placed], file=model.file)
    kept = (child for child in model.children if child.tag != "pose")
    return [frame, *(_child(child, proxy, in_model_frame) for child in kept)]


def canonical_link(model: Node) -> str | None:
    """The one that is named, else the first, else that of the first model in it; None where there is none."""
    if named := model.attributes.get("canonical_link"):
        return named
    for link in model.all("link"):
        return link.text_of("name")
    for inner in model.all("model"):
        if (found := canonical_link(inner)) is not None:
            return f"{inner.text_of('name')}::{found}"
    return None


def _child(node: Node, proxy: str, in_model_frame: bool) -> Node:
    """A link, joint, frame or model, as it is given in the frame of its model."""
    if node.tag in _POSED:
        here = node.one("pose")
        pose = Node("pose", {}, node.line, file=node.file) if here is None else here
        given = pose.attributes.get("relative_to") or pose.attributes.get("frame") or MODEL
        posed = replace(pose, attributes={**pose.attributes, "relative_to": proxy if given == MODEL else given})
        return replace(node, children=[posed, *(child for child in node.children if child.tag != "pose")])
    if node.tag == "frame":
        at = node.attributes.get("attached_to", MODEL)
        node = replace(node, attributes={**node.attributes, "attached_to": proxy if at == MODEL else at})
        return _referring(node, proxy)
    if node.tag == "joint":
        children = [_axis(child, proxy, in_model_frame) for child in node.children]
        return _referring(replace(node, children=children), proxy)
    return node


def _axis(axis: Node, proxy: str, in_model_frame: bool) -> Node:
    """An axis that is given in the frame of the model says so."""
    flag = axis.one(FLAG) if axis.tag in ("axis", "axis2") else None
    is_in_model = in_model_frame if flag is None else is_true(flag.text)
    if axis.tag not in ("axis", "axis2") or not is_in_model:
        return axis
    children = [
        replace(child, attributes={"expressed_in": proxy, **child.attributes}) if child.tag == "xyz" else child
        for child in axis.children
    ]
    return replace(axis, children=[child for child in children if child.tag != FLAG])


def _referring(node: Node, proxy: str) -> Node:
    """With the frame in place of the model, where a pose, an axis or an end of a joint names it."""
    names = _REFERRING.get(node.tag, ())
    attributes = {k: proxy if k in names and x == MODEL else x for k, x in node.attributes.items()}
    text = proxy if node.tag in _ENDS and node.text.strip() == MODEL else node.text
    children = [_referring(child, proxy) for child in node.children]
    return replace(node, attributes=attributes, text=text, children=children)
