"""Every target that can be executed here is: its self-test, whose reference values are the interpreter's, says ok."""

from __future__ import annotations

import subprocess
import sys
from collections.abc import Sequence
from pathlib import Path
from struct import pack

import pytest
from defusedxml import ElementTree
from exported_models import LIMIT, exported_of, tree_of, write
from mixed_program import mixed_program
from run_code import STRICT, alone, octave, tool

from substructures.export import TARGETS, Exported, files
from substructures.export.reference import reference

CPP = ["-std=c++17", "-Wall", "-Wextra", "-Wpedantic", "-Wconversion", "-Werror"]
FORTRAN = [
    "gfortran",
    "-std=f2018",
    "-pedantic",
    "-Wall",
    "-Wno-unused-dummy-argument",
    "-Wno-unused-variable",
    "-Werror",
]
#: commands by target, the last one runs the self-test
COMMANDS: dict[str, list[list[str]]] = {
    "c": [["gcc", *STRICT, "-o", "run", "{}_selftest.c", "{}.c", "-lm"], ["./run"]],
    "cpp": [["g++", *CPP, "-o", "run", "{}_selftest.cpp"], ["./run"]],
    "fortran": [
        [*FORTRAN, "-o", "run", "{}.f90", "{}_selftest.f90"],
        ["./run"],
    ],
    "rust": [["rustc", "--edition", "2024", "-D", "warnings", "-o", "run", "{}_selftest.rs"], ["./run"]],
    "javascript": [["node", "{}_selftest.mjs"]],
    "python": [[sys.executable, "{}_selftest.py"]],
}


def run(exported: Exported, commands: Sequence[Sequence[str]], folder: Path) -> tuple[int, str]:
    """Return code and output of the last command; the others have to succeed."""
    for k, command in enumerate(commands):
        given = [word.format(exported.name) for word in command]
        program = given[0] if given[0].startswith((".", "/")) else tool(given[0])
        done = subprocess.run([program, *given[1:]], cwd=folder, capture_output=True, text=True, timeout=300)
        if k < len(commands) - 1:
            assert done.returncode == 0, done.stdout + done.stderr
    return done.returncode, done.stdout + done.stderr


@pytest.fixture(scope="module")
def cases() -> list[Exported]:
    """Every operation and symmetry, and all quantities of two models."""
    trees = [
        exported_of(tree_of(*parts), name) for parts, name in ((("acrobot",), "arm"), (("scara", "camera"), "pair"))
    ]
    return [alone(mixed_program(), "mixed"), *trees]


@pytest.mark.parametrize("target", COMMANDS)
def test_self_tests(cases: list[Exported], target: str, tmp_path: Path) -> None:
    for exported in cases:
        write(exported, target, tmp_path)
        code, text = run(exported, COMMANDS[target], tmp_path)
        assert (code, text.strip()) == (0, "ok"), text


def test_self_test_in_octave(cases: list[Exported], tmp_path: Path) -> None:
    for exported in cases:
        write(exported, "matlab", tmp_path)
        assert octave(f"{exported.name}_selftest()", tmp_path)[0] == "ok"


#: 9.81 and 9.82 as they are written
OLD = {**dict.fromkeys(COMMANDS, b"9.81"), "javascript": pack("<d", 9.81)}
NEW = {**dict.fromkeys(COMMANDS, b"9.82"), "javascript": pack("<d", 9.82)}


@pytest.mark.parametrize("target", COMMANDS)
def test_self_tests_see_a_fault(cases: list[Exported], target: str, tmp_path: Path) -> None:
    """A number of the acrobot's forces is another one."""
    exported = cases[1]
    for path in write(exported, target, tmp_path):
        data = path.read_bytes()
        assert path.stem != exported.name or path.suffix in (".h", ".mjs") or OLD[target] in data
        path.write_bytes(data if "selftest" in path.name else data.replace(OLD[target], NEW[target]))
    code, text = run(exported, COMMANDS[target], tmp_path)
    assert code != 0
    assert "arm_forces" in text


def test_self_tests_compare_something(cases: list[Exported]) -> None:
    for exported in cases:
        for each in reference(exported):
            assert each.checks
    # every function of the closed set is compared, none is NaN there
    (mixed,) = reference(cases[0])
    number = list(cases[0].functions[0].program.outputs).index("list")
    assert {c.index for c in mixed.checks if c.output == number} >= {(k,) for k in range(12)}


def test_what_is_not_executed_says_so(cases: list[Exported]) -> None:
    for name, target in TARGETS.items():
        text = "".join(data.decode("latin-1") for data in files(cases[1], name, LIMIT).values())
        assert ("Not executed" in text) == (not target.executed), name


def test_prefixes_of_several_functions_differ(cases: list[Exported]) -> None:
    for exported in cases:
        names = [exported.called(f) for f in exported.functions]
        assert len(set(names)) == len(names)


def test_formulas_to_be_read(cases: list[Exported], tmp_path: Path) -> None:
    """LaTeX compiles, pages are well-formed, and the metric of the acrobot is the textbook's line."""
    exported = cases[1]
    lines = files(exported, "text", LIMIT)["arm_metric.txt"].decode().splitlines()
    assert "metric[2, 2] = Ic2 + m2*lc2^2" in lines
    for name, data in files(exported, "mathml", LIMIT).items():
        assert ElementTree.fromstring(data).tag.endswith("html"), name
    latex = tool("pdflatex")
    for path in write(exported, "latex", tmp_path)[:3]:
        command = [latex, "-interaction=nonstopmode", "-halt-on-error", path.name]
        done = subprocess.run(command, cwd=tmp_path, capture_output=True, text=True, timeout=900, check=False)
        assert done.returncode == 0, done.stdout[-2000:]
        assert "Overfull" not in done.stdout
