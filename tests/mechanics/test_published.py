"""Formulas and numbers from textbooks and test suites, typed by hand: pendulums and small chains."""

# ruff: noqa: N806 -- symbols of the notation

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
from formulas import alone, assert_formulas
from random_trees import Plain

from substructures.quantities.numbers.evaluation import evaluate


def symbols(*names: str) -> Plain:
    return {name: {"value": 1} for name in names}


def test_acrobot() -> None:
    """Drake, multibody/benchmarks/acrobot/acrobot.cc; M. W. Spong, IEEE Control Systems 15(1), 1995.

    The vertical plane, q1 from the horizontal.
    """
    constants = symbols("m1", "m2", "l1", "lc1", "lc2", "Ic1", "Ic2")
    definition = {
        "name": "one",
        "parameters": constants,
        "bodies": [
            {
                "name": "link1",
                "parent": "base",
                "joint": {"type": "revolute", "coordinate": "q1", "theta": "pi/2"},
                "mass": "m1",
                "com": ["lc1", 0, 0],
                "inertia": {"zz": "Ic1"},
            },
            {
                "name": "link2",
                "parent": "link1",
                "joint": {"type": "revolute", "coordinate": "q2", "d": "l1"},
                "mass": "m2",
                "com": ["lc2", 0, 0],
                "inertia": {"zz": "Ic2"},
            },
        ],
    }
    model = alone(definition, [0, 0, "-g"], constants | symbols("g"))
    I1, I2 = "(Ic1 + m1*lc1^2)", "(Ic2 + m2*lc2^2)"
    g12 = f"{I2} + m2*l1*lc2*cos(q2)"
    h = "m2*l1*lc2*sin(q2)"
    metric = {(0, 0): f"{I1} + {I2} + m2*l1^2 + 2*m2*l1*lc2*cos(q2)", (0, 1): g12, (1, 0): g12, (1, 1): I2}
    assert_formulas(model, "metric", metric)
    gamma = {(0, 0, 1): f"-{h}", (0, 1, 0): f"-{h}", (0, 1, 1): f"-{h}", (1, 0, 0): h}
    assert_formulas(model, "christoffel", gamma)
    second = "m2*lc2*g*cos(q1 + q2)"
    assert_formulas(model, "gravity", {(0,): f"-(m1*lc1 + m2*l1)*g*cos(q1) - {second}", (1,): f"-{second}"})


def test_pendulum_on_a_cart() -> None:
    """SymPy, physics/mechanics/tests/test_models.py: angle from the upward vertical."""
    constants = symbols("m0", "m1", "l0")
    definition = {
        "name": "one",
        "parameters": constants,
        "bodies": [
            {
                "name": "cart",
                "parent": "base",
                "joint": {
                    "type": "prismatic",
                    "coordinate": "q0",
                    "placement": {"position": [0, 0, 0], "rpy": [0, 0, 0]},
                    "axis": [1, 0, 0],
                },
                "mass": "m0",
            },
            {
                "name": "bob",
                "parent": "cart",
                "joint": {"type": "revolute", "coordinate": "q1", "phi": "pi/2"},
                "mass": "m1",
                "com": ["l0", 0, 0],
            },
        ],
    }
    model = alone(definition, [0, "-g", 0], constants | symbols("g"))
    g12 = "-l0*m1*cos(q1)"
    assert_formulas(model, "metric", {(0, 0): "m0 + m1", (0, 1): g12, (1, 0): g12, (1, 1): "l0^2*m1"})
    assert_formulas(model, "christoffel", {(0, 1, 1): "l0*m1*sin(q1)"})
    assert_formulas(model, "gravity", {(1,): "m1*g*l0*sin(q1)"})


@pytest.mark.parametrize(
    "accelerations",
    [[-4.905], [-5.886, 3.924], [-6.03692307692308, 3.77307692307692, 1.50923076923077]],
    ids=["single", "double", "triple"],
)
def test_small_chains(accelerations: list[float]) -> None:
    """RBDL, tests/DynamicsTests.cc: to all digits given there."""
    bodies = [
        {
            "name": f"b{i}",
            "parent": f"b{i - 1}" if i else "base",
            "joint": {"type": "revolute", "d": 1 if i else 0},
            "mass": 1,
            "com": [1, 0, 0],
            "inertia": {"xx": 1, "yy": 1, "zz": 1},
        }
        for i in range(len(accelerations))
    ]
    model = alone({"name": "one", "bodies": bodies}, [0, -9.81, 0])
    answer = evaluate(model, ["forward_dynamics"], q=[0] * len(bodies))
    np.testing.assert_allclose(answer["forward_dynamics"], accelerations, rtol=0, atol=5e-15 * 10)


def test_simple_pendulum_has_the_published_period() -> None:
    """IFToMM benchmark A01: released from the horizontal, back after 4 sqrt(L/g) K(sin 45 deg)."""
    body = {
        "name": "bob",
        "parent": "base",
        "joint": {"type": "revolute", "coordinate": "q"},
        "mass": 1,
        "com": [1, 0, 0],
    }
    model = alone({"name": "one", "bodies": [body]}, [0, -9.81, 0])
    steps, period = 1000, 2.3678419475762373
    h = period / steps

    def slope(x: Any) -> Any:
        answer = evaluate(model, ["forward_dynamics"], q=x[:1], qd=x[1:])
        return np.array([x[1], answer["forward_dynamics"][0]])

    x = np.zeros(2)
    for _ in range(steps):
        k1 = slope(x)
        k2 = slope(x + h / 2 * k1)
        k3 = slope(x + h / 2 * k2)
        x = x + h / 6 * (k1 + 2 * k2 + 2 * k3 + slope(x + h * k3))
    np.testing.assert_allclose(x, [0, 0], rtol=0, atol=1e-7)
