"""JAX functions: values, derivatives through JAX, maps over states, and the self-test."""

from __future__ import annotations

import subprocess
import sys
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from exported_models import exported_of, tree_of, write
from mixed_program import POINT, mixed_program
from run_code import agree, alone, arguments, by_output, load_python, state

from substructures.export import Exported, files
from substructures.expr.interpret import interpret

jax = pytest.importorskip("jax", reason="the wheel jax is not installed")
jax.config.update("jax_enable_x64", True)


@pytest.fixture(scope="module")
def loaded(tmp_path_factory: pytest.TempPathFactory) -> tuple[Exported, Any, Path]:
    exported = exported_of(tree_of("scara", "camera"))
    folder = tmp_path_factory.mktemp("jax")
    path = next(path for path in write(exported, "jax", folder) if "selftest" not in path.name)
    return exported, load_python(path.read_text(), folder), folder


@pytest.mark.parametrize("form", ["compact", "expanded"])
def test_every_operation(form: str, tmp_path: Path) -> None:
    exported = alone(mixed_program(), "two_links", form)
    (function,) = exported.functions
    module = load_python(files(exported, "jax", 10**5)["two_links_jax.py"].decode(), tmp_path)
    agree(by_output(function, jax.jit(module.two_links_any)(**arguments(function, POINT))), function, POINT)
    with pytest.raises(ValueError, match=r"p has the shape \(1,\), \(5,\) is needed"):
        module.two_links_any([], [], [], [], [1.0])


def test_values_and_maps_over_states(loaded: tuple[Exported, Any, Path]) -> None:
    exported, module, _ = loaded
    for function in exported.functions:
        values = state(function.interface)
        given = list(arguments(function, values).values())
        call = getattr(module, exported.called(function))
        expected = interpret(function.program, values)
        agree(by_output(function, call(*map(np.asarray, given))), function, values)
        batch = [np.stack([np.asarray(x)] * 3) for x in given]
        found = by_output(function, jax.vmap(call)(*batch))
        for name, y in expected.items():
            np.testing.assert_allclose(np.asarray(found[name])[2], y, rtol=1e-12, atol=1e-12)


def test_derivatives_are_differences(loaded: tuple[Exported, Any, Path]) -> None:
    exported, module, _ = loaded
    metric, dynamics = module.demo_metric, module.demo_forward_dynamics
    q = np.linspace(0.2, 0.9, len(exported.interface.vectors["q"]))
    nothing = np.zeros(len(exported.interface.vectors["u"]))
    for f in (metric, lambda x: dynamics(x, 0 * x, nothing)):
        found = np.asarray(jax.jacfwd(f)(q))
        for k in range(len(q)):
            h = np.eye(len(q))[k] * 1e-6
            slope = (np.asarray(f(q + h)) - np.asarray(f(q - h))) / 2e-6
            np.testing.assert_allclose(found[..., k], slope, rtol=1e-6, atol=1e-7)


def test_the_selftest_is_passed(loaded: tuple[Exported, Any, Path]) -> None:
    done = subprocess.run(
        [sys.executable, "demo_jax_selftest.py"], cwd=loaded[2], capture_output=True, text=True, check=False
    )
    assert (done.stdout.strip(), done.returncode) == ("ok", 0), done.stderr
