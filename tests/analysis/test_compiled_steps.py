"""Steps in machine code are SciPy's: times, states, evaluations, states within, and how they fail."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
import scipy
from analysis_models import catalogue_model, shipped
from ball_trees import random_balls, random_position
from catalogue_entries import CHAINS
from closed_trees import at, four_bar
from in_depth import deep
from random_trees import Plain, model_of
from simulated import simulated

from substructures import Definition, Model, TreeSpec, couple, derive
from substructures.analysis.closed.reductions import Projected
from substructures.analysis.motion.conditions import DYNAMICS, read_conditions
from substructures.analysis.motion.integrators.compiled_steps import EXPLICIT, CompiledStepper, compiled_stepper
from substructures.analysis.motion.integrators.fixed_step import compiled_rk4, rk4
from substructures.analysis.motion.integrators.steppers import scipy_stepper, within
from substructures.analysis.motion.integrators.tableaux import TABLEAUX
from substructures.analysis.motion.problems.signals import Interpolation
from substructures.analysis.motion.problems.start import Start
from substructures.analysis.motion.right_hand_side import RightHandSide
from substructures.analysis.simulate import Table
from substructures.compile import target

pytestmark = pytest.mark.skipif(not target.available(), reason="machine code cannot be made, or is not wanted")
#: without a joint
RIGID = {"camera", "flange-tool", "welding-torch"}
DRIVEN = "3*sin(2*t) - 0.2*{qd}"


def function(model: Model, inputs: dict[str, Any], span: tuple[float, float]) -> tuple[RightHandSide, Any]:
    """x' of a model from a start in which it moves fast, and that start."""
    start = Start(q=[1.2, 0.4], qd=[2.0, -1.0], inputs=inputs).with_defaults(model)
    conditions = read_conditions(model, start, span, DYNAMICS)
    f = RightHandSide(model, conditions.values, conditions.zero, conditions)
    return f, np.concatenate([conditions.start, np.zeros(f.size - 2 * f.n)])


@pytest.mark.parametrize("method", EXPLICIT)
@pytest.mark.parametrize("longest", [None, 0.01])
@pytest.mark.parametrize("driven", ["", "formula", "cubic", "quintic"])
def test_the_steps_of_scipy(method: str, longest: float | None, driven: Any) -> None:
    model, span = catalogue_model("acrobot"), (-0.25, 0.75)
    given: Any = DRIVEN.format(qd=f"{model.coordinates[1]}'")
    if driven in ("cubic", "quintic"):
        given = Table([-0.3, 0.0, 0.1, 0.5, 0.8], [0, 1, -1, 0.5, 0], driven)
    f, x = function(model, {model.input_names[0]: given} if driven else {}, span)
    assert f.has_power == bool(driven)
    settings = method, 1e-7, 1e-9, longest
    plain, ours = scipy_stepper(*settings)(f, span[0], x, span[1]), compiled_stepper(*settings)(f, span[0], x, span[1])
    assert isinstance(ours, CompiledStepper)
    steps = 0
    while plain.status == "running":
        assert plain.step() is None
        assert ours.step() is None
        steps += 1
        assert (ours.status, ours.nfev) == (plain.status, plain.nfev)
        np.testing.assert_allclose([ours.t_old, ours.t], [plain.t_old, plain.t], rtol=0, atol=1e-9)
        np.testing.assert_allclose(ours.y, plain.y, rtol=1e-8, atol=1e-8)
        if steps % 10 == 1:
            middle = (plain.t_old + plain.t) / 2
            states = [within(each, scipy_stepper(*settings))(middle) for each in (ours, plain)]
            np.testing.assert_allclose(states[0], states[1], rtol=1e-8, atol=1e-8)
    assert ours.t == span[1]
    assert steps > 10


@pytest.mark.parametrize("method", EXPLICIT)
def test_the_coefficients_of_scipy(method: str) -> None:
    """To the bit; and the first steps that it chooses from states of all sizes."""
    theirs: Any = getattr(scipy.integrate, method)
    ours = TABLEAUX[method]
    for s in range(ours.stages):
        assert ours.a[s][:s] == tuple(theirs.A[s][:s])
    both = (theirs.E5 if hasattr(theirs, "E5") else theirs.E, getattr(theirs, "E3", np.zeros(ours.stages + 1)))
    for found, there in zip((ours.b, ours.c, ours.e, ours.e3), (theirs.B, theirs.C, *both), strict=True):
        assert found == tuple(there)
    f, x = function(catalogue_model("acrobot"), {}, (0.0, 1.0))
    for size in (0.0, 1e-7, 1e-3, 1.0, 30.0):
        for end, longest in ((1.0, None), (1e-9, None), (0.5, 1e-3)):
            made = [of(method, 1e-9, 1e-11, longest)(f, 0.0, size * x, end) for of in (scipy_stepper, compiled_stepper)]
            assert made[1].h_abs == made[0].h_abs
            assert made[1].nfev == made[0].nfev
    with pytest.raises(ValueError, match="finite"):
        compiled_stepper(method, 1e-9, 1e-11)(f, 0.0, x * np.nan, 1.0)


@pytest.mark.parametrize("name", deep(*sorted({*CHAINS} - RIGID)))
def test_shipped_entries(name: str, monkeypatch: pytest.MonkeyPatch) -> None:
    """Motions of the whole catalogue against SciPy's steps, to a hundred times the tolerance of 1e-10."""
    model = shipped(name)
    q = (0.3 + 0.05 * np.arange(model.dof)).tolist()
    request: dict[str, Any] = {"q": q, "span": [0, 0.3], "count": 31}
    ours = simulated(model, **request)
    monkeypatch.setattr(RightHandSide, "compiled", lambda _: None)
    plain = simulated(model, **request)
    assert (ours.status, ours.is_right) == (plain.status, plain.is_right)
    assert abs(ours.steps - plain.steps) <= 2
    for one, two in ((ours.q, plain.q), (ours.qd, plain.qd)):
        np.testing.assert_allclose(one, two, rtol=0, atol=1e-8 * (1 + np.abs(two).max()))


@pytest.mark.parametrize("method", EXPLICIT)
def test_closed_motions(method: str, monkeypatch: pytest.MonkeyPatch) -> None:
    """Steps that land on the closures, against SciPy's."""
    model, tolerances = four_bar((0, -9.81, 0)), {"relative_tolerance": 1e-6, "absolute_tolerance": 1e-8}
    request: Plain = {"q": at(model, crank=0.7, coupler=0.2, rocker=1.2), "qd": at(model, crank=9), "span": [0, 0.3]}
    request |= {"inputs": {"tau.x.crank": "0.1*sin(20*t)"}, "method": method, "fixed": ["x.crank"], "count": 7}
    ours = simulated(model, **request, **tolerances)
    monkeypatch.setattr(Projected, "compiled", lambda _: None)
    plain = simulated(model, **request, **tolerances)
    assert (ours.status, ours.is_right, ours.steps) == (plain.status, plain.is_right, plain.steps)
    for one, two in ((ours.q, plain.q), (ours.qd, plain.qd)):
        np.testing.assert_allclose(one, two, rtol=0, atol=1e-11 * np.abs(two).max())


def test_fixed_steps() -> None:
    """Steps one after the other, and shorter ones from where they begin."""
    model = catalogue_model("acrobot")
    f, x = function(model, {model.input_names[0]: DRIVEN.format(qd=f"{model.coordinates[1]}'")}, (0, 1))
    rates = f.compiled()
    assert rates is not None
    step, ours, plain = compiled_rk4(rates), x, x
    for k in range(20):
        t, h = 0.02 * k, 0.01
        np.testing.assert_allclose(step(f, t, ours, h / 3), rk4(f, t, plain, h / 3), rtol=1e-12, atol=1e-13)
        for part in (0.0, h):
            ours, plain = step(f, t + part, ours, h), rk4(f, t + part, plain, h)
        np.testing.assert_allclose(ours, plain, rtol=1e-12, atol=1e-13)
    assert not np.isfinite(step(f, 0.0, np.full(len(x), 1e200), 1.0)).all()


@pytest.mark.parametrize("how", ["hold", "linear"])
@pytest.mark.parametrize("name", ["acrobot", "four-bar"])
def test_tables_between_breaks(name: str, how: Interpolation, monkeypatch: pytest.MonkeyPatch) -> None:
    """Values that hold and lines, beside an expression, on an open tree and on closures: the steps are SciPy's."""
    times, rng = np.linspace(-0.1, 0.9, 11).tolist(), np.random.default_rng(4)
    tables = [Table(times, rng.normal(0, 0.3, 11).tolist(), how) for _ in range(2)]
    if name == "acrobot":
        model = catalogue_model(name)
        inputs = {model.input_names[0]: tables[0], model.input_names[1]: tables[1]}
        request: Plain = {"q": [1.2, 0.4], "span": [0, 0.85]}
    else:
        model = four_bar((0, -9.81, 0))
        inputs = {"tau.x.crank": tables[0], "tau.x.rocker": "0.1*sin(20*t)"}
        request = {"q": at(model, crank=0.7, coupler=0.2, rocker=1.2), "qd": at(model, crank=9), "span": [0, 0.3]}
        request |= {"fixed": ["x.crank"]}
    request |= {"inputs": inputs, "count": 12, "relative_tolerance": 1e-8, "absolute_tolerance": 1e-9}
    owner = RightHandSide if name == "acrobot" else Projected
    made, compiled = list[bool](), owner.compiled

    def noted(f: Any) -> Any:
        """As ever, and that there is machine code."""
        made.append((found := compiled(f)) is not None)
        return found

    monkeypatch.setattr(owner, "compiled", noted)
    ours = simulated(model, **request)
    assert len(made) > 2
    assert all(made)
    monkeypatch.setattr(owner, "compiled", lambda _: None)
    plain = simulated(model, **request)
    assert (ours.status, ours.is_right, ours.steps) == ("finished", True, plain.steps)
    for one, two in ((ours.q, plain.q), (ours.qd, plain.qd)):
        np.testing.assert_allclose(one, two, rtol=0, atol=1e-9 * np.abs(two).max())


def test_tables_are_taken_piece_by_piece() -> None:
    """The kernel is that of the piece that was entered, up to both of its ends; there is none of any time."""
    model = catalogue_model("acrobot")
    f, x = function(model, {model.input_names[0]: Table([0, 1, 2], [0, 2, -2], "hold")}, (0, 2))
    assert f.compiled() is None
    states = []
    for piece in ((0.0, 1.0), (1.0, 2.0)):
        f.enter(*piece)
        rates = f.compiled()
        assert rates is not None
        step = compiled_rk4(rates)
        states.append(step(f, piece[0], x, 1e-3))
        np.testing.assert_allclose(states[-1], rk4(f, piece[0], x, 1e-3), rtol=1e-12)
    assert np.abs(states[1] - states[0]).max() > 1e-4
    f.leave()
    assert f.compiled() is None
    # a step that was made before goes on with the piece at its time
    for t in (0.3, 1.3):
        np.testing.assert_allclose(step(f, t, x, 1e-3), rk4(f, t, x, 1e-3), rtol=1e-12, atol=1e-15)


def test_what_is_more_than_kernels_is_left_to_scipy() -> None:
    model = catalogue_model("acrobot")
    f, x = function(model, {model.input_names[0]: Table([0, 0.5, 1], [0, 1, 0], "linear")}, (0, 1))
    make = compiled_stepper("DOP853", 1e-8, 1e-8)
    assert f.compiled() is None
    assert not isinstance(make(f, 0.0, x, 1.0), CompiledStepper)
    f.enter(0.0, 0.5)
    assert isinstance(make(f, 0.0, x, 0.5), CompiledStepper)
    assert not isinstance(make(lambda t, y: f(t, y), 0.0, x, 0.5), CompiledStepper)
    assert not isinstance(make(f, 0.5, x, 0.0), CompiledStepper)


def test_a_motion_that_cannot_go_on() -> None:
    """x'' = 6 x^2 with x = (1 - t)^-2 up to the pole, where the steps become too small."""
    definition = {
        "name": "cart",
        "parameters": {"m": {"value": 1, "unit": "kg"}},
        "bodies": [{"name": "b", "parent": "base", "joint": {"type": "prismatic", "coordinate": "x"}, "mass": "m"}],
        "loads": [{"type": "joint", "coordinate": "x", "force": "6*x^2"}],
    }
    spec = TreeSpec.read({"name": "t", "instances": [{"name": "c", "definition": definition}]})
    found = simulated(couple(spec, {"c": derive(Definition.read(definition))}), q=[1], qd=[2], span=[0, 2], count=5)
    assert found.status == "failed"
    assert "could not go on at t = 1 s (Required step size" in found.message
    np.testing.assert_allclose(found.q[1], [4], rtol=1e-7)


def test_cancelled_between_steps() -> None:
    """Many steps are made at a time; who watches is told each one, and has enough when it says so."""
    told: list[float] = []

    def progress(share: float) -> bool:
        """Enough after twenty."""
        told.append(share)
        return len(told) < 20

    found = simulated(catalogue_model("acrobot"), q=[1.2, 0.4], span=[0, 20], progress=progress)
    assert found.cancelled
    assert found.steps == 20
    assert told == sorted(told)
    assert found.t[-1] < 20


@pytest.mark.parametrize("method", EXPLICIT)
def test_ball_joints(method: str, monkeypatch: pytest.MonkeyPatch) -> None:
    """Quaternions, which kernels write as well as rates, against SciPy's steps, with inputs of both kinds."""
    model = model_of(random_balls(3, 2, 8)[0])
    q = random_position(np.random.default_rng(3), model).tolist()
    given = dict(zip(model.coordinates, np.linspace(-1, 1, model.dof).tolist(), strict=True))
    inputs = {model.input_names[0]: "0.3*sin(5*t)", model.input_names[1]: Table([0, 0.2, 0.5], [0, 1, 0])}
    values = {s.name: 0.7 for s in model.program.symbols if s.kind == "parameter"}
    request: Plain = {"q": q, "qd": given, "span": (0, 0.5), "times": [0, 0.3, 0.5], "inputs": inputs}
    request |= {"parameters": values, "method": method, "relative_tolerance": 1e-8, "absolute_tolerance": 1e-8}
    made = list[bool]()
    compiled = RightHandSide.compiled
    monkeypatch.setattr(RightHandSide, "compiled", lambda f: made.append((x := compiled(f)) is not None) or x)
    ours = simulated(model, **request)
    assert made
    assert all(made)
    monkeypatch.setattr(RightHandSide, "compiled", lambda _: None)
    plain = simulated(model, **request)
    assert (ours.status, ours.is_right, ours.steps) == (plain.status, plain.is_right, plain.steps)
    for one, two in ((ours.q, plain.q), (ours.qd, plain.qd), (ours.series["work"], plain.series["work"])):
        np.testing.assert_allclose(one, two, rtol=0, atol=1e-9 * (1 + np.abs(two).max()))
