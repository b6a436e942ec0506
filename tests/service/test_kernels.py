"""Compiled kernels behind the evaluations: the same numbers, kept in a folder, made at once for large batches."""

from __future__ import annotations

import gc
import weakref
from pathlib import Path
from threading import Event
from time import monotonic, sleep
from typing import Any

import numpy as np
import pytest
from fastapi.testclient import TestClient
from machine_code import NEEDS_MACHINE_CODE

from service.settings import Settings
from service.store import kernels
from service.store.kernels import Kernels
from substructures import Definition, Model, TreeSpec, catalogue, couple, derive
from substructures.compile import compile_program
from substructures.part.part import Part
from substructures.quantities.from_parts import NumericTree
from substructures.quantities.numbers.evaluation import EvaluationOptions, evaluate


@pytest.fixture(scope="module")
def model() -> Model:
    spec = {"name": "arm", "gravity": [0, 0, "-9.81"], "instances": [{"name": "arm", "substructure": "ur5"}]}
    return couple(TreeSpec.read(spec), {"arm": derive(Definition.read(catalogue.load("ur5")))})


def request(states: int) -> dict[str, object]:
    q = np.random.default_rng(0).uniform(-3, 3, (states, 6))
    return {"quantities": ["metric", "forces", "forward_dynamics", "kinetic_energy"], "q": q, "qd": q[:, ::-1]}


def agree(model: Model, engine: Kernels, states: int) -> None:
    wanted = request(states)
    found, expected = evaluate(model, **wanted, options=EvaluationOptions(evaluator=engine)), evaluate(model, **wanted)
    for name in wanted["quantities"]:
        np.testing.assert_allclose(found[name], expected[name], rtol=1e-9, atol=1e-9)


def test_small_batches_are_answered_first_and_compiled_then(
    model: Model, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    engine, gate = Kernels(tmp_path), Event()
    engine._compiler.submit(gate.wait)
    agree(model, engine, 3)
    assert not list(tmp_path.iterdir())
    gate.set()
    limit = monotonic() + 30
    while engine._waiting:
        assert monotonic() < limit, "nothing is compiled in the background"
        sleep(0.02)
    assert list(tmp_path.iterdir())
    monkeypatch.setattr("service.store.kernels.interpreted", None)  # kernels alone can answer now
    agree(model, engine, 3)
    engine.close()


def test_large_batches_are_compiled_at_once(model: Model, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(kernels, "AT_ONCE", 10)
    monkeypatch.setattr("service.store.kernels.interpreted", None)
    engine = Kernels(tmp_path)
    agree(model, engine, 33)
    engine.close()
    assert list(tmp_path.iterdir())


def test_large_batches_may_come_in_pieces(model: Model, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """The background is too busy to compile; the third piece is more than is worth interpreting."""
    monkeypatch.setattr(kernels, "AT_ONCE", 10)
    engine = Kernels(tmp_path)
    monkeypatch.setattr(engine._compiler, "submit", lambda *_: None)
    for _ in range(2):
        agree(model, engine, 4)
        assert not list(tmp_path.iterdir())
    agree(model, engine, 4)
    assert list(tmp_path.iterdir())
    engine.close()


def test_damaged_files_are_made_anew(model: Model, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(kernels, "AT_ONCE", 1)
    for _ in range(2):
        engine = Kernels(tmp_path)
        agree(model, engine, 5)
        engine.close()
        kept = {file: file.read_bytes() for file in tmp_path.iterdir()}
        assert kept
        assert not any(content.endswith(b"garbage") for content in kept.values())
        for file, content in kept.items():
            file.write_bytes(content[:-7] + b"garbage")


SPEC = {
    "name": "two",
    "gravity": [0, 0, "-9.81"],
    "instances": [
        {"name": "a", "substructure": "planar-2r"},
        {"name": "b", "substructure": "planar-2r", "at": "a.link2", "parameters": {"m1": "a.m2"}},
    ],
}


def test_one_state_comes_from_warm_parts(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """Without compiling anything for the tree; the same numbers as from its formulas."""
    part, spec = derive(Definition.read(catalogue.load("planar-2r"))), TreeSpec.read(SPEC)
    parts = {"a": part, "b": part}
    model, engine = couple(spec, parts), Kernels(tmp_path)
    engine.prepare(parts.values())
    limit = monotonic() + 30
    while not engine.warm(parts.values()):
        assert monotonic() < limit
        sleep(0.02)
    asked: list[str] = []
    tree = NumericTree(spec, parts, engine.of_part)
    monkeypatch.setattr(engine, "_compile_later", lambda key, *_: asked.append(key[0]))
    monkeypatch.setattr("service.store.kernels.interpreted", None)
    monkeypatch.setattr("service.store.kernels.interpret_entries", None)
    q = np.random.default_rng(1).uniform(-1, 1, 4)
    wanted = {"quantities": ["metric", "christoffel", "forces", "kinematics"], "q": q, "qd": q[::-1]}
    found = evaluate(
        model,
        **wanted,
        options=EvaluationOptions(evaluator=engine.of_tree(model.program, parts.values(), lambda: tree)),
    )
    expected = evaluate(model, **wanted)
    for name in ("metric", "christoffel", "forces"):
        np.testing.assert_allclose(found[name], expected[name], rtol=0, atol=1e-12)
    np.testing.assert_allclose(found["kinematics"]["U"], expected["kinematics"]["U"], atol=1e-12)
    assert asked == [model.program.digest]
    engine.close()


def test_ways() -> None:
    assert kernels.quickest(1, coupled=True, warm=True) is kernels.Way.PARTS
    assert kernels.quickest(1, coupled=True, warm=False) is kernels.Way.INTERPRETER
    assert kernels.quickest(100, coupled=True, warm=True) is kernels.Way.INTERPRETER
    assert kernels.quickest(100, coupled=False, warm=True) is kernels.Way.PARTS
    assert kernels.quickest(10**5, coupled=False, warm=True) is kernels.Way.KERNEL


def test_kernels_on_request(filled: TestClient, monkeypatch: pytest.MonkeyPatch) -> None:
    """Compiled once; evaluations of the same quantities then use them."""
    body = {"quantities": ["metric", "forward_dynamics"]}
    first = filled.post("/v1/trees/cell/kernels", json=body)
    assert first.status_code == 201, first.text
    rows = first.json()["kernels"]
    assert [(row["program"], row["new"]) for row in rows] == [("model", True), ("forward_dynamics", True)]
    again = filled.post("/v1/trees/cell/kernels", json=body)
    assert again.status_code == 200
    assert not any(row["new"] for row in again.json()["kernels"])
    states = {"q": [[0.1], [0.2]], "qd": [[0], [1]]}
    monkeypatch.setattr("service.store.kernels.interpreted", None)
    assert filled.post("/v1/trees/cell/evaluations", json={**body, **states}).status_code == 200
    assert filled.post("/v1/trees/cell").status_code == 405


@pytest.mark.parametrize("body", [[], {}, {"quantities": ["mass"]}, {"quantities": [{}]}, {"more": 1}])
def test_refused_requests_for_kernels(filled: TestClient, body: Any) -> None:
    assert filled.post("/v1/trees/cell/kernels", json=body).status_code == 422


@pytest.mark.parametrize(
    ("database", "folder", "expected"),
    [
        ("sqlite:///a/b.db", "", Path("a/b.db.kernels")),
        ("sqlite:///a/b.db", "-", None),
        ("sqlite:///a/b.db", "c", Path("c")),
        ("postgresql://h/d", "", None),
    ],
)
def test_folder(database: str, folder: str, expected: Path | None) -> None:
    assert Settings(database=database, kernels=folder).kernel_folder == expected


def pendulums(count: int) -> list[Part]:
    """Parts that differ by a number in their formulas."""
    document = catalogue.load("simple-pendulum")
    loads = [{"type": "joint", "coordinate": "q1", "force": f"-{k}*q1^3"} for k in range(1, count + 1)]
    return [derive(Definition.read({**document, "loads": [load]})) for load in loads]


@NEEDS_MACHINE_CODE
def test_kernels_in_memory_are_bounded_and_come_back(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """Room for three: the one that was not used for longest is unloaded, and read from the folder when it is asked."""
    parts, names = pendulums(5), ["metric", "applied"]
    first = compile_program(parts[0].program, names)
    monkeypatch.setattr(kernels, "CAPACITY", 3 * first.held + first.held // 2)
    engine = Kernels(tmp_path)
    loaded = []
    for part in parts:
        loaded.append(weakref.ref(engine.compiled(part.program, names)[0]))
        assert engine.has(parts[0].program, names)
    gc.collect()
    assert [ref() is not None for ref in loaded] == [True, False, False, True, True]
    values = dict.fromkeys(first.symbols, 0.25) | {"q1": np.linspace(-1, 1, 5)}
    expected = compile_program(parts[1].program, names).evaluate(values)
    monkeypatch.setattr("substructures.compile.target.assemble", None)  # all is found
    kernel, is_new = engine.compiled(parts[1].program, names)
    assert is_new
    np.testing.assert_array_equal(kernel.evaluate(values)["applied"], expected["applied"])
    engine.close()


def test_what_waits_for_the_compiler_is_bounded(monkeypatch: pytest.MonkeyPatch) -> None:
    """Trees beyond that are answered without a kernel, and compiled when they are asked again later."""
    monkeypatch.setattr(kernels, "QUEUE", 2)
    engine, gate = Kernels(None), Event()
    engine._compiler.submit(gate.wait)
    parts, names = pendulums(4), ["metric"]
    values = dict.fromkeys((symbol.name for part in parts for symbol in part.program.symbols), 0.5)
    try:
        for part in parts:
            assert engine(part.program, values, names, 1)["metric"].shape == (1, 1, 1)
        assert len(engine._waiting) == 2
    finally:
        gate.set()
    limit = monotonic() + 30
    while engine._waiting:
        assert monotonic() < limit
        sleep(0.02)
    engine(parts[3].program, values, names, 1)
    while engine._waiting:
        assert monotonic() < limit
        sleep(0.02)
    assert [engine.has(part.program, names) for part in parts] == [True, True, False, True]
    engine.close()
