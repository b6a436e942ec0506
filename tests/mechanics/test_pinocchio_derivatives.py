"""Derivatives of inverse and forward dynamics beside Pinocchio's (J. Carpentier, N. Mansard, RSS 2018)."""

# ruff: noqa: N806 -- symbols of the notation

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
from in_depth import seeds
from random_trees import GRAVITY, Kind, Plain, model_of, random_definition, random_states

from substructures import Model
from substructures.quantities.derivative_directions import Direction
from substructures.quantities.numbers.evaluation import EvaluationOptions, evaluate

pin = pytest.importorskip("pinocchio", reason="Pinocchio is in the test extra (not on Windows)")
from pinocchio_trees import engine_of  # noqa: E402 -- the engine is optional


def pairs(number: int) -> tuple[Plain, Model]:
    rng = np.random.default_rng(6100 + number)
    while True:
        kind = Kind(5, chain=number % 3 == 0, massive=True, laws=False, loads=0, springs=0)
        definition = random_definition(rng, kind)
        model = model_of(definition)
        if model.dof:
            return definition, model


def jacobian(model: Model, quantity: str, state: Plain, along: Plain, inputs: Plain | None = None) -> Any:
    """Columns: derivatives along the directions, one for every state of a batch of equal states."""
    request = {key: np.tile(v, (model.dof, 1)) for key, v in state.items()} | {
        "inputs": inputs,
        "options": EvaluationOptions(along=Direction(**along)),
    }
    return evaluate(model, **(request | {"quantities": [quantity]}))[quantity].T


@pytest.mark.parametrize("number", seeds(4, 10))
def test_derivatives(number: int) -> None:
    definition, model = pairs(number)
    engine = engine_of(definition, GRAVITY)
    order = engine.order([c.removeprefix("x.") for c in model.coordinates])
    place, data, n = np.argsort(order), engine.model.createData(), model.dof
    x = {key: v[0] for key, v in random_states(np.random.default_rng(number), 1, n).items()}
    q, qd, qdd = (x[key][place] for key in ("q", "qd", "qdd"))
    ours = [jacobian(model, "inverse_dynamics_derivative", x, {field: np.eye(n)}) for field in ("q", "qd", "qdd")]
    dq, dqd, M = pin.computeRNEADerivatives(engine.model, data, q, qd, qdd)
    for found, expected in zip(ours, (dq, dqd, M), strict=True):
        close(found, expected[np.ix_(order, order)])
    tau = np.random.default_rng(number + 1).uniform(-1, 1, n)
    inputs = {f"tau.{name}": tau[a] for a, name in enumerate(model.coordinates)}
    state = {"q": x["q"], "qd": x["qd"]}
    effort = {"inputs": {f"tau.{name}": np.eye(n)[a] for a, name in enumerate(model.coordinates)}}
    directions: list[Plain] = [{"q": np.eye(n)}, {"qd": np.eye(n)}, effort]
    slopes = [jacobian(model, "forward_dynamics_derivative", state, along, inputs) for along in directions]
    for found, expected in zip(slopes, pin.computeABADerivatives(engine.model, data, q, qd, tau[place]), strict=True):
        close(found, expected[np.ix_(order, order)])


def close(found: Any, expected: Any) -> None:
    np.testing.assert_allclose(found, expected, rtol=0, atol=1e-9 * max(1, float(np.abs(expected).max())))
