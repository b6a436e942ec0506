"""Sines and cosines of constant angles have their values, whether they are built from roots or not."""

from __future__ import annotations

import math

import pytest

from substructures.expr.graph import Graph
from substructures.expr.interpret import interpret
from substructures.expr.parse import parse
from substructures.expr.program import array, program


@pytest.mark.parametrize("n", [1, 2, 3, 4, 5, 6, 7, 8, 9, 11, 12, 24])
def test_constant_angles(n: int) -> None:
    graph = Graph()
    texts = [f"{name}({k}*pi/{n})" for name in ("cos", "sin") for k in range(-2 * n, 2 * n + 1)]
    formulas = [parse(graph, text, lambda _: None) for text in texts]
    found = interpret(program(graph, {"x": array((len(formulas),), lambda i: formulas[i])}, {}), {})["x"]
    angles = [k * math.pi / n for k in range(-2 * n, 2 * n + 1)]
    assert found == pytest.approx([*map(math.cos, angles), *map(math.sin, angles)], abs=1e-14)
