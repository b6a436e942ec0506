"""Programs that are small and ask for much: in bundles they are not believed, in a store they are not used."""

from __future__ import annotations

import json
import zlib
from time import process_time
from typing import Any

import pytest
from fastapi.testclient import TestClient
from sqlalchemy import update

from service.content.integrity import digest_of
from service.database.tables import parts
from service.messages.viewer import ANYBODY
from service.operations import catalogue
from service.queries import content
from service.store.store import Store
from substructures.documents import write_json

from .bundle_files import Files, changed_program, packed, sent
from .conftest import TREE
from .test_bundles import files, source

__all__ = ["files", "source"]


def powers(count: int, needed: bool) -> Any:
    """What puts so many powers of powers into a program; ``needed``: by one more output."""

    def change(program: Any) -> None:
        operations = program["operations"]
        symbol = next(i for i, operation in enumerate(operations) if operation[0] == "sym")
        start = len(operations)
        operations += [["powi", start + k - 1 if k else symbol, 64] for k in range(count)]
        if needed:
            last = {"shape": [], "symmetry": "none", "index": [[]], "entries": [len(operations) - 1]}
            program["outputs"]["more"] = last

    return change


@pytest.mark.parametrize("needed", [False, True])
def test_99000_powers(client: TestClient, files: Files, needed: bool) -> None:
    """They are never computed: what is stored is derived from the definition, which is all that is believed."""
    data = packed(changed_program(files, powers(99_000, needed)), 8)  # deflated
    assert len(data) < 500_000
    start = process_time()
    answer = sent(client, data)
    assert process_time() - start < 10  # what they ask for would take minutes, and gigabytes
    assert answer.status_code == 201, answer.text
    assert {item["name"]: item["formulas"] for item in answer.json()["items"]} == {
        "pendulum": "differ",
        "slider": "equal",
    }
    assert client.get("/v1/substructures/pendulum").json()["operations"]["total"] < 1000
    assert client.post("/v1/trees", json=TREE).status_code == 201


@pytest.mark.parametrize("needed", [False, True])
def test_what_is_stored_all_the_same_is_not_used(filled: TestClient, store: Store, needed: bool) -> None:
    """Whatever put it there: it is not what this server derived, and makes room for that."""
    with store.database.read() as connection:
        version = catalogue.find(connection, ANYBODY, "pendulum")
        found = json.loads(content.get_program(connection, version.program) or b"")
    powers(99_000, needed)(found)
    bomb = write_json(found)
    with store.database.write() as connection:
        content.put_program(connection, digest_of(bomb), zlib.compress(bomb), len(found["operations"]))
        connection.execute(update(parts).where(parts.c.digest == version.digest).values(program=digest_of(bomb)))
    start = process_time()
    answer = filled.get("/v1/substructures/pendulum/formulas/metric")
    assert process_time() - start < 10
    assert answer.status_code == 200
    assert filled.get("/v1/substructures/pendulum").json()["program"] == version.program
