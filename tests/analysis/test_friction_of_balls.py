"""Joints with friction that stick or are loaded, on bodies that turn by quaternions: beside angles, in closed form."""

from __future__ import annotations

from itertools import product
from typing import Any

import numpy as np
import pytest
from random_trees import Plain, model_of, tree_of
from simulated import simulated

from substructures import (
    Definition,
    Event,
    Fault,
    InvalidDocument,
    InvalidInput,
    Model,
    Outputs,
    TreeMotion,
    couple,
    derive,
    simulate,
    simulate_ensemble,
)
from substructures.analysis.motion.conditions import read_conditions
from substructures.analysis.motion.friction.dry_friction import DryMotion, friction_laws
from substructures.analysis.motion.integrators.tableaux import TABLEAUX
from substructures.analysis.motion.problems.start import Start
from substructures.analysis.motion.right_hand_side import RightHandSide
from substructures.analysis.motion.trajectory import Trajectory
from substructures.compile import target
from substructures.compile.motion import CompiledRun
from substructures.quantities.powers import powers
from substructures.quantities.reactions import reactions

#: by angles, and by quaternions
PAIRS = (("spherical", "ball"), ("free", "floating"))
ANGLES = ["yaw", "pitch", "roll"]
#: rates of the body, at rest and without a turn those of the angles, and of the joints behind it
TURNING, BEHIND, SLIDING = [0.5, 0.3, -0.2], [2.0, 0.3], [0.1, -0.4, 0.2]


def inertia(*sizes: str) -> Plain:
    return dict(zip(("xx", "yy", "zz"), sizes, strict=True)) | {"about": "com"}


def definition(kind: str) -> Plain:
    """A body on a joint of this kind, with an arm and a slide on the arm, both with friction."""
    first: Plain = {"type": kind}
    if kind in dict(PAIRS):
        first["coordinate"] = ["x", "y", "z", *ANGLES][-3 if kind == "spherical" else -6 :]
    bearing = {"coefficient": "0.2", "radius": "0.05", "axial_radius": "0.02"}
    arm = {"coulomb": "0.3", "static": "0.5", "stribeck": "0.1", "velocity": "0.01", "load": bearing}
    slide = {"coulomb": "0.4", "velocity": "0.01", "load": {"coefficient": "0.1"}}
    turn = {"type": "revolute", "coordinate": "q", "d": "0.2", "theta": "0.4", "friction": arm}
    move = {"type": "prismatic", "coordinate": "s", "d": "0.2", "theta": "0.6", "friction": slide, "stiffness": 60}
    thin = inertia("0.02", "0.03", "0.04")
    return {
        "name": "a",
        "bodies": [
            {"name": "b", "parent": "base", "mass": 3, "com": ["0.1", 0, "-0.2"], "joint": first,
             "inertia": inertia("0.2", "0.3", "0.25")},
            {"name": "arm", "parent": "b", "mass": 1, "com": ["0.3", 0, 0], "joint": turn, "inertia": thin},
            {"name": "slide", "parent": "arm", "mass": 1, "joint": move, "inertia": thin},
        ],
    }  # fmt: skip


def start(kind: str) -> tuple[list[float], list[float]]:
    """The same state by angles and by quaternions."""
    place = [0.0] * 3 if kind in PAIRS[1] else []
    sliding = SLIDING if place else []
    if kind in dict(PAIRS):
        return [*place, 0, 0, 0, 0.3, 0.1], [*sliding, *TURNING[::-1], *BEHIND]
    return [*place, 1, 0, 0, 0, 0.3, 0.1], [*sliding, *TURNING, *BEHIND]


def moved(kind: str, friction: str, end: float, **more: Any) -> Trajectory:
    tree, parts = tree_of(definition(kind), (0, 0, -9)), {"x": derive(Definition.read(definition(kind)))}
    q, qd = start(kind)
    bearings = {"bearings": reactions(tree, parts)} if friction == "loaded" else {}
    more |= {"qd": qd, "friction": friction, "count": 31, "powers": powers(tree, parts)}
    return simulated(couple(tree, parts), q, (0, end), **bearings, **more)


@pytest.mark.parametrize(("friction", "kinds"), [*product(("exact", "loaded"), PAIRS)])
def test_joints_rub_as_on_angles(friction: str, kinds: tuple[str, str]) -> None:
    """States, forces, energies, and when joints stick and slip; the energy that is lost is work of friction."""
    theirs, ours = (moved(kind, friction, 2 if friction == "exact" else 0.5) for kind in kinds)
    assert theirs.is_right is ours.is_right is True, ours.checks
    assert [(e.name, e.kind) for e in ours.events] == [(e.name, e.kind) for e in theirs.events]
    assert bool(ours.events) is (friction == "exact")
    np.testing.assert_allclose([e.t for e in ours.events], [e.t for e in theirs.events], rtol=0, atol=1e-8)
    for event, like in zip(ours.events, theirs.events, strict=True):
        np.testing.assert_allclose(event.q[-2:], like.q[-2:], atol=1e-8)
        np.testing.assert_allclose(event.qd[-2:], like.qd[-2:], atol=1e-8)
        assert (len(event.q), len(event.qd)) == (len(ours.positions), len(ours.coordinates))
    np.testing.assert_allclose(ours.q[:, -2:], theirs.q[:, -2:], rtol=0, atol=1e-8)
    np.testing.assert_allclose(ours.qd[:, -2:], theirs.qd[:, -2:], rtol=0, atol=1e-8)
    np.testing.assert_allclose(ours.series["energy"], theirs.series["energy"], rtol=1e-8)
    np.testing.assert_allclose(ours.series["work"], theirs.series["work"], rtol=1e-8, atol=1e-9)
    np.testing.assert_allclose(ours.series["friction"][:, -2:], theirs.series["friction"][:, -2:], rtol=0, atol=1e-6)
    np.testing.assert_allclose(ours.series["work"], ours.series["energy"] - ours.series["energy"][0], atol=1e-9)
    assert ours.series["work"][-1] < -0.2
    assert {"energy-balance", "quaternions", "power"} < {check.name for check in ours.checks}


def wheel() -> Model:
    """A wheel about the y axis of a hull that flies, held by 0.3 N m."""
    friction = {"coulomb": "0.3", "velocity": "0.001"}
    joint = {"type": "revolute", "coordinate": "spin", "friction": friction, "axis": [0, 1, 0]}
    return model_of(
        {
            "name": "a",
            "bodies": [
                {"name": "hull", "parent": "base", "mass": 1, "joint": {"type": "floating"},
                 "inertia": inertia("1", "2", "3")},
                {"name": "wheel", "parent": "hull", "inertia": inertia("0.3", "0.5", "0.3"),
                 "joint": joint | {"placement": {"position": [0, 0, 0]}}},
            ],
        },
        (0, 0, 0),
    )  # fmt: skip


AT_REST = [0, 0, 0, 1, 0, 0, 0, 0]


def test_a_wheel_turns_its_hull_past_a_pitch_of_90_degrees() -> None:
    """J w' = F of the hull, the rate of the wheel falls by F (1/J + 1/J_w), from then on both turn as one."""
    nu, J, J_w, F = 6.0, 2.0, 0.5, 0.3  # noqa: N806 -- inertias
    found = simulate(
        wheel(), AT_REST, (0, 12), qd=[0, 0, 0, 0, 0, 0, nu], kind=TreeMotion("exact"), outputs=Outputs(count=25)
    )
    assert found.is_right, found.checks
    (stop,) = found.events
    end = nu / (F * (1 / J + 1 / J_w))
    assert (stop.name, stop.kind) == ("x.spin", "stick")
    np.testing.assert_allclose(stop.t, end, atol=1e-9)
    slipping, sticking = np.minimum(found.t, end), np.maximum(found.t - end, 0)
    turned = F / J * (slipping**2 / 2 + end * sticking)
    assert turned[-1] > np.pi / 2
    np.testing.assert_allclose(found.q[:, [3, 5]], np.transpose([np.cos(turned / 2), np.sin(turned / 2)]), atol=1e-9)
    assert not found.qd[found.t > end, -1].any()
    np.testing.assert_allclose(found.series["work"][-1], F * (F * end**2 * (1 / J + 1 / J_w) / 2 - nu * end), rtol=1e-9)


def test_a_load_on_a_rate_of_a_ball_sticks() -> None:
    """J w' = -F about one axis of the body."""
    body = {"name": "b", "parent": "base", "joint": {"type": "ball"}, "inertia": inertia("1", "1.5", "2")}
    load = {"type": "friction", "coordinate": "w_b_z", "coulomb": 1, "velocity": "0.001"}
    model = model_of({"name": "a", "bodies": [body], "loads": [load]}, (0, 0, 0))
    found = simulated(model, [1, 0, 0, 0], (0, 6), qd=[0, 0, 2], friction="exact", count=7)
    assert found.is_right, found.checks
    assert [(e.name, e.kind, round(e.t, 9)) for e in found.events] == [("x.w_b_z", "stick", 4)]
    np.testing.assert_allclose(found.q[-1], [np.cos(2), 0, 0, np.sin(2)], atol=1e-9)


def test_members_stick_as_they_do_alone() -> None:
    rates = np.zeros((3, 7))
    rates[:, -1] = 2, 4, 0
    kind, model = TreeMotion("exact"), wheel()
    found = simulate_ensemble(model, AT_REST, (0, 3), qd=rates, kind=kind, states=True)
    assert (found.violation <= 1).all()
    assert found.q is not None
    alone = simulate(model, AT_REST, (0, 3), qd=rates[0], kind=kind, outputs=Outputs(count=101))
    np.testing.assert_allclose(found.q[0], alone.q, rtol=0, atol=1e-9)
    assert not found.q[2, :, -1].any()
    assert found.happened is not None
    assert [(each["member"], each["kind"]) for each in found.happened.events] == [(0, "stick")]


def test_a_slide_on_a_ball_is_thrown_back() -> None:
    """An event that acts, then on with what sticks at rest: as on angles."""
    wall = [Event("wall", "x.s - 0.09", direction="falling", reset={"x.s'": "-0.5*x.s'"})]
    theirs, ours = (moved(kind, "exact", 1, events=wall) for kind in PAIRS[0])
    assert theirs.is_right is ours.is_right is True
    assert [(e.name, e.kind) for e in ours.events] == [(e.name, e.kind) for e in theirs.events]
    assert any(e.name == "wall" for e in ours.events)
    np.testing.assert_allclose(ours.q[:, -2:], theirs.q[:, -2:], rtol=0, atol=1e-8)


@pytest.mark.skipif(not target.available(), reason="machine code cannot be made, or is not wanted")
def test_steps_are_machine_code_whoever_sticks() -> None:
    """Rates, accelerations and powers are those of Python."""
    model, (q, qd) = model_of(definition("floating"), (0, 0, -9)), start("floating")
    conditions = read_conditions(model, Start(q, qd), (0, 1), ["metric", "bias", "forces"])
    laws = friction_laws(model, conditions.values)
    dry = DryMotion(RightHandSide(model, conditions.values, conditions.zero, conditions), conditions, laws)
    for ways in product((-1, 0, 1), repeat=2):
        dry.signs = np.array(ways)
        x = np.concatenate([q, qd[:6], np.array([0.4, 0.2]) * dry.signs, [0.0]])
        rates = dry.compiled()
        assert rates is not None
        found = CompiledRun(TABLEAUX["RK23"], rates, (1.0, 1.0)).rates(0.4, x)
        np.testing.assert_allclose(found, dry(0.4, x), rtol=1e-12, atol=1e-12)
        assert not found[-3:-1][dry.signs == 0].any()


def faults_of(make: Any) -> list[Fault]:
    with pytest.raises(InvalidInput) as error:
        make()
    return list(error.value.faults)


def test_friction_is_that_of_joints_with_one_coordinate() -> None:
    """A ball joint has none, a tree without any is told so, and steps of one size stay without."""
    hinged: Plain = {"type": "ball", "friction": {"coulomb": 1, "velocity": "0.1"}}
    bodies = [{"name": "b", "parent": "base", "mass": 1, "joint": hinged, "inertia": inertia("1", "1", "1")}]
    with pytest.raises(InvalidDocument) as error:
        derive(Definition.read({"name": "a", "bodies": bodies}))
    assert [(fault.pointer, fault.code) for fault in error.value.faults] == [("/bodies/0/joint/friction", "no-angles")]
    del hinged["friction"]
    smooth = model_of({"name": "a", "bodies": bodies}, (0, 0, 0))
    (fault,) = faults_of(lambda: simulated(smooth, [1, 0, 0, 0], (0, 1), friction="exact"))
    assert (fault.pointer, fault.code) == ("/friction", "no-friction")
