"""Given motions and velocity constraints in one tree: B(q, t) q' + b(q, t) = 0, where drives move frames."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
from closed_trees import tree_model
from random_trees import Plain

from substructures import ConstrainedMotion, Model, linearise, simulate, simulate_ensemble
from substructures.analysis.equations.nonholonomic import quasi_velocities
from substructures.analysis.equations.nonholonomic.quasi_velocities import quasi_velocity_equations
from substructures.analysis.equations.nonholonomic.velocity_constraints import closing
from substructures.analysis.motion.problems.output_times import OutputGrid
from substructures.analysis.simulate import Outputs
from substructures.errors import InvalidInput, VerificationFailed
from substructures.quantities.numbers.evaluation import evaluate

EDGE = {"name": "blade", "type": "knife_edge", "frame": "s.edge"}
MASS: Plain = {"mass": 1, "com": [0.1, 0, 0], "inertia": {"xx": 0.1, "yy": 0.1, "zz": 0.1}}
#: the blade lies 0.3 m behind the axis about which it is steered
HINGE = {"type": "revolute", "coordinate": "steer", "axis": [0, 0, 1], "placement": {"position": [1, 0, 0]}}
PART: Plain = {
    "name": "sledge",
    "bodies": [
        {"name": "frame", "parent": "base", "joint": {"type": "planar", "coordinate": ["x", "y", "f"]}, **MASS},
        {"name": "runner", "parent": "frame", "joint": HINGE, **MASS},
    ],
    "ports": [{"name": "edge", "body": "runner", "position": [-0.3, 0, 0]}],
}
TREE: Plain = {"gravity": [0, 0, 0], "instances": [{"name": "s", "substructure": "p"}]}
STEER = {"s.steer": "0.5*sin(2*t)"}


def sledge(**more: Any) -> Model:
    return tree_model({**TREE, **more}, {"p": PART})


def test_a_steered_sledge_moves_as_with_multipliers() -> None:
    """Of the tree in which it is free to steer, held by rows: the blade, and the angle that is given."""
    model, free = sledge(driven=STEER, velocity_constraints=[EDGE]), sledge()
    kind = ConstrainedMotion(closing(model), independent=["s.x", "s.f"], v={"s.x'": 1.0, "s.f'": 0.3})
    found = simulate(model, [0, 0, 0.2], (0, 1), kind=kind, outputs=Outputs(times=[0.3, 0.30001, 0.7, 0.70001]))
    assert found.is_right, found.checks
    assert np.abs(found.series["work"]).max() > 0.01
    edge = free.frames.index("s.edge")

    def row(q: Any) -> Any:
        """B of the blade."""
        return evaluate(free, "kinematics", q)["kinematics"]["U"][edge][:, 1]

    for k in (0, 2):
        t, (a, ad, add) = found.t[k], (0.5 * g for g in waves(found.t[k]))
        q, qd = np.append(found.q[k], a), np.append(found.qd[k], ad)
        assert abs(row(q) @ qd) < 1e-9
        h = 1e-6
        change = (row(q + h * qd) - row(q - h * qd)) / (2 * h)
        at = evaluate(free, ["metric", "bias"], q, qd)
        B = np.vstack([row(q), [0, 0, 0, 1]])  # noqa: N806
        left = np.block([[at["metric"], B.T], [B, np.zeros((2, 2))]])
        second = np.linalg.solve(left, np.concatenate([-at["bias"], [-change @ qd, add]]))[:3]
        np.testing.assert_allclose((found.qd[k + 1] - found.qd[k]) / (found.t[k + 1] - t), second, rtol=1e-3, atol=1e-3)


def waves(t: float) -> tuple[float, float, float]:
    return float(np.sin(2 * t)), float(2 * np.cos(2 * t)), float(-4 * np.sin(2 * t))


def test_the_same_in_members_and_what_takes_none() -> None:
    model = sledge(driven=STEER, velocity_constraints=[EDGE])
    kind = ConstrainedMotion(closing(model), independent=["s.x", "s.f"], v={"s.x'": [1.0, 2.0], "s.f'": 0.3})
    many = simulate_ensemble(model, [0, 0, 0.2], (0, 1), kind=kind, grid=OutputGrid(count=3))
    # no integral is known, so that nothing but the motion itself is compared
    assert (many.failed, many.is_right) == (0, None)
    one = ConstrainedMotion(kind.constraints, independent=kind.independent, v={"s.x'": 2.0, "s.f'": 0.3})
    motion = simulate(model, [0, 0, 0.2], (0, 1), kind=one, outputs=Outputs(count=3))
    assert many.q is not None
    np.testing.assert_allclose(many.q[1], motion.q, atol=1e-7)
    hamel = ConstrainedMotion(kind.constraints, form="boltzmann-hamel")
    for call, pointer, code in (
        (lambda: simulate(model, [0, 0, 0.2], (0, 1), kind=hamel), "/form", "not-supported"),
        (lambda: linearise(model, [0, 0, 0.2]), "", "has-driven"),
    ):
        with pytest.raises(InvalidInput) as caught:
            call()
        assert (caught.value.faults[0].pointer, caught.value.faults[0].code) == (pointer, code)


def test_what_drives_make_of_the_blade_is_certified(monkeypatch: pytest.MonkeyPatch) -> None:
    """b left out of the rows is found."""
    name = "substructures.analysis.equations.nonholonomic.velocity_constraints.GIVEN"
    monkeypatch.setattr(name, ("U", "Omega"))
    quasi_velocities._equations.cache_clear()
    with pytest.raises(VerificationFailed):
        quasi_velocity_equations(sledge(driven=STEER, velocity_constraints=[EDGE]), independent=["s.x", "s.f"])


def test_a_blade_that_is_steered_past_a_right_angle_changes_its_velocities() -> None:
    """A blade that turns by a = 0.3 t^2: u' = c a'^2 along it, c from the blade to the mass centre before it."""
    body = {"name": "body", "parent": "base", "joint": {"type": "planar", "coordinate": ["x", "y", "f"]}, **MASS}
    edge = {"name": "blade", "type": "knife_edge", "frame": "s.body"}
    model = tree_model(
        {**TREE, "driven": {"s.f": "0.3*t^2"}, "velocity_constraints": [edge]}, {"p": {"name": "p", "bodies": [body]}}
    )
    found = simulate(model, [0, 0], (0, 3), qd=[1, 0], outputs=Outputs(count=13))
    assert found.is_right, found.checks
    # u = 1 + 0.1 * 0.36 t^3/3
    along = 1 + 0.012 * found.t**3
    np.testing.assert_allclose(
        found.qd, along[:, None] * np.array([np.cos(a := 0.3 * found.t**2), np.sin(a)]).T, atol=1e-8
    )
    kept = simulate(model, [0, 0], (0, 3), kind=ConstrainedMotion(closing(model), independent=["s.x"], v=[1]))
    assert "where cos(0.3*t^2) is near zero" in kept.message
