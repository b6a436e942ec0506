"""The supervisor: a thread that hands queued items to an engine and keeps what comes back.

::

    reports of the engine --> ended attempts --.
    the clock ---------------------------------+--> one transaction (a round) --> stop and start attempts
    woken by submissions and cancellations ----'

The database is the truth: whatever this process forgets, it or another one finds there when the lease ends. All ends of
attempts since the last round share a transaction, since a transaction costs a write to the disk.
"""

from __future__ import annotations

import logging
import secrets
import threading
from collections.abc import Callable
from datetime import timedelta
from time import monotonic

from service.database.connections import set_clock
from service.jobs.engines.engine import AttemptReport, Budget, Engine, Outcome, Work
from service.jobs.kinds.shapes import KNOWN, SHARE
from service.messages.refusals import Refused, problem
from service.queries.attempts import Attempt
from service.queries.common import is_conflict, is_outage, now
from service.queries.jobs import jobs, queue
from service.queries.jobs.uploads import remove_unused
from service.queries.removal import remove_finished
from service.queue.backlog import GATHER, Backlog, Known
from service.queue.mirroring import WithMirrors
from service.queue.rounds import Ended, Round, lock_owned, play, put_back_all
from service.store.store import Store
from substructures.documents import read_json

POLL = 0.5  # seconds between looks at the queue when nothing wakes us
SOON = 0.05  # seconds for which the last ends of a job are gathered
PATIENCE = 20.0  # seconds for the last round
NEWS = 0.05  # seconds to wait for news of what runs
CHUNKS = 10  # uploads that are removed together
SWEEP = 60.0  # seconds between looks for jobs and uploads to be removed
_log = logging.getLogger(__name__)


class Supervisor:
    """Runs the jobs of a store on an engine until it is closed."""

    def __init__(self, store: Store, engine: Callable[[], Engine]) -> None:
        """``engine`` is called in the thread, which alone uses what it makes."""
        self._store, self._make_engine = store, engine
        self._owner = secrets.token_hex(8)
        self._limits = store.settings.limits
        self._lease = timedelta(seconds=self._limits.lease_seconds)
        self._running: dict[str, tuple[Attempt, float]] = {}  # by id, with the time of the start
        self._ended: dict[str, Ended] = {}
        self._backlog, self._known = Backlog(), Known()
        self._fractions: dict[str, float] = {}
        self._played = 0.0
        self._due: dict[str, float] = {}
        self._take_over_at_once = store.database.is_sqlite  # whoever had items died: only one server can live
        self._stop = threading.Event()
        self._thread = threading.Thread(target=self._run, name="supervisor", daemon=True)

    def start(self) -> None:
        """Begin."""
        self._thread.start()

    def close(self) -> None:
        """Stop all attempts, queue their items again and end the thread."""
        self._stop.set()
        self._store.runtime.wake.set()
        self._thread.join(PATIENCE)
        if self._thread.is_alive():  # it ends with the process; its items are taken over when their lease ends
            _log.error("the database has not answered for %g s; the supervisor is left behind", PATIENCE)

    def _run(self) -> None:
        self._await_work()
        engine = None
        while not self._stop.is_set():
            try:
                engine = engine or WithMirrors(self._make_engine(), self._store)
                self._step(engine)
            except Exception as error:
                self._complain("a round failed; it is played again", error)
        if engine is not None:
            engine.close()
        self._hand_back()

    def _await_work(self) -> None:
        """No worker is started before there is something to do."""
        while not self._stop.is_set():
            self._store.runtime.wake.clear()
            try:
                with self._store.database.read() as connection:
                    is_needed = jobs.waiting(connection) > 0
                if is_needed:
                    self._store.runtime.wake.set()
                    return
                if self._is_due("sweep", SWEEP):
                    sweep(self._store, self._stop)
            except Exception as error:
                self._complain("the queue cannot be read; it is tried again", error)
            self._store.runtime.wake.wait(POLL)

    def _complain(self, what: str, error: Exception) -> None:
        """Log what went wrong, and wait where that may help."""
        if is_conflict(error):
            _log.info("%s at once: another host was in the way", what)
            return
        if is_outage(error):
            _log.error("%s: the database does not answer: %s", what, str(error).partition("\n")[0])
        else:
            _log.error("%s", what, exc_info=error)
        self._stop.wait(POLL)

    def _step(self, engine: Engine) -> None:
        free = engine.free
        is_idle = not (self._running or self._ended or self._backlog.attempts)
        if is_idle and free:
            self._store.runtime.wake.wait(POLL)
        for report in engine.reports(NEWS if self._running or not free else 0.0):
            self._hear(report)
        self._check_times(engine)
        self._feed(engine)
        if self._backlog.attempts and self._backlog.is_stuck:
            self._give_back()
        if self._is_round_due(engine.free, free):
            self._play(engine)
        if self._is_due("renew", self._lease.total_seconds() / 4):
            self._renew(engine)
        if self._is_due("sweep", SWEEP):
            sweep(self._store, self._stop)

    def _is_round_due(self, free: int, before: int) -> bool:
        """At once when somebody waits; otherwise ends are gathered for a moment."""
        is_woken = self._store.runtime.wake.is_set()
        self._store.runtime.wake.clear()
        if self._is_due("poll", POLL) or is_woken or (free > 0 and (self._ended or free > before)):
            return True
        return bool(self._ended) and monotonic() - self._played > (SOON if self._is_last_of_job() else GATHER)

    def _is_last_of_job(self) -> bool:
        """Whether of some job all that is known here has ended, so that somebody may be waiting for it."""
        going = {attempt.job for attempt, _ in self._running.values()} | {a.job for a in self._backlog.attempts}
        return any(each.attempt.job not in going for each in self._ended.values())

    def _feed(self, engine: Engine) -> None:
        while self._backlog.attempts and engine.free > 0:
            self._begin(engine, self._backlog.attempts.popleft())

    def _is_due(self, what: str, period: float) -> bool:
        is_due = monotonic() >= self._due.get(what, 0.0)
        if is_due:
            self._due[what] = monotonic() + period
        return is_due

    def _hear(self, report: AttemptReport) -> None:
        known = self._running.get(report.id)
        if known is None:
            return
        if report.is_final:
            self._end(known[0], report.outcome, report.death)
        else:
            self._fractions[report.id] = report.fraction

    def _end(self, attempt: Attempt, outcome: Outcome | None, death: str = "") -> None:
        started = self._running.pop(attempt.id, (attempt, monotonic()))[1]
        self._backlog.note_end(attempt.job, monotonic() - started)
        self._fractions.pop(attempt.id, None)
        self._ended[attempt.id] = Ended(attempt, outcome, death)

    def _check_times(self, engine: Engine) -> None:
        limit = self._limits.job_seconds
        for attempt, started in list(self._running.values()):
            if monotonic() - started > limit:
                engine.stop(attempt.id)
                detail = f"the item was not finished after {limit:g} s"
                self._end(attempt, Outcome(problem=problem(Refused(503, "took-too-long", detail, limit=limit))))

    def _play(self, engine: Engine) -> None:
        ended = list(self._ended.values())
        take_over = self._take_over_at_once or self._is_due("lost", self._lease.total_seconds() / 4)
        free, ahead = engine.free, None
        if free or not self._backlog.is_stuck:
            ahead = self._backlog.ahead(free + len(self._running), (a.job for a, _ in self._running.values()))
        alone = self._store.database.is_sqlite
        round_ = Round(self._owner, self._lease, ended, free, take_over, alone, ahead, self._store.usage.take)
        with self._store.database.write() as connection:
            played = play(connection, round_)
        if ended:
            with self._store.database.read() as connection:
                self._known.note(connection, ended)
        self._take_over_at_once, self._played = False, monotonic()
        for each in ended:
            del self._ended[each.attempt.id]
        self._store.metrics.items(played.states)
        for identifier in played.stopped:
            engine.stop(identifier)
            self._forget(identifier)
        self._backlog.attempts.extend(played.claimed)
        self._feed(engine)

    def _give_back(self) -> None:
        """Others may have free places for what waits here behind long items."""
        ids = {attempt.id for attempt in self._backlog.attempts}
        with self._store.database.write() as connection:
            put_back_all(connection, self._owner, ids, is_counted=False)
        self._backlog.forget(ids)

    def _begin(self, engine: Engine, attempt: Attempt) -> None:
        """Start an attempt. One that cannot be started is no longer known here: the next renewal puts it back."""
        limits = self._limits
        try:
            blobs = {digest: self._store.blob(digest) for digest in read_json(attempt.blobs.encode())}
            budget = Budget(limits.job_cpu_seconds, limits.job_memory_bytes)
            told = {SHARE: f"job {attempt.job}", KNOWN: self._known.of(attempt.job)}
            item = read_json(attempt.item.encode()) | told
            engine.start(Work(attempt.id, attempt.kind, item, blobs, budget))
        except Refused as error:
            self._end(attempt, Outcome(problem=problem(error)))
        except Exception:
            _log.exception("attempt %s could not be started", attempt.id)
        else:
            self._running[attempt.id] = attempt, monotonic()
            self._backlog.note_start()

    def _forget(self, identifier: str) -> None:
        self._running.pop(identifier, None)
        self._ended.pop(identifier, None)
        self._fractions.pop(identifier, None)
        self._backlog.forget({identifier})

    def _renew(self, engine: Engine) -> None:
        """Keep the leases. What was taken over by others is stopped; what a failed round left to us is put back."""
        with self._store.database.write(durable=False) as connection:
            set_clock(connection)
            lock_owned(connection, self._owner)
            mine = queue.renew(connection, self._owner, self._lease)
            known = [(self._running[i][0], fraction) for i, fraction in self._fractions.items() if i in self._running]
            queue.note_fractions(connection, known)
            known_ids = self._running.keys() | self._ended.keys() | {a.id for a in self._backlog.attempts}
            put_back_all(connection, self._owner, mine - known_ids, is_counted=True)
        for identifier in known_ids - mine:
            engine.stop(identifier)
            self._forget(identifier)

    def _hand_back(self) -> None:
        """Keep what has ended, and leave the rest to others."""
        try:
            with self._store.database.write() as connection:
                play(
                    connection, Round(self._owner, self._lease, list(self._ended.values()), take=self._store.usage.take)
                )
                put_back_all(connection, self._owner, None, is_counted=False)
        except Exception:
            _log.exception("items could not be handed back; they are taken over when their lease ends")


def sweep(store: Store, stop: threading.Event) -> None:
    """Remove what has been kept long enough, finished jobs with their results and uploads that no job refers to: little
    in a transaction, so that nobody waits for long.
    """
    limits = store.settings.limits
    old, unused = now(-timedelta(days=limits.job_days)), now(-timedelta(hours=limits.upload_hours))
    for remove, before, most in ((remove_finished, old, 1), (remove_unused, unused, CHUNKS)):
        removed = most
        while removed and not stop.is_set():
            with store.database.write() as connection:
                removed = remove(connection, before, most)
