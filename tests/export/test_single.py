"""C in single precision: compiled without a warning, within the bound of its rounding that its header states."""

from __future__ import annotations

import ctypes
import re
import subprocess
from dataclasses import replace
from math import prod
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from exported_models import exported_of, tree_of, write
from mixed_program import mixed_program
from random_expressions import collected
from run_code import STRICT, alone, shared, tool

from substructures.errors import InvalidArgument
from substructures.export import Exported, Function
from substructures.export.rounding import Ranges, bounds, read_ranges
from substructures.expr.graph import Graph
from substructures.expr.interpret import interpret
from substructures.expr.program import Formulas

FLAGS = [*STRICT, "-Wdouble-promotion", "-ffp-contract=off"]


def states(function: Function, rng: np.random.Generator, ranges: Ranges) -> dict[str, np.ndarray[Any, Any]]:
    """Arguments in the stated ranges that are numbers of single precision; parameters at their defaults."""
    found = {}
    for symbol in function.arguments:
        vector = function.vector(symbol)
        most = np.array([np.pi if unit == "rad" else 1.0 for unit in vector.units])
        ends = [ranges.get(n, ranges.get(symbol, (-x, x))) for n, x in zip(vector.names, most, strict=True)]
        values = np.array(vector.defaults) if symbol == "p" else rng.uniform(*np.array(ends).T)
        found[symbol] = values.astype(np.float32)
    return found


def call(library: ctypes.CDLL, exported: Exported, function: Function, given: Any) -> list[np.ndarray[Any, Any]]:
    pointer = ctypes.POINTER(ctypes.c_float)
    outputs = [np.zeros(max(1, prod(o.shape)), np.float32) for o in function.program.outputs.values()]
    arguments = [
        ctypes.c_float(given[s][0]) if s == "t" else given[s].ctypes.data_as(pointer) for s in function.arguments
    ]
    getattr(library, exported.called(function))(*arguments, *(x.ctypes.data_as(pointer) for x in outputs))
    return outputs


@pytest.mark.parametrize(
    ("parts", "ranges"),
    [
        (("acrobot",), ""),
        (("scara", "camera"), ""),
        (("puma560",), ""),
        (("puma560",), "q:-0.1:0.1,i0.q3:-0.75:-0.5,qd:-0.5:0.5,tau.i0.q2:30:40"),
    ],
)
def test_rounding_is_within_its_bound(parts: tuple[str, ...], ranges: str, tmp_path: Path) -> None:
    """Accelerations have a bound where the ranges are narrow enough, or the mechanism is small."""
    exported = exported_of(tree_of(*parts))
    exported = replace(exported, precision="single", ranges=read_ranges(ranges, exported.interface))
    write(exported, "c", tmp_path)
    library, rng = shared([tmp_path / "demo.c"], FLAGS), np.random.default_rng(3)
    finite = 0
    for function in exported.functions:
        bound = bounds(function, exported.ranges)
        if function.quantity == "forward_dynamics":
            assert np.isfinite(bound["forward_dynamics"][0]) == (ranges != "" or parts != ("puma560",))
        for _ in range(40):
            given = states(function, rng, exported.ranges)
            # exactly what was given; but parameters are the defaults, whose rounding belongs to the bound
            values = {
                n: float(x) for s in given if s != "p" for n, x in zip(function.vector(s).names, given[s], strict=True)
            }
            p = function.interface.vectors["p"]
            exact = interpret(function.program, values | dict(zip(p.names, p.defaults, strict=True)))
            for (name, expected), found in zip(exact.items(), call(library, exported, function, given), strict=True):
                error, size = bound[name]
                if np.isfinite(error):
                    finite += 1
                    assert np.abs(found - np.ravel(expected)).max() <= error
                    assert np.abs(expected).max() <= size * (1 + 1e-12)
    assert finite > 40 * 8  # forward dynamics divides by what may vanish in the ranges


def test_the_bound_says_something() -> None:
    """Not only true: within a few thousand roundings of the size of the metric."""
    exported = exported_of(tree_of("scara", "camera"))
    metric = next(f for f in exported.functions if f.quantity == "metric")
    (error, size) = bounds(metric, {})["metric"]
    assert 2.0**-24 * size < error < 2000 * 2.0**-24 * size


def test_a_wrong_bound_would_be_seen(tmp_path: Path) -> None:
    exported = replace(exported_of(tree_of("puma560")), precision="single")
    write(exported, "c", tmp_path)
    library, rng = shared([tmp_path / "demo.c"], FLAGS), np.random.default_rng(3)
    function = next(f for f in exported.functions if f.quantity == "christoffel")
    worst = 0.0
    for _ in range(200):
        given = states(function, rng, {})
        p = function.interface.vectors["p"]
        values = dict(zip(function.vector("q").names, map(float, given["q"]), strict=True))
        exact = interpret(function.program, values | dict(zip(p.names, p.defaults, strict=True)))["christoffel"]
        worst = max(worst, float(np.abs(call(library, exported, function, given)[0] - np.ravel(exact)).max()))
    assert bounds(function, {})["christoffel"][0] / 5000 < worst


def test_narrower_ranges_have_a_lower_bound() -> None:
    exported = exported_of(tree_of("acrobot"))
    function = next(f for f in exported.functions if f.quantity == "forward_dynamics")
    errors = [
        bounds(function, read_ranges(text, exported.interface))["forward_dynamics"][0]
        for text in ("", "qd:-0.5:0.5", "qd:-0.5:0.5,i0.q2:-0.1:0.1", "qd:0:0,q:0:0,u:0:0")
    ]
    assert errors == sorted(errors, reverse=True)
    assert 0 < errors[-1] < errors[0] / 5


def test_what_can_have_no_bound_lets_nothing_be_halved() -> None:
    """1/x has none where x may vanish, wherever its range is cut: the bound of 1/(y^2 - y + 1) is as it is alone."""
    g = Graph()
    x, y = g.symbol("x"), g.symbol("y")
    needs_halves = g.one / (y * y - y + g.one)
    both = collected(g, a=Formulas((1,), {(0,): g.one / x}), b=Formulas((1,), {(0,): needs_halves}))
    one = collected(g, b=Formulas((1,), {(0,): needs_halves}))
    found, alone_found = (bounds(alone(p).functions[0], {"y": (0.0, 1.0)}) for p in (both, one))
    assert np.isinf(found["a"][0])
    assert found["b"] == alone_found["b"]
    assert 1.2e-7 < found["b"][0] < 1e-4
    assert 4 / 3 <= found["b"][1] < 10


@pytest.mark.parametrize(
    ("text", "told"),
    [
        ("i0.q9:0:1", "'i0.q9' is no argument and no element of one"),
        ("i0.q1:1:0", "no range: name:lowest:highest"),
        ("i0.q1:0", "no range"),
        ("i0.q1:0:nan", "no range"),
        ("q:a:b", "no range"),
    ],
)
def test_what_is_no_range_is_told(text: str, told: str) -> None:
    with pytest.raises(InvalidArgument, match=told):
        read_ranges(text, exported_of(tree_of("acrobot")).interface)


@pytest.mark.parametrize("compiler", ["gcc", "clang"])
def test_it_compiles_and_passes_its_selftest(compiler: str, tmp_path: Path) -> None:
    for exported in (exported_of(tree_of("scara", "camera")), alone(mixed_program(), "mixed")):
        write(replace(exported, precision="single"), "c", tmp_path)
        name = exported.name
        sources = [str(tmp_path / f"{name}_selftest.c"), str(tmp_path / f"{name}.c")]
        flags = [flag for flag in FLAGS if flag != "-Wdouble-promotion"]
        subprocess.run([tool(compiler), *flags, "-o", str(tmp_path / "run"), *sources, "-lm"], check=True)
        done = subprocess.run([str(tmp_path / "run")], capture_output=True, text=True, check=False)
        assert (done.stdout.strip(), done.returncode) == ("ok", 0)
        code = re.sub(r"//.*", "", (tmp_path / f"{name}.c").read_text())
        assert "double" not in code
        assert not re.search(r"[^\w.]\d+\.\d+(e[-+]?\d+)?(?![\d.ef])", code)
