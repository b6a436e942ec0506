"""The test for the zero function beyond fingerprints, and directional derivatives."""

from __future__ import annotations

import pytest

from substructures.expr.calculus.vanish import Vanishing
from substructures.expr.differentiate import derivative, directional
from substructures.expr.graph import Expr, Graph
from substructures.expr.parse import parse


def read(graph: Graph, text: str) -> Expr:
    return parse(graph, text, graph.symbol)


@pytest.mark.parametrize(
    "text",
    [
        "sqrt(11)*sqrt(11) - 11",
        "sqrt(x^2 + 2*x + 1)^2 - (x + 1)^2",
        "sin(sqrt(7*x^2))^2 - sin(x*sqrt(7))^2",
        "sqrt(x^2*y^2) - sqrt(x^2)*sqrt(y^2)",
        "cos(2*q) - cos(q)^2 + sin(q)^2",
        "x/sqrt(x) - sqrt(x)",
        "0",
    ],
)
def test_zero(text: str) -> None:
    graph = Graph()
    assert Vanishing(graph)(read(graph, text)) is True


@pytest.mark.parametrize(
    "text",
    [
        *("sqrt(11)*sqrt(13) - 12", "x - sqrt(x^2 + 1e-30)", "sin(q) - q", "x", "1/10^30"),
        # zero for positive x alone
        *("sqrt(x^2 + 2*x + 1) - x - 1", "sin(sqrt(7*x^2)) - sin(x*sqrt(7))", "-2*(sqrt(x^2) - x)"),
        # smaller than the last of 90 digits, beside factors that make it large again
        *("-(sqrt(1 + 1e-100*x^2) - 1)*x*1e110", "(sqrt(1 + 1e-390*x^2) - 1)*1e395", "(cos(1e-120*x) - 1)*1e245"),
    ],
)
def test_not_zero(text: str) -> None:
    graph = Graph()
    assert Vanishing(graph)(read(graph, text)) is False


@pytest.mark.parametrize(
    "text", ["sqrt(x^2 + 2*x + 1) - x - 1", "sqrt((x-9e3)^2) + x - 9e3", "sqrt((x+1e-4)^2) - x - 1e-4"]
)
def test_no_side_is_missed(text: str) -> None:
    """Points are random; that some lie where x < -1 is not left to chance."""
    for _ in range(200):
        graph = Graph()
        assert Vanishing(graph)(read(graph, text)) is False


@pytest.mark.parametrize("text", ["sqrt(-1 - x^2)", "sqrt(-1 - x^2) - sqrt(-2 - 2*x^2)*sqrt(1/2)"])
def test_unknown(text: str) -> None:
    """What has no value anywhere is neither zero nor not zero."""
    graph = Graph()
    assert Vanishing(graph)(read(graph, text)) is None


def test_functions_beyond_the_grammar() -> None:
    graph = Graph()
    x = graph.symbol("x")
    vanishes = Vanishing(graph)
    assert vanishes(graph.function("abs", x) - x) is False
    assert vanishes(graph.function("abs", x) - graph.sqrt(x * x)) is True
    assert vanishes(graph.function("exp", graph.function("log", x)) - x) is None
    assert vanishes(graph.function("log", graph.function("exp", x)) - x) is True
    assert vanishes(graph.function("atan2", x, graph.one) - graph.function("atan", x))
    assert not vanishes(graph.function("sign", x))


def test_directional_derivative_is_linear_in_the_seeds() -> None:
    graph = Graph()
    f = read(graph, "x^2*sin(q)/(1 + y)")
    a, b = graph.symbol("a"), graph.symbol("b")
    (found,) = directional([f], {"x": a, "q": b})
    assert found is a * derivative(f, "x") + b * derivative(f, "q")
    assert directional([graph.one], {"x": a})[0].is_zero
    assert directional([], {}) == []


@pytest.mark.parametrize(
    ("text", "varies"),
    [("x*y", True), ("sqrt(x^2 + 2*x + 1)^2 - (x + 1)^2 + y", False), ("y*x/x + y^2", False), ("y + 1e-40*x", True)],
)
def test_what_changes_with_a_symbol(text: str, varies: bool) -> None:
    graph = Graph()
    vanish, x = Vanishing(graph), read(graph, text)
    assert vanish.varies(x, frozenset("x")) is varies
    assert vanish.varies(x, frozenset("y"))
    assert not vanish.varies(read(graph, "sqrt(-1 - x^2)"), frozenset("x"))  # it has no value
