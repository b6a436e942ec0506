"""Sets of states that a few words describe: a grid, or a random sample; any part of them can be made alone.

Columns are named as in a tree: coordinates, velocities (``arm.q1'``), parameters, inputs (``tau.arm.q1``).
"""

from __future__ import annotations

import math
from collections.abc import Collection, Mapping, Sequence
from typing import Any

import numpy as np

from service.jobs.kinds.kind import inside
from service.schemas.state_sets import Grid, Sample
from service.settings import Limits
from substructures.array import Array
from substructures.documents import pointer_step, read_model
from substructures.errors import Fault, InvalidDocument, among
from substructures.quantities.measured import PlaceUnits, si_values
from substructures.quantities.sources import numbers_per_state, read_quantities

NamedAxis = tuple[str, list[float]]
#: draws that one step of the counter of Philox makes (Salmon et al. 2011, Parallel random numbers, section 4)
DRAWS = 4


def read_grid(given: Mapping[str, Any], known: Mapping[str, str]) -> list[NamedAxis]:
    """Name and values in SI of every axis of a :class:`Grid`; ``known``: SI units by name. Raises InvalidInput."""
    _check_names("/grid", given, known)
    with inside("/grid"):
        return read_model(Grid, si_values(given, axis_units(given, known), "")).axes()


def axis_units(given: Mapping[str, Any], known: Mapping[str, str]) -> PlaceUnits:
    """What stands in a grid: values, or the ends of a span of them."""
    spans = {name for name, axis in given.items() if isinstance(axis, Mapping) and "from" in axis}
    return {name: dict.fromkeys(("from", "to"), unit) if name in spans else unit for name, unit in known.items()}


def _check_names(pointer: str, given: Mapping[str, Any], known: Collection[str]) -> None:
    what = "the tree has no coordinate, parameter or input"
    faults = [
        Fault(pointer + pointer_step(name), "unknown-name", f"{what} '{name[:80]}'{among(name, known, k)}")
        for k, name in enumerate(name for name in given if name not in known)
    ]
    if faults:
        raise InvalidDocument(faults)


def grid_size(axes: Sequence[NamedAxis]) -> int:
    """How many states a grid has."""
    return math.prod(len(values) for _, values in axes)


def grid_states(axes: Sequence[NamedAxis], start: int, stop: int) -> dict[str, Array]:
    """The columns of a part of the grid; the last axis varies fastest."""
    indices = np.unravel_index(np.arange(start, stop), [len(values) for _, values in axes])
    return {
        name: np.asarray(values, dtype=np.float64)[index] for (name, values), index in zip(axes, indices, strict=True)
    }


def read_sample(
    given: Mapping[str, Any], known: Mapping[str, str], limits: Mapping[str, tuple[float, float] | None]
) -> dict[str, Any]:
    """A :class:`Sample` as plain data, with a range for every coordinate: the one given, or its joint limits.

    ``known``: SI units by name; ``limits``: by coordinate; None where the joint has none that are numbers. Raises
    InvalidInput.
    """
    with inside("/sample"):
        sample = read_model(Sample, {"count": None, **si_values(given, {"ranges": known}, "")})
    _check_names("/sample/ranges", sample.ranges, known)
    missing = [name for name, limit in limits.items() if limit is None and name not in sample.ranges]
    if missing:
        message = f"the joints of {', '.join(missing[:10])} have no limits that are numbers: give ranges"
        raise InvalidDocument.at("/sample/ranges", "missing", message)
    defaults = {name: list(limit) for name, limit in limits.items() if limit is not None}
    chosen = {name: list(pair) for name, pair in sample.ranges.items()}
    return {"count": sample.count, "seed": sample.seed, "ranges": {**defaults, **chosen}}


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


def states_per_item(quantities: Sequence[str], dof: int, frames: int, limits: Limits) -> int:
    """How many states an item may have. Raises InvalidArgument."""
    size = 8 * numbers_per_state(read_quantities(quantities), dof, frames)
    return max(1, min(limits.job_states, limits.binary_bytes // size))
