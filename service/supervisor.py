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
from collections import deque
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from datetime import timedelta
from statistics import median
from time import monotonic

from service.cache import Cache
from service.jobs.engine import Budget, Engine, Outcome, Report, Work
from service.operations.job_rounds import Ended, Round, play, put_back_all
from service.operations.retention import sweep
from service.queries import content, jobs, queue
from service.queries.attempts import Attempt
from service.refusals import Refused, problem
from service.store import Store
from substructures.documents import read_json

POLL = 0.5  # seconds between looks at the queue when nothing wakes us
GATHER = 0.5  # seconds for which ends are gathered while there is work to go on with
SOON = 0.05  # the same for the last ends of a job
AHEAD = 200  # items claimed ahead at most
NEWS = 0.05  # seconds to wait for news of what runs
BLOBS = 64 * 2**20  # bytes of definitions and programs kept at hand
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
        self._backlog: deque[Attempt] = deque()  # claimed, so that short items need not wait for a round each
        self._fractions: dict[str, float] = {}
        self._durations: deque[float] = deque(maxlen=32)  # of late, s
        self._played = 0.0
        self._blobs: Cache[bytes] = Cache(BLOBS, len)
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
        self._store.wake.set()
        self._thread.join()

    def _run(self) -> None:
        self._await_work()
        engine = None
        while not self._stop.is_set():
            try:
                engine = engine or self._make_engine()
                self._step(engine)
            except Exception:
                _log.exception("a round failed; it is played again")
                self._stop.wait(POLL)
        if engine is not None:
            engine.close()
        self._hand_back()

    def _await_work(self) -> None:
        """No worker is started before there is something to do."""
        while not self._stop.is_set():
            self._store.wake.clear()
            try:
                with self._store.database.read() as connection:
                    is_needed = jobs.waiting(connection) > 0
                if is_needed:
                    self._store.wake.set()
                    return
                if self._is_due("sweep", SWEEP):
                    sweep(self._store, self._stop)
            except Exception:
                _log.exception("the queue cannot be read; it is tried again")
            self._store.wake.wait(POLL)

    def _step(self, engine: Engine) -> None:
        free = engine.free
        is_idle = not (self._running or self._ended or self._backlog)
        if is_idle and free:
            self._store.wake.wait(POLL)
        for report in engine.reports(NEWS if self._running or not free else 0.0):
            self._hear(report)
        self._check_times(engine)
        self._feed(engine)
        if self._is_round_due(engine.free, free):
            self._play(engine)
        if self._is_due("renew", self._lease.total_seconds() / 4):
            self._renew(engine)
        if self._is_due("sweep", SWEEP):
            sweep(self._store, self._stop)

    def _is_round_due(self, free: int, before: int) -> bool:
        """At once when somebody waits; otherwise ends are gathered for a moment."""
        is_woken = self._store.wake.is_set()
        self._store.wake.clear()
        if self._is_due("poll", POLL) or is_woken or (free > 0 and (self._ended or free > before)):
            return True
        return bool(self._ended) and monotonic() - self._played > (SOON if self._is_last_of_job() else GATHER)

    def _is_last_of_job(self) -> bool:
        """Whether of some job all that is known here has ended, so that somebody may be waiting for it."""
        going = {attempt.job for attempt, _ in self._running.values()} | {attempt.job for attempt in self._backlog}
        return any(each.attempt.job not in going for each in self._ended.values())

    def _feed(self, engine: Engine) -> None:
        while self._backlog and engine.free > 0:
            self._begin(engine, self._backlog.popleft())

    def _is_due(self, what: str, period: float) -> bool:
        is_due = monotonic() >= self._due.get(what, 0.0)
        if is_due:
            self._due[what] = monotonic() + period
        return is_due

    def _hear(self, report: Report) -> None:
        known = self._running.get(report.id)
        if known is None:
            return
        if report.is_final:
            self._end(known[0], report.outcome, report.death)
        else:
            self._fractions[report.id] = report.fraction

    def _end(self, attempt: Attempt, outcome: Outcome | None, death: str = "") -> None:
        started = self._running.pop(attempt.id, (attempt, monotonic()))[1]
        self._durations.append(monotonic() - started)
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
        free = engine.free
        wanted = max(0, free + self._ahead(free + len(self._running)) - len(self._backlog))
        round_ = Round(self._owner, self._lease, ended, wanted, take_over, self._store.database.is_sqlite)
        with self._store.database.write() as connection:
            played = play(connection, round_)
        self._take_over_at_once, self._played = False, monotonic()
        for each in ended:
            del self._ended[each.attempt.id]
        self._store.metrics.items(played.states)
        for identifier in played.stopped:
            engine.stop(identifier)
            self._forget(identifier)
        self._backlog.extend(played.claimed)
        self._feed(engine)

    def _ahead(self, slots: int) -> int:
        """How many items to claim beyond those that can start now: what ends while ends are gathered, twice over."""
        if not self._durations:
            return 0
        return min(AHEAD, int(2 * GATHER * slots / max(median(self._durations), 1e-4)))

    def _begin(self, engine: Engine, attempt: Attempt) -> None:
        """Start an attempt. One that cannot be started is no longer known here: the next renewal puts it back."""
        limits = self._limits
        try:
            blobs = {digest: self._blob(digest) for digest in read_json(attempt.blobs.encode())}
            budget = Budget(limits.job_cpu_seconds, limits.job_memory_bytes)
            engine.start(Work(attempt.id, attempt.kind, read_json(attempt.item.encode()), blobs, budget))
        except LookupError as error:
            self._end(attempt, Outcome(problem=problem(Refused(500, "missing-content", str(error)))))
        except Exception:
            _log.exception("attempt %s could not be started", attempt.id)
        else:
            self._running[attempt.id] = attempt, monotonic()

    def _blob(self, digest: str) -> bytes:
        blob = self._blobs.get(digest)
        if blob is None:
            with self._store.database.read() as connection:
                blob = content.get_blob(connection, digest)
            if blob is None:
                raise LookupError(f"{digest} is not in the store")
            self._blobs.put(digest, blob)
        return blob

    def _forget(self, identifier: str) -> None:
        self._running.pop(identifier, None)
        self._ended.pop(identifier, None)
        self._fractions.pop(identifier, None)
        self._backlog = deque(attempt for attempt in self._backlog if attempt.id != identifier)

    def _renew(self, engine: Engine) -> None:
        """Keep the leases. What was taken over by others is stopped; what a failed round left to us is put back."""
        with self._store.database.write() as connection:
            mine = queue.renew(connection, self._owner, self._lease)
            known = [(self._running[i][0], fraction) for i, fraction in self._fractions.items() if i in self._running]
            queue.note_fractions(connection, known)
            known_ids = self._running.keys() | self._ended.keys() | {attempt.id for attempt in self._backlog}
            put_back_all(connection, self._owner, mine - known_ids)
        for identifier in known_ids - mine:
            engine.stop(identifier)
            self._forget(identifier)

    def _hand_back(self) -> None:
        try:
            with self._store.database.write() as connection:
                put_back_all(connection, self._owner, None)
        except Exception:
            _log.exception("items could not be handed back; they are taken over when their lease ends")


@contextmanager
def supervised(store: Store, engine: Callable[[], Engine] | None) -> Iterator[None]:
    """Run the jobs of a store while the block lasts; None leaves them to another process."""
    if engine is None:
        yield
        return
    supervisor = Supervisor(store, engine)
    supervisor.start()
    try:
        yield
    finally:
        supervisor.close()
