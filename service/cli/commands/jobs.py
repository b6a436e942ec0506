"""The command ``jobs``: submit, watch and read batch jobs of a server."""

from __future__ import annotations

import sys
from collections.abc import Iterable, Iterator, Mapping
from contextlib import contextmanager
from json import dumps, loads
from pathlib import Path
from typing import Annotated, Any

import typer

from service.cli import completion
from service.cli.choices import one_of
from service.cli.documents import named, read_document, read_from
from service.cli.options import Json, Server, with_server
from service.cli.output import print_json, table
from service.cli.progress import follow
from service.cli.rows import ROWS, Columns, Count, Front, Out, Sort, Where, print_rows, require_suffix
from substructures.client import Client
from substructures.client.jobs import FORMATS, PATIENCE
from substructures.client.progress import counted
from substructures.client.steps import step
from substructures.errors import InvalidDocument
from substructures.formats import arrow
from substructures.formats.arrays import read_npz
from substructures.quantities.quantity import QUANTITIES

Id = Annotated[str, typer.Argument(metavar="ID", autocompletion=completion.jobs)]
Wait = Annotated[bool, typer.Option(help="Wait until it has ended.")]
Patience = Annotated[
    float,
    typer.Option(
        metavar="SECONDS", help="To go on when the server cannot be reached.", callback=lambda x: _positive(x)
    ),
]


def _positive(seconds: float) -> float:
    if not seconds > 0:
        raise typer.BadParameter(f"a number of seconds above 0 is needed, found '{seconds:g}'")
    return seconds


@with_server
def submit(
    server: Server,
    file: Annotated[
        Path, typer.Argument(metavar="FILE", help='{"kind", "items"} or {"kind", "template", "choices"}, JSON or YAML.')
    ],
    label: Annotated[str | None, typer.Option(help="What it is for, in words.")] = None,
    wait: Wait = True,
    patience: Patience = PATIENCE,
    json: Json = False,
) -> int:
    """Queue the job in a file.

    \b
    {"kind": "evaluate", "items": [{"tree": "swing", "request": {"quantities": ["metric"], "q": [[0, 0], [1, 0]]}}]}
    {"kind": "simulate", "template": {"tree": "swing", "request": {"q": [0, 0], "span": [0, 5], "step": 0.05}},
     "choices": {"/request/q/0": [0.1, 0.2]}}

    \b
    An item is, for
      assemble             a tree document
      derive               a definition
      verify               substructure (* for all)
      compare              a, b (a list, or * for the catalogue), coordinates
      evaluate             tree, request, grid or sample, format
      simulate, optimise   tree, request or requests, format
      analyse              tree, analysis, request or requests, format
      export               tree, quantity, format, form, bind, options
      upgrade              substructure (* for all)
      mirror               source
      sweep                the whole file: template, choices, samples, columns (see 'substructures sweep')

    A choice is a list of values for a place in the template: a JSON pointer, or in a tree document an instance or
    instance.parameter. All combinations are computed. The full description of all fields is JobRequest in the OpenAPI
    document: 'substructures openapi', or /openapi.json of a server.

    Unless --no-wait is given, the exit code is 0 when all items succeeded, 3 when some failed, 4 when all did, 5 when
    it was cancelled, 6 when all succeeded but those that were skipped ("on_invalid": "skip"). A motion that fails or
    violates a first integral is an item that failed.
    """
    with server.client() as client:
        document = read_document(file)
        if label is not None and isinstance(document, dict):
            document["label"] = label
        with named(file):
            job = client.submit_job(document)
        return _queued(client, job, wait, patience, json)


@with_server
def retry(server: Server, id: Id, wait: Wait = True, patience: Patience = PATIENCE, json: Json = False) -> int:  # noqa: A002 -- an argument
    """Once more what of a job failed or was cancelled, as a new job."""
    with server.client() as client:
        return _queued(client, client.retry_job(id), wait, patience, json)


@with_server
def remove(
    server: Server,
    ids: Annotated[list[str], typer.Argument(metavar="ID...", autocompletion=completion.jobs)],
    json: Json = False,
) -> int:
    """Remove jobs that have ended, with their results."""
    with server.client() as client:
        for job in ids:
            client.remove_job(job)
    if json:
        print_json({"removed": ids})
    return 0


@with_server
def evaluate(
    server: Server,
    tree: Annotated[str, typer.Argument(help="Name of a tree.", autocompletion=completion.trees)],
    file: Annotated[
        Path,
        typer.Argument(metavar="FILE", help="States: .npz or .arrow with q, qd, t, inputs.<name>, ...; .json, .yaml."),
    ],
    quantities: Annotated[
        str,
        typer.Option(
            help="metric,forces,... (default: those in the file).", autocompletion=completion.listed(QUANTITIES)
        ),
    ] = "",
    format: Annotated[str, one_of(FORMATS, help="Of the results: npz or arrow.")] = "npz",  # noqa: A002 -- an option
    wait: Wait = True,
    patience: Patience = PATIENCE,
    json: Json = False,
) -> int:
    """Queue the evaluation of a tree for a file of states."""
    with _states(file) as (constants, states), server.client() as client:
        if quantities:
            constants["quantities"] = quantities.split(",")
        return _queued(client, client.submit_states(tree, states, format, **constants), wait, patience, json)


@contextmanager
def _states(path: Path) -> Iterator[tuple[dict[str, Any], Mapping[str, Any] | Iterable[Mapping[str, Any]]]]:
    """What is the same for all states of a file, and the states, as ``Client.submit_states`` wants them.

    Raises InvalidDocument naming the file.
    """
    with path.open("rb") as file, named(path):
        if path.suffix == ".npz":
            arrays = read_npz(file, sys.maxsize)
            texts = {name: x.tolist() for name, x in arrays.items() if x.dtype.kind == "U"}
            yield texts, {name: x for name, x in arrays.items() if name not in texts}
        elif path.suffix in (".arrow", ".arrows"):
            reader = arrow.Reader(file, sys.maxsize)
            yield {name: loads(text) for name, text in reader.metadata.items()}, reader
        else:
            states = read_from(path, file)
            if not isinstance(states, dict):
                raise InvalidDocument.at("", "object-expected", "an object with 'quantities', 'q', ... is needed")
            yield {}, states


def _queued(client: Client, job: Mapping[str, Any], wait: bool, patience: float, as_json: bool) -> int:
    if not as_json:
        print(job["id"], flush=True)
    skipped = job.get("skipped", ())
    for each in skipped:
        for fault in each["errors"]:
            print(f"skipped: item {each['item']}: {fault['pointer']}: {fault['message']}", file=sys.stderr)
    code = follow(client, job["id"], patience) if wait else 0
    if as_json:
        print_json({**client.job(job["id"]), **({"skipped": skipped} if skipped else {})})
    return code


@with_server
def show_all(
    server: Server,
    state: Annotated[str | None, typer.Option(help="Only those in this state.")] = None,
    kind: Annotated[str | None, typer.Option(help="Only those of this kind.")] = None,
    label: Annotated[str | None, typer.Option(help="Only those with this label, or with it as a word.")] = None,
    count: Annotated[int, typer.Option(min=1, help="How many.")] = 20,
    json: Json = False,
) -> int:
    """List jobs, the newest first."""
    filters = {name: x for name, x in (("state", state), ("kind", kind), ("label", label)) if x}
    with server.client() as client:
        found = [job for _, job in zip(range(count), client.jobs(**filters), strict=False)]
    if json:
        print_json(found)
        return 0
    rows = [
        (job["id"], job["created"][:19], job["kind"], job["state"], counted(job), job["label"] or "") for job in found
    ]
    table(("id", "created", "kind", "state", "items", "label"), rows)
    return 0


@with_server
def show(server: Server, id: Id) -> int:  # noqa: A002 -- an argument
    """Print a job as JSON."""
    with server.client() as client:
        print_json(client.job(id))
    return 0


@with_server
def cancel(server: Server, id: Id, json: Json = False) -> int:  # noqa: A002 -- an argument
    """Cancel what is not finished."""
    with server.client() as client:
        job = client.cancel_job(id)
    if json:
        print_json(job)
    else:
        print(job["state"])
    return 0


@with_server
def watch(server: Server, id: Id, patience: Patience = PATIENCE, json: Json = False) -> int:  # noqa: A002 -- an argument
    """Follow a job until it has ended."""
    with server.client() as client:
        code = follow(client, id, patience)
        if json:
            print_json(client.job(id))
    return code


@with_server
def result(
    server: Server,
    id: Id,  # noqa: A002 -- an argument
    output: Annotated[Path | None, typer.Option(help="Save everything there is as this zip file.")] = None,
    json: Json = False,
) -> int:
    """Print what came of every item, or save all files."""
    with server.client() as client:
        if output is not None:
            size = client.download(f"/v1/jobs/{step(id)}/archive", output)
            print(f"{output}: {size:,} bytes")
            return 0
        found = client.job_items(id)
        if json:
            print_json(list(found))
            return 0
        for item in found:
            what = item["problem"]["detail"] if item["problem"] else dumps(item["result"] or {})
            subject = f"{item['subject']}: " if item["subject"] else ""
            print(f"{item['position']}  {item['state']}  {subject}{what}")
    return 0


@with_server
def sweep_table(
    server: Server,
    id: Id,  # noqa: A002 -- an argument
    sort: Sort = "",
    where: Where = "",
    columns: Columns = "",
    pareto: Front = False,
    out: Out = None,
    count: Count = ROWS,
    json: Json = False,
) -> int:
    """Print the table of a sweep, also while it runs, or save it."""
    require_suffix(out)
    with server.client() as client:
        print_rows(client, id, {"sort": sort, "where": where, "columns": columns}, pareto, out, count, json)
    return 0


COMMANDS = {
    "jobs": {
        "submit": submit,
        "retry": retry,
        "rm": remove,
        "evaluate": evaluate,
        "list": show_all,
        "show": show,
        "cancel": cancel,
        "watch": watch,
        "result": result,
        "table": sweep_table,
    }
}
