"""Evaluation in a prime field is a homomorphism: what is zero as a function is zero there."""

from __future__ import annotations

import pytest

from substructures.expr.differentiate import directional
from substructures.expr.graph import Expr, Graph
from substructures.expr.parse import parse
from substructures.expr.program import Formulas, Program, Symbol, program
from substructures.expr.rings.modular import Field, FieldValues, NoSquareRoot


def formula(text: str) -> Program:
    """An expression v in x and y, and dv/dx + 2 dv/dy."""
    graph = Graph()
    names = {name: graph.symbol(name) for name in ("x", "y")}
    root = parse(graph, text, names.get)
    (change,) = directional([root], {"x": graph.one, "y": graph.number(2)})
    symbols = {name: Symbol(name, "parameter") for name in names}
    return program(graph, {"v": Formulas((), {(): root}), "change": Formulas((), {(): change})}, symbols)


def value(field: Field, text: str, values: dict[str, int]) -> int:
    """Its value; left sides are kept apart, so that no graph can fold them."""
    return field.evaluate(formula(text), values, "v").get((), 0)


@pytest.mark.parametrize(
    ("left", "right"),
    [
        ("sin(x + y)", "sin(x)*cos(y) + cos(x)*sin(y)"),
        ("cos(x + 0.4)*cos(x + 0.45) + sin(x + 0.4)*sin(x + 0.45)", "cos(0.05)"),
        ("cos(x/3)^3*4 - 3*cos(x/3)", "cos(x)"),
        ("cos(x + pi/4)", "(cos(x) - sin(x))/sqrt(2)"),
        ("sin(2*(x - pi/12) - y)", "(sqrt(3)*sin(2*x - y) - cos(2*x - y))/2"),
        ("tan(x)*cos(x)", "sin(x)"),
        ("x/(1 + 1/y)", "x*y/(1 + y)"),
        ("(x^2 - y^2)/(x + y)", "x - y"),
        ("cos(-(x*y)/2)", "cos(y*x/2)"),
        ("2*cos(pi/5)*cos(3*pi/5)", "cos(4*pi/5) + cos(2*pi/5)"),
    ],
)
def test_identities(left: str, right: str) -> None:
    field = Field()
    values = {"x": field.draw(), "y": field.draw()}
    assert value(field, left, values) == value(field, right, values)
    assert value(field, f"{left} + 1", values) != value(field, right, values)


@pytest.mark.parametrize(
    "text",
    ["x*y^3 - sin(2*x - y/3)", "cos(x + pi/4)/(y - x)", "tan(x)/y", "-x^(-2)", "sqrt(3)*x - 0.2*y + 1", "pi*cos(y)"],
)
def test_changes(text: str) -> None:
    """Derivatives of values are values of derivatives."""
    field, found = Field(), formula(text)
    values = FieldValues(field, found, {"x": field.draw(), "y": field.draw()}, ["v", "change"])
    assert values.is_exact
    (change,) = values.changes(["v"], {"x": 1, "y": 2})
    assert (change[()] - values.output("change")[()]) % field.prime == 0


@pytest.mark.parametrize("text", ["sin(x*y)", "sqrt(x^2)", "abs(x)", "exp(x)", "cos(x + pi/5)", "atan2(x, y)"])
def test_not_told(text: str) -> None:
    """Equal functions of these may have different values."""
    field = Field()
    values = {"x": field.draw() ** 2, "y": field.draw()}
    assert not FieldValues(field, formula(text), values, ["v"]).is_exact


def test_square_roots() -> None:
    """Those of 2, 3 and their products always; of other numbers in every second field."""
    field = Field()
    assert field.root(2) * field.root(3) % field.prime == field.root(6)
    found = 0
    for _ in range(60):
        field = Field()
        try:
            root = value(field, "sqrt(1.37)", {})
        except NoSquareRoot:
            continue
        assert (root * root * 100 - 137) % field.prime == 0
        found += 1
    assert 0 < found < 60


def test_square_roots_of_the_numbers_in_formulas() -> None:
    """One field has all of them, whatever divides them, and still no root of -1."""
    texts = ["1.37", "2", "35/6", "43131*x + 374018", "39388521", "9334978122595822", "0.4*0.1"]
    graph = Graph()
    roots = [graph.function("sqrt", parse(graph, text, {"x": graph.one}.get)) for text in texts]
    formulas = program(graph, {"v": Formulas((7,), {(i,): root for i, root in enumerate(roots)})}, {})
    for _ in range(5):
        field = Field([formulas])
        found = field.evaluate(formulas, {}, "v")
        for i, square in enumerate([(137, 100), (2, 1), (35, 6), (417149, 1), (39388521, 1), (9334978122595822, 1)]):
            assert (found[i,] ** 2 * square[1] - square[0]) % field.prime == 0
        with pytest.raises(NoSquareRoot):
            field.root(-1)


def test_other_functions_and_division_by_zero() -> None:
    graph, field = Graph(), Field()
    x = graph.symbol("x")
    roots: list[Expr] = [graph.function("exp", x), graph.function("exp", x + 1), graph.function("atan2", x, x + 1)]
    symbols = {"x": Symbol("x", "parameter")}
    found = program(graph, {"v": Formulas((3,), {(i,): r for i, r in enumerate(roots)})}, symbols)
    values = field.evaluate(found, {"x": 5}, "v")
    assert len(set(values.values())) == 3
    assert field.evaluate(found, {"x": 5}, "v") == values
    with pytest.raises(ZeroDivisionError):
        value(field, "1/(x - 5)", {"x": 5})
