"""What jobs compute. A submission is expanded into items, each item is resolved, and later run in another process."""

from __future__ import annotations

import logging
from collections.abc import Mapping
from typing import Any

from service.content.integrity import CheckedBlobs
from service.jobs.engines.engine import Outcome
from service.jobs.kinds.choices import combinations
from service.jobs.kinds.kind import ItemProgress, Kind
from service.jobs.kinds.library import Library
from service.jobs.kinds.requested import REQUESTED
from service.messages.refusals import Refused, known_refusal, problem
from service.schemas.jobs import ItemDocument, SubmittedItems, SubmittedSweep
from service.settings import Limits
from substructures.documents import read_model
from substructures.errors import InvalidDocument, InvalidInput, InvalidProgram, meant
from substructures.late import Table
from substructures.part.definition import Definition
from substructures.sweeps.document import SweepDocument
from substructures.tree.document import TreeSpec

__all__ = ["KINDS", "Library", "expand", "given", "load", "resolve", "run", "submission"]

SWEEP_KIND = "sweep"
#: kinds whose module is called otherwise
_OTHERS = {"simulate": "analyse", "optimise": "analyse"}
KINDS = (
    *("assemble", "evaluate", "export", "derive", "verify", "upgrade", "compare"),
    *("simulate", "optimise", "analyse", "mirror", SWEEP_KIND),
)
_KINDS: Table[Kind] = Table("KINDS", {name: f"{__name__}.{_OTHERS.get(name, name)}" for name in KINDS})
_log = logging.getLogger(__name__)


def load() -> None:
    """Import all that computes, and build the models of documents, so that it is there before the time of the first
    item begins.
    """
    for table in (_KINDS, REQUESTED):
        dict(table)
    for model in (Definition, TreeSpec):
        model.model_rebuild()


def submission(document: Mapping[str, Any]) -> SubmittedItems | SubmittedSweep:
    """What is submitted, read by the model of its kind. Raises InvalidDocument."""
    kind = document.get("kind")
    if kind not in KINDS:
        what = "'kind' is needed" if kind is None else f"unknown kind '{str(kind)[:80]}'"
        message = f"{what}; there are {', '.join(KINDS)}{meant(str(kind), KINDS)}"
        raise InvalidDocument.at("/kind", "missing" if kind is None else "unknown-kind", message)
    return read_model(SubmittedSweep, document) if kind == SWEEP_KIND else read_model(SubmittedItems, document)


def expand(asked: SubmittedItems | SubmittedSweep, limits: Limits, library: Library) -> list[ItemDocument]:
    """The items of a submission: ``items``, or every combination of the ``choices`` put into the ``template``.

    An item may stand for several: states are split into parts of bounded size, ``*`` into the
    versions of the catalogue. Raises InvalidDocument with pointers into the submission.
    """
    items: list[ItemDocument] = []
    for pointer, one in given(asked, limits.job_items):
        try:
            items += _KINDS[asked.kind].spread(one, limits, library)
        except InvalidInput as error:
            raise error.below(pointer) from None
        if len(items) > limits.job_items:
            message = f"more than {limits.job_items:,} items after splitting; submit several jobs"
            raise InvalidDocument.at("/items", "too-many-items", message)
    if not items:
        raise InvalidDocument.at("/items", "empty", "a job needs at least one item")
    return items


def given(asked: SubmittedItems | SubmittedSweep, limit: int) -> list[tuple[str, Any]]:
    """The items as given or put together, each with the place of its faults."""
    if isinstance(asked, SubmittedSweep):
        return [("", asked.model_dump(include=set(SweepDocument.model_fields), exclude_unset=True))]
    if asked.template is not None and asked.choices is not None:
        return [("/template", item) for item in combinations(asked.template, asked.choices, limit)]
    items = asked.items or []
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

    Raises MemoryError, and SystemError: what the interpreter makes of allocations that fail in libraries, after which
    the process is not to be trusted.

    Blobs are compared with their digests whenever they are read.
    """
    checked = CheckedBlobs(blobs)
    try:
        return REQUESTED[kind](item, checked) if kind in REQUESTED else _KINDS[kind].run(item, checked, progress)
    except (MemoryError, SystemError):
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
