"""Closures: their formulas against exact derivatives, the joints they stand for, documents and their faults."""

# ruff: noqa: N806 -- symbols of the notation

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
from catalogue_entries import shipped_part
from in_depth import seeds
from random_trees import GRAVITY, Kind, Plain, random_definition, random_states, vector

from substructures import Definition, InvalidDocument, Model, TreeSpec, couple, derive
from substructures.expr.differentiate import gradient
from substructures.expr.graph import Expr, Graph
from substructures.expr.interpret import interpret
from substructures.expr.program import Program, array, program
from substructures.expr.replay import replay
from substructures.mechanics.cut_joints import ROWS

TYPES = tuple(ROWS)


def closed_model(seed: int, bare: bool = False) -> Model:
    """A random tree of two random parts, one on the other, with a closure of every type between random frames.

    ``bare``: all of them between the last frames of the parts, without placement and axis.
    """
    rng = np.random.default_rng(seed)
    definitions = [random_definition(rng, Kind(3, depth=5), f"part{i}") for i in range(2)]
    parts = {f"x{i}": derive(Definition.read(d)) for i, d in enumerate(definitions)}
    frames = [f"{name}.{frame}" for name, part in parts.items() for frame in part.frames]
    second = {"name": "x1", "definition": definitions[1], "at": f"x0.{parts['x0'].frames[-1]}"}
    closures = []
    for k, kind in enumerate(TYPES):
        closure: Plain = {"name": f"c{k}", "type": kind, "from": str(rng.choice(frames))}
        closure["to"] = str(rng.choice([*frames, "world"]))
        closure["placement"] = {"position": vector(rng), "rpy": vector(rng, 3)}
        if bare:
            closure = {"name": f"c{k}", "type": kind}
            closure |= {"from": f"x0.{parts['x0'].frames[-1]}", "to": f"x1.{parts['x1'].frames[-1]}"}
        if kind == "rod":
            closure["length"] = "L/2"
        elif not bare and kind in ("pin", "planar", "universal"):
            closure["axis"] = [0.6, 0, 0.8]
        closures.append(closure)
    document = {
        "name": "loops",
        "gravity": list(GRAVITY),
        "parameters": {"L": {"value": 1.4}},
        "instances": [{"name": "x0", "definition": definitions[0]}, second],
        "closures": closures,
    }
    return couple(TreeSpec.read(document), parts)


def differentiated(model: Model) -> Program:
    """dphi/dq, and d(dphi/dq q')/dq q', by the chain rule on the graph."""
    graph = Graph()
    residual = replay(model.program, graph, {}, ["closure.residual"])["closure.residual"]
    rows = [graph.zero + residual.entries.get((k,), 0) for k in range(residual.shape[0])]
    rates = [graph.symbol(f"{name}'") for name in model.coordinates]
    G = gradient(rows, model.coordinates)
    speeds: list[Expr] = [graph.sum(x * v for x, v in zip(row, rates, strict=True)) for row in G]
    second = gradient(speeds, model.coordinates)
    total = [graph.sum(x * v for x, v in zip(row, rates, strict=True)) for row in second]
    outputs = {
        "jacobian": array((len(rows), model.dof), lambda k, a: G[k][a]),
        "acceleration": array((len(rows),), lambda k: total[k]),
    }
    symbols = {s.name: s for s in model.program.symbols}
    return program(graph, outputs, symbols)


def values(model: Model, seed: int, count: int = 3) -> Plain:
    states = random_states(np.random.default_rng(seed), count, model.dof)
    result: Plain = {"L": 1.4, "t": 0.0}
    for a, name in enumerate(model.coordinates):
        result |= {name: states["q"][:, a], f"{name}'": states["qd"][:, a]}
    return result


@pytest.mark.parametrize("seed", seeds(2, 6))
def test_cross_products_equal_derivatives(seed: int) -> None:
    model = closed_model(40 + seed)
    x = values(model, seed)
    exact = interpret(differentiated(model), x)
    names = ["closure.jacobian", "closure.acceleration"]
    found = interpret(model.program, x, names)
    for name in names:
        expected = exact[name.removeprefix("closure.")]
        np.testing.assert_allclose(found[name], expected, rtol=0, atol=1e-12 * max(1, np.abs(expected).max()))


#: what every joint leaves no freedom: places, then turns
JOINTS = {
    "revolute": "x y z rx ry",
    "prismatic": "x y rx ry rz",
    "spherical": "x y z",
    "fixed": "x y z rx ry rz",
    "cylindrical": "x y rx ry",
    "universal": "x y z cross",
    "planar": "z rx ry",
    "rod": "length",
}
SAME = {"pin": "revolute", "slider": "prismatic", "ball": "spherical", "weld": "fixed"}


def rows_by_hand(d: Any, m: Any, length: float) -> dict[str, tuple[float, Any, float]]:
    """Residual, direction and alignment of every row from d = r_B - r_A and the axes m of B, in the axes of A."""
    e = np.eye(3)
    return {
        **{name: (d[i], e[i], 0.0) for i, name in enumerate("xyz")},
        "length": ((d @ d - length**2) / (2 * length), d / length, 0.0),
        "rx": (-m[2, 1], -np.cross(m[2], e[1]), m[2, 2]),
        "ry": (m[2, 0], np.cross(m[2], e[0]), m[2, 2]),
        "rz": (m[0, 1], np.cross(m[0], e[1]), m[0, 0]),
        "cross": (m[1, 2], np.cross(m[1], e[2]), 0.0),
    }


def test_rows_from_place_and_motion_of_the_frames() -> None:
    """Also G_a = direction . (u_a or w_a): a multiplier is a force or a moment on B, its reaction acts on A."""
    model = closed_model(43, bare=True)
    x = {s.name: 0.5 for s in model.program.symbols} | {n: 0.3 + 0.1 * k for k, n in enumerate(model.coordinates)}
    out = interpret(model.program, x | {"L": 1.4})
    a, b = (model.frames.index(name) for name in (model.closures[0].start, model.closures[0].end))
    (A, B), (r_A, r_B) = out["rotation"][[a, b]], out["position"][[a, b]]
    d, M = A.T @ (r_B - r_A), A.T @ B
    w = out["Omega"][b] @ M.T - out["Omega"][a]
    u = out["U"][b] @ M.T - out["U"][a] - np.cross(out["Omega"][a], d)
    expected = rows_by_hand(d, M.T, 0.7)
    names = [name for kind in TYPES for name in JOINTS[SAME.get(kind, kind)].split()]
    assert len(out["closure.residual"]) == len(names)
    for k, name in enumerate(names):
        residual, direction, alignment = expected[name]
        np.testing.assert_allclose(out["closure.residual"][k], residual, atol=1e-15, err_msg=name)
        np.testing.assert_allclose(out["closure.direction"][k], direction, atol=1e-15, err_msg=name)
        np.testing.assert_allclose(out["closure.alignment"][k], alignment, atol=1e-15, err_msg=name)
        twists = u if name in ("x", "y", "z", "length") else w
        np.testing.assert_allclose(out["closure.jacobian"][k], twists @ direction, atol=1e-14, err_msg=name)


def defaults(model: Model) -> Plain:
    return {name: float(p["value"]) for name, p in model.parameters.items()}


def one_loop(closures: list[Plain], **more: Any) -> Model:
    part = shipped_part("four-bar")
    document = {"name": "t", "instances": [{"name": "x", "substructure": "four-bar"}], "closures": closures} | more
    return couple(TreeSpec.read(document), {"x": part})


PIN = {"name": "pin", "type": "pin", "from": "x.coupler_end", "to": "x.rocker_end"}


def test_without_closures_nothing_changes() -> None:
    """Documents of trees stay what they were, and so do all functions of the model."""
    document = {"name": "t", "instances": [{"name": "x", "substructure": "four-bar"}]}
    assert b"closures" not in TreeSpec.read(document).canonical()
    plain, looped = one_loop([]), one_loop([PIN])
    assert "closures" not in plain.summary()
    assert not [name for name in plain.program.outputs if name.startswith("closure")]
    values = {
        s.name: x for s, x in zip(plain.program.symbols, np.random.default_rng(1).uniform(1, 2, 99), strict=False)
    }
    found, expected = (interpret(m.program, values, list(plain.program.outputs)) for m in (looped, plain))
    for name, value in expected.items():
        np.testing.assert_allclose(found[name], value, rtol=1e-13, atol=1e-13, err_msg=name)
    # products that a loop needs too stay as they are
    counts = [m.program.count(plain.program.outputs)["total"] for m in (looped, plain)]
    assert 0 <= counts[0] - counts[1] < 0.01 * counts[1]


def test_rows_of_a_planar_pin() -> None:
    """Out of the plane nothing is left: those rows are zero as formulas."""
    model = one_loop([PIN])
    assert {i[0] for i in model.program.outputs["closure.residual"].index} == {0, 1}
    assert {i[0] for i in model.program.outputs["closure.jacobian"].index} == {0, 1}
    assert model.closures[0].rows == ("x", "y", "z", "rx", "ry")
    again = Model.load(model.summary(), model.program.to_bytes())
    assert again.closures == model.closures


BAD: list[tuple[Plain, str, str]] = [
    ({"type": "pinn"}, "/closures/0/type", "literal-error"),
    ({"from": "x"}, "/closures/0/from", "string-pattern-mismatch"),
    ({"from": "y.rocker"}, "/closures/0/from", "unknown-instance"),
    ({"to": "x.end"}, "/closures/0/to", "unknown-port"),
    ({"type": "rod"}, "/closures/0", "rod-length"),
    ({"length": 1}, "/closures/0", "rod-length"),
    ({"type": "rod", "length": 0}, "/closures/0/length", "bad-length"),
    ({"type": "rod", "length": "2*L"}, "/closures/0/length", "unknown-name"),
    ({"type": "ball", "axis": [1, 0, 0]}, "/closures/0", "no-axis"),
    ({"axis": [0, 0, 0]}, "/closures/0/axis", "bad-axis"),
    ({"placement": {"position": [0, "u", 0]}}, "/closures/0/placement/position/1", "unknown-name"),
    ({"stiffness": 1}, "/closures/0/stiffness", "extra-forbidden"),
]


@pytest.mark.parametrize(("change", "pointer", "code"), BAD)
def test_bad_closures(change: Plain, pointer: str, code: str) -> None:
    with pytest.raises(InvalidDocument) as caught:
        one_loop([PIN | change])
    assert [(f.pointer, f.code) for f in caught.value.faults] == [(pointer, code)]


def test_two_closures_of_one_name() -> None:
    with pytest.raises(InvalidDocument) as caught:
        one_loop([PIN, PIN])
    assert [(f.pointer, f.code) for f in caught.value.faults] == [("/closures/1/name", "duplicate-name")]
