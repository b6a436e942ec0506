"""Shipped parts coupled to a tree, exported with all quantities."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import Any

from catalogue_entries import open_entry
from made_once import coupled_once

from substructures import Definition, Model, TreeSpec, couple, derive
from substructures.export import Exported, exported_model, files, interface_of_model
from substructures.quantities.sources import Sources

LIMIT = 1_000_000
QUANTITIES = ("metric", "christoffel", "gravity", "kinematics", "potential_energy", "coriolis", "bias", "forces")
QUANTITIES += ("inverse_dynamics", "forward_dynamics", "kinetic_energy", "momentum", "total_momentum")


def tree_of(*parts: str) -> Model:
    instances = [{"name": f"i{k}", "substructure": name} for k, name in enumerate(parts)]
    tree = {"name": "demo", "gravity": [0, 0, "-9.81"], "instances": instances}
    return coupled_once(tree, {name: open_entry(name) for name in parts})


def derived_anew(*parts: str) -> Model:
    """The same, from nothing."""
    instances = [{"name": f"i{k}", "substructure": name} for k, name in enumerate(parts)]
    spec = TreeSpec.read({"name": "demo", "gravity": [0, 0, "-9.81"], "instances": instances})
    return couple(spec, {f"i{k}": derive(Definition.read(open_entry(name))) for k, name in enumerate(parts)})


def exported_of(model: Model, name: str = "demo", quantities: Sequence[str] = QUANTITIES, **options: Any) -> Exported:
    interface = interface_of_model(model, "demo@1", "sha256:1")
    return exported_model(Sources(model), interface, quantities, name, **options)


def write(exported: Exported, target: str, folder: Path) -> list[Path]:
    made = files(exported, target, LIMIT)
    for name, data in made.items():
        (folder / name).write_bytes(data)
    return [folder / name for name in made]
