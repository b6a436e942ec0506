"""Sensitivities to parameters against closed forms and differences."""

from __future__ import annotations

import numpy as np
import pytest
from analysis_models import catalogue_model, defaults, random_model, values_at
from random_trees import Plain, model_of, random_states
from simulated import simulated

from substructures import InvalidInput
from substructures.analysis.from_fields import sensitivity_arguments
from substructures.analysis.motion.parameter_sensitivity import sensitivities, sensitivity_formulas
from substructures.analysis.simulate import FixedStep
from substructures.expr.interpret import interpret

FINE: Plain = {"relative_tolerance": 1e-12, "absolute_tolerance": 1e-13}
H = 1e-4


@pytest.mark.parametrize("number", [1, 2, 4, 5])
def test_formulas_against_differences(number: int) -> None:
    """g, Gamma and Q of random trees by up to three of their parameters."""
    model = random_model(number)
    names = list(model.parameters)[:3]
    source = sensitivity_formulas(model, names)
    x = random_states(np.random.default_rng(number), 2, model.dof)
    found = interpret(source, values_at(model, x["q"], x["qd"]))
    for name in names:
        ends = []
        for h in (H, -H):
            values = values_at(model, x["q"], x["qd"]) | {name: defaults(model)[name] + h}
            ends.append(interpret(model.program, values, ["metric", "christoffel", "forces"]))
        for quantity in ends[0]:
            slope = (ends[0][quantity] - ends[1][quantity]) / (2 * H)
            scale = 1 + np.abs(slope).max()
            np.testing.assert_allclose(found[f"{quantity}:{name}"], slope, rtol=0, atol=1e-5 * scale)


def test_an_oscillator_by_its_stiffness_and_start() -> None:
    """x = cos w t, w = sqrt(k/m): dx/dk = -t sin(w t)/(2 w m)."""
    slide = {"type": "prismatic", "coordinate": "s", "stiffness": "k"}
    body = {"name": "b", "parent": "base", "joint": slide, "mass": 1}
    model = model_of({"name": "a", "bodies": [body], "parameters": {"k": {"value": 4}}}, (0, 0, 0))
    found = sensitivities(model, [1], (0, 3), **sensitivity_arguments(**FINE, by=["k"], of_start=True))
    t = found.t
    np.testing.assert_allclose(found.q[:, 0], np.cos(2 * t), atol=1e-10)
    np.testing.assert_allclose(found.series["d.k"][:, 0], -t * np.sin(2 * t) / 4, atol=1e-10)
    exact = np.array([[np.cos(2 * t), np.sin(2 * t) / 2], [-2 * np.sin(2 * t), np.cos(2 * t)]])
    np.testing.assert_allclose(found.series["d.start"], np.moveaxis(exact, 2, 0), atol=1e-10)


def test_a_force_that_depends_on_time() -> None:
    """s'' = p cos t: s = p (1 - cos t)."""
    body = {"name": "b", "parent": "base", "joint": {"type": "prismatic", "coordinate": "s"}, "mass": 1}
    loads = [{"type": "joint", "coordinate": "s", "force": "p*cos(t)"}]
    model = model_of({"name": "a", "bodies": [body], "loads": loads, "parameters": {"p": {"value": 2}}}, (0, 0, 0))
    name = next(iter(model.parameters))
    found = sensitivities(model, [0], (0, 2), [name], **sensitivity_arguments(count=5, **FINE))
    np.testing.assert_allclose(found.series[f"d.{name}"][:, 0], 1 - np.cos(found.t), atol=1e-10)


def test_a_driven_machine_against_differences() -> None:
    model = catalogue_model("furuta-pendulum")
    names = list(model.parameters)[:3]
    request: Plain = {"q": [0.1, 0.4], "span": [0, 1], "count": 3, **FINE}
    request["inputs"] = {f"tau.{model.coordinates[0]}": "sin(4*t)/100"}
    found = sensitivities(model, **sensitivity_arguments(**request, by=names))
    for name in names:
        value = defaults(model)[name]
        h = 1e-5 * max(abs(value), 1e-2)
        ends = [simulated(model, **request, parameters={name: value + s}) for s in (h, -h)]
        slope = (np.hstack([ends[0].q, ends[0].qd]) - np.hstack([ends[1].q, ends[1].qd])) / (2 * h)
        scale = np.abs(slope).max()
        np.testing.assert_allclose(found.series[f"d.{name}"], slope, rtol=0, atol=1e-4 * scale)


def test_what_is_refused() -> None:
    model = catalogue_model("double-pendulum")
    base: Plain = {"q": [0, 0], "span": [0, 1]}
    with pytest.raises(InvalidInput, match="unknown parameter") as error:
        sensitivity_formulas(model, ["x.nothing"])
    assert error.value.faults[0].pointer == "/parameters/0"
    with pytest.raises(InvalidInput, match="unknown quantity"):
        sensitivity_formulas(model, ["x.m1"], ["mass"])
    with pytest.raises(InvalidInput, match="depend on t only"):
        sensitivities(model, **sensitivity_arguments(**base, inputs={"tau.x.q1": "x.q2"}, by=["x.m1"]))
    with pytest.raises(InvalidInput) as error:
        sensitivities(model, **sensitivity_arguments(**base, method=FixedStep(0.1), by=["x.m1"]))
    assert [(f.pointer, f.code) for f in error.value.faults] == [("/method", "not-supported")]
    with pytest.raises(InvalidInput, match="unknown parameter") as error:
        sensitivities(model, **sensitivity_arguments(**base, by=["x.m1", "x.m9"]))
    assert error.value.faults[0].pointer == "/by/1"
