"""What a kernel is given: values by name, and arrays whose columns are the values of names."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from typing import Any

import numpy as np

from substructures.array import Array

#: names, and an array whose columns (last axis) are their values
NamedColumns = tuple[Sequence[str], Array]


def batch_shape(values: Mapping[str, Any], columns: Iterable[NamedColumns] = ()) -> tuple[int, ...]:
    """The common shape of all values. Raises ValueError when there is none, or names and columns differ in number."""
    kinds = set(map(type, values.values()))
    shapes = {np.shape(v) for v in values.values() if type(v) is not float} if kinds - {float} else set()
    for names, array in columns:
        shape = np.shape(array)
        if not shape or shape[-1] != len(names):
            raise ValueError(f"{len(names)} names for an array of shape {shape}")
        shapes.add(shape[:-1])
    shapes.discard(())
    if not shapes:
        return ()
    return shapes.pop() if len(shapes) == 1 else np.broadcast_shapes(*shapes)


def merged(values: Mapping[str, Any], columns: Iterable[NamedColumns]) -> Mapping[str, Any]:
    """Columns as values by name; of those that come twice the last ones."""
    result = dict(values)
    for names, array in columns:
        result |= {name: np.asarray(array)[..., k] for k, name in enumerate(names)}
    return result
