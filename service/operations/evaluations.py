"""Numbers for many states: JSON or npz in and out."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import numpy as np
import orjson

from service.arrays import flat, read_npz, write_npz
from service.settings import Limits
from substructures.errors import InvalidDocument, TooLarge
from substructures.evaluation import QUANTITIES, Engine, Sources, cost, evaluate
from substructures.model import Model

_OBJECTS = ("along.inputs", "along", "inputs", "parameters")


def compute(
    model: Model, request: Any, limits: Limits, engine: Engine, sources: Sources | None = None
) -> dict[str, Any]:
    """Arrays by name, and ``failures``. Raises InvalidDocument, MissingValue, TooLarge.

    ``sources``: where derived programs are kept, and the regressor, which cannot be had from a model alone.
    """
    if not isinstance(request, Mapping):
        raise InvalidDocument.at("", "object-expected", "expected a JSON object")
    check_size(model, request, limits, sources)
    return evaluate(model, request, limits.states, engine, sources)


def check_size(model: Model, request: Mapping[str, Any], limits: Limits, sources: Sources | None = None) -> None:
    """Refuse what would take too long or too much memory, before anything is computed."""
    states = _states(request.get("q")) or 1
    given = request.get("quantities")
    names = [name for name in given if isinstance(name, str) and name in QUANTITIES] if isinstance(given, list) else []
    operations, numbers = cost(sources or Sources(model), names)
    work, size = states * operations, 8 * states * numbers
    if work > limits.evaluation_operations:
        raise TooLarge("the evaluation (states times operations)", work, limits.evaluation_operations)
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
    """A request from npz arrays: ``q, qd, qdd, t, quantities``, ``inputs.<name>``, ``parameters.<name>``, ``along.q``,
    ``along.qd``, ``along.qdd`` and ``along.inputs.<name>``."""
    request: dict[str, Any] = {}
    for name, array in read_npz(data, limits.binary_bytes).items():
        place = request
        group = next((each for each in _OBJECTS if name.startswith(f"{each}.")), "")
        for step in filter(None, group.split(".")):
            place = place.setdefault(step, {})
            if not isinstance(place, dict):
                raise InvalidDocument.at(f"/{step}", "object-expected", f"both '{step}' and '{name}' are given")
        place[name[len(group) + 1 :] if group else name] = array.tolist() if array.dtype.kind == "U" else array
    return request


def as_npz(result: Mapping[str, Any]) -> bytes:
    """The answer as npz; nested names are joined by dots, ``failures`` become parallel arrays."""
    failures = result["failures"]
    columns = {key: [str(f[key]) for f in failures] for key in ("quantity", "code", "message")}
    return write_npz(flat({**result, "failures": {"state": [f["state"] for f in failures], **columns}}))


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
