"""Where a quantity turns within a step: between such times it passes a level at most once.

A function of the time is interpolated in Chebyshev's points, in halves of the step where that is not close, and the
interpolating polynomials say where it turns (J. P. Boyd, Computing zeros on a real interval through Chebyshev expansion
and polynomial rootfinding, SIAM J. Numer. Anal. 40, 2002).
"""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
from numpy.polynomial import chebyshev

from substructures.array import Array

Function = Callable[[Array], list[float]]

DEGREE = 8
#: Chebyshev's points of the second kind in [-1, 1], and what makes coefficients of values in them
POINTS = -np.cos(np.pi * np.arange(DEGREE + 1) / DEGREE)
TO_COEFFICIENTS = np.linalg.inv(chebyshev.chebvander(POINTS, DEGREE))
#: an expansion whose last coefficients are below this part of the sum of all is close
CLOSE = 1e-3
#: of values that are equal up to rounding
EQUAL = 1e-13
#: so many times a step is halved at most
HALVINGS = 8


def turns(g: Function, a: float, b: float, ends: tuple[float, float], level: float) -> list[tuple[float, float]]:
    """Times in (a, b), in order, at which g turns, and g there, as far as g may be zero near them.

    ``g``: of several times, a quantity less ``level``; ``ends``: its values at a and b. What turns twice within b - a
    over 2^HALVINGS may be missed.
    """
    found: list[tuple[float, float]] = []
    pieces = [(a, b, *ends, 0)]
    while pieces:
        start, end, first, last, halved = pieces.pop()
        times = (start + end) / 2 + (end - start) / 2 * POINTS
        values = np.array([first, *g(times[1:-1]), last])
        # g = sum c_k T_k, |T_k| <= 1
        c = TO_COEFFICIENTS @ values
        spread = float(np.abs(c[1:]).sum())
        least = EQUAL * (abs(level) + float(np.abs(values).max()))
        is_close = float(np.abs(c[-2:]).max()) <= max(CLOSE * spread, least)
        # far from a close expansion the sum of its coefficients says less
        if not np.isfinite(spread) or abs(float(c[0])) > (1 if is_close else 4) * spread:
            continue
        if is_close or halved == HALVINGS:
            roots = _real_roots(chebyshev.chebder(c))
            at = (start + end) / 2 + (end - start) / 2 * roots
            found += zip(at.tolist(), chebyshev.chebval(roots, c).tolist(), strict=True)
        else:
            middle, value = float(times[DEGREE // 2]), float(values[DEGREE // 2])
            found.append((middle, value))
            pieces += [(start, middle, first, value, halved + 1), (middle, end, value, last, halved + 1)]
    return sorted((t, x) for t, x in found if a < t < b)


def _real_roots(c: Array) -> Array:
    """The real roots in (-1, 1) of a series in Chebyshev polynomials; double ones too, which rounding takes apart."""
    size = float(np.abs(c).max())
    roots = chebyshev.chebroots(chebyshev.chebtrim(c, EQUAL * size)) if size else np.zeros(0)
    some = roots.real[(np.abs(roots.imag) < np.sqrt(EQUAL)) & (np.abs(roots.real) < 1)]
    return np.asarray(some, dtype=np.float64)
