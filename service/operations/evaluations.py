"""Numbers for many states: JSON or npz in and out."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import numpy as np
import orjson

from service.arrays import read_npz
from service.settings import Limits
from substructures.errors import InvalidDocument, TooLarge
from substructures.evaluation import QUANTITIES, Engine, evaluate, numbers_per_state
from substructures.model import Model

_FLAT_INPUTS = ("inputs", "parameters")


def compute(model: Model, request: Any, limits: Limits, engine: Engine) -> dict[str, Any]:
    """Arrays by name, and ``failures``. Raises InvalidDocument, MissingValue, TooLarge."""
    if not isinstance(request, Mapping):
        raise InvalidDocument.at("", "object-expected", "expected a JSON object")
    check_size(model, request, limits)
    return evaluate(model, request, limits.states, engine)


def check_size(model: Model, request: Mapping[str, Any], limits: Limits) -> None:
    """Refuse what would take too long or too much memory, before anything is computed."""
    states = _states(request.get("q")) or 1
    given = request.get("quantities")
    names = {name for name in given if isinstance(name, str)} & QUANTITIES.keys() if isinstance(given, list) else set()
    needs = {output for name in names for output in QUANTITIES[name].needs}
    work = states * len(model.program.reachable(needs))
    if work > limits.evaluation_operations:
        raise TooLarge("the evaluation (states times operations)", work, limits.evaluation_operations)
    size = 8 * states * numbers_per_state(names, len(model.coordinates), len(model.frames))
    if size > limits.binary_bytes:
        raise TooLarge("the answer (in bytes)", size, limits.binary_bytes)


def _states(q: Any) -> int | None:
    """The number of states, None for one without a leading axis; what is wrong with them is found later."""
    columns = list(q.values()) if isinstance(q, Mapping) else [q]
    lists = [c for c in columns if isinstance(c, list | tuple | np.ndarray)]
    if isinstance(q, Mapping):
        return max(map(len, lists)) if lists else None
    is_batch = bool(lists) and len(q) > 0 and isinstance(q[0], list | tuple | np.ndarray)
    return len(q) if is_batch else None


def read_npz_request(data: bytes, limits: Limits) -> dict[str, Any]:
    """A request from npz arrays: ``q, qd, qdd, t, quantities``, ``inputs.<name>`` and ``parameters.<name>``."""
    request: dict[str, Any] = {}
    for name, array in read_npz(data, limits.binary_bytes).items():
        group, _, key = name.partition(".")
        if array.dtype.kind == "U":
            request[name] = array.tolist()
        elif group in _FLAT_INPUTS and key:
            request.setdefault(group, {})[key] = array
        else:
            request[name] = array
    return request


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
