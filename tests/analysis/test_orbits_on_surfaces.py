"""Orbits, sections and exponents of states with quaternions, on closures and with velocity constraints."""

# ruff: noqa: N806 -- symbols of the notation

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
from rolling_bodies import A, C, M, R, disc_part
from scipy.spatial.transform import Rotation
from scipy.special import ellipk

from substructures import Event, Model, couple, derive, steady_motions
from substructures.analysis.drawings import draw_section
from substructures.analysis.orbits.lyapunov import lyapunov_exponents
from substructures.analysis.orbits.periodic import Section, Shooting, periodic_orbits
from substructures.analysis.orbits.sections import poincare_section
from substructures.errors import InvalidInput

from .orbit_trees import tree_of

Plain = dict[str, Any]
G, L = 9.81, 0.7


def top(moments: tuple[Any, Any, Any], com: Any = (0, 0, 0), joint: str = "ball") -> Model:
    inertia = dict(zip(("xx", "yy", "zz"), moments, strict=True))
    body = {"name": "b", "parent": "base", "mass": 2, "com": list(com), "inertia": inertia, "joint": {"type": joint}}
    return tree_of({"name": "top", "bodies": [body]})


def quaternion(*turn: float) -> np.ndarray:
    return np.asarray(Rotation.from_rotvec(turn).as_quat(scalar_first=True))


def pendulum(name: str, mass: Any, place: Any = 0) -> Plain:
    joint = {"type": "revolute", "coordinate": name, "axis": [0, -1, 0], "placement": {"position": [place, 0, 0]}}
    return {"name": name, "parent": "base", "joint": {**joint, "damping": "d"}, "mass": mass, "com": [0, 0, "-0.7"]}


def part(*bodies: Plain) -> Plain:
    tips = [{"name": f"tip_{b['name']}", "body": b["name"], "position": [0, 0, "-0.7"]} for b in bodies]
    return {"name": "rods", "parameters": {"d": {"value": 0}}, "bodies": list(bodies), "ports": tips}


@pytest.fixture(scope="module")
def parallelogram() -> Model:
    """Two pendulums whose tips a rod holds as far apart as their hinges: one pendulum of 3 kg."""
    rod = {"name": "bar", "type": "rod", "from": "p.tip_a", "to": "p.tip_b", "length": "0.4"}
    instance = {"name": "p", "substructure": "rods"}
    tree = {"name": "t", "gravity": [0, 0, "-9.81"], "instances": [instance], "closures": [rod]}
    return couple(tree, {"p": derive(part(pendulum("a", 1), pendulum("b", 2, "0.4")))})


def test_a_top_that_precesses_steadily_nods_at_the_frequency_of_its_neighbours() -> None:
    """A O^2 cos th - C w O + m g l = 0; O^2 - 2 m g l cos th/A + (m g l/(A O))^2 of the nutation (E. J. Routh, Advanced
    Rigid Dynamics, 1884); with w = O (2 + cos th) it spins twice about its axis in a turn about the vertical.
    """
    mgl, A, C, th = 2 * G * 0.3, 0.5, 0.2, 0.6
    model = top((A - 0.18, A - 0.18, C), (0, 0, "0.3"))
    O = np.sqrt(mgl / (2 * C + (C - A) * np.cos(th)))  # noqa: E741
    w = O * (2 + np.cos(th))
    start, hold = quaternion(th + 0.003, 0, 0), ("p.w_b_z'",)
    (orbit,) = periodic_orbits(model, start, Shooting(6.29 / O, hold=hold), qd=np.array([0, O * np.sin(th), w])).found
    assert orbit.is_right
    assert orbit.period == pytest.approx(2 * np.pi / O, rel=1e-8)
    nods = np.exp(1j * orbit.period * np.sqrt(O**2 - 2 * mgl * np.cos(th) / A + (mgl / (A * O)) ** 2))
    left = sorted(orbit.multipliers, key=lambda x: abs(x - nods))
    assert left[0] == pytest.approx(nods, abs=1e-7)
    assert min(abs(x - nods.conjugate()) for x in orbit.multipliers) < 1e-7
    np.testing.assert_allclose(sorted(np.abs(orbit.multipliers - 1))[:4], 0, atol=1e-3)


def test_a_free_top_crosses_where_its_rates_turn() -> None:
    """w_x + i w_y = w exp(i k t), k = (C - A)/A w_z in the axes of the body."""
    model = top((1, 1, "3/2"))
    found = poincare_section(model, quaternion(0.1, 0.2, 0.3), "p.w_b_y'", 32, qd=[0.3, 0, 1.2], count=3)
    assert found.is_right
    np.testing.assert_allclose(found.t, 2 * np.pi * np.arange(1, 4) / 0.6, rtol=1e-9)
    assert found.q.shape == (3, 4)
    drawn = draw_section(found, model.joints)
    assert drawn.count("t in s") == 3
    assert "p.w_b_x' in rad/s" in drawn
    exponents = lyapunov_exponents(model, quaternion(0.1, 0.2, 0.3), 8, qd=[0.3, 0, 1.2], intervals=20)
    assert exponents.is_right
    assert exponents.exponents.shape == (6,)


def test_a_body_that_bounces_as_it_turns() -> None:
    """Without loss: T = 2 v/g, and from the plane on a whole turn about the vertical in that time; its height changes
    the period, its turning parts from it with its rate.
    """
    model = top((1, 1, 1), joint="floating")
    bounce = Event("bounce", "p.r_b_z", direction="falling", reset={"p.v_b_z'": "-p.v_b_z'"})
    T = 1.3
    (orbit,) = periodic_orbits(
        model, np.array([0, 0, 0.2, 1, 0, 0, 0]), Shooting(1.01 * T, hold=("p.w_b_z'",)),
        qd=np.array([0, 0, np.sqrt((G * T / 2) ** 2 - 0.4 * G), 0, 0, 2 * np.pi / T]), events=[bounce],
    ).found  # fmt: skip
    assert orbit.is_right
    assert orbit.period == pytest.approx(T, rel=1e-8)
    np.testing.assert_allclose(np.abs(orbit.multipliers), 1, atol=1e-3)


def test_a_parallelogram_swings_as_one_pendulum(parallelogram: Model) -> None:
    """T = 4 K(sin^2(a/2)) sqrt(l/g), from an amplitude that is held, and by a section; forced and damped it has the
    multipliers of the pendulum; with dampers its exponents add up to - sum d/(m l^2).
    """
    a = 1.0
    T = 4 * ellipk(np.sin(a / 2) ** 2) * np.sqrt(L / G)
    held = Shooting(1.02 * T, hold=("p.a", "p.b'"))
    for shooting in (held, Shooting(None, section=Section("p.b'"))):
        (orbit,) = periodic_orbits(parallelogram, np.array([a, a]), shooting).found
        assert orbit.is_right
        assert orbit.period == pytest.approx(T, rel=1e-10)
        assert orbit.multipliers.shape == (2,)
        np.testing.assert_allclose(orbit.multipliers, 1, atol=1e-5)
    forced = {"inputs": {"tau.p.a": "2*cos(3*t)"}, "parameters": {"p.d": 0.5}}
    (two,) = periodic_orbits(parallelogram, np.array([0.1, 0.1]), Shooting(2 * np.pi / 3), **forced).found
    alone = part(pendulum("a", 3))
    single = tree_of({**alone, "bodies": [{**alone["bodies"][0], "joint": {**alone["bodies"][0]["joint"]}}]})
    forced["parameters"] = {"p.d": 1.0}
    (one,) = periodic_orbits(single, np.array([0.1]), Shooting(2 * np.pi / 3), **forced).found
    assert one.is_right is two.is_right is True
    np.testing.assert_allclose(two.q, one.q[0], rtol=1e-7)
    np.testing.assert_allclose(np.sort_complex(two.multipliers), np.sort_complex(one.multipliers), atol=1e-7)
    exponents = lyapunov_exponents(parallelogram, np.array([0.3, 0.3]), 5, intervals=20, parameters={"p.d": 0.5})
    assert exponents.is_right
    assert exponents.exponents.sum() == pytest.approx(-2 * 0.5 / (3 * L**2), abs=1e-7)


def test_a_disc_comes_back_on_its_circle() -> None:
    """Routh: (A sin th cos th - (C + m r^2) (k + cos th) sin th) psi'^2 = m g r cos th with ph' = k psi', k = -5 here;
    multipliers are those of the eigenvalues of the steady motion.
    """
    floor = {"name": "floor", "type": "rolling", "frame": "p.disc", "radius": "p.r"}
    tree = {"name": "t", "gravity": [0, 0, "-9.81"], "velocity_constraints": [floor]}
    model = couple({**tree, "instances": [{"name": "p", "substructure": "disc"}]}, {"p": derive(disc_part())})
    th, k = 1.2, -5
    s, c = np.sin(th), np.cos(th)
    psi = np.sqrt(M * G * R * c / (A * s * c - (C + M * R * R) * (k + c) * s))
    normal = np.array([0, -s, c])
    down = -(np.array([0, 0, 1]) - c * normal) / s * R
    moving = -np.cross(psi * np.array([0, 0, 1]) + k * psi * normal, down)
    q, qd = np.array([0, 0, R * s, 0, th, 0]), np.array([*moving, psi, 0, k * psi])
    turns = {"p.psi": 1, "p.ph": k}
    (orbit,) = periodic_orbits(model, q, Shooting(1.001 * 2 * np.pi / psi, turns=turns, hold=("p.th",)), qd=qd).found
    assert orbit.is_right
    assert orbit.period == pytest.approx(2 * np.pi / psi, rel=1e-7)
    steady = steady_motions(model, rates={"p.psi": psi, "p.ph": k * psi}, starts=q, count=0)
    motion = next(each for each in steady.found if abs(each.q[4] - th) < 1e-6)
    eigenvalues = np.array([mode.eigenvalue for mode in motion.modes])
    assert np.abs(eigenvalues).max() > 1
    for multiplier in np.exp(eigenvalues * orbit.period):
        assert np.abs(orbit.multipliers - multiplier).min() < 1e-3


def test_what_is_not_known_is_refused(parallelogram: Model) -> None:
    event = Event("e", "p.a", direction="falling", reset={"p.a'": "-p.a'"})
    with pytest.raises(InvalidInput, match="events act on trees without closures"):
        periodic_orbits(parallelogram, np.array([1.0, 1.0]), Shooting(1.0), events=[event])
    with pytest.raises(InvalidInput, match="a state takes 'values'"):
        periodic_orbits(top((1, 1, 1)), quaternion(0, 0, 0), Shooting(1.0), vary="p.w_b_x'", between=(0, 1))
