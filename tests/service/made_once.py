"""What every store and every app of a worker begins with, made once: the schema, and what the routes take.

A new SQLite file gets the tables of the first one, which was migrated, instead of running all migrations again; a file
that has tables is migrated as ever. An app gets the routes of the first one: FastAPI reads the parameters of all their
functions again for each app. Tests of migrations call ``service.database.migrate.upgrade`` themselves.
"""

from __future__ import annotations

import sqlite3
from collections.abc import Callable
from contextlib import closing
from functools import cache

from fastapi import FastAPI
from sqlalchemy import Engine, StaticPool, create_engine, inspect

from service.app import bare_app
from service.database.migrate import upgrade


def upgrade_once() -> Callable[..., None]:
    """In place of ``upgrade``."""

    @cache
    def made() -> bytes:
        engine = create_engine("sqlite://", poolclass=StaticPool)
        upgrade(engine)
        with engine.connect() as connection:
            found: bytes = connection.connection.driver_connection.serialize()
        engine.dispose()
        return found

    def quick(engine: Engine, *revision: str) -> None:
        if revision or engine.dialect.name != "sqlite" or inspect(engine).get_table_names():
            upgrade(engine, *revision)
            return
        with engine.connect() as connection, closing(sqlite3.connect(":memory:")) as source:
            source.deserialize(made())
            source.backup(connection.connection.driver_connection)

    return quick


def bare_app_from(first: FastAPI) -> Callable[..., FastAPI]:
    """In place of ``bare_app``; ``first``: whose routes all others have."""

    def quick(*about: object) -> FastAPI:
        made = bare_app(*about)
        made.router = first.router
        return made

    return quick
