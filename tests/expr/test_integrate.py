"""Potentials by integration of the canonical form."""

from __future__ import annotations

import pytest

from substructures.expr.calculus.integrate import antiderivative, filtered, needed, potential
from substructures.expr.differentiate import gradient
from substructures.expr.graph import Expr, Graph
from substructures.expr.parse import parse
from substructures.expr.rings.expand import is_zero


def read(graph: Graph, *texts: str) -> list[Expr]:
    return [parse(graph, text, graph.symbol) for text in texts]


@pytest.mark.parametrize(
    "text",
    [
        "k*(x - y)^4/(a + b)",
        "x^3*sin(2*x + y)*k + cos(x - y)*x*y^3",
        "x*sin(y)*cos(y)^3 + sqrt(3)*x",
        "x^2/a + cos(x + a)^3*b",
        "1/x^2 + y^5/x",
        "sqrt(1 + a)*sin(x/3 + pi/7)*y",
    ],
)
def test_what_was_differentiated_is_found(text: str) -> None:
    graph = Graph()
    (energy,) = read(graph, text)
    forces = [-x for x in gradient([energy], ["x", "y"])[0]]
    found = potential(forces, ["x", "y"])
    assert found is not None
    assert all(is_zero(a - b) for a, b in zip(gradient([found], ["x", "y"])[0], [-f for f in forces], strict=True))
    # with a curl of 1 there is none, in any order of the coordinates
    assert potential([forces[0], forces[1] + graph.symbol("x")], ["x", "y"]) is None
    assert potential([forces[1] + graph.symbol("x"), forces[0]], ["y", "x"]) is None


@pytest.mark.parametrize("text", ["sqrt(x)", "sin(x)/x", "1/x", "1/(1 + x^2)", "cos(x^2)", "cos(x)/sqrt(1 + sin(x)^2)"])
def test_what_is_no_polynomial_is_not_integrated(text: str) -> None:
    graph = Graph()
    (force,) = read(graph, text)
    assert antiderivative(force, "x") is None
    assert potential([force], ["x"]) is None


def test_too_many_terms_are_no_potential() -> None:
    graph = Graph()
    (force,) = read(graph, "(1 + x + a + b + c + d)^30")
    assert potential([force], ["x"], limit=50) is None
    assert filtered(force, {"x"}, limit=50) is None


def test_terms_by_their_symbols() -> None:
    graph = Graph()
    force, kept, other = read(graph, "(x + y)*(x - 2*a)/b", "(x^2 - 2*a*x)/b", "1/(1 + y)")
    assert filtered(force, {"x", "a", "b"}) is kept
    assert filtered(other, {"x"}) is None


def test_symbols_that_are_needed() -> None:
    graph = Graph()
    force, large = read(graph, "(x + y)^2 - 2*x*y - y^2 + sin(a)^2 + cos(a)^2", "(1 + x + y + a)^9")
    assert needed(force) == {"x"}
    assert needed(large, limit=50) == {"x", "y", "a"}
