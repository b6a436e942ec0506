"""Contacts that only press: balls, blocks, a hopper and a walker in closed form and as published."""

from __future__ import annotations

import math
from typing import Any

import numpy as np
import pytest
import scipy
from contact_models import BALL, PLACED, G, block, box, of, walker

from substructures import Contact, Integrator, Model, Outputs, TreeMotion, simulate
from substructures.analysis.motion.trajectory import Trajectory

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
