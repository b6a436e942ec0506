"""Forward dynamics as formulas: inverse of inverse dynamics, against Cholesky's factors, singular metrics."""

# ruff: noqa: N806 -- symbols of the notation

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
from in_depth import seeds
from random_trees import GRAVITY, Kind, Plain, model_of, random_definition, random_states

from substructures import InvalidDocument, Model, TooLarge, catalogue
from substructures.compile import compile_program
from substructures.expr.graph import Graph
from substructures.expr.interpret import interpret
from substructures.mechanics.accelerations import cholesky_solve
from substructures.mechanics.factorisation import factor_operations, factorised
from substructures.quantities.derivative_directions import Direction
from substructures.quantities.derivatives import SingularMetric, forward_dynamics
from substructures.quantities.formulas import DERIVED, derived
from substructures.quantities.numbers.evaluation import EvaluationOptions, evaluate
from substructures.quantities.sources import Sources, cost

N = 5
Q: Plain = {"quantities": ["forward_dynamics"]}


def random_model(number: int) -> Model:
    rng = np.random.default_rng(5200 + number)
    joints = ("revolute", "prismatic", "fixed", "spherical", "free")
    while True:
        definition = random_definition(rng, Kind(5, chain=number % 3 == 0, joints=joints, massive=True))
        if any("coordinate" in b["joint"] for b in definition["bodies"]):
            return model_of(definition)


@pytest.mark.parametrize("number", seeds(4, 12))
def test_inverse_of_inverse_dynamics(number: int) -> None:
    """ID(q, q', FD) = 0, and FD of tau = ID(q'') with Q without tau is q''."""
    model = random_model(number)
    x = random_states(np.random.default_rng(number), N, model.dof)
    rest = {"q": x["q"], "qd": x["qd"], "t": 0.3}
    answer = evaluate(model, **(rest | {"quantities": ["forward_dynamics", "metric", "bias", "forces"]}))
    assert not answer.failures
    expected = cholesky_solve(answer["metric"], answer["forces"] - answer["bias"])
    condition = np.linalg.cond(answer["metric"]).max()
    tolerance = 1e-14 * condition * np.abs(expected).max()
    np.testing.assert_allclose(answer["forward_dynamics"], expected, rtol=0, atol=tolerance)
    needed = evaluate(model, **(x | {"quantities": ["inverse_dynamics"], "t": 0.3}))["inverse_dynamics"]
    tau = {f"tau.{name}": needed[:, a] for a, name in enumerate(model.coordinates)}
    back = evaluate(model, **(rest | Q | {"inputs": tau}))["forward_dynamics"]
    np.testing.assert_allclose(back, x["qdd"], rtol=0, atol=1e-13 * condition * max(1, np.abs(needed).max()))


def test_compiled_equals_interpreted() -> None:
    model = random_model(3)
    program = derived(model, "forward_dynamics")
    rng = np.random.default_rng(0)
    values = {s.name: rng.uniform(-1, 1, 33) for s in program.symbols}
    found = compile_program(program, ["forward_dynamics"]).evaluate(values)["forward_dynamics"]
    request = {
        "q": np.stack([values[c] for c in model.coordinates], axis=1),
        "qd": np.stack([values[f"{c}'"] for c in model.coordinates], axis=1),
        "inputs": {s.name: values[s.name] for s in program.symbols if s.kind == "input"},
        "t": values.get("t", 0),
    }
    expected = evaluate(model, **(Q | request))["forward_dynamics"]
    np.testing.assert_allclose(found, expected, rtol=1e-9, atol=1e-9 * np.abs(expected).max())


def test_factors_over_numbers_and_zeros_between_branches() -> None:
    """L^T D L = g; a metric of two branches on a common base has no entries between them in L either."""
    rng = np.random.default_rng(1)
    A = rng.uniform(-1, 1, (4, 4))
    g = A @ A.T + np.eye(4)
    g[2, 3] = g[3, 2] = 0
    entries = {(i, k): float(g[i, k]) for k in range(4) for i in range(k + 1) if g[i, k]}
    factors = factorised(4, entries)
    L = np.eye(4)
    for k, row in enumerate(factors.below):
        L[k, list(row)] = list(row.values())
    assert L[3, 2] == 0
    np.testing.assert_allclose(L.T @ np.diag(factors.pivots) @ L, g, atol=1e-14)
    np.testing.assert_allclose(factors.solve([1.0, 2.0, 3.0, 4.0]), np.linalg.solve(g, [1, 2, 3, 4]))
    assert factor_operations(4, entries) < factor_operations(4, [(i, k) for k in range(4) for i in range(k + 1)])


def test_singular_in_one_state_is_one_failure() -> None:
    """A gimbal without inertia about its own axes loses a direction where two axes coincide."""
    joint = {"type": "spherical", "coordinate": ["a", "b", "c"]}
    body = {"mass": 1, "inertia": {"xx": 1, "yy": 1, "zz": 1}}
    model = model_of({"name": "ball", "bodies": [{"name": "x", "parent": "base", "joint": joint, **body}]})
    pitch = np.array([0.3, np.pi / 2, -0.3])
    answer = evaluate(model, **(Q | {"q": np.stack([pitch, pitch, pitch], axis=1), "qd": np.ones((3, 3))}))
    (failure,) = answer.failures
    assert (failure.state, failure.code) == (1, "not-finite")
    assert "singular" in failure.message
    assert np.isnan(answer["forward_dynamics"][1]).all()
    assert np.isfinite(answer["forward_dynamics"][[0, 2]]).all()


def massless() -> Model:
    joints: list[Plain] = [
        {"type": "prismatic", "coordinate": "x"},
        {"type": "prismatic", "coordinate": "y", "theta": 1},
    ]
    bodies = [{"name": "a", "parent": "base", "joint": joints[0], "mass": 1}]
    return model_of({"name": "m", "bodies": [*bodies, {"name": "b", "parent": "a", "joint": joints[1]}]})


def test_singular_in_every_state() -> None:
    """Advice for every state; as formulas a refusal."""
    model = massless()
    with pytest.raises(SingularMetric, match="singular"):
        derived(model, "forward_dynamics")
    quantities = ["forward_dynamics", "forward_dynamics_derivative", "metric"]
    request = {"quantities": quantities, "q": np.zeros((2, 2)), "options": EvaluationOptions(along=Direction(q=[1, 0]))}
    answer = evaluate(model, **request)
    assert [f.quantity for f in answer.failures] == [q for q in quantities[:2] for _ in range(2)]
    assert issubclass(SingularMetric, InvalidDocument)


def test_negative_mass_is_a_failure() -> None:
    body = {"name": "a", "parent": "base", "joint": {"type": "prismatic"}, "mass": "m"}
    model = model_of({"name": "n", "parameters": {"m": {"value": 1}}, "bodies": [body]})
    answer = evaluate(model, **(Q | {"q": np.zeros((4, 1)), "parameters": {"m": [1, -1, 0, 2]}}))
    assert [failure.state for failure in answer.failures] == [1, 2]


def test_tiny_and_huge_masses_are_not_singular() -> None:
    """Pivots are relative to the metric: between 0 and 1, and 1 for a single coordinate."""
    slide = {"name": "slide", "parent": "base", "joint": {"type": "prismatic", "coordinate": "s"}, "mass": "m"}
    model = model_of({"name": "slide", "parameters": {"m": {"value": 1}}, "bodies": [slide]})
    for m in (1e-30, 1e30):
        request = Q | {"q": [0], "parameters": {"m": m}, "inputs": {"tau.x.s": 3 * m}}
        np.testing.assert_allclose(evaluate(model, **request)["forward_dynamics"], 3 + GRAVITY[2], rtol=1e-12)
    some = random_model(2)
    x = random_states(np.random.default_rng(2), N, some.dof)["q"]
    values = {s.name: 0.0 for s in some.program.symbols} | {c: x[:, a] for a, c in enumerate(some.coordinates)}
    pivots = interpret(derived(some, "forward_dynamics"), values, ["pivots"])["pivots"]
    assert some.dof > 1
    assert np.all(pivots > 0)
    assert np.all(pivots <= 1 + 1e-12)
    assert np.all(pivots[:, -1] == 1)


def test_numbers_where_the_formulas_are_too_large(monkeypatch: pytest.MonkeyPatch) -> None:
    model = random_model(2)
    q, qd = np.random.default_rng(0).uniform(-1, 1, (2, 7, model.dof))
    request = Q | {"q": q, "qd": qd}
    expected = evaluate(model, **request)["forward_dynamics"]

    def small(model: Model, name: str) -> Any:
        return forward_dynamics(model, 3) if name == "forward_dynamics" else derived(model, name)

    monkeypatch.setattr("substructures.quantities.accelerations.BLOCK", 2 * model.dof**2)
    found = evaluate(Sources(model, small), **request)
    np.testing.assert_allclose(found["forward_dynamics"], expected, rtol=1e-9, atol=1e-9 * np.abs(expected).max())
    assert cost(Sources(model, small), ["forward_dynamics"])[1] == model.dof
    for name in DERIVED:
        with pytest.raises(TooLarge):
            derived(model, name, 3)
    with pytest.raises(TooLarge, match="kinetic_energy"):
        evaluate(Sources(model, lambda m, n: derived(m, n, 3)), **request | {"quantities": ["kinetic_energy"]})


def test_cholesky_leaves_the_other_states_alone() -> None:
    g = np.broadcast_to(np.eye(3), (9, 3, 3)).copy()
    g[[2, 7]] = 0
    x = cholesky_solve(g, np.ones((9, 3)))
    assert sorted(set(np.argwhere(np.isnan(x))[:, 0])) == [2, 7]
    assert (x[[0, 1, 3, 4, 5, 6, 8]] == 1).all()


def test_nothing_moves() -> None:
    model = model_of(
        {"name": "rock", "bodies": [{"name": "a", "parent": "base", "joint": {"type": "fixed"}, "mass": 1}]}
    )
    answer = evaluate(model, **(Q | {"q": []}))
    assert answer["forward_dynamics"].shape == (0,)
    assert not answer.failures


def test_division_by_a_pivot_known_to_be_zero() -> None:
    graph = Graph()
    with pytest.raises(ZeroDivisionError):
        factorised(1, {(0, 0): graph.zero})


@pytest.mark.parametrize("name", ["ur5", "kuka-iiwa-14"])
def test_shipped_arm_is_cheaper_as_formulas(name: str) -> None:
    """All of forward dynamics takes fewer operations than metric, bias and forces and an elimination.

    Inverse dynamics of seven joints, by recursion, takes fewer than those three.
    """
    model = model_of(catalogue.load(name))
    elimination = factor_operations(model.dof, model.program.outputs["metric"].index)
    terms = model.program.count(["metric", "bias", "forces"])["total"]
    assert model.dof < 7 or derived(model, "inverse_dynamics").count()["total"] < terms
    direct = terms + elimination
    assert derived(model, "forward_dynamics").count(["forward_dynamics"])["total"] < direct


def test_models_stored_before_inverse_dynamics_was_an_output() -> None:
    """It follows from metric, bias and forces then; all that is formed from it as well."""
    model = random_model(4)
    kept = [name for name in model.program.outputs if name != "inverse_dynamics"]
    older = Model.load(model.summary(), model.program.select(kept).to_bytes())
    x = random_states(np.random.default_rng(4), N, model.dof)
    names = ["inverse_dynamics", "forward_dynamics", "inverse_dynamics_derivative", "forward_dynamics_derivative"]
    request = x | {"quantities": names, "options": EvaluationOptions(along=Direction(q=x["qd"])), "t": 0.3}
    found, expected = evaluate(older, **request), evaluate(model, **request)
    for name in names:
        atol = 1e-9 * max(1, np.abs(expected[name]).max())
        np.testing.assert_allclose(found[name], expected[name], rtol=0, atol=atol)
