"""What the default tests take a few of, and ``pytest -m deep`` the others."""

from __future__ import annotations

from collections.abc import Collection
from typing import Any

import pytest


def deep(*values: Any) -> list[Any]:
    """Values of ``parametrize`` of the long tests alone; a tuple is the values of several arguments."""
    return [pytest.param(*(x if isinstance(x, tuple) else (x,)), marks=pytest.mark.deep) for x in values]


def seeds(quick: int | Collection[int], count: int) -> list[Any]:
    """``count`` seeds, of which the first ``quick``, or just these, are in the default tests."""
    first = range(quick) if isinstance(quick, int) else quick
    return [*first, *deep(*(k for k in range(count) if k not in first))]
