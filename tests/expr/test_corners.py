"""Zero functions among formulas with |x| and sign x: on all sides, or not at all."""

from __future__ import annotations

import pytest

from substructures.expr.calculus.corners import VanishingOnAllSides, corners, inner, on_side
from substructures.expr.graph import Expr, Graph
from substructures.expr.parse import parse


def read(graph: Graph, text: str) -> Expr:
    return parse(graph, text, graph.symbol)


MANY = "*".join(f"(sqrt((q{i} - {i})^2) - q{i} + {i})" for i in range(7))
FEW = " + ".join(f"(sqrt((q{i} - {i})^2) - q{i} + {i})*(sqrt((q{i} + 3)^2) + q{i} + 3)" for i in range(6))


@pytest.mark.parametrize(
    "text",
    [
        "sqrt(x^2)^2 - x^2",
        "(sqrt(x^2) - x)*(sqrt(x^2) + x)",
        "1/sqrt(x^2) - sqrt(x^2)/x^2",
        "sqrt((x - 5)^2)*(y - 1) + sqrt((x - 5)^2) - y*sqrt((x - 5)^2)",
        f"({FEW}) - ({FEW}) + sqrt(x^2)*sqrt(x^2) - x^2",
    ],
)
def test_zero_on_all_sides(text: str) -> None:
    graph = Graph()
    assert VanishingOnAllSides(graph)(read(graph, text))


@pytest.mark.parametrize(
    "text",
    [
        "sqrt(x^2) - x",
        "sqrt(x^2) + x",
        "sqrt((x - 10^6)^2) + x - 10^6",
        "sqrt(x^2)*sqrt(y^2) - x*y",
        FEW,
        MANY,
        "x - y",
    ],
)
def test_zero_on_some_sides_only(text: str) -> None:
    """Each of them but the last vanishes on a part of the states; with seven signs there are too many to look at."""
    graph = Graph()
    assert not VanishingOnAllSides(graph)(read(graph, text))


def test_the_sides() -> None:
    graph = Graph()
    x = graph.symbol("x")
    root, sign = graph.sqrt(x * x), graph.function("sign", x)
    size = graph.function("abs", root - 1)
    found = corners([root + sign + size])
    assert {inner(node) for node in found} == {x, root - 1}
    (low,) = on_side([size + sign], dict.fromkeys(found, -1))
    assert low is x
    with pytest.raises(ValueError, match="no corner"):
        inner(x + 1)
