"""Modules of WebAssembly, run in Node: the same values as the reference evaluator, for every operation and any cut."""

from __future__ import annotations

import json
import math
import shutil
import subprocess
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from catalogue_entries import shipped_part
from flint import arb, ctx

from substructures.array import Array
from substructures.errors import TooLarge
from substructures.export.webassembly import module as modules
from substructures.export.webassembly.module import Argument, Function, module
from substructures.expr.interpret import interpret
from substructures.expr.operations import Output, Symbol
from substructures.expr.program import Program

NODE = shutil.which("node")
pytestmark = pytest.mark.skipif(NODE is None, reason="Node is not installed")

#: calls every function of a module with the given arguments, prints all results; what is no number as text
CALLER = """
const { readFileSync } = require("node:fs");
const { calls, heap } = JSON.parse(readFileSync(process.argv[2]));
const module = new WebAssembly.Module(readFileSync(process.argv[1]));
const { exports } = new WebAssembly.Instance(module, { math: Math });
exports.memory.grow(64);
const printed = calls.map(({ name, given, sizes }) => {
    let at = heap;
    const addresses = given.map((x) => {
        if (!Array.isArray(x)) return Number(x);
        new Float64Array(exports.memory.buffer, at, x.length).set(x.map(Number));
        at += 8 * x.length;
        return at - 8 * x.length;
    });
    const results = sizes.map((size) => new Float64Array(exports.memory.buffer, (at += 8 * size) - 8 * size, size));
    results.forEach((array) => array.fill(777));
    exports[name](...addresses, ...results.map((array) => array.byteOffset));
    return results.map((array) => Array.from(array, (x) => (Object.is(x, -0) ? "-0" : String(x))));
});
console.log(JSON.stringify(printed));
"""


def call(
    functions: Sequence[Function], states: Sequence[Mapping[str, float]], folder: Path, part: int = 1000
) -> list[dict[str, Array]]:
    """The results of every function at its state."""
    made = module(functions, part)
    (folder / "model.wasm").write_bytes(made.content)
    calls = []
    for f, values in zip(functions, states, strict=True):
        given: list[Any] = [[str(values[s]) for s in a.symbols] for a in f.arguments]
        given = [x[0] if a.scalar else x for x, a in zip(given, f.arguments, strict=True)]
        sizes = [math.prod(f.program.outputs[name].shape) for name in f.outputs]
        calls.append({"name": f.name, "given": given, "sizes": sizes})
    text = json.dumps({"calls": calls, "heap": made.heap}).replace("inf", "Infinity").replace("nan", "NaN")
    (folder / "calls.json").write_text(text)
    command = [str(NODE), "-e", CALLER, str(folder / "model.wasm"), str(folder / "calls.json")]
    done = subprocess.run(command, capture_output=True, text=True, timeout=900, check=False)
    assert done.returncode == 0, done.stderr
    return [
        {
            name: np.array(x, dtype=float).reshape(f.program.outputs[name].shape)
            for name, x in zip(f.outputs, found, strict=True)
        }
        for f, found in zip(functions, json.loads(done.stdout), strict=True)
    ]


def by_kind(name: str, program: Program, outputs: Sequence[str]) -> Function:
    """A function with one vector for every kind of symbol."""
    kinds: dict[str, list[str]] = {}
    for symbol in program.symbols:
        kinds.setdefault(symbol.kind, []).append(symbol.name)
    return Function(name, program, tuple(outputs), tuple(Argument(tuple(names)) for names in kinds.values()))


OPERATIONS: tuple[tuple[Any, ...], ...] = (
    ("sym", 0),
    ("sym", 1),
    ("int", "3"),
    ("rat", "-1", "7"),
    *((op, 0, 1) for op in ("add", "sub", "mul", "div", "atan2")),
    *((op, 0) for op in ("neg", "sin", "cos", "tan", "asin", "acos", "atan", "exp", "log", "sqrt", "abs", "sign")),
    *(("powi", 1, n) for n in (-9, -8, -3, -1, 2, 3, 4, 5, 6, 7, 8, 9, 20)),
    # a sine without its cosine, and one of a value that is used elsewhere, too
    ("mul", 4, 5),
    ("sin", 34),
    ("mul", 35, 34),
    ("cos", 36),
)


@pytest.mark.parametrize("part", [1, 2, 3, 7, 1000])
def test_every_operation_at_ordinary_and_at_odd_places(part: int, tmp_path: Path) -> None:
    entries = tuple(range(len(OPERATIONS)))
    output = Output((len(entries),), tuple((i,) for i in entries), entries)
    symbols = (Symbol("x", "coordinate"), Symbol("y", "parameter"))
    program = Program(symbols, OPERATIONS, {"all": output})
    odd = (0.0, -0.0, 0.3, -0.9, 1.0, math.pi, -2e5, 1e300, math.inf, -math.inf, math.nan)
    states = [{"x": x, "y": y} for x in odd for y in (0.7, -1.3, 0.0, -0.0, math.inf)]
    arguments = (Argument(("x",), scalar=True), Argument(("y",)))
    functions = [Function(f"f{k}", program, ("all",), arguments) for k in range(len(states))]
    for values, found in zip(states, call(functions, states, tmp_path, part), strict=True):
        with np.errstate(all="ignore"):
            wanted = interpret(program, values)["all"]
        np.testing.assert_allclose(found["all"], wanted, rtol=4e-15, atol=1e-300, err_msg=str(values))
        zero = (wanted == 0) & (np.arange(len(entries)) < 20)
        assert (np.signbit(found["all"]) == np.signbit(wanted))[zero].all(), values


def test_sines_near_their_zeros_and_where_the_host_answers(tmp_path: Path) -> None:

    symbol = (Symbol("x", "coordinate"),)
    outputs = {"sin": Output((), ((),), (1,)), "cos": Output((), ((),), (2,))}
    program = Program(symbol, (("sym", 0), ("sin", 0), ("cos", 0)), outputs)
    rng = np.random.default_rng(1)
    places = [k * math.pi / 2 for k in (*range(-8, 9), 1000, 83_000)]
    xs = [y for x in places for y in (x, np.nextafter(x, 9e9), np.nextafter(x, -9e9))]
    xs += [*rng.uniform(-100, 100, 100), *rng.uniform(-1.3e5, 1.3e5, 100), 2.0**17, 1e6, 1e-9, 5e-324]
    functions = [Function(f"f{k}", program, ("sin", "cos"), (Argument(("x",), scalar=True),)) for k in range(len(xs))]
    for x, found in zip(xs, call(functions, [{"x": float(x)} for x in xs], tmp_path), strict=True):
        for name in ("sin", "cos"):
            with ctx.workprec(200):
                wanted = float(getattr(arb(float(x)), name)().mid())
            assert abs(float(found[name]) - wanted) <= 2.5 * math.ulp(wanted), (x, name)


@pytest.mark.parametrize("name", ["puma560", "scara", "gimbal-gyroscope"])
@pytest.mark.parametrize("part", [50, 1000])
def test_parts_of_the_catalogue(name: str, part: int, tmp_path: Path) -> None:
    program = shipped_part(name).program
    rng = np.random.default_rng(2)
    states = [{s.name: float(x) for s, x in zip(program.symbols, rng.normal(size=99999), strict=False)}] * 2
    functions = [by_kind("first", program, ("metric", "christoffel")), by_kind("all", program, tuple(program.outputs))]
    found = call(functions, states, tmp_path, part)
    wanted = interpret(program, states[0])
    for answer in found:
        for output, array in answer.items():
            scale = np.max(np.abs(wanted[output]), initial=1e-300)
            assert np.max(np.abs(array - wanted[output]), initial=0) < 1e-13 * scale, output


def test_a_module_that_is_too_large_is_refused(monkeypatch: pytest.MonkeyPatch) -> None:

    program = shipped_part("simple-pendulum").program
    monkeypatch.setattr(modules, "LIMIT", 500)
    with pytest.raises(TooLarge, match="WebAssembly"):
        module([by_kind("f", program, tuple(program.outputs))])
