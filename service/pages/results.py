"""What the first items of a job became, on its page: links to what was stored, figures, pictures, files."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

import orjson

from service.pages.html import Content, Html, joined, link, table, tag
from service.queries.jobs.jobs import Job, JobItem
from service.queries.jobs.results import File
from service.views.jobs import item_view, job_path

PREVIEWED, FIGURES = 20, 6
PICTURE = "image/svg+xml"
#: members of summaries that say nothing to people
SILENT = {"digest", "program", "software", "media_type", "nodes", "location", "name", "bytes", "analysis"}
STORED = {"/v1/trees/": "/trees/", "/v1/substructures/": "/substructures/"}


def results_section(job: Job, items: Sequence[JobItem], files: Mapping[str, Sequence[File]]) -> list[Html]:
    """Of up to PREVIEWED items that succeeded, of which there may be one more."""
    shown = [item_view(job.id, item, files.get(item.key, ())) for item in items[:PREVIEWED]]
    if not shown:
        return []
    rows = [(view["position"], *_row(view, item)) for view, item in zip(shown, items, strict=False)]
    more = tag("p", "There are more: ", link("all", f"{job_path(job.id)}/items?state=succeeded"), ".", class_="quiet")
    listed = table(("item", "became", "files"), rows)
    others = ", ".join(str(view["position"]) for view in shown if not view["computed_here"])
    told = tag(
        "p", f"Kept by an older version or elsewhere, without the seal of this server: {others}.", class_="quiet"
    )
    return [tag("h2", "Results"), listed, told if others else Html(), more if len(items) > PREVIEWED else Html()]


def _row(view: Mapping[str, Any], item: JobItem) -> tuple[Content, Content]:
    told: Mapping[str, Any] = orjson.loads(item.summary or "{}")
    place = str(told.get("location", ""))
    page = next((place.replace(api, pages, 1) for api, pages in STORED.items() if place.startswith(api)), "")
    became = link(page.rpartition("/")[2], page) if page else _picture(view)
    said = {name: x for name, x in told.items() if isinstance(x, str | int | float) and x != ""}
    kept = [(name, x) for name, x in said.items() if name not in SILENT]
    figures = joined([f"{name} {_short(x)}" for name, x in kept[:FIGURES]])
    links = [link(f"{each['name']} ({each['size']:,} bytes)", each["href"]) for each in view["files"]]
    return [became, tag("div", figures)], joined(links)


def _picture(view: Mapping[str, Any]) -> Html:
    found = [each["href"] for each in view["files"] if each["media_type"].startswith(PICTURE)]
    return Html("".join(tag("img", src=href, alt=f"Picture of item {view['position']}", width="320") for href in found))


def _short(x: str | int | float) -> str:
    if isinstance(x, bool):
        return "yes" if x else "no"
    if isinstance(x, str):
        return x.partition("@sha256:")[0][:80]
    return f"{x:.4g}" if isinstance(x, float) else f"{x:,}"
