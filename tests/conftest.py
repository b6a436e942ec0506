"""Test helpers in this directory (random_trees, random_cuts, independent) can be imported by every test."""

from __future__ import annotations

import sys
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
