"""Dry friction that sticks exactly in closed motions: against open trees, and against mechanics of one angle."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
from closed_trees import at, held_bar, tree_model
from in_depth import deep
from random_trees import Plain
from scipy.integrate import solve_ivp
from simulated import simulated

from substructures import InvalidInput, Model, catalogue
from substructures.analysis.closed import dry_friction
from substructures.analysis.closed.constrained import Constrained
from substructures.analysis.closed.dry_friction import ClosedDryMotion
from substructures.analysis.closed.dry_state import DryConstrained
from substructures.analysis.closed.reductions import Projected
from substructures.analysis.closed.sticking_forces import bounded
from substructures.analysis.motion.integrators.tableaux import TABLEAUX
from substructures.analysis.motion.problems.start import Start
from substructures.analysis.motion.trajectory import Trajectory
from substructures.analysis.simulate import FixedStep
from substructures.compile import target
from substructures.compile.motion import CompiledRun

from .closed_motions import METHODS, crank_inertia, piston, right, slope

Laws = dict[str, tuple[str, str]]


def friction(coordinate: str, coulomb: str, static: str) -> Plain:
    law = {"coulomb": coulomb, "static": static, "velocity": "1/1000"}
    return {"name": f"f_{coordinate[2:]}", "type": "friction", "coordinate": coordinate} | law


def slider_crank(laws: Laws, *loads: Plain, gravity: Any = (0, 0, 0)) -> Model:
    """With friction F_c, F_s in these joints."""
    instance = {"name": "x", "substructure": "slider-crank"}
    wrist = {"name": "wrist", "type": "pin", "from": "x.rod_end", "to": "x.pin"}
    document: Plain = {"gravity": list(gravity), "instances": [instance], "closures": [wrist]}
    document["loads"] = [*(friction(f"x.{name}", *law) for name, law in laws.items()), *loads]
    return tree_model(document, {"slider-crank": catalogue.load("slider-crank")})


#: of the joints of the slider-crank
LAWS: Laws = {"crank": ("1/50", "3/100"), "rod": ("1/100", "3/200"), "piston": ("1/2", "3/5")}


def levers(a: Any) -> np.ndarray:
    """d (crank, rod, piston) / da at angles a; the rod turns by db/da - 1 against the crank."""
    r, length = 0.04, 0.14
    db = -r * np.cos(a) / np.sqrt(length**2 - (r * np.sin(a)) ** 2)
    return np.array([np.ones_like(a), db - 1, piston(a)[1]])


def sliding(a: float, w: float, torque: float = 0.0) -> float:
    """a'' of the slider-crank by J a'' + J' a'^2 / 2 = torque - sum of F_c,i |dq_i/da| sign(a')."""
    lost = np.array([0.02, 0.01, 0.5]) @ np.abs(levers(a)) * np.sign(w)
    return float((torque - lost - 0.5 * slope(crank_inertia, np.array(a)) * w**2) / crank_inertia(np.array(a)))


def own_stop(a: float, w: float) -> tuple[float, float]:
    """When and where it stops, piece by piece between the turning points of the piston."""
    t = 0.0
    while True:

        def rest(_: float, y: np.ndarray) -> float:
            return float(y[1])

        def turning(_: float, y: np.ndarray, first: float = a) -> float:
            return float(y[0] - (np.floor(first / np.pi + 1e-9) + 1) * np.pi)

        rest.terminal = turning.terminal = True  # type: ignore[attr-defined]
        motion = solve_ivp(
            lambda _, y: [y[1], sliding(y[0], y[1])],
            (t, t + 100),
            [a, w],
            "DOP853",
            events=[rest, turning],
            rtol=1e-12,
            atol=1e-13,
        )
        t, (a, w) = float(motion.t[-1]), motion.y[:, -1]
        if len(motion.t_events[0]):
            return t, a


@pytest.mark.parametrize("method", ["partitioning", *deep("projection")])
def test_a_slider_crank_comes_to_rest(method: str) -> None:
    """Where and when an own integration of the angle has it stop; all joints stop together and stay, held by forces
    within their limits; the energy of the start is work of friction.
    """
    model = slider_crank(LAWS)
    request: Plain = {"q": at(model, crank=0.3, piston=0.17), "qd": at(model, crank=9), "fixed": ["x.crank"]}
    motion = simulated(model, **request, span=(0, 2), count=201, friction="exact", reduction=method)
    right(motion)
    assert {"friction", "energy", "steps"} <= {check.name for check in motion.checks}
    stop, angle = own_stop(0.3, 9.0)
    assert stop < 1.5
    assert angle > np.pi
    late = motion.t > stop
    np.testing.assert_allclose(motion.q[late, 0], angle, rtol=0, atol=1e-7)
    np.testing.assert_allclose(motion.qd[late], 0, atol=1e-12)
    assert (np.abs(motion.qd[~late, 0]) > 1e-3).all()
    first, last = (motion.series[name][[0, -1]] for name in ("kinetic_energy", "work"))
    np.testing.assert_allclose(-last[1], first[0], rtol=1e-9)
    # no load: none is needed at rest; before, all of it against the way
    np.testing.assert_allclose(motion.series["friction"][late], 0, atol=1e-9)
    moving = motion.series["friction"][~late]
    np.testing.assert_allclose(moving, -np.sign(motion.qd[~late]) * [0.02, 0.01, 0.5], rtol=1e-12)


def weights(a: float) -> float:
    """The largest torque on the crank that static friction holds, sum of F_s,i |dq_i/da|."""
    return float(np.array([0.03, 0.015, 0.6]) @ np.abs(levers(a)))


@pytest.mark.parametrize("method", ["partitioning", *deep("projection")])
def test_a_slider_crank_breaks_away(method: str) -> None:
    """Under a torque that grows: when it is sum of F_s,i |dq_i/da|, not before, and then as it slips."""
    model, a = slider_crank(LAWS), 0.8
    x = float(piston(np.array(a))[0])
    request: Plain = {"q": at(model, crank=a, piston=x), "fixed": ["x.crank"], "inputs": {"tau.x.crank": "t/10"}}
    away = 10 * weights(a)
    times = [0, away / 2, away * (1 - 1e-6), away + 0.02, away + 0.05, away + 0.1]
    motion = simulated(model, **request, span=(0, times[-1]), times=times, friction="exact", reduction=method)
    right(motion)
    assert np.abs(motion.qd[:3]).max() < 1e-13
    # held together: every joint has the same share of what it can, and the power of a virtual motion is none
    force = motion.series["friction"][:3]
    np.testing.assert_allclose(force @ levers(a), -motion.t[:3] / 10, atol=1e-12)
    np.testing.assert_allclose(np.abs(force), np.outer(motion.t[:3] / away, [0.03, 0.015, 0.6]), rtol=1e-8, atol=1e-12)
    own = solve_ivp(
        lambda t, y: [y[1], sliding(y[0], max(y[1], 1e-300), t / 10)],
        (away, times[-1]),
        [a, 0.0],
        "DOP853",
        t_eval=times[3:],
        rtol=1e-12,
        atol=1e-14,
    )
    np.testing.assert_allclose(motion.q[3:, 0], own.y[0], atol=1e-9)
    np.testing.assert_allclose(motion.qd[3:, 0], own.y[1], rtol=1e-7)


def test_it_starts_at_a_dead_centre() -> None:
    """Where the piston has no lever and can hold nothing: crank and rod alone do, and then it brakes, too."""
    model = slider_crank(LAWS)
    request: Plain = {"q": at(model, piston=0.18), "fixed": ["x.crank"], "count": 11, "friction": "exact"}
    assert np.isclose(weights(0), 0.03 + 0.015 * (1 + 0.04 / 0.14))
    still = simulated(model, **request, span=(0, 0.2), inputs={"tau.x.crank": 0.99 * weights(0)})
    right(still)
    assert np.abs(still.qd).max() < 1e-13
    torque = 1.01 * weights(0)
    motion = simulated(model, **request, span=(0, 0.2), inputs={"tau.x.crank": torque})
    right(motion)
    own = solve_ivp(
        lambda _, y: [y[1], sliding(y[0], max(y[1], 1e-300), torque)],
        (0, 0.2),
        [0, 0],
        "DOP853",
        rtol=1e-12,
        atol=1e-14,
    )
    np.testing.assert_allclose(motion.q[-1, 0], own.y[0, -1], atol=1e-8)
    assert motion.qd[-1, 2] < 0
    assert motion.series["friction"][-1, 2] == pytest.approx(0.5)


def slides(count: int, closures: list[Plain], pull: str, gravity: Any = (0, 0, 0)) -> Model:
    """Blocks of 1, 2, ... kg side by side on slides along z, each with friction, pulled by a spring."""
    bodies = [
        {
            "name": f"b{i}",
            "parent": "base",
            "mass": 1 + i,
            "inertia": {"xx": 1, "yy": 1, "zz": 1},
            "joint": {"type": "prismatic", "coordinate": f"z{i}"},
        }
        for i in range(count)
    ]
    loads = [friction(f"x.z{i}", f"{3 + i}", f"{4 + i}") for i in range(count)]
    loads.append({"name": "pull", "type": "joint", "coordinate": "x.z0", "force": pull})
    document = {"gravity": list(gravity), "closures": closures, "loads": loads}
    document["instances"] = [{"name": "x", "substructure": "slides"}]
    return tree_model(document, {"slides": {"name": "slides", "bodies": bodies}})


def blocks(model: Model, span: tuple[float, float], **more: Any) -> Trajectory:
    """Both moving alike at the start."""
    n = model.dof
    return simulated(model, [0.0] * n, span, qd=[0.7] * n, count=41, friction="exact", **more)


@pytest.mark.parametrize("method", ["projection", *deep("partitioning")])
def test_blocks_in_line_are_one_block(method: str) -> None:
    """A weld of two blocks, of whose six rows five are redundant, is a block with the sum of masses and frictions:
    stick and slip under a spring and a force that grows.
    """
    weld = {"name": "weld", "type": "weld", "from": "x.b0", "to": "x.b1"}
    pull = "-80*x.z0 + 12*t"
    two = blocks(slides(2, [weld], pull), (0, 4), reduction=method)
    right(two)
    body = {"name": "b", "parent": "base", "mass": 3, "joint": {"type": "prismatic", "coordinate": "z0"}}
    loads = [friction("x.z0", "7", "9"), {"name": "pull", "type": "joint", "coordinate": "x.z0", "force": pull}]
    document = {"gravity": [0, 0, 0], "instances": [{"name": "x", "substructure": "one"}], "loads": loads}
    one = blocks(tree_model(document, {"one": {"name": "one", "bodies": [body]}}), (0, 4))
    assert one.is_right, one.checks
    sticks = one.qd[:, 0] == 0
    assert 0.2 < sticks.mean() < 0.98
    assert (np.diff(sticks.astype(int)) != 0).sum() >= 3
    for k in range(2):
        np.testing.assert_allclose(two.q[:, k], one.q[:, 0], rtol=0, atol=1e-9)
        np.testing.assert_allclose(two.qd[:, k], one.qd[:, 0], rtol=0, atol=1e-8)
    np.testing.assert_allclose(two.series["friction"].sum(axis=1), one.series["friction"][:, 0], atol=1e-7)


@pytest.mark.skipif(not target.available(), reason="machine code cannot be made, or is not wanted")
@pytest.mark.parametrize("ways", [[1, -1, -1], [0, 0, 0], *deep([0, -1, 1], [1, 0, 0])])
def test_steps_are_machine_code_whoever_sticks(ways: list[int]) -> None:
    """Accelerations and power of a state as in Python, of whatever joints slip; what sticks has no acceleration."""
    model, a = slider_crank(LAWS), 0.8
    q = np.array([a, np.arcsin(-0.04 * np.sin(a) / 0.14) - a, piston(np.array(a))[0]])
    s = DryConstrained(model, Start(q), (0, 1))
    s.signs = np.array(ways)
    rate = 3.0 * all(ways)
    x = np.concatenate((q, rate * levers(a), [0.0]))
    s.move(0.0, *np.split(x[:-1], 2))
    reduction = Projected(s, 2)
    rates = reduction.compiled()
    assert rates is not None
    found = CompiledRun(TABLEAUX["RK23"], rates, (1.0, 1.0)).rates(0.0, x)
    np.testing.assert_allclose(found, reduction.rates(0.0, x), rtol=1e-12, atol=1e-12)
    assert not found[3:6][s.signs == 0].any()
    # by the angle of the crank alone where all slip; else all of them rest
    assert found[3] == pytest.approx(sliding(a, rate) if all(ways) else 0.0, rel=1e-9, abs=1e-12)


def test_friction_of_prescribed_motions() -> None:
    """A crank that is driven to and fro: the drive has the friction of all joints, its own by the smooth law."""
    model = slider_crank(LAWS)
    drive = "1 + 0.5*sin(3*t)"
    request: Plain = {"q": at(model, crank=1, piston=0.15), "prescribed": {"x.crank": drive}, "span": (0, 3)}
    motion = simulated(model, **request, friction="exact", count=61)
    right(motion)
    w, a = motion.qd[:, 0], motion.q[:, 0]
    fast = np.abs(w) > 0.05
    ddw = -4.5 * np.sin(3 * motion.t)
    inertial = crank_inertia(a) * ddw + 0.5 * slope(crank_inertia, a) * w**2
    lost = np.array([0.02, 0.01, 0.5]) @ np.abs(levers(a)) * np.sign(w)
    np.testing.assert_allclose(motion.series["actuation"][fast, 0], (inertial + lost)[fast], atol=1e-7)
    np.testing.assert_allclose(motion.series["friction"][:, 0], -0.02 * np.tanh(w / 1e-3), rtol=1e-12)


def test_a_drive_that_waits() -> None:
    """What it drives has no friction while nothing moves, and the friction of its way behind."""
    model = slider_crank(LAWS)
    drive = "1 + max(t - 1, 0)^3"
    request: Plain = {"q": at(model, crank=1, piston=0.15), "prescribed": {"x.crank": drive}, "span": (0, 2)}
    motion = simulated(model, **request, friction="exact", count=5)
    assert motion.status == "finished", motion.message
    np.testing.assert_allclose(motion.series["friction"][:2], 0, atol=1e-12)
    np.testing.assert_allclose(motion.series["friction"][3:], [[-0.02, 0.01, 0.5]] * 2, rtol=1e-9)


@pytest.mark.deep  # 4 s: several loops at once
def test_loops_beside_each_other_stick_one_by_one() -> None:
    """Two pairs of blocks, each welded: one holds its load, the other does not; forces are those of least shares."""
    welds = [{"name": f"w{i}", "type": "weld", "from": f"x.b{i}", "to": f"x.b{i + 1}"} for i in (0, 2)]
    model = slides(4, welds, "6 + 4*t")
    motion = simulated(
        model, [0.0] * 4, (0, 1), inputs={"tau.x.z2": -10.0, "tau.x.z3": 2.0}, count=11, friction="exact"
    )
    right(motion)
    # 6 + 4 t beyond F_s = 4 + 5 N from t = 3/4 on; then 3 + 4 N of friction on 3 kg
    t = motion.t
    late = t > 0.75
    step = (t - 0.75)[late]
    np.testing.assert_allclose(motion.q[late, 0], (2 / 2 * step**2 + 4 / 6 * step**3) / 3, atol=1e-9)
    assert np.abs(motion.q[:, 2:]).max() < 1e-13
    held = motion.series["friction"]
    np.testing.assert_allclose(held[:, 2:], [[8 * 6 / 13, 8 * 7 / 13]] * len(t), rtol=1e-7)
    np.testing.assert_allclose(held[~late, :2], -np.outer(6 + 4 * t[~late], [4 / 9, 5 / 9]), rtol=1e-7)
    np.testing.assert_allclose(held[late, :2], [[-3, -4]] * late.sum(), rtol=1e-12)


@pytest.mark.deep  # 3 s: a mechanism on a carriage
def test_a_carriage_that_holds_its_mechanism() -> None:
    """Two degrees of freedom, one of which sticks: crank and piston move as on the ground, to and fro."""
    joint: Plain = {"type": "prismatic", "coordinate": "c", "placement": {"position": [0, 0, 0]}, "axis": [1, 0, 0]}
    cart = {"name": "cart", "bodies": [{"name": "cart", "parent": "base", "mass": 3, "joint": joint}]}
    wrist = {"name": "wrist", "type": "pin", "from": "x.rod_end", "to": "x.pin"}
    document: Plain = {"gravity": [0, -9.81, 0], "closures": [wrist]}
    document["instances"] = [
        {"name": "y", "substructure": "cart"},
        {"name": "x", "substructure": "slider-crank", "at": "y.cart"},
    ]
    document["loads"] = [friction("y.c", "50", "60"), *(friction(f"x.{name}", *law) for name, law in LAWS.items())]
    both = tree_model(document, {"cart": cart, "slider-crank": catalogue.load("slider-crank")})
    alone = slider_crank(LAWS, gravity=(0, -9.81, 0))
    request: Plain = {"span": (0, 1.5), "fixed": ["x.crank"], "count": 31, "friction": "exact"}
    found, wanted = (
        simulated(model, at(model, crank=0.3, piston=0.17), qd=at(model, crank=9), **request) for model in (both, alone)
    )
    right(found)
    assert (np.diff(np.sign(wanted.qd[:, 0])) != 0).any()
    np.testing.assert_allclose(found.q[:, 0], 0, atol=1e-9)
    np.testing.assert_allclose(found.q[:, 1:], wanted.q, rtol=0, atol=1e-8)
    np.testing.assert_allclose(found.series["friction"][:, 1:], wanted.series["friction"], atol=1e-6)


def test_a_mechanism_without_masses() -> None:
    """A failure with a message, and the state where it is."""
    nothing = dict.fromkeys(("mc", "Jc", "mr", "Jr", "mp"), 0)
    model = slider_crank(LAWS)
    values = {f"x.{name}": 0.0 for name in nothing}
    motion = simulated(model, at(model, piston=0.18), (0, 1), parameters=values, friction="exact")
    assert motion.status == "failed"
    assert "mass" in motion.message
    assert len(motion.t) == 1


@pytest.mark.parametrize(("rate", "ways"), [(3e-12, (0, 0, 0)), (1e-3, (1, -1, -1)), (-1e-3, (-1, 1, 1))])
def test_who_is_at_rest(rate: float, ways: tuple[int, ...]) -> None:
    """The piston is, by its rate, and with it crank and rod, whose rates are larger; they slip where none is."""
    model, a = slider_crank(LAWS), np.array(0.3)
    q = np.array([0.3, np.arcsin(-0.04 * np.sin(0.3) / 0.14) - 0.3, piston(a)[0]])
    s = DryConstrained(model, Start(q), (0, 1))
    signs, x = ClosedDryMotion(s).decided(0.0, np.concatenate((q, rate * levers(a), [0.0])))
    assert abs(rate * levers(a)[2]) < 2e-12 or all(ways)
    assert tuple(signs.tolist()) == ways
    np.testing.assert_allclose(x[3:6], rate * levers(a) * np.abs(ways), rtol=1e-12, atol=1e-24)


def test_who_breaks_away_when_not_all_can() -> None:
    """Four joints and two degrees of freedom: the conditions of Gauss's principle, |f| <= F_s, and a joint that is not
    held goes the way against which it has all of F_s.
    """
    rng = np.random.default_rng(3)
    for _ in range(20):
        ways, a, most = rng.normal(size=(4, 2)), rng.normal(size=2), rng.uniform(0.1, 1, 4)
        f = bounded(ways, ways @ a, most)
        left = ways @ (ways.T @ f + a)
        # a joint at rest has less than F_s, or what it has is against its way
        held = np.abs(f) < most * (1 - 1e-9)
        np.testing.assert_allclose(left[held], 0, atol=1e-9)
        assert (left[~held] * f[~held] <= 1e-9).all()
        assert (np.abs(f) <= most * (1 + 1e-12)).all()


@pytest.mark.parametrize("fault", ["lost_power", *deep("EDGE")])
def test_faults_are_seen(fault: str, monkeypatch: pytest.MonkeyPatch) -> None:
    """Joints that stick with more than they can, and the work of the smooth law."""
    if fault == "EDGE":
        monkeypatch.setattr(dry_friction, "EDGE", 0.5)
    else:
        monkeypatch.setattr(DryConstrained, "lost_power", Constrained.lost_power)
        monkeypatch.setattr(DryConstrained, "compiled", lambda *_: None)
    model = slider_crank(LAWS)
    x = float(piston(np.array(0.8))[0])
    request: Plain = {"q": at(model, crank=0.8, piston=x), "fixed": ["x.crank"], "inputs": {"tau.x.crank": "t/10"}}
    motion = simulated(model, **request, span=(0, 13 * weights(0.8)), count=11, friction="exact")
    assert not motion.is_right


def test_what_closed_motions_refuse() -> None:
    model = slider_crank(LAWS)
    for more, pointer in (({"friction": "loaded"}, "/friction"), ({"fixed_step": FixedStep(0.1)}, "/fixed_step")):
        with pytest.raises(InvalidInput) as error:
            simulated(model, at(model, piston=0.18), (0, 1), **{"friction": "exact"} | more)
        assert [fault.pointer for fault in error.value.faults] == [pointer]
    with pytest.raises(InvalidInput) as error:
        simulated(slider_crank({}), at(model, piston=0.18), (0, 1), friction="exact")
    assert [fault.pointer for fault in error.value.faults] == ["/friction"]


@pytest.mark.parametrize("method", METHODS)
@pytest.mark.parametrize("torque", [1, *deep(0, 4.9, -4.999)])
def test_a_mechanism_that_is_stuck_stays_where_it_is_and_is_right(torque: float, method: Any) -> None:
    """5 N m hold what is less: no energy is there, and none is the scale of another."""
    model = held_bar()
    inputs = {"tau.f.q1": torque}
    motion = simulated(model, [0.5, 0.09, 1.2], (0, 0.3), count=4, inputs=inputs, friction="exact", reduction=method)
    assert motion.is_right, motion.checks
    np.testing.assert_allclose(motion.q, np.tile(motion.q[0], (4, 1)), atol=1e-14)
    energy = next(check for check in motion.checks if check.name == "energy")
    assert energy.relative < 1e-12
    assert energy.scale > 0.1


def test_many_steps_near_rest_are_told_to_take_exact_friction() -> None:
    """0.5 N m let the crank creep by v_0 atanh(0.5/5) = 1e-4 rad/s in steps of some 20 microseconds."""
    request = {"inputs": {"tau.f.q1": 0.5}, "count": 2}
    motion = simulated(held_bar(), [0.5, 0.09, 1.2], (0, 0.3), max_steps=1200, **request)
    assert motion.qd[-1, 0] == pytest.approx(0.001 * np.arctanh(0.1), rel=1e-3)
    assert "1,200 steps were taken, most of them while 'f.q1' nearly stood still" in motion.message
    assert motion.message.endswith("the method 'Radau' and 'friction': 'exact' need no such steps")
    exact = simulated(held_bar(), [0.5, 0.09, 1.2], (0, 0.3), friction="exact", **request)
    assert (exact.message, exact.is_right) == ("", True)
    assert exact.steps < 20


@pytest.mark.deep  # 3 s: a fast mechanism, and smooth friction that is steep beside it
def test_joints_that_turn_while_others_move_fast() -> None:
    """The rocker turns back within the resolution of times; smooth friction comes to the same as v_0 gets smaller."""
    joints, request = ("q1", "q2", "q3"), {"count": 2, "inputs": {"tau.f.q1": "30*sin(3*t)"}}
    exact = simulated(held_bar(joints), [0.5, 0.09, 1.2], (0, 0.45), friction="exact", **request)
    assert (exact.status, exact.is_right) == ("finished", True)
    ends = [
        simulated(held_bar(joints, v), [0.5, 0.09, 1.2], (0, 0.45), method="Radau", relative_tolerance=1e-8, **request)
        for v in (1e-4, 1e-5)
    ]
    far, near = (float(np.abs(smooth.q[-1] - exact.q[-1]).max()) for smooth in ends)
    assert near < 1e-4
    assert 6 < far / near < 10
