"""Linearisations of trees with ball and floating joints: differences, chains of angles, tops, satellites."""

# ruff: noqa: N806 -- symbols of the notation

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
from ball_trees import apart, displaced, random_balls, random_position
from in_depth import seeds
from random_trees import model_of
from scipy.integrate import solve_ivp
from scipy.spatial.transform import Rotation

from substructures import Model, equilibria, evaluate, frequency_response, linearise, regulator
from substructures.analysis.equations.perturbation import perturbation, state_space
from substructures.analysis.stability.linearisation_result import BallLinearisation
from substructures.analysis.stability.root_locus import root_locus
from substructures.errors import InvalidArgument
from substructures.expr.interpret import interpret
from substructures.quantities.numbers.quaternions import moved_on

Plain = dict[str, Any]
J1, J2, J3 = 1.0, 2.0, 2.5


def single(joint: str, inertia: Plain, com: list[Any], gravity: list[Any]) -> Model:
    body = {"name": "b", "parent": "base", "mass": 2, "com": com, "joint": {"type": joint}, "inertia": inertia}
    return model_of({"name": "top", "bodies": [body]}, gravity=gravity)


def at_a_state(seed: int) -> tuple[Model, np.ndarray, np.ndarray, Plain]:
    """A random tree, and a state of it with its other conditions."""
    definition, rng = random_balls(seed, 2, 8)
    model = model_of(definition)
    q, v = random_position(rng, model), rng.uniform(-1, 1, model.dof)
    parameters = {s.name: rng.uniform(0.5, 1) for s in model.program.symbols if s.kind == "parameter"}
    return model, q, v, {"inputs": {name: rng.uniform(-1, 1) for name in model.input_names}, "parameters": parameters}


@pytest.mark.parametrize("seed", seeds(3, 30))
def test_random_trees_by_differences(seed: int) -> None:
    """A and B of v' = f(q, v, u) and of displacements along the motion."""
    model, q, v, given = at_a_state(seed)
    found, n, h = linearise(model, q, qd=v, **given), model.dof, 1e-5
    assert isinstance(found, BallLinearisation)
    if np.linalg.cond(found.M) > 1e9:  # massless bodies between two balls have no accelerations
        assert "singular" in found.message
        return
    assert found.status == "finished"

    def second(at: np.ndarray, rates: np.ndarray, inputs: Plain) -> np.ndarray:
        more = {**given, "inputs": {**given["inputs"], **inputs}}
        return np.asarray(evaluate(model, "forward_dynamics", at, rates, **more)["forward_dynamics"])

    def flow(at: np.ndarray, rates: np.ndarray, t: float) -> np.ndarray:
        """At constant rates."""
        return displaced(model, at, rates * t)

    A, small = np.zeros((2 * n, 2 * n)), 1e-4
    for k, e in enumerate(np.eye(2 * n)):
        sides, apart_at = [], []
        for way in (h, -h):
            there, rates = displaced(model, q, way * e[:n]), v + way * e[n:]
            sides.append(second(there, rates, {}))
            ends = [apart(model, flow(q, v, t), flow(there, rates, t)) for t in (small, -small)]
            apart_at.append((ends[0] - ends[1]) / (2 * small))
        A[:n, k], A[n:, k] = (apart_at[0] - apart_at[1]) / (2 * h), (sides[0] - sides[1]) / (2 * h)
    np.testing.assert_allclose(found.A[:n], A[:n], atol=1e-5)
    np.testing.assert_allclose(found.A[n:], A[n:], atol=1e-7 * np.abs(A).max())
    np.testing.assert_allclose(found.A[:n, :n], found.R, atol=0)
    name = found.inputs[0]
    slope = second(q, v, {name: given["inputs"][name] + 1}) - second(q, v, {})
    np.testing.assert_allclose(found.B[n:, 0], slope, atol=1e-9 * max(1.0, np.abs(slope).max()))


@pytest.mark.parametrize("seed", seeds(2, 10))
def test_formulas_are_the_numbers(seed: int) -> None:
    model, q, v, given = at_a_state(seed)
    outputs = {"y": f"{model.positions[-1]}^2 + 3*{model.coordinates[-1]}'", "z": model.positions[0]}
    found = linearise(model, q, qd=v, outputs=outputs, **given)
    values = dict(zip(model.positions, q, strict=True)) | given["inputs"] | given["parameters"] | {"t": 0.0}
    values |= {f"{name}'": x for name, x in zip(model.coordinates, v, strict=True)}
    space = interpret(state_space(model, list(outputs.values())), values)
    for name, x in {"A": found.A, "B": found.B, "C": found.C, "D": found.Dy}.items():
        np.testing.assert_allclose(space[name], x, rtol=1e-9, atol=1e-9 * np.abs(found.A).max(), err_msg=name)
    expected = evaluate(model, ["position_rates", "forward_dynamics"], q, v, **given)
    np.testing.assert_allclose(
        space["derivative"], np.concatenate([expected["position_rates"], expected["forward_dynamics"]]), rtol=1e-9
    )
    values |= {f"{name}''": x for name, x in zip(model.coordinates, found.qdd, strict=True)}
    matrices = interpret(perturbation(model), values)
    for name, x in {"metric": found.M, "stiffness": found.K, "rates_by_position": found.R}.items():
        np.testing.assert_allclose(matrices[name], x, atol=1e-9 * max(1.0, np.abs(x).max()), err_msg=name)
    # y by differences of displacements
    h, n = 1e-6, model.dof
    ends = [displaced(model, q, way * np.eye(n)[n - 1])[model.positions.index(outputs["z"])] for way in (h, -h)]
    assert found.C[1, n - 1] == pytest.approx((ends[0] - ends[1]) / (2 * h), abs=1e-8)


def hanging(joint: str) -> Model:
    """Two bodies below each other, with a spring from the second one to the base and dampers."""
    inertia = {"xx": 0.2, "yy": 0.3, "zz": 0.25, "xy": 0.02}
    placement = {"position": [0, 0, 0], "rpy": ["0.3", "0.4", "-0.2"]}
    definition = {
        "name": "chain",
        "bodies": [
            {"name": "a", "parent": "base", "mass": 2, "com": [0.1, 0.2, -0.5], "inertia": inertia,
             "joint": {"type": joint, "placement": placement}},
            {"name": "b", "parent": "a", "mass": 1, "com": [0.3, -0.1, -0.4], "inertia": inertia,
             "joint": {"type": joint, "placement": {"position": [0.1, 0.1, -1]}}},
        ],
        "loads": [
            {"type": "spring", "from": {"body": "base", "at": [0.4, 0, 0]}, "to": {"body": "b", "at": [0.2, 0.1, -0.3]},
             "stiffness": 3, "damping": "0.2"},
            {"type": "spring", "from": {"body": "base", "at": [0, 0.5, 0]}, "to": {"body": "a", "at": [0.3, 0, 0]},
             "stiffness": 5, "length": "0.1", "damping": "0.3"},
        ],
    }  # fmt: skip
    if joint == "spherical":
        for body, names in zip(definition["bodies"], (["u", "v", "w"], ["x", "y", "z"]), strict=True):
            body["joint"]["coordinate"] = names
    return model_of(definition, gravity=[0.5, 0.7, "-9.81"])


def test_modes_are_those_of_the_chain_of_angles() -> None:
    """An equilibrium has the same eigenvalues in any coordinates."""
    angles, balls = hanging("spherical"), hanging("ball")
    (found,) = equilibria(angles, starts=[1.7, 0.4, -0.7, -3, 0.8, 0.1], count=0).found[-1:]
    turns = evaluate(angles, "kinematics", found.q)["kinematics"]["rotation"]
    first, second = (Rotation.from_matrix(turns[angles.frames.index(f"x.{name}")]) for name in ("a", "b"))
    before = Rotation.from_euler("xyz", [0.3, 0.4, -0.2])
    q = np.concatenate([x.as_quat(scalar_first=True) for x in (before.inv() * first, first.inv() * second)])
    at = linearise(balls, q)
    assert at.is_equilibrium
    assert at.stability is not None
    assert at.stability.verdict == "asymptotically stable"
    roots = [np.sort_complex(np.linalg.eigvals(x.A)) for x in (found.at, at)]
    np.testing.assert_allclose(roots[1], roots[0], rtol=1e-8, atol=1e-9)
    np.testing.assert_allclose(at.K, at.K.T, atol=1e-8)
    by_mode = [[mode.eigenvalue for mode in x.modes] for x in (found.at, at)]
    np.testing.assert_allclose(by_mode[1], by_mode[0], rtol=1e-7)


@pytest.mark.parametrize("factor", [0.9, 1.1])
def test_a_sleeping_top_is_stable_above_the_known_spin(factor: float) -> None:
    """C^2 w^2 > 4 A m g l (Lagrange): A z'' - i C w z' - m g l z = 0 of z = x + i y, seen from turning axes."""
    C, m, g, l_ = 0.1, 2, 9.81, 0.3
    model = single("ball", {"xx": 0.5, "yy": 0.5, "zz": C}, [0, 0, "0.3"], [0, 0, "-9.81"])
    A = 0.5 + m * l_**2
    w = factor * np.sqrt(4 * A * m * g * l_) / C
    found = linearise(model, [np.cos(0.2), 0, 0, np.sin(0.2)], qd=[0, 0, w])
    np.testing.assert_allclose(found.qdd, 0, atol=1e-12)
    half = np.sqrt(complex((C * w) ** 2 - 4 * A * m * g * l_))
    z = np.array([1j * (C * w + way * half) / (2 * A) - 1j * w for way in (1, -1)])
    expected = np.concatenate([z, z.conj(), [0, 0]])
    roots = np.linalg.eigvals(found.A)
    for each in expected:
        assert np.abs(roots - each).min() < 1e-6 * w
    assert (roots.real.max() > 0.1) == (factor < 1)
    assert (found.is_equilibrium, isinstance(found, BallLinearisation) and found.is_steady) == (False, True)
    assert found.stability is not None
    assert found.stability.verdict == ("unstable" if factor < 1 else "undecided")
    largest = max(mode.eigenvalue.real for mode in found.modes)
    assert largest == pytest.approx(max(z.real.max(), 0), abs=1e-6 * w)
    leaning = linearise(model, [np.cos(0.2), np.sin(0.2), 0, 0], qd=[0, 0, w])
    assert leaning.stability is None


@pytest.mark.parametrize(("axis", "square"), [(0, -1), (1, 1), (2, -1)])
def test_a_free_body_turns_stably_about_its_least_and_largest_axis(axis: int, square: int) -> None:
    """Euler: s^2 = w^2 (J_j - J)(J - J_k)/(J_j J_k) for turning about the axis of J."""
    J = np.array([J1, J2, J3])
    model = single("floating", {"xx": J1, "yy": J2, "zz": J3}, [0, 0, 0], [0, 0, 0])
    w = np.zeros(6)
    w[3 + axis] = 3.0
    q = displaced(model, np.array([0.1, 0.2, 0.3, 1, 0, 0, 0]), np.array([0, 0, 0, 0.4, -0.5, 0.6]))
    found = linearise(model, q, qd=w)
    roots = np.linalg.eigvals(found.A)
    j, k = (i for i in range(3) if i != axis)
    s = np.sqrt(complex(9 * (J[j] - J[axis]) * (J[axis] - J[k]) / (J[j] * J[k])))
    assert np.sign((s**2).real) == square
    assert np.abs(roots - s).min() < 1e-9
    assert roots.real.max() == pytest.approx(max(s.real, 0.0), abs=1e-6)
    assert found.stability is not None
    assert found.stability.verdict == ("unstable" if square > 0 else "undecided")
    assert "about a steady motion" in repr(found)


def test_where_constant_rates_lead() -> None:
    """As an integrator has it, also for small turns; and a spring that is slack now alone makes no steady motion."""
    model = single("floating", {"xx": 1, "yy": 1, "zz": 2}, [0, 0, 0], [0, 0, 0])
    rng = np.random.default_rng(1)
    q = displaced(model, np.array([0.1, 0.2, 0.3, 1, 0, 0, 0]), rng.uniform(-1, 1, 6))
    for v in (rng.uniform(-2, 2, 6), np.array([0.5, -1, 2, 0, 0, 0.0]), np.array([1, 0, 0, 0, 3e-5, 0])):

        def moved(_: float, at: np.ndarray, v: np.ndarray = v) -> np.ndarray:
            unit = np.concatenate([at[:3], at[3:] / np.linalg.norm(at[3:])])
            return np.asarray(evaluate(model, "position_rates", unit, v)["position_rates"])

        expected = solve_ivp(moved, (0, 1), q, "DOP853", rtol=1e-11, atol=1e-12).y[:, -1]
        there = moved_on(model.positions, model.coordinates, model.balls, q, v)
        np.testing.assert_allclose(there, expected, rtol=0, atol=1e-9)
    body = {"name": "b", "parent": "base", "mass": 2, "joint": {"type": "floating"},
            "inertia": {"xx": 1, "yy": 1, "zz": 2}}  # fmt: skip
    ends = {"from": {"body": "base", "at": [1, 0, 0]}, "to": {"body": "b", "at": [0, 0, 0]}}
    held = model_of({"name": "d", "bodies": [body], "loads": [{"type": "spring", **ends, "stiffness": 3, "length": 1}]},
                    gravity=[0, 0, 0])  # fmt: skip
    for speed, known in ((0, True), (0.5, False)):
        found = linearise(held, [0, 0, 0, 1, 0, 0, 0], qd=[speed, 0, 0, 0, 0, 0])
        np.testing.assert_allclose(found.qdd, 0, atol=1e-14)
        assert (found.stability is not None) == known
    wheel = {"name": "w", "parent": "b", "joint": {"type": "revolute", "coordinate": "s", "stiffness": 2, "d": 0},
             "inertia": {"xx": 1, "yy": 1, "zz": 1}, "mass": 1}  # fmt: skip
    passing = model_of({"name": "d", "bodies": [body, wheel]}, gravity=[0, 0, 0])
    found = linearise(passing, [0, 0, 0, 1, 0, 0, 0, 0], qd=[0, 0, 0, 0, 0, 0, 1])
    np.testing.assert_allclose(found.qdd, 0, atol=1e-14)
    assert found.stability is None


def test_equilibria_are_found_at_any_attitude() -> None:
    """The pendulum hangs and stands, turned about the vertical as is all one; the chain has no singular angles."""
    model = single("ball", {"xx": 0.5, "yy": 0.5, "zz": 0.3}, ["0.1", 0, "0.3"], [0, 0, "-9.81"])
    found = equilibria(model, count=12)
    assert (len(found.found), found.is_right, found.held) == (2, True, ())
    assert sorted(each.verdict for each in found.found) == ["undecided", "unstable"]
    for each in found.found:
        down = Rotation.from_quat(each.q, scalar_first=True).apply([0.1, 0, 0.3])
        np.testing.assert_allclose(np.abs(down), [0, 0, np.hypot(0.1, 0.3)], atol=1e-9)
        # about the vertical, in the axes of the body
        np.testing.assert_allclose(np.abs(each.free), [np.array([0.1, 0, 0.3]) / np.hypot(0.1, 0.3)], atol=1e-8)
    many = equilibria(hanging("ball"), count=8)
    assert (many.message, many.is_right) == ("", True)
    assert all(each.at.status == "finished" for each in many.found)
    given = equilibria(hanging("ball"), starts=many.found[0].q, count=0)
    assert any(np.allclose(each.q, many.found[0].q, atol=1e-9) for each in given.found)
    free = equilibria(single("floating", {"xx": 1, "yy": 1, "zz": 1}, [0, 0, 0], [0, 0, -1]), count=4)
    assert (free.found, free.held) == ((), ("x.r_b_x", "x.r_b_y", "x.r_b_z"))
    with pytest.raises(InvalidArgument, match="norm") as caught:
        equilibria(model, starts=[[2, 0, 0, 0]])
    assert caught.value.faults[0].pointer == "/starts"


def test_root_loci_of_a_hanging_body() -> None:
    """The frequencies of the pendulum over its length."""
    definition = {
        "name": "top",
        "parameters": {"l": {"value": "0.3", "unit": "m"}},
        "bodies": [{"name": "b", "parent": "base", "mass": 2, "com": [0, 0, "-l"], "joint": {"type": "ball"},
                    "inertia": {"xx": 0.5, "yy": 0.5, "zz": 0.3}}],
    }  # fmt: skip
    model = model_of(definition, gravity=[0, 0, "-9.81"])
    lengths = np.array([0.3, 0.5, 0.7])
    found = root_locus(model, "l", lengths, [1, 0, 0, 0])
    assert found.q.shape == (3, 4)
    w = np.sqrt(2 * 9.81 * lengths / (0.5 + 2 * lengths**2))
    np.testing.assert_allclose(np.abs(found.eigenvalues.imag).max(axis=1), w, rtol=1e-9)


def test_satellites_are_regulated_and_answer() -> None:
    """J d'' = u about each axis: G = -1/(J w^2), of the quaternion half of it; K = (1, sqrt(2 J)) of weights 1."""
    model = single("ball", {"xx": J1, "yy": J2, "zz": J3}, [0, 0, 0], [0, 0, 0])
    found = frequency_response(model, [1, 0, 0, 0], frequencies=[2.0])
    assert found.outputs == model.positions
    np.testing.assert_allclose(
        found.response[0, 1:],
        np.diag(-0.5 / (4 * np.array([J1, J2, J3]))),
        atol=1e-12,
    )
    turned = np.array([0.5, 0.5, -0.5, 0.5])
    held = regulator(model, turned)
    assert held.is_right
    np.testing.assert_allclose(
        held.gain, np.hstack([np.eye(3), np.diag(np.sqrt(2 * np.array([J1, J2, J3])))]), atol=1e-9
    )
    weighted = regulator(model, turned, weights={"x.w_b_x": 4, "x.w_b_x'": 1, "x.w_b_y": 1, "x.w_b_z": 1})
    np.testing.assert_allclose(weighted.gain[0, [0, 3]], [2, np.sqrt(1 + 4 * J1)], atol=1e-9)


@pytest.mark.parametrize("size", [1, 1e-3])
def test_a_spring_that_pulls_at_the_centre_now_alone_makes_no_steady_motion(size: float) -> None:
    """However small: of 1 m, or 1 mm with 1e-6 of the mass and 1e-4 of the stiffness."""
    J = {name: f"{x}*{size**4:.0e}*{size:.0e}" for name, x in {"xx": J1, "yy": J2, "zz": J3}.items()}
    joint = {"type": "ball", "coordinate": ["w", "x", "y", "z"]}
    body = {"name": "b", "parent": "base", "mass": f"{size**2:.0e}", "joint": joint, "inertia": J}
    ends = {"from": {"body": "base", "at": [f"2*{size}", 0, 0]}, "to": {"body": "b", "at": [f"{size}", 0, 0]}}
    spring = {"type": "spring", **ends, "stiffness": f"{10 * size**1.5:.0e}", "length": 0}
    model = model_of({"name": "spun", "bodies": [body], "loads": [spring]}, (0, 0, 0))
    found = linearise(model, [1, 0, 0, 0], qd=[0, 0, 1])
    np.testing.assert_allclose(found.qdd, 0, atol=1e-12)
    assert found.stability is None
