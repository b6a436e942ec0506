"""Reactions of trees with velocity constraints: what contacts exert, against balances of momentum and by hand."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
from random_trees import Plain
from rolling_bodies import BASE, BLADE, FORWARD, FRONT, REAR, bicycle_part, disc_part, sleigh, sleigh_part

from substructures import ConstrainedMotion, Definition, Model, TreeSpec, couple, derive, simulate
from substructures.analysis.equations.nonholonomic.velocity_constraints import constraints_of
from substructures.analysis.simulate import Outputs
from substructures.errors import InvalidInput, VerificationFailed
from substructures.mechanics.wrench import Wrench
from substructures.quantities import reactions as module
from substructures.quantities.part_models import ReactionModel
from substructures.quantities.reactions import reactions

EDGE = {"name": "blade", "type": "knife_edge", "frame": "s.b"}
FLOOR = {"name": "floor", "type": "rolling", "frame": "s.disc", "radius": "s.r"}
NAMES = ("reaction_force", "reaction_moment", "reaction_force_world", "reaction_moment_world")


def made(part: Plain, constraints: list[Plain], gravity: Any = (0, 0, 0)) -> tuple[Model, ReactionModel]:
    tree = {"name": "t", "gravity": list(gravity), "instances": [{"name": "s", "definition": part}]}
    spec = TreeSpec.read({**tree, "velocity_constraints": constraints})
    parts = {"s": derive(Definition.read(part))}
    return couple(spec, parts), reactions(spec, parts)


def test_a_rolling_disc_is_held_by_the_floor_alone() -> None:
    """No actuator acts on its six coordinates, so their joints transmit nothing: all that moves it comes from the
    contact, m (a - gamma) of the mass centre, at the point where it touches.
    """
    model, transmitted = made(disc_part(), [FLOOR], [0, 0, -9.81])
    q = [0, 0, 0.5 * np.sin(1.2), 0.3, 1.2, 0.1]
    kind = ConstrainedMotion(constraints_of(model), independent=["s.psi", "s.th", "s.ph"], v=[0.4, -0.3, 4])
    motion = simulate(model, q, (0, 0.3), kind=kind, outputs=Outputs(reactions=transmitted))
    assert motion.is_right
    weight = 2 * 9.81
    for name in NAMES:
        assert np.abs(motion.series[name]).max() < 1e-9 * weight
    assert motion.joints == (*model.coordinates, "s.base")
    contact = motion.series["multipliers"][:, 2]
    assert contact.min() > 0.3 * weight
    assert np.ptp(contact) > 1e-3 * weight


def test_wheels_of_a_bicycle_at_rest_carry_its_weight() -> None:
    """Benchmark bicycle upright: moments about the points of contact give the loads of the axles by hand."""
    wheels = [("rear", "s.rear_axle", REAR), ("front", "s.front_axle", FRONT)]
    given = [{"name": name, "type": "rolling", "frame": frame, "radius": r} for name, frame, r in wheels]
    model, transmitted = made(bicycle_part(), given, [0, 0, -9.81])
    kind = ConstrainedMotion(constraints_of(model), independent=["s.lean", "s.steer", "s.rear"])
    outputs = Outputs(reactions=transmitted.of(["s.rear", "s.front", "s.base"]))
    motion = simulate(model, [0, 0, REAR, 0, 0, 0, 0, 0, 0], (0, 1e-3), kind=kind, outputs=outputs)
    whole, front = 94, (85 * 0.3 + 4 * 0.9 + 3 * BASE) / BASE
    loads = motion.series["reaction_force_world"][0, :, 2]
    # the frame presses the wheels down, and the ground holds the rest of them
    np.testing.assert_allclose(loads, [-9.81 * (whole - front - 2), -9.81 * (front - 3), 0], atol=1e-9)


def test_an_edge_pushes_the_sleigh_across() -> None:
    """lambda = m (v w + a w') at the edge, and neither slide nor hinge transmits anything in the plane."""
    model, transmitted = made(sleigh_part(), [EDGE])
    kind = ConstrainedMotion(constraints_of(model), velocities=FORWARD, v={"u": 2, "w": 1})
    motion = simulate(model, [0, 0, 0.4], (0, 1), kind=kind, outputs=Outputs(reactions=transmitted))
    assert max(np.abs(motion.series[name]).max() for name in NAMES) < 1e-12
    m, a, inertia = 2, 0.25, 0.3
    u, w = motion.series["v"].T
    turning = -m * a * u * w / (inertia + m * a * a)
    np.testing.assert_allclose(motion.series["multipliers"][:, 0], m * (u * w + a * turning), rtol=1e-12)


def test_linear_constraints_act_in_joints() -> None:
    """The same edge as an expression: the slides give what the blade would, at the origin of the body."""
    texts = {"name": "edge", "type": "linear", "expression": "cos(s.f)*s.y' - sin(s.f)*s.x'"}
    model, transmitted = made(sleigh_part(), [texts])
    start: dict[str, Any] = {"kind": ConstrainedMotion(constraints_of(model), velocities=FORWARD, v={"u": 2, "w": 1})}
    motion = simulate(model, [0, 0, 0.4], (0, 1), **start, outputs=Outputs(reactions=transmitted))
    force = motion.series["reaction_force_world"][:, motion.joints.index("s.f")]
    across = np.stack([-np.sin(motion.q[:, 2]), np.cos(motion.q[:, 2])], axis=1)
    np.testing.assert_allclose(force[:, :2], motion.series["multipliers"] * across, atol=1e-12)


def test_faults() -> None:
    with pytest.raises(InvalidInput) as caught:
        made(sleigh_part(), [EDGE, {**EDGE, "name": "b", "frame": "s.c"}])
    assert caught.value.faults[0].pointer == "/velocity_constraints/1/frame"
    _, transmitted = made(sleigh_part(), [EDGE])
    kind = ConstrainedMotion([BLADE])
    with pytest.raises(InvalidInput, match="part of the tree"):
        simulate(sleigh(), [0, 0, 0], (0, 1), kind=kind, outputs=Outputs(reactions=transmitted))


@pytest.mark.parametrize("shape", ["disc", "sphere", "edge"])
def test_the_certificate_finds_planted_faults(shape: str, monkeypatch: pytest.MonkeyPatch) -> None:
    given = {**FLOOR, "shape": shape, "normal": [0, 1, 2]} if shape != "edge" else {**EDGE, "frame": "s.disc"}
    made(disc_part(), [given])
    right = module.applied_wrenches

    def wrong(*args: Any) -> Any:
        for part, carrier, wrench in right(*args):
            x, y, z = wrench.f
            yield part, carrier, Wrench((x, z, y), wrench.n)

    monkeypatch.setattr(module, "applied_wrenches", wrong)
    with pytest.raises(VerificationFailed, match="reactions"):
        made(disc_part(), [given])
