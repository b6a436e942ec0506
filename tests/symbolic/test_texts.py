"""SymPy expressions as texts: what documents make of them has the value that SymPy gives."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import pytest
import sympy
from sympy.physics.vector import dynamicsymbols

from substructures import InvalidArgument, couple, derive, evaluate, from_sympy

k, c = sympy.symbols("k c")
q = dynamicsymbols("q")
t = dynamicsymbols._t
FORCES = [
    -k * q - c * q.diff(t),
    k * sympy.sin(q) ** 2 / 3 - sympy.Rational(1, 7) * q.diff(t) ** 3,
    sympy.sqrt(k + q**2) / sympy.pi,
    (k + 1) ** sympy.Rational(2, 3) - 1 / sympy.sqrt(k),
    sympy.exp(-c * q) * sympy.tanh(q.diff(t)) + sympy.E,
    sympy.Max(q, 0, c) - sympy.Min(k, q),
    sympy.Abs(q) ** -1 + sympy.sign(q.diff(t)) * sympy.log(k),
    sympy.atan2(q, k) + sympy.asin(q / 3) - sympy.acos(q / 5) * sympy.atan(k) - sympy.tan(q),
    -q / (2 * k) / (c / 3) - (-(q - k)) ** 2,
    0.1 * q - 1e-7 * k + sympy.Float("2.5e20") * c * 1e-20,
    sympy.cos(3 * t) * k,
]


@pytest.mark.parametrize("force", FORCES)
def test_a_load_has_the_value_of_the_expression(force: Any) -> None:
    joint = {"type": "prismatic", "coordinate": "q"}
    definition = {
        "name": "slide",
        "parameters": {"k": {"value": 1.5}, "c": {"value": 0.25}},
        "bodies": [{"name": "b", "parent": "base", "joint": joint, "mass": 1}],
        "loads": [{"type": "joint", "coordinate": "q", "force": from_sympy(force)}],
    }
    instance = {"name": "x", "definition": definition}
    model = couple({"name": "t", "gravity": [0, 0, 0], "instances": [instance]}, {"x": derive(definition)})
    found = evaluate(model, ["forces"], [[0.6]], [[-0.4]], t=0.3)["forces"][0][0]
    state = {q.diff(t): -0.4, q: 0.6, t: 0.3, k: 1.5, c: 0.25}
    assert found == pytest.approx(float(force.subs(state).evalf()), rel=1e-13)


def test_names_that_documents_do_not_take_are_given() -> None:
    theta = sympy.Symbol(r"\theta_{1}")
    alpha = sympy.Function("alpha{1}")(t)
    assert from_sympy(2 * theta, {theta: "theta1"}) == "2*theta1"
    assert from_sympy(alpha.diff(t) + alpha, {alpha: "arm.a"}) in ("arm.a + arm.a'", "arm.a' + arm.a")
    assert from_sympy(3) == "3"
    assert from_sympy(q.diff(t, 2)) == "q''"


@pytest.mark.parametrize(
    ("expression", "message"),
    [
        (sympy.sinh(k), "'sinh' is none of the functions"),
        (sympy.I * k, "'I' has no counterpart"),
        (sympy.oo, "'oo' has no counterpart"),
        (k * sympy.Float("1e400"), "is beyond the range of doubles"),
        (sympy.nan, "'nan' has no counterpart"),
        (sympy.Symbol("theta_{1}"), "is no name of a document"),
        (sympy.Symbol("pi"), "has a meaning of its own"),
        (sympy.Symbol("x y"), "is no name of a document"),
        (sympy.Piecewise((k, k > 0), (0, True)), "'Piecewise' is none of the functions"),
        (sympy.Function("f")(k), "is no function of time alone"),
        (sympy.Derivative(sympy.Function("f")(k), k), "is no derivative by time"),
        (sympy.Integral(k, k), "has no counterpart"),
        (sympy.Matrix([k]), "has no counterpart"),
        (k > 0, "has no counterpart"),
        (sympy.Symbol("k", commutative=False) * k, "has no counterpart"),
    ],
)
def test_the_rest_is_refused_by_name(expression: Any, message: str) -> None:
    with pytest.raises(InvalidArgument, match=message):
        from_sympy(expression)


class Converted:
    """What SymPy would ask for another object in its place."""

    def __init__(self, text: str) -> None:
        self.text = text

    def _sympy_(self) -> str:
        return self.text


@pytest.mark.parametrize(
    "within", [str, lambda x: [x], lambda x: (x,), lambda x: {x}, lambda x: {"a": x}, lambda x: {x: 1}, Converted]
)
def test_texts_are_never_evaluated(within: Any, tmp_path: Path) -> None:
    """SymPy evaluates texts that it is given, also within tuples; what comes from outside is often a text."""
    file = tmp_path / "made"
    with pytest.raises(InvalidArgument, match="is no expression of SymPy"):
        from_sympy(within(f"open({str(file)!r}, 'w')"))
    assert not file.exists()
