"""A sweep on many machines, simulated from measured rates: where it saturates, and what it costs.

python -m benchmarks.scheduler [--rows N] [--shapes N] [--json FILE]

Workers take chunks of about a second from one queue in PostgreSQL, compute them and hand their blocks back. Simulated
event by event: a claim and an end are a transaction each, one after the other; a block goes through the database, or
to an object store, which takes many at a time; a worker that dies loses its chunk, which another one takes over when
its lease ends; the first chunk of a shape in a worker couples and compiles it. Chunks are in the order of shapes
(``by shape``) or mixed. The rates are those of ``benchmarks/sweeps.py`` and ``benchmarks/jobs.py`` (docs/figures.md).
"""

from __future__ import annotations

import heapq
import random
from dataclasses import dataclass, field

from benchmarks.report import keep, options

#: microseconds of a core and bytes, compressed, of a row with ten columns; seconds of a new shape in a worker
ROW_US, ROW_BYTES, SHAPE_S = 8.8, 57.0, 0.12
#: seconds of a transaction of the queue; bytes per second that the database writes, and that a machine sends
TRANSACTION_S, DATABASE_BYTES, LINK_BYTES = 0.0022, 150e6, 100e6
#: mean seconds until a worker dies (spot machines), and until its chunk is taken over
LIFE_S, LEASE_S = 6 * 3600.0, 20.0
CHUNK_S = 1.0
NONE = -1


@dataclass
class Queue:
    """One thing after the other: when it is free, and how long it was busy."""

    free: float = 0.0
    busy: float = 0.0

    def served(self, now: float, seconds: float) -> float:
        """When it has served who comes now."""
        self.free = max(self.free, now) + seconds
        self.busy += seconds
        return self.free


@dataclass
class Run:
    """Rows in so many workers; ``in_database``: whether blocks go through it; ``by_shape``: how chunks are ordered."""

    rows: int
    workers: int
    shapes: int = 1
    in_database: bool = True
    by_shape: bool = True
    chance: random.Random = field(default_factory=lambda: random.Random(0))  # noqa: S311 -- a simulation
    deaths: int = 0
    per_shape: int = 1

    def seconds(self) -> tuple[float, float]:
        """How long it takes, and which part of that the database is busy."""
        size = max(1, int(CHUNK_S * 1e6 / ROW_US))
        left = list(range(-(-self.rows // size)))[::-1]  # the next one is the last
        self.per_shape = max(1, -(-len(left) // self.shapes))
        database, now, block = Queue(), 0.0, size * ROW_BYTES
        known = [set[int]() for _ in range(self.workers)]
        # when, worker, and the chunk that it hands back: none of one that looks for work
        events: list[tuple[float, int, int]] = [(0.0, worker, NONE) for worker in range(self.workers)]
        lost: list[tuple[float, int]] = []
        open_ = len(left)
        while open_:
            t, worker, chunk = heapq.heappop(events)
            if chunk != NONE:
                t = now = database.served(t, TRANSACTION_S + (block / DATABASE_BYTES if self.in_database else 0.0))
                open_ -= 1
            if lost and lost[0][0] <= t:
                chunk = heapq.heappop(lost)[1]
            elif left:
                chunk = left.pop()
            else:
                heapq.heappush(events, (max(t, lost[0][0]) if lost else t + LEASE_S, worker, NONE))
                continue
            heapq.heappush(events, self._computed(database.served(t, TRANSACTION_S), worker, chunk, known, lost, block))
        return now, database.busy / now

    def _computed(
        self, t: float, worker: int, chunk: int, known: list[set[int]], lost: list[tuple[float, int]], block: float
    ) -> tuple[float, int, int]:
        """When a worker is heard of again, and with what."""
        shape = chunk // self.per_shape if self.by_shape else chunk % self.shapes
        work = CHUNK_S + (0.0 if shape in known[worker] else SHAPE_S)
        known[worker].add(shape)
        if self.chance.random() < work / LIFE_S:
            self.deaths += 1
            known[worker].clear()
            heapq.heappush(lost, (t + LEASE_S, chunk))
            return t + work / 2 + LEASE_S, worker, NONE
        return t + work + block / LINK_BYTES, worker, chunk


def main() -> None:
    """Simulate, and print a table."""
    parser = options(__doc__)
    parser.add_argument("--rows", type=int, default=10**9)
    parser.add_argument("--shapes", type=int, default=2000)
    given = parser.parse_args()
    figures: dict[str, float] = {}
    print(
        f"{given.rows:,} rows, {given.shapes} shapes; {'workers':>8} {'minutes':>9} {'core hours':>11} {'database':>9}"
    )
    for name, how in (
        ("blocks in the database", {}),
        ("blocks in an object store", {"in_database": False}),
        ("the same, shapes mixed", {"in_database": False, "by_shape": False}),
    ):
        print(name)
        for workers in (8, 32, 128, 512, 2048):
            run = Run(given.rows, workers, given.shapes, **how)
            seconds, busy = run.seconds()
            hours = workers * seconds / 3600
            key = name.split(",", maxsplit=1)[0].replace(" ", "_")
            figures |= {f"{key}_{workers}_minutes": seconds / 60, f"{key}_{workers}_core_hours": hours}
            print(f"{'':>36}{workers:>8} {seconds / 60:>9.1f} {hours:>11.2f} {busy:>8.0%}  {run.deaths} deaths")
    keep(figures, given.json)


if __name__ == "__main__":
    main()
