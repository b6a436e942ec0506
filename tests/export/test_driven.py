"""Trees with given motions in C, Python and as FMUs: their functions have the time and the inputs, too."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import pytest
from closed_trees import tree_model
from exported_models import LIMIT, write
from run_code import agree, by_output, call_c, load_python, shared, state
from simulated import simulated

from substructures import Model, catalogue
from substructures.export import Exported, exported_model, files, interface_of_model
from substructures.export.exported import Function
from substructures.quantities.sources import Sources

fmpy = pytest.importorskip("fmpy", reason="the wheel FMPy is not installed")
from fmpy.validation import validate_fmu  # noqa: E402

QUANTITIES = ("forward_dynamics", "metric", "christoffel", "forces", "bias", "g_a0", "g_00", "Gamma_ab0", "Gamma_a00")
QUANTITIES += ("T_2", "T_1", "T_0", "drive_forces", "kinetic_energy", "potential_energy", "position", "U_0")
LAW = "A*cos(w*t) + step(t, 1, 1)"
GIVEN: dict[str, Any] = {"law": LAW, "input": {"input": True}}


@pytest.fixture(scope="module", params=GIVEN)
def model(request: pytest.FixtureRequest) -> Model:
    parameters = {"A": {"value": 0.2, "unit": "m"}, "w": {"value": 5, "unit": "rad/s"}}
    instances = [
        {"name": "cart", "substructure": "cart-pendulum"},
        {"name": "arm", "substructure": "acrobot", "at": "cart.bob"},
    ]
    tree = {"gravity": [0, 0, "-9.81"], "parameters": parameters, "instances": instances}
    definitions = {name: catalogue.load(name) for name in ("cart-pendulum", "acrobot")}
    return tree_model(tree | {"driven": {"cart.q0": GIVEN[request.param]}}, definitions)


def exported_of(model: Model) -> Exported:
    return exported_model(Sources(model), interface_of_model(model, "demo@1", "sha256:1"), QUANTITIES, "demo")


def arguments_of(function: Function, values: dict[str, float]) -> list[Any]:
    given = [[values[name] for name in function.vector(symbol).names] for symbol in function.arguments]
    return [x[0] if symbol == "t" else np.array(x) for symbol, x in zip(function.arguments, given, strict=True)]


def test_functions_are_those_of_the_interpreter(model: Model, tmp_path: Path) -> None:
    exported = exported_of(model)
    values = state(exported.interface)
    write(exported, "c", tmp_path)
    library = shared([tmp_path / "demo.c"])
    text = next(x for name, x in files(exported, "python", LIMIT).items() if name.endswith(".py"))
    module = load_python(text.decode() if isinstance(text, bytes) else text, tmp_path)
    for function in exported.functions:
        assert {"u", *(["t"] if exported.interface.has_time else [])} <= set(function.arguments)
        agree(call_c(library, exported, function, values), function, values)
        called = getattr(module, exported.called(function))
        agree(by_output(function, called(*arguments_of(function, values))), function, values)


def test_simulated_as_an_fmu_it_moves_as_here(model: Model, tmp_path: Path) -> None:
    path = tmp_path / "model.fmu"
    path.write_bytes(files(exported_of(model), "fmu", LIMIT)["demo.fmu"])
    assert validate_fmu(str(path)) == []
    names = [v.name for v in fmpy.read_model_description(str(path)).modelVariables]
    coordinates = list(model.coordinates)
    options: dict[str, Any] = {
        "start_values": {coordinates[0]: 0.3},
        "output": coordinates,
        "relative_tolerance": 1e-10,
    }
    inputs = {}
    if "cart.q0" in model.inputs:
        given = ["cart.q0", "cart.q0_d", "cart.q0_dd"]
        assert set(given) <= set(names)
        t = np.linspace(0, 0.5, 2001)
        rows = np.array([t, 0.1 * t**2, 0.2 * t, np.full(len(t), 0.2)]).T
        options["input"] = np.array([tuple(x) for x in rows], dtype=[(n, float) for n in ("time", *given)])
        inputs = {"cart.q0": "0.1*t^2", "cart.q0'": "0.2*t", "cart.q0''": 0.2}
    found = fmpy.simulate_fmu(str(path), fmi_type="ModelExchange", stop_time=0.5, output_interval=0.1, **options)
    ours = simulated(
        model, q=[0.3, *[0.0] * (model.dof - 1)], span=(0, 0.5), times=found["time"], inputs=inputs,
        relative_tolerance=1e-11, absolute_tolerance=1e-12,
    )  # fmt: skip
    shown = np.stack([found[each] for each in coordinates], axis=1)
    assert np.abs(shown - ours.q).max() <= 1e-6 * np.abs(ours.q).max()
