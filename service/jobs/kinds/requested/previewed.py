"""What a document would become, before anything of it is stored."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np

from service.jobs.engines.engine import Outcome
from service.jobs.kinds.kind import Blobs
from service.jobs.kinds.requested.reported import INSTANCE
from service.schemas.jobs import ItemDocument
from substructures.documents import read_model
from substructures.part.definition import Definition
from substructures.part.derive import derive
from substructures.part.mass import mass_at_defaults
from substructures.part.part import Part
from substructures.pictures.tree import picture
from substructures.tree.couple import couple
from substructures.tree.document import TreeSpec


def preview_of(item: ItemDocument, _blobs: Blobs) -> Outcome:
    """``picture, dof, joints, mass, warnings`` of a ``definition``, or of a ``tree`` that brings its definitions along.
    Raises InvalidDocument, TooLarge."""
    spec, parts = _parts(item)
    model = couple(spec, parts, item["nodes"])
    masses = [mass_at_defaults(part.definition) for part in parts.values()]
    with np.errstate(all="ignore"):
        drawn = picture(spec, parts, model)
    told = {
        "picture": str(drawn),
        "dof": model.dof,
        "joints": model.joints,
        "mass": None if None in masses else sum(mass for mass in masses if mass is not None),
        "warnings": [dict(each) for part in parts.values() for each in part.certificate["warnings"]],
    }
    return Outcome(told)


def _parts(item: ItemDocument) -> tuple[TreeSpec, Mapping[str, Part]]:
    nodes = item["nodes"]
    if "tree" not in item:
        part = derive(read_model(Definition, item["definition"]), nodes)
        instance = {"name": INSTANCE, "substructure": part.name, "level": "full"}
        return TreeSpec.read({"name": part.name, "instances": [instance]}), {INSTANCE: part}
    spec = TreeSpec.read(item["tree"])
    return spec, {each.name: derive(each.definition, nodes) for each in spec.instances if each.definition is not None}


REQUESTED = {"preview": preview_of}
