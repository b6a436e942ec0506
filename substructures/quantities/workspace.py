"""Outputs of a model in a new graph, to form further formulas from them."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

from substructures.expr.graph import Expr, Graph
from substructures.expr.program import Formulas, Output, Program, Symbol, array, program
from substructures.expr.replay import replay
from substructures.tree.model import Model

LENGTH = {"R": "rad", "P": "m"}
ID = "inverse_dynamics"
Entries = dict[tuple[int, ...], Expr]


class Replayed:
    """A model in a graph of its own, and symbols for velocities and accelerations."""

    def __init__(self, model: Model) -> None:
        self.model, self.graph, self.n = model, Graph(), model.dof
        self.symbols = {symbol.name: symbol for symbol in model.program.symbols}

    def independent(self, name: str, bindings: Mapping[str, Expr] | None = None) -> Entries:
        """The stored elements of an output; ``bindings``: expressions in place of symbols."""
        found = replay(self.model.program, self.graph, bindings or {}, [name])[name]
        return {index: x for index, x in found.entries.items() if isinstance(x, Expr)}

    def elements(self, name: str, bindings: Mapping[str, Expr] | None = None) -> Entries:
        """All non-zero elements of an output."""
        stored, values = self.model.program.outputs[name], list(self.independent(name, bindings).values())
        numbered = Output(stored.shape, stored.index, tuple(range(len(values))), stored.symmetry)
        return {index: values[k] if sign > 0 else -values[k] for index, k, sign in numbered.expanded()}

    def rate(self, a: int, primes: str) -> Expr:
        """q'^a or q''^a."""
        name = self.model.coordinates[a] + primes
        kind = "velocity" if primes == "'" else "acceleration"
        unit = LENGTH[self.model.joints[a]] + ("/s" if primes == "'" else "/s^2")
        self.symbols[name] = Symbol(name, kind, unit)
        return self.graph.symbol(name)

    def product(self, matrix: Entries, primes: str) -> Entries:
        """m_ab q'^b (or q''^b)."""
        entries: Entries = {}
        for (a, b), x in matrix.items():
            entries[(a,)] = entries.get((a,), self.graph.zero) + x * self.rate(b, primes)
        return entries

    def inverse_dynamics(self, accelerations: Sequence[Expr] | None = None) -> list[Expr]:
        """g_ab q''^b + Gamma_abc q'^b q'^c - Q_a at the symbols q'', or at other expressions for them."""
        rates = [self.rate(a, "''") for a in range(self.n)]
        bindings = dict(zip((str(x.value) for x in rates), accelerations or rates, strict=True))
        if ID in self.model.program.outputs:
            result = self.independent(ID, bindings)
            return [result.get((a,), self.graph.zero) for a in range(self.n)]
        # models that were stored before this was one of their outputs
        rows = [self.graph.zero] * self.n
        for (a, b), x in self.elements("metric").items():
            rows[a] = rows[a] + x * list(bindings.values())[b]
        bias, forces = self.elements("bias"), self.elements("forces")
        return [x + bias.get((a,), 0) - forces.get((a,), 0) for a, x in enumerate(rows)]

    def program(self, outputs: Mapping[str, Formulas]) -> Program:
        """Outputs as a program."""
        return program(self.graph, outputs, self.symbols)


def vector(values: Sequence[Any]) -> Formulas:
    """An output of one axis."""
    return array((len(values),), lambda a: values[a])
