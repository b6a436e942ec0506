"""One round of whoever computes items, in one transaction: keep what ended, take over what is lost, fill free places.

The jobs concerned are locked first, always in the same order, so that several hosts can share a queue.
"""

from __future__ import annotations

import logging
from collections.abc import Callable, Collection, Mapping, Sequence
from dataclasses import dataclass
from datetime import timedelta
from typing import Any

from service.database.connections import Connection
from service.jobs.engines.engine import Outcome
from service.messages.refusals import Refused, StaleError, problem
from service.operations.jobs import job_results
from service.queries.attempts import Attempt, Changes, Lost
from service.queries.common import is_outage
from service.queries.jobs import job_events, jobs, queue
from substructures.documents import write_json

#: attempts whose worker died; and all attempts, since an item may also bring down whoever watches over the workers:
#: many, since what was claimed is lost with a service that is killed for other reasons
MAX_DEATHS, MAX_ATTEMPTS = 3, 1000
ALL_FAILED = problem(Refused(500, "all-items-failed", "every item failed; its problem says why"))
_log = logging.getLogger(__name__)


@dataclass(frozen=True, slots=True)
class Ended:
    """The end of an attempt: an outcome, or what was seen of its death."""

    attempt: Attempt
    outcome: Outcome | None
    death: str = ""


@dataclass(frozen=True, slots=True)
class Round:
    """What one owner brings and wants.

    ``alone``: no other owner can live, so all others' items are lost. ``ahead``: how many items of a job to claim
    even where these are more than its share of the ``wanted`` ones. ``take``: counts the bytes of results.
    """

    owner: str
    lease: timedelta
    ended: Sequence[Ended] = ()
    wanted: int = 0
    take_over: bool = False
    alone: bool = False
    ahead: Callable[[str], int] | None = None
    take: job_results.Take | None = None


@dataclass(frozen=True, slots=True)
class Played:
    """Items to be computed now, ids of attempts that are to be stopped, and how many items changed to which state."""

    claimed: Sequence[Attempt]
    stopped: Sequence[str]
    states: Mapping[str, int]


def play(connection: Connection, round_: Round) -> Played:
    """Play one round inside of a write transaction."""
    changes = Changes()
    touched = _lock(connection, round_)
    stopped = _drop_unwanted(connection, round_.owner, touched, changes)
    _take_over(connection, round_, touched, changes)
    if round_.ended:
        _end(connection, round_, touched, changes)
    claimed: list[Attempt] = []
    if round_.wanted or round_.ahead is not None:
        ahead = round_.ahead or (lambda _: 0)
        claimed = queue.claim(connection, round_.owner, round_.lease, round_.wanted, changes, ahead)
    _close(connection, changes)
    return Played(claimed, stopped, changes.total())


def lock_owned(connection: Connection, owner: str) -> None:
    """Lock the jobs of an owner's running items, before any of the items."""
    jobs.lock(connection, {lost.job for lost in queue.owned(connection, owner)})


def put_back_all(connection: Connection, owner: str, ids: Collection[str] | None, *, is_counted: bool) -> None:
    """Queue running items of an owner again that it does not compute: those of these attempts, or all.

    ``is_counted``: as attempts that were lost; otherwise as if they had not been claimed.
    """
    changes = Changes()
    lock_owned(connection, owner)
    for lost in queue.owned(connection, owner):
        if ids is None or lost.id in ids:
            if not is_counted:
                queue.uncount(connection, lost.job, lost.position)
            _again(connection, lost, lost.deaths, changes)
    _close(connection, changes)


def _lock(connection: Connection, round_: Round) -> set[str]:
    touched = {each.attempt.job for each in round_.ended}
    keys = [each.attempt.key for each in round_.ended if each.outcome is not None and each.outcome.problem is None]
    if keys:
        touched |= queue.twins(connection, keys)
    touched |= {lost.job for lost in queue.unwanted(connection, round_.owner)}
    if round_.take_over:
        touched |= {lost.job for lost in queue.expired(connection, round_.owner, round_.alone)}
    if touched:
        jobs.lock(connection, touched)
    return touched


def _drop_unwanted(connection: Connection, owner: str, touched: set[str], changes: Changes) -> list[str]:
    if not touched:
        return []
    dropped = [lost for lost in queue.unwanted(connection, owner) if lost.job in touched]
    for lost in dropped:
        queue.drop(connection, lost.job, lost.position)
        changes.add(lost.job, "cancelled", [lost.position])
    return [lost.id for lost in dropped]


def _take_over(connection: Connection, round_: Round, touched: set[str], changes: Changes) -> None:
    if not round_.take_over:
        return
    for lost in queue.expired(connection, round_.owner, round_.alone):
        if lost.job in touched:
            _again(connection, lost, lost.deaths, changes)


def _again(connection: Connection, lost: Lost, deaths: Sequence[str], changes: Changes) -> None:
    """Queue a lost item again, unless nobody wants it or it has been tried often enough."""
    if lost.is_cancelling:
        queue.drop(connection, lost.job, lost.position)
        state = "cancelled"
    elif len(deaths) >= MAX_DEATHS or lost.number >= MAX_ATTEMPTS:
        queue.give_up(connection, lost.job, lost.position, deaths, _dump(_given_up(lost.number, deaths)))
        state = "failed"
    else:
        queue.put_back(connection, lost.job, lost.position, deaths)
        state = "queued"
    changes.add(lost.job, state, [lost.position])


def _given_up(number: int, deaths: Sequence[str]) -> dict[str, Any]:
    seen = f"; seen: {'; '.join(dict.fromkeys(deaths))}" if deaths else ""
    lost = f", and {number - len(deaths)} times the service that had it was lost" if number > len(deaths) else ""
    detail = f"given up after {number} attempts: {len(deaths)} workers died{lost}{seen}"
    return problem(Refused(500, "worker-died", detail, attempts=number, deaths=list(deaths)))


def _end(connection: Connection, round_: Round, touched: set[str], changes: Changes) -> None:
    """Keep what ended. An attempt that is no longer its item's latest, or no longer the owner's, changes nothing."""
    held = {lost.id: lost for lost in queue.held(connection, round_.owner, [each.attempt for each in round_.ended])}
    valid = [each for each in round_.ended if each.attempt.id in held]
    for each in valid:
        if each.outcome is None:
            lost = held[each.attempt.id]
            _again(connection, lost, (*lost.deaths, each.death), changes)
    finished = _finish(connection, round_, [(e.attempt, e.outcome) for e in valid if e.outcome is not None])
    for attempt, problem_text in finished:
        changes.add(attempt.job, "succeeded" if problem_text is None else "failed", [attempt.position])
    keys = [attempt.key for attempt, problem_text in finished if problem_text is None]
    if keys:
        for job, positions in jobs.succeed_equal(connection, touched, keys).items():
            changes.add(job, "succeeded", positions)


def _finish(
    connection: Connection, round_: Round, outcomes: Sequence[tuple[Attempt, Outcome]]
) -> list[tuple[Attempt, str | None]]:
    """Keep outcomes and finish their items: the problem of each, or None."""
    kept = [(attempt, outcome) for attempt, outcome in outcomes if outcome.problem is None or outcome.files]
    problems = {attempt.id: outcome.problem for attempt, outcome in outcomes if outcome.problem is not None}
    problems |= _keep(connection, kept, round_.take)
    finished = [(a, _dump(problems[a.id]) if a.id in problems else None) for a, _ in outcomes]
    queue.finish(connection, finished)
    return finished


def _keep(
    connection: Connection, kept: Sequence[tuple[Attempt, Outcome]], take: job_results.Take | None
) -> dict[str, Mapping[str, Any]]:
    """Keep outcomes, together or, when one of them cannot be kept, each for itself: the problems by attempt."""
    fault = _fault(connection, kept, take)
    if fault is None:
        return {}
    if len(kept) == 1:
        return {kept[0][0].id: fault}
    faults = {each[0].id: _fault(connection, [each], take) for each in kept}
    return {identifier: each for identifier, each in faults.items() if each is not None}


def _fault(
    connection: Connection, kept: Sequence[tuple[Attempt, Outcome]], take: job_results.Take | None
) -> Mapping[str, Any] | None:
    """Keep outcomes, all or none; the problem when they cannot be kept."""
    if not kept:
        return None
    try:
        with connection.begin_nested():
            job_results.keep(connection, kept, take)
    except StaleError as error:
        return problem(Refused(409, "conflict", str(error)))
    except Refused as error:
        return problem(error)
    except Exception as error:
        if is_outage(error):  # the database, not the item
            raise
        _log.exception("outcomes cannot be kept: %s", ", ".join(attempt.id for attempt, _ in kept))
        return problem(Refused(500, "internal-error", "the result cannot be stored; the log says why"))
    return None


def _close(connection: Connection, changes: Changes) -> None:
    """Count, log and, where nothing is left to be done, finish the jobs that changed."""
    jobs.count(connection, changes.finished())
    for job, states in changes.by_job.items():
        job_events.add_event(connection, job, "items", states)
    jobs.settle(connection, changes.by_job)
    if changes.total().get("failed"):
        jobs.fail_whole(connection, changes.by_job, _dump(ALL_FAILED))


def _dump(document: Mapping[str, Any]) -> str:
    return write_json(document).decode()
