"""Loads of a tree as loads of the part that it becomes."""

from __future__ import annotations

from typing import Any

from substructures.tree.load_document import TreeForce, TreeFriction, TreeJointLoad, TreeLoad, TreeSpring, TreeTorque
from substructures.tree.published_names import PartNames

#: fields that are no numbers
WORDS = frozenset(("name", "type", "from", "to", "axes", "coordinate"))


def load_of_part(load: TreeLoad, names: PartNames) -> dict[str, Any]:
    """The load of the part in place of one of the tree."""
    plain = load.model_dump(by_alias=True, exclude_none=True)
    read = {
        field: names.expressions("", value, f"/loads/{load.name}/{field}")
        for field, value in plain.items()
        if field not in WORDS
    }
    match load:
        case TreeJointLoad() | TreeFriction():
            instance, name = load.coordinate.split(".")
            return {"type": load.type, "coordinate": names.symbol(instance, name), **read}
        case TreeSpring():
            ends = {end: {"body": names.frame(plain[end]), "at": read.pop(f"{end}_at")} for end in ("from", "to")}
            return {"type": load.type, **ends, **read}
        case TreeForce() | TreeTorque() if load.from_ == "world":
            # from outside of the part
            frame = "body" if load.axes == "to" else "world"
            return {"type": load.type, "body": names.frame(load.to), "frame": frame, **read}
    words: dict[str, Any] = {field: x for field, x in plain.items() if field == "axes"}
    words |= {field: names.frame(x) for field, x in plain.items() if field in ("from", "to")}
    return {"type": load.type, **words, **read}
