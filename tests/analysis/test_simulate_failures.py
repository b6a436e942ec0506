"""Simulations that are cancelled, cannot go on or are asked for wrongly: status, advice, pointers."""

from __future__ import annotations

from collections.abc import Callable
from decimal import Decimal
from typing import Any

import numpy as np
import pytest
from analysis_models import catalogue_model, oscillator
from random_trees import Plain, model_of
from simulated import simulated

from substructures import InvalidArgument, InvalidInput, MissingValue
from substructures.analysis.simulate import Event, FixedStep, Integrator, Linear, Outputs, Rolling, Table, simulate
from substructures.analysis.stability.equilibria import equilibria
from substructures.analysis.stability.linearise import linearise


def test_progress_is_told_and_can_cancel() -> None:
    model = catalogue_model("double-pendulum")
    told: list[float] = []
    simulate(model, [1, 0.5], (2, 5), integrator=Integrator(progress=lambda share: told.append(share)))
    assert told[-1] == 1
    assert told == sorted(told)
    motion = simulate(model, [1, 0.5], (0, 50), integrator=Integrator(progress=lambda share: share < 0.1))
    assert motion.status == "stopped"
    assert "cancelled" in motion.message


@pytest.mark.parametrize("method", ["DOP853", "LSODA", "BDF"])
def test_a_motion_that_cannot_go_on_fails_with_advice(method: str) -> None:
    """s'' = 1 + s'^2 goes to infinity at t = pi/2; the motion up to there is kept."""
    definition = oscillator() | {"loads": [{"type": "joint", "coordinate": "s", "force": "1 + s'^2"}]}
    motion = simulate(
        model_of(definition, (0, 0, 0)), [0], (0, 2), integrator=Integrator(method=method), outputs=Outputs(step=0.1)
    )
    assert motion.status == "failed"
    assert "the integrator could not go on" in motion.message
    assert 10 <= len(motion.t) <= 17
    # LSODA keeps its tolerance less strictly
    np.testing.assert_allclose(motion.qd[:15, 0], np.tan(motion.t[:15]), rtol=1e-4)


def test_a_singular_start_fails_with_advice() -> None:
    """The free body has no unique rates of its angles at pitch = 90 degrees."""
    motion = simulate(catalogue_model("free-body"), [0, 0, 0, 0, np.pi / 2, 0], (0, 1))
    assert motion.status == "failed"
    assert "pitch" in motion.message
    assert motion.t.tolist() == [0]
    empty = {"name": "empty", "bodies": [{"name": "b", "parent": "base", "joint": {"type": "revolute"}}]}
    motion = simulate(model_of(empty), [0], (0, 1))
    assert motion.status == "failed"
    assert "no inertia" in motion.message


@pytest.mark.filterwarnings("ignore::RuntimeWarning")  # SciPy divides by what is 0
@pytest.mark.parametrize("method", ["DOP853", "BDF"])
def test_no_absolute_tolerance_at_rest_is_named(method: str) -> None:
    integrator = Integrator(method=method, absolute_tolerance=0)
    motion = simulate(catalogue_model("double-pendulum"), [1, 1], (0, 1), integrator=integrator)
    assert motion.status == "failed"
    assert "an 'absolute_tolerance' of 0 allows no error of what is 0" in motion.message
    moving = simulate(catalogue_model("double-pendulum"), [1, 1], (0, 1), qd=[1, 1], integrator=integrator)
    assert moving.status == "finished"


def test_steps_are_limited() -> None:
    motion = simulate(catalogue_model("double-pendulum"), [1, 1], (0, 100), integrator=Integrator(max_steps=20))
    assert motion.status == "failed"
    assert "max_steps" in motion.message
    assert motion.steps == 20


@pytest.mark.parametrize(
    ("changes", "pointer", "code"),
    [
        ({"q": [1]}, "/q", "wrong-length"),
        ({"q": {"x.q1": 1}}, "/q", "missing"),
        ({"qd": [1, "a"]}, "/qd/1", "number-expected"),
        ({"span": [1, 0]}, "/span", "empty-span"),
        ({"span": [0]}, "/span", "wrong-length"),
        ({"span": [0, "b"]}, "/span/1", "number-expected"),
        ({"step": 0.1, "count": 3}, "/step", "one-grid"),
        ({"step": 0}, "/step", "greater-than"),
        ({"step": 1e-9}, "/step", "too-many-outputs"),
        ({"count": 1}, "/count", "greater-than-equal"),
        ({"count": 2.5}, "/count", "int-type"),
        ({"times": [0, 2]}, "/times", "outside"),
        ({"times": [0.5, 0.5]}, "/times", "not-increasing"),
        ({"times": [[0, 1]]}, "/times/0", "number-expected"),
        ({"times": np.linspace(0, 1, 1_000_001)}, "/times", "too-long"),
        ({"max_step": -1}, "/max_step", "greater-than"),
        ({"max_steps": 0}, "/max_steps", "greater-than-equal"),
        ({"relative_tolerance": 1}, "/relative_tolerance", "less-than-equal"),
        ({"absolute_tolerance": -1}, "/absolute_tolerance", "greater-than-equal"),
        ({"drift_limit": 0}, "/drift_limit", "greater-than"),
        ({"method": "euler"}, "/method", "literal-error"),
        ({"parameters": {"x.mass": 1}}, "/parameters/x.mass", "unknown-parameter"),
        ({"parameters": {"x.m1": "heavy"}}, "/parameters/x.m1", "number-expected"),
        ({"inputs": {"tau.x.q1": 10**400}}, "/inputs/tau.x.q1", "wrong-length"),
        ({"inputs": {"tau.x.q1": Decimal("1e400")}}, "/inputs/tau.x.q1", "number-not-finite"),
        ({"span": [0, 10**400]}, "/span/1", "number-not-finite"),
        ({"inputs": {"tau.x.q9": 1}}, "/inputs/tau.x.q9", "unknown-input"),
        ({"inputs": {"tau.x.q1": "3*x.q7"}}, "/inputs/tau.x.q1", "unknown-name"),
        ({"inputs": {"tau.x.q1": Table([0, 0.5], [0, 1])}}, "/inputs/tau.x.q1/times", "not-covered"),
        ({"events": [Event("e", "x.q1 +")]}, "/events/0/quantity", "bad-expression"),
        ({"series": {"a": "nothing"}}, "/series/a", "unknown-name"),
        ({"series": {"energy": "x.q1"}}, "/series/energy", "reserved-name"),
        ({"fixed_step": FixedStep(0.1), "events": [Event("e", "x.q1")]}, "/events", "not-supported"),
        ({"fixed": ["x.q1"]}, "/fixed", "not-supported"),
        ({"v": np.zeros(2)}, "/v", "not-supported"),
        ({"prescribed": {"x.q1": 1}, "fixed_step": FixedStep(0.1)}, "/fixed_step", "not-supported"),
        ({"prescribed": {"x.q1": 1}, "method": "LSODA"}, "/method", "literal-error"),
        ({"constraints": [Linear("c", "x.q1'")], "prescribed": {"x.q1": 1}}, "/prescribed", "not-supported"),
        ({"constraints": [Linear("c", "x.q1'")], "method": "Euler"}, "/method", "literal-error"),
    ],
)
def test_faults_have_pointers(changes: Plain, pointer: str, code: str) -> None:
    with pytest.raises(InvalidInput) as error:
        simulated(catalogue_model("double-pendulum"), **{"q": [0, 0], "span": [0, 1]} | changes)
    assert (error.value.faults[0].pointer, error.value.faults[0].code) == (pointer, code)


@pytest.mark.parametrize(
    ("make", "pointer", "code"),
    [
        (lambda: Table([0, 1], [0]), "/values", "too-short"),
        (lambda: Table([0, 1, 2], [0, 1]), "/values", "wrong-length"),
        (lambda: Table([0, 0], [0, 1]), "/times", "not-increasing"),
        (lambda: Table([0, "x"], [0, 1]), "/times/1", "number-expected"),
        (lambda: Table([0, 1], [0, 1], "septic"), "/interpolation", "literal-error"),
        (lambda: Event("e", "x.q1", level=np.inf), "/level", "number-not-finite"),
        (lambda: Event("e", "x.q1", level=True), "/level", "number-expected"),
        (lambda: Event("e", "x.q1", direction="up"), "/direction", "literal-error"),
        (lambda: FixedStep(-1), "/step", "greater-than"),
        (lambda: FixedStep(1, "euler"), "/method", "literal-error"),
        (lambda: Rolling("r", "x.a", 1, "cube"), "/shape", "literal-error"),
    ],
)
def test_parts_of_a_call_are_checked_where_they_are_made(make: Callable[[], object], pointer: str, code: str) -> None:
    with pytest.raises(InvalidArgument) as error:
        make()
    assert [(f.pointer, f.code) for f in error.value.faults] == [(pointer, code)]


def test_numbers_of_all_kinds_are_the_same() -> None:
    """Of Python, numpy and exact decimals, where numbers and where expressions may be."""
    model = catalogue_model("double-pendulum")
    kinds: list[Any] = [0.25, np.float64(0.25), Decimal("0.25"), "0.25", "1/4"]
    ends = [
        simulate(
            model,
            [1, 0.5],
            (0, 1),
            inputs={"tau.x.q1": x},
            outputs=Outputs(count=2, series={"same": x}, events=[Event("e", x)]),
        )
        for x in kinds
    ]
    for end in ends:
        np.testing.assert_array_equal(end.series["same"], 0.25)
        np.testing.assert_allclose(end.q, ends[0].q, rtol=1e-9)


def test_nothing_that_moves() -> None:
    """A camera on the wall can neither be simulated nor linearised."""
    model = catalogue_model("camera")
    for call in (lambda m: simulate(m, [], (0, 1)), lambda m: linearise(m, []), equilibria):
        with pytest.raises(InvalidInput, match="nothing that moves"):
            call(model)


def test_a_parameter_without_value_is_missing() -> None:
    definition = oscillator() | {"parameters": {"m": {}}}
    definition["bodies"][0]["mass"] = "m"
    with pytest.raises(MissingValue):
        simulate(model_of(definition), [0], (0, 1))


def pendulum(m: str, length: str) -> Plain:
    """Two point masses on links of the same length."""
    bodies: list[Plain] = []
    for k, row in enumerate(({"theta": "pi/2"}, {"d": length})):
        joint = {"type": "revolute", "coordinate": f"q{k}", **row}
        parent = "base" if k == 0 else "b0"
        bodies.append({"name": f"b{k}", "parent": parent, "joint": joint, "mass": m, "com": [length, 0, 0]})
    return {"name": "two", "parameters": {"m": {"value": 1}, "L": {"value": 1}}, "bodies": bodies}


def test_inertias_beyond_the_range_of_numbers_are_named() -> None:
    """Products of two of them are 0 or infinite: the formulas of the accelerations would be wrong or not numbers."""
    for length in ("1e-84", "1e84"):
        motion = simulate(model_of(pendulum("1", length), (0, 0, 0)), [0.1, 0.7], (0, 1), qd=[0.3, 0.2])
        assert (motion.status, motion.is_right) == ("failed", None)
        assert "1e-100 to 1e100" in motion.message
    free = model_of(pendulum("m", "L"), (0, 0, 0))
    motion = simulate(free, [0.1, 0.7], (0, 1), parameters={"m": 1e200, "L": 1e100})
    assert "overflow" in motion.message
    assert "definite" not in motion.message
    small = simulate(model_of(pendulum("1e-20", "1e-9"), (0, 0, 0)), [0.1, 0.7], (0, 1), qd=[0.3, 0.2])
    large = simulate(model_of(pendulum("1", "1"), (0, 0, 0)), [0.1, 0.7], (0, 1), qd=[0.3, 0.2])
    assert small.is_right
    np.testing.assert_allclose(small.q, large.q, rtol=1e-9)


def test_a_small_rotor_on_a_heavy_cart_is_not_singular() -> None:
    """1e6 kg beside 1e-12 kg m^2: their ratio says nothing, as their units differ."""
    joints: list[Plain] = [{"type": "prismatic", "coordinate": "x"}, {"type": "revolute", "coordinate": "a"}]
    bodies = [
        {"name": "cart", "parent": "base", "joint": joints[0], "mass": 1e6},
        {"name": "rotor", "parent": "cart", "joint": joints[1], "inertia": dict.fromkeys(("xx", "yy", "zz"), 1e-12)},
    ]
    motion = simulate(model_of({"name": "c", "bodies": bodies}, (0, 0, 0)), [0, 0], (0, 1), qd=[1, 2])
    assert motion.is_right
    np.testing.assert_allclose(motion.q[-1], [1, 2])
