"""The pages of the jobs: all of them, and one with its progress, which follows the job while it runs."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import orjson

from service.operations.jobs.progress import Progress
from service.pages.html import Content, Html, facts, html, link, table, tag
from service.pages.layout import LIVE, document
from service.queries.jobs.jobs import Job, JobItem
from service.views.jobs import job_path, subject

AGAIN = 2  # seconds until a page of what changes is loaded again
#: where a script says what did not go
TOLD = tag("p", id="told", role="status", class_="warn")
STATES = {"failed": "warn", "cancelled": "quiet", "queued": "quiet"}


def jobs_page(jobs: Sequence[Job], progress: Sequence[Progress], more: bool, query: Mapping[str, str]) -> bytes:
    """The bytes of the list, the newest first; ``more``: there are others; ``query``: what it is narrowed to."""
    rows = [_row(job, each) for job, each in zip(jobs, progress, strict=True)]
    columns = ("job", "kind", "state")
    note = tag("p", "There are more: ", tag("code", "GET /v1/jobs"), ".", class_="quiet") if more else Html()
    none = "None of these." if any(query.values()) else "None yet."
    listed = table(columns, rows) if rows else tag("p", none, class_="quiet")
    runs = any(not job.is_final for job in jobs)
    live = tag("div", listed, note, id="live", data_running="yes" if runs else None)
    content = tag("h1", "Jobs"), _filter(query), TOLD, live
    return document("Jobs - substructures", *content, script=LIVE, refresh=AGAIN if runs else None)


def _filter(query: Mapping[str, str]) -> Html:
    hints = {"state": "running", "kind": "sweep", "label": "study:night"}
    fields = [
        tag("label", f"{name} ", tag("input", name=name, value=query.get(name, ""), placeholder=hint))
        for name, hint in hints.items()
    ]
    return tag("form", *fields, tag("button", "Show", type="submit"), class_="bar")


def _row(job: Job, progress: Progress) -> list[Content]:
    """Three columns, which phones have room for."""
    created = tag("div", f"{job.created[:10]} {job.created[11:19]}", class_="quiet small")
    state = tag("span", job.state, class_=STATES.get(job.state))
    return [
        [link(tag("code", job.id[:16]), f"/jobs/{job.id}"), created],
        f"{job.kind}: {job.label}" if job.label else job.kind,
        [state, ", ", _counted(job), _bar(progress, job)],
    ]


def job_page(
    job: Job,
    progress: Progress,
    bad: Sequence[JobItem],
    more: bool,
    may_change: bool,
    results: Sequence[Html] = (),
    rows: Html | None = None,
) -> bytes:
    """The bytes of the page of one job; ``bad``: items that failed, ``more``: there are others; ``may_change``: it can
    be cancelled, tried again and removed; ``results``: of its items; ``rows``: of a sweep.
    """
    path = job_path(job.id)
    live = tag(
        "div",
        tag("p", _bar(progress, job), data_final="yes" if job.is_final else None),
        _buttons(job, path) if may_change else None,
        _about(job, progress, path),
        *_problems(bad, more, path),
        *results,
        id="live",
        data_events=f"{path}/events",
    )
    return document(
        f"Job {job.id[:16]} - substructures",
        tag("h1", f"Job {job.kind}"),
        tag("p", tag("code", job.id)),
        TOLD,
        live,
        *([rows] if rows is not None else []),
        script=LIVE,
        refresh=None if job.is_final else AGAIN,
        crumbs=[("jobs", "/jobs")],
    )


def _about(job: Job, progress: Progress, path: str) -> Html:
    return facts(
        [
            ("Label", job.label),
            ("Tries again", link(tag("code", job.retry_of[:16]), f"/jobs/{job.retry_of}") if job.retry_of else None),
            ("State", _state(job)),
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


def _buttons(job: Job, path: str) -> Html:
    """What can be done with it now."""

    def one(text: str, method: str, address: str, to: str, sure: str | None = None) -> Html:
        """A button; ``sure``: what is asked first."""
        return tag("button", text, type="button", data_method=method, data_address=address, data_to=to, data_sure=sure)

    found = [] if job.is_final else [one("Cancel", "POST", f"{path}/cancel", "here")]
    if job.failed or job.state == "cancelled":
        found.append(one("Try again what failed", "POST", f"{path}/retry", "job"))
    if job.is_final:
        found.append(one("Remove", "DELETE", path, "jobs", "Remove this job with all its results?"))
    return tag("p", found, class_="bar")


def _problems(bad: Sequence[JobItem], more: bool, path: str) -> list[Html]:
    if not bad:
        return []
    rows = [(item.position, subject(item), item.attempts, _detail(item)) for item in bad]
    note = tag("p", "There are more: ", link("all", f"{path}/items?state=failed"), ".") if more else Html()
    return [tag("h2", "Items that failed"), table(("item", "of", "attempts", "what was seen"), rows), note]


def _detail(item: JobItem) -> str:
    return str(orjson.loads(item.problem or "{}").get("detail", ""))


def _state(job: Job) -> Html:
    """A job that ended well but for some of its items says so."""
    if job.state == "succeeded" and job.failed:
        return tag("span", f"succeeded, {job.failed:,} of {job.total:,} failed", class_="warn")
    return tag("span", job.state, class_=STATES.get(job.state))


def _bar(progress: Progress, job: Job) -> Html:
    """Succeeded, failed, and what is left; with the text for those who do not see it."""
    percent = f"{100 * progress.fraction:.0f} %"
    failed = 100 * job.failed / job.total if job.total else 0.0
    good = max(0.0, 100 * progress.fraction - failed)
    told = f"{percent}" + (f", {job.failed:,} of {job.total:,} failed" if job.failed else "")
    return tag(
        "svg",
        tag("title", told),
        tag("rect", width="100", height="8", class_="left"),
        tag("rect", width=f"{good:.2f}", height="8", class_="good"),
        tag("rect", x=f"{good:.2f}", width=f"{failed:.2f}", height="8", class_="bad"),
        viewBox="0 0 100 8",
        preserveAspectRatio="none",
        role="img",
        class_="share",
    )


def _counted(job: Job) -> Content:
    failed = tag("span", f", {job.failed:,} failed", class_="warn") if job.failed else None
    return [f"{job.done:,} of {job.total:,}", failed, f", {job.skipped:,} skipped" if job.skipped else None]


def _time(time: str | None) -> str | None:
    return None if time is None else f"{time[:10]} {time[11:19]} UTC"
