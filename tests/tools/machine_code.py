"""A mark for tests of what only machine code has."""

from __future__ import annotations

import pytest

from substructures.compile import target

NEEDS_MACHINE_CODE = pytest.mark.skipif(
    not target.available(), reason="llvmlite has no wheel for this machine, or the interpreter is wanted"
)
