"""Optimal control of trees with closures: gradients by differences on the closures, loops that have a closed form."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
from closed_trees import four_bar, stewart, tree_model
from in_depth import seeds
from random_trees import Plain

from substructures import InvalidInput, Model
from substructures.analysis.closed.loops import loop_state
from substructures.analysis.control import shooting
from substructures.analysis.control.closed_start import start_state
from substructures.analysis.control.cost_gradient import cost_gradient
from substructures.analysis.control.demands import Demands, End
from substructures.analysis.control.from_fields import control_arguments
from substructures.analysis.control.optimal_control import optimal_control
from substructures.analysis.control.problem import ControlProblem, Cost
from substructures.analysis.control.shooting import Shooting
from substructures.analysis.motion.problems.signals import Table
from substructures.analysis.simulate import Outputs, simulate

DOWN = (0, -9.81, 0)
STENCIL = np.array([-2, -1, 1, 2]) * 1e-3
WEIGHTS = np.array([1, -8, 8, -1]) / 12e-3
RAIL: Plain = {
    "name": "rail",
    "parameters": {"m": {"value": 1, "unit": "kg"}},
    "bodies": [
        {"name": "cart", "parent": "base", "joint": {"type": "prismatic", "coordinate": "s"}, "mass": "m"},
    ],
    "ports": [{"name": "top", "body": "cart"}],
}


def two_carts() -> Model:
    """Carts of 1 and 3 kg on one rail, welded together: one of 4 kg; five of the six rows are redundant."""
    carts = [{"name": name, "substructure": "rail", "parameters": {"m": m}} for name, m in (("a", 1), ("b", 3))]
    document = {"instances": carts, "closures": [{"name": "weld", "type": "weld", "from": "a.top", "to": "b.top"}]}
    return tree_model(document, {"rail": RAIL})


def test_welded_carts_are_one() -> None:
    """u = 6 m (T - 2 t)/T^3 and J = 12 m^2/T^3 from rest to rest, one metre; the second cart needs no demand."""
    for end in (End([1, 1], [0, 0]), End({"a.s": 1}, {"b.s": 0})):
        problem = ControlProblem(controls=["tau.a.s"], cost=Cost("tau.a.s^2"), horizon=1.5, intervals=6, q=[0, 0])
        found = optimal_control(two_carts(), problem, Demands(end, tolerance=1e-14))
        assert found.status == "optimal"
        assert found.trajectory.is_right
        assert found.cost == pytest.approx(12 * 16 / 1.5**3, rel=1e-9)
        np.testing.assert_allclose(found.controls[:, 0], 24 * (1.5 - 2 * np.linspace(0, 1.5, 7)) / 1.5**3, atol=1e-6)
        np.testing.assert_allclose(found.trajectory.q[:, 0], found.trajectory.q[:, 1], atol=1e-12)
        assert found.hamiltonian_drift is not None
        assert found.hamiltonian_drift < 1e-5


def request(model: Model, rng: Any, **more: Any) -> Plain:
    """A cost that depends on everything, from a closed state."""
    state = loop_state(model, rng.uniform(-0.3, 0.3, model.dof), qd=rng.uniform(-1, 1, model.dof)).consistent
    first, last = model.coordinates[0], model.coordinates[-1]
    cost = Cost(f"tau.{first}^2 + sin({last})*{first}' + 0.1*t*{last}'^2", f"{first}'^2 + cos({last})")
    basis = {"controls": [f"tau.{first}", f"tau.{last}"], "cost": cost, "horizon": 0.1, "intervals": 3, "steps": 8}
    values = {f"tau.{name}": rng.uniform(-1, 1, 4).tolist() for name in (first, last)}
    return basis | {"q": state.q, "qd": state.qd, "values": values} | more


@pytest.mark.parametrize("make", [lambda: four_bar(DOWN), stewart], ids=["four-bar", "stewart"])
def test_gradients_are_those_by_differences(make: Any) -> None:
    """By controls, by a mass, and by starts that stay on the closures; redundant closures included."""
    model, rng = make(), np.random.default_rng(11)
    (mass, *_) = [name for name, p in model.parameters.items() if p.get("unit") == "kg"]
    asked = request(model, rng, vary=[mass])
    found = cost_gradient(model, **control_arguments(**asked))
    assert found.status == "finished"
    assert {"closures", "gradient by qd"} <= {check.name for check in found.checks}
    assert found.is_right
    problem = ControlProblem(**{name: x for name, x in asked.items() if name not in ("values", "vary")})
    moving = Shooting(model, problem, start_state(model, problem), [mass])
    controls, start, nominal = np.array(list(asked["values"].values())).T, moving.start.x, dict(moving.values)
    assert moving.run(start[None], controls).cost == found.cost

    def slope(du: Any, dx: Any, dm: float) -> float:
        costs = []
        for h in STENCIL:
            moving.values = nominal | {mass: nominal[mass] + h * dm}
            costs.append(moving.run(start[None] + h * dx, controls + h * du).cost)
        return float(WEIGHTS @ costs)

    way = rng.uniform(-1, 1, controls.shape)
    assert np.sum(found.controls * way) == pytest.approx(slope(way, 0, 0), rel=1e-7)
    assert found.parameters[mass] == pytest.approx(slope(0, 0, 1), rel=1e-7)
    # dq' = N z: what the closures leave free
    free = loop_state(model, asked["q"], qd=rng.uniform(-1, 1, model.dof)).consistent.qd
    assert found.qd @ free == pytest.approx(slope(0, np.append(0 * free, free), 0), rel=1e-7)


def swung(model: Model, **more: Any) -> Any:
    """A four-bar from one position of its crank to another, from rest to rest."""
    start = loop_state(model, [0.7, 0.2, 1.2], fixed=[model.coordinates[0]]).consistent.q
    problem = ControlProblem(
        controls=["tau.x.crank"], cost=Cost("tau.x.crank^2"), horizon=0.4, intervals=8, steps=6, q=start
    )
    return optimal_control(model, problem, Demands(**{"end": End({"x.crank": 1.5}, [0, 0, 0])} | more))


@pytest.mark.parametrize("segments", [1, 4])
def test_four_bar_from_rest_to_rest(segments: int) -> None:
    """The torque that was found moves it there in a simulation, too; three rates are demanded, of which one counts."""
    model = four_bar(DOWN)
    found = swung(model, segments=segments)
    assert found.status == "optimal"
    assert found.trajectory.is_right
    assert found.hamiltonian_drift is not None
    assert found.hamiltonian_drift < 0.05
    at, u = np.linspace(0, 0.4, 9), found.controls[:, 0]
    torque = {"tau.x.crank": Table(at.tolist(), u.tolist())}
    moved = simulate(model, found.trajectory.q[0], (0, 0.4), inputs=torque, outputs=Outputs(times=[0.4]))
    assert moved.is_right
    assert moved.q[-1, 0] == pytest.approx(1.5, abs=2e-4)
    np.testing.assert_allclose(moved.qd[-1], 0, atol=2e-3)
    np.testing.assert_allclose(moved.q[-1], found.trajectory.q[-1], atol=2e-4)


def test_what_the_closures_forbid_is_refused() -> None:
    model = four_bar(DOWN)
    opened = {"q": {"x.crank": 1.5, "x.rocker": 0.3}}
    with pytest.raises(InvalidInput, match=r"x\.(rocker|crank)") as caught:
        swung(model, end=End(**opened))
    assert (caught.value.faults[0].pointer, caught.value.faults[0].code) == ("/end/q", "open-closure")
    with pytest.raises(InvalidInput, match="the other demands") as caught:
        swung(model, end=End({"x.crank": 1.5}, [1, 1, 1]))
    assert caught.value.faults[0].pointer == "/end/qd"
    with pytest.raises(InvalidInput, match=r"depend on 'x\.l1'") as caught:
        cost_gradient(model, **control_arguments(**request(model, np.random.default_rng(1), vary=["x.l1"])))
    assert (caught.value.faults[0].pointer, caught.value.faults[0].code) == ("/vary/0", "opens-closure")
    far = ControlProblem(controls=[], horizon=1, intervals=1, q=[0, 50, 0], parameters={"x.l3": 9})
    with pytest.raises(InvalidInput, match="cannot be met") as caught:
        cost_gradient(model, far)
    assert (caught.value.faults[0].pointer, caught.value.faults[0].code) == ("/q", "open-closure")


@pytest.mark.parametrize("seed", seeds(1, 4))
def test_planted_faults_are_found(seed: int, monkeypatch: pytest.MonkeyPatch) -> None:
    """Multipliers with the wrong sign, and closures that are left out of the motion: checks fail, gradients differ."""
    model, rng = four_bar(DOWN), np.random.default_rng(seed)
    asked = request(model, rng)
    right = cost_gradient(model, **control_arguments(**asked))
    solve = shooting.saddle_solve

    def turned(*given: Any) -> Any:
        x, y = solve(*given)
        return x, -y

    def lost(g: Any, rows: Any, a: Any, b: Any) -> Any:
        return solve(g, 0 * rows + np.eye(*rows.shape[1:]), a, b)

    monkeypatch.setattr(shooting, "saddle_solve", turned)
    wrong = cost_gradient(model, **control_arguments(**asked))
    assert wrong.cost == right.cost
    assert np.abs(wrong.qd - right.qd).max() > 1e-3 * np.abs(right.qd).max()
    monkeypatch.setattr(shooting, "saddle_solve", lost)
    opened = cost_gradient(model, **control_arguments(**asked))
    assert not opened.is_right
    assert next(check for check in opened.checks if check.name == "closures").holds is False


def test_starts_are_closed() -> None:
    """The nearest closed state, and independent rows of a mechanism in the plane: two of five."""
    start = start_state(four_bar(), ControlProblem(controls=[], horizon=1, intervals=1, q=[0.7, 0.2, 1.2]))
    assert start.rows.tolist() == [0, 1]
    assert start.closed is not None
    assert start.closed.opening < 1e-12
