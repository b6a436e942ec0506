"""Sums of angles are turned by the addition theorem in machine code: few sines, the same numbers."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from substructures.compile import compile_program
from substructures.compile.angles import by_addition_theorem
from substructures.expr.graph import Expr, Graph
from substructures.expr.interpret import interpret
from substructures.expr.operations import Symbol
from substructures.expr.program import Program, array, program
from substructures.expr.trigonometry import cos, sin

KINDS = {"a": "coordinate", "b": "coordinate", "c": "velocity", "p": "parameter"}


def of(*entries: Expr, other: Expr | None = None) -> Program:
    symbols = {name: Symbol(name, kind) for name, kind in KINDS.items()}
    outputs = {"y": array((len(entries),), lambda i: entries[i])}
    if other is not None:
        outputs["other"] = array((), lambda: other)
    return program(entries[0].graph, outputs, symbols)


def angles(made: Program, names: list[str]) -> int:
    """Different angles of sines and cosines."""
    ops = made.operations
    return len({ops[i][1] for i in made.reachable(names) if ops[i][0] in ("sin", "cos")})


@pytest.fixture
def names() -> list[Expr]:
    graph = Graph()
    return [graph.symbol(x) for x in KINDS]


def test_sums_and_differences_of_known_angles(names: list[Expr], tmp_path: Path) -> None:
    a, b, c, p = names
    made = of(sin(a), cos(b), sin(c), cos(p), sin(a + b), cos(a - b), sin(a + b + c), cos(a + b + c), sin(p - c))
    assert angles(made, ["y"]) == 8
    assert angles(by_addition_theorem(made, ["y"]), ["y"]) == 4
    rng = np.random.default_rng(1)
    values = {name: rng.uniform(-3, 3, 37) for name in KINDS} | {"p": 0.3}
    expected = interpret(made, values)["y"]
    for _ in range(2):
        # the second time as it was kept
        found = compile_program(made, ["y"], tmp_path).evaluate(values)["y"]
        assert np.abs(found - expected).max() < 1e-15


def test_a_sum_stays_where_its_sine_is_the_only_one(names: list[Expr]) -> None:
    a, b, *_ = names
    alone = of(sin(a + b), cos(a))
    assert by_addition_theorem(alone, ["y"]) is alone
    # what other outputs have is not computed
    beside = of(sin(a + b), cos(a), other=cos(b))
    assert by_addition_theorem(beside, ["y"]) is beside
    assert angles(by_addition_theorem(beside, ["y", "other"]), ["y", "other"]) == 2


def test_sines_of_sines(names: list[Expr], tmp_path: Path) -> None:
    """An angle that is a sine itself has one, too."""
    a, b, *_ = names
    inner = sin(a)
    made = of(inner, cos(b), sin(a + b), sin(inner), cos(inner + b), cos(cos(inner)))
    values = {name: np.linspace(-3, 3, 11) for name in KINDS}
    found = compile_program(made, ["y"], tmp_path).evaluate(values)["y"]
    assert np.abs(found - interpret(made, values)["y"]).max() < 1e-15
