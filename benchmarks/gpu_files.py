"""The exported CUDA of a Puma 560, an iiwa and the humanoid, states, and reference values of the interpreter.

``python -m benchmarks.gpu_files FOLDER``, then ``python benchmarks/gpu.py FOLDER`` on a machine with a GPU.
"""

from __future__ import annotations

import json
import sys
from pathlib import Path
from typing import Any

import numpy as np

from benchmarks.derive import humanoid
from substructures import Definition, TreeSpec, catalogue, couple, derive
from substructures.export import exported_model, files, interface_of_model
from substructures.expr.interpret import interpret
from substructures.quantities.sources import Sources

#: states with reference values
COMPARED = 64
QUANTITIES = ("metric", "christoffel", "inverse_dynamics", "forward_dynamics")


def make(folder: Path) -> None:
    """The files of a Puma 560, an iiwa and the humanoid."""

    folder.mkdir(parents=True, exist_ok=True)
    models = {}
    for name, part in (("puma", "puma560"), ("iiwa", "kuka-iiwa-14")):
        spec = TreeSpec.read(
            {"name": name, "gravity": [0, 0, "-9.81"], "instances": [{"name": "r", "substructure": part}]}
        )
        models[name] = couple(spec, {"r": derive(Definition.read(catalogue.load(part)))})
    spec, library = humanoid()
    models["humanoid"] = couple(spec, {i.name: derive(library[str(i.substructure)]) for i in spec.instances})
    described = []
    for name, model in models.items():
        exported = exported_model(Sources(model), interface_of_model(model), QUANTITIES, name)
        (folder / f"{name}.cu").write_bytes(files(exported, "cuda", 1_000_000)[f"{name}.cu"])
        rng = np.random.default_rng(1)
        vectors = exported.interface.vectors
        for function in exported.functions:
            given = {s: rng.uniform(-2, 2, (len(vectors[s]), COMPARED)) for s in function.arguments if s != "p"}
            values: dict[str, Any] = dict(zip(vectors["p"].names, vectors["p"].defaults, strict=True))
            for symbol, rows in given.items():
                values |= dict(zip(vectors[symbol].names, rows, strict=True))
            wanted = interpret(function.program, values)
            called = exported.called(function)
            saved = {f"in_{s}": x for s, x in given.items()} | {"in_p": np.array(vectors["p"].defaults)}
            saved |= {f"out_{n}": np.moveaxis(x, 0, -1) for n, x in wanted.items()}
            np.savez(folder / f"{called}.npz", **saved)
            outputs = {n: list(o.shape) for n, o in function.program.outputs.items()}
            row = {"model": name, "called": called, "arguments": function.arguments, "outputs": outputs}
            described.append(row | {"operations": function.program.count()["total"]})
    (folder / "functions.json").write_text(json.dumps(described))


if __name__ == "__main__":
    make(Path(sys.argv[1]))
