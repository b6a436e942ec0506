"""Inputs and parameters that are declared and occur in no formula are accepted like all others, everywhere."""

from __future__ import annotations

from functools import cache
from typing import Any

import numpy as np
import pytest

from substructures import Definition, Model, TreeSpec, couple, derive, equilibria, evaluate, first_integrals, linearise
from substructures import simulate as motion
from substructures.analysis.control.adjoint import adjoint_equations
from substructures.analysis.control.cost_gradient import cost_gradient
from substructures.analysis.control.from_fields import control_arguments
from substructures.analysis.control.problem import Cost
from substructures.analysis.equations.perturbation import state_space
from substructures.analysis.motion.parameter_sensitivity import sensitivities, sensitivity_formulas
from substructures.analysis.stability.root_locus import root_locus
from substructures.errors import InvalidInput
from substructures.quantities.derivative_directions import Direction
from substructures.quantities.numbers.evaluation import EvaluationOptions

PENDULUM: dict[str, Any] = {
    "name": "pendulum",
    "parameters": {"l": {"value": 1, "unit": "m"}, "idle": {"value": 3, "unit": "kg"}},
    "inputs": {"wind": {"unit": "N"}},
    "bodies": [
        {
            "name": "rod",
            "parent": "base",
            "joint": {"type": "revolute", "coordinate": "q", "theta": "pi/2", "damping": 1},
            "mass": 1,
            "com": ["l", 0, 0],
        }
    ],
}


@cache
def _model() -> Model:
    tree = {"name": "t", "gravity": [0, 0, -10], "parameters": {"spare": {"value": 1}}}
    tree["instances"] = [{"name": "p", "substructure": "pendulum"}]
    return couple(TreeSpec.read(tree), {"p": derive(Definition.read(PENDULUM))})


PARAMETERS, INPUTS = {"p.idle": 5.0, "spare": 2.0}, {"p.wind": 7.0}
START = [0.2]


def test_they_are_listed() -> None:
    assert set(_model().parameters) == {"p.l", "p.idle", "spare"}
    assert dict(_model().inputs) == {"p.wind": {"unit": "N", "description": ""}}


def test_evaluations_take_them() -> None:
    given = {"q": START, "qd": [1.0], "parameters": PARAMETERS, "inputs": INPUTS}
    plain, found = evaluate(_model(), "forces", q=START, qd=[1.0]), evaluate(_model(), "forces", **given)
    assert np.array_equal(plain["forces"], found["forces"])
    slope = evaluate(
        _model(),
        "forward_dynamics_derivative",
        q=START,
        options=EvaluationOptions(along=Direction(inputs={"p.wind": 1.0})),
    )
    assert slope["forward_dynamics_derivative"] == [0.0]


@pytest.mark.parametrize("inputs", [INPUTS, {"p.wind": "sin(t) + spare"}])
def test_motions_take_them(inputs: Any) -> None:
    model = _model()
    plain = motion(model, START, (0, 0.5))
    found = motion(model, START, (0, 0.5), parameters=PARAMETERS, inputs=inputs)
    assert np.allclose(plain.q[-1], found.q[-1], rtol=0, atol=1e-9)
    result = sensitivities(model, START, (0, 0.5), by=["p.idle"], parameters=PARAMETERS)
    assert not np.any(result.series["d.p.idle"])


def test_linear_models_have_columns_of_zeros_for_them() -> None:
    found = linearise(_model(), [0.0], parameters=PARAMETERS, inputs=INPUTS, of_inputs=["p.wind", "tau.p.q"])
    assert found.B[1].tolist() == [0.0, 1.0]
    assert linearise(_model(), [0.0]).B.shape == (2, 2)
    assert state_space(_model(), (), ("p.wind",)).outputs["B"].entries == ()


def test_all_other_analyses_take_them() -> None:
    model = _model()
    assert equilibria(model, parameters=PARAMETERS, inputs=INPUTS).found
    assert root_locus(model, "p.idle", [1.0, 2.0], [-np.pi / 2]).status == "finished"
    assert first_integrals(model, ["p.wind"], ["spare"]).integrals is not None
    assert sensitivity_formulas(model, ["p.idle"], ["metric"]).outputs["metric:p.idle"].entries == ()
    assert adjoint_equations(model, ["p.wind"], Cost(running="p.wind^2"), ["spare"]).varied == ("spare",)
    given: dict[str, Any] = {"cost": Cost(terminal="p.q^2"), "parameters": PARAMETERS, "vary": ["p.idle"]}
    gradient = cost_gradient(
        model, **control_arguments(controls=["p.wind"], horizon=1.0, intervals=2, q=START, **given)
    )
    assert not np.any(gradient.controls)


@pytest.mark.parametrize("given", [{"parameters": {"p.nothing": 1.0}}, {"inputs": {"p.nothing": 1.0}}])
def test_what_is_not_declared_is_refused_with_candidates(given: Any) -> None:
    for run in (
        lambda: evaluate(_model(), "forces", q=START, **given),
        lambda: motion(_model(), START, (0, 1), **given),
    ):
        with pytest.raises(InvalidInput) as raised:
            run()
        (fault,) = raised.value.faults
        assert fault.pointer.endswith("/p.nothing")
        assert fault.code in ("unknown-parameter", "unknown-input")
        assert "p.idle" in fault.message or "p.wind" in fault.message
