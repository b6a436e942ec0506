"""Regulators with velocity constraints: hand calculations, the benchmark bicycle, costs of simulated motions."""

# ruff: noqa: N806 -- symbols of the notation

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
from rolling_bodies import BLADE, FLOOR, FORWARD, FRONT, REAR, R, bicycle_part, disc, single, sleigh
from scipy.integrate import trapezoid
from scipy.linalg import solve_continuous_are

from substructures import ConstrainedMotion, InvalidInput, Outputs, linearise, regulator, simulate
from substructures.analysis.equations.nonholonomic.quasi_velocities import quasi_velocity_equations
from substructures.analysis.equations.nonholonomic.solved import state_space
from substructures.analysis.simulate import Rolling
from substructures.expr.interpret import interpret

#: mass of the sledge, place of its mass centre and moment of inertia about it
MASS, AHEAD, INERTIA = 2.0, 0.25, 0.3
INPUTS = ["tau.s.th", "tau.s.ph"]


def riccati(a: Any, b: Any, q: Any) -> Any:
    return b.T @ solve_continuous_are(a, b, q, np.eye(b.shape[1]))


def driving(speed: float, turn: float = 0.0) -> ConstrainedMotion:
    return ConstrainedMotion([BLADE], velocities=FORWARD, v=[speed, turn])


def test_a_sledge_at_rest() -> None:
    """Along its blade m u' = F: K = (1, sqrt(2 m)); no force moves it aside (Brockett), which is told."""
    found = regulator(sleigh(), [0, 0, 0], weights={"s.x": 1.0}, kind=driving(0), of_inputs=["tau.s.x"])
    assert (found.coordinates, found.states) == (("s.x",), ("s.x", "u"))
    assert found.gain[0] == pytest.approx([1, np.sqrt(2 * MASS)], rel=1e-9)
    assert (found.controllable, found.is_right) == (True, True)
    found = regulator(sleigh(), [0, 0, 0], weights={"s.x": 1, "s.y": 1, "s.f": 1}, kind=driving(0))
    assert (found.controllable, found.status) == (False, "failed")
    assert "no input moves the mode 0 1/s of 's.y'" in found.message.replace("0+0j", "0")
    assert "out of 'weights'" in found.message


def test_a_sledge_that_drives_keeps_its_line() -> None:
    """y' = u f, f' = w, (I + m a^2) w' = -m a u w + tau: y is controlled by the torque where the sledge moves."""
    u = 1.5
    found = regulator(sleigh(), [0, 0, 0], weights={"s.y": 2.0, "s.f": 0.5}, kind=driving(u), of_inputs=["tau.s.f"])
    J = INERTIA + MASS * AHEAD**2
    hand = np.array([[0, u, 0], [0, 0, 1], [0, 0, -MASS * AHEAD * u / J]])
    expected = riccati(hand, np.array([[0], [0], [1 / J]]), np.diag([2, 0.5, 0]))
    assert found.states == ("s.y", "s.f", "w")
    np.testing.assert_allclose(found.gain, expected, rtol=1e-9)
    assert found.is_right


def test_the_cost_is_that_of_simulated_motions() -> None:
    """Integral of x^T Q x + tau^2 along the motion of the sledge itself under u = -K x, from 1 mm beside the line."""
    found = regulator(sleigh(), [0, 0, 0], weights={"s.y": 2.0, "s.f": 0.5}, kind=driving(1.5), of_inputs=["tau.s.f"])
    by_y, by_f, by_w = found.gain[0].tolist()
    kind, e = driving(1.5), 1e-3
    law = f"-({by_y!r}*s.y + {by_f!r}*s.f + {by_w!r}*s.f')"
    t = np.linspace(0, 20, 4001)
    motion = simulate(sleigh(), [0, e, 0], (0, 20), kind=kind, inputs={"tau.s.f": law}, outputs=Outputs(times=t))
    y, f, w = motion.q[:, 1], motion.q[:, 2], motion.qd[:, 2]
    spent = 2 * y**2 + 0.5 * f**2 + (by_y * y + by_f * f + by_w * w) ** 2
    assert trapezoid(spent, t) == pytest.approx(e**2 * found.cost[0, 0], rel=1e-4)
    assert np.abs(motion.q[-1, 1:]).max() < 1e-3 * e


def test_in_a_turn_places_are_not_fed_back() -> None:
    """Their rates turn with the sledge; speeds alone are regulated."""
    with pytest.raises(InvalidInput) as caught:
        regulator(
            sleigh(), [0, 0, 0], weights={"s.x": 1}, kind=ConstrainedMotion([BLADE], velocities=FORWARD, v=[0, 1])
        )
    assert caught.value.faults[0].code == "not-steady"


@pytest.mark.parametrize("speed", [2.0, 5.0])
def test_a_bicycle_is_steered(speed: float) -> None:
    """M q'' + v C1 q' + (g K0 + v^2 K2) q = (0, T) with the published matrices (Meijaard et al. 2007, section 5);
    speed, place and heading, which nothing depends on, are not fed back. Steer is the other way there.
    """
    mass = np.array([[80.81722, 2.31941332208709], [2.31941332208709, 0.29784188199686]])
    C1 = np.array([[0, 33.86641391492494], [-0.85035641456978, 1.68540397397560]])
    K0 = np.array([[-80.95, -2.59951685249872], [-2.59951685249872, -0.80329488458618]])
    K2 = np.array([[0, 76.59734589573222], [0, 2.65431523794604]])
    lower = -np.linalg.solve(mass, np.hstack([9.81 * K0 + speed**2 * K2, speed * C1]))
    hand = np.vstack([np.eye(2, 4, 2), lower])
    B = np.concatenate([np.zeros(2), np.linalg.solve(mass, [0, 1])])[:, None]
    expected = riccati(hand, B, np.diag([1.0, 1, 0, 0]))[0]
    wheels = (Rolling("rear", "s.rear_axle", REAR), Rolling("front", "s.front_axle", FRONT))
    v = {"s.rear'": speed / REAR}
    kind = ConstrainedMotion(wheels, independent=["s.lean", "s.steer", "s.rear"], v=v)
    model = single(bicycle_part(), [0, 0, -9.81])
    found = regulator(
        model, [0, 0, REAR, 0, 0, 0, 0, 0, 0], weights={"s.lean": 1, "s.steer": 1}, kind=kind, of_inputs=["tau.s.steer"]
    )
    assert found.states == ("s.lean", "s.steer", "s.lean'", "s.steer'")
    # the torque turns with the angle: lean counts the other way
    np.testing.assert_allclose(found.gain[0], expected * np.array([-1, 1, -1, 1]), rtol=1e-8)
    assert found.is_right


def test_the_state_space_is_that_of_the_linearisation() -> None:
    """Formulas A, B, C, D at a motion in general position, beside the numbers and differences of x' = f(x, u)."""
    model, constraints = disc(), [FLOOR]
    names = ["s.psi", "s.th", "s.ph"]
    equations = quasi_velocity_equations(model, constraints, independent=names)
    texts = ["sin(s.th)*s.x' + s.psi*tau.s.th", "s.ph'^2"]
    source = state_space(equations, texts, ["tau.s.th", "tau.s.ph"])
    rng = np.random.default_rng(3)
    q, v = rng.uniform(0.3, 1.2, 6), rng.uniform(-1, 1, 3)
    values = {**dict(zip(model.coordinates, q, strict=True)), **dict(zip(equations.velocities, v, strict=True))}
    values |= {"s.m": 2.0, "s.r": R, "tau.s.th": 0.4, "tau.s.ph": -0.2, "tau.s.x": 0, "tau.s.y": 0, "tau.s.z": 0}
    values |= {"tau.s.psi": 0.0}
    found = interpret(source, values)
    states = [*model.coordinates, *equations.velocities]
    for matrix, output, by in (("A", "derivative", states), ("C", "output", states), ("B", "derivative", INPUTS)):
        slopes = [slope(source, values, output, name) for name in by]
        np.testing.assert_allclose(found[matrix], np.transpose(slopes), atol=1e-8)
    np.testing.assert_allclose(found["D"], [[q[3], 0], [0, 0]], atol=1e-14)
    kind = ConstrainedMotion(constraints, independent=names, v=v)
    at = linearise(model, q, kind=kind, inputs={"tau.s.th": 0.4, "tau.s.ph": -0.2}, of_inputs=INPUTS)
    np.testing.assert_allclose(found["A"], at.A, atol=1e-12)
    np.testing.assert_allclose(found["B"], at.B, atol=1e-12)


def slope(source: Any, values: Any, output: str, name: str) -> Any:
    """By central differences of fourth order."""
    h = 1e-3
    ends = [interpret(source, {**values, name: values[name] + k * h}, [output])[output] for k in (-2, -1, 1, 2)]
    return (8 * (ends[2] - ends[1]) - (ends[3] - ends[0])) / (12 * h)
