"""Formulas rebuilt in another graph."""

from __future__ import annotations

from substructures.expr.graph import Graph
from substructures.expr.trigonometry import sin
from substructures.expr.walk import transfer


def test_symbols_are_replaced_on_the_way() -> None:
    old, new = Graph(), Graph()
    x, y = old.symbol("x"), old.symbol("y")
    z = new.symbol("z") + 1
    (moved,) = transfer([x * y + sin(x) / 3], new, {"x": z})
    assert moved is z * new.symbol("y") + sin(z) / 3
