"""Formulas of parts and of trees, with what their axes mean, ready to be compared in one graph."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from substructures.documents.fields import in_si
from substructures.expr.direct import ball
from substructures.expr.graph import Graph
from substructures.expr.operations import Symbol
from substructures.expr.replay import replay
from substructures.interchange.difference.formulas import FormulaSet
from substructures.part.outputs import OWN_INERTIA, inertia_bindings, over_formulas
from substructures.part.part import INTERNAL, Part
from substructures.quantities.quantity import COORDINATES, FRAMES, OUTPUTS
from substructures.tree.model import Model

#: outputs of a tree that are made of others that are compared
MADE = frozenset(("nonlinear_effects", "inverse_dynamics"))


def of_part(graph: Graph, part: Part) -> FormulaSet:
    """The formulas of a part as it stands alone, with its own inertia."""
    own = over_formulas(graph)(part, {}, OWN_INERTIA)
    bindings = inertia_bindings(part, {carrier: own.own_inertia(carrier) for carrier in part.inertia_symbols})
    names = [name for name in part.program.outputs if name not in INTERNAL]
    lifted = {name: graph.lift(x) for name, x in bindings.items()}
    axes = {"b": part.coordinates, "c": part.coordinates}

    def labels(name: str) -> tuple[tuple[str, ...] | None, ...]:
        """Of the leading axes."""
        known = tuple(axes.get(axis) or part.labels(axis) or None for axis in part.axes_of(name))
        return known + (None,) * (len(part.program.outputs[name].shape) - len(known)) if name in names else ()

    symbols = {symbol.name: symbol for symbol in part.program.symbols}
    return FormulaSet(replay(part.program, graph, lifted, names), labels, symbols, _defaults(part.parameters))


def of_model(graph: Graph, model: Model) -> FormulaSet:
    """The formulas of a tree."""
    names = [name for name in model.program.outputs if name not in MADE and not name.startswith("closure")]
    known = {COORDINATES: model.coordinates, FRAMES: model.frames}

    def labels(name: str) -> tuple[tuple[str, ...] | None, ...]:
        """Of the leading axes."""
        if name not in names:
            return ()
        axes = [known.get(axis) for axis in OUTPUTS[name].axes] if name in OUTPUTS else []
        return (*axes, *[None] * (len(model.program.outputs[name].shape) - len(axes)))

    symbols: dict[str, Symbol] = {symbol.name: symbol for symbol in model.program.symbols}
    return FormulaSet(replay(model.program, graph, {}, names), labels, symbols, _defaults(model.parameters))


def _defaults(parameters: Mapping[str, Mapping[str, Any]]) -> dict[str, float]:
    given = {name: in_si(each.get("value")) for name, each in parameters.items()}
    return {name: float(ball(value).mid()) for name, value in given.items() if value is not None}
