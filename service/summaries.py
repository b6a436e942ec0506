"""What is stored beside the program of a tree."""

from __future__ import annotations

from substructures.documents import read_json, write_json
from substructures.model import Model
from substructures.tree import TreeSpec


def tree_summary(spec: TreeSpec, model: Model) -> bytes:
    """Canonical JSON: the summary of the model, with gravity and instances as they were given."""
    given = read_json(spec.canonical())
    shown = {"gravity": given.get("gravity", [0, 0, 0]), "instances": given.get("instances", [])}
    return write_json({**model.summary(), **shown})
