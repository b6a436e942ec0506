"""Names and units from outside cannot leave their comment or string, in formulas for people."""

from __future__ import annotations

import pytest
from hypothesis import given
from hypothesis import strategies as st

from substructures.export import render
from substructures.expr.program import Output, Program, Symbol
from substructures.printers import FORMATS
from substructures.printers.names import comment, formula_name, identifier, latex_names, prefix

NASTY = [
    "*/ int main(void) { return 1; } /*",
    "x\nimport os\n",
    "x\r\nx",
    "x\\",
    "x??/",
    "x\u2028y\u2029z\x85w",
    "\x00",
    '"""',
    "''' + boom + '''",
    "${x} %s {0} `x`",
    "}\\end{aligned}\\input{/etc/passwd}",
    "#{x} #= =#",
    "%{\n%}",
    "//",
    "/*/",
    "**//",
    "\u202egnp.exe",
    "\U0001f600",
    "t1",
    "x[0]",
    "model",
    "metric",
    "__import__('os').system('x')",
    "coding: utf-7",
    "a" * 5000,
    "",
    "sin",
    "pi",
]


def nasty_program() -> Program:
    """Every nasty text as name and unit of a symbol and as name of an output."""
    symbols = tuple(Symbol(n, "parameter", n) for n in NASTY)
    operations = (*(("sym", i) for i in range(len(NASTY))), ("add", 0, 1), ("mul", 2, 3))
    outputs = {n: Output((2,), ((0,), (1,)), (len(NASTY), len(NASTY) + 1)) for n in NASTY}
    return Program(symbols, operations, outputs)


def code_only(text: str, mark: str) -> str:
    """The text without comment lines."""
    return "\n".join(line for line in text.split("\n") if not line.lstrip().startswith(mark))


@pytest.mark.parametrize("format_", sorted(FORMATS))
def test_names_do_not_leave_their_line(format_: str) -> None:
    plain = Program(tuple(Symbol(f"n{i}", "parameter") for i in range(len(NASTY))), *_rest())
    nasty = render(nasty_program(), format_, name="x\ny")
    going_on = " \\\\\n&\\quad "  # a long formula in LaTeX
    lines = [text.replace(going_on, " ").split("\n") for text in (nasty, render(plain, format_))]
    assert len(lines[0]) == len(lines[1])
    if format_ != "json":
        assert nasty.isascii()
        assert nasty.isprintable() or set(nasty) - set(map(chr, range(32, 127))) == {"\n"}
        assert not set(nasty) & {"\u202e", "\r", "\x00"}
    if format_ != "json":
        assert "\\input" not in nasty
        assert "*/ int" not in nasty


def _rest() -> tuple[tuple[tuple[object, ...], ...], dict[str, Output]]:
    program = nasty_program()
    return program.operations, {f"o{i}": o for i, o in enumerate(program.outputs.values())}


@given(st.text(max_size=300))
def test_comments_are_one_harmless_line(text: str) -> None:
    escaped = comment(text)
    assert escaped.isascii()
    assert not set(escaped) & set('\n\r\\?"`{}%$#@!&|~;\x00') - {";"}
    assert "*/" not in escaped
    assert "/*" not in escaped


@given(st.lists(st.text(max_size=12), unique=True, max_size=6))
def test_latex_names_are_different_and_balanced(names: list[str]) -> None:
    texts = latex_names(names)
    assert len(set(texts)) == len(names)
    assert all(t.count("{") == t.count("}") for t in texts)


def test_names_of_latex_and_text() -> None:
    assert latex_names(["q1", "arm.q1'", "theta", "lc1", "m_hand", "q''", "a.b.c2"]) == [
        "q_{1}",
        r"\dot{q}_{\mathrm{arm},1}",
        r"\theta",
        "l_{c1}",
        r"m_{\mathrm{hand}}",
        r"\ddot{q}",
        r"c_{\mathrm{a},\mathrm{b},2}",
    ]
    assert formula_name("arm.q1'") == "arm.q1'"
    assert formula_name("sin") == '"sin"'
    assert formula_name("x y") == '"x y"'
    assert prefix(["x", "t1", "tt_2"]) == "ttt"
    assert identifier("metric", (), "y0") == "metric"
    assert identifier("U.link", (), "y0") == identifier("", (), "y0") == "y0"
