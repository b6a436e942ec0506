"""Roots, logarithms and arcs outside of their real domains are NaN in every language, never complex."""

from __future__ import annotations

import shutil
import subprocess
from fractions import Fraction
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import sympy
from run_code import alone

from substructures.export import files
from substructures.expr.graph import Graph
from substructures.expr.program import Formulas, Program, Symbol, program

OCTAVE = shutil.which("octave-cli") or shutil.which("octave")
FUNCTIONS = ("sqrt", "log", "asin", "acos")


@pytest.fixture
def partial() -> Program:
    graph = Graph()
    x, y = graph.symbol("x"), graph.symbol("y")
    formulas = [graph.function(f, x) for f in FUNCTIONS]
    formulas += [graph.sqrt(graph.number(2)), graph.sqrt(x * x + y * y)]
    # what begins with a number is not one
    formulas += [graph.function(f, Fraction(n, 4) * x) for n, f in enumerate(FUNCTIONS, 5)]
    outputs = {"f": Formulas((10,), {(i,): e for i, e in enumerate(formulas)})}
    return program(graph, outputs, {n: Symbol(n, "coordinate", "") for n in ("x", "y")})


def test_sympy(partial: Program) -> None:
    space: dict[str, Any] = {}
    text = files(alone(partial), "sympy", 1000)["model_sympy.py"]
    exec(text, space)  # noqa: S102 -- our own text
    found = space["model_any"]()
    values = {sympy.Symbol("x", real=True): sympy.Rational(-3, 2), sympy.Symbol("y", real=True): 2}
    assert [x is sympy.nan for x in (e.subs(values) for e in found)] == [True] * 4 + [False] * 2 + [True] * 4
    # what cannot be negative stays as it is written
    assert found[5] == sympy.sqrt(sympy.Symbol("x", real=True) ** 2 + sympy.Symbol("y", real=True) ** 2)
    half = {sympy.Symbol("x", real=True): sympy.Rational(1, 2)}
    assert [found[i].subs(half) for i in range(4)] == [
        f(sympy.Rational(1, 2)) for f in (sympy.sqrt, sympy.log, sympy.asin, sympy.acos)
    ]


@pytest.mark.skipif(OCTAVE is None, reason="Octave is not installed")
def test_octave(partial: Program, tmp_path: Path) -> None:
    (tmp_path / "model_any.m").write_bytes(files(alone(partial), "matlab", 1000)["model_any.m"])
    script = (
        "f = model_any([-1.5; 2], [], [], []); disp(isreal(f)); disp(isnan(f)'); "
        "f = model_any([0.5; 2], [], [], []); printf('%.17g ', f);"
    )
    run = subprocess.run(
        [str(OCTAVE), "--no-gui", "--norc", "--eval", script], cwd=tmp_path, capture_output=True, text=True, timeout=60
    )
    real, nan, values = run.stdout.split("\n")[:3]
    assert real.strip() == "1"
    assert nan.split() == [*"1111001111"]
    of_x = [0.5**0.5, -0.6931471805599453, 0.5235987755982989, 1.0471975511965979, 2**0.5, 4.25**0.5]
    of_multiples = [0.625**0.5, np.log(0.75), np.arcsin(0.875), 0]
    assert [float(x) for x in values.split()] == pytest.approx([*of_x, *of_multiples], rel=1e-14)
