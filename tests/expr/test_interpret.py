"""The reference evaluator, and binding of symbols."""

from __future__ import annotations

from decimal import Decimal
from fractions import Fraction

import numpy as np
import pytest
from random_expressions import collected

from substructures.errors import InvalidDocument, MissingValue
from substructures.expr.bind import bind
from substructures.expr.graph import Graph
from substructures.expr.interpret import constant, interpret, interpret_in_blocks
from substructures.expr.program import Formulas, Output, Program, Symbol
from substructures.expr.trigonometry import cos, sin


@pytest.fixture
def arm() -> Program:
    g = Graph()
    m, l1, l2, q = (g.symbol(n) for n in ("arm.m", "arm.l1", "l2", "arm.q"))
    entries = {(0, 0): m * (l1 + l2) ** 2, (0, 1): m * l1 * cos(q) / l2, (1, 1): g.sqrt(m)}
    return collected(g, metric=Formulas((2, 2), entries, "symmetric"), energy=sin(q) * l1)


POINT = {"arm.m": 2.0, "arm.l1": 0.5, "l2": 0.3, "arm.q": 0.4}


def test_every_operation() -> None:
    g = Graph()
    x, y = g.symbol("x"), g.symbol("y")
    names = ("sin", "cos", "tan", "asin", "acos", "atan", "exp", "log", "sqrt", "abs", "sign")
    outputs = {n: g.function(n, x) for n in names} | {"atan2": g.function("atan2", y, x)}
    numpy = {"asin": "arcsin", "acos": "arccos", "atan": "arctan", "abs": "absolute"}
    values = interpret(collected(g, **outputs), {"x": 0.3, "y": -0.8})
    for n in names:
        assert values[n] == getattr(np, numpy.get(n, n))(0.3)
    assert values["atan2"] == np.arctan2(-0.8, 0.3)


def test_arithmetic() -> None:
    x, y = 0.3, -0.8
    expected = {
        ("add", 0, 1): x + y,
        ("sub", 0, 1): x - y,
        ("mul", 0, 1): x * y,
        ("div", 0, 1): x / y,
        ("neg", 1): -y,
        ("powi", 1, 3): y**3,
        ("powi", 0, -2): x**-2,
        ("int", "-7"): -7.0,
        ("rat", "-3", "8"): -0.375,
    }
    output = Output((len(expected),), tuple((k,) for k in range(len(expected))), tuple(range(2, 2 + len(expected))))
    symbols = (Symbol("x", "parameter"), Symbol("y", "parameter"))
    found = interpret(Program(symbols, (("sym", 0), ("sym", 1), *expected), {"f": output}), {"x": x, "y": y})["f"]
    np.testing.assert_allclose(found, list(expected.values()), rtol=1e-15)


def test_batches(arm: Program) -> None:
    q = np.linspace(-1, 1, 6).reshape(2, 3)
    batch = interpret(arm, {**POINT, "arm.q": q})
    assert batch["metric"].shape == (2, 3, 2, 2)
    for i in np.ndindex(2, 3):
        np.testing.assert_array_equal(batch["metric"][i], interpret(arm, {**POINT, "arm.q": q[i]})["metric"])
    np.testing.assert_array_equal(batch["metric"], np.swapaxes(batch["metric"], -1, -2))


@pytest.mark.parametrize("memory", [1, 30, 10**6])
def test_blocks_of_states(arm: Program, memory: int) -> None:
    """The last block is shorter than the others; numbers hold for all states."""
    values = {**POINT, "arm.q": np.linspace(-1, 1, 11), "l2": np.linspace(1, 2, 11)}
    expected = interpret(arm, values)
    found = interpret_in_blocks(arm, values, list(arm.outputs), 11, memory)
    assert found.keys() == expected.keys()
    for name, array in expected.items():
        np.testing.assert_array_equal(found[name], array)
    assert interpret_in_blocks(arm, POINT, ["energy"], 3)["energy"].tolist() == [0.5 * np.sin(0.4)] * 3


def test_missing_and_irregular_values(arm: Program) -> None:
    with pytest.raises(MissingValue) as caught:
        interpret(arm, {n: v for n, v in POINT.items() if n != "l2"})
    assert caught.value.name == "l2"
    values = interpret(arm, {**POINT, "l2": 0.0, "arm.m": -1.0})
    assert np.isinf(values["metric"][0, 1])
    assert np.isnan(values["metric"][1, 1])
    assert interpret(arm, {"arm.q": 0.4, "arm.l1": 1.0}, ["energy"])["energy"] == np.sin(0.4)


def test_constants_are_rounded_correctly() -> None:
    assert constant(("rat", "1", "3")) == 1 / 3
    assert constant(("int", str(2**53 + 1))) == 2.0**53
    assert constant(("rat", str(10**600 + 1), str(3 * 10**600))) == 1 / 3
    assert constant(("int", "-" + "9" * 400)) == float("-inf")


def test_bind_any_mixture_of_numbers_and_symbols(arm: Program) -> None:
    reference = interpret(arm, POINT)
    bindings: list[dict[str, int | str | Decimal | Fraction]] = [
        {},
        {"arm.m": 2},
        {"arm.m": "2.0", "l2": Decimal("0.3")},
        {"arm.m": 2, "arm.l1": Fraction(1, 2), "l2": "3/10", "arm.q": "0.4"},
        {"arm.l1": "0.5 + l2 - 0.3", "l2": "0.3"},
        {"arm.m": "4*arm.l1"},
    ]
    for values in bindings:
        bound = bind(arm, values)
        assert not {s.name for s in bound.symbols} & set(values)
        result = interpret(bound, POINT)
        for name, expected in reference.items():
            np.testing.assert_allclose(result[name], expected, rtol=1e-14)
    kept = {s.name: s for s in arm.symbols}
    assert all(kept[s.name] == s for s in bind(arm, {"arm.m": 2}).symbols)
    assert bind(arm, {}).count() == arm.count()


def test_bind_folds(arm: Program) -> None:
    folded = bind(arm, {"arm.q": 0, "l2": "arm.l1"})
    assert folded.count(["metric"])["total"] < arm.count(["metric"])["total"]
    assert folded.outputs["energy"].entries == ()
    assert folded.outputs["metric"].symmetry == "symmetric"


def test_bound_symbols_keep_their_kind() -> None:
    program = Program((Symbol("q", "coordinate", "rad"), Symbol("m", "inertia", "kg")), (("sym", 0), ("sym", 1)), {})
    assert bind(program, {"m": 1}).symbols == ()


@pytest.mark.parametrize(
    ("values", "pointer", "code"),
    [
        ({"mass": 1}, "/bind/mass", "unknown-name"),
        ({"a/b~c": 1}, "/bind/a~1b~0c", "unknown-name"),
        ({"l2": "arm.m +"}, "/bind/l2", "expression"),
        ({"l2": "foo"}, "/bind/l2", "expression"),
        ({"l2": "1/0"}, "/bind/l2", "expression"),
        ({"l2": "__import__('os')"}, "/bind/l2", "expression"),
        ({"l2": 0.5}, "/bind/l2", "number"),
        ({"l2": True}, "/bind/l2", "number"),
        ({"l2": None}, "/bind/l2", "number"),
        ({"l2": Decimal("NaN")}, "/bind/l2", "number"),
        ({"l2": Decimal("Infinity")}, "/bind/l2", "number"),
        ({"l2": Decimal("1e100000")}, "/bind/l2", "number"),
        ({"l2": 1 << 5000}, "/bind/l2", "number"),
        ({"l2": "arm.m", "arm.m": "l2"}, "/bind/arm.m", "bound"),
        ({"l2": 0}, "/bind", "undefined"),
        ({"arm.m": -1}, "/bind", "undefined"),
    ],
)
def test_bind_refuses(arm: Program, values: dict[str, object], pointer: str, code: str) -> None:
    with pytest.raises(InvalidDocument) as caught:
        bind(arm, values)
    assert (caught.value.faults[0].pointer, caught.value.faults[0].code) == (pointer, code)


def test_bind_reports_all_faults(arm: Program) -> None:
    with pytest.raises(InvalidDocument) as caught:
        bind(arm, {"l2": "?", "nothing": 1})
    assert {f.pointer for f in caught.value.faults} == {"/bind/l2", "/bind/nothing"}
