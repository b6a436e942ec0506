"""The square commutes: coupling evaluated parts gives the same numbers as evaluating coupled formulas."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

from substructures import Definition, MissingValue, Part, TreeSpec, catalogue, couple, derive
from substructures.expr.interpret import interpret
from substructures.numeric import EQUATIONS, NumericTree


def parts_of(spec: TreeSpec) -> dict[str, Part]:
    library = {
        str(i.substructure): derive(Definition.read(catalogue.load(str(i.substructure)))) for i in spec.instances
    }
    return {i.name: library[str(i.substructure)] for i in spec.instances}


def tree(*mounts: tuple[str, str, str], **more: Any) -> TreeSpec:
    instances = [{"name": name, "substructure": part, "at": at, **more.get(name, {})} for name, part, at in mounts]
    parameters = {"g": {"value": 9.81}}
    return TreeSpec.read({"name": "t", "gravity": ["0.3", 0, "-g"], "parameters": parameters, "instances": instances})


TREES = {
    "arm on arm": tree(
        ("a", "ur5", "world"),
        ("b", "puma560", "a.flange"),
        a={"placement": {"rpy": ["0.2", 0, "0.1"], "position": [1, "a.m1", 0]}},
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
    names = [*evaluator.assembly.scope.symbols, *(f"{name}'" for name in evaluator.coordinates)]
    return {
        name: rng.uniform(0.5, 1.5, batch) if batch else float(rng.uniform(0.5, 1.5)) for name in sorted(set(names))
    }


@pytest.mark.parametrize("name", TREES)
@pytest.mark.parametrize("batch", [(), (3,)])
def test_square_commutes(name: str, batch: tuple[int, ...]) -> None:
    spec = TREES[name]
    parts = parts_of(spec)
    evaluator = NumericTree(spec, parts)
    values = values_of(evaluator, batch)
    found = evaluator.evaluate(values)
    expected = interpret(couple(spec, parts).program, values, EQUATIONS)
    for quantity in EQUATIONS:
        scale = max(1.0, float(np.abs(expected[quantity]).max(initial=0.0)))
        assert found[quantity].shape == expected[quantity].shape
        np.testing.assert_allclose(found[quantity], expected[quantity], atol=1e-12 * scale, rtol=0)


def test_missing_value_is_named() -> None:
    spec = TREES["springs"]
    with pytest.raises(MissingValue, match="has no value"):
        NumericTree(spec, parts_of(spec)).evaluate({})
