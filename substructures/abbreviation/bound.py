"""Proof that trigonometric sums do not exceed a number in a box: branch and bound.

In a box with centre c and half widths r every sum f(q) = Re sum C_k exp(i k . q) obeys

    |f(q)| <= |f(c)| + sum_j r_j |d_j f(c)| + 1/2 sum_k |C_k| (sum_j |k_j| r_j)^2,        |f(q)| <= sum_k |C_k|

(Taylor; the second derivative along h is -sum C_k (k . h)^2 exp(i k . q)). The bound of an element is the sum of those
of its products of variables, each of which can be +-1 times its largest value. Boxes with too large a bound are halved.
Every product is looked at alone first, with fewer angles and terms; what is found bounds it in all boxes.

Rounding: exp(i k c_j) of one coordinate comes from a ball of python-flint, rounded to doubles. Everything after that
is sums and products of doubles; for T terms in D coordinates they are wrong by less than (T + 8 D + 64) 2^-52 times the
same sums of absolute values, of which four times as much is added.
"""

from __future__ import annotations

import math
from collections import deque
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from fractions import Fraction

import flint
import numpy as np

from substructures.abbreviation.balls import PRECISION, exact
from substructures.abbreviation.ranges import Interval
from substructures.abbreviation.sums import AngleSums
from substructures.array import Array, ComplexArray

#: terms times boxes that a proof may look at for an element, and for one of its products alone
EFFORT, ALONE = 6_000_000, 300_000
#: terms times boxes that are looked at together
TOGETHER = 40_000
#: a bound that exceeds what is taken on somewhere by less is as good as the best one
TIGHT = 1.03


@dataclass(frozen=True)
class Bound:
    """``proven``: never exceeded in the box; ``seen``: what the bound of a single point is somewhere, at least."""

    proven: float
    seen: float


class Prover:
    """Proofs over the same ranges of angles. ``report`` is told from time to time, and may raise."""

    def __init__(self, ranges: Sequence[Interval], report: Callable[[], object] = lambda: None) -> None:
        self._low = np.array([_down(x.low) for x in ranges], dtype=np.float64)
        self._high = np.array([_up(x.high) for x in ranges], dtype=np.float64)
        self._waves: dict[tuple[int, int], dict[float, complex]] = {}
        self._products: dict[tuple[tuple[tuple[Fraction, ...], ...], bytes], float] = {}
        self._bounds: dict[tuple[object, ...], Bound] = {}
        self._report = report

    def bound(self, sums: AngleSums, enough: float = 0.0) -> Bound:
        """A bound of an element; none below ``enough`` is looked for, and no more once one cannot be proven."""
        if not sums.starts or not math.isfinite(sums.rest):
            return Bound(sums.rest, sums.rest)
        key = sums.starts, sums.multiples, sums.weights.tobytes(), sums.rest, enough
        if key not in self._bounds:
            self._bounds[key] = self._bound(sums, enough)
        return self._bounds[key]

    def _bound(self, sums: AngleSums, enough: float) -> Bound:
        alone = [self._alone(sums.product(m)) for m in range(len(sums.starts))]
        flat = np.array(alone)
        together = (float(flat.sum()) + sums.rest) * (1 + 2**-40)
        if together <= enough or len(alone) == 1 or not any(map(any, sums.multiples)):
            return Bound(together, 0.0)
        found = self._searched(_Element(sums, flat, self._wave), enough, EFFORT)
        return Bound(min(found.proven, together), found.seen)

    def _alone(self, sums: AngleSums) -> float:
        """What a sum of one product does not exceed."""
        key = sums.multiples, sums.weights.tobytes()
        found = self._products.get(key)
        if found is None:
            flat = sums.sizes * (1 + len(sums.weights) * 2**-50)
            found = float(flat[0])
            if len(sums.weights) > 1:
                found = min(found, self._searched(_Element(sums, flat, self._wave), 0.0, ALONE).proven)
            self._products[key] = found
        return found

    def _searched(self, element: _Element, enough: float, effort: int) -> Bound:
        terms = len(element.size)
        # a coordinate that does not occur is at its centre
        centre = (self._low + self._high) / 2
        low, high = (np.where(element.used, x, centre)[None, :] for x in (self._low, self._high))
        proven = seen = 0.0
        per_round, left = max(1, TOGETHER // terms), max(1, effort // terms)
        waiting = deque([(low, high, np.array([math.inf]))])
        while waiting:
            low, high, known = waiting.popleft()
            if left <= 0:
                return Bound(max(proven, *(float(x.max()) for _, _, x in [(low, high, known), *waiting])), seen)
            self._report()
            bounds, points, halved = element.bounds(low, high)
            left -= len(bounds)
            seen = max(seen, float(points.max()))
            if seen > enough > 0:
                return Bound(math.inf, seen)
            is_open = bounds > max(enough, TIGHT * seen)
            proven = max(proven, float(bounds[~is_open].max(initial=0.0)))
            low, high = _halves(low[is_open], high[is_open], halved[is_open])
            known = np.repeat(bounds[is_open], 2)
            for k in range(0, len(known), per_round):
                some = slice(k, k + per_round)
                waiting.append((low[some], high[some], known[some]))
        return Bound(proven, seen)

    def _wave(self, multiples: Sequence[Fraction], x: Array) -> ComplexArray:
        """exp(i k x) for multiples k (K,) and x (B,): (B, K), components correct to a unit in the last place of 1."""
        points, place = np.unique(x, return_inverse=True)
        columns = [[self._at(k, point) for point in points.tolist()] for k in multiples]
        return np.array(columns, dtype=np.complex128).T[place]

    def _at(self, k: Fraction, x: float) -> complex:
        known = self._waves.setdefault(k.as_integer_ratio(), {})
        found = known.get(x)
        if found is None:
            with flint.ctx.workprec(PRECISION):
                angle = exact(k * Fraction(x))
                found = known[x] = complex(float(angle.cos().mid()), float(angle.sin().mid()))
        return found


class _Element:
    """The sums of one element as arrays; ``flat``: what each of its products does not exceed anywhere."""

    def __init__(self, sums: AngleSums, flat: Array, wave: Callable[[Sequence[Fraction], Array], ComplexArray]) -> None:
        self.sums, self.wave = sums, wave
        self.k = np.array([[float(x) for x in row] for row in sums.multiples]).reshape(len(sums.multiples), -1)
        # rounded up, as the sums that they are in
        self.reach = np.abs(self.k) * (1 + 2**-50)
        self.size = np.abs(sums.weights)
        self.flat = flat
        self.used = np.any(self.k != 0, axis=0)
        terms, coordinates = self.k.shape
        self.rounding = (terms + 8 * coordinates + 64) * 2.0**-50
        columns = list(zip(*sums.multiples, strict=True))
        #: by coordinate, its multiples and which of them every term has
        self.tables = [{x: number for number, x in enumerate(dict.fromkeys(column))} for column in columns]
        self.which = [np.array([table[x] for x in column]) for table, column in zip(self.tables, columns, strict=True)]
        self.steep = self.size @ self.reach

    def bounds(self, low: Array, high: Array) -> tuple[Array, Array, Array]:
        """Of boxes (B, D): a bound in each, that at its centre, and the coordinate by which it is halved."""
        centre = (low + high) / 2
        half = np.maximum(high - centre, centre - low) * (1 + 2**-50)
        terms = np.broadcast_to(self.sums.weights, (len(low), len(self.size))).copy()
        for j in np.flatnonzero(self.used):
            terms *= self.wave(list(self.tables[j]), centre[:, j])[:, self.which[j]]
        at_centre = np.abs(self._summed(terms.real))
        slope, imag = np.zeros_like(at_centre), np.ascontiguousarray(terms.imag)
        for j in np.flatnonzero(self.used):
            slope += half[:, j, None] * np.abs(self._summed(imag * self.k[:, j]))
        reach = half @ self.reach.T
        squares = self.size * reach * reach
        found = np.minimum(at_centre + slope + self._summed(squares) / 2, self.flat).sum(axis=1)
        slack = self.rounding * (self.size.sum() + reach @ self.size + squares.sum(axis=1))
        points = at_centre.sum(axis=1)
        rest = self.sums.rest
        return (found + slack + rest) * (1 + 2**-48), points + rest, np.argmax(half * self.steep, axis=1)

    def _summed(self, terms: Array) -> Array:
        return np.add.reduceat(terms, self.sums.starts, axis=1)


def _halves(low: Array, high: Array, coordinate: Array) -> tuple[Array, Array]:
    rows = np.arange(len(low))
    first, second = high.copy(), low.copy()
    middle = (low[rows, coordinate] + high[rows, coordinate]) / 2
    first[rows, coordinate] = second[rows, coordinate] = middle
    return (
        np.stack([low, second], axis=1).reshape(-1, low.shape[1]),
        np.stack([first, high], axis=1).reshape(-1, low.shape[1]),
    )


def _down(x: Fraction) -> float:
    found = float(x)
    return found if Fraction(found) <= x else math.nextafter(found, -math.inf)


def _up(x: Fraction) -> float:
    return -_down(-x)
