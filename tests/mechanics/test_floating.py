"""Trees whose base floats, in rates without singular angles: another engine, Euler's equations, planted faults."""

# ruff: noqa: N806 -- symbols of the notation

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np
import pytest
import scipy
from random_trees import GRAVITY, Kind, random_definition, tree_of

from substructures import Definition, TreeSpec, couple, derive
from substructures.errors import InvalidInput, TooLarge, VerificationFailed
from substructures.quantities import floating as module
from substructures.quantities.floating import floating_christoffel, floating_metric
from substructures.quantities.numbers.evaluation import evaluate
from substructures.quantities.sources import Sources, of_parts

Plain = dict[str, Any]
QUANTITIES = ["floating_metric", "floating_christoffel"]
DISC: Plain = {
    "name": "disc",
    "parameters": {"A": {"value": 2}, "B": {"value": 3}, "C": {"value": 4}},
    "bodies": [
        {
            "name": "box",
            "parent": "base",
            "joint": {"type": "fixed"},
            "mass": 5,
            "inertia": {"xx": "A", "yy": "B", "zz": "C"},
        }
    ],
}


def sources_of(definition: Plain, gravity: Any = GRAVITY) -> Sources:
    spec, parts = tree_of(definition, gravity), {"x": derive(Definition.read(definition))}
    return Sources(couple(spec, parts), of_parts=of_parts(spec, parts))


@pytest.mark.parametrize("seed", range(8))
def test_against_an_engine(seed: int) -> None:
    """M and the velocity forces of random trees on a free flyer, at any pose of the base, and gravity at it."""
    pin = pytest.importorskip("pinocchio", reason="Pinocchio is in the test extra (not on Windows)")
    from pinocchio_trees import engine_of  # noqa: PLC0415 -- the engine is optional

    rng = np.random.default_rng(seed)
    definition = random_definition(rng, Kind(int(rng.integers(1, 5)), bool(rng.integers(2)), depth=5))
    for body in definition["bodies"]:
        body["joint"].pop("armature", None)  # which the certificate has, and the engine here has not
    sources = sources_of(definition)
    q, v = rng.uniform(-1, 1, sources.model.dof), rng.uniform(-1, 1, 6 + sources.model.dof)
    found = evaluate(sources, QUANTITIES, q)
    assert list(found.labels["rates"][:6]) == ["vx", "vy", "vz", "wx", "wy", "wz"]
    engine = engine_of(definition, GRAVITY, floats=True)
    names = [name.removeprefix("x.") for name in sources.model.coordinates]
    order = [*range(6), *engine.order(names)]
    place = np.argsort(order)
    turn = rng.normal(size=4)
    pose = np.concatenate([rng.uniform(-1, 1, 3), turn / np.linalg.norm(turn)])
    data, state = engine.model.createData(), np.concatenate([pose, q[np.argsort(engine.order(names))]])
    M = pin.crba(engine.model, data, state)
    M = np.triu(M) + np.triu(M, 1).T
    np.testing.assert_allclose(found["floating_metric"], M[np.ix_(order, order)], rtol=1e-11, atol=1e-11)
    bias = np.einsum("abc,b,c", found["floating_christoffel"], v, v)
    gravity = pin.computeGeneralizedGravity(engine.model, data, state)[order]
    effects = pin.nonLinearEffects(engine.model, data, state, v[place])[order]
    np.testing.assert_allclose(bias, effects - gravity, rtol=1e-10, atol=1e-10)
    turned = pin.SE3(pin.Quaternion(*pose[[6, 3, 4, 5]]).matrix(), np.zeros(3)).rotation.T
    down = turned @ np.asarray(GRAVITY, dtype=float)
    np.testing.assert_allclose(found["floating_metric"][:, :3] @ down, -gravity, rtol=1e-10, atol=1e-10)


def test_a_rigid_body_has_eulers_equations() -> None:
    """Gamma of w x J w, and of m w x v: nothing else."""
    found = evaluate(sources_of(DISC), QUANTITIES, None)
    np.testing.assert_array_equal(found["floating_metric"], np.diag([5, 5, 5, 2, 3, 4]))
    rng = np.random.default_rng(0)
    v, w = rng.uniform(-1, 1, (2, 3))
    rates = np.concatenate([v, w])
    bias = np.einsum("abc,b,c", found["floating_christoffel"], rates, rates)
    np.testing.assert_allclose(bias, [*(5 * np.cross(w, v)), *np.cross(w, [2 * w[0], 3 * w[1], 4 * w[2]])], rtol=1e-14)
    np.testing.assert_array_equal(found["floating_christoffel"], found["floating_christoffel"].transpose(0, 2, 1))


def test_a_satellite_turns_past_a_pitch_of_90_degrees() -> None:
    """Energy and the momentum in space stay, where yaw, pitch and roll are singular."""
    wheel = {"type": "revolute", "coordinate": "q", "theta": 0.3, "psi": 0.4, "d": 0.2}
    body = {"name": "w", "parent": "box", "joint": wheel, "mass": 1, "inertia": {"xx": 0.1, "yy": 0.1, "zz": 0.2}}
    sources = sources_of({**DISC, "bodies": [*DISC["bodies"], {**body, "com": [0.1, 0, 0]}]})

    def split(x: Any) -> tuple[Any, Any, Any]:
        return x[:9].reshape(3, 3), x[12:13], x[13:]

    def rates(_: float, x: Any) -> Any:
        R, q, v = split(x)
        found = evaluate(sources, QUANTITIES, q)
        change = np.linalg.solve(found["floating_metric"], -np.einsum("abc,b,c", found["floating_christoffel"], v, v))
        return np.concatenate([(R @ np.cross(v[3:6], np.eye(3)).T).ravel(), R @ v[:3], v[6:], change])

    def conserved(x: Any) -> tuple[float, Any]:
        R, q, v = split(x)
        M = evaluate(sources, "floating_metric", q)["floating_metric"]
        momentum = M @ v
        return float(v @ momentum / 2), np.concatenate(
            [R @ momentum[:3], R @ momentum[3:6] + np.cross(x[9:12], R @ momentum[:3])]
        )

    start = np.concatenate([np.eye(3).ravel(), np.zeros(3), [0.2], [0.1, 0, 0.2, 0.05, 1.0, 0.02, 1.5]])
    run = scipy.integrate.solve_ivp(rates, (0, 4), start, rtol=1e-9, atol=1e-11, method="DOP853")
    pitch = -np.arcsin(np.clip(run.y[6], -1, 1))
    assert pitch.max() > 1.5
    energy, momentum = conserved(start)
    after, there = conserved(run.y[:, -1])
    assert after == pytest.approx(energy, rel=1e-7)
    np.testing.assert_allclose(there, momentum, rtol=1e-6, atol=1e-7)


def test_relations_and_names() -> None:
    """Formulas in coordinates that are left, beside an instance and a parameter that have the names of the host."""
    mass = {"mass": 2, "com": [0.2, 0.1, 0.3], "inertia": {"xx": 0.3, "yy": 0.4, "zz": 0.5}}
    joints = [{"type": "revolute", "coordinate": f"q{k}", "d": k / 2} for k in range(3)]
    hosts = ["base", "b0", "b1"]
    bodies = [{"name": f"b{k}", "parent": hosts[k], "joint": joints[k], **mass} for k in range(3)]
    free = {"name": "arm", "bodies": bodies}
    tied = {**free, "relations": [{"coordinate": "q2", "of": "q1", "multiplier": -2, "offset": 0.3}]}
    found = []
    for definition, q in ((tied, [0.3, 0.7]), (free, [0.3, 0.7, -1.1])):
        tree = {
            "name": "t",
            "parameters": {"base_": {"value": 1}},
            "instances": [{"name": "base", "substructure": "arm"}],
        }
        spec, parts = TreeSpec.read(tree), {"base": derive(definition)}
        found.append(evaluate(Sources(couple(spec, parts), of_parts=of_parts(spec, parts)), QUANTITIES, q))
    N = np.zeros((9, 8))
    N[:8, :8] = np.eye(8)
    N[8, 7] = -2
    left, whole = found
    np.testing.assert_allclose(left["floating_metric"], N.T @ whole["floating_metric"] @ N, rtol=1e-13, atol=1e-13)
    reduced = np.einsum("abc,ai,bj,ck->ijk", whole["floating_christoffel"], N, N, N)
    np.testing.assert_allclose(left["floating_christoffel"], reduced, rtol=1e-13, atol=1e-13)


def test_what_it_costs() -> None:
    """The pose of the base is in nothing: of the arm on a base with six angles and places it is in everything."""
    parts = {"a": derive("puma560")}
    spec = TreeSpec.read({"name": "t", "instances": [{"name": "a", "substructure": "puma560"}]})
    metric, symbols = floating_metric(spec, parts), floating_christoffel(spec, parts)
    assert metric.program.count()["total"] <= 439
    assert symbols.program.count()["total"] <= 1093
    kinds = {symbol.name for symbol in symbols.program.symbols if symbol.kind == "coordinate"}
    assert kinds == {f"a.q{k}" for k in range(1, 7)}


def test_planted_faults_are_found(monkeypatch: pytest.MonkeyPatch) -> None:
    spec, parts = (
        TreeSpec.read({"name": "t", "instances": [{"name": "a", "substructure": "acrobot"}]}),
        {"a": derive("acrobot")},
    )
    right = module.model_outputs
    made = {
        "floating metric": ("metric", floating_metric),
        "floating Christoffel symbols": ("christoffel", floating_christoffel),
    }
    for told, (name, make) in made.items():
        seen: list[Any] = []

        def noted(*given: Any, name: str = name, seen: list[Any] = seen) -> Any:
            """Which elements of the base there are."""
            found = right(*given)
            seen.extend(index for index in found[name].entries if min(index) < 6)
            return found

        monkeypatch.setattr(module, "model_outputs", noted)
        make(spec, parts)
        for index in np.random.default_rng(0).choice(len(seen), 8, replace=False):

            def wrong(*given: Any, name: str = name, index: Any = seen[index]) -> Any:
                """By one too large."""
                found = right(*given)
                entries = {**found[name].entries, index: found[name].entries[index] + 1}
                return {**found, name: replace(found[name], entries=entries)}

            monkeypatch.setattr(module, "model_outputs", wrong)
            with pytest.raises(VerificationFailed, match=told):
                make(spec, parts)


def test_given_motions_are_refused() -> None:
    tree = {"name": "t", "driven": {"a.q1": "sin(t)"}, "instances": [{"name": "a", "substructure": "acrobot"}]}
    with pytest.raises(InvalidInput) as caught:
        floating_metric(TreeSpec.read(tree), {"a": derive("acrobot")})
    assert caught.value.faults[0].code == "has-driven"


def test_large_ones_are_refused(monkeypatch: pytest.MonkeyPatch) -> None:
    spec, parts = (
        TreeSpec.read({"name": "t", "instances": [{"name": "a", "substructure": "acrobot"}]}),
        {"a": derive("acrobot")},
    )
    with pytest.raises(TooLarge):
        floating_metric(spec, parts, 10)
    monkeypatch.setattr("substructures.mechanics.formula_size.MOST_CHRISTOFFEL", 5)
    with pytest.raises(TooLarge, match="in elements"):
        floating_christoffel(spec, parts)
