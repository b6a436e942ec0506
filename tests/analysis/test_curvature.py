"""The curvature tensor: closed forms, symmetries, the Bianchi identities, and finite differences of the metric."""

# ruff: noqa: N806 -- symbols of the notation

from __future__ import annotations

from collections.abc import Mapping
from itertools import product
from math import comb
from typing import Any

import numpy as np
import pytest
from analysis_models import shipped
from in_depth import seeds
from random_trees import Kind, Plain, model_of, random_definition, with_parameters

from substructures import InvalidInput, Model, TooLarge
from substructures.analysis.equations.curvature import curvature, curvature_values, independent_elements
from substructures.compile import compile_program
from substructures.expr.graph import Expr, Graph
from substructures.expr.parse import parse
from substructures.expr.program import Program
from substructures.expr.replay import replay
from substructures.expr.rings.expand import is_zero
from substructures.quantities.numbers.evaluation import EvaluationOptions, evaluate, interpreted


def symbolic(bodies: list[Plain], parameters: str) -> Model:
    return model_of({"name": "x", "bodies": bodies, "parameters": {p: {} for p in parameters.split()}})


def assert_formula(model: Model, output: str, index: tuple[int, ...], expected: str) -> None:
    graph = Graph()
    found = replay(curvature(model), graph, {}, [output])[output].entries.get(index, graph.zero)
    assert is_zero(found - parse(graph, expected, lambda name: graph.symbol(name.replace("q", "x.q")))), (output, index)


@pytest.mark.parametrize("name", ["simple-pendulum", "gantry", "cart-pendulum", "drive-train", "mass-spring-chain"])
def test_flat(name: str) -> None:
    """One degree of freedom; prismatic axes; rotors on one axis; two masses of which one keeps its direction: with
    g_00, g_11 constant and g_01 a function of q1 alone, R_0101 = d_0 d_1 g_01 - ... = 0."""
    program = curvature(shipped(name))
    assert not program.outputs["riemann"].entries
    assert not program.outputs["scalar_curvature"].entries
    assert curvature(shipped("furuta-pendulum")).outputs["riemann"].entries


def test_sphere() -> None:
    """A mass point on a massless rod: the sphere with m l^2 (d theta^2 + sin^2 theta d phi^2), K = 1/(m l^2)."""
    rod = {"name": "b", "parent": "a", "joint": {"type": "revolute", "coordinate": "q2", "theta": "pi/2"}}
    bodies = [
        {"name": "a", "parent": "base", "joint": {"type": "revolute", "coordinate": "q1"}},
        {**rod, "mass": "m", "com": ["l", 0, 0]},
    ]
    model = symbolic(bodies, "m l")
    assert_formula(model, "scalar_curvature", (), "2/(m*l^2)")
    assert_formula(model, "ricci", (0, 0), "cos(q2)^2")
    assert_formula(model, "ricci", (1, 1), "1")
    assert_formula(model, "riemann", (0, 1, 0, 1), "m*l^2*cos(q2)^2")


def test_double_pendulum() -> None:
    """K = m1 cos(d) / (l1 l2 (m1 + m2 sin(d)^2)^2), d the angle between the rods: from E = (m1 + m2) l1^2, G = m2 l2^2
    and F = m2 l1 l2 cos(u - v) in the absolute angles u, v by R_1212 = d_u d_v F - F d_u F d_v F / (E G - F^2)."""
    bodies = [
        {"name": "a", "parent": "base", "joint": {"type": "revolute", "coordinate": "q1"}},
        {"name": "b", "parent": "a", "joint": {"type": "revolute", "coordinate": "q2", "d": "l1"}},
    ]
    for k, body in enumerate(bodies, 1):
        body |= {"mass": f"m{k}", "com": [f"l{k}", 0, 0]}
    model = symbolic(bodies, "m1 m2 l1 l2")
    assert_formula(model, "scalar_curvature", (), "2*m1*cos(q2)/(l1*l2*(m1 + m2*sin(q2)^2)^2)")


def test_rotation_group() -> None:
    """A body with equal moments I about a fixed mass centre: the sphere of dimension 3 with radius 2 sqrt(I)."""
    ball = {"name": "b", "parent": "base", "joint": {"type": "spherical", "coordinate": ["q1", "q2", "q3"]}, "mass": 1}
    model = symbolic([{**ball, "inertia": {"xx": "I", "yy": "I", "zz": "I"}}], "I")
    assert_formula(model, "scalar_curvature", (), "3/(2*I)")


def random_model(seed: int, share: float = 0.0) -> Model:
    rng = np.random.default_rng(9100 + seed)
    definition: Plain = {"bodies": []}
    while not 3 <= sum(np.size(b["joint"].get("coordinate", [])) for b in definition["bodies"]) <= 5:
        kind = Kind(4, chain=seed % 2 == 0, joints=("revolute", "revolute", "prismatic"), massive=True)
        definition = random_definition(rng, kind)
    return model_of(with_parameters(rng, definition, share))


def metric_derivatives(model: Model, q: Any) -> tuple[Any, Any, Any]:
    """g, d_c g_ab at [a, b, c] and d_c d_d g_ab at [a, b, c, d] by central differences."""
    n, h = model.dof, 2e-4
    steps = np.array(list(product((-2, -1, 0, 1, 2), repeat=2)))
    weights = np.array([1, -8, 0, 8, -1]) / (12 * h)
    mixed = np.outer(weights, weights).reshape(-1)
    second = np.zeros((n,) * 4)
    for c, d in product(range(n), repeat=2):
        points = np.repeat(q[None], 25, axis=0)
        points[:, c] += steps[:, 0] * h
        points[:, d] += steps[:, 1] * h
        g = evaluate(model, ["metric"], q=points)["metric"]
        second[:, :, c, d] = np.einsum("k,kab->ab", mixed, g)
    around = q + h * np.arange(-2, 3)[:, None, None] * np.eye(n)
    g = evaluate(model, ["metric"], q=around.reshape(-1, n))["metric"].reshape(5, n, n, n)
    return g[2, 0], np.einsum("k,kcab->abc", weights, g), second


@pytest.mark.parametrize("seed", seeds(4, 6))
def test_random_trees(seed: int) -> None:
    """Symmetries, the first Bianchi identity, contractions, and the second derivatives of the metric:
    R_abcd = 1/2 (d_b d_c g_ad + d_a d_d g_bc - d_a d_c g_bd - d_b d_d g_ac) + g^ef (Gamma_ead Gamma_fbc - ...)."""
    model = random_model(seed, 0.3 * (seed % 2))
    q = np.random.default_rng(seed).uniform(-1, 1, model.dof)
    found = curvature_values(model, q)
    R, scale = found.riemann, max(float(np.abs(found.riemann).max()), 1e-3)
    assert not found.failures
    for image in (-R.transpose(1, 0, 2, 3), -R.transpose(0, 1, 3, 2), R.transpose(2, 3, 0, 1)):
        assert np.array_equal(R, image)
    np.testing.assert_allclose(R + R.transpose(0, 3, 1, 2) + R.transpose(0, 2, 3, 1), 0, atol=1e-12 * scale)
    g, dg, ddg = metric_derivatives(model, q)
    inverse = np.linalg.inv(g)
    np.testing.assert_allclose(found.inverse_metric, inverse, rtol=1e-9, atol=1e-12 * np.abs(inverse).max())
    gamma = (dg.transpose(0, 2, 1) + dg - dg.transpose(2, 0, 1)) / 2
    first = np.einsum("adbc->abcd", ddg) + np.einsum("bcad->abcd", ddg)
    first = first - np.einsum("bdac->abcd", ddg) - np.einsum("acbd->abcd", ddg)
    squares = np.einsum("ef,ead,fbc->abcd", inverse, gamma, gamma) - np.einsum(
        "ef,eac,fbd->abcd", inverse, gamma, gamma
    )
    np.testing.assert_allclose(R, first / 2 + squares, rtol=0, atol=2e-5 * scale)
    np.testing.assert_allclose(found.ricci, np.einsum("ac,abcd->bd", inverse, R), atol=1e-9 * np.abs(R).max() * 50)
    assert found.scalar_curvature == pytest.approx(np.einsum("bd,bd", inverse, found.ricci), rel=1e-8, abs=1e-9)


def test_number_of_independent_elements() -> None:
    for n in range(9):
        assert len(independent_elements(n)) == n**2 * (n**2 - 1) // 12
        assert comb(n, 4) == len({tuple(sorted(i)) for i in independent_elements(n) if len(set(i)) == 4})


def test_bianchi_holds_as_formula() -> None:
    graph, n = Graph(), 4
    model = model_of(random_definition(np.random.default_rng(5), Kind(4, True, ("revolute",), True)))
    R = replay(curvature(model), graph, {}, ["riemann"])["riemann"].entries
    terms = [R.get(i, graph.zero) for i in ((0, 1, 2, 3), (0, 2, 3, 1), (0, 3, 1, 2))]
    assert model.dof == n
    assert sum(terms, graph.zero).is_zero
    assert all(isinstance(x, Expr) for x in terms)


def test_refusals_and_failures() -> None:
    model = shipped("double-pendulum")
    with pytest.raises(TooLarge):
        curvature(model, max_nodes=20)
    with pytest.raises(InvalidInput) as error:
        curvature_values(model, [0, 0], parameters={"x.nothing": 1})
    assert error.value.faults[0].pointer == "/parameters/x.nothing"
    joint = {"type": "revolute", "coordinate": "q1"}
    with pytest.raises(InvalidInput) as error:
        curvature(model_of({"name": "x", "bodies": [{"name": "a", "parent": "base", "joint": joint}]}))
    assert error.value.faults[0].code == "singular-metric"
    sphere = model_of(
        {
            "name": "x",
            "bodies": [
                {"name": "a", "parent": "base", "joint": joint},
                {
                    "name": "b",
                    "parent": "a",
                    "mass": 1,
                    "com": [1, 0, 0],
                    "joint": {"type": "revolute", "coordinate": "q2", "theta": "pi/2", "phi": "pi/2"},
                },
            ],
        }
    )
    failures = curvature_values(sphere, [[0, 1], [0, 0]]).failures
    assert [f.state for f in failures] == [1]


def test_one_position_for_all_parameters() -> None:
    model = shipped("double-pendulum")
    name = next(iter(model.parameters))
    found = curvature_values(model, [0.3, 0.7], parameters={name: [1, 2]})
    assert found.riemann.shape == (2, 2, 2, 2, 2)
    one = curvature_values(model, [0.3, 0.7], parameters={name: 2})
    assert np.array_equal(found.riemann[1], one.riemann)
    assert repr(one).startswith("CurvatureValues(n=2, states=1, failures=0)\nscalar curvature from ")


@pytest.mark.parametrize("q", [[], [[]], [[], [], []]])
def test_nothing_moves(q: Any) -> None:
    """Without coordinates shapes say how many states there are all the same: of the interpreter and of kernels."""
    body = {"name": "block", "parent": "base", "joint": {"type": "fixed"}, "mass": 1}
    model, states = model_of({"name": "x", "bodies": [body]}), np.shape(q)[:-1]
    for engine in (interpreted, compiled):
        values = vars(curvature_values(model, q=q, engine=engine))
        shapes = {name: np.shape(x) for name, x in values.items() if name != "failures"}
        axes = {"riemann": 4, "ricci": 2, "scalar_curvature": 0, "inverse_metric": 2, "christoffel_second": 3}
        assert shapes == {name: (*states, *[0] * count) for name, count in axes.items()}
        found = evaluate(
            model, ["metric", "potential_energy", "forces"], q=q, options=EvaluationOptions(evaluator=engine)
        )
        expected = [(*states, 0, 0), states, (*states, 0)]
        assert [found[name].shape for name in ("metric", "potential_energy", "forces")] == expected


def compiled(program: Program, values: Mapping[str, Any], names: list[str], _: int) -> dict[str, np.ndarray]:
    return compile_program(program, names).evaluate(values)
