"""The terms by which parts are found are those of the latest versions, whatever is written beside each other."""

from __future__ import annotations

from concurrent.futures import ThreadPoolExecutor
from pathlib import Path
from typing import Any

import pytest
import sqlalchemy as sa

from service.app import open_store
from service.database.migrate import upgrade
from service.queries.searching.terms import terms_of
from service.settings import Settings
from service.store.store import Store

from .conftest import PENDULUM, make_client
from .databases import fresh

BOTH = pytest.mark.parametrize("kind", ["sqlite", "postgresql"])


def part(name: str, tag: str, port: str) -> dict[str, Any]:
    return {**PENDULUM, "name": name, "tags": [tag], "ports": [{"name": port, "body": PENDULUM["bodies"][0]["name"]}]}


def terms(store: Store) -> tuple[set[Any], set[Any]]:
    """Those of the store, and those of the latest versions."""
    with store.database.read() as connection:
        rows = connection.execute(
            sa.text(
                """SELECT s.name, p.title, p.tags, p.ports FROM substructures s
                   JOIN versions v ON v.name = s.name AND v.version = s.latest JOIN parts p ON p.digest = v.digest"""
            )
        ).all()
        stored = {tuple(row) for row in connection.execute(sa.text("SELECT kind, term, name FROM search_terms"))}
    return stored, {(*each, row.name) for row in rows for each in terms_of(*row) or ()}


@BOTH
def test_submitting_and_withdrawing_side_by_side(kind: str, tmp_path: Path) -> None:
    """Six clients, three names."""
    with fresh(kind, tmp_path) as address, open_store(Settings(database=address, catalogue=False)) as store:
        client = make_client(store)

        def work(k: int) -> None:
            for j in range(8):
                made = client.post("/v1/substructures", json=part(f"p-{j % 3}", f"k{k}", f"x{k}{j}"))
                assert made.status_code == 201, made.text
                for number in {made.json()["version"], max(1, made.json()["version"] - 1)} if j % 2 else ():
                    path = f"/v1/substructures/{made.json()['name']}@{number}/withdraw"
                    assert client.post(path, json={"reason": "old"}).status_code == 200

        with ThreadPoolExecutor(6) as pool:
            list(pool.map(work, range(6)))
        stored, wanted = terms(store)
        assert stored == wanted
        with store.database.read() as connection:
            rows = connection.execute(
                sa.text(
                    """SELECT s.latest, max(v.version) FROM substructures s
                       LEFT JOIN versions v ON v.name = s.name AND v.withdrawn_at IS NULL GROUP BY s.name, s.latest"""
                )
            ).all()
            assert len(rows) == 3
            assert all(latest == newest for latest, newest in rows)


@BOTH
def test_the_version_after_a_damaged_one(kind: str, tmp_path: Path) -> None:
    """Whose terms nobody can read: they are gone with it."""
    with fresh(kind, tmp_path) as address, open_store(Settings(database=address, catalogue=False)) as store:
        client = make_client(store)
        assert client.post("/v1/substructures", json=part("p", "old", "tip")).status_code == 201
        with store.database.write() as connection:
            connection.execute(sa.text("""UPDATE parts SET tags = '["old'"""))
        assert client.post("/v1/substructures", json=part("p", "new", "tip")).status_code == 201
        stored, wanted = terms(store)
        assert stored == wanted
        assert ("tag", "new", "p") in stored


@BOTH
def test_names_of_older_stores_are_numbered_by_age(kind: str, tmp_path: Path) -> None:
    """Not by where the database happens to keep them, which a change of the first name moves."""
    with fresh(kind, tmp_path, is_migrated=False) as address:
        engine = sa.create_engine(address.replace("postgresql://", "postgresql+psycopg://"))
        upgrade(engine, "0012")
        with engine.begin() as connection:
            connection.execute(sa.text("INSERT INTO programs VALUES ('p', :x, 1, '')"), {"x": b"\0"})
            columns = [each["name"] for each in sa.inspect(connection).get_columns("parts")]
            numbers = dict.fromkeys(("dof", "operations", "mass"), 1)
            values = {name: numbers.get(name, "") for name in columns} | {"program": "p"}
            parts = sa.Table("parts", sa.MetaData(), autoload_with=connection)
            for age, name in enumerate(("zebra", "ant", "cat")):
                connection.execute(parts.insert().values(values | {"digest": f"d{age}"}))
                connection.execute(sa.text("INSERT INTO substructures (name) VALUES (:name)"), {"name": name})
                connection.execute(
                    sa.text("INSERT INTO versions (name, version, digest, created) VALUES (:name, 1, :d, :at)"),
                    {"name": name, "d": f"d{age}", "at": f"2026-01-0{age + 1}T00:00:00Z"},
                )
            connection.execute(sa.text("UPDATE substructures SET latest = 1 WHERE name = 'zebra'"))
        upgrade(engine)
        with engine.begin() as connection:
            connection.execute(sa.text("INSERT INTO substructures (name) VALUES ('bee')"))
            rows = connection.execute(sa.text("SELECT name FROM substructures ORDER BY number")).scalars()
            assert list(rows) == ["zebra", "ant", "cat", "bee"]
        engine.dispose()
