"""Families of steady motions and their bifurcations, against closed forms and published speeds."""

from __future__ import annotations

from itertools import pairwise
from typing import Any

import numpy as np
import pytest
from closed_trees import at, governor, governor_accelerations, lift
from in_depth import deep
from random_trees import Plain, model_of
from scipy.optimize import brentq

from substructures import InvalidInput, Model
from substructures.analysis.continuation import Continuation
from substructures.analysis.stability.steady_motions import steady_motions
from substructures.analysis.stability.steady_result import SteadyMotions
from substructures.analysis.stability.steady_search import SteadySearch

G, RADIUS, HOOP = 9.81, 0.5, 0.3
CRITICAL = np.sqrt(G / RADIUS)


def revolute(name: str, parent: str = "base", joint: Plain | None = None, **more: Any) -> Plain:
    return {"name": name, "parent": parent, "joint": {"type": "revolute", "coordinate": name, **(joint or {})}, **more}


def bead_on_a_hoop(off: float = 0, damping: float = 0) -> Model:
    """A bead of 2 kg on a hoop that turns about its vertical diameter, or about a line ``off`` beside it [m]; the angle
    is 0 at the bottom.
    """
    hoop = revolute("turn", inertia={"xx": HOOP, "yy": HOOP, "zz": HOOP})
    joint = {"placement": {"position": [off, 0, 0], "rpy": ["pi/2", 0, 0]}, "damping": damping}
    bead = revolute("angle", "turn", joint, mass=2, com=[0, -RADIUS, 0])
    return model_of({"name": "hoop", "bodies": [hoop, bead]}, (0, 0, -G))


def turntable(potential: str) -> Model:
    """A mass of 1 kg on a slide across a table that turns, in a potential V(x): x is at rest where V' = w^2 x."""
    table = revolute("turn", inertia={"xx": 1, "yy": 1, "zz": 2})
    slide = {"type": "prismatic", "coordinate": "x", "placement": {"position": [0, 0, 0]}, "axis": [1, 0, 0]}
    mass = {"name": "mass", "parent": "turn", "joint": slide, "mass": 1}
    units = {"k": "N/m", "a": "N/m^2", "c": "N/m^3", "d": "N/m^5"}
    parameters = {name: {"value": 4 if name == "k" else 1, "unit": unit} for name, unit in units.items()}
    loads = [{"type": "potential", "potential": potential}]
    return model_of({"name": "table", "parameters": parameters, "bodies": [table, mass], "loads": loads}, (0, 0, 0))


def over_rates(model: Model, first: float, last: float, **more: Any) -> SteadyMotions:
    """Of the coordinate ``turn``, at rates that are held."""
    given: Plain = {
        "rates": {},
        "held": "rates",
        "vary": "x.turn",
        "between": (first, last),
        "count": 8,
        "steps": 20,
    } | more
    return steady_motions(model, **given)


def met(found: SteadyMotions) -> list[tuple[str, float]]:
    """Kinds and values of bifurcations."""
    return [(one.kind, one.at.value or 0.0) for one in found.bifurcations]


@pytest.mark.parametrize(("first", "last"), [(0.0, 8.0), (8.0, 0.0)])
def test_a_bead_on_a_hoop(first: float, last: float) -> None:
    """The bottom loses its stability at w^2 = g/R to cos a = g/(w^2 R), by a pitchfork."""
    found = over_rates(bead_on_a_hoop(), first, last)
    assert found.is_right is True
    assert met(found) == [("pitchfork", pytest.approx(CRITICAL, rel=1e-9))]
    branches = {motion.branch for motion in found.found}
    assert branches == {0, 1, 2, 3}
    sides = set()
    for motion in found.found:
        w, a = motion.value or 0.0, motion.q[1]
        np.testing.assert_allclose(motion.rates, [w])
        if abs(np.sin(a)) > 1e-6:
            sides.add(np.sign(a))
            np.testing.assert_allclose(np.cos(a), G / (w**2 * RADIUS), rtol=1e-9)
            assert motion.verdict == "stable"
        else:
            assert motion.verdict == ("stable" if abs(a) < 1 and w < CRITICAL else "unstable")
    assert sides == {-1, 1}
    ends = [motion for motion in found.found if abs((motion.value or 0.0) - 8) < 1e-9]
    assert len(ends) == 4
    assert repr(found).startswith("SteadyMotions(found=")
    assert "bifurcations=['pitchfork at 4.42945']" in repr(found)


def test_over_momenta_at_both_signs() -> None:
    """p = I w at the bottom."""
    found = over_rates(bead_on_a_hoop(), -8, 8, rates=None, momenta={}, held="momenta")
    values = sorted(value for kind, value in met(found) if kind == "pitchfork")
    np.testing.assert_allclose(values, [-HOOP * CRITICAL, HOOP * CRITICAL], rtol=1e-9)
    assert found.is_right is True
    assert found.message == ""


@pytest.mark.parametrize("off", [0.02, 1e-4])
def test_a_hoop_beside_its_axis(off: float) -> None:
    """The pitchfork is unfolded: w^2 (r + R sin a) = g tan a turns back where its derivative vanishes; however narrow
    the gap, no family is left for the other.
    """
    found = over_rates(bead_on_a_hoop(off), 0, 8)

    def square(a: float) -> float:
        return float(G * np.tan(a) / (off + RADIUS * np.sin(a)))

    h = 1e-6
    angle = brentq(lambda a: square(a + h) - square(a - h), -0.8, -2 * off / RADIUS - 0.01, xtol=1e-12)
    folds = [one for one in found.bifurcations if one.kind == "fold" and abs(one.at.q[1]) < 1]
    assert len(folds) == 1
    assert folds[0].at.value == pytest.approx(np.sqrt(square(angle)), rel=1e-9)
    assert folds[0].at.q[1] == pytest.approx(angle, abs=1e-5)
    assert found.is_right is True
    near = [m for m in found.found if abs(m.q[1]) < 1.5]
    for branch in {m.branch for m in near}:
        one = [m for m in near if m.branch == branch]
        assert len({bool(m.q[1] > -off / RADIUS) for m in one if m.value}) == 1
        turning = branch == folds[0].at.branch
        assert {m.verdict for m in one} == ({"stable", "unstable"} if turning else {"stable"})


def test_a_carousel() -> None:
    """A seat of 2 kg on a rod of 0.5 m that hangs 2 m beside the axis: g tan a = w^2 (r + l sin a) has one way outwards
    for every rate, since r > l, and it is stable; nothing turns back or branches there.
    """
    found = over_rates(bead_on_a_hoop(2.0), 0.1, 6)
    assert found.is_right is True
    hanging = sorted((m.value or 0.0, m.q[1]) for m in found.found if np.cos(m.q[1]) > 0)
    assert len(hanging) >= 10
    for w, a in hanging:
        np.testing.assert_allclose(w**2 * (2 + RADIUS * np.sin(a)), G * np.tan(a), rtol=1e-9)
    assert all(b > a for (_, a), (_, b) in pairwise(dict(hanging).items()))
    assert {m.verdict for m in found.found if np.cos(m.q[1]) > 0} == {"stable"}
    assert not [one for one in found.bifurcations if np.cos(one.at.q[1]) > 0]


def test_a_family_that_closes_round_a_full_turn() -> None:
    """cos a = e/(m w^2 R^2) from the bottom over the side to the top and back on the other side, each part once."""
    hoop = revolute("turn", inertia={"xx": HOOP, "yy": HOOP, "zz": HOOP})
    joint = {"placement": {"position": [0, 0, 0], "rpy": ["pi/2", 0, 0]}}
    bead = revolute("angle", "turn", joint, mass=2, com=[0, -RADIUS, 0])
    part: Plain = {"name": "hoop", "bodies": [hoop, bead]}
    part["parameters"] = {"e": {"value": 1, "unit": "N m"}}
    part["loads"] = [{"type": "potential", "potential": "-e*cos(angle)"}]
    found = over_rates(model_of(part, (0, 0, 0)), -3, 3, vary="e", rates={"x.turn": 2.0})
    two = 2 * 2.0**2 * RADIUS**2
    assert met(found) == [(kind, pytest.approx(e, rel=1e-9)) for kind, e in (("pitchfork", two), ("pitchfork", -two))]
    assert {m.branch for m in found.found} == {0, 1, 2, 3}
    (whole,) = ([m for m in found.found if m.branch == k] for k in {m.branch for m in found.found if 1 < m.q[1] < 2})
    angles = np.unwrap([m.q[1] for m in whole])
    assert abs(angles[-1] - angles[0]) > 2 * np.pi - 0.2
    np.testing.assert_allclose(np.cos(angles), [(m.value or 0.0) / two for m in whole], atol=1e-9)


def test_folds_of_a_pitchfork_that_is_subcritical() -> None:
    """(k - w^2) x - c x^3 + d x^5 = 0: a pitchfork at w^2 = k, folds at k - w^2 = c^2/(4 d)."""
    found = over_rates(turntable("k*x^2/2 - c*x^4/4 + d*x^6/6"), 1, 3)
    fold = ("fold", pytest.approx(np.sqrt(4 - 1 / 4), rel=1e-12))
    assert met(found) == [("pitchfork", pytest.approx(2, rel=1e-9)), fold, fold]
    for one in found.bifurcations[1:]:
        assert abs(one.at.q[1]) == pytest.approx(np.sqrt(0.5), rel=1e-6)


@pytest.mark.parametrize(("vary", "between", "value"), [("x.turn", (1.5, 2.7), 2.0), ("k", (3, 5.6), 4.0)])
def test_a_transcritical_bifurcation(vary: str, between: tuple[float, float], value: float) -> None:
    """x = 0 and x = (w^2 - k)/a cross at w^2 = k and exchange their stability."""
    model = turntable("k*x^2/2 + a*x^3/3")
    found = over_rates(model, 0, 0, vary=vary, between=between, rates={"x.turn": 2.0}, starts=[[0, -2.25]])
    assert met(found) == [("transcritical", pytest.approx(value, rel=1e-8))]
    for motion in found.found:
        at_value = motion.value or 0.0
        stiffness = at_value - 4 if vary == "k" else 4 - at_value**2
        x = motion.q[1]
        assert min(abs(x), abs(x + stiffness)) < 1e-8
        assert motion.verdict == ("stable" if (stiffness > 0) == (abs(x) < 1e-8) else "unstable")


def test_two_eigenvalues_at_once() -> None:
    """A shaft with a disk that is free in both directions: not told by second derivatives, but found."""
    slide: Plain = {"type": "prismatic", "placement": {"position": [0, 0, 0]}, "stiffness": 4}
    bodies = [
        revolute("turn", inertia={"xx": 1, "yy": 1, "zz": 1}),
        {"name": "x", "parent": "turn", "joint": slide | {"coordinate": "x", "axis": [1, 0, 0]}},
        {"name": "y", "parent": "x", "joint": slide | {"coordinate": "y", "axis": [0, 1, 0]}, "mass": 1},
    ]
    found = over_rates(model_of({"name": "shaft", "bodies": bodies}, (0, 0, 0)), 1, 3.1, count=0)
    (one,) = [one for one in found.bifurcations if one.kind == "branch-point"]
    assert one.at.value == pytest.approx(2, rel=1e-8)
    assert "more than one eigenvalue" in one.reason


def test_a_shaft_with_internal_damping() -> None:
    """It whirls at its natural frequency above w_0 (1 + d_e/d_i) (D. M. Smith, Proc. R. Soc. A 142, 1933)."""
    k, inner, outer = 4.0, 0.2, 0.1
    slide: Plain = {"type": "prismatic", "placement": {"position": [0, 0, 0]}, "stiffness": k, "damping": outer}
    bodies = [
        {"name": "x", "parent": "base", "joint": slide | {"coordinate": "x", "axis": [1, 0, 0]}},
        {"name": "y", "parent": "x", "joint": slide | {"coordinate": "y", "axis": [0, 1, 0]}, "mass": 1},
        revolute("turn", "y", inertia={"zz": 0.1, "xx": 0.1, "yy": 0.1}),
    ]
    loads = [
        {"type": "joint", "coordinate": "x", "force": "-i*(x' + turn'*y)"},
        {"type": "joint", "coordinate": "y", "force": "-i*(y' - turn'*x)"},
    ]
    parameters = {"i": {"value": "0.2", "unit": "N s/m"}}
    model = model_of({"name": "rotor", "parameters": parameters, "bodies": bodies, "loads": loads}, (0, 0, 0))
    found = over_rates(model, 1, 5.1, count=0)
    (one,) = found.bifurcations
    assert one.kind == "hopf"
    assert one.at.value == pytest.approx(2 * (1 + outer / inner), rel=1e-5)
    assert "at 2 rad/s" in one.reason
    before, after = (
        {m.verdict for m in found.found if m.value < one.at.value},
        {m.verdict for m in found.found if m.value > one.at.value},
    )
    assert (before, after) == ({"asymptotically stable"}, {"unstable"})


def test_the_sleeping_top_awakes() -> None:
    """(C s)^2 = 4 A m g l: two pairs meet at C s/(2 A) (R. Cushman, J.-C. van der Meer, 1990)."""
    across, axial, reach = 0.4, 0.1, 0.25
    bodies = [
        revolute("a", joint={"placement": {"rpy": ["pi/2", 0, 0]}}),
        revolute("b", "a", {"placement": {"rpy": [0, "pi/2", 0]}}),
        revolute("s", "b", {"placement": {"rpy": ["-pi/2", 0, 0]}}),
    ]
    bodies[-1] |= {
        "mass": 2,
        "com": [0, 0, reach],
        "inertia": {"xx": across, "yy": across, "zz": axial, "about": "origin"},
    }
    model = model_of({"name": "top", "bodies": bodies}, (0, 0, -G))
    found = steady_motions(model, rates={}, vary="x.s", between=(20, 40), count=0, steps=20)
    spin = np.sqrt(4 * across * 2 * G * reach) / axial
    assert met(found) == [("hamiltonian-hopf", pytest.approx(spin, rel=1e-8))]
    assert f"meet at {axial * spin / (2 * across):.6g}" in found.bifurcations[0].reason


def test_a_governor_with_rods() -> None:
    """Its speed at each angle, and where this is extreme, by the equation of motion in closed form."""
    model, angle = governor(), 0.6

    def speed(a: float) -> float:
        low, high = governor_accelerations(a, 0, 0)[0], governor_accelerations(a, 0, 1)[0]
        return float(np.sqrt(-low / (high - low)))

    start = at(model, right=angle, left=angle, lift=lift(angle)[0])
    found = over_rates(model, speed(angle), 8, starts=start, count=0)
    motions = [m for m in found.found if m.branch == 0]
    assert found.is_right is True
    assert len(motions) > 10
    for one, two in pairwise(motions):
        np.testing.assert_allclose(two.q[1], two.q[2], atol=1e-9)
        np.testing.assert_allclose(two.value, speed(two.q[1]), rtol=1e-8)
        assert abs(two.q[1] - one.q[1]) < 0.2
    start = at(model, right=-0.27, left=-0.27, lift=lift(-0.27)[0])
    found = over_rates(model, 9, 8.5, starts=start, count=0)
    h = 1e-5
    extreme = brentq(lambda a: speed(a + h) - speed(a - h), -0.5, -0.2, xtol=1e-12)
    (fold,) = [one for one in found.bifurcations if one.kind == "fold"]
    assert fold.at.value == pytest.approx(speed(extreme), rel=1e-9)


def test_over_a_length_in_closures() -> None:
    """The rods of a governor: each motion is that which a search at this length finds."""
    model = governor()
    start = at(model, right=0.6, left=0.6, lift=lift(0.6)[0])
    given: Plain = {"rates": {"x.turn": 7.0}, "held": "rates", "count": 0}
    found = steady_motions(model, **given, starts=start, vary="x.ll", between=(0.25, 0.27), steps=4)
    assert found.is_right is True
    motions = [m for m in found.found if m.branch == 0]
    assert motions[-1].value == 0.27
    for motion in motions[1::2]:
        again = steady_motions(model, **given, starts=motion.q, parameters={"x.ll": motion.value})
        np.testing.assert_allclose(min(np.abs(m.q - motion.q).max() for m in again.found), 0, atol=1e-9)


def random_arm(seed: int) -> Model:
    """One to three links on a table that turns, with springs and dampers in some joints."""
    rng = np.random.default_rng(seed)
    bodies = [revolute("turn", inertia={"xx": 1, "yy": 1, "zz": 1})]
    for k in range(rng.integers(1, 4)):
        place, angles, com = np.round(rng.uniform(-1, 1, (3, 3)), 2).tolist()
        joint: Plain = {"placement": {"position": place, "rpy": angles}}
        joint |= {"stiffness": float(round(rng.choice([0, 4]) * rng.random(), 2)), "damping": 0.3 * (seed % 3 == 0)}
        tensor = {"xx": 0.2, "yy": 0.3, "zz": 0.25}
        bodies.append(revolute(f"q{k}", bodies[-1]["name"], joint, mass=1, com=com, inertia=tensor))
    return model_of({"name": "arm", "bodies": bodies}, (0, 0, -G))


@pytest.mark.parametrize("seed", [30, *deep(*range(12))])
def test_verdicts_change_at_bifurcations_alone(seed: int) -> None:
    """Of random arms, along each family; neighbours are near each other, and all of them are steady."""
    held: Any = ("rates", "momenta")[seed % 2]
    found = over_rates(random_arm(seed), 0, 6, held=held, count=4, steps=30)
    assert found.is_right is True
    assert len(found.found) > 30
    for one, two in pairwise(found.found):
        if one.branch != two.branch or "undecided" in (one.verdict, two.verdict):
            continue
        turned = np.abs(np.angle(np.exp(1j * (two.q - one.q))))
        assert turned.max() < 0.1
        if one.verdict != two.verdict:
            low, high = sorted((one.value or 0.0, two.value or 0.0))
            assert [b for b in found.bifurcations if low - 0.2 < (b.at.value or 0.0) < high + 0.2]


def test_points_that_are_no_steady_motions_are_seen(monkeypatch: pytest.MonkeyPatch) -> None:
    """Of a search that stops at the guess along the tangent, what is off is left out, and told."""
    monkeypatch.setattr(Continuation, "_corrected", lambda _, guess, __: guess)
    found = over_rates(bead_on_a_hoop(0.02), 0, 8)
    assert "left out where accelerations up to" in found.message
    monkeypatch.setattr("substructures.analysis.stability.steady_motions.confirmed", lambda some: (tuple(some), ""))
    assert over_rates(bead_on_a_hoop(0.02), 0, 8).is_right is False


def test_a_bifurcation_by_a_wrong_derivative_is_seen(monkeypatch: pytest.MonkeyPatch) -> None:
    """The equations are singular at each, by differences, whatever their derivatives say."""
    right = SteadySearch._slope
    monkeypatch.setattr(SteadySearch, "_slope", lambda self, found: right(self, found) + 0.1)
    found = over_rates(bead_on_a_hoop(), 0, 8)
    assert found.is_right is False
    assert [check.name for check in found.checks if check.holds is False] == ["pitchfork at 4.45197"]


def test_where_nothing_keeps_still() -> None:
    found = over_rates(
        model_of({"name": "top", "bodies": [revolute("turn", inertia={"xx": 1, "yy": 1, "zz": 1})]}), 1, 2
    )
    assert [motion.verdict for motion in found.found] == ["stable"] * len(found.found)
    assert found.found[-1].value == 2
    assert found.bifurcations == ()


def test_faults_have_pointers() -> None:
    cases: list[tuple[Plain, str]] = [
        ({"between": (1, 2)}, "/vary"),
        ({"vary": "x.turn"}, "/between"),
        ({"vary": "x.trun", "between": (1, 2)}, "/vary"),
        ({"vary": "x.angle", "between": (1, 2)}, "/vary"),
        ({"vary": "x.turn", "between": (1, 1)}, "/between"),
        ({"vary": "x.turn", "between": (1, 2, 3)}, "/between"),
        ({"vary": "x.turn", "between": (1, "fast")}, "/between/1"),
        ({"vary": "x.turn", "between": (1, 2), "steps": 0}, "/steps"),
    ]
    for request, pointer in cases:
        with pytest.raises(InvalidInput) as error:
            steady_motions(bead_on_a_hoop(), rates={}, **request)
        assert error.value.faults[0].pointer == pointer, request


def test_where_coordinates_are_singular_a_family_ends() -> None:
    """A top in regular precession that comes upright: precession and spin are about one axis there."""
    bodies = [
        revolute("precession"),
        revolute("tilt", "precession", {"placement": {"rpy": ["pi/2", 0, 0]}}),
        revolute("spin", "tilt", {"placement": {"rpy": ["-pi/2", 0, 0]}}),
    ]
    bodies[-1] |= {"mass": 2, "com": [0, 0, 0.25], "inertia": {"xx": 0.4, "yy": 0.4, "zz": 0.1, "about": "origin"}}
    model = model_of({"name": "top", "bodies": bodies}, (0, 0, -G))
    given: Plain = {"vary": "x.precession", "between": (3, 1.5), "starts": [[0, 1, 0]], "count": 0}
    found = steady_motions(model, rates={"x.spin": 20}, **given)
    assert "these coordinates are singular there" in found.message
    # A p^2 cos t - C (s + p cos t) p + m g l = 0 at t = pi, where it hangs
    p = brentq(lambda p: -0.3 * p**2 - 2 * p + 2 * G * 0.25, 0, 3)
    last = [m for m in found.found if m.branch == 0][-1]
    assert last.value == pytest.approx(p, rel=1e-2)
