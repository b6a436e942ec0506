"""Least time, limits along the motion, parameters as unknowns and warm starts of optimal control."""

from __future__ import annotations

from functools import cache
from typing import Any

import numpy as np
import orjson
import pytest
from analysis_models import shipped
from random_trees import Plain, model_of

from service.models.results import written
from substructures import InvalidInput, Model
from substructures.analysis.control.demands import Demands, End
from substructures.analysis.control.from_fields import control_arguments
from substructures.analysis.control.nonlinear_program import ShootingProgram
from substructures.analysis.control.optimal_control import Optimum, optimal_control
from substructures.analysis.control.problem import ControlProblem, Cost


@cache
def cart() -> Model:
    """A mass m on a rail."""
    body = {"name": "b", "parent": "base", "joint": {"type": "prismatic", "coordinate": "s"}, "mass": "m"}
    return model_of({"name": "x", "parameters": {"m": {"value": 2, "unit": "kg"}}, "bodies": [body]}, (0, 0, 0))


#: one metre from rest to rest, at most a = 2 m/s^2
FAST: Plain = {
    "controls": ["tau.x.s"],
    "cost": Cost("1"),
    "horizon": 3,
    "free_horizon": (0.1, 10),
    "intervals": 6,
    "hold": "constant",
    "q": [0],
    "end": End([1], [0]),
    "bounds": {"tau.x.s": (-4, 4)},
}


def solved(**change: Any) -> Optimum:
    return optimal_control(cart(), **control_arguments(**FAST | change))


@pytest.mark.parametrize("cost", [Cost("1"), Cost(terminal="t")])
def test_least_time(cost: Cost) -> None:
    """Bang-bang in T = 2 sqrt(d/a) (A. E. Bryson and Y.-C. Ho, Applied Optimal Control, 1975, section 3.9)."""
    found = solved(cost=cost)
    assert found.status == "optimal"
    assert found.is_right
    assert found.horizon == pytest.approx(2 * np.sqrt(1 / 2), rel=1e-8)
    np.testing.assert_allclose(found.controls[:, 0], [4, 4, 4, -4, -4, -4], atol=1e-6)
    assert found.trajectory.t[-1] == found.horizon


def test_a_limit_of_speed_along_the_way() -> None:
    """With |q'| <= v the fastest speeds up, coasts and brakes: T = d/v + v/a."""
    found = solved(intervals=9, path={"x.s'": (None, 0.5)})
    assert found.status == "optimal"
    assert found.is_right
    assert found.horizon == pytest.approx(1 / 0.5 + 0.5 / 2, rel=1e-8)
    assert found.trajectory.qd.max() <= 0.5 + 1e-9
    assert "x.s'" in [check.name for check in found.checks]


def test_bryson_and_denham() -> None:
    """J = 4/(9 l) for 1/2 u^2, from q' = 1 to q' = -1 in a second below l = 1/9 (Bryson and Ho, section 3.11)."""
    bounded: Plain = {"path": {"x.s": (None, 1 / 9)}, "bounds": {}, "free_horizon": None, "hold": "linear"}
    found = solved(cost=Cost("(tau.x.s/m)^2/2"), horizon=1, intervals=12, qd=[1],
                   end=End([0], [-1]), **bounded)  # fmt: skip
    assert found.status == "optimal"
    assert found.cost == pytest.approx(4, rel=1e-3)
    assert found.is_right


@cache
def bead() -> Model:
    """A mass m in a vertical plane, on a smooth wire: its force u |q'| across the path turns the velocity by u/m."""
    slide: Plain = {"type": "prismatic", "placement": {"position": [0, 0, 0]}}
    bodies = [
        {"name": "a", "parent": "base", "joint": {**slide, "coordinate": "x", "axis": [1, 0, 0]}},
        {"name": "b", "parent": "a", "joint": {**slide, "coordinate": "z", "axis": [0, 0, 1]}, "mass": "m"},
    ]
    loads = [{"type": "joint", "coordinate": q, "force": force} for q, force in (("x", "-u*z'"), ("z", "u*x'"))]
    parameters = {"m": {"value": 2, "unit": "kg"}}
    return model_of({"name": "x", "parameters": parameters, "inputs": {"u": {"unit": "kg/s"}}, "bodies": bodies,
                     "loads": loads}, (0, 0, "-9.81"))  # fmt: skip


@pytest.mark.parametrize("guess", [0.0, 4.0])
def test_brachistochrone(guess: float) -> None:
    """From one point of a cycloid to another its arc is the fastest way: x = R (a - sin a), z = R (cos a - 1) with a' =
    w = sqrt(g/R). The direction turns by w/2, gravity turns it by -w/2, and so u = m w all along (Bernoulli, 1697).
    """
    R, (first, last) = 0.8, (0.6, 2.4)  # noqa: N806 -- symbol of the notation
    w = np.sqrt(9.81 / R)

    def at(a: float) -> tuple[list[float], list[float]]:
        """Place and velocity."""
        return [R * (a - np.sin(a)), R * (np.cos(a) - 1)], [R * w * (1 - np.cos(a)), -R * w * np.sin(a)]

    (q, qd), (end, speed) = at(first), at(last)
    wire: Plain = {"controls": ["x.u"], "q": q, "qd": qd, "end": End(end), "bounds": {"x.u": (-40, 40)}}
    wire |= {
        "horizon": 0.7,
        "free_horizon": (0.1, 3),
        "guess": {"x.u": guess},
        "tolerance": 1e-13,
        "steps": 20,
        "intervals": 3,
    }
    found = optimal_control(bead(), **control_arguments(**FAST | wire))
    assert found.status == "optimal"
    assert found.is_right
    assert found.horizon == pytest.approx((last - first) / w, rel=1e-8)
    np.testing.assert_allclose(found.controls, 2 * w, rtol=1e-4)
    np.testing.assert_allclose(found.trajectory.qd[-1], speed, rtol=1e-4)


def test_parameters_alone() -> None:
    """The mass that a force of 3 N takes to 1 m in a second: m = F T^2 / (2 d)."""
    found = solved(
        controls=[], bounds={}, inputs={"tau.x.s": 3}, cost=Cost(terminal="1 + (x.s - 1)^2"), horizon=1, end=End(),
        free_horizon=None, free_parameters={"m": (0.5, 10)},
    )  # fmt: skip
    assert found.status == "optimal"
    assert found.parameters["m"] == pytest.approx(1.5, rel=1e-5)
    assert found.controls.shape == (6, 0)


def test_an_earlier_result_is_the_start() -> None:
    """Also from its JSON: where the search begins is where the other ended, at other nodes."""
    first = solved()
    for earlier in (first, orjson.loads(written(first, "application/json", cart()))):
        wanted = Demands(FAST["end"], FAST["bounds"], free_horizon=FAST["free_horizon"], warm_start=earlier)
        given = {name: FAST[name] for name in ("controls", "cost", "horizon", "hold", "q")}
        search = ShootingProgram(cart(), ControlProblem(**given, intervals=12), wanted)
        cost, violation = search.progress(search.guess())
        assert cost == pytest.approx(first.cost, rel=1e-12)
        assert violation < 1e-8


def test_slopes_against_finite_differences() -> None:
    """Of cost, gaps and path by horizon and parameters, with time in the cost and in the path."""
    wanted = Demands(
        End([0.3, None], [None, 0]),
        path={"x.q1*t + x.m1*tau.x.q0": (-9, 9), "x.q0'": (None, 8)},
        free_parameters={"x.m1": (0.1, 1)},
        free_horizon=(0.1, 2),
    )
    cost = Cost("tau.x.q0^2*(1 + t^2) + x.m1*x.q0'^2", "t*x.q1 + x.m1*t^2")
    given: Plain = {
        "controls": ["tau.x.q0"],
        "horizon": 0.6,
        "intervals": 3,
        "q": [0.1, 2],
        "cost": cost,
        "steps": 2,
        "t": 0.2,
    }
    for hold in ("linear", "constant"):
        problem = ControlProblem(**given, hold=hold)
        search = ShootingProgram(shipped("cart-pendulum"), problem, wanted)
        rng = np.random.default_rng(1)
        z = search.guess() + rng.uniform(-0.05, 0.05, len(search.guess()))
        slopes = np.concatenate([search.jacobian(z), search.on_path(z)[1], search.cost(z)[1][None]])

        def values(z: Any, search: ShootingProgram = search) -> Any:
            return np.concatenate([search.residual(z), search.on_path(z)[0], [search.cost(z)[0]]])

        for i in range(len(z)):
            step = 1e-5 * np.eye(len(z))[i]
            change = (values(z + step) - values(z - step)) / 2e-5
            np.testing.assert_allclose(slopes[:, i], change, atol=2e-7)


@pytest.mark.parametrize(
    ("change", "pointer", "code"),
    [
        ({"controls": [], "bounds": {}, "free_horizon": None}, "/controls", "too-short"),
        ({"free_horizon": (2, 1)}, "/free_horizon", "empty"),
        ({"free_parameters": {"x.z": (1, 2)}}, "/free_parameters/x.z", "unknown-parameter"),
        ({"path": {"x.s": (2, 1)}}, "/path/x.s", "empty"),
        ({"path": {"x.z": (None, 1)}}, "/path/x.z", "unknown-name"),
        ({"path": {"x.s": (0.5, 1)}}, "/path/x.s", "start-outside"),
        ({"path": {"x.s": (None, 1)}, "segments": 3}, "/segments", "not-a-divisor"),
        ({"warm_start": {"names": []}}, "/warm_start/trajectory", "missing"),
    ],
)
def test_refusals(change: Plain, pointer: str, code: str) -> None:
    with pytest.raises(InvalidInput) as error:
        solved(**change)
    assert [(f.pointer, f.code) for f in error.value.faults] == [(pointer, code)]
