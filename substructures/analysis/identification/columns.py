"""The columns of the regressor and of drives, as functions of coordinates whose dependencies are looked for."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from contextlib import suppress
from fractions import Fraction
from functools import partial
from typing import Any, TypeVar

from substructures.analysis.equations.dependencies import Functions
from substructures.errors import TooLarge
from substructures.expr.bind import bind
from substructures.expr.graph import Expr, Graph
from substructures.expr.replay import replay
from substructures.expr.rings.modular import Field, NoSquareRoot
from substructures.quantities.regressor_model import RegressorModel

#: unit of a drive's parameter, for revolute and prismatic joints
DRIVE_UNITS = {
    "armature": ("kg m^2", "kg"),
    "viscous": ("N m s/rad", "N s/m"),
    "coulomb": ("N m", "N"),
    "offset": ("N m", "N"),
}
#: primes that are tried until one has all square roots
MAX_FIELDS = 10_000
#: points of a field that are tried until it has the square roots there
MAX_POINTS = 200
#: a formula, or a value in the field
X = TypeVar("X", Expr, int)


class Columns:
    """The columns of Y and of the drives."""

    def __init__(self, Y: RegressorModel, drives: tuple[str, ...]) -> None:
        self.Y, self.drives, self.n = Y, drives, len(Y.coordinates)
        pairs = [(kind, a) for kind in drives for a in range(self.n)]
        self.names = (*Y.names, *(f"{Y.coordinates[a]}.{kind}" for kind, a in pairs))
        self.units = (*Y.units, *(DRIVE_UNITS[kind][Y.joints[a] == "P"] for kind, a in pairs))
        self.pairs = list(enumerate(pairs, len(Y.names)))
        # coefficients do not depend on what Y does not depend on (a height along gravity): any value does
        known = {s.name for s in Y.program.symbols}
        self.regrouping = bind(
            Y.regrouping, {s.name: Fraction(113, 355) for s in Y.regrouping.symbols if s.name not in known}
        )

    def regressor(self, graph: Graph, bindings: Mapping[str, Expr]) -> dict[tuple[int, int], Expr]:
        """[a, i] of Y for these values of symbols."""
        found = replay(self.Y.program, graph, bindings, ["regressor"])["regressor"].entries
        return {(index[0], index[1]): x for index, x in found.items() if isinstance(x, Expr) and not x.is_zero}

    def full(self, graph: Graph) -> dict[tuple[int, int], Expr]:
        """[a, i] with the columns of the drives."""
        result = self.regressor(graph, {})
        for i, (kind, a) in self.pairs:
            name = self.Y.coordinates[a]
            speed = graph.symbol(f"{name}'")
            values = {
                "armature": graph.symbol(f"{name}''"),
                "viscous": speed,
                "coulomb": graph.function("sign", speed),
                "offset": graph.one,
            }
            result[a, i] = values[kind]
        return result

    def functions(self) -> Functions:
        """The functions of q alone, with a field that holds all square roots that occur."""
        names = [s.name for s in self.Y.program.symbols if s.kind == "parameter"]
        turns = {name for name, joint in zip(self.Y.coordinates, self.Y.joints, strict=True) if joint == "R"}
        angular = [name in turns for name in self.Y.positions]
        for _ in range(MAX_FIELDS):
            field = Field([self.Y.program, self.regrouping])
            symbols = {name: field.draw() for name in names}
            # a trial finds out whether the field holds the roots
            with suppress(NoSquareRoot, ZeroDivisionError):
                self._random(field, symbols)
                field.evaluate(self.regrouping, symbols, "relations")
                random = partial(self._random, field, symbols)
                return Functions(len(self.names), angular, field, random, self._exact, symbols, self._known)
        raise TooLarge("the search for a field with all square roots (in primes)", MAX_FIELDS + 1, MAX_FIELDS)

    def _random(self, field: Field, symbols: Mapping[str, int]) -> list[dict[int, int]]:
        """Rows at a random point of the field that has the square roots of positions. Raises NoSquareRoot."""
        for _ in range(MAX_POINTS):
            with suppress(NoSquareRoot):
                return self._at_random(field, symbols)
        raise NoSquareRoot

    def _at_random(self, field: Field, symbols: Mapping[str, int]) -> list[dict[int, int]]:
        at = {**symbols, **{name: field.draw() for name in self.Y.positions}}

        def regressor(motion: Mapping[str, int]) -> dict[tuple[int, ...], int]:
            """Y at a random position in the field, for a motion."""
            return field.evaluate(self.Y.program, {**at, **motion}, "regressor")

        return self._rows(regressor, 0, 1)

    def _exact(self, graph: Graph, q: Sequence[Expr]) -> list[dict[int, Expr]]:
        """Rows of formulas at q."""
        at = dict(zip(self.Y.positions, q, strict=True))
        # quaternions are not 0
        at |= {ball["positions"][-4]: at[ball["positions"][-4]] + 1 for ball in self.Y.balls}
        return self._rows(lambda motion: self.regressor(graph, {**at, **motion}), graph.zero, graph.one)

    def _known(self, graph: Graph) -> list[dict[int, Expr]]:
        """Rows of what joints do not move."""
        rows: dict[int, dict[int, Expr]] = {}
        for (r, j), x in replay(self.regrouping, graph, {}, ["relations"])["relations"].entries.items():
            # carriers without mass come after the drives
            rows.setdefault(r, {})[j if j < len(self.Y.names) else j + len(self.pairs)] = graph.lift(x)
        return [rows[r] for r in sorted(rows)]

    def _rows(self, regressor: Callable[[Mapping[str, X]], Mapping[Any, X]], zero: X, one: X) -> list[dict[int, X]]:
        """g^i_ab (a <= b) and G_ai, and one row for each friction."""
        still = {f"{name}{primes}": zero for name in self.Y.coordinates for primes in ("'", "''")}
        static = regressor(still)
        rows: dict[tuple[str, int, int], dict[int, X]] = {}
        for (a, i), x in static.items():
            rows.setdefault(("static", a, a), {})[i] = x
        for b, name in enumerate(self.Y.coordinates):
            for (a, i), x in regressor(still | {f"{name}''": one}).items():
                if a <= b:
                    # g^i_ab = ID_a(q, 0, e_b) - G_ai
                    rows.setdefault(("metric", a, b), {})[i] = x - static.get((a, i), zero)
        kinds = {"armature": "metric", "offset": "static"}
        for i, (kind, a) in self.pairs:
            rows.setdefault((kinds.get(kind, kind), a, a), {})[i] = one
        return list(rows.values())
