"""The index of formulas: its rows for whoever reads the store, and stores of older versions, killed or not."""

from __future__ import annotations

import signal
import subprocess
import sys
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import pytest
import sqlalchemy as sa

from service.content.summaries import PartContent, part_content
from service.database.connections import Database
from service.database.migrate import upgrade
from service.database.tables import metadata
from service.operations.catalogue import store_part
from service.operations.verification import verify_all
from service.queries.searching.formulas import FormulaRow, list_formulas
from substructures import Definition, catalogue, derive

from .databases import fresh

NAMES = ("puma560", "free-body", "parallel-gripper", "camera")
COLUMNS = ("position", "quantity", "body", "coordinate", "shape", "symmetry", "operations", "output", "entry")
VIEW = sa.table("formulas", *map(sa.column, ("part", *COLUMNS)))
#: opens a store once for each line that it reads, in a process that dies before a statement that begins like this line
KILLED = """
import os, signal, sys
import sqlalchemy as sa
import service.database.migrate
from service.database.connections import Database
for line in sys.stdin:
    @sa.event.listens_for(sa.engine.Engine, "before_cursor_execute")
    def kill(connection, cursor, statement, *_):
        if statement.split()[:3] == line.split():
            os.kill(os.getpid(), signal.SIGKILL)
    child = os.fork()
    if not child:
        Database(sys.argv[1])
        os._exit(0)
    print(os.waitstatus_to_exitcode(os.waitpid(child, 0)[1]), flush=True)
"""
MOMENTS = "UPDATE parts SET", "DROP TABLE formulas", "CREATE VIEW formulas"


@pytest.fixture(params=["sqlite", "postgresql"])
def address(request: pytest.FixtureRequest, tmp_path: Path) -> Iterator[str]:
    with fresh(request.param, tmp_path, is_migrated=False) as found:
        yield found


@pytest.fixture(scope="module")
def contents() -> list[PartContent]:
    return [part_content(derive(Definition.read(catalogue.load(name)))) for name in NAMES]


def rows_of(connection: sa.Connection, part: str) -> list[FormulaRow]:
    """Out of the table of older versions, or the view."""
    query = sa.select(*(VIEW.c[name] for name in COLUMNS)).where(VIEW.c.part == part).order_by(VIEW.c.position)
    return [FormulaRow(*row) for row in connection.execute(query)]


LATER = ("source", "mass", "software", "recipe")  # columns that came after


def old_store(address: str, contents: list[PartContent]) -> None:
    """A store of revision 0007 with these parts."""
    engine = sa.create_engine(address)
    upgrade(engine, "0007")
    with engine.begin() as connection:
        for content in contents:
            program = {"digest": content.row["program"], "content": content.program, "nodes": content.nodes}
            connection.execute(sa.insert(metadata.tables["programs"]).values(**program, created="then"))
            row = {name: value for name, value in content.row.items() if name not in LATER}
            old = sa.table("parts", *map(sa.column, (*row, "created")))
            connection.execute(sa.insert(old).values(**row, created="then"))
            rows = [{"part": content.digest, **dict(zip(COLUMNS, row, strict=True))} for row in content.formulas]
            connection.execute(sa.insert(VIEW), rows)
    engine.dispose()


def expected(content: PartContent) -> list[FormulaRow]:
    return [FormulaRow(*row) for row in content.formulas]


def test_the_view_has_a_row_for_every_formula(address: str, contents: list[PartContent]) -> None:
    database = Database(address)
    with database.write() as connection:
        for content in contents:
            store_part(connection, content)
    with database.read() as connection:
        for content in contents:
            assert rows_of(connection, content.digest) == expected(content)
            assert list_formulas(connection, content.digest) == expected(content)
        [(place, entry)] = connection.exec_driver_sql(
            "SELECT output, entry FROM formulas WHERE quantity = 'U' AND body = 'link3' AND coordinate = 'q1'"
        ).all()
        assert (place, entry) == ("U", "[2,0]")
    database.close()


def test_chosen_formulas(address: str, contents: list[PartContent]) -> None:
    database = Database(address)
    with database.write() as connection:
        store_part(connection, contents[0])
    digest, rows = contents[0].digest, expected(contents[0])
    with database.read() as connection:
        for quantities, body, coordinate in ((("U",), None, None), ((), "link3", None), (("U", "F"), "link3", "q1")):
            found = list_formulas(connection, digest, quantities, body, coordinate)
            assert found
            assert found == [
                row
                for row in rows
                if (row.quantity in quantities or not quantities)
                and (row.body == body or body is None)
                and (row.coordinate == coordinate or coordinate is None)
            ]
        assert list_formulas(connection, "sha256:none") == []
    database.close()


def test_an_older_store_is_carried_over_as_a_whole(address: str, contents: list[PartContent]) -> None:
    """Killed at some moment, it is as it was; then everything is there."""
    old_store(address, contents)
    command = [sys.executable, "-c", KILLED, address]
    with subprocess.Popen(command, stdin=subprocess.PIPE, stdout=subprocess.PIPE, text=True) as killed:
        assert killed.stdin is not None
        assert killed.stdout is not None
        for moment in MOMENTS:
            print(moment, file=killed.stdin, flush=True)
            assert int(killed.stdout.readline()) == -signal.SIGKILL
            engine = sa.create_engine(address)
            with engine.connect() as connection:
                assert connection.exec_driver_sql("SELECT version_num FROM alembic_version").scalar() == "0007"
                assert "formulas" in sa.inspect(connection).get_table_names()
                for content in contents:
                    assert rows_of(connection, content.digest) == expected(content)
            engine.dispose()
    database = Database(address)
    with database.read() as connection:
        assert "formulas" not in sa.inspect(connection).get_table_names()
        for content in contents:
            assert rows_of(connection, content.digest) == expected(content)
            written: Any = connection.exec_driver_sql("SELECT created FROM parts").scalars().all()
            assert written == ["then"] * len(contents)
    assert all("has not derived it" in finding.fault for finding in verify_all(database))
    assert all(finding.is_sound for finding in verify_all(database, repair=True))
    with database.read() as connection:
        for content in contents:
            assert list_formulas(connection, content.digest) == expected(content)
    database.close()
