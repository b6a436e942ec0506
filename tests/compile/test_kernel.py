"""Kernels beside the reference interpreter: operations, shapes, sweeps, threads, non-finite results."""

from __future__ import annotations

import gc
from collections.abc import Callable
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from machine_code import NEEDS_MACHINE_CODE

from substructures.compile import Kernel, compile_program, target
from substructures.compile.lowering import lower
from substructures.errors import MissingValue
from substructures.expr.graph import Graph
from substructures.expr.interpret import interpret
from substructures.expr.program import Formulas, Output, Program, Symbol

WIDTHS = pytest.mark.parametrize("width", [2, 4, 8])
FUNCTIONS = ("tan", "asin", "acos", "atan", "exp", "log", "sqrt", "abs", "sign", "sin", "cos")


@pytest.fixture
def mixture(collected: Callable[..., Program]) -> Program:
    """Both stages, every symmetry, nested functions, outputs that are symbols, constants and parameters."""
    g = Graph()
    m, length, x, y = (g.symbol(n) for n in ("m", "l", "x", "y"))
    s = g.function("sin", x + m)
    nested = g.function("cos", s * length + g.function("exp", y))
    metric = {(0, 0): m * length + s, (0, 1): nested * x, (1, 1): g.function("sqrt", length)}
    gamma = {(0, 0, 1): x * y - s, (0, 1, 2): nested / length, (1, 1, 2): x, (0, 2, 2): m * m}
    return collected(
        g,
        {"m": "parameter", "l": "inertia"},
        metric=Formulas((2, 2), metric, "symmetric"),
        christoffel=Formulas((3, 3, 3), gamma, "christoffel"),
        plain=Formulas((5,), {(0,): x, (2,): g.number(3), (3,): length, (4,): g.function("cos", m)}),
        scalar=nested * nested,
        empty=Formulas((2, 2), {}),
    )


VALUES: dict[str, Any] = {"m": 1.5, "l": 0.75, "x": np.linspace(-2, 2, 23), "y": np.linspace(1, -1, 23)}


def agree(kernel: Kernel, program: Program, values: dict[str, Any], rtol: float = 5e-15) -> None:
    found, expected = kernel.evaluate(values), interpret(program, values, kernel.names)
    assert found.keys() == expected.keys() != set()
    for name, array in expected.items():
        assert found[name].shape == array.shape
        np.testing.assert_allclose(found[name], array, rtol=rtol, atol=1e-15)


@WIDTHS
def test_every_operation(collected: Callable[..., Program], width: int) -> None:
    g = Graph()
    x, y = g.symbol("x"), g.symbol("y")
    outputs = {n: g.function(n, x) for n in FUNCTIONS}
    outputs |= {"atan2": g.function("atan2", y, x), "ratio": x / y, "less": x - y, "negative": -x, "product": x * y + 3}
    program = collected(g, {}, **outputs)
    kernel = compile_program(program, list(outputs), width=width)
    values = {"x": np.linspace(-3, 3, 37), "y": np.linspace(2, -5, 37)}
    with np.errstate(all="ignore"):
        agree(kernel, program, values)
    special = np.array([0.0, -0.0, np.inf, -np.inf, np.nan, 1e308, 1e-310])
    x_, y_ = (v.ravel() for v in np.meshgrid(special, special))
    agree(kernel, program, {"x": x_, "y": y_})
    as_parameters = Program(
        tuple(Symbol(s.name, "parameter") for s in program.symbols), program.operations, program.outputs
    )
    agree(compile_program(as_parameters, list(outputs), width=width), program, {"x": 0.3, "y": -0.7})


@WIDTHS
def test_integer_powers(width: int) -> None:
    exponents = [-64, -9, -8, -3, -2, -1, 0, 1, 2, 3, 7, 8, 9, 20, 64]
    operations = (("sym", 0), *(("powi", 0, n) for n in exponents))
    places = range(len(exponents))
    output = Output((len(exponents),), tuple((k,) for k in places), tuple(k + 1 for k in places))
    program = Program((Symbol("x", "coordinate"),), operations, {"x": output})
    values = {"x": np.array([-1.7, 0.3, 0.0, -0.0, 2, np.inf, np.nan])}
    agree(compile_program(program, ["x"], width=width), program, values)


@NEEDS_MACHINE_CODE
@WIDTHS
@pytest.mark.parametrize("part", [1, 3, 1000])
def test_stages_levels_and_symmetries(mixture: Program, width: int, part: int, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("substructures.compile.compiled.lower", lambda p, n, fused: lower(p, n, part, fused))
    names = list(mixture.outputs)
    kernel = compile_program(mixture, names, width=width)
    assert kernel.compiled
    agree(kernel, mixture, VALUES)
    for name in names:
        agree(compile_program(mixture, [name], width=width), mixture, VALUES)


def test_shapes_as_from_the_interpreter(mixture: Program) -> None:
    kernel = compile_program(mixture, list(mixture.outputs))
    for values in (
        {"m": 1, "l": 2.0, "x": 0.5, "y": np.float32(0.25)},
        {"m": 1, "l": np.float64(2), "x": [0.5, 0.25], "y": 3},
        {"m": 1.0, "l": 2.0, "x": np.ones((2, 1)), "y": np.ones(3)},
        {"m": 1.0, "l": 2.0, "x": np.ones(1), "y": 1.0},
        {"m": 1.0, "l": 2.0, "x": np.ones((0, 2)), "y": 1.0},
        {"m": 1.0, "l": 2.0, "x": 1.0, "y": 1.0, "unused": np.zeros(4)},
        {"m": 1.0, "l": 2.0, "x": np.arange(8.0)[::-2], "y": np.arange(12).reshape(4, 3)[:, 1]},
    ):
        agree(kernel, mixture, values)
    for name in ("m", "y"):
        with pytest.raises(MissingValue) as caught:
            kernel.evaluate({n: v for n, v in VALUES.items() if n != name})
        assert caught.value.name == name
    assert set(compile_program(mixture, ["plain"]).symbols) == {"m", "l", "x"}
    with pytest.raises(KeyError):
        compile_program(mixture, ["nothing"])


def test_sweeps(mixture: Program) -> None:
    kernel = compile_program(mixture, list(mixture.outputs))
    rng = np.random.default_rng(0)
    swept = {**VALUES, "m": rng.uniform(1, 2, 23)}
    agree(kernel, mixture, swept)
    agree(kernel, mixture, {**swept, "l": rng.uniform(1, 2, 23), "x": 0.5})
    agree(kernel, mixture, VALUES)
    found = kernel.evaluate({**swept, "m": np.full(23, 1.5)})
    for name, array in kernel.evaluate(VALUES).items():
        np.testing.assert_array_equal(found[name], array)


def test_columns_packed_and_into(mixture: Program) -> None:
    kernel = compile_program(mixture, list(mixture.outputs))
    expected = kernel.evaluate(VALUES)
    states = np.stack([VALUES["x"], VALUES["y"]], axis=1)
    rest = {"m": 1.5, "l": 0.75}
    by_columns, packed = kernel.evaluate(rest, columns=[(("x", "y"), states)]), kernel.evaluate(VALUES, packed=True)
    for name in mixture.outputs:
        np.testing.assert_array_equal(by_columns[name], expected[name])
        array = packed[name]
        index = np.array(kernel.outputs[name].index, dtype=int).reshape(
            array.shape[-1], len(kernel.outputs[name].shape)
        )
        np.testing.assert_array_equal(array, expected[name][(slice(None), *index.T)].reshape(array.shape))
    out = {n: np.full((23, 9, *kernel.shape(n)), np.nan)[:, 4] for n in mixture.outputs}
    kernel.evaluate_into(out, VALUES)
    for name, array in out.items():
        np.testing.assert_array_equal(array, expected[name])
    for bad in (np.zeros((22, 2, 2)), np.zeros((23, 2, 2), dtype=np.float32), np.zeros((23, 2, 2)).transpose(0, 2, 1)):
        with pytest.raises(ValueError, match="'metric'"):
            kernel.evaluate_into({"metric": bad}, VALUES)
    with pytest.raises(ValueError, match="3 names"):
        kernel.evaluate(rest, columns=[(("x", "y", "z"), states)])


def test_blocks(mixture: Program, monkeypatch: pytest.MonkeyPatch) -> None:
    kernel = compile_program(mixture, list(mixture.outputs))
    expected = kernel.evaluate(VALUES, packed=True)
    monkeypatch.setattr(target, "library", lambda: None)
    for some in (kernel, compile_program(mixture, list(mixture.outputs))):
        blocks = some.blocks(VALUES)
        again = some.blocks(VALUES, out=np.empty_like(blocks.array), threads=2)
        for name in mixture.outputs:
            np.testing.assert_allclose(blocks.entries(name), expected[name], rtol=1e-14, atol=1e-15)
            np.testing.assert_array_equal(again.entries(name), blocks.entries(name))
        with pytest.raises(ValueError, match=r"shape|broadcast"):
            some.blocks(VALUES, out=np.zeros((2, 2, 2)))
    many = {**VALUES, "x": np.linspace(0, 1, 5001), "y": 0.5}
    np.testing.assert_array_equal(kernel.blocks(many).array, kernel.blocks(many, threads=2).array)


@WIDTHS
@pytest.mark.parametrize("count", [1, 3])
@pytest.mark.parametrize("packed", [False, True])
@pytest.mark.parametrize("columns", [("x", "y"), ("y",)])
def test_bound_calls_read_their_arrays_anew(
    mixture: Program, width: int, count: int, packed: bool, columns: tuple[str, ...]
) -> None:
    """One state, for which there is a driver of its own, and several; neighbouring columns and single ones."""
    kernel = compile_program(mixture, list(mixture.outputs), width=width)
    m, state = np.full(count, 1.5), np.linspace([0.25, 0.5], [1.25, -0.5], count)
    out = {name: np.full((count, *kernel.shape(name, packed)), np.nan) for name in mixture.outputs}
    own = {"m": m, "l": 0.75, "x": state[:, 0]}
    given = {name: x for name, x in own.items() if name not in columns}
    call = kernel.bind(out, given, columns=[(columns, state[:, -len(columns) :])], packed=packed)
    for m[0], state[0, 0], state[-1, 1] in ((1.5, 0.25, 0.5), (2.5, 0.25, 0.5), (2.5, -1.0, -0.25)):
        call()
        values = {"m": m.copy(), "l": 0.75, "x": state[:, 0].copy(), "y": state[:, 1].copy()}
        for name, array in kernel.evaluate(values, packed=packed).items():
            np.testing.assert_array_equal(out[name], array)


def test_same_bits_from_threads_and_splits(mixture: Program) -> None:
    kernel = compile_program(mixture, list(mixture.outputs))
    rng = np.random.default_rng(3)
    for count in (1, 2, 3, 5, 511, 513, 4099):
        values = {"m": 1.5, "l": 0.75, "x": rng.uniform(-9, 9, count), "y": rng.uniform(-2, 2, count)}
        for parameters in ({}, {"m": rng.uniform(1, 2, count)}):
            whole = kernel.evaluate(values | parameters)
            threaded = kernel.evaluate(values | parameters, threads=3)
            swept = values | parameters
            cuts = [slice(k, k + 97) for k in range(0, count, 97)]
            batches = [({n: v[cut] if np.ndim(v) else v for n, v in swept.items()}, ()) for cut in cuts]
            pieces = [{n: a.copy() for n, a in found.items()} for found in kernel.stream(batches, threads=2)]
            for name, array in whole.items():
                np.testing.assert_array_equal(threaded[name], array)
                np.testing.assert_array_equal(np.concatenate([piece[name] for piece in pieces]), array)


def test_many_callers_at_once(mixture: Program) -> None:
    kernel = compile_program(mixture, list(mixture.outputs))
    values = [VALUES | {"m": 1 + k / 7, "x": VALUES["x"] + k} for k in range(12)]
    expected = [kernel.evaluate(v)["metric"] for v in values]
    with ThreadPoolExecutor(6) as pool:
        for _ in range(20):
            for found, reference in zip(
                pool.map(lambda v: kernel.evaluate(v)["metric"], values), expected, strict=True
            ):
                np.testing.assert_array_equal(found, reference)


@NEEDS_MACHINE_CODE
def test_without_llvmlite(mixture: Program, monkeypatch: pytest.MonkeyPatch) -> None:
    compiled = compile_program(mixture, list(mixture.outputs))
    monkeypatch.setattr(target, "library", lambda: None)
    kernel = compile_program(mixture, list(mixture.outputs))
    assert (compiled.compiled, kernel.compiled) == (True, False)
    agree(kernel, mixture, VALUES, rtol=0)
    packed = kernel.evaluate(VALUES, packed=True, threads=2)
    for name, array in compiled.evaluate(VALUES, packed=True).items():
        np.testing.assert_allclose(packed[name], array, rtol=1e-14, atol=1e-15)
    state = np.array([0.5])
    out = {"scalar": np.zeros(1)}
    call = kernel.bind(out, {**VALUES, "x": state, "y": 0.5})
    state[0] = 0.75
    call()
    assert out["scalar"][0] == interpret(mixture, {**VALUES, "x": 0.75, "y": 0.5})["scalar"]


def resident() -> int:
    """Pages of memory in use."""
    return int(Path("/proc/self/statm").read_text().split()[1])


@pytest.mark.skipif(not Path("/proc/self/statm").exists(), reason="memory in use is read from /proc")
def test_dropped_kernels_free_their_memory(mixture: Program) -> None:
    def some() -> int:
        for _ in range(40):
            compile_program(mixture, ["metric", "christoffel"]).evaluate(VALUES)
        gc.collect()
        return resident()

    some()
    before = some()
    assert some() - before < 1500  # 6 MB


@pytest.mark.parametrize("name", ["sqrt", "log", "asin", "acos", "sign"])
def test_arguments_with_sharp_edges_are_rounded_as_the_interpreter_does(
    name: str, collected: Callable[..., Program]
) -> None:
    """f(k + a b - c d) where a b = c d: contraction of one product gives an argument on the wrong side of the edge."""
    g = Graph()
    a, b, c, d = (g.symbol(n) for n in "abcd")
    edge = {"asin": 1, "acos": -1}.get(name, 0)
    program = collected(g, {}, f=g.function(name, (a * b - c * d) + edge), twice=(a * b - c * d) * (a + d))
    rng = np.random.default_rng(1)
    x, y = rng.uniform(-3, 3, 2000), rng.uniform(-3, 3, 2000)
    values = {"a": x, "b": y, "c": y, "d": x}
    found, expected = compile_program(program, ["f", "twice"]).evaluate(values), interpret(program, values)
    np.testing.assert_array_equal(found["f"], expected["f"])
