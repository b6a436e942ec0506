"""Closed loops in independent coordinates: textbooks, published accelerations, differences, and multipliers."""

# ruff: noqa: N806 -- symbols of the notation

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from catalogue_entries import shipped_part
from closed_trees import SQUEEZER, closed_entry, parallelogram, tree_model
from made_once import derived_once

from substructures import InvalidDocument, InvalidInput, Model, TreeSpec, catalogue, couple, derive, evaluate
from substructures.analysis.closed.loops import loop_state
from substructures.analysis.closed.reduced import ReducedEquations, reduced_equations
from substructures.analysis.equations.nonholonomic.quasi_velocities import quasi_velocity_equations
from substructures.analysis.equations.nonholonomic.velocity_constraints import Closed
from substructures.errors import VerificationFailed
from substructures.expr.interpret import interpret
from substructures.tree.certificate import certify_tree
from substructures.tree.publishing.published import Publication, published
from substructures.tree.publishing.published_formulas import published_part

Plain = dict[str, Any]
L0, L1, L2, L3 = 0.4, 0.1, 0.35, 0.25
LINKAGE: Plain = {
    **catalogue.load("four-bar"),
    "name": "linkage",
    "closures": [{"name": "pin", "type": "pin", "from": "coupler_end", "to": "rocker_end"}],
    "independent": ["crank"],
    "start": {"crank": 1, "coupler": "-0.3", "rocker": {"value": 110, "unit": "deg"}},
    "ranges": {"crank": ["-2*pi", {"value": 500, "unit": "deg"}]},
}


def linkage() -> Model:
    return tree_model(
        {"gravity": [0, -9.81, 0], "instances": [{"name": "x", "substructure": "linkage", "level": "full"}]},
        {"linkage": LINKAGE},
    )


def on_an_arm() -> Model:
    """Two linkages with other lengths and dampers on an arm that swings in all directions."""
    damped = json.loads(json.dumps(LINKAGE, default=float))
    for body in damped["bodies"]:
        body["joint"] |= {"damping": 0.02, "stiffness": 0.3}
    ball = {"type": "universal", "coordinate": ["a", "b"]}
    stick = {"name": "stick", "parent": "base", "joint": ball, "mass": 1, "com": [0, 0, 0.2]}
    stick["inertia"] = {"xx": 0.1, "yy": 0.1, "zz": 0.01}
    arm = {"name": "arm", "bodies": [stick], "ports": [{"name": "tip", "body": "stick", "position": [0, 0.1, 0.4]}]}
    instances = [
        {"name": "arm", "substructure": "arm"},
        {
            "name": "left",
            "substructure": "linkage",
            "level": "full",
            "at": "arm.tip",
            "placement": {"rpy": [0.4, 0.3, 0]},
        },
        {"name": "right", "substructure": "linkage", "level": "full", "at": "left.rocker", "parameters": {"l1": 0.12}},
    ]
    return tree_model({"gravity": [1, -9.81, 2], "instances": instances}, {"arm": arm, "linkage": damped})


def freudenstein(crank: float) -> tuple[float, float]:
    """Absolute angles of coupler and rocker on the branch with the joint above the bearings."""
    B = L1 * np.exp(1j * crank)
    d, along = abs(L0 - B), np.angle(L0 - B)
    bend = np.arccos((L2**2 + d**2 - L3**2) / (2 * L2 * d))
    coupler = along + bend
    return coupler, float(np.angle(B + L2 * np.exp(1j * coupler) - L0))


@pytest.mark.parametrize("crank", [-6.0, -3.0, -0.5, 0.0, 1.3, 2.9, 5.0, 8.7])
def test_the_four_bar_linkage_by_hand(crank: float) -> None:
    """Positions in closed form (F. Freudenstein, 1955), rates by the law of sines, T of three rods: g* = 2 T."""
    found = reduced_equations(linkage(), {"x.crank": crank})
    assert found.is_right, found
    coupler, rocker = freudenstein(crank)
    wanted = np.exp(1j * np.array([crank, coupler - crank, rocker]))
    assert np.abs(np.exp(1j * found.q) - wanted).max() < 1e-12
    w2 = L1 * np.sin(rocker - crank) / (L2 * np.sin(coupler - rocker))
    w3 = L1 * np.sin(coupler - crank) / (L3 * np.sin(coupler - rocker))
    np.testing.assert_allclose(found.tangent[:, 0], [1, w2 - 1, w3], rtol=0, atol=1e-12)
    middle = 1j * L1 * np.exp(1j * crank) + 0.5j * L2 * w2 * np.exp(1j * coupler)
    energy = 0.5 * L1**2 / 3 + 1.4 * (abs(middle) ** 2 + L2**2 / 12 * w2**2) + L3**2 / 3 * w3**2
    assert found.metric[0, 0] == pytest.approx(energy, rel=1e-12)


def test_a_full_turn_ends_where_it_began() -> None:
    """The branch is that of the start, on the whole way."""
    one, other = (reduced_equations(linkage(), {"x.crank": 1 + turn}) for turn in (0, 2 * np.pi))
    np.testing.assert_allclose(other.q - one.q, [2 * np.pi, -2 * np.pi, 0], atol=1e-12)
    below = reduced_equations(linkage(), {"x.crank": 1}, start={"x.coupler": -2.5, "x.rocker": -1.9})
    assert below.is_right
    assert abs(np.exp(1j * below.q[2]) - np.exp(1j * one.q[2])) > 0.5


def test_many_states_are_followed_one_after_the_other() -> None:
    """As one by one; a way that ends at a dead centre has numbers up to there."""
    way, rates = np.linspace(-3, 3, 13), np.linspace(0, 1, 13)
    found = reduced_equations(linkage(), {"x.crank": way}, qd={"x.crank": rates.tolist()})
    assert found.is_right, found
    assert [x.shape for x in (found.q, found.metric, found.christoffel)] == [(13, 3), (13, 1, 1), (13, 1, 1, 1)]
    for k in (0, 5, 12):
        one = reduced_equations(linkage(), {"x.crank": float(way[k])}, qd={"x.crank": float(rates[k])})
        np.testing.assert_allclose(found.qdd[k], one.qdd, rtol=1e-9)
    rocker = np.linspace(2, 3, 11)
    ended = reduced_equations(linkage(), {"x.rocker": rocker}, independent=["x.rocker"])
    assert ended.is_right is None
    assert np.isfinite(ended.metric[:, 0, 0]).tolist() == (rocker < 2.498).tolist()
    assert "x.rocker = 2.498091" in ended.message
    constant = reduced_equations(linkage(), {"x.crank": [1.5]}, qd={"x.crank": 0.1})
    assert constant.q.shape == (1, 3)


def test_christoffel_symbols_are_those_of_the_reduced_metric() -> None:
    """Gamma*_ijk = 1/2 (d_j g*_ik + d_k g*_ij - d_i g*_jk), Q* = -dV/dy of gravity and springs at rest: differences."""
    model, h = on_an_arm(), 1e-5
    names = model.reduction.independent
    assert names == ("arm.a", "arm.b", "left.crank", "right.crank")
    y = np.array([0.3, -0.4, 0.8, 1.4])

    def at(place: Any) -> ReducedEquations:
        return reduced_equations(model, dict(zip(names, map(float, place), strict=True)))

    def potential(place: Any) -> float:
        return float(evaluate(model, "potential_energy", q=at(place).q.tolist())["potential_energy"])

    found, steps = at(y), [h * e for e in np.eye(4)]
    slopes = np.array([(at(y + e).metric - at(y - e).metric) / (2 * h) for e in steps])
    wanted = (np.einsum("jik->ijk", slopes) + np.einsum("kij->ijk", slopes) - slopes) / 2
    np.testing.assert_allclose(found.christoffel, wanted, rtol=0, atol=1e-9 * np.abs(wanted).max())
    forces = [-(potential(y + e) - potential(y - e)) / (2 * h) for e in steps]
    np.testing.assert_allclose(found.forces, forces, rtol=0, atol=1e-8 * np.abs(forces).max())
    turned = np.array([(at(y + e).tangent - at(y - e).tangent) / (2 * h) for e in steps])
    np.testing.assert_allclose(found.tangent_derivative, np.einsum("jbk->bjk", turned), rtol=0, atol=1e-8)


def test_they_are_the_equations_with_multipliers() -> None:
    """Accelerations of all coordinates at moving states with inputs, dampers and springs: to 1e-10."""
    model, rng = on_an_arm(), np.random.default_rng(8)
    names = model.reduction.independent
    for _ in range(5):
        q, qd = (dict(zip(names, rng.uniform(-2, 2, 4), strict=True)) for _ in range(2))
        inputs = {f"tau.{name}": float(x) for name, x in zip(model.coordinates, rng.uniform(-2, 2, 8), strict=True)}
        found = reduced_equations(model, q, qd=qd, inputs=inputs)
        assert found.is_right, found
        assert np.abs(evaluate(model, "closure.jacobian", q=found.q)["closure.jacobian"] @ found.tangent).max() < 1e-13
        other = loop_state(model, found.q, qd=found.qd, inputs=inputs)
        np.testing.assert_allclose(other.consistent.q, found.q, rtol=0, atol=1e-12)
        np.testing.assert_allclose(found.qdd, other.qdd, rtol=0, atol=1e-10 * np.abs(other.qdd).max())


def test_formulas_of_them_are_velocity_equations() -> None:
    """g*, Gamma* y'y' and Q* as certified formulas in all coordinates, by elimination: the same numbers to 1e-12."""
    model = on_an_arm()
    formulas = quasi_velocity_equations(model, [Closed(rows.name) for rows in model.closures])
    assert formulas.velocities == tuple(f"{name}'" for name in model.reduction.independent)
    rates = dict(zip(model.reduction.independent, [0.7, -1.1, 1.3, 0.4], strict=True))
    found = reduced_equations(model, {"left.crank": 0.3, "right.crank": 2.0, "arm.b": 0.6}, qd=rates)
    values = {s.name: 0.0 for s in formulas.program.symbols} | dict(zip(model.coordinates, found.q, strict=True))
    values |= {name: float(p["value"]) for name, p in model.parameters.items()}
    values |= {f"{name}'": x for name, x in rates.items()}
    numbers = interpret(formulas.program, values, ["metric", "bias", "forces", "T"])
    yd = list(rates.values())
    np.testing.assert_allclose(numbers["T"], found.tangent, rtol=0, atol=1e-12)
    np.testing.assert_allclose(numbers["metric"], found.metric, rtol=0, atol=1e-12)
    bias = np.einsum("ijk,j,k->i", found.christoffel, yd, yd)
    np.testing.assert_allclose(numbers["bias"], bias, rtol=0, atol=1e-12 * np.abs(bias).max())
    np.testing.assert_allclose(numbers["forces"], found.forces, rtol=0, atol=1e-12 * np.abs(found.forces).max())


def test_the_squeezer_starts_as_published() -> None:
    known = json.loads((Path(__file__).parent.parent / "reference" / "andrews-squeezer.json").read_text())
    ends = [{"name": f"p{k}", "type": "ball", "from": f"x.end{k}", "to": "x.end3"} for k in (2, 4, 6)]
    model = closed_entry("andrews-squeezer", ends)
    start = {f"x.{name}": x for name, x in zip(known["coordinates"], known["start"], strict=True)}
    found = reduced_equations(model, independent=["x.beta"], start=start)
    assert found.is_right, found
    place = [model.coordinates.index(name) for name in start]
    np.testing.assert_allclose(found.qdd[place], known["start_acceleration"], rtol=1e-7, atol=1e-2)
    assert set(SQUEEZER) == set(known["coordinates"])


def test_the_five_bar_arm_has_the_textbook_equations() -> None:
    """Two inertias that no position changes, no velocity forces (Spong, Hutchinson and Vidyasagar, 2006)."""
    tree = {
        "name": "t",
        "gravity": [0, -9.81, 0],
        "instances": [{"name": "x", "substructure": "five-bar", "level": "full"}],
    }
    model = couple(TreeSpec.read(tree), {"x": shipped_part("five-bar")})
    p = {name: float(x["value"]) for name, x in catalogue.load("five-bar")["parameters"].items()}
    d11 = p["m1"] * p["c1"] ** 2 + p["m3"] * p["c3"] ** 2 + p["m4"] * p["l1"] ** 2 + p["I1"] + p["I3"]
    d22 = p["m2"] * p["c2"] ** 2 + p["m3"] * p["l2"] ** 2 + p["m4"] * p["c4"] ** 2 + p["I2"] + p["I4"]
    found = reduced_equations(model, {"x.q1": 0.2, "x.q2": 1.9}, qd={"x.q1": 1, "x.q2": -2})
    assert found.is_right, found
    np.testing.assert_allclose(found.q, [0.2, 1.9, -1.7, 1.7], atol=1e-13)
    np.testing.assert_allclose(found.metric, np.diag([d11, d22]), atol=1e-13)
    np.testing.assert_allclose(found.christoffel, 0, atol=1e-12)
    first = p["m1"] * p["c1"] + p["m3"] * p["c3"] + p["m4"] * p["l1"]
    second = p["m2"] * p["c2"] + p["m3"] * p["l2"] - p["m4"] * p["c4"]
    wanted = [-9.81 * np.cos(0.2) * first, -9.81 * np.cos(1.9) * second]
    np.testing.assert_allclose(found.forces, wanted, atol=1e-12)


def test_singular_places_bound_what_is_reached_and_are_named() -> None:
    """The rocker turns as far as crank and coupler are in line; a parallelogram branches where it is flat."""
    last = np.pi - np.arccos((L0**2 + L3**2 - (L2 - L1) ** 2) / (2 * L0 * L3))
    inside = reduced_equations(linkage(), {"x.rocker": last - 0.01}, independent=["x.rocker"])
    assert inside.is_right, inside
    beyond = reduced_equations(linkage(), {"x.rocker": last + 0.01}, independent=["x.rocker"])
    assert beyond.is_right is None
    assert float(beyond.message.split("x.rocker = ")[1].split(",")[0]) == pytest.approx(last, abs=1e-6)
    flat = parallelogram()
    crank = flat.coordinates[0]
    start = dict(zip(flat.coordinates, [1.0, 1.0], strict=True))
    assert reduced_equations(flat, {crank: 2.9}, independent=[crank], start=start).is_right
    stopped = reduced_equations(flat, {crank: 3.4}, independent=[crank], start=start)
    assert float(stopped.message.split(f"{crank} = ")[1].split(",")[0]) == pytest.approx(np.pi, abs=1e-4)


@pytest.mark.parametrize(
    ("asked", "place", "code"),
    [
        ({"q": {"x.crank": 9}}, "/q/x.crank", "out-of-range"),
        ({"q": {"x.rocker": 1}}, "/q/x.rocker", "not-independent"),
        ({"q": [1]}, "/q", "object-expected"),
        ({"q": {"x.crank": [1, 2]}, "qd": {"x.crank": [1, 2, 3]}}, "/q", "wrong-length"),
        ({"q": {"x.crank": []}}, "/q", "wrong-length"),
        ({"q": {"x.crank": [1, 9]}}, "/q/x.crank", "out-of-range"),
        ({"qd": {"x.crank": np.nan}}, "/qd/x.crank", "number-not-finite"),
        ({"independent": ["x.crank", "x.rocker"]}, "/independent", "wrong-number"),
        ({"independent": ["x.cronk"]}, "/independent/0", "unknown-coordinate"),
        ({"start": {"x.cronk": 1}}, "/start/x.cronk", "unknown-coordinate"),
    ],
)
def test_what_is_asked_wrongly(asked: Plain, place: str, code: str) -> None:
    with pytest.raises(InvalidInput) as raised:
        reduced_equations(linkage(), **asked)
    assert [(fault.pointer, fault.code) for fault in raised.value.faults] == [(place, code)]


def test_what_the_definitions_do_not_say() -> None:
    """Without closures there is nothing to reduce; with some that no part names coordinates for, the request has to."""
    arm = couple(
        TreeSpec.read({"name": "t", "instances": [{"name": "x", "substructure": "five-bar", "level": "full"}]}),
        {"x": derive({**catalogue.load("five-bar"), "independent": [], "start": {}})},
    )
    for model, code in ((arm, "missing"), (closed_entry("four-bar", []), "not-of-tree")):
        with pytest.raises(InvalidInput) as raised:
            reduced_equations(model)
        assert raised.value.faults[0].code == code
    open_start = reduced_equations(linkage(), {"x.crank": 1}, parameters={"x.l0": 2})
    assert "at the start the closures cannot be met" in open_start.message


@pytest.mark.parametrize(
    ("change", "place", "code"),
    [
        ({"independent": ["cronk"], "ranges": {}}, "/independent/0", "unknown-coordinate"),
        ({"independent": ["crank", "crank"]}, "/independent/1", "duplicate-name"),
        ({"independent": ["crank", "coupler", "rocker"]}, "/independent", "none-dependent"),
        ({"start": {"cronk": 1}}, "/start/cronk", "unknown-coordinate"),
        ({"start": {"crank": "l1"}}, "/start/crank", "unknown-name"),
        ({"start": {"crank": {"value": 1, "unit": "m"}}}, "/start/crank", "unit-mismatch"),
        ({"ranges": {"rocker": [0, 1]}}, "/ranges/rocker", "not-independent"),
        ({"ranges": {"crank": [1, "1"]}}, "/ranges/crank", "empty-range"),
        ({"closures": [], "ranges": {}, "start": {}}, "/independent", "no-closures"),
    ],
)
def test_faults_of_definitions_have_their_place(change: Plain, place: str, code: str) -> None:
    with pytest.raises(InvalidDocument) as raised:
        derive({**LINKAGE, **change})
    assert [(fault.pointer, fault.code) for fault in raised.value.faults] == [(place, code)]


def test_what_a_model_says_of_them_is_certified() -> None:
    """Also as it comes out of a store."""
    model, parts = linkage(), {"x": derived_once(LINKAGE)}
    tree = {
        "name": "loop",
        "gravity": [0, -9.81, 0],
        "instances": [{"name": "x", "substructure": "linkage", "level": "full"}],
    }
    definitions = {name: part.definition for name, part in parts.items()}
    summary = json.loads(json.dumps(model.described()))
    assert certify_tree(TreeSpec.read(tree), definitions, summary, model.program)["direct_form"]
    assert Model.load({**model.summary(), **summary}, model.program.to_bytes()).reduction == model.reduction
    summary["reduction"]["start"]["x.crank"] = "2"
    with pytest.raises(VerificationFailed, match="reduction"):
        certify_tree(TreeSpec.read(tree), definitions, summary, model.program)


def test_a_published_tree_says_it_too() -> None:
    parts = {"a": derived_once(LINKAGE), "p": shipped_part("simple-pendulum")}
    instances = [
        {"name": "p", "substructure": "p", "at": "a.rocker"},
        {"name": "a", "substructure": "linkage", "level": "full"},
    ]
    tree = {"name": "t", "gravity": [0, -9.81, 0], "instances": instances}
    spec = TreeSpec.read(tree)
    part = published_part(published(spec, parts, Publication({"name": "whole"})), parts)
    assert part.definition.independent == ("a_crank", "p_q1")
    mounted = {**tree, "instances": [{"name": "w", "substructure": "whole", "level": "full"}]}
    whole = couple(TreeSpec.read(mounted), {"w": part})
    found = reduced_equations(whole, {"w.a_crank": 2.0, "w.p_q1": 0.3})
    other = reduced_equations(couple(spec, parts), {"a.crank": 2.0, "p.q1": 0.3})
    np.testing.assert_allclose(found.metric, other.metric, rtol=1e-12)
    np.testing.assert_allclose(found.accelerations, other.accelerations, rtol=1e-10)
    rod = {"name": "rod", "type": "rod", "from": "p.base", "to": "a.crank", "length": 1}
    loose = published(TreeSpec.read({**tree, "closures": [rod]}), parts, Publication({"name": "whole"})).definition
    assert (loose.independent, dict(loose.ranges), set(loose.start)) == ((), {}, {"a_crank", "a_coupler", "a_rocker"})
