"""Trees of one part whose orbits are known."""

from __future__ import annotations

from typing import Any

from substructures import couple, derive
from substructures.tree.model import Model


def slider(name: str, parent: str, axis: list[int], **more: Any) -> dict[str, Any]:
    joint = {"type": "prismatic", "coordinate": name, "placement": {"position": [0, 0, 0]}, "axis": axis, **more}
    return {"name": f"body_{name}", "parent": parent, "joint": joint}


def tree_of(part: dict[str, Any] | str) -> Model:
    instance = {"name": "p", "substructure": part if isinstance(part, str) else part["name"]}
    return couple({"name": "one", "gravity": [0, 0, "-9.81"], "instances": [instance]}, {"p": derive(part)})
