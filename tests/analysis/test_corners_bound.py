"""Corners of force laws in motions with closures and with velocity constraints, and corners of given inputs."""

from __future__ import annotations

from itertools import pairwise
from typing import Any, Literal

import numpy as np
import pytest
from closed_trees import four_bar, tree_model
from simulated import simulated

from substructures import Model
from substructures.analysis.motion.corners import Corners, Laws
from substructures.analysis.motion.trajectory import Trajectory
from substructures.analysis.simulate import ClosedMotion, ConstrainedMotion, Linear, Outputs, Table, simulate

REDUCTIONS = ("projection", "partitioning")


def single(part: dict[str, Any], **more: Any) -> Model:
    return tree_model({"instances": [{"name": "x", "substructure": "p"}], **more}, {"p": part})


#: on the unit circle, beside it weight to the left or the right, a push down in one quarter, a stop below y = -0.6
SIDEWAYS, UPWARDS = "-5*sign({x})", "-3*max({x}*{y}, 0) + 40*max(-{y} - 0.6, 0)"


def ring() -> Model:
    """A mass of 1 kg that slides along x and y on a rod of 1 m about the origin."""
    first = {"type": "prismatic", "coordinate": "x", "psi": "pi/2", "theta": "pi/2"}
    second = {"type": "prismatic", "coordinate": "y", "theta": "pi/2"}
    bodies = [
        {"name": "a", "parent": "base", "joint": first},
        {"name": "b", "parent": "a", "joint": second, "mass": 1},
    ]
    places = {"x": "x", "y": "y"}
    loads = [
        {"type": "joint", "coordinate": "x", "force": SIDEWAYS.format(**places)},
        {"type": "joint", "coordinate": "y", "force": UPWARDS.format(**places)},
    ]
    rod = {"name": "rod", "type": "rod", "from": "x.b", "to": "world", "length": 1}
    return single({"name": "slides", "bodies": bodies, "loads": loads}, closures=[rod])


def pendulum() -> Model:
    """The same with its angle as coordinate."""
    places = {"x": "cos(a)", "y": "sin(a)"}
    torque = f"-sin(a)*({SIDEWAYS.format(**places)}) + cos(a)*({UPWARDS.format(**places)})"
    body = {"name": "b", "parent": "base", "joint": {"type": "revolute", "coordinate": "a"}}
    loads = [{"type": "joint", "coordinate": "a", "force": torque}]
    return single({"name": "turns", "bodies": [body | {"mass": 1, "com": [1, 0, 0]}], "loads": loads})


TIMES = np.linspace(0, 4, 41)


def on_ring(reduction: Literal["projection", "partitioning"], **given: Any) -> Trajectory:
    q, qd = [np.cos(0.7), np.sin(0.7)], [2 * np.sin(0.7), -2 * np.cos(0.7)]
    return simulated(ring(), q, (0, 4), qd=qd, times=TIMES, reduction=reduction, **given)


@pytest.fixture(scope="module")
def turned() -> Trajectory:
    return simulate(pendulum(), [0.7], (0, 4), qd=[-2], outputs=Outputs(times=TIMES))


@pytest.mark.parametrize("reduction", REDUCTIONS)
def test_a_closed_loop_is_its_tree(reduction: Literal["projection", "partitioning"], turned: Trajectory) -> None:
    found = on_ring(reduction)
    angle = turned.q[:, 0]
    np.testing.assert_allclose(found.q, np.stack([np.cos(angle), np.sin(angle)], axis=1), atol=1e-9)
    assert found.is_right
    assert all(check.holds for check in found.checks)
    # all sides were taken
    assert found.q.min() < -0.7
    assert found.q.max() > 0.7


def test_a_closed_loop_without_them(monkeypatch: pytest.MonkeyPatch) -> None:
    """Corners that are stepped over need more steps."""
    steps = on_ring("projection").steps
    monkeypatch.setattr(Laws, "on_sides", lambda *_: None)
    assert on_ring("projection").steps > 1.8 * steps


def test_a_four_bar_is_driven_both_ways() -> None:
    """A torque of an input that changes its direction, and the pieces one after the other with a constant one."""
    model = four_bar()
    torque = next(name for name in model.input_names if name.startswith("tau."))
    start = simulate(
        model, [0.4, 0.9, 1.2], (0, 0.01), kind=ClosedMotion(fixed=[model.coordinates[0]]), outputs=Outputs(times=[0])
    )
    q, qd = start.q[0], start.qd[0]
    ends = [0, *(np.pi * np.arange(1, 4) / 3), 4.0]
    found = simulate(model, q, (0, 4), qd=qd, inputs={torque: "0.2*sign(sin(3*t))"}, outputs=Outputs(times=ends))
    assert found.is_right
    for k, (a, b) in enumerate(pairwise(ends)):
        piece = simulate(model, q, (a, b), qd=qd, inputs={torque: 0.2 * (-1) ** k}, outputs=Outputs(times=[b]))
        q, qd = piece.q[-1], piece.qd[-1]
        np.testing.assert_allclose(found.q[k + 1], q, atol=1e-9)


#: a quarter of the period of (m + I/r^2) x'' = -sign x from x = 1 with m + I/r^2 = 3
QUARTER = np.sqrt(6)
INERTIA = {"xx": 0.5, "yy": 0.5, "zz": 0.5}
GEAR = Linear("gear", "x.x' - 0.5*x.f'")


def wheel() -> Model:
    """A mass of 1 kg on a line, and a wheel of 0.5 kg m^2 and 0.5 m that it turns; its torque jumps."""
    bodies = [
        {"name": "a", "parent": "base", "joint": {"type": "prismatic", "coordinate": "x"}, "mass": 1},
        {"name": "w", "parent": "base", "joint": {"type": "revolute", "coordinate": "f"}, "inertia": INERTIA},
    ]
    inputs = {"u": {"unit": "N"}}
    loads = [
        {"type": "joint", "coordinate": "f", "force": "-0.5*sign(f)"},
        {"type": "joint", "coordinate": "x", "force": "u"},
    ]
    return single({"name": "wheel", "bodies": bodies, "loads": loads, "inputs": inputs})


def parabolas(times: np.ndarray) -> np.ndarray:
    """x'' = -sign(x)/3 from x = 1."""
    phase = times % (4 * QUARTER)
    first = 1 - phase**2 / 6
    second = -1 + (phase - 2 * QUARTER) ** 2 / 6
    last = 1 - (phase - 4 * QUARTER) ** 2 / 6
    return np.where(phase < QUARTER, first, np.where(phase < 3 * QUARTER, second, last))


def test_a_wheel_with_a_torque_that_jumps() -> None:
    times = np.linspace(0, 20 * QUARTER, 101)
    found = simulate(
        wheel(), [1, 2], (0, times[-1]), kind=ConstrainedMotion(constraints=[GEAR]), outputs=Outputs(times=times)
    )
    np.testing.assert_allclose(found.q[:, 0], parabolas(times), atol=1e-10)
    assert found.is_right
    assert found.steps < 150


def test_a_wheel_without_them(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(Laws, "on_sides", lambda *_: None)
    found = simulate(
        wheel(),
        [1, 2],
        (0, 20 * QUARTER),
        kind=ConstrainedMotion(constraints=[GEAR]),
        outputs=Outputs(times=[20 * QUARTER]),
    )
    assert found.steps > 200


def test_corners_that_meet() -> None:
    """An input that is zero by corners where the torque has one, too."""
    times = np.linspace(0, 8 * QUARTER, 33)
    nothing = {"x.u": "abs(x.x) + min(x.x, 0) - max(x.x, 0)"}
    found = simulate(
        wheel(),
        [1, 2],
        (0, times[-1]),
        inputs=nothing,
        kind=ConstrainedMotion(constraints=[GEAR]),
        outputs=Outputs(times=times),
    )
    np.testing.assert_allclose(found.q[:, 0], parabolas(times), atol=1e-9)


def cart(force: str) -> Model:
    """A mass of 1 kg on a line, x, with a force on it."""
    body = {"name": "b", "parent": "base", "joint": {"type": "prismatic", "coordinate": "x"}, "mass": 1}
    loads = [{"type": "joint", "coordinate": "x", "force": force}]
    return single({"name": "cart", "bodies": [body], "loads": loads, "inputs": {"u": {"unit": "N"}}})


def pushed(force: str, end: float, u: Any, **given: Any) -> Trajectory:
    return simulated(cart(force), [0], (0, end), inputs={"x.u": u}, **given)


def test_an_input_that_jumps() -> None:
    """x'' = sign(sin(pi t)): x' is a triangle, which each second brings x one half further."""
    found = pushed("u", 20, "sign(sin(pi*t))", step=1)
    np.testing.assert_allclose(found.q[:, 0], np.arange(21) / 2, atol=1e-9)
    assert found.is_right
    assert found.steps < 250


def test_an_input_without_them(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(Laws, "on_sides", lambda *_: None)
    assert pushed("u", 20, "sign(sin(pi*t))", step=1).steps > 400


@pytest.mark.parametrize("tolerance", [1e-6, 1e-10])
def test_a_law_of_an_input(tolerance: float) -> None:
    """x'' + x = |t - 1|: x = |t - 1| - cos t + sin t, and sin(t - 1) twice from t = 1 on, less."""
    found = pushed("abs(u) - x", 3, "t - 1", times=[3], relative_tolerance=tolerance)
    expected = 2 - np.cos(3) + np.sin(3) - 2 * np.sin(2)
    np.testing.assert_allclose(found.q[-1, 0], expected, atol=10 * tolerance)


def test_a_corner_inside_another() -> None:
    """x'' = max(u, 0) with u = sign(sin(pi t)), half of the time 1 and else 0: its place jumps."""
    found = pushed("max(u - 0.25, 0)", 6, "sign(sin(pi*t))", times=[6])
    # 3/4 in the first half of every two seconds: x' = 3/4 k, and x = 3/4 (1/2 + 1) in the first two
    np.testing.assert_allclose(found.q[-1, 0], 0.75 * (3 * 1.5 + 2 * (1 + 2)), atol=1e-9)
    assert found.is_right


def test_a_table_that_jumps_over_a_corner() -> None:
    """A wall that is moved in a jump: x'' = -sign(x - u), and the time of the jump is a break."""
    wall = Table([0, 1, 4], [-10, 10, 10], "hold")
    found = pushed("-1*sign(x - u)", 3, wall, times=[1, 3])
    # -1 for a second, then 1: x = -1/2, and then -1/2 - 2 + 2
    np.testing.assert_allclose(found.q[:, 0], [-0.5, -0.5], atol=1e-9)
    assert found.steps < 30


@pytest.fixture
def blind(monkeypatch: pytest.MonkeyPatch) -> None:
    """A planted fault: sides are taken, and no corner is watched."""
    right = Corners.__init__

    def wrong(self: Corners, *given: Any) -> None:
        right(self, *given)
        self.watches = []

    monkeypatch.setattr(Corners, "__init__", wrong)


@pytest.mark.usefixtures("blind")
def test_verdicts_see_who_goes_on_at_the_wrong_side() -> None:
    wheel_motion = simulate(wheel(), [1, 2], (0, 2 * QUARTER), kind=ConstrainedMotion(constraints=[GEAR]))
    for found in (on_ring("projection"), on_ring("partitioning"), wheel_motion, pushed("u", 3, "sign(sin(pi*t))")):
        assert found.is_right is False
        assert not all(check.holds for check in found.checks)
