"""The shipped substructures: well formed, physical, and equal to what was published."""

from __future__ import annotations

import ast
import json
import math
import operator
import re
from itertools import pairwise
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from substructures import couple, derive
from substructures.catalogue import load, load_tree, names
from substructures.definition import Definition
from substructures.evaluation import evaluate
from substructures.expr.expand import is_zero
from substructures.expr.graph import Expr, Graph
from substructures.expr.parse import parse
from substructures.expr.replay import replay
from substructures.model import Model
from substructures.part import Part
from substructures.tree import TreeSpec

ENTRIES = pytest.mark.parametrize("name", names())
REFERENCE = Path(__file__).parent / "reference"

#: published moments of inertia that no rigid body can have, kept as published
NOT_PHYSICAL = {("puma560", "link1"), ("puma560", "link3")}

HUMANOID = [(i["name"], i["substructure"], i["at"]) for i in load_tree("humanoid")["instances"]]

FUNCTIONS = {"sin": math.sin, "cos": math.cos, "tan": math.tan, "sqrt": math.sqrt}
OPERATORS: dict[type[ast.AST], Any] = {
    ast.Add: operator.add,
    ast.Sub: operator.sub,
    ast.Mult: operator.mul,
    ast.Div: operator.truediv,
    ast.Pow: operator.pow,
    ast.USub: operator.neg,
}


def number(value: Any, names_: dict[str, float]) -> float:
    """A number or expression of a definition, by a walk over Python's syntax tree (independent of the package)."""
    if not isinstance(value, str):
        return float(value)

    def walk(node: Any) -> float:
        match node:
            case ast.BinOp(left=left, op=op, right=right):
                return float(OPERATORS[type(op)](walk(left), walk(right)))
            case ast.UnaryOp(op=op, operand=operand):
                return float(OPERATORS[type(op)](walk(operand)))
            case ast.Call(func=ast.Name(id=function), args=[argument]):
                return FUNCTIONS[function](walk(argument))
            case ast.Name(id=name):
                return names_[name]
        return float(node.value)

    return walk(ast.parse(value.replace("^", "**"), mode="eval").body)


def defaults(entry: dict[str, Any]) -> dict[str, float]:
    constants = {"pi": math.pi}
    return constants | {name: number(p["value"], constants) for name, p in entry["parameters"].items()}


def strings(data: Any) -> list[str]:
    if isinstance(data, dict):
        data = list(data.values())
    if isinstance(data, list):
        return [text for item in data for text in strings(item)]
    return [data] if isinstance(data, str) else []


def mounted(*instances: tuple[str, str, str], gravity: str | None = "g") -> Model:
    """A tree of catalogue entries (instance, entry, at) under gravity along -z."""
    parts = {instance: derive(Definition.read(load(entry))) for instance, entry, _ in instances}
    tree: dict[str, Any] = {
        "name": "tree",
        "gravity": [0, 0, f"-{gravity}"] if gravity else [0, 0, 0],
        "parameters": {gravity: {"value": 9.81, "unit": "m/s^2"}} if gravity else {},
        "instances": [{"name": i, "substructure": entry, "at": at} for i, entry, at in instances],
    }
    return couple(TreeSpec.read(tree), parts)


def reference(name: str) -> dict[str, Any]:
    data: dict[str, Any] = json.loads((REFERENCE / f"{name}.json").read_text())
    return data


# --- the files


def test_enough_entries() -> None:
    assert len(names()) >= 28
    assert list(names()) == sorted(names())
    with pytest.raises(KeyError, match="no catalogue entry 'nothing'"):
        load("nothing")


@ENTRIES
def test_entry_is_complete(name: str) -> None:
    entry = load(name)
    assert entry["name"] == name
    assert entry["license"] == "CC0-1.0"
    for key in ("title", "description", "source"):
        assert len(entry[key]) >= 10
    assert entry["tags"]
    assert entry["ports"]
    for parameter in entry["parameters"].values():
        assert parameter["unit"]
        assert parameter["description"]
    Definition.read(entry)


@ENTRIES
def test_names_are_used_and_known(name: str) -> None:
    entry = load(name)
    parameters, inputs = set(entry["parameters"]), set(entry.get("inputs", ()))
    words = "placement axis psi theta d sigma phi tau stiffness rest damping armature limits mass com inertia position"
    numeric = f"{words} rotation at vector force length".split()

    def expressions(data: Any) -> list[str]:
        if isinstance(data, list):
            return [text for item in data for text in expressions(item)]
        if not isinstance(data, dict):
            return []
        return [t for key, value in data.items() for t in (strings(value) if key in numeric else expressions(value))]

    texts = [text for key in ("bodies", "ports", "loads") for text in expressions(entry.get(key, []))]
    found = {word for text in texts for word in re.findall(r"[A-Za-z]\w*", text)} - {"pi", "sin", "cos", "sqrt"}
    assert found == parameters | inputs


@ENTRIES
def test_default_values_are_physical(name: str) -> None:
    entry = load(name)
    values = defaults(entry)
    for body in entry["bodies"]:
        mass = number(body.get("mass", 0), values)
        assert mass >= 0
        t = {k: number(v, values) for k, v in body.get("inertia", {}).items()}
        xy, xz, yz = (t.get(k, 0.0) for k in ("xy", "xz", "yz"))
        moments = np.linalg.eigvalsh(
            [[t.get("xx", 0.0), xy, xz], [xy, t.get("yy", 0.0), yz], [xz, yz, t.get("zz", 0.0)]]
        )
        physical = moments[0] >= 0 and moments[0] + moments[1] >= moments[2] * (1 - 1e-12)
        assert physical != ((name, body["name"]) in NOT_PHYSICAL)


# --- what is derived from them


@pytest.fixture(scope="module", params=names())
def part(request: pytest.FixtureRequest) -> Part:
    return derive(Definition.read(load(request.param)))


def test_entry_derives(part: Part) -> None:
    assert part.dof == len(part.coordinates) == len(part.joints)
    assert part.ports == tuple(port["name"] for port in load(part.name)["ports"])
    assert Part.load(part.definition, part.program.to_bytes(), part.certificate).program == part.program


def test_metric_is_positive_definite_at_the_default_values(part: Part) -> None:
    model = couple(
        TreeSpec.read(
            {
                "name": "one",
                "gravity": [0, 0, 0],
                "instances": [{"name": "x", "substructure": part.name, "at": "world"}],
            }
        ),
        {"x": part},
    )
    if not part.dof:
        assert model.coordinates == ()
        return
    q = np.random.default_rng(5).uniform(-1, 1, (3, part.dof)).tolist()
    answer = evaluate(model, {"quantities": ["metric", "forces"], "q": q, "qd": q})
    assert np.all(np.linalg.eigvalsh(np.array(answer["metric"])) > 0)
    assert np.isfinite(np.array(answer["forces"])).all()


def exact(model: Model, instance: str, output: str) -> tuple[Graph, dict[tuple[int, ...], Expr], Any]:
    """An output as expressions, and a reader of reference formulas in the names of the instance."""
    graph = Graph()
    formulas = replay(model.program, graph, {}, [output])[output].entries
    entries = {index: graph.zero + entry for index, entry in formulas.items()}

    def read(text: str) -> Expr:
        return parse(graph, text, lambda name: graph.symbol(name if name == "g" else f"{instance}.{name}"))

    return graph, entries, read


def filled(model: Model, output: str, entries: dict[tuple[int, ...], Expr]) -> dict[tuple[int, ...], Expr]:
    """All elements, those that follow from the symmetry included."""
    o = model.program.outputs[output]
    return {i: entries[o.index[o.entries.index(e)]] * sign for i, e, sign in o.expanded()}


@pytest.mark.parametrize("name", ["simple-pendulum", "acrobot", "cart-pendulum", "andrews-squeezer"])
@pytest.mark.parametrize("quantity", ["metric", "christoffel"])
def test_published_formulas(name: str, quantity: str) -> None:
    known = reference(name)
    if quantity not in known:
        return
    model = mounted(("x", name, "world"), gravity=None)
    place = [model.coordinates.index(f"x.{c}") for c in known["coordinates"]]
    graph, entries, read = exact(model, "x", quantity)
    found = filled(model, quantity, entries)
    expected = {}
    for key, text in known[quantity].items():
        index = tuple(place[int(i)] for i in key.split(","))
        expected[index] = read(text)
        if quantity == "metric":
            expected[index[::-1]] = expected[index]
    for index in found | expected:
        assert is_zero(found.get(index, graph.zero) - expected.get(index, graph.zero)), index


@pytest.mark.parametrize("name", ["simple-pendulum", "acrobot", "cart-pendulum"])
def test_published_gravity(name: str) -> None:
    known = reference(name)
    model = mounted(("x", name, "world"))
    rng = np.random.default_rng(7)
    for _ in range(3):
        values = {p: float(rng.uniform(0.5, 2)) for p in load(name)["parameters"]} | {"g": 9.81}
        q = {c: float(rng.uniform(-3, 3)) for c in known["coordinates"]}
        answer = evaluate(
            model,
            {
                "quantities": ["gravity"],
                "q": [q[c.removeprefix("x.")] for c in model.coordinates],
                "parameters": {(p if p == "g" else f"x.{p}"): v for p, v in values.items()},
            },
        )
        expected = [number(text, values | q) for text in known["gravity"]]
        np.testing.assert_allclose(answer["gravity"], expected, rtol=1e-12, atol=1e-12)


def test_puma_560_as_published() -> None:
    known = reference("puma560")
    model = mounted(("arm", "puma560", "world"))
    request = {
        "quantities": ["metric", "coriolis", "gravity", "inverse_dynamics"],
        "q": [number(q, {"pi": math.pi}) for q in known["q"]],
        "qd": known["qd"],
        "qdd": known["qdd"],
    }
    answer = evaluate(model, request)
    close = {"rtol": 0, "atol": known["tolerance"]}
    np.testing.assert_allclose(answer["metric"], known["metric"], **close)
    np.testing.assert_allclose(answer["coriolis"], known["coriolis"], **close)
    np.testing.assert_allclose(np.negative(answer["gravity"]), known["gravity"], **close)
    inertial = np.array(answer["metric"]) @ known["qdd"]
    np.testing.assert_allclose(inertial, known["inertial_torque"], **close)


@pytest.mark.parametrize("case", reference("robots")["cases"], ids=lambda case: case["entry"])
def test_robots_as_published(case: dict[str, Any]) -> None:
    """The figures in the frames they were published in, through another engine, and in the frames of the entry."""
    model = mounted(("x", case["entry"], "world"))
    request = {key: case[key] for key in ("q", "qd")} | {"quantities": ["metric", "bias", "gravity"]}
    answer = evaluate(model, request | {"parameters": {f"x.{name}": v for name, v in case["parameters"].items()}})
    for quantity in ("metric", "bias", "gravity"):
        np.testing.assert_allclose(answer[quantity], case[quantity], rtol=1e-10, atol=1e-11)


def test_andrews_squeezer_starts_as_published() -> None:
    """The accelerations of the closed mechanism at the start, its closures cut from the reference."""
    known = reference("andrews-squeezer")
    entry = load("andrews-squeezer")
    values, order = defaults(entry), known["coordinates"]
    model = mounted(("x", "andrews-squeezer", "world"), gravity=None)
    place = [model.coordinates.index(f"x.{c}") for c in order]
    q = np.zeros(7)
    q[place] = known["start"]
    answer = evaluate(model, {"quantities": ["metric", "forces"], "q": q.tolist(), "qd": [0.0] * 7})
    metric = np.array(answer["metric"])[np.ix_(place, place)]
    forces = np.array(answer["forces"])[place]

    def closures(angles: Any) -> Any:
        names_ = values | dict(zip(order, angles, strict=True))
        return np.array([number(text, names_) for text in known["closures"]])

    start, step = np.array(known["start"]), 1e-5
    assert np.abs(closures(start)).max() < 1e-15
    jacobian = np.array([(closures(start + step * e) - closures(start - step * e)) / (2 * step) for e in np.eye(7)]).T
    matrix = np.block([[metric, jacobian.T], [jacobian, np.zeros((6, 6))]])
    acceleration = np.linalg.solve(matrix, np.concatenate([forces, np.zeros(6)]))[:7]
    np.testing.assert_allclose(acceleration, known["start_acceleration"], rtol=1e-7, atol=1e-2)


def test_the_limbs_make_a_humanoid() -> None:
    model = mounted(*HUMANOID)
    assert len(model.coordinates) == 34
    q = np.random.default_rng(2).uniform(-0.5, 0.5, 34)
    answer = evaluate(model, {"quantities": ["metric", "gravity"], "q": q.tolist()})
    metric = np.array(answer["metric"])
    assert np.all(np.linalg.eigvalsh(metric) > 0)
    # the three translations carry the whole mass: the fractions of the segments add up to one
    np.testing.assert_allclose(np.diag(metric)[:3], 73, rtol=1e-12)
    np.testing.assert_allclose(answer["gravity"][:3], [0, 0, -73 * 9.81], rtol=1e-12)


def test_four_legs_make_a_quadruped() -> None:
    """Side and front mirror the published tensors: the stretched robot is symmetric but for its trunk."""
    corners = [("fl", "front_left"), ("fr", "front_right"), ("rl", "rear_left"), ("rr", "rear_right")]
    instances: list[dict[str, Any]] = [{"name": "trunk", "substructure": "quadruped-trunk", "at": "world"}]
    for leg, port in corners:
        signs = {"front": 1 if leg[0] == "f" else -1, "side": 1 if leg[1] == "l" else -1}
        instances.append({"name": leg, "substructure": "quadruped-leg", "at": f"trunk.{port}", "parameters": signs})
    parts = {i["name"]: derive(Definition.read(load(i["substructure"]))) for i in instances}
    model = couple(TreeSpec.read({"name": "quadruped", "gravity": [0, 0, 0], "instances": instances}), parts)
    assert len(model.coordinates) == 18
    metric = np.array(evaluate(model, {"quantities": ["metric"], "q": [0.0] * 18})["metric"])
    legs = [metric[np.ix_(i, i)] for i in (range(6 + 3 * k, 9 + 3 * k) for k in range(4))]
    mirror = np.diag([-1.0, 1, 1])
    np.testing.assert_allclose(legs[0], mirror @ legs[1] @ mirror, rtol=1e-12, atol=1e-15)
    for one, other in pairwise(legs):
        np.testing.assert_allclose(np.diag(one)[1:], np.diag(other)[1:], rtol=1e-12)
