"""Numbers for one state or many: limits, and JSON out."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np
import orjson

from service.settings import Limits
from substructures.errors import TooLarge
from substructures.quantities.numbers.result import Evaluation
from substructures.quantities.quantity import has_numbers
from substructures.quantities.sources import Sources, cost


def check_size(
    sources: Sources, quantities: Sequence[Any], states: int, limits: Limits, streamed: bool = False
) -> None:
    """Refuse what would take too long or too much memory, before anything is computed.

    ``streamed``: the answer leaves part by part and may have any size. Raises InvalidInput, TooLarge.
    """
    operations, numbers = cost(sources, _known(quantities))
    work, size = states * operations, 8 * states * numbers
    if work > limits.evaluation_operations:
        raise TooLarge("the evaluation (states times operations)", work, limits.evaluation_operations)
    if size > limits.binary_bytes and not streamed:
        raise TooLarge("the answer (in bytes)", size, limits.binary_bytes)


def _known(quantities: Sequence[Any]) -> list[str]:
    """Those that there are; unknown ones are refused later."""
    return list(dict.fromkeys(filter(has_numbers, quantities)))


def bytes_per_state(sources: Sources, quantities: Sequence[Any]) -> int:
    """About the size of the results for one state."""
    return max(1, 8 * cost(sources, _known(quantities))[1])


def as_json(result: Evaluation, digest: str) -> bytes:
    """The answer as JSON; the result of a quantity for a state where it failed is null. ``digest``: of the tree."""
    shown = result.plain(digest)
    for failure in result.failures:
        shown[failure.quantity] = _without(shown[failure.quantity], None if result.single else failure.state)
    return orjson.dumps(shown, option=orjson.OPT_SERIALIZE_NUMPY)


def _without(value: Any, state: int | None) -> Any:
    """The value with null in place of one state; None: there is only one, without a leading axis."""
    if isinstance(value, Mapping):
        return {name: _without(item, state) for name, item in value.items()}
    if state is None:
        return None
    rows: list[Any] = value.tolist() if isinstance(value, np.ndarray) else value
    rows[state] = None
    return rows
