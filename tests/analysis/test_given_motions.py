"""Motions given as tables and expressions: how they run between their values, and kinks, which are refused."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
from closed_trees import tree_model
from scipy.interpolate import CubicSpline, PchipInterpolator, make_interp_spline

from substructures import InvalidArgument, Model, simulate
from substructures.analysis.closed.constrained import Constrained
from substructures.analysis.closed.loops import loop_state
from substructures.analysis.closed.prescribed import Prescribed
from substructures.analysis.motion.integrators.tableaux import TABLEAUX
from substructures.analysis.motion.problems.signals import Curve, Table
from substructures.analysis.motion.problems.start import Start
from substructures.analysis.simulate import ClosedMotion, Integrator, Outputs
from substructures.compile import target
from substructures.compile.motion import CompiledRun

TIMES = [0.0, 1.0, 2.0, 3.0]
DWELL = [0.0, 1.0, 1.0, 1.0]


@pytest.fixture(scope="module")
def slide() -> Model:
    body = {"name": "b", "parent": "base", "joint": {"type": "prismatic", "coordinate": "x"}, "mass": 1}
    document = {"gravity": [0, 0, 0], "instances": [{"name": "s", "substructure": "slide"}]}
    return tree_model(document, {"slide": {"name": "slide", "bodies": [body]}})


def moved(model: Model, motion: Any, span: tuple[float, float] = (0, 3), x: float = 0) -> np.ndarray:
    found = simulate(model, [x], span, kind=ClosedMotion(prescribed={"s.x": motion}), outputs=Outputs(count=7))
    assert found.is_right, found.message
    return found.q[:, 0]


@pytest.mark.parametrize("how", ["hold", "linear"])
def test_a_table_that_jumps_or_has_corners_is_refused(slide: Model, how: Any) -> None:
    with pytest.raises(InvalidArgument, match=r"kink at t = 1 s: .*jumps from .* infinite force; .*quintic") as caught:
        simulate(slide, [0], (0, 3), kind=ClosedMotion(prescribed={"s.x": Table(TIMES, DWELL, how)}))
    assert [(f.pointer, f.code) for f in caught.value.faults] == [("/prescribed/s.x/interpolation", "kink")]


def test_tables_run_as_they_say(slide: Model) -> None:
    t = np.linspace(0, 3, 7)
    np.testing.assert_allclose(moved(slide, Table(TIMES, DWELL, "cubic")), CubicSpline(TIMES, DWELL)(t), atol=1e-9)
    spline = make_interp_spline(TIMES, DWELL, k=3)(t)  # of four points the degree is three
    np.testing.assert_allclose(moved(slide, Table(TIMES, DWELL)), spline, atol=1e-9)
    np.testing.assert_allclose(moved(slide, Table(TIMES, DWELL, "quintic")), spline, atol=1e-9)


@pytest.mark.parametrize(
    ("how", "values", "span", "expected"),
    [
        ("linear", [0, 1, 2, 3], (0, 3), np.linspace(0, 3, 7)),
        ("linear", DWELL, (0, 1), np.linspace(0, 1, 7)),
        ("linear", DWELL, (1, 3), np.ones(7)),
        ("linear", [0, 1, 3, 4], (1, 2), np.linspace(1, 3, 7)),
        ("hold", [1, 1, 1, 1], (0, 3), np.ones(7)),
        ("hold", [0, 1, 2, 2], (1, 2), np.ones(7)),
    ],
)
def test_within_a_span_without_kinks_they_do_so_too(
    slide: Model, how: Any, values: list[float], span: tuple[float, float], expected: np.ndarray
) -> None:
    """Up to a corner at either end of the span, where the motion goes on as inside."""
    np.testing.assert_allclose(moved(slide, Table(TIMES, values, how), span, expected[0]), expected, atol=1e-9)


@pytest.mark.parametrize(
    ("motion", "time", "jump"),
    [
        ("abs(t-1)", 1, "velocity jumps from -1 to 1 m/s"),
        ("max(0, t-1)", 1, "velocity jumps from 0 to 1 m/s"),
        ("sqrt((t-2)^2)", 2, "velocity jumps from -1 to 1 m/s"),
        ("sign(t-1.5)", 1.5, "it jumps from -1 to 1 m"),
        ("table(t; 0: 0, 1: 1, 2: 1, 4: 1)", 0, "velocity jumps from 0 to 1 m/s"),
        ("1e-9*abs(t-1.5)", 1.5, "velocity jumps from -1e-09 to 1e-09 m/s"),
        ("sqrt(((t-2)/1.25)^2)", 2, "velocity jumps from -0.8 to 0.8 m/s"),
        ("3+abs(sin(t-2))", 2, "velocity jumps from -1 to 1 m/s"),
    ],
)
def test_kinks_of_expressions_are_named(slide: Model, motion: str, time: float, jump: str) -> None:
    with pytest.raises(InvalidArgument, match=f"kink at t = {time:g} s: .*{jump}") as caught:
        simulate(slide, [0], (0, 3), kind=ClosedMotion(prescribed={"s.x": motion}))
    assert caught.value.faults[0].pointer == "/prescribed/s.x"


@pytest.mark.parametrize(
    ("motion", "time"),
    [
        ("1/(t-1.3)", 1.3),
        ("2+1/(t-1.3)^3", 1.3),
        ("tan(t)", 1.5708),
        ("exp(1/(t-1.3))", 1.3),
        ("sqrt(2-t)", 2.0),
        ("log(t)", 0.0),
        ("1/(t-3)", 3.0),
    ],
)
def test_a_motion_that_is_not_finite_is_named_with_its_time(slide: Model, motion: str, time: float) -> None:
    with pytest.raises(InvalidArgument, match=r"no finite value at t = ([\d.]+) s: leave it out of the span") as caught:
        simulate(slide, [0], (0, 3), kind=ClosedMotion(prescribed={"s.x": motion}), integrator=Integrator(max_steps=50))
    (fault,) = caught.value.faults
    assert fault.pointer == "/prescribed/s.x"
    assert float(fault.message.split("t = ")[1].split(" s")[0]) == pytest.approx(time, abs=2e-3)


def test_a_motion_divided_by_what_vanishes_with_it_is_taken(slide: Model) -> None:
    np.testing.assert_allclose(moved(slide, "(t^2-1.69)/(t-1.3)"), np.linspace(0, 3, 7) + 1.3, atol=1e-9)


@pytest.mark.parametrize(
    ("motion", "at"),
    [
        ("max(0, t-1)^2", lambda t: np.maximum(0, t - 1) ** 2),
        ("(t-1)*abs(t-1)", lambda t: (t - 1) * np.abs(t - 1)),
        ("abs((t-1)^2)", lambda t: (t - 1) ** 2),
        ("min(t, 1)^2*(3-2*min(t, 1))", lambda t: np.minimum(t, 1) ** 2 * (3 - 2 * np.minimum(t, 1))),
    ],
)
def test_a_jump_of_the_acceleration_is_no_kink(slide: Model, motion: str, at: Any) -> None:
    t = np.linspace(0, 3, 7)
    np.testing.assert_allclose(moved(slide, motion), at(t), atol=1e-9)


@pytest.mark.skipif(not target.available(), reason="machine code cannot be made, or is not wanted")
def test_tables_and_expressions_are_followed_in_machine_code() -> None:
    """-s'' of a table of five pieces of a parabola, beside an expression, in the order in which they are given."""
    bodies = [
        {"name": n, "parent": p, "joint": {"type": "prismatic", "coordinate": n}, "mass": 1}
        for n, p in (("x", "base"), ("y", "x"), ("z", "y"))
    ]
    document = {"gravity": [0, 0, 0], "instances": [{"name": "s", "substructure": "slide"}]}
    model = tree_model(document, {"slide": {"name": "slide", "bodies": bodies}})
    times = np.linspace(0, 3, 6)
    given = {"s.z": "t^3", "s.x": Table(times, 2 * times**2, "cubic"), "s.y": Table(times, -(times**2), "quintic")}
    state = Constrained(model, Start([0, 0, 0]), (0, 3), given)
    state.move(0.0, np.zeros(3), np.zeros(3))
    rates = state.compiled(state.equations(state.independent_rows()))
    assert rates is not None
    run = CompiledRun(TABLEAUX["DOP853"], rates, (1e-9, 1e-9))
    for t in (0.0, 1.3, 3.0):
        np.testing.assert_allclose(run.rates(t, np.zeros(7))[3:6], [4, -2, 6 * t], atol=1e-9)
    found = simulate(model, [0, 0, 0], (0, 3), kind=ClosedMotion(prescribed=given), outputs=Outputs(count=4))
    assert found.is_right, found.message
    np.testing.assert_allclose(found.q, np.stack([2 * found.t**2, -(found.t**2), found.t**3], axis=1), atol=1e-8)


def test_loop_states_see_kinks_where_they_are(slide: Model) -> None:
    for motion in ("abs(t-1)", Table(TIMES, DWELL, "linear")):
        with pytest.raises(InvalidArgument, match="kink at t = 1 s"):
            loop_state(slide, [0], t=1, prescribed={"s.x": motion})
    found = loop_state(slide, [0], t=0.5, prescribed={"s.x": Table(TIMES, DWELL, "linear")})
    assert (found.consistent.q[0], found.consistent.qd[0]) == (0.5, 1)
    assert loop_state(slide, [0], t=0.25, prescribed={"s.x": "abs(t-1)"}).consistent.qd[0] == -1


def test_smooth_laws_have_rates_where_their_pieces_meet(slide: Model) -> None:
    """At every place of a table, its ends and a start at its first place, too; intervals of any length."""
    x, y = [0.0, 1.0, 2.1, 3.0], [0.0, 1.0, 0.5, 2.0]
    spline = CubicSpline(x, y, bc_type="clamped")
    text = f"table(t; {', '.join(f'{a}: {b}' for a, b in zip(x, y, strict=True))}; smooth)"
    given = Prescribed(slide, {"s.x": text}, (0.0, 3.0))
    for t in (*x, *(a + d for a in x[1:3] for d in (1e-12, -1e-12)), 0.4):
        np.testing.assert_allclose(given.at(t)[0], [spline(t), spline(t, 1), spline(t, 2)], atol=1e-9)
    found = loop_state(slide, [0], t=0, prescribed={"s.x": text})
    assert abs(found.consistent.qd[0]) < 1e-9
    np.testing.assert_allclose(moved(slide, text), spline(np.linspace(0, 3, 7)), atol=1e-7)
    ramp = Prescribed(slide, {"s.x": "step(t, 1, 2)"}, (0.0, 2.0))
    for t, value in ((0.0, 0), (2.0, 1)):
        np.testing.assert_allclose(ramp.at(t)[0], [value, 0, 0], atol=1e-10)
    rising = Prescribed(slide, {"s.x": "table(t; 0: 0, 1: 2, 3: 3; monotone)"}, (0.5, 1.0))
    slopes = PchipInterpolator([0, 1, 3], [0, 2, 3])
    before = [slopes(1), slopes(1, 1), slopes(1 - 1e-9, 2)]  # the acceleration jumps: as within the span
    np.testing.assert_allclose(rising.at(1.0)[0], before, atol=1e-7)


def test_inputs_take_quintic_tables_too() -> None:
    t = np.linspace(0, 2, 9)
    curve = Curve(Table(t.tolist(), np.sin(t).tolist(), "quintic"))
    assert curve.breaks == []
    inside = np.linspace(0, 2, 33)
    np.testing.assert_allclose([curve(x) for x in inside.tolist()], np.sin(inside), atol=1e-5)
    assert Curve(Table(TIMES, DWELL))(0.5) == 0.5
