"""Optimal control: a closed form, a swing-up with its necessary conditions, refusals and failures."""

from __future__ import annotations

from functools import cache
from typing import Any

import numpy as np
import pytest
from analysis_models import shipped
from random_trees import Plain, model_of
from scipy.integrate import solve_ivp

from substructures import InvalidInput, Model
from substructures.analysis.control.demands import Demands, End
from substructures.analysis.control.from_fields import control_arguments
from substructures.analysis.control.motion_sizes import motion_sizes
from substructures.analysis.control.nonlinear_program import ShootingProgram
from substructures.analysis.control.optimal_control import Optimum, optimal_control
from substructures.analysis.control.problem import ControlProblem, Cost
from substructures.quantities.numbers.evaluation import evaluate


@cache
def slider(damping: float = 0) -> Model:
    """2 kg on a rail."""
    joint = {"type": "prismatic", "coordinate": "s", "damping": damping}
    body = {"name": "b", "parent": "base", "joint": joint, "mass": 2}
    return model_of({"name": "x", "bodies": [body]}, (0, 0, 0))


REST: Plain = {
    "controls": ["tau.x.s"],
    "cost": Cost("tau.x.s^2"),
    "horizon": 1.5,
    "intervals": 6,
    "q": [0],
    "end": End([1], [0]),
}


@pytest.mark.parametrize("segments", [1, 3])
def test_from_rest_to_rest(segments: int) -> None:
    """u = 6 m (T - 2 t) / T^3 and J = 12 m^2 / T^3, to rounding, since u is linear and l of degree two."""
    found = optimal_control(slider(), **control_arguments(**REST | {"segments": segments, "tolerance": 1e-14}))
    t = np.linspace(0, 1.5, 7)
    assert found.status == "optimal"
    np.testing.assert_allclose(found.controls[:, 0], 12 * (1.5 - 2 * t) / 1.5**3, atol=1e-6)
    assert found.cost == pytest.approx(48 / 1.5**3, rel=1e-9)
    assert found.hamiltonian_drift is not None
    assert found.hamiltonian_drift < 1e-5
    assert found.trajectory.is_right
    # lambda_qd = -2 u m
    costate = found.trajectory.series["costates"][:, 1]
    np.testing.assert_allclose(costate, -4 * found.trajectory.series["controls"][:, 0], atol=1e-4)


def test_bounds_and_free_ends() -> None:
    """As far as possible in one second with |u| <= 3: u = 3 throughout, q = u T^2 / (2 m); without demands L-BFGS-B."""
    free = REST | {"cost": Cost(terminal="-x.s"), "end": End(), "bounds": {"tau.x.s": [None, 3]}, "horizon": 1}
    found = optimal_control(slider(), **control_arguments(**free | {"segments": 1, "hold": "constant"}))
    assert found.status == "optimal"
    assert found.cost == pytest.approx(-0.75)
    np.testing.assert_allclose(found.controls, 3)
    kept = optimal_control(
        slider(), **control_arguments(**free | {"end": End(qd={"x.s": 0}), "bounds": {"tau.x.s": [-3, 3]}})
    )
    assert kept.status == "optimal"
    assert kept.cost == pytest.approx(-0.75 / 2 * (1 - 1 / 27), rel=1e-2)
    assert np.abs(kept.controls).max() <= 3 + 1e-12


SWING_UP: Plain = {
    "controls": ["tau.x.q0"],
    "cost": Cost("tau.x.q0^2"),
    "horizon": 2,
    "intervals": 40,
    "steps": 2,
    "q": {"x.q0": 0, "x.q1": np.pi},
    "end": End([0, 0], [0, 0]),
    "bounds": {"tau.x.q0": [-20, 20]},
}


@cache
def swing_up(intervals: int = 40) -> Optimum:
    return optimal_control(shipped("cart-pendulum"), **control_arguments(**SWING_UP | {"intervals": intervals}))


# takes seconds: a whole optimisation, of which each step is a motion and its adjoint
def test_swing_up() -> None:
    """A pendulum on a cart from hanging to standing: an independent integration of the controls found arrives there."""
    found = swing_up()
    assert found.status == "optimal"
    assert found.stationarity < 1e-3
    assert found.violation < 1e-8
    assert found.hamiltonian_drift is not None
    assert found.hamiltonian_drift < 0.03
    assert np.abs(found.controls).max() < 20
    assert found.history[-1, 0] == pytest.approx(found.cost, rel=1e-6)
    assert found.history[0, 1] > 1e-2
    model, t = shipped("cart-pendulum"), np.linspace(0, 2, 41)

    def rates(time: float, x: Any) -> Any:
        u = float(np.interp(time, t, found.controls[:, 0]))
        state = {"q": x[:2], "qd": x[2:], "inputs": {"tau.x.q0": u}}
        return [*x[2:], *evaluate(model, ["forward_dynamics"], **state)["forward_dynamics"]]

    motion = solve_ivp(rates, (0, 2), [0, np.pi, 0, 0], rtol=1e-8, atol=1e-8, max_step=0.05)
    np.testing.assert_allclose(motion.y[:, -1], 0, atol=1e-2)
    energy = evaluate(model, ["potential_energy"], q=found.trajectory.q[[0, -1]])["potential_energy"]
    assert energy[1] - energy[0] == pytest.approx(2 * 0.2 * 9.81 * 0.5)


@pytest.mark.deep
def test_hamiltonian_becomes_constant_with_finer_controls() -> None:
    """The drift falls at least with the first power of the interval, and the cost converges."""
    coarse, fine = swing_up(40), swing_up(80)
    assert fine.status == "optimal"
    assert coarse.hamiltonian_drift is not None
    assert fine.hamiltonian_drift is not None
    assert fine.hamiltonian_drift < coarse.hamiltonian_drift / 2
    assert fine.cost == pytest.approx(coarse.cost, rel=1e-3)


@pytest.mark.deep
def test_acrobot() -> None:
    """Shoulder free, elbow driven, from hanging to standing."""
    request: Plain = {
        "controls": ["tau.x.q2"],
        "cost": Cost("tau.x.q2^2"),
        "horizon": 3,
        "intervals": 60,
        "steps": 2,
        "q": [-np.pi / 2, 0],
        "iterations": 1000,
        "end": End([np.pi / 2, 0], [0, 0]),
        "bounds": {"tau.x.q2": [-40, 40]},
        "segments": 12,
    }
    rough = optimal_control(shipped("acrobot"), **control_arguments(**request))
    assert rough.status == "failed"  # what is optimal for so few steps is not so for the motion
    assert "steps" in rough.message
    found = optimal_control(shipped("acrobot"), **control_arguments(**request), error_limit=1e3)
    assert found.status == "optimal"
    assert found.violation < 1e-6


def test_jacobian_against_finite_differences() -> None:
    model = shipped("cart-pendulum")
    given = {name: SWING_UP[name] for name in ("controls", "cost", "steps", "q")}
    wanted = Demands(SWING_UP["end"], SWING_UP["bounds"], {}, segments=3, iterations=500, tolerance=1e-8)
    for hold in ("linear", "constant"):
        search = ShootingProgram(model, ControlProblem(**given, intervals=6, horizon=0.6, hold=hold), wanted)
        rng = np.random.default_rng(1)
        z = search.guess() + rng.uniform(-0.2, 0.2, len(search.guess()))
        slopes, gradient = search.jacobian(z).copy(), search.cost(z)[1].copy()
        assert slopes.shape == (12, (7 if hold == "linear" else 6) + 8)
        for _ in range(3):
            dz, h = rng.uniform(-1, 1, len(z)), 1e-5
            change = (search.residual(z + h * dz) - search.residual(z - h * dz)) / (2 * h)
            np.testing.assert_allclose(slopes @ dz, change, atol=1e-7)
            slope = (search.cost(z + h * dz)[0] - search.cost(z - h * dz)[0]) / (2 * h)
            assert gradient @ dz == pytest.approx(slope, rel=1e-6, abs=1e-7)


@pytest.mark.parametrize(
    ("change", "pointer", "code"),
    [
        ({"segments": 4}, "/segments", "not-a-divisor"),
        ({"end": End([1, 2])}, "/end/q", "wrong-length"),
        ({"end": End({"x.z": 1})}, "/end/q/x.z", "unknown-coordinate"),
        ({"bounds": {"tau.x.s": [1, -1]}}, "/bounds/tau.x.s", "empty"),
        ({"bounds": {"u": [1, -1]}}, "/bounds/u", "unknown-input"),
        ({"bounds": {"tau.x.s": ["a", 1]}}, "/bounds/tau.x.s/0", "number-expected"),
        ({"bounds": {"tau.x.s": 5}}, "/bounds/tau.x.s", "wrong-length"),
        ({"free_horizon": [1]}, "/free_horizon", "wrong-length"),
        ({"path": {"x.s": [0]}}, "/path/x.s", "wrong-length"),
        ({"end": End([[1]])}, "/end/q", "number-expected"),
        ({"end": End(1)}, "/end/q", "list-expected"),  # type: ignore[arg-type]
        ({"guess": {"tau.x.s": [1]}}, "/guess/tau.x.s", "wrong-length"),
        ({"intervals": 9000}, "/intervals", "too-large"),
        ({"guess": {"u": [1]}}, "/guess/u", "unknown-guess"),
        ({"segments": 0}, "/segments", "greater-than-equal"),
        ({"iterations": 0}, "/iterations", "greater-than-equal"),
        ({"tolerance": 2}, "/tolerance", "less-than"),
    ],
)
def test_refusals(change: Plain, pointer: str, code: str) -> None:
    with pytest.raises(InvalidInput) as error:
        optimal_control(slider(), **control_arguments(**REST | change))
    assert [(f.pointer, f.code) for f in error.value.faults] == [(pointer, code)]


def test_failures_are_values() -> None:
    """Too weak to arrive; too few iterations."""
    weak = optimal_control(
        slider(), **control_arguments(**REST | {"bounds": {"tau.x.s": [-0.1, 0.1]}, "iterations": 50})
    )
    assert weak.status == "failed"
    assert "bounds" in weak.message
    assert not weak.trajectory.is_right
    seen: list[int] = []
    few = optimal_control(
        shipped("cart-pendulum"),
        **control_arguments(**SWING_UP | {"iterations": 2}, progress=lambda k, *_: seen.append(k)),
    )
    assert seen == [1, 2]
    assert few.status == "failed"
    assert len(few.history) >= 2


def nanokilogram() -> Model:
    body = {"name": "b", "parent": "base", "joint": {"type": "prismatic", "coordinate": "s"}, "mass": "1/10^9"}
    return model_of({"name": "x", "bodies": [body]}, (0, 0, 0))


def test_a_control_of_a_nanonewton_has_bounds_of_its_own() -> None:
    """1 nkg is held by up to 1 nN as 1 kg is by 1 N: x = 1 - t^2/2 costs 1 - 1/3 + 1/20 times 1e-9, on nodes."""
    problem = ControlProblem(controls=["tau.x.s"], horizon=1, intervals=20, q=[1], cost=Cost("1/10^9*x.s^2"))
    found = optimal_control(nanokilogram(), problem, Demands(bounds={"tau.x.s": (-1e-9, 1e-9)}))
    assert found.cost == pytest.approx((1 - 1 / 3 + 1 / 20) * 1e-9, rel=1e-4)
    assert (found.status, found.is_right) == ("optimal", True)


@pytest.mark.parametrize("segments", [1, 4])
def test_a_nanokilogram_is_moved_as_well_as_a_kilogram(segments: int) -> None:
    """tau = 6 m (1 - 2 t) moves m over 1 m in 1 s, at the cost of 12 m^2."""
    problem = ControlProblem(controls=["tau.x.s"], horizon=1, intervals=20, steps=2, q=[0], cost=Cost("tau.x.s^2"))
    found = optimal_control(nanokilogram(), problem, Demands(End([1], [0]), segments=segments))
    assert found.status == "optimal"
    assert found.cost == pytest.approx(12e-18, rel=1e-6)


@pytest.mark.parametrize(("q", "way"), [(0, 1e-9), (0.3, 1e-6)])
@pytest.mark.parametrize("segments", [1, 4])
def test_a_nanometre_is_a_way_as_a_metre_is(q: float, way: float, segments: int) -> None:
    """12 m^2 d^2/T^3 over d in T; a demand that is met by staying is none."""
    problem = ControlProblem(controls=["tau.x.s"], horizon=2, intervals=8, q=[q], cost=Cost("tau.x.s^2"))
    found = optimal_control(nanokilogram(), problem, Demands(End([q + way], [0]), segments=segments))
    assert found.status == "optimal"
    assert found.is_right
    assert found.cost == pytest.approx(12e-18 * way**2 / 8, rel=1e-4)
    assert found.trajectory.q[-1, 0] - q == pytest.approx(way, rel=1e-5)


@pytest.mark.parametrize("path", [{"x.s'": (None, 1.2)}, {"3*x.s'": (None, 3.6)}, {"tau.x.s*10^9": (-5, 5)}])
def test_limits_along_a_way_of_a_nanometre_hold_as_along_a_metre(path: dict[str, tuple[float | None, float]]) -> None:
    """At the same cost, over the square of the way; without limits it is 12, at a speed of at most 1.5."""
    costs = []
    for way in (1.0, 1e-9):
        problem = ControlProblem(
            controls=["tau.x.s"], horizon=1, intervals=20, q=[0], cost=Cost(f"(10^9/{way!r}*tau.x.s)^2")
        )
        limits = {text: tuple(x and x * way for x in pair) for text, pair in path.items()}
        found = optimal_control(nanokilogram(), problem, Demands(End([way], [0]), path=limits))
        assert (found.status, found.is_right) == ("optimal", True)
        costs.append(found.cost)
    assert costs[0] > 12.05
    assert costs[1] == pytest.approx(costs[0], rel=1e-4)


def test_what_rounding_demands_is_no_size() -> None:
    """0.1 + 0.2 is no move from 0.3: the motion of the rates alone is what counts."""
    model, start = slider(), np.array([0.3, 0.0])
    assert motion_sizes(model, start, [(0, 0.1 + 0.2), (1, 0.0)], 2).tolist() == [1, 1]
    assert motion_sizes(model, start, [(0, 0.3 + 2.0**-10)], 2).tolist() == [2.0**-10, 2.0**-11]
    assert motion_sizes(model, start, [(0, 0.3), (1, 2.0**-9)], 2).tolist() == [2.0**-8, 2.0**-9]
    assert motion_sizes(model, start, [(0, 5.0)], 2).tolist() == [1, 1]


def test_of_a_nanokilogram_a_free_end_is_as_good() -> None:
    """(tau/m)^2 and (x(T) - 1)^2: the least is 3/4, and told as that, in one segment without demands, too."""
    cost = Cost("(tau.x.s*10^9)^2", "(x.s-1)^2")
    problem = ControlProblem(controls=["tau.x.s"], horizon=1, intervals=20, steps=2, q=[0], cost=cost)
    found = optimal_control(nanokilogram(), problem, Demands(segments=1))
    assert found.status == "optimal"
    assert found.cost == pytest.approx(0.75, rel=1e-6)


def test_a_cost_that_vanishes_at_its_least_value_has_an_optimum() -> None:
    """x = cos(sqrt(k) t) is -1/2 after a second where k = (2 pi/3)^2: the cost (x + 1/2)^2 falls to 0 there."""
    joint = {"type": "prismatic", "coordinate": "s", "stiffness": "k"}
    body = {"name": "b", "parent": "base", "joint": joint, "mass": 1}
    document = {"name": "x", "parameters": {"k": {"value": 1, "unit": "N/m"}}, "bodies": [body]}
    cost = Cost(terminal="(x.s + 1/2)^2")
    problem = ControlProblem(controls=[], horizon=1, intervals=20, steps=5, q=[1], cost=cost)
    wanted = Demands(free_parameters={"k": (1, 9)}, tolerance=1e-12)
    found = optimal_control(model_of(document, (0, 0, 0)), problem, wanted)
    assert found.parameters["k"] == pytest.approx((2 * np.pi / 3) ** 2, rel=1e-8)
    assert (found.status, found.is_right) == ("optimal", True)
