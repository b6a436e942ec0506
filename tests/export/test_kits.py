"""What stands beside functions in a zip: the commands of each README run as they are printed, the example is right."""

from __future__ import annotations

import os
import re
import subprocess
import sys
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from exported_models import LIMIT, exported_of, tree_of, write
from run_code import tool

from substructures.export import Exported, files
from substructures.export.kits import KITS
from substructures.export.kits.example import Example
from substructures.export.stages import staged
from substructures.expr.interpret import interpret

#: what the commands of a README need
NEEDS = {"c": "cmake", "cpp": "cmake", "rust": "cargo", "fortran": "gfortran", "javascript": "node"}
NEEDS |= {"matlab": "octave-cli"}
RUN = [target for target, kit in KITS.items() if kit.executed]
LINES = 10


def blocks(readme: str) -> dict[str, str]:
    """The code blocks by language."""
    return dict(re.findall(r"```(\w+)\n(.*?)```", readme, re.DOTALL))


def printed(folder: Path, **more: str) -> list[str]:
    """What the commands of the README print, line by line. ``more``: of the environment."""
    commands = blocks((folder / "README.md").read_text())["sh"]
    path = f"{Path(sys.executable).parent}{os.pathsep}{os.environ['PATH']}"
    environment = {**os.environ, "PATH": path, "CARGO_NET_OFFLINE": "true", **more}
    done = subprocess.run(
        [tool("sh"), "-e", "-c", commands], cwd=folder, capture_output=True, text=True, timeout=300, env=environment
    )
    assert done.returncode == 0, done.stdout + done.stderr
    return done.stdout.splitlines()


def expected(exported: Exported) -> float:
    """The first element of the first output of the example's function, by the interpreter."""
    example = Example(exported)
    return float(np.ravel(next(iter(interpret(example.function.program, example.values()).values())))[0])


@pytest.mark.parametrize("target", [pytest.param(t, marks=() if t == "c" else pytest.mark.deep) for t in RUN])
def test_the_readme_does_what_it_says(target: str, tmp_path: Path) -> None:
    if target == "jax":
        pytest.importorskip("jax", reason="the wheel jax is not installed")
    tool(NEEDS.get(target, "sh"))
    for k, exported in enumerate((exported_of(tree_of("acrobot"), "arm"), forces())):
        folder = tmp_path / str(k)
        folder.mkdir()
        write(exported, target, folder)
        *_, ok, number = printed(folder)
        assert ok == "ok"
        assert float(number) == pytest.approx(expected(exported), rel=1e-8)


@pytest.mark.parametrize("target", [pytest.param(t, marks=() if t == "python" else pytest.mark.deep) for t in RUN])
def test_where_nothing_moves_there_is_nothing_to_print(target: str, tmp_path: Path) -> None:
    if target == "jax":
        pytest.importorskip("jax", reason="the wheel jax is not installed")
    tool(NEEDS.get(target, "sh"))
    write(exported_of(tree_of("camera"), "arm", quantities=("metric", "forces")), target, tmp_path)
    with_warnings = {"CFLAGS": "-Wall -Wextra -Werror", "CXXFLAGS": "-Wall -Wextra -Werror"}
    assert printed(tmp_path, **with_warnings)[-1] == "ok"
    write(exported_of(tree_of("camera"), "arm", quantities=("metric", "position")), target, tmp_path)
    assert float(printed(tmp_path)[-1]) == 0


def forces() -> Exported:
    """With time, inputs and velocities, and outputs of several arrays."""
    exported = exported_of(tree_of("cart-pendulum"), "cart")
    chosen = ("forces", "kinematics")
    return replace(exported, functions=tuple(each for each in exported.functions if each.quantity in chosen))


@pytest.mark.parametrize("target", sorted(KITS))
def test_the_readme_prints_the_example(target: str) -> None:
    made = files(exported_of(tree_of("acrobot"), "arm"), target, LIMIT)
    (name,) = [each for each in made if each.startswith("arm_example")]
    text = made[name].decode()
    printed_there = [text for language, text in blocks(made["README.md"].decode()).items() if language != "sh"]
    assert printed_there == [text]
    assert len([line for line in text.splitlines() if line.strip()]) <= LINES
    assert "demo version 1" in made["README.md"].decode()


@pytest.mark.parametrize("options", [{"standard": "c89"}, {"precision": "single"}])
@pytest.mark.deep
def test_variants_of_c(options: dict[str, str], tmp_path: Path) -> None:
    for k, exported in enumerate((exported_of(tree_of("acrobot")), staged(exported_of(tree_of("acrobot"))))):
        (tmp_path / str(k)).mkdir()
        write(replace(exported, **options), "c", tmp_path / str(k))
        *_, ok, number = printed(tmp_path / str(k))
        assert (ok, float(number)) == ("ok", pytest.approx(expected(exported_of(tree_of("acrobot"))), rel=1e-6))


def test_no_two_targets_write_one_file() -> None:
    """But for what has its name from the tools: README, CMakeLists.txt; FMUs of either version, and C89."""
    seen: dict[str, str] = {}
    common = {"README.md", "CMakeLists.txt"}
    for target in ("c", "cpp", "casadi", "simulink", "cuda", "fortran", "rust", "python", "jax", "sympy", "matlab"):
        for name in set(files(exported_of(tree_of("acrobot")), target, LIMIT)) - common:
            if name == "demo_parameters.m":  # the same in either
                continue
            assert name not in seen, (name, target, seen[name])
            seen[name] = target
