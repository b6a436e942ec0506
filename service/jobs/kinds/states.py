"""Sets of states that a few words describe: a grid, or a random sample; any part of them can be made alone.

Columns are named as in a tree: coordinates, velocities (``arm.q1'``), parameters, inputs (``tau.arm.q1``).
"""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np

from substructures.array import Array
from substructures.documents import pointer_step
from substructures.errors import Fault, InvalidDocument

Axis = tuple[str, list[float]]
#: draws that one step of the counter of Philox makes (Salmon et al. 2011, Parallel random numbers, section 4)
DRAWS = 4
MAX_AXIS = 10_000


def read_grid(given: Any, known: set[str]) -> list[Axis]:
    """Name and values of every axis, which may be a list, one number, or ``{"from", "to", "count"}``.

    Raises InvalidDocument.
    """
    if not isinstance(given, Mapping) or not given:
        raise InvalidDocument.at("/grid", "object-expected", "an object of axes by name is needed")
    _check_names("/grid", given, known)
    return [(name, _axis(axis, "/grid" + pointer_step(name))) for name, axis in given.items()]


def _check_names(pointer: str, given: Mapping[str, Any], known: set[str]) -> None:
    faults = [
        Fault(pointer + pointer_step(name), "unknown-name", f"the tree has no coordinate, parameter or input '{name}'")
        for name in given
        if name not in known
    ]
    if faults:
        raise InvalidDocument(faults)


def _axis(given: Any, pointer: str) -> list[float]:
    if isinstance(given, Mapping):
        if given.keys() != {"from", "to", "count"}:
            raise InvalidDocument.at(pointer, "axis", "an axis has 'from', 'to' and 'count'")
        count = _count(given["count"], f"{pointer}/count", MAX_AXIS)
        start, stop = (_finite(given[name], f"{pointer}/{name}") for name in ("from", "to"))
        return [float(x) for x in np.linspace(start, stop, count)]
    values = given if isinstance(given, list) else [given]
    if not 0 < len(values) <= MAX_AXIS:
        raise InvalidDocument.at(pointer, "axis", f"an axis has 1 to {MAX_AXIS:,} values")
    return [_finite(x, f"{pointer}/{k}" if isinstance(given, list) else pointer) for k, x in enumerate(values)]


def _finite(given: Any, pointer: str) -> float:
    try:
        value = math.nan if isinstance(given, bool | str) else float(given)
    except (TypeError, ValueError, OverflowError):
        value = math.nan
    if not math.isfinite(value):
        raise InvalidDocument.at(pointer, "number-expected", f"a number is needed, found {str(given)[:40]!r}")
    return value


def _count(given: Any, pointer: str, limit: int) -> int:
    if isinstance(given, bool) or not isinstance(given, int) or not 0 < given <= limit:
        raise InvalidDocument.at(pointer, "count", f"a whole number from 1 to {limit:,} is needed")
    return given


def grid_size(axes: Sequence[Axis]) -> int:
    """How many states a grid has."""
    return math.prod(len(values) for _, values in axes)


def grid_states(axes: Sequence[Axis], start: int, stop: int) -> dict[str, Array]:
    """The columns of a part of the grid; the last axis varies fastest."""
    indices = np.unravel_index(np.arange(start, stop), [len(values) for _, values in axes])
    return {
        name: np.asarray(values, dtype=np.float64)[index] for (name, values), index in zip(axes, indices, strict=True)
    }


def read_sample(given: Any, known: set[str], limits: Mapping[str, tuple[float, float] | None]) -> dict[str, Any]:
    """``{"count", "seed", "ranges"}`` with a range for every coordinate: the one given, or its joint limits.

    ``limits``: by coordinate; None where the joint has none that are numbers. Raises InvalidDocument.
    """
    if not isinstance(given, Mapping) or not given.keys() <= {"count", "seed", "ranges"}:
        raise InvalidDocument.at("/sample", "sample", "a sample has 'count', 'seed' and 'ranges'")
    count = _count(given.get("count"), "/sample/count", 2**53)
    seed = given.get("seed", 0)
    if isinstance(seed, bool) or not isinstance(seed, int) or not 0 <= seed < 2**64:
        raise InvalidDocument.at("/sample/seed", "seed", "a seed is a whole number from 0 to 2^64 - 1")
    ranges = given.get("ranges", {})
    if not isinstance(ranges, Mapping):
        raise InvalidDocument.at("/sample/ranges", "object-expected", "an object of ranges by name is needed")
    _check_names("/sample/ranges", ranges, known)
    chosen = {name: _range(r, "/sample/ranges" + pointer_step(name)) for name, r in ranges.items()}
    missing = [name for name, limit in limits.items() if limit is None and name not in chosen]
    if missing:
        message = f"the joints of {', '.join(missing[:10])} have no limits that are numbers: give ranges"
        raise InvalidDocument.at("/sample/ranges", "missing", message)
    defaults = {name: list(limit) for name, limit in limits.items() if limit is not None}
    return {"count": count, "seed": seed, "ranges": {**defaults, **chosen}}


def _range(given: Any, pointer: str) -> list[float]:
    if not isinstance(given, list) or len(given) != 2:
        raise InvalidDocument.at(pointer, "range", "a range has two numbers")
    low, high = (_finite(x, f"{pointer}/{k}") for k, x in enumerate(given))
    if low > high:
        raise InvalidDocument.at(pointer, "range", f"{low:g} is above {high:g}")
    return [low, high]


def sample_states(sample: Mapping[str, Any], start: int, stop: int) -> dict[str, Array]:
    """The columns of a part of a sample, uniform in the ranges; state k is the same whatever part it is made with."""
    names = sorted(sample["ranges"])
    steps = -(-len(names) // DRAWS)  # of the counter, for one state
    generator = np.random.Generator(np.random.Philox(sample["seed"]).advance(start * steps))
    unit = generator.random((stop - start, steps * DRAWS))
    result = {}
    for k, name in enumerate(names):
        low, high = (float(x) for x in sample["ranges"][name])
        result[name] = low + (high - low) * unit[:, k]
    return result
