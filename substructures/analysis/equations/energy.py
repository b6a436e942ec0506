"""The rule of the energy T + V: constant, falling, or balanced by a power. H' = Q_a q'^a + V', which has no q''."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from functools import lru_cache
from typing import Literal

from substructures.analysis.equations.formulas import ModelFormulas
from substructures.analysis.equations.kernels import Known, known_model
from substructures.expr.differentiate import directional
from substructures.expr.graph import Expr
from substructures.expr.vanish import Vanishing
from substructures.expr.walk import reachable
from substructures.tree.model import Model

EnergyRule = Literal["constant", "falling", "balance"]


def has_even_dissipation(model: Model, inputs: Iterable[str] = (), zero: Iterable[str] = ()) -> bool:
    """Whether H' = -D_ab q'^a q'^b with the same D in all positions (0 where all forces have a potential).

    Then one position says of all whether the energy may rise; s^2 s' feeds energy in near s = 0, where D = 0.
    ``inputs``: inputs that may have any value, all others are 0; ``zero``: parameters that are 0. Closures do no work.
    """
    return _has_even_dissipation(known_model(model), frozenset(inputs), frozenset(zero))


@lru_cache(maxsize=32)
def _has_even_dissipation(known: Known, given: frozenset[str], zero: frozenset[str]) -> bool:
    unused = {s.name for s in known.source.program.symbols if s.kind == "input" and s.name not in given}
    f = ModelFormulas(known.source, unused | zero)
    vanishes = Vanishing(f.graph)
    found = judged_energy(f, vanishes, given)
    if found is None or found[0] == "balance":
        return False
    anywhere = {str(q.value): f.graph.symbol(f"d.{q.value}") for q in f.q}
    return vanishes(directional([f.power], anywhere)[0]) is True


def judged_energy(f: ModelFormulas, vanishes: Vanishing, given: frozenset[str]) -> tuple[EnergyRule, str] | None:
    """The rule of the energy and the reason; None where an input that varies is part of V."""
    if depends_on([f.scalar("potential_energy")], given):
        return None
    power, rates = f.power, {str(v.value): v for v in f.rates}
    idle = f"; {closures_of(f.model)} do no work" if f.model.closures else ""
    # P = Q_a q'^a + V' is the zero formula
    if vanishes(power):
        return "constant", f"all forces have a potential that does not depend on time: Q_a q'^a + V' = 0{idle}"
    # P(q, s q') = s^2 P(q, q'), by Euler: dP/dq'^a q'^a = 2 P
    twice = directional([power], rates)[0]
    if vanishes(twice - 2 * power) and not depends_on([power], {"t"}):
        return "falling", f"forces without potential are linear in the velocities: it falls where they damp{idle}"
    return "balance", f"it changes by the power of the forces without potential{idle}"


def closures_of(model: Model) -> str:
    """All closures by name, as part of a sentence."""
    return "the closures " + ", ".join(f"'{rows.name}'" for rows in model.closures)


def depends_on(exprs: Sequence[Expr], names: Iterable[str]) -> bool:
    """Whether one of the symbols occurs."""
    wanted = frozenset(names)
    return any(node.op == "sym" and str(node.value) in wanted for node in reachable(exprs))
