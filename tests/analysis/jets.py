"""Polynomials in several variables up to a degree: exact derivatives of plain computations, without the package."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from functools import cache
from itertools import combinations_with_replacement
from typing import Any

import numpy as np

Array = Any


class Space:
    """Monomials of ``count`` variables up to ``degree``, constant first, then the variables."""

    def __init__(self, count: int, degree: int) -> None:
        self.count, self.degree = count, degree
        words = [w for d in range(degree + 1) for w in combinations_with_replacement(range(count), d)]
        self.words, index = words, {w: i for i, w in enumerate(words)}
        self.size = len(words)
        pairs = [
            (i, j, index[tuple(sorted(a + b))])
            for i, a in enumerate(words)
            for j, b in enumerate(words)
            if len(a) + len(b) <= degree
        ]
        self.left, self.right, self.product = np.array(pairs, dtype=np.int64).T
        #: for each variable: (from, to, factor) of the derivative's coefficients
        self.slopes = [
            np.array([(i, index[_without(w, a)], w.count(a)) for i, w in enumerate(words) if a in w], dtype=np.int64).T
            for a in range(count)
        ]

    def variable(self, a: int, value: float) -> Jet:
        """value + x_a."""
        c = np.zeros(self.size)
        c[0], c[1 + a] = value, 1.0
        return Jet(self, c)

    def variables(self, values: Sequence[float], first: int = 0) -> list[Jet]:
        """Some variables in a row."""
        return [self.variable(first + a, float(x)) for a, x in enumerate(values)]


@cache
def space(count: int, degree: int) -> Space:
    return Space(count, degree)


def _without(word: tuple[int, ...], a: int) -> tuple[int, ...]:
    k = word.index(a)
    return word[:k] + word[k + 1 :]


class Jet:
    """A polynomial with coefficients ``c``; everything of a higher degree is dropped."""

    __slots__ = ("c", "space")

    def __init__(self, where: Space, c: Array) -> None:
        self.space, self.c = where, c

    def _other(self, x: Any) -> Array:
        if isinstance(x, Jet):
            return x.c
        c = np.zeros(self.space.size)
        c[0] = x
        return c

    def __add__(self, x: Any) -> Jet:
        return Jet(self.space, self.c + self._other(x))

    def __sub__(self, x: Any) -> Jet:
        return Jet(self.space, self.c - self._other(x))

    def __rsub__(self, x: Any) -> Jet:
        return Jet(self.space, self._other(x) - self.c)

    def __neg__(self) -> Jet:
        return Jet(self.space, -self.c)

    def __mul__(self, x: Any) -> Jet:
        if isinstance(x, np.ndarray):
            return NotImplemented  # times each of its elements
        if not isinstance(x, Jet):
            return Jet(self.space, self.c * x)
        s = self.space
        return Jet(s, np.bincount(s.product, self.c[s.left] * x.c[s.right], s.size))

    __radd__, __rmul__ = __add__, __mul__

    def __truediv__(self, x: Any) -> Jet:
        return self * (x**-1 if isinstance(x, Jet) else 1 / x)

    def __rtruediv__(self, x: Any) -> Jet:
        return self**-1 * x

    def __pow__(self, power: float) -> Jet:
        if power >= 0 and float(power).is_integer():
            result: Any = 1.0
            for _ in range(int(power)):
                result = self * result
            return result if isinstance(result, Jet) else Jet(self.space, self._other(result))
        terms = [1.0]
        for m in range(self.space.degree):
            terms.append(terms[-1] * (power - m) / (m + 1))
        return self._composed([k * self.value ** (power - m) for m, k in enumerate(terms)])

    def sin(self) -> Jet:
        return self._composed([math.sin(self.value + m * math.pi / 2) / math.factorial(m) for m in self._orders()])

    def cos(self) -> Jet:
        return self._composed([math.cos(self.value + m * math.pi / 2) / math.factorial(m) for m in self._orders()])

    def tan(self) -> Jet:
        return self.sin() / self.cos()

    def sqrt(self) -> Jet:
        return self**0.5

    def _orders(self) -> range:
        return range(self.space.degree + 1)

    def _composed(self, terms: Sequence[float]) -> Jet:
        """sum terms_m h^m with h = self - value."""
        h, result = self - self.value, Jet(self.space, self._other(terms[-1]))
        for x in reversed(terms[:-1]):
            result = result * h + x
        return result

    @property
    def value(self) -> float:
        return float(self.c[0])

    def slope(self, a: int) -> Jet:
        """The derivative by variable a, of a degree less."""
        source, target, factor = self.space.slopes[a]
        c = np.zeros(self.space.size)
        c[target] = self.c[source] * factor
        return Jet(self.space, c)


def value(x: Any) -> float:
    return x.value if isinstance(x, Jet) else float(x)


def values(x: Any) -> Array:
    """Of an array of objects."""
    return np.vectorize(value, otypes=[float])(np.asarray(x, dtype=object))


def slopes(x: Any, a: int) -> Array:
    """Derivatives of all elements of an array of objects by variable a."""
    apply: Callable[..., Array] = np.vectorize(lambda y: y.slope(a) if isinstance(y, Jet) else 0.0, otypes=[object])
    return apply(np.asarray(x, dtype=object))


def gradient(x: Any, variables: Sequence[int]) -> Array:
    """Values of the derivatives, the variables on the last axis."""
    return np.stack([values(slopes(x, a)) for a in variables], axis=-1)
