"""The workspace of analyses: a model solved for the accelerations and differentiated along the motion."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from functools import cached_property
from typing import Any

import numpy as np

from substructures.analysis.equations.elimination import MetricElimination
from substructures.errors import InvalidDocument
from substructures.expr.calculus.corners import between_corners
from substructures.expr.differentiate import directional, in_directions
from substructures.expr.graph import Expr
from substructures.expr.program import Entries, Symbol
from substructures.mechanics.balls import displacement_rates
from substructures.quantities.numbers.workspace import Workspace
from substructures.tree.cuts import require_open
from substructures.tree.given.ties import require_untied
from substructures.tree.model import Model

#: what takes closures
MOTIONS = "use loop states, simulations or velocity equations with constraints of the type 'closure'"


def require_moving(model: Model, what: str = "linearisations") -> None:
    """Raises InvalidDocument (``no-coordinates``) for a model in which nothing moves, and
    (``has-velocity-constraints``) where ``what`` would ignore those of the tree.
    """
    require_untied(model, what)
    if not model.dof:
        why = "all coordinates are given" if model.given else "the tree has no joint"
        raise InvalidDocument.at("", "no-coordinates", f"{why}: there is nothing that moves")


def require_tree(model: Model, what: str = "this analysis") -> None:
    """Raises InvalidDocument: as :func:`require_moving`, and ``has-closures`` for a model with closed loops."""
    require_moving(model, what)
    require_open(model.closures, MOTIONS)


def unsteady(model: Model, inputs: Mapping[str, Any]) -> str:
    """Why nothing can rest relative to the drives of a model, by its formulas and the values of ``inputs``; else
    nothing. Formulas without given motions are taken at the time that is said.
    """
    if not model.driven:
        return ""
    used = {symbol.name for symbol in model.program.select(["metric", "bias", "forces"]).symbols}
    if "t" in used:
        return "the given motions make the equations depend on the time"
    for name in (f"{name}{primes}" for name in model.driven for primes in ("", "'")):
        if name in used and name in model.inputs and np.any(np.asarray(inputs.get(f"{name}'", 0))):
            return f"the equations depend on '{name}', which changes: the input '{name}'' is not 0"
    return ""


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
    def position_rates(self) -> dict[str, Expr]:
        """By what a state q consists of: q', of ball joints p' = R v and Q' = 1/2 Q (0, w)."""
        return self.moved(self.rates)

    @cached_property
    def displacement_rates(self) -> Entries:
        """R of d' = dv + R d for displacements d of a state q: 0 but for ball joints."""
        places, result = {name: a for a, name in enumerate(self.model.coordinates)}, Entries()
        for ball in self.model.balls:
            at = [places[name] for name in ball["velocities"]]
            found = displacement_rates([self.rates[a] for a in at])
            result |= {(at[i], at[k]): self.graph.lift(x) for (i, k), x in found.items()}
        return result

    @cached_property
    def metric_slopes(self) -> dict[tuple[int, int, int], Expr]:
        """d_c g_ab at (a, b, c), a <= b; of ball joints, in whose rates dT/dv^c moves with the body, what stands for it
        in p_c' = 1/2 d_c g_ab v^a v^b + Q_c.
        """
        gamma, zero = self.elements("christoffel"), self.graph.zero
        if not self.model.balls:
            # Gamma_abc + Gamma_bac
            pairs = ((index, x + gamma.get((index[1], index[0], index[2]), zero)) for index, x in gamma.items())
            return {(min(a, b), max(a, b), c): x for (a, b, c), x in pairs}
        g = self.elements("metric")
        moved = dict(zip(g, in_directions(list(g.values()), self.displacements), strict=True))
        none, n = [zero] * self.n, range(self.n)
        # d_a g_cb + d_b g_ca - 2 Gamma~_cab
        found = {
            (a, b, c): moved.get((c, b), none)[a] + moved.get((c, a), none)[b] - 2 * gamma.get((c, a, b), zero)
            for a in n
            for b in range(a, self.n)
            for c in n
        }
        return {index: x for index, x in found.items() if not x.is_zero}

    def at_zero(self, names: Iterable[str]) -> dict[str, Expr]:
        """0 for these symbols, but for quaternions, which turn nothing."""
        turning = {ball["positions"][-4] for ball in self.model.balls}
        return {name: self.graph.one if name in turning else self.graph.zero for name in names}

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
    def multipliers(self) -> tuple[str, ...]:
        """The symbols of those of the rows that hold the motion, of closures."""
        return multipliers_of(self.model)

    @cached_property
    def constraint_rows(self) -> Mapping[tuple[int, ...], Expr]:
        """G_ka of these rows."""
        return self.elements("closure.jacobian") if self.multipliers else {}

    @cached_property
    def is_scleronomic(self) -> bool:
        """Whether these rows do no work: closures that move with drives do."""
        return not (self.model.driven and self.model.closures)

    @cached_property
    def reactions(self) -> list[Expr]:
        """G^T lambda of closures, with a symbol ``lambda.<closure>.<row>`` [N, N m] for every row; else zeros."""
        result = [self.graph.zero] * self.n
        names = self.multipliers
        for name in names:
            unit = "N" if name.rpartition(".")[2] in ("x", "y", "z", "length") else "N m"
            self.symbols[name] = Symbol(name, "input", unit)
        for (k, a), x in self.constraint_rows.items():
            result[a] = result[a] + x * self.graph.symbol(names[k])
        return result

    @cached_property
    def momenta(self) -> list[Expr]:
        """p_a = dT/dq'^a: g_ab q'^b, and g_a0 of given motions."""
        g, mixed = self.elements("metric"), self.elements("g_a0") if self.model.given else {}
        result = [self.graph.zero] * self.n
        for (a, b), x in sorted(g.items()):
            result[a] = result[a] + x * self.rates[b]
        return [p + mixed.get((a,), 0) for a, p in enumerate(result)]

    @cached_property
    def drives(self) -> list[Expr]:
        """g_a0 that are not zero, and g_00; none without given motions."""
        return [*self.elements("g_a0").values(), self.scalar("g_00")] if self.model.given else []

    @cached_property
    def energy(self) -> Expr:
        """H = T + V; of given motions Jacobi's T_2 - T_0 + V."""
        if self.model.given:
            return self.scalar("T_2") - self.scalar("T_0") + self.scalar("potential_energy")
        twice = self.graph.sum(p * v for p, v in zip(self.momenta, self.rates, strict=True))
        return twice / 2 + self.scalar("potential_energy")

    @cached_property
    def power(self) -> Expr:
        """H' = Q_a q'^a + V': what forces without potential feed in (T' = Q_a q'^a because g' - 2C is skew); of given
        motions H' = Q_a q'^a + V' - d_t T.
        """
        work = self.graph.sum(f * v for f, v in zip(self.vector("forces"), self.rates, strict=True))
        potential = self.scalar("potential_energy")
        if not self.model.driven:
            return work + self.along_motion([potential])[0]
        kinetic = self.graph.sum(self.scalar(name) for name in ("T_2", "T_1", "T_0"))

        def rates(smooth: list[Expr]) -> list[Expr]:
            """V' and d_t T."""
            return [*self.along_motion(smooth[:1]), *directional(smooth[1:], self.time)]

        # where pieces of tables meet, their derivatives as formulas are 0/0
        change, explicit = between_corners([potential, kinetic], rates)
        return work + change - explicit

    def along_motion(self, exprs: Sequence[Expr]) -> list[Expr]:
        """Derivatives with respect to time where q'' does not occur: seeds q' for q, 1 for t."""
        return directional(exprs, self._seeds())

    def rate(self, exprs: Sequence[Expr]) -> list[Expr]:
        """Derivatives with respect to time along the equations of motion."""
        accelerations = {str(v.value): x for v, x in zip(self.rates, self.acceleration, strict=True)}
        return directional(exprs, self._seeds() | accelerations)

    def _seeds(self) -> dict[str, Expr]:
        return self.position_rates | self.time
