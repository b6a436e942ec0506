"""The square commutes: coupling evaluated parts gives the same numbers as evaluating coupled formulas."""

from __future__ import annotations

from functools import cache
from typing import Any

import numpy as np
import pytest
from catalogue_entries import shipped_part

from substructures import MissingValue, Model, Part, TreeSpec, catalogue, couple
from substructures.compile import compile_program
from substructures.expr.interpret import interpret
from substructures.quantities.from_parts import EQUATIONS, NumericTree
from substructures.quantities.numbers.evaluation import evaluate
from substructures.quantities.part_kernels import CompiledParts


def parts_of(spec: TreeSpec) -> dict[str, Part]:
    library = {str(i.substructure): shipped_part(str(i.substructure)) for i in spec.instances}
    return {i.name: library[str(i.substructure)] for i in spec.instances}


def tree(*mounts: tuple[str, str, str], **more: Any) -> TreeSpec:
    instances = [{"name": name, "substructure": part, "at": at, **more.get(name, {})} for name, part, at in mounts]
    parameters = {"g": {"value": 9.81}}
    return TreeSpec.read({"name": "t", "gravity": ["0.3", 0, "-g"], "parameters": parameters, "instances": instances})


TREES = {
    "arm on arm": tree(
        ("a", "ur5", "world"),
        ("b", "puma560", "a.flange"),
        a={"placement": {"rpy": ["0.2", 0, "0.1"], "position": [1, "a.d1", 0]}},
        b={"placement": {"rpy": ["0.1", 0, 0]}},
    ),
    "hand and camera on a gantry": tree(
        ("x", "gantry", "world"),
        ("hand", "parallel-gripper", "x.flange"),
        ("eye", "camera", "hand.base"),
    ),
    "quadruped": tree(
        ("trunk", "quadruped-trunk", "world"),
        ("leg", "quadruped-leg", f"trunk.{catalogue.load('quadruped-trunk')['ports'][0]['name']}"),
    ),
    "springs": tree(("car", "quarter-car", "world"), ("p", "simple-pendulum", "car.base")),
}


def values_of(evaluator: NumericTree, batch: tuple[int, ...]) -> dict[str, Any]:
    rng = np.random.default_rng(1)
    names = [*evaluator.assembly.scope.symbols]
    names += [f"{name}{primes}" for name in evaluator.coordinates for primes in ("'", "''")]
    return {
        name: rng.uniform(0.5, 1.5, batch) if batch else float(rng.uniform(0.5, 1.5)) for name in sorted(set(names))
    }


def compare(found: dict[str, Any], expected: dict[str, Any]) -> None:
    for name, x in expected.items():
        scale = max(1.0, float(np.abs(x).max(initial=0.0)))
        assert found[name].shape == x.shape
        np.testing.assert_allclose(found[name], x, atol=1e-12 * scale, rtol=0)


@cache
def pair(name: str) -> tuple[dict[str, Part], Model]:
    parts = parts_of(TREES[name])
    return parts, couple(TREES[name], parts)


@pytest.fixture(scope="module")
def compiled(tmp_path_factory: pytest.TempPathFactory) -> CompiledParts:
    return CompiledParts(tmp_path_factory.mktemp("kernels"))


@pytest.mark.parametrize("name", TREES)
@pytest.mark.parametrize("batch", [(), (3,), (37,)])
def test_square_commutes(name: str, batch: tuple[int, ...], monkeypatch: pytest.MonkeyPatch) -> None:
    """All outputs of the model; also when the batch is worked off in blocks."""
    parts, model = pair(name)
    evaluator = NumericTree(TREES[name], parts)
    values = values_of(evaluator, batch)
    monkeypatch.setattr("substructures.quantities.from_parts.BLOCK", 10)
    compare(evaluator.evaluate(values, list(model.program.outputs)), interpret(model.program, values))


@pytest.mark.parametrize("name", TREES)
@pytest.mark.parametrize("batch", [(), (5,)])
def test_kernels_of_parts(name: str, batch: tuple[int, ...], compiled: CompiledParts) -> None:
    """The same from compiled parts, and from the kernel of the whole."""
    parts, model = pair(name)
    evaluator = NumericTree(TREES[name], parts, compiled)
    values = values_of(evaluator, batch)
    found = evaluator.evaluate(values)
    compare(found, interpret(model.program, values, EQUATIONS))
    compare(found, compile_program(model.program, EQUATIONS).evaluate(values))


def test_parts_that_are_warm_are_not_compiled(monkeypatch: pytest.MonkeyPatch) -> None:
    parts, _ = pair("springs")
    engine = CompiledParts()
    for part in parts.values():
        engine.warm(part)
    monkeypatch.setattr("substructures.quantities.part_kernels.compile_program", None)
    evaluator = NumericTree(TREES["springs"], parts, engine)
    evaluator.evaluate(values_of(evaluator, ()))
    evaluator.evaluate(values_of(evaluator, ()), ["metric"])


def test_missing_value_is_named() -> None:
    spec = TREES["springs"]
    with pytest.raises(MissingValue, match="has no value"):
        NumericTree(spec, parts_of(spec)).evaluate({})


def test_answers_have_the_axis_of_states() -> None:
    """Also for one state and for none; parameters that are not given have their defaults."""
    parts, model = pair("arm on arm")
    evaluator = NumericTree(TREES["arm on arm"], parts)
    q = np.random.default_rng(0).uniform(-1, 1, (2, model.dof))
    for states in (2, 1, 0):
        values = {name: q[:states, a] for a, name in enumerate(model.coordinates)}
        found = evaluator.answer(values, ["metric", "gravity"], states)
        expected = evaluate(model, ["metric", "gravity"], q=q[:states])
        compare(found, {name: expected[name] for name in ("metric", "gravity")})
