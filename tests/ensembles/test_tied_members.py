"""Ensembles with velocity constraints and closures: members are the motions that are simulated alone."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
from closed_trees import tree_model
from random_trees import Plain
from rolling_bodies import FORWARD, R, disc_part, sleigh_part

from substructures import ConstrainedMotion, Model, catalogue, simulate, simulate_ensemble
from substructures.analysis.equations.nonholonomic.velocity_constraints import closing
from substructures.analysis.motion.problems.output_times import OutputGrid
from substructures.analysis.motion.problems.outputs import Outputs
from substructures.ensembles import constrained
from substructures.ensembles.columns import MotionColumn
from substructures.ensembles.sampled import with_samples
from substructures.ensembles.samples import Samples
from substructures.errors import InvalidInput

EDGE = {"name": "blade", "type": "knife_edge", "frame": "s.b"}
FLOOR = {"name": "floor", "type": "rolling", "frame": "s.disc", "radius": "s.r"}
ANGLES = ["s.psi", "s.th", "s.ph"]


def tied(part: Plain, constraints: list[Plain], gravity: Any = (0, 0, -9.81)) -> Model:
    tree: Plain = {"gravity": list(gravity), "instances": [{"name": "s", "substructure": "p"}]}
    return tree_model({**tree, "velocity_constraints": constraints}, {"p": part})


def test_members_are_motions_with_the_constraint() -> None:
    """Starts, parameters, a law of the velocities, an integral and torques, each as of the motion alone."""
    model, law = tied(sleigh_part(), [EDGE], (0, 0, 0)), "-s.x'/2 + sin(t)"
    speeds, lengths = [1.0, 2.0, 3.0], [0.1, 0.25, 0.3]
    kind = ConstrainedMotion(closing(model), velocities=FORWARD, v={"u": speeds, "w": 1.0})
    columns = {
        "way": MotionColumn(expression="s.x'", take="integral"),
        "torque": MotionColumn(quantity="inverse_dynamics", of="s.f"),
    }
    given: Plain = {"inputs": {"tau.s.x": law}, "parameters": {"s.a": lengths}}
    found = simulate_ensemble(
        model, [0, 0, 0.4], (0, 2), kind=kind, grid=OutputGrid(count=5), columns=columns, states=True, **given
    )
    assert found.is_right, found.checks
    assert found.q is not None
    assert found.qd is not None
    assert {each["name"] for each in found.checks} == {"energy-balance"}
    for k, (u, a) in enumerate(zip(speeds, lengths, strict=True)):
        one = ConstrainedMotion(kind.constraints, velocities=FORWARD, v={"u": u, "w": 1.0})
        request: Plain = {"inputs": given["inputs"], "parameters": {"s.a": a}, "kind": one}
        motion = simulate(model, [0, 0, 0.4], (0, 2), outputs=Outputs(count=5), **request)
        np.testing.assert_allclose(found.q[k], motion.q, atol=1e-8)
        np.testing.assert_allclose(found.qd[k], motion.qd, atol=1e-8)
    np.testing.assert_allclose(found.columns["way"], found.q[:, -1, 0], atol=1e-8)
    # about the vertical through the blade nothing but the constraint's own force acts, which has no arm
    np.testing.assert_allclose(found.columns["torque"], 0, atol=1e-9)


def test_contacts_of_rolling_discs_are_judged(monkeypatch: pytest.MonkeyPatch) -> None:
    model = tied(disc_part(), [FLOOR])
    tilts = np.array([1.0, 1.2, 1.4])
    q = np.zeros((3, 6))
    q[:, 2], q[:, 4] = R * np.sin(tilts), tilts
    kind = ConstrainedMotion(closing(model), independent=ANGLES, v=[1.0, 0.2, -6.0])
    found = simulate_ensemble(model, q, (0, 1), kind=kind, grid=OutputGrid(count=5))
    assert found.is_right, found.checks
    assert {"energy", "gaps"} <= {each["name"] for each in found.checks}
    assert found.q is not None
    motion = simulate(model, q[1], (0, 1), kind=kind, outputs=Outputs(count=5))
    np.testing.assert_allclose(found.q[1], motion.q, atol=1e-7)
    # velocities that meet the constraints give the same members
    again = simulate_ensemble(model, q, (0, 1), qd=found.qd[:, 0], grid=OutputGrid(count=5))  # type: ignore[index]
    np.testing.assert_allclose(again.q, found.q, atol=1e-7)
    # a slope that is left out of q' lets the disc sink, which the gap tells
    whole = constrained.full_states

    def sunk(*arguments: Any) -> Any:
        """z off by a part of t."""
        states = whole(*arguments)
        states[:, 2] += 1e-3 * np.arange(len(states))
        return states

    monkeypatch.setattr("substructures.ensembles.members.full_states", sunk)
    assert simulate_ensemble(model, q, (0, 1), kind=kind, grid=OutputGrid(count=5)).is_right is False


def test_loops_stay_closed() -> None:
    """Four-bars of several masses from positions that are moved onto the loop, against simulations with multipliers."""
    pin = {"name": "pin", "type": "pin", "from": "f.coupler_end", "to": "f.rocker_end"}
    tree: Plain = {"gravity": [0, -9.81, 0], "instances": [{"name": "f", "substructure": "four-bar"}]}
    model = tree_model({**tree, "closures": [pin]}, {"four-bar": catalogue.load("four-bar")})
    masses, lengths, q = [1.0, 1.4], [0.35, 0.36], [0.6, -0.2, 1.5]
    given = {"parameters": {"f.m2": masses, "f.l2": lengths}}
    found = simulate_ensemble(model, q, (0, 0.5), grid=OutputGrid(count=5), **given)
    assert found.is_right, found.checks
    assert found.q is not None
    assert "gaps" in {each["name"] for each in found.checks}
    for k, (mass, length) in enumerate(zip(masses, lengths, strict=True)):
        motion = simulate(
            model, found.q[k, 0], (0, 0.5), parameters={"f.m2": mass, "f.l2": length}, outputs=Outputs(count=5)
        )
        np.testing.assert_allclose(found.q[k], motion.q, atol=1e-7)
    with pytest.raises(InvalidInput) as caught:
        simulate_ensemble(model, q, (0, 0.5), parameters={"f.l2": [0.35, 3.0]})
    assert (caught.value.faults[0].pointer, caught.value.faults[0].code) == ("/q", "open-closure")
    assert "member 1" in caught.value.faults[0].message


def test_quasi_velocities_are_drawn() -> None:
    model = tied(sleigh_part(), [EDGE], (0, 0, 0))
    kind = ConstrainedMotion(closing(model), velocities=FORWARD)
    samples = Samples(
        method="sobol",
        count=8,
        seed=0,
        of={"u": {"uniform": (1, 2)}, "s.f": {"uniform": (0, 1)}},  # type: ignore[dict-item]
    )
    given = with_samples(model, samples, {"q": None, "qd": None, "v": {"w": 0.5}, "parameters": {}, "inputs": {}}, kind)
    assert sorted(given["v"]) == ["u", "w"]
    assert given["qd"] is None
    other = ConstrainedMotion(kind.constraints, velocities=FORWARD, v=given["v"])
    found = simulate_ensemble(model, given["q"], (0, 1), kind=other)
    assert (found.count, found.is_right) == (8, True)
    assert found.qd is not None
    np.testing.assert_allclose(np.hypot(found.qd[:, 0, 0], found.qd[:, 0, 1]), given["v"]["u"], rtol=1e-12)


@pytest.mark.parametrize(
    ("given", "pointer", "code"),
    [
        ({"v": {"w": 1}}, "/v/w", "unknown-velocity"),
        ({"v": [[1, 2, 3]]}, "/v", "wrong-length"),
        ({"v": [1, 2], "qd": [0, 0, 0]}, "/v", "two-velocities"),
        ({"qd": [[0, 0, 1], [1, 1, 0]]}, "/qd", "violated"),
    ],
)
def test_faults_have_their_place(given: Plain, pointer: str, code: str) -> None:
    model = tied(sleigh_part(), [EDGE], (0, 0, 0))
    kind = ConstrainedMotion(closing(model), v=given.get("v"))
    with pytest.raises(InvalidInput) as caught:
        simulate_ensemble(model, [0, 0, 0.4], (0, 1), qd=given.get("qd"), kind=kind)
    assert (caught.value.faults[0].pointer, caught.value.faults[0].code) == (pointer, code)
