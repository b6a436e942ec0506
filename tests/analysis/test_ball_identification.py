"""Base parameters of trees with ball and floating joints: their number, another engine, recovery from motions."""

# ruff: noqa: N806 -- symbols of the notation

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
from ball_trees import GRAVITY, OF, of_engine, random_position
from catalogue_entries import shipped_part
from in_depth import seeds
from random_trees import Kind, Plain, random_definition, tree_of

from substructures import Definition, InvalidInput, Model, Outputs, TreeSpec, couple, derive, evaluate, simulate
from substructures.analysis.identification.base_parameters import BaseParameters, base_parameters
from substructures.analysis.identification.fit import excitation, identify
from substructures.analysis.identification.grouped import grouped_model
from substructures.expr.interpret import interpret
from substructures.quantities.numbers.defaults import default_numbers
from substructures.quantities.regressor import regressor

pin: Any = pytest.importorskip("pinocchio", reason="Pinocchio is in the test extra (not on Windows)")
from pinocchio_trees import engine_of  # noqa: E402 -- the engine is optional

JOINTS = ("revolute", "revolute", "prismatic", "spherical", "free", "fixed")
LEGS = [("fl", "front_left"), ("fr", "front_right"), ("rl", "rear_left"), ("rr", "rear_right")]


def random_pair(seed: int) -> tuple[Plain, Plain, np.random.Generator]:
    """A random mechanism in angles, and the same with ball and floating joints."""
    rng = np.random.default_rng(seed)
    while True:
        kind = Kind(int(rng.integers(2, 5)), bool(rng.integers(2)), JOINTS, laws=False, loads=0, springs=0)
        definition = random_definition(rng, kind)
        if any(body["joint"]["type"] in OF for body in definition["bodies"]):
            break
    bodies = []
    for body in definition["bodies"]:
        joint = dict(body["joint"])
        if joint["type"] in OF:
            joint |= {"type": OF[joint["type"]], "velocities": joint.pop("coordinate")}
        bodies.append({**body, "joint": joint})
    return definition, {**definition, "bodies": bodies}, rng


def rank_of(stacked: Any) -> int:
    # columns of rounding do not count
    sizes = np.linalg.svd(stacked / (np.linalg.norm(stacked, axis=0) + 1e-6), compute_uv=False)
    return int(np.sum(sizes > 1e-8 * sizes[0]))


@pytest.mark.parametrize("seed", seeds(8, 60))
def test_as_many_as_of_the_chain_of_angles(seed: int) -> None:
    """And as the rank of Y at random states says; Y_B beta = Y pi for any parameters."""
    with_angles, with_quaternions, rng = random_pair(seed)
    parts = {"x": derive(Definition.read(with_quaternions))}
    spec = tree_of(with_quaternions, GRAVITY)
    Y, model = regressor(spec, parts), couple(spec, parts)
    base = base_parameters(Y)
    assert base.count == base_parameters(regressor(spec, {"x": derive(Definition.read(with_angles))})).count
    q = np.array([random_position(rng, model) for _ in range(50)])
    qd, qdd = rng.uniform(-1, 1, (2, 50, model.dof))
    full = Y.evaluate(q, qd, qdd)["regressor"]
    assert rank_of(full.reshape(-1, len(Y.names))) == base.count
    values: Plain = dict(zip(model.positions, q.T, strict=True))
    for primes, x in (("'", qd), ("''", qdd)):
        values |= {f"{name}{primes}": x[:, a] for a, name in enumerate(model.coordinates)}
    found = interpret(base.program, values)
    pi = rng.uniform(-1, 1, len(Y.names))
    force = found["base_regressor"] @ (found["grouping"][0] @ pi)
    np.testing.assert_allclose(force, full @ pi, rtol=0, atol=1e-9 * np.abs(full @ pi).max())


@pytest.mark.parametrize("seed", seeds(4, 30))
def test_forces_of_another_engine_tell_them(seed: int) -> None:
    """Their number is the rank of Pinocchio's regressor, and from its forces follows [1 C] pi of the documents."""
    _, definition, rng = random_pair(100 + seed)
    spec, parts = tree_of(definition, GRAVITY), {"x": derive(Definition.read(definition))}
    model, base = couple(spec, parts), base_parameters(regressor(spec, parts))
    engine = engine_of(definition, GRAVITY)
    data, place = engine.model.createData(), engine.order([name.removeprefix("x.") for name in model.coordinates])
    q = np.array([random_position(rng, model) for _ in range(60)])
    qd, qdd = rng.uniform(-1, 1, (2, 60, model.dof))
    tau, rows = np.zeros_like(qd), []
    for k in range(len(q)):
        state, rates, second = of_engine(engine, model, q[k]), np.zeros(model.dof), np.zeros(model.dof)
        rates[place], second[place] = qd[k], qdd[k]
        tau[k] = pin.rnea(engine.model, data, state, rates, second)[place]
        rows.append(np.array(pin.computeJointTorqueRegressor(engine.model, data, state, rates, second)))
    assert rank_of(np.concatenate(rows)) == base.count
    found = identify(base, q, qd, qdd, tau)
    beta = own_values(base)
    np.testing.assert_allclose(found.values, beta, rtol=0, atol=1e-7 * np.abs(beta).max())


def own_values(base: BaseParameters) -> Any:
    return interpret(base.program, default_numbers(base.parameters), ["base_parameters"])["base_parameters"]


def shipped(tree: Plain) -> tuple[TreeSpec, Plain, Model]:
    spec, parts = TreeSpec.read(tree), {i["name"]: shipped_part(i["substructure"]) for i in tree["instances"]}
    return spec, parts, couple(spec, parts)


def driven_motion(model: Model, sizes: Plain, span: float, count: int) -> tuple[Any, Any, Any, Any]:
    """A motion under forces of the drives, each of two harmonics, at ``count`` times; accelerations of its states."""
    inputs, rng, t = {}, np.random.default_rng(0), np.linspace(0, span, count)
    tau = np.zeros((count, model.dof))
    for a, name in enumerate(model.coordinates):
        size = sizes[name.rsplit(".", 1)[1][0]]
        w, p = rng.uniform(2, 12, 2).round(3), rng.uniform(0, 6, 2).round(3)
        inputs[f"tau.{name}"] = " + ".join(f"{size}*sin({w[i]}*t + {p[i]})" for i in range(2))
        tau[:, a] = size * np.sin(np.outer(t, w) + p).sum(1)
    still = [float(name.endswith("qw")) for name in model.positions]
    motion = simulate(model, still, (0, span), inputs=inputs, outputs=Outputs(times=t))
    assert motion.is_right
    forces = {f"tau.{name}": tau[:, a] for a, name in enumerate(model.coordinates)}
    second = evaluate(model, "forward_dynamics", motion.q, motion.qd, inputs=forces)["forward_dynamics"]
    return motion.q, motion.qd, second, tau


SATELLITE: Plain = {"name": "s", "gravity": [0, 0, 0], "instances": [{"name": "s", "substructure": "satellite-wheels"}]}
QUADRUPED: Plain = {
    "name": "q",
    "gravity": [0, 0, "-9.81"],
    "instances": [
        {"name": "base", "substructure": "quadruped-trunk-floating"},
        *({"name": leg, "substructure": "quadruped-leg", "at": f"base.{port}"} for leg, port in LEGS),
    ],
}


@pytest.mark.parametrize(
    ("tree", "sizes", "span", "count"),
    [
        # m, s_3 and J_33 of what turns about an axis count with the link before
        (SATELLITE, {"v": 30.0, "w": 3.0, "s": 0.2}, 4, 10 + 4 * 7),
        (QUADRUPED, {"v": 60.0, "w": 6.0, "h": 3.0, "k": 3.0, "t": 3.0, "c": 3.0, "a": 3.0}, 1, 10 + 12 * 7),
    ],
    ids=["satellite", "quadruped"],
)
def test_recovery_from_simulated_forces(tree: Plain, sizes: Plain, span: float, count: int) -> None:
    """With noise too: within four standard deviations."""
    spec, parts, model = shipped(tree)
    base = base_parameters(regressor(spec, parts))
    assert base.count == count
    q, qd, qdd, tau = driven_motion(model, sizes, span, 200)
    beta = own_values(base)
    assert excitation(base, q, qd, qdd).is_good
    exact = identify(base, q, qd, qdd, tau, model=model)
    np.testing.assert_allclose(exact.values, beta, rtol=0, atol=1e-11)
    noise = np.random.default_rng(4).normal(0, 0.05, tau.shape)
    found = identify(base, q, qd, qdd, tau + noise, model=model)
    assert np.all(np.abs(found.values - beta) < 4 * found.deviations)
    assert np.mean(np.abs(found.values - beta) < found.deviations) > 0.5
    np.testing.assert_allclose(found.residual, 0.05, rtol=0.25)


def test_equations_in_grouped_symbols() -> None:
    """The four wheels count with the hub; the same metric."""
    spec, parts, model = shipped(SATELLITE)
    base = base_parameters(regressor(spec, parts))
    bodies = ["hub", *(f"wheel{k}" for k in range(1, 5))]
    assert base.combinations()["s.hub.m"] == {f"s.{body}.m": "1" for body in bodies}
    grouped = grouped_model(spec, parts, model, base)
    values = {s.name: 0.3 for s in model.program.symbols} | default_numbers(model.parameters)
    symbols = {name: float(x) for name, x in interpret(grouped.definitions, values).items()}
    found = interpret(grouped.model.program, {**values, **symbols}, ["metric"])["metric"]
    np.testing.assert_allclose(found, interpret(model.program, values, ["metric"])["metric"], rtol=0, atol=1e-13)


def test_what_is_no_state_is_refused() -> None:
    """A quaternion of length 2, and one number too few for the forces."""
    spec, parts, _ = shipped(SATELLITE)
    base = base_parameters(regressor(spec, parts))
    q, still = np.zeros((9, 11)), np.zeros((9, 10))
    q[:, 3] = 2
    with pytest.raises(InvalidInput) as error:
        identify(base, q, still, still, still)
    assert error.value.faults[0].code == "not-a-unit-quaternion"
    q[:, 3] = 1
    with pytest.raises(InvalidInput) as error:
        identify(base, q, still, still, q)
    assert [(f.pointer, f.code) for f in error.value.faults] == [("/tau", "wrong-length")]
