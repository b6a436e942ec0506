"""Loads of a tree as loads of the part that it becomes."""

from __future__ import annotations

from typing import Any

from substructures.loads.document import Load
from substructures.loads.spring import TreeSpring
from substructures.loads.vectors import TreeForce, TreeTorque
from substructures.tree.published_names import PartNames

#: fields that are no numbers
WORDS = frozenset(("type", "axes"))


def load_of_part(load: Load, names: PartNames) -> dict[str, Any]:
    """The load of the part in place of one of the tree."""
    found: dict[str, Any] = {}
    for field, x in load.model_dump(by_alias=True, exclude_none=True).items():
        pointer = f"/loads/{getattr(load, 'name', '')}/{field}"
        if field == "coordinate":
            found[field] = names.symbol(*x.split("."))
        elif field in load.frames:
            found[field] = frames_of_part(x, "", names, pointer)
        elif field != "name":
            found[field] = x if field in WORDS else names.expressions("", x, pointer)
    match load:
        case TreeSpring():
            return found | {end: {"body": found[end], "at": found.pop(f"{end}_at")} for end in ("from", "to")}
        case TreeForce() | TreeTorque() if load.from_ == "world":
            # from outside of the part
            axes, _ = found.pop("axes"), found.pop("from")
            return found | {"body": found.pop("to"), "frame": "body" if axes == "to" else "world"}
    return found


def frames_of_part(given: Any, instance: str, names: PartNames, pointer: str) -> Any:
    """The frames of a load of an instance, or of the tree itself without one: as bodies of the part."""
    if isinstance(given, str):
        return names.own(instance, given)
    if isinstance(given, list | tuple):
        return [frames_of_part(x, instance, names, f"{pointer}/{i}") for i, x in enumerate(given)]
    point = {field: x for field, x in given.items() if field != "frame"}
    return {"frame": names.own(instance, given["frame"]), **names.expressions(instance, point, pointer)}
