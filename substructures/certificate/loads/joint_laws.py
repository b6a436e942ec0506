"""Forces and energies of what stands in the joints of a definition: springs, dampers, actuators, friction, stops."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

from flint import arb, fmpq

from substructures.certificate.bodies import limits_of, of_step
from substructures.certificate.linear import Ball
from substructures.certificate.loads.forces import Forces, add_to
from substructures.certificate.numbers import Numbers, Plain
from substructures.certificate.relations import mover, multiplier_steps, position_steps
from substructures.certificate.texts import difference, negative, product
from substructures.expr.direct import steps_of


def joint_law(found: Forces, a: int, joint: Plain, step: int) -> None:
    """Q = tau - k (q - rest) - c q',   V = k (q - rest)^2 / 2 where k and rest are no functions of the state."""
    numbers = found.numbers
    name = found.bodies.joints[a].coordinate.rpartition(".")[2]
    given = [of_step(joint.get(x, 0), step) for x in ("stiffness", "rest", "damping")]
    k, rest, c = map(numbers.read, given)
    if found.bodies.joints[a].group:  # of rates there are no positions
        add_to(found.applied, {a: numbers.names[f"tau.{name}"] - c * found.rate(a)})
        return
    stretch = numbers.names[name] - rest
    effort = numbers.names[f"tau.{name}"] if name in found.coordinates else arb(0)
    add_to(found.applied, {a: effort - k * stretch - c * found.rate(a)})
    if found.depends(*given[:2]):
        place = position_steps(found.definition, name)
        law = product(steps_of(given[0]), difference(place, steps_of(given[1])))
        if name not in found.coordinates:
            law = product(multiplier_steps(found.definition, name), law)
        moved_by = found.coordinates[mover(found.definition, name)]
        found.given.setdefault(moved_by, []).append(negative(law))
    else:
        found.potential += k * stretch * stretch * arb(fmpq(1, 2))
        add_to(found.slopes, {a: -k * stretch})
    joint_friction(found, a, of_step(joint.get("friction"), step))
    _stops(found, a, numbers.names[name], of_step(joint.get("limits_act"), step), limits_of(joint, step))


def joint_friction(found: Forces, a: int, law: Plain | None) -> None:
    """Of a joint."""
    if law is not None:
        add_to(found.applied, {a: -friction_force(found.numbers, law, found.rate(a))})


def friction_force(numbers: Numbers, law: Plain, rate: Ball) -> Ball:
    """(F_c + (F_s - F_c) exp(-(q'/v_s)^2)) tanh(q'/v_0)."""
    F = numbers.read(law["coulomb"])
    if law.get("stribeck") is not None:
        ratio, static = rate / numbers.read(law["stribeck"]), law.get("static")
        F += (numbers.read(law["coulomb"] if static is None else static) - F) * (-ratio * ratio).exp()
    return F * (rate / numbers.read(law["velocity"])).tanh()


def _stops(found: Forces, a: int, q: Ball, stop: Plain | None, limits: Sequence[Any] | None) -> None:
    """(k + c p') p against q at the depth p beyond a limit, nothing within; V = k p^2 / 2."""
    if stop is None or limits is None:
        return
    low, high = map(found.numbers.read, limits)
    k, c = (found.numbers.read(stop.get(x, 0)) for x in ("stiffness", "damping"))
    for side, beyond in ((1, q - high), (-1, low - q)):
        p = beyond.max(arb(0))
        # p' = q' beyond the upper limit, -q' beyond the lower one
        add_to(found.applied, {a: -side * (k + c * side * found.rate(a)) * p})
        add_to(found.slopes, {a: -side * k * p})
        found.potential += k * p * p * arb(fmpq(1, 2))
