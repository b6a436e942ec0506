"""Names and units from outside cannot leave their comment or string, in any language; and the two untested dialects."""

from __future__ import annotations

import ast
import re
import shutil
import subprocess
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from random_expressions import collected

from substructures.expr.graph import Graph
from substructures.expr.interpret import interpret
from substructures.expr.program import Formulas, Output, Program, Symbol
from substructures.expr.trigonometry import cos
from substructures.printers import FORMATS, render
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
COMPILER = shutil.which("cc") or shutil.which("gcc") or shutil.which("clang")


def nasty_program() -> Program:
    """Every nasty text as name and unit of a symbol and as name of an output."""
    symbols = tuple(Symbol(n, "parameter", n) for n in NASTY)
    operations = (*(("sym", i) for i in range(len(NASTY))), ("add", 0, 1), ("mul", 2, 3))
    outputs = {n: Output((2,), ((0,), (1,)), (len(NASTY), len(NASTY) + 1)) for n in NASTY}
    return Program(symbols, operations, outputs)


def code_only(text: str, mark: str) -> str:
    """The text without comment lines."""
    return "\n".join(line for line in text.split("\n") if not line.lstrip().startswith(mark))


@pytest.mark.parametrize("name", [*NASTY, "good_name"])
def test_python_has_the_same_structure_whatever_the_names(name: str) -> None:
    for format_ in ("python", "sympy"):
        tree = ast.parse(render(nasty_program(), format_, name=name))
        called = {ast.unparse(n.func) for n in ast.walk(tree) if isinstance(n, ast.Call)}
        assert not {c for c in called if re.search("system|import|eval|exec|open|boom", c)}
        kinds = {type(n) for n in tree.body}
        assert kinds <= {ast.Expr, ast.Import, ast.ImportFrom, ast.Assign, ast.FunctionDef}
        assert sum(isinstance(n, (ast.Import, ast.ImportFrom)) for n in tree.body) == 1


@pytest.mark.skipif(COMPILER is None, reason="no C compiler")
@pytest.mark.parametrize("name", NASTY[:6])
def test_c_has_one_function_whatever_the_names(name: str, tmp_path: Path) -> None:
    text = render(nasty_program(), "c", name=name)
    (tmp_path / "nasty.c").write_text(text, encoding="ascii")
    flags = ["-std=c99", "-trigraphs", "-Wall", "-Wextra", "-Wcomment", "-Werror", "-c"]
    subprocess.run([str(COMPILER), *flags, "-o", str(tmp_path / "nasty.o"), str(tmp_path / "nasty.c")], check=True)
    assert len(re.findall(r"^\w.*\(", code_only(text, "//"), re.MULTILINE)) == 1


@pytest.mark.parametrize("format_", sorted(FORMATS))
def test_names_do_not_leave_their_line(format_: str) -> None:
    plain = Program(tuple(Symbol(f"n{i}", "parameter") for i in range(len(NASTY))), *_rest())
    nasty = render(nasty_program(), format_, name="x\ny")
    assert len(nasty.split("\n")) == len(render(plain, format_).split("\n"))
    if format_ != "json":
        assert nasty.isascii()
        assert nasty.isprintable() or set(nasty) - set(map(chr, range(32, 127))) == {"\n"}
        assert not set(nasty) & {"\u202e", "\r", "\x00"}
    if format_ not in ("json", "python", "sympy"):
        assert "\\input" not in nasty
        assert "*/ int" not in nasty
    if format_ in ("c", "matlab", "julia"):
        mark = {"c": "//", "matlab": "%", "julia": "#"}[format_]
        assert not re.search("boom|import os|system|passwd", code_only(nasty, mark))


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
        r"\mathit{lc}_{1}",
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


@pytest.mark.parametrize("format_", ["matlab", "julia"])
def test_matlab_and_julia_through_a_transliteration(format_: str) -> None:
    """Without interpreters of these languages: their assignments, with indices from 1, give the right numbers."""
    g = Graph()
    q, m = g.symbol("q"), g.symbol("m")
    k = m * cos(q)
    metric = {(0, 0): k * k + k, (0, 1): g.function("atan2", m, q) / 3, (1, 1): k - q}
    christoffel = {(0, 0, 1): k / q, (0, 1, 1): -k}
    program = collected(
        g,
        metric=Formulas((2, 2), metric, "symmetric"),
        christoffel=Formulas((2, 2, 2), christoffel, "christoffel"),
        forces=Formulas((2,), {(1,): k + g.pi}),
        energy=m * q * q,
    )
    point = {"q": 0.3, "m": 1.7}
    text = render(program, format_)
    values: dict[str, object] = {"cos": np.cos, "atan2": np.arctan2, "atan": np.arctan2, "pi": np.pi}
    values["x"] = np.array([point[s.name] for s in program.symbols])
    for line in text.splitlines():
        match = re.fullmatch(r"\s+(\w+)(?:[(\[]([\d, ]+)[)\]])? = (.*);", line)
        if match:
            target, index, formula = match.groups()
            formula = re.sub(r"\b(x|metric|christoffel)[(\[]([\d, ]+)[)\]]", _from_zero, formula).replace("^", "**")
            formula = re.sub(r"zeros\(([\d, ]+)\)", r"np.zeros((\1,))", formula)
            value = eval(formula, {"np": np}, values)  # noqa: S307 -- our own output, which is what is tested
            if index:
                values[target][tuple(int(i) - 1 for i in index.split(","))] = value
            else:
                values[target] = value
    for name, expected in interpret(program, point).items():
        found = np.asarray(values[name])
        np.testing.assert_allclose(found.reshape(expected.shape), expected, rtol=1e-13)
    assert text.rstrip().endswith("end")


def _from_zero(match: re.Match[str]) -> str:
    return f"{match[1]}[{', '.join(str(int(i) - 1) for i in match[2].split(','))}]"
