"""Optimal control with ball and floating joints: turns in closed form, and gradients beside differences."""

# ruff: noqa: N806 -- symbols of the notation

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
from ball_trees import displaced, random_balls, random_position
from scipy.spatial.transform import Rotation

from substructures import ControlProblem, Cost, Demands, End, Model, cost_gradient, couple, derive, optimal_control
from substructures.analysis.control.adjoint import adjoint_equations
from substructures.analysis.control.closed_start import start_state
from substructures.analysis.control.shooting import Shooting
from substructures.certificate.derived.adjoint import adjoint
from substructures.errors import InvalidInput, VerificationFailed
from substructures.expr.program import Program
from substructures.quantities.certificate import DYNAMICS, certified

J = 2.0


def satellite(joint: str = "ball", moments: Any = (2, 2, 2)) -> Model:
    inertia = dict(zip(("xx", "yy", "zz"), moments, strict=True))
    body = {"name": "b", "parent": "base", "mass": 3, "inertia": inertia, "joint": {"type": joint}}
    instance = {"name": "p", "substructure": "satellite"}
    return couple({"name": "t", "instances": [instance]}, {"p": derive({"name": "satellite", "bodies": [body]})})


TORQUES = [f"tau.p.w_b_{axis}" for axis in "xyz"]
EFFORT = " + ".join(f"{u}^2" for u in TORQUES)


def quaternion(*turn: float) -> np.ndarray:
    return np.asarray(Rotation.from_rotvec(turn).as_quat(scalar_first=True))


@pytest.mark.parametrize("sign", [1, -1])
def test_a_round_body_turns_about_one_axis(sign: int) -> None:
    """From rest to rest by an angle a in a time T at least of the integral of u^2: u = 6 J a/T^2 (1 - 2 t/T), which
    costs 12 J^2 a^2/T^3; both quaternions of the attitude are demanded alike.
    """
    start, turn, T = quaternion(0.3, -0.2, 0.9), np.array([0.4, -0.7, 1.1]), 1.5
    a = float(np.linalg.norm(turn))
    end = (Rotation.from_quat(start, scalar_first=True) * Rotation.from_rotvec(turn)).as_quat(scalar_first=True)
    problem = ControlProblem(controls=TORQUES, cost=Cost(EFFORT), horizon=T, intervals=6, steps=4, q=start)
    found = optimal_control(satellite(), problem, Demands(End((sign * end).tolist(), [0, 0, 0]), segments=3))
    assert found.status == "optimal"
    assert found.is_right
    assert found.cost == pytest.approx(12 * J**2 * a**2 / T**3, rel=1e-4)
    t = np.linspace(0, T, 7)
    np.testing.assert_allclose(found.controls, 6 * J / T**2 * (1 - 2 * t / T)[:, None] * turn, atol=0.05)
    assert found.hamiltonian_drift is not None
    assert found.hamiltonian_drift < 1e-2
    reached = Rotation.from_quat(found.trajectory.q[-1], scalar_first=True)
    assert (reached.inv() * Rotation.from_quat(end, scalar_first=True)).magnitude() < 1e-6
    assert found.trajectory.positions == satellite().positions
    again = optimal_control(satellite(), problem, Demands(End(end.tolist(), [0, 0, 0]), segments=3, warm_start=found))
    assert again.cost == pytest.approx(found.cost, rel=1e-5)
    assert again.iterations <= found.iterations


def test_a_place_is_reached_by_a_body_that_turns() -> None:
    """Only where it is, and its pointing by one number of the quaternion; limits along the path hold."""
    model = satellite("floating", (1, 2, "5/2"))
    controls = [f"tau.p.{name}_b_{axis}" for name in "vw" for axis in "xyz"]
    cost = " + ".join(f"{u}^2" for u in controls)
    problem = ControlProblem(
        controls=controls, cost=Cost(cost), horizon=2, intervals=8, steps=2, q=[0, 0, 0, 1, 0, 0, 0]
    )
    end = End({"p.r_b_x": 1, "p.r_b_y": 0, "p.r_b_z": 0, "p.q_b_x": 0.5}, [0] * 6)
    found = optimal_control(model, problem, Demands(end, path={"p.v_b_x'": (None, 0.7)}))
    assert found.status == "optimal"
    assert found.is_right
    np.testing.assert_allclose(found.trajectory.q[-1, :3], [1, 0, 0], atol=1e-6)
    assert abs(found.trajectory.q[-1, 4]) == pytest.approx(0.5, abs=1e-6)
    assert found.trajectory.qd[:, 0].max() < 0.71


@pytest.mark.parametrize("seed", [2, 5])
def test_gradients_are_differences(seed: int) -> None:
    """By controls, by displacements and rates of the start, and by a parameter of the cost, of random trees."""
    definition, rng = random_balls(seed, 2)
    instance = {"name": "x", "substructure": "d"}
    model = couple({"name": "t", "gravity": [1, 2, -9], "instances": [instance]}, {"x": derive(definition)})
    q, v = random_position(rng, model), rng.uniform(-0.5, 0.5, model.dof)
    controls = [f"tau.{name}" for name in model.coordinates][:3]
    running = f"{controls[0]}^2 + {model.positions[0]}*{model.coordinates[-1]}' + {model.positions[-1]}^2"
    cost, values = Cost(running, f"{model.positions[-1]}*{model.coordinates[0]}'"), rng.uniform(-1, 1, (3, 3))

    problem = ControlProblem(
        controls=controls, cost=cost, horizon=0.2, intervals=2, steps=8, q=q.tolist(), qd=v.tolist()
    )
    shooting = Shooting(model, problem, start_state(model, problem))

    def at(q: np.ndarray, v: np.ndarray, values: np.ndarray) -> float:
        return shooting.run(np.concatenate([q, v])[None], values).cost

    found = cost_gradient(model, problem, values=dict(zip(controls, values.T.tolist(), strict=True)))
    assert found.cost == pytest.approx(at(q, v, values), rel=1e-12)
    assert found.q.shape == found.qd.shape == (model.dof,)
    h, scale = 1e-5, max(np.abs(found.q).max(), np.abs(found.qd).max(), np.abs(found.controls).max())
    for a, one in enumerate(np.eye(model.dof)):
        by_q = (at(displaced(model, q, h * one), v, values) - at(displaced(model, q, -h * one), v, values)) / (2 * h)
        by_v = (at(q, v + h * one, values) - at(q, v - h * one, values)) / (2 * h)
        np.testing.assert_allclose([found.q[a], found.qd[a]], [by_q, by_v], atol=2e-7 * scale)
    for k in range(3):
        change = np.zeros((3, 3))
        change[1, k] = h
        by_u = (at(q, v, values + change) - at(q, v, values - change)) / (2 * h)
        assert found.controls[1, k] == pytest.approx(by_u, abs=2e-7 * scale)


def test_wrong_adjoint_equations_are_found() -> None:
    """Each number of their program, changed."""
    model = satellite("floating", (1, 2, "5/2"))
    cost = Cost("p.q_b_x^2*p.w_b_y' + p.r_b_z*tau.p.w_b_x", "p.q_b_w*p.v_b_z'")
    right = adjoint_equations(model, TORQUES, cost).program
    texts = {"running": cost.running, "terminal": cost.terminal}
    expected = adjoint(TORQUES, texts, (), (), model.positions)
    more = {s.name: "input" for s in right.symbols if s.name.startswith(("lambda", "mu"))}
    needs, found = (*DYNAMICS, "position_rates"), 0
    certified(right, model, expected, "x", needs=needs, more=more)
    for i, (op, *args) in enumerate(right.operations):
        if op == "rat":
            wrong = (*right.operations[:i], (op, str(int(args[0]) + 7), args[1]), *right.operations[i + 1 :])
            with pytest.raises(VerificationFailed):
                certified(Program(right.symbols, wrong, right.outputs), model, expected, "x", needs=needs, more=more)
            found += 1
    assert found > 2


def test_what_is_demanded_of_a_quaternion_has_length_1() -> None:
    problem = ControlProblem(controls=TORQUES, cost=Cost(EFFORT), horizon=1, intervals=2, q=[1, 0, 0, 0])
    with pytest.raises(InvalidInput, match="norm of the quaternion"):
        optimal_control(satellite(), problem, Demands(End([1, 1, 0, 0])))
    with pytest.raises(InvalidInput, match="unknown coordinate"):
        optimal_control(satellite(), problem, Demands(End({"p.w_b_x": 1})))
