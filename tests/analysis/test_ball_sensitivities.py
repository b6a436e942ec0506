"""Sensitivities of motions with ball and floating joints, in displacements: differences, and A(t) of linearisations."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
from ball_trees import apart, displaced
from random_trees import model_of

from substructures import Integrator, Model, SensitivityOutputs, Table, linearise, sensitivities, simulate
from substructures.analysis.motion.variation import variational
from substructures.certificate.derived.perturbed import varied
from substructures.errors import VerificationFailed
from substructures.expr.program import Program
from substructures.quantities.certificate import certified

FINE = Integrator(relative_tolerance=1e-11, absolute_tolerance=1e-12)
SPAN = (0.0, 0.8)


@pytest.fixture(scope="module")
def model() -> Model:
    """A body that floats, with a damped wheel and a boom on a ball joint that gravity turns."""
    inertia = {"xx": 1, "yy": 2, "zz": 2.5}
    definition: dict[str, Any] = {
        "name": "satellite",
        "parameters": {"m": {"value": 1, "unit": "kg"}, "l": {"value": 0.5, "unit": "m"}},
        "bodies": [
            {"name": "hull", "parent": "base", "mass": 5, "inertia": inertia, "joint": {"type": "floating"}},
            {"name": "wheel", "parent": "hull", "mass": 1, "inertia": inertia,
             "joint": {"type": "revolute", "coordinate": "spin", "damping": "0.1", "d": 0.2}},
            {"name": "boom", "parent": "wheel", "mass": "m", "com": ["l", 0, "0.1"], "inertia": inertia,
             "joint": {"type": "ball"}},
        ],
        "loads": [{"type": "spring", "from": {"body": "base", "at": [0, 0, 1]}, "to": {"body": "boom", "at": [1, 0, 0]},
                   "stiffness": 8}],
    }  # fmt: skip
    return model_of(definition)


@pytest.fixture(scope="module")
def start(model: Model) -> tuple[np.ndarray, np.ndarray]:
    rng = np.random.default_rng(4)
    zero = np.array([0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0.0])
    return displaced(model, zero, rng.uniform(-1.5, 1.5, model.dof)), rng.uniform(-1, 1, model.dof)


def moved(model: Model, q: np.ndarray, qd: np.ndarray, **parameters: float) -> tuple[np.ndarray, np.ndarray]:
    inputs = {"tau.x.w_hull_x": "0.3*sin(4*t)"}
    found = simulate(model, q, SPAN, qd=qd, parameters=parameters, inputs=inputs, integrator=FINE)
    return found.q[-1], found.qd[-1]


def test_derivatives_are_differences(model: Model, start: tuple[np.ndarray, np.ndarray]) -> None:
    (q, qd), n = start, model.dof
    found = sensitivities(
        model, q, SPAN, ["m", "l"], qd=qd, inputs={"tau.x.w_hull_x": "0.3*sin(4*t)"}, integrator=FINE,
        outputs=SensitivityOutputs(of_start=True, count=3),
    )  # fmt: skip
    assert (found.status, found.is_right, found.positions) == ("finished", True, model.positions)
    end = moved(model, q, qd)
    np.testing.assert_allclose(found.q[-1], end[0] * np.sign(end[0] @ found.q[-1]), atol=1e-9)
    assert found.series["d.start"].shape == (3, 2 * n, 2 * n)
    np.testing.assert_allclose(found.series["d.start"][0], np.eye(2 * n), atol=1e-12)

    def slope(ends: list[tuple[np.ndarray, np.ndarray]], h: float) -> np.ndarray:
        (q1, v1), (q2, v2) = ends
        return np.concatenate([apart(model, q2, q1), v1 - v2]) / (2 * h)

    h = 1e-5
    for name, value in {"m": 1.0, "l": 0.5}.items():
        expected = slope([moved(model, q, qd, **{name: value + way}) for way in (h, -h)], h)
        np.testing.assert_allclose(found.series[f"d.{name}"][-1], expected, atol=1e-5 * np.abs(expected).max())
    for k in (0, 4, 6, 8, n + 4, 2 * n - 1):
        e = np.eye(2 * n)[k]
        ends = [moved(model, displaced(model, q, way * e[:n]), qd + way * e[n:]) for way in (h, -h)]
        expected = slope(ends, h)
        np.testing.assert_allclose(found.series["d.start"][-1][:, k], expected, atol=1e-5 * np.abs(expected).max())


def test_they_obey_the_linearised_equations(model: Model, start: tuple[np.ndarray, np.ndarray]) -> None:
    """S' = A S with A of a linearisation about the state."""
    (q, qd), h, n = start, 1e-3, model.dof
    outputs = SensitivityOutputs(of_start=True, times=[0, 0.4 - h, 0.4, 0.4 + h])
    table = Table([0, 0.8], [0.1, 0.5])
    found = sensitivities(model, q, (0, 0.41), qd=qd, inputs={"tau.x.spin": table}, integrator=FINE, outputs=outputs)
    _, before, at, after = found.series["d.start"]
    A = linearise(model, found.q[2], qd=found.qd[2], inputs={"tau.x.spin": 0.3}).A  # noqa: N806 -- of the notation
    np.testing.assert_allclose(A @ at, (after - before) / (2 * h), atol=2e-4 * np.abs(A @ at).max())
    assert A.shape == (2 * n, 2 * n)


def test_planted_faults_are_found(model: Model) -> None:
    """Each number of the program, another one: the certificate knows what changes of places and quaternions vary by."""
    right, found = variational(model, ["m"]), 0
    expected = varied(["m"], model.positions, model.balls)
    assert certified(right, model, expected, "variation of the motion") is not None
    reached = right.reachable(["rates", "rates_variation"])
    numbers = [i for i in reached if right.operations[i][0] in ("rat", "int")]
    for i in numbers:
        name, *rest = right.operations[i]
        changed = (name, *rest[:-1], str(int(rest[-1]) + 1))
        wrong = (*right.operations[:i], changed, *right.operations[i + 1 :])
        with pytest.raises(VerificationFailed):
            certified(Program(right.symbols, wrong, right.outputs), model, expected, "variation of the motion")
        found += 1
    assert found > 1
