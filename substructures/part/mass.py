"""The mass of bodies, what no body can have, and ranges of coordinates, straight from the text of their definition."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping, Sequence
from math import isfinite
from typing import Any

import flint
import numpy as np
from numpy.typing import NDArray

from substructures.array import Array
from substructures.documents.fields import in_si
from substructures.expr.direct import ball, value
from substructures.expr.syntax import ExpressionError
from substructures.part.definition import Body, Definition
from substructures.part.topology import CHAINS, topology

PRECISION = 128  # bits
#: an eigenvalue of Binet's tensor may be so much below zero, relative to the largest
ROUNDING = 1e-9
Indices = NDArray[np.intp]
#: m, h and Theta of a body for every set of values, (10, N); m = 0 where Theta is about the mass centre
Tensor = NDArray[Any]
UNITS = ("rad", "m")  #: of a revolute and of a prismatic coordinate
ARMATURE = ("kg m^2", "kg")  #: units of the rotor inertia that is seen at such a joint


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


def more(count: int) -> str:
    """Beside the first of so many."""
    return f" (and in {count - 1} more)" if count > 1 else ""


def faults_of(body: Body, names: Mapping[str, Any], first: int) -> tuple[list[tuple[str, str]], Tensor | None]:
    """Code and message of what a body cannot have, and its inertia where that is to be looked at, too: numbers alone
    were, when formulas were derived.
    """
    tensor = body.inertia
    inertia = [getattr(tensor, e) for e in ("xx", "yy", "zz", "xy", "xz", "yz")]
    armature, kinds, found = body.joint.armature, [s for s, _ in CHAINS[body.joint.type]], list[tuple[str, str]]()
    rotors = armature if isinstance(armature, tuple) else [armature] * len(kinds)
    for given, s in dict.fromkeys((x, s) for x, s in zip(rotors, kinds, strict=True) if isinstance(x, str)):
        found += _negative("armature", number_of(given, names), ARMATURE[s], first)
    if not any(isinstance(x, str) for x in (body.mass, *body.com, *inertia)):
        return found, None
    # most are names of floats, which need not be read; other numbers become floats
    entries = (body.mass, *body.com, *inertia)
    known = [names.get(x) if type(x) is str else None for x in entries]
    numbers = [k if isinstance(k, float) else number_of(x, names) for k, x in zip(known, entries, strict=True)]
    if isinstance(body.mass, str):
        found += _negative("mass", numbers[0], "kg", first)
    if any(x is None for x in numbers):
        return found, None
    is_one = all(isinstance(x, float) for x in numbers)
    together = np.array(numbers if is_one else np.broadcast_arrays(*numbers)).reshape(10, -1)
    if tensor.about != "origin":
        together[0] = 0
    return found, together


def _negative(what: str, given: Any, unit: str, first: int) -> Iterator[tuple[str, str]]:
    if given is None:
        return
    if isinstance(given, float) and given >= 0:
        return
    found = np.atleast_1d(given)
    bad = np.flatnonzero(~(found >= 0))
    if len(bad):
        is_what = "is negative" if found[bad[0]] < 0 else "is not a number"
        yield f"negative-{what}", f"the {what} {found[bad[0]]:g} {unit} {is_what}{_place(found, bad, first)}"


def _place(found: Array, bad: Indices, first: int) -> str:
    return f", in state {first + bad[0]}{more(len(bad))}" if len(found) > 1 else ""


def impossible(tensors: Sequence[Tensor], first: int) -> Iterator[list[tuple[str, str]]]:
    """Of every tensor: about the mass centre it must have principal moments that obey the triangle inequality."""
    if not tensors:
        return
    # all bodies at all values together: one call for the eigenvalues of many small matrices
    m, x, y, z, xx, yy, zz, xy, xz, yz = np.concatenate(tensors, axis=1)
    # what overflows is told below
    with np.errstate(all="ignore"):
        # J = tr(Theta)/2 1 - Theta has no negative eigenvalue;   about another point J_C = J - m h h^T
        half, h = (xx + yy + zz) / 2, (x, y, z)
        J = np.array([[half - xx, -xy, -xz], [-xy, half - yy, -yz], [-xz, -yz, half - zz]])
        J = np.moveaxis(J - m * np.array([[a * b for b in h] for a in h]), -1, 0)
    finite = np.isfinite(J).all(axis=(1, 2))
    values = np.linalg.eigvalsh(np.where(finite[:, None, None], J, 0.0))
    is_bad = ~finite | (values[:, 0] < -ROUNDING * np.abs(values).max(axis=1))
    end = 0
    for tensor in tensors:
        start, end = end, end + tensor.shape[1]
        yield list(_told(values[start:end], np.flatnonzero(is_bad[start:end]), first))


def _told(eigenvalues: Array, bad: Indices, first: int) -> Iterator[tuple[str, str]]:
    if len(bad):
        shown = ", ".join(f"{x:.6g}" for x in np.sort(eigenvalues[bad[0]].sum() - eigenvalues[bad[0]]))
        message = f"no rigid body has the principal moments of inertia {shown} kg m^2 about its mass centre"
        yield "impossible-inertia", f"{message} (triangle inequality){_place(eigenvalues, bad, first)}"
