"""Simulation: published periods, conserved quantities, orders; every trajectory is judged."""

from __future__ import annotations

import csv
import io

import numpy as np
import pytest
from analysis_models import FINE, PERIOD, catalogue_model, defaults, oscillator, random_model
from exported_models import derived_anew
from in_depth import seeds
from random_trees import model_of, random_states
from simulated import simulated

from substructures.analysis.motion.right_hand_side import RightHandSide, forward_kernel
from substructures.analysis.motion.trajectory import Trajectory
from substructures.analysis.motion.writers import to_csv
from substructures.analysis.simulate import Event, FixedStep, Outputs, Table, simulate
from substructures.quantities.numbers.evaluation import evaluate


def names(trajectory: Trajectory) -> set[str]:
    return {check.name for check in trajectory.checks}


@pytest.mark.parametrize("number", seeds(2, 8))
def test_the_right_hand_side_is_forward_dynamics(number: int) -> None:
    """L^T D L in the graph against Cholesky in numbers, on random trees with loads and inputs."""
    model = random_model(number)
    rng = np.random.default_rng(number)
    x = random_states(rng, 1, model.dof)
    inputs = {s.name: float(rng.uniform(-1, 1)) for s in model.program.symbols if s.kind == "input"}
    state = {"q": x["q"][0], "qd": x["qd"][0], "inputs": inputs, "t": 0.4}
    expected = evaluate(model, ["forward_dynamics"], **state)["forward_dynamics"]
    f = RightHandSide(model, defaults(model) | inputs)
    found = f(0.4, np.concatenate([x["q"][0], x["qd"][0], np.zeros(f.size - 2 * model.dof)]))
    np.testing.assert_allclose(found[: model.dof], x["qd"][0])
    scale = np.abs(expected).max()
    np.testing.assert_allclose(found[model.dof : 2 * model.dof], expected, rtol=0, atol=1e-11 * scale)


def test_kernels_are_reused() -> None:
    one, two = derived_anew("acrobot"), derived_anew("acrobot")
    assert one is not two
    assert forward_kernel(one) is forward_kernel(two)


@pytest.mark.parametrize("method", ["DOP853", "Radau"])
def test_period_of_the_simple_pendulum(method: str) -> None:
    """To 1e-9 of the elliptic integral: the velocity falls through zero once in a period."""
    event = Event("turn", "x.q1'", direction="falling", action="stop")
    fine = FINE if method == "DOP853" else {"relative_tolerance": 1e-12, "absolute_tolerance": 1e-12}
    request = {"q": [np.pi / 2 - 1e-15], "span": [0, 3], "events": [event], "method": method, **fine}
    motion = simulated(catalogue_model("simple-pendulum"), **request)
    assert motion.status == "stopped"
    assert motion.events[0].t == pytest.approx(PERIOD, abs=1e-9)
    assert motion.t[-1] == motion.events[0].t
    assert motion.is_right


def test_puma_560_keeps_its_energy() -> None:
    """Free motion for 100 s; the vertical moment of momentum is constant, too."""
    request = {"q": [0.1, 0.2, 0.3, 0.4, 0.5, 0.6], "qd": [0.5] * 6, "span": [0, 100], "count": 2, **FINE}
    motion = simulated(catalogue_model("puma560"), **request)
    assert motion.status == "finished"
    assert motion.is_right
    drifts = {check.name: check.relative for check in motion.checks}
    assert set(drifts) == {"energy", "momentum.x.q1", "steps"}
    assert drifts["energy"] < 1e-10
    assert drifts["momentum.x.q1"] < 1e-10
    energy = motion.series["energy"]
    assert abs(energy[-1] - energy[0]) < 1e-10 * abs(energy[0])


def test_a_free_body_keeps_all_six_momenta() -> None:
    request = {"q": [0] * 6, "qd": [0.3, -0.2, 0.1, 0.4, 0.2, 0.5], "span": [0, 5], **FINE}
    motion = simulated(catalogue_model("free-body", (0, 0, 0)), **request)
    kinds = {f"{kind}_momentum.{axis}" for kind in ("linear", "angular") for axis in "xyz"}
    assert {"energy", *kinds} <= names(motion)
    assert max(check.relative for check in motion.checks) < 1e-11


@pytest.mark.parametrize("number", seeds(2, 6))
def test_balance_of_energy_on_random_trees(number: int) -> None:
    """With dampers, loads and inputs: H less the work of all forces without potential is constant."""
    model = random_model(number)
    inputs = {f"tau.{model.coordinates[0]}": "sin(3*t)/2", "x.u1": Table([0, 0.5, 1], [0, 1, -1])}
    inputs = {name: x for name, x in inputs.items() if name in {s.name for s in model.program.symbols}}
    request = {"q": [0.1] * model.dof, "span": [0, 0.4], "inputs": inputs, **FINE}
    if "x.u1" in inputs:
        inputs["x.u1"] = Table([0, 0.5, 1], [0, 1, -1], "cubic")
    motion = simulated(model, **request)
    assert motion.status == "finished", motion.message
    assert names(motion) & {"energy", "energy-balance"}
    assert max(check.relative for check in motion.checks) < 1e-9, motion.checks


def test_energy_falls_with_dampers() -> None:
    motion = simulated(model_of(oscillator(stiffness=4, damping=0.5), (0, 0, 0)), [1], (0, 10), **FINE)
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
    motion = simulated(catalogue_model("puma560"), **request)
    assert motion.status == "finished"
    assert not motion.is_right
    energy = next(check for check in motion.checks if check.name == "energy")
    assert energy.time is not None
    assert 0 < energy.time < 5
    assert energy.relative > 1e-6


def test_rounding_is_no_violation() -> None:
    """The upright pendulum falls by the error of pi alone: its energy is noise."""
    motion = simulate(catalogue_model("simple-pendulum"), [np.pi], (0, 1))
    assert 0 < np.abs(motion.qd).max() < 1e-13
    assert motion.is_right


def test_outputs_do_not_depend_on_their_number() -> None:
    model = catalogue_model("double-pendulum")
    base = {"q": [1, 0.5], "span": [0, 2], **FINE}
    many, few = simulated(model, **base, step=0.01), simulated(model, **base, times=[0.5, 2])
    assert len(many.t) == 201
    np.testing.assert_allclose(many.q[[50, 200]], few.q, atol=1e-11)


@pytest.mark.parametrize(("method", "order"), [("rk4", 4), ("semi-implicit-euler", 1)])
def test_order_of_fixed_steps(method: str, order: int) -> None:
    """Halving the step divides the error by 2^order; the real-time factor is told."""
    model = catalogue_model("double-pendulum")
    base = {"q": [1, 0.5], "span": [0, 1], "count": 2, "drift_limit": 1}
    exact = simulated(model, **base | FINE).q[-1]
    steps = [0.02, 0.01] if order == 4 else [2e-3, 1e-3]
    runs = [simulated(model, **base, fixed_step=FixedStep(h, method)) for h in steps]
    errors = [np.abs(run.q[-1] - exact).max() for run in runs]
    assert np.log2(errors[0] / errors[1]) == pytest.approx(order, abs=0.3)
    assert runs[0].figures["real_time_factor"] > 0
    assert 0 < runs[0].figures["longest_step"] < 1 / runs[0].figures["real_time_factor"] + 1e-9
    assert runs[1].steps == round(1 / steps[1])


@pytest.mark.parametrize(("step", "times"), [(0.25, [2, 2.25, 2.5, 2.75, 3]), (0.4, [2, 2.4, 2.8, 3])])
def test_results_at_steps_from_the_start_and_at_the_end(step: float, times: list[float]) -> None:
    motion = simulate(model_of(oscillator(stiffness=4), (0, 0, 0)), [1], (2, 3), outputs=Outputs(step=step))
    assert motion.t.tolist() == pytest.approx(times)


def test_outputs_between_fixed_steps() -> None:
    model = model_of(oscillator(stiffness=4), (0, 0, 0))
    request = {"q": [1], "span": [0, 1], "times": [0.33333, 1], "fixed_step": FixedStep(0.01)}
    np.testing.assert_allclose(simulated(model, **request).q[:, 0], np.cos([0.66666, 2]), atol=1e-7)


def test_followed_quantities_and_files() -> None:
    model = catalogue_model("double-pendulum")
    motion = simulate(model, [1, 0.5], (0, 1), outputs=Outputs(count=5, series={"sum": "x.q1 + x.q2"}))
    np.testing.assert_allclose(motion.series["sum"], motion.q.sum(axis=1))
    rows = list(csv.DictReader(io.StringIO(to_csv(motion))))
    assert len(rows) == 5
    assert [float(row["x.q1'"]) for row in rows] == motion.qd[:, 0].tolist()
    assert motion.summary()["checks"][0]["holds"] is True


def test_results_say_in_two_lines_what_they_are() -> None:
    motion = simulate(catalogue_model("simple-pendulum"), [1], (0, 1), outputs=Outputs(count=3))
    first, second = repr(motion).splitlines()
    assert first.startswith("Trajectory: 3 states of x.q1, t = 0 to 1 s, ")
    assert second == "is_right=True: 2 of 2 checks hold (energy constant, steps accurate); series: energy"
