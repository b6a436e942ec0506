"""Ensembles: every member is the motion that is simulated alone, whatever stands beside it, and is judged by itself."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

from substructures import couple, derive, simulate
from substructures.analysis.motion.problems.output_times import OutputGrid
from substructures.analysis.motion.problems.problem import Integrator
from substructures.ensembles import lanes, members
from substructures.ensembles.ensemble import simulate_ensemble
from substructures.ensembles.motion_column import MotionColumn
from substructures.ensembles.sampled import with_samples
from substructures.ensembles.samples import Samples
from substructures.errors import InvalidInput
from substructures.tree.model import Model

ACCURATE = Integrator(relative_tolerance=1e-11, absolute_tolerance=1e-12)


def tree(part: str, *loads: dict[str, Any]) -> Model:
    spec = {"name": "one", "gravity": [0, 0, "-9.81"], "instances": [{"name": "arm", "substructure": part}]}
    return couple({**spec, "loads": list(loads)} if loads else spec, {"arm": derive(part)})


@pytest.fixture(scope="module")
def acrobot() -> Model:
    return tree("acrobot")


@pytest.fixture(scope="module")
def oscillator() -> Model:
    """m x'' + b x' + k x = F"""
    body = {
        "name": "mass",
        "parent": "base",
        "joint": {"type": "prismatic", "coordinate": "x", "stiffness": "k", "damping": "b"},
        "mass": "m",
    }
    parameters = {"m": {"value": 2, "unit": "kg"}, "k": {"value": 8, "unit": "N/m"}, "b": {"value": 0, "unit": "N s/m"}}
    part = {"name": "osc", "parameters": parameters, "bodies": [body]}
    return couple({"name": "one", "instances": [{"name": "o", "substructure": "osc"}]}, {"o": derive(part)})


def starts(count: int, n: int = 2) -> np.ndarray[Any, Any]:
    return np.random.default_rng(3).uniform(-1.5, 1.5, (count, n))


@pytest.mark.parametrize("method", ["DOP853", "RK45"])
def test_members_are_motions(acrobot: Model, method: str) -> None:
    q, masses = starts(5), np.linspace(0.6, 1.4, 5)
    law = "-0.3*arm.q2' - 2*sin(arm.q2) + 0.1*cos(3*t)"
    how = Integrator(method, relative_tolerance=1e-11, absolute_tolerance=1e-12)
    grid = OutputGrid(times=[0, 0.4, 1.1, 2.0])
    given = {"parameters": {"arm.m1": masses}, "inputs": {"tau.arm.q2": law}}
    found = simulate_ensemble(acrobot, q, (0, 2), qd=[0.1, -0.2], grid=grid, integrator=how, **given)
    assert found.q is not None
    assert found.qd is not None
    assert (found.is_right, found.failed, found.q.shape) == (True, 0, (5, 4, 2))
    assert {check["name"] for check in found.checks} == {"energy-balance"}
    for k in range(5):
        alone = simulate(
            acrobot,
            q[k],
            (0, 2),
            qd=[0.1, -0.2],
            parameters={"arm.m1": masses[k]},
            inputs=given["inputs"],
            integrator=ACCURATE,
        )
        np.testing.assert_allclose(found.q[k, -1], alone.q[-1], rtol=0, atol=2e-8)
        np.testing.assert_allclose(found.qd[k, -1], alone.qd[-1], rtol=0, atol=2e-8)


def test_columns_of_oscillators(oscillator: Model) -> None:
    """x = x_0 cos(w t), w^2 = k/m."""
    k = np.array([2.0, 8.0, 18.0])
    columns = {
        "end": MotionColumn(expression="o.x"),
        "power": MotionColumn(expression="o.k*o.x*o.x'", take="largest_absolute"),
        "energy": MotionColumn(quantity="kinetic_energy", take="largest"),
        "spring": MotionColumn(quantity="forces", of="o.x", take="rms"),
    }
    found = simulate_ensemble(oscillator, [[0.3]], (0, 2 * np.pi), parameters={"o.k": k}, columns=columns)
    w = np.sqrt(k / 2)
    assert found.q is None
    assert found.is_right
    np.testing.assert_allclose(found.columns["end"], 0.3 * np.cos(2 * np.pi * w), atol=1e-9)
    np.testing.assert_allclose(found.columns["power"], 0.045 * k * w, rtol=1e-2)
    np.testing.assert_allclose(found.columns["energy"], 0.045 * k, rtol=1e-2)
    # whole periods: the mean of cos^2 over the 101 times, of which the last one is the first again
    np.testing.assert_allclose(found.columns["spring"], 0.3 * k * np.sqrt(51 / 101), rtol=1e-9)
    told = found.statistics["energy"]
    assert told["count"] == 3
    assert told["largest"] == found.columns["energy"].max()
    assert told["quantiles"]["0.5"] == pytest.approx(found.columns["energy"][1], rel=1e-12)


def test_integrals_are_as_exact_as_the_motion(oscillator: Model) -> None:
    k, driven = np.array([2.0, 8.0]), {"tau.o.x": "3*sin(t)"}
    columns = {
        "square": MotionColumn(expression="o.x'^2", take="integral"),
        "end": MotionColumn(expression="o.x"),
        "work": MotionColumn(expression="tau.o.x*o.x'", take="integral"),
    }
    given: dict[str, Any] = {"parameters": {"o.k": k}, "columns": columns, "grid": OutputGrid(count=2)}
    found = simulate_ensemble(oscillator, [[0.3]], (0, 1), **given)
    w = np.sqrt(k / 2)
    assert list(found.columns) == ["square", "end", "work"]
    np.testing.assert_allclose(found.columns["square"], 0.045 * w**2 * (1 - np.sin(2 * w) / (2 * w)), rtol=1e-9)
    assert not found.columns["work"].any()
    # up to the end, whatever the times that results are wanted at
    short = simulate_ensemble(oscillator, [[0.3]], (0, 1), **{**given, "grid": OutputGrid(times=[0.5])}, states=True)
    assert (short.t.tolist(), short.q.shape) == ([0, 0.5], (2, 2, 1))  # type: ignore[union-attr]
    np.testing.assert_allclose(short.columns["square"], found.columns["square"], rtol=1e-9)
    np.testing.assert_allclose(short.columns["end"], 0.3 * np.cos(0.5 * w), rtol=1e-9)
    # what an input does is what the energy grows by
    moved = simulate_ensemble(oscillator, [[0.3]], (0, 1), inputs=driven, states=True, **given)
    assert moved.q is not None
    assert moved.qd is not None
    energy = moved.qd[..., 0] ** 2 + k[:, None] * moved.q[..., 0] ** 2 / 2
    np.testing.assert_allclose(moved.columns["work"], energy[:, 1] - energy[:, 0], rtol=1e-9)


def test_the_last_part_may_be_small(acrobot: Model, monkeypatch: pytest.MonkeyPatch) -> None:
    given: dict[str, Any] = {"inputs": {"tau.arm.q1": "sin(t)"}, "grid": OutputGrid(count=3)}
    whole = simulate_ensemble(acrobot, starts(600), (0, 0.2), **given)
    monkeypatch.setattr("substructures.ensembles.ensemble.STATES", 1)
    parts = simulate_ensemble(acrobot, starts(600), (0, 0.2), **given)
    assert whole.q is not None
    np.testing.assert_array_equal(whole.q, parts.q)


def test_nobody_changes_another_one(acrobot: Model) -> None:
    """To the last bit: other orders, fewer members, more than there are lanes."""
    q = starts(1200)
    order = np.random.default_rng(1).permutation(len(q))
    grid = OutputGrid(count=3)
    whole = simulate_ensemble(acrobot, q, (0, 1), grid=grid)
    mixed = simulate_ensemble(acrobot, q[order], (0, 1), grid=grid)
    few = simulate_ensemble(acrobot, q[700:703], (0, 1), grid=grid)
    for name in ("q", "qd", "violation"):
        np.testing.assert_array_equal(getattr(whole, name)[order], getattr(mixed, name))
        np.testing.assert_array_equal(getattr(whole, name)[700:703], getattr(few, name))


def test_what_fails_is_told_and_the_others_stay(oscillator: Model) -> None:
    wall = {"tau.o.x": "1/(1 - o.x)"}  # pulls towards 1, and there is no end to it
    columns = {
        "end": MotionColumn(expression="o.x"),
        "mass": MotionColumn(expression="o.m"),
        "energy": MotionColumn(quantity="kinetic_energy", take="mean"),
        "moved": MotionColumn(quantity="inverse_dynamics", of="o.x", take="mean"),
    }
    found = simulate_ensemble(oscillator, [[-0.1], [0.9], [0.05]], (0, 3), inputs=wall, columns=columns)
    assert (found.failed, found.failures[0].member, found.is_right) == (1, 1, None)
    assert 0 < found.failures[0].t < 3
    assert "too small" in found.failures[0].message
    for name, column in found.columns.items():
        assert np.isnan(column).tolist() == [False, True, False]
        assert found.statistics[name]["count"] == 2
    few = simulate_ensemble(oscillator, [[1.0]], (0, 3), integrator=Integrator(max_steps=3))
    assert "more than 3 steps" in few.failures[0].message


def test_no_absolute_tolerance_at_rest_is_named(acrobot: Model) -> None:
    """As a motion alone does; the others move."""
    how = Integrator(relative_tolerance=1e-9, absolute_tolerance=0)
    found = simulate_ensemble(acrobot, [[1, 1], [1, 0.5]], (0, 0.1), qd=[[0, 0], [1, 1]], integrator=how)
    assert [failure.member for failure in found.failures] == [0]
    assert "an 'absolute_tolerance' of 0 allows no error of what is 0" in found.failures[0].message


def test_a_wrong_force_is_seen(acrobot: Model, monkeypatch: pytest.MonkeyPatch) -> None:
    right = members.KernelRates.bound

    def wrong(self: Any, t: Any, x: Any, found: Any) -> Any:
        run = right(self, t, x, found)

        def go() -> None:
            run()
            found[:, 2] *= 1.001

        return go

    q = starts(4)
    assert simulate_ensemble(acrobot, q, (0, 1)).is_right
    monkeypatch.setattr(members.KernelRates, "bound", wrong)
    found = simulate_ensemble(acrobot, q, (0, 1))
    assert found.is_right is False
    assert (found.violation > 1).all()
    assert found.checks[0]["violated"] == 4


def test_the_balance_of_what_is_damped(oscillator: Model) -> None:
    found = simulate_ensemble(oscillator, [[1.0]], (0, 2), parameters={"o.b": [0.5, 1.0, 20.0]})
    assert [(check["name"], check["rule"]) for check in found.checks] == [("energy-balance", "constant")]
    assert found.is_right


def test_energy_may_rise_between_the_times(acrobot: Model) -> None:
    """At none of them has the motor power."""
    grid = OutputGrid(times=[0.0, np.pi])
    assert simulate_ensemble(acrobot, [[0.2, 0.1]], (0, 4), inputs={"tau.arm.q2": "sin(t)"}, grid=grid).is_right


@pytest.mark.parametrize("states", [1, 400_000])
def test_progress_ends_it(acrobot: Model, monkeypatch: pytest.MonkeyPatch, states: int) -> None:
    monkeypatch.setattr("substructures.ensembles.ensemble.STATES", states)
    told: list[float] = []

    def report(share: float) -> bool:
        told.append(share)
        return share < 0.5

    found = simulate_ensemble(acrobot, starts(1200), (0, 0.2), integrator=Integrator(progress=report))
    assert found.cancelled
    assert found.is_right is not True
    assert told == sorted(told)


def test_without_a_compiler(acrobot: Model, monkeypatch: pytest.MonkeyPatch) -> None:
    q = starts(3)
    whole = simulate_ensemble(acrobot, q, (0, 0.5))
    monkeypatch.setattr("substructures.compile.target.available", lambda: False)
    lanes.sums.cache_clear()
    found = simulate_ensemble(tree("acrobot"), q, (0, 0.5))
    lanes.sums.cache_clear()
    np.testing.assert_allclose(found.q, whole.q, atol=1e-9)


SAMPLES = {"method": "sobol", "count": 8, "seed": 4, "of": {"arm.q1": {"uniform": [0, 90], "unit": "deg"}}}


def test_samples_stand_in_their_places(acrobot: Model) -> None:
    of = {
        **SAMPLES["of"],
        "arm.q2'": {"values": [1, 2]},
        "arm.m1": {"normal": [1, 0.1]},
        "tau.arm.q2": {"values": [0.5]},
    }
    samples = Samples.model_validate({**SAMPLES, "of": of})
    given = with_samples(acrobot, samples, {"q": [7, 0.25], "qd": None, "parameters": {"arm.m2": 2}, "inputs": {}})
    assert given["q"].shape == (8, 2)
    assert (given["q"][:, 1] == 0.25).all()
    assert 0 <= given["q"][:, 0].min() <= given["q"][:, 0].max() <= np.pi / 2
    assert set(given["qd"][:, 1]) == {1.0, 2.0}
    assert given["parameters"]["arm.m2"] == 2
    assert len(given["parameters"]["arm.m1"]) == len(given["inputs"]["tau.arm.q2"]) == 8


@pytest.mark.parametrize(
    ("samples", "given", "pointer"),
    [
        ({"of": {"arm.q7": {"values": [1]}}}, {}, "/samples/of/arm.q7"),
        ({"of": {"arm.q1": {"values": [1], "unit": "kg"}}}, {}, "/samples/of/arm.q1/unit"),
        ({"of": {"arm.q1": {"values": [1, 2]}}}, {"parameters": {"arm.m1": [1, 2]}}, "/samples"),
        ({"method": "random", "count": 10**8, "of": {"arm.q1": {"uniform": [0, 1]}}}, {}, "/samples/count"),
    ],
)
def test_bad_samples(acrobot: Model, samples: Any, given: Any, pointer: str) -> None:
    with pytest.raises(InvalidInput) as caught:
        with_samples(acrobot, Samples.model_validate(samples), given)
    assert [fault.pointer for fault in caught.value.faults] == [pointer]


@pytest.mark.parametrize(
    ("given", "pointer"),
    [
        ({"q": [[0, 0], [0]]}, "/q"),
        ({"parameters": {"arm.m1": [1, 2, 3]}, "q": [[0, 0], [1, 1]]}, "/parameters/arm.m1"),
        ({"parameters": {"arm.mass": 1}}, "/parameters/arm.mass"),
        ({"inputs": {"tau.arm.q2": "sin(arm.q3)"}}, "/inputs/tau.arm.q2"),
        ({"integrator": Integrator("Radau")}, "/method"),
        ({"columns": {"a": MotionColumn(expression="arm.q3")}}, "/columns/a/expression"),
        ({"columns": {"a": MotionColumn(quantity="metrik")}}, "/columns/a/quantity"),
        ({"columns": {"a": MotionColumn(quantity="forces")}}, "/columns/a/of"),
    ],
)
def test_bad_input(acrobot: Model, given: dict[str, Any], pointer: str) -> None:
    with pytest.raises(InvalidInput) as caught:
        simulate_ensemble(acrobot, **{"q": [0.1, 0.2], "span": (0, 0.1), **given})
    assert caught.value.faults[0].pointer == pointer


def test_loops_are_refused() -> None:
    with pytest.raises(InvalidInput, match="closure"):
        simulate_ensemble(closed(), [[0.0, 0.0]], (0, 1))


def closed() -> Model:
    spec = {
        "name": "loop",
        "instances": [{"name": "arm", "substructure": "planar-2r"}],
        "closures": [{"name": "pin", "type": "point", "from": {"frame": "world"}, "to": {"frame": "arm.tool"}}],
    }
    return couple(spec, {"arm": derive("planar-2r")})
