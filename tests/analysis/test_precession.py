"""Steady precession of trees on ball and floating joints: Lagrange's top, gimbals, Staude's motions."""

# ruff: noqa: N806 -- symbols of the notation

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
from analysis.test_ball_steady import ARM, MASS, A, C, G, model_of, top
from in_depth import deep
from random_trees import Plain
from scipy.spatial.transform import Rotation

from substructures import InvalidInput, Model, couple, derive, simulate, steady_motions
from substructures.analysis.drawings import draw
from substructures.analysis.stability.steady_result import BallSteadyMotion

SPIN, HEAVY = "x.w_b_z", MASS * G * ARM
OVER_SPIN: Plain = {"vary": SPIN, "between": (20, 30)}


def tilted(tilt: float) -> list[float]:
    return [float(np.cos(tilt / 2)), float(np.sin(tilt / 2)), 0.0, 0.0]


def tilt_of(motion: Any) -> float:
    w, x, y, z = motion.q[-4:]
    return float(2 * np.arctan2(np.hypot(x, y), np.hypot(w, z)))


def only(found: Any) -> BallSteadyMotion:
    (motion,) = (each for each in found.found if 1e-3 < tilt_of(each) < np.pi - 1e-3)
    assert isinstance(motion, BallSteadyMotion)
    return motion


@pytest.mark.parametrize(("tilt", "spin"), [(0.7, 30.0), (1.2, 20.0), (2.2, 12.0), (np.pi / 2, 25.0)])
def test_lagranges_top_precesses_slowly_and_fast(tilt: float, spin: float) -> None:
    """A cos(t) p^2 - C w p + m g l = 0, and nutations n^2 = (A^2 p^4 - 2 A m g l cos(t) p^2 + (m g l)^2)/(A p)^2 beside
    it, all stable (H. Goldstein, Classical Mechanics, section 5-7; E. J. Routh, Advanced Rigid Dynamics, section 207).
    """
    model = model_of(top())
    found = steady_motions(model, rates={SPIN: spin}, precession="any", starts=[tilted(tilt)], count=0)
    square = A * np.cos(tilt) if abs(np.cos(tilt)) > 1e-12 else 0.0
    expected = np.sort(np.roots([square, -C * spin, HEAVY]))
    assert found.is_right
    assert [each.verdict for each in found.found] == ["stable"] * len(expected)
    for each, p in zip(found.found, expected, strict=True):
        assert isinstance(each, BallSteadyMotion)
        assert each.precession == pytest.approx(p, rel=1e-9)
        assert each.axis == "z"
        assert each.angular_momentum == pytest.approx(A * p * np.sin(tilt) ** 2 + C * spin * np.cos(tilt), rel=1e-9)
        nutation = np.sqrt((A * p * p) ** 2 - 2 * A * HEAVY * np.cos(tilt) * p * p + HEAVY**2) / abs(A * p)
        assert max(mode.frequency for mode in each.modes) == pytest.approx(nutation, rel=1e-7)


def test_slow_tops_do_not_precess() -> None:
    """C^2 w^2 < 4 A m g l cos(t)."""
    spin = 0.99 * np.sqrt(4 * A * HEAVY * np.cos(0.7)) / C
    found = steady_motions(model_of(top()), rates={SPIN: spin}, precession="any", starts=[tilted(0.7)], count=0)
    assert found.found == ()
    assert "no rate of precession keeps the 'starts'" in found.message


def test_nothing_precesses_where_forces_are_not_finite() -> None:
    model = model_of(top(), gravity=(0, 0, "1" * 399))
    with np.errstate(all="ignore"):
        found = steady_motions(model, rates={SPIN: 30.0}, precession="any", starts=[tilted(0.7)], count=0)
    assert found.found == ()
    assert "no rate of precession keeps the 'starts'" in found.message


def test_it_is_the_motion_of_the_top() -> None:
    """The tilt stays, and the heading turns at the rate of the precession."""
    model = model_of(top())
    found = steady_motions(model, rates={SPIN: 30.0}, precession="any", starts=[tilted(0.7)], count=0)
    for each in found.found:
        assert isinstance(each, BallSteadyMotion)
        motion = simulate(model, each.q, (0, 3), qd=each.v)
        axes = Rotation.from_quat(motion.q, scalar_first=True).apply([0, 0, 1])
        assert np.ptp(axes[:, 2]) < 1e-9
        heading = np.unwrap(np.arctan2(axes[:, 1], axes[:, 0]))
        np.testing.assert_allclose(heading - heading[0], each.precession * motion.t, atol=1e-7)


def test_the_tilt_of_a_precession_is_found() -> None:
    """By spin and precession, and by the momenta: cos(t) = (C w p - m g l)/(A p^2); of each family one."""
    model, spin, p = model_of(top()), 30.0, 1.0
    tilt = np.arccos((C * spin * p - HEAVY) / (A * p * p))
    motion = only(steady_motions(model, rates={SPIN: spin}, precession=p, count=12))
    assert tilt_of(motion) == pytest.approx(tilt, abs=1e-9)
    momenta = {SPIN: C * spin, "angular_momentum.z": A * p * np.sin(tilt) ** 2 + C * spin * np.cos(tilt)}
    found = steady_motions(model, momenta=momenta, count=4)
    assert tilt_of(only(found)) == pytest.approx(tilt, abs=1e-9)
    assert only(found).precession == pytest.approx(p, rel=1e-9)
    assert len(found.found) == 1
    # without precession momenta are those of spins
    still = steady_motions(model, momenta={SPIN: C * spin}, count=4)
    assert {round(tilt_of(each), 6) for each in still.found} == {0.0, round(np.pi, 6)}
    np.testing.assert_allclose([each.rates for each in still.found], spin)


def gimbal(name: str, parent: str, axis: list[int], **body: Any) -> Plain:
    joint = {"type": "revolute", "coordinate": name, "axis": axis, "placement": {"position": [0, 0, 0]}}
    return {"name": name, "parent": parent, "joint": joint, **body}


def test_gimbals_tell_the_same() -> None:
    """Precession, nutation and spin as coordinates, whose cyclic rates are given: the same tilt, M and verdict."""
    body = {name: x for name, x in top().items() if name not in ("name", "parent", "joint")}
    chain = model_of(gimbal("a", "base", [0, 0, 1]), gimbal("n", "a", [1, 0, 0]), gimbal("s", "n", [0, 0, 1], **body))
    spin, p = 30.0, 1.0
    motion = only(steady_motions(model_of(top()), rates={SPIN: spin}, precession=p, count=12))
    rates = {"x.a": p, "x.s": spin - p * np.cos(tilt_of(motion))}
    found = steady_motions(chain, rates=rates, count=8).found
    (same,) = (each for each in found if abs(abs(each.q[1]) - tilt_of(motion)) < 1e-9 and each.q[1] > 0)
    np.testing.assert_allclose(same.momenta, [motion.angular_momentum, motion.momenta[0]], rtol=1e-9)
    assert same.verdict == motion.verdict == "stable"
    nutation = max(mode.frequency for mode in motion.modes)
    assert max(mode.frequency for mode in same.modes) == pytest.approx(nutation, rel=1e-7)


def test_a_rotor_precesses_with_its_frame() -> None:
    """Of the top's axis C w is what turns with it and the rotor together: A cos(t) p^2 - h p + m g l = 0."""
    inertia = {"xx": "1/20", "yy": "1/20", "zz": "1/10"}
    rotor: Plain = {"name": "rotor", "parent": "b", "inertia": inertia}
    model = model_of(top("1/20"), rotor | {"joint": {"type": "revolute", "coordinate": "turn"}})
    given = {SPIN: 2.0, "x.turn": 60.0}
    start = [*tilted(0.9), 0.0]
    found = steady_motions(model, rates=given, precession="any", starts=[start], count=0)
    # 1/5 - 1/20 of the body and 1/10 of the rotor
    h = 0.15 * 2 + 0.1 * 62
    expected = np.sort(np.roots([A * np.cos(0.9), -h, HEAVY]))
    np.testing.assert_allclose([each.precession for each in found.found], expected, rtol=1e-9)  # type: ignore[attr-defined]
    assert [each.verdict for each in found.found] == ["stable"] * 2


def test_families_of_precessions() -> None:
    """Over the rate of precession the tilt ends upright, where the slow rate is that of cos(t) = 1."""
    spin = 30.0
    given: Plain = {"rates": {SPIN: spin}, "vary": "precession", "between": (1.0, 1.2), "steps": 4, "count": 8}
    found = steady_motions(model_of(top()), **given)
    assert found.is_right
    (one,) = found.bifurcations
    slow = min(np.roots([A, -C * spin, HEAVY]))
    assert (one.kind, one.at.value) == ("pitchfork", pytest.approx(slow, rel=1e-6))
    assert {each.verdict for each in found.found} == {"stable"}
    leaning = [each for each in found.found if tilt_of(each) > 1e-3]
    assert len(leaning) > 4
    for each in leaning:
        p = float(each.value or 0)
        assert np.cos(tilt_of(each)) == pytest.approx((C * spin * p - HEAVY) / (A * p * p), abs=1e-9)
    assert "precession" in draw(found, "RRR")
    # upright it is found from both ends, once
    values = sorted(float(each.value or 0) for each in found.found if tilt_of(each) < 1e-9)
    assert (values[0], values[-1]) == (1.0, 1.2)
    assert len(set(values)) == len(values)


@pytest.mark.parametrize("vary", ["x.l", SPIN, *deep("angular_momentum.z")])
def test_families_over_what_is_given(vary: str) -> None:
    """A length, the spin, or the momentum about the vertical: the tilt follows at every value."""
    body: Plain = {**top(), "com": [0, 0, "l"], "inertia": {"xx": "1/2-2*l^2", "yy": "1/2-2*l^2", "zz": "1/5"}}
    tree = {"name": "t", "gravity": [0, 0, "-9.81"], "instances": [{"name": "x", "substructure": "d"}]}
    definition = {"name": "d", "bodies": [body], "parameters": {"l": {"value": "3/10"}}}
    model, tilt, p = couple(tree, {"x": derive(definition)}), 0.8, 1.1
    spin = (A * np.cos(tilt) * p * p + HEAVY) / (C * p)
    momentum = A * p * np.sin(tilt) ** 2 + C * spin * np.cos(tilt)
    given: Plain = {"rates": {SPIN: spin}, "precession": p}
    between: Any = (0.3, 0.29) if vary == "x.l" else (spin, spin + 0.5)
    if vary == "angular_momentum.z":
        given, between = {"momenta": {SPIN: C * spin}}, (momentum, momentum + 0.1)
    start = np.array(tilted(tilt))
    found = steady_motions(model, **given, vary=vary, between=between, steps=2, starts=start, count=0)
    assert found.is_right
    leaning = [each for each in found.found if 1e-3 < tilt_of(each) < 3]
    assert len(leaning) > 2
    for each in leaning:
        assert isinstance(each, BallSteadyMotion)
        value, rate = float(each.value or 0), each.precession
        w = value if vary == SPIN else spin
        heavy = MASS * G * (value if vary == "x.l" else ARM)
        assert A * np.cos(tilt_of(each)) * rate**2 - C * w * rate + heavy == pytest.approx(0, abs=1e-8)
        assert vary != "angular_momentum.z" or each.angular_momentum == pytest.approx(value, rel=1e-9)


def alone(joint: str, com: list[float], gravity: list[float] | None = None, **inertia: float) -> Model:
    body: Plain = {"name": "b", "parent": "base", "mass": 2, "com": com, "inertia": inertia, "joint": {"type": joint}}
    return model_of(body) if gravity is None else model_of(body, gravity=gravity)


def test_staudes_motions() -> None:
    """A heavy body turns steadily about the vertical without a spin of its own, about axes of a cone in it (O. Staude,
    Journal fuer die reine und angewandte Mathematik 113, 1894): (J u x u) . c = 0 for the vertical u and mass centre c.
    """
    c, tensor = np.array([0.1, 0.05, 0.3]), np.diag([0.5, 0.4, 0.2])
    J = tensor + 2 * (c @ c * np.eye(3) - np.outer(c, c))
    model = alone("ball", c.tolist(), xx=0.5, yy=0.4, zz=0.2)
    found = steady_motions(model, rates={}, precession=9.0, count=8)
    assert found.is_right
    assert len(found.found) >= 4
    assert "precession" in draw(found, "RRR")
    for each in found.found:
        assert isinstance(each, BallSteadyMotion)
        u = Rotation.from_quat(each.q, scalar_first=True).inv().apply([0, 0, 1])
        assert np.cross(J @ u, u) @ c == pytest.approx(0, abs=1e-9)
        np.testing.assert_allclose(each.v, 9 * u, atol=1e-12)
        motion = simulate(model, each.q, (0, 1), qd=each.v)
        np.testing.assert_allclose(motion.qd, each.v[None].repeat(len(motion.t), axis=0), atol=1e-7)


@pytest.mark.parametrize("joint", ["ball", *deep("floating")])
def test_a_free_body_precesses_about_its_momentum(joint: str) -> None:
    """A cos(t) p = C w (L. Euler), or it only spins."""
    model = alone(joint, [0, 0, 0], [0, 0, 0], xx=0.5, yy=0.5, zz=0.2)
    start = [*([0.0] * (len(model.positions) - 4)), *tilted(0.8)]
    found = steady_motions(model, rates={SPIN: 6.0}, precession="any", starts=[start], count=0)
    rates = [each.precession for each in found.found]  # type: ignore[attr-defined]
    np.testing.assert_allclose(rates, [0, 0.2 * 6 / (0.5 * np.cos(0.8))], rtol=1e-9, atol=1e-12)


def test_bad_requests() -> None:
    """With the place and a way out."""
    ball = alone("ball", [0, 0, 0], [0, 0, 0], xx=0.5, yy=0.5, zz=0.5)
    chain = model_of(gimbal("a", "base", [0, 0, 1], mass=1, inertia=dict.fromkeys(("xx", "yy", "zz"), 1)))
    away = alone("ball", [0, 0, 0.3], [0.3, 0.2, -9], xx=0.5, yy=0.5, zz=0.2)
    cases: list[tuple[Model, Plain, str, str]] = [
        (ball, {"rates": {}, "precession": 1.0}, "/precession", "several axes"),
        (chain, {"rates": {"x.a": 1}, "precession": 1.0}, "/precession", "of a coordinate"),
        (away, {"rates": {}, "precession": 1.0}, "/precession", "about no axis"),
        (model_of(top()), {"momenta": {}, "precession": 1.0}, "/precession", "'angular_momentum.z'"),
        (model_of(top()), {"rates": {"angular_momentum.z": 1}}, "/rates/angular_momentum.z", "no cyclic rate"),
        (model_of(top()), {"rates": {}, "precession": float("nan")}, "/precession", "finite"),
        (model_of(top()), {}, "/rates", "either 'rates' or 'momenta'"),
        (model_of(top()), {"rates": {}, "held": "rates"}, "/held", "are not known with ball"),
        (model_of(top()), {"rates": {}, "vary": "x.w_b_x", "between": (0, 1)}, "/vary", "no cyclic rate"),
        (model_of(top()), {"rates": {}, "precession": "any", **OVER_SPIN}, "/precession", "of single places"),
        (model_of(top()), {"rates": {}, "vary": "x.q", "between": (0, 1)}, "/vary", "no parameter or coordinate"),
    ]
    for model, given, pointer, told in cases:
        with pytest.raises(InvalidInput) as caught:
            steady_motions(model, **given)
        assert (caught.value.faults[0].pointer, told in str(caught.value)) == (pointer, True), str(caught.value)
