"""Steady motions: conical pendulum, tops, free bodies, governors, against closed forms and forward dynamics."""

# ruff: noqa: N806 -- symbols of the notation

from __future__ import annotations

from typing import Any, Literal

import numpy as np
import pytest
from analysis_models import catalogue_model, values_at
from closed_trees import at as state_at
from closed_trees import governor, governor_accelerations, lift, resized, tree_model
from in_depth import deep
from random_trees import Plain, model_of

from substructures import InvalidInput, Model
from substructures.analysis.equations.routh import routh
from substructures.analysis.stability.closed_search import is_met
from substructures.analysis.stability.found_places import still
from substructures.analysis.stability.linearise import linearise
from substructures.analysis.stability.operating_point import is_small
from substructures.analysis.stability.steady_motions import steady_motions
from substructures.analysis.stability.steady_result import SteadyMotion
from substructures.analysis.stability.steady_search import SteadySearch
from substructures.analysis.stability.vibrations import first_order
from substructures.expr.interpret import interpret
from substructures.quantities.numbers.evaluation import evaluate

from .moved_worlds import motions, moved

G, LENGTH, MASS, FRAME = 9.81, 0.5, 2.0, 0.3


def conical_pendulum(damping: float) -> Plain:
    """A mass point on a rod that swings in a frame turning about the vertical; the angle is 0 where it hangs."""
    bodies: list[Plain] = [
        {
            "name": "frame",
            "parent": "base",
            "joint": {"type": "revolute", "coordinate": "turn"},
            "inertia": {"xx": FRAME, "yy": FRAME, "zz": FRAME},
        },
        {
            "name": "rod",
            "parent": "frame",
            "joint": {"type": "revolute", "coordinate": "angle", "theta": "pi/2", "damping": damping},
            "mass": MASS,
            "com": [0, -LENGTH, 0],
        },
    ]
    return {"name": "conical", "bodies": bodies}


def conical(damping: float = 0) -> Model:
    return model_of(conical_pendulum(damping), (0, 0, -G))


def at(found: Any, *place: float) -> SteadyMotion:
    """The steady motion at a place of the coordinates that keep still."""
    still = [found.found[0].coordinates.index(c) for c in found.found[0].coordinates if c not in found.moving]
    return min(found.found, key=lambda each: float(np.abs(each.q[still] - place).max()))


@pytest.mark.parametrize("rate", [3.0, 6.0])
def test_a_conical_pendulum(rate: float) -> None:
    """cos a = g/(w^2 l) above w^2 = g/l; M, K by hand at constant rate, and at constant momentum."""
    fast, m = rate**2 > G / LENGTH, MASS * LENGTH**2
    for held in ("rates", "momenta"):
        found = steady_motions(conical(), rates={"x.turn": rate}, held=held)
        assert found.moving == ("x.turn",)
        assert len(found.found) == (4 if fast else 2)
        for motion in found.found:
            a = motion.q[1]
            inertia, slope = FRAME + m * np.sin(a) ** 2, 2 * m * np.sin(a) * np.cos(a) * rate
            K = MASS * G * LENGTH * np.cos(a) - m * rate**2 * np.cos(2 * a)
            K += slope**2 / inertia if held == "momenta" else 0
            np.testing.assert_allclose([motion.M[0, 0], motion.K[0, 0]], [m, K], rtol=1e-8)
            np.testing.assert_allclose(motion.momenta, inertia * rate, rtol=1e-9)
            assert motion.verdict == ("stable" if K > 0 else "unstable")
        hanging = at(found, 0.0)
        assert hanging.verdict == ("unstable" if fast else "stable")
    if fast:
        a = np.arccos(G / (rate**2 * LENGTH))
        np.testing.assert_allclose(at(found, a).q, [0, a], atol=1e-9)
        reason = at(found, a).stability
        assert reason is not None
        assert reason.reason.startswith("the amended potential")


def test_momenta_lead_to_the_same_motion_as_rates() -> None:
    by_rate = at(steady_motions(conical(), rates={"x.turn": 6.0}), 0.9)
    by_momentum = at(steady_motions(conical(), momenta={"x.turn": float(by_rate.momenta[0])}), 0.9)
    np.testing.assert_allclose(by_momentum.q, by_rate.q, atol=1e-9)
    np.testing.assert_allclose(by_momentum.rates, [6.0])


def test_damping_in_the_hinge() -> None:
    found = steady_motions(conical(0.2), rates={"x.turn": 6.0})
    assert at(found, 0.99).verdict == "asymptotically stable"
    assert at(found, 0.0).verdict == "unstable"


def free_body(inertia: tuple[float, float, float]) -> Model:
    joint = {"type": "free", "coordinate": ["x", "y", "z", "yaw", "pitch", "roll"]}
    body = {"name": "b", "parent": "base", "mass": 2, "joint": joint, "inertia": dict(zip(("xx", "yy", "zz"), inertia))}  # noqa: B905
    return model_of({"name": "b", "bodies": [body]}, (0, 0, 0))


@pytest.mark.parametrize(("z", "verdict"), [(1.0, "stable"), (2.0, "unstable"), (2.5, "stable")])
def test_a_free_body_about_its_principal_axes(z: float, verdict: str) -> None:
    """Stable about the axes of least and of largest inertia; about the middle one w sqrt((B-A)(C-B)/(A C))."""
    others = [i for i in (1.0, 2.0, 2.5) if i != z]
    found = steady_motions(free_body((others[0], others[1], z)), rates={"x.yaw": 3.0}, count=12)
    upright = at(found, 0.0, 0.0)
    np.testing.assert_allclose(upright.q, 0, atol=1e-8)
    assert upright.verdict == verdict
    assert upright.stability is not None
    words = {1.0: "the energy has a strict maximum", 2.0: "positive real part", 2.5: "the amended potential"}[z]
    assert words in upright.stability.reason
    if verdict == "unstable":
        largest = max(mode.eigenvalue.real for mode in upright.modes)
        np.testing.assert_allclose(largest, 3 * np.sqrt((2 - 1) * (2.5 - 2) / 2.5), rtol=1e-7)
    assert "coordinates are singular" in found.message


@pytest.mark.parametrize("size", [1e-14, 1e14])
def test_a_free_body_of_any_size_turns_as_one_of_a_metre(size: float) -> None:
    """The verdict of the energy does not hang on radians beside metres."""
    upright = at(steady_motions(free_body((2 * size, 2.5 * size, size)), rates={"x.yaw": 3.0}, count=12), 0.0, 0.0)
    assert upright.stability is not None
    assert upright.stability.verdict == "stable"
    assert "the energy has a strict maximum" in upright.stability.reason


A, C, REACH = 0.4, 0.1, 0.25
WEIGHT = MASS * G * REACH


def top(*chain: Plain) -> Model:
    """A symmetric top with its fixed point at the origin, A and C about it, on massless joints."""
    about = {"xx": A, "yy": A, "zz": C, "about": "origin"}
    bodies: list[Plain] = []
    for i, joint in enumerate(chain):
        parent = f"b{i - 1}" if i else "base"
        bodies.append({"name": f"b{i}", "parent": parent, "joint": {"type": "revolute", **joint}})
    bodies[-1] |= {"mass": MASS, "com": [0, 0, REACH], "inertia": about}
    return model_of({"name": "top", "bodies": bodies}, (0, 0, -G))


def turned(x: str, coordinate: str) -> Plain:
    """An axis that is turned about the first axis of the frame before."""
    return {"coordinate": coordinate, "placement": {"rpy": [x, 0, 0]}}


def test_regular_precession_of_a_heavy_top() -> None:
    """A p^2 cos t - C (s + p cos t) p + m g l = 0 with precession p and spin s; K against Routh's amended potential."""
    model = top({"coordinate": "precession"}, turned("pi/2", "tilt"), turned("-pi/2", "spin"))
    p, s = 3.0, 20.0
    found = steady_motions(model, rates={"x.precession": p, "x.spin": s}, count=16)
    tilt = np.arccos((C * p * s - WEIGHT) / ((A - C) * p**2))
    motion = min(found.found, key=lambda each: abs(abs(each.q[1]) - tilt))
    np.testing.assert_allclose(abs(motion.q[1]), tilt, rtol=1e-9)
    assert motion.verdict == "stable"
    reduced, h = routh(model), 1e-3
    q = np.zeros((5, 3)) + motion.q
    q[:, 1] += h * np.arange(-2, 3)
    momenta = {f"p.{name}": value for name, value in zip(found.moving, motion.momenta, strict=True)}
    V = interpret(reduced.program, values_at(model, q, 0 * q) | momenta, ["amended_potential"])["amended_potential"]
    np.testing.assert_allclose(
        (-V[0] + 16 * V[1] - 30 * V[2] + 16 * V[3] - V[4]) / (12 * h**2), motion.K[0, 0], rtol=1e-6
    )
    np.testing.assert_allclose(V[0] - 8 * V[1] + 8 * V[3] - V[4], 0, atol=1e-8)


@pytest.mark.parametrize(("share", "verdict"), [(0.9, "unstable"), (1.1, "stable"), (2.0, "stable")])
def test_the_sleeping_top(share: float, verdict: str) -> None:
    """Upright it is stable for (C s)^2 > 4 A m g l: gyroscopic, with a maximum of the amended potential."""
    across = {"coordinate": "b", "placement": {"rpy": [0, "pi/2", 0]}}
    model = top(turned("pi/2", "a"), across, turned("-pi/2", "s"))
    upright = evaluate(model, ["potential_energy"], q=[[0, 0, 0], [0.1, 0, 0], [0, 0.1, 0]])["potential_energy"]
    np.testing.assert_allclose(upright, WEIGHT * np.cos([0, 0.1, 0.1]))
    spin = share * np.sqrt(4 * A * WEIGHT) / C
    found = steady_motions(model, rates={"x.s": spin}, count=0)
    sleeping = at(found, 0.0, 0.0)
    np.testing.assert_allclose(sleeping.q, 0, atol=1e-9)
    assert np.linalg.eigvalsh(sleeping.K).max() < 0
    assert sleeping.verdict == verdict
    assert sleeping.stability is not None
    assert (verdict == "unstable") == ("positive real part" in sleeping.stability.reason)


@pytest.mark.parametrize(("name", "rates"), [("flyball-governor", [4.0]), ("gimbal-gyroscope", [0.4, 30.0])])
def test_nothing_accelerates_in_a_steady_motion(name: str, rates: list[float]) -> None:
    """Against forward dynamics of the whole model, and of a shifted place that is no steady motion."""
    model = catalogue_model(name)
    moving = steady_motions(model, rates={}, count=0).moving
    found = steady_motions(model, rates=dict(zip(moving, rates, strict=True)), count=12)
    assert found.found
    for motion in found.found:
        qd = np.zeros(model.dof)
        qd[[model.coordinates.index(c) for c in moving]] = motion.rates
        still = [a for a, c in enumerate(model.coordinates) if c not in moving]
        shifted = motion.q + 0.1 * np.isin(np.arange(model.dof), still)
        states = {"q": np.array([motion.q, shifted]), "qd": np.array([qd, qd])}
        qdd = evaluate(model, ["forward_dynamics"], **states)["forward_dynamics"]
        assert np.abs(qdd[0]).max() < 1e-7 * (1 + np.abs(motion.rates).max() ** 2)
        assert np.abs(qdd[1]).max() > 1e-3


def folded_arm() -> Model:
    """A base that turns with two links on it, held by springs in bent positions: g_xs and its slope are not zero."""
    hinge: Plain = {"type": "revolute", "stiffness": 30, "rest": 1, "d": 0.4}
    tensor = {"xx": 0.2, "yy": 0.3, "zz": 0.4, "xy": 0.05}
    bodies: list[Plain] = [
        {"name": "a", "parent": "base", "joint": {"type": "revolute", "coordinate": "s"}, "inertia": tensor, "mass": 1},
        {
            "name": "b",
            "parent": "a",
            "joint": hinge | {"coordinate": "x", "theta": 0.7},
            "mass": 2,
            "com": [0.3, 0.1, 0],
        },
        {"name": "c", "parent": "b", "joint": hinge | {"coordinate": "y"}, "mass": 1, "com": [0.2, 0, 0.1]},
    ]
    bodies[1]["inertia"] = bodies[2]["inertia"] = tensor
    return model_of({"name": "arm", "bodies": bodies}, (0, 0, 0))


def test_eigenvalues_are_those_of_the_whole_model() -> None:
    """The state space of all coordinates about the steady motion has these eigenvalues, and zeros for s; D is skew."""
    model = folded_arm()
    found = steady_motions(model, rates={"x.s": 3.0}, count=8)
    assert found.found
    for steady in found.found:
        D = steady.D
        assert np.abs(D[0, 1]) > 0.01
        np.testing.assert_allclose(D, -D.T, atol=1e-9)
        np.testing.assert_allclose(steady.K, steady.K.T, atol=1e-7)
        rates = [steady.rates[0], 0, 0]
        whole = np.linalg.eigvals(linearise(model, steady.q, qd=rates, qdd=[0, 0, 0]).A)
        reduced = np.linalg.eigvals(first_order(steady.M, D, steady.K))
        # the two zeros of s are found to the root of rounding
        for z in reduced:
            assert np.abs(whole - z).min() < 1e-6 * np.abs(reduced).max()


@pytest.mark.parametrize("held", ["momenta", "rates"])
def test_a_governor_with_rods(held: Literal["momenta", "rates"]) -> None:
    """With closures: at its speed at an angle of 0.6, M and K of the arms from the equations in closed form."""
    model, angle, h = governor(), 0.6, 1e-4
    low, high = governor_accelerations(angle, 0, 0)[0], governor_accelerations(angle, 0, 1)[0]
    speed = np.sqrt(-low / (high - low))
    start = state_at(model, right=angle + 0.05, left=angle + 0.05, lift=lift(angle)[0])
    found = steady_motions(model, rates={"x.turn": speed}, held=held, starts=start, count=0)
    steady = min(found.found, key=lambda each: float(np.abs(each.q - start).max()))
    np.testing.assert_allclose(steady.q, state_at(model, right=angle, left=angle, lift=lift(angle)[0]), atol=1e-8)
    assert (len(steady.independent), steady.verdict) == (1, "stable")
    np.testing.assert_allclose(steady.M[0, 0], 2 * 0.3**2 + 0.8 * lift(angle)[1] ** 2, rtol=1e-8)

    def inertia(a: float) -> float:
        """Of the spindle with the balls."""
        return float(0.011 + 2 * (0.03 + 0.3 * np.sin(a)) ** 2)

    def acceleration(a: float) -> float:
        """Of the arms, at constant momentum or speed."""
        spin = speed * inertia(angle) / inertia(a) if held == "momenta" else speed
        return governor_accelerations(a, 0, spin)[0]

    slope = (acceleration(angle + h) - acceleration(angle - h)) / (2 * h)
    np.testing.assert_allclose(steady.K[0, 0] / steady.M[0, 0], -slope, rtol=1e-6)


def test_driven_rates() -> None:
    """A motor's moment takes the cyclic coordinate away; at a given rate the rod on it is steady all the same."""
    model = conical()
    assert steady_motions(model, rates={"x.turn": 2.0}, held="rates", inputs={"tau.x.turn": 1.0}).found
    with pytest.raises(InvalidInput, match="is no cyclic coordinate"):
        steady_motions(model, rates={"x.turn": 2.0}, inputs={"tau.x.turn": 1.0})
    with pytest.raises(InvalidInput, match=r"depends on 'x\.angle' itself"):
        steady_motions(model, rates={"x.angle": 2.0}, held="rates")


def test_faults_have_pointers() -> None:
    model = conical()
    cases: list[tuple[Plain, str]] = [
        ({}, "/rates"),
        ({"rates": {}, "momenta": {}}, "/rates"),
        ({"rates": {"x.angle": 1}}, "/rates/x.angle"),
        ({"momenta": {"x.nothing": 1}}, "/momenta/x.nothing"),
        ({"momenta": {"x.turn": 1}, "held": "rates"}, "/momenta"),
        ({"rates": {"x.turn": "fast"}}, "/rates/x.turn"),
        ({"rates": {"x.turn": 1}, "held": "both"}, "/held"),
        ({"rates": {"x.turn": 1}, "starts": [[1]]}, "/starts"),
    ]
    for request, pointer in cases:
        with pytest.raises(InvalidInput) as error:
            steady_motions(model, **request)
        assert error.value.faults[0].pointer == pointer
    with pytest.raises(InvalidInput, match="coordinate that moves at"):
        steady_motions(catalogue_model("simple-pendulum"), rates={})


def test_what_is_not_steady_is_not_called_right(monkeypatch: pytest.MonkeyPatch) -> None:
    """The accelerations of the others are computed from the formulas of the model, whatever the search says."""
    for model in (conical(), governor()):
        found = steady_motions(model, rates={"x.turn": 6.0}, held="rates", reach=0.1)
        assert found.is_right is True
        assert len(found.checks) == len(found.found) > 0
        assert all(check.worst < 1e-6 for check in found.checks)
    monkeypatch.setattr(SteadySearch, "solve", lambda _, start, moving: start[moving])
    wrong = steady_motions(conical(), rates={"x.turn": 6.0}, count=3)
    assert "3 places were left out where accelerations up to" in wrong.message
    assert all(check.holds for check in wrong.checks)
    monkeypatch.setattr("substructures.analysis.stability.steady_motions.confirmed", lambda some: (tuple(some), ""))
    wrong = steady_motions(conical(), rates={"x.turn": 6.0}, count=3)
    assert len(wrong.found) == 4
    assert wrong.is_right is False
    # w = p / g_ss: m (-g l sin a + w^2 l^2 sin a cos a) = m l^2 a''
    for motion in wrong.found:
        angle, rate = motion.q[1], motion.rates[0]
        expected = -G / LENGTH * np.sin(angle) + rate**2 * np.sin(angle) * np.cos(angle)
        np.testing.assert_allclose(motion.qdd, [expected], rtol=1e-9, atol=1e-12)


@pytest.mark.parametrize("size", [1e-4, *deep(1e3)])
def test_steady_motions_do_not_depend_on_the_unit_of_length(size: float) -> None:
    """A governor with w^2 l / g and k l / (m g) as before stands at the same angles, at 1/10 mm too."""
    model, places = governor(), []
    for x in (1.0, size):
        parameters = resized(model, x, **{"x.k": 500 / x})
        request: Plain = {"rates": {"x.turn": 7 / np.sqrt(x)}, "parameters": parameters, "reach": 0.1 * x}
        found = steady_motions(model, **request, held="rates", count=40)
        assert found.is_right is True
        places.append([(motion.q / [1, 1, 1, x], motion.verdict) for motion in found.found])
    assert len(places[0]) == len(places[1])
    for (one, first), (two, second) in zip(*places, strict=True):
        np.testing.assert_allclose(two, one, atol=1e-6)
        assert first == second


def test_shown_in_two_lines() -> None:
    found = steady_motions(conical(), rates={"x.turn": 6.0})
    assert repr(found) == "SteadyMotions(found=4, moving=['x.turn'])\n2 stable, 2 unstable"
    assert all(repr(each).count("\n") == 1 for each in found.found)


@pytest.mark.parametrize("held", ["momenta", "rates"])
def test_a_place_beside_a_lost_rank_does_not_spoil_the_others(held: Any) -> None:
    """Porter's governor with rods: w^2 = (m + M) g / (m l cos a); upright the closures lose rank."""
    joint: Plain = {"type": "revolute", "coordinate": "turn"}
    inertia = {"xx": 0.005, "yy": 0.005, "zz": 0.01}
    bodies: list[Plain] = [{"name": "spindle", "parent": "base", "joint": joint, "inertia": inertia}]
    for side, y in (("right", -1), ("left", 1)):
        joint = {"type": "revolute", "coordinate": side, "placement": {"position": [0, 0, 0]}, "axis": [0, y, 0]}
        bodies.append({"name": side, "parent": "spindle", "joint": joint, "mass": 1, "com": [0, 0, -0.3]})
    lift = {"type": "prismatic", "coordinate": "lift", "placement": {"position": [0, 0, -0.6]}, "axis": [0, 0, 1]}
    bodies.append({"name": "sleeve", "parent": "spindle", "joint": lift, "mass": 0.8})
    ports = [{"name": f"{side}_pin", "body": side, "position": [0, 0, -0.3]} for side in ("right", "left")]
    rods = [
        {"name": side, "type": "rod", "from": f"g.{side}_pin", "to": "g.sleeve", "length": 0.3}
        for side in ("right", "left")
    ]
    document = {"gravity": [0, 0, -9.81], "instances": [{"name": "g", "substructure": "p"}], "closures": rods}
    model = tree_model(document, {"p": {"name": "p", "bodies": bodies, "ports": ports}})
    rate = float(np.sqrt(1.8 * 9.81 / (0.3 * np.cos(np.pi / 4))))
    found = steady_motions(model, rates={"g.turn": rate}, starts=[[0, 0.7, 0.7, 0.2]], held=held)
    assert found.is_right is True
    assert all(check.worst < 1e-9 for check in found.checks)
    both = next(one for one in found.found if np.allclose(one.q[1:3], np.pi / 4, atol=1e-9))
    assert both.stability is not None
    assert both.stability.verdict == "stable"
    frequency = {"momenta": 10.313244010789258, "rates": 4.808574814308301}[held]
    assert [mode.frequency for mode in both.modes] == [pytest.approx(frequency, rel=1e-9)]


def test_what_is_stiff_elsewhere_excuses_no_acceleration() -> None:
    """A slide that falls freely beside a spring of 1e12 N/m is not at rest."""
    K, M, falling = np.diag([1e12, 0.0]), np.eye(2), np.array([1.0, 9.5])
    assert not is_small(falling, K, M)
    assert still("rest", "", falling, M, K).holds is False
    assert is_small(np.array([1.0, 0.0]), K, M)
    assert not is_met(np.array([0.0, 1.0]), K)


@pytest.mark.parametrize("number", range(3))
def test_in_a_world_that_is_turned_by_decimals(number: int) -> None:
    """The same motions: that gravity is along the axis to 16 digits makes the turn no force; that it is not, does."""
    definition = conical_pendulum(0)
    tree = {"gravity": [0, 0, -G], "instances": [{"name": "x", "substructure": "conical"}], "closures": []}
    model = tree_model(moved(tree, motions(5, 1)[number]), {"conical": definition})
    found, expected = (steady_motions(m, rates={"x.turn": 6.0}) for m in (model, conical()))
    assert found.moving == ("x.turn",)
    np.testing.assert_allclose([m.q[1] for m in found.found], [m.q[1] for m in expected.found], atol=1e-9)
    for motion, other in zip(found.found, expected.found, strict=True):
        np.testing.assert_allclose(motion.K, other.K, rtol=1e-9)
        assert motion.stability.verdict == other.stability.verdict
    leaning = tree | {"gravity": [1e-6, 0, -G]}
    with pytest.raises(InvalidInput, match="no cyclic coordinate"):
        steady_motions(tree_model(leaning, {"conical": definition}), rates={"x.turn": 6.0})


def test_a_door_turns_steadily_however_its_world_is_turned() -> None:
    """Gravity along its axis in decimals: what is left of its torque is rounding."""
    axis = np.array([0.1, 0.2, 0.3])
    joint = {"type": "revolute", "coordinate": "a", "placement": {"position": [0, 0, 0]}, "axis": axis.tolist()}
    body = {"name": "b", "parent": "base", "mass": 1, "com": [0.3, 0.4, 0.5], "joint": joint}
    gravity = -9.81 * axis / np.linalg.norm(axis)
    for size in (1, 0):
        model = model_of({"name": "door", "bodies": [body]}, tuple((size * gravity).tolist()))
        (found,) = steady_motions(model, rates={"x.a": 2.0}).found
        assert (found.moving, found.verdict, found.rates.tolist()) == (("x.a",), "stable", [2.0])
