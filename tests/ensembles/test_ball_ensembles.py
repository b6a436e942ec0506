"""Ensembles of trees with ball and floating joints: each member as it moves alone, judged by energy and norms."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
from ball_trees import displaced
from random_trees import model_of

from substructures import Event, Model, Outputs, simulate
from substructures.analysis.motion.problems.output_times import OutputGrid
from substructures.analysis.motion.problems.problem import Integrator
from substructures.ensembles.columns import MotionColumn
from substructures.ensembles.ensemble import simulate_ensemble
from substructures.ensembles.sampled import with_samples
from substructures.ensembles.samples import Samples
from substructures.errors import InvalidInput

FINE = Integrator(relative_tolerance=1e-11, absolute_tolerance=1e-12)
GRID = OutputGrid(times=[0, 0.3, 1.0])


@pytest.fixture(scope="module")
def model() -> Model:
    """A satellite with a wheel, whose bearing damps, and a ball joint that carries a boom."""
    inertia = {"xx": 1, "yy": 2, "zz": 2.5}
    definition: dict[str, Any] = {
        "name": "satellite",
        "parameters": {"m": {"value": 1, "unit": "kg"}},
        "bodies": [
            {"name": "hull", "parent": "base", "mass": 5, "inertia": inertia, "joint": {"type": "floating"}},
            {"name": "boom", "parent": "hull", "mass": "m", "com": [0.5, 0, 0], "inertia": inertia,
             "joint": {"type": "ball"}},
            {"name": "wheel", "parent": "hull", "mass": 1, "inertia": inertia,
             "joint": {"type": "revolute", "coordinate": "spin", "damping": "0.1", "d": 0.2}},
        ],
    }  # fmt: skip
    return model_of(definition)


def starts(model: Model, count: int) -> tuple[np.ndarray, np.ndarray]:
    rng = np.random.default_rng(2)
    zero = np.array([0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0, 0.0])
    q = np.array([displaced(model, zero, rng.uniform(-2, 2, model.dof)) for _ in range(count)])
    return q, rng.uniform(-1, 1, (count, model.dof))


def test_members_are_motions(model: Model) -> None:
    (q, qd), masses = starts(model, 4), np.linspace(0.6, 1.4, 4)
    inputs = {"tau.x.w_hull_x": "0.2*cos(3*t) - 0.1*x.w_hull_x'"}
    columns = {
        "turn": MotionColumn(expression="x.q_hull_w^2", take="largest"),
        "work": MotionColumn(expression="x.spin'^2", take="integral"),
        "energy": MotionColumn(quantity="kinetic_energy"),
        "lifted": MotionColumn(quantity="forward_dynamics", of="x.v_hull_z"),
    }
    given: dict[str, Any] = {"inputs": inputs, "grid": GRID, "integrator": FINE, "columns": columns, "states": True}
    found = simulate_ensemble(model, q, (0, 1), qd=qd, parameters={"m": masses}, **given)
    assert (found.is_right, found.failed, found.positions) == (True, 0, model.positions)
    assert {each["name"] for each in found.checks} == {"energy", "quaternions"}
    assert found.q is not None
    assert found.qd is not None
    for k in range(4):
        alone = simulate(
            model, q[k], (0, 1), qd=qd[k], parameters={"m": masses[k]}, inputs=inputs, integrator=FINE,
        )  # fmt: skip
        sign = np.sign(np.sum(alone.q[-1] * found.q[k, -1]))
        assert sign == 1
        np.testing.assert_allclose(found.q[k, -1], alone.q[-1], rtol=0, atol=1e-8)
        np.testing.assert_allclose(found.qd[k, -1], alone.qd[-1], rtol=0, atol=1e-8)
        assert found.columns["energy"][k] == pytest.approx(alone.series["kinetic_energy"][-1], rel=1e-8)
    np.testing.assert_allclose(np.linalg.norm(found.q[..., 3:7], axis=-1), 1, atol=1e-14)
    beside = simulate_ensemble(model, q[1:2], (0, 1), qd=qd[1:2], parameters={"m": masses[1]}, **given)
    assert beside.q is not None
    np.testing.assert_array_equal(beside.q[0], found.q[1])


def test_a_wrong_motion_is_found(model: Model) -> None:
    """Coarse steps lose energy and length: both are seen."""
    q, qd = starts(model, 3)
    coarse = Integrator("RK23", relative_tolerance=1e-2, absolute_tolerance=1e-2)
    found = simulate_ensemble(model, q, (0, 3), qd=3 * qd, grid=OutputGrid(count=20), integrator=coarse)
    assert found.is_right is False
    assert {each["name"] for each in found.checks if each["violated"]} == {"energy", "quaternions"}


def test_events_and_samples(model: Model) -> None:
    q, qd = starts(model, 1)
    samples = Samples.model_validate(
        {"count": 3, "seed": 1, "method": "latin-hypercube",
         "of": {"x.r_hull_z": {"uniform": [1, 2]}, "x.w_hull_z'": {"uniform": [-1, 1]}}}
    )  # fmt: skip
    given = with_samples(model, samples, {"q": None, "qd": None, "parameters": {}, "inputs": {}})
    assert given["q"].shape == (3, 12)
    np.testing.assert_array_equal(given["q"][:, 3:11], [[1, 0, 0, 0] * 2] * 3)
    assert np.ptp(given["qd"][:, model.coordinates.index("x.w_hull_z")]) > 0
    falls = Event("ground", "x.r_hull_z")
    found = simulate_ensemble(model, given["q"], (0, 2), qd=given["qd"], grid=GRID, events=[falls])
    assert found.happened is not None
    for k, end in enumerate(found.happened.ends.tolist()):
        outputs = Outputs(events=[falls])
        alone = simulate(model, given["q"][k], (0, 2), qd=given["qd"][k], outputs=outputs)
        assert end == pytest.approx(alone.events[0].t, abs=1e-9)
    with pytest.raises(InvalidInput, match="norm"):
        simulate_ensemble(model, 2 * q, (0, 1), qd=qd)
