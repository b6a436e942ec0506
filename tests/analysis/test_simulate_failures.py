"""Simulations that are cancelled, cannot go on or are asked for wrongly: status, advice, pointers."""

from __future__ import annotations

from decimal import Decimal

import numpy as np
import pytest
from analysis_models import catalogue_model, oscillator
from random_trees import Plain, model_of

from substructures import InvalidDocument, MissingValue
from substructures.analysis.simulate import simulate
from substructures.analysis.stability.equilibria import equilibria
from substructures.analysis.stability.linearise import linearise
from substructures.errors import InvalidInput


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
    with pytest.raises(InvalidInput) as error:
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
