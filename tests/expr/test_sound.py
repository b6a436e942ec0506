"""A formula is what was written: signs of roots, domains, rounding errors, sizes of numbers."""

from __future__ import annotations

import math

import pytest

from substructures.errors import TooLarge
from substructures.expr.construction.exact import MAX_BITS
from substructures.expr.graph import Expr, Graph
from substructures.expr.interpret import interpret
from substructures.expr.parse import parse
from substructures.expr.program import Formulas, Program, Symbol, program
from substructures.expr.replay import replay
from substructures.expr.rings.expand import expand


def read(text: str, graph: Graph) -> Expr:
    return parse(graph, text, graph.symbol)


def value(expr: Expr, **point: float) -> float:
    symbols = {n: Symbol(n, "coordinate", "") for n in expr.graph.symbols}
    p = Program.from_bytes(program(expr.graph, {"f": Formulas((), {(): expr})}, symbols).to_bytes())
    return float(interpret(p, point)["f"])


@pytest.mark.parametrize(
    ("text", "expected"),
    [
        ("(-sqrt(k))^2", 3.0),
        ("(-2*sqrt(k))^2", 12.0),
        ("(-sqrt(k))^3", -(3.0**1.5)),
        ("1/(-sqrt(k))^2", 1 / 3),
        ("-3*sqrt(k)*(-2*sqrt(k))", 18.0),
        ("sqrt((-sqrt(k))^2)", 3.0**0.5),
        ("(-sqrt(11))^2", 11.0),
        ("-sqrt(k)/(-sqrt(k)*2)", 0.5),
        ("(-sqrt(k))*sqrt(k)", -3.0),
    ],
)
def test_signs_of_roots(text: str, expected: float) -> None:
    assert value(read(text, Graph()), k=3.0) == pytest.approx(expected, rel=1e-14)


@pytest.mark.parametrize(
    ("first", "second", "at", "expected"),
    [
        ("(q0+4)*(q0+9)-(q0+2)*(q0+11)", "14*q1", 1e9, 14.0),
        ("q1*((q0+4)*(q0+9)-(q0+2)*(q0+11))", "14*q1", 1e9, 14.0),
        ("(q0+1e9)*q1-1e9*q1", "q0*q1", 1e-7, 1e-7),
        ("(q0^2-1)/(q0-1)", "q0+1", 1.0, 2.0),
        ("sin(2*q0)/sin(q0)", "2*cos(q0)", 0.0, 2.0),
        ("sqrt(q0)*sqrt(q0)*q1/q1", "q0", -2.0, -2.0),
        ("(q1*q0+q0)/(q1+1)", "q0+1", 0.5, 1.5),
        ("q0*(1e-9*sqrt(q0)+q1)-1e-9*q0*sqrt(q0)", "q0*q1", -2.0, -2.0),
    ],
)
def test_one_expression_does_not_change_another(first: str, second: str, at: float, expected: float) -> None:
    graph = Graph()
    read(first, graph)
    assert value(read(second, graph), q0=at, q1=1.0) == pytest.approx(expected, rel=1e-14)


def test_numbers_and_symbols_are_literal() -> None:
    graph = Graph()
    read("(q0+4)*(q0+9)-(q0+2)*(q0+11)", graph)
    read("(q0+q1)*(q0-q1)+q1*q1-q0*(q0-1)", graph)
    assert graph.number(14).op == "int"
    assert graph.symbol("q0").op == "sym"
    # what is built later and is one of them becomes literal
    assert read("(q0+4)*(q0+9)-(q0+2)*(q0+11)", graph) is graph.number(14)


@pytest.mark.parametrize("best", ["(q0*q1+q1)/q1", "(q0*sqrt(q1)+sqrt(q1))/sqrt(q1)", "(q0/q1+1/q1)*q1"])
@pytest.mark.parametrize("text", ["q0^2+q0+1-q0^2", "(q0^3+q0+1)-q0^3"])
def test_zero_adds_nothing(best: str, text: str) -> None:
    """Also where the table of fingerprints has another node of the same value, which may not stand for this one."""
    graph = Graph()
    other, x = read(best, graph), read(text, graph)
    assert graph.table[x.fp] is other is not x
    assert (x + 0) is (graph.zero + x) is (x - 0) is x
    assert graph.sum([x, graph.zero]) is x
    assert (0 - x) is -x


def test_arithmetic_of_numbers_is_a_number() -> None:
    """Also beside a node whose value is that number, or its negative."""
    graph = Graph()
    assert read("(sqrt(2)-10)*(sqrt(2)+10)", graph).op == "mul"
    assert graph.number(49) + graph.number(49) is graph.number(98)
    graph = Graph()
    read("(sqrt(2)-10)*(sqrt(2)+10)", graph)
    for x in (graph.number(7) * 14, graph.number(100) - 2, 2 - graph.number(-96), graph.number(-49) * -2):
        assert x is graph.number(98)
    assert graph.number(-95) - 3 is graph.number(-98)


def test_the_same_with_operands_exchanged() -> None:
    """One node, also where no bound of the rounding errors is known: the root has no value at most points."""
    graph = Graph()
    assert read("a*a+sqrt(cos(b)-2)", graph) is read("sqrt(cos(b)-2)+a*a", graph)
    assert read("a*sqrt(cos(b)-2)", graph) is -read("-sqrt(cos(b)-2)*a", graph)
    assert read("a-sqrt(cos(b)-2)", graph) is -read("sqrt(cos(b)-2)-a", graph)


def test_whole_turns_are_left_out() -> None:
    graph = Graph()
    assert read("sin(q+2*pi)", graph) is read("sin(q)", graph)
    assert read("cos(q-3*pi)", graph) is -read("cos(q)", graph)
    assert read("sin(q+5*pi/2)", graph) is read("cos(q)", graph)


def test_numbers_have_one_limit() -> None:
    """What can be built can be read; what cannot is refused while it is built."""
    graph = Graph()
    digits = "1" * 390
    term = "+".join(f"q0/{digits[:-1]}{n}" for n in (1, 3, 7))
    assert value(read(term, graph), q0=1.0) == pytest.approx(3 / float(digits), rel=1e-14)
    with pytest.raises(ValueError, match="bits"):
        read(f"{term}+q0/{digits[:-1]}9", graph)
    with pytest.raises(TooLarge):
        graph.number(1 << MAX_BITS)


@pytest.mark.parametrize(
    ("text", "expected"), [("sqrt(10^64*10^64*10^64*10^64*10^64*10^60+7)/1e190", 1.0), ("1e190/sqrt(1e380+7)", 1.0)]
)
def test_roots_beyond_the_range_of_doubles(text: str, expected: float) -> None:
    assert value(read(text, Graph())) == pytest.approx(expected, rel=1e-14)


@pytest.mark.parametrize(
    ("text", "point"),
    [
        ("1/(b-1+sqrt(a+2))", {"a": 2.0, "b": 3.0}),
        ("1/(1+sqrt(1-sqrt(a^2)+a))", {"a": -0.5}),
        ("1/(1+sqrt(1-sqrt(a^2)+a))", {"a": 0.5}),
        ("1/(a+sqrt(2))", {"a": math.sqrt(2)}),
        ("b/(sqrt(a)+sqrt(b))", {"a": 2.0, "b": 2.0}),
        ("a/sqrt(b)", {"a": 1.0, "b": 2.0}),
    ],
)
def test_expanding_multiplies_by_nothing_that_vanishes(text: str, point: dict[str, float]) -> None:
    expr = read(text, Graph())
    assert value(expand(expr).to_expr(Graph()), **point) == pytest.approx(value(expr, **point), rel=1e-14)


def test_replaying_changes_nothing() -> None:
    graph = Graph()
    x = read("cos(q0)*(q1+3)-sin(q0)*sqrt(q1^2+k)", graph)
    symbols = {n: Symbol(n, "coordinate", "") for n in graph.symbols}
    p = program(graph, {"f": Formulas((), {(): x})}, symbols)
    again = Graph()
    assert program(again, replay(p, again, {}), symbols).digest == p.digest
