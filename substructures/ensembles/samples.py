"""Samples of parameters, any range of rows of which can be made by itself, with the same bits whatever the range.

Random numbers are hashes of seed, axis and row (splitmix64: Steele, Lea, Flood 2014); a Latin hypercube needs a
permutation of its rows for each axis, which is a Feistel network with cycle walking (Black, Rogaway 2002), since the
usual one would have to be kept whole. Sobol' points are scrambled (Owen) as SciPy makes them.
"""

from __future__ import annotations

import math
import warnings
from collections.abc import Mapping
from dataclasses import dataclass
from importlib import import_module  # of what takes half a second
from typing import Annotated, Literal

import numpy as np
from numpy.typing import NDArray
from pydantic import Field, field_validator, model_validator
from pydantic_core import PydanticCustomError

from substructures.array import Array
from substructures.documents import DocumentPart
from substructures.documents.fields import NUMERIC, Real, unit_of

#: rows that may be drawn
MOST_ROWS = 10**8
Values = Annotated[list[Real], Field(min_length=1, max_length=1_000_000)]
Words = NDArray[np.uint64]
ROUNDS = 6  # of the Feistel network; 4 are as good as random to a polynomial adversary (Luby, Rackoff 1988)
_GAMMA = 0x9E3779B97F4A7C15


class Distribution(DocumentPart):
    """What values a parameter takes: ``values``, or ``uniform`` between two, or ``normal`` (mean, deviation).

    ``count``: of a grid, points from end to end of ``uniform``, or quantiles of ``normal``; ``unit``: of the numbers,
    SI if left out.
    """

    values: Values | None = None
    uniform: tuple[Real, Real] | None = None
    normal: tuple[Real, Annotated[float, Field(ge=0), NUMERIC]] | None = None
    count: Annotated[int, Field(ge=1, le=MOST_ROWS), NUMERIC] | None = None
    unit: Annotated[str, Field(max_length=64)] = ""

    @field_validator("unit")
    @classmethod
    def _known(cls, unit: str) -> str:
        if unit:
            unit_of(unit)
        return unit

    @property
    def factor(self) -> float:
        """What its numbers are multiplied by in SI."""
        return unit_of(self.unit).scale if self.unit else 1.0

    @model_validator(mode="after")
    def _one(self) -> Distribution:
        if sum(each is not None for each in (self.values, self.uniform, self.normal)) != 1:
            raise PydanticCustomError("one-distribution", "give one of 'values', 'uniform' and 'normal'")
        if self.values is not None and self.count is not None:
            raise PydanticCustomError("counted-twice", "'values' are as many as they are: leave 'count' out")
        factor = self.factor
        if not factor:
            raise PydanticCustomError("unit-too-small", "the factor of the unit is below the range of doubles")
        if not all(math.isfinite(x * factor) for x in self.values or self.uniform or self.normal or ()):
            raise PydanticCustomError("number-not-finite", "in SI a number is not finite: give smaller ones")
        if self.uniform is not None and not math.isfinite((self.uniform[1] - self.uniform[0]) * factor):
            raise PydanticCustomError("number-not-finite", "the range is not finite: give smaller numbers")
        return self


class Samples(DocumentPart):
    """Numbers of parameters for each combination of parts.

    ``grid``: all values of each with all of the others; ``list``: the first of each together, then the second, ...;
    the others draw ``count`` rows from the distributions, the same ones for the same ``seed``.
    """

    method: Literal["grid", "list", "random", "sobol", "latin-hypercube"] = "grid"
    count: Annotated[int, Field(ge=1, le=MOST_ROWS), NUMERIC] | None = None
    seed: Annotated[int, Field(ge=0, lt=2**53), NUMERIC] = 0
    of: dict[str, Distribution] = Field(min_length=1, max_length=1000)

    @model_validator(mode="after")
    def _has_counts(self) -> Samples:
        drawn = self.method not in ("grid", "list")
        if drawn and self.count is None:
            raise PydanticCustomError("missing-count", f"samples by '{self.method}' need a 'count'")
        if not drawn and self.count is not None:
            raise PydanticCustomError("counted-twice", f"a {self.method} has the counts of its values: no 'count' here")
        for name, each in self.of.items():
            if drawn and each.count is not None:
                raise PydanticCustomError("counted-twice", f"'{name}': 'count' stands beside 'method'")
            if self.method == "grid" and each.values is None and each.count is None:
                raise PydanticCustomError("missing-count", f"'{name}' needs a 'count' in a grid")
            if self.method == "list" and each.values is None:
                raise PydanticCustomError("missing-values", f"'{name}' needs 'values' in a list")
        if self.method == "list" and len({len(each.values or ()) for each in self.of.values()}) > 1:
            raise PydanticCustomError("lengths", "the lists of values differ in length")
        return self


def size_of(samples: Samples | None) -> int:
    """How many rows samples have; one where there are none."""
    if samples is None:
        return 1
    if samples.count is not None:
        return samples.count
    sizes = [len(each.values) if each.values is not None else each.count or 1 for each in samples.of.values()]
    return math.prod(sizes) if samples.method == "grid" else sizes[0]


@dataclass(frozen=True)
class Sampler:
    """The values of the sampled parameters, by name, for ranges of rows."""

    samples: Samples | None

    @property
    def names(self) -> tuple[str, ...]:
        """The parameters."""
        return () if self.samples is None else tuple(self.samples.of)

    @property
    def size(self) -> int:
        """How many rows there are."""
        return size_of(self.samples)

    def rows(self, start: int, stop: int) -> dict[str, Array]:
        """The columns of the rows from ``start`` to ``stop``, (stop - start,) each."""
        if self.samples is None:
            return {}
        given, index = self.samples, np.arange(start, stop, dtype=np.int64)
        if given.method == "grid":
            return _grid(given.of, index)
        if given.method == "list":
            return {name: _axis(each)[index] for name, each in given.of.items()}
        if given.method == "sobol":
            unit = _sobol(len(given.of), given.seed, start, stop)
        else:
            make = _stratified if given.method == "latin-hypercube" else _uniform
            unit = np.stack([make(given.seed, axis, index, self.size) for axis in range(len(given.of))], axis=1)
        return {name: _drawn(each, unit[:, k]) for k, (name, each) in enumerate(given.of.items())}


def _grid(of: Mapping[str, Distribution], index: NDArray[np.int64]) -> dict[str, Array]:
    """The last axis varies fastest."""
    axes = {name: _axis(each) for name, each in of.items()}
    places = np.unravel_index(index, [len(values) for values in axes.values()])
    return {name: values[place] for (name, values), place in zip(axes.items(), places, strict=True)}


def _axis(of: Distribution) -> Array:
    """The values of a parameter in a grid."""
    if of.values is not None:
        return np.asarray(of.values, dtype=np.float64) * of.factor
    count = of.count or 1
    if of.uniform is not None:
        return np.linspace(*of.uniform, count) * of.factor
    return _drawn(of, (np.arange(count) + 0.5) / count)


def _drawn(of: Distribution, unit: Array) -> Array:
    """Values by their distribution function, of numbers in (0, 1), in SI."""
    if of.values is not None:
        values = _axis(of)
        return values[np.minimum((unit * len(values)).astype(np.int64), len(values) - 1)]
    if of.uniform is not None:
        low, high = (x * of.factor for x in of.uniform)
        return low + (high - low) * unit
    mean, deviation = (x * of.factor for x in of.normal or (0.0, 0.0))
    normal: Array = import_module("scipy.special").ndtri(unit)
    return mean + deviation * normal


def _sobol(axes: int, seed: int, start: int, stop: int) -> Array:
    engine = import_module("scipy.stats.qmc").Sobol(axes, scramble=True, rng=np.random.default_rng(seed))
    if start:
        engine.fast_forward(start)
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")  # that a part of them, which is all that is asked for here, is not balanced
        found: Array = engine.random(stop - start)
    return np.clip(found, 2.0**-54, 1 - 2.0**-53)


def _uniform(seed: int, axis: int, index: NDArray[np.int64], _size: int) -> Array:
    return (_hash(index.astype(np.uint64), seed, 2 * axis) >> np.uint64(11)).astype(np.float64) * 2.0**-53 + 2.0**-54


def _stratified(seed: int, axis: int, index: NDArray[np.int64], size: int) -> Array:
    """One number in each of ``size`` intervals of equal length, in a random order."""
    place = permuted(index.astype(np.uint64), size, seed, 2 * axis + 1)
    return np.minimum((place + _uniform(seed, axis, index, size)) / size, 1 - 2.0**-53)


def permuted(index: Words, size: int, seed: int, key: int) -> Words:
    """Where a permutation of 0 ... size - 1, one for each seed and key, takes ``index``."""
    half = max(1, math.ceil(math.log2(max(size, 2)) / 2))
    mask, shift = np.uint64(2**half - 1), np.uint64(half)
    found, open_ = index.copy(), np.ones(len(index), dtype=bool)
    while open_.any():  # until all are below the size again: 4 times at most on average
        left, right = found[open_] >> shift, found[open_] & mask
        for step in range(ROUNDS):
            left, right = right, left ^ (_hash(right, seed, key * ROUNDS + step) & mask)
        found[open_] = (left << shift) | right
        open_[open_] = found[open_] >= np.uint64(size)
    return found


def _hash(words: Words, seed: int, key: int) -> Words:
    """splitmix64 of the words, of a stream for each seed and key."""
    with np.errstate(over="ignore"):
        salt = np.uint64((seed * _GAMMA + key * 0xD1B54A32D192ED03 + 0x8CB92BA72F3D8DD7) % 2**64)
        z = _mixed((words + np.uint64(1)) * np.uint64(_GAMMA) ^ salt)
        return _mixed(z + salt)


def _mixed(z: Words) -> Words:
    z = (z ^ (z >> np.uint64(30))) * np.uint64(0xBF58476D1CE4E5B9)
    z = (z ^ (z >> np.uint64(27))) * np.uint64(0x94D049BB133111EB)
    return z ^ (z >> np.uint64(31))
