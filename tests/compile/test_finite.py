"""Kernels see by themselves whether all their results are finite."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np
import pytest
from machine_code import NEEDS_MACHINE_CODE

from substructures.compile import compile_program
from substructures.compile.kernel import with_elements
from substructures.expr.graph import Graph
from substructures.expr.program import Formulas, Program

pytestmark = NEEDS_MACHINE_CODE
NAMES = ["quotient", "symmetric", "constant"]


@pytest.fixture
def program(collected: Callable[..., Program]) -> Program:
    g = Graph()
    x, y, p = (g.symbol(n) for n in "xyp")
    symmetric = {(0, 0): x * x, (0, 1): g.function("sin", y), (2, 2): x / y}
    quotient = {(k,): (x + k) / (y - k) for k in range(9)}
    return collected(
        g,
        {"p": "parameter"},
        quotient=Formulas((9,), quotient),
        symmetric=Formulas((3, 3), symmetric, "symmetric"),
        constant=g.function("log", p),
    )


@pytest.mark.parametrize("threads", [1, 2])
@pytest.mark.parametrize("width", [2, 4, 8])
def test_each_state_is_seen(program: Program, width: int, threads: int) -> None:
    """Wherever in a batch, in a vector that is not full, and whatever the result is that has no number."""
    kernel = compile_program(program, NAMES, width=width)
    for count in (1, 2, 7, 8, 1500):
        values: dict[str, Any] = {"x": np.full(count, 0.3), "y": np.full(count, 0.4), "p": 2.0}
        assert kernel.evaluate(values, threads=threads).finite
        for state in {0, count // 2, count - 1}:
            for name, bad in (("y", 0.0), ("y", 8.0), ("x", np.inf), ("x", 1e308), ("y", np.nan)):
                some = {**values, name: values[name].copy()}
                some[name][state] = bad
                found = kernel.evaluate(some, threads=threads)
                assert found.finite == all(np.isfinite(array).all() for array in found.values())
        assert not kernel.evaluate({**values, "p": 0.0}, threads=threads).finite


def test_elements_in_an_order_of_the_caller(program: Program) -> None:
    """Dependent ones, structural zeros, and one twice."""
    kernel = compile_program(program, NAMES)
    values = {"x": np.linspace(1, 2, 13), "y": np.linspace(0.1, 0.2, 13), "p": 2.0}
    places = np.array([8, 3, 1, 0, 4, 8])
    found = kernel.evaluate(values, places={"symmetric": places})
    dense = kernel.evaluate(values)
    np.testing.assert_array_equal(found["symmetric"], dense["symmetric"].reshape(13, 9)[:, places])
    chosen = with_elements(dense, {"symmetric": places})["symmetric"]  # as engines without places have it
    np.testing.assert_array_equal(chosen, found["symmetric"])
    assert chosen.flags.c_contiguous  # otherwise it cannot be written as JSON
    np.testing.assert_array_equal(found["quotient"], dense["quotient"])
