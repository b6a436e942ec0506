"""Requests generated from the OpenAPI document: every answer is one that the document has, none is a 5xx.

GENERATED_EXAMPLES: so many for every operation, valid ones and others, on every database; what covers each place of
the document in turn is about how bodies are read, and goes to one of them.
"""

from __future__ import annotations

import os
import subprocess
import sys
from pathlib import Path

import pytest

from service.server import background
from service.settings import Limits, Settings
from substructures.client import Client

from .conftest import PENDULUM, SLIDER, TREE
from .databases import fresh

EXAMPLES = os.environ.get("GENERATED_EXAMPLES", "3")
CONFIGURATION = Path(__file__).with_name("generated_requests.toml")


@pytest.mark.deep
@pytest.mark.parametrize("kind", ["sqlite", "postgresql"])
def test_every_answer_keeps_the_contract(kind: str, tmp_path: Path) -> None:
    with fresh(kind, tmp_path) as database:
        settings = Settings(database=database, port=0, catalogue=False, workers=1, limits=Limits(sync_seconds=3))
        with background(settings) as address:
            with Client(address) as client:
                client.submit(PENDULUM)
                client.submit(SLIDER)
                client.create_tree(TREE)
            command = [sys.executable, "-m", "schemathesis.cli", "--config-file", str(CONFIGURATION), "run"]
            command += [f"{address}/openapi.json", "--max-examples", EXAMPLES, "--request-timeout", "30"]
            command += ["--generation-deterministic", "--no-color"]
            command += ["--phases", "fuzzing,stateful"] if kind == "postgresql" else []
            hooks = {"SCHEMATHESIS_HOOKS": "generated_hooks", "PYTHONPATH": str(CONFIGURATION.parent)}
            named = {**os.environ, **hooks}
            found = subprocess.run(command, cwd=tmp_path, env=named, capture_output=True, text=True, check=False)
    lines = [line[:300] for line in (found.stdout + found.stderr).splitlines()]
    assert found.returncode == 0, "\n".join(lines)
    print(*(line for line in lines if " generated, " in line))
