"""Variables of FMUs: each has a name of its own, and outputs have derivatives by all that is known."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import pytest
from closed_trees import tree_model

from substructures.export import exported_model, files, interface_of_model
from substructures.quantities.sources import Sources

fmpy = pytest.importorskip("fmpy", reason="the wheel FMPy is not installed")
from fmpy.validation import validate_fmu  # noqa: E402

from .fmu_instances import instance  # noqa: E402


def written(target: str, folder: Path) -> Path:
    """Of a tree whose symbols are called as variables are that every FMU has, with forces of all that is known."""
    slide = {"type": "prismatic", "d": 0}
    bodies = [
        {"name": "a", "parent": "base", "joint": {**slide, "coordinate": "x"}, "mass": "x_d"},
        {"name": "b", "parent": "a", "joint": {**slide, "coordinate": "y_d"}, "mass": 2},
        {"name": "c", "parent": "b", "joint": {**slide, "coordinate": "y"}, "mass": 3},
    ]
    law = {"type": "joint", "coordinate": "x", "force": "x_dd*sin(3*t)*cos(x) - k*x'"}
    own = {"x_d": {"value": 1.5}, "k": {"value": 0.5}}
    part = {"name": "p", "bodies": bodies, "parameters": own, "inputs": {"x_dd": {"default": 2}}, "loads": [law]}
    parameters = {name: {"value": 2} for name in ("time", "metric", "solver_step")}
    instances = [{"name": "a", "substructure": "p", "parameters": {"k": "time*metric*solver_step/8"}}]
    model = tree_model({"gravity": [0, 0, -9.81], "parameters": parameters, "instances": instances}, {"p": part})
    quantities = ("forward_dynamics", "metric", "kinetic_energy")
    exported = exported_model(Sources(model), interface_of_model(model, "demo@1", "sha256:1"), quantities, "demo")
    path = folder / "demo.fmu"
    path.write_bytes(files(exported, target, 10**6)["demo.fmu"])
    return path


@pytest.mark.parametrize("target", ["fmu", "fmu2"])
def test_names_are_different(target: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("substructures.export.fmu.libraries", lambda *_: {})  # nothing is run
    path = written(target, tmp_path)
    assert validate_fmu(str(path)) == []
    told = {each.name: each for each in fmpy.read_model_description(str(path)).modelVariables}
    starts = {"parameter.a.x_d": 1.5, "a.x_dd": 2, "parameter.time": 2, "parameter.solver_step": 2, "metric": 2}
    assert {name: float(told[name].start) for name in starts} == starts
    assert float(told["solver_step"].start) == 0
    assert {told[name].causality for name in ("a.x_d", "a.y_d", "velocity.a.y_d")} == {"output"}
    assert told["der(velocity.a.y_d)"].derivative.name == "velocity.a.y_d"


def test_directional_derivatives_are_of_all_outputs_by_all_knowns(tmp_path: Path) -> None:
    """States are outputs, and time and parameters are known: a central difference says the same."""
    known = {"time": 0.3, "a.x": 0.4, "a.x_d": -0.7, "a.x_dd": 1.1, "parameter.a.x_d": 1.3, "parameter.time": 2.0}
    unknown = ["a.x", "a.x_d", "a.y", "der(a.x)", "der(a.x_d)", "kinetic_energy"]
    seed, h = np.arange(1.0, 7.0), 1e-5
    with instance(written("fmu", tmp_path), "ModelExchange") as (one, at):

        def values(step: float) -> Any:
            moved = [x + step * d for x, d in zip(known.values(), seed, strict=True)]
            one.setTime(moved[0])
            one.setFloat64([at[name] for name in known][1:], moved[1:])
            return np.array(one.getFloat64([at[name] for name in unknown]))

        expected = (values(h) - values(-h)) / (2 * h)
        values(0)
        places = [at[name] for name in unknown], [at[name] for name in known]
        found = one.getDirectionalDerivative(*places, list(seed), len(unknown))
    assert np.count_nonzero(expected) == 5
    np.testing.assert_allclose(found, expected, rtol=1e-8, atol=1e-9)
