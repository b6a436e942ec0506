"""Formulas rebuilt in another graph."""

from __future__ import annotations

from substructures.expr.graph import Expr, Graph
from substructures.expr.program import Formulas, Symbol, program
from substructures.expr.replay import replay
from substructures.expr.trigonometry import sin
from substructures.expr.walk import transfer


def test_symbols_are_replaced_on_the_way() -> None:
    old, new = Graph(), Graph()
    x, y = old.symbol("x"), old.symbol("y")
    z = new.symbol("z") + 1
    (moved,) = transfer([x * y + sin(x) / 3], new, {"x": z})
    assert moved is z * new.symbol("y") + sin(z) / 3


def test_what_is_known_of_a_program_is_not_replayed() -> None:
    old, new = Graph(), Graph()
    x, y = old.symbol("x"), old.symbol("y")
    square = x * x + 1
    source = program(
        old,
        {"a": Formulas((), {(): square}), "b": Formulas((), {(): square * y})},
        {name: Symbol(name, "parameter") for name in "xy"},
    )
    known: dict[int, Expr] = {}
    first = replay(source, new, {"y": new.symbol("z")}, ["a"], known)["a"].entries[()]
    assert set(known) == set(source.reachable(["a"]))
    known[source.outputs["a"].entries[0]] = new.symbol("w")
    second = replay(source, new, {"y": new.symbol("z")}, ["b"], known)["b"].entries[()]
    assert first is new.symbol("x") * new.symbol("x") + 1
    assert second is new.symbol("w") * new.symbol("z")
