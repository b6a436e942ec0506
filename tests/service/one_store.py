"""One store for all tests of a file, in place of one for each: for tests that leave each other alone.

Fixtures of the same names as in ``conftest``, to be imported; ``double`` has a store of its own.
"""

from __future__ import annotations

import shutil
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

import pytest
from fastapi.testclient import TestClient

from service.app import open_store
from service.settings import Settings
from service.store.store import Store

from .conftest import HAND, make_client


@contextmanager
def copied(template: Path, folder: Path) -> Iterator[Store]:
    """A store that begins as a copy of another one."""
    path = shutil.copy(template, folder / "store.db")
    with open_store(Settings(database=f"sqlite:///{path}", catalogue=False, key_seconds=0)) as opened:
        yield opened


@pytest.fixture(scope="module")
def store(template: Path, tmp_path_factory: pytest.TempPathFactory) -> Iterator[Store]:
    """The store of ``filled``."""
    with copied(template, tmp_path_factory.mktemp("one")) as opened:
        yield opened


@pytest.fixture(scope="module")
def filled(store: Store) -> Iterator[TestClient]:
    """A client of a server that knows pendulum, slider and the tree cell@1."""
    with make_client(store) as opened:
        yield opened


@pytest.fixture(scope="module")
def double(template: Path, tmp_path_factory: pytest.TempPathFactory) -> Iterator[TestClient]:
    """The same with the tree cell@2: two pendulums, the second with a quarter of the mass."""
    with copied(template, tmp_path_factory.mktemp("two")) as store, make_client(store) as opened:
        assert opened.post("/v1/trees/cell/couplings", json=HAND).status_code == 201
        yield opened
