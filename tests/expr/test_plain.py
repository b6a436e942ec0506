"""Formulas of which fingerprints tell all, and those of which they do not."""

from __future__ import annotations

import pytest

from substructures.expr.calculus.plain import PlainFormulas
from substructures.expr.calculus.vanish import Vanishing
from substructures.expr.graph import Expr, Graph
from substructures.expr.parse import parse

PLAIN = [
    *("x", "x*y - 1/3", "x/(y + 2)", "sin(x)*cos(y) - cos(x - 2*y)", "sqrt(6)*x - sqrt(2)", "sin(x) - x"),
    "m*(l*sin(q + r))^2/(x^2 + 1) - m*l*cos(q)",
]
NOT_PLAIN = ["sqrt(11)", "sqrt(x)", "sin(x/2)", "sin(x*y)", "sin(x + 1)", "cos(x + pi/5)", "abs(x)", "exp(x)", "x*pi"]


def read(graph: Graph, text: str) -> Expr:
    return parse(graph, text, graph.symbol)


@pytest.mark.parametrize("text", PLAIN)
def test_fingerprints_tell_that_it_is_not_zero(text: str) -> None:
    graph = Graph()
    x, vanishes = read(graph, text), Vanishing(graph)
    assert vanishes.plain.has(x)
    assert vanishes(x) is False
    assert not vanishes.values


@pytest.mark.parametrize("text", NOT_PLAIN)
def test_balls_tell_it_of_others(text: str) -> None:
    graph = Graph()
    x, vanishes = read(graph, text), Vanishing(graph)
    assert not vanishes.plain.has(x)
    assert not vanishes.plain.has(x * graph.symbol("z") + graph.one)
    assert vanishes(x) is False
    assert vanishes.values


@pytest.mark.parametrize(
    "text", ["sin(x) - 2*sin(x/2)*cos(x/2)", "sin(m*(x + y)) - sin(m*x + m*y)", "2*cos(x + pi/5) - 2*sin(pi*3/10 - x)"]
)
def test_what_fingerprints_do_not_know_is_left_to_balls(text: str) -> None:
    graph = Graph()
    assert Vanishing(graph)(read(graph, text)) is True


@pytest.mark.parametrize("text", PLAIN)
def test_what_it_varies_with(text: str) -> None:
    graph, known = Graph(), PlainFormulas()
    x = read(graph, text)
    for name in ("x", "y", "q", "m"):
        assert known.has(x)
        assert known.varies(x, frozenset([name])) is (name in text.replace("sqrt", ""))


def test_what_cancels_does_not_vary() -> None:
    graph, known = Graph(), PlainFormulas()
    m, q = map(graph.symbol, "mq")
    first, second = read(graph, "m*sin(q)^2"), read(graph, "m*cos(q)^2")
    # a node that the graph would not make
    found = Expr(graph, "add", (first, second), None, m.fp)
    assert not known.varies(found, frozenset("q"))
    assert known.varies(found, frozenset("m"))
    assert known.varies(q - m, frozenset("q"))
