"""Ball and floating joints: another engine, closed forms, the chains of angles, planted faults."""

# ruff: noqa: N806 -- symbols of the notation

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
from ball_trees import GRAVITY, of_engine, random_balls, random_position
from damaged import require_all_found
from in_depth import seeds
from random_trees import model_of, tree_of, with_parameters

from substructures import Definition, InvalidDocument, TreeSpec, couple, derive, evaluate, linearise
from substructures.errors import InvalidInput
from substructures.expr.interpret import interpret
from substructures.quantities.centroidal import centroidal
from substructures.quantities.derivative_directions import Direction
from substructures.quantities.from_parts import NumericTree
from substructures.quantities.numbers.evaluation import EvaluationOptions
from substructures.quantities.reactions import reactions
from substructures.quantities.regressor import regressor

pin = pytest.importorskip("pinocchio", reason="Pinocchio is in the test extra (not on Windows)")
from pinocchio_trees import engine_of  # noqa: E402 -- the engine is optional

Plain = dict[str, Any]
TOLERANCE = 1e-10
TOP: Plain = {
    "name": "top",
    "parameters": {"m": {"value": 2}, "l": {"value": "0.3"}, "A": {"value": 1}, "C": {"value": "1/2"}},
    "bodies": [
        {"name": "b", "parent": "base", "mass": "m", "com": [0, 0, "l"],
         "joint": {"type": "ball", "velocities": ["wx", "wy", "wz"]}, "inertia": {"xx": "A", "yy": "A", "zz": "C"}},
    ],
}  # fmt: skip


def deviation(found: Any, expected: Any) -> float:
    assert np.isfinite(found).all()
    return float(np.abs(found - expected).max(initial=0) / max(np.abs(expected).max(initial=0), 1e-2))


@pytest.mark.parametrize("seed", seeds(10, 60))
def test_random_trees_against_pinocchio(seed: int) -> None:
    """M, Gamma~, velocity forces, gravity, inverse dynamics and momenta with free flyers, balls, hinges and slides."""
    definition, rng = random_balls(seed)
    for body in definition["bodies"]:
        for law in ("stiffness", "rest", "damping", "armature"):
            body["joint"].pop(law, None)
    model = model_of(definition)
    engine = engine_of(definition, GRAVITY)
    place = engine.order([name.removeprefix("x.") for name in model.coordinates])
    q = random_position(rng, model)
    v, a = rng.uniform(-1, 1, (2, model.dof))
    names = ["metric", "christoffel", "bias", "gravity", "inverse_dynamics", "forward_dynamics", "kinematics"]
    found = evaluate(model, names, q, v, a)
    state, rates, second = of_engine(engine, model, q), np.zeros(model.dof), np.zeros(model.dof)
    rates[place], second[place] = v, a
    data = engine.model.createData()
    M = np.triu(pin.crba(engine.model, data, state))
    M = (M + np.triu(M, 1).T)[np.ix_(place, place)]
    assert deviation(found["metric"], M) < TOLERANCE
    weight = -pin.computeGeneralizedGravity(engine.model, data, state)[place]
    assert deviation(found["gravity"], weight) < TOLERANCE
    bias = pin.nonLinearEffects(engine.model, data, state, rates)[place] + weight
    assert deviation(found["bias"], bias) < TOLERANCE
    assert deviation(np.einsum("abc,b,c", found["christoffel"], v, v), bias) < TOLERANCE
    np.testing.assert_array_equal(found["christoffel"], found["christoffel"].transpose(0, 2, 1))
    assert deviation(found["inverse_dynamics"], pin.rnea(engine.model, data, state, rates, second)[place]) < TOLERANCE
    if np.linalg.cond(M) < 1e9:  # massless bodies between two balls have no accelerations
        assert deviation(M @ found["forward_dynamics"], weight - bias) < 1e-9
    pin.forwardKinematics(engine.model, data, state)
    for name, (joint, where) in engine.frames.items():
        pose = data.oMi[joint] * where
        k = model.frames.index(f"x.{name}")
        assert deviation(found["kinematics"]["position"][k], pose.translation) < TOLERANCE
        assert deviation(found["kinematics"]["rotation"][k], pose.rotation) < TOLERANCE


@pytest.mark.parametrize("seed", seeds(3, 20))
def test_trees_of_parts(seed: int) -> None:
    """Parts with such joints on each other, coupled and certified; quantities of parts, and numbers of parts."""
    first, rng = random_balls(seed, 4, 8)
    second, _ = random_balls(seed + 100, 2, 7)
    first = with_parameters(rng, first, 0.3) if seed % 2 else first
    parts = {
        "a": derive(Definition.read({**first, "name": "first"})),
        "b": derive(Definition.read({**second, "name": "second"})),
    }
    tree = {
        "name": "t",
        "gravity": ["0.3", 0, "-9.81"],
        "instances": [
            {"name": "a", "substructure": "first"},
            {"name": "b", "substructure": "second", "at": f"a.{parts['a'].bodies[-1]}",
             "placement": {"rpy": ["0.1", "0.2", "0.3"], "position": ["0.5", 0, 0]}},
        ],
    }  # fmt: skip
    spec, model = TreeSpec.read(tree), couple(tree, parts)
    for quantity in (centroidal, regressor, reactions):
        assert len(quantity(spec, parts).program)
    values = {s.name: rng.uniform(-1, 1) for s in model.program.symbols}
    names = ["metric", "christoffel", "gravity", "forces", "bias", "inverse_dynamics"]
    found = NumericTree(spec, parts).evaluate(values, names)
    expected = interpret(model.program, values, names)
    for name in names:
        assert deviation(found[name], expected[name]) < 1e-12, name


def test_a_spring_at_a_ball_is_a_bushing() -> None:
    """-k sin(t) n and k (1 - cos t) of a turn t about n; I w^2 = k_i of three stiffnesses about the axes at rest."""

    def sprung(*k: float) -> Any:
        load = {"type": "bushing", "from": "base", "to": "b", "angular_stiffness": list(k)}
        body = {**TOP["bodies"][0], "mass": 1, "com": [0, 0, 0], "inertia": {"xx": 0.3, "yy": 0.4, "zz": 0.5}}
        return model_of({"name": "sprung", "bodies": [body], "loads": [load]}, (0, 0, 0))

    t, n = 0.8, np.array([1, 2, 2]) / 3
    found = evaluate(sprung(7, 7, 7), ["forces", "potential_energy"], [np.cos(t / 2), *(np.sin(t / 2) * n)])
    np.testing.assert_allclose(found["forces"], -7 * np.sin(t) * n, rtol=1e-13)
    assert found["potential_energy"] == pytest.approx(7 * (1 - np.cos(t)), rel=1e-13)
    at = linearise(sprung(2, 5, 9), [1, 0, 0, 0])
    np.testing.assert_allclose(sorted(mode.frequency for mode in at.modes), np.sqrt([2 / 0.3, 5 / 0.4, 9 / 0.5]))
    assert at.stability is not None
    assert at.stability.verdict == "stable"


def test_euler_and_lagrange_by_hand() -> None:
    """J w' + w x J w = m l x R^T g, with J about the point that is held."""
    model = couple(
        {"name": "t", "gravity": [0, 0, "-9.81"], "instances": [{"name": "x", "substructure": "top"}]},
        {"x": derive(TOP)},
    )
    assert model.coordinates == ("x.wx", "x.wy", "x.wz")
    assert model.positions == ("x.q_b_w", "x.q_b_x", "x.q_b_y", "x.q_b_z")
    w, s = np.array([0.3, -0.7, 1.1]), np.sqrt(0.5)
    # a quarter turn about y: the axis of the top is x of the world
    found = evaluate(model, ["metric", "bias", "gravity", "potential_energy", "kinetic_energy"], [s, 0, s, 0], w)
    J = np.diag([1 + 2 * 0.3**2, 1 + 2 * 0.3**2, 0.5])
    np.testing.assert_allclose(found["metric"], J, rtol=1e-14)
    np.testing.assert_allclose(found["bias"], np.cross(w, J @ w), rtol=1e-13, atol=1e-15)
    # Q' = 1/2 Q (0, w) of Q = s (1, e_y)
    moved = evaluate(model, "position_rates", [s, 0, s, 0], w)
    half = s / 2 * np.array([-w[1], w[0] + w[2], w[1], w[2] - w[0]])
    np.testing.assert_allclose(moved["position_rates"], half, rtol=1e-14)
    assert moved.labels == {"positions": model.positions}
    # gravity (0, 0, -g) of the world is (g, 0, 0) in the body
    np.testing.assert_allclose(found["gravity"], np.cross([0, 0, 0.6], [9.81, 0, 0]), rtol=1e-13, atol=1e-15)
    assert found["kinetic_energy"] == pytest.approx(w @ J @ w / 2)
    assert found["potential_energy"] == pytest.approx(0, abs=1e-15)


def test_the_base_is_not_in_the_metric() -> None:
    """An arm on a floating base costs what it costs on a fixed one, and some rows of the base."""
    deck = {
        "name": "deck",
        "bodies": [{"name": "hull", "parent": "base", "joint": {"type": "floating"}, "mass": 100,
                    "inertia": {"xx": 20, "yy": 20, "zz": 30}}],
    }  # fmt: skip
    parts = {"d": derive(deck), "a": derive("puma560")}
    at = {"name": "a", "substructure": "puma560", "at": "d.hull"}
    tree = {"name": "t", "gravity": [0, 0, "-9.81"], "instances": [{"name": "d", "substructure": "deck"}, at]}
    model = couple(tree, parts)
    assert not {*model.program.needs(["metric", "christoffel"])} & {*model.balls[0]["positions"]}
    arm = {name: _of_arm(model.program, name) for name in ("metric", "christoffel")}
    # in the frames that are best for the whole; by itself the arm has 286 and 392
    assert arm == {"metric": 297, "christoffel": 516}
    assert {name: model.operations[name] for name in arm} == {"metric": 443, "christoffel": 1097}


def _of_arm(program: Any, name: str) -> int:
    """Operations of the elements without an index of the base."""
    output = program.outputs[name]
    some = [k for i, k in zip(output.index, output.entries, strict=True) if min(i) >= 6]
    return int(program.totals_of([some])[0])


@pytest.mark.parametrize(
    ("change", "pointer", "code"),
    [
        ({"stiffness": 1}, "/bodies/0/joint/stiffness", "no-angles"),
        ({"armature": 1, "type": "floating"}, "/bodies/0/joint/armature", "no-angles"),
        ({"armature": [1, 1, 2]}, "/bodies/0/joint/armature", "wrong-length"),
        ({"limits": [-1, 1]}, "/bodies/0/joint/limits", "no-angles"),
        ({"velocities": ["a", "b"]}, "/bodies/0/joint/velocities", "wrong-length"),
        ({"coordinate": ["a", "b", "c"]}, "/bodies/0/joint/coordinate", "wrong-length"),
        ({"velocities": ["a", "b", "m"]}, "/bodies/0/joint/velocities", "duplicate-name"),
        ({"type": "spherical"}, "/bodies/0/joint/velocities", "velocities-of-chain"),
    ],
)
def test_wrong_definitions(change: Plain, pointer: str, code: str) -> None:
    body = {**TOP["bodies"][0], "joint": {**TOP["bodies"][0]["joint"], **change}}
    with pytest.raises(InvalidDocument) as caught:
        derive({**TOP, "bodies": [body]})
    assert (pointer, code) in [(fault.pointer, fault.code) for fault in caught.value.faults]


def test_what_does_not_go_with_them() -> None:
    related = {**TOP, "relations": [{"coordinate": "wx", "of": "wy"}]}
    with pytest.raises(InvalidDocument, match="spherical") as caught:
        derive(related)
    assert caught.value.faults[0].code == "has-balls"
    loads = [{"type": "joint", "coordinate": "wx", "force": "-wx"}]
    with pytest.raises(InvalidDocument, match="wx"):
        derive({**TOP, "loads": loads})
    bent = {"name": "p", "type": "joint", "coordinate": "x.wx", "force": "-x.wx"}
    tree = {"name": "t", "gravity": [0, 0, 0], "instances": [{"name": "x", "substructure": "top"}]}
    with pytest.raises(InvalidDocument, match=r"x\.wx"):
        couple({**tree, "loads": [bent]}, {"x": derive(TOP)})
    with pytest.raises(InvalidDocument) as caught:
        couple({**tree, "driven": {"x.wx": "t"}}, {"x": derive(TOP)})
    assert caught.value.faults[0].code == "has-balls"
    part = derive({**TOP, "loads": [{"type": "joint", "coordinate": "wx", "force": "-2*wx'"}]})
    found = evaluate(couple(tree, {"x": part}), "forces", [1, 0, 0, 0], [3, 0, 0])
    np.testing.assert_allclose(found["forces"], [-6, 0, 0])
    for along in ([1, 0, 0], [1, 0, 0, 0]):
        options = EvaluationOptions(along=Direction(q=along))
        with pytest.raises(InvalidDocument, match="rates of ball") as caught:
            evaluate(couple(tree, {"x": part}), "forward_dynamics_derivative", [1, 0, 0, 0], options=options)
        assert caught.value.faults[0].code == "has-balls"


def test_quaternions_have_the_norm_1() -> None:
    model = couple(tree_of(TOP), {"x": derive(TOP)})
    with pytest.raises(InvalidInput, match=r"norm .* is 1\.1") as caught:
        evaluate(model, "gravity", [1.1, 0, 0, 0])
    assert caught.value.faults[0].code == "not-a-unit-quaternion"
    near = evaluate(model, "gravity", [0.6 * (1 + 5e-7), 0.8 * (1 + 5e-7), 0, 0])["gravity"]
    np.testing.assert_allclose(near, evaluate(model, "gravity", [0.6, 0.8, 0, 0])["gravity"], rtol=1e-15)
    by_name = {"x.q_b_w": 0.6, "x.q_b_x": 0.8, "x.q_b_y": 0, "x.q_b_z": 0}
    np.testing.assert_allclose(evaluate(model, "gravity", by_name)["gravity"], near, rtol=1e-15)


def test_planted_faults_are_found() -> None:
    definition, _ = random_balls(3, 2, 8)
    part, spec = derive(Definition.read(definition)), tree_of(definition)
    require_all_found(part, spec, couple(spec, {"x": part}))
