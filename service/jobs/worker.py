"""What one request lets others compute: its works share its time, which counts the CPU time that they take.

The clock ends them too, later: a machine that is busy makes no request a job.
"""

from __future__ import annotations

import logging
import secrets
from collections.abc import Mapping
from dataclasses import dataclass
from time import monotonic
from typing import Any, Protocol

from service.jobs.engine import AttemptReport, Budget, Outcome, Work
from service.refusals import Refused, refused_of
from service.schemas.jobs import ItemDocument
from substructures.errors import InvalidDocument, TooLarge

ATTEMPTS = 2  # works store nothing, so that one whose runner died is computed again
CLOSED = "the server stops"  # of a report
KILLED = "the process that computed this was killed, and so was the next one"
LATE = ("cpu-limit", "took-too-long")
LEAST = 0.01  # seconds; a budget of none would be no limit
_log = logging.getLogger(__name__)


class Workers(Protocol):
    """Compute works of requests. For any number of threads."""

    def compute(self, share: str, work: Work, seconds: float) -> AttemptReport:
        """The last report about a work; ``share``: on whose behalf. Raises TimeoutError after so many seconds."""

    def close(self) -> None:
        """Stop all, and leave no process behind."""


@dataclass
class Worker:
    """Computes on behalf of ``share``; ``cpu_seconds``: what is left of the time of the request, which ends at ``due``
    (:func:`time.monotonic`) in any case."""

    workers: Workers
    share: str
    cpu_seconds: float
    due: float
    memory_bytes: int

    def __call__(self, kind: str, item: ItemDocument, blobs: Mapping[str, bytes] | None = None) -> Outcome:
        """The outcome of a work (:func:`service.jobs.kinds.run`).

        Raises TimeoutError when it takes too long, InvalidDocument, TooLarge and Refused for its problem, Refused 503
        where its runner was killed again and again.
        """
        report = AttemptReport("")
        for _ in range(ATTEMPTS):
            work = Work(secrets.token_hex(8), kind, item, blobs or {}, self._budget())
            report = self.workers.compute(self.share, work, self.due - monotonic())
            if report.outcome is not None:
                self.cpu_seconds -= report.cpu_seconds
                return _sound(report.outcome)
            _log.warning("a work of kind %s ended: %s", kind, report.death)
            if report.death == CLOSED:
                break
        what = "the server is being stopped" if report.death == CLOSED else KILLED
        detail = f"{what}; ask once more"
        raise Refused(503, "restarting", detail, headers={"Retry-After": "1"})

    def _budget(self) -> Budget:
        if self.cpu_seconds <= 0 or monotonic() >= self.due:
            raise TimeoutError("there is no time left")
        return Budget(max(LEAST, self.cpu_seconds), self.memory_bytes)


def _sound(outcome: Outcome) -> Outcome:
    """The outcome, unless all there is of it is its problem."""
    if outcome.problem is None or outcome.files:
        return outcome
    problem: Mapping[str, Any] = outcome.problem
    if problem["code"] in LATE:
        raise TimeoutError(problem["detail"])
    refused = refused_of(problem)
    if refused.code == "too-large" and refused.members.keys() >= {"what", "size", "limit"}:
        raise TooLarge(*(refused.members[name] for name in ("what", "size", "limit")))
    if refused.code == "invalid-document" and not refused.members:
        raise InvalidDocument(refused.faults)
    raise refused
