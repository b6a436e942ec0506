"""Packed metric and Christoffel symbols, and results in single precision."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
from catalogue_entries import shipped_part

from substructures import TreeSpec, couple
from substructures.client import unpack
from substructures.compile import compile_program
from substructures.quantities.from_parts import NumericTree
from substructures.quantities.numbers.evaluation import EvaluationOptions, evaluate, evaluate_in_parts, interpreted
from substructures.quantities.sources import Sources
from substructures.tree.model import Model

NAMES = ["metric", "christoffel", "forces", "kinematics"]


def tree_of(*parts: tuple[str, str, str]) -> tuple[TreeSpec, dict[str, Any]]:
    instances = [{"name": name, "substructure": part, "at": at} for name, part, at in parts]
    spec = TreeSpec.read({"name": "t", "gravity": [0, 0, "-9.81"], "instances": instances})
    return spec, {name: shipped_part(part) for name, part, _ in parts}


#: a chain, and branches, between which nothing is coupled
CHAIN, BRANCHES = (("x", "puma560", "world"),), (("a", "planar-2r", "world"), ("b", "planar-2r", "world"))


@pytest.fixture(scope="module", params=[CHAIN, BRANCHES], ids=["chain", "branches"])
def given(request: pytest.FixtureRequest) -> tuple[Model, NumericTree]:
    spec, parts = tree_of(*request.param)
    return couple(spec, parts), NumericTree(spec, parts)


def independent(metric: Any, gamma: Any) -> tuple[list[Any], list[Any]]:
    """As the contract says it, in plain loops."""
    n = len(metric)
    return (
        [metric[a][b] for a in range(n) for b in range(a + 1)],
        [gamma[a][b][c] for c in range(n) for a in range(c) for b in range(c + 1)],
    )


def engines(model: Model, numeric: NumericTree) -> dict[str, Any]:
    def compiled(program: Any, values: Any, names: Any, _states: int, places: Any = None, /) -> Any:
        return compile_program(program, names).evaluate(values, threads=2, places=places or {})

    def parts(_program: Any, values: Any, names: Any, states: int, places: Any = None, /) -> Any:
        dense = numeric.answer({**{s.name: 0.0 for s in model.program.symbols}, **values}, names, states)
        return {n: x.reshape(states, -1)[:, places[n]] if n in (places or {}) else x for n, x in dense.items()}

    return {"interpreter": interpreted, "kernel": compiled, "parts": parts}


@pytest.mark.parametrize("engine", ["interpreter", "kernel", "parts"])
def test_packed_is_the_independent_elements(given: tuple[Model, NumericTree], engine: str) -> None:
    """Their order is that of the contract, and all others follow from them."""
    model, numeric = given
    evaluator, rng = engines(model, numeric)[engine], np.random.default_rng(3)
    q, qd = rng.uniform(-3, 3, (2, 11, model.dof))
    dense = evaluate(model, NAMES, q, qd)
    packed = evaluate(model, NAMES, q, qd, options=EvaluationOptions(packed=True, evaluator=evaluator))
    for k in range(11):
        metric, gamma = independent(dense["metric"][k], dense["christoffel"][k])
        np.testing.assert_allclose(packed["metric"][k], metric, rtol=1e-10, atol=1e-11)
        np.testing.assert_allclose(packed["christoffel"][k], gamma, rtol=1e-10, atol=1e-11)
    for name in ("metric", "christoffel"):
        np.testing.assert_allclose(unpack(name, packed[name], model.dof), dense[name], rtol=1e-10, atol=1e-11)
    np.testing.assert_allclose(packed["forces"], dense["forces"], rtol=1e-10, atol=1e-10)
    assert packed["kinematics"]["U"].shape == dense["kinematics"]["U"].shape


def test_one_state_and_no_state(given: tuple[Model, NumericTree]) -> None:
    model, _ = given
    n = model.dof
    one = evaluate(model, ["metric", "christoffel"], np.zeros(n), options=EvaluationOptions(packed=True, float32=True))
    assert one["metric"].shape == (n * (n + 1) // 2,)
    assert one["christoffel"].shape == (n * (n * n - 1) // 3,)
    assert one["metric"].dtype == np.float32
    assert evaluate(model, ["metric"], np.zeros((0, n)), options=EvaluationOptions(packed=True))["metric"].shape == (
        0,
        n * (n + 1) // 2,
    )


def test_unpack_refuses_what_does_not_fit() -> None:
    with pytest.raises(ValueError, match="3 elements are packed for 2 coordinates, found 4"):
        unpack("metric", np.zeros((5, 4)), 2)
    with pytest.raises(ValueError, match="'forces' is never packed"):
        unpack("forces", np.zeros(2), 2)
    assert unpack("christoffel", np.zeros((4, 0)), 1).tolist() == [[[[0.0]]]] * 4


def test_parts_are_the_whole(given: tuple[Model, NumericTree]) -> None:
    """Also where a state fails; warnings about values are told once."""
    model, _ = given
    q, qd = np.random.default_rng(4).uniform(-3, 3, (2, 23, model.dof))
    qd[[5, 17]] = 1e200
    names = ["metric", "bias", "kinetic_energy"]
    arguments: dict[str, Any] = {"q": q, "qd": qd, "parameters": {next(iter(model.parameters)): -1.0}}
    whole = evaluate(model, names, **arguments)
    parts = list(evaluate_in_parts(Sources(model), names, arguments, 10, told_first=True))
    assert [part.count for part in parts] == [10, 10, 3]
    for quantity in names:
        np.testing.assert_array_equal(np.concatenate([part[quantity] for part in parts]), whole[quantity])
    counted = [(x.state + 10 * k, x.quantity) for k, part in enumerate(parts) for x in part.failures]
    assert sorted(counted) == sorted((x.state, x.quantity) for x in whole.failures)
    assert {state for state, _ in counted} == {5, 17}
    assert [w for part in parts for w in part.warnings] == list(whole.warnings) != []


@pytest.mark.parametrize("engine", ["interpreter", "kernel"])
def test_single_precision(given: tuple[Model, NumericTree], engine: str) -> None:
    """Rounded once, and what has no number there is a failure."""
    model, numeric = given
    q = np.random.default_rng(5).uniform(-3, 3, (7, model.dof))
    tau = np.zeros(7)
    tau[4] = 1e39
    arguments: dict[str, Any] = {"q": q, "inputs": {f"tau.{model.coordinates[0]}": tau}}
    ways = [EvaluationOptions(float32=x, evaluator=engines(model, numeric)[engine]) for x in (False, True)]
    double, single = (evaluate(model, ["metric", "forces"], **arguments, options=way) for way in ways)
    np.testing.assert_array_equal(single["metric"], double["metric"].astype(np.float32))
    assert double.failures == ()
    assert [(x.state, x.quantity, x.code) for x in single.failures] == [(4, "forces", "overflow")]
