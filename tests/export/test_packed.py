"""Packed exports hold what evaluations' ``packed`` holds, in the same order, in every target that runs here."""

from __future__ import annotations

import json
import re
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest
from exported_models import LIMIT, exported_of, tree_of, write
from run_code import STRICT, by_output, call_c, load_python, octave, octave_call, shared, state, tool

from substructures import Model, evaluate
from substructures.export import TARGETS, Exported, files
from substructures.export.render import LANGUAGES
from substructures.formats.packing import unpack

#: fewer elements: n (n + 1) / 2 of n^2, and n (n^2 - 1) / 3 of n^3
SIZES = {"metric": 10, "christoffel": 20}


@pytest.fixture(scope="module")
def scara() -> Model:
    return tree_of("scara")


@pytest.fixture(scope="module")
def exported(scara: Model) -> Exported:
    return exported_of(scara, "lean", together=True, packed=True)


def right(found: dict[str, object], model: Model, exported: Exported) -> None:
    """Dense values from the model itself, not from the packed program."""
    values = state(exported.interface)
    q = [values[name] for name in exported.interface.vectors["q"].names]
    for name, size in SIZES.items():
        packed = np.asarray(found[name], dtype=float)
        assert packed.size == size
        expected = np.asarray(evaluate(model, name, q=q)[name])
        assert np.abs(expected).max() > 0
        np.testing.assert_allclose(unpack(name, packed.ravel(), model.dof), expected, rtol=1e-12, atol=1e-12)


def test_values_in_c_python_and_octave(scara: Model, exported: Exported, tmp_path: Path) -> None:
    values = state(exported.interface)
    library = shared([p for p in write(exported, "c", tmp_path) if p.suffix == ".c" and "selftest" not in p.name])
    module = load_python(write(exported, "python", tmp_path)[0].read_text(), tmp_path)
    write(exported, "matlab", tmp_path)
    *_, together = exported.functions
    right(call_c(library, exported, together, values), scara, exported)
    q = [values[name] for name in exported.interface.vectors["q"].names]
    some = [f for f in exported.functions if f.quantity in SIZES]
    right({f.quantity: by_output(f, getattr(module, exported.called(f))(q))[f.quantity] for f in some}, scara, exported)
    right({f.quantity: octave_call(exported, f, values, tmp_path)[f.quantity] for f in some}, scara, exported)


@pytest.mark.parametrize("target", sorted(set(TARGETS) - {"text", "latex", "mathml"}))
def test_every_target_has_the_table(exported: Exported, target: str) -> None:
    """The indices of all elements, from 0 or 1 as the language counts, in a comment or as data."""
    text = "\n".join(data.decode("latin-1") for data in files(exported, target, LIMIT).values())
    metric = [(a, b) for a in range(4) for b in range(a + 1)]
    christoffel = [(a, b, c) for c in range(4) for a in range(c) for b in range(c + 1)]
    first = LANGUAGES[target].first if target in LANGUAGES else 0
    comments = re.sub(r"\W*\n\W*from \d+: ", ", ", text)
    data = re.sub(r"\s", "", text)
    for indices in (metric, christoffel):
        told = ", ".join(" ".join(str(i + first) for i in index) for index in indices)
        assert told in comments or str([list(index) for index in indices]).replace(" ", "") in data


def test_the_interface_tells_the_indices(scara: Model, exported: Exported) -> None:
    told = json.loads(files(exported, "interface", LIMIT)["lean_interface.json"])
    outputs = {f["quantity"]: f["outputs"][0] for f in told["functions"]}
    for name, size in SIZES.items():
        indices = np.array(outputs[name]["packed"])
        assert outputs[name]["shape"] == [size]
        assert indices.shape == (size, len(indices[0]))
        dense = np.arange(scara.dof ** len(indices[0])).reshape((scara.dof,) * len(indices[0]))
        # position and index agree with how evaluations are unpacked
        again = unpack(name, np.arange(1, size + 1), scara.dof)
        assert dense.shape == again.shape
        assert [again[tuple(index)] for index in indices] == list(range(1, size + 1))
    assert "packed" not in outputs["gravity"]


@pytest.mark.parametrize(
    ("target", "commands"),
    [
        ("c", [["gcc", *STRICT, "-o", "run", "lean_selftest.c", "lean.c", "-lm"], ["./run"]]),
        ("fortran", [["gfortran", "-std=f2018", "-o", "run", "lean.f90", "lean_selftest.f90"], ["./run"]]),
        ("cpp", [["g++", "-std=c++17", "-o", "run", "lean_selftest.cpp"], ["./run"]]),
        ("javascript", [["node", "lean_selftest.mjs"]]),
        ("python", [[sys.executable, "lean_selftest.py"]]),
    ],
)
def test_self_tests(exported: Exported, target: str, commands: list[list[str]], tmp_path: Path) -> None:
    write(exported, target, tmp_path)
    for program, *rest in commands:
        command = [program if program[0] in "./" else tool(program), *rest]
        done = subprocess.run(command, cwd=tmp_path, capture_output=True, text=True, timeout=900)
        assert done.returncode == 0, done.stdout + done.stderr
    assert done.stdout.strip() == "ok"


def test_self_test_in_octave(exported: Exported, tmp_path: Path) -> None:
    write(exported, "matlab", tmp_path)
    assert octave("lean_selftest()", tmp_path)[0] == "ok"
