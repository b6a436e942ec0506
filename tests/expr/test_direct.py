"""Values straight from the text: hand-typed values, SymPy on random expressions, and nothing of the graph."""

from __future__ import annotations

import random
import subprocess
import sys
from decimal import Decimal
from fractions import Fraction

import flint
import numpy as np
import pytest
import sympy

from substructures.expr.direct import ball, value
from substructures.expr.steps import ExpressionError


@pytest.mark.parametrize(
    ("text", "expected"),
    [
        ("-2^2", -4.0),
        ("(-sqrt(3))^2", 3.0),
        ("2^-3", 0.125),
        ("7-2-1", 4.0),
        ("8/4/2", 1.0),
        ("--3", 3.0),
        ("1.5e-3*l", 0.003),
        ("sin(pi/6)", 0.5),
        ("cos(a.q1')", 1.0),
        ("tan(pi/4)*sqrt(16)", 4.0),
        (Decimal("0.25"), 0.25),
        (3, 3.0),
        (Fraction(1, 3), 1 / 3),
    ],
)
def test_hand_typed_values(text: str, expected: float) -> None:
    names = {"l": 2.0, "a.q1'": 0.0}
    assert float(value(text, names)) == pytest.approx(expected, rel=1e-15)
    near = ball(text, names)
    assert float(near.rad()) < 1e-30
    assert float(near.mid()) == pytest.approx(expected, rel=1e-15)


def _random_text(source: random.Random, depth: int) -> str:
    if depth == 0:
        return source.choice(["x", "y", "pi", "2", "0.5", "1.25e-1"])
    some = lambda: _random_text(source, depth - 1)  # noqa: E731
    forms = (
        *("({}+{})", "({}-{})", "{}*{}", "({})/(2+({})^2)", "-({})", "({})^2", "sin({})", "cos({})"),
        *("sqrt(1+({})^2)", "tan(sin({})/2)"),
    )
    form = source.choice(forms)
    return form.format(*(some() for _ in range(form.count("{}"))))


def test_sympy_reads_the_same() -> None:
    """An independent reader and evaluator, at 60 digits."""
    source = random.Random(11)  # noqa: S311
    for _ in range(60):
        text = _random_text(source, 4)
        x, y = source.uniform(-2, 2), source.uniform(-2, 2)
        symbols = {"x": sympy.Float(x, 80), "y": sympy.Float(y, 80)}
        expected = sympy.N(sympy.sympify(text.replace("^", "**"), locals=symbols, rational=True), 60)
        with flint.ctx.workprec(300):
            error = float(abs(ball(text, {"x": x, "y": y}, 300) - flint.arb(str(expected))))
        assert error <= 1e-50 * max(1.0, abs(float(expected))), text
        single = float(value(text, {"x": x, "y": y}))
        # the radius at 53 bits bounds the rounding errors of floating point, but for those of sin, cos and tan
        assert abs(single - float(expected)) <= 4 * float(ball(text, {"x": x, "y": y}, 53).rad()) + 1e-300, text


def test_arrays_and_domains() -> None:
    assert np.allclose(value("x^2+1", {"x": np.arange(3.0)}), [1.0, 2.0, 5.0])
    assert np.isnan(value("sqrt(x)", {"x": -1.0}))
    assert np.isinf(value("1/x", {"x": 0.0}))
    assert not ball("sqrt(x)", {"x": -1.0}).is_finite()
    assert not ball("1/(x-x)", {"x": 2.0}).is_finite()
    assert ball("sqrt(x)^2", {"x": -1.0}, complex_=True).real.contains(-1)
    assert ball("(pi-pi)^3").contains(0)  # a ball around zero
    assert float(ball("(x-3)^-2", {"x": 1})) == 0.25
    assert np.isinf(value("1e300*1e300"))
    assert float(ball("1e300*1e300/1e300").mid()) == pytest.approx(1e300)


def test_unknown_names_and_long_numbers() -> None:
    with pytest.raises(ExpressionError, match=r"unknown name 'k' \(column 3\)"):
        value("2*k", {})
    with pytest.raises(ValueError, match="400 digits"):
        value(Decimal("1e500"))


def test_nothing_of_the_graph_is_imported() -> None:
    code = "import sys, substructures.expr.direct; print([m for m in sys.modules if 'graph' in m or 'parse' in m])"
    found = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True).stdout
    assert "substructures" not in found
