"""Defaults of parameters and inputs, as numbers."""

from __future__ import annotations

from collections.abc import Mapping
from functools import lru_cache
from typing import Any

from substructures.documents.fields import in_si
from substructures.errors import InvalidDocument
from substructures.expr.graph import Graph
from substructures.expr.interpret import interpret
from substructures.expr.parse import parse
from substructures.expr.program import array, program
from substructures.expr.steps import ExpressionError
from substructures.loads.scope import no_names


def default_numbers(parameters: Mapping[str, Mapping[str, Any]]) -> dict[str, float]:
    """The default values of parameters that have one, correctly rounded, in SI."""
    return {name: default_number(p["value"]) for name, p in parameters.items() if p["value"] is not None}


def input_defaults(inputs: Mapping[str, Mapping[str, Any]]) -> dict[str, float]:
    """The defaults of inputs that have one, correctly rounded, in SI; all others are 0 where they are not given."""
    found = {name: given.get("default") for name, given in inputs.items()}
    return {name: default_number(value) for name, value in found.items() if value is not None}


def with_input_defaults(inputs: Mapping[str, Mapping[str, Any]], given: Any) -> Any:
    """Inputs by name as they are given, with the defaults of those that are not."""
    return {**input_defaults(inputs), **given} if isinstance(given, Mapping) else given


@lru_cache(maxsize=10_000)
def default_number(value: Any) -> float:
    """A default as a double, in SI: a number, or a constant expression in the grammar."""
    value = in_si(value)
    if not isinstance(value, str):
        return float(value)
    graph = Graph()
    try:
        constant = parse(graph, value, no_names)
    except ExpressionError as error:
        raise InvalidDocument.at("", "bad-expression", str(error)) from None
    return float(interpret(program(graph, {"x": array((), lambda: constant)}, {}), {})["x"])
