"""Submit, look at and cancel jobs. Everything is checked and resolved before anything is queued."""

from __future__ import annotations

import secrets
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import replace
from time import sleep
from typing import Any

from service.content.derivation import release
from service.database.connections import Connection
from service.jobs import kinds
from service.jobs.files import document_of
from service.messages.refusals import SHOWN, Refused, not_found
from service.messages.viewer import Viewer
from service.operations.jobs.submission import JobSubmission, Skipped, key_of
from service.operations.library import Reader, StoreLibrary
from service.operations.owners import require
from service.queries import audit
from service.queries.jobs import jobs, uploads
from service.queries.jobs.jobs import Job, NewItem
from service.queries.removal import remove_job
from service.schemas.jobs import SubmittedItems
from service.settings import Limits
from service.store.store import Store
from substructures.documents import require_object, write_json
from substructures.errors import Fault, InvalidDocument, InvalidInput, TooLarge

NAMING = ("assemble", "derive", "upgrade")  # kinds whose results are trees and versions, of which every item names one
STORING = (*NAMING, "mirror")  # kinds that need the right to write
AFRESH = ("assemble", "upgrade", "verify", "mirror")  # kinds whose results are about a store that goes on changing
YIELD = 8  # items that are resolved at a stretch


def prepare(store: Store, viewer: Viewer, body: Any, members: Mapping[str, Any] | None = None) -> JobSubmission:
    """Resolve all items of ``{"kind", "items"}``; ``members`` are added to each.

    Raises InvalidDocument or Refused 422 with pointers to the items; nothing is queued then.
    """
    require_object(body)
    asked = kinds.submission(body)
    with store.database.read() as connection:
        library = StoreLibrary(connection, viewer, store.settings.mirror_sources, _reader(store, viewer))
        skipped: list[Skipped] = []
        if isinstance(asked, SubmittedItems) and asked.on_invalid == "skip":
            items, skipped = _good(asked, library, store.settings.limits)
        else:
            expanded = kinds.expand(asked, store.settings.limits, library)
            items = _resolved(asked.kind, expanded, library, _places(body, len(expanded)), members or {})
        if asked.shared and library.private:
            private = ", ".join(f"'{name}'" for name in sorted(library.private)[:SHOWN])
            message = f"every key would see the results, and private is {private}; make it public, or do not share"
            raise InvalidDocument.at("/shared", "private-part", message)
        return JobSubmission(asked.kind, items, shared=asked.shared, skipped=skipped, label=asked.whole_label)


def _reader(store: Store, viewer: Viewer) -> Reader:
    """What reads the robot files of a submission: a worker, which may take for all of them what an item may."""
    worker, limit = store.job_worker(viewer.owner), store.settings.limits.job_cpu_seconds

    def read(given: Mapping[str, Any]) -> Mapping[str, Any]:
        """The document. Raises InvalidDocument, Refused 503."""
        try:
            return document_of(worker, given)
        except TimeoutError:
            detail = "to read the files of this submission takes longer than an item of a job may; send fewer of them"
            raise Refused(503, "took-too-long", detail, limit=limit) from None

    return read


def _good(asked: SubmittedItems, library: StoreLibrary, limits: Limits) -> tuple[list[NewItem], list[Skipped]]:
    """The items that can be computed, and those that cannot. Raises InvalidDocument, Refused where none can."""
    good: list[NewItem] = []
    bad: list[Skipped] = []
    for k, (_, item) in enumerate(kinds.given(asked, limits.job_items)):
        try:
            expanded = kinds.expand(SubmittedItems(kind=asked.kind, items=[item]), limits, library)
            good += _resolved(asked.kind, expanded, library, iter([("", "")] * len(expanded)), {})
        except (InvalidInput, Refused) as error:
            if isinstance(error, Refused) and error.status >= 500:
                raise
            bad.append(Skipped(k, [replace(f, pointer=f.pointer.removeprefix("/items/0")) for f in error.faults]))
        if len(good) > limits.job_items:
            message = f"more than {limits.job_items:,} items after splitting; submit several jobs"
            raise InvalidDocument.at("/items", "too-many-items", message)
    if not good:
        faults = [replace(f, pointer=f"/items/{each.item}{f.pointer}") for each in bad for f in each.faults]
        detail = f"none of {len(bad)} items can be computed, so nothing was queued: {faults[0]}"
        raise Refused(422, "invalid-items", detail, faults[:SHOWN], count=len(faults))
    return good, bad


def prepare_items(
    store: Store, viewer: Viewer, kind: str, items: Sequence[Mapping[str, Any]], digests: Sequence[str]
) -> JobSubmission:
    """Resolve items that are expanded, and that refer to states uploaded before. Raises as :func:`prepare`."""
    with store.database.read() as connection:
        resolved = _resolved(kind, items, StoreLibrary(connection, viewer), _places({}, len(items)), {})
    return JobSubmission(kind, resolved, digests)


def prepare_one(
    store: Store, viewer: Viewer, kind: str, item: Any, step: str = "", members: Mapping[str, Any] | None = None
) -> JobSubmission:
    """A job of one item in place of a request; ``step`` is where the body of the request is in the item. Raises as
    :func:`prepare`, with pointers into that body."""
    place = f"/items/0{step}"
    try:
        return prepare(store, viewer, {"kind": kind, "items": [item]}, members)
    except (InvalidInput, Refused) as error:
        if isinstance(error, Refused) and error.status >= 500:
            raise
        raise InvalidDocument(Fault(f.pointer.removeprefix(place), f.code, f.message) for f in error.faults) from None


def _places(body: Mapping[str, Any], count: int) -> Iterator[tuple[str, str]]:
    """For every item where in the request its faults are, and what to say before the message."""
    given = body.get("items")
    is_plain = isinstance(given, list) and len(given) == count
    for k in range(count):
        yield (f"/items/{k}", "") if is_plain else ("/template" if given is None else "/items", f"item {k}: ")


def _resolved(
    kind: str,
    items: Sequence[Mapping[str, Any]],
    library: StoreLibrary,
    places: Iterator[tuple[str, str]],
    members: Mapping[str, Any],
) -> list[NewItem]:
    resolved: list[NewItem] = []
    faults: list[Fault] = []
    bad = 0
    if kind in AFRESH:  # equal items of other submissions are others
        members = {**members, "run": secrets.token_hex(8)}
    if kind in NAMING and kind != "upgrade":
        library.foresee(kind, items)
    for k, (item, (place, note)) in enumerate(zip(items, places, strict=True)):
        if k % YIELD == 0:
            sleep(0)  # other requests need not wait until all items are done
        try:
            pinned, blobs = kinds.resolve(kind, dict(item), library)
            owned = library.owned(kind, pinned) if kind in NAMING else {}
            resolved.append(
                _new_item(kind, {**pinned, **owned, **members}, blobs)
            )  # as text, passed over by collectors
        except InvalidInput as error:
            bad += 1
            faults += [Fault(place + f.pointer, f.code, note + f.message) for f in error.faults]
        except TooLarge as error:
            bad += 1
            faults.append(Fault(place, "too-large", note + str(error)))
    if faults:
        shown = f"; the first {SHOWN} of {len(faults)} faults are shown" if len(faults) > SHOWN else ""
        detail = f"{bad} of {bad + len(resolved)} items cannot be computed, so nothing was queued{shown}: {faults[0]}"
        raise Refused(422, "invalid-items", detail, faults[:SHOWN], count=len(faults))
    return resolved


def _new_item(kind: str, item: Mapping[str, Any], blobs: Sequence[str]) -> NewItem:
    content = write_json(item)
    return NewItem(key_of(kind, item, content, release()), content.decode(), write_json(list(blobs)).decode())


def require_room(connection: Connection, new: int, principal: str, limits: Limits) -> None:
    """Raise Refused 503 when so many more items do not fit into the queue now, 422 when they never will."""
    most = min(limits.job_queue, limits.job_queue_per_key)
    if new > most:
        detail = f"{new:,} items are more than the queue takes, {most:,}; submit several jobs"
        raise Refused(422, "too-many-items", detail, limit=most)
    for whose, waiting, limit in (
        ("the queue", jobs.waiting(connection), limits.job_queue),
        ("your part of the queue", jobs.waiting(connection, principal), limits.job_queue_per_key),
    ):
        if waiting + new > limit:
            detail = f"{whose} is full: {waiting:,} items wait, {new:,} more exceed {limit:,}; nothing was queued"
            raise Refused(503, "queue-full", detail, headers={"Retry-After": "30"}, limit=limit)


def submit(connection: Connection, viewer: Viewer, submission: JobSubmission, limits: Limits) -> Job:
    """Queue a job. Raises Refused 503 when the queue is full."""
    require_room(connection, len(submission.items), viewer.key, limits)
    about = submission.shared, submission.label, submission.retry_of, len(submission.skipped)
    identifier = jobs.add_job(connection, submission.kind, viewer, submission.items, *about)
    uploads.refer(connection, identifier, submission.uploads)
    told = {"kind": submission.kind, "items": len(submission.items)}
    audit.note(connection, viewer, "job.submit", f"job {identifier}", **told)
    return find(connection, viewer, identifier)


def find(connection: Connection, viewer: Viewer, identifier: str) -> Job:
    """A job. Raises Refused 404 for what the viewer does not see."""
    job = jobs.get_job(connection, identifier)
    if job is None or not job.is_seen_by(viewer):
        advice = "GET /v1/jobs, or 'substructures jobs list', tells which there are"
        raise not_found(f"there is no job '{identifier[:80]}'; {advice}", "unknown-job")
    return job


def find_item(connection: Connection, viewer: Viewer, identifier: str, position: int) -> jobs.JobItem:
    """One item of a job. Raises Refused 404."""
    found = jobs.page_items(connection, find(connection, viewer, identifier).id, None, position - 1, 1)
    if not found or found[0].position != position:
        raise not_found(f"the job has no item {position}", "unknown-item")
    return found[0]


def cancel(connection: Connection, viewer: Viewer, identifier: str) -> Job:
    """Cancel what is not finished. Raises Refused 404, 403 for a shared job of others."""
    job = _own(connection, viewer, identifier, "cancels it")
    jobs.cancel(connection, job.id)
    audit.note(connection, viewer, "job.cancel", f"job {job.id}")
    return find(connection, viewer, identifier)


def again(connection: Connection, viewer: Viewer, identifier: str) -> JobSubmission:
    """What of a job failed or was cancelled, as another job. Raises Refused 404, 403, 409 where there is nothing."""
    job = _own(connection, viewer, identifier, "tries it again")
    if job.kind in STORING:
        viewer.require("write")
    items = jobs.unsuccessful(connection, job.id)
    if not items:
        left = "all its items succeeded" if job.is_final else "none of its items has failed so far"
        raise Refused(409, "nothing-failed", f"there is nothing of the job {job.id} to try again: {left}")
    states = uploads.of_job(connection, job.id)
    return JobSubmission(job.kind, items, states, bool(job.shared), label=job.label, retry_of=job.id)


def remove(connection: Connection, viewer: Viewer, identifier: str) -> None:
    """Remove a job with its results and uploads. Raises Refused 404, 403, 409 for one that has not ended."""
    job = _own(connection, viewer, identifier, "removes it")
    if not job.is_final:
        advice = f"cancel it first (POST /v1/jobs/{job.id}/cancel, or 'substructures jobs cancel {job.id}')"
        raise Refused(409, "job-not-ended", f"the job {job.id} is {job.state}: {advice}")
    remove_job(connection, job.id, job.principal)
    audit.note(connection, viewer, "job.remove", f"job {job.id}", items=job.total)


def _own(connection: Connection, viewer: Viewer, identifier: str, what: str) -> Job:
    """A job that the viewer may change. Raises Refused 404, 403."""
    job = find(connection, viewer, identifier)
    if viewer.key != job.principal:
        require(viewer, job.owner, f"job {job.id}", what)
    return job
