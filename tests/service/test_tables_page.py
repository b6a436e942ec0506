"""The page about the tables: its reader needs a database file and the standard library alone; no column is left out."""

from __future__ import annotations

import json
import re
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest
from fastapi.testclient import TestClient
from sqlalchemy import inspect

from service.database.tables import metadata
from service.store.store import Store
from substructures import catalogue
from substructures.documents import write_json

PAGE = (Path(__file__).parents[2] / "docs" / "reference" / "tables.md").read_text()
READER = PAGE.split("```python\n")[1].split("```")[0]


def read(folder: Path, path: Path, name: str, values: dict[str, float]) -> dict[tuple[int, ...], float]:
    """What the reader of the page prints, isolated from all that is installed."""
    script = folder / "reader.py"
    lines = "values = json.loads(sys.argv[3])", "g = metric(sys.argv[1], sys.argv[2], 1, values)"
    driver = "\n".join(["import sys", *lines, "print(json.dumps([[list(i), x] for i, x in g.items()]))"])
    script.write_text(READER + driver)
    command = [sys.executable, "-I", "-S", str(script), str(path), name, json.dumps(values)]
    done = subprocess.run(command, capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stderr
    return {tuple(index): x for index, x in json.loads(done.stdout)}


@pytest.mark.parametrize("name", ["acrobot", "puma560", "parallel-gripper", "free-body"])
def test_the_reader_of_the_page(name: str, client: TestClient, store: Store, tmp_path: Path) -> None:
    """Its metric is that of the service for the part alone; the server runs meanwhile."""
    body = write_json(catalogue.load(name))
    headers = {"Content-Type": "application/json"}
    version = client.post("/v1/substructures", content=body, headers=headers).json()
    tree = {"name": "alone", "instances": [{"name": "x", "substructure": name}]}
    model = client.post("/v1/trees", json=tree).json()
    coordinates = [name.removeprefix("x.") for name in model["coordinates"]]
    rng = np.random.default_rng(1)
    parameters = dict(zip(version["parameters"], rng.uniform(0.5, 1.5, len(version["parameters"])), strict=True))
    q = dict(zip(coordinates, rng.uniform(-1, 1, len(coordinates)), strict=True))
    named = {f"x.{name}": x for name, x in parameters.items() if f"x.{name}" in model["parameters"]}
    request = {"quantities": ["metric"], "q": list(q.values()), "parameters": named}
    answer = client.post("/v1/trees/alone/evaluations", json=request).json()
    assert "metric" in answer, answer
    found = np.zeros((len(q), len(q)))
    for index, x in read(tmp_path, Path(store.database.url.database or ""), name, {**parameters, **q}).items():
        found[index] = x
    np.testing.assert_allclose(found, answer["metric"], rtol=1e-12, atol=1e-14)
    assert np.linalg.matrix_rank(found) == len(q)


def test_every_table_and_column_is_described(store: Store) -> None:
    described: dict[str, list[str]] = {}
    for table, rest in re.findall(r"^\*\*`(\w+)`\*\*(.*?)\n\n(?=\*\*|##|\Z)", PAGE + "\n\n", re.DOTALL | re.MULTILINE):
        names = [row.split("|")[1] for row in rest.split("|---|---|")[1].splitlines()[1:] if row]
        described[table] = sorted(name for cell in names for name in re.findall(r"`(\w+)`", cell))
    with store.database.read() as connection:
        view = {"formulas": sorted(column["name"] for column in inspect(connection).get_columns("formulas"))}
    assert described == view | {name: sorted(table.columns.keys()) for name, table in metadata.tables.items()}
