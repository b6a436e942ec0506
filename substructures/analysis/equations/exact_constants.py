"""The constants of a first integral whose terms are known, as formulas in the parameters."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from contextlib import suppress
from typing import Any, TypeVar

from substructures.analysis.equations.ansatz import OUTPUTS, Ansatz, Column
from substructures.analysis.equations.dependencies import Functions, dependencies
from substructures.analysis.equations.symmetries import Direction, direction_of
from substructures.errors import TooLarge
from substructures.expr.graph import Expr, Graph
from substructures.expr.program import Formulas, Program, Symbol, program
from substructures.expr.replay import replay
from substructures.expr.rings.modular import Field, NoSquareRoot

X = TypeVar("X")

#: fields, and random points of each, that are tried
FIELDS, TRIALS = 8, 64
#: terms of a constant that is brought to its canonical form
READABLE = 500


def exact_constants(ansatz: Ansatz, columns: Sequence[Column]) -> Direction | None:
    """c by number of the column with sum_j c_j F_j' = 0, the last one not zero; None where none are found."""
    source = ansatz.program()
    for _ in range(FIELDS):
        with suppress(TooLarge, ArithmeticError):
            found = dependencies(_Samples(ansatz, columns, source).functions()).others
            last = len(columns) - 1
            # where floats were right only the last column depends on the others
            return direction_of(last, found[last], READABLE) if list(found) == [last] else None
    return None


class _Samples:
    """Rows of F_1', ..., F_m' at points of one field, and at exact points."""

    def __init__(self, ansatz: Ansatz, columns: Sequence[Column], source: Program) -> None:
        self.ansatz, self.columns, self.source, self.field = ansatz, columns, source, Field([source])
        self.symbols = {s.name: self.field.draw() for s in source.symbols if s.kind == "parameter"}
        self.varied = [s.name for s in source.symbols if s.kind != "parameter"]

    def functions(self) -> Functions:
        """For the exact search."""
        model = self.ansatz.f.model
        angles = {name for name, joint in zip(model.coordinates, model.joints, strict=True) if joint == "R"}
        angular = [name in angles for name in self.varied]
        return Functions(len(self.columns), angular, self.field, self._random, self._exact, self.symbols)

    def _random(self) -> list[dict[int, int]]:
        """At a random point that has the square roots there are. Raises TooLarge."""
        for _ in range(TRIALS):
            with suppress(NoSquareRoot, ZeroDivisionError):
                values = {**self.symbols, **{name: self.field.draw() for name in self.varied}}
                found = {name: self.field.evaluate(self.source, values, name) for name in OUTPUTS}
                return [{j: x % self.field.prime for j, x in self._row(found, 0).items()}]
        raise TooLarge("the search for a point with all square roots (in points)", TRIALS + 1, TRIALS)

    def _exact(self, graph: Graph, point: Sequence[Expr]) -> list[dict[int, Expr]]:
        """Formulas in the parameters; nothing where they divide by zero, or have roots that the field does not hold."""
        try:
            found = replay(self.source, graph, dict(zip(self.varied, point, strict=True)), OUTPUTS)
            row = self._row({name: found[name].entries for name in OUTPUTS}, graph.zero)
            kept = {j: graph.lift(x) for j, x in row.items() if not graph.lift(x).is_zero}
            described = {name: Symbol(name, "parameter") for name in self.symbols}
            formulas = Formulas((len(self.columns),), {(j,): x for j, x in kept.items()})
            self.field.evaluate(program(graph, {"row": formulas}, described), self.symbols, "row")
        except (ArithmeticError, ValueError):
            return []
        return [kept]

    def _row(self, found: Mapping[str, Mapping[tuple[int, ...], X]], zero: X) -> dict[int, Any]:
        sizes = {name: self.source.outputs[name].shape[0] for name in OUTPUTS}
        at = {name: [found[name].get((k,), zero) for k in range(size)] for name, size in sizes.items()}
        return {j: column.rate(at) for j, column in enumerate(self.columns)}
