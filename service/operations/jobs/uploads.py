"""States that are uploaded for a job: checked, cut into chunks, and on the disk before the job is queued.

Every chunk is an npz file of the columns that have a row for every state, stored by its sha256; an item of the job has
one chunk and the range of its states. Equal chunks are stored once, and equal items are computed once.
"""

from __future__ import annotations

import hashlib
from collections.abc import Iterable, Iterator, Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np

from service.jobs.kinds.states import states_per_item
from service.messages.viewer import Viewer
from service.operations.jobs import jobs
from service.operations.jobs.submission import JobSubmission
from service.queries.jobs.uploads import put_uploads
from service.queries.trees import Tree
from service.schemas.numbers import EvaluationRequest
from service.settings import Limits
from service.store.store import Store
from substructures.array import Array
from substructures.errors import InvalidDocument, InvalidInput
from substructures.formats.arrays import flat, write_npz
from substructures.formats.columns import ColumnRequest, parted, pointer_of, request_of
from substructures.quantities.numbers.asked import check
from substructures.quantities.sources import Sources

TOGETHER = 8 * 2**20  # bytes that are written in one transaction


@dataclass(frozen=True, slots=True)
class _Chunk:
    """States ``start`` to ``stop``: columns with a row for each of them, and what is the same for all."""

    rows: Mapping[str, Array]
    constants: ColumnRequest
    start: int
    stop: int
    single: bool


def prepare(
    store: Store, viewer: Viewer, tree: Tree, sources: Sources, requests: Iterable[EvaluationRequest], form: str
) -> JobSubmission:
    """Store the states of requests (one, or one for each record batch) and resolve the items that evaluate them.

    ``form``: npz or arrow, the format of the results. Raises InvalidDocument with the place of the array among all
    states, MissingValue, TooLarge, and Refused 503 as soon as there are more items than the queue has room for.
    """
    limits, written = store.settings.limits, dict[str, bytes]()
    items: list[dict[str, Any]] = []
    digests: list[str] = []
    common = {"tree": f"{tree.name}@{tree.revision}", "format": form, "nodes": limits.job_nodes}
    for chunk in _chunks(sources, requests, limits):  # the first is stored at once, which shows whether there is room
        item = {**common, "request": chunk.constants}
        if not chunk.single:
            item["range"] = [chunk.start, chunk.stop]
        if chunk.rows:
            content = b"".join(write_npz(chunk.rows).pieces)
            digests.append("sha256:" + hashlib.sha256(content).hexdigest())
            item["states"] = digests[-1]
            written[digests[-1]] = content
        items.append(item)
        if len(items) == 1 or sum(map(len, written.values())) > TOGETHER:
            _write(store, written, len(items), viewer.key)
    _write(store, written, len(items), viewer.key)
    return jobs.prepare_items(store, viewer, "evaluate", items, digests)


def _write(store: Store, contents: dict[str, bytes], items: int, principal: str) -> None:
    with store.database.write() as connection:
        jobs.require_room(connection, items, principal, store.settings.limits)
        store.usage.take(connection, "upload", principal, sum(map(len, contents.values())))
        put_uploads(connection, contents, principal)
    contents.clear()


def _chunks(sources: Sources, requests: Iterable[EvaluationRequest], limits: Limits) -> Iterator[_Chunk]:
    """Chunks of equal size, however the states arrive."""
    model, start, carried = sources.model, 0, dict[str, Array]()
    size, constants, single = 0, dict[str, Any](), False
    for request in requests:
        rows, constants, single = _parted(sources, request, start + _length(carried))
        size = size or states_per_item(request.quantities, model.dof, len(model.frames), limits)
        carried = {name: np.concatenate([carried[name], x]) if carried else x for name, x in rows.items()}
        for stop in range(size, _length(carried), size):
            part = {name: x[stop - size : stop] for name, x in carried.items()}
            yield _Chunk(part, constants, start, start + size, single)
            start += size
            if start >= size * limits.job_items:
                message = f"more than {size * limits.job_items:,} states; submit several jobs"
                raise InvalidDocument.at("/q", "too-many-states", message)
        done = max(0, (_length(carried) - 1) // size * size)
        carried = {name: x[done:] for name, x in carried.items()}
    yield _Chunk(carried, constants, start, start + (_length(carried) if carried else 1), single)


def _length(rows: Mapping[str, Array]) -> int:
    return len(next(iter(rows.values()))) if rows else 0


def _parted(sources: Sources, request: EvaluationRequest, first: int) -> tuple[dict[str, Array], dict[str, Any], bool]:
    """The columns with a row for every state, what is the same for all, and whether it is one state without an axis.

    ``first``: how many states came before.
    """
    request = request.in_si(sources.model)
    rows, rest = parted(flat(request.given()))
    count = _length(rows) if rows else 1
    try:
        states = check(sources, **request.arguments())
    except InvalidInput as error:
        raise error.moved(lambda pointer: _moved(pointer, rows, first)) from None
    if states.count != count:
        message = f"{states.count:,} values in the metadata where there are {count:,} states"
        raise InvalidDocument.at("", "wrong-length", message)
    constants = {name: x.tolist() if isinstance(x, np.ndarray) else x for name, x in rest.items()}
    return rows, request_of({}, constants), states.single


def _moved(pointer: str, rows: Iterable[str], first: int) -> str:
    """The pointer with the number of the state among all that were sent."""
    for place in map(pointer_of, rows):
        index, *rest = pointer.removeprefix(f"{place}/").split("/")
        if pointer.startswith(f"{place}/") and index.isdigit():
            return "/".join([place, str(int(index) + first), *rest])
    return pointer
