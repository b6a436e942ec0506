"""Programs in C and Octave that read the interface document, and need no other knowledge of what they call."""

from __future__ import annotations

import json
import shutil
import subprocess
from pathlib import Path

import numpy as np
import pytest
from exported_models import exported_of, tree_of, write
from mixed_program import POINT, mixed_program
from run_code import STRICT, Values, agree, alone, octave, shared, state, tool

from substructures.export import Exported

HERE = Path(__file__).parent


@pytest.fixture(params=["pair", "mixed"])
def case(request: pytest.FixtureRequest) -> tuple[Exported, Values]:
    """A tree of two bodies with all quantities, whose parameters have their defaults from the document alone, or a
    program with all operations and no defaults."""
    if request.param == "mixed":
        return alone(mixed_program(), "mixed"), POINT
    exported = exported_of(tree_of("scara", "camera"), "pair")
    defaults = set(exported.interface.vectors["p"].with_default)
    assert defaults
    return exported, {n: x for n, x in state(exported.interface).items() if n not in defaults}


def compare(lines: list[str], exported: Exported, given: Values) -> None:
    """Every output of every function, in the order of the document."""
    found = {(f.quantity, o): np.empty(0) for f in exported.functions for o in f.program.outputs}
    rest = iter(line for line in lines if line)
    for f in exported.functions:
        for output, array in f.program.outputs.items():
            called, name, *numbers = next(rest).split(" ")
            assert (called, name) == (exported.called(f), output)
            found[f.quantity, output] = np.array(numbers, dtype=float).reshape(array.shape)
    assert not list(rest)
    values = {**state(exported.interface), **given}
    for f in exported.functions:
        agree({o: found[f.quantity, o] for o in f.program.outputs}, f, values, 1e-11)


def documents(exported: Exported, given: Values, folder: Path) -> tuple[str, str]:
    """The files of the interface and of values."""
    (folder / "values.json").write_text(json.dumps({"names": list(given), "values": list(given.values())}))
    return write(exported, "interface", folder)[0].name, "values.json"


def test_a_caller_in_c(case: tuple[Exported, Values], tmp_path: Path) -> None:
    exported, given = case
    library = shared([p for p in write(exported, "c", tmp_path) if p.suffix == ".c" and "selftest" not in p.name])
    caller = ["-o", "caller", str(HERE / "generic_caller.c"), "-ldl"]
    subprocess.run([tool("gcc"), *STRICT, *caller], check=True, cwd=tmp_path)
    command = ["./caller", library._name, *documents(exported, given, tmp_path)]
    run = subprocess.run(command, cwd=tmp_path, capture_output=True, text=True, timeout=60)
    assert run.returncode == 0, run.stderr
    compare(run.stdout.split("\n"), exported, given)


def test_a_caller_in_octave(case: tuple[Exported, Values], tmp_path: Path) -> None:
    exported, given = case
    write(exported, "matlab", tmp_path)
    shutil.copy(HERE / "generic_caller.m", tmp_path)
    interface, values = documents(exported, given, tmp_path)
    compare(octave(f"generic_caller ('{interface}', '{values}')", tmp_path), exported, given)
