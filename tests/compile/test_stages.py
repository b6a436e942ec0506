"""Parameters, positions, velocities, accelerations and inputs: a stage whose inputs do not vary runs once."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from typing import Any

import numpy as np
import pytest
from machine_code import NEEDS_MACHINE_CODE

from substructures.compile import compile_program
from substructures.compile.lowering import lower
from substructures.compile.order import REGIONS, depth_first, registers
from substructures.expr.graph import Graph
from substructures.expr.interpret import interpret
from substructures.expr.program import Formulas, Program

pytestmark = NEEDS_MACHINE_CODE
STAGES = (("m", "I"), ("x", "t"), ("v",), ("a", "f"))
NAMES = ("parameter", "inertia", "coordinate", "time", "velocity", "acceleration", "input")
KINDS = dict(zip((n for names in STAGES for n in names), NAMES, strict=True))
COUNT = 1203


@pytest.fixture
def staged(collected: Callable[..., Program]) -> Program:
    """Results, functions and symbols of every stage, and values that cross from each to each later one."""
    g = Graph()
    m, inertia, x, t, v, a, f = (g.symbol(n) for n in KINDS)
    s, c = g.function("sin", x * m), g.function("cos", x + t)
    w, root = g.function("exp", v * s), g.function("sqrt", m + inertia)
    last = g.function("sin", a * w + f * root) - c
    entries = [m, root, x, s * c, inertia * s, v, w + root, w * s, a, last, last * m + v * c, g.number(2)]
    return collected(
        g, KINDS, mixed=Formulas((len(entries),), {(k,): e for k, e in enumerate(entries)}), last=last, first=root * m
    )


def values_of(varying: tuple[int, ...], count: int = COUNT) -> dict[str, Any]:
    """Numbers, and arrays for the inputs of the given stages."""
    rng = np.random.default_rng(5)
    values: dict[str, Any] = {n: float(rng.uniform(0.5, 1)) for names in STAGES for n in names}
    return values | {n: rng.uniform(0.5, 1, count) for k in varying for n in STAGES[k]}


CASES = pytest.mark.parametrize("varying", [(0, 1, 2, 3), (1, 2, 3), (2, 3), (3,), (2,), (0,), (0, 2), (1,), (1, 3)])


@CASES
@pytest.mark.parametrize("width", [2, 4, 8])
def test_numbers_give_the_bits_of_arrays(staged: Program, varying: tuple[int, ...], width: int) -> None:
    kernel = compile_program(staged, list(staged.outputs), width=width)
    values = values_of(varying)
    full = {n: np.full(COUNT, v) if np.ndim(v) == 0 else v for n, v in values.items()}
    expected, once = kernel.evaluate(full), kernel.evaluate(values)
    reference = interpret(staged, full, kernel.names)
    broadcast = kernel.evaluate({n: np.broadcast_to(v, COUNT) for n, v in values.items()})
    single = kernel.evaluate({n: v if np.ndim(v) else np.array([v]) for n, v in values.items()}, threads=2)
    blocks, threaded = kernel.blocks(values), kernel.blocks(values, threads=2)
    for name in staged.outputs:
        array = expected[name]
        np.testing.assert_allclose(array, reference[name], rtol=1e-14, atol=1e-15)
        for found in (once, broadcast, single):
            np.testing.assert_array_equal(found[name], array)
        for some in (blocks, threaded):
            np.testing.assert_array_equal(some.entries(name).reshape(array.shape), array)


def test_calls_do_not_see_what_earlier_ones_have_left(staged: Program) -> None:
    kernel = compile_program(staged, list(staged.outputs))
    fresh = {v: compile_program(staged, list(staged.outputs)).evaluate(values_of(v)) for v in [(1, 2, 3), (2,), (0,)]}
    for varying, expected in [*fresh.items(), *reversed(fresh.items())]:
        found = kernel.evaluate(values_of(varying))
        for name in staged.outputs:
            np.testing.assert_array_equal(found[name], expected[name])


def test_one_position_as_a_row(staged: Program) -> None:
    kernel = compile_program(staged, list(staged.outputs))
    values = values_of((2, 3))
    rest: Mapping[str, Any] = {n: values[n] for n in ("m", "I", "v", "a", "f")}
    position = np.array([[values["x"], values["t"]]])
    for given in (position, position[0], np.broadcast_to(position, (COUNT, 2))):
        found = kernel.evaluate(rest, columns=[(("x", "t"), given)])
        for name, array in kernel.evaluate(values).items():
            np.testing.assert_array_equal(found[name], array)


#: neighbours of one stage and of two
ORDER = ("f", "a", "x", "m", "I", "t", "v")


def columns_of(kind: str, whole: Any) -> list[Any]:
    """The columns ORDER of (COUNT, 7) in other arrays."""
    if kind == "two arrays":
        return [(ORDER[:5], whole[:, :5]), (ORDER[5:], whole[:, 5:])]
    if kind == "the last ones count":
        return [(("x", "a"), np.ones((COUNT, 2))), (ORDER, whole)]
    if kind == "three axes":
        return [(ORDER, whole.reshape(3, COUNT // 3, 7))]
    made = {
        "rows": whole,
        "columns": np.asfortranarray(whole),
        "wider": np.concatenate([whole, whole], axis=1)[:, :7],
        "every second": np.repeat(whole, 2, axis=1)[:, ::2],
        "backwards": whole[::-1].copy()[::-1],
        "read-only": np.frombuffer(whole.tobytes()).reshape(COUNT, 7),
        "list": whole.tolist(),
    }
    return [(ORDER, made[kind])]


KINDS_OF_COLUMNS = (
    *("rows", "columns", "wider", "every second", "backwards", "read-only", "list"),
    *("two arrays", "the last ones count", "three axes"),
)


@pytest.mark.parametrize("width", [2, 4, 8])
@pytest.mark.parametrize("kind", KINDS_OF_COLUMNS)
def test_columns_give_the_bits_of_values_by_name(staged: Program, kind: str, width: int) -> None:
    """Neighbouring columns are read in pairs, wherever they go: pairs and single ones, in all arrays."""
    kernel = compile_program(staged, list(staged.outputs), width=width)
    whole = np.random.default_rng(2).uniform(0.5, 1, (COUNT, len(ORDER)))
    expected = kernel.evaluate({name: whole[:, k].copy() for k, name in enumerate(ORDER)})
    for threads in (1, 2):
        found = kernel.evaluate({}, columns=columns_of(kind, whole), threads=threads)
        for name, array in expected.items():
            np.testing.assert_array_equal(found[name].reshape(array.shape), array)
    half = kernel.evaluate(
        dict(zip(ORDER[3:], whole[0, 3:].tolist(), strict=True)), columns=[(ORDER[:3], whole[:, :3])]
    )
    fixed = kernel.evaluate({}, columns=[(ORDER[:3], whole[:, :3]), (ORDER[3:], whole[0, 3:])])
    for name, array in half.items():
        np.testing.assert_array_equal(fixed[name], array)


def test_operations_stand_in_the_stage_of_their_latest_operand(staged: Program) -> None:
    stages = lower(staged, list(staged.outputs)).stages
    assert [stage.region for stage in stages] == list(REGIONS)
    for stage, names in zip(stages, STAGES, strict=True):
        assert {staged.symbols[k].name for k in stage.inputs} == set(names)
    entries = {e for output in staged.outputs.values() for e in output.entries}
    assert sum(len(stage.results) for stage in stages) == len(entries)
    assert [len(stage.results) for stage in stages] == [4, 3, 3, 3]


@pytest.mark.parametrize("first", ["small", "large"])
def test_what_takes_most_registers_comes_first(first: str) -> None:
    """Sethi and Ullman's numbers: k for a full tree of 2^k leaves, of which one of each pair is read from memory."""
    full = [("sym", k) for k in range(8)] + [("mul", k, k + 1) for k in (0, 2, 4, 6)]
    full += [("add", 8, 9), ("add", 10, 11), ("mul", 12, 13), ("mul", 0, 7)]
    small, large = 15, 14
    ops: Any = [*full, ("sub", large, small) if first == "large" else ("sub", small, large)]
    found = registers(ops, [16])
    assert [found[k] for k in (0, 8, 12, 14, 15, 16)] == [0, 1, 2, 3, 1, 3]
    order = depth_first(ops, [16])
    assert sorted(order) == list(range(17))
    assert order.index(large) < order.index(small) < order.index(16)
