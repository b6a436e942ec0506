"""Values that wait in memory where there are more than registers."""

from __future__ import annotations

import re

import numpy as np
from machine_code import NEEDS_MACHINE_CODE

from substructures.compile import compile_program
from substructures.compile.emission import KEPT, WIDE, assembly
from substructures.compile.lowering import lower
from substructures.expr.program import Output, Program, Symbol

pytestmark = NEEDS_MACHINE_CODE
COUNT = 70


def twice() -> Program:
    """v_k = x_k y - x_0, and outputs v_1 v_2 ... v_n and v_1 + ... + v_n: every v_k is needed in two places."""
    symbols = tuple(Symbol(name, "coordinate") for name in (*(f"x{k}" for k in range(COUNT + 1)), "y"))
    ops: list[tuple[str | int, ...]] = [("sym", k) for k in range(COUNT + 2)]
    values = []
    for k in range(1, COUNT + 1):
        ops += [("mul", k, COUNT + 1), ("sub", len(ops), 0)]
        values.append(len(ops) - 1)
    ends = []
    for op in ("mul", "add"):
        last = values[0]
        for value in values[1:]:
            ops.append((op, last, value))
            last = len(ops) - 1
        ends.append(last)
    output = Output((2,), ((0,), (1,)), tuple(ends))
    return Program(symbols, tuple(ops), {"x": output})


def test_what_waits_is_stored_once_and_read_once() -> None:
    """All but what stays in registers, beside it the sum, x_0 and y."""
    program = twice()
    text = assembly(lower(program, ["x"]), program.operations, WIDE)
    places = re.findall(r"(%\d+) = getelementptr i8, ptr %w, ", text)
    stores = [place for place in places if re.search(rf"store .* ptr {place},", text)]
    assert COUNT - KEPT <= len(stores) <= COUNT - KEPT + 4
    assert len(places) == 2 * len(stores)
    assert len(set(re.findall(r"load .*", text))) < 2 * COUNT + len(stores)


def test_same_bits_as_with_registers_by_the_compiler() -> None:
    program = twice()
    rng = np.random.default_rng(1)
    values = {name: rng.uniform(-2, 2, 43) for name in program.needs(["x"])}
    found = [compile_program(program, ["x"], width=width).evaluate(values)["x"] for width in (4, WIDE)]
    np.testing.assert_array_equal(found[0], found[1])
