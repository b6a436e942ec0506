"""One position, many velocities: the same numbers as the position repeated, by both engines, in all quantities."""

from __future__ import annotations

from collections.abc import Mapping
from functools import cache
from typing import Any

import numpy as np
import pytest
from random_trees import Kind, model_of, random_definition, random_states, tree_of

from substructures import Definition, Model, couple, derive
from substructures.array import Array
from substructures.compile import Kernel, compile_program
from substructures.expr.program import Program
from substructures.quantities.accelerations import Evaluator
from substructures.quantities.derivative_directions import Direction
from substructures.quantities.numbers.evaluation import EvaluationOptions, evaluate, interpreted
from substructures.quantities.numbers.result import Evaluation
from substructures.quantities.quantity import QUANTITIES, REGRESSOR
from substructures.quantities.sources import Sources, cost, numbers_per_state, of_parts

N = 5
NAMES = [name for name, quantity in QUANTITIES.items() if quantity.source != REGRESSOR]


_kernels: dict[tuple[str, ...], Kernel] = {}


def compiled(program: Program, values: Mapping[str, Any], names: list[str], _states: int) -> dict[str, Array]:
    """The engine that compiles what it is asked for, once."""
    key = program.digest, *names
    if key not in _kernels:
        _kernels[key] = compile_program(program, names)
    return _kernels[key].evaluate(values)


@cache
def random_sources(seed: int = 77) -> Sources:
    definition = random_definition(np.random.default_rng(seed), Kind(3, joints=("revolute", "prismatic"), massive=True))
    spec, parts = tree_of(definition), {"x": derive(Definition.read(definition))}
    return Sources(couple(spec, parts), of_parts=of_parts(spec, parts))


def random_model() -> Model:
    return random_sources().model


def leaves(answer: Evaluation) -> dict[str, Any]:
    """Arrays of the quantities by name."""
    found: dict[str, Any] = {}
    for name in NAMES:
        some = answer[name] if isinstance(answer[name], dict) else {"": answer[name]}
        found |= {f"{name}.{key}": x for key, x in some.items()}
    return found


@pytest.mark.parametrize("engine", [interpreted, compiled])
@pytest.mark.parametrize("batched", ["qd qdd", "qdd", "qd", "t", "inputs"])
def test_one_position_stands_for_all(engine: Evaluator, batched: str) -> None:
    sources = random_sources()
    model = sources.model
    x = random_states(np.random.default_rng(1), N, model.dof)
    given = {"t": np.arange(N) / 7, "inputs": {f"tau.{model.coordinates[0]}": np.arange(N) - 2.0}}
    one = {"q": x["q"][0], "qd": x["qd"][0], "qdd": x["qdd"][0], "t": 0.3, "quantities": NAMES}
    along = Direction(q=x["qd"][1], inputs={f"tau.{model.coordinates[0]}": 1.0})
    options = EvaluationOptions(along=along, evaluator=engine)
    one |= {name: (x | given)[name] for name in batched.split()}
    found = evaluate(sources, **one, options=options)
    rows = evaluate(sources, **one | {"q": x["q"][:1]}, options=options)
    repeated = evaluate(
        sources, **one | {"q": np.repeat(x["q"][:1], N, axis=0)}, options=EvaluationOptions(along=along)
    )
    assert found.count == rows.count == N
    for name, expected in leaves(repeated).items():
        scale = max(1.0, np.abs(expected).max(initial=0))
        np.testing.assert_allclose(leaves(found)[name], expected, rtol=1e-12, atol=1e-13 * scale, err_msg=name)
        np.testing.assert_array_equal(leaves(rows)[name], leaves(found)[name], err_msg=name)


def test_the_axis_of_states_is_dropped_for_one_state_only() -> None:
    model = random_model()
    zero = np.zeros(model.dof)
    for qd, shape in ((zero, ()), (zero[None], ()), (np.zeros((2, model.dof)), (2,))):
        answer = evaluate(model, ["metric"], q=zero, qd=qd)
        assert answer["metric"].shape == (*shape, model.dof, model.dof)


def test_the_size_of_an_answer_is_known_before() -> None:
    """The numbers of every quantity exactly, and at most so many without any formulas."""
    sources = random_sources(78)
    model = sources.model
    x = random_states(np.random.default_rng(1), 1, model.dof)
    state: dict[str, Any] = {key: rows[0] for key, rows in x.items()}
    options = EvaluationOptions(along=Direction(q=x["q"][0]))
    for name in QUANTITIES:
        found = evaluate(sources, name, **state, options=options)[name]
        size = sum(np.size(array) for array in (found.values() if isinstance(found, dict) else [found]))
        assert cost(sources, [name])[1] == size <= numbers_per_state([name], model.dof, len(model.frames)), name
    assert cost(sources, ["metric", "momentum"])[1] == model.dof**2 + 6


def test_operations_of_an_answer() -> None:
    """A slide of mass m: its metric is the symbol m, its gravity force -(10 m)."""
    slide = {"name": "slide", "parent": "base", "joint": {"type": "prismatic", "coordinate": "s"}, "mass": "m"}
    model = model_of({"name": "slide", "parameters": {"m": {"value": 2}}, "bodies": [slide]}, (0, 0, -10))
    assert cost(Sources(model), ["metric"]) == (1, 1)
    assert cost(Sources(model), ["gravity"]) == (4, 1)
    assert cost(Sources(model), ["metric", "gravity"]) == (4, 2)
