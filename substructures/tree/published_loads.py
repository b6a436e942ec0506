"""Loads of a tree as loads of the part that it becomes, as far as a part can have them."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from substructures.errors import InvalidDocument
from substructures.part.part import Part
from substructures.tree.load_document import (
    TreeForce,
    TreeJointLoad,
    TreeLoad,
    TreePotential,
    TreeSpring,
    TreeTorque,
)
from substructures.tree.published_names import PartNames


def load_of_part(load: TreeLoad, names: PartNames, parts: Mapping[str, Part]) -> list[dict[str, Any]]:
    """The loads of the part in place of one of the tree. Raises InvalidDocument with its name where there are none."""
    pointer = f"/loads/{load.name}"
    plain = load.model_dump(by_alias=True)

    def read(name: str) -> Any:
        """A field with the names of the part."""
        return names.expressions("", plain[name], f"{pointer}/{name}")

    match load:
        case TreeJointLoad():
            instance, name = load.coordinate.split(".")
            return [{"type": "joint", "coordinate": names.symbol(instance, name), "force": read("force")}]
        case TreePotential():
            return [{"type": "potential", "potential": read("potential")}]
        case TreeSpring():
            ends = {end: {"body": names.frame(plain[end], parts), "at": read(f"{end}_at")} for end in ("from", "to")}
            return [{"type": "spring", **ends, **{x: read(x) for x in ("stiffness", "damping", "length")}}]
        case TreeForce() | TreeTorque() if load.from_ == "world":
            frame = "body" if load.axes == "to" else "world"
            acting = {"type": load.type, "body": names.frame(load.to, parts), "vector": read("vector"), "frame": frame}
            return [acting | ({"at": read("at")} if isinstance(load, TreeForce) else {})]
        case TreeTorque() if load.axes == "world":
            on, back = read("vector"), [f"-({x})" for x in map(str, read("vector"))]
            return [
                {"type": "torque", "body": names.frame(place, parts), "vector": vector, "frame": "world"}
                for place, vector in ((load.to, on), (load.from_, back))
            ]
    message = f"the load '{load.name}' ({load.type}) between two frames is none that a part can have: leave it to the"
    raise InvalidDocument.at(pointer, "no-load-of-part", f"{message} trees that the part comes into")
