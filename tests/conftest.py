"""Test helpers in this directory (random_trees, random_cuts, independent) can be imported by every test."""

from __future__ import annotations

import gc
import sys
from collections.abc import Generator
from pathlib import Path

import pytest

sys.path.insert(0, str(Path(__file__).parent))

import checked_graph


def pytest_addoption(parser: pytest.Parser) -> None:
    """The test mode of tests/checked_graph.py."""
    parser.addoption("--checked", action="store_true", help="check every constructor of formulas")


def pytest_configure(config: pytest.Config) -> None:
    """Before anything is imported that makes formulas."""
    if config.getoption("--checked"):
        checked_graph.install()


@pytest.hookimpl(wrapper=True)
def pytest_collection() -> Generator[None, object, object]:
    """Nine thousand tests stay to the end: the collector of garbage need not look through them, a tenth of the time."""
    gc.disable()
    try:
        return (yield)
    finally:
        gc.freeze()
        gc.enable()
