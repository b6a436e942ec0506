"""<include> of an SDF file: the model of another file of the same folder or zip, as one that is nested here.

Its name, pose, static and plugins may be given beside the uri, and go before its own; with ``merge`` its content is in
this one (``merging``). A uri is a path from the file
that has it, or ``model://NAME/...`` (``package://``), which is looked for beside that file, beside its folder, and in
a folder ``models`` at either place. It leads to a file or to a folder, whose ``model.config`` names the file, else
``model.sdf`` is taken. Source: http://sdformat.org/tutorials?tut=composition
"""

from __future__ import annotations

import posixpath
from collections.abc import Mapping, Sequence
from dataclasses import replace

from substructures.interchange.files.archive import models_at
from substructures.interchange.known.sdf import SDF
from substructures.interchange.report import Report, refuse
from substructures.interchange.sdf.frames import is_true
from substructures.interchange.sdf.merging import FLAG, merged
from substructures.interchange.xml import MAX_DEPTH, MAX_ELEMENTS, SHOWN, Node, read_xml

MANIFEST, MODEL = "model.config", "model.sdf"
#: what goes before the same of the model
_OVER = ("pose", "static")
_HOLDERS = ("sdf", "world", "model")


def with_included(root: Node, files: Mapping[str, bytes], in_model_frame: Sequence[str], report: Report) -> Node:
    """The document with models in the place of <include>; ``files``: by their paths from it.

    ``in_model_frame``: versions in which axes are given in the frame of the model. A world that has a model does
    without what is not there. Raises InvalidDocument for files that are not given, and circles.
    """
    return _Writer(files, in_model_frame, root.attributes.get("version", ""), report).written(root, "", ())


class _Writer:
    """Counts the elements of all files."""

    def __init__(self, files: Mapping[str, bytes], in_model_frame: Sequence[str], version: str, report: Report) -> None:
        self.files, self.report = files, report
        self._in_model_frame, self._version, self._count = in_model_frame, version, 0

    def written(self, node: Node, folder: str, above: tuple[str, ...], depth: int = 0) -> Node:
        """A copy without <include>; ``above``: the files that it is included by."""
        if depth > MAX_DEPTH:
            raise refuse(node.place, "nesting", f"models are nested deeper than {MAX_DEPTH} levels")
        children: list[Node] = []
        for child in node.children:
            if child.tag == "include":
                path = self._path(child, folder)
                if path is None and node.tag == "world" and any(node.all("model")):
                    message = "the file is not here, and what it has beside the model is left out"
                    self.report.lost(child.place, message, "topology")
                    continue
                children += self._model(child, node, path, above, depth)
            elif child.tag in _HOLDERS:
                children.append(self.written(child, folder, above, depth + 1))
            else:
                children.append(child)
        return replace(node, children=children)

    def _path(self, include: Node, folder: str) -> str | None:
        """Where its file is; None where it is not."""
        for path in models_at(_uri(include)):
            here = posixpath.normpath(posixpath.join(folder, path))
            if here in self.files:
                return here
            for name in (self._named(posixpath.join(here, MANIFEST)), MODEL):
                if name and posixpath.join(here, name) in self.files:
                    return posixpath.join(here, name)
        return None

    def _named(self, manifest: str) -> str:
        """The last file that a manifest names: they are listed by their versions."""
        if manifest not in self.files:
            return ""
        return next(
            (node.text.strip() for node in reversed([*read_xml(self.files[manifest], manifest).all("sdf")])), ""
        )

    def _model(self, include: Node, holder: Node, path: str | None, above: tuple[str, ...], depth: int) -> list[Node]:
        """The model of a file as it is included, or what it has; of a file without any what it has (a light)."""
        is_merged = is_true(include.attributes.get("merge", ""))
        if is_merged and holder.tag != "model":
            message = f"merge in a <{holder.tag}> is not read: leave it out, the model has its links and joints"
            raise refuse(include.place, "not-read", message)
        if path is None:
            message = (
                f"'{_uri(include)[:SHOWN]}' is not here: send its folder along (zip, or import FOLDER), or put the "
                "model's content here"
            )
            raise refuse(include.place, "external-file", message)
        if path in above:
            raise refuse(include.place, "cycle", f"the file '{path[:SHOWN]}' includes itself")
        root = read_xml(self.files[path], path)
        self._count += _size(root)
        if self._count > MAX_ELEMENTS:
            raise refuse(include.place, "too-large", f"more than {MAX_ELEMENTS:,} elements in what is included")
        models = list(root.all("model"))
        if root.tag != "sdf" or len(models) > 1:
            message = f"'{path[:SHOWN]}' is no SDF file with one model: include such files alone"
            raise refuse(include.place, "several-models", message)
        SDF.tell(root, self.report)
        if not models:
            return root.children
        self._say_frames(root)
        model = self.written(models[0], posixpath.dirname(path), (*above, path), depth + 1)
        model = _named_here(include, model)
        return merged(model, self._version in self._in_model_frame) if is_merged else [model]

    def _say_frames(self, root: Node) -> None:
        """Axes of a file of another version say in which frame they are given."""
        version = root.attributes.get("version", "")
        if (version in self._in_model_frame) == (self._version in self._in_model_frame):
            return
        text = "true" if version in self._in_model_frame else "false"
        waiting = [root]
        while waiting:
            node = waiting.pop()
            waiting += [child for child in node.children if child.tag in (*_HOLDERS, "joint")]
            for axis in node.all("axis", "axis2"):
                if axis.one(FLAG) is None:
                    axis.children.append(Node(FLAG, {}, axis.line, text=text))


def _uri(include: Node) -> str:
    found = include.one("uri")
    if found is None or not found.text.strip():
        raise refuse(include.place, "missing-element", "<uri> is needed")
    return found.text.strip()


def _named_here(include: Node, model: Node) -> Node:
    """A model with the name and the pose that an <include> gives it."""
    attributes, given = dict(model.attributes), [x for x in include.children if x.tag not in ("uri", "name")]
    for tag in ("name", "placement_frame"):
        if (node := include.one(tag)) is not None:
            attributes[tag] = node.text.strip()
    over = {node.tag for node in given if node.tag in _OVER}
    kept = [child for child in model.children if child.tag not in over]
    return replace(model, attributes=attributes, children=[*kept, *(x for x in given if x.tag != "placement_frame")])


def _size(node: Node) -> int:
    count, waiting = 0, [node]
    while waiting:
        here = waiting.pop()
        waiting += here.children
        count += 1
    return count
