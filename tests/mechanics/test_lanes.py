"""Scalars over the states: the same numbers as arrays, and no work for exact zeros and ones."""

from __future__ import annotations

import numpy as np
import pytest

from substructures.expr.graph import Graph
from substructures.expr.program import Symbol, array, program
from substructures.quantities.numbers.array_scalars import Lanes, Supports, lanes, plain

X, Y = np.array([1.0, -2.0, 0.5]), np.array([3.0, 0.25, -1.0])
OTHERS = [Y, 2.5, 0.0, 0, 1, -1]


@pytest.mark.parametrize("other", OTHERS, ids=str)
def test_arithmetic(other: object) -> None:
    a, b = lanes(X), lanes(other)
    for found, expected in (
        (a + b, X + other), (b + a, other + X), (a - b, X - other), (b - a, other - X),
        (a * b, X * other), (b * a, other * X), (-a, -X),
    ):  # fmt: skip
        np.testing.assert_array_equal(np.broadcast_to(plain(found), 3), expected)


def test_zeros_and_ones_are_free() -> None:
    a = Lanes(X)
    assert a + 0 is a
    assert 0 + a is a
    assert a - 0 is a
    assert a * 1 is a
    assert 0 * a == 0
    assert isinstance(a * 0, int)


def test_what_elements_depend_on() -> None:
    graph = Graph()
    p, q = graph.symbol("p"), graph.symbol("q")
    entries = [p * p, p * q, graph.number(3), q + 1]
    found = program(graph, {"x": array((4,), lambda i: entries[i])}, {n: Symbol(n, "parameter") for n in "pq"})
    supports = Supports(found)
    assert supports.varying({"p": 1.0, "q": X})("x") == [False, True, False, True]
    assert supports.varying({"p": X, "q": 1.0})("x") == [True, True, False, False]
