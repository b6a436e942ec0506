"""What jobs compute. A submission is expanded into items, each item is resolved, and later run in another process."""

from __future__ import annotations

import logging
from collections.abc import Mapping
from typing import Any

from service.integrity import CheckedBlobs
from service.jobs.engine import Outcome
from service.jobs.kinds.analyse import analysis_kind
from service.jobs.kinds.assemble import ASSEMBLE
from service.jobs.kinds.choices import combinations
from service.jobs.kinds.compare import COMPARE
from service.jobs.kinds.derive import DERIVE
from service.jobs.kinds.evaluate import EVALUATE
from service.jobs.kinds.export import EXPORT
from service.jobs.kinds.kind import ItemProgress, Kind
from service.jobs.kinds.library import Library
from service.jobs.kinds.mirror import MIRROR, MIRROR_KIND
from service.jobs.kinds.requested import REQUESTED
from service.jobs.kinds.upgrade import UPGRADE
from service.jobs.kinds.verify import VERIFY
from service.refusals import Refused, known_refusal, problem
from service.schemas.jobs import ItemDocument
from service.settings import Limits
from substructures.errors import Fault, InvalidDocument, InvalidInput, InvalidProgram, among, meant

__all__ = ["KINDS", "Library", "expand", "given", "resolve", "run"]

_KINDS: dict[str, Kind] = {
    "assemble": ASSEMBLE,
    "evaluate": EVALUATE,
    "export": EXPORT,
    "derive": DERIVE,
    "verify": VERIFY,
    "upgrade": UPGRADE,
    "compare": COMPARE,
    "simulate": analysis_kind("simulations"),
    "optimise": analysis_kind("optimal-controls"),
    "analyse": analysis_kind(),
    MIRROR_KIND: MIRROR,
}
KINDS = tuple(_KINDS)
FIELDS = ("kind", "items", "template", "choices", "shared", "on_invalid", "label")
_log = logging.getLogger(__name__)


def expand(kind: str, request: Mapping[str, Any], limits: Limits, library: Library) -> list[ItemDocument]:
    """The items of a submission: ``items``, or every combination of the ``choices`` put into the ``template``.

    An item may stand for several: states are split into parts of bounded size, ``*`` into the
    versions of the catalogue. Raises InvalidDocument with pointers into the submission.
    """
    if kind not in _KINDS:
        message = f"unknown kind '{kind[:80]}'; there are {', '.join(KINDS)}{meant(kind, KINDS)}"
        raise InvalidDocument.at("/kind", "unknown-kind", message)
    items: list[ItemDocument] = []
    for pointer, one in given(request, limits.job_items):
        if not isinstance(one, dict):
            raise InvalidDocument.at(pointer, "object-expected", "an object is needed")
        try:
            items += _KINDS[kind].spread(one, limits, library)
        except InvalidInput as error:
            raise error.below(pointer) from None
        if len(items) > limits.job_items:
            message = f"more than {limits.job_items:,} items after splitting; submit several jobs"
            raise InvalidDocument.at("/items", "too-many-items", message)
    if not items:
        raise InvalidDocument.at("/items", "empty", "a job needs at least one item")
    return items


def given(request: Mapping[str, Any], limit: int) -> list[tuple[str, Any]]:
    """The items as given or put together, each with the place of its faults."""
    faults = [
        Fault(f"/{key}", "unknown-field", f"unknown field '{key[:80]}'{among(key, FIELDS, k)}")
        for k, key in enumerate(key for key in request if key not in FIELDS)
    ]
    if ("items" in request) == ("template" in request):
        faults.append(Fault("/items", "missing", "give either 'items', or a 'template' with 'choices'"))
    if faults:
        raise InvalidDocument(faults)
    if "template" in request:
        made = combinations(request["template"], request.get("choices"), limit)
        return [("/template", item) for item in made]
    items = request["items"]
    if not isinstance(items, list) or not items:
        raise InvalidDocument.at("/items", "empty", "a list of at least one item is needed")
    if len(items) > limit:
        raise InvalidDocument.at("/items", "too-many-items", f"{len(items):,} items; the limit is {limit:,}")
    return [(f"/items/{k}", item) for k, item in enumerate(items)]


def resolve(kind: str, item: ItemDocument, library: Library) -> tuple[ItemDocument, tuple[str, ...]]:
    """The item with all references pinned to digests, and the digests of the blobs that it needs.

    Raises InvalidDocument with pointers relative to the item.
    """
    return _KINDS[kind].resolve(item, library)


def run(kind: str, item: ItemDocument, blobs: Mapping[str, bytes], progress: ItemProgress) -> Outcome:
    """Compute a resolved item, or what a request needs; what fails on its own account becomes a problem document.

    Raises MemoryError.

    Blobs are compared with their digests whenever they are read.
    """
    checked = CheckedBlobs(blobs)
    try:
        return REQUESTED[kind](item, checked) if kind in REQUESTED else _KINDS[kind].run(item, checked, progress)
    except MemoryError:
        raise
    except TimeoutError as error:  # what would take too long is not begun
        return failed(Refused(503, "took-too-long", str(error)))
    except InvalidProgram as error:
        return failed(Refused(500, "damaged-content", str(error)))
    except Exception as error:  # one item never takes the others with it
        known = known_refusal(error)
        if known is None:
            _log.error("unexpected %s", type(error).__name__, exc_info=error)
            known = Refused(500, "internal-error", f"an error in the service: {type(error).__name__}")
        return failed(known)


def failed(refused: Refused) -> Outcome:
    """The outcome of an item that failed."""
    return Outcome(problem=problem(refused))
