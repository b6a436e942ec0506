"""Parts and models come back from bytes as they were, and every process makes the same bytes."""

from __future__ import annotations

import json
import subprocess
import sys
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from random_trees import GRAVITY

from substructures import Definition, Model, Part, TreeSpec, couple, derive
from substructures.documents import write_json
from substructures.quantities.numbers.evaluation import evaluate

from .samples import COUNT, SEEDS, flat, pair, request_for


@pytest.mark.parametrize("seed", SEEDS)
def test_round_trips_of_storage(seed: int) -> None:
    """Part and model come back from bytes with the same digest, and couple and evaluate to the same numbers."""
    _, symbolic = pair(seed, 0.5)
    part = derive(Definition.read(symbolic))
    stored = json.loads(json.dumps(dict(part.certificate)))
    again = Part.load(Definition.read(json.loads(part.definition.canonical())), part.program.to_bytes(), stored)
    assert again.program == part.program
    assert again.program.digest == part.program.digest
    assert again.definition.digest == part.definition.digest
    assert again.formulas() == part.formulas()
    assert again.operations == part.operations
    one = {"name": "x", "substructure": "random"}
    spec = TreeSpec.read({"name": "tree", "gravity": list(GRAVITY), "instances": [one]})
    model, other = couple(spec, {"x": part}), couple(spec, {"x": again})
    assert model.program.to_bytes() == other.program.to_bytes()
    loaded = Model.load(json.loads(write_json(model.summary())), model.program.to_bytes())
    assert loaded.program.digest == model.program.digest
    assert loaded.coordinates == model.coordinates
    assert loaded.operations == model.operations
    request = request_for(model, seed)
    for name, x in flat(evaluate(model, **request)).items():
        assert np.array_equal(flat(evaluate(loaded, **request))[name], x), name


def test_the_index_of_stored_formulas() -> None:
    """Quantity, body, coordinate, shape, symmetry and operations of formulas of a crane: a mast, a universal joint."""
    joints = [("mast", "base", "revolute", "q1"), ("boom", "mast", "universal", ["a", "b"])]
    bodies = [
        {"name": name, "parent": parent, "joint": {"type": kind, "coordinate": coordinate, "d": 1}, "mass": 1}
        for name, parent, kind, coordinate in joints
    ]
    ports = [{"name": "hook", "body": "boom", "position": [2, 0, 0]}]
    part = derive(Definition.read({"name": "crane", "bodies": bodies, "ports": ports}))
    found = {(f.output, f.index): f for f in part.formulas()}
    places = {
        ("U", (1, 0)): ("U", "boom", "q1", (3,), "none"),
        ("Omega", (2, 2)): ("Omega", "boom", "b", (3,), "none"),
        ("kappa", (0, 2)): ("kappa", "boom", "q1", (3,), "none"),
        ("F", (1, 2)): ("F", "boom", "a", (3,), "none"),
        ("R", (0,)): ("R", "mast", None, (3, 3), "none"),
        ("subtree.J", (2,)): ("subtree", "boom", None, (3, 3), "none"),
        ("port.r", (0,)): ("port", "hook", None, (3,), "none"),
        ("port.Omega", (0, 1)): ("port", "hook", "a", (3,), "none"),
        ("metric", (0, 2)): ("metric", None, "q1", (), "symmetric"),
        ("christoffel", (0, 1, 2)): ("christoffel", None, "q1", (), "christoffel"),
        ("composite.m", ()): ("composite", None, None, (), "none"),
    }
    for place, expected in places.items():
        f = found[place]
        assert (f.quantity, f.body, f.coordinate, f.shape, f.symmetry) == expected, place
    assert found["subtree.m", (0,)].operations == 1
    assert part.labels("mover") is part.labels("mover")  # found once for all formulas
    elements = {(name, i) for name, output in part.program.outputs.items() for i in output.index}
    lists = ("tilt", "turn", "full", "frame.", "load.")
    covered = {(f.output, i) for f in found.values() for _, i in elements if i[: len(f.index)] == f.index}
    assert {(name, i) for name, i in elements if not any(x in name for x in lists)} == elements & covered


SCRIPT = """
import json, sys
from substructures import Definition, TreeSpec, couple, derive
for text in sys.stdin:
    definition = json.loads(text)
    part = derive(Definition.read(definition))
    one = {"name": "x", "substructure": "random"}
    other = {"name": "y", "substructure": "random", "at": "x.port_base", "placement": {"rpy": [0.1, 0, 2]}}
    tree = {"name": "tree", "gravity": [0.71, -2.3, -9.3], "instances": [one, other]}
    model = couple(TreeSpec.read(tree), {"x": part, "y": part})
    print(part.definition.digest, part.program.digest, model.program.digest)
"""


# takes seconds: new processes import and derive everything
def test_digests_are_the_same_in_every_process() -> None:
    """Fingerprints are drawn anew in every process; nothing of them may show in what is stored."""
    lines = [write_json(pair(seed, [0, 0.5, 1][seed % 3])[1]) for seed in range(COUNT)]
    runs = [
        subprocess.run(
            [sys.executable, "-c", SCRIPT],
            input=b"\n".join(lines),
            capture_output=True,
            check=True,
            cwd=Path(__file__).parents[2],
        ).stdout
        for _ in range(2)
    ]
    assert runs[0].count(b"sha256:") == 3 * len(lines)
    assert runs[0] == runs[1]


@pytest.mark.parametrize("seed", SEEDS)
def test_the_order_of_keys_does_not_show(seed: int) -> None:
    """Equal documents have equal digests, and so have their programs."""

    def turned(data: Any) -> Any:
        if isinstance(data, dict):
            return {key: turned(data[key]) for key in reversed(data)}
        return [turned(x) for x in data] if isinstance(data, list) else data

    definition = pair(seed, 0.5)[1]
    parameters = definition["parameters"]
    one = {"name": "x", "substructure": "random", "parameters": {name: f"2*{name}" for name in parameters}}
    tree = {"name": "tree", "gravity": list(GRAVITY), "parameters": parameters, "instances": [one]}
    found = set()
    for version, spec in ((definition, tree), (turned(definition), turned(tree))):
        part, read = derive(Definition.read(version)), TreeSpec.read(spec)
        model = couple(read, {"x": part})
        found.add((part.definition.digest, part.program.digest, read.digest, model.program.digest))
    assert len(found) == 1
