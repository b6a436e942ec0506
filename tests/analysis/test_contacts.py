"""Contacts that only press: balls, blocks, a hopper and a walker in closed form and as published."""

from __future__ import annotations

import math
from typing import Any

import numpy as np
import pytest
import scipy
from contact_models import BALL, PLACED, G, block, box, disc, of, plane_body, point, walker

from substructures import Contact, Event, Integrator, Model, Outputs, TreeMotion, simulate
from substructures.analysis.motion.conditions import read_conditions
from substructures.analysis.motion.contacts.contact_motion import SLIP, STARTS, STICK, ContactMotion
from substructures.analysis.motion.contacts.deciding import DecidedContacts
from substructures.analysis.motion.integrators.tableaux import TABLEAUX
from substructures.analysis.motion.problems.problem import Start
from substructures.analysis.motion.trajectory import Trajectory
from substructures.array import Array
from substructures.compile import target
from substructures.compile.motion import CompiledRun

SLIDING = [Contact(name, f"b.{name}", type="point_line", friction=0.3) for name in "lr"]


def move(model: Model, q: Any, qd: Any, end: float, contacts: list[Contact], **more: Any) -> Trajectory:
    outputs = Outputs(**{"count": 101, **more})
    return simulate(model, q, (0, end), qd=qd, kind=TreeMotion(contacts=contacts), outputs=outputs)


def seen(motion: Trajectory) -> list[tuple[str, str]]:
    return [(event.name, event.kind) for event in motion.events]


def test_a_ball_bounces_until_it_lies() -> None:
    """Times in closed form; below 1e-4 m/s it does not rebound any more, and lies there."""
    e, first = 0.8, math.sqrt(2 / G)
    motion = move(of("b", BALL, [0, 0, -G]), [1], [0], 6, [Contact("floor", "b.body", restitution=e)])
    hits = [event for event in motion.events if event.kind == "impact"]
    count = math.ceil(math.log(1e-4 / math.sqrt(2 * G)) / math.log(e)) + 1
    times = first + np.cumsum([0, *(2 * first * e**k for k in range(1, count))])
    assert [event.t for event in hits] == pytest.approx(times, abs=1e-12)
    for k, event in enumerate(hits[:-1]):
        speed = math.sqrt(2 * G) * e**k
        assert event.impulse == pytest.approx((2 * (1 + e) * speed, 0, 0), rel=1e-8)
        assert event.energy_change == pytest.approx(-(1 - e * e) * speed**2, rel=1e-8)
    assert seen(motion)[-2:] == [("floor", "impact"), ("floor", "slip")]
    assert hits[-1].after is not None
    assert hits[-1].after[1] == pytest.approx([0], abs=1e-15)
    assert (motion.status, motion.is_right) == ("finished", True)
    assert motion.q[-1] == pytest.approx([0], abs=1e-13)
    assert motion.series["contact_forces"][-1] == pytest.approx(np.array([[2 * G, 0, 0]]))


def test_a_block_slides_until_it_stops() -> None:
    """After v / (mu g), at v^2 / (2 mu g), with more load on the front corner while it slides."""
    b, h, mu = 0.3, 0.2, 0.3
    motion = move(of("b", block(b, h), [0, 0, -G]), [0, h, 0], [3, 0, 0], 2, SLIDING)
    assert seen(motion) == [("l", "stick"), ("r", "stick")]
    assert [event.t for event in motion.events] == pytest.approx([3 / (mu * G)] * 2, abs=1e-10)
    assert motion.q[-1] == pytest.approx([9 / (2 * mu * G), h, 0], abs=1e-12)
    load = np.array([1 - mu * h / b, 1 + mu * h / b]) * G
    assert motion.series["contact_forces"][0, :, 0] == pytest.approx(load)
    assert motion.series["contact_forces"][0, :, 1] == pytest.approx(-mu * load)
    assert motion.series["contact_forces"][-1, :, :2] == pytest.approx(np.array([[G, 0], [G, 0]]), abs=1e-9)
    assert motion.is_right


@pytest.mark.parametrize("fast", [1e3, 1e300])
def test_a_large_rest_velocity_is_no_restitution(fast: float) -> None:
    """Slow slips are slips all the same: sliding takes v / (mu g) from 0.1 m/s, too."""
    contacts = [Contact(name, f"b.{name}", type="point_line", friction=0.3, rest_velocity=fast) for name in "lr"]
    motion = move(of("b", block(0.3, 0.2), [0, 0, -G]), [0, 0.2, 0], [0.1, 0, 0], 1, contacts)
    assert [event.t for event in motion.events] == pytest.approx([0.1 / (0.3 * G)] * 2, abs=1e-10)
    assert motion.q[-1] == pytest.approx([0.01 / (0.6 * G), 0.2, 0], abs=1e-12)
    assert motion.is_right


@pytest.mark.parametrize("slope", [0.28, 0.31])
def test_a_block_on_a_slope_stays_where_friction_holds_it(slope: float) -> None:
    gravity = [G * math.sin(math.atan(slope)), 0, -G * math.cos(math.atan(slope))]
    motion = move(of("b", block(0.3, 0.2), gravity), [0, 0.2, 0], [0, 0, 0], 1, SLIDING)
    downhill = max(0.0, gravity[0] + 0.3 * gravity[2])
    assert motion.q[-1] == pytest.approx([downhill / 2, 0.2, 0], abs=1e-12)
    assert (seen(motion), motion.is_right) == ([], True)


def test_a_push_that_grows_lets_a_block_slip() -> None:
    """Pushed with 3 t N at its foot it slips where that is mu m g; the force is that of friction from there on."""
    loads = [{"type": "joint", "name": "push", "coordinate": "b.x", "force": "3*t"}]
    contacts = [Contact(name, f"b.{name}", type="point_line", friction=0.3) for name in "lr"]
    motion = move(of("b", block(0.5, 0.1), [0, 0, -G], loads=loads), [0, 0.1, 0], [0, 0, 0], 3, contacts)
    start = 0.3 * 2 * G / 3
    assert seen(motion) == [("l", "slip"), ("r", "slip")]
    assert [event.t for event in motion.events] == pytest.approx([start] * 2, abs=1e-7)
    left = 3 - start
    assert motion.q[-1, 0] == pytest.approx(3 / 2 * left**3 / 6, abs=1e-8)
    assert motion.is_right


def tilted(angle: float, w: float, h: float) -> list[float]:
    """A block that stands on its right corner at x = w, turned by an angle about y."""
    c, s = math.cos(angle), math.sin(angle)
    return [w - (c * w - s * h), s * w + c * h, angle]


def test_a_block_rocks_as_housner_says() -> None:
    """G. W. Housner, The behavior of inverted pendulum structures during earthquakes, Bull. Seism. Soc. Am. 53 (1963)
    403-417: after an impact 1 - 3/2 sin^2 alpha of the rate is left, and a quarter of a period of a slender block is
    acosh(1 / (1 - theta_0 / alpha)) / p, p^2 = 3 g / (4 R); of any block a quadrature.
    """
    contacts = [Contact(name, f"b.{name}", type="point_line", friction=2) for name in "lr"]
    for w, close in ((0.1, 0.02), (0.01, 1e-4)):
        alpha, radius = math.atan2(w, 0.5), math.hypot(w, 0.5)
        start, p = alpha / 2, math.sqrt(3 * G / (4 * radius))
        motion = move(of("b", block(w, 0.5), [0, 0, -G]), tilted(start, w, 0.5), [0, 0, 0], 1.5, contacts)
        first, second = [event for event in motion.events if event.kind == "impact"][:2]
        assert seen(motion)[:3] == [("l", "impact"), ("l", "stick"), ("r", "lift_off")]
        assert first.after is not None
        ratio = first.after[1][2] / first.qd[2]
        assert ratio == pytest.approx(1 - 1.5 * math.sin(alpha) ** 2, abs=1e-10)

        def period(turn: float, alpha: float = alpha, p: float = p) -> float:
            """From rest at an angle: theta'^2 = 2 p^2 (cos(alpha - theta_0) - cos(alpha - theta)), theta = th - s^2."""

            def slope(s: float) -> float:
                drop = math.cos(alpha - turn) - math.cos(alpha - turn + s * s)
                return 2 * s / math.sqrt(2 * p * p * drop) if s else 2 / math.sqrt(2 * p * p * math.sin(alpha - turn))

            return float(scipy.integrate.quad(slope, 0, math.sqrt(turn), epsabs=1e-13)[0])

        assert first.t == pytest.approx(period(start), abs=1e-9)
        assert first.t == pytest.approx(math.acosh(1 / (1 - start / alpha)) / p, rel=close)
        # up again to where cos(alpha - theta) - cos(alpha) is r^2 of what it was, and down
        rise = ratio**2 * (math.cos(alpha - start) - math.cos(alpha))
        again = alpha - math.acos(math.cos(alpha) + rise)
        assert second.t - first.t == pytest.approx(2 * period(again), abs=1e-8)
        assert motion.is_right


def test_a_rocking_block_comes_to_rest() -> None:
    contacts = [Contact(name, f"b.{name}", type="point_line", friction=2) for name in "lr"]
    motion = move(of("b", block(0.2, 0.5), [0, 0, -G]), tilted(0.2, 0.2, 0.5), [0, 0, 0], 8, contacts)
    assert (motion.status, motion.is_right) == ("finished", True)
    assert np.abs([*motion.q[-1, 1:] - [0.5, 0], *motion.qd[-1]]).max() < 1e-12
    assert motion.series["contact_forces"][-1, :, 0] == pytest.approx([G, G])


def test_a_hopper_loses_what_its_foot_had() -> None:
    """A body on a spring on a foot: the impact takes the energy of the foot; then the body swings about its place of
    rest until the spring lifts the foot off.
    """
    hopper = {
        "name": "hopper",
        "bodies": [
            {"name": "foot", "parent": "base", "joint": {"type": "prismatic", "coordinate": "z"}, "mass": 0.1},
            {"name": "body", "parent": "foot", "mass": 1,
             "joint": {"type": "prismatic", "coordinate": "s", "stiffness": 400, "rest": 0.5}},
        ],
    }  # fmt: skip
    motion = move(of("h", hopper, [0, 0, -G]), [0.3, 0.5], [0, 0], 1, [Contact("foot", "h.foot")])
    assert seen(motion)[:3] == [("foot", "impact"), ("foot", "slip"), ("foot", "lift_off")]
    hit, _, off = motion.events[:3]
    speed = math.sqrt(2 * G * 0.3)
    assert hit.t == pytest.approx(speed / G, abs=1e-12)
    assert hit.energy_change == pytest.approx(-0.05 * speed**2)
    # s - s_0 = (0.5 - s_0) cos(w t) - v / w sin(w t) up to 0.5 + 0.1 g / 400
    w, below = 20.0, G / 400
    size, phase = math.hypot(below, speed / w), math.atan2(speed / w, below)
    swing = 2 * math.pi - phase - math.acos((below + 0.1 * G / 400) / size)
    assert off.t - hit.t == pytest.approx(swing / w, abs=1e-9)
    assert motion.is_right


def test_the_simplest_walker_changes_its_foot_as_published() -> None:
    """M. Garcia, A. Chatterjee, A. Ruina, M. Coleman, The simplest walking model, J. Biomech. Eng. 120 (1998) 281-288:
    at the slope 0.009 the gait repeats itself at theta = 0.2003109, theta' = -0.1998325, with feet without mass. Here
    both feet are points that may touch while they are in front; the other one lifts off by itself.
    """
    slope, (angle, rate) = 0.009, (0.2003109, -0.1998325)
    model = of("w", walker("1/10^7"), [math.sin(slope), 0, -math.cos(slope)])
    c, s, swing = math.cos(angle), math.sin(angle), (1 - math.cos(2 * angle)) * rate
    q, qd = [-s, c, -angle, angle], [-c * rate, -s * rate, -rate, swing - rate]
    feet = [
        Contact("a", "w.fa", type="point_line", friction=5, when="w.a < w.b - 0.2"),
        Contact("b", "w.fb", type="point_line", friction=5, when="w.b < w.a - 0.2"),
    ]
    motion = move(model, q, qd, 4.5, feet)
    assert seen(motion) == [("b", "impact"), ("a", "lift_off"), ("b", "stick")]
    hit = motion.events[0]
    assert hit.after is not None
    assert hit.t == pytest.approx(3.88, abs=0.01)
    assert (-hit.after[0][3], -hit.after[1][3]) == pytest.approx((angle, rate), abs=1e-6)
    assert motion.is_right
    # the foot that swings goes through the ground, as it scuffs
    assert motion.series["gaps"][:, 1].min() < -1e-5


def test_bodies_that_collide_exchange_their_momentum() -> None:
    """A ball on a table that moves: u+ = -e u- of both, and their momentum is what it was."""
    slide = {"type": "prismatic", **PLACED, "axis": [0, 0, 1]}
    pair = {
        "name": "pair",
        "bodies": [
            {"name": "table", "parent": "base", "joint": {**slide, "coordinate": "table"}, "mass": 3},
            {"name": "ball", "parent": "base", "joint": {**slide, "coordinate": "ball"}, "mass": 1},
        ],
    }
    motion = move(
        of("p", pair, [0, 0, 0]), [0, 1], [2, -1], 1, [Contact("c", "p.ball", plane="p.table", restitution=0.5)]
    )
    (hit,) = motion.events
    assert hit.t == pytest.approx(1 / 3, abs=1e-12)
    assert hit.after is not None
    # v = (6 - 1) / 4 of both together; 1.5 apart
    assert hit.after[1] == pytest.approx([1.25 - 1.5 / 4, 1.25 + 1.5 * 3 / 4])
    assert motion.is_right


def test_what_touches_without_any_force_is_hit_together() -> None:
    """Two bodies that lie at each other, weightless, and a third one that hits them: all go on with what it had."""
    slide = {"type": "prismatic", **PLACED, "axis": [0, 0, 1]}
    bodies = [
        {"name": n, "parent": "base", "joint": {**slide, "coordinate": n}, "mass": k} for k, n in enumerate("abc", 1)
    ]
    model = of("p", {"name": "three", "bodies": bodies}, [0, 0, 0])
    contacts = [Contact("first", "p.b", plane="p.a"), Contact("second", "p.c", plane="p.b", friction=0.2)]
    motion = move(model, [-1, 0, 0], [0.5, 0, 0], 3, contacts)
    assert motion.is_right, motion.message
    assert motion.events[0].t == pytest.approx(2)
    np.testing.assert_allclose(motion.qd[-1], 0.5 / 6, atol=1e-12)


@pytest.mark.parametrize("speed", [1.0, 3.0])
def test_a_point_that_hits_a_plane_slips_or_stops(speed: float) -> None:
    """A mass at v_N = -2 and v_T: it loses mu (1 + e) 2 of v_T along its way, or all of it."""
    joint = {"type": "free", "coordinate": ["x", "y", "z", "yaw", "pitch", "roll"]}
    ball = {"name": "ball", "bodies": [{"name": "body", "parent": "base", "joint": joint, "mass": 2,
            "inertia": {"xx": 1, "yy": 1, "zz": 1}}]}  # fmt: skip
    way = np.array([0.6, 0.8])
    contact = Contact("c", "b.body", restitution=0.5, friction=0.5)
    motion = move(of("b", ball, [0, 0, 0]), [0, 0, 1, 0, 0, 0], [*(speed * way), -2, 0, 0, 0], 1, [contact])
    (hit,) = motion.events
    assert hit.after is not None
    assert hit.after[1][:3] == pytest.approx([*(max(0.0, speed - 1.5) * way), 1], abs=1e-12)
    assert motion.is_right


def test_a_box_slides_straight_and_spins_to_a_stop() -> None:
    """In space: four corners, whose forces are not unique. A box that slides and spins stops both at once."""
    contacts = [Contact(c, f"b.{c}", friction=0.3) for c in CORNERS]
    model = of("b", box(), [0, 0, -G])
    straight = move(model, [0, 0, 0.1, 0, 0, 0], [3, 1, 0, 0, 0, 0], 1.5, contacts)
    speed = math.hypot(3, 1)
    assert [event.t for event in straight.events] == pytest.approx([speed / (0.3 * G)] * 4, abs=1e-9)
    way = speed / (2 * 0.3 * G)
    assert straight.q[-1] == pytest.approx([3 * way, way, 0.1, 0, 0, 0], abs=1e-9)
    spun = move(model, [0, 0, 0.1, 0, 0, 0], [3, 1, 0, 4, 0, 0], 1.5, contacts)
    assert {event.kind for event in spun.events} == {"stick"}
    assert max(event.t for event in spun.events) > speed / (0.3 * G)
    assert np.abs(spun.qd[-1]).max() < 1e-9
    assert straight.is_right
    assert spun.is_right


def test_a_box_tumbles_to_rest() -> None:
    contacts = [Contact(c, f"b.{c}", friction=0.3, restitution=0.2) for c in CORNERS]
    motion = simulate(
        of("b", box(), [0, 0, -G]), [0, 0, 0.15, 0.3, 0.1, 0.2], (0, 0.8), qd=[1, 1, 0, 1, 1, 0],
        kind=TreeMotion(contacts=contacts), integrator=Integrator("RK45", relative_tolerance=1e-8),
    )  # fmt: skip
    assert (motion.status, motion.is_right) == ("finished", True)
    assert len([event for event in motion.events if event.kind == "impact"]) > 20
    assert np.abs(motion.qd[-1]).max() < 1e-9
    assert motion.q[-1, 2] == pytest.approx(0.1, abs=1e-9)


CORNERS = ("c00", "c01", "c10", "c11")
#: contacts by name with their modes, coordinates, and rates with which the closed ones keep their gaps
MOVING = {
    "in the air": ({"l": 0, "r": 0}, block(0.2, 0.5), [0, 0.6, 0.1], [1, 2, 3]),
    "turns about a corner": ({"l": 0, "r": STICK}, block(0.2, 0.5), [0, 0.5, 0], [0.5, -0.2, 1]),
    "slides on a corner": ({"l": 0, "r": SLIP}, block(0.2, 0.5), [0, 0.5, 0], [2, -0.2, 1]),
    "slides on two": ({"l": SLIP, "r": SLIP}, block(0.2, 0.5), [0, 0.5, 0], [2, 0, 0]),
    "slides and spins": (dict.fromkeys(CORNERS, SLIP), box(), [0, 0, 0.1, 0.3, 0, 0], [3, 1, 0, 4, 0, 0]),
    "turns about a point": ({"c00": STICK, "c01": SLIP}, box(), [0, 0, 0.1, 0, 0, 0], [0.1, -0.2, 0, 2, 0, 0]),
    "on a ring": ({f"p{k}": SLIP for k in range(8)}, disc(8), [0, 0, 0.05, 0.2, 0, 0], [0.3, 0.1, 0, 5, 0, 0]),
}  # fmt: skip


@pytest.mark.skipif(not target.available(), reason="machine code cannot be made, or is not wanted")
@pytest.mark.parametrize("name", MOVING)
def test_steps_of_contacts_are_machine_code(name: str) -> None:
    """x', its power and forces as in Python; closed contacts keep their gaps, and those that stick their places."""
    modes, body, q, qd = MOVING[name]
    kind: Any = "point_plane" if len(q) == 6 else "point_line"
    feet = [Contact(each, f"b.{each}", type=kind, friction=0.3) for each in modes]
    model, x = of("b", body, [0, 0, -G]), np.array([*q, *qd, 0.0], dtype=np.float64)
    conditions = read_conditions(model, Start(q), (0, 1), ["metric", "bias", "forces"])
    f = DecidedContacts(model, conditions.values, conditions.zero, conditions, feet)
    f.begin()
    f.look(0.0, x)
    f.modes[:, 0], f.modes[:, 1], f.modes[:, 3] = list(modes.values()), 1, f.yields(np.arange(len(feet)))
    rates = f.compiled()
    assert rates is not None
    found = CompiledRun(TABLEAUX["RK23"], rates, (1.0, 1.0)).rates(0.0, x)
    second, _, power = f.evaluate(0.0, x)
    np.testing.assert_array_equal(found, [*qd, *second, power])
    force = f.force.copy()
    second, _, power = ContactMotion.evaluate(f, 0.0, x)
    size = max(1.0, float(np.abs(second).max()))
    np.testing.assert_allclose(found[len(q) :], [*second, power], rtol=1e-11, atol=1e-11 * size)
    np.testing.assert_allclose(force, f.force, rtol=1e-9, atol=1e-9 * max(1.0, float(np.abs(force).max())))
    kept = (f.G @ found[len(q) : -1] + f.bias)[f.modes[:, 0] > 0, 0]
    np.testing.assert_allclose(kept, 0, atol=1e-11 * size)
    assert (force[:, 0] != 0).tolist() == (f.modes[:, 0] > 0).tolist()


@pytest.mark.skipif(not target.available(), reason="machine code cannot be made, or is not wanted")
def test_slips_that_begin_are_found_in_machine_code() -> None:
    """Of two corners at once, whose accelerations are along their ways: as in Python."""
    feet = [Contact(each, f"b.{each}", friction=0.3) for each in CORNERS[:2]]
    model, x = of("b", box(), [4, 1, -G]), np.array([0, 0, 0.1, 0.3, 0, 0, *[0] * 7], dtype=np.float64)
    conditions = read_conditions(model, Start(x[:6]), (0, 1), ["metric", "bias", "forces"])
    f = DecidedContacts(model, conditions.values, conditions.zero, conditions, feet)
    f.begin()
    f.look(0.0, x)
    f.modes[:, 0], f.modes[:, 1], f.modes[:, 3] = STARTS, 1, f.yields(np.arange(2))
    assert f.compiled() is None
    second, _, _ = f.evaluate(0.0, x)
    force, w = f.force.copy(), f.G @ second + f.bias
    np.testing.assert_allclose(w[:, 1] * force[:, 2], w[:, 2] * force[:, 1], atol=1e-11)
    np.testing.assert_allclose(np.hypot(*force[:, 1:].T), 0.3 * force[:, 0])
    found, _, _ = ContactMotion.evaluate(f, 0.0, x)
    np.testing.assert_allclose([*second, *force.ravel()], [*found, *f.force.ravel()], rtol=1e-9, atol=1e-10)


def test_what_rests_is_right_however_long() -> None:
    """Nothing moves, so that there is no energy with which rounding could be compared."""
    feet = [Contact(name, f"b.{name}", type="point_line", friction=0.5) for name in "lr"]
    motion = move(of("b", block(0.2, 0.5), [3, 0, -G]), [0.3, 0.5, 0], [0, 0, 0], 10, feet)
    assert motion.is_right, motion.checks
    assert np.abs(motion.qd).max() < 1e-14


def test_a_disc_stays_where_it_falls_on_sixteen_points() -> None:
    """Flat, after 0.1 s: as many points alike hold it as their number, with impulses of which only sums are known."""
    rim = [Contact(f"p{k}", f"b.p{k}", friction=0.4) for k in range(16)]
    fall = 0.1
    start = [0, 0, 0.05 + G * fall**2 / 2, 0, 0, 0]
    motion = move(
        of("b", disc(16), [0, 0, -G]), start, [0.2, 0.1, 0, 0, 0, 0], 0.2, rim, count=None, times=[0, 0.15, 0.2]
    )
    assert motion.is_right, motion.checks
    assert [event.t for event in motion.events if event.kind == "impact"] == pytest.approx([fall] * 16)
    np.testing.assert_allclose(motion.q[1:], [[0.2 * fall, 0.1 * fall, 0.05, 0, 0, 0]] * 2, atol=1e-9)
    assert np.abs(motion.qd[1:]).max() < 1e-12
    np.testing.assert_allclose(motion.series["contact_forces"][-1, :, 0], 2 * G / 16, rtol=1e-6)


def test_a_thin_disc_settles_point_by_point() -> None:
    """Tilted onto eight points, of which some begin to slip slowly: friction is against their accelerations then."""
    rim = [Contact(f"p{k}", f"b.p{k}", friction=0.4) for k in range(8)]
    model = of("b", disc(8, 1.0, 0.01, (0.1 * 0.0253, 0.005)), [0, 0, -G])
    motion = move(model, [0, 0, 0.1, 0, 0.1, 0.2], [0] * 6, 0.4, rim)
    assert motion.is_right, motion.checks
    assert motion.steps < 2000
    assert motion.q[-1, 2:] == pytest.approx([0.01, motion.q[-1, 3], 0, 0], abs=1e-9)
    assert np.abs(motion.qd[-1]).max() < 1e-9


def test_a_slip_from_rest_has_the_way_of_its_acceleration() -> None:
    """Pushed beyond friction by a force that turns: v x (F - mu m g v/|v|) = 0 from rest on, by another integrator."""
    loads = [{"type": "joint", "name": f"push_{a}", "coordinate": f"b.{a}", "force": text}
             for a, text in (("x", "6 + t"), ("y", "4*t^2"))]  # fmt: skip
    contacts = [Contact("c", "b.body", friction=0.3)]
    motion = move(of("b", point(), [0, 0, -G], loads=loads), [0, 0, 0], [0, 0, 0], 0.5, contacts)

    def rates(t: float, x: Array) -> Array:
        force = np.array([6 + t, 4 * t * t]) - 0.6 * G * x[2:] / max(np.hypot(*x[2:]), 1e-12)
        return np.concatenate([x[2:], force / 2])

    start = [0, 0, 1e-6 * (6 - 0.6 * G) / 2, 0]
    right = scipy.integrate.solve_ivp(rates, (1e-6, 0.5), start, "Radau", rtol=1e-11, atol=1e-14).y[:, -1]
    assert [*motion.q[-1, :2], *motion.qd[-1, :2]] == pytest.approx(right, abs=1e-8)
    assert motion.is_right, motion.checks


def test_rows_that_depend_on_each_other_may_part() -> None:
    """Two legs of 1 m side by side, which begin to spread on the ground: the rows of both feet are the same at the
    start alone. All slide together by gravity, and the hip falls.
    """
    feet = [Contact(leg, f"w.f{leg}", type="point_line") for leg in "ab"]
    model = of("w", walker("1/2"), [1, 0, -G])
    motion = move(model, [0, 1, 0, 0], [0, 0, 0.5, -0.5], 0.5, feet)
    assert motion.is_right, motion.checks
    x, z, a, b = motion.q.T
    np.testing.assert_allclose(x, motion.t**2 / 2, atol=1e-10)
    np.testing.assert_allclose([z, b], [np.cos(a), -a], atol=1e-10)
    # a hip of 1 kg at z = cos(a), and feet of 1/2 kg at -+sin(a) from it
    rate = motion.qd[:, 2]
    energy = (np.sin(a) * rate) ** 2 / 2 + (np.cos(a) * rate) ** 2 / 2 + G * np.cos(a)
    np.testing.assert_allclose(energy, energy[0], rtol=1e-9)


def test_a_rod_that_jams_is_told() -> None:
    """P. Painleve, Sur les lois du frottement de glissement, C. R. Acad. Sci. 121 (1895) 112-115: a rod of length 2
    that slides with its end ahead has no contact force where 1 + 3 sin^2 < 3 mu sin cos.
    """
    rod = of("b", plane_body({"end": [0, 0, -1]}, 1, 1 / 3), [0, 0, -G])
    s, c = math.sin(0.6), math.cos(0.6)
    most = (1 + 3 * s * s) / (3 * s * c)
    for mu, status in ((0.99 * most, "finished"), (1.01 * most, "failed")):
        contacts = [Contact("end", "b.end", type="point_line", friction=mu)]
        motion = move(rod, [-s, c, -0.6], [3, 0, 0], 0.01, contacts)
        assert motion.status == status
    assert "Painleve" in motion.message
    assert motion.is_right is None
    behind = move(rod, [s, c, 0.6], [3, 0, 0], 0.01, contacts)
    assert (behind.status, behind.is_right) == ("finished", True)


def test_planes_and_lines_agree() -> None:
    model, start = of("b", block(0.3, 0.2), [0, 0, -G]), ([0, 0.7, 0.4], [1, 0, 1])
    found: list[Array] = []
    for kind in ("point_line", "point_plane"):
        contacts = [Contact(n, f"b.{n}", type=kind, friction=0.3, restitution=0.3) for n in "lr"]  # type: ignore[arg-type]
        motion = move(model, *start, 2, contacts)
        assert motion.is_right
        found.append(motion.q)
    assert found[0] == pytest.approx(found[1], abs=1e-8)


def test_other_events_and_inputs_go_on() -> None:
    loads = [{"type": "joint", "name": "air", "coordinate": "b.z", "force": "-0.5*b.z'"}]
    up = Event("half", "b.z", level=0.5, action="record")
    model = of("b", BALL, [0, 0, -G], loads=loads)
    motion = move(model, [1], [0], 3, [Contact("floor", "b.body", restitution=0.9)], events=[up])
    assert [event.name for event in motion.events][:5] == ["half", "floor", "half", "half", "floor"]
    assert motion.is_right
    told: list[float] = []

    def report(share: float) -> bool:
        told.append(share)
        return len(told) < 5

    contacts = [Contact("floor", "b.body", restitution=0.9)]
    cut = simulate(model, [1], (0, 3), kind=TreeMotion(contacts=contacts), integrator=Integrator(progress=report))
    assert cut.cancelled


@pytest.mark.parametrize(("force", "fall"), [(20.0, 0.0), (12.0, 9.81 - 2 * 0.4 * 12.0)])
def test_fingers_hold_a_body_by_friction(force: float, fall: float) -> None:
    """Two fingers press with F on a body of 1 kg: it stays where 2 mu F > m g, and else slides between them. Their
    sides are planes that move.
    """
    slide = {"type": "prismatic", **PLACED, "axis": [1, 0, 0]}
    fingers = [
        {"name": side, "parent": "base", "joint": {**slide, "coordinate": side}, "mass": 0.5}
        for side in ("left", "right")
    ]
    edges = {"lu": [-0.05, 0, 0.03], "ld": [-0.05, 0, -0.03], "ru": [0.05, 0, 0.03], "rd": [0.05, 0, -0.03]}
    body = plane_body({name: list(map(float, place)) for name, place in edges.items()}, 1, 0.01)
    definition = {
        "name": "grip",
        "bodies": [*body["bodies"], *fingers],
        "ports": [*body["ports"],
                  {"name": "pl", "body": "left", "position": [0, 0, 0], "rotation": {"rpy": [0, "pi/2", 0]}},
                  {"name": "pr", "body": "right", "position": [0, 0, 0], "rotation": {"rpy": [0, "-pi/2", 0]}}],
    }  # fmt: skip
    loads = [
        {"type": "joint", "name": side, "coordinate": f"g.{side}", "force": sign * force}
        for side, sign in (("left", 1), ("right", -1))
    ]
    model = of("g", definition, [0, 0, -G], loads=loads)
    contacts = [Contact(f"{s}{e}", f"g.{s}{e}", plane=f"g.p{s}", friction=0.4) for s in "lr" for e in "ud"]
    start = [{"g.left": -0.05, "g.right": 0.05}.get(name, 0) for name in model.coordinates]
    motion = simulate(model, start, (0, 0.5), kind=TreeMotion(contacts=contacts), outputs=Outputs(count=11))
    assert (motion.status, motion.is_right) == ("finished", True)
    z = motion.q[-1, model.coordinates.index("g.z")]
    assert z == pytest.approx(-fall * 0.5**2 / 2, abs=1e-9)
    assert motion.series["contact_forces"][-1, :, 0] == pytest.approx([force / 2] * 4, rel=0.2)
