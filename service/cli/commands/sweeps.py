"""The commands ``sweep`` and ``jobs table``: many combinations of parts and numbers as a table."""

from __future__ import annotations

import sys
from json import loads
from pathlib import Path
from typing import Annotated, Any

import typer

from service.cli import completion
from service.cli.documents import named, read_document, require_place
from service.cli.options import Server, with_server
from service.cli.output import print_json, table
from service.cli.progress import follow
from substructures.client import Client
from substructures.client.files import save
from substructures.client.jobs import PATIENCE
from substructures.client.sweeps import MEDIA

ROWS = 20  # that are printed
Where = Annotated[str, typer.Option(help="A condition over columns, 'mass < 3 and torque < 180'.")]
Sort = Annotated[str, typer.Option(help="Columns, the first one first, '-' for falling: '-torque,mass'.")]
Columns = Annotated[str, typer.Option(help="Columns, separated by commas; all if left out.")]
Front = Annotated[bool, typer.Option("--pareto", help="Rows on the Pareto front alone.")]
Out = Annotated[Path | None, typer.Option(help="Save all rows: .csv, .npz, .arrow, .parquet.")]
Count = Annotated[int, typer.Option(min=1, max=1000, help="How many rows are printed.")]
Json = Annotated[bool, typer.Option("--json", help="Print them as JSON.")]


@with_server
def sweep(
    server: Server,
    file: Annotated[Path, typer.Argument(metavar="FILE", help="The sweep, JSON or YAML; '-' reads from stdin.")],
    wait: Annotated[bool, typer.Option(help="Wait until it has ended, and print its table.")] = True,
    sort: Sort = "",
    where: Where = "",
    pareto: Front = False,
    out: Out = None,
    count: Count = ROWS,
) -> int:
    """Evaluate all combinations of parts and numbers of a tree; print the table.

    \b
    template: {name: pair, gravity: [0, 0, "-9.81"], instances: [{name: arm, substructure: puma560}, ...]}
    choices: {arm: [puma560, ur5], hand: {query: {tag: gripper}}}
    samples: {of: {hand.m: {uniform: [0.1, 2], count: 100}}}
    columns: {mass: mass, torque: {quantity: inverse_dynamics, of: arm.q2, over: {q: [...], qd: [...], qdd: [...]}}}
    where: torque < 180
    pareto: {minimise: [mass, torque]}
    """
    _suffix(out)
    with server.client() as client:
        document = read_document(file)
        with named(file):
            job = client.submit_job({"kind": "sweep", **document})
        if not wait:
            print(job["id"])
            return 0
        code = follow(client, job["id"], PATIENCE)
        if code in (0, 3):
            _print(client, job["id"], {"sort": sort, "where": where}, pareto, out, count, False)
    return code


@with_server
def rows(
    server: Server,
    id: Annotated[str, typer.Argument(metavar="ID", autocompletion=completion.jobs)],  # noqa: A002 -- an argument
    sort: Sort = "",
    where: Where = "",
    columns: Columns = "",
    pareto: Front = False,
    out: Out = None,
    count: Count = ROWS,
    json: Json = False,
) -> int:
    """Print the table of a sweep, also while it runs, or save it."""
    _suffix(out)
    with server.client() as client:
        _print(client, id, {"sort": sort, "where": where, "columns": columns}, pareto, out, count, json)
    return 0


def _suffix(out: Path | None) -> None:
    if out is not None and out.suffix not in MEDIA:
        raise typer.BadParameter(f"the name of a table ends in one of {', '.join(MEDIA)}", param_hint="--out")
    require_place(out)


def _print(
    client: Client, job: str, query: dict[str, str], pareto: bool, out: Path | None, count: int, as_json: bool
) -> None:
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


COMMANDS = {"sweep": sweep}
