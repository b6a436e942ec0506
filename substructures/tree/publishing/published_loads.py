"""Loads and closures of a tree as those of the part that it becomes."""

from __future__ import annotations

from typing import Any

from substructures.loads.document import OfTree
from substructures.part.definition import PartClosure
from substructures.tree.publishing.published_names import PartNames

#: fields that are no numbers
WORDS = frozenset(("type", "axes"))


def load_of_part(load: OfTree, names: PartNames) -> dict[str, Any]:
    """The load of the part in place of one of the tree."""
    found: dict[str, Any] = {}
    for field, x in load.model_dump(by_alias=True, exclude_none=True).items():
        pointer = f"/loads/{load.name}/{field}"
        if field == "coordinate":
            found[field] = names.symbol(*x.split("."))
        elif field in load.frames:
            found[field] = frames_of_part(x, "", names, pointer)
        elif field != "name":
            found[field] = x if field in WORDS else names.expressions("", x, pointer)
    return load.of_part(found)


def closure_of_part(closure: PartClosure, instance: str, names: PartNames, pointer: str) -> dict[str, Any]:
    """The closure of the part in place of one of an instance, or of the tree itself without one."""
    given = closure.model_dump(by_alias=True, exclude_defaults=True)
    numbers = {x: given[x] for x in given if x in ("placement", "length")}
    moved = names.expressions(instance, numbers, pointer)
    ends = {"from": names.own(instance, closure.from_), "to": names.own(instance, closure.to)}
    return {**given, **moved, **ends, "name": names.closures.new(*filter(None, (instance, closure.name)))}


def frames_of_part(given: Any, instance: str, names: PartNames, pointer: str) -> Any:
    """The frames of a load of an instance, or of the tree itself without one: as bodies of the part."""
    if isinstance(given, str):
        return names.own(instance, given)
    if isinstance(given, list | tuple):
        return [frames_of_part(x, instance, names, f"{pointer}/{i}") for i, x in enumerate(given)]
    point = {field: x for field, x in given.items() if field != "frame"}
    return {"frame": names.own(instance, given["frame"]), **names.expressions(instance, point, pointer)}
