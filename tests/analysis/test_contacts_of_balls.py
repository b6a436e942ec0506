"""Contacts of bodies that turn by quaternions: as by angles, past the pitch where these end, and in closed form."""

from __future__ import annotations

import math
from typing import Any

import numpy as np
import pytest
import tied_combinations
from ball_trees import displaced, random_balls, random_position
from contact_models import BALL, PLACED, G, block, of
from scipy.spatial.transform import Rotation

from service.models.formulas import QUANTITIES
from service.models.numbers import ANALYSES
from substructures import (
    Contact,
    Integrator,
    InvalidInput,
    Model,
    Outputs,
    TreeMotion,
    couple,
    derive,
    evaluate,
    simulate,
)
from substructures.analysis.motion.conditions import read_conditions
from substructures.analysis.motion.contacts.contact_motion import OPEN, SLIP, STICK, ContactMotion
from substructures.analysis.motion.contacts.deciding import DecidedContacts
from substructures.analysis.motion.contacts.rows import contact_rows
from substructures.analysis.motion.integrators.tableaux import TABLEAUX
from substructures.analysis.motion.problems.start import Start
from substructures.analysis.motion.trajectory import Trajectory
from substructures.array import Array
from substructures.compile import target
from substructures.compile.motion import CompiledRun
from substructures.expr.interpret import interpret

from .test_contacts import move, seen

Plain = dict[str, Any]
#: half sizes of a box, its mass, and its corners
HALF, MASS = np.array([0.3, 0.2, 0.1]), 2.0
SIGNS = np.array([[x, y, z] for x in (-1, 1) for y in (-1, 1) for z in (-1, 1)])
CORNERS = [f"c{k}" for k in range(8)]
ANGLES = ["x", "y", "z", "yaw", "pitch", "roll"]


def joint_of(kind: str) -> Plain:
    return {"type": kind, **({"coordinate": ANGLES} if kind == "free" else {})}


def box(kind: str, axes: Array | None = None) -> Model:
    """A box on a joint of this kind, described in axes whose directions in those of its edges are columns."""
    turn = np.eye(3) if axes is None else axes
    inertia = turn.T @ np.diag(MASS / 3 * (HALF @ HALF - HALF**2)) @ turn
    places = (SIGNS * HALF) @ turn
    return of(
        "b",
        {
            "name": "box",
            "bodies": [{"name": "body", "parent": "base", "joint": joint_of(kind), "mass": MASS,
                        "inertia": dict(zip(("xx", "yy", "zz"), np.diag(inertia).round(12).tolist(), strict=True))}],
            "ports": [{"name": name, "body": "body", "position": place}
                      for name, place in zip(CORNERS, places.round(12).tolist(), strict=True)],
        },
        [0, 0, -G],
    )  # fmt: skip


def thrown(model: Model, place: Any, turn: Rotation, v: Any, w: Any) -> tuple[list[float], list[float]]:
    """The state of a body at a place, turned, with a velocity and an angular velocity, all in the world."""
    if model.balls:
        rates = [*turn.inv().apply(v), *turn.inv().apply(w)]
        return [*place, *turn.as_quat(scalar_first=True)], rates
    yaw, pitch, roll = turn.as_euler("ZYX")
    of_yaw = Rotation.from_euler("Z", yaw)
    # w = yaw' e_z + pitch' e_y' + roll' e_x''
    columns = np.column_stack([[0, 0, 1], of_yaw.apply([0, 1, 0]), turn.apply([1, 0, 0])])
    return [*place, yaw, pitch, roll], [*v, *np.linalg.solve(columns, w)]


def fall(model: Model, start: tuple[list[float], list[float]], end: float, **more: Any) -> Trajectory:
    contacts = [Contact(name, f"b.{name}", **{"restitution": 0.3, "friction": 0.4, **more}) for name in CORNERS]
    return move(model, *start, end, contacts, count=41)


def corners(model: Model, motion: Trajectory) -> Array:
    """Of all results (K, 8, 3)."""
    frames = [model.frames.index(f"b.{name}") for name in CORNERS]
    return np.asarray(evaluate(model, "position", motion.q)["position"][:, frames])


def impacts(motion: Trajectory) -> Array:
    """Number of the corner, time, impulse along the normal and its size across, in the order of time."""
    hits = [event for event in motion.events if event.kind == "impact"]
    return np.array([[CORNERS.index(e.name), e.t, e.impulse[0], math.hypot(*e.impulse[1:])] for e in hits])


def impacts_of(motion: Trajectory) -> list[float]:
    return [event.t for event in motion.events if event.kind == "impact"]


def test_a_spinning_ball_bounces_as_one_that_slides() -> None:
    """All mass about its origin: impulses do not turn it, and its angular momentum stays in all axes."""
    floor = [Contact("floor", "b.body", restitution=0.8)]
    slides = move(of("b", BALL, [0, 0, -G]), [1], [0], 4, floor)
    body = {"name": "body", "parent": "base", "joint": {"type": "floating"}, "mass": 2,
            "inertia": {"xx": 1, "yy": 2, "zz": 3}}  # fmt: skip
    model = of("b", {"name": "ball", "bodies": [body]}, [0, 0, -G])
    turns = move(model, [0, 0, 1, 0.6, 0, 0.8, 0], [0, 0, 0, 2, -1, 3], 4, floor)
    assert turns.is_right is slides.is_right is True
    assert seen(turns) == seen(slides)
    ours, theirs = ([(e.t, *e.impulse) for e in m.events if e.kind == "impact"] for m in (turns, slides))
    np.testing.assert_allclose(ours, theirs, rtol=0, atol=1e-9)
    np.testing.assert_allclose(turns.q[:, 2], slides.q[:, 0], atol=1e-9)
    angular = evaluate(model, "momentum", turns.q, turns.qd)["momentum"]["angular"]
    np.testing.assert_allclose(angular, np.broadcast_to(angular[0], angular.shape), atol=1e-8)
    np.testing.assert_allclose(np.linalg.norm(turns.q[:, 3:], axis=1), 1, rtol=1e-14)
    hit = next(event for event in turns.events if event.kind == "impact")
    assert hit.after is not None
    np.testing.assert_allclose(hit.after[0], hit.q, atol=1e-12)


def test_a_corner_that_begins_below_is_lifted_onto_the_floor() -> None:
    """Least in the metric: beside the place the box turns, and its quaternion stays one."""
    model, turn = box("floating"), Rotation.from_euler("ZYX", [0.3, 0.2, -0.5])
    below = 5e-7
    height = -turn.apply(SIGNS * HALF)[:, 2].min() - below
    start = thrown(model, [0, 0, height], turn, [0, 0, 0], [0, 0, 0])
    motion = fall(model, start, 0.02)
    assert motion.is_right
    assert np.abs(motion.series["gaps"].min(axis=1)).max() <= 1e-12
    lifted = motion.q[0] - start[0]
    assert 0 < lifted[2] < below
    assert np.abs(lifted[3:]).max() > 1e-8
    np.testing.assert_allclose(np.linalg.norm(motion.q[:, 3:], axis=1), 1, rtol=1e-14)


@pytest.mark.parametrize(
    ("turn", "v", "w"),
    [((-0.4, 0.3, 1.0), (1.0, -0.5, 0.0), (-2, 1, 3)), ((1.2, -0.2, -0.6), (0.0, 1.0, -1.0), (0.5, -1.5, -4))],
)
def test_a_box_falls_as_by_angles(turn: Any, v: Any, w: Any) -> None:
    """Whatever happens does at the same times, with the same impulses; corners go the same ways, and come to rest."""
    start = [0, 0, 1], Rotation.from_euler("ZYX", turn), v, w
    models = [box(kind) for kind in ("floating", "free")]
    ours, theirs = (fall(model, thrown(model, *start), 2) for model in models)
    assert ours.is_right is theirs.is_right is True
    assert seen(ours) == seen(theirs)
    assert len(ours.events) > 50
    np.testing.assert_allclose(impacts(ours), impacts(theirs), rtol=0, atol=1e-7)
    ways = [corners(*each) for each in zip(models, (ours, theirs), strict=True)]
    np.testing.assert_allclose(*ways, atol=1e-8)
    np.testing.assert_allclose(ours.series["energy"], theirs.series["energy"], atol=1e-8)


def test_a_box_tumbles_past_a_pitch_of_90_degrees() -> None:
    """By quaternions in axes whose pitch goes there, and by angles in axes whose pitch stays small."""
    axes = np.array([[0, 1, 0], [0, 0, 1], [1, 0, 0]]).T  # x along y, y along z, z along x
    upright, thrown_up = Rotation.from_euler("Y", 0.2), ([0.5, -0.2, 1], [0.3, 6, 0.2])
    model, other = box("floating"), box("free", axes)
    ours = fall(model, thrown(model, [0, 0, 1], upright, *thrown_up), 2)
    theirs = fall(other, thrown(other, [0, 0, 1], upright * Rotation.from_matrix(axes), *thrown_up), 2)
    assert ours.is_right is theirs.is_right is True
    rotation = evaluate(model, "rotation", ours.q)["rotation"][:, model.frames.index("b.body")]
    assert np.abs(rotation[:, 2, 0]).max() > 0.98  # the sine of the pitch
    assert seen(ours) == seen(theirs)
    one, two = impacts(ours)[:, :3], impacts(theirs)[:, :3]
    np.testing.assert_allclose(one, two, rtol=0, atol=1e-7)
    np.testing.assert_allclose(corners(model, ours), corners(other, theirs), atol=1e-8)
    # at rest on a face
    assert np.abs(ours.qd[-1]).max() < 1e-9
    heights = np.sort(corners(model, ours)[-1, :, 2])
    np.testing.assert_allclose(heights, [0] * 4 + [0.2] * 4, atol=1e-9)
    assert {"falling"} == {check.rule for check in ours.checks if check.name == "energy"}


def test_a_box_rocks_on_its_end_as_a_block_in_the_plane() -> None:
    """About a pitch of 90 degrees, where a body that is free by angles goes nowhere: as Housner's block does."""
    lean, width, height = 0.1, HALF[2], HALF[0]
    feet = [Contact(name, f"b.{name}", type="point_line", friction=1) for name in "lr"]
    c, s = math.cos(lean), math.sin(lean)
    plane = of("b", block(width, height, MASS), [0, 0, -G])
    flat = move(plane, [0, s * width + c * height, lean], [0, 0, 0], 1, feet, count=41)
    turn, still = Rotation.from_euler("Y", math.pi / 2 + lean), [0, 0, 0]
    start = [0, 0, s * width + c * height], turn, still, still
    floating, free = (box(kind) for kind in ("floating", "free"))
    ours = fall(floating, thrown(floating, *start), 1, restitution=0, friction=1)
    assert ours.is_right is flat.is_right is True
    hits = [sorted({round(t, 8) for t in impacts_of(motion)}) for motion in (ours, flat)]
    assert len(hits[1]) > 3
    np.testing.assert_allclose(hits[0][:4], hits[1][:4], atol=1e-7)
    np.testing.assert_allclose(ours.q[:, [0, 2]], flat.q[:, :2], atol=1e-8)
    theirs = fall(free, thrown(free, *start), 1, restitution=0, friction=1)
    assert theirs.status == "failed"


def test_a_throw_that_is_turned_about_the_vertical_is_turned() -> None:
    """Every corner comes down when and as hard as before, wherever the box looks."""
    model, about = box("floating"), Rotation.from_euler("Z", 2.0)
    turn, v, w = Rotation.from_euler("ZYX", (0.1, 0.7, 0.3)), [0.5, 0.2, 0.3], [2, 6, 0.5]
    ours = fall(model, thrown(model, [0, 0, 1], turn, v, w), 1.5)
    turned = fall(model, thrown(model, [0, 0, 1], about * turn, about.apply(v), about.apply(w)), 1.5)
    np.testing.assert_allclose(impacts(ours)[:8], impacts(turned)[:8], rtol=0, atol=1e-7)
    np.testing.assert_allclose(about.apply(corners(model, ours).reshape(-1, 3)),
                               corners(model, turned).reshape(-1, 3), atol=1e-6)  # fmt: skip


def test_a_box_slides_to_a_stop() -> None:
    """After v / (mu g), at v^2 / (2 mu g), whatever axes its velocity is in."""
    model, turn, mu = box("floating"), Rotation.from_euler("Z", 0.7), 0.3
    motion = fall(model, thrown(model, [0, 0, 0.1], turn, [3, 1, 0], [0, 0, 0]), 1.5, friction=mu, restitution=0)
    speed = math.hypot(3, 1)
    assert {event.kind for event in motion.events} == {"stick"}
    np.testing.assert_allclose([event.t for event in motion.events], speed / (mu * G), atol=1e-9)
    way = speed / (2 * mu * G)
    np.testing.assert_allclose(motion.q[-1, :3], [3 * way, way, 0.1], atol=1e-9)
    assert motion.is_right


def top(joint: Plain) -> Model:
    """A rod whose end is held 0.4 m above the floor, with a disc at its tip, 0.5 m away."""
    body = {"name": "body", "parent": "base", "mass": 1, "com": [0, 0, -0.5],
            "inertia": {"xx": 0.02, "yy": 0.02, "zz": 0.03},
            "joint": {"placement": {"position": [0, 0, 0.4]}, **joint}}  # fmt: skip
    ports = [{"name": "tip", "body": "body", "position": [0, 0, -0.5]}]
    return of("b", {"name": "top", "bodies": [body], "ports": ports}, [0, 0, -G])


def test_a_pendulum_on_a_ball_hits_the_floor_as_on_an_axis() -> None:
    floor = [Contact("floor", "b.tip", restitution=0.5)]
    hinge = {"type": "revolute", "axis": [0, 1, 0], "coordinate": "a"}
    swings = move(top(hinge), [-1.5], [0], 3, floor)
    turns = move(top({"type": "ball"}), [math.cos(0.75), 0, -math.sin(0.75), 0], [0, 0, 0], 3, floor)
    assert turns.is_right is swings.is_right is True
    assert seen(turns) == seen(swings)
    assert [event.t for event in turns.events] == pytest.approx([event.t for event in swings.events], abs=1e-9)
    hit = turns.events[0]
    assert hit.after is not None
    assert hit.after[1] == pytest.approx(-hit.qd / 2, abs=1e-12)
    np.testing.assert_allclose(turns.qd, np.outer(swings.qd[:, 0], [0, 1, 0]), atol=1e-8)


def test_a_floor_does_not_turn_a_spinning_top_about_the_vertical() -> None:
    """Without friction L_z stays through impacts; with friction on its tip the top comes to rest."""
    model, turn = top({"type": "ball"}), Rotation.from_euler("Y", -1.2)
    q, w = turn.as_quat(scalar_first=True), turn.inv().apply([0, 0, 3]) + np.array([0, 0, 4])
    smooth = move(model, q, w, 2, [Contact("floor", "b.tip", restitution=0.6)])
    assert smooth.is_right
    assert len(impacts_of(smooth)) > 2
    # about the point that is held
    angular = evaluate(model, "momentum", smooth.q, smooth.qd)["momentum"]["angular"]
    np.testing.assert_allclose(angular[:, 2], angular[0, 2], rtol=1e-8)
    rough = move(model, q, w, 6, [Contact("floor", "b.tip", friction=0.5)])
    assert rough.is_right
    assert ("floor", "stick") in seen(rough)


def hopper(kind: str) -> Model:
    """A hull on a leg that slides, with a spring and a damper, and has a foot with four corners."""
    leg = {"type": "prismatic", "axis": [0, 0, 1], "coordinate": "leg", "stiffness": 400, "damping": 20, **PLACED}
    bodies = [
        {"name": "hull", "parent": "base", "mass": 4, "inertia": {"xx": 0.1, "yy": 0.2, "zz": 0.2},
         "joint": joint_of(kind)},
        {"name": "foot", "parent": "hull", "mass": 1, "com": [0, 0, -0.4],
         "inertia": {"xx": 0.01, "yy": 0.01, "zz": 0.02}, "joint": leg},
    ]  # fmt: skip
    corners = {f"f{i}{j}": [0.4 * i - 0.2, 0.4 * j - 0.2, -0.5] for i in (0, 1) for j in (0, 1)}
    ports = [{"name": name, "body": "foot", "position": place} for name, place in corners.items()]
    return of("b", {"name": "hopper", "bodies": bodies, "ports": ports}, [0, 0, -G])


def test_a_floating_base_lands_on_its_foot() -> None:
    """As on a base by angles; then it stands, and the floor carries its weight."""
    feet = [Contact(name, f"b.{name}", friction=0.8) for name in ("f00", "f01", "f10", "f11")]
    turn, motions = Rotation.from_euler("ZYX", (0.5, 0.05, 0.02)), []
    for kind, end in (("floating", 4), ("free", 1)):
        model = hopper(kind)
        q, v = thrown(model, [0, 0, 0.6], turn, [0.05, 0, 0], [0, 0.1, 0.1])
        motions.append(move(model, [*q, 0], [*v, 0], end, feet, count=4 * end + 1))
    ours, theirs = motions
    assert ours.is_right is theirs.is_right is True
    # then it rocks ever faster until it stands
    assert seen(ours)[:50] == seen(theirs)[:50]
    assert [e.t for e in ours.events[:50]] == pytest.approx([e.t for e in theirs.events[:50]], abs=1e-8)
    np.testing.assert_allclose(ours.q[:5, :3], theirs.q[:, :3], atol=1e-7)
    assert np.abs(ours.qd[-1]).max() < 1e-4
    assert ours.q[-1, -1] == pytest.approx(4 * G / 400, abs=1e-5)
    assert ours.series["contact_forces"][-1, :, 0].sum() == pytest.approx(5 * G, rel=1e-4)


@pytest.mark.parametrize(("seed", "end"), [(5, 1.2), (12, 1.1)])
def test_a_hull_on_two_legs_rocks_on_its_feet(seed: int, end: float) -> None:
    """Two feet on each leg, whose velocities across it are one; slips that hardly begin are stiff."""
    legs = [
        {"name": name, "parent": "hull", "mass": 0.5, "com": [0, 0, -0.2],
         "inertia": {"xx": 0.01, "yy": 0.01, "zz": 0.002},
         "joint": {"type": "revolute", "axis": [0, 1, 0], "coordinate": f"q{name}", "damping": 0.5 * (seed % 2),
                   "placement": {"position": [0, side, 0]}}}
        for name, side in (("l", 0.15), ("r", -0.15))
    ]  # fmt: skip
    hull = {"name": "hull", "parent": "base", "mass": 4, "inertia": {"xx": 0.1, "yy": 0.08, "zz": 0.12},
            "joint": joint_of("floating")}  # fmt: skip
    feet = {f"{leg}{end}": (leg, x) for leg in "lr" for end, x in (("f", 0.05), ("b", -0.05))}
    ports = [{"name": name, "body": leg, "position": [x, 0, -0.4]} for name, (leg, x) in feet.items()]
    model, rng = (
        of("b", {"name": "hull", "bodies": [hull, *legs], "ports": ports}, [0, 0, -G]),
        np.random.default_rng(seed),
    )
    turn = Rotation.from_rotvec(rng.normal(size=3) * 0.2).as_quat(scalar_first=True)
    q, qd = [0, 0, 0.55, *turn, *rng.normal(size=2) * 0.2], rng.normal(size=8) * 0.3
    floor = [Contact(name, f"b.{name}", restitution=float(rng.choice([0, 0.3])), friction=0.3) for name in feet]
    motion = simulate(
        model,
        q,
        (0, end),
        qd=qd,
        kind=TreeMotion(contacts=floor),
        integrator=Integrator(method="Radau", max_steps=5000),
    )
    assert (motion.status, motion.is_right) == ("finished", True)
    assert {event.kind for event in motion.events} == {"impact", "lift_off", "stick", "slip"}


#: legs of a quadruped: port of the trunk, side, front
LEGS = {
    "fl": ("front_left", 1, 1),
    "fr": ("front_right", -1, 1),
    "rl": ("rear_left", 1, -1),
    "rr": ("rear_right", -1, -1),
}


def test_a_quadruped_lands_and_stands() -> None:
    """Of the catalogue, with its legs held by springs and dampers: its floor carries its weight."""
    trunk, leg = derive("quadruped-trunk-floating"), derive("quadruped-leg")
    instances = [
        {"name": name, "substructure": "leg", "at": f"t.{port}", "parameters": {"side": side, "front": front}}
        for name, (port, side, front) in LEGS.items()
    ]
    tree = {"name": "q", "gravity": [0, 0, -G], "instances": [{"name": "t", "substructure": "trunk"}, *instances]}
    model = couple(tree, {"t": trunk, **dict.fromkeys(LEGS, leg)})
    bent = np.array([0, 0.7, -1.4] * 4)
    hold = {
        f"tau.{name}": f"-150*({name} - ({angle})) - 10*{name}'"
        for name, angle in zip(model.positions[7:], bent.tolist(), strict=True)
    }
    feet = [Contact(name, f"{name}.toe", friction=0.7) for name in LEGS]
    start = [0, 0, 0.35, *Rotation.from_euler("ZYX", (0.5, 0.02, 0.02)).as_quat(scalar_first=True), *bent]
    motion = simulate(model, start, (0, 1), inputs=hold, kind=TreeMotion(contacts=feet), outputs=Outputs(count=5))
    assert (motion.status, motion.is_right) == ("finished", True)
    assert {event.name for event in motion.events if event.kind == "impact"} == set(LEGS)
    assert np.abs(motion.qd[-1]).max() < 1e-3
    # the metric of the velocities of the base is its mass
    weight = G * evaluate(model, "metric", start)["metric"][0, 0]
    assert motion.series["contact_forces"][-1, :, 0].sum() == pytest.approx(weight, rel=1e-3)


@pytest.mark.parametrize("seed", [1, 7])
def test_rows_and_what_rates_make_of_them_are_slopes(seed: int) -> None:
    """Rows against differences of the gap, and the bias against those of velocities, by displacements of bodies."""
    definition, rng = random_balls(seed)
    tree = {"name": "t", "gravity": [0, 0, -G], "instances": [{"name": "x", "substructure": "d"}]}
    model = couple(tree, {"x": derive(definition)})
    values = {s.name: 0.7 for s in model.program.symbols if s.kind == "parameter"}
    bodies = [name for name in model.frames if name.startswith("x.b")]
    program = contact_rows(model, [Contact("c", bodies[-1]), Contact("d", bodies[-1], plane=bodies[0])])
    q, v, h = random_position(rng, model), rng.uniform(-1, 1, model.dof), 1e-6
    values |= {f"{name}'": x for name, x in zip(model.coordinates, v, strict=True)}

    def at(by: Array) -> Plain:
        """What is seen where bodies are displaced."""
        return interpret(program, values | dict(zip(model.positions, displaced(model, q, by), strict=True)))

    here = at(np.zeros(model.dof))
    for a, step in enumerate(h * np.eye(model.dof)):
        slope = (at(step)["gap"] - at(-step)["gap"]) / (2 * h)
        np.testing.assert_allclose(here["rows"][:, 0, a], slope, atol=1e-7)
    change = (at(h * v)["rows"] - at(-h * v)["rows"]) @ v / (2 * h)
    np.testing.assert_allclose(here["bias"], change, atol=1e-6)


@pytest.mark.skipif(not target.available(), reason="machine code cannot be made, or is not wanted")
@pytest.mark.parametrize("modes", [(OPEN, OPEN), (STICK, OPEN), (SLIP, OPEN), (STICK, SLIP)])
def test_steps_are_machine_code(modes: tuple[int, int]) -> None:
    """x' with its changes of quaternions, power and forces, as in Python."""
    model, rng = box("floating"), np.random.default_rng(2)
    feet = [Contact(name, f"b.{name}", friction=0.3) for name in CORNERS[:2]]
    turn = Rotation.random(random_state=3).as_quat(scalar_first=True)
    q, v = [0.1, 0.2, 0.3, *turn], rng.uniform(-1, 1, 6)
    x = np.array([*q, *v, 0.0])
    conditions = read_conditions(model, Start(q), (0, 1), ["metric", "bias", "forces"])
    f = DecidedContacts(model, conditions.values, conditions.zero, conditions, feet)
    f.begin()
    f.look(0.0, x)
    f.modes[:, 0], f.modes[:, 1], f.modes[:, 3] = modes, 1, f.yields(np.arange(2))
    rates = f.compiled()
    assert rates is not None
    found = CompiledRun(TABLEAUX["RK23"], rates, (1.0, 1.0)).rates(0.0, x)
    second, _, power = ContactMotion.evaluate(f, 0.0, x)
    np.testing.assert_allclose(found[7:], [*second, power], rtol=1e-10, atol=1e-10 * np.abs(second).max())
    wanted = evaluate(model, "position_rates", q, v)["position_rates"]
    np.testing.assert_allclose(found[:7], wanted, atol=1e-13)
    np.testing.assert_allclose(f(0.0, x), found, rtol=1e-10, atol=1e-10 * np.abs(second).max())


def test_what_a_contact_waits_for_names_positions() -> None:
    """A coordinate that is a rate alone has no value of its own."""
    model, still = box("floating"), [0, 0, 0]
    given = thrown(model, [0, 0, 0.5], Rotation.identity(), still, still)
    through = fall(model, given, 0.5, when="b.r_body_x > 1")
    assert not impacts_of(through)
    stopped = fall(model, given, 0.5, when="b.q_body_w > 0.5")
    assert impacts_of(stopped)
    with pytest.raises(InvalidInput, match=r"did you mean 'b\.v_body_x''"):
        fall(model, given, 0.5, when="b.v_body_x > 0")


def test_a_tree_may_have_both() -> None:
    """As a motion to which the contacts are given."""
    body = {"name": "body", "parent": "base", "joint": {"type": "floating"}, "mass": 2,
            "inertia": {"xx": 1, "yy": 2, "zz": 3}}  # fmt: skip
    floor = {"name": "floor", "point": "b.body", "restitution": "0.8"}
    model = of("b", {"name": "ball", "bodies": [body]}, [0, 0, -G], contacts=[floor])
    found = simulate(model, [0, 0, 1, 1, 0, 0, 0], (0, 2), qd=[0, 0, 0, 1, 2, 3], outputs=Outputs(count=5))
    plain = of("b", {"name": "ball", "bodies": [body]}, [0, 0, -G])
    given = TreeMotion(contacts=[Contact("floor", "b.body", restitution=0.8)])
    same = simulate(plain, [0, 0, 1, 1, 0, 0, 0], (0, 2), qd=[0, 0, 0, 1, 2, 3], kind=given, outputs=Outputs(count=5))
    assert found.is_right
    np.testing.assert_array_equal(found.q, same.q)


def test_a_singular_metric_at_an_impact_is_told(monkeypatch: pytest.MonkeyPatch) -> None:
    def decided(*_: Any) -> None:
        raise np.linalg.LinAlgError

    monkeypatch.setattr(DecidedContacts, "decided", decided)
    motion = move(of("b", BALL, [0, 0, -G]), [1], [0], 1, [Contact("floor", "b.body")])
    assert (motion.status, motion.is_right) == ("failed", None)
    assert "'ball' and 'floating' go on" in motion.message


@pytest.mark.parametrize("name", [*ANALYSES, *QUANTITIES])
def test_what_takes_both_takes_them_together(monkeypatch: pytest.MonkeyPatch, name: str) -> None:
    """Each analysis, and each formula of analyses, of the table of what goes together."""
    trees = tied_combinations.TREES
    both = {**trees["balls"], "contacts": trees["contacts"]["contacts"]}
    monkeypatch.setitem(trees, "balls that touch", both)
    if name != "reduced-equations":
        alone = {kind: tied_combinations.refusal(name, kind) for kind in ("balls", "contacts")}
        assert tied_combinations.refusal(name, "balls that touch") == (alone["balls"] or alone["contacts"])
