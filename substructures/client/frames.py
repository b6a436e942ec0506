"""Arrays of states as columns of a table, for pandas and polars where these are installed."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from importlib import import_module
from itertools import product
from typing import Any

import numpy as np
from numpy.typing import NDArray

from substructures.client.answers import Answer
from substructures.quantities.quantity import labels_of

Array = NDArray[Any]
#: series of motions that are called like a quantity, or like none
SERIES = ("qdd", "friction")


class Tabular(Answer):
    """An answer about many states."""

    def columns(self) -> dict[str, Array]:
        """Columns by name, with one row for each state."""
        raise NotImplementedError

    def _labels(self, name: str, shape: Sequence[int]) -> list[list[str]]:
        """Names of the places of a quantity, numbers from 0 where they have none."""
        found = labels_of(name, self)
        if name in SERIES and len(shape) == 1:
            found = labels_of("forces", self)  # one for each coordinate, too
        known = found if len(found) == len(shape) else [[] for _ in shape]
        return [
            labels if len(labels) == size else [str(k) for k in range(size)]
            for labels, size in zip(known, shape, strict=True)
        ]

    def to_pandas(self) -> Any:
        """A ``pandas.DataFrame``. Raises ImportError where pandas is not installed."""
        return _module("pandas").DataFrame(self.columns())

    def to_polars(self) -> Any:
        """A ``polars.DataFrame``. Raises ImportError where polars is not installed."""
        return _module("polars").DataFrame(self.columns())


def _module(name: str) -> Any:
    try:
        return import_module(name)
    except ImportError:
        raise ImportError(f"a frame of {name} needs the package: pip install {name}") from None


def labelled(name: str, values: Array, axes: Sequence[Sequence[str]]) -> Iterator[tuple[str, Array]]:
    """An array (N, ...) as columns ``name.<label>.<label>``: ``axes`` has the labels of all axes but the first."""
    rows = values.reshape(len(values), -1)
    for labels, column in zip(product(*axes), rows.T, strict=True):
        yield ".".join([name, *labels]), column


def states(given: Mapping[str, Any], coordinates: Sequence[str], count: int) -> dict[str, Array]:
    """The states of a request as columns ``t``, ``q.<coordinate>``, ``qd.<coordinate>``, as far as they are numbers."""
    found: dict[str, Array] = {}
    for name in ("t", "q", "qd"):
        value = given.get(name)
        if isinstance(value, Mapping):
            columns = {f"{name}.{key}": value[key] for key in coordinates if key in value}
        elif name == "t":
            columns = {name: value}
        else:
            columns = dict(_by_coordinate(name, value, coordinates, count))
        for label, column in columns.items():
            array = _numbers(column)
            if array is not None:
                found[label] = np.broadcast_to(array.ravel(), (count,))
    return found


def _by_coordinate(name: str, value: Any, coordinates: Sequence[str], count: int) -> Iterator[tuple[str, Array]]:
    array, n = _numbers(value), len(coordinates)
    if array is not None:
        yield from labelled(name, np.broadcast_to(array.reshape(-1, n), (count, n)), [coordinates])


def _numbers(value: Any) -> Array | None:
    """An array of numbers, None for all else, as numbers with units."""
    if value is None:
        return None
    try:
        return np.asarray(value, dtype=np.float64)
    except (TypeError, ValueError):
        return None
