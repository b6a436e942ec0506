"""Runs exported functions: compiled, or in the interpreters that are installed, and compares with reference values.

Arguments are lists by symbol, in the order of the calling convention; results are arrays by output.
"""

from __future__ import annotations

import ctypes
import importlib.util
import itertools
import shutil
import subprocess
import zipfile
from collections.abc import Mapping, Sequence
from pathlib import Path
from types import ModuleType
from typing import Any

import numpy as np
import pytest

from substructures.export import Exported, Function, Interface
from substructures.expr.interpret import interpret
from substructures.expr.program import Program

COUNTER = itertools.count()
STRICT = ["-std=c99", "-Wall", "-Wextra", "-Wpedantic", "-Wconversion", "-Werror"]
Values = Mapping[str, float]


def tool(*names: str) -> str:
    """The first of these programs that is installed, or the test is skipped."""
    found = next((path for name in names if (path := shutil.which(name))), None)
    if found is None:
        pytest.skip(f"{names[0]} is not installed")
    return found


def alone(program: Program, name: str = "model", form: str = "compact") -> Exported:
    """A bare program as the function ``name_any``."""
    interface = Interface.of_symbols(program.symbols)
    return Exported(name, interface, (Function("any", program, interface),), form)


def arguments(function: Function, values: Values) -> dict[str, Any]:
    """The arguments of a function for values of symbols by name; what has none is 0."""
    found: dict[str, Any] = {}
    for symbol in function.arguments:
        column = [values.get(name, 0.0) for name in function.vector(symbol).names]
        found[symbol] = column[0] if symbol == "t" else column
    return found


def state(interface: Interface, seed: int = 1) -> dict[str, float]:
    """Values of all symbols: parameters at their defaults, or near 1, all else random."""
    rng = np.random.default_rng(seed)
    found = {}
    for symbol, vector in interface.vectors.items():
        for k, name in enumerate(vector.names):
            given = vector.defaults[k] if symbol == "p" else np.nan
            found[name] = float(rng.uniform(0.5, 1.5) if np.isnan(given) else given)
    return found


def agree(found: Mapping[str, Any], function: Function, values: Values, tolerance: float = 1e-12) -> float:
    """Compares with the interpreter; the largest difference, relative to the largest element of an output."""
    expected = interpret(function.program, values)
    assert set(found) == set(expected)
    worst = 0.0
    for name, value in expected.items():
        array = np.asarray(found[name], dtype=float).reshape(np.shape(value))
        np.testing.assert_array_equal(np.isnan(array), np.isnan(value))
        scale = max(1.0, float(np.nanmax(np.abs(value), initial=0.0)))
        worst = max(worst, float(np.nanmax(np.abs(array - value), initial=0.0)) / scale)
    assert worst <= tolerance
    return worst


def by_output(function: Function, result: Any) -> dict[str, Any]:
    """What a function gives, as a dictionary also where it is one array."""
    names = list(function.program.outputs)
    return {names[0]: result} if len(names) == 1 else dict(result)


def load_python(text: str, folder: Path) -> ModuleType:
    path = folder / f"generated_{next(COUNTER)}.py"
    path.write_text(text, encoding="ascii")
    spec = importlib.util.spec_from_file_location(path.stem, path)
    assert spec is not None
    assert spec.loader is not None
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    return module


def shared(sources: Sequence[Path], flags: Sequence[str] = STRICT, compiler: str = "") -> ctypes.CDLL:
    """A library of C sources."""
    library = sources[0].with_name(f"lib{next(COUNTER)}.so")
    given = ["-O1", *flags, "-shared", "-fPIC", "-o", str(library), *map(str, sources), "-lm"]
    subprocess.run([compiler or tool("gcc", "cc"), *given], check=True)
    return ctypes.CDLL(str(library))


def call_c(library: ctypes.CDLL, exported: Exported, function: Function, values: Values) -> dict[str, Any]:
    """A function of a library by its own signature."""
    given: list[Any] = []
    for symbol, value in arguments(function, values).items():
        array = np.array(value)
        given.append(ctypes.c_double(value) if symbol == "t" else array.ctypes.data_as(ctypes.c_void_p))
        given.append(array)  # kept alive
    results = {n: np.full(o.shape, np.nan) for n, o in function.program.outputs.items()}
    pointers = [*given[::2], *(a.ctypes.data_as(ctypes.c_void_p) for a in results.values())]
    getattr(library, exported.called(function))(*pointers)
    return results


def require_clean_sources(fmu: Path, compiler: str, folder: Path) -> None:
    """The C sources of an FMU compile without a warning."""
    with zipfile.ZipFile(fmu) as packed:
        for name in packed.namelist():
            if name.startswith("sources/"):
                (folder / Path(name).name).write_bytes(packed.read(name))
    for each in sorted(folder.glob("*.c")):
        command = [tool(compiler), *STRICT, "-fPIC", "-c", str(each), "-o", str(folder / "one.o")]
        done = subprocess.run(command, capture_output=True, text=True, check=False)
        assert done.returncode == 0, done.stderr[:2000]


def octave(script: str, folder: Path) -> list[str]:
    """The lines that a script prints. Fails when Octave does."""
    command = [tool("octave-cli", "octave"), "--no-gui", "--norc", "--eval", script]
    run = subprocess.run(command, cwd=folder, capture_output=True, text=True, timeout=900)
    assert run.returncode == 0, run.stderr
    return run.stdout.split("\n")


def octave_call(exported: Exported, function: Function, values: Values, folder: Path) -> dict[str, Any]:
    """A function file in this folder, called with columns; its outputs are printed row by row."""
    given = ", ".join(
        repr(v) if s == "t" else "[" + "; ".join(map(repr, v)) + "]" for s, v in arguments(function, values).items()
    )
    outputs = function.program.outputs
    results = ", ".join(f"y{k}" for k in range(len(outputs)))
    script = f"[{results}] = {exported.called(function)}({given});"
    for k, output in enumerate(outputs.values()):
        axes = len(output.shape)
        turned = f"permute(y{k}, [{' '.join(str(a) for a in range(axes, 0, -1))}])" if axes > 1 else f"y{k}"
        script += f" printf('%.17g ', {turned}); printf('\\n');"
    lines = octave(script, folder)
    shapes = [o.shape for o in outputs.values()]
    return {n: np.array(lines[k].split(), dtype=float).reshape(shapes[k]) for k, n in enumerate(outputs)}
