"""What is said of results: states without one, and doubtful ones."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from math import prod
from typing import Any

import numpy as np
from numpy.typing import NDArray

from substructures.array import Array
from substructures.quantities.numbers.conditioning import Doubt, Look, closed_doubts, doubts, is_usable
from substructures.quantities.quantity import CONDITION, REACTIONS, TABLE, Quantity

_OPEN = (
    "the state does not meet the closures (also their velocities), or they lose rank there, or the metric is singular: "
    "take consistent states from loop states"
)
_ENDLESS = "the metric is singular to rounding, or not positive definite, or not finite: it has no condition number"
_NOT_FINITE = "the result is not finite: numbers overflow, or a formula divides by zero in this state"
_NO_MOTION = (
    "the accelerations of this state, which reactions are of, are not determined or not finite: ask for "
    "forward_dynamics to see why, or give accelerations 'qdd'"
)


def result_of(quantity: Quantity, found: Mapping[str, Array]) -> Any:
    """The arrays of a quantity; NaN where the metric could not be inverted."""
    result = quantity.of(found)
    if "pivots" in quantity.pivots and "pivots" in found:
        usable = is_usable(found["pivots"])
        if not usable.all():
            several = {name: _where(usable, x) for name, x in result.items()} if quantity.fields else None
            return _where(usable, result) if several is None else several
    return result


def _where(usable: NDArray[np.bool_], result: Array) -> Array:
    """NaN in all other states."""
    return np.where(usable.reshape(-1, *(1,) * (result.ndim - 1)), result, np.nan)


def told_of(
    names: Sequence[str],
    found: Mapping[str, Mapping[str, Array]],
    results: Mapping[str, Any],
    look: Look,
) -> dict[str, dict[int, Doubt]]:
    """What is to be said of accelerations and their derivatives, by quantity and state."""
    told = {}
    for name in names:
        outputs = found[TABLE[name].source]
        if not TABLE[name].pivots:
            continue
        if CONDITION in outputs:
            told[name] = closed_doubts(results[name], outputs[CONDITION], _OPEN)
        elif "pivots" in outputs:
            told[name] = doubts(_rows(results[name]), outputs["pivots"], look)
    return told


def _rows(result: Any) -> Array:
    """All numbers of a result in a row for each state."""
    each = list(result.values()) if isinstance(result, dict) else [result]
    return np.concatenate([x.reshape(len(x), prod(x.shape[1:])) for x in each], axis=1)


def advice(name: str, doubt: Doubt | None, is_beyond: bool, more: str = "") -> tuple[str, str]:
    """Code and message of a failure. ``is_beyond``: only in the precision wanted; ``more``: what else it may be."""
    if is_beyond:
        return "overflow", "the result is beyond 3.4e38, the largest number of single precision"
    message = {CONDITION: _ENDLESS, REACTIONS: _NO_MOTION}.get(name, _NOT_FINITE) if doubt is None else doubt.message
    return "not-finite" if doubt is None else doubt.code, f"{message}; {more}" if more else message


def state_warnings(
    results: Mapping[str, Any], told: Mapping[str, Mapping[int, Doubt]], single: bool
) -> Iterator[dict[str, Any]]:
    """A warning for every state with results that are doubtful."""
    for name, by_state in told.items():
        finite = np.asarray(np.isfinite(_rows(results[name])).all(axis=1))
        for state, doubt in by_state.items():
            if finite[state]:
                place = "/q" if single else f"/q/{state}"
                told_of = {"pointer": place, "code": doubt.code, "message": doubt.message}
                yield {**told_of, "state": state, "quantity": name}
