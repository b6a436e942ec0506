"""Contacts in machine code, bodies that rest on many points, slips that begin, jams, and other events beside them."""

from __future__ import annotations

import math
from typing import Any

import numpy as np
import pytest
import scipy
from contact_models import BALL, PLACED, G, block, box, disc, of, plane_body, point, walker

from substructures import Contact, Event, Integrator, Outputs, TreeMotion, simulate
from substructures.analysis.motion.conditions import read_conditions
from substructures.analysis.motion.contacts.contact_motion import SLIP, STARTS, STICK, ContactMotion
from substructures.analysis.motion.contacts.deciding import DecidedContacts
from substructures.analysis.motion.integrators.tableaux import TABLEAUX
from substructures.analysis.motion.problems.start import Start
from substructures.array import Array
from substructures.compile import target
from substructures.compile.motion import CompiledRun

from .test_contacts import CORNERS, move

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
