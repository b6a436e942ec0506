"""Exact derivatives against identities and finite differences."""

from __future__ import annotations

import numpy as np
import pytest
from random_expressions import collected, sample

from substructures.expr import differentiate
from substructures.expr.differentiate import derivative, gradient, in_directions, pullback
from substructures.expr.graph import Graph
from substructures.expr.interpret import interpret
from substructures.expr.parse import parse
from substructures.expr.trigonometry import cos, sin, tan


def test_all_directions_take_one_walk(monkeypatch: pytest.MonkeyPatch) -> None:
    g = Graph()
    x, y = g.symbol("x"), g.symbol("y")
    walks, nodes = list[int](), differentiate.reachable
    monkeypatch.setattr(differentiate, "reachable", lambda roots: walks.append(1) or nodes(roots))
    assert in_directions([x * y, x], [{"x": y}, {"y": x}, {"x": g.one, "y": g.one}]) == [
        [y * y, x * x, x + y],
        [y, g.zero, g.one],
    ]
    assert gradient([x * y], ["x", "y"]) == [[y, x]]
    assert gradient([], ["x"]) == []
    assert len(walks) == 2


@pytest.mark.parametrize("y", ["1.5", "2.5", "1.3", "k", "k/2 + 1", "7/2"])
def test_powers_have_slopes_where_they_begin(y: str) -> None:
    """d max(x, 0)^y = y max(x, 0)^(y-1), which is 0 up to x = 0; forwards and backwards."""
    g = Graph()
    f = parse(g, f"3*max(x, 0)^({y})", g.symbol)
    df = derivative(f, "x"), *pullback([f], [g.one], ["x"])
    x, k = np.array([-1.0, 0.0, 1.0, 4.0]), 2.2
    power = {"k": k, "k/2 + 1": k / 2 + 1, "7/2": 3.5}.get(y) or float(y)
    for each in df:
        found = interpret(collected(g, f=each), {"x": x, "k": k})["f"]
        assert found == pytest.approx(3 * power * np.maximum(x, 0) ** (power - 1))


def test_rules() -> None:
    g = Graph()
    x, y = g.symbol("x"), g.symbol("y")
    f = g.function
    cases = {
        x**5: 5 * x**4,
        sin(x) * cos(x): cos(2 * x),
        tan(x): 1 / cos(x) ** 2,
        sin(3 * x + y): 3 * cos(3 * x + y),
        x / y: 1 / y,
        y / x: -y / (x * x),
        f("exp", 2 * x): 2 * f("exp", 2 * x),
        f("log", x * y): 1 / x,
        g.sqrt(x): 1 / (2 * g.sqrt(x)),
        f("asin", x): 1 / g.sqrt(1 - x * x),
        f("acos", x): -1 / g.sqrt(1 - x * x),
        f("atan", x): 1 / (1 + x * x),
        f("atan2", y, x): -y / (x * x + y * y),
        f("abs", x): f("sign", x),
        f("sign", x): g.zero,
        f("tan", x): 1 + tan(x) ** 2,
        y: g.zero,
        g.pi: g.zero,
    }
    for expr, expected in cases.items():
        assert derivative(expr, "x") is expected, expr
    assert derivative(x, "z") is g.zero


def test_gradient_is_the_jacobian() -> None:
    g = Graph()
    x, y = g.symbol("x"), g.symbol("y")
    assert gradient([x * y, x + 3 * y], ["x", "y"]) == [[y, x], [g.one, g.number(3)]]
    assert gradient([], ["x"]) == []


def test_reverse_mode_is_the_row_times_the_jacobian() -> None:
    """Node by node the same formulas as by forward mode."""
    for seed in range(40):
        s = sample(2000 + seed, size=30)
        names, rows = list(s.point), s.exprs[7:]
        weights = [s.graph.symbol(f"w{i}") for i in range(len(rows))]
        jacobian = gradient(rows, names)
        expected = [
            s.graph.sum(w * row[j] for w, row in zip(weights, jacobian, strict=True)) for j in range(len(names))
        ]
        assert pullback(rows, weights, names) == expected
    g = Graph()
    assert pullback([g.one, g.symbol("x")], [g.one, g.one], ["x", "y"]) == [g.one, g.zero]


def test_mixed_derivatives_commute() -> None:
    for seed in range(30):
        for e in sample(seed).exprs[-5:]:
            assert derivative(derivative(e, "q1"), "x") is derivative(derivative(e, "x"), "q1")


def test_finite_differences() -> None:
    h, checked = 1e-5, 0
    for seed in range(40):
        s = sample(1000 + seed, size=25)
        names = list(s.point)
        exprs = s.exprs[7:]
        exact = gradient(exprs, names)
        outputs = {f"d{i}_{j}": exact[i][j] for i in range(len(exprs)) for j in range(len(names))}
        program = collected(s.graph, **outputs, **{f"e{i}": e for i, e in enumerate(exprs)})
        values = interpret(program, s.point)
        if max(abs(v) for v in values.values()) > 1e4:
            continue
        for j, name in enumerate(names):
            stencil = {n: v + h * np.array([-2, -1, 1, 2]) * (n == name) for n, v in s.point.items()}
            around = interpret(program, stencil)
            for i in range(len(exprs)):
                f = around[f"e{i}"]
                numeric = (f[0] - 8 * f[1] + 8 * f[2] - f[3]) / (12 * h)
                assert values[f"d{i}_{j}"] == pytest.approx(numeric, rel=1e-5, abs=1e-5), (seed, i, name)
                checked += 1
    assert checked > 1000


def test_deep_expressions_need_no_recursion() -> None:
    g = Graph()
    x = g.symbol("x")
    e = x
    for n in range(3000):
        e = g.function("exp", e) if n % 2 else e * x
    assert not derivative(e, "x").is_zero
