"""How far jobs are."""

from __future__ import annotations

from dataclasses import dataclass

from service.database.connections import Connection
from service.queries.jobs import jobs
from service.queries.jobs.jobs import Job

RECENT = 30.0  # seconds over which the rate is measured


@dataclass(frozen=True, slots=True)
class Progress:
    """How far a job is: items done per second, of late, and the time left at this rate."""

    fraction: float
    rate: float | None
    eta_seconds: float | None


def progress(connection: Connection, job: Job) -> Progress:
    """The progress of a job; the rate is that of the last half minute, or of the whole run when nothing ended since."""
    partial = 0.0 if job.is_final else jobs.partial_work(connection, job.id)
    fraction = min(1.0, (job.done + partial) / job.total)
    if job.is_final or job.started is None:
        return Progress(fraction, None, None)
    age = max(jobs.seconds_since(job.started), 1e-3)
    window = min(age, RECENT)
    recent = jobs.finished_since(connection, job.id, window)
    rate = recent / window if recent else (job.done + partial) / age
    left = job.total - job.done - partial
    return Progress(fraction, rate, left / rate if rate > 0 else None)
