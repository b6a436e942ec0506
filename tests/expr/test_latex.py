"""LaTeX is read back: a reader of its own grammar finds the numbers of the program in every formula."""

from __future__ import annotations

import math
import re
from collections.abc import Callable
from typing import Any

import pytest

from substructures.export import render
from substructures.expr.graph import Graph
from substructures.expr.interpret import interpret
from substructures.expr.program import Formulas, Program, Symbol, program

POINT = {"x": 0.6, "v": -0.4, "m": 1.3, "arm.l": 0.8}
WRITTEN = {"l": "arm.l", "x": "x", "v": "v", "m": "m", r"l_{\mathrm{arm}}": "arm.l", r"\pi": "pi"}
FUNCTIONS: dict[str, Callable[..., float]] = {
    **{rf"\{name}": getattr(math, name) for name in ("sin", "cos", "tan", "exp")},
    **{rf"\arc{name}": getattr(math, f"a{name}") for name in ("sin", "cos", "tan")},
    r"\ln": math.log,
    r"\operatorname{atan2}": math.atan2,
    r"\operatorname{sgn}": lambda x: math.copysign(1, x),
}
PARENTHESES = {"(": ")", r"\left(": r"\right)", r"\bigl(": r"\bigr)", r"\Bigl(": r"\Bigr)"}
TOKEN = re.compile(
    r"[a-z]_\{[^}]*\{?\w+\}?\}|\\(?:left|right|[bB]igl|[bB]igr)[(|)]|\\operatorname\{\w+\}|\\,|\\[a-z]+|[\d.]+|\S"
)


class Reader:
    """Value of one formula; ``known``: values by what is written for them."""

    def __init__(self, text: str, known: dict[str, float]) -> None:
        self.tokens, self.known = TOKEN.findall(text), known

    def take(self, *wanted: str) -> str:
        return self.tokens.pop(0) if self.tokens and self.tokens[0] in wanted else ""

    def inside(self, opening: str, closing: str) -> float:
        assert self.take(opening), self.tokens
        value = self.sum()
        assert self.take(closing), self.tokens
        return value

    def sum(self) -> float:
        value = -self.product() if self.take("-") else self.product()
        while sign := self.take("+", "-"):
            value += self.product() if sign == "+" else -self.product()
        return value

    def product(self) -> float:
        value = self.power()
        while self.take(r"\cdot", r"\,"):
            value *= self.power()
        return value

    def power(self) -> float:
        value = self.atom()
        return value ** self.inside("{", "}") if self.take("^") else value

    def atom(self) -> float:
        if self.take(r"\frac"):
            return self.inside("{", "}") / self.inside("{", "}")
        if self.take(r"\sqrt"):
            return math.sqrt(self.inside("{", "}"))
        if self.tokens[0] == r"\left|":
            return abs(self.inside(r"\left|", r"\right|"))
        if self.tokens[0] in PARENTHESES:
            return self.inside(self.tokens[0], PARENTHESES[self.tokens[0]])
        if name := self.take(*FUNCTIONS):
            exponent = self.inside("{", "}") if self.take("^") else 1
            opening = self.take(*PARENTHESES)
            if not opening:  # the angle is a single name
                return FUNCTIONS[name](self.atom()) ** exponent
            arguments = [self.sum()]
            while self.take(","):
                arguments.append(self.sum())
            assert self.take(PARENTHESES[opening])
            return FUNCTIONS[name](*arguments) ** exponent
        token = self.tokens.pop(0)
        return self.known[token] if token in self.known else float(token)


def rows_of(text: str) -> list[tuple[str, str]]:
    """Left and right sides."""
    body = text.split("\\begin{aligned}\n")[1].split("\n\\end{aligned}")[0].replace(" \\\\\n&\\quad ", " ")
    return [(left, right) for left, _, right in (row.partition(" &= ") for row in body.split(" \\\\\n"))]


def subscript(index: tuple[int, ...], shape: tuple[int, ...]) -> str:
    places = [str(i + 1) for i in index]
    return "_{" + ("," if max(shape) > 9 else "").join(places) + "}" if places else ""


@pytest.fixture
def mixed() -> Program:
    """All operations, numbers of every kind, all symmetries, an empty output and more than nine elements."""
    g = Graph()
    x, v, m, length = (g.symbol(n) for n in POINT)
    some = [g.function(f, x) for f in ("sin", "cos", "tan", "asin", "acos", "atan", "exp", "log", "sqrt")]
    some += [g.function("abs", v), g.function("sign", v), g.function("atan2", v, x), g.pi * 2, g.one / 3, -g.one / 97]
    some += [x - (v - m), x / (v / m), (x + v) ** 3, m / (x * v), -(x + v) * (m - length), g.number(2) * 3**20 * x]
    some += [(x - v) * (x - v) * m, x * g.one / 1000, 1 / (x + m) - v, -x - v, x + -(v * m), g.sqrt(x + 1) * -v]
    outputs = {
        "metric": Formulas((2, 2), {(0, 0): m, (0, 1): m * length - x, (1, 1): x * x}, "symmetric"),
        "christoffel": Formulas((3, 3, 3), {(0, 1, 2): x * m, (0, 2, 2): v}, "christoffel"),
        "some": Formulas((len(some),), {(i,): e for i, e in enumerate(some)}),
        "energy": Formulas((), {(): m * v * v / 2}),
        "wide": Formulas((12, 2), {(11, 1): x}),
        "none": Formulas((2,), {}),
    }
    return program(g, outputs, {n: Symbol(n, "parameter") for n in POINT})


@pytest.mark.parametrize("form", ["compact", "expanded", "textbook"])
def test_every_formula_has_the_value_of_its_element(mixed: Program, form: str) -> None:
    expected: dict[str, Any] = interpret(mixed, POINT)
    rows = rows_of(render(mixed, "latex", form))
    known = {written: {**POINT, "pi": math.pi}[name] for written, name in WRITTEN.items()}
    while rows[0][0].startswith("t_"):
        left, right = rows.pop(0)
        known[left] = Reader(right, known).sum()
    for name, output in mixed.outputs.items():
        for index in output.index:
            left, right = rows.pop(0)
            assert left.endswith(subscript(index, output.shape)), (name, index, left)
            reader = Reader(right, known)
            assert reader.sum() == pytest.approx(expected[name][index], rel=1e-12), (name, index, right)
            assert not reader.tokens
        if not output.index:
            assert rows.pop(0)[1] == "0"
        if output.symmetry != "none":
            assert rows.pop(0)[0] == {"metric": "g_{ab}", "christoffel": r"\Gamma_{abc}"}[name]
    assert rows == []
