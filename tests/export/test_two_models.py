"""Two models stand in one program, in every language: neither hides a name of the other."""

from __future__ import annotations

import re
import subprocess
from collections.abc import Callable
from pathlib import Path

import pytest
from exported_models import exported_of, tree_of, write
from run_code import STRICT, load_python, octave, tool

from substructures import evaluate
from substructures.export import Exported

Q = (0.3, 0.4)


@pytest.fixture(scope="module")
def models() -> tuple[Exported, Exported]:
    return exported_of(tree_of("acrobot"), "one"), exported_of(tree_of("cart-pendulum"), "two")


def numbers(command: list[list[str]], folder: Path) -> list[float]:
    """What the last command prints."""
    for words in command:
        program = words[0] if words[0].startswith("./") else tool(words[0])
        done = subprocess.run([program, *words[1:]], cwd=folder, capture_output=True, text=True, check=False)
        assert done.returncode == 0, done.stderr
    return [float(x) for x in done.stdout.split()]


def c(folder: Path) -> list[float]:
    (folder / "main.c").write_text(
        '#include "one.h"\n#include "two.h"\n#include <stdio.h>\nint main(void) {\n'
        "    double q[2] = {0.3, 0.4}, p[one_NP], r[two_NP], m[4], n[4];\n"
        "    one_defaults(p); two_defaults(r); one_metric(q, p, m); two_metric(q, r, n);\n"
        '    printf("%.17g %.17g", m[0], n[1]);\n    return 0;\n}\n'
    )
    return numbers([["gcc", *STRICT, "-o", "run", "main.c", "one.c", "two.c", "-lm"], ["./run"]], folder)


def cpp(folder: Path) -> list[float]:
    (folder / "main.cpp").write_text(
        '#include "one.hpp"\n#include "two.hpp"\n#include <cstdio>\nint main() {\n'
        '    std::printf("%.17g %.17g", one::metric<>({0.3, 0.4})[0], two::metric<>({0.3, 0.4})[1]);\n}\n'
    )
    flags = ["-std=c++17", "-Wall", "-Wextra", "-Wpedantic", "-Werror"]
    return numbers([["g++", *flags, "-o", "run", "main.cpp"], ["./run"]], folder)


def fortran(folder: Path) -> list[float]:
    (folder / "main.f90").write_text(
        "program main\n    use one\n    use two\n    implicit none\n"
        "    integer, parameter :: dp = kind(1.0d0)\n"
        "    real(dp) :: q(2) = [0.3_dp, 0.4_dp], p(8), r(3), m(2, 2), n(2, 2)\n"
        "    call one_defaults(p)\n    call two_defaults(r)\n"
        "    call one_metric(q, p, m)\n    call two_metric(q, r, n)\n"
        "    print '(2es25.17)', m(1, 1), n(1, 2)\nend program\n"
    )
    flags = ["-std=f2018", "-pedantic", "-Wall", "-Wno-unused-dummy-argument", "-Wno-unused-variable"]
    return numbers([["gfortran", *flags, "-o", "run", "one.f90", "two.f90", "main.f90"], ["./run"]], folder)


def rust(folder: Path) -> list[float]:
    (folder / "main.rs").write_text(
        "mod one;\nmod two;\nfn main() {\n    let q = [0.3, 0.4];\n"
        "    let (mut m, mut n) = ([[0.0; 2]; 2], [[0.0; 2]; 2]);\n"
        "    one::one_metric(&q, &one::P, &mut m);\n    two::two_metric(&q, &two::P, &mut n);\n"
        '    println!("{} {}", m[0][0], n[0][1]);\n}\n'
    )
    return numbers([["rustc", "--edition", "2024", "-A", "dead_code", "-o", "run", "main.rs"], ["./run"]], folder)


def javascript(folder: Path) -> list[float]:
    (folder / "main.mjs").write_text(
        'import { load as one } from "./one.mjs";\nimport { load as two } from "./two.mjs";\n'
        "const [a, b] = await Promise.all([one(), two()]);\n"
        "console.log(a.one_metric([0.3, 0.4])[0], b.two_metric([0.3, 0.4])[1]);\n"
    )
    return numbers([["node", "main.mjs"]], folder)


def matlab(folder: Path) -> list[float]:
    script = "m = one_metric([0.3, 0.4]); n = two_metric([0.3, 0.4]); printf('%.17g %.17g', m(1, 1), n(1, 2));"
    return [float(x) for x in octave(script, folder)[0].split()]


def python(folder: Path) -> list[float]:
    one, two = (load_python((folder / f"{name}.py").read_text(), folder) for name in ("one", "two"))
    return [one.one_metric(Q)[0, 0], two.two_metric(two.Coordinates(*Q), two.Parameters())[0, 1]]


def cuda(folder: Path) -> list[float]:
    (folder / "main.cpp").write_text(
        '#include "one.cu"\n#include "two.cu"\n#include <stdio.h>\nint main() {\n'
        "    double q[2] = {0.3, 0.4}, p[one_NP], r[two_NP], m[4], n[4];\n"
        "    one_defaults(p); two_defaults(r); one_metric(q, p, m); two_metric(q, r, n);\n"
        '    printf("%.17g %.17g", m[0], n[1]);\n}\n'
    )
    return numbers([["g++", "-std=c++17", "-o", "run", "main.cpp"], ["./run"]], folder)


def casadi(folder: Path) -> list[float]:
    made = pytest.importorskip("casadi", reason="the wheel casadi is not installed")
    sources = [str(folder / f"{name}_casadi.c") for name in ("one", "two")]
    library = str(folder / "both.so")
    subprocess.run([tool("gcc"), *STRICT, "-shared", "-fPIC", "-o", library, *sources, "-lm"], check=True)
    one, two = (made.external(f"{name}_metric", library) for name in ("one", "two"))
    first, second = tree_of("acrobot"), tree_of("cart-pendulum")
    p, r = ([exported.interface.vectors["p"].defaults] for exported in (exported_of(first), exported_of(second)))
    return [float(one(Q, *p)[0, 0]), float(two(Q, *r)[0, 1])]


PROGRAMS: dict[str, Callable[[Path], list[float]]] = {
    "c": c,
    "cpp": cpp,
    "fortran": fortran,
    "rust": rust,
    "javascript": javascript,
    "matlab": matlab,
    "python": python,
    "cuda": cuda,
    "casadi": casadi,
}


@pytest.mark.parametrize(
    "target", [name if name == "c" else pytest.param(name, marks=pytest.mark.deep) for name in PROGRAMS]
)
def test_two_models_in_one_program(models: tuple[Exported, Exported], target: str, tmp_path: Path) -> None:
    for exported in models:
        write(exported, target, tmp_path)
    expected = [
        evaluate(tree_of("acrobot"), "metric", q=list(Q))["metric"][0][0],
        evaluate(tree_of("cart-pendulum"), "metric", q=list(Q))["metric"][0][1],
    ]
    assert PROGRAMS[target](tmp_path) == pytest.approx(expected, rel=1e-14)


def test_the_file_for_casadi_says_how_it_is_used(models: tuple[Exported, Exported], tmp_path: Path) -> None:
    """Its command compiles it, its line of Python loads it."""
    made = pytest.importorskip("casadi", reason="the wheel casadi is not installed")
    (path,) = write(models[0], "casadi", tmp_path)
    text = path.read_text()
    (command,) = re.findall(r"^//   (cc .*)$", text, re.MULTILINE)
    (name, line) = re.findall(r"^//   (\w+) = (casadi\.external.*)$", text, re.MULTILINE)[0]
    assert name == "one_metric"
    subprocess.run([tool("cc"), *command.split()[1:]], cwd=tmp_path, check=True)
    asked, library = re.findall(r'"([^"]*)"', line)
    p = list(models[0].interface.vectors["p"].defaults)
    found = made.external(asked, str(tmp_path / library))(Q, p)
    assert float(found[0, 0]) == pytest.approx(evaluate(tree_of("acrobot"), "metric", q=list(Q))["metric"][0][0])
