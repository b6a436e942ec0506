"""Forces and torques on bodies that have a potential: V against differences, balances and a motion."""

# ruff: noqa: N806 -- symbols of the notation

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
from in_depth import seeds
from random_trees import Kind, Plain, number, random_definition

from substructures import Definition, Model, TreeSpec, couple, derive
from substructures.analysis.equations.first_integrals import first_integrals
from substructures.analysis.simulate import simulate
from substructures.analysis.stability.equilibria import equilibria
from substructures.errors import VerificationFailed
from substructures.expr.graph import Graph
from substructures.expr.program import program as collect
from substructures.expr.replay import replay
from substructures.quantities.from_parts import NumericTree
from substructures.quantities.numbers.evaluation import evaluate
from substructures.tree.certificate import certify_tree

GRAVITY = (0, -9.81, 0)
RIGID: Plain = {"mass": 1.3, "com": [0.3, 0, 0], "inertia": {"xx": 0.1, "yy": 0.2, "zz": 0.3}}
AXES = {
    "parallel": {"type": "revolute", "coordinate": "p", "d": 0.7},
    "skew": {"type": "revolute", "coordinate": "p", "theta": "pi/2"},
    "slide": {"type": "prismatic", "coordinate": "p", "psi": "pi/2", "theta": "pi/2"},
}


def torque(vector: list[Any], body: str = "a", frame: str = "world") -> Plain:
    return {"type": "torque", "body": body, "vector": vector, "frame": frame}


def force(vector: list[Any], body: str = "a", frame: str = "world", at: Any = (0.5, 0.1, 0)) -> Plain:
    return {"type": "force", "body": body, "vector": vector, "frame": frame, "at": list(at)}


def definition(*loads: Plain, second: str | None = None, **joint: Any) -> Plain:
    bodies = [{"name": "a", "parent": "base", "joint": {"type": "revolute", "coordinate": "q"} | joint, **RIGID}]
    bodies += [{"name": "b", "parent": "a", "joint": AXES[second], **RIGID}] if second else []
    return {"name": "arm", "parameters": {"T": {"value": 2}}, "bodies": bodies, "loads": list(loads)}


def tree(given: Plain, gravity: Any = (0, 0, 0)) -> tuple[TreeSpec, dict[str, Any]]:
    spec = TreeSpec.read({"name": "t", "gravity": list(gravity), "instances": [{"name": "x", "substructure": "arm"}]})
    return spec, {"x": derive(Definition.read(given))}


def model_of(given: Plain, gravity: Any = (0, 0, 0)) -> Model:
    return couple(*tree(given, gravity))


def slope(model: Model, q: np.ndarray) -> np.ndarray:
    """dV/dq by central differences of fourth order at the states (N, n)."""
    h, columns = 1e-3, []
    for e in np.eye(model.dof):
        f = {k: evaluate(model, ["potential_energy"], q=q + k * h * e)["potential_energy"] for k in (-2, -1, 1, 2)}
        columns.append((8 * (f[1] - f[-1]) - (f[2] - f[-2])) / (12 * h))
    return np.stack(columns, axis=-1)


#: what has a potential, by hand: axis e of the joint a is the third of the world, that of a skew joint lies across
CONSERVATIVE: dict[str, tuple[Plain, Any]] = {
    "about the first axis": (definition(torque([0.3, 0, "T"])), lambda q: -2 * q[:, 0]),
    "in the axes of the body": (definition(torque([0.3, 0, "T"], frame="body")), lambda q: -2 * q[:, 0]),
    "of the angle": (definition(torque([0, 0, "T - 3*q"])), lambda q: -2 * q[:, 0] + 1.5 * q[:, 0] ** 2),
    "about parallel axes": (definition(torque([0, 0, "T"], "b"), second="parallel"), lambda q: -2 * q.sum(axis=1)),
    "about a skew axis": (definition(torque([0, 0, "T"], "b"), second="skew"), lambda q: -2 * q[:, 0]),
    "along a slide": (
        definition(force([0, 0, "-T*p"], "b", "body", (0, 0, 0.2)), second="slide"), lambda q: q[:, 1] ** 2
    ),
    "force that turns with its body": (definition(force([0, "T*q", 0], frame="body")), lambda q: -0.5 * q[:, 0] ** 2),
}  # fmt: skip
#: what has none
OTHERS: dict[str, Plain] = {
    "two axes": definition(torque(["T", 0, 0], "b"), second="skew"),
    "follower": definition(force([0, "T", 0], "b", "body"), second="parallel"),
    "of another angle": definition(torque([0, 0, "T*p"]), second="parallel"),
}


@pytest.mark.parametrize("name", CONSERVATIVE)
def test_what_has_a_potential(name: str) -> None:
    given, by_hand = CONSERVATIVE[name]
    model = model_of(given)
    q = np.random.default_rng(1).uniform(-2, 2, (5, model.dof))
    found = evaluate(model, ["potential_energy", "forces"], q=q)
    np.testing.assert_allclose(slope(model, q), -found["forces"], atol=1e-9)
    if by_hand is not None:
        np.testing.assert_allclose(found["potential_energy"], by_hand(q), atol=1e-12)
    assert evaluate(model, ["potential_energy"], q=[0.0] * model.dof)["potential_energy"] == 0
    assert "potential_left_out" not in model.certificate["direct_form"]
    # numbers straight from the parts say the same
    spec, parts = tree(given)
    values = dict(zip(model.coordinates, q.T, strict=True)) | {"x.T": 2.0}
    numbers = NumericTree(spec, parts).evaluate(values, ["potential_energy"])["potential_energy"]
    np.testing.assert_allclose(numbers, found["potential_energy"], atol=1e-12)


@pytest.mark.parametrize("name", OTHERS)
def test_what_has_none(name: str) -> None:
    model = model_of(OTHERS[name])
    q = np.array([[0.4, 0.3]])
    found = evaluate(model, ["potential_energy", "forces"], q=q)
    assert found["potential_energy"][0] == 0
    # nor does the certificate say that something is left out
    assert "potential_left_out" not in model.certificate["direct_form"]
    assert np.abs(found["forces"]).max() > 0.1


def test_a_torque_in_a_part_that_is_carried() -> None:
    """About parallel axes of two parts: V = -T (q1 + q2)."""
    part = definition(torque([0, 0, "T"])) | {"ports": [{"name": "tip", "body": "a", "position": [0.5, 0, 0]}]}
    instances = [{"name": name, "substructure": "arm", "at": at} for name, at in (("x", "world"), ("y", "x.tip"))]
    read = derive(Definition.read(part))
    spec = TreeSpec.read({"name": "t", "gravity": [0, 0, 0], "instances": instances})
    model = couple(spec, {"x": read, "y": read})
    V = evaluate(model, ["potential_energy"], q=[0.3, 0.5])["potential_energy"]
    np.testing.assert_allclose(V, -2 * 0.3 - 2 * (0.3 + 0.5))


def test_energy_is_constant_and_stability_follows() -> None:
    """A pendulum under gravity and a constant torque: m g c cos q = T at the equilibria, stable where it hangs."""
    model = model_of(definition(torque([0, 0, "T"])), GRAVITY)
    assert [each.rule for each in first_integrals(model).integrals if each.name == "energy"] == ["constant"]
    motion = simulate(model, [0.2], (0, 3))
    assert motion.is_right is True
    energy = evaluate(model, ["potential_energy", "kinetic_energy"], q=motion.q, qd=motion.qd)
    total = energy["potential_energy"] + energy["kinetic_energy"]
    np.testing.assert_allclose(total, total[0], atol=1e-8)
    assert np.ptp(energy["kinetic_energy"]) > 1
    # V = m g c sin q - T q: stable where the mass is below the axis
    found = equilibria(model, count=16, seed=3).found
    np.testing.assert_allclose([np.cos(each.q[0]) for each in found], 2 / (1.3 * 9.81 * 0.3), atol=1e-9)
    assert {(bool(each.q[0] < 0), each.verdict) for each in found} == {(True, "stable"), (False, "unstable")}


def test_wrong_potentials_are_refused() -> None:
    """The certificate finds a factor and a constant in the formula, without the graph."""
    spec, parts = tree(CONSERVATIVE["of the angle"][0])
    model = couple(spec, parts)
    for damage in (lambda x: x * 2, lambda x: x + 1, lambda x: -x):
        graph = Graph()
        outputs = replay(model.program, graph, {})
        outputs["potential_energy"].entries[()] = damage(outputs["potential_energy"].entries[()])
        wrong = collect(graph, outputs, {s.name: s for s in model.program.symbols})
        with pytest.raises(VerificationFailed, match="potential_energy"):
            certify_tree(spec, {"x": parts["x"].definition}, model.described(), wrong, 0.0)


@pytest.mark.parametrize("seed", seeds(8, 60))
def test_random_loads(seed: int) -> None:
    """Whatever is found has the forces of these loads as its gradient, and the certificate agrees what there is."""
    rng = np.random.default_rng([seed, 77])
    given = random_definition(rng, Kind(bodies=3, loads=0, springs=0, laws=False), "arm")
    names = [f"q{k + 1}" for k in range(sum(len(_names(body)) for body in given["bodies"]))]
    pick = [str(number(rng)), f"{number(rng)}*{rng.choice(names)}", "0"] if names else ["1"]
    for body in given["bodies"]:
        vector = [str(rng.choice(pick)) for _ in range(3)]
        kind, frame = rng.choice(["force", "torque"]), str(rng.choice(["world", "body"]))
        load = (force if kind == "force" else torque)(vector, body["name"], frame)
        with_load = given | {"loads": [load]}
        model = model_of(with_load)
        if not model.dof:
            continue
        q = rng.uniform(-1, 1, (3, model.dof))
        found = evaluate(model, ["potential_energy", "forces"], q=q)
        V = found["potential_energy"]
        if np.ptp(V) > 0 or np.abs(found["forces"]).max() < 1e-12:
            np.testing.assert_allclose(slope(model, q), -found["forces"], atol=1e-8)


def _names(body: Plain) -> list[str]:
    given = body["joint"].get("coordinate", [])
    return [given] if isinstance(given, str) else given
