"""Frequency responses, what inputs reach, and regulators, beside closed forms."""

# ruff: noqa: N806 -- symbols of the notation

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
from scipy.integrate import solve_ivp
from scipy.linalg import solve_continuous_lyapunov

from substructures import InvalidInput, Model, couple, derive, frequency_response, linearise, regulator
from substructures.analysis.stability import regulator as regulators

G = 9.81
OSCILLATOR = {
    "name": "oscillator",
    "bodies": [
        {"name": "b", "parent": "base", "mass": 2,
         "joint": {"type": "prismatic", "coordinate": "x", "stiffness": 18, "damping": 0.5}}
    ],
}  # fmt: skip


def alone(definition: Any, gravity: Any = (0, 0, -G)) -> Model:
    part = derive(definition)
    tree = {"name": "t", "gravity": list(gravity), "instances": [{"name": "p", "substructure": part.name}]}
    return couple(tree, {"p": part})


@pytest.fixture(scope="module")
def oscillator() -> Model:
    return alone(OSCILLATOR, (0, 0, 0))


@pytest.fixture(scope="module")
def pendulum() -> Model:
    return alone("simple-pendulum")


@pytest.fixture(scope="module")
def cart() -> Model:
    return alone("cart-pendulum")


def test_the_response_of_an_oscillator(oscillator: Model) -> None:
    """G = 1/(k - m w^2 + i d w), of the velocity i w G, of the force through the spring and damper (k + i d w) G."""
    w = np.array([0.0, 1.0, 3.0, 30.0])
    outputs = {"x": "p.x", "rate": "p.x'", "force": "18*p.x + 0.5*p.x'", "through": "tau.p.x"}
    found = frequency_response(oscillator, [0], frequencies=w, outputs=outputs)
    expected = 1 / (18 - 2 * w**2 + 0.5j * w)
    assert found.response[:, 0, 0] == pytest.approx(expected, rel=1e-12)
    assert found.response[:, 1, 0] == pytest.approx(1j * w * expected, rel=1e-12)
    assert found.response[:, 2, 0] == pytest.approx((18 + 0.5j * w) * expected, rel=1e-12)
    assert found.response[:, 3, 0] == pytest.approx(np.ones(4), rel=1e-12)
    assert found.magnitude[2, 0, 0] == pytest.approx(1 / 1.5)
    assert found.phase[:, 0, 0] == pytest.approx(np.angle(expected))
    assert sorted(found.poles.imag) == pytest.approx(np.array([-1, 1]) * np.sqrt(9 - 0.125**2))


def test_the_response_is_that_of_a_simulated_motion(cart: Model) -> None:
    """Of the hanging pendulum on a cart that damping has settled, at one frequency."""
    found = frequency_response(cart, [0, np.pi], frequencies=[3.0], of_inputs=["tau.p.q0"], outputs={"a": "p.q1"})
    system = linearise(cart, [0, np.pi], of_inputs=["tau.p.q0"])
    # x = X e^(i w t) of x' = A x + B e^(i w t), from its own start
    X = np.linalg.solve(3j * np.eye(4) - system.A, system.B[:, 0])
    ends = solve_ivp(lambda t, x: system.A @ x + system.B[:, 0] * np.cos(3 * t), (0, 2), X.real, rtol=1e-10, atol=1e-12)
    assert ends.y[1, -1] == pytest.approx((found.response[0, 0, 0] * np.exp(6j)).real, rel=1e-6)


def test_frequencies_by_default_span_the_poles(pendulum: Model) -> None:
    found = frequency_response(pendulum, [0])
    speed = abs(found.poles[0])
    assert (found.frequencies[0], found.frequencies[-1]) == pytest.approx((speed / 10, 10 * speed))
    assert np.isfinite(found.response).all()


def test_frequencies_by_default_span_slow_poles() -> None:
    """A spring of 1e-14 N/m on 1 kg: 1e-7 rad/s."""
    joint = {"type": "prismatic", "stiffness": "1/10^14"}
    found = frequency_response(
        alone({"name": "m", "bodies": [{**OSCILLATOR["bodies"][0], "joint": joint}]}, (0, 0, 0)), [0]
    )
    np.testing.assert_allclose(found.frequencies[[0, -1]], np.sqrt(0.5) * np.array([1e-8, 1e-6]))


def test_a_pole_is_told() -> None:
    free = alone({**OSCILLATOR, "bodies": [{**OSCILLATOR["bodies"][0], "joint": {"type": "prismatic"}}]}, (0, 0, 0))
    found = frequency_response(free, [0], frequencies=[1.0, 0.0])
    assert (found.status, found.message.startswith("0 rad/s is a pole")) == ("failed", True)


def test_a_resonance_without_damping_is_a_pole(pendulum: Model) -> None:
    found = frequency_response(pendulum, [0], frequencies=[np.sqrt(G)])
    assert (found.status, found.message.startswith("3.13209 rad/s is a pole")) == ("failed", True)
    beside = frequency_response(pendulum, [0], frequencies=[np.sqrt(G) * (1 + 1e-9)])
    assert beside.status == "finished"
    np.testing.assert_allclose(beside.magnitude, 1 / (2 * G * 1e-9), rtol=1e-5)


def test_the_regulator_of_a_mass() -> None:
    """x'' = u: K = (1, sqrt 2), eigenvalues of a Butterworth filter (Kalman)."""
    free = alone({**OSCILLATOR, "bodies": [{"name": "b", "parent": "base", "mass": 1, "joint": {"type": "prismatic"}}]})
    found = regulator(free, [0], inputs={"tau.p.q_b": G})
    assert found.gain[0] == pytest.approx([1, np.sqrt(2)])
    assert sorted(found.eigenvalues.imag) == pytest.approx([-np.sqrt(0.5), np.sqrt(0.5)])
    assert (found.controllable, found.observable, found.is_right) == (True, True, True)


def test_the_regulator_of_an_upright_pendulum(pendulum: Model) -> None:
    """m l^2 p'' = m g l p + u: k1 = a + sqrt(a^2 + q), k2 = sqrt(2 k1 J) with a = m g l, J = m l^2, R = 1."""
    system = linearise(pendulum, [np.pi])
    J, a = float(system.M[0, 0]), -float(system.K[0, 0])
    found = regulator(pendulum, [np.pi], weights={"p.q1": 4.0, "p.q1'": 0.0})
    k1 = a + np.sqrt(a**2 + 4)
    assert found.gain[0] == pytest.approx([k1, np.sqrt(2 * k1 * J)], rel=1e-9)
    assert found.is_right


def test_the_cost_is_that_of_the_motions(cart: Model) -> None:
    """x_0^T P x_0 is the integral of x^T Q x + u^T R u along x' = (A - B K) x, by Lyapunov's equation."""
    weights = {"p.q0": 1.0, "p.q1": 10.0, "p.q0'": 0.1}
    found = regulator(cart, [0, 0], weights=weights, efforts={"tau.p.q0": 0.01}, of_inputs=["tau.p.q0"])
    assert found.controllable
    assert found.is_right
    system = linearise(cart, [0, 0], of_inputs=["tau.p.q0"])
    closed = system.A - system.B @ found.gain
    spent = np.diag([1.0, 10.0, 0.1, 0.0]) + 0.01 * found.gain.T @ found.gain
    assert solve_continuous_lyapunov(closed.T, -spent) == pytest.approx(found.cost, rel=1e-7)


def test_closed_loops_are_those_of_their_free_coordinate() -> None:
    """Two carts of 1 and 3 kg, welded, one on a spring: 1/(k - m w^2 + i d w) and the regulator of one cart of 4 kg."""

    def cart(name: str, mass: float, **joint: float) -> Any:
        moved = {"type": "prismatic", "coordinate": "x", **joint}
        bodies = [{"name": "b", "parent": "base", "mass": mass, "joint": moved}]
        return derive({"name": name, "bodies": bodies, "ports": [{"name": "top", "body": "b"}]})

    spring = {"stiffness": 18, "damping": 0.5}
    parts = {"a": cart("a", 1, **spring), "b": cart("b", 3), "one": cart("one", 4, **spring)}
    weld = {"name": "weld", "type": "weld", "from": "a.top", "to": "b.top"}
    pair = [{"name": name, "substructure": name} for name in "ab"]
    closed = couple({"name": "t", "instances": pair, "closures": [weld]}, {name: parts[name] for name in "ab"})
    single = couple({"name": "t", "instances": [{"name": "one", "substructure": "one"}]}, {"one": parts["one"]})
    w = np.array([0.0, 1.0, 3.0])
    found = frequency_response(closed, [0, 0], frequencies=w, of_inputs=["tau.a.x"])
    assert found.outputs == ("a.x", "b.x")
    for k in range(2):
        assert found.response[:, k, 0] == pytest.approx(1 / (18 - 4 * w**2 + 0.5j * w), rel=1e-12)
    # both carts count
    two = regulator(closed, [0, 0], weights={"a.x": 1, "b.x": 4, "b.x'": 2}, of_inputs=["tau.b.x"])
    one = regulator(single, [0], weights={"one.x": 5, "one.x'": 2})
    assert two.gain == pytest.approx(one.gain, rel=1e-9)
    assert (two.coordinates, two.is_right, two.controllable) in ((("a.x",), True, True), (("b.x",), True, True))


def test_the_response_of_a_sledge() -> None:
    """A knife edge along x: m x'' = u and no way aside, G = -1/(m w^2)."""
    slide = {"type": "prismatic", "placement": {"position": [0, 0, 0]}}
    bodies: Any = [
        {"name": "a", "parent": "base", "joint": {**slide, "coordinate": "x", "axis": [1, 0, 0]}, "mass": 1},
        {"name": "b", "parent": "a", "joint": {**slide, "coordinate": "y", "axis": [0, 1, 0]}, "mass": 3},
    ]
    part = derive({"name": "sledge", "bodies": bodies, "ports": [{"name": "edge", "body": "b"}]})
    tree: Any = {"name": "t", "instances": [{"name": "s", "substructure": "sledge"}]}
    tree |= {"velocity_constraints": [{"name": "edge", "type": "knife_edge", "frame": "s.edge"}]}
    model = couple(tree, {"s": part})
    found = frequency_response(model, [0, 0], frequencies=[1.0, 2.0], of_inputs=["tau.s.x"])
    assert found.response[:, 0, 0] == pytest.approx([-1 / 4, -1 / 16], rel=1e-12)
    assert np.abs(found.response[:, 1, 0]).max() < 1e-14
    assert regulator(model, [0, 0], weights={"s.x": 1}).gain[0] == pytest.approx([1, np.sqrt(8)], rel=1e-9)
    assert "'s.y'" in regulator(model, [0, 0], weights={"s.x": 1, "s.y": 1}).message
    with pytest.raises(InvalidInput) as caught:
        regulator(model, [0, 0])
    assert (caught.value.faults[0].pointer, caught.value.faults[0].code) == ("/weights", "missing")


def test_what_no_input_moves_and_no_weight_sees_is_told() -> None:
    part = derive("simple-pendulum")
    instances = [{"name": name, "substructure": "simple-pendulum"} for name in ("a", "b")]
    two = couple({"name": "t", "gravity": [0, 0, -G], "instances": instances}, {"a": part, "b": part})
    found = regulator(two, [np.pi, np.pi], of_inputs=["tau.a.q1"])
    assert (found.controllable, found.status, found.is_right) == (False, "failed", None)
    assert "no input moves the mode" in found.message
    found = regulator(two, [0.0, 0.0], weights={"a.q1": 1.0})
    assert (found.observable, found.status) == (False, "failed")
    assert "no weight sees the mode" in found.message


def test_a_wrong_solution_is_seen(pendulum: Model, monkeypatch: pytest.MonkeyPatch) -> None:
    right = regulators.scipy.linalg.solve_continuous_are
    monkeypatch.setattr(regulators.scipy.linalg, "solve_continuous_are", lambda *a: right(*a) * (1 + 1e-6))
    assert regulator(pendulum, [np.pi]).is_right is False


@pytest.mark.parametrize(
    ("given", "pointer"),
    [
        ({"weights": {"p.q9": 1}}, "/weights/p.q9"),
        ({"weights": {"p.q1": -1}}, "/weights/p.q1"),
        ({"weights": {"p.q1": "1"}}, "/weights/p.q1"),
        ({"efforts": {"tau.p.q1": 0}}, "/efforts/tau.p.q1"),
        ({"efforts": {"tau": 1}}, "/efforts/tau"),
        ({"q": [0.3]}, "/q"),
        ({"q": [[0.0], [0.1]]}, "/q"),
        ({"of_inputs": []}, "/of_inputs"),
        ({"of_inputs": ["x"]}, "/of_inputs/0"),
    ],
)
def test_bad_input(given: Any, pointer: str, pendulum: Model) -> None:
    with pytest.raises(InvalidInput) as caught:
        regulator(pendulum, given.pop("q", [0.0]), **given)
    assert caught.value.faults[0].pointer == pointer
    if "weights" not in given and "efforts" not in given and pointer != "/q":
        with pytest.raises(InvalidInput):
            frequency_response(pendulum, [0.0], **given)


def test_bad_frequencies(pendulum: Model) -> None:
    wrong: dict[str, list[Any]] = {
        "/frequencies": [[], [-1.0], np.ones((1, 1))],
        "/frequencies/0": [[np.nan], ["fast"]],
    }
    for pointer, each in wrong.items():
        for given in each:
            with pytest.raises(InvalidInput) as caught:
                frequency_response(pendulum, [0.0], frequencies=given)
            assert caught.value.faults[0].pointer == pointer
