"""Programs to compile, and the measure of agreement."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from functools import cache
from typing import Any

import numpy as np
import pytest
from catalogue_entries import shipped_part

from substructures import TreeSpec, couple
from substructures.expr.interpret import constant, interpret
from substructures.expr.program import Formulas, Program, Symbol, program
from substructures.quantities.numbers.defaults import default_number
from substructures.tree.model import Model

Array = Any
EPS = float(np.finfo(float).eps)


def _magnitude(operation: tuple[Any, ...], value: Callable[[int], Array], size: Callable[[int], Array]) -> Array:
    """Size of the terms of an operation: its value if nothing cancelled, and what errors of its operands come to."""
    op, x = operation[0], operation[1] if len(operation) > 1 else 0
    if op in ("add", "sub"):
        return size(x) + size(operation[2])
    if op == "mul":
        return size(x) * size(operation[2])
    if op == "div":
        return size(x) * size(operation[2]) / value(operation[2]) ** 2
    if op in ("sin", "cos"):
        return 1 + size(x)
    if op == "sqrt":
        return size(x) / np.sqrt(value(x))
    if op == "powi":
        n = operation[2]
        return np.abs(value(x)) ** n * (size(x) / np.abs(value(x))) ** abs(n)
    if op == "acos":  # pi
        return np.pi * size(x)
    if op == "sign":
        return np.ones_like(size(x))
    assert op in ("neg", "abs"), op
    return size(x)


def _deviation(compiled: Program, values: Mapping[str, Any], found: Mapping[str, Array]) -> float:
    """Largest |found - reference| / (eps * size of the terms) over all elements of all outputs and states."""
    results: dict[int, Array] = {}
    sizes: dict[int, Array] = {}
    expected = interpret(compiled, values, list(found))
    single = {"sin": np.sin, "cos": np.cos, "neg": np.negative, "sqrt": np.sqrt, "abs": np.abs, "acos": np.arccos}
    single["sign"] = np.sign
    double = {"add": np.add, "sub": np.subtract, "mul": np.multiply, "div": np.divide}
    with np.errstate(all="ignore"):
        for i in compiled.reachable(list(found)):
            operation = compiled.operations[i]
            op = operation[0]
            if op in ("int", "rat", "sym"):
                given = constant(operation) if op != "sym" else values[compiled.symbols[operation[1]].name]
                results[i] = np.asarray(given, dtype=float)
                sizes[i] = np.abs(results[i])
                continue
            if op == "powi":
                results[i] = results[operation[1]] ** float(operation[2])
            else:
                results[i] = (single | double)[op](*(results[x] for x in operation[1:]))
            sizes[i] = _magnitude(operation, results.__getitem__, sizes.__getitem__)
        worst = 0.0
        for name, array in found.items():
            np.testing.assert_array_equal(np.isnan(array), np.isnan(expected[name]), err_msg=name)
            for index, entry, _ in compiled.outputs[name].expanded():
                error = np.abs(array[(..., *index)] - expected[name][(..., *index)])
                worst = max(worst, float(np.max(np.where(error > 0, error / (EPS * sizes[entry]), 0), initial=0)))
            zero = np.ones(compiled.outputs[name].shape, dtype=bool)
            for index, _, _ in compiled.outputs[name].expanded():
                zero[index] = False
            assert not array[..., zero].any()
    return worst


@pytest.fixture
def deviation() -> Callable[..., float]:
    """deviation(program, values, found) in units of the last place of the terms."""
    return _deviation


@cache
def _tree(*instances: tuple[str, str, str]) -> Model:
    parts = {i: shipped_part(entry) for i, entry, _ in instances}
    document = {
        "name": "tree",
        "gravity": [0, 0, "-g"],
        "parameters": {"g": {"value": 9.81, "unit": "m/s^2"}},
        "instances": [{"name": i, "substructure": entry, "at": at, "level": "full"} for i, entry, at in instances],
    }
    return couple(TreeSpec.read(document), parts)


@pytest.fixture(scope="session")
def tree() -> Callable[..., Model]:
    """tree((instance, entry, at), ...) under gravity along -z, with all coordinates of loops."""
    return _tree


def _states(model: Model, count: int, seed: int = 0) -> dict[str, Any]:
    rng = np.random.default_rng(seed)
    values: dict[str, Any] = {}
    for symbol in model.program.symbols:
        given = model.parameters.get(symbol.name, {}).get("value")
        if symbol.kind in ("parameter", "inertia"):
            values[symbol.name] = rng.uniform(0.5, 2) if given is None else default_number(given)
        else:
            values[symbol.name] = rng.uniform(-3, 3, count)
    return values


@pytest.fixture(scope="session")
def states() -> Callable[..., dict[str, Any]]:
    """states(model, count, seed=0): default parameters, random states and inputs."""
    return _states


def _collected(graph: Any, kinds: Mapping[str, str], **outputs: Any) -> Program:
    formulas = {n: o if isinstance(o, Formulas) else Formulas((), {(): o}) for n, o in outputs.items()}
    names = {str(e.value) for e in graph.nodes if e.op == "sym"}
    return program(graph, formulas, {n: Symbol(n, kinds.get(n, "coordinate"), "") for n in names})


@pytest.fixture
def collected() -> Callable[..., Program]:
    """collected(graph, {symbol: kind}, name=Expr or Formulas) -> Program; symbols are coordinates by default."""
    return _collected
