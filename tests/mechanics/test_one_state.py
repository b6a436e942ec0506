"""Single states that were prepared for, beside :func:`evaluate` by the interpreter."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
from catalogue_entries import shipped_part

from substructures import TreeSpec, couple
from substructures.compile import compile_program
from substructures.quantities.numbers.evaluation import evaluate
from substructures.quantities.numbers.one_state import OneState, prepared
from substructures.quantities.quantity import QUANTITIES
from substructures.quantities.sources import Sources
from substructures.tree.model import Model

PLAIN = ["metric", "christoffel", "forces", "bias", "kinematics", "inverse_dynamics", "kinetic_energy", "momentum"]


def tree(name: str) -> Model:
    """One part of the catalogue."""
    spec = TreeSpec.read(
        {"name": "own", "gravity": [0, 0, "-9.81"], "instances": [{"name": "a", "substructure": name}]}
    )
    return couple(spec, {"a": shipped_part(name)})


def ready(model: Model, names: list[str] = PLAIN) -> OneState:
    """Prepared by compiled kernels."""
    found = prepared(Sources(model), names, compile_program)
    assert found is not None
    return found


@pytest.mark.parametrize("name", ["ur5", "cart-pendulum", "puma560"])
def test_states_one_after_the_other(name: str) -> None:
    model, rng = tree(name), np.random.default_rng(3)
    one = ready(model)
    for full in (True, False, True):
        q, qd, qdd = rng.uniform(-1, 1, (3, model.dof))
        given: dict[str, Any] = {"q": q.tolist(), "qdd": qdd.tolist()} | ({"qd": qd.tolist(), "t": 2} if full else {})
        found, expected = one.at(given | {"quantities": PLAIN}), evaluate(model, PLAIN, **given)
        assert found is not None
        shown, wanted = found.plain(), expected.plain()
        assert shown.keys() == wanted.keys()
        for key, value in wanted.items():
            if key not in PLAIN:
                assert shown[key] == value
            for field in QUANTITIES[key].fields or ("",) if key in PLAIN else ():
                a, b = (x[key][field] if field else x[key] for x in (shown, wanted))
                np.testing.assert_allclose(a, b, rtol=1e-12, atol=1e-12, err_msg=key)


@pytest.mark.parametrize(
    "given",
    [
        {},
        {"q": [0.1]},
        {"q": [0.1, 0.2, 0.3]},
        {"q": [[0.1, 0.2]]},
        {"q": [True, 0.2]},
        {"q": ["1", 0.2]},
        {"q": [0.1, None]},
        {"q": [0.1, float("nan")]},
        {"q": [0.1, 10**400]},
        {"q": {"a.q1": 0.1, "a.q2": 0.2}},
        {"q": [0.1, 0.2], "t": [0]},
        {"q": [0.1, 0.2], "parameters": {"a.m1": 2}},
        {"q": [0.1, 0.2], "packed": True},
    ],
)
def test_all_that_is_not_plain_is_left_to_evaluate(given: dict[str, Any]) -> None:
    assert ready(tree("acrobot"), ["metric"]).at(given) is None


def test_limits_that_are_left_are_left_to_evaluate() -> None:
    model = tree("scara")  # its slide: 0 to 0.21 m
    one = ready(model, ["metric"])
    inside, outside = [0.0, 0.0, 0.1, 0.0], [0.0, 0.0, 0.3, 0.0]
    assert one.at({"q": inside}) is not None
    assert any(each["code"] == "limits-left" for each in evaluate(model, "metric", q=outside).warnings)
    assert one.at({"q": outside}) is None


def test_results_that_are_not_finite_are_left_to_evaluate() -> None:
    one = ready(tree("cart-pendulum"), ["kinetic_energy"])
    assert one.at({"q": [0.0, 0.0], "qd": [1e200, 0.0]}) is None
    assert one.at({"q": [0.0, 0.0], "qd": [1.0, 0.0]}) is not None


@pytest.mark.parametrize("name", ["forward_dynamics", "forward_dynamics_derivative", "condition"])
def test_what_takes_more_than_kernels_is_not_prepared(name: str) -> None:
    assert prepared(Sources(tree("acrobot")), ["metric", name], compile_program) is None
