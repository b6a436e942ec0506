"""The table of a sweep: which of its rows are printed or saved."""

from __future__ import annotations

import sys
from json import loads
from pathlib import Path
from typing import Annotated, Any

import typer

from service.cli.documents import require_place
from service.cli.output import print_json, table
from substructures.client import Client
from substructures.client.files import save
from substructures.client.sweeps import MEDIA

ROWS = 20  # that are printed
Where = Annotated[str, typer.Option(help="A condition over columns, 'mass < 3 and torque < 180'.")]
Sort = Annotated[str, typer.Option(help="Columns, the first one first, '-' for falling: '-torque,mass'.")]
Columns = Annotated[str, typer.Option(help="Columns, separated by commas; all if left out.")]
Front = Annotated[bool, typer.Option("--pareto", help="Rows on the Pareto front alone.")]
Out = Annotated[Path | None, typer.Option(help="Save all rows: .csv, .npz, .arrow, .parquet.")]
Count = Annotated[int, typer.Option(min=1, max=1000, help="How many rows are printed.")]


def require_suffix(out: Path | None) -> None:
    """Raises BadParameter for a file that no table is written to."""
    if out is not None and out.suffix not in MEDIA:
        raise typer.BadParameter(f"the name of a table ends in one of {', '.join(MEDIA)}", param_hint="--out")
    require_place(out)


def print_rows(
    client: Client, job: str, query: dict[str, str], pareto: bool, out: Path | None, count: int, as_json: bool
) -> None:
    """Print rows of the table of a job, or save them all."""
    page = loads(client.table_file(job, "application/json", {**query, "page_size": str(count)}, pareto))
    if out is not None:
        save(out, client.table_file(job, MEDIA[out.suffix], query, pareto))
        print(f"{out}: {page['count']:,} rows")
        return
    if as_json:
        print_json(page)
        return
    names = page["columns"]
    head = [] if sys.stdout.isatty() else [names]  # on a terminal a table has one
    table(names, [*head, *([_cell(row[name]) for name in names] for row in page["items"])])
    print(f"{page['count']:,} rows; {page['done']:,} of {page['rows']:,} computed, {page['finite']:,} have numbers")
    for code, each in page["refused"].items():
        print(f"  without: {each['rows']:,} {code}, as row {each['example']['row']}: {each['example']['message']}")


def _cell(value: Any) -> str:
    return f"{value:.6g}" if isinstance(value, float) else str(value)
