"""Pictures of parts and trees in one pose, as SVG; those in the standard pose are kept."""

from __future__ import annotations

import math
import re
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np
import orjson

from service.jobs.kinds.reported import INSTANCE
from service.messages.refusals import unprocessable
from service.operations.evaluations import check_size
from service.operations.sharing.sources import tree_parts
from service.queries.catalogue import Version
from service.queries.trees import Tree
from service.store.store import Store
from substructures.documents.fields import Quantity, quantity_of
from substructures.errors import InvalidArgument
from substructures.part.part import Part
from substructures.pictures.scene import scene
from substructures.pictures.tree import picture
from substructures.quantities.measured import si_values
from substructures.quantities.numbers.evaluation import Sources
from substructures.tree.document import TreeSpec
from substructures.tree.model import Model

PoseValues = tuple[float, ...]
LARGEST = 1e6
_NUMBER = re.compile(r"[+-]?(?:[0-9]+\.?[0-9]*|\.[0-9]+)(?:[eE][+-]?[0-9]+)?")


@dataclass(frozen=True, slots=True)
class Drawn:
    """What there is to draw."""

    spec: TreeSpec
    parts: Mapping[str, Part]
    model: Model


def joints_of(tree: Tree) -> str:
    """The kinds of a tree's joints, R and P."""
    return str(orjson.loads(tree.summary)["joints"])


def read_pose(text: str | None, joints: str) -> PoseValues | None:
    """The pose of ``?q=0.1,30 deg``; None for the standard one. Raises Refused 422 with the pointer ``/query/q``.

    ``joints``: the kind of every coordinate, R or P.
    """
    if text is None:
        return None
    fields = [field.strip() for field in text.split(",")] if text.strip() else []
    if len(fields) != len(joints):
        raise unprocessable("q", f"expected {len(joints)} comma separated numbers, found {len(fields)}", "/query/q")
    return tuple(_coordinate(field, kind) for field, kind in zip(fields, joints, strict=True))


def _coordinate(field: str, kind: str) -> float:
    """A number in rad or m, or one with its unit."""
    given = quantity_of(field)
    number = str(given.value) if isinstance(given, Quantity) else given
    value = math.nan
    if _NUMBER.fullmatch(number) and math.isfinite(float(number)):
        try:
            plain = {"value": float(number), "unit": given.unit} if isinstance(given, Quantity) else float(number)
            value = si_values(plain, {"R": "rad", "P": "m"}[kind], "/query/q")
        except InvalidArgument as error:
            (fault,) = error.faults
            raise unprocessable(fault.code, f"'{field[:40]}': {fault.message}", "/query/q") from None
    if not abs(value) <= LARGEST:
        detail = f"'{field[:40]}' is no number between -{LARGEST:g} and {LARGEST:g} (rad or m)"
        raise unprocessable("q", detail, "/query/q")
    return value


def draw_part(store: Store, version: Version, pose: PoseValues | None) -> str:
    """SVG of a part alone, mounted on the world. Raises TooLarge."""
    return _kept(store, version.digest, pose) or _draw(store, version.digest, _part_scene(store, version), pose)


def draw_tree(store: Store, tree: Tree, pose: PoseValues | None) -> str:
    """SVG of a revision of a tree. Raises TooLarge."""
    return _kept(store, tree.digest, pose) or _draw(store, tree.digest, _tree_scene(store, tree), pose)


def _kept(store: Store, digest: str, pose: PoseValues | None) -> str | None:
    return store.caches.pictures.get(digest) if pose is None else None


def _draw(store: Store, digest: str, drawn: Drawn, pose: PoseValues | None) -> str:
    check_size(Sources(drawn.model), ["kinematics"], 1, store.settings.limits)
    with np.errstate(all="ignore"):  # defaults of any size may be stored; what is not finite is not drawn
        svg = picture(drawn.spec, drawn.parts, drawn.model, None if pose is None else list(pose))
    if pose is None:
        store.caches.pictures.put(digest, svg)
    return svg


def _part_scene(store: Store, version: Version) -> Drawn:
    with store.database.read() as connection:
        part = store.required_part(connection, version.digest)
    instance = {"name": INSTANCE, "substructure": f"{version.name}@{version.digest}"}
    spec = TreeSpec.read({"name": version.name, "instances": [instance]})
    parts = {INSTANCE: part}
    return Drawn(spec, parts, store.coupled(spec, parts))


def _tree_scene(store: Store, tree: Tree) -> Drawn:
    spec, parts = tree_parts(store, tree)
    with store.database.read() as connection:
        return Drawn(spec, parts, store.model(connection, tree))


def scene_of_part(store: Store, version: Version) -> str:
    """What there is to draw of a part, as JSON. Raises TooLarge."""
    return _scene(store, version.digest, lambda: _part_scene(store, version), f"{INSTANCE}.")


def scene_of_tree(store: Store, tree: Tree) -> str:
    """What there is to draw of a revision of a tree, as JSON. Raises TooLarge."""
    return _scene(store, tree.digest, lambda: _tree_scene(store, tree), "")


def _scene(store: Store, digest: str, find: Callable[[], Drawn], prefix: str) -> str:
    def make() -> str:
        """Names of a part without the name of the instance that it is drawn as."""
        drawn = find()
        check_size(Sources(drawn.model), ["kinematics"], 1, store.settings.limits)
        with np.errstate(all="ignore"):
            found = scene(drawn.spec, drawn.parts, drawn.model)
        if prefix:
            _renamed(found, prefix)
        return orjson.dumps(found).decode()

    return store.caches.pictures.once((digest, "scene"), make)


def _renamed(found: dict[str, Any], prefix: str) -> None:
    for kind, key in (("frames", "name"), ("joints", "coordinate"), ("bodies", "name"), ("loads", "name")):
        for each in found[kind]:
            each[key] = each[key].removeprefix(prefix)
    for frame in found["frames"]:
        frame["instance"] = ""
