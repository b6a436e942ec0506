"""Large evaluations: requests from npz and Arrow, answered as npz, or part by part in bounded memory as Arrow."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping
from itertools import chain
from typing import IO, Any

import numpy as np

from service.schemas.numbers import EvaluationRequest
from service.settings import Limits
from substructures.array import Array
from substructures.documents import read_json
from substructures.errors import InvalidDocument, TooLarge
from substructures.formats import arrow
from substructures.formats.arrays import flat, read_npz
from substructures.formats.columns import request_of
from substructures.tree.model import (
    Model,
)  #: fields that the metadata of an Arrow schema may give, as JSON: what is the same for all states

_CONSTANTS = ("quantities", "parameters", "inputs", "along", "t", "packed", "float32", "joints")


def npz_request(file: IO[bytes], limits: Limits) -> EvaluationRequest:
    """The request in an npz file: ``q, qd, qdd, t, quantities``, ``inputs.<name>``, ``parameters.<name>``, ..."""
    arrays = read_npz(file, limits.binary_bytes)
    columns = {name: a.tolist() if a.dtype.kind in "Ub" else a for name, a in arrays.items()}
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


def _without(answer: Mapping[str, Any], names: Iterable[str]) -> dict[str, Any]:
    """What an answer says beside the quantities and single states: coordinates, digest, ..."""
    return {key: value for key, value in answer.items() if key not in {*names, "failures", "warnings"}}


def as_arrow(answers: Iterable[Iterable[Mapping[str, Any]]], quantities: Iterable[str]) -> Iterator[memoryview | bytes]:
    """The answer as an Arrow stream: a record batch for every part, null where a state has no result.

    Warnings about the values of a part stand in its rows, since what comes first was sent before these were known.
    """
    names, rest = list(dict.fromkeys(quantities)), _each_told_once(chain.from_iterable(answers))
    first = next(rest)
    metadata = {**_without(first, [*names, "count"]), "quantities": names}
    return arrow.write_tables((arrow.table_of(answer, names) for answer in chain([first], rest)), metadata)


def _each_told_once(answers: Iterable[Mapping[str, Any]]) -> Iterator[Mapping[str, Any]]:
    """The same, with each warning that is about no single state in the first of them that has it."""
    told = list[Mapping[str, Any]]()
    for answer in answers:
        new = [each for each in answer["warnings"] if "state" in each or each not in told]
        told += [each for each in new if "state" not in each]
        yield {**answer, "warnings": new}
