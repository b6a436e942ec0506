"""Computer algebra systems read the formulas back: numbers are the interpreter's, and the metric is what the system
itself derives from the Lagrangian."""

from __future__ import annotations

import re
import subprocess
from pathlib import Path

import pytest
import sympy
from exported_models import exported_of, tree_of, write
from mixed_program import mixed_program
from run_code import agree, alone, load_python, tool

from substructures.export import Exported

from .algebra_systems import fricas, maxima, numbers_in_maxima, values


def cases() -> list[Exported]:
    return [
        alone(mixed_program(), "mixed"),
        exported_of(tree_of("acrobot"), "arm"),
        exported_of(tree_of("scara"), "arm"),
    ]


@pytest.mark.parametrize("case", range(3))
def test_numbers_in_maxima(case: int, tmp_path: Path) -> None:
    exported = cases()[case]
    (path,) = write(exported, "maxima", tmp_path)
    for function, found in zip(exported.functions, numbers_in_maxima(exported, path), strict=True):
        agree(found, function, values(function), 1e-11)


def test_lengths_in_maxima(tmp_path: Path) -> None:
    exported = exported_of(tree_of("acrobot"), "arm")
    (path,) = write(exported, "maxima", tmp_path)
    script = f'load("{path.name}")$ disp(errcatch(arm_metric([1], arm_p)))$ disp(arm_metric([1, 2], arm_p))$'
    (tmp_path / "script.mac").write_text(script)
    run = subprocess.run(
        [tool("maxima"), "--very-quiet", '--batch-string=load("script.mac")$'],
        cwd=tmp_path, stdin=subprocess.DEVNULL, capture_output=True, text=True, timeout=60,
    )  # fmt: skip
    assert "arm_metric: q needs 2 elements" in run.stdout
    assert "[]" in run.stdout


#: kinetic energies, from the positions of the mass centres
LAGRANGIANS = {
    "acrobot": "m1/2*(d(lc1*cos(a))^2 + d(lc1*sin(a))^2) + Ic1/2*ad^2 + Ic2/2*(ad+bd)^2"
    " + m2/2*(d(l1*cos(a) + lc2*cos(a+b))^2 + d(l1*sin(a) + lc2*sin(a+b))^2)",
    "cart-pendulum": "m0/2*ad^2 + m1/2*(d(a - l0*sin(b))^2 + d(l0*cos(b))^2)",
}


def lagrangian(name: str) -> tuple[str, str, list[str]]:
    """Parameters in their order, the kinetic energy, and the names of all symbols."""
    parameters = list(tree_of(name).parameters)
    names = [p.partition(".")[2] for p in parameters]
    return f"[{', '.join(names)}]", LAGRANGIANS[name], names


@pytest.mark.parametrize("name", LAGRANGIANS)
def test_the_metric_is_what_maxima_derives(name: str, tmp_path: Path) -> None:
    exported = exported_of(tree_of(name), "arm")
    (path,) = write(exported, "maxima", tmp_path)
    parameters, energy, _ = lagrangian(name)
    script = f'load("{path.name}")$ d(x) := diff(x, a)*ad + diff(x, b)*bd$ T: {energy}$ v: [ad, bd]$\n'
    script += "M: genmatrix(lambda([i, k], diff(diff(T, v[i]), v[k])), 2, 2)$ simple(x) := ratsimp(exponentialize(x))$"
    for b in ("b", "b + 1"):
        script += f"print(args(simple(M - arm_metric([a, {b}], {parameters}))))$\n"
    lines = [line.strip() for line in maxima(script, tmp_path)]
    assert lines.count("[[0, 0], [0, 0]]") == 1


@pytest.mark.parametrize("name", LAGRANGIANS)
def test_the_metric_is_what_fricas_derives(name: str, tmp_path: Path) -> None:
    exported = exported_of(tree_of(name), "arm")
    (path,) = write(exported, "fricas", tmp_path)
    parameters, energy, _ = lagrangian(name)
    script = f")read {path.name} )quiet\n"
    script += "d(x : Expression Integer) : Expression Integer == D(x, 'a)*ad + D(x, 'b)*bd\n"
    script += f"T : Expression Integer := {energy}\n"
    script += "M := matrix [[D(D(T, u), w) for w in ['ad, 'bd]] for u in ['ad, 'bd]]\n"
    script += f"zero := map(x +-> simplify(expand(x)), M - armMetric([a, b], {parameters}))\n"
    script += 'output(if zero = matrix [[0, 0], [0, 0]] then "equal" else "different")\n'
    script += f"other := map(x +-> simplify(expand(x)), M - armMetric([a, b + 1], {parameters}))\n"
    script += 'output(if other = matrix [[0, 0], [0, 0]] then "never" else "other")\n'
    text = fricas(script, tmp_path)
    assert re.search(r"^\s*equal\s*$", text, re.MULTILINE), text
    assert re.search(r"^\s*other\s*$", text, re.MULTILINE), text


@pytest.mark.parametrize("name", LAGRANGIANS)
def test_the_metric_is_what_sympy_derives(name: str, tmp_path: Path) -> None:
    exported = exported_of(tree_of(name), "arm")
    module = load_python(write(exported, "sympy", tmp_path)[0].read_text(), tmp_path)
    _, energy, names = lagrangian(name)
    a, b, ad, bd = sympy.symbols("a b ad bd", real=True)
    symbols = {n: sympy.Symbol(n, real=True) for n in names}
    space = {
        **symbols,
        "a": a,
        "b": b,
        "ad": ad,
        "bd": bd,
        "cos": sympy.cos,
        "sin": sympy.sin,
        "Integer": sympy.Integer,
    }
    space["d"] = lambda x: x.diff(a) * ad + x.diff(b) * bd
    kinetic = eval(re.sub(r"/2\*", "/Integer(2)*", energy.replace("^", "**")), space)  # noqa: S307 -- our own text
    ours = module.arm_metric([a, b], list(symbols.values()))
    for i, v in enumerate((ad, bd)):
        for k, w in enumerate((ad, bd)):
            assert sympy.simplify(kinetic.diff(v, w) - ours[i, k]) == 0
