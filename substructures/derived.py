"""Formulas that follow from metric, Christoffel symbols and forces: Coriolis matrix, inverse dynamics, energy."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

from substructures.expr.graph import Expr, Graph
from substructures.expr.program import Formulas, Output, Program, Symbol, program
from substructures.expr.replay import replay
from substructures.model import Model

LENGTH = {"R": "rad", "P": "m"}


class _Replayed:
    """Outputs of a model in a new graph, with all dependent elements, and symbols for velocities and accelerations."""

    def __init__(self, model: Model) -> None:
        self.model, self.graph, self.n = model, Graph(), model.dof
        self.symbols = {symbol.name: symbol for symbol in model.program.symbols}

    def elements(self, name: str) -> dict[tuple[int, ...], Expr]:
        """All non-zero elements of an output."""
        stored = self.model.program.outputs[name]
        values = [
            x for x in replay(self.model.program, self.graph, {}, [name])[name].entries.values() if isinstance(x, Expr)
        ]
        numbered = Output(stored.shape, stored.index, tuple(range(len(values))), stored.symmetry)
        return {index: values[k] if sign > 0 else -values[k] for index, k, sign in numbered.expanded()}

    def rate(self, a: int, primes: str) -> Expr:
        """q'^a or q''^a."""
        name = self.model.coordinates[a] + primes
        kind = "velocity" if primes == "'" else "acceleration"
        unit = LENGTH[self.model.joints[a]] + ("/s" if primes == "'" else "/s^2")
        self.symbols[name] = Symbol(name, kind, unit)
        return self.graph.symbol(name)

    def coriolis(self) -> dict[tuple[int, ...], Expr]:
        """C_ab = Gamma_abc q'^c."""
        entries: dict[tuple[int, ...], Expr] = {}
        for (a, b, c), gamma in self.elements("christoffel").items():
            entries[a, b] = entries.get((a, b), self.graph.zero) + gamma * self.rate(c, "'")
        return entries

    def product(self, matrix: dict[tuple[int, ...], Expr], primes: str) -> dict[tuple[int, ...], Expr]:
        """m_ab q'^b (or q''^b)."""
        entries: dict[tuple[int, ...], Expr] = {}
        for (a, b), x in matrix.items():
            entries[(a,)] = entries.get((a,), self.graph.zero) + x * self.rate(b, primes)
        return entries

    def inverse_dynamics(self) -> dict[tuple[int, ...], Expr]:
        """g_ab q''^b + Gamma_abc q'^b q'^c - Q_a."""
        result = self.product(self.elements("metric"), "''")
        for index, x in self.elements("bias").items():
            result[index] = result.get(index, self.graph.zero) + x
        for index, x in self.elements("forces").items():
            result[index] = result.get(index, self.graph.zero) - x
        return result

    def kinetic_energy(self) -> dict[tuple[int, ...], Expr]:
        """1/2 g_ab q'^a q'^b."""
        momentum = self.product(self.elements("metric"), "'")
        twice = self.graph.sum(p * self.rate(a, "'") for (a,), p in momentum.items())
        return {(): twice / 2}


_SHAPES: dict[str, tuple[int, Callable[[_Replayed], dict[tuple[int, ...], Any]]]] = {
    "coriolis": (2, _Replayed.coriolis),
    "inverse_dynamics": (1, _Replayed.inverse_dynamics),
    "kinetic_energy": (0, _Replayed.kinetic_energy),
}
DERIVED = tuple(_SHAPES)


def derived(model: Model, quantity: str) -> Program:
    """A quantity of DERIVED as a program with one output of that name (mathematics.md, section 7).

    coriolis (n, n): C_ab = Gamma_abc q'^c, g' - 2 C is skew;
    inverse_dynamics (n,): g_ab q''^b + Gamma_abc q'^b q'^c - Q_a [N m, N]; kinetic_energy (): [J].
    Velocities are the symbols q', accelerations q''. Raises KeyError for another name.
    """
    axes, formula = _SHAPES[quantity]
    replayed = _Replayed(model)
    entries = formula(replayed)
    return program(replayed.graph, {quantity: Formulas((model.dof,) * axes, entries)}, replayed.symbols)
