"""A definition alone at the world, and its formulas compared exactly with formulas given as text."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

from random_trees import Plain

from substructures import Definition, Model, TreeSpec, couple, derive
from substructures.expr.graph import Graph
from substructures.expr.parse import parse
from substructures.expr.replay import replay
from substructures.expr.rings.expand import is_zero


def alone(definition: Plain, gravity: list[Any], parameters: Plain | None = None) -> Model:
    one = {
        "name": "x",
        "substructure": "one",
        "parameters": {name: name for name in definition.get("parameters", {}) if parameters},
    }
    spec = {"name": "tree", "gravity": gravity, "parameters": parameters or {}, "instances": [one]}
    return couple(TreeSpec.read(spec), {"x": derive(Definition.read(definition))})


def alone_name(name: str) -> str:
    """The name in a model of :func:`alone`: its parameters are those of the tree."""
    return f"x.{name}" if name.startswith("q") else name


def assert_formulas(
    model: Model, quantity: str, expected: dict[tuple[int, ...], str], rename: Callable[[str], str] = alone_name
) -> None:
    """All elements, those that follow from symmetries included; elements not named are zero."""
    graph = Graph()
    formulas = replay(model.program, graph, {}, [quantity])[quantity].entries
    output = model.program.outputs[quantity]
    entry = {e: graph.zero + formulas[i] for i, e in zip(output.index, output.entries, strict=True)}
    found = {i: entry[e] * sign for i, e, sign in output.expanded()}
    for index in found | expected:
        difference = found.get(index, graph.zero) - parse(
            graph, expected.get(index, "0"), lambda name: graph.symbol(rename(name))
        )
        assert is_zero(difference), (quantity, index)
