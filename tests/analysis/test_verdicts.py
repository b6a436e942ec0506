"""Verdicts have three values: right, wrong, and nobody knows; what no first integral judges, a second run does."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np
import pytest
from analysis_models import oscillator, shipped
from catalogue_entries import shipped_part
from closed_trees import four_bar
from random_trees import Plain, model_of
from simulated import simulated

from substructures import Definition, Model, TreeSpec, couple, derive
from substructures.analysis.closed import loops
from substructures.analysis.closed.loops import least_multipliers, loop_state
from substructures.analysis.control.cost_gradient import cost_gradient
from substructures.analysis.control.demands import End
from substructures.analysis.control.from_fields import control_arguments
from substructures.analysis.control.optimal_control import optimal_control
from substructures.analysis.control.problem import Cost
from substructures.analysis.from_fields import sensitivity_arguments
from substructures.analysis.identification import fit
from substructures.analysis.identification.base_parameters import base_parameters
from substructures.analysis.identification.fit import identify
from substructures.analysis.motion.parameter_sensitivity import sensitivities
from substructures.analysis.motion.trajectory import Trajectory
from substructures.analysis.simulate import Event, FixedStep, Integrator, Linear, Outputs, Table, simulate
from substructures.analysis.stability.equilibria import Equilibrium, equilibria
from substructures.analysis.stability.linearise import linearise
from substructures.analysis.verdict import Check, verdict
from substructures.quantities.numbers.evaluation import evaluate
from substructures.quantities.regressor import regressor

HOLDS = Check("a", "constant", "", "J", 0.0, 1.0, 1e-7)
VIOLATED = Check("b", "zero", "", "m", 1.0, 1.0, 1e-7, 0.3)
SPARED = Check.left_out("c", "constant", "no need")
MISSING = Check.left_out("d", "accurate", "the second run failed", needed=True)


@pytest.mark.parametrize(
    ("checks", "finished", "expected"),
    [
        ([], True, None),
        ([SPARED], True, None),
        ([MISSING], True, None),
        ([HOLDS], True, True),
        ([HOLDS, SPARED], True, True),
        ([HOLDS, MISSING], True, None),
        ([HOLDS, VIOLATED], True, False),
        ([MISSING, VIOLATED], True, False),
        ([HOLDS], False, None),
        ([VIOLATED], False, None),
    ],
)
def test_three_values(checks: list[Check], finished: bool, expected: bool | None) -> None:
    assert verdict(checks, finished) is expected


def test_what_is_not_a_number_is_violated_and_what_was_not_made_has_no_numbers() -> None:
    assert Check.of(("x", "zero", "", ""), np.array([0, np.nan]), np.array([0.0, 0.5]), 1, 1).time == 0.5
    told = MISSING.summary()
    assert (told["holds"], told["worst"], told["limit"], told["reason"]) == (None, None, None, MISSING.reason)


def test_motions_that_did_not_come_to_their_end_are_neither_right_nor_wrong() -> None:
    model, start = shipped("acrobot"), [1.2, 0]
    failed = simulate(model, start, (0, 5), integrator=Integrator(max_steps=3))
    assert (failed.status, failed.is_right) == ("failed", None)
    assert failed.summary()["is_right"] is None
    assert "is_right=None" in repr(failed)
    cancelled = simulate(model, start, (0, 5), integrator=Integrator(progress=lambda share: share < 0.1))
    assert (cancelled.status, cancelled.is_right) == ("stopped", None)
    for fixed in (None, FixedStep(0.001)):
        cut = simulated(model, start, (0, 0.2), progress=lambda share: share < 0.5, fixed_step=fixed)
        assert cut.is_right is None
    stopped = simulate(model, start, (0, 5), outputs=Outputs(events=[Event("level", "x.q1", level=0.3)]))
    assert (stopped.status, stopped.is_right) == ("stopped", True)
    bare = Trajectory(("x",), np.zeros(1), np.zeros((1, 1)), np.zeros((1, 1)))
    assert bare.is_right is None


START: Plain = {"q": [1.2, 0], "span": (0, 3), "by": ["x.Ic1", "x.m2"], "of_start": True, "count": 31}


def error_of(name: str, found: Trajectory, exact: Trajectory) -> float:
    """Largest error over the largest number, by two motions."""
    about, _, series = name.partition(" of ")
    n = found.q.shape[1]
    half = {"q": slice(n), "qd": slice(n, None), "d.start": slice(None)}[about]
    whole = series or (about if about == "d.start" else "")
    one, two = (
        motion.series[whole][:, half] if whole else np.concatenate([motion.q, motion.qd], axis=1)[:, half]
        for motion in (found, exact)
    )
    return float(np.abs(one - two).max() / np.abs(two).max())


def test_sensitivities_state_their_error() -> None:
    """The difference of two runs is the error of the first, by a third that is far more accurate."""
    model = shipped("acrobot")
    exact = sensitivities(model, **sensitivity_arguments(**START, relative_tolerance=1e-13, absolute_tolerance=1e-14))
    assert exact.is_right
    judged = 0
    for tolerance in (1e-2, 1e-4, 1e-7):
        both = {"relative_tolerance": tolerance, "absolute_tolerance": tolerance}
        found = sensitivities(model, **sensitivity_arguments(**START, **both))
        assert found.is_right is False
        for check in found.checks:
            if check.rule == "accurate":
                judged += 1
                # ten times tighter tolerances: the second run has a tenth of the error, or some more
                assert check.relative == pytest.approx(error_of(check.name, found, exact), rel=0.6), check
    assert judged == 21


def test_sensitivities_of_loose_tolerances_are_not_right() -> None:
    """Tolerances of 0.1, for which simulations of the same motion say so, too."""
    model, loose = shipped("acrobot"), {"relative_tolerance": 0.1, "absolute_tolerance": 0.1}
    request: Plain = {"q": [1.2, 0], "span": (0, 5)}
    assert simulated(model, **request, **loose).is_right is False
    assert sensitivities(model, **sensitivity_arguments(**request, by=["x.Ic1"], **loose)).is_right is False
    assert sensitivities(model, **sensitivity_arguments(**request, by=["x.Ic1"])).is_right is True
    # steps that 'max_step' keeps short are not made shorter by tolerances: halved steps tell their error, too
    held = sensitivities(model, **sensitivity_arguments(**START, **loose, max_step=0.01, method="RK23"))
    exact = sensitivities(model, **sensitivity_arguments(**START))
    assert held.is_right is False
    for check in held.checks:
        if check.rule == "accurate":
            assert 0.5 < check.relative / error_of(check.name, held, exact) < 2, check


def test_sensitivities_that_fail_are_not_judged() -> None:
    found = sensitivities(shipped("acrobot"), [1.2, 0], (0, 5), ["x.Ic1"], integrator=Integrator(max_steps=5))
    assert (found.status, found.is_right) == ("failed", None)
    assert {check.holds for check in found.checks if check.rule == "accurate"} == {None}


def test_rest_is_right_although_rounding_is_all_there_is() -> None:
    """Hanging, q = pi has no exact sine: velocities of 1e-16 that no second run repeats."""
    found = sensitivities(shipped("simple-pendulum"), [np.pi], (0, 1), [])
    assert found.is_right, found.checks


def spring_of_given_length() -> Model:
    """A mass on a spring whose rest length is an input, so that energy has no balance that is known."""
    ends = {"from": {"body": "base", "at": [1, 0, 0]}, "to": {"body": "b", "at": [0, 0, 0]}}
    spring = {"type": "spring", **ends, "stiffness": 50, "damping": 0, "length": "u"}
    return model_of(oscillator() | {"name": "sprung", "inputs": {"u": {"unit": "m"}}, "loads": [spring]}, (0, 0, 0))


@pytest.mark.parametrize(
    ("change", "expected"),
    [
        ({}, True),
        ({"times": []}, True),
        ({"relative_tolerance": 1e-3, "absolute_tolerance": 1e-3}, False),
        ({"method": "RK45"}, True),
        ({"fixed_step": FixedStep(0.01)}, False),
        ({"fixed_step": FixedStep(0.001)}, True),
        ({"events": [Event("there", "x.s", 0.3)]}, True),
        ({"max_steps": 2}, None),
    ],
)
def test_motions_without_first_integrals_have_a_second_run(change: Plain, expected: bool | None) -> None:
    model = spring_of_given_length()
    found = simulated(model, [0.5], (0, 3), inputs={"x.u": "0.5*cos(3*t)"}, **change)
    assert found.is_right is expected, found.checks
    assert {check.rule for check in found.checks if check.made or check.needed} == {"accurate"}
    assert [check.name for check in found.checks if not check.needed] == ["energy"]
    # for a constant length there is a balance again, and no second run but of single steps
    plain = simulate(shipped("simple-pendulum"), [0.5], (0, 1))
    assert {check.name for check in plain.checks if check.rule != "constant"} == {"steps"}


def two_slides(length: str, **closures: Any) -> Model:
    """Two masses of 1 kg that slide along x and y; a spring with this rest length from (3, 0) to the second."""
    ends = {"from": {"body": "base", "at": [3, 0, 0]}, "to": {"body": "b", "at": [0, 0, 0]}}
    rows: list[Plain] = [{"psi": "pi/2", "theta": "pi/2"}, {"theta": "pi/2"}]
    joints = [{"type": "prismatic", "coordinate": name, **row} for name, row in zip("xy", rows, strict=True)]
    bodies = [
        {"name": b, "parent": p, "joint": j, "mass": 1} for b, p, j in zip("ab", ("base", "a"), joints, strict=True)
    ]
    spring = {"type": "spring", **ends, "stiffness": 50, "damping": 0, "length": length}
    definition = {"name": "slides", "inputs": {"u": {"unit": "m"}}, "bodies": bodies, "loads": [spring]}
    part = derive(Definition.read(definition | {"ports": [{"name": "p", "body": "b", "position": [0, 0, 0]}]}))
    one = {"name": "i", "substructure": "slides"}
    return couple(TreeSpec.read({"name": "t", "gravity": [0, 0, 0], "instances": [one], **closures}), {"i": part})


ROD: Plain = {"closures": [{"name": "rod", "type": "rod", "from": "i.p", "length": 1}]}
SLOPE: Plain = {"constraints": [Linear("slope", "i.x' - i.y'")]}


@pytest.mark.parametrize(("closures", "more"), [({}, {}), (ROD, {}), ({}, SLOPE)], ids=["tree", "closed", "rolling"])
def test_potentials_that_vary(closures: Plain, more: Plain) -> None:
    """The same rest length as part of the load, where dV/dt is balanced, and as an input, where a second run judges."""
    request: Plain = {"q": [0.8, 0.6], "span": (0, 2), **more}
    inside = simulated(two_slides("0.5*cos(3*t)", **closures), **request)
    driven = simulated(two_slides("u", **closures), **request, inputs={"i.u": "0.5*cos(3*t)"})
    assert inside.is_right, inside.checks
    assert driven.is_right, driven.checks
    np.testing.assert_allclose(inside.q, driven.q, atol=1e-8)
    assert any(check.name.startswith("energy") and check.holds for check in inside.checks)
    assert {check.rule for check in driven.checks if check.name in ("q", "qd", "v")} == {"accurate"}
    assert [check.holds for check in driven.checks if check.name == "energy"] == [None]
    loose = {"relative_tolerance": 1e-2, "absolute_tolerance": 1e-2}
    model = two_slides("u", **closures)
    wrong = simulated(model, **request, **loose, inputs={"i.u": "0.5*cos(3*t)"})
    assert wrong.is_right is False
    early = [Event("there", "i.x", 0.81, action="stop")]
    stopped = simulated(model, **request, inputs={"i.u": "0.5*cos(3*t)"}, events=early)
    assert (stopped.status, stopped.is_right) == ("stopped", True)


COSTLY: Plain = {"controls": ["tau.x.q1"], "horizon": 2, "intervals": 2, "q": [1.2, 0], "cost": Cost("x.q1^2")}


def gradient(steps: int) -> Any:
    return cost_gradient(shipped("acrobot"), **control_arguments(**COSTLY, steps=steps, vary=["x.m1", "x.m2"]))


def test_cost_gradients_state_their_error() -> None:
    """One step of a second: a cost of 284 for 10.5; steps small enough: right, with the error that it has."""
    exact = gradient(160)
    coarse, fine = gradient(1), gradient(40)
    assert exact.is_right
    assert coarse.is_right is False
    assert "'steps'" in coarse.message
    assert coarse.cost > 20 * exact.cost
    assert fine.is_right
    assert not fine.message
    stated = {check.name: check.relative for check in fine.checks}
    assert stated["cost"] == pytest.approx(abs(fine.cost / exact.cost - 1), rel=0.2)
    off = np.abs(fine.controls - exact.controls).max() / np.abs(exact.controls).max()
    assert stated["gradient by controls"] == pytest.approx(off, rel=0.2)
    start = np.abs(fine.qd - exact.qd).max() / np.abs(exact.qd).max()
    assert stated["gradient by qd"] == pytest.approx(start, rel=0.2)
    strict = cost_gradient(shipped("acrobot"), **control_arguments(**COSTLY, steps=40, error_limit=1e-9))
    assert strict.is_right is False


def test_costs_that_leave_the_range_of_numbers_are_not_judged() -> None:
    found = cost_gradient(shipped("acrobot"), **control_arguments(**COSTLY | {"horizon": 20, "intervals": 20}))
    assert (found.status, found.is_right, found.trajectory.is_right) == ("failed", None, None)


def test_optimal_controls_are_judged_along_accurate_motions() -> None:
    """A pendulum raised a little: two steps for a second are too few, what the search calls an optimum is none."""
    model = shipped("simple-pendulum")
    problem: Plain = {"controls": ["tau.x.q1"], "cost": Cost("tau.x.q1^2"), "horizon": 2, "intervals": 4, "q": [0]}
    problem |= {"end": End([0.5], [0])}
    coarse, fine = (
        optimal_control(model, **control_arguments(**problem)),
        optimal_control(model, **control_arguments(**problem, steps=8)),
    )
    assert (coarse.status, coarse.is_right) == ("failed", False)
    assert "'steps'" in coarse.message
    assert (fine.status, fine.is_right) == ("optimal", True), fine.checks
    assert {check.name for check in fine.checks} == {"end", "stationarity", "cost", "q", "qd"}
    # the controls of the coarse search miss the end by what its check states
    motion = simulate(model, [0], (0, 2), inputs={"tau.x.q1": held(coarse)}, outputs=Outputs(count=5))
    missed = abs(float(motion.q[-1, 0]) - 0.5) / np.abs(motion.q).max()
    stated = next(check.relative for check in coarse.checks if check.name == "q")
    assert 0.5 * missed < stated < 5 * missed


def held(found: Any) -> Any:
    """The controls between their nodes, linear, as a table."""
    return Table(np.linspace(0, 2, 5).tolist(), found.controls[:, 0].tolist(), "linear")


def measured(noise: float = 0.0, friction: float = 0.0, moving: float = 1.0) -> tuple[Any, Plain]:
    """Base parameters of a planar arm, and a motion of it with its forces."""
    name, rng = "planar-2r", np.random.default_rng(11)
    part = shipped_part(name)
    spec = TreeSpec.read({"name": "t", "gravity": [0, -9.81, 0], "instances": [{"name": "x", "substructure": name}]})
    model, base = couple(spec, {"x": part}), base_parameters(regressor(spec, {"x": part}))
    data = {key: rng.uniform(-1, 1, (60, 2)) * moving for key in ("q", "qd", "qdd")}
    tau = np.asarray(evaluate(model, "inverse_dynamics", **data)["inverse_dynamics"])
    tau = tau + friction * np.sign(data["qd"]) + noise * rng.normal(size=tau.shape) * tau.std(axis=0)
    return base, data | {"tau": tau}


@pytest.mark.parametrize(
    ("given", "limit", "expected"),
    [
        ({}, 0.1, True),
        ({"noise": 0.01}, 0.1, True),
        ({"noise": 0.01}, 1e-3, False),
        ({"noise": 1.0}, 0.1, False),
        ({"friction": 30.0}, 0.1, False),
        ({"moving": 0.0}, 0.1, None),
    ],
)
def test_identifications_are_judged(given: Plain, limit: float, expected: bool | None) -> None:
    """By what the parameters do not explain, and what they leave uncertain; not where the motion does not show them."""
    base, data = measured(**given)
    found = identify(base, **data, error_limit=limit)
    assert found.is_right is expected, (found, found.checks)
    assert [check.name for check in found.checks] == ["normal equations", "explained force", "deviations"]


def test_normal_equations_are_those_of_the_weighted_fit(monkeypatch: pytest.MonkeyPatch) -> None:
    """A solver that is a little off: explained to a percent still, and no least squares."""
    base, data = measured(noise=0.01)
    solve = fit._solved
    monkeypatch.setattr(fit, "_solved", lambda *given: solve(*given) * (1 + 1e-5))
    found = identify(base, **data)
    assert {check.name: check.holds for check in found.checks}["normal equations"] is False
    assert found.is_right is False


def test_equilibria_are_judged_by_other_equations() -> None:
    model = shipped("double-pendulum")
    found = equilibria(model)
    assert found.is_right
    assert len(found.checks) == len(found.found) == 4
    wrong = Equilibrium(np.array([0.1, 0.0]), np.zeros((0, 2)), linearise(model, [0.1, 0.0]))
    assert wrong.check().holds is False
    assert replace(found, found=(*found.found, wrong)).is_right is False
    assert equilibria(model_of(oscillator(axis=[0, 0, 1], placement={}), (0, 0, -9.81))).is_right is None


def test_loop_states_are_judged(monkeypatch: pytest.MonkeyPatch) -> None:
    model = four_bar((0, -9.81, 0))
    assert loop_state(model, [0.7, 0.2, 1.2], qd=[1, 0, 0]).is_right
    # hanging at rest, with no accelerations but rounding
    low = equilibria(model).found[0].q
    assert loop_state(model, low).is_right
    apart = loop_state(model, [0.7, 0.2, 1.2], parameters={"x.l1": 50})
    assert (bool(apart.message), apart.is_right) == (True, None)
    monkeypatch.setattr(loops, "least_multipliers", lambda s, qdd: 1.001 * least_multipliers(s, qdd))
    wrong = loop_state(model, [0.7, 0.2, 1.2], qd=[1, 0, 0])
    assert {check.name for check in wrong.checks if not check.holds} == {"equations of motion"}
    assert wrong.is_right is False
