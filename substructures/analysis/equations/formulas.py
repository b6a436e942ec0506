"""The formulas of a model in one graph, solved for the accelerations and differentiated along the motion."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import replace
from functools import cached_property

from substructures.errors import InvalidDocument
from substructures.expr.differentiate import directional
from substructures.expr.graph import Expr, Graph
from substructures.expr.program import Output, Symbol
from substructures.expr.replay import replay
from substructures.tree.model import Model, require_open

LENGTH = {"R": "rad", "P": "m"}
#: what takes closures
MOTIONS = "use loop states, simulations or velocity equations with constraints of the type 'closure'"
Entries = dict[tuple[int, ...], Expr]


def require_moving(model: Model) -> None:
    """Raises InvalidDocument (``no-coordinates``) for a model in which nothing moves."""
    if not model.dof:
        raise InvalidDocument.at("", "no-coordinates", "the tree has no joint: there is nothing that moves")


def require_tree(model: Model) -> None:
    """Raises InvalidDocument: as :func:`require_moving`, and ``has-closures`` for a model with closed loops."""
    require_moving(model)
    require_open(model.closures, MOTIONS)


def inputs_of(model: Model) -> tuple[str, ...]:
    """All inputs: actuators and inputs of loads, in the order of the program's symbols."""
    return tuple(s.name for s in model.program.symbols if s.kind == "input")


def multipliers_of(model: Model) -> tuple[str, ...]:
    """The symbols of the multipliers of all closures, row by row."""
    return tuple(f"lambda.{rows.name}.{row}" for rows in model.closures for row in rows.rows)


class ModelFormulas:
    """Outputs of a model with all dependent elements; the symbols ``zero`` are put to 0.

    Raises InvalidDocument (``division-by-zero``) when a formula then divides by zero.
    """

    def __init__(self, model: Model, zero: Iterable[str] = ()) -> None:
        self.model, self.graph, self.n = model, Graph(), model.dof
        self.zero = frozenset(zero)
        self.symbols = {symbol.name: symbol for symbol in model.program.symbols}
        for a, name in enumerate(model.coordinates):
            unit = LENGTH[model.joints[a]]
            self.symbols[name] = Symbol(name, "coordinate", unit)
            self.symbols[f"{name}'"] = Symbol(f"{name}'", "velocity", f"{unit}/s")
        self.q = [self.graph.symbol(name) for name in model.coordinates]
        self.rates = [self.graph.symbol(f"{name}'") for name in model.coordinates]
        self._found: dict[str, Entries] = {}

    def elements(self, name: str) -> Entries:
        """All non-zero elements of an output by index."""
        if name not in self._found:
            stored = self.model.program.outputs[name]
            formulas = self._replayed(name)
            values = [formulas[i] for i in stored.index]
            numbered = replace(stored, entries=tuple(range(len(values))))
            signed = ((index, values[k], sign) for index, k, sign in Output.expanded(numbered))
            self._found[name] = {i: x if sign > 0 else -x for i, x, sign in signed if not x.is_zero}
        return self._found[name]

    def _replayed(self, name: str) -> Entries:
        nothing = dict.fromkeys(self.zero, self.graph.zero)
        try:
            found = replay(self.model.program, self.graph, nothing, [name])[name].entries
        except ZeroDivisionError:
            names = ", ".join(f"'{x}'" for x in sorted(self.zero & set(self.model.parameters)))
            raise InvalidDocument.at(
                "/parameters", "division-by-zero", f"a formula divides by zero when these are zero: {names}"
            ) from None
        return {i: x for i, x in found.items() if isinstance(x, Expr)}

    def vector(self, name: str) -> list[Expr]:
        """An output of shape (n,), zeros included."""
        found = self.elements(name)
        return [found.get((a,), self.graph.zero) for a in range(self.n)]

    def scalar(self, name: str) -> Expr:
        """An output without axes."""
        return self.elements(name).get((), self.graph.zero)

    @cached_property
    def factors(self) -> Factors:
        """g = L^T D L."""
        return Factors(self.elements("metric"), self.model.coordinates)

    @cached_property
    def acceleration(self) -> list[Expr]:
        """q''^a from g q'' = Q - Gamma q' q' + G^T lambda. Raises InvalidDocument (``singular-metric``)."""
        forces, bias = self.vector("forces"), self.vector("bias")
        return self.factors.solve([f - b + r for f, b, r in zip(forces, bias, self.reactions, strict=True)])

    @cached_property
    def reactions(self) -> list[Expr]:
        """G^T lambda of closures, with a symbol ``lambda.<closure>.<row>`` [N, N m] for every row; else zeros."""
        result = [self.graph.zero] * self.n
        names = multipliers_of(self.model)
        for name in names:
            unit = "N" if name.rpartition(".")[2] in ("x", "y", "z", "length") else "N m"
            self.symbols[name] = Symbol(name, "input", unit)
        for (k, a), x in self.elements("closure.jacobian").items() if names else ():
            result[a] = result[a] + x * self.graph.symbol(names[k])
        return result

    @cached_property
    def momenta(self) -> list[Expr]:
        """p_a = g_ab q'^b."""
        g = self.elements("metric")
        result = [self.graph.zero] * self.n
        for (a, b), x in sorted(g.items()):
            result[a] = result[a] + x * self.rates[b]
        return result

    @cached_property
    def energy(self) -> Expr:
        """H = T + V."""
        twice = self.graph.sum(p * v for p, v in zip(self.momenta, self.rates, strict=True))
        return twice / 2 + self.scalar("potential_energy")

    @cached_property
    def power(self) -> Expr:
        """H' = Q_a q'^a + V': what forces without potential feed in (T' = Q_a q'^a because g' - 2C is skew)."""
        work = self.graph.sum(f * v for f, v in zip(self.vector("forces"), self.rates, strict=True))
        return work + self.along_motion([self.scalar("potential_energy")])[0]

    def along_motion(self, exprs: Sequence[Expr]) -> list[Expr]:
        """Derivatives with respect to time where q'' does not occur: seeds q' for q, 1 for t."""
        return directional(exprs, self._seeds())

    def rate(self, exprs: Sequence[Expr]) -> list[Expr]:
        """Derivatives with respect to time along the equations of motion."""
        accelerations = {str(v.value): x for v, x in zip(self.rates, self.acceleration, strict=True)}
        return directional(exprs, self._seeds() | accelerations)

    def _seeds(self) -> dict[str, Expr]:
        return {str(x.value): v for x, v in zip(self.q, self.rates, strict=True)} | {"t": self.graph.one}


class Factors:
    """g = L^T D L with unit lower triangular L, eliminated from the leaves: no entry outside the paths fills in.

    R. Featherstone, Efficient factorization of the joint-space inertia matrix for branched kinematic trees, 2005.
    """

    def __init__(self, metric: Mapping[tuple[int, ...], Expr], names: Sequence[str]) -> None:
        n = len(names)
        rows: list[dict[int, Expr]] = [{} for _ in range(n)]
        for (a, b), x in metric.items():
            if b <= a:
                rows[a][b] = x
        self.L: list[dict[int, Expr]] = [{} for _ in range(n)]
        self.D: list[Expr] = []
        self.inverse: list[Expr] = []
        for k in reversed(range(n)):
            row = rows[k]
            pivot = row.pop(k, None)
            if pivot is None or pivot.is_zero:
                message = f"coordinate '{names[k]}' has no inertia: give the bodies that it moves mass or inertia"
                raise InvalidDocument.at("", "singular-metric", message)
            self._eliminate(k, row, pivot, rows)

    def _eliminate(self, k: int, row: dict[int, Expr], pivot: Expr, rows: list[dict[int, Expr]]) -> None:
        inverse = 1 / pivot
        self.D.insert(0, pivot)
        self.inverse.insert(0, inverse)
        for i in sorted(row, reverse=True):
            factor = self.L[k][i] = row[i] * inverse
            for j in sorted(x for x in row if x <= i):
                known = rows[i].get(j)
                product = factor * row[j]
                rows[i][j] = -product if known is None else known - product

    def solve(self, right: Sequence[Expr]) -> list[Expr]:
        """x of g x = right."""
        x = list(right)
        for k in reversed(range(len(x))):
            for i, factor in self.L[k].items():
                x[i] = x[i] - factor * x[k]
        x = [a * b for a, b in zip(x, self.inverse, strict=True)]
        for k, row in enumerate(self.L):
            for i, factor in sorted(row.items()):
                x[k] = x[k] - factor * x[i]
        return x
