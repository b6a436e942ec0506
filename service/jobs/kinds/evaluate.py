"""evaluate: numbers of a tree for many states, in items of bounded size.

An item given is ``{"tree", "request", "grid" | "sample", "format"}``; ``request`` is the body of an evaluation, whose
states are listed there, or described by a grid or a sample (:mod:`service.jobs.kinds.states`; coordinates that are not
named there are 0). ``format``: npz, or arrow (:mod:`substructures.formats.arrow`). Its parts have a field ``range``,
the first state and the one behind the last. Of uploaded states (:mod:`service.operations.jobs.uploads`) an item
has its chunk: ``states`` is the digest of the npz file with the columns.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from importlib import import_module
from importlib.util import find_spec
from io import BytesIO
from typing import Any

import numpy as np

from service.content.cache import Cache
from service.jobs.engines.engine import Outcome
from service.jobs.kinds.decoded import summary_of
from service.jobs.kinds.items import STATES, Evaluated
from service.jobs.kinds.joint_limits import joint_limits
from service.jobs.kinds.kind import Blobs, ItemProgress, Kind, inside, known_tree
from service.jobs.kinds.library import Library, StoredTree
from service.jobs.kinds.states import grid_size, grid_states, read_grid, read_sample, sample_states, states_per_item
from service.jobs.kinds.trees import pinned, sources_of
from service.jobs.kinds.values import check_described, check_states, without_formulas
from service.schemas.jobs import ItemDocument
from service.schemas.numbers import EvaluationRequest
from service.settings import Limits
from substructures.array import Array
from substructures.compile import Kernel, compile_program
from substructures.compile.kernel import NO_PLACES, Places
from substructures.documents import pointer_step, read_model
from substructures.documents.grouped import take
from substructures.errors import Fault, InvalidDocument
from substructures.expr.program import Program
from substructures.formats.arrays import as_npz, read_npz
from substructures.formats.columns import request_of
from substructures.mechanics.state_names import resting_state
from substructures.quantities.numbers.evaluation import EvaluationOptions, evaluate, interpreted
from substructures.quantities.quantity import LABELS, needs_parts
from substructures.quantities.sources import read_quantities
from substructures.tree.given.ties import require_chains
from substructures.tree.model import Model

#: what an answer says beside quantities and states
ABOUT = ("coordinates", "digest", *LABELS, "warnings")
#: From so many states an item is worth a compiled kernel, which the next item of the same tree finds.
COMPILED = 1000
#: warnings in the summary of an item; its result has all
MOST_WARNINGS = 20
CAPACITY = 2_000_000

_kernels: Cache[Kernel] = Cache(
    CAPACITY, lambda kernel: 100 + 10 * sum(len(o.entries) for o in kernel.outputs.values())
)


def _spread(item: ItemDocument, limits: Limits, library: Library) -> list[ItemDocument]:
    read = read_model(Evaluated, item)
    tree = known_tree(item, library)
    summary = summary_of(tree.summary)
    request = _request(read, without_formulas(summary))
    chunk = states_per_item(request.quantities, len(summary["coordinates"]), len(summary["frames"]), limits)
    described = _described(read, request, tree, summary, library)
    with inside("/request"):
        count = _count(summary, request, described)
    if count is not None and count > chunk * limits.job_items:
        message = f"{count:,} states; the limit is {chunk * limits.job_items:,}"
        raise InvalidDocument.at("/" + next(iter(described or ("request",))), "too-many-states", message)
    common = {
        "tree": item["tree"],
        "format": read.format,
        "request": request.given(),
        "nodes": limits.job_nodes,
    }
    if count is None:
        return [common]
    given = _in_rows(request.given(), summary["coordinates"])
    ranges = [[start, min(start + chunk, count)] for start in range(0, count, chunk)]
    return [{**common, **described, "request": _sliced(given, count, *each), "range": each} for each in ranges]


def _request(item: Evaluated, model: Model) -> EvaluationRequest:
    """The request of an item, numbers in SI; ``model``: without formulas. Raises InvalidInput."""
    if item.format == "arrow" and find_spec("pyarrow") is None:
        how = "pip install 'substructures[arrow]' (in a clone: pip install -e '.[arrow]')"
        message = f"Arrow needs the extra 'arrow' on the server: {how}"
        raise InvalidDocument.at("/format", "not-installed", message)
    with inside("/request"):
        read = EvaluationRequest.read(item.request)
        read_quantities(read.quantities)
        return read.in_si(model)


def _described(
    item: Evaluated, request: EvaluationRequest, tree: StoredTree, summary: Mapping[str, Any], library: Library
) -> ItemDocument:
    """The grid or sample, complete; empty when the states are listed."""
    model = without_formulas(summary)
    known = model.units | model.state_units["q"] | {f"{c}'": unit for c, unit in model.state_units["qd"].items()}
    if item.grid is not None:
        grid = read_grid(item.grid, known)
        _check_once(request, "/grid", [name for name, _ in grid])
        return {"grid": grid}
    if item.sample is not None:
        require_chains(model.balls, "give 'q' in lists, or a grid", "/sample")
        # not of what is given, or follows from loops
        limits = {name: limit for name, limit in joint_limits(tree, library).items() if name in known}
        sample = read_sample(item.sample, known, limits)
        _check_once(request, "/sample/ranges", sample["ranges"])
        return {"sample": sample}
    return {}


def _check_once(request: EvaluationRequest, place: str, names: Iterable[str]) -> None:
    """Raise InvalidDocument for names that the request has as well."""
    fields = (request.inputs, request.parameters)
    given = {name for field in fields if isinstance(field, Mapping) for name in field}
    faults = [
        Fault(place + pointer_step(name), "given-twice", f"'{name}' is given in the request as well")
        for name in names
        if name in given
    ]
    if faults:
        raise InvalidDocument(faults)


def _count(summary: Mapping[str, Any], request: EvaluationRequest, described: ItemDocument) -> int | None:
    """The number of states, None for one without a leading axis. Raises InvalidDocument."""
    if not described:
        states = check_states(summary, request)
        return None if states.single else states.count
    count = grid_size(described["grid"]) if "grid" in described else int(described["sample"]["count"])
    check_described(summary, request, count)
    return count


def _in_rows(request: Mapping[str, Any], coordinates: Sequence[str]) -> dict[str, Any]:
    """The request with a row for each state where one coordinate has numbers, which are states of it."""

    def rows(value: Any) -> Any:
        """A number, or so many, in rows."""
        flat = value if isinstance(value, list) else [value]
        is_plain = len(coordinates) == 1 and not any(x is None or isinstance(x, list | Mapping) for x in flat)
        return [[x] for x in flat] if is_plain else value

    states = {name: rows(x) for name, x in request.items() if name in ("q", "qd", "qdd")}
    return {**request, **states, **({"along": _in_rows(x, coordinates)} if (x := request.get("along")) else {})}


def _sliced(request: Mapping[str, Any], count: int, start: int, stop: int) -> dict[str, Any]:
    """The request for some of its states: what is given for each of them is cut."""

    def cut(field: str, value: Any) -> Any:
        """What belongs to the states of the slice."""
        if isinstance(value, Mapping):
            return {name: cut(name if field == "along" else "", each) for name, each in value.items()}
        is_flat = isinstance(value, list) and not (value and isinstance(value[0], list))
        belongs_to_all = field in ("quantities", "joints") or (field in ("q", "qd", "qdd") and is_flat)
        is_cut = isinstance(value, list) and len(value) == count and not belongs_to_all
        return value[start:stop] if is_cut else value

    parts = {name: cut(name, value) for name, value in request.items()}
    return {**parts, "q": _with_axis(parts["q"])} if parts.get("q") else parts


def _with_axis(q: Any) -> Any:
    """One row of coordinates as a list of one row: part of many states, it must not pass for the only one."""
    if isinstance(q, Mapping):
        return {name: x if isinstance(x, list) else [x] for name, x in q.items()}
    return q if isinstance(q[0], list) else [q]


def _resolve(item: ItemDocument, library: Library) -> tuple[ItemDocument, tuple[str, ...]]:
    quantities = EvaluationRequest.read(item["request"]).quantities
    found, blobs = pinned(item, library, item["nodes"], any(map(needs_parts, quantities)))
    return found, (*blobs, item["states"]) if "states" in item else blobs


def _run(item: ItemDocument, blobs: Blobs, progress: ItemProgress) -> Outcome:
    """File ``result``: the answer of an evaluation, and the states where they were described as ``states.<name>``."""
    sources = sources_of(item, blobs)
    model = sources.model
    progress(0.1)
    columns = _columns(item)
    request = EvaluationRequest.read(_with_columns(model, _uploaded(item, blobs), columns))
    first = item["range"][0] if "range" in item else 0
    given = {**request.arguments(), "evaluator": _evaluator, "first": first}
    found = evaluate(sources, options=take(EvaluationOptions, given), **given)
    answer = found.plain()
    progress(0.9)
    data = _written({**answer, "states": columns} if columns else answer, item["format"], "range" in item)
    summary = {
        "tree": item["tree"],
        "range": item.get("range", [0, 1]),
        "media_type": STATES[item["format"]],
        "bytes": len(data),
        "failures": len(answer["failures"]),
        "warnings": answer["warnings"][:MOST_WARNINGS],
    }
    return Outcome(summary, {"result": data})


def _written(answer: dict[str, Any], form: str, has_axis: bool) -> bytes:
    """The file of an answer; as Arrow always with an axis for the states."""
    if form == "npz":
        return b"".join(as_npz(answer).pieces)
    names = [name for name in answer if name not in (*ABOUT, "count", "failures", "warnings")]
    rows = answer if has_axis else {**answer, **{name: _row(answer[name]) for name in names}}
    arrow = import_module("substructures.formats.arrow")  # an extra; most runners need not load it
    metadata = {name: answer[name] for name in ABOUT if name in answer} | {"quantities": names}
    return b"".join(arrow.write_tables([arrow.table_of(rows, names)], metadata))


def _row(value: Any) -> Any:
    return {name: _row(x) for name, x in value.items()} if isinstance(value, Mapping) else np.asarray(value)[np.newaxis]


def _uploaded(item: ItemDocument, blobs: Blobs) -> dict[str, Any]:
    """The request with the states that were uploaded for the item."""
    request: dict[str, Any] = item["request"]
    if "states" not in item:
        return request
    content = blobs[item["states"]]
    return request_of(request, read_npz(BytesIO(content), len(content)))


def _columns(item: ItemDocument) -> dict[str, Array]:
    if "grid" in item:
        return grid_states(item["grid"], *item["range"])
    return sample_states(item["sample"], *item["range"]) if "sample" in item else {}


def _with_columns(model: Model, request: Mapping[str, Any], columns: Mapping[str, Array]) -> dict[str, Any]:
    if not columns:
        return dict(request)
    zeros = np.zeros(len(next(iter(columns.values()))))
    resting = zip(model.positions, resting_state(model.positions, model.balls), strict=True)
    places = {*model.positions, *(f"{name}'" for name in model.coordinates)}
    rest = {name: x for name, x in columns.items() if name not in places}
    inputs = {name: x for name, x in rest.items() if name in model.input_names}
    return {
        **request,
        "q": {name: columns.get(name, zeros + x) for name, x in resting},
        "qd": {name: columns.get(f"{name}'", zeros) for name in model.coordinates},
        "inputs": {**(request.get("inputs") or {}), **inputs},
        "parameters": {**(request.get("parameters") or {}), **{n: x for n, x in rest.items() if n not in inputs}},
    }


def _evaluator(
    program: Program, values: Mapping[str, Any], names: list[str], states: int, places: Places = NO_PLACES, /
) -> dict[str, Array]:
    """Which engine answers depends on the item alone, so that its numbers never depend on what came before."""
    if states < COMPILED:
        return interpreted(program, values, names, states, places)
    key = program.digest, tuple(names)
    kernel = _kernels.get(key)
    if kernel is None:
        kernel = compile_program(program, names)
        _kernels.put(key, kernel)
    return kernel.evaluate(values, threads=1, places=places)


KINDS = {"evaluate": Kind(_spread, _resolve, _run)}
