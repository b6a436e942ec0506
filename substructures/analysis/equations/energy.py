"""The rule of the energy T + V: constant, falling, or balanced by a power. H' = Q_a q'^a + V', which has no q''."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping, Sequence
from functools import lru_cache
from typing import Literal

import numpy as np

from substructures.analysis.equations.formulas import ModelFormulas
from substructures.expr.calculus.corners import VanishingOnAllSides, corners, inner, on_side
from substructures.expr.differentiate import directional, gradient, in_directions
from substructures.expr.graph import Expr
from substructures.expr.interpret import interpret
from substructures.expr.known import Known
from substructures.expr.program import Program, array, program
from substructures.expr.walk import reachable, transfer
from substructures.quantities.numbers.memo import known_model
from substructures.tree.given.ties import names_of
from substructures.tree.model import Model

#: nearer to a corner of a force than this [rad, m] nothing is told
CORNER = 1e-9

EnergyRule = Literal["constant", "falling", "balance"]


def has_even_dissipation(
    model: Model, at: Mapping[str, float], inputs: Iterable[str] = (), zero: Iterable[str] = ()
) -> bool:
    """Whether near a state of rest the forces have a potential, but for dampers H' = -D_ab q'^a q'^b with one D.

    Then one position says of all near it whether the energy may rise; s^2 s' feeds energy in near s = 0, where D = 0.
    A potential of forces r_a is there where d_b r_a = d_a r_b, in closed form or not. ``at``: values of coordinates,
    parameters and t, which tell on which side of their corners forces are (end stops); on a corner nothing is told.
    ``inputs``: inputs that may have any value, all others are 0; ``zero``: parameters that are 0. Closures do no work.
    """
    given, none = frozenset(inputs), frozenset(zero)
    sides = _sides(_power_corners(known_model(model), given, none), at)
    return sides is not None and _has_even_dissipation(known_model(model), given, none, sides)


def _without(model: Model, given: frozenset[str], zero: frozenset[str]) -> frozenset[str]:
    """The symbols that are 0."""
    return zero | {s.name for s in model.program.symbols if s.kind == "input" and s.name not in given}


@lru_cache(maxsize=32)
def _power_corners(known: Known, given: frozenset[str], zero: frozenset[str]) -> Program:
    """x of every |x| and sign x in the power, in order."""
    f = ModelFormulas(known.source, _without(known.source, given, zero))
    found = [inner(node) for node in corners([f.power])]
    return program(f.graph, {"x": array((len(found),), lambda k: found[k])}, f.symbols)


def _sides(source: Program, at: Mapping[str, float]) -> tuple[int, ...] | None:
    """On which side of each corner a state is; None where it is on one, or where velocities or inputs decide."""
    if any(s.kind not in ("coordinate", "parameter", "time") for s in source.symbols):
        return None
    if not source.outputs["x"].shape[0]:
        return ()
    values = interpret(source, {s.name: at[s.name] for s in source.symbols}, ["x"])["x"]
    return tuple(int(x) for x in np.sign(values)) if (np.abs(values) > CORNER).all() else None


@lru_cache(maxsize=32)
def _has_even_dissipation(known: Known, given: frozenset[str], zero: frozenset[str], sides: tuple[int, ...]) -> bool:
    model: Model = known.source
    f = ModelFormulas(model, _without(model, given, zero))
    vanishes = VanishingOnAllSides(f.graph)
    if depends_on([f.scalar("potential_energy")], given):
        return False
    found = corners([f.power])
    (power,) = on_side([f.power], dict(zip(found, sides, strict=True)))
    at_rest = rest_forces(f, power)
    if at_rest is None or depends_on([power], {"t"}) or not _is_gradient(f, at_rest, vanishes):
        return False
    # what is left of P without r_a q'^a is -D_ab q'^a q'^b, by Euler: dP/dq'^a q'^a = 2 P
    left = power - f.graph.sum(r * v for r, v in zip(at_rest, f.rates, strict=True))
    anywhere = {name: f.graph.symbol(f"d.{name}") for name in model.positions}
    along = {str(v.value): v for v in f.rates}
    return vanishes(directional([left], along)[0] - 2 * left) and vanishes(directional([left], anywhere)[0])


def rest_forces(f: ModelFormulas, power: Expr) -> list[Expr] | None:
    """r_a of P = r_a q'^a + ...: the forces at rest beside those of V; None where there is no derivative."""
    names = [str(v.value) for v in f.rates]
    try:
        return transfer(gradient([power], names)[0], f.graph, dict.fromkeys(names, f.graph.zero))
    except ZeroDivisionError:
        return None


def _is_gradient(f: ModelFormulas, forces: Sequence[Expr], vanishes: Callable[[Expr], bool]) -> bool:
    """Whether d_b r_a = d_a r_b for all pairs of coordinates: then, and only then, r has a potential near any place. Of
    forces on ball joints, whose displacements do not commute, nothing is told.
    """
    on_balls = {name for ball in f.model.balls for name in ball["velocities"]}
    if any(name in on_balls and not x.is_zero for name, x in zip(f.model.coordinates, forces, strict=True)):
        return False
    slopes = in_directions(forces, f.displacements) if any(not x.is_zero for x in forces) else []
    pairs = ((a, b) for a in range(len(slopes)) for b in range(a))
    return all(vanishes(slopes[a][b] - slopes[b][a]) for a, b in pairs)


def judged_energy(
    f: ModelFormulas, vanishes: VanishingOnAllSides, given: frozenset[str]
) -> tuple[EnergyRule, str] | None:
    """The rule of the energy and the reason; None where an input that varies is part of V."""
    if depends_on([f.scalar("potential_energy")], given) or not f.is_scleronomic:
        return None
    idle = f"; {constraints_in(f.model)} do no work" if f.multipliers else ""
    if f.model.ignored:
        idle = "; the kinetic energy of all coordinates, T_2 - T_0, and V"
    if f.model.driven:
        idle = "; Jacobi's T_2 - T_0 + V, relative to the given motions"
    rule = rule_of(f, f.power, vanishes)
    if rule == "constant":
        return rule, f"all forces have a potential that does not depend on time: Q_a q'^a + V' = 0{idle}"
    if rule == "falling":
        return rule, f"forces without potential are linear in the velocities: it falls where they damp{idle}"
    culprits = "the given motions and of forces without potential" if f.model.driven else _culprits(f, vanishes)
    return rule, f"it changes by the power of {culprits}{idle}"


def rule_of(f: ModelFormulas, power: Expr, vanishes: Callable[[Expr], bool]) -> EnergyRule:
    """What becomes of an energy that changes by a power."""
    # P = Q_a q'^a + V' is the zero formula
    if vanishes(power):
        return "constant"
    # P(q, s q') = s^2 P(q, q'), by Euler: dP/dq'^a q'^a = 2 P
    twice = directional([power], {str(v.value): v for v in f.rates})[0]
    return "falling" if vanishes(twice - 2 * power) and not depends_on([power], {"t"}) else "balance"


def _culprits(f: ModelFormulas, vanishes: Callable[[Expr], bool]) -> str:
    """What the power is that of, in words."""
    at_rest = rest_forces(f, f.power)
    if at_rest is None or all(vanishes(x) for x in at_rest):
        return "the forces without potential"
    names = ", ".join(f"'{name}'" for name, x in zip(f.model.coordinates, at_rest, strict=True) if not vanishes(x))
    if depends_on(at_rest, {"t"}) or not _is_gradient(f, at_rest, vanishes):
        return f"the forces without potential, at rest those on {names}"
    return f"forces that are not in V: those on {names} have a potential, but none in closed form was found"


def constraints_in(model: Model) -> str:
    """All closures and velocity constraints by name, as part of a sentence."""
    closures = "the closures " + ", ".join(f"'{rows.name}'" for rows in model.closures)
    others = "the velocity constraints " + ", ".join(f"'{name}'" for name in names_of(model.velocity_constraints))
    return " and ".join([closures] * bool(model.closures) + [others] * bool(model.velocity_constraints))


def depends_on(exprs: Sequence[Expr], names: Iterable[str]) -> bool:
    """Whether one of the symbols occurs."""
    wanted = frozenset(names)
    return any(node.op == "sym" and str(node.value) in wanted for node in reachable(exprs))
