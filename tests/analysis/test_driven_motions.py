"""Given motions in analyses: Kapitza, Mathieu, the bead on a hoop, Foucault, Jacobi's integral, prescribed motions."""

# ruff: noqa: N806 -- symbols of the notation

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
from closed_trees import tree_model, tree_parts
from scipy.special import mathieu_a, mathieu_b

from substructures import (
    ClosedMotion,
    Event,
    Geodesic,
    Integrator,
    InvalidDocument,
    InvalidInput,
    Model,
    Table,
    couple,
    equilibria,
    evaluate,
    first_integrals,
    linearise,
    simulate,
    simulate_ensemble,
    steady_motions,
)
from substructures.analysis.closed.constrained import Constrained
from substructures.analysis.closed.loops import loop_state
from substructures.analysis.closed.reduced import reduced_equations
from substructures.analysis.closed.reductions import Projected
from substructures.analysis.equations.curvature import curvature
from substructures.analysis.equations.perturbation import perturbation
from substructures.analysis.equations.routh import routh
from substructures.analysis.motion.integrators.tableaux import TABLEAUX
from substructures.analysis.motion.problems.start import Start
from substructures.analysis.simulate import Outputs
from substructures.compile import target
from substructures.compile.motion import CompiledRun
from substructures.quantities.powers import powers
from substructures.quantities.reactions import reactions

Plain = dict[str, Any]
EXACT = Integrator(relative_tolerance=1e-12, absolute_tolerance=1e-13)
#: along z; then a joint about y with a mass point hanging below
LIFT = {"name": "lift", "bodies": [{"name": "b", "parent": "base", "joint": {"type": "prismatic", "coordinate": "z"}}],
        "ports": [{"name": "top", "body": "b"}]}  # fmt: skip
ROD: Plain = {
    "name": "rod",
    "parameters": {"m": {"value": 2, "unit": "kg"}, "l": {"value": 1, "unit": "m"}},
    "bodies": [
        {"name": "b", "parent": "base", "mass": "m", "com": [0, "l", 0],
         "joint": {"type": "revolute", "coordinate": "q", "placement": {"rpy": ["-pi/2", 0, 0]}}},
    ],
    "ports": [{"name": "tip", "body": "b", "position": [0, "l", 0]}],
}  # fmt: skip
SPIN = {"name": "spin", "bodies": [{"name": "b", "parent": "base", "joint": {"type": "revolute", "coordinate": "a"}}],
        "ports": [{"name": "top", "body": "b"}]}  # fmt: skip
PARAMETERS: Plain = {
    "g": {"value": 9.81, "unit": "m/s^2"},
    "A": {"value": 0.1, "unit": "m"},
    "w": {"value": 2, "unit": "rad/s"},
}


def on(base: Plain, given: Plain, rod: Plain = ROD) -> Model:
    """A rod on a base whose motion is given."""
    instances = [
        {"name": "base", "substructure": base["name"]},
        {"name": "p", "substructure": rod["name"], "at": "base.top"},
    ]
    tree = {"gravity": [0, 0, "-g"], "parameters": PARAMETERS, "instances": instances}
    return tree_model(tree | ({"driven": given} if given else {}), {base["name"]: base, rod["name"]: rod})


@pytest.fixture(scope="module")
def lift() -> Model:
    return on(LIFT, {"base.z": "A*cos(w*t)"})


@pytest.fixture(scope="module")
def hoop() -> Model:
    return on(SPIN, {"base.a": "w*t"})


def monodromy(model: Model, q: float, period: float, parameters: Plain, steps: int = 400) -> Any:
    """S(T) of S' = A(t) S about a position, by Runge and Kutta's method; A at all times from one linearisation."""
    t = np.linspace(0, period, 2 * steps + 1)
    A = linearise(model, np.full((len(t), 1), q), qdd=np.zeros((len(t), 1)), t=t, parameters=parameters).A
    S, h = np.eye(2), period / steps
    for k in range(steps):
        a, b, c = A[2 * k : 2 * k + 3]
        k1 = a @ S
        k2 = b @ (S + h / 2 * k1)
        k3 = b @ (S + h / 2 * k2)
        S = S + h / 6 * (k1 + 2 * k2 + 2 * k3 + c @ (S + h * k3))
    return S


@pytest.mark.parametrize(("share", "is_stable"), [(0.9, False), (0.95, False), (1.1, True), (1.5, True)])
def test_kapitza_stands_upright_where_a2_w2_is_more_than_2_g_l(lift: Model, share: float, is_stable: bool) -> None:
    g, length, a = 9.81, 1.0, 0.02
    w = share * np.sqrt(2 * g * length) / a
    S = monodromy(lift, np.pi, 2 * np.pi / w, {"A": a, "w": w})
    assert np.linalg.det(S) == pytest.approx(1, abs=1e-9)
    assert bool(abs(np.trace(S)) < 2) is is_stable


@pytest.mark.parametrize("q", [0.1, 0.5, 1.0])
def test_mathieu_has_its_characteristic_values(lift: Model, q: float) -> None:
    """y'' + (a - 2 q cos 2t) y = 0 with a = g, 2 q = A w^2, w = 2: multipliers 1 at a_0 and -1 at b_1."""
    for a, trace in ((mathieu_a(0, q), 2), (mathieu_b(1, q), -2)):
        S = monodromy(lift, 0, np.pi, {"A": q / 2, "w": 2, "g": float(a)})
        assert np.trace(S) == pytest.approx(trace, abs=1e-8)


def test_a_bead_leaves_the_bottom_of_a_hoop_at_w2_g_over_r(hoop: Model) -> None:
    for w, angle in ((3.0, None), (3.5, np.arccos(9.81 / 3.5**2)), (6.0, np.arccos(9.81 / 36))):
        found = equilibria(hoop, parameters={"w": w})
        places = {round(float(e.q[0]), 9): e.verdict for e in found.found}
        assert places[round(np.pi, 9)] == "unstable"
        assert found.is_right
        if angle is None:
            assert places == {0.0: "stable", round(np.pi, 9): "unstable"}
        else:
            assert places[0.0] == "unstable"
            assert {q: v for q, v in places.items() if 0 < abs(q) < 3} == dict.fromkeys(
                (round(angle, 9), -round(angle, 9)), "stable"
            )
    critical = linearise(hoop, [0.0], parameters={"w": np.sqrt(9.81)})
    assert abs(critical.K[0, 0]) < 1e-12


def test_jacobis_integral_is_constant_on_a_hoop(hoop: Model) -> None:
    (energy,) = (each for each in first_integrals(hoop).integrals if each.kind == "energy")
    assert energy.rule == "constant"
    assert "Jacobi's T_2 - T_0 + V" in energy.reason
    motion = simulate(hoop, [1.0], (0, 5), qd=[0.5], integrator=EXACT, outputs=Outputs(count=21))
    assert motion.is_right
    q, qd = motion.q[:, 0], motion.qd[:, 0]
    expected = qd**2 - 4 * np.sin(q) ** 2 - 2 * 9.81 * np.cos(q)
    np.testing.assert_allclose(motion.series["energy"], expected, rtol=1e-9)


def test_driven_is_prescribed(lift: Model) -> None:
    law = "A*cos(w*t)"
    plain = on(LIFT, {})
    here = simulate(lift, [0.7], (0, 4), qd=[0.1], integrator=EXACT, outputs=Outputs(count=21))
    kind = ClosedMotion(prescribed={"base.z": law.replace("A", "0.1").replace("w", "2")})
    there = simulate(plain, [0.1, 0.7], (0, 4), qd=[0, 0.1], kind=kind, integrator=EXACT, outputs=Outputs(count=21))
    assert here.is_right
    assert there.is_right
    np.testing.assert_allclose(here.q[:, 0], there.q[:, 1], rtol=0, atol=1e-12)
    np.testing.assert_allclose(here.qd[:, 0], there.qd[:, 1], rtol=0, atol=3e-12)
    work = np.gradient(there.series["work"], there.t)
    assert np.abs(work).max() > 0.1


def ramp(t: float, power: int) -> float:
    """x at a time t of x'' + 4 x = -s'' with s = max(0, t)^power, at rest before."""
    t = max(0.0, t)
    return float(np.cos(2 * t) - 1) / 2 if power == 2 else 0.75 * float(np.sin(2 * t)) - 1.5 * t


@pytest.mark.parametrize(
    ("law", "expected"),
    [
        ("max(t, 0)^3", ramp(2, 3)),
        ("max(0, t - p)^3 - max(0, t - 1)^3", ramp(1.5, 3) - ramp(1, 3)),
        ("max(0, t)*t - max(t - p, 0)^2", ramp(2, 2) - ramp(1.5, 2)),
        ("(abs(t)*t^2 + t^3)/2", ramp(2, 3)),
    ],
)
def test_powers_of_max_drive_without_a_jump_of_the_velocity(law: str, expected: float) -> None:
    slide = {"type": "prismatic", "coordinate": "s"}
    hung = {"type": "prismatic", "coordinate": "x", "stiffness": 4}
    bodies = [
        {"name": "a", "parent": "base", "joint": slide, "mass": 1},
        {"name": "b", "parent": "a", "joint": hung, "mass": 1},
    ]
    instance = {"name": "c", "substructure": "carts"}
    tree = {"gravity": [0, 0, 0], "parameters": {"p": {"value": 0.5}}, "instances": [instance]}
    model = tree_model({**tree, "driven": {"c.s": law}}, {"carts": {"name": "carts", "bodies": bodies}})
    motion = simulate(model, [0], (-1, 2))
    assert motion.is_right
    np.testing.assert_allclose(motion.q[-1], expected, rtol=1e-9)


def test_an_input_drives_as_its_law_does(lift: Model) -> None:
    given = on(LIFT, {"base.z": {"input": True}})
    laws = {"base.z": "A*cos(w*t)", "base.z'": "-A*w*sin(w*t)", "base.z''": "-A*w^2*cos(w*t)"}
    found, expected = (
        simulate(model, [0.7], (0, 4), inputs=inputs, integrator=EXACT, outputs=Outputs(count=11))
        for model, inputs in ((given, laws), (lift, {}))
    )
    assert found.is_right
    np.testing.assert_allclose(found.q, expected.q, rtol=0, atol=1e-10)


@pytest.mark.parametrize("end", [1, 2])
def test_an_input_that_varies_has_its_derivatives(end: int) -> None:
    """Else it would be moved as if it stood still."""
    given = on(LIFT, {"base.z": {"input": True}})
    laws = dict([("base.z", "2*t^2"), ("base.z'", "4*t"), ("base.z''", "4")][:end])
    for run in (simulate, simulate_ensemble):
        with pytest.raises(InvalidInput, match="give its derivative by time") as caught:
            run(given, [0.7], (0, 1), inputs=laws)
        assert [f.pointer for f in caught.value.faults] == ["/inputs/base.z" + "'" * end]


def test_a_pendulum_on_a_turning_table_keeps_its_plane() -> None:
    """Foucault: a mass on springs swings in one plane of the world, and turns by -w on the table."""
    joint = {"type": "prismatic", "stiffness": 5, "placement": {}, "axis": [1, 0, 0], "coordinate": "x"}
    mass: Plain = {
        "name": "mass",
        "bodies": [
            {"name": "a", "parent": "base", "joint": joint},
            {"name": "b", "parent": "a", "mass": 1, "joint": joint | {"axis": [0, 1, 0], "coordinate": "y"}},
        ],
    }
    table = on(SPIN, {"base.a": "w*t"}, mass)
    motion = simulate(table, [1.0, 0.0], (0, 6), qd=[0.0, -2.0], integrator=EXACT, outputs=Outputs(count=61))
    assert motion.is_right
    t, (x, y) = motion.t, motion.q.T
    np.testing.assert_allclose(np.sin(2 * t) * x + np.cos(2 * t) * y, 0, atol=1e-9)
    np.testing.assert_allclose(np.cos(2 * t) * x - np.sin(2 * t) * y, np.cos(np.sqrt(5) * t), atol=1e-9)


@pytest.mark.parametrize("given", ["A*cos(w*t)", {"input": True}])
def test_powers_of_loads_and_drives_add_up(given: Any) -> None:
    instances = [{"name": "base", "substructure": "lift"}, {"name": "p", "substructure": "rod", "at": "base.top"}]
    tree = {"name": "t", "gravity": [0, 0, "-g"], "parameters": PARAMETERS, "instances": instances}
    spec, parts = tree_parts(tree | {"driven": {"base.z": given}}, {"lift": LIFT, "rod": ROD})
    laws = {"base.z": "0.1*cos(2*t)", "base.z'": "-0.2*sin(2*t)", "base.z''": "-0.4*cos(2*t)"}
    outputs = Outputs(count=11, powers=powers(spec, parts), reactions=reactions(spec, parts))
    inputs = {} if isinstance(given, str) else laws
    motion = simulate(couple(spec, parts), [0.7], (0, 2), inputs=inputs, integrator=EXACT, outputs=outputs)
    assert motion.is_right
    assert motion.loads[-1] == "drive base.z"
    assert next(check for check in motion.checks if check.name == "power").holds
    assert np.abs(motion.series["powers"][:, -1]).max() > 1


def test_many_motions_are_those_one_by_one(lift: Model) -> None:
    many = simulate_ensemble(lift, q=[[0.3], [0.6]], span=(0, 2))
    assert many.is_right


def test_what_takes_no_given_motion_says_so_at_the_beginning(lift: Model, hoop: Model) -> None:
    calls = [
        lambda: curvature(lift),
        lambda: routh(lift),
        lambda: steady_motions(hoop),
        lambda: simulate(lift, [0.1], (0, 1), kind=Geodesic()),
    ]
    for call in calls:
        with pytest.raises(InvalidDocument, match=r"the motion of 'base.[za]' is given") as caught:
            call()
        assert [fault.code for fault in caught.value.faults] == ["has-driven"]
    with pytest.raises(InvalidDocument, match="depend on the time: nothing stays at rest") as caught:
        equilibria(lift)
    assert [fault.code for fault in caught.value.faults] == ["not-steady"]


def test_where_the_formulas_vary_no_stability_is_told(lift: Model) -> None:
    at = linearise(lift, [0.0], t=0.4)
    assert abs(float(at.qdd[0])) < 1e-12
    assert at.stability is None


def crank(given: Plain) -> Model:
    """A slider-crank with a spring and a pendulum at the slider, whose crank may be driven, in the plane of x and z."""
    joint = {"type": "revolute", "coordinate": "q", "placement": {}, "axis": [0, 1, 0]}
    bar = {
        "name": "bar",
        "parameters": {"l": {"value": 1, "unit": "m"}},
        "bodies": [
            {
                "name": "b",
                "parent": "base",
                "mass": 1,
                "com": ["l/2", 0, 0],
                "inertia": {"yy": 0.1, "zz": 0.1},
                "joint": joint,
            }
        ],
        "ports": [{"name": "end", "body": "b", "position": ["l", 0, 0]}],
    }
    slide = joint | {
        "type": "prismatic",
        "axis": [1, 0, 0],
        "coordinate": "x",
        "stiffness": 30,
        "rest": 2,
        "damping": 0.5,
    }
    block = {"name": "block", "bodies": [{"name": "b", "parent": "base", "mass": 2, "joint": slide}]}
    instances = [
        {"name": "crank", "substructure": "bar", "parameters": {"l": 0.5}},
        {"name": "rod", "substructure": "bar", "at": "crank.end"},
        {"name": "block", "substructure": "block"},
        {"name": "bob", "substructure": "bar", "at": "block.b"},
    ]
    closures = [{"name": "pin", "type": "pin", "from": "rod.end", "to": "block.b", "axis": [0, 1, 0]}]
    tree = {"gravity": [0, 0, "-g"], "parameters": PARAMETERS, "instances": instances, "closures": closures}
    return tree_model(tree | ({"driven": given} if given else {}), {"bar": bar, "block": block})


def test_driven_closures_move_as_prescribed_ones() -> None:
    """phi(q, t) = 0 and G q'' + G' q' + 2 phi_t' q' + phi_tt = 0."""
    law = "0.4 + 3*t + 0.2*sin(4*t)"
    here, there = crank({"crank.q": law}), crank({})
    start = {"crank.q": 0.4, "rod.q": -0.6, "block.x": 1.4, "bob.q": 0.3}
    free = {name: start[name] for name in here.coordinates}
    outputs = Outputs(count=11)
    found = simulate(here, free, (0, 1.5), kind=ClosedMotion(), integrator=EXACT, outputs=outputs)
    kind = ClosedMotion(prescribed={"crank.q": law})
    expected = simulate(there, start, (0, 1.5), kind=kind, integrator=EXACT, outputs=outputs)
    assert expected.is_right
    assert found.is_right, [c for c in found.checks if not c.holds]
    places = [there.coordinates.index(name) for name in here.coordinates]
    np.testing.assert_allclose(found.q, expected.q[:, places], rtol=0, atol=1e-10)
    np.testing.assert_allclose(found.qd, expected.qd[:, places], rtol=0, atol=1e-9)
    assert np.ptp(found.q[:, here.coordinates.index("bob.q")]) > 0.5
    lambdas = expected.series["multipliers"][:, : found.series["multipliers"].shape[1]]
    scale = np.abs(lambdas).max()
    np.testing.assert_allclose(found.series["qdd"], expected.series["qdd"][:, places], rtol=0, atol=1e-6)
    state = {"q": found.q, "qd": found.qd, "qdd": found.series["qdd"], "t": found.t}
    drives = evaluate(here, ["drive_forces", "closure.drives"], **state)
    reactions_of = np.einsum("kir,ki->kr", drives["closure.drives"], found.series["multipliers"])
    force = drives["drive_forces"] - reactions_of
    np.testing.assert_allclose(force[:, 0], expected.series["actuation"][:, 0], rtol=0, atol=1e-6 * scale)


def test_a_reset_changes_jacobis_energy(hoop: Model) -> None:
    """Moved on and slowed down where it passes an angle; what changes then is told."""
    event = Event("jump", "p.q - 0.5", direction="falling", reset={"p.q": "p.q + 0.3", "p.q'": "0.5*p.q'"})
    motion = simulate(hoop, [1.0], (0, 3), integrator=EXACT, outputs=Outputs(count=31, events=[event]))
    assert motion.is_right, motion.checks
    told, energy = sum(each.energy_change for each in motion.events), motion.series["energy"]
    assert told == pytest.approx(energy[-1] - energy[0], rel=1e-9)


def test_prescribed_and_driven_go_together(lift: Model) -> None:
    kind = ClosedMotion(prescribed={"p.q": "0.3*sin(t)"})
    motion = simulate(lift, [0.0], (0, 2), qd=[0.3], kind=kind, integrator=EXACT, outputs=Outputs(count=11))
    assert motion.is_right
    found = evaluate(lift, ["inverse_dynamics"], q=motion.q, qd=motion.qd, qdd=motion.series["qdd"], t=motion.t)
    np.testing.assert_allclose(motion.series["actuation"], found["inverse_dynamics"], atol=1e-8)


def test_what_takes_no_moving_closures_says_so() -> None:
    model = crank({"crank.q": "0.4 + 3*t"})
    calls = [
        lambda: linearise(model, {"rod.q": -0.6, "block.x": 1.4, "bob.q": 0.3}),
        lambda: equilibria(model),
        lambda: reduced_equations(model, {"rod.q": 0.1}),
        lambda: perturbation(model),
        lambda: evaluate(model, ["forward_dynamics"], q={"rod.q": -0.6, "block.x": 1.4, "bob.q": 0.3}),
    ]
    for call in calls:
        with pytest.raises(InvalidDocument, match=r"the motion of 'crank.q' is given"):
            call()
    assert not [each for each in first_integrals(model).integrals if each.kind == "energy"]
    assert loop_state(model, {"rod.q": -0.6, "block.x": 1.4, "bob.q": 0.3}, t=0.1).is_right


LAW = "0.4 + 3*t + 0.2*sin(4*t)"


@pytest.mark.skipif(not target.available(), reason="machine code cannot be made, or is not wanted")
@pytest.mark.parametrize(
    ("driven", "given"),
    [
        ({"crank.q": LAW}, {}),
        ({}, {"crank.q": LAW}),
        ({}, {"crank.q": Table([0.0, 0.4, 1.0, 1.5, 2.0], [0.4, 1.5, 0.5, 0.9, 2.0])}),
    ],
)
def test_closures_that_move_are_machine_code(driven: Any, given: Any) -> None:
    """x' as in Python, with the power of what moves them."""
    model = crank(driven)
    start = {"crank.q": 0.4, "rod.q": -0.6, "block.x": 1.4, "bob.q": 0.3}
    near = {name: start[name] for name in model.coordinates}
    state = loop_state(model, near, t=0.2, prescribed=given).consistent
    s = Constrained(model, Start(state.q, state.qd), (0, 1), given)
    s.move(0.2, state.q, state.qd)
    reduction = Projected(s, len(s.labels))
    rates = reduction.compiled()
    assert rates is not None
    y = np.concatenate([state.q, state.qd, [0.0]])
    found = CompiledRun(TABLEAUX["RK23"], rates, (1.0, 1.0)).rates(0.2, y)
    np.testing.assert_allclose(found, reduction.rates(0.2, y), rtol=1e-10, atol=1e-10)
    assert abs(found[-1]) > 1
