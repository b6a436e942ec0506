"""Trees with ball and floating joints in C and Python: q has places and quaternions, qd the rates."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import pytest
from exported_models import LIMIT, write
from run_code import agree, by_output, call_c, load_python, shared, state

from substructures import Model, couple, derive
from substructures.errors import InvalidDocument
from substructures.export import Exported, exported_model, files, interface_of_model
from substructures.quantities.numbers.evaluation import Sources

QUANTITIES = (
    "forward_dynamics",
    "metric",
    "christoffel",
    "forces",
    "bias",
    "kinetic_energy",
    "potential_energy",
    "position_rates",
    "position",
)


@pytest.fixture(scope="module")
def model() -> Model:
    inertia = {"xx": 1, "yy": 2, "zz": 3}
    hull: dict[str, Any] = {
        "name": "hull",
        "parent": "base",
        "mass": 2,
        "inertia": inertia,
        "joint": {"type": "floating"},
    }
    arm = {"name": "arm", "parent": "hull", "mass": 1, "com": [1, 0, 0], "inertia": inertia, "joint": {"type": "ball"}}
    wheel = {**arm, "name": "wheel", "parent": "arm", "joint": {"type": "revolute", "coordinate": "q", "d": 1}}
    tree = {"name": "t", "gravity": [0, 0, "-9.81"], "instances": [{"name": "x", "substructure": "sat"}]}
    return couple(tree, {"x": derive({"name": "sat", "bodies": [hull, arm, wheel]})})


def exported_of(model: Model) -> Exported:
    return exported_model(Sources(model), interface_of_model(model, "demo@1", "sha256:1"), QUANTITIES, "demo")


def test_functions_are_those_of_the_interpreter(model: Model, tmp_path: Path) -> None:
    exported = exported_of(model)
    assert [len(exported.interface.vectors[symbol]) for symbol in ("q", "qd", "qdd")] == [12, 10, 10]
    values = state(exported.interface)
    write(exported, "c", tmp_path)
    library = shared([tmp_path / "demo.c"])
    text = next(x for name, x in files(exported, "python", LIMIT).items() if name.endswith(".py"))
    module = load_python(text.decode() if isinstance(text, bytes) else text, tmp_path)
    for function in exported.functions:
        agree(call_c(library, exported, function, values), function, values)
        given = [[values[name] for name in function.vector(symbol).names] for symbol in function.arguments]
        called = getattr(module, exported.called(function))
        agree(by_output(function, called(*map(np.array, given))), function, values)


def test_an_fmu_is_refused(model: Model) -> None:
    with pytest.raises(InvalidDocument) as caught:
        files(exported_of(model), "fmu", LIMIT)
    assert caught.value.faults[0].code == "has-balls"
