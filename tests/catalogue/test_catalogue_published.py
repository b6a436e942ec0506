"""Shipped substructures, alone and coupled, beside what was published of them."""

from __future__ import annotations

import json
from itertools import pairwise
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from formulas import assert_formulas
from independent import defaults, value

from substructures import couple, derive
from substructures.catalogue import load, load_tree
from substructures.part.definition import Definition
from substructures.quantities.numbers.evaluation import evaluate
from substructures.tree.document import TreeSpec
from substructures.tree.model import Model

REFERENCE = Path(__file__).parents[1] / "reference"
HUMANOID = [(i["name"], i["substructure"], i["at"]) for i in load_tree("humanoid")["instances"]]


def mounted(*instances: tuple[str, str, str], gravity: str | None = "g") -> Model:
    """A tree of catalogue entries (instance, entry, at) under gravity along -z."""
    parts = {instance: derive(Definition.read(load(entry))) for instance, entry, _ in instances}
    tree: dict[str, Any] = {
        "name": "tree",
        "gravity": [0, 0, f"-{gravity}"] if gravity else [0, 0, 0],
        "parameters": {gravity: {"value": 9.81, "unit": "m/s^2"}} if gravity else {},
        "instances": [{"name": i, "substructure": entry, "at": at} for i, entry, at in instances],
    }
    return couple(TreeSpec.read(tree), parts)


def reference(name: str) -> dict[str, Any]:
    data: dict[str, Any] = json.loads((REFERENCE / f"{name}.json").read_text())
    return data


FORMULAS = [
    (name, quantity)
    for name in ("simple-pendulum", "acrobot", "cart-pendulum", "andrews-squeezer")
    for quantity in ("metric", "christoffel")
    if quantity in reference(name)
]


@pytest.mark.parametrize(("name", "quantity"), FORMULAS)
def test_published_formulas(name: str, quantity: str) -> None:
    known = reference(name)
    model = mounted(("x", name, "world"), gravity=None)
    place = [model.coordinates.index(f"x.{c}") for c in known["coordinates"]]
    expected = {tuple(place[int(i)] for i in key.split(",")): text for key, text in known[quantity].items()}
    if quantity == "metric":
        expected |= {(b, a): text for (a, b), text in expected.items()}
    assert_formulas(model, quantity, expected, "x.{}".format)


@pytest.mark.parametrize("name", ["simple-pendulum", "acrobot", "cart-pendulum"])
def test_published_gravity(name: str) -> None:
    known = reference(name)
    model = mounted(("x", name, "world"))
    rng = np.random.default_rng(7)
    for _ in range(3):
        values = {p: float(rng.uniform(0.5, 2)) for p in load(name)["parameters"]} | {"g": 9.81}
        q = {c: float(rng.uniform(-3, 3)) for c in known["coordinates"]}
        answer = evaluate(
            model,
            ["gravity"],
            q=[q[c.removeprefix("x.")] for c in model.coordinates],
            parameters={(p if p == "g" else f"x.{p}"): v for p, v in values.items()},
        )
        expected = [value(text, values | q) for text in known["gravity"]]
        np.testing.assert_allclose(answer["gravity"], expected, rtol=1e-12, atol=1e-12)


def test_puma_560_as_published() -> None:
    known = reference("puma560")
    model = mounted(("arm", "puma560", "world"))
    request = {
        "quantities": ["metric", "coriolis", "gravity", "inverse_dynamics"],
        "q": [value(q) for q in known["q"]],
        "qd": known["qd"],
        "qdd": known["qdd"],
    }
    answer = evaluate(model, **request)
    close = {"rtol": 0, "atol": known["tolerance"]}
    np.testing.assert_allclose(answer["metric"], known["metric"], **close)
    np.testing.assert_allclose(answer["coriolis"], known["coriolis"], **close)
    np.testing.assert_allclose(np.negative(answer["gravity"]), known["gravity"], **close)
    inertial = np.array(answer["metric"]) @ known["qdd"]
    np.testing.assert_allclose(inertial, known["inertial_torque"], **close)


@pytest.mark.parametrize("case", reference("robots")["cases"], ids=lambda case: case["entry"])
def test_robots_as_published(case: dict[str, Any]) -> None:
    """The figures in the frames they were published in, through another engine, and in the frames of the entry."""
    model = mounted(("x", case["entry"], "world"))
    request = {key: case[key] for key in ("q", "qd")} | {"quantities": ["metric", "bias", "gravity"]}
    answer = evaluate(model, **(request | {"parameters": {f"x.{name}": v for name, v in case["parameters"].items()}}))
    for quantity in ("metric", "bias", "gravity"):
        np.testing.assert_allclose(answer[quantity], case[quantity], rtol=1e-10, atol=1e-11)


def test_andrews_squeezer_starts_as_published() -> None:
    """The accelerations of the closed mechanism at the start, its closures cut from the reference."""
    known = reference("andrews-squeezer")
    entry = load("andrews-squeezer")
    values, order = defaults(entry), known["coordinates"]
    model = mounted(("x", "andrews-squeezer", "world"), gravity=None)
    place = [model.coordinates.index(f"x.{c}") for c in order]
    q = np.zeros(7)
    q[place] = known["start"]
    answer = evaluate(model, ["metric", "forces"], q=q.tolist(), qd=[0.0] * 7)
    metric = np.array(answer["metric"])[np.ix_(place, place)]
    forces = np.array(answer["forces"])[place]

    def closures(angles: Any) -> Any:
        known_names = values | dict(zip(order, angles, strict=True))
        return np.array([value(text, known_names) for text in known["closures"]])

    start, step = np.array(known["start"]), 1e-5
    assert np.abs(closures(start)).max() < 1e-15
    jacobian = np.array([(closures(start + step * e) - closures(start - step * e)) / (2 * step) for e in np.eye(7)]).T
    matrix = np.block([[metric, jacobian.T], [jacobian, np.zeros((6, 6))]])
    acceleration = np.linalg.solve(matrix, np.concatenate([forces, np.zeros(6)]))[:7]
    np.testing.assert_allclose(acceleration, known["start_acceleration"], rtol=1e-7, atol=1e-2)


def test_the_limbs_make_a_humanoid() -> None:
    model = mounted(*HUMANOID)
    assert len(model.coordinates) == 34
    q = np.random.default_rng(2).uniform(-0.5, 0.5, 34)
    answer = evaluate(model, ["metric", "gravity"], q=q.tolist())
    metric = np.array(answer["metric"])
    assert np.all(np.linalg.eigvalsh(metric) > 0)
    # the three translations carry the whole mass: the fractions of the segments add up to one
    np.testing.assert_allclose(np.diag(metric)[:3], 73, rtol=1e-12)
    np.testing.assert_allclose(answer["gravity"][:3], [0, 0, -73 * 9.81], rtol=1e-12)


def test_four_legs_make_a_quadruped() -> None:
    """Side and front mirror the published tensors: the stretched robot is symmetric but for its trunk."""
    corners = [("fl", "front_left"), ("fr", "front_right"), ("rl", "rear_left"), ("rr", "rear_right")]
    instances: list[dict[str, Any]] = [{"name": "trunk", "substructure": "quadruped-trunk", "at": "world"}]
    for leg, port in corners:
        signs = {"front": 1 if leg[0] == "f" else -1, "side": 1 if leg[1] == "l" else -1}
        instances.append({"name": leg, "substructure": "quadruped-leg", "at": f"trunk.{port}", "parameters": signs})
    parts = {i["name"]: derive(Definition.read(load(i["substructure"]))) for i in instances}
    model = couple(TreeSpec.read({"name": "quadruped", "gravity": [0, 0, 0], "instances": instances}), parts)
    assert len(model.coordinates) == 18
    metric = np.array(evaluate(model, ["metric"], q=[0.0] * 18)["metric"])
    legs = [metric[np.ix_(i, i)] for i in (range(6 + 3 * k, 9 + 3 * k) for k in range(4))]
    mirror = np.diag([-1.0, 1, 1])
    np.testing.assert_allclose(legs[0], mirror @ legs[1] @ mirror, rtol=1e-12, atol=1e-15)
    for one, other in pairwise(legs):
        np.testing.assert_allclose(np.diag(one)[1:], np.diag(other)[1:], rtol=1e-12)


def test_a_spindle_moves_two_jaws() -> None:
    """I + I_r + 2 m (h / 2 pi)^2 and d + 2 b (h / 2 pi)^2 at the spindle of lead h; jaws 6 mm out after 1.5 turns."""
    model = mounted(("x", "screw-gripper", "world"))
    assert model.coordinates == ("x.turn",)
    turn = 1.5 * 2 * np.pi
    answer = evaluate(model, ["metric", "forces", "bias", "limits", "kinematics"], q=[turn], qd=[2.0])
    ratio = 0.004 / (2 * np.pi)
    np.testing.assert_allclose(answer["metric"], [[2e-6 + 1e-5 + 2 * 0.12 * ratio**2]], rtol=1e-12)
    np.testing.assert_allclose(answer["forces"], [-2 * (2e-5 + 2 * 4 * ratio**2)], rtol=1e-12)
    np.testing.assert_allclose(answer["bias"], [0], atol=1e-18)
    np.testing.assert_allclose(answer["limits"], [[0, 0.03 / ratio]], rtol=1e-12)
    jaws = [answer["kinematics"]["position"][model.frames.index(f"x.{jaw}_pad"), 0] for jaw in ("left", "right")]
    np.testing.assert_allclose(jaws, [1.5 * 0.004, -1.5 * 0.004], rtol=1e-12)
