"""Meshes of an MJCF file: of the files that are given beside it, or written in it."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np

from substructures.array import Array
from substructures.errors import InvalidDocument, among
from substructures.interchange.files.meshes import (
    MODES,
    BadMesh,
    Triangles,
    Weighed,
    changed,
    paths_of,
    read_mesh,
    weighed,
)
from substructures.interchange.mjcf.settings import Compiler, Defaults, choice
from substructures.interchange.numbers import ONE, ORIGIN, ZERO, value
from substructures.interchange.report import Report, refuse
from substructures.interchange.rotations import from_quaternion
from substructures.interchange.xml import Node

LEGACY = "legacy"


class UnknownMass(InvalidDocument):
    """The mass of a geom is in a file that is not here, or that of a shell."""


class Meshes:
    """What bodies of the shape of a mesh weigh, by the names in <asset>."""

    def __init__(
        self, root: Node, compiler: Compiler, defaults: Defaults, files: Mapping[str, bytes], report: Report
    ) -> None:
        found = [defaults.applied(mesh, None) for asset in root.all("asset") for mesh in asset.all("mesh")]
        self._nodes = {node.attributes.get("name", _stem(node.attributes.get("file", ""))): node for node in found}
        self._compiler, self._files, self._report = compiler, files, report
        self._weighed: dict[str, Weighed] = {}

    def of(self, geom: Node) -> Weighed:
        """Of the mesh of a geom, with density 1, in the frame of the geom. Raises InvalidDocument for one that is not
        there or has no volume, UnknownMass where its file is not given.
        """
        name = geom.text_of("mesh")
        if name not in self._nodes:
            raise refuse(geom.place, "unknown-mesh", f"there is no mesh '{name[:60]}'{among(name, self._nodes)}")
        if name not in self._weighed:
            self._weighed[name] = self._of(self._nodes[name], geom)
        return self._weighed[name]

    def _of(self, node: Node, geom: Node) -> Weighed:
        mode = choice(node, "inertia", MODES) if "inertia" in node.attributes else self._mode()
        scale = np.array([value(x) for x in node.numbers("scale", 3, (ONE, ONE, ONE))])
        position = np.array([value(x) for x in node.numbers("refpos", 3, ORIGIN)])
        turned = [value(x) for x in node.numbers("refquat", 4, (ONE, ZERO, ZERO, ZERO))]
        try:
            return weighed(changed(self._triangles(node, geom), scale, position, from_quaternion(turned)), mode)
        except BadMesh as error:
            raise refuse(node.place, "bad-mesh", f"this mesh has no mass: {error}; or give <inertial>") from None

    def _mode(self) -> str:
        return "exact" if self._compiler.exactmeshinertia else LEGACY

    def _triangles(self, node: Node, geom: Node) -> Triangles:
        if "file" not in node.attributes:
            if "vertex" not in node.attributes:
                message = "a mesh that a program makes ('builtin') is not read: give the body an <inertial>"
                raise UnknownMass(refuse(geom.place, "mesh-inertia", message).faults)
            return Triangles(_rows(node, "vertex"), _rows(node, "face").astype(int))
        file = node.text_of("file")
        told = file.replace("\\", "/").rpartition("/")[2] if self._compiler.strippath else file
        for path in paths_of(told, self._compiler.meshdir):
            if path in self._files:
                found = read_mesh(told, self._files[path])
                if found.others:
                    message = f"only the first object of '{file[:80]}' is weighed, as MuJoCo does; the others have "
                    self._report.warning(node.place, f"{message}{found.others} faces")
                return found
        message = (
            f"the mass of a mesh needs its file: '{file[:80]}' is not given; send it beside (zip), or give the body an "
            "<inertial>, or the geom mass='0'"
        )
        raise UnknownMass(refuse(geom.place, "mesh-inertia", message).faults)


def _rows(node: Node, name: str) -> Array:
    numbers = [value(x) for x in node.numbers(name, None, ())]
    if len(numbers) % 3:
        raise refuse(node.place, "wrong-length", f"{name} has three numbers a row")
    return np.array(numbers).reshape(-1, 3)


def _stem(file: str) -> str:
    return file.replace("\\", "/").rpartition("/")[2].rpartition(".")[0]
