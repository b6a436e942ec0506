"""The command ``jobs``: submit, watch and read batch jobs of a server."""

from __future__ import annotations

import argparse
import json
import sys
from collections.abc import Iterable, Iterator, Mapping
from contextlib import contextmanager
from math import nan
from pathlib import Path
from typing import Any

from service.cli.options import Add, add_action, add_server, named, read_document, read_from
from service.cli.progress import counted, follow
from substructures.client import Client
from substructures.client.connection import step
from substructures.client.jobs import FORMATS, PATIENCE
from substructures.errors import InvalidDocument
from substructures.formats import arrow
from substructures.formats.arrays import read_npz

EPILOG = """\
{"kind": "evaluate", "items": [{"tree": "swing", "request": {"quantities": ["metric"], "q": [[0, 0], [1, 0]]}}]}
{"kind": "simulate", "template": {"tree": "swing", "request": {"q": [0, 0], "span": [0, 5], "step": 0.05}},
 "choices": {"/request/q/0": [0.1, 0.2]}}

An item is, for
  assemble             a tree document
  derive               a definition
  verify               substructure (* for all)
  compare              a, b (a list, or * for the catalogue), coordinates
  evaluate             tree, request, grid or sample, format
  simulate, optimise   tree, request or requests, format
  analyse              tree, analysis, request or requests, format
  export               tree, quantity, format, form, bind, options
  mirror               source

A choice is a list of values for a place in the template: a JSON pointer, or in a tree document an instance or
instance.parameter. All combinations are computed. The full description of all fields is JobRequest in the OpenAPI
document: 'substructures openapi', or /openapi.json of a server.

With --wait the exit code is 0 when all items succeeded, 3 when some failed, 4 when all did, 5 when it was cancelled.
"""


def _add_jobs(jobs: argparse.ArgumentParser) -> None:
    actions = jobs.add_subparsers(title="actions", required=True, metavar="ACTION")
    command = add_action(actions, "submit", _submit, "queue the job in a file")
    command.add_argument("file", type=Path, help='{"kind", "items"} or {"kind", "template", "choices"}, JSON or YAML')
    command.formatter_class, command.epilog = argparse.RawDescriptionHelpFormatter, EPILOG
    command.add_argument("--label", help="what it is for, in words")
    _add_wait(command)
    add_server(command)
    command = add_action(actions, "retry", _retry, "once more what of a job failed or was cancelled, as a new job")
    command.add_argument("id")
    _add_wait(command)
    add_server(command)
    command = add_action(actions, "rm", _remove, "remove jobs that have ended, with their results")
    command.add_argument("id", nargs="+")
    add_server(command)
    command = add_action(actions, "evaluate", _evaluate, "queue the evaluation of a tree for a file of states")
    command.add_argument("tree", help="name of a tree")
    command.add_argument(
        "file", type=Path, help="states: .npz or .arrow with q, qd, t, inputs.<name>, ...; .json, .yaml"
    )
    command.add_argument("--quantities", help="metric,forces,... (default: those in the file)")
    command.add_argument("--format", choices=tuple(FORMATS), default="npz", help="of the results (npz)")
    _add_wait(command)
    add_server(command)
    command = add_action(actions, "list", _list, "list jobs, the newest first")
    command.add_argument("--state", help="only those in this state")
    command.add_argument("--kind", help="only those of this kind")
    command.add_argument("--count", type=_count, default=20, help="how many (20)")
    add_server(command)
    for name, run, text in (
        ("show", _show, "print a job as JSON"),
        ("cancel", _cancel, "cancel what is not finished"),
        ("watch", _watch, "follow a job until it has ended"),
        ("result", _result, "print what came of every item, or save all files"),
    ):
        command = add_action(actions, name, run, text)
        command.add_argument("id")
        add_server(command)
        if run is _watch:
            _add_patience(command)
    command.add_argument("--output", type=Path, help="save everything there is as this zip file")


def _add_wait(command: argparse.ArgumentParser) -> None:
    command.add_argument("--wait", action="store_true", help="wait until it has ended")
    _add_patience(command)


def _add_patience(command: argparse.ArgumentParser) -> None:
    text = f"seconds to go on when the server cannot be reached ({PATIENCE:g})"
    command.add_argument("--patience", type=_patience, default=PATIENCE, metavar="SECONDS", help=text)


def _count(text: str) -> int:
    if not text.isdecimal() or not int(text):
        raise argparse.ArgumentTypeError(f"a whole number from 1 is needed, found '{text}'")
    return int(text)


def _patience(text: str) -> float:
    try:
        seconds = float(text)
    except ValueError:
        seconds = nan
    if not seconds > 0:
        raise argparse.ArgumentTypeError(f"a number of seconds above 0 is needed, found '{text}'")
    return seconds


def _client(options: argparse.Namespace) -> Client:
    return Client(options.server, options.key)


def _submit(options: argparse.Namespace) -> int:
    with _client(options) as client:
        document = read_document(options.file)
        if options.label is not None and isinstance(document, dict):
            document["label"] = options.label
        return _queued(client, client.submit_job(document), options)


def _retry(options: argparse.Namespace) -> int:
    with _client(options) as client:
        return _queued(client, client.retry_job(options.id), options)


def _remove(options: argparse.Namespace) -> int:
    with _client(options) as client:
        for job in options.id:
            client.remove_job(job)
    return 0


def _evaluate(options: argparse.Namespace) -> int:
    with _states(options.file) as (constants, states), _client(options) as client:
        if options.quantities:
            constants["quantities"] = options.quantities.split(",")
        return _queued(client, client.submit_states(options.tree, states, options.format, **constants), options)


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
            yield {name: json.loads(text) for name, text in reader.metadata.items()}, reader
        else:
            states = read_from(path, file)
            if not isinstance(states, dict):
                raise InvalidDocument.at("", "object-expected", "an object with 'quantities', 'q', ... is needed")
            yield {}, states


def _queued(client: Client, job: Mapping[str, Any], options: argparse.Namespace) -> int:
    print(job["id"], flush=True)
    return follow(client, job["id"], options.patience) if options.wait else 0


def _list(options: argparse.Namespace) -> int:
    filters = {name: getattr(options, name) for name in ("state", "kind") if getattr(options, name)}
    with _client(options) as client:
        for _, job in zip(range(options.count), client.jobs(**filters), strict=False):
            state = f"{job['kind']:<9} {job['state']:<10} {counted(job)}  {job['label']}".rstrip()
            print(f"{job['id']}  {job['created'][:19]}  {state}")
    return 0


def _show(options: argparse.Namespace) -> int:
    with _client(options) as client:
        print(json.dumps(client.job(options.id), indent=1))
    return 0


def _cancel(options: argparse.Namespace) -> int:
    with _client(options) as client:
        print(client.cancel_job(options.id)["state"])
    return 0


def _watch(options: argparse.Namespace) -> int:
    with _client(options) as client:
        return follow(client, options.id, options.patience)


def _result(options: argparse.Namespace) -> int:
    with _client(options) as client:
        if options.output is not None:
            size = client.download(f"/v1/jobs/{step(options.id)}/archive", options.output)
            print(f"{options.output}: {size:,} bytes")
            return 0
        for item in client.job_items(options.id):
            what = item["problem"]["detail"] if item["problem"] else json.dumps(item["result"] or {})
            subject = f"{item['subject']}: " if item["subject"] else ""
            print(f"{item['position']}  {item['state']}  {subject}{what}")
    return 0


ADD: Add = {"jobs": _add_jobs}
