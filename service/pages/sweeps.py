"""The table of a sweep on the page of its job: rows that can be sorted and filtered, and a plot of two columns."""

from __future__ import annotations

from collections.abc import Sequence
from urllib.parse import urlencode

import numpy as np

from service.messages.addresses import BASE
from service.operations.jobs.tables import Table
from service.pages.html import Content, Html, joined, link, table, tag
from substructures.array import Array
from substructures.sweeps.block import objectives
from substructures.sweeps.front import front
from substructures.sweeps.names import ROW

ROWS = 50
#: points of the plot; of more rows every so many-th, and all of the front
POINTS = 2000
WIDTH, HEIGHT, EDGE = 640, 360, 46
FORMATS = (("CSV", "text/csv"), ("npz", "application/x-npz"), ("Parquet", "application/vnd.apache.parquet"))


def sweep_section(whole: Table, shown: Table, path: str, query: dict[str, str], may_write: bool, wrong: str) -> Html:
    """``whole``: all rows, ``shown``: those that were asked for; ``path``: of the job in the interface, ``query``: of
    the page; ``wrong``: what is wrong with the query.
    """
    about = whole.about
    counts = (
        f"{shown.count:,} of {about['kept']:,} rows; {about['done']:,} of {about['rows']:,} computed, "
        f"{about['finite']:,} have numbers"
    )
    refused = [
        tag("li", f"{each['rows']:,} without: {code}. Row {each['example']['row']}: {each['example']['message']}")
        for code, each in about["refused"].items()
    ]
    asked = urlencode({name: x for name, x in query.items() if name in ("sort", "where") and x})
    files = link("as JSON", f"{path}/table?{asked}"), link("Pareto front", f"{path}/pareto")
    return tag(
        "div",
        tag("h2", "Rows"),
        _form(whole, query),
        tag("p", wrong, class_="warn") if wrong else None,
        _plot(whole, shown, query) if shown.count else None,
        tag("p", counts, " · ", joined(files, " · "), class_="quiet"),
        tag("ul", refused, class_="plain") if refused else None,
        _rows(shown, path, query, may_write),
        id="rows",
    )


def _form(whole: Table, query: dict[str, str]) -> Html:
    names = whole.numeric[1:]

    def one(name: str, about: str, hint: str) -> Html:
        """A field."""
        return tag("label", f"{about} ", tag("input", name=name, value=query.get(name, ""), placeholder=hint))

    last, (x, y) = names[-1] if names else ROW, _axes(whole)
    return tag(
        "form",
        one("where", "where", f"{last} < 3"),
        one("sort", "sort", f"-{last}"),
        one("x", "x", x or ROW),
        one("y", "y", y or last),
        tag("button", "Show", type="submit"),
        class_="bar",
    )


def _rows(shown: Table, path: str, query: dict[str, str], may_write: bool) -> Html:
    columns = {name: each.tolist() for name, each in shown.rows(0, ROWS).columns.items()}
    rows: list[list[Content]] = []
    for values in zip(*columns.values(), strict=True):
        cells: list[Content] = [_cell(x) for x in values]
        if may_write:
            address = f"{path}/rows/{values[0]}/tree"
            what = {"data_method": "POST", "data_address": address, "data_to": "tree"}
            cells.append(tag("button", "Store tree", type="button", **what))
        rows.append(cells)
    heads: list[Content] = [_head(name, path.removeprefix(BASE), query) for name in columns]
    return table([*heads, *([""] if may_write else [])], rows)


def _head(name: str, page: str, query: dict[str, str]) -> Html:
    """A link that sorts by the column, falling where it is sorted rising."""
    sort = f"-{name}" if query.get("sort") == name else name
    mark = {name: " ↑", f"-{name}": " ↓"}.get(query.get("sort", ""), "")
    return link(name + mark, f"{page}?" + urlencode({**{n: x for n, x in query.items() if x}, "sort": sort}))


def _cell(value: object) -> str:
    return f"{value:.6g}" if isinstance(value, float) else str(value)


def _plot(whole: Table, shown: Table, query: dict[str, str]) -> Html | None:
    """Points of two columns, those of the Pareto front apart."""
    names, (x, y) = whole.numeric[1:], _axes(whole, query.get("x", ""))
    y = query.get("y") if query.get("y") in names else y
    if x is None or y is None or shown.count < 2:
        return None
    return _drawn(shown, x, y)


def _axes(whole: Table, wanted: str = "") -> tuple[str | None, str | None]:
    """The columns of the front, or the last ones that are not the same in all rows; ``wanted``: the first of them."""
    names, goals = whole.numeric[1:], whole.plan.document.pareto
    chosen = [*goals.minimise, *goals.maximise] if goals else []
    same = [name for name in names if not np.ptp(whole.columns[name].astype(float)) > 0] if whole.count else []
    rest = [name for name in reversed(names) if name not in chosen]
    ordered = [*chosen, *(name for name in rest if name not in same), *(name for name in rest if name in same)]
    x = wanted if wanted in names else next(iter(ordered), None)
    return x, next((name for name in ordered if name != x), None)


def _drawn(shown: Table, x: str, y: str) -> Html:
    goals, columns = shown.plan.document.pareto, {name: shown.columns[name].astype(float) for name in (x, y)}
    every = np.unique(np.linspace(0, shown.count - 1, min(POINTS, shown.count)).astype(int))
    best = front(objectives(shown.columns, goals)) if goals else np.zeros(0, dtype=int)
    horizontal, vertical = _scaled(columns[x], WIDTH), _scaled(columns[y], HEIGHT)
    pairs = list(zip((EDGE + horizontal).tolist(), (HEIGHT - EDGE - vertical).tolist(), strict=True))
    points = [
        tag("path", d="".join(f"M{pairs[k][0]:.1f} {pairs[k][1]:.1f}h0" for k in places), class_=kind)
        for kind, places in (("point", every), ("best", best[:POINTS]))
    ]
    return tag(
        "svg",
        tag("title", f"{y} over {x}"),
        tag("rect", x=EDGE, y=EDGE // 2, width=WIDTH - 3 * EDGE // 2, height=HEIGHT - 3 * EDGE // 2, class_="frame"),
        points,
        *_axis(x, columns[x], is_x=True),
        *_axis(y, columns[y], is_x=False),
        viewBox=f"0 0 {WIDTH} {HEIGHT}",
        class_="plot",
        role="img",
    )


def _scaled(values: Array, size: int) -> Array:
    low, high = float(values.min()), float(values.max())
    room = size - 3 * EDGE // 2 - 12
    return 6 + (values - low) / (high - low) * room if high > low else np.full(len(values), 6 + room / 2)


def _axis(name: str, values: Array, *, is_x: bool) -> Sequence[Html]:
    low, high = f"{values.min():.4g}", f"{values.max():.4g}"
    if is_x:
        base = HEIGHT - EDGE + 16
        right = WIDTH - EDGE // 2
        return (
            tag("text", low, x=EDGE, y=base),
            tag("text", high, x=right, y=base, text_anchor="end"),
            tag("text", name, x=(EDGE + right) // 2, y=base + 16, text_anchor="middle"),
        )
    top = EDGE // 2 - 8
    return (
        tag("text", f"{high}  {name}", x=4, y=top),
        tag("text", low, x=EDGE - 4, y=HEIGHT - EDGE, text_anchor="end"),
    )
