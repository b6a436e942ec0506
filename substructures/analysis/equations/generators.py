"""Whether a first integral is new, or a combination with constant coefficients of known ones and their products."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np

from substructures.analysis.equations.formulas import ModelFormulas
from substructures.array import Array
from substructures.expr.graph import Expr
from substructures.expr.interpret import interpret
from substructures.expr.program import Formulas, program

#: random states, and columns of which products are formed
STATES, MOST = 800, 400
#: relative to the size of the new one, what is left of it beside the known ones; of products beside each other
NOTHING, LEAST = 1e-8, 1e-11


class Generators:
    """Known integrals of one model by their values at random states, with parameters that are the same for all."""

    def __init__(self, f: ModelFormulas) -> None:
        self.f, self.rng = f, np.random.default_rng(0)
        self.symbols: dict[str, Array | float] = {"_batch": np.zeros(STATES)}
        self.known: list[Array] = []
        # an orthonormal basis of 1, all known ones and their products
        self.basis = np.full((STATES, 1), STATES**-0.5)

    def copy(self) -> Generators:
        """Another one that knows the same."""
        other = Generators(self.f)
        other.symbols, other.known, other.basis = self.symbols, list(self.known), self.basis
        return other

    def add(self, value: Expr) -> None:
        """One that is known from now on."""
        self.add_values(self.values_of(value))

    def add_values(self, x: Array) -> None:
        """The same by its values: with products of two and three of the known ones, as far as these are few."""
        size = np.abs(x).max()
        if not np.isfinite(x).all() or not size:
            return
        self.known.append(x / size)
        x, some = self.known[-1], self.known
        pairs = [x * y for y in some]
        triples = [y * z for k, y in enumerate(pairs) for z in some[: k + 1]]
        room = MOST - self.basis.shape[1]
        columns = [x, *(pairs if len(pairs) < room else ()), *(triples if len(pairs) + len(triples) < room else ())]
        block = np.stack(columns, axis=1)
        block /= np.abs(block).max(axis=0)
        size = np.linalg.norm(block)
        left, kept, _ = np.linalg.svd(self._beside(block), full_matrices=False)
        self.basis = np.hstack([self.basis, left[:, kept > LEAST * size]])

    def is_new(self, value: Expr) -> bool:
        """Whether it is no combination of 1, known integrals, and their products; also where floats cannot tell."""
        return self.are_new(self.values_of(value))

    def are_new(self, x: Array) -> bool:
        """The same of values at the states."""
        left = np.abs(self._beside(x)).max()
        return not np.isfinite(left) or bool(left > NOTHING * np.abs(x).max())

    def _beside(self, x: Array) -> Array:
        """What is left beside the known ones."""
        x = x - self.basis @ (self.basis.T @ x)
        return np.asarray(x - self.basis @ (self.basis.T @ x))

    def values(self) -> Mapping[str, Array | float]:
        """Of all symbols at the states."""
        for symbol in self.f.symbols.values():
            if symbol.name not in self.symbols:
                fixed = symbol.kind == "parameter"
                self.symbols[symbol.name] = self.rng.uniform(0.5, 1.5) if fixed else self.rng.uniform(-2, 2, STATES)
        return self.symbols

    def values_of(self, value: Expr) -> Array:
        """At the states."""
        source = program(self.f.graph, {"value": Formulas((), {(): value})}, self.f.symbols)
        with np.errstate(all="ignore"):
            found = interpret(source, dict(self.values()), ["value"])["value"]
        return np.broadcast_to(found, (STATES,))
