"""Optimal control with velocity constraints: a sleigh on its blade beside its equations in three rates."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np
import pytest
from rolling_bodies import sleigh_part
from scipy.integrate import solve_ivp

from substructures import ControlProblem, Cost, Demands, End, Model, cost_gradient, couple, derive, optimal_control
from substructures.analysis.control.adjoint import adjoint_equations
from substructures.analysis.control.closed_start import start_state
from substructures.analysis.control.first_controls import first_variables, unmet
from substructures.analysis.control.nonlinear_program import ShootingProgram
from substructures.analysis.control.optimal_control import Optimum
from substructures.analysis.control.shooting import Shooting
from substructures.analysis.equations.nonholonomic.constrained_formulas import ConstrainedFormulas, rows_expected
from substructures.certificate.derived.adjoint import adjoint
from substructures.errors import InvalidInput, VerificationFailed
from substructures.expr.program import Program
from substructures.quantities.certificate import DYNAMICS, certified
from substructures.tree.model import KINEMATICS

MASS, INERTIA, ARM = 2.0, 0.3, 0.25
CONTROLS = ["s.u", "tau.s.f"]
EFFORT = Cost("s.u^2 + tau.s.f^2")


def sleigh(**more: Any) -> Model:
    """Pushed along its blade, and turned."""
    push = {"type": "force", "body": "b", "at": [0, 0, 0], "vector": ["u", 0, 0], "frame": "body"}
    part = {**sleigh_part(), "inputs": {"u": {"unit": "N"}}, "loads": [push]}
    blade = {"name": "blade", "type": "knife_edge", "frame": "s.b"}
    tree = {"name": "t", "instances": [{"name": "s", "substructure": "sleigh"}], "velocity_constraints": [blade]}
    return couple({**tree, **more}, {"s": derive(part)})


@pytest.fixture(scope="module")
def model() -> Model:
    return sleigh()


def problem(horizon: float, intervals: int, **more: Any) -> ControlProblem:
    given: dict[str, Any] = {"controls": CONTROLS, "cost": EFFORT, "q": [0, 0, 0], "steps": 4, **more}
    return ControlProblem(horizon=horizon, intervals=intervals, **given)


def test_straight_on_at_least_effort(model: Model) -> None:
    """From rest to rest over d in T: 12 m^2 d^2/T^3, by a force that falls on a line."""
    found = optimal_control(model, problem(2, 8), Demands(End({"s.x": 1.5}, [0, 0, 0]), segments=4))
    assert found.status == "optimal"
    assert found.is_right
    assert found.cost == pytest.approx(12 * MASS**2 * 1.5**2 / 8, rel=1e-6)
    np.testing.assert_allclose(found.controls[:, 0], 6 * MASS * 1.5 / 4 * np.linspace(1, -1, 9), atol=1e-3)
    assert {check.name for check in found.checks} >= {"constraints", "end"}


def test_a_sleigh_is_parked_sideways(model: Model) -> None:
    """Its own equations under the controls that were found, (m + I/a^2 ...) in V along the blade and w: V' = u/m +
    a w^2, (I + m a^2) w' = M - m a w V (S. A. Chaplygin, Mat. Sbornik 28, 1911), lead to the same end.
    """
    turn = [1, 0.5, 0, -0.5, -1, -0.5, 0, 0, -0.5, -1, 0, 0.5, 1]
    guess = {"s.u": [1] * 6 + [-1] * 7, "tau.s.f": turn}
    found = optimal_control(model, problem(3, 12), Demands(End([0, 1, 0], [0, 0, 0]), segments=4, guess=guess))
    assert_parked_sideways(found)


def test_a_sleigh_is_parked_sideways_without_a_guess(model: Model) -> None:
    """At least effort, which the search with a guess does not better."""
    found = optimal_control(model, problem(3, 12), Demands(End([0, 1, 0], [0, 0, 0]), segments=4))
    assert_parked_sideways(found)
    assert found.cost < 10.9


def test_where_nothing_goes_to_first_order_controls_swing(model: Model) -> None:
    """At rest a blade goes sideways by brackets alone: x and f are met to first order, y is not. A
    guess that is given is the start.
    """
    aside, ahead = (Demands(End(end, [0, 0, 0]), segments=1) for end in ([0, 1, 0], [1, 0, 0.5]))
    search = ShootingProgram(model, problem(3, 6), aside)
    assert unmet(search, search.guess()).tolist() == [False, True, False, False, False]
    starts = list(first_variables(search))
    assert len(starts) > 1
    assert not unmet(search, starts[0]).any()
    straight = ShootingProgram(model, problem(3, 6), ahead)
    (only,) = first_variables(straight)
    assert not only.any()
    given = ShootingProgram(model, problem(3, 6), replace(aside, guess={"s.u": 2}))
    (only,) = first_variables(given)
    assert only.tolist() == given.guess().tolist()


def assert_parked_sideways(found: Optimum) -> None:
    assert found.status == "optimal"
    assert found.is_right
    nodes = np.linspace(0, 3, 13)

    def rates(t: float, s: np.ndarray) -> list[float]:
        _, _, f, V, w = s  # noqa: N806
        u, M = (np.interp(t, nodes, found.controls[:, k]) for k in (0, 1))  # noqa: N806
        turning = (M - MASS * ARM * w * V) / (INERTIA + MASS * ARM**2)
        return [V * np.cos(f), V * np.sin(f), w, u / MASS + ARM * w**2, turning]

    own = solve_ivp(rates, (0, 3), np.zeros(5), rtol=1e-10, atol=1e-12, max_step=0.25)
    np.testing.assert_allclose(own.y[:, -1], [0, 1, 0, 0, 0], atol=1e-4)
    assert np.ptp(found.trajectory.q[:, 0]) > 0.1


def test_gradients_are_differences(model: Model) -> None:
    given = problem(0.5, 2, q=[0.1, 0.2, 0.4], qd=[np.cos(0.4), np.sin(0.4), 0.7])
    given = ControlProblem(**{**vars(given), "cost": Cost("s.u^2 + s.y*s.f'", "s.x*s.f + s.y'^2")})
    values = np.array([[0.3, 0.2], [-0.4, 0.5], [0.1, -0.6]])
    found = cost_gradient(model, given, values=dict(zip(CONTROLS, values.T.tolist(), strict=True)), vary=["s.m"])
    assert found.is_right
    start = start_state(model, given)
    shooting, h = Shooting(model, given, start, ["s.m"]), 1e-5

    def at(controls: np.ndarray, mass: float = MASS) -> float:
        return shooting.at({"s.m": mass}, 0.5).run(start.x[None], controls).cost

    for index in np.ndindex(3, 2):
        change = np.zeros((3, 2))
        change[index] = h
        by = (at(values + change) - at(values - change)) / (2 * h)
        assert found.controls[index] == pytest.approx(by, abs=1e-8)
    by = (at(values, MASS + h) - at(values, MASS - h)) / (2 * h)
    assert found.parameters["s.m"] == pytest.approx(by, abs=1e-8)


def test_wrong_equations_are_found(model: Model) -> None:
    """Each sum and each cosine of the program, changed to another."""
    right = adjoint_equations(model, CONTROLS, EFFORT).program
    texts, f = {"running": EFFORT.running, "terminal": "0"}, ConstrainedFormulas(model)
    needs, found = (*DYNAMICS, *KINEMATICS), 0
    more = {s.name: "input" for s in right.symbols if s.name.startswith(("lambda", "mu", "rho", "nu"))}

    def require(source: Program) -> None:
        rows = rows_expected(f, source)
        assert rows is not None
        expected = adjoint(CONTROLS, texts, (), ("blade",), model.positions, (rows, source))
        certified(source, model, expected, "x", needs=needs, more=more)

    require(right)
    for i, (op, *args) in enumerate(right.operations):
        if op in ("add", "sub", "cos", "sin"):
            other = {"add": "sub", "sub": "add", "cos": "sin", "sin": "cos"}[op]
            wrong = (*right.operations[:i], (other, *args), *right.operations[i + 1 :])
            with pytest.raises(VerificationFailed):
                require(Program(right.symbols, wrong, right.outputs))
            found += 1
    assert found > 5


def test_what_does_not_go_is_refused(model: Model) -> None:
    with pytest.raises(InvalidInput, match="violate the constraints"):
        cost_gradient(model, problem(1, 2, qd=[0, 1, 0]))
    table = {"type": "linear", "name": "belt", "expression": "s.x' - 1"}
    moving = sleigh(velocity_constraints=[table])
    with pytest.raises(InvalidInput, match="moves by itself"):
        cost_gradient(moving, problem(1, 2, qd=[1, 0, 0]))
