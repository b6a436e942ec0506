"""The reduced level of instances: linkages by hand, the equations with multipliers, planted faults, bad input."""

# ruff: noqa: N806 -- symbols of the notation

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
import tied_combinations
from closed_trees import tree_model, tree_parts
from mechanics.reduced_parts import ARM, HEXAPOD, PARTS, Plain

from substructures import (
    Model,
    catalogue,
    evaluate,
    first_integrals,
    simulate,
)
from substructures.analysis.closed.reduced import reduced_equations
from substructures.quantities.reactions import reactions
from substructures.quantities.sources import Sources

NAMES = {each["name"]: each for each in PARTS}


#: to a point that moves about the linkage
STAY: Plain = {"name": "stay", "type": "rod", "from": "hand.tip", "to": "world", "length": 2}


def alone(name: str, level: str | None = None, gravity: Any = (0, -9.81, 0), **more: Any) -> Model:
    instance = {"name": "x", "substructure": name} | ({"level": level} if level else {})
    return tree_model({"gravity": list(gravity), "instances": [instance], **more}, {name: NAMES[name]})


def between_arms(name: str, level: str | None = None, **more: Any) -> tuple[Plain, Plain]:
    """The second one on its last body."""
    linkage = {"name": "x", "substructure": name, "at": "arm.tip", "placement": {"rpy": ["0.3", 0, "0.1"]}}
    last = NAMES[name]["bodies"][-1]["name"]
    instances = [
        {"name": "arm", "substructure": "arm"},
        linkage | ({"level": level} if level else {}),
        {"name": "hand", "substructure": "arm", "at": f"x.{last}"},
    ]
    return {"gravity": [1, "-9.81", 2], "instances": instances, **more}, {"arm": ARM, name: NAMES[name]}


def on_an_arm(name: str, level: str | None = None) -> Model:
    return tree_model(*between_arms(name, level))


def with_reactions(document: Plain, definitions: Plain) -> Sources:
    transmitted = reactions(*tree_parts(document, definitions))
    return Sources(tree_model(document, definitions), of_parts=lambda _: transmitted)


def start_of(name: str) -> dict[str, float]:
    return {f"x.{q}": float(x) for q, x in NAMES[name]["start"].items()}


@pytest.mark.parametrize("crank", [-2.0, 0.4, 3.0, 7.0])
def test_the_crank_rocker_by_hand(crank: float) -> None:
    """Angles by the law of cosines (F. Freudenstein, 1955), rates by that of sines; g* = 2 T, V, Q* of its laws."""
    model = alone("crank-rocker")
    assert model.coordinates == ("x.phi",)
    assert not model.closures
    L0, L1, L2, L3 = 1, 0.3, 0.9, 0.7
    B = L1 * np.exp(1j * crank)
    d = abs(L0 - B)
    coupler = np.angle(L0 - B) + np.arccos((L2**2 + d**2 - L3**2) / (2 * L2 * d))
    rocker = float(np.angle(B + L2 * np.exp(1j * coupler) - L0))
    w2 = L1 * np.sin(rocker - crank) / (L2 * np.sin(coupler - rocker))
    w3 = L1 * np.sin(coupler - crank) / (L3 * np.sin(coupler - rocker))
    found = evaluate(model, ["metric", "position", "potential_energy", "forces", "generalised_momenta"], [crank], [1.0])
    tip = found["position"][model.frames.index("x.tip")]
    np.testing.assert_allclose(tip, [L0 + L3 * np.cos(rocker), L3 * np.sin(rocker), 0], atol=1e-13)
    c = 0.1 + 0.05j
    v1, v2, v3 = 1j * np.exp(1j * crank) * c, 1j * B + 1j * w2 * np.exp(1j * coupler) * c, 1j * w3 * abs(c)
    energy = sum(abs(v) ** 2 for v in (v1, v2, v3)) + 0.02 * (1 + w2**2 + w3**2) + 0.1 * w3**2
    assert found["metric"][0, 0] == pytest.approx(energy, rel=1e-12)
    height = np.imag(np.exp(1j * crank) * c + B + np.exp(1j * coupler) * c + np.exp(1j * rocker) * c)
    assert found["potential_energy"] == pytest.approx(9.81 * height + 1.5 * (rocker - 0.7) ** 2, rel=1e-12)
    weight = -9.81 * np.imag(v1 + v2 + 1j * w3 * np.exp(1j * rocker) * c)
    assert found["forces"][0] == pytest.approx(weight - 3 * (rocker - 0.7) * w3 - 0.2 * w3**2, rel=1e-11)


@pytest.mark.parametrize("angle", [-1.0, 0.3, 2.0])
def test_the_slider_crank_by_hand(angle: float) -> None:
    """x = r cos phi + sqrt(l^2 - r^2 sin^2 phi); Gamma* is half the slope of g*."""
    model, r, long = alone("slider-pin"), 0.3, 0.8

    def by_hand(phi: float) -> tuple[float, float]:
        s = np.sqrt(long**2 - r**2 * np.sin(phi) ** 2)
        turn = -r * np.cos(phi) / s
        slope = -r * np.sin(phi) - r**2 * np.sin(phi) * np.cos(phi) / s
        along = (s - 1j * r * np.sin(phi)) / long
        v = 1j * r * np.exp(1j * phi) + 1j * turn * along * (0.1 + 0.05j)
        return r * np.cos(phi) + s, abs(0.1 + 0.05j) ** 2 + abs(v) ** 2 + slope**2 + 0.02 * (1 + turn**2)

    found, h = evaluate(model, ["metric", "christoffel", "position"], [angle]), 1e-5
    x, g = by_hand(angle)
    assert found["position"][model.frames.index("x.slider")][0] == pytest.approx(x, rel=1e-13)
    assert found["metric"][0, 0] == pytest.approx(g, rel=1e-12)
    assert found["christoffel"][0, 0, 0] == pytest.approx(
        (by_hand(angle + h)[1] - by_hand(angle - h)[1]) / (4 * h), abs=1e-8
    )


@pytest.mark.parametrize("name", NAMES)
def test_they_are_the_equations_with_multipliers(name: str) -> None:
    """Between two arms: metric, symbols, forces and accelerations of the tree with closures, reduced in numbers."""
    model, full, rng = on_an_arm(name), on_an_arm(name, "full"), np.random.default_rng(3)
    assert full.closures
    assert not model.closures
    assert [x["instance"] for x in model.reduced] == ["x"]
    names, start = model.coordinates, start_of(name)
    for _ in range(2):
        q = {c: start.get(c, 0) + rng.uniform(-0.2, 0.2) for c in names}
        qd = {c: rng.uniform(-1, 1) for c in names}
        tau = {f"tau.{c}": rng.uniform(-1, 1) for c in full.coordinates}
        other = reduced_equations(full, q, qd=qd, inputs=tau, independent=names, start=start)
        assert other.is_right
        found = evaluate(model, ["metric", "christoffel", "forces", "forward_dynamics", "bias"], q, qd, inputs=tau)
        named = {"metric": "metric", "christoffel": "christoffel", "forces": "forces"}
        for ours, theirs in (named | {"forward_dynamics": "accelerations"}).items():
            wanted = getattr(other, theirs)
            np.testing.assert_allclose(found[ours], wanted, rtol=0, atol=1e-11 * np.abs(wanted).max())
        speeds = np.array(list(qd.values()))
        bias = np.einsum("abc,b,c", found["christoffel"], speeds, speeds)
        np.testing.assert_allclose(found["bias"], bias, rtol=0, atol=1e-12 * np.abs(bias).max())


def assert_same_reactions(ours: Sources, theirs: Sources, state: Any, closed: Any, inputs: Any) -> None:
    found = evaluate(ours, "reactions", *state, inputs=inputs)
    other = evaluate(theirs, "reactions", *closed, inputs=inputs)
    assert found.labels["joints"] == other.labels["joints"]
    for kind, wanted in other["reactions"].items():
        np.testing.assert_allclose(found["reactions"][kind], wanted, rtol=0, atol=1e-10 * np.abs(wanted).max())


@pytest.mark.parametrize("name", NAMES)
def test_joints_transmit_what_they_do_with_closures(name: str) -> None:
    """Multipliers of least norm follow from the motion, of planar loops one after the other."""
    ours, theirs = (with_reactions(*between_arms(name, level)) for level in (None, "full"))
    rng, start, names = np.random.default_rng(3), start_of(name), ours.model.coordinates
    q = {c: start.get(c, 0) + rng.uniform(-0.2, 0.2) for c in names}
    qd = {c: rng.uniform(-1, 1) for c in names}
    tau = {f"tau.{c}": rng.uniform(-1, 1) for c in theirs.model.coordinates}
    closed = reduced_equations(theirs.model, q, qd=qd, independent=names, start=start)
    assert_same_reactions(ours, theirs, (q, qd), (closed.q, closed.qd), tau)


def test_more_rows_act_than_coordinates_depend(monkeypatch: pytest.MonkeyPatch) -> None:
    """A ball in axes that are tilted against the plane: three rows for two coordinates, and forces of least norm."""
    plain, turned = NAMES["crank-rocker"], {"rotation": {"rpy": ["0.4", "0.3", 0]}}
    ball: Plain = {"closures": [{"name": "loop", "type": "ball", "from": "end", "to": "tip"}]}
    monkeypatch.setitem(
        NAMES, "tilted", {**plain, **ball, "name": "tilted", "ports": [p | turned for p in plain["ports"]]}
    )
    test_joints_transmit_what_they_do_with_closures("tilted")


def test_joints_transmit_forces_of_other_closures() -> None:
    """A rod from the tip to the world, at rest: its force goes through the linkage."""
    names, start = on_an_arm("rod").coordinates, start_of("rod")
    q = {c: start.get(c, 0) + 0.1 for c in names}
    tip = evaluate(on_an_arm("rod"), "position", q)["position"][on_an_arm("rod").frames.index("hand.tip")]
    stay = {**STAY, "length": float(np.linalg.norm(tip))}
    ours, theirs = (with_reactions(*between_arms("rod", level, closures=[stay])) for level in (None, "full"))
    closed = reduced_equations(on_an_arm("rod", "full"), q, independent=names, start=start)
    assert_same_reactions(ours, theirs, (q,), (closed.q,), {f"tau.{c}": 1 for c in names})


def test_bearings_of_a_slider_crank_by_hand() -> None:
    """At rest without masses, the crank at right angles: the guide holds what the rod presses beside it."""
    none = ("mass", "com", "inertia", "armature")
    bodies = [{k: x for k, x in body.items() if k not in none} for body in NAMES["slider-pin"]["bodies"]]
    push = {"type": "force", "body": "slider", "at": [0, 0, 0], "vector": [-10, 0, 0]}
    light = {**NAMES["slider-pin"], "name": "light", "bodies": bodies, "loads": [push]}
    tree = with_reactions({"instances": [{"name": "x", "substructure": "light"}]}, {"light": light})
    found = evaluate(tree, "reactions", [np.pi / 2], [0], [0])
    rows = dict(zip(found.labels["joints"], found["reactions"]["force_world"], strict=True))
    side = 10 * 0.3 / np.sqrt(0.8**2 - 0.3**2)
    np.testing.assert_allclose(rows["x.x"], [0, side, 0], atol=1e-12)
    np.testing.assert_allclose(rows["x.phi"], [10, -side, 0], atol=1e-12)


def test_a_driven_crank_transmits_what_one_does_that_moves_so() -> None:
    driven, free = (
        with_reactions(
            {"gravity": [0, -9.81, 0], "instances": [{"name": "x", "substructure": "slider-pin"}], **more},
            {"slider-pin": NAMES["slider-pin"]},
        )
        for more in ({"driven": {"x.phi": "0.3 + 2*t"}}, {})
    )
    ours = evaluate(driven, "reactions", [], t=0.4)["reactions"]
    theirs = evaluate(free, "reactions", [1.1], [2.0], [0.0])["reactions"]
    for kind, wanted in theirs.items():
        np.testing.assert_allclose(ours[kind], wanted, rtol=1e-12, atol=1e-12)


def test_motions_are_those_with_closures() -> None:
    model, full = alone("crank-rocker"), alone("crank-rocker", "full")
    ours = simulate(model, [1.0], (0, 1), qd=[2.0])
    closed = reduced_equations(full, {"x.phi": 1.0}, qd={"x.phi": 2.0})
    theirs = simulate(full, closed.q, (0, 1), qd=closed.qd)
    assert ours.is_right
    assert theirs.is_right
    np.testing.assert_allclose(ours.q[:, 0], theirs.q[:, 0], rtol=0, atol=1e-6)


def test_a_driven_crank_has_the_torque_of_the_motor() -> None:
    """At constant speed the torque is Gamma* w^2 - Q*; nothing is left to move."""
    driven = alone("slider-pin", driven={"x.phi": "0.3 + 2*t"})
    assert driven.dof == 0
    torque = evaluate(driven, "drive_forces", [], t=0.4)["drive_forces"][0]
    found = evaluate(alone("slider-pin"), "inverse_dynamics", [1.1], [2.0], [0.0])["inverse_dynamics"][0]
    assert torque == pytest.approx(found, rel=1e-12)


def test_parallelograms_have_no_root_and_pass_where_they_are_flat() -> None:
    model = tree_model(
        {"gravity": [0, -9.81, 0], "instances": [{"name": "x", "substructure": "five-bar"}]},
        {"five-bar": catalogue.load("five-bar")},
    )
    assert not any(operation[0] == "sqrt" for operation in model.program.operations)
    assert model.operations["christoffel"] < 60
    found = evaluate(model, ["metric", "christoffel"], [0.2, 1.9])
    p = {name: float(x["value"]) for name, x in catalogue.load("five-bar")["parameters"].items()}
    d11 = p["m1"] * p["c1"] ** 2 + p["m3"] * p["c3"] ** 2 + p["m4"] * p["l1"] ** 2 + p["I1"] + p["I3"]
    d22 = p["m2"] * p["c2"] ** 2 + p["m3"] * p["l2"] ** 2 + p["m4"] * p["c4"] ** 2 + p["I2"] + p["I4"]
    np.testing.assert_allclose(found["metric"], np.diag([d11, d22]), atol=1e-13)
    np.testing.assert_allclose(found["christoffel"], 0, atol=1e-13)
    far = simulate(model, [0.0, 1.0], (0, 1), qd=[0.0, 6.0])
    assert np.ptp(far.q[:, 1]) > 3


def test_a_loop_on_a_slide_knows_nothing_of_it() -> None:
    """A rod beside the plane of two pendulums on a cart, whose momentum stays."""
    seat = {"name": "seat", "body": "deck", "position": [1, "0.3", 0]}
    rod = {**tied_combinations.BAR, "from": "tip", "to": "seat", "length": "1.05"}
    more = {"start": {"c": -1}, "ranges": {"a": [-2, 2], "b": ["-0.4", "0.4"]}, "closures": [rod]}
    cart = {**tied_combinations.LINKAGE, "name": "c", "ports": [tied_combinations.CART["ports"][0], seat], **more}
    model = tree_model(
        {"gravity": [0, 0, "-9.81"], "instances": [{"name": "x", "substructure": "cart"}]}, {"cart": cart}
    )
    assert model.coordinates == ("x.a", "x.b")
    assert "x.a" not in model.program.needs(["dependent"])
    found = first_integrals(model)
    assert found.cyclic == ("x.a",)
    # as that of any cart: the momentum along x, for two reasons
    reason = next(each.reason for each in found.integrals if each.name == "linear_momentum.x")
    assert "; the metric does not depend on 'x.a' and no generalised force acts on it" in reason


def test_a_platform_on_six_rods_is_where_they_hold_it() -> None:
    """All six coordinates at once; nothing beyond what the rods reach, and nothing wrong beyond a dead centre."""
    model = tree_model({"instances": [{"name": "x", "substructure": "hexapod"}]}, {"hexapod": HEXAPOD})
    assert model.reduced[0]["dependent"] == ["x.x", "x.y", "x.z", "x.a", "x.b", "x.c"]
    slides = [0.03, -0.02, 0.04, 0.01, -0.05, 0.02]
    found = evaluate(model, ["position"], slides)["position"]
    frames = {name: found[k] for k, name in enumerate(model.frames)}
    for k in range(6):
        assert np.linalg.norm(frames[f"x.p{k}"] - frames[f"x.s{k}"]) == pytest.approx(0.8, rel=1e-14)
    assert evaluate(model, "metric", [0.0, 1.5, 0.0, 1.5, 0.0, 1.5]).failures
