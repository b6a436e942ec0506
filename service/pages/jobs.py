"""The pages of the jobs: all of them, and one with its progress, which loads itself again while the job runs."""

from __future__ import annotations

from collections.abc import Sequence

import orjson

from service.operations.jobs import Progress
from service.pages.html import Content, Html, facts, html, link, table, tag
from service.pages.layout import document
from service.queries.jobs import Job, JobItem
from service.views.jobs import job_path, subject

AGAIN = 2  # seconds until a page of what changes is loaded again
STATES = {"failed": "warn", "cancelled": "quiet", "queued": "quiet"}


def jobs_page(jobs: Sequence[Job], progress: Sequence[Progress], more: bool) -> bytes:
    """The bytes of the list, the newest first; ``more``: there are others."""
    rows = [_row(job, each) for job, each in zip(jobs, progress, strict=True)]
    columns = ("job", "kind", "state", "progress", "items", "created")
    note = tag("p", "There are more: ", tag("code", "GET /v1/jobs"), ".", class_="quiet") if more else Html()
    listed = table(columns, rows) if rows else tag("p", "None yet.", class_="quiet")
    runs = any(not job.is_final for job in jobs)
    return document("Jobs - substructures", tag("h1", "Jobs"), listed, note, refresh=AGAIN if runs else None)


def _row(job: Job, progress: Progress) -> list[Content]:
    return [
        link(tag("code", job.id[:16]), f"/jobs/{job.id}"),
        f"{job.kind}: {job.label}" if job.label else job.kind,
        _state(job.state),
        _bar(progress),
        _counted(job),
        f"{job.created[:10]} {job.created[11:19]}",
    ]


def job_page(job: Job, progress: Progress, bad: Sequence[JobItem], more: bool) -> bytes:
    """The bytes of the page of one job; ``bad``: items that failed, ``more``: there are others."""
    path = job_path(job.id)
    about = facts(
        [
            ("Label", job.label),
            ("Tries again", link(tag("code", job.retry_of[:16]), f"/jobs/{job.retry_of}") if job.retry_of else None),
            ("State", _state(job.state)),
            ("Items", _counted(job)),
            ("Rate", f"{progress.rate:.3g} items per second" if progress.rate else None),
            ("Time left", f"about {progress.eta_seconds:,.0f} s" if progress.eta_seconds is not None else None),
            ("Attempts", f"{job.attempts:,}"),
            ("Submitted by", job.principal),
            ("Created", _time(job.created)),
            ("Started", _time(job.started)),
            ("Finished", _time(job.finished)),
            ("As data", html(link("JSON", path), " · ", link("results", f"{path}/result"))),
            ("All files", link("zip", f"{path}/archive")),
        ]
    )
    return document(
        f"Job {job.id[:16]} - substructures",
        tag("h1", f"Job {job.kind}"),
        tag("p", tag("code", job.id)),
        _bar(progress),
        about,
        *_problems(bad, more, path),
        refresh=None if job.is_final else AGAIN,
    )


def _problems(bad: Sequence[JobItem], more: bool, path: str) -> list[Html]:
    if not bad:
        return []
    rows = [(item.position, subject(item), item.attempts, _detail(item)) for item in bad]
    note = tag("p", "There are more: ", link("all", f"{path}/items?state=failed"), ".") if more else Html()
    return [tag("h2", "Items that failed"), table(("item", "of", "attempts", "what was seen"), rows), note]


def _detail(item: JobItem) -> str:
    return str(orjson.loads(item.problem or "{}").get("detail", ""))


def _state(state: str) -> Html:
    return tag("span", state, class_=STATES.get(state))


def _bar(progress: Progress) -> Html:
    percent = f"{100 * progress.fraction:.0f} %"
    return tag("progress", percent, value=f"{progress.fraction:.4f}", max="1", aria_label="Progress", title=percent)


def _counted(job: Job) -> Content:
    failed = tag("span", f", {job.failed:,} failed", class_="warn") if job.failed else None
    return [f"{job.done:,} of {job.total:,}", failed, f", {job.skipped:,} skipped" if job.skipped else None]


def _time(time: str | None) -> str | None:
    return None if time is None else f"{time[:10]} {time[11:19]} UTC"
