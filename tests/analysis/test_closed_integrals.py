"""First integrals of closed loops: constant along simulated motions, and not claimed where a reaction changes them."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
from closed_trees import bricard, four_bar, governor, tree_model
from random_trees import Plain
from simulated import simulated

from substructures import Model
from substructures.analysis.equations.first_integrals import first_integrals
from substructures.analysis.equations.integral import FirstIntegrals
from substructures.expr.interpret import interpret_in_blocks

DOWN = (0, -9.81, 0)


def along(model: Model, found: FirstIntegrals, request: Plain) -> dict[str, Any]:
    """Values of all integrals along a simulated motion."""
    motion = simulated(model, **request, span=(0, 0.6), count=7)
    assert motion.is_right, motion.message
    values: Plain = {name: float(p["value"]) for name, p in model.parameters.items()}
    values |= {s.name: 0.0 for s in model.program.symbols if s.kind == "input"} | {"t": motion.t}
    values |= {name: motion.q[:, a] for a, name in enumerate(model.coordinates)}
    values |= {f"{name}'": motion.qd[:, a] for a, name in enumerate(model.coordinates)}
    return interpret_in_blocks(found.program, values, [i.name for i in found.integrals], len(motion.t))


def names(found: FirstIntegrals) -> dict[str, str]:
    return {i.name: i.rule for i in found.integrals}


@pytest.mark.parametrize(
    ("model", "request_"),
    [
        (four_bar(DOWN), {"q": [0.7, 0.2, 1.2], "qd": [2, 0, 0]}),
        (bricard(), {"q": [2, 0.1, 2, 0.1, 2], "qd": [1, 0, 0, 0, 0]}),
        (governor(), {"q": [0, 0.6, 0.6, 0.1], "qd": [9, 1, 1, 0]}),
    ],
)
def test_constants_of_a_motion(model: Model, request_: Plain) -> None:
    found = first_integrals(model)
    for name, values in along(model, found, request_).items():
        assert np.ptp(values) < 1e-7 * np.abs(values).max() + 1e-9, name
        assert np.ptp(values) > 0 or name != "energy"


def test_the_spin_of_a_governor() -> None:
    """The spindle stays a cyclic coordinate: no rod depends on it, and says so."""
    found = first_integrals(governor())
    assert names(found) == {"energy": "constant", "angular_momentum.z": "constant"}
    assert found.cyclic == ("x.turn",)
    energy, spin = found.integrals
    assert energy.reason.endswith("the closures 'right', 'left' do no work")
    assert "the closures 'right', 'left' do not depend on it" in spin.reason


def carts(closures: list[Plain]) -> Model:
    """Two carts on parallel rails along x, without forces."""
    rail = {"type": "prismatic", "coordinate": "s", "placement": {"position": [0, 0, 0]}, "axis": [1, 0, 0]}
    cart = {"name": "cart", "parent": "base", "mass": 2, "joint": rail}
    instances = [
        {"name": n, "substructure": "c", "placement": {"position": [0, y, 0]}} for n, y in (("a", 1), ("b", 2))
    ]
    return tree_model({"instances": instances, "closures": closures}, {"c": {"name": "c", "bodies": [cart]}})


def test_a_rod_between_two_carts_leaves_only_their_sum() -> None:
    """Both carts are cyclic without it; it takes both, and leaves the momentum along x; one to the world takes all."""
    assert first_integrals(carts([])).cyclic == ("a.s", "b.s")
    rod: Plain = {"name": "rod", "type": "rod", "from": "a.cart", "to": "b.cart", "length": 2}
    tied = first_integrals(carts([rod]))
    assert tied.cyclic == ()
    momentum = ("linear_momentum.x", "galilei.x")
    assert names(tied) == dict.fromkeys(("energy", *momentum), "constant")
    assert "the closures 'rod' and the world" in tied.integrals[1].reason
    rod |= {"to": "world", "placement": {"position": [5, 0, 0]}}
    assert names(first_integrals(carts([rod]))) == dict.fromkeys(("energy", "momentum.b.s", "energy.a.s"), "constant")


def test_a_loop_that_floats_keeps_all_momenta() -> None:
    """A four-bar on a free base without gravity: reactions inside the loop cancel as formulas."""
    box = {"xx": 1, "yy": 2, "zz": 2}
    bodies: list[Plain] = [
        {"name": "hull", "parent": "base", "mass": 3, "inertia": box, "joint": {"type": "free"}},
        {"name": "crank", "parent": "hull", "joint": {"type": "revolute", "coordinate": "a"}},
        {"name": "rocker", "parent": "hull", "joint": {"type": "revolute", "coordinate": "b", "d": 1}},
        {"name": "coupler", "parent": "crank", "joint": {"type": "revolute", "coordinate": "c", "d": 0.5}},
    ]
    for k, body in enumerate(bodies[1:]):
        body |= {"mass": 1 + k, "com": [0.3, 0.1, 0.2 * k], "inertia": box}
    ports = [
        {"name": "x", "body": "coupler", "position": [1, 0, 0]},
        {"name": "y", "body": "rocker", "position": [0.5, 0, 0]},
    ]
    part = {"name": "p", "bodies": bodies, "ports": ports}
    pin = {"name": "pin", "type": "pin", "from": "x.x", "to": "x.y"}
    model = tree_model({"instances": [{"name": "x", "substructure": "p"}], "closures": [pin]}, {"p": part})
    found = first_integrals(model)
    expected = {f"{kind}_momentum.{axis}" for kind in ("linear", "angular") for axis in "xyz"}
    assert expected <= set(names(found))
    start = np.array([0.1, 0.2, 0.3, 0.1, 0.2, 0.3, 1, 1, -1])
    values = along(model, found, {"q": start, "qd": np.linspace(-1, 1, 9)})
    for name in expected:
        assert np.ptp(values[name]) < 1e-7, name


def test_dampers_and_drives() -> None:
    """Falling where joints damp, balanced by what inputs feed in."""
    assert names(first_integrals(four_bar(DOWN)))["energy"] == "constant"
    driven = first_integrals(four_bar(DOWN), ["tau.x.crank"])
    assert names(driven)["energy"] == "balance"
    assert "'pin' do no work" in driven.integrals[0].reason
