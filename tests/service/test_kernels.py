"""Compiled kernels behind the evaluations: the same numbers, kept in a folder, made at once for large batches."""

from __future__ import annotations

from pathlib import Path
from time import monotonic, sleep

import numpy as np
import pytest

from service import kernels
from service.kernels import Kernels
from service.settings import Settings
from substructures import Definition, Model, TreeSpec, catalogue, couple, derive
from substructures.evaluation import evaluate


@pytest.fixture(scope="module")
def model() -> Model:
    spec = {"name": "arm", "gravity": [0, 0, "-9.81"], "instances": [{"name": "arm", "substructure": "ur5"}]}
    return couple(TreeSpec.read(spec), {"arm": derive(Definition.read(catalogue.load("ur5")))})


def request(states: int) -> dict[str, object]:
    q = np.random.default_rng(0).uniform(-3, 3, (states, 6))
    return {"quantities": ["metric", "forces", "forward_dynamics", "kinetic_energy"], "q": q, "qd": q[:, ::-1]}


def agree(model: Model, engine: Kernels, states: int) -> None:
    wanted = request(states)
    found, expected = evaluate(model, wanted, engine=engine), evaluate(model, wanted)
    for name in wanted["quantities"]:  # type: ignore[attr-defined]
        np.testing.assert_allclose(found[name], expected[name], rtol=1e-9, atol=1e-9)


def wait_for(folder: Path) -> None:
    limit = monotonic() + 30
    while not any(folder.glob("*")):
        assert monotonic() < limit, "nothing was compiled"
        sleep(0.02)


def test_small_batches_are_answered_first_and_compiled_then(model: Model, tmp_path: Path) -> None:
    engine = Kernels(tmp_path / "kernels")
    agree(model, engine, 3)
    engine.close()
    agree(model, engine, 3)


def test_large_batches_are_compiled_at_once(model: Model, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(kernels, "AT_ONCE", 10)
    engine = Kernels(tmp_path)
    agree(model, engine, 33)
    engine.close()
    wait_for(tmp_path)


def test_damaged_files_are_made_anew(model: Model, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(kernels, "AT_ONCE", 1)
    for _ in range(2):
        engine = Kernels(tmp_path)
        agree(model, engine, 5)
        engine.close()
        for file in tmp_path.iterdir():
            file.write_bytes(file.read_bytes()[:-7] + b"garbage")


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
