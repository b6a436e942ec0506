"""Simulation: published periods, conserved quantities, events, inputs, failures; every trajectory is judged."""

from __future__ import annotations

import csv
import io
from decimal import Decimal
from typing import Any

import numpy as np
import pytest
from analysis_models import catalogue_model, defaults, random_model, seeds
from random_trees import Plain, model_of, random_states

from substructures import InvalidDocument, MissingValue
from substructures.analysis.equilibria import equilibria
from substructures.analysis.linearise import linearise
from substructures.analysis.right_hand_side import RightHandSide, forward_kernel
from substructures.analysis.simulate import simulate
from substructures.analysis.trajectory import Trajectory
from substructures.analysis.writers import to_csv, to_npz
from substructures.evaluation import evaluate

FINE: Plain = {"relative_tolerance": 1e-13, "absolute_tolerance": 1e-14}
#: released at rest from the horizontal, m = L = 1, g = 9.81: 4 sqrt(L/g) K(sin 45 deg) (IFToMM A01)
PERIOD = 2.3678419475762373


def oscillator(**joint: Any) -> Plain:
    """A mass of 1 kg on a slide."""
    slide = {"type": "prismatic", "coordinate": "s"} | joint
    return {"name": "mass", "bodies": [{"name": "b", "parent": "base", "joint": slide, "mass": 1}]}


def names(trajectory: Trajectory) -> set[str]:
    return {check.name for check in trajectory.checks}


@pytest.mark.parametrize("number", seeds(4, 8))
def test_the_right_hand_side_is_forward_dynamics(number: int) -> None:
    """L^T D L in the graph against Cholesky in numbers, on random trees with loads and inputs."""
    model = random_model(number)
    rng = np.random.default_rng(number)
    x = random_states(rng, 1, model.dof)
    inputs = {s.name: float(rng.uniform(-1, 1)) for s in model.program.symbols if s.kind == "input"}
    state = {"q": x["q"][0], "qd": x["qd"][0], "inputs": inputs, "t": 0.4}
    expected = evaluate(model, {"quantities": ["forward_dynamics"], **state})["forward_dynamics"]
    f = RightHandSide(model, defaults(model) | inputs)
    found = f(0.4, np.concatenate([x["q"][0], x["qd"][0], np.zeros(f.size - 2 * model.dof)]))
    np.testing.assert_allclose(found[: model.dof], x["qd"][0])
    scale = np.abs(expected).max()
    np.testing.assert_allclose(found[model.dof : 2 * model.dof], expected, rtol=0, atol=1e-11 * scale)


def test_kernels_are_reused() -> None:
    one, two = catalogue_model("acrobot"), catalogue_model("acrobot")
    assert one is not two
    assert forward_kernel(one) is forward_kernel(two)


@pytest.mark.parametrize("method", ["DOP853", "Radau"])
def test_period_of_the_simple_pendulum(method: str) -> None:
    """To 1e-9 of the elliptic integral: the velocity falls through zero once in a period."""
    event = {"name": "turn", "quantity": "x.q1'", "direction": "falling", "action": "stop"}
    fine = FINE if method == "DOP853" else {"relative_tolerance": 1e-12, "absolute_tolerance": 1e-12}
    request = {"q": [np.pi / 2 - 1e-15], "span": [0, 3], "events": [event], "method": method, **fine}
    motion = simulate(catalogue_model("simple-pendulum"), request)
    assert motion.status == "stopped"
    assert motion.events[0].t == pytest.approx(PERIOD, abs=1e-9)
    assert motion.t[-1] == motion.events[0].t
    assert motion.is_right


def test_puma_560_keeps_its_energy() -> None:
    """Free motion for 100 s; the vertical moment of momentum is constant, too."""
    request = {"q": [0.1, 0.2, 0.3, 0.4, 0.5, 0.6], "qd": [0.5] * 6, "span": [0, 100], "count": 2, **FINE}
    motion = simulate(catalogue_model("puma560"), request)
    assert motion.status == "finished"
    assert motion.is_right
    drifts = {check.name: check.relative for check in motion.checks}
    assert set(drifts) == {"energy", "momentum.x.q1"}
    assert drifts["energy"] < 1e-10
    assert drifts["momentum.x.q1"] < 1e-10
    energy = motion.series["energy"]
    assert abs(energy[-1] - energy[0]) < 1e-10 * abs(energy[0])


def test_a_free_body_keeps_all_six_momenta() -> None:
    request = {"q": [0] * 6, "qd": [0.3, -0.2, 0.1, 0.4, 0.2, 0.5], "span": [0, 5], **FINE}
    motion = simulate(catalogue_model("free-body", (0, 0, 0)), request)
    kinds = {f"{kind}_momentum.{axis}" for kind in ("linear", "angular") for axis in "xyz"}
    assert {"energy", *kinds} <= names(motion)
    assert max(check.relative for check in motion.checks) < 1e-11


@pytest.mark.parametrize("number", seeds(4, 6))
def test_balance_of_energy_on_random_trees(number: int) -> None:
    """With dampers, loads and inputs: H less the work of all forces without potential is constant."""
    model = random_model(number)
    inputs = {f"tau.{model.coordinates[0]}": "sin(3*t)/2", "x.u1": {"times": [0, 0.5, 1], "values": [0, 1, -1]}}
    inputs = {name: x for name, x in inputs.items() if name in {s.name for s in model.program.symbols}}
    request = {"q": [0.1] * model.dof, "span": [0, 0.4], "inputs": inputs, **FINE}
    if "x.u1" in inputs:
        request["inputs"]["x.u1"] |= {"interpolation": "cubic"}
    motion = simulate(model, request)
    assert motion.status == "finished", motion.message
    assert names(motion) & {"energy", "energy-balance"}
    assert max(check.relative for check in motion.checks) < 1e-9, motion.checks


def test_energy_falls_with_dampers() -> None:
    motion = simulate(model_of(oscillator(stiffness=4, damping=0.5), (0, 0, 0)), {"q": [1], "span": [0, 10], **FINE})
    falling = next(check for check in motion.checks if check.rule == "falling")
    assert falling.holds
    assert motion.series["energy"][-1] < 0.01 * motion.series["energy"][0]
    # x = e^(-t/4) (cos w t + sin(w t)/(4 w)), w = sqrt(4 - 1/16)
    w, t = np.sqrt(4 - 1 / 16), motion.t
    exact = np.exp(-t / 4) * (np.cos(w * t) + np.sin(w * t) / (4 * w))
    np.testing.assert_allclose(motion.q[:, 0], exact, atol=1e-11)


def test_a_coarse_motion_is_marked_wrong() -> None:
    """The first time and the size of the violation are told."""
    request = {"q": [0.1] * 6, "qd": [1] * 6, "span": [0, 5], "relative_tolerance": 1e-2, "absolute_tolerance": 1e-2}
    motion = simulate(catalogue_model("puma560"), request)
    assert motion.status == "finished"
    assert not motion.is_right
    energy = next(check for check in motion.checks if check.name == "energy")
    assert energy.time is not None
    assert 0 < energy.time < 5
    assert energy.relative > 1e-6


def test_rounding_is_no_violation() -> None:
    """The upright pendulum falls by the error of pi alone: its energy is noise."""
    motion = simulate(catalogue_model("simple-pendulum"), {"q": [np.pi], "span": [0, 1]})
    assert 0 < np.abs(motion.qd).max() < 1e-13
    assert motion.is_right


def test_constant_force_and_tables() -> None:
    """s'' = u: a number, an expression, a held, a linear and a cubic table against their integrals."""
    model = model_of(oscillator(), (0, 0, 0))
    times = np.linspace(0, 2, 5)
    held = {"times": [0, 1, 2], "values": [1, -1, 0], "interpolation": "hold"}
    for given, exact in (
        (3, 1.5 * times**2),
        ("6*t", times**3),
        ({"times": [0, 2], "values": [0, 12]}, times**3),
        ({"times": [0, 1, 2, 3], "values": [0, 1, 4, 9], "interpolation": "cubic"}, times**4 / 12),
        (held, np.where(times <= 1, times**2 / 2, 0.5 + (times - 1) - (times - 1) ** 2 / 2)),
    ):
        request = {"q": [0], "span": [0, 2], "times": times, "inputs": {"tau.x.s": given}, **FINE}
        motion = simulate(model, request)
        np.testing.assert_allclose(motion.q[:, 0], exact, atol=1e-12)
        assert motion.is_right


def test_jumps_of_tables_cost_no_accuracy_and_few_steps() -> None:
    """The integrator begins anew at a jump, with the value from the side it is on."""
    held = {"times": [0, 0.3, 0.7, 1], "values": [2, -3, 5, 0], "interpolation": "hold"}
    base: Plain = {"q": [0], "span": [0, 1], "inputs": {"tau.x.s": held}, "count": 2, **FINE}
    motion = simulate(model_of(oscillator(), (0, 0, 0)), base)
    # v = 0.6, -0.6, 0.9 at the ends of the pieces
    exact = 0.5 * 2 * 0.09 + (0.6 * 0.4 - 1.5 * 0.16) + (-0.6 * 0.3 + 2.5 * 0.09)
    assert motion.q[-1, 0] == pytest.approx(exact, abs=1e-14)
    assert motion.qd[-1, 0] == pytest.approx(0.9, abs=1e-14)
    assert motion.steps < 40


def test_feedback_as_an_expression() -> None:
    """A spring and a damper by an input; energy changes by their work."""
    law = {"tau.x.s": "-4*x.s - x.s'/2"}
    one = simulate(model_of(oscillator(), (0, 0, 0)), {"q": [1], "span": [0, 3], "inputs": law, **FINE})
    two = simulate(model_of(oscillator(stiffness=4, damping=0.5), (0, 0, 0)), {"q": [1], "span": [0, 3], **FINE})
    np.testing.assert_allclose(one.q, two.q, atol=1e-12)
    assert one.is_right
    assert "work" in one.series


def test_events_are_found_in_order() -> None:
    """Of s = cos 2t: recorded crossings, directions, levels, and the stop."""
    model = model_of(oscillator(stiffness=4), (0, 0, 0))
    events = [
        {"name": "down", "quantity": "x.s", "direction": "falling", "action": "record"},
        {"name": "half", "quantity": "x.s", "level": 0.5, "action": "record"},
        {"name": "late", "quantity": "t", "level": 4, "action": "stop"},
    ]
    motion = simulate(model, {"q": [1], "span": [0, 100], "step": 0.5, "events": events, **FINE})
    found = [(e.name, e.t) for e in motion.events]
    turns = [np.pi / 6, np.pi / 4, 5 * np.pi / 6, 7 * np.pi / 6, 5 * np.pi / 4, 4.0]
    assert [name for name, _ in found] == ["half", "down", "half", "half", "down", "late"]
    np.testing.assert_allclose([t for _, t in found], turns, atol=1e-11)
    assert motion.status == "stopped"
    assert motion.t[-1] == 4


def test_outputs_do_not_depend_on_their_number() -> None:
    model = catalogue_model("double-pendulum")
    base = {"q": [1, 0.5], "span": [0, 2], **FINE}
    many, few = simulate(model, base | {"step": 0.01}), simulate(model, base | {"times": [0.5, 2]})
    assert len(many.t) == 201
    np.testing.assert_allclose(many.q[[50, 200]], few.q, atol=1e-11)


@pytest.mark.parametrize(("method", "order"), [("rk4", 4), ("semi-implicit-euler", 1)])
def test_order_of_fixed_steps(method: str, order: int) -> None:
    """Halving the step divides the error by 2^order; the real-time factor is told."""
    model = catalogue_model("double-pendulum")
    base = {"q": [1, 0.5], "span": [0, 1], "count": 2, "drift_limit": 1}
    exact = simulate(model, base | FINE).q[-1]
    steps = [0.02, 0.01] if order == 4 else [2e-3, 1e-3]
    runs = [simulate(model, base | {"fixed_step": {"step": h, "method": method}}) for h in steps]
    errors = [np.abs(run.q[-1] - exact).max() for run in runs]
    assert np.log2(errors[0] / errors[1]) == pytest.approx(order, abs=0.3)
    assert runs[0].figures["real_time_factor"] > 0
    assert runs[1].steps == round(1 / steps[1])


def test_outputs_between_fixed_steps() -> None:
    model = model_of(oscillator(stiffness=4), (0, 0, 0))
    request = {"q": [1], "span": [0, 1], "times": [0.33333, 1], "fixed_step": {"step": 0.01}}
    np.testing.assert_allclose(simulate(model, request).q[:, 0], np.cos([0.66666, 2]), atol=1e-7)


def test_followed_quantities_and_files() -> None:
    model = catalogue_model("double-pendulum")
    motion = simulate(model, {"q": [1, 0.5], "span": [0, 1], "count": 5, "series": {"sum": "x.q1 + x.q2"}})
    np.testing.assert_allclose(motion.series["sum"], motion.q.sum(axis=1))
    with np.load(io.BytesIO(to_npz(motion)), allow_pickle=False) as stored:
        assert tuple(stored["coordinates"]) == model.coordinates
        np.testing.assert_array_equal(stored["q"], motion.q)
        np.testing.assert_array_equal(stored["energy"], motion.series["energy"])
    rows = list(csv.DictReader(io.StringIO(to_csv(motion))))
    assert len(rows) == 5
    assert [float(row["x.q1'"]) for row in rows] == motion.qd[:, 0].tolist()
    assert motion.summary()["checks"][0]["holds"] is True


def test_progress_is_told_and_can_cancel() -> None:
    model = catalogue_model("double-pendulum")
    told: list[float] = []
    simulate(model, {"q": [1, 0.5], "span": [2, 5]}, lambda share: told.append(share))
    assert told[-1] == 1
    assert told == sorted(told)
    motion = simulate(model, {"q": [1, 0.5], "span": [0, 50]}, lambda share: share < 0.1)
    assert motion.status == "stopped"
    assert "cancelled" in motion.message


@pytest.mark.parametrize("method", ["DOP853", "LSODA", "BDF"])
def test_a_motion_that_cannot_go_on_fails_with_advice(method: str) -> None:
    """s'' = 1 + s'^2 goes to infinity at t = pi/2; the motion up to there is kept."""
    definition = oscillator() | {"loads": [{"type": "joint", "coordinate": "s", "force": "1 + s'^2"}]}
    motion = simulate(model_of(definition, (0, 0, 0)), {"q": [0], "span": [0, 2], "step": 0.1, "method": method})
    assert motion.status == "failed"
    assert "the integrator could not go on" in motion.message
    assert 10 <= len(motion.t) <= 17
    # LSODA keeps its tolerance less strictly
    np.testing.assert_allclose(motion.qd[:15, 0], np.tan(motion.t[:15]), rtol=1e-4)


def test_a_singular_start_fails_with_advice() -> None:
    """The free body has no unique rates of its angles at pitch = 90 degrees."""
    motion = simulate(catalogue_model("free-body"), {"q": [0, 0, 0, 0, np.pi / 2, 0], "span": [0, 1]})
    assert motion.status == "failed"
    assert "pitch" in motion.message
    assert motion.t.tolist() == [0]
    empty = {"name": "empty", "bodies": [{"name": "b", "parent": "base", "joint": {"type": "revolute"}}]}
    motion = simulate(model_of(empty), {"q": [0], "span": [0, 1]})
    assert motion.status == "failed"
    assert "no inertia" in motion.message


def test_steps_are_limited() -> None:
    motion = simulate(catalogue_model("double-pendulum"), {"q": [1, 1], "span": [0, 100], "max_steps": 20})
    assert motion.status == "failed"
    assert "max_steps" in motion.message
    assert motion.steps == 20


@pytest.mark.parametrize(
    ("changes", "pointer"),
    [
        ({"q": [1]}, "/q"),
        ({"q": {"x.q1": 1}}, "/q"),
        ({"qd": [1, "a"]}, "/qd/1"),
        ({"span": [1, 0]}, ""),
        ({"span": [0, "b"]}, "/span/1"),
        ({"step": 0.1, "count": 3}, ""),
        ({"times": [0, 2]}, ""),
        ({"method": "euler"}, "/method"),
        ({"parameters": {"x.mass": 1}}, "/parameters/x.mass"),
        ({"parameters": {"x.m1": "heavy"}}, "/parameters/x.m1"),
        ({"inputs": {"tau.x.q1": 10**400}}, "/inputs/tau.x.q1"),
        ({"inputs": {"tau.x.q1": Decimal("1e400")}}, "/inputs/tau.x.q1"),
        ({"span": [0, 10**400]}, "/span/1"),
        ({"inputs": {"tau.x.q9": 1}}, "/inputs/tau.x.q9"),
        ({"inputs": {"tau.x.q1": "3*x.q7"}}, "/inputs/tau.x.q1"),
        ({"inputs": {"tau.x.q1": {"times": [0, 0.5], "values": [0, 1]}}}, "/inputs/tau.x.q1/times"),
        ({"inputs": {"tau.x.q1": {"times": [0, 1], "values": [0]}}}, "/inputs/tau.x.q1/values"),
        ({"events": [{"name": "e", "quantity": "x.q1 +"}]}, "/events/0/quantity"),
        ({"series": {"a": "nothing"}}, "/series/a"),
        ({"series": {"energy": "x.q1"}}, "/series/energy"),
        ({"fixed_step": {"step": 0.1}, "events": [{"name": "e", "quantity": "x.q1"}]}, "/events"),
        ({"stepp": 1}, "/stepp"),
    ],
)
def test_faults_have_pointers(changes: Plain, pointer: str) -> None:
    with pytest.raises(InvalidDocument) as error:
        simulate(catalogue_model("double-pendulum"), {"q": [0, 0], "span": [0, 1]} | changes)
    assert error.value.faults[0].pointer == pointer


def test_nothing_that_moves() -> None:
    """A camera on the wall can neither be simulated nor linearised."""
    model = catalogue_model("camera")
    for call in (simulate, linearise, lambda m, _: equilibria(m)):
        with pytest.raises(InvalidDocument, match="nothing that moves"):
            call(model, {"q": [], "span": [0, 1]})


def test_a_parameter_without_value_is_missing() -> None:
    definition = oscillator() | {"parameters": {"m": {}}}
    definition["bodies"][0]["mass"] = "m"
    with pytest.raises(MissingValue):
        simulate(model_of(definition), {"q": [0], "span": [0, 1]})
