"""Functions of force laws: formulas beside what they mean, derivatives by differences, tables beside SciPy."""

from __future__ import annotations

from itertools import pairwise
from typing import Any

import flint
import numpy as np
import pytest
from scipy.interpolate import CubicSpline, PchipInterpolator

from substructures.certificate.stored import operations_in_balls
from substructures.certificate.texts import slope
from substructures.expr.differentiate import derivative
from substructures.expr.direct import ball, value
from substructures.expr.graph import Graph
from substructures.expr.interpret import interpret
from substructures.expr.operations import Symbol
from substructures.expr.parse import parse
from substructures.expr.program import array, program
from substructures.expr.steps import ExpressionError
from substructures.expr.syntax import read
from substructures.expr.units.dimensions import Dimensioned, DimensionError, Inference

X, Y = np.array([0.0, 0.5, 1.25, 2.0, 3.5, 4.0]), np.array([1.0, 3.0, 2.5, 2.5, 4.0, 7.0])
KNOTS = ", ".join(f"{x}: {y}" for x, y in zip(X, Y, strict=True))
TEXTS = [
    *("abs(x)", "sign(x)", "exp(x)", "log(x + 9)", "tanh(3*x)", "asin(x/9)", "acos(x/9)", "atan(x)", "atan2(x, y)"),
    *("min(x, y)", "max(x, 2*y)", "max(min(x, 1), -1)", "step(x, y, 0.5)", "step(x, 0.3, 6)", "(x^2 + 1)^(y/3)"),
    *(
        "(x^2 + 1)^1.5",
        "(x^2 + 1)^-0.5",
        "abs(x)^p",
        f"table(x; {KNOTS})",
        f"table(x; {KNOTS}; monotone)",
        f"table(x; {KNOTS}; smooth)",
    ),
    "max(0, x)^2*(1 + tanh(y/0.01)) - abs(y)*sign(x)",
]
PLACES = {"x": np.array([-2.3, -0.4, 0.2, 0.7, 1.9, 3.4, 5.1]), "y": np.array([0.4, -0.7, 0.6, 0.9, -1.1, 2.0, -3.0])}
GIVEN: dict[str, Any] = {**PLACES, "p": 1.3}


def formula(text: str, along: str | None = None) -> np.ndarray:
    """The values of the formula, or of its derivative, at the places."""
    graph = Graph()
    node = parse(graph, text, graph.symbol)
    node = node if along is None else derivative(node, along)
    symbols = {name: Symbol(name, "parameter") for name in GIVEN}
    found = interpret(program(graph, {"f": array((), lambda: node)}, symbols), GIVEN)["f"]
    return np.broadcast_to(found, (7,))


@pytest.mark.parametrize("text", TEXTS)
def test_formulas_are_what_they_mean(text: str) -> None:
    """In floating point, in balls, and their slopes by power series of balls and by differences."""
    names = sorted({str(s.value) for s in read(text) if s.op == "name"})
    expected = value(text, GIVEN)
    assert np.allclose(formula(text), expected, rtol=1e-13, atol=1e-13)
    h = 1e-6
    for name in names:
        up, down = (value(text, {**GIVEN, name: GIVEN[name] + d}) for d in (h, -h))
        assert np.allclose(formula(text, name), (up - down) / (2 * h), rtol=1e-6, atol=1e-8)
    for k in range(7):
        point = {name: float(np.broadcast_to(x, (7,))[k]) for name, x in GIVEN.items()}
        assert abs(float(ball(text, point).mid()) - expected[k]) < 1e-13 * max(1, abs(expected[k]))
        balls = {name: flint.arb(x) for name, x in point.items()}
        for name in names:
            assert abs(float(slope(text, balls, name).mid()) - formula(text, name)[k]) < 1e-10 * max(
                1, abs(expected[k])
            )


def test_far_away() -> None:
    """Nothing overflows where a law is flat: no NaN in values or in derivatives."""
    for text, low, high in (("tanh(x)", -1, 1), ("step(x, 0, 1)", 0, 1), (f"table(x; {KNOTS})", 1, 7)):
        for x, expected in ((-1e12, low), (-500, low), (500, high), (1e12, high)):
            graph = Graph()
            node = parse(graph, text, graph.symbol)
            some = {"f": array((), lambda node=node: node), "d": array((), lambda node=node: derivative(node, "x"))}
            found = interpret(program(graph, some, {"x": Symbol("x", "parameter")}), {"x": x})
            assert float(found["f"]) == pytest.approx(expected, abs=1e-14)
            assert float(found["d"]) == pytest.approx(0, abs=1e-14)


@pytest.mark.parametrize("text", ["max(0, x - 0.05)^1.5", "asin(max(-1, min(1, x)))", "sqrt(4 - min(2, -x)^2)"])
def test_what_is_held_at_a_number_is_that_number_in_balls(text: str) -> None:
    """Beside it by nothing, where a root of what is below zero has no value."""
    graph = Graph()
    node = parse(graph, text, graph.symbol)
    made = program(graph, {"f": array((), lambda: node)}, {"x": Symbol("x", "parameter")})
    found = operations_in_balls(made, {"x": flint.arb("-10/3")})[-1]
    assert found.is_finite()
    assert found.overlaps(ball(text, {"x": -10 / 3}))


def test_powers_of_nothing_and_of_negative_numbers() -> None:
    """0^y is 0 for y > 0 without a derivative, and what is below zero has no value."""
    for text in ("max(0, x)^1.5", "max(0, x)^1.3"):
        graph = Graph()
        node = parse(graph, text, graph.symbol)
        made = program(graph, {"f": array((), lambda node=node: node)}, {"x": Symbol("x", "parameter")})
        assert float(interpret(made, {"x": -2.0})["f"]) == 0
        assert float(value(text, {"x": -2.0})) == 0
    for text in ("x^1.5", "x^1.3", "log(x)"):
        graph = Graph()
        node = parse(graph, text, graph.symbol)
        made = program(graph, {"f": array((), lambda node=node: node)}, {"x": Symbol("x", "parameter")})
        assert np.isnan(float(interpret(made, {"x": -2.0})["f"]))
        assert np.isnan(float(value(text, {"x": -2.0})))
        assert not ball(text, {"x": -2.0}).is_finite()


def test_tables_against_scipy() -> None:
    """On a fine grid with the places themselves, and constant outside; random tables, too."""
    rng = np.random.default_rng(3)
    for n in (2, 3, 5, 12):
        x = np.cumsum(rng.integers(1, 20, n)) / 8 - 3
        y = rng.integers(-20, 20, n) / 4
        knots = ", ".join(f"{a}: {b}" for a, b in zip(x, y, strict=True))
        grid = np.concatenate([x, np.linspace(x[0], x[-1], 101), [x[0] - 1, x[-1] + 1]])
        inside = np.clip(grid, x[0], x[-1])
        for text, expected in (
            (f"table(x; {knots})", np.interp(grid, x, y)),
            (f"table(x; {knots}; monotone)", PchipInterpolator(x, y)(inside)),
            (f"table(x; {knots}; smooth)", CubicSpline(x, y, bc_type="clamped")(inside)),
        ):
            graph = Graph()
            node = parse(graph, text, graph.symbol)
            found = interpret(
                program(graph, {"f": array((), lambda node=node: node)}, {"x": Symbol("x", "parameter")}), {"x": grid}
            )
            assert np.allclose(found["f"], expected, rtol=0, atol=1e-12)
            assert np.allclose(value(text, {"x": grid}), expected, rtol=0, atol=1e-12)


def test_a_monotone_table_rises_where_its_values_do() -> None:
    x = np.linspace(0, 4, 401)
    y = value(f"table(x; {KNOTS}; monotone)", {"x": x})
    for a, b in pairwise(range(len(X))):
        piece = np.diff(y[(x >= X[a]) & (x <= X[b])])
        assert (piece * np.sign(Y[b] - Y[a]) >= -1e-12).all()


@pytest.mark.parametrize(
    ("text", "column"),
    [
        *(
            ("min(x)", 6),
            ("min(x, y, z)", 9),
            ("step(x, 1)", 10),
            ("tanh()", 6),
            ("table(x)", 8),
            ("table(x; 1: 2)", 1),
        ),
        *(("table(x; 1: 2, 1: 3)", 1), ("table(x; 1: 2, 0: 3)", 1), ("table(x; a: 2, 1: 3)", 10), ("x^2^y", 4)),
        *(("table(x; 0: 2, 1: 3; cubic)", 22), ("x^", 3), ("x^y^2", 4), ("(-2)^0.5", 6), ("1; 2", 2), ("exp(x;)", 6)),
    ],
)
def test_what_cannot_be_read(text: str, column: int) -> None:
    graph = Graph()
    with pytest.raises(ExpressionError) as raised:
        parse(graph, text, graph.symbol)
    assert raised.value.column == column, raised.value


def test_places_of_tables_rise() -> None:
    for text in ("table(x; 1: 2, 1: 3)", "table(x; 1: 2, 0: 3)"):
        with pytest.raises(ExpressionError, match="which rise"):
            read(text)


def test_names_stay_free() -> None:
    """What was a name before there were these functions is one still."""
    graph = Graph()
    for name in ("abs", "exp", "min", "max", "step", "table", "tanh", "distance", "angle", "monotone", "smooth"):
        assert parse(graph, f"2*{name}", graph.symbol) == 2 * graph.symbol(name)


def test_dimensions() -> None:
    metre, pure = Dimensioned((1, 0, 0, 0, 0, 0, 0)), Dimensioned((0,) * 7)
    names = {"l": metre, "n": pure}

    def of(text: str) -> Any:
        return Inference(lambda name: names.get(name, "unknown")).of(read(text))

    assert (of("abs(l)"), of("max(l, 2*l)"), of("l^2").dimension[0]) == (metre, metre, 2)
    assert of("step(l, 2*l, l)") == of("atan2(l, l)") == of("sign(l)") == "pure"
    for wrong in ("exp(l)", "tanh(l)", "max(l, n)", "step(l, n, l)", "n^l", "log(l)"):
        with pytest.raises(DimensionError):
            of(wrong)
