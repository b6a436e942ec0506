"""Numbers for one state or many: limits, and JSON out."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import numpy as np
import orjson

from service.settings import Limits
from substructures.errors import InvalidDocument, TooLarge
from substructures.quantities.evaluation import QUANTITIES, Sources, cost
from substructures.quantities.states import longest


def check_size(sources: Sources, request: Any, limits: Limits, streamed: bool = False) -> None:
    """Refuse what would take too long or too much memory, before anything is computed.

    ``streamed``: the answer leaves part by part and may have any size. Raises InvalidDocument, TooLarge.
    """
    if not isinstance(request, Mapping):
        raise InvalidDocument.at("", "object-expected", "expected a JSON object")
    states = longest(request)
    operations, numbers = cost(sources, _quantities(request))
    work, size = states * operations, 8 * states * numbers
    if work > limits.evaluation_operations:
        raise TooLarge("the evaluation (states times operations)", work, limits.evaluation_operations)
    if size > limits.binary_bytes and not streamed:
        raise TooLarge("the answer (in bytes)", size, limits.binary_bytes)


def _quantities(request: Mapping[str, Any]) -> list[str]:
    """Those that there are; unknown ones are refused later."""
    given = request.get("quantities")
    names = [name for name in given if isinstance(name, str)] if isinstance(given, list) else []
    return [name for name in dict.fromkeys(names) if name in QUANTITIES]


def bytes_per_state(sources: Sources, request: Mapping[str, Any]) -> int:
    """About the size of the results for one state."""
    return max(1, 8 * cost(sources, _quantities(request))[1])


def _is_single(request: Mapping[str, Any]) -> bool:
    """Whether the answer has no axis of states."""
    q = request.get("q")
    columns = list(q.values()) if isinstance(q, Mapping) else q
    has_rows = columns is not None and len(columns) > 0 and np.ndim(columns[0]) > 0
    return not has_rows and longest(request) == 1


def as_json(result: Mapping[str, Any], request: Mapping[str, Any]) -> bytes:
    """The answer as JSON; the result of a quantity for a state where it failed is null."""
    single = _is_single(request)
    shown = dict(result)
    for failure in result["failures"]:
        name = failure["quantity"]
        shown[name] = _without(shown[name], None if single else failure["state"])
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
