"""Two stages in C: what depends on parameters alone is computed once, and functions take what they need of it."""

from __future__ import annotations

import subprocess
from pathlib import Path

import numpy as np
import pytest
from exported_models import exported_of, tree_of, write
from mixed_program import mixed_program
from run_code import STRICT, alone, call_c, shared, state, tool

from substructures.export import Exported, Function
from substructures.export.stages import staged
from substructures.expr.interpret import interpret


def prepared(exported: Exported, values: dict[str, float]) -> dict[str, float]:
    """Names of ``w`` with what ``prepare`` gives, by the interpreter."""
    prepare, names = exported.functions[0], exported.interface.vectors["w"].names
    return dict(zip(names, interpret(prepare.program, values)["w"].tolist(), strict=True))


@pytest.mark.parametrize("parts", [("acrobot",), ("scara", "camera"), ("puma560",), ("furuta-pendulum",)])
def test_both_stages_give_what_one_gives(parts: tuple[str, ...], tmp_path: Path) -> None:
    whole = exported_of(tree_of(*parts))
    exported = staged(whole)
    write(exported, "c", tmp_path)
    library = shared([tmp_path / "demo.c"], STRICT)
    values = state(exported.interface)
    for factor in (1.0, 1.25):  # another set of parameters
        for name in exported.interface.vectors["p"].names:
            values[name] *= factor
        w = call_c(library, exported, exported.functions[0], values)["w"]
        here = values | dict(zip(exported.interface.vectors["w"].names, np.ravel(w).tolist(), strict=True))
        for one, other in zip(whole.functions, exported.functions[1:], strict=True):
            expected = interpret(one.program, values)
            for name, found in call_c(library, exported, other, here).items():
                scale = max(1e-300, np.abs(expected[name]).max(initial=0))
                np.testing.assert_allclose(found, expected[name], rtol=1e-11, atol=1e-13 * scale)


@pytest.mark.parametrize("parts", [("acrobot",), ("puma560",)])
def test_what_remains_is_what_each_state_costs(parts: tuple[str, ...]) -> None:
    whole = exported_of(tree_of(*parts))
    exported = staged(whole)
    for one, other in zip(whole.functions, exported.functions[1:], strict=True):
        assert other.program.count()["total"] == one.program.count(per_state=True)["total"]
        assert "w" in other.arguments
        assert other.arguments[-1] == "w"
    assert exported.functions[0].arguments == ("p",)


def test_a_stale_preparation_is_seen() -> None:
    exported = staged(exported_of(tree_of("puma560")))
    values = state(exported.interface)
    metric = next(f for f in exported.functions if f.quantity == "metric")
    old = values | prepared(exported, values)
    heavier = {n: 2 * values[n] for n in exported.interface.vectors["p"].names}
    new = values | heavier | prepared(exported, values | heavier)
    stale = values | heavier | prepared(exported, values)
    a, b, c = (interpret(metric.program, each)["metric"] for each in (old, new, stale))
    assert np.abs(a - b).max() > 0.1 * np.abs(a).max()
    assert np.abs(c - b).max() > 1e-3 * np.abs(a).max()


@pytest.mark.parametrize("compiler", ["gcc", "clang"])
def test_every_operation_and_the_selftest(compiler: str, tmp_path: Path) -> None:
    for name, whole in (("mixed", alone(mixed_program(), "mixed")), ("demo", exported_of(tree_of("scara", "camera")))):
        write(staged(whole), "c", tmp_path)
        sources = [str(tmp_path / f"{name}_selftest.c"), str(tmp_path / f"{name}.c")]
        subprocess.run([tool(compiler), *STRICT, "-o", str(tmp_path / "run"), *sources, "-lm"], check=True)
        done = subprocess.run([str(tmp_path / "run")], capture_output=True, text=True, check=False)
        assert (done.stdout.strip(), done.returncode) == ("ok", 0)
        header = (tmp_path / f"{name}.h").read_text()
        assert f"void {name}_prepare(const double *p, double *w" in header


def test_functions_without_parameters_stay(tmp_path: Path) -> None:
    exported = staged(alone(mixed_program(), "mixed"))
    functions: tuple[Function, ...] = exported.functions
    assert functions[0].quantity == "prepare"
    document = exported.document("x")
    assert document["functions"][0]["arguments"] == ["p"]
    assert write(exported, "interface", tmp_path)
