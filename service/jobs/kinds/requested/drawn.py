"""Pictures and scenes of parts and trees, drawn by runners for requests.

An item names its subject as those of :mod:`service.jobs.kinds.requested.shown` do, trees with their parts.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np
import orjson

from service.jobs.engines.engine import Outcome
from service.jobs.kinds.assemble import tree_parts
from service.jobs.kinds.decoded import model_of, part_of
from service.jobs.kinds.kind import Blobs
from service.jobs.kinds.requested.reported import INSTANCE
from service.schemas.jobs import ItemDocument
from substructures.part.part import Part
from substructures.pictures.scene import scene
from substructures.pictures.tree import picture
from substructures.tree.couple import couple
from substructures.tree.document import TreeSpec
from substructures.tree.model import Model


@dataclass(frozen=True, slots=True)
class _Drawn:
    spec: TreeSpec
    parts: Mapping[str, Part]
    model: Model


def _subject(item: ItemDocument, blobs: Blobs) -> _Drawn:
    """A tree, or a part alone, mounted on the world. Raises TooLarge."""
    if "substructure" not in item:
        return _Drawn(*tree_parts(item["parts"], blobs), model_of(item, blobs))
    name, _, digest = item["substructure"].partition("@")
    parts = {INSTANCE: part_of(digest, item["program"], blobs)}
    one = {"name": INSTANCE, "substructure": item["substructure"], "level": "full"}  # as the formulas of the part
    spec = TreeSpec.read({"name": name, "instances": [one]})
    return _Drawn(spec, parts, couple(spec, parts, item["nodes"]))


def picture_of(item: ItemDocument, blobs: Blobs) -> Outcome:
    """File ``svg``: the picture in the pose of ``q``, by default the standard one."""
    found = _subject(item, blobs)
    with np.errstate(all="ignore"):  # defaults of any size may be stored; what is not finite is not drawn
        svg = picture(found.spec, found.parts, found.model, item["q"])
    return Outcome(files={"svg": svg.encode()})


def scene_of(item: ItemDocument, blobs: Blobs) -> Outcome:
    """File ``json``: what there is to draw; names of a part without the name of the instance that it is drawn as."""
    found = _subject(item, blobs)
    with np.errstate(all="ignore"):
        told = scene(found.spec, found.parts, found.model)
    if "substructure" in item:
        _rename(told, f"{INSTANCE}.")
    return Outcome(files={"json": orjson.dumps(told)})


def _rename(told: dict[str, Any], prefix: str) -> None:
    for kind, key in (("frames", "name"), ("joints", "coordinate"), ("bodies", "name"), ("loads", "name")):
        for each in told[kind]:
            each[key] = each[key].removeprefix(prefix)
    told["positions"] = [name.removeprefix(prefix) for name in told["positions"]]
    for frame in told["frames"]:
        frame["instance"] = ""


REQUESTED = {"picture": picture_of, "scene": scene_of}
