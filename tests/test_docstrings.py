"""The examples in docstrings of what people call are run as they stand there."""

from __future__ import annotations

import doctest

import pytest

import substructures
from substructures import couple, derive, evaluate, linearise, render, simulate

FLAGS = doctest.REPORT_NDIFF


@pytest.mark.parametrize("named", [substructures, couple, derive, evaluate, linearise, render, simulate])
def test_examples_run(named: object) -> None:
    (example,) = doctest.DocTestFinder(recurse=False).find(named, globs={getattr(named, "__name__", ""): named})
    assert example.examples, f"{named} has no example"
    told: list[str] = []
    assert doctest.DocTestRunner(optionflags=FLAGS).run(example, out=told.append).failed == 0, "".join(told)
