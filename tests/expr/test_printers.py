"""Text and LaTeX are readable, JSON is the stored format; sizes are known before anything is printed."""

from __future__ import annotations

import json
import re
from typing import Any

import numpy as np
import pytest
from mixed_program import POINT, mixed_program
from random_expressions import collected

from substructures.errors import InvalidDocument, TooLarge
from substructures.export import Interface, render
from substructures.expr.graph import Expr, Graph
from substructures.expr.interpret import interpret
from substructures.expr.parse import parse
from substructures.expr.program import Program
from substructures.expr.trigonometry import cos
from substructures.printers import FORMATS, entries


@pytest.fixture
def mixed() -> Program:
    return mixed_program()


def agree(found: dict[str, Any], expected: dict[str, Any]) -> None:
    assert set(found) == set(expected)
    for name, value in expected.items():
        np.testing.assert_allclose(np.asarray(found[name], dtype=float), value, rtol=1e-12, atol=1e-12, err_msg=name)


def test_text_of_a_whole_program_is_a_let_list(mixed: Program) -> None:
    g = Graph()
    known: dict[str, Expr] = {}
    # there is only one instance
    names = {name.removeprefix("arm."): name for name in POINT}
    for line in render(mixed, "text").splitlines():
        if not line.startswith("#") and not any(
            f in line for f in ("asin", "acos", "atan", "exp", "log", "abs", "sign")
        ):
            left, right = line.split(" = ")
            known[left] = parse(
                g, right, lambda name: known.get(name) or (g.symbol(names[name]) if name in names else None)
            )
    assert known["metric[2, 2]"] is g.symbol("m")
    assert known["metric[1, 2]"] is g.symbol("m") + g.symbol("m") * g.symbol("l") * cos(g.symbol("arm.q1"))


def test_latex(mixed: Program) -> None:
    text = render(mixed, "latex")
    assert text.count(r"\begin{aligned}") == text.count(r"\end{aligned}") == 1
    assert text.count("{") == text.count("}")
    assert text.count(r"\left") == text.count(r"\right")
    for piece in (
        r"\dot{q}_{1}",
        r"\theta_{\mathrm{x}}",
        r"\pi",
        r"g_{12} &=",
        r"\Gamma_{122} &=",
        r"g_{ab} &= g_{ba}",
    ):
        assert piece in text


def test_json(mixed: Program) -> None:
    assert render(mixed, "json") == mixed.to_bytes().decode()
    expanded = Program.from_bytes(render(mixed, "json", "expanded").encode())
    agree(interpret(expanded, POINT), interpret(mixed, POINT))
    assert json.loads(render(mixed, "json"))["format"] == "substructures.program"


def test_entries_are_the_independent_ones(mixed: Program) -> None:
    found = entries(mixed, "christoffel", form="expanded")
    assert [e["index"] for e in found] == [[0, 0, 1], [0, 1, 1], [0, 1, 2], [0, 2, 2], [1, 0, 2]]
    assert found[0]["formula"] == "-l*m*sin(arm.q1)"
    assert entries(mixed, "nothing") == []
    with pytest.raises(KeyError):
        entries(mixed, "other")


@pytest.mark.parametrize("format_", sorted(FORMATS))
@pytest.mark.parametrize("form", ["compact", "expanded"])
def test_sizes_are_known_before(format_: str, form: str, mixed: Program) -> None:
    with pytest.raises(TooLarge) as caught:
        render(mixed, format_, form, limit=10)
    assert caught.value.size > 10
    assert render(mixed, format_, form)


def test_unknown_formats_and_forms(mixed: Program) -> None:
    for kwargs, culprit in (({"format": "exe"}, "exe"), ({"format": "text", "form": "long"}, "long")):
        with pytest.raises(InvalidDocument, match=culprit):
            render(mixed, **kwargs)


def test_long_chains_need_no_recursion() -> None:
    g = Graph()
    x = g.symbol("m")
    e = x
    for n in range(3000):
        e = e * x + g.number(n) if n % 50 else g.function("atan", e)
    program = collected(g, f=e)
    for format_ in FORMATS:
        assert render(program, format_)


@pytest.mark.parametrize("format_", ["text", "c", "python", "matlab", "fortran"])
def test_differences_are_turned_where_their_sign_is(format_: str) -> None:
    """b - a for -(a - b), unless the difference has a name."""
    g = Graph()
    a, b, c = (g.symbol(name) for name in "abc")
    program = collected(g, x=-(a * b - c), y=-(a + b), z=-(b - c) + a * (b - c))
    text = render(program, format_, interface=Interface.of_symbols(program.symbols), quantity="x")
    assert text.count(" - ") == 3
    assert text.count("-(") == 1
    assert re.search(r"= [^*\n]+ - [^*\n]+\*", text)  # c - a*b, and not a*b - c
