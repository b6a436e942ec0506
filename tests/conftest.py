"""What is in tests/tools (random trees, independent engines, a reader of exports) can be imported by every test."""

from __future__ import annotations

import gc
import os
import sys
from collections.abc import Generator
from pathlib import Path

import anyio
import pytest

# workers of pytest take all cores: a library of linear algebra that takes them, too, waits for them, busily
os.environ["OMP_NUM_THREADS"] = os.environ["OPENBLAS_NUM_THREADS"] = os.environ["MKL_NUM_THREADS"] = "1"
# a process of a server or command would compile all modules that it imports, a quarter of its start
os.environ.pop("PYTHONDONTWRITEBYTECODE", None)
sys.path.insert(0, str(Path(__file__).parent))
sys.path.insert(0, str(Path(__file__).parent / "tools"))

import checked_graph

#: tests that took 0.3 s or more when they were last measured (``python -m benchmarks.tests_by_folder``), a line
#: each, but for one of every file: they run with the deep ones, so that the others take minutes
LONG = Path(__file__).with_name("long.txt")


def pytest_addoption(parser: pytest.Parser) -> None:
    """The test mode of tests/tools/checked_graph.py."""
    parser.addoption("--checked", action="store_true", help="check every constructor of formulas")


def pytest_configure(config: pytest.Config) -> None:
    """Before anything is imported that makes formulas.

    Modules of anyio are loaded when they are first used, and rewritten by pytest then, which two threads cannot do at
    once: they are loaded here.
    """
    sys.dont_write_bytecode = False
    for name in dir(anyio):
        getattr(anyio, name)
    if config.getoption("--checked"):
        checked_graph.install()


@pytest.hookimpl(tryfirst=True)
def pytest_collection_modifyitems(config: pytest.Config, items: list[pytest.Item]) -> None:
    """What LONG names is deep. Raises UsageError for names of tests that are no longer there."""
    names = frozenset(LONG.read_text().splitlines())
    for item in items:
        if item.nodeid in names:
            item.add_marker("deep")
    files = {item.nodeid.partition("::")[0] for item in items}
    known = {item.nodeid.partition("[")[0] for item in items}
    lost = {n for n in names if n.partition("::")[0] in files and n.partition("[")[0] not in known}
    if lost and not any("::" in argument for argument in config.args):
        raise pytest.UsageError(f"{LONG.name} names tests that are not there: {', '.join(sorted(lost))}")


@pytest.hookimpl(wrapper=True)
def pytest_collection() -> Generator[None, object, object]:
    """Nine thousand tests stay to the end: the collector of garbage need not look through them, a tenth of the time."""
    gc.disable()
    try:
        return (yield)
    finally:
        gc.freeze()
        gc.enable()
