"""Kinks and poles of given motions: where a motion or its velocity jumps, or has no finite value, the force of its
actuator would have to be infinite.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from itertools import pairwise
from typing import Any

import numpy as np
import scipy

from substructures.array import Array
from substructures.errors import InvalidArgument

#: a jump is more than this part of the greatest change or velocity
JUMP = 1e-6
#: how near to a kink both of its sides are looked at, as a part of the time
BESIDE = 1e-12
#: times at which signs are looked at
LOOKS = 2001
#: a motion has a pole where it is more than this many times what it is elsewhere, so near to it
POLE = 1e3

#: columns (K, k) at times (K,)
Columns = Callable[[Array], Array]


def require_smooth_table(curve: Any, span: tuple[float, float], pointer: str, unit: str) -> Any:
    """The part of a piecewise polynomial (scipy.interpolate.PPoly, in ``unit``) that a span needs.

    Raises InvalidArgument (``kink``) where it or its slope jumps there.
    """
    start, end = span
    slope = curve.derivative()
    sizes = JUMP * np.array([np.ptp(curve(curve.x)), np.abs(slope(curve.x)).max()])
    for k, t in enumerate(curve.x[1:-1].tolist()):
        if start < t < end or start == t == end:
            before = [np.polyval(each.c[:, k], t - curve.x[k]) for each in (curve, slope)]
            _require(t, np.array(before), np.array([curve(t), slope(t)]), sizes, f"{pointer}/interpolation", unit)
    first = int(np.searchsorted(curve.x[1:-1], start, side="right"))
    last = max(first, int(np.searchsorted(curve.x[1:-1], end, side="left")))
    return scipy.interpolate.PPoly(curve.c[:, first : last + 1], curve.x[first : last + 2])


def require_smooth(motion: Columns, places: Columns, span: tuple[float, float], pointer: str, unit: str) -> None:
    """Raises InvalidArgument (``kink``) where a motion or its velocity jumps within the span or at its ends.

    ``motion``: s, s', s'' [``unit``; s]; ``places``: what changes sign where there may be a kink.
    """
    start, end = span
    h = BESIDE * max(1.0, abs(start), abs(end))
    times = np.linspace(start - h, end + h, LOOKS if end > start else 3)
    # a single time says nothing of how large the motion is
    around = times if end > start else np.linspace(start - h / BESIDE, start + h / BESIDE, LOOKS)
    changes = np.abs(motion(around) - [motion(around[:1])[0, 0], 0, 0])
    greatest = np.where(np.isfinite(changes), changes, 0).max(axis=0)
    for a, b in _changes(places, times, h):
        before, after = motion(np.array([a, b]))[:, :2]
        # what is more than a smooth motion changes by
        t = (a + b) / 2
        _require(
            t if abs(t) > 4 * h else 0.0, before, after, JUMP * greatest[:2] + 4 * (b - a) * greatest[1:], pointer, unit
        )


def require_finite(motion: Columns, divisors: Columns, span: tuple[float, float], pointer: str) -> None:
    """Raises InvalidArgument (``not-finite``) where a motion or its velocity has no finite value within the span.

    ``motion``: s, s', s'' at times; ``divisors``: what it is divided by, which changes its sign at a pole.
    """
    start, end = span
    h = BESIDE * max(1.0, abs(start), abs(end))
    times = np.linspace(start, end, LOOKS if end > start else 1)
    values = motion(times)[:, :2]
    is_finite = np.isfinite(values).all(axis=1)
    most = POLE * np.abs(values[is_finite]).max(axis=0, initial=0)
    nowhere = [(max(start, t - h), min(end, t + h)) for t in times[~is_finite].tolist()]
    for a, b in sorted([*nowhere, *_changes(divisors, times, h)]):
        # 0/0 at one time alone, but for the ends, has a limit
        t = (a + b) / 2
        t = t if abs(t) > 4 * h else 0.0
        if not (np.abs(motion(np.array([a, b]))[:, :2]) <= most).all():
            message = (
                f"the given motion has no finite value at t = {t:.6g} s: leave it out of the span, or give "
                "a motion that is finite all the time"
            )
            raise InvalidArgument.at(pointer, "not-finite", message)


def _changes(places: Columns, times: Array, h: float) -> Iterator[tuple[float, float]]:
    """Times less than 4 h apart between which a place changes its sign."""
    signs = np.sign(places(times))
    for k in range(signs.shape[1]):
        there = np.flatnonzero(np.abs(signs[:, k]) == 1)
        for i, j in pairwise(there.tolist()):
            if signs[i, k] != signs[j, k]:
                a, b = float(times[i]), float(times[j])
                while b - a > 4 * h:
                    middle = (a + b) / 2
                    sign = float(np.sign(places(np.array([middle]))[0, k]))
                    # the place itself has no side
                    a, b = (middle - h, middle + h) if not sign else (middle, b) if sign == signs[i, k] else (a, middle)
                yield a, b


def _require(t: float, before: Array, after: Array, allowed: Array, pointer: str, unit: str) -> None:
    """``before``, ``after``: value and velocity on both sides of t."""
    named = ("it", unit), ("its velocity", f"{unit}/s")
    for (what, unit_of), a, b, most in zip(named, before, after, allowed, strict=True):
        if abs(b - a) > most:
            message = (
                f"the given motion has a kink at t = {t:.6g} s: {what} jumps from {a:.6g} to {b:.6g} {unit_of}, which "
                "takes an infinite force; round it, as tables are whose 'interpolation' is 'cubic' or 'quintic' (or is "
                "not given), or end the span there and begin anew with the state and the motion after it"
            )
            raise InvalidArgument.at(pointer, "kink", message)
