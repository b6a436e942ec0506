"""Formulas that follow from a tree by an analysis, and rows of closures, as functions of an export."""

from __future__ import annotations

import io
import subprocess
import sys
import zipfile
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from fastapi.testclient import TestClient
from run_code import load_python

from .analysis_trees import client as client
from .analysis_trees import store as store

#: of the cart with a pendulum, and of a ring of three bars
CASES = (
    *(("cart", name) for name in ("routhian", "state_space", "perturbation", "curvature", "adjoint")),
    *(("cart", name) for name in ("base_regressor", "base_parameters")),
    *(("ring", name) for name in ("closures", "closure.residual", "closure.jacobian")),
)


def of(client: TestClient, path: str, **query: Any) -> Any:
    answer = client.get(f"/v1/trees/{path}", params=query)
    assert answer.status_code == 200, answer.text
    return answer


@pytest.mark.parametrize(("tree", "quantity"), CASES)
def test_an_export_gives_what_the_formulas_give(client: TestClient, tree: str, quantity: str, tmp_path: Path) -> None:
    content = of(client, f"{tree}/export", target="python", quantities=quantity, name="our").content
    with zipfile.ZipFile(io.BytesIO(content)) as packed:
        packed.extractall(tmp_path)
    command = [sys.executable, "our_selftest.py"]
    done = subprocess.run(command, cwd=tmp_path, capture_output=True, text=True, check=False)
    assert (done.returncode, done.stdout) == (0, "ok\n")
    ours = load_python((tmp_path / "our.py").read_text(), tmp_path)
    theirs = load_python(of(client, f"{tree}/{quantity}", format="python", name="our").text, tmp_path)
    told = of(client, f"{tree}/export", target="interface", quantities=quantity, name="our").json()
    (function,) = told["functions"]
    vectors = {**told["vectors"], "x": function.get("x")}
    rng = np.random.default_rng(2)
    given = [0.3 if s == "t" else rng.uniform(0.5, 1.5, vectors[s]["length"]) for s in function["arguments"]]
    first, second = (getattr(module, function["name"])(*given) for module in (ours, theirs))
    first, second = (x if isinstance(x, dict) else {"": x} for x in (first, second))
    assert first.keys() == second.keys()
    for name, array in first.items():
        np.testing.assert_allclose(array, second[name], rtol=1e-13, atol=1e-13)


def test_arrays_of_one_name_are_not_mixed(client: TestClient) -> None:
    """The metric of the Routhian is that of the coordinates that are left."""
    query = {"target": "python", "quantities": "metric,routhian", "together": True}
    answer = client.get("/v1/trees/cart/export", params=query)
    assert answer.status_code == 422
    assert answer.json()["errors"][0]["code"] == "two-outputs"
    of(client, "cart/export", target="python", quantities="metric,routhian")
