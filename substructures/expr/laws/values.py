"""Functions of force laws straight from what they mean, by cases: in floating point, in balls, and in the power series
of balls, of which the first three coefficients are right. Nothing here is made of formulas.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from fractions import Fraction
from functools import lru_cache
from typing import Any

import numpy as np
from flint import arb, arb_series, fmpq, fmpq_mat

from substructures.expr.rationals import fraction, to_fmpq
from substructures.expr.steps import Knots

UNKNOWN = arb("nan")
#: a function with its partial derivatives, and with the second ones row by row, where these are not all 0
Parted = tuple[Any, Sequence[Any]] | tuple[Any, Sequence[Any], Sequence[Sequence[Any]]]


def _power_of_floats(x: Any, y: Any) -> Any:
    """x^y; NaN where x < 0."""
    return np.where(np.asarray(x) < 0, np.nan, np.power(np.abs(x), y))


def _step_of_floats(x: Any, start: Any, width: Any) -> Any:
    u = np.clip((x - start) / width + 0.5, 0, 1)
    return u**3 * (10 - 15 * u + 6 * u**2)


def _table_of_floats(knots: Knots, x: Any) -> Any:
    values = np.vectorize(lambda given: float(_in_table(knots, _exact(given))[0].mid()), otypes=[float])
    return values(x)


def _exact(x: float) -> Any:
    return arb(x)


def _abs(x: Any) -> Parted:
    return abs(x), [x.sgn()]


def _sign(x: Any) -> Parted:
    return x.sgn(), [arb(0) if not x.contains(0) else UNKNOWN]


def _tanh(x: Any) -> Parted:
    y = x.tanh()
    return y, [1 - y * y], [[-2 * y * (1 - y * y)]]


def _max(a: Any, b: Any) -> Parted:
    """The derivative is that of the larger one, at a corner half of both."""
    share = ((a - b).sgn() + 1) / 2
    return a.max(b), [share, 1 - share]


def _min(a: Any, b: Any) -> Parted:
    share = ((b - a).sgn() + 1) / 2
    return a.min(b), [share, 1 - share]


def _atan2(y: Any, x: Any) -> Parted:
    square = x * x + y * y
    bend, mixed = 2 * x * y / (square * square), (y * y - x * x) / (square * square)
    return arb.atan2(y, x), [x / square, -y / square], [[-bend, mixed], [mixed, bend]]


def _step(x: Any, start: Any, width: Any) -> Parted:
    u = (x - start) / width + arb(fmpq(1, 2))
    if u < 0 or u > 1:
        return (arb(0) if u < 0 else arb(1)), [arb(0)] * 3
    slope, bend = 30 * u * u * (1 - u) * (1 - u), 60 * u * (1 - u) * (1 - 2 * u)
    value = u * u * u * (10 - 15 * u + 6 * u * u)
    if not (u >= 0 and u <= 1):
        return UNKNOWN, [UNKNOWN] * 3
    # u by x, start and width, and its second derivatives by these
    at, square = (x - start) / (width * width), width * width
    du = [1 / width, -1 / width, -at]
    ddu = [[0, 0, -1 / square], [0, 0, 1 / square], [-1 / square, 1 / square, 2 * at / width]]
    seconds = [[bend * du[i] * du[j] + slope * ddu[i][j] for j in range(3)] for i in range(3)]
    return value, [slope * each for each in du], seconds


def _power(x: Any, y: Any) -> Parted:
    """exp(y log x)."""
    if x == 0 and y > 0:
        return arb(0), [UNKNOWN, UNKNOWN]
    value = x**y if x > 0 else UNKNOWN
    log = x.log()
    mixed = value / x * (1 + y * log)
    return value, [y * value / x, value * log], [[y * (y - 1) * value / (x * x), mixed], [mixed, value * log * log]]


def _in_table(knots: Knots, x: Any) -> Parted:
    """Of the interval in which x is; at a knot the value is that of both, the derivative that of the one before."""
    places = [_ball(each) for each in knots.x]
    if x <= places[0] or x >= places[-1]:
        return _ball(knots.y[0] if x <= places[0] else knots.y[-1]), [arb(0)]
    k = next((k for k in range(len(places) - 1) if x >= places[k] and x <= places[k + 1]), None)
    if k is None:
        return UNKNOWN, [UNKNOWN]
    h, rise = knots.x[k + 1] - knots.x[k], knots.y[k + 1] - knots.y[k]
    u = (x - places[k]) / _ball(h)
    if knots.kind == "linear":
        return _ball(knots.y[k]) + _ball(rise) * u, [_ball(rise / h)]
    # Hermite's cubic in its basis
    slopes = _spline(knots) if knots.kind == "smooth" else _pchip(knots)
    s, r = (_ball(slope * h) for slope in slopes[k : k + 2])
    a, b = _ball(knots.y[k]), _ball(knots.y[k + 1])
    one = 1 - u
    value = a * one * one * (1 + 2 * u) + b * u * u * (3 - 2 * u) + s * u * one * one - r * u * u * one
    slope = 6 * u * one * (b - a) + s * one * (1 - 3 * u) - r * u * (2 - 3 * u)
    bend = 6 * (1 - 2 * u) * (b - a) + s * (6 * u - 4) + r * (6 * u - 2)
    return value, [slope / _ball(h)], [[bend / _ball(h * h)]]


def _pchip(knots: Knots) -> list[Fraction]:
    """Slopes at the knots: between intervals of one direction the harmonic mean with the weights of Fritsch and Butland
    (1984), else 0; at the ends the parabola's, if it has the direction of the first interval, at most three times it.
    """
    x, y, last = knots.x, knots.y, len(knots.x) - 1
    chord = [Fraction(y[k + 1] - y[k], x[k + 1] - x[k]) for k in range(last)]
    if last == 1:
        return chord * 2
    found = [Fraction(0)] * (last + 1)
    for k in range(1, last):
        left, right = chord[k - 1], chord[k]
        if left * right > 0:
            alpha = (1 + (x[k + 1] - x[k]) / (x[k + 1] - x[k - 1])) / 3
            found[k] = left * right / (alpha * right + (1 - alpha) * left)
    for end, one, two in ((0, 0, 1), (last, last - 1, last - 2)):
        h, g = x[one + 1] - x[one], x[two + 1] - x[two]
        slope = chord[one] + (chord[one] - chord[two]) * h / (h + g)
        if slope * chord[one] > 0:
            bound = chord[one] * 3
            found[end] = bound if chord[one] * chord[two] < 0 and abs(slope) > abs(bound) else slope
    return found


@lru_cache(maxsize=100)
def _spline(knots: Knots) -> list[Fraction]:
    """Slopes at the knots of the spline that ends flat, by its second derivatives M, which are exact: rise/h -
    h/6 (2 M_k + M_{k+1}); each as the shortest decimal of the double next to it, as tables are defined.
    """
    x, y, last = knots.x, knots.y, len(knots.x) - 1
    h = [x[i + 1] - x[i] for i in range(last)]
    rise = [y[i + 1] - y[i] for i in range(last)]
    # rows: 2 h_0 M_0 + h_0 M_1 = 6 m_0; h_{i-1} M_{i-1} + 2 (h_{i-1} + h_i) M_i + h_i M_{i+1} = 6 (m_i - m_{i-1}); end
    system = fmpq_mat(last + 1, last + 1)
    right = fmpq_mat(last + 1, 1)
    for i in range(last):
        for row, other in ((i, i + 1), (i + 1, i)):
            system[row, row] += to_fmpq(2 * h[i])
            system[row, other] += to_fmpq(h[i])
        slope = to_fmpq(6 * rise[i] / h[i])
        right[i, 0] += slope
        right[i + 1, 0] -= slope
    M = [fraction(row) for row in system.solve(right).entries()]
    exact = [rise[i] / h[i] - h[i] / 6 * (2 * M[i] + M[i + 1]) for i in range(last)]
    return [*(Fraction(str(float(s))) for s in exact), Fraction(0)]


def _ball(x: Fraction) -> Any:
    return arb(to_fmpq(x))


def _in_balls(parted: Callable[..., Parted]) -> Callable[..., Any]:
    """A function of balls, or of power series, from its value and its partial derivatives at balls."""

    def function(*args: Any) -> Any:
        """f(a + a1 h + a2 h^2, ...) = f + f_a a1 h + (f_a a2 + 1/2 f_ab a1 b1) h^2 + ..."""
        if not any(isinstance(x, arb_series) for x in args):
            return parted(*args)[0]
        rows = [[x[k] for k in range(3)] if isinstance(x, arb_series) else [x, arb(0), arb(0)] for x in args]
        value, slopes, *seconds = parted(*(row[0] for row in rows))
        moved = [i for i, row in enumerate(rows) if row[1] != 0]
        first, second = (sum((slopes[i] * row[k] for i, row in enumerate(rows) if row[k] != 0), arb(0)) for k in (1, 2))
        bends = seconds[0] if seconds else []
        for i in moved if bends else ():
            second += sum((bends[i][j] * rows[i][1] * rows[j][1] for j in moved), arb(0)) / 2
        return arb_series([value, first, second])

    return function


BALLS: dict[str, Callable[..., Any]] = {
    **{name: _in_balls(f) for name, f in (("abs", _abs), ("sign", _sign), ("tanh", _tanh), ("atan2", _atan2))},
    **{name: _in_balls(f) for name, f in (("max", _max), ("min", _min), ("step", _step), ("power", _power))},
    "table": lambda knots, x: _in_balls(lambda inner: _in_table(knots, inner))(x),
}
FLOATS: dict[str, Callable[..., Any]] = {
    "abs": np.abs,
    "sign": np.sign,
    "tanh": np.tanh,
    "atan2": np.arctan2,
    "max": np.maximum,
    "min": np.minimum,
    "step": _step_of_floats,
    "power": _power_of_floats,
    "table": _table_of_floats,
}
