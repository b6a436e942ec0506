"""The workspace of analyses: a model solved for the accelerations and differentiated along the motion."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from functools import cached_property

from substructures.analysis.equations.elimination import MetricElimination
from substructures.errors import InvalidDocument
from substructures.expr.differentiate import directional
from substructures.expr.graph import Expr
from substructures.expr.program import Symbol
from substructures.quantities.numbers.workspace import Workspace
from substructures.tree.model import Model, require_open

#: what takes closures
MOTIONS = "use loop states, simulations or velocity equations with constraints of the type 'closure'"


def require_moving(model: Model) -> None:
    """Raises InvalidDocument (``no-coordinates``) for a model in which nothing moves."""
    if not model.dof:
        raise InvalidDocument.at("", "no-coordinates", "the tree has no joint: there is nothing that moves")


def require_tree(model: Model) -> None:
    """Raises InvalidDocument: as :func:`require_moving`, and ``has-closures`` for a model with closed loops."""
    require_moving(model)
    require_open(model.closures, MOTIONS)


def inputs_of(model: Model) -> tuple[str, ...]:
    """All inputs: actuators and inputs of loads, in the order of the program's symbols; then those without effect."""
    return model.input_names


def multipliers_of(model: Model) -> tuple[str, ...]:
    """The symbols of the multipliers of all closures, row by row."""
    return tuple(f"lambda.{rows.name}.{row}" for rows in model.closures for row in rows.rows)


class ModelFormulas(Workspace):
    """A model solved for the accelerations, and differentiated along the motion; the symbols ``zero`` are put to 0.

    Raises InvalidDocument (``division-by-zero``) when a formula then divides by zero.
    """

    def __init__(self, model: Model, zero: Iterable[str] = ()) -> None:
        super().__init__(model, zero)
        self.q = [self.graph.symbol(name) for name in model.coordinates]
        self.rates = [self.velocity_symbol(a) for a in range(self.n)]

    @cached_property
    def factors(self) -> MetricElimination:
        """g = L^T D L."""
        return MetricElimination(self.elements("metric"), self.model.coordinates)

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
