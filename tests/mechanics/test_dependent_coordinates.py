"""Dependent coordinates of the reduced level: their values, limits, and names in expressions."""

# ruff: noqa: N806 -- symbols of the notation

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
from closed_trees import tree_model
from mechanics.reduced_parts import PARTS

from substructures import Event, InvalidDocument, Model, Outputs, evaluate, simulate
from substructures.analysis.closed.reduced import reduced_equations

NAMES = {each["name"]: each for each in PARTS}


def alone(name: str, level: str | None = None, **limited: Any) -> Model:
    """``limited``: limits of joints by body."""
    bodies = [
        {**body, "joint": {**body["joint"], "limits": limited[body["name"]]}} if body["name"] in limited else body
        for body in NAMES[name]["bodies"]
    ]
    instance = {"name": "x", "substructure": name} | ({"level": level} if level else {})
    return tree_model({"gravity": [0, -9.81, 0], "instances": [instance]}, {name: {**NAMES[name], "bodies": bodies}})


@pytest.mark.parametrize("name", NAMES)
def test_they_are_those_of_the_closed_loop(name: str) -> None:
    model, full = alone(name), alone(name, "full")
    start = {f"x.{q}": float(x) for q, x in NAMES[name]["start"].items()}
    for turn in (-0.2, 0.3):
        q = {c: start[c] + turn for c in model.coordinates}
        closed = reduced_equations(full, q, independent=model.coordinates, start=start)
        found = evaluate(model, "dependent", q)
        assert list(found.labels["dependent"]) == list(model.dependent)
        wanted = dict(zip(full.coordinates, closed.q, strict=True))
        apart = found["dependent"] - [wanted[z] for z in model.dependent]
        np.testing.assert_allclose(np.exp(1j * apart), 1, rtol=0, atol=1e-12)


def test_their_limits_are_looked_at() -> None:
    """Of states, and of motions; of the rocker, which no one gives."""
    model = alone("crank-rocker", rocker=[0.2, 2])
    assert not evaluate(model, "metric", [1.0]).warnings
    (told,) = evaluate(model, "metric", [[1.0], [3.0]]).warnings
    assert told["message"] == "'x.chi' is 2.38741 rad in state 1; its joint has limits 0.2 to 2"
    motion = simulate(model, [1.0], (0, 1), qd=[3.0])
    assert motion.is_right
    assert [x["code"] for x in motion.warnings] == ["limits-left"]
    assert "'x.chi'" in motion.warnings[0]["message"]


def test_expressions_name_them_and_their_rates() -> None:
    """The angle of the rocker, and its rate, which is that of the body; an event at 2.2 rad."""
    model = alone("crank-rocker")
    event = Event("far", "x.chi", 2.2)
    series = {"angle": "x.chi", "rate": "x.chi'"}
    motion = simulate(model, [1.4], (0, 3), qd=[3.0], outputs=Outputs(series=series, events=[event]))
    assert motion.is_right
    assert motion.status == "stopped"
    k, found = model.frames.index("x.rocker"), evaluate(model, ["rotation", "Omega"], motion.q)
    R, turned = found["rotation"][:, k], found["Omega"][:, k, 0, 2] * motion.qd[:, 0]
    np.testing.assert_allclose(motion.series["rate"], turned, rtol=0, atol=1e-12)
    np.testing.assert_allclose(motion.series["angle"], np.arctan2(R[:, 1, 0], R[:, 0, 0]), atol=1e-12)
    assert motion.series["angle"][-1] == pytest.approx(2.2, abs=1e-9)


def test_of_driven_linkages_they_move_with_the_time() -> None:
    model = tree_model(
        {"instances": [{"name": "x", "substructure": "slider-pin"}], "driven": {"x.phi": "0.3 + 2*t"}},
        {"slider-pin": NAMES["slider-pin"]},
    )
    found = evaluate(model, "dependent", [], t=0.4)["dependent"]
    np.testing.assert_allclose(found, evaluate(alone("slider-pin"), "dependent", [1.1])["dependent"], rtol=1e-14)


def test_to_drive_one_is_refused_with_a_way_out() -> None:
    tree = {"instances": [{"name": "x", "substructure": "slider-pin"}], "driven": {"x.psi": "2*t"}}
    with pytest.raises(InvalidDocument) as raised:
        tree_model(tree, {"slider-pin": NAMES["slider-pin"]})
    (fault,) = raised.value.faults
    assert (fault.pointer, fault.code) == ("/driven/x.psi", "unknown-coordinate")
    assert "give 'x' the level 'full'" in fault.message


def test_no_branch_is_chosen_where_two_meet() -> None:
    """A parallelogram that starts flat, which may go on crossed: it has all coordinates, and is told why."""
    start = [("crank", "base", 0), ("coupler", "crank", 1), ("rocker", "base", 2)]
    bodies = [
        {"name": name, "parent": parent, "mass": 1, "joint": {"type": "revolute", "placement": {"position": [x, 0, 0]}}}
        for name, parent, x in start
    ]
    flat = {
        "name": "flat",
        "bodies": bodies,
        "ports": [{"name": "tip", "body": "coupler", "position": [2, 0, 0]}],
        "closures": [
            {"name": "loop", "type": "pin", "from": "tip", "to": "rocker", "placement": {"position": [1, 0, 0]}}
        ],
        "independent": ["q_crank"],
    }
    tree = {"gravity": [0, -9.81, 0], "instances": [{"name": "x", "substructure": "flat"}]}
    model = tree_model(tree, {"flat": flat})
    assert model.dof == 3
    (told,) = (x["message"] for x in model.certificate["warnings"] if x["code"] == "full-level")
    assert "its two positions meet at the start, a dead centre: give one away from it" in told
    open_ = {"q_crank": 1, "q_coupler": -1, "q_rocker": 1}
    assert tree_model(tree, {"flat": {**flat, "start": open_}}).dof == 1
