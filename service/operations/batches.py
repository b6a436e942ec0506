"""Large evaluations: requests from npz and Arrow, answered as npz, or part by part in bounded memory as Arrow."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator, Mapping
from itertools import chain
from typing import IO, Any

import numpy as np

from service.operations import evaluations
from service.schemas.numbers import EvaluationRequest
from service.settings import Limits
from substructures.array import Array
from substructures.documents import pointer_step, read_json
from substructures.errors import InvalidDocument, TooLarge
from substructures.formats import arrow
from substructures.formats.arrays import flat, read_npz
from substructures.formats.columns import has_rows, request_of
from substructures.quantities.evaluation import Sources
from substructures.quantities.measured import numeric
from substructures.quantities.states import read_states
from substructures.tree.model import Model

PART = 4 * 2**20  # bytes of results that are computed, and then sent, at a time
#: fields that the metadata of an Arrow schema may give, as JSON: what is the same for all states
_CONSTANTS = ("quantities", "parameters", "inputs", "along", "t")

#: of a request, and the number of its first state
Evaluate = Callable[[EvaluationRequest, int], Mapping[str, Any]]


def npz_request(file: IO[bytes], limits: Limits) -> EvaluationRequest:
    """The request in an npz file: ``q, qd, qdd, t, quantities``, ``inputs.<name>``, ``parameters.<name>``, ..."""
    arrays = read_npz(file, limits.binary_bytes)
    columns = {name: a.tolist() if a.dtype.kind == "U" else a for name, a in arrays.items()}
    return EvaluationRequest.read(request_of({}, columns))


def arrow_requests(file: IO[bytes], limits: Limits) -> Iterator[EvaluationRequest]:
    """One request for each record batch: arrays are columns, the rest JSON in the metadata of the schema."""
    reader, states = arrow.Reader(file, limits.binary_bytes), 0
    constants = {name: read_json(reader.metadata[name]) for name in _CONSTANTS if name in reader.metadata}
    for columns in reader:
        count = max((len(column) for column in columns.values()), default=0)
        states += count
        if states > limits.stream_states:
            raise TooLarge("the number of states", states, limits.stream_states)
        if count:
            yield EvaluationRequest.read(request_of(constants, columns))
    if not states:
        raise InvalidDocument.at("/q", "missing", "the stream has no states")


def joined(model: Model, requests: Iterable[EvaluationRequest], limits: Limits) -> EvaluationRequest:
    """One request of all record batches, for an answer in one piece. Raises TooLarge, InvalidArgument."""
    kept, size = [], 0
    for request in requests:
        kept.append(request)
        size += sum(column.nbytes for column in _arrays(request).values())
        if size > limits.binary_bytes:
            raise TooLarge("the request (in bytes; an answer as Arrow has no such limit)", size, limits.binary_bytes)
    if len(kept) == 1:
        return kept[0]
    batches = [_arrays(request) for request in kept]
    columns = {name: np.concatenate([each[name] for each in batches]) for name in batches[0]}
    return EvaluationRequest.read(request_of({}, flat(kept[0].in_si(model).given()) | columns))


def _arrays(request: EvaluationRequest) -> dict[str, Array]:
    return {name: column for name, column in flat(request.given()).items() if isinstance(column, np.ndarray)}


def split(sources: Sources, request: EvaluationRequest, limits: Limits) -> Iterable[EvaluationRequest]:
    """Check the numbers of a request, and cut it into parts whose results are of moderate size and have a leading axis
    also for a single state. Raises InvalidInput.
    """
    request = request.in_si(sources.model)
    states = read_states(sources.model, request.arguments(), limits.states)
    given = {**request.given(), "q": states.q}
    if states.single:
        return [EvaluationRequest.read(given)]
    count, size = states.count, max(1, PART // evaluations.bytes_per_state(sources, request.quantities))
    fields = {name: _numbers(value, pointer_step(name)) for name, value in given.items() if name != "quantities"}
    if not set(_lengths(fields, "")) <= {1, count}:  # the evaluation says which one is wrong
        return [EvaluationRequest.read(given)]
    quantities = {"quantities": request.quantities}
    parts = (_cut(fields, slice(i, i + size), count, "") for i in range(0, max(1, count), size))
    return (EvaluationRequest.read(part | quantities) for part in parts)


def _numbers(value: Any, pointer: str) -> Any:
    if isinstance(value, Mapping):
        return {name: _numbers(item, pointer + pointer_step(name)) for name, item in value.items()}
    return numeric(value, pointer) if isinstance(value, list | tuple | np.ndarray) else value


def _lengths(fields: Mapping[str, Any], above: str) -> Iterator[int]:
    for name, value in fields.items():
        pointer = above + pointer_step(name)
        if isinstance(value, Mapping):
            yield from _lengths(value, pointer)
        elif has_rows(value, pointer):
            yield len(value)


def _cut(fields: Mapping[str, Any], some: slice, count: int, above: str) -> dict[str, Any]:
    part = {}
    for name, value in fields.items():
        pointer = above + pointer_step(name)
        if isinstance(value, Mapping):
            part[name] = _cut(value, some, count, pointer)
        else:
            part[name] = value[some] if has_rows(value, pointer) and len(value) == count else value
    return part


def _without(answer: Mapping[str, Any], names: Iterable[str]) -> dict[str, Any]:
    """What an answer says beside the quantities and single states: coordinates, digest, ..."""
    return {key: value for key, value in answer.items() if key not in {*names, "failures", "warnings"}}


def as_arrow(
    evaluate: Evaluate, cuts: Iterable[Iterable[EvaluationRequest]], quantities: Iterable[str]
) -> Iterator[memoryview | bytes]:
    """The answer as an Arrow stream: a record batch for every part, null where a state has no result.

    Warnings about the values of a part stand in its rows, since what comes first was sent before these were known.
    """
    names = list(dict.fromkeys(quantities))
    answers = _answers(evaluate, (part for cut in cuts for part in cut))
    first = next(answers)
    metadata = {**_without(first, [*names, "count"]), "quantities": names}
    return arrow.write_tables((arrow.table_of(answer, names) for answer in chain([first], answers)), metadata)


def _answers(evaluate: Evaluate, parts: Iterable[EvaluationRequest]) -> Iterator[Mapping[str, Any]]:
    """The answers one after the other; a warning that is about no single state is told once."""
    start, told = 0, list[Mapping[str, Any]]()
    for part in parts:
        answer = evaluate(part, start)
        new = [each for each in answer["warnings"] if "state" in each or each not in told]
        told += [each for each in new if "state" not in each]
        start += answer["count"]
        yield {**answer, "warnings": new}
