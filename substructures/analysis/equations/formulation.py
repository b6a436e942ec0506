"""A model in a new graph, where further formulas are built from its outputs."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

from substructures.analysis.equations.formulas import LENGTH
from substructures.expr.graph import Expr, Graph
from substructures.expr.program import Output, Symbol
from substructures.expr.replay import replay
from substructures.part.scope import Scope
from substructures.tree.model import KINEMATICS, Model

Elements = dict[tuple[int, ...], Expr]


class Formulation:
    """Graph and scope with the symbols of a model: coordinates, velocities, parameters, the time."""

    def __init__(self, model: Model) -> None:
        self.model, self.graph, self.n = model, Graph(), model.dof
        self.scope = Scope(self.graph)
        for s in model.program.symbols:
            if s.kind != "input":
                self.scope.declare(s.name, s.kind, s.unit)
            self.scope.symbols[s.name] = s
        for name, kind in zip(model.coordinates, model.joints, strict=True):
            self.scope.declare(name, "coordinate", LENGTH[kind])
            self.scope.declare(f"{name}'", "velocity", f"{LENGTH[kind]}/s")
        for name, parameter in model.parameters.items():
            self.scope.declare(name, "parameter", str(parameter.get("unit", "")))

    @property
    def symbols(self) -> dict[str, Symbol]:
        """Descriptions of all symbols by name."""
        return self.scope.symbols

    def outputs(self, names: Sequence[str], bindings: Mapping[str, Expr] | None = None) -> dict[str, Elements]:
        """All non-zero elements of outputs of the model, symmetric ones included."""
        found = replay(self.model.program, self.graph, bindings or {}, names)
        return {name: self._elements(name, found[name].entries) for name in names}

    def _elements(self, name: str, entries: Mapping[tuple[int, ...], Expr | int]) -> Elements:
        values = [self.graph.zero + x for x in entries.values()]
        stored = self.model.program.outputs[name]
        numbered = Output(stored.shape, tuple(entries), tuple(range(len(values))), stored.symmetry)
        return {index: values[k] if sign > 0 else -values[k] for index, k, sign in numbered.expanded()}

    def kinematics(self) -> dict[str, Elements]:
        """Position, rotation, U and Omega of all frames."""
        return self.outputs(KINEMATICS)
