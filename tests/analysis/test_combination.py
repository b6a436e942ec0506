"""All at once: a hand with relations on an arm on a floating base that rolls on a wheel, with a rod that closes a loop.

It is derived, coupled and certified as every tree is; its motion is compared with the equations with multipliers of
the tree that has none of its ties, in numbers.
"""

from __future__ import annotations

from typing import Any

import numpy as np
from closed_trees import tree_model
from random_trees import Plain

from substructures import Model, sensitivities, simulate, simulate_ensemble
from substructures.analysis.equations.nonholonomic.independent_rows import check_constraints
from substructures.analysis.equations.nonholonomic.quasi_velocities import quasi_velocity_equations
from substructures.analysis.equations.nonholonomic.solved import solved
from substructures.analysis.motion.problems.output_times import OutputGrid
from substructures.analysis.motion.problems.outputs import SensitivityOutputs
from substructures.analysis.simulate import Outputs
from substructures.expr.interpret import interpret
from substructures.quantities.numbers.evaluation import evaluate

RADIUS = 0.4
ROUND = dict.fromkeys(("xx", "yy", "zz"), 0.05)
FLOOR = {"name": "floor", "type": "rolling", "frame": "base.axle", "radius": RADIUS}
ROD = {"name": "rod", "type": "rod", "from": "arm.tip", "to": "base.eye", "length": 1}
TORQUE = {"tau.base.w": "0.5*cos(3*t)", "tau.arm.q1": "2", "tau.hand.left": "0.1"}


def hinge(coordinate: str, place: list[float], axis: list[int]) -> Plain:
    return {"type": "revolute", "coordinate": coordinate, "axis": axis, "placement": {"position": place}}


def body(name: str, parent: str, joint: Plain, mass: Any, com: list[float]) -> Plain:
    return {"name": name, "parent": parent, "joint": joint, "mass": mass, "com": com, "inertia": ROUND}


def slide(coordinate: str, axis: list[int]) -> Plain:
    return {"type": "prismatic", "coordinate": coordinate, "axis": axis, "placement": {"position": [0, 0, 0]}}


FREE = {"type": "free", "coordinate": ["x", "y", "z", "a", "b", "c"], "placement": {}}
BASE: Plain = {
    "name": "base",
    "bodies": [
        body("hull", "base", FREE, 6, [0, 0, 0.1]),
        body("wheel", "hull", hinge("w", [0, 0, 0], [0, 1, 0]), 2, [0, 0, 0]),
    ],
    "ports": [
        {"name": "axle", "body": "wheel", "rotation": {"rpy": ["-pi/2", 0, 0]}},
        {"name": "deck", "body": "hull", "position": [0, 0, 0.3]},
        {"name": "eye", "body": "hull", "position": [1, 0, 0.3]},
    ],
}
ARM: Plain = {
    "name": "arm",
    "parameters": {"m": {"value": 1.5, "unit": "kg"}},
    "bodies": [
        body("upper", "base", hinge("q1", [0, 0, 0], [0, -1, 0]), "m", [0.5, 0, 0]),
        body("lower", "upper", hinge("q2", [1, 0, 0], [0, -1, 0]), 1, [0.5, 0, 0]),
        body("wrist", "lower", hinge("q3", [1, 0, 0], [1, 0, 0]), 0.4, [0, 0, 0.05]),
    ],
    "ports": [
        {"name": "tip", "body": "lower", "position": [1, 0, 0]},
        {"name": "flange", "body": "wrist", "position": [0.1, 0, 0]},
    ],
}
HAND: Plain = {
    "name": "hand",
    "bodies": [
        body("l", "base", slide("left", [0, 1, 0]), 0.2, [0.05, 0.02, 0]),
        body("r", "base", slide("right", [0, 1, 0]), 0.2, [0.05, -0.02, 0]),
        body("cam", "base", hinge("cam", [0, 0, 0], [1, 0, 0]), 0.1, [0, 0, 0]),
    ],
    "relations": [
        {"coordinate": "right", "of": "left", "multiplier": -1},
        {"coordinate": "cam", "of": "right", "multiplier": 20, "offset": 0.1},
    ],
}
PARTS = {"base": BASE, "arm": ARM, "hand": HAND}
TREE: Plain = {
    "gravity": [0, 0, -9.81],
    "instances": [
        {"name": "base", "substructure": "base"},
        {"name": "arm", "substructure": "arm", "at": "base.deck"},
        {"name": "hand", "substructure": "hand", "at": "arm.flange"},
    ],
}
COORDINATES = [*(f"base.{c}" for c in ("x", "y", "z", "a", "b", "c", "w")), "arm.q1", "arm.q2", "arm.q3", "hand.left"]
START = {"base.z": RADIUS, "arm.q2": np.pi / 2, "arm.q3": 0.3, "hand.left": 0.02}


def whole(**more: Any) -> Model:
    return tree_model({**TREE, "closures": [ROD], "velocity_constraints": [FLOOR], **more}, PARTS)


def start(model: Model) -> list[float]:
    return [START.get(name, 0.0) for name in model.coordinates]


def multiplied(q: Any, qd: Any, t: float, driven: Plain | None = None) -> Any:
    """q'' by [g B^T; B 0] of the tree without its ties: columns of velocities of frames, and their changes by
    differences along the motion; ``driven``: accelerations that are given, by coordinate.
    """
    free, inputs = tree_model(TREE, PARTS), {"tau.base.w": 0.5 * np.cos(3 * t), "tau.arm.q1": 2, "tau.hand.left": 0.1}
    given = driven or {}

    def rows(at: Any) -> Any:
        """B: what slips at the foot of the wheel, and the length of the rod."""
        found = evaluate(free, "kinematics", at)["kinematics"]
        frames = {name: k for k, name in enumerate(free.frames)}
        k, tip, eye = (frames[name] for name in ("base.axle", "arm.tip", "base.eye"))
        turn, axis = found["rotation"][k], found["rotation"][k] @ [0, 0, 1]
        down = np.array([0, 0, 1]) - axis[2] * axis
        down = -RADIUS * down / np.linalg.norm(down)
        foot = [turn @ U + np.cross(turn @ w, down) for U, w in zip(found["U"][k], found["Omega"][k], strict=True)]
        apart = found["position"][tip] - found["position"][eye]
        ends = [(found["rotation"][f] @ found["U"][f].T).T for f in (tip, eye)]
        return np.vstack([np.array(foot).T, (ends[0] - ends[1]) @ apart])

    h, found = 1e-6, evaluate(free, ["metric", "bias", "forces"], q, qd, inputs=inputs)
    held, change = rows(q), (rows(q + h * qd) - rows(q - h * qd)) / (2 * h)
    assert np.abs(held @ qd).max() < 1e-8
    units = np.eye(free.dof)[[free.coordinates.index(name) for name in given]]
    B, right = np.vstack([held, units]), np.append(-change @ qd, list(given.values()))  # noqa: N806
    n, m = free.dof, len(B)
    left = np.block([[found["metric"], B.T], [B, np.zeros((m, m))]])
    return np.linalg.solve(left, np.concatenate([found["forces"] - found["bias"], right]))[:n]


def own_accelerations(model: Model, q: Any, qd: Any, t: float) -> Any:
    """q'' by the equations in independent velocities, whose q' are those of the motion."""
    near = dict(zip(model.coordinates, q.tolist(), strict=True))
    equations = quasi_velocity_equations(model, near=near | {"t": t})
    rates = dict(zip((f"{name}'" for name in model.coordinates), qd, strict=True))
    values = dict.fromkeys(model.input_names, 0.0) | near | {name: rates[name] for name in equations.velocities}
    values |= {"arm.m": 1.5, "t": t, "tau.base.w": 0.5 * np.cos(3 * t), "tau.arm.q1": 2, "tau.hand.left": 0.1}
    own = interpret(solved(equations), values)
    np.testing.assert_allclose(own["rates"], qd, atol=1e-8)
    return own["second"]


def test_it_moves_as_with_multipliers() -> None:
    model = whole()
    check_constraints(model)
    assert list(model.coordinates) == COORDINATES
    found = simulate(model, start(model), (0, 0.4), inputs=TORQUE, outputs=Outputs(count=5))
    assert (found.status, found.is_right) == ("finished", True), found.checks
    assert {"energy", "constraints", "gaps"} <= {check.name for check in found.checks}
    assert np.ptp(found.q, axis=0).max() > 0.1
    for t, q, qd in zip(found.t[1:].tolist(), found.q[1:], found.qd[1:], strict=True):
        expected = multiplied(q, qd, t)
        np.testing.assert_allclose(own_accelerations(model, q, qd, t), expected, atol=1e-6 * np.abs(expected).max())


def test_members_and_derivatives_have_all_of_it() -> None:
    model = whole()
    q, masses = start(model), [1.4, 1.6]
    many = simulate_ensemble(model, q, (0, 0.2), parameters={"arm.m": masses}, grid=OutputGrid(count=3))
    assert many.is_right, many.checks
    assert many.q is not None
    found = sensitivities(model, q, (0, 0.2), ["arm.m"], outputs=SensitivityOutputs(count=3))
    assert found.is_right, found.checks
    slope = (many.q[1, -1] - many.q[0, -1]) / 0.2
    expected = found.series["d.arm.m"][-1][: model.dof]
    np.testing.assert_allclose(slope, expected, atol=1e-2 * np.abs(expected).max())


#: motions with their rates and accelerations at a time
DRIVEN: Plain = {"hand.left": "0.02 + 0.01*sin(t)", "arm.q3": "0.3 + t^2/10"}


def test_driven_it_moves_as_with_multipliers() -> None:
    """Fingers and wrist move as is given; the wheel, the rod and the free base follow."""
    model = whole(driven=DRIVEN)
    check_constraints(model)
    assert list(model.driven) == ["arm.q3", "hand.left"]
    torques = {name: x for name, x in TORQUE.items() if name in model.input_names}
    found = simulate(model, start(model), (0, 0.4), inputs=torques, outputs=Outputs(count=5))
    assert (found.status, found.is_right) == ("finished", True), found.checks
    for t, q, qd in zip(found.t[1:].tolist(), found.q[1:], found.qd[1:], strict=True):
        moved = {"arm.q3": (0.3 + t * t / 10, t / 5), "hand.left": (0.02 + 0.01 * np.sin(t), 0.01 * np.cos(t))}
        whole_q, whole_qd = (
            np.array([{**dict(zip(model.coordinates, x, strict=True)), **given}[name] for name in COORDINATES])
            for x, given in ((q, {n: x[0] for n, x in moved.items()}), (qd, {n: x[1] for n, x in moved.items()}))
        )
        expected = multiplied(whole_q, whole_qd, t, {"arm.q3": 0.2, "hand.left": -0.01 * np.sin(t)})
        free = [COORDINATES.index(name) for name in model.coordinates]
        np.testing.assert_allclose(
            own_accelerations(model, q, qd, t), expected[free], atol=1e-6 * np.abs(expected).max()
        )


def test_driven_it_moves_without_the_wheel_too() -> None:
    model = whole(driven=DRIVEN, velocity_constraints=[])
    found = simulate(model, start(model), (0, 0.4), outputs=Outputs(count=5))
    assert (found.status, found.is_right) == ("finished", True), found.checks
