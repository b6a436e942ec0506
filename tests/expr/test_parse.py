"""The grammar: values, columns of faults, hostile strings."""

from __future__ import annotations

import contextlib
import time

import pytest
from hypothesis import given
from hypothesis import strategies as st

from substructures.errors import TooLarge
from substructures.expr.graph import Graph
from substructures.expr.parse import parse
from substructures.expr.steps import ExpressionError
from substructures.expr.trigonometry import cos, sin


def test_values() -> None:
    g = Graph()
    x, y = g.symbol("x"), g.symbol("arm.q1'")
    known = {name: g.symbol(name) for name in ("t", "a.x", "a.y", "a.y'")}
    names = {"x": x, "arm.q1'": y, **known}.get
    cases = {
        "1.5e1": g.number(15),
        ".5": g.number(1) / 2,
        "2.": g.number(2),
        "-x^2": -(x * x),
        "(-x)**2": x * x,
        "x^-1": 1 / x,
        "2*-x": -2 * x,
        "--x": x,
        "1-2-3": g.number(-4),
        "8/4/2": g.number(1),
        "x - arm.q1'*2": x - 2 * y,
        "sin(x)^2 + cos(x)^2": g.one,
        "cos(x+pi/2)": -sin(x),
        "tan(x)*cos(x)": sin(x),
        "sqrt(1/4)": g.number(1) / 2,
        " x\t+\n t ": x + g.symbol("t"),
        "cos ( pi )": g.number(-1),
        "a.x-a.y-1": g.symbol("a.x") - g.symbol("a.y") - 1,
        "2*a.x-a.y'": 2 * g.symbol("a.x") - g.symbol("a.y'"),
    }
    for text, expected in cases.items():
        assert parse(g, text, names) is expected, text
    assert parse(g, "cos(x)", names) is cos(x)


@pytest.mark.parametrize(
    ("text", "column"),
    [
        ("", 1),
        ("  ", 1),
        ("x +", 4),
        ("x + y", 5),
        ("x ? 2", 3),
        ("2 x", 3),
        ("(x", 3),
        ("x)", 2),
        ("sin x", 5),
        ("sin", 4),
        ("1/0", 3),
        ("1/(x-x)", 3),
        ("x^y", 3),
        ("x^;", 3),
        ("x^65", 3),
        ("2^3^4", 4),
        ("0^-1", 4),
        ("sqrt(-1)", 1),
        ("tan(pi/2)", 1),
        ("x**", 4),
        ("x;x", 2),
        ("1e999", 1),
        ("x.__class__", 1),
        ("x[0]", 2),
        ("'x'", 1),
        ("x=1", 2),
        ("\uff11", 1),
        ("x\u00b2", 2),
    ],
)
def test_faults_have_columns(text: str, column: int) -> None:
    g = Graph()
    with pytest.raises(ExpressionError) as caught:
        parse(g, text, {"x": g.symbol("x")}.get)
    assert caught.value.column == column


def test_unknown_name_is_named() -> None:
    with pytest.raises(ExpressionError) as caught:
        parse(Graph(), "2*mass", lambda _: None)
    assert (caught.value.name, caught.value.column) == ("mass", 3)


HOSTILE = [
    "__import__('os').system('true')",
    "().__class__.__bases__",
    "exec('1')",
    "lambda: 0",
    "9" * 401,
    "1e-401",
    "(" * 65 + "x" + ")" * 65,
    "(" * 9000,
    "-" * 10_001,
    "x" * 10_001,
    "1+" * 5000 + "1+",
    "2^64^64^64",
    "\0",
    "x\u202ey",
    "%s%n${x}{{x}}",
    "1_000",
    "0x10",
    "1j",
    "inf",
    "nan",
]


@pytest.mark.parametrize("text", HOSTILE, ids=range(len(HOSTILE)))
def test_hostile_strings_are_refused_quickly(text: str) -> None:
    start = time.perf_counter()
    with pytest.raises(ExpressionError):
        parse(Graph(), text, lambda name: None if name != "x" else Graph().symbol("x"))
    assert time.perf_counter() - start < 2


def test_numbers_cannot_explode() -> None:
    with pytest.raises((ExpressionError, TooLarge)):
        parse(Graph(), "((((10^64)^64)^64)^64)", lambda _: None)
    with pytest.raises((ExpressionError, TooLarge)):
        parse(Graph(), "*".join(["(9^64)^4"] * 20), lambda _: None)
    with pytest.raises((ExpressionError, TooLarge)):
        parse(Graph(), "+".join(f"1/{n}" for n in range(2, 2000)), lambda _: None)


@given(st.text(alphabet="x1.e+-*/^() sincotaqrp'", max_size=60))
def test_anything_else_is_an_expression_or_a_fault(text: str) -> None:
    g = Graph()
    with contextlib.suppress(ExpressionError, TooLarge):
        assert parse(g, text, {"x": g.symbol("x")}.get).graph is g


def test_long_flat_expressions() -> None:
    g = Graph()
    x = g.symbol("x")
    assert parse(g, "+".join(["x"] * 4000), {"x": x}.get) is 4000 * x
    assert parse(g, "+".join(["(x)"] * 200), {"x": x}.get) is 200 * x
    assert parse(g, "-" * 9998 + "x", {"x": x}.get) is x
