"""Generated code agrees with the interpreter: C compiled, Python and SymPy executed; text and LaTeX are readable."""

from __future__ import annotations

import ctypes
import importlib.util
import itertools
import json
import shutil
import subprocess
from pathlib import Path
from types import ModuleType
from typing import Any

import numpy as np
import pytest
from random_expressions import collected, sample

from substructures.errors import InvalidDocument, TooLarge
from substructures.expr.graph import Expr, Graph
from substructures.expr.interpret import interpret
from substructures.expr.parse import parse
from substructures.expr.program import Formulas, Program
from substructures.expr.trigonometry import cos, sin
from substructures.printers import FORMATS, entries, render

COMPILER = shutil.which("cc") or shutil.which("gcc") or shutil.which("clang")
COUNTER = itertools.count()
POINT = {"arm.q1": 0.6, "arm.q1'": -0.4, "m": 1.3, "l": 0.8, "theta_x": 0.35}


@pytest.fixture
def mixed() -> Program:
    """All operations, all symmetries, shapes of every rank, large and small numbers, zeros."""
    g = Graph()
    q, v, m, length, th = (g.symbol(n) for n in POINT)
    k, h = m * length * cos(q), -m * length * sin(q)
    one = [g.function(f, th) for f in ("asin", "acos", "atan", "exp", "log", "sqrt", "abs", "sign", "tan")]
    numbers = [g.number(n) for n in (1, -2, 10**30, -(10**25) + 1)] + [
        g.one / 3,
        -g.one / 7,
        g.pi * 2,
        g.sqrt(g.number(2)),
    ]
    vector = [
        *one,
        *numbers,
        g.function("atan2", v, q),
        -(k + h) / (m - length),
        (k - h) ** 3,
        g.zero,
        m / (q / v),
        v - (q - m),
    ]
    return collected(
        g,
        metric=Formulas((2, 2), {(0, 0): m + 2 * k + length**2, (0, 1): m + k, (1, 1): m}, "symmetric"),
        christoffel=Formulas(
            (3, 3, 3), {(0, 0, 1): h, (0, 1, 1): h, (1, 0, 2): h * 2, (0, 1, 2): -k, (0, 2, 2): k}, "christoffel"
        ),
        list=Formulas((len(vector),), {(i,): e for i, e in enumerate(vector)}),
        energy=m * v * v / 2,
        nothing=Formulas((2,), {(0,): g.zero}),
        Omega=Formulas((1, 3), {(0, 2): g.one}),
    )


def load_python(text: str, folder: Path) -> ModuleType:
    path = folder / f"generated_{next(COUNTER)}.py"
    path.write_text(text, encoding="ascii")
    spec = importlib.util.spec_from_file_location(path.stem, path)
    assert spec is not None
    assert spec.loader is not None
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    return module


def run_c(text: str, program: Program, folder: Path, point: dict[str, float]) -> dict[str, Any]:
    source = folder / f"generated_{next(COUNTER)}.c"
    source.write_text(text, encoding="ascii")
    library = source.with_suffix(".so")
    flags = ["-std=c99", "-Wall", "-Wextra", "-pedantic", "-Werror", "-Wno-unused-variable", "-O1", "-shared", "-fPIC"]
    subprocess.run([str(COMPILER), *flags, "-o", str(library), str(source), "-lm"], check=True)
    function = ctypes.CDLL(str(library)).model
    arrays = {n: np.full(o.shape, np.nan) for n, o in program.outputs.items()}
    x = np.array([point[s.name] for s in program.symbols])
    pointers = [a.ctypes.data_as(ctypes.c_void_p) for a in (x, *arrays.values())]
    function(*pointers)
    return arrays


def agree(found: dict[str, Any], expected: dict[str, Any]) -> None:
    assert set(found) == set(expected)
    for name, value in expected.items():
        np.testing.assert_allclose(np.asarray(found[name], dtype=float), value, rtol=1e-12, atol=1e-12, err_msg=name)


@pytest.mark.parametrize("form", ["compact", "expanded"])
def test_python(mixed: Program, form: str, tmp_path: Path) -> None:
    module = load_python(render(mixed, "python", form, "two_links"), tmp_path)
    expected = interpret(mixed, POINT)
    agree(module.two_links(POINT), expected)
    agree(module.two_links([POINT[name] for name in module.INPUTS]), expected)
    batch = {**POINT, "arm.q1": np.linspace(0, 1, 5)}
    agree(module.two_links(batch), interpret(mixed, batch))
    with pytest.raises(ValueError, match="inputs expected"):
        module.two_links([1.0])


@pytest.mark.skipif(COMPILER is None, reason="no C compiler")
@pytest.mark.parametrize("form", ["compact", "expanded"])
def test_c(mixed: Program, form: str, tmp_path: Path) -> None:
    agree(run_c(render(mixed, "c", form), mixed, tmp_path, POINT), interpret(mixed, POINT))


@pytest.mark.parametrize("form", ["compact", "expanded"])
def test_sympy(mixed: Program, form: str, tmp_path: Path) -> None:
    module = load_python(render(mixed, "sympy", form), tmp_path)
    values = {s: POINT[s.name] for s in module.x}
    assert all(s.is_real for s in module.x)
    found = {}
    for name, array in module.outputs.items():
        value = array.subs(values)
        found[name] = np.array(value.tolist() if hasattr(value, "tolist") else value, dtype=float)
    agree(found, interpret(mixed, POINT))


@pytest.mark.skipif(COMPILER is None, reason="no C compiler")
def test_random_programs_in_all_languages(tmp_path: Path) -> None:
    for seed in range(4):
        s = sample(5000 + seed, size=60)
        program = collected(s.graph, f=Formulas((len(s.exprs),), {(i,): e for i, e in enumerate(s.exprs)}))
        expected = interpret(program, s.point)
        agree(load_python(render(program, "python"), tmp_path).model(s.point), expected)
        agree(run_c(render(program, "c"), program, tmp_path, s.point), expected)


def test_text_of_a_whole_program_is_a_let_list(mixed: Program) -> None:
    g = Graph()
    known: dict[str, Expr] = {}
    for line in render(mixed, "text").splitlines():
        if not line.startswith("#") and not any(
            f in line for f in ("asin", "acos", "atan", "exp", "log", "abs", "sign")
        ):
            left, right = line.split(" = ")
            known[left] = parse(g, right, lambda name: known.get(name) or (g.symbol(name) if name in POINT else None))
    assert known["metric[2, 2]"] is g.symbol("m")
    assert known["metric[1, 2]"] is g.symbol("m") + g.symbol("m") * g.symbol("l") * cos(g.symbol("arm.q1"))


def test_latex(mixed: Program) -> None:
    text = render(mixed, "latex")
    assert text.count(r"\begin{aligned}") == text.count(r"\end{aligned}") == 1
    assert text.count("{") == text.count("}")
    assert text.count(r"\left") == text.count(r"\right")
    for piece in (
        r"\dot{q}_{\mathrm{arm},1}",
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
    for kwargs, culprit in (({"format": "exe"}, "exe"), ({"format": "c", "form": "long"}, "long")):
        with pytest.raises(InvalidDocument, match=culprit):
            render(mixed, **kwargs)


def test_long_chains_need_no_recursion(tmp_path: Path) -> None:
    g = Graph()
    x = g.symbol("m")
    e = x
    for n in range(3000):
        e = e * x + g.number(n) if n % 50 else g.function("atan", e)
    program = collected(g, f=e)
    for format_ in FORMATS:
        assert render(program, format_)
    agree(load_python(render(program, "python"), tmp_path).model([1.3]), interpret(program, {"m": 1.3}))
