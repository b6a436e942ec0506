"""Stored kernels: equal to fresh ones, found again, never used when damaged or foreign."""

from __future__ import annotations

import dataclasses
import hashlib
import json
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from machine_code import NEEDS_MACHINE_CODE

from substructures.compile import cache, compile_program, engine, target
from substructures.compile import compiled as package
from substructures.compile.lowering import lower
from substructures.compile.recipe import Recipe
from substructures.expr.graph import Graph
from substructures.expr.program import Program

pytestmark = NEEDS_MACHINE_CODE
VALUES = {"m": 2.0, "x": np.linspace(-1, 1, 21)}


@pytest.fixture
def spring(collected: Callable[..., Program]) -> Program:
    g = Graph()
    m, x = g.symbol("m"), g.symbol("x")
    return collected(g, {"m": "parameter"}, force=g.function("sin", m * x) / (m + x * x), energy=m * x * x)


@pytest.fixture(autouse=True)
def _new_process(monkeypatch: pytest.MonkeyPatch) -> None:
    """The shared functions are looked up in the folder as well."""
    monkeypatch.setattr(engine, "_runtimes", {})


@pytest.fixture
def compiled(monkeypatch: pytest.MonkeyPatch) -> list[str]:
    """What LLVM has been asked to compile."""
    asked: list[str] = []
    assemble = target.assemble

    def noted(text: str, *level: int) -> bytes:
        asked.append(text)
        return assemble(text, *level)

    monkeypatch.setattr(target, "assemble", noted)
    return asked


def results(program: Program, folder: Path | None) -> Any:
    return compile_program(program, ["force", "energy"], folder).evaluate(VALUES)


def files(folder: Path) -> list[Path]:
    return sorted(folder.iterdir())


def forget(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(engine, "_runtimes", {})


def test_cached_equals_fresh(
    spring: Program, tmp_path: Path, compiled: list[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    folder = tmp_path / "kernels"
    fresh = results(spring, None)
    forget(monkeypatch)
    first = results(spring, folder)
    assert len(compiled) == 4
    assert len(files(folder)) == 2
    forget(monkeypatch)
    second = results(spring, folder)
    assert len(compiled) == 4
    for name, array in fresh.items():
        np.testing.assert_array_equal(first[name], array)
        np.testing.assert_array_equal(second[name], array)


def test_other_programs_outputs_and_hosts_have_other_entries(
    spring: Program, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    results(spring, tmp_path)
    compile_program(spring, ["force"], tmp_path)
    compile_program(spring.select(["force"]), ["force"], tmp_path)
    assert len(files(tmp_path)) == 4
    other = dataclasses.replace(target.host(), cpu="another")
    monkeypatch.setattr(target, "host", lambda: other)
    monkeypatch.setattr(package.target, "machine", target.machine)
    compile_program(spring, ["force"], tmp_path)
    assert len(files(tmp_path)) == 5


def test_kernels_for_one_state_are_found_again(
    spring: Program, tmp_path: Path, compiled: list[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    for _ in range(2):
        compile_program(spring, ["force"], tmp_path, single=True)
        compile_program(spring, ["force"], tmp_path, width=2)
        forget(monkeypatch)
    assert len(compiled) == 3
    assert len(files(tmp_path)) == 3


def damaged(data: bytes) -> dict[str, bytes]:
    head, body = data[: len(cache.MARK) + 65], data[len(cache.MARK) + 65 :]

    def sealed(content: bytes) -> bytes:
        return cache.MARK + hashlib.sha256(content).hexdigest().encode() + b"\n" + content

    line, _, code = body.partition(b"\n")
    return {
        "empty": b"",
        "cut": data[:-1],
        "bit in the code": data[:-100] + bytes([data[-100] ^ 1]) + data[-99:],
        "bit in the head": head + bytes([body[0] ^ 1]) + body[1:],
        "other mark": b"S" + data[1:],
        "other key": sealed(line.replace(b'"key":"', b'"key":"0') + b"\n" + code),
        "no JSON": sealed(b"?" + body),
        "other JSON": sealed(line.replace(b'"steps"', b'"stops"') + b"\n" + code),
        "no code": sealed(line + b"\n"),
    }


def test_recipes_as_plain_data(spring: Program) -> None:
    recipe = Recipe.of(lower(spring, ["force", "energy"]), spring)
    plain = json.loads(json.dumps(recipe.plain()))
    assert Recipe.read(plain) == recipe
    with pytest.raises(ValueError, match="3 stages"):
        Recipe.read(plain | {"stages": plain["stages"][:3]})


def test_damaged_entries_are_made_anew(
    spring: Program, tmp_path: Path, compiled: list[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    fresh = results(spring, tmp_path)
    for path in files(tmp_path):
        intact = path.read_bytes()
        for name, data in damaged(intact).items():
            path.write_bytes(data)
            forget(monkeypatch)
            before = len(compiled)
            again = results(spring, tmp_path)
            assert len(compiled) - before == (b'"data":null' not in intact or name != "other JSON"), name
            assert path.read_bytes() == intact or b'"data":null' in intact, name
            np.testing.assert_array_equal(again["force"], fresh["force"])
            path.write_bytes(intact)


def test_a_folder_that_cannot_be_written(spring: Program, tmp_path: Path) -> None:
    blocked = tmp_path / "file"
    blocked.write_bytes(b"")
    np.testing.assert_array_equal(results(spring, blocked)["force"], results(spring, None)["force"])
