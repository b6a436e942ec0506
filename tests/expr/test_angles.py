"""Sines and cosines of constant angles have their values, whether they are built from roots or not."""

from __future__ import annotations

import math

import pytest

from substructures.expr.graph import Graph
from substructures.expr.interpret import interpret
from substructures.expr.operations import Symbol
from substructures.expr.parse import parse
from substructures.expr.program import array, program
from substructures.expr.trigonometry import angle, cos_sin, of_sum


@pytest.mark.parametrize("n", [1, 2, 3, 4, 5, 6, 7, 8, 9, 11, 12, 24])
def test_constant_angles(n: int) -> None:
    graph = Graph()
    texts = [f"{name}({k}*pi/{n})" for name in ("cos", "sin") for k in range(-2 * n, 2 * n + 1)]
    formulas = [parse(graph, text, lambda _: None) for text in texts]
    found = interpret(program(graph, {"x": array((len(formulas),), lambda i: formulas[i])}, {}), {})["x"]
    angles = [k * math.pi / n for k in range(-2 * n, 2 * n + 1)]
    assert found == pytest.approx([*map(math.cos, angles), *map(math.sin, angles)], abs=1e-14)


@pytest.mark.parametrize("text", ["a", "-a", "a + pi/2", "pi - a", "b - a - pi/2", "a + pi/7"])
def test_angles_are_recognised_by_their_cosines_and_sines(text: str) -> None:
    graph = Graph()
    c, s = cos_sin(parse(graph, text, graph.symbol))
    found = angle(c, s)
    assert found is not None
    assert cos_sin(found) == (c, s)
    assert of_sum((c, s), cos_sin(graph.symbol("b"))) == cos_sin(parse(graph, f"{text} + b", graph.symbol))


def test_others_are_turned_by_the_addition_theorem() -> None:
    graph = Graph()
    x, b = graph.symbol("x"), cos_sin(graph.symbol("b"))
    root = graph.sqrt(1 - x * x)
    assert angle(x, root) is None
    symbols = {name: Symbol(name, "parameter") for name in "xb"}
    made = program(graph, {"y": array((2,), lambda i: of_sum((x, root), b)[i])}, symbols)
    found = interpret(made, {"x": math.cos(0.4), "b": 0.7})["y"]
    assert found == pytest.approx([math.cos(1.1), math.sin(1.1)], abs=1e-15)
