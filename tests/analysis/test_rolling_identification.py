"""Identification with velocity constraints: a cart on two driven wheels, from the torques of its wheels alone."""

# ruff: noqa: N806 -- symbols of the notation

from __future__ import annotations

from functools import cache
from typing import Any

import numpy as np
import pytest
from closed_trees import tree_model, tree_parts
from random_trees import Plain

from substructures import InvalidInput, Model, Outputs, simulate
from substructures.analysis.equations.nonholonomic.positions import start_velocities
from substructures.analysis.equations.nonholonomic.quasi_velocities import quasi_velocity_equations
from substructures.analysis.equations.nonholonomic.solved import solved
from substructures.analysis.identification import on_constraints
from substructures.analysis.identification.base_parameters import BaseParameters, base_parameters
from substructures.analysis.identification.fit import excitation, identify
from substructures.expr.interpret import interpret
from substructures.quantities.numbers.defaults import default_numbers
from substructures.quantities.regressor import regressor
from substructures.quantities.regressor_model import RegressorModel

R, HALF = 0.1, 0.2


def cart() -> Plain:
    """Its chassis in a plane, with the mass centre ahead of the axle; wheels a little out of balance."""
    inertia = {"xx": 0.2, "yy": 0.3, "zz": 0.4}
    plane: Plain = {"type": "planar", "coordinate": ["x", "y", "f"], "placement": {"position": [0, 0, R]}}
    bodies: list[Plain] = [
        {"name": "chassis", "parent": "base", "joint": plane, "mass": 8, "com": [0.05, 0.01, 0], "inertia": inertia}
    ]
    for name, side in (("left", HALF), ("right", -HALF)):
        placement = {"position": [0, side, 0], "rpy": ["-pi/2", 0, 0]}
        bodies.append(
            {
                "name": name,
                "parent": "chassis",
                "joint": {"type": "revolute", "coordinate": name[0], "placement": placement},
                "mass": 0.7,
                "com": [0.004, 0.003, 0.01],
                "inertia": {"xx": 0.004, "yy": 0.004, "zz": 0.007},
            }
        )
    return {"name": "cart", "bodies": bodies}


def wheel(name: str) -> Plain:
    return {"name": name, "type": "rolling", "frame": f"s.{name}", "radius": R}


TREE: Plain = {"gravity": [0, 0, "-9.81"], "instances": [{"name": "s", "substructure": "p"}]}
ROLLING: Plain = {**TREE, "velocity_constraints": [wheel("left"), wheel("right")]}


@cache
def made() -> tuple[Model, RegressorModel, BaseParameters]:
    """With its constraints; the regressor and base parameters of the cart that slides in its plane."""
    Y = regressor(*tree_parts(TREE, {"p": cart()}))
    return tree_model(ROLLING, {"p": cart()}), Y, base_parameters(Y)


@cache
def measured(samples: int = 120) -> Plain:
    """A motion on which the cart turns round, and the torques of its wheels."""
    model, t = made()[0], np.linspace(0, 6, samples)
    laws = {"tau.s.l": "0.9*sin(2.1*t) + 0.5*cos(5*t) - 0.05", "tau.s.r": "0.8*sin(2.9*t) - 0.6*cos(4*t + 1) + 0.1"}
    motion = simulate(model, [0, 0, 0.2, 0, 0], (0, 6), inputs=laws, outputs=Outputs(times=t))
    assert motion.is_right
    assert np.ptp(motion.q[:, 2]) > np.pi
    torque = [0.9 * np.sin(2.1 * t) + 0.5 * np.cos(5 * t) - 0.05, 0.8 * np.sin(2.9 * t) - 0.6 * np.cos(4 * t + 1) + 0.1]
    tau = np.column_stack((np.zeros((samples, 3)), *torque))
    equations = quasi_velocity_equations(model, independent=["s.l", "s.r"])
    source, second = solved(equations), []
    for q, qd, forces in zip(motion.q, motion.qd, tau, strict=True):
        values = {**dict(zip(model.coordinates, q, strict=True)), "t": 0.0}
        values |= {f"tau.{name}": x for name, x in zip(model.coordinates, forces, strict=True)}
        v = start_velocities(equations, values, qd, None)
        values |= dict(zip(equations.velocities, v, strict=True))
        second.append(interpret(source, values, ["second"])["second"])
    return {"q": motion.q, "qd": motion.qd, "qdd": np.array(second), "tau": tau}


def truth(base: BaseParameters, combinations: Any) -> Any:
    values = default_numbers(base.parameters)
    beta = dict(zip(base.names, interpret(base.program, values, ["base_parameters"])["base_parameters"], strict=True))
    return np.array([sum(c * beta[name] for name, c in some.items()) for some in combinations.values()])


def test_a_cart_is_identified_by_the_torques_of_its_wheels() -> None:
    model, _, base = made()
    found = identify(base, **measured(), closed=model)
    assert (found.status, found.is_right) == ("identified", True)
    assert found.combinations is not None
    assert len(found.names) < base.count
    np.testing.assert_allclose(found.values, truth(base, found.combinations), rtol=1e-6, atol=1e-7)
    given = {name: measured()[name] for name in ("q", "qd", "qdd")}
    shown = excitation(base, **given, closed=model)
    assert (shown.names, shown.rank) == (found.names, len(found.names))


def test_their_number_is_the_rank_of_what_the_wheels_do() -> None:
    """N by hand: x' = u cos f, y' = u sin f, f' = w, R l' = u - b w, R r' = u + b w."""
    model, Y, base = made()
    rng, rows = np.random.default_rng(3), []
    for _ in range(40):
        q, (u, w), (du, dw) = rng.uniform(-2, 2, 5), rng.uniform(-1, 1, 2), rng.uniform(-1, 1, 2)
        c, s = np.cos(q[2]), np.sin(q[2])
        N = np.array([[c, 0], [s, 0], [0, 1], [1 / R, -HALF / R], [1 / R, HALF / R]])
        second = N @ [du, dw] + np.array([-s, c, 0, 0, 0]) * u * w
        rows.append(N.T @ Y.evaluate(q=q, qd=N @ [u, w], qdd=second)["regressor"])
    stacked = np.concatenate(rows)
    sizes = np.linalg.svd(stacked / (np.linalg.norm(stacked, axis=0) + 1e-6), compute_uv=False)
    ties = on_constraints.Rolled.of(model, base, measured()["q"], {})
    assert len(ties.kept) == int(np.sum(sizes > 1e-8 * sizes[0]))


def test_noise_is_told() -> None:
    model, _, base = made()
    noisy = {**measured(), "tau": measured()["tau"] + 0.001 * np.random.default_rng(1).standard_normal((120, 5))}
    found = identify(base, **noisy, closed=model)
    assert found.combinations is not None
    away = np.abs(found.values - truth(base, found.combinations)) / found.deviations
    assert 0.1 < away.max() < 5


def test_a_planted_fault_is_seen(monkeypatch: pytest.MonkeyPatch) -> None:
    """Velocities that the constraints do not leave: forces of rolling are taken for inertia."""
    model, _, base = made()
    right = on_constraints.Rolled.tangents
    monkeypatch.setattr(on_constraints.Rolled, "tangents", lambda self, q: right(self, q) + 0.1)
    assert not identify(base, **measured(), closed=model, error_limit=0.01).is_right


def test_constraints_that_move_are_refused() -> None:
    """Of a measured motion the time is not known."""
    law = {"name": "belt", "type": "linear", "expression": "s.x' - sin(t)"}
    model = tree_model({**TREE, "velocity_constraints": [law]}, {"p": cart()})
    with pytest.raises(InvalidInput) as caught:
        identify(made()[2], **measured(), closed=model)
    assert caught.value.faults[0].code == "not-steady"
