"""The mass of bodies and the ranges of coordinates, straight from the text of their definition."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from math import isfinite
from typing import Any

import flint
import numpy as np

from substructures.documents.fields import in_si
from substructures.expr.direct import ball, value
from substructures.expr.syntax import ExpressionError
from substructures.part.definition import Definition
from substructures.part.topology import topology

PRECISION = 128  # bits
UNITS = ("rad", "m")  #: of a revolute and of a prismatic coordinate


def sum_of(masses: Iterable[tuple[Any, Mapping[str, Any]]]) -> float | None:
    """The sum of numbers or expressions in kg, each with the values of its names; the same double on every machine.

    None where a name has no value, and where the sum is no finite number.
    """
    total = ball_sum(masses)
    return None if total is None else rounded(total)


def ball_sum(masses: Iterable[tuple[Any, Mapping[str, Any]]]) -> Any:
    """The same as a ball; None where a name has no value."""
    try:
        # with more bits than a double has, so that neither the order nor the machine shows in the double
        with flint.ctx.workprec(PRECISION):
            return sum((ball(in_si(mass), names, PRECISION) for mass, names in masses), flint.arb(0))
    except (ExpressionError, ArithmeticError, ValueError):
        return None


def rounded(total: Any) -> float | None:
    """A ball as a double; None of one that is not finite."""
    return float(total) if isfinite(float(total)) else None


def mass_at_defaults(definition: Definition) -> float | None:
    """The mass of all bodies in kg; None where that of one depends on a parameter without a value."""
    given = {name: in_si(each.value) for name, each in definition.parameters.items() if each.value is not None}
    names = {name: ball(x, precision=PRECISION) for name, x in given.items()}
    return sum_of((body.mass, names) for body in definition.bodies)


def limits_in_numbers(definition: Definition, names: Mapping[str, Any]) -> dict[str, tuple[Any, Any, str]]:
    """Lowest and highest value, and unit, of coordinates that have limits; those of joints that relations move bound
    the coordinate that moves them. ``names``: values of parameters, numbers or arrays.
    """
    found: dict[str, tuple[Any, Any, str]] = {}
    layout = topology(definition)
    for joint in layout.joints:
        limits = definition.bodies[joint.body].joint.limits
        pair = limits[joint.step] if limits and isinstance(limits[0], tuple) else limits
        low, high = (number_of(x, names) for x in pair or (None, None))
        if low is None or high is None:
            continue
        q, low, high = _of_mover(definition, names, joint.coordinate, low, high)
        known = found.get(q, (-np.inf, np.inf))
        # of all joints that one coordinate moves: each of them stops it
        if joint.coordinate != q or q in found:
            low, high = np.maximum(low, known[0]), np.minimum(high, known[1])
        if np.isfinite(low).any() or np.isfinite(high).any():
            found[q] = low, high, UNITS[layout.joints[layout.movers[layout.coordinates.index(q)]].s]
    return found


def _of_mover(definition: Definition, names: Mapping[str, Any], name: str, low: Any, high: Any) -> tuple[str, Any, Any]:
    """The coordinate that moves a joint, and its range while the joint is between two values."""
    relations = {each.coordinate: each for each in definition.relations}
    while name in relations:
        mu, delta = (number_of(x, names) for x in (relations[name].multiplier, relations[name].offset))
        name = relations[name].of
        if mu is None or delta is None:
            # a factor without a value bounds nothing; the way goes on to the coordinate that moves it
            low, high = -np.inf, np.inf
            continue
        # q = (q^d - delta) / mu, between the smaller and the larger one of the ends; all q where mu is 0
        with np.errstate(all="ignore"):
            ends, moves = [np.true_divide(x - delta, mu) for x in (low, high)], np.not_equal(mu, 0)
        low, high = np.where(moves, np.minimum(*ends), -np.inf)[()], np.where(moves, np.maximum(*ends), np.inf)[()]
    return name, low, high


def number_of(given: Any, names: Mapping[str, Any]) -> Any:
    """The value, None of what is not given or names a parameter without one."""
    try:
        return None if given is None else value(in_si(given), names)
    except ExpressionError:
        return None
