"""The regressor times the inertial parameters is inverse dynamics; its columns are derivatives of it."""

# ruff: noqa: N806 -- symbols of the notation

from __future__ import annotations

from itertools import product
from typing import Any

import independent
import numpy as np
import pytest
from ball_trees import random_position
from catalogue_entries import all_entries, shipped_part
from in_depth import seeds
from random_cuts import all_cuts, cut_tree
from random_trees import GRAVITY, Kind, Plain, random_definition, random_states, tree_of, with_parameters

from substructures import MissingValue, Part, TooLarge, TreeSpec, couple, derive
from substructures.errors import InvalidArgument
from substructures.expr.differentiate import derivative
from substructures.expr.graph import Expr, Graph
from substructures.expr.interpret import interpret
from substructures.expr.replay import replay
from substructures.quantities.formulas import derived
from substructures.quantities.numbers.defaults import default_number
from substructures.quantities.numbers.evaluation import evaluate
from substructures.quantities.regressor import regressor
from substructures.quantities.regressor_model import RegressorModel
from substructures.quantities.sources import Sources

N = 3
TEN = ("m", "sx", "sy", "sz", "Jxx", "Jyy", "Jzz", "Jxy", "Jxz", "Jyz")


def of(tree: Plain) -> tuple[TreeSpec, dict[str, Part]]:
    """A tree document with its parts."""
    spec = TreeSpec.read(tree)
    parts = {i.name: shipped_part(i.substructure) if i.substructure else derive(i.definition) for i in spec.instances}
    return spec, parts


def inverse_dynamics(spec: TreeSpec, parts: dict[str, Part], states: Plain, armature: Any) -> Any:
    """g q'' + bias - gravity forces from the coupled model, without rotors."""
    model = couple(spec, parts)
    known = {name: x for name, x in states.get("parameters", {}).items() if name in model.parameters}
    answer = evaluate(model, ["metric", "bias", "gravity"], **(states | {"parameters": known}))
    inertial = np.einsum("nab,nb->na", answer["metric"], states["qdd"]) - armature * states["qdd"]
    return inertial + answer["bias"] - answer["gravity"]


def check(spec: TreeSpec, parts: dict[str, Part], armature: Any) -> RegressorModel:
    Y = regressor(spec, parts)
    n, rng, model = len(Y.coordinates), np.random.default_rng(len(Y.coordinates)), couple(spec, parts)
    states = random_states(rng, N, n)
    if model.balls:
        states["q"] = np.array([random_position(rng, model) for _ in range(N)])
    expected = inverse_dynamics(spec, parts, states, armature)
    found = Y.evaluate(**states)
    assert found["regressor"].shape == (N, n, len(Y.names))
    assert found["inertial_parameters"].shape == (N, len(Y.names))
    assert len(Y.names) == len(Y.units) == len(set(Y.names))
    force = np.einsum("nai,ni->na", found["regressor"], found["inertial_parameters"])
    np.testing.assert_allclose(force, expected, rtol=0, atol=1e-11 * max(float(np.abs(expected).max(initial=0)), 1))
    return Y


def rotors(part: Part) -> Any:
    """The armature of a part at the defaults of its parameters, by coordinate: mu^2 I of what it moves."""
    values = {name: default_number(p["value"]) for name, p in part.parameters.items()}
    found = interpret(part.program, values, ["armature", *part.program.outputs.keys() & {"multiplier"}])
    sums = np.zeros(len(part.coordinates))
    np.add.at(sums, list(part.topology.moved_by), found["armature"] * found.get("multiplier", 1) ** 2)
    return sums


@pytest.mark.parametrize("name", all_entries())
def test_catalogue(name: str) -> None:
    one = {"name": "x", "substructure": name, "level": "full"}
    spec, parts = of({"name": "t", "gravity": [0.3, -1, -9.81], "instances": [one]})
    Y = check(spec, parts, rotors(parts["x"]))
    links = dict.fromkeys(entry.rsplit(".", 1)[0] for entry in Y.names)
    assert Y.names == tuple(f"{link}.{entry}" for link in links for entry in TEN)
    assert Y.parameters.keys() == {s.name for s in Y.program.symbols if s.kind == "parameter"}


@pytest.mark.parametrize("number", seeds(4, 8))
def test_random_trees_in_pieces(number: int) -> None:
    """One part, and the same mechanism cut somewhere; every other one with parameters."""
    rng = np.random.default_rng(4200 + number)
    definition = random_definition(rng, Kind(5, chain=bool(number % 3 == 0)))
    document = with_parameters(rng, definition, 0.5 * (number % 2))
    cuts = list(all_cuts(definition))
    whole = of(tree_of(document).model_dump(by_alias=True, exclude_defaults=True))
    for tree in (whole, *(of(cut_tree(rng, document, cuts[i])) for i in (int(rng.integers(1, 32)),))):
        names = [c.split(".")[1] for c in regressor(*tree).coordinates]
        check(*tree, independent.by_coordinate(definition, "armature", names))


JOINTS: list[Plain] = [
    {"type": "revolute", "coordinate": "q1", "theta": 0.4, "d": 0.3, "tau": 0.2},
    {"type": "prismatic", "coordinate": "q2", "theta": "pi/3", "d": 0.5, "phi": 0.2},
    {"type": "revolute", "coordinate": "q3", "placement": {"position": [0.1, 0.2, 0.3]}, "axis": [1, 0, 0]},
]
PLACES = ("m", "sx", "sy", "sz", "Txx", "Tyy", "Tzz", "Txy", "Txz", "Tyz")


def symbolic(k: int, joint: Plain) -> Plain:
    """A body with m, s and the inertia tensor about the origin of its frame as parameters."""
    parent = f"b{k - 1}" if k > 1 else "base"
    tensor = {place[1:]: f"{place}{k}" for place in PLACES[4:]}
    com = [f"s{x}{k}/m{k}" for x in "xyz"]
    inertial = {"mass": f"m{k}", "com": com, "inertia": tensor | {"about": "origin"}}
    return {"name": f"b{k}", "parent": parent, "joint": joint} | inertial


SYMBOLIC: Plain = {
    "name": "symbolic",
    "parameters": {f"{place}{k}": {} for k in (1, 2, 3) for place in PLACES},
    "bodies": [symbolic(k, joint) for k, joint in enumerate(JOINTS, 1)],
}


def test_columns_are_the_derivatives_of_inverse_dynamics() -> None:
    """As formulas, equal as functions: with m, s and Theta as symbols, J = tr(Theta)/2 - Theta."""
    spec, parts = of(
        {"name": "t", "gravity": ["1/3", -2, "-9.81"], "instances": [{"name": "x", "definition": SYMBOLIC}]},
    )
    Y, graph = regressor(spec, parts), Graph()
    rows = replay(derived(couple(spec, parts), "inverse_dynamics"), graph, {})["inverse_dynamics"].entries
    columns = replay(Y.program, graph, {}, ["regressor"])["regressor"].entries
    assert not any(s.name.split(".")[-1][0] in "msT" for s in Y.program.select(["regressor"]).symbols)
    for a, k in product(range(3), (1, 2, 3)):
        row = rows[(a,)]
        assert isinstance(row, Expr)
        column = {e: columns.get((a, Y.names.index(f"x.b{k}.{e}")), 0) + graph.zero for e in TEN}
        slope = {e: derivative(row, f"x.{e}{k}") for e in PLACES}
        assert all((slope[e] - column[e]).is_zero for e in ("m", "sx", "sy", "sz"))
        assert all((slope[f"T{e}"] + column[f"J{e}"]).is_zero for e in ("xy", "xz", "yz"))
        trace = (column["Jxx"] + column["Jyy"] + column["Jzz"]) / 2
        assert all((slope[f"T{e}"] - trace + column[f"J{e}"]).is_zero for e in ("xx", "yy", "zz"))


def test_linear_in_parameters_that_are_given_later() -> None:
    """Y stays the same for other masses, Y pi follows inverse dynamics, and pi is linear."""
    spec, parts = of(
        {"name": "t", "gravity": [0, 0, "-9.81"], "instances": [{"name": "x", "definition": SYMBOLIC}]},
    )
    Y, states = regressor(spec, parts), random_states(np.random.default_rng(1), N, 3)
    with pytest.raises(MissingValue):
        Y.evaluate(**states)
    rng = np.random.default_rng(2)
    one, two = ({name: float(rng.uniform(1, 2)) for name in Y.parameters} for _ in range(2))
    both = {name: one[name] + two[name] for name in one}
    a, b, c = (Y.evaluate(**states, parameters=p) for p in (one, two, both))
    assert np.array_equal(a["regressor"], b["regressor"])
    pi = [x["inertial_parameters"] for x in (a, b, c)]
    np.testing.assert_allclose(pi[0] + pi[1], pi[2], rtol=1e-13)
    expected = inverse_dynamics(spec, parts, states | {"parameters": two}, 0)
    np.testing.assert_allclose(np.einsum("nai,ni->na", b["regressor"], pi[1]), expected, rtol=1e-11)


def test_zero_and_equal_columns() -> None:
    """Of its first link a base joint about the vertical sees Jxx + Jyy alone; of a later joint a link feels nothing."""
    spec, parts = of(
        {"name": "t", "gravity": [0, 0, "-9.81"], "instances": [{"name": "arm", "substructure": "ur5"}]},
    )
    Y = regressor(spec, parts)
    output = Y.program.outputs["regressor"]
    first = {Y.names[i].split(".")[-1]: e for (_, i), e in zip(output.index, output.entries, strict=True) if i < 10}
    assert first.keys() == {"Jxx", "Jyy"}
    assert first["Jxx"] == first["Jyy"]
    assert all(a <= i // 10 for a, i in output.index)


def test_compound_joints_and_fixed_bodies() -> None:
    """Massless bodies inside compound joints are no links; fixed bodies belong to what carries them."""
    joint = {"type": "free", "coordinate": ["x", "y", "z", "a", "b", "c"]}
    body = {"mass": 2, "com": [0.1, 0, 0], "inertia": {"xx": 1, "yy": 2, "zz": 2.5}}
    definition: Plain = {
        "name": "flier",
        "bodies": [
            {"name": "ground", "parent": "base", "joint": {"type": "fixed"}, "mass": 3},
            {"name": "hull", "parent": "base", "joint": joint, **body},
            {"name": "box", "parent": "hull", "joint": {"type": "fixed", "d": 1}, **body},
        ],
    }
    spec, parts = of({"name": "t", "gravity": GRAVITY, "instances": [{"name": "x", "definition": definition}]})
    Y = check(spec, parts, 0)
    assert Y.names == tuple(f"x.hull.{e}" for e in TEN)
    assert Y.units == ("kg", *["kg m"] * 3, *["kg m^2"] * 6)
    still = dict.fromkeys(("q", "qd", "qdd"), np.zeros(6))
    assert Y.evaluate(**still)["inertial_parameters"][:2] == pytest.approx([4, 2 * 0.1 + 2 * 1.1])


def test_what_is_fixed_to_a_mounted_interface_is_a_link() -> None:
    port = shipped_part("ur5").ports[0]
    tree = [
        {"name": "arm", "substructure": "ur5"},
        {"name": "tool", "substructure": "flange-tool", "at": f"arm.{port}"},
    ]
    spec, parts = of({"name": "t", "gravity": GRAVITY, "instances": tree})
    Y = check(spec, parts, 0)
    assert Y.names[-10:] == tuple(f"tool.base.{e}" for e in TEN)
    assert {name for name in Y.parameters if name.startswith("tool.")} >= {"tool.m", "tool.cx", "tool.Ixx"}


def test_parameters_that_the_motion_does_not_feel() -> None:
    """A wheel about its axis: Theta_xx is no parameter of the model, but J_xx = (Theta_yy + Theta_zz - Theta_xx)/2."""
    wheel = {"name": "wheel", "parent": "base", "joint": {"type": "revolute"}, "mass": 1}
    definition = {
        "name": "wheel",
        "parameters": {"a": {"value": 1}},
        "bodies": [wheel | {"inertia": {"xx": "a", "yy": 1, "zz": 1}}],
    }
    spec, parts = of({"name": "t", "instances": [{"name": "x", "definition": definition}]})
    model = couple(spec, parts)
    sources = Sources(model, of_parts=lambda _: regressor(spec, parts))
    assert "x.a" not in model.effective
    request = {"quantities": ["inertial_parameters"], "q": [0], "parameters": {"x.a": 0.5}}
    found = evaluate(sources, **request)
    assert found["inertial_parameters"][4] == 0.75
    assert [warning["code"] for warning in found.warnings] == ["gravity-not-given"]
    found = evaluate(sources, **request | {"quantities": ["metric"]})
    assert [warning["code"] for warning in found.warnings] == ["gravity-not-given", "no-effect"]


def test_an_interface_that_carries_nothing_is_no_link() -> None:
    arms = [
        {"name": "a", "substructure": "planar-2r"},
        {"name": "b", "substructure": "planar-2r", "at": "a.flange"},
    ]
    spec, parts = of({"name": "t", "gravity": GRAVITY, "instances": arms})
    links = [name.rsplit(".", 1)[0] for name in check(spec, parts, 0).names[::10]]
    assert links == [f"{arm}.{body}" for arm in "ab" for body in parts["a"].bodies]


def test_refusals() -> None:
    spec, parts = of({"name": "t", "instances": [{"name": "x", "substructure": "planar-2r"}]})
    with pytest.raises(TooLarge):
        regressor(spec, parts, max_nodes=10)
    with pytest.raises(InvalidArgument) as error:
        regressor(spec, parts).evaluate(q=[0, 0])
    assert error.value.faults[0].pointer == "/qdd"
