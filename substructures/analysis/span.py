"""The time span of a request and how finely it is integrated."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from substructures.errors import InvalidDocument
from substructures.states import numeric

Array = NDArray[np.float64]
#: told the share of the time span that is done; False cancels
Progress = Callable[[float], bool]


@dataclass(frozen=True)
class Span:
    """Times of a request and how finely they are integrated."""

    times: Array
    rtol: float
    atol: float
    max_step: float
    max_steps: int


def read_span(request: Mapping[str, Any]) -> Span:
    """``start``, ``end`` and ``outputs``, or ``times``; ``rtol``, ``atol``, ``max_step``, ``max_steps``.

    Raises InvalidDocument.
    """
    start = _positive(request, "start", 0.0, zero=True)
    if request.get("times") is not None:
        times = numeric(request["times"], "/times")
        if times.ndim != 1 or len(times) < 2 or (np.diff(times) <= 0).any():
            raise InvalidDocument.at("/times", "not-rising", "two or more rising times are needed")
    else:
        end = _positive(request, "end", None)
        count = request.get("outputs", 201)
        if isinstance(count, bool) or not isinstance(count, int) or not 2 <= count <= 1_000_000:
            raise InvalidDocument.at("/outputs", "bad-number", "a whole number from 2 to 1,000,000 is needed")
        if end <= start:
            raise InvalidDocument.at("/end", "bad-number", "the end must be later than the start")
        times = np.linspace(start, end, count)
    most = _positive(request, "max_steps", 1_000_000.0)
    return Span(
        times,
        max(_positive(request, "rtol", 1e-10), 1e-13),
        _positive(request, "atol", 1e-12),
        _positive(request, "max_step", np.inf),
        int(most),
    )


def _positive(request: Mapping[str, Any], name: str, default: float | None, zero: bool = False) -> float:
    given = request.get(name)
    if given is None:
        if default is None:
            raise InvalidDocument.at(f"/{name}", "missing", f"'{name}' is needed")
        return default
    value = numeric(given, f"/{name}")
    if value.ndim or not (zero or value > 0):
        raise InvalidDocument.at(f"/{name}", "bad-number", f"'{name}' must be a positive number")
    return float(value)
