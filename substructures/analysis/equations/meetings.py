"""Derivatives where pieces of a smooth law meet: a formula of one is 0/0 there, and the same on both sides."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping
from typing import Any

import numpy as np

from substructures.array import Array

#: how far beside, as parts of max(1, |x|): what is the same on both sides differs less the nearer they are
BESIDE, FARTHER = 2.0**-30, 2.0**-20
#: how much sides may differ: of their size, or of how they differ farther away
SAME, LESS = 1e-6, 0.01

Run = Callable[[Mapping[str, Any]], dict[str, Array]]


def with_sides(run: Run, values: Mapping[str, Any], moved: Iterable[str]) -> dict[str, Array]:
    """What ``run`` makes of values; elements that are not finite there are the mean of both sides, where ``moved``
    symbols are a little larger and smaller, if these tend to each other. At a corner they do not, and nothing changes.
    """
    found = run(values)
    if all(np.isfinite(x).all() for x in found.values()):
        return found
    names = [name for name in moved if name in values]
    sides = [
        run({**values, **{n: values[n] + far * np.maximum(1.0, np.abs(values[n])) for n in names}})
        for far in (BESIDE, -BESIDE, FARTHER, -FARTHER)
    ]
    return {name: _between(x, *(side[name] for side in sides)) for name, x in found.items()}


def _between(x: Array, up: Array, down: Array, above: Array, below: Array) -> Array:
    with np.errstate(invalid="ignore"):
        apart = np.abs(up - down)
        is_same = (apart <= SAME * np.maximum(np.abs(up), np.abs(down))) | (apart <= LESS * np.abs(above - below))
    return np.where(~np.isfinite(x) & is_same, (up + down) / 2, x)
