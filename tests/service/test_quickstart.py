"""The notebook beside the client is run cell by cell, and what its cells end with is shown as a notebook shows it."""

from __future__ import annotations

import ast
import json
from pathlib import Path
from typing import Any

import pytest

import substructures.client
from service.server import background
from service.settings import Settings

NOTEBOOK = Path(substructures.client.__file__).with_name("quickstart.ipynb")


def cells() -> list[dict[str, Any]]:
    return json.loads(NOTEBOOK.read_text())["cells"]


def shown(source: str, names: dict[str, Any]) -> dict[str, str]:
    """Run a cell; what is shown of the expression that it ends with."""
    body = ast.parse(source)
    last = body.body[-1] if body.body and isinstance(body.body[-1], ast.Expr) else None
    body.body = body.body[:-1] if last else body.body
    exec(compile(body, "cell", "exec"), names)  # noqa: S102 -- the cells of this repository's own notebook
    value = eval(compile(ast.Expression(last.value), "cell", "eval"), names) if last else None  # noqa: S307 -- the same
    show = getattr(value, "_repr_mimebundle_", None)
    return show() if show else {}


def test_the_quick_start_runs(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.setenv("MPLBACKEND", "agg")
    names: dict[str, Any] = {}
    with background(Settings(database=f"sqlite:///{tmp_path / 'x.db'}")) as address:
        monkeypatch.setenv("SUBSTRUCTURES_SERVER", address)
        found = [shown("".join(cell["source"]), names) for cell in cells() if cell["cell_type"] == "code"]
    pictures = [each["image/svg+xml"] for each in found if "image/svg+xml" in each]
    formulas = [each["text/latex"] for each in found if "text/latex" in each]
    assert len(pictures) == 3
    assert all(picture.startswith("<svg") for picture in pictures)
    assert [formula.splitlines()[0] for formula in formulas] == ["$$", "$$"]
    assert "g_{11} &=" in formulas[0]
    assert "energy constant True" in capsys.readouterr().out
    assert names["motion"].is_right
    assert names["found"].count == 400


def test_outputs_are_stripped() -> None:
    assert all(cell["outputs"] == [] and cell["execution_count"] is None for cell in cells() if "outputs" in cell)
