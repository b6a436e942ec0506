"""What a supervisor remembers between rounds: attempts that are claimed ahead of the engine, so that short items need
not wait for a round each, and what results of a job have in common and is stored already, so that it is not sent again.
"""

from __future__ import annotations

from collections import Counter, OrderedDict, deque
from collections.abc import Callable, Iterable, Mapping, Sequence
from statistics import median
from time import monotonic

from service.content.tree_summaries import TreeSummary
from service.database.connections import Connection
from service.queries import content
from service.queries.attempts import Attempt
from service.queue.rounds import Ended

GATHER = 0.2  # seconds for which ends are gathered while there is work to go on with
STALE = 2.0  # seconds without an end or a start after which what is claimed ahead goes back to the queue
AHEAD = 200  # items claimed ahead at most
JOBS, LATEST = 64, 32  # durations and digests are remembered of so many jobs, and so many of each


class Backlog:
    """Claimed attempts in the order of their claims, and how long items took of late. For one thread."""

    def __init__(self) -> None:
        self.attempts: deque[Attempt] = deque()
        self._durations: OrderedDict[str, deque[float]] = OrderedDict()
        self._moved = monotonic()

    def note_start(self) -> None:
        """Something moves."""
        self._moved = monotonic()

    def note_end(self, job: str, seconds: float) -> None:
        """An item of a job took so long."""
        self._moved = monotonic()
        self._durations.setdefault(job, deque(maxlen=LATEST)).append(seconds)
        self._durations.move_to_end(job)
        if len(self._durations) > JOBS:
            self._durations.popitem(last=False)

    @property
    def is_stuck(self) -> bool:
        """Whether nothing has moved for too long: others may have use for what is claimed."""
        return monotonic() - self._moved > STALE

    def forget(self, identifiers: set[str]) -> None:
        """Drop attempts."""
        self.attempts = deque(attempt for attempt in self.attempts if attempt.id not in identifiers)

    def ahead(self, slots: int, running: Iterable[str]) -> Callable[[str], int]:
        """How many items of a job to claim beyond those that can start now.

        It is what ends while ends are gathered, twice over and shared between the jobs, and one of a job of which
        nothing runs or waits here, for as many jobs as there are slots: so every job gets its turn. To be asked once
        about every job. ``running``: the job of every running attempt.
        """
        waiting = Counter(attempt.job for attempt in self.attempts)
        here = waiting.keys() | set(running)
        firsts = iter(range(slots))
        seconds = 2 * GATHER * slots / max(1, len(here))

        def of(job: str) -> int:
            """How many more items of a job may be claimed."""
            durations = self._durations.get(job)
            ends = min(AHEAD, int(seconds / max(median(durations), 1e-4))) if durations else 0
            if not ends and job not in here:
                return int(next(firsts, None) is not None)
            return ends - waiting[job]

        return of


class Known:
    """Digests of programs and forms of summaries that trees of a job have, by job. For one thread."""

    def __init__(self) -> None:
        self._of: OrderedDict[str, OrderedDict[str, None]] = OrderedDict()

    def of(self, job: str) -> Sequence[str]:
        """Digests of a job, the latest ones."""
        return list(self._of.get(job, ()))

    def note(self, connection: Connection, ended: Iterable[Ended]) -> None:
        """Remember what came with these ends, where it is stored."""
        for each in ended:
            if each.attempt.kind != "assemble" or each.outcome is None or each.outcome.problem is not None:
                continue
            sent = _sent(each.outcome.summary["program"], each.outcome.files)
            known = self._of.setdefault(each.attempt.job, OrderedDict())
            self._of.move_to_end(each.attempt.job)
            for digest in content.stored_of(connection, sent - known.keys()):
                known[digest] = None
            while len(known) > LATEST:
                known.popitem(last=False)
        while len(self._of) > JOBS:
            self._of.popitem(last=False)


def _sent(program: str, files: Mapping[str, bytes]) -> set[str]:
    """The digests of what came along."""
    form = TreeSummary.of_files(files)
    found = {program} if "program" in files else set()
    return found | ({form.form_digest} if form.form is not None and form.form_digest is not None else set())
