"""The table of a sweep: the rows that fit, put together from the items that are done, filtered and sorted."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from service.content.cache import Cache
from service.database.connections import Connection
from service.jobs.kinds.sweep import plan_of, rows_of
from service.messages.refusals import Refused, not_found, unprocessable
from service.queries.jobs import jobs as rows_of_jobs
from service.queries.jobs import results
from service.queries.jobs.jobs import Job
from substructures.documents import read_json
from substructures.ensembles.columns import deviation
from substructures.errors import InvalidDocument, among
from substructures.sweeps.block import Block, joined, objectives
from substructures.sweeps.conditions import read_condition
from substructures.sweeps.front import front
from substructures.sweeps.names import ROW
from substructures.sweeps.plan import Plan

KIND = "sweep"
#: bytes of tables that are kept put together
CAPACITY = 2**28
ITEMS = 500
QUANTILES = (0.0, 0.05, 0.25, 0.5, 0.75, 0.95, 1.0)

Column = NDArray[Any]


class _Taken(Mapping[str, Column]):
    """Some rows of columns, which are taken when they are asked for: of a page no more than what it shows."""

    def __init__(self, columns: Mapping[str, Column], places: NDArray[Any]) -> None:
        self.columns, self.places = columns, places

    def __getitem__(self, name: str) -> Column:
        return self.columns[name][self.places]

    def __iter__(self) -> Iterator[str]:
        return iter(self.columns)

    def __len__(self) -> int:
        return len(self.columns)

    def take(self, places: NDArray[Any]) -> _Taken:
        """Some of these."""
        return _Taken(self.columns, self.places[places])


@dataclass(frozen=True)
class Table:
    """Columns by name, the first ones the row and the choices; ``about``: how far the sweep is."""

    plan: Plan
    columns: Mapping[str, Column]
    about: Mapping[str, Any]

    @property
    def count(self) -> int:
        """How many rows it has."""
        return len(self.columns.places if isinstance(self.columns, _Taken) else self.columns[ROW])

    @property
    def weight(self) -> int:
        """Its size in bytes."""
        return sum(int(each.nbytes) for each in self.columns.values()) + 1

    @property
    def numeric(self) -> list[str]:
        """Its columns that are numbers."""
        return [name for name, each in self.columns.items() if each.dtype.kind in "fi"]

    def take(self, places: NDArray[Any]) -> Table:
        """Some of its rows."""
        columns = self.columns
        return replace(self, columns=columns.take(places) if isinstance(columns, _Taken) else _Taken(columns, places))

    def rows(self, start: int, stop: int) -> Table:
        """Those in places from ``start`` to before ``stop``."""
        return self.take(np.arange(min(start, self.count), min(stop, self.count)))

    def only(self, names: Sequence[str]) -> Table:
        """Some of its columns."""
        columns = self.columns
        if isinstance(columns, _Taken):
            return replace(self, columns=_Taken({name: columns.columns[name] for name in names}, columns.places))
        return replace(self, columns={name: columns[name] for name in names})


_tables: Cache[Table] = Cache(CAPACITY, lambda table: table.weight)


def table_of(connection: Connection, job: Job) -> Table:
    """The table of a sweep, as far as it is done. Raises Refused 404 for jobs of other kinds."""
    if job.kind != KIND:
        raise not_found(f"the job {job.id} is of kind '{job.kind}', and has no table", "no-table")
    found = _tables.once((job.id, job.done), lambda: _made(connection, job))
    return replace(found, about={**found.about, "state": job.state})


def _made(connection: Connection, job: Job) -> Table:
    plan = plan_of(read_json(results.first_item(connection, job.id).encode()))
    keys: list[str] = []
    finite = rows = proven = kept = 0
    ways: Counter[str] = Counter()
    refused: dict[str, dict[str, Any]] = {}
    after = -1
    while items := rows_of_jobs.page_items(connection, job.id, None, after, ITEMS):
        after = items[-1].position
        for item in items:
            if item.summary is None or item.state != "succeeded":
                continue
            told = read_json(item.summary.encode())
            rows += told["rows"][1] - told["rows"][0]
            finite, proven = finite + told["finite"], proven + told["proven"]
            for code, each in told["refused"].items():
                refused.setdefault(code, {**each, "rows": 0})["rows"] += each["rows"]
            ways.update(told.get("ways", {}))
            if told["kept"]:
                keys.append(item.key)
                kept += told["kept"]
    block = joined(plan, _blocks(connection, keys), kept)
    about: dict[str, Any] = {
        "rows": plan.rows,
        "done": rows,
        "finite": finite,
        "kept": len(block.rows),
        "proven": proven,
    }
    about["ways"] = dict(ways)
    return Table(plan, {ROW: block.rows, **_choices(plan, block.rows), **block.columns}, {**about, "refused": refused})


def _blocks(connection: Connection, keys: Sequence[str]) -> Iterator[Block]:
    """The rows of items, one after the other."""
    for key in keys:
        content = results.get_file(connection, key, "rows")
        if content is not None:
            arrays = rows_of(content)
            yield Block(arrays.pop(ROW), arrays)


def _choices(plan: Plan, rows: NDArray[np.int64]) -> dict[str, Column]:
    """What stands in the place of each instance for which there is a choice."""
    left, found = rows // plan.sampler.size, {}
    for name, options in reversed(list(zip(plan.instances, plan.options, strict=True))):
        left, index = np.divmod(left, len(options))
        if len(options) > 1:
            found[name] = _labels(options)[index]
    return dict(reversed(found.items()))


def _labels(options: Sequence[Mapping[str, Any]]) -> Column:
    """Names of the parts, with what tells apart options of one part."""
    names = [str(each["substructure"]).partition("@")[0] for each in options]
    counts, seen, labels = Counter(names), Counter[str](), []
    for name in names:
        seen[name] += 1
        labels.append(f"{name} #{seen[name]}" if counts[name] > 1 else name)
    return np.array(labels)


def chosen(table: Table, where: str, sort: str, columns: Sequence[str]) -> Table:
    """Rows that a condition holds for, in an order, ``-torque,mass``; with some of the columns. Raises Refused 422."""
    if where:
        try:
            condition = read_condition(where, table.numeric, "/query/where")
        except InvalidDocument as error:
            raise unprocessable(error.faults[0].code, error.faults[0].message, "/query/where") from None
        numbers = {name: table.columns[name].astype(np.float64) for name in condition.needs}
        table = table.take(np.flatnonzero(condition.holds(numbers, table.count)))
    keys = [name.strip() for name in sort.split(",") if name.strip()]
    for name in keys:
        _require(table, name.removeprefix("-"), "/query/sort")
    if keys:
        ranks = []
        for name in reversed(keys):
            values = table.columns[name.removeprefix("-")]
            if values.dtype.kind not in "fi":
                values = np.unique(values, return_inverse=True)[1]
            ranks.append(-values if name.startswith("-") else values)
        table = table.take(np.lexsort(ranks))
    for name in columns:
        _require(table, name, "/query/columns")
    wanted = [ROW, *(name for name in columns if name != ROW)] if columns else list(table.columns)
    return table.only(wanted)


def _require(table: Table, name: str, pointer: str) -> None:
    if name not in table.columns:
        message = f"unknown column '{name[:80]}'{among(name, list(table.columns))}"
        raise unprocessable("unknown-column", message, pointer)


def pareto(table: Table) -> Table:
    """The rows on the Pareto front. Raises Refused 409 for a sweep that names no columns for one."""
    goals = table.plan.document.pareto
    if goals is None:
        raise Refused(409, "no-pareto", "the sweep names no columns to 'minimise' or 'maximise' ('pareto')")
    return table.take(front(objectives(table.columns, goals)))


def distribution(table: Table, name: str, bins: int) -> dict[str, Any]:
    """Count, mean, deviation, quantiles and histogram of a column. Raises Refused 404."""
    if name not in table.numeric:
        raise not_found(f"there is no column '{name[:80]}' of numbers{among(name, table.numeric)}", "unknown-column")
    values = table.columns[name].astype(np.float64)
    if not len(values):
        return {"column": name, "count": 0, "mean": None, "deviation": None, "quantiles": {}, "histogram": None}
    with np.errstate(over="ignore", invalid="ignore"):  # what is beyond the range of doubles is null
        quantiles = np.quantile(values, QUANTILES)
        return {
            "column": name,
            "count": len(values),
            "mean": float(values.mean()),
            "deviation": deviation(values),
            "quantiles": {f"{q:g}": float(x) for q, x in zip(QUANTILES, quantiles, strict=True)},
            "histogram": _histogram(values, bins),
        }


def _histogram(values: Column, bins: int) -> dict[str, Any] | None:
    """Edges and counts, around values that differ by rounding alone; None where they are too far apart."""
    low, high = values.min(), values.max()
    least = 4 * bins * np.spacing(max(abs(low), abs(high)))  # so that bins have a width
    if high - low < least:
        low, high = low - max(0.5, least), high + max(0.5, least)
    if not np.isfinite(high - low):
        return None
    counts, edges = np.histogram(values, bins, (low, high))
    return {"edges": edges.tolist(), "counts": counts.tolist()}


def tree_of(table: Table, row: int) -> dict[str, Any]:
    """The tree document of a row. Raises Refused 404."""
    if not 0 <= row < table.plan.rows:
        raise not_found(f"the sweep has rows 0 to {table.plan.rows - 1:,}, and no row {row}", "unknown-row")
    return table.plan.tree(row)
