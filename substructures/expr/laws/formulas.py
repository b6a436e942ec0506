"""Functions of force laws as formulas: what is not an operation of programs is made of those that are.

With pos(x) = x (1 + sign x)/2, which is exact in floating point, and as a product is not taken apart in sums:

=============  =======================================================================================================
max(a, b)      b + pos(a - b)                 rounding of the larger operand; b a number, if one is
min(a, b)      b - pos(b - a)                 the same
tanh(x)        1 - 2/(1 + exp(c))             c = 2x, held within +-577/7, where tanh is +-1 but for 4e-36
step(x, x0, w) u^3 (10 - 15 u + 6 u^2)        u = (x - x0)/w + 1/2, held within 0 and 1: 0 before x0 - w/2, 1 after
                                              x0 + w/2, with two continuous derivatives
x^y            exp(y log x)                   x > 0, and 0 for x = 0 < y; sqrt(x)^n for y = n/2
table          y_0 + sum of p_k(u_k)          u_k = (x - x_k)/(x_{k+1} - x_k), held within 0 and 1: what interval k adds
=============  =======================================================================================================

Where a law has a corner (abs, sign, min, max, linear tables) its derivative is that of one side, and what needs one
everywhere refuses it. The others have one, and are held by (x + sqrt(x^2))/2, as end stops are: formulas of their
derivative are 0/0 at the very place where pieces meet (given motions and linearisations take it from beside), and as
rounding grows with x they are right for |x| up to 1e15 times their width. x^y has no derivative at x = 0.
"""

from __future__ import annotations

from collections.abc import Callable
from fractions import Fraction
from itertools import pairwise

from substructures.expr.graph import Expr
from substructures.expr.steps import Knots

HALF = Fraction(1, 2)
#: where exp(c) is held; at no place that is a short decimal
FAR = Fraction(577, 7)


def pos(x: Expr) -> Expr:
    """max(x, 0) = x (1 + sign x)/2.

    >>> from substructures.expr.graph import Graph
    >>> pos(Graph().number(-3)), pos(Graph().number(3))
    (0, 3)
    """
    return x * ((1 + sign(x)) * HALF)


def magnitude(x: Expr) -> Expr:
    """|x|."""
    if x.is_number:
        return x.graph.number(abs(x.value))
    return x.graph.function("abs", x)


def sign(x: Expr) -> Expr:
    """1, -1 or 0."""
    if x.is_number:
        return x.graph.number((x.value > 0) - (x.value < 0))
    return x.graph.function("sign", x)


def maximum(a: Expr, b: Expr) -> Expr:
    """max(a, b), a number being b: where it is the larger one nothing is added, also in balls.

    >>> from substructures.expr.graph import Graph
    >>> x = Graph().symbol("x")
    >>> maximum(x.graph.number(0), x) is maximum(x, x.graph.number(0))
    True
    """
    a, b = (b, a) if a.is_number else (a, b)
    return b + pos(a - b)


def minimum(a: Expr, b: Expr) -> Expr:
    """min(a, b), a number being b."""
    a, b = (b, a) if a.is_number else (a, b)
    return b - pos(b - a)


def smooth_pos(x: Expr) -> Expr:
    """max(x, 0) = (x + sqrt(x^2))/2, of what is smooth where it meets zero."""
    return (x + x.graph.sqrt(x * x)) * HALF


def held(u: Expr, hold: Callable[[Expr], Expr] = smooth_pos) -> Expr:
    """u within 0 and 1: 1 - pos(1 - pos(u))."""
    return 1 - hold(1 - hold(u))


def tanh(x: Expr) -> Expr:
    """1 - 2/(1 + exp(2x))."""
    c = 2 * FAR * held(x / FAR + HALF) - FAR
    return 1 - 2 / (1 + x.graph.function("exp", c))


def smooth_step(x: Expr, start: Expr, width: Expr) -> Expr:
    """From 0 to 1 over a width about a place."""
    u = held((x - start) / width + HALF)
    return u**3 * (10 - 15 * u + 6 * u**2)


def power(x: Expr, y: Expr) -> Expr:
    """x^y. Raises ValueError for a number below zero with an exponent that is no integer."""
    if y.is_number and Fraction(y.value).denominator == 1 and abs(y.value) <= 1000:
        return x ** int(y.value)
    if x.is_number and x.value < 0:
        raise ValueError(f"a power of {x} with an exponent that is no integer")
    if y.is_number and Fraction(y.value).denominator == 2 and abs(y.value) <= 500:
        return x.graph.sqrt(x) ** int(2 * y.value)
    return x.graph.function("exp", y * x.graph.function("log", x))


def table(x: Expr, knots: Knots) -> Expr:
    """Interpolation in a table, the first and the last value outside of it."""
    slopes = SLOPES[knots.kind](knots) if knots.kind in SLOPES else None
    total = x.graph.number(knots.y[0])
    for k, (a, b) in enumerate(pairwise(knots.x)):
        u = held((x - a) / (b - a), pos if slopes is None else smooth_pos)
        rise = knots.y[k + 1] - knots.y[k]
        if slopes is None:
            total = total + rise * u
            continue
        # Hermite's cubic from 0 to the rise with the slopes s, r (times h) at its ends
        s, r = slopes[k] * (b - a), slopes[k + 1] * (b - a)
        total = total + u * (s + u * (3 * rise - 2 * s - r + u * (s + r - 2 * rise)))
    return total


def monotone_slopes(knots: Knots) -> list[Fraction]:
    """Slopes at the knots, zero at turning points: weighted harmonic means of the slopes beside, as SciPy's PCHIP.

    F. N. Fritsch and J. Butland, A method for constructing local monotone piecewise cubic interpolants, SIAM J. Sci.
    Stat. Comput. 5 (1984); three-point formula at the ends (C. Moler, Numerical Computing with MATLAB, 2004, 3.6).
    """
    h = [b - a for a, b in pairwise(knots.x)]
    m = [(b - a) / step for a, b, step in zip(knots.y, knots.y[1:], h, strict=False)]
    if len(m) == 1:
        return [m[0], m[0]]
    inner = []
    for k in range(1, len(m)):
        before, after = 2 * h[k] + h[k - 1], h[k] + 2 * h[k - 1]
        turns = m[k - 1] * m[k] <= 0
        inner.append(Fraction(0) if turns else (before + after) / (before / m[k - 1] + after / m[k]))
    return [_end(h[0], h[1], m[0], m[1]), *inner, _end(h[-1], h[-2], m[-1], m[-2])]


def _end(h: Fraction, g: Fraction, m: Fraction, n: Fraction) -> Fraction:
    """The slope at an end, from the first two intervals."""
    slope = ((2 * h + g) * m - h * n) / (h + g)
    if slope * m <= 0:
        return Fraction(0)
    return 3 * m if m * n <= 0 and abs(slope) > 3 * abs(m) else slope


def spline_slopes(knots: Knots) -> list[Fraction]:
    """Slopes at the knots of the cubic spline that ends flat: 0, and where the second derivatives of the intervals
    beside meet (C. de Boor, A Practical Guide to Splines, 1978, chapter IV).

    The solution of s_{k-1}/h_{k-1} + 2 s_k (1/h_{k-1} + 1/h_k) + s_{k+1}/h_k = 3 (m_{k-1}/h_{k-1} + m_k/h_k), with 17
    digits.
    """
    h = [b - a for a, b in pairwise(knots.x)]
    m = [(b - a) / step for a, b, step in zip(knots.y, knots.y[1:], h, strict=False)]
    # s_k = known_k - share_k s_{k+1}, from the first to the last
    known, share = [Fraction(0)], [Fraction(0)]
    for k in range(1, len(h)):
        diagonal = 2 / h[k - 1] + 2 / h[k] - share[-1] / h[k - 1]
        known.append((3 * (m[k - 1] / h[k - 1] + m[k] / h[k]) - known[-1] / h[k - 1]) / diagonal)
        share.append(1 / h[k] / diagonal)
    slopes = [Fraction(0)]
    for a, b in zip(reversed(known), reversed(share), strict=True):
        slopes.append(a - b * slopes[-1])
    return [Fraction(repr(float(slope))) for slope in reversed(slopes)]


#: slopes at the knots by the kind of a table
SLOPES = {"monotone": monotone_slopes, "smooth": spline_slopes}


def _function(name: str) -> Callable[[Expr], Expr]:
    return lambda x: x.graph.function(name, x)


#: functions of expressions by name
FUNCTIONS: dict[str, Callable[..., Expr]] = {
    **{name: _function(name) for name in ("exp", "log", "asin", "acos", "atan")},
    "atan2": lambda y, x: y.graph.function("atan2", y, x),
    "abs": magnitude,
    "sign": sign,
    "tanh": tanh,
    "min": minimum,
    "max": maximum,
    "step": smooth_step,
}
