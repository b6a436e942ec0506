"""Numbers for one state or many: limits, and JSON out."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import numpy as np
import orjson

from service.settings import Limits
from substructures.errors import InvalidDocument, TooLarge
from substructures.evaluation import QUANTITIES
from substructures.model import Model

# dimensions of the answer for one state; what is not listed has one
_DIMENSIONS = {
    "metric": 2,
    "coriolis": 2,
    "christoffel": 3,
    "kinetic_energy": 0,
    "potential_energy": 0,
}


def check_size(model: Model, request: Any, limits: Limits, streamed: bool = False) -> None:
    """Refuse what would take too long or too much memory, before anything is computed.

    ``streamed``: the answer leaves part by part and may have any size. Raises InvalidDocument, TooLarge.
    """
    if not isinstance(request, Mapping):
        raise InvalidDocument.at("", "object-expected", "expected a JSON object")
    states = _states(request.get("q")) or 1
    needs = {output for name in _quantities(request) for output in QUANTITIES[name].needs}
    work = states * len(model.program.reachable(needs))
    if work > limits.evaluation_operations:
        raise TooLarge("the evaluation (states times operations)", work, limits.evaluation_operations)
    size = states * bytes_per_state(model, request)
    if size > limits.binary_bytes and not streamed:
        raise TooLarge("the answer (in bytes)", size, limits.binary_bytes)


def _quantities(request: Mapping[str, Any]) -> set[str]:
    """Those that there are; unknown ones are refused later."""
    given = request.get("quantities")
    names = {name for name in given if isinstance(name, str)} if isinstance(given, list) else set()
    return names & QUANTITIES.keys()


def bytes_per_state(model: Model, request: Mapping[str, Any]) -> int:
    """About the size of the results for one state."""
    n, frames = max(1, len(model.coordinates)), len(model.frames)
    sizes = {"kinematics": frames * (12 + 6 * n)} | {name: n**k for name, k in _DIMENSIONS.items()}
    return max(1, 8 * sum(sizes.get(name, n) for name in _quantities(request)))


def _states(q: Any) -> int | None:
    """The number of states, None for one without a leading axis; what is wrong with them is found later."""
    columns = list(q.values()) if isinstance(q, Mapping) else [q]
    lists = [c for c in columns if isinstance(c, list | tuple | np.ndarray)]
    if isinstance(q, Mapping):
        return max(map(len, lists)) if lists else None
    is_batch = bool(lists) and len(q) > 0 and isinstance(q[0], list | tuple | np.ndarray)
    return len(q) if is_batch else None


def as_json(result: Mapping[str, Any], request: Mapping[str, Any]) -> bytes:
    """The answer as JSON; the result of a quantity for a state where it failed is null."""
    single = _states(request.get("q")) is None
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
