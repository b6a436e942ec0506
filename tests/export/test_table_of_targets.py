"""Every target that can be executed here gives M, Gamma and Q of large parts and of a tree; a table tells how well.

Self-tests are written with limits that nothing is within, so that they print every value that they find.
"""

from __future__ import annotations

import re
import subprocess
import sys
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from pathlib import Path
from time import perf_counter
from typing import Any

import numpy as np
import pytest
from exported_models import tree_of, write
from run_code import STRICT, agree, arguments, by_output, load_python, octave, shared, state, tool

from substructures import catalogue
from substructures.export import Exported, exported_model, interface_of_model, reference
from substructures.quantities.sources import Sources

from .algebra_systems import double, numbers_in_maxima
from .algebra_systems import values as values_for_algebra
from .cuda_on_cpu import call as call_cuda
from .cuda_on_cpu import library

pytestmark = pytest.mark.deep

QUANTITIES = ("metric", "christoffel", "forces", "forward_dynamics")
SEVERAL = 8
#: largest difference, relative to the largest element of an output: of direct formulas, and of forward dynamics
TOLERANCE, OF_SOLUTIONS = 1e-13, 1e-9
NUMBER = re.compile(r"-?\d+\.?\d*(?:[eE][+-]?\d+)?")
Runner = Callable[[Exported, Path], dict[str, float]]


def exported_of(*parts: str, quantities: tuple[str, ...] = QUANTITIES) -> Exported:
    model = tree_of(*parts)
    # of ball joints, whose rates are no derivatives, an FMU needs them
    quantities = (*quantities, *(["position_rates"] if model.balls else []))
    return exported_model(Sources(model), interface_of_model(model, "demo@1", "sha256:1"), quantities, "demo")


@dataclass
class Row:
    """What a target gave: bytes of the files of the tree, seconds to write all and to compile and run them."""

    size: int = 0
    writing: float = 0.0
    running: float = 0.0
    direct: float = 0.0
    solved: float = 0.0

    def add(self, exported: Exported, differences: Mapping[str, float]) -> None:
        for function in exported.functions:
            difference = differences[function.quantity]
            if function.quantity == "forward_dynamics":
                self.solved = max(self.solved, difference)
            else:
                self.direct = max(self.direct, difference)


def printed(exported: Exported, text: str) -> dict[str, float]:
    """The largest difference of every function in what its self-test printed."""
    lines = [line for line in text.splitlines() if exported.name in line]
    found: dict[str, float] = {}
    for function, each in zip(exported.functions, reference.reference(exported), strict=True):
        own, lines = lines[: len(each.checks)], lines[len(each.checks) :]
        pairs = [[float(x) for x in NUMBER.findall(line)[-2:]] for line in own]
        assert [y for _, y in pairs] == [check.value for check in each.checks]
        differences = [abs(x - y) / -check.limit for (x, y), check in zip(pairs, each.checks, strict=True)]
        found[function.quantity] = max(differences)
    assert not lines
    return found


def by_self_test(*commands: list[str]) -> Runner:
    def run(exported: Exported, folder: Path) -> dict[str, float]:
        """All commands; the last one prints."""
        for command in commands:
            given = [word.format(exported.name) for word in command]
            program = given[0] if given[0].startswith((".", "/")) else tool(given[0])
            done = subprocess.run([program, *given[1:]], cwd=folder, capture_output=True, text=True, timeout=600)
            assert done.returncode == 0 or command is commands[-1], done.stderr
        return printed(exported, done.stdout)

    return run


def by_jax(exported: Exported, folder: Path) -> dict[str, float]:
    pytest.importorskip("jax", reason="the wheel jax is not installed")
    return by_self_test([sys.executable, "{}_jax_selftest.py"])(exported, folder)


def by_octave(exported: Exported, folder: Path) -> dict[str, float]:
    path = folder / f"{exported.name}_selftest.m"
    path.write_text(
        path.read_text().replace("error('selftest:wrong', '%s", "printf('%s").replace("%.17g'", "%.17g\\n'")
    )
    return printed(exported, "\n".join(octave(f"{exported.name}_selftest()", folder)))


def compared(exported: Exported, call: Callable[[Any, Mapping[str, float]], Any]) -> dict[str, float]:
    """The largest difference of every function, called at a state."""
    values = state(exported.interface)
    return {f.quantity: agree(call(f, values), f, values, OF_SOLUTIONS) for f in exported.functions}


def by_sympy(exported: Exported, folder: Path) -> dict[str, float]:
    module = load_python((folder / f"{exported.name}_sympy.py").read_text(), folder)

    def call(function: Any, values: Mapping[str, float]) -> dict[str, Any]:
        found = by_output(function, getattr(module, exported.called(function))(**arguments(function, values)))
        return {n: np.array(x.tolist() if hasattr(x, "tolist") else x, dtype=float) for n, x in found.items()}

    return compared(exported, call)


def by_cuda_on_cpu(exported: Exported, folder: Path) -> dict[str, float]:
    loaded = library(exported, folder)
    return compared(exported, lambda f, values: call_cuda(loaded, exported, f, [values], False)[0])


def by_casadi(exported: Exported, folder: Path) -> dict[str, float]:
    casadi = pytest.importorskip("casadi", reason="the wheel casadi is not installed")
    # not optimised: most of it are Jacobians, which are not called here
    name = shared([folder / f"{exported.name}_casadi.c"], [*STRICT, "-O0"])._name

    def call(function: Any, values: Mapping[str, float]) -> dict[str, Any]:
        found = casadi.external(exported.called(function), name)(*arguments(function, values).values())
        (output,) = function.program.outputs
        return {output: np.asarray(found.full())}

    return compared(exported, call)


def by_maxima(exported: Exported, folder: Path) -> dict[str, float]:
    numbers = numbers_in_maxima(exported, folder / f"{exported.name}.mac", double)
    pairs = zip(exported.functions, numbers, strict=True)
    return {f.quantity: agree(x, f, values_for_algebra(f), OF_SOLUTIONS) for f, x in pairs}


def by_fmpy(exported: Exported, folder: Path) -> dict[str, float]:
    pytest.importorskip("fmpy", reason="the wheel FMPy is not installed")
    from .fmu_instances import instance  # noqa: PLC0415 -- needs the wheel

    values = state(exported.interface)
    vectors = exported.interface.vectors
    known = {name: values[name] for symbol in "qup" for name in vectors[symbol].names}
    # rates of ball joints are derivatives of nothing
    plain = {name.removesuffix("'"): values[name] for name in vectors["qd"].names}
    speeds = {f"{name}_d" if name in vectors["q"].names else name: x for name, x in plain.items()}
    changes = {"forward_dynamics": speeds, "position_rates": vectors["q"].names}
    with instance(folder / f"{exported.name}.fmu", **known, **speeds) as (one, at):

        def call(function: Any, _: Mapping[str, float]) -> dict[str, Any]:
            ((name, output),) = function.program.outputs.items()
            moved = changes.get(function.quantity)
            places = [at[name]] if moved is None else [at[f"der({each})"] for each in moved]
            size = int(np.prod(output.shape))
            return {name: np.array(one.getFloat64(places, nValues=size)).reshape(output.shape)}

        return compared(exported, call)


#: what runs a target, and by which name it stands in the table
TABLE: dict[str, tuple[str, str, Runner]] = {
    "c": ("c", "gcc", by_self_test(["gcc", *STRICT, "-O1", "-o", "run", "{}_selftest.c", "{}.c", "-lm"], ["./run"])),
    "c clang": (
        "c",
        "clang",
        by_self_test(["clang", *STRICT, "-O1", "-o", "run", "{}_selftest.c", "{}.c", "-lm"], ["./run"]),
    ),
    "cpp": ("cpp", "g++", by_self_test(["g++", "-std=c++17", "-O1", "-o", "run", "{}_selftest.cpp"], ["./run"])),
    "fortran": (
        "fortran",
        "gfortran",
        by_self_test(["gfortran", "-std=f2018", "-o", "run", "{}.f90", "{}_selftest.f90"], ["./run"]),
    ),
    "rust": ("rust", "rustc", by_self_test(["rustc", "--edition", "2024", "-o", "run", "{}_selftest.rs"], ["./run"])),
    "python": ("python", "NumPy", by_self_test([sys.executable, "{}_selftest.py"])),
    "jax": ("jax", "JAX", by_jax),
    "javascript": ("javascript", "Node", by_self_test(["node", "{}_selftest.mjs"])),
    "matlab": ("matlab", "Octave", by_octave),
    "casadi": ("casadi", "CasADi", by_casadi),
    "cuda": ("cuda", "g++", by_cuda_on_cpu),
    "fmu": ("fmu", "FMPy", by_fmpy),
    "sympy": ("sympy", "SymPy", by_sympy),
    "maxima": ("maxima", "Maxima", by_maxima),
}


@pytest.fixture(scope="module")
def cases() -> list[Exported]:
    """The parts with the most operations, and a tree of 12 degrees of freedom."""
    counted = []
    for name in catalogue.names():
        exported = exported_of(name, quantities=("metric", "christoffel"))
        counted.append((sum(f.program.count()["total"] for f in exported.functions), name))
    largest = [name for _, name in sorted(counted)[-SEVERAL:]]
    return [*(exported_of(name) for name in largest), exported_of("ur5", "puma560")]


@pytest.mark.parametrize("name", TABLE)
def test_numbers_of_large_models(
    cases: list[Exported],
    name: str,
    tmp_path: Path,
    monkeypatch: pytest.MonkeyPatch,
    capsys: pytest.CaptureFixture[str],
) -> None:
    monkeypatch.setattr(reference, "TOLERANCE", -1.0)
    target, executed, run = TABLE[name]
    row = Row()
    for k, exported in enumerate(cases):
        folder = tmp_path / str(k)
        folder.mkdir()
        start = perf_counter()
        row.size = sum(p.stat().st_size for p in write(exported, target, folder))
        row.writing += perf_counter() - start
        start = perf_counter()
        row.add(exported, run(exported, folder))
        row.running += perf_counter() - start
    with capsys.disabled():
        print(
            f"\n{name:10} {executed:8} tree {row.size / 1e3:4.0f} kB, all written in {row.writing:4.1f} s,"
            f" run in {row.running:4.1f} s, M, Gamma, Q to {row.direct:.1e}, forward dynamics to {row.solved:.1e}"
        )
    assert row.direct <= TOLERANCE
    assert row.solved <= OF_SOLUTIONS
