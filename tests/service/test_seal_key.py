"""The key of seals that servers of one PostgreSQL database are given: who can write there alone is not believed."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import closing, contextmanager
from pathlib import Path
from typing import Any

import pytest
from fastapi.testclient import TestClient

from service.app import open_store
from service.cli.main import main
from service.database.connections import Database
from service.database.file import DatabaseError
from service.database.seal_keys import BYTES
from service.settings import Settings

from .conftest import PENDULUM, SLIDER, make_client
from .databases import fresh
from .seals import seal_again

STATE = {"quantities": ["metric"], "q": [0.3]}
FORGED = """UPDATE parts SET program = (SELECT p.program FROM parts p JOIN versions v ON v.digest = p.digest
WHERE v.name = 'slider') WHERE digest = (SELECT digest FROM versions WHERE name = 'pendulum')"""


@contextmanager
def served(address: str, key: str) -> Iterator[TestClient]:
    with open_store(Settings(database=address, catalogue=False, seal_key=key)) as store:
        yield make_client(store)


def derived_here(client: TestClient) -> list[bool]:
    return [each["derived_here"] for each in client.get("/v1/substructures").json()["items"]]


def stored(client: TestClient) -> Any:
    for body in (PENDULUM, SLIDER):
        assert client.post("/v1/substructures", json=body).status_code == 201
    return client.get("/v1/substructures/pendulum/formulas/metric").json()


def test_who_can_write_to_the_database_cannot_forge(tmp_path: Path) -> None:
    file = tmp_path / "seal.key"
    file.write_bytes(bytes(range(BYTES)))
    with fresh("postgresql", tmp_path) as address:
        with served(address, str(file)) as client:
            right = stored(client)
            assert derived_here(client) == [True, True]
        with closing(Database(address)) as database, database.write() as connection:
            connection.exec_driver_sql(FORGED)
        seal_again(address)
        with served(address, "") as client:  # a seal without a key is one that everybody can make
            assert derived_here(client) == [True, True]
        with served(address, str(file)) as client:
            assert derived_here(client) == [False, False]
            assert client.get("/v1/substructures/pendulum/formulas/metric").json() == right
            assert client.get("/v1/substructures/slider").status_code == 200
            assert derived_here(client) == [True, True]


def test_commands_use_the_key(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    file = tmp_path / "seal.key"
    file.write_bytes(bytes(range(BYTES)))
    with fresh("sqlite", tmp_path) as address:
        with served(address, str(file)) as client:
            stored(client)
        assert main(["verify", "--database", address]) == 1
        monkeypatch.setenv("SUBSTRUCTURES_SEAL_KEY", str(file))
        assert main(["verify", "--database", address]) == 0


@pytest.mark.parametrize(("content", "message"), [(None, "make one for all servers"), (b"short", "is no key")])
def test_without_the_key_nothing_starts(content: bytes | None, message: str, tmp_path: Path) -> None:
    """A key that each server made for itself would break the seals of the others."""
    file = tmp_path / "seal.key"
    if content is not None:
        file.write_bytes(content)
    with pytest.raises(DatabaseError, match=message):
        Database(f"sqlite:///{tmp_path / 'x.db'}", seal_key=str(file))
