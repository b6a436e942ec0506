"""The commands ``substructures jobs``, ``backup`` and ``restore``."""

from __future__ import annotations

import argparse
import json
import os
import sys
from collections.abc import Callable
from pathlib import Path
from time import monotonic
from typing import Any, TextIO

from service.backup import backup, restore
from service.client import Client
from service.settings import from_environment
from substructures.documents import read_json, read_yaml

Add = Callable[[Any, str, Callable[[argparse.Namespace], int], str], argparse.ArgumentParser]
SERVER = "http://127.0.0.1:8000"
WIDTH = 30
LINES = 10.0  # seconds between lines where there is no terminal


def register(commands: Any, add: Add, add_database: Callable[[argparse.ArgumentParser], None]) -> None:
    """Add the commands to a parser."""
    jobs = commands.add_parser("jobs", help="submit, watch and read batch jobs")
    actions = jobs.add_subparsers(title="actions", required=True, metavar="ACTION")
    command = add(actions, "submit", _submit, "queue the job in a file")
    command.add_argument("file", type=Path, help='{"kind", "items"} or {"kind", "template", "choices"}, JSON or YAML')
    command.add_argument("--wait", action="store_true", help="wait until it has ended")
    add_server(command)
    command = add(actions, "list", _list, "list jobs, the newest first")
    command.add_argument("--state", help="only those in this state")
    command.add_argument("--kind", help="only those of this kind")
    command.add_argument("--count", type=int, default=20, help="how many (20)")
    add_server(command)
    for name, run, text in (
        ("show", _show, "print a job as JSON"),
        ("cancel", _cancel, "cancel what is not finished"),
        ("watch", _watch, "follow a job until it has ended"),
        ("result", _result, "print what came of every item, or save all files"),
    ):
        command = add(actions, name, run, text)
        command.add_argument("id")
        add_server(command)
    command.add_argument("--output", type=Path, help="save everything there is as this zip file")
    command = add(commands, "backup", _backup, "copy the SQLite store to a file, also while a server runs")
    command.add_argument("file", type=Path)
    add_database(command)
    command = add(commands, "restore", _restore, "put a backup in the place of the SQLite store")
    command.add_argument("file", type=Path)
    command.add_argument("--overwrite", action="store_true", help="replace a store that is there")
    add_database(command)


def add_server(command: argparse.ArgumentParser) -> None:
    """The options of every command that talks to a server."""
    command.add_argument("--server", default=SERVER, help=f"address ({SERVER})")
    command.add_argument("--key", default=os.environ.get("SUBSTRUCTURES_KEY"), help="API key ($SUBSTRUCTURES_KEY)")


def read_document(path: Path) -> Any:
    """A document in JSON or YAML. Raises InvalidDocument."""
    data = path.read_bytes()
    return read_json(data) if path.suffix == ".json" else read_yaml(data)


def _client(options: argparse.Namespace) -> Client:
    return Client(options.server, options.key)


def _submit(options: argparse.Namespace) -> int:
    with _client(options) as client:
        job = client.submit_job(read_document(options.file))
        print(job["id"], flush=True)
        return follow(client, job["id"]) if options.wait else 0


def _list(options: argparse.Namespace) -> int:
    filters = {name: getattr(options, name) for name in ("state", "kind") if getattr(options, name)}
    with _client(options) as client:
        for _, job in zip(range(options.count), client.jobs(**filters), strict=False):
            print(f"{job['id']}  {job['created'][:19]}  {job['kind']:<9} {job['state']:<10} {_counted(job)}")
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
        return follow(client, options.id)


def _result(options: argparse.Namespace) -> int:
    with _client(options) as client:
        if options.output is not None:
            size = client.download(f"/v1/jobs/{options.id}/archive", options.output)
            print(f"{options.output}: {size:,} bytes")
            return 0
        for item in client.job_items(options.id):
            what = item["problem"]["detail"] if item["problem"] else json.dumps(item["result"] or {})
            print(f"{item['position']}  {item['state']}  {what}")
    return 0


def _backup(options: argparse.Namespace) -> int:
    print(f"{options.file}: {backup(_database(options), options.file):,} bytes")
    return 0


def _restore(options: argparse.Namespace) -> int:
    restore(options.file, _database(options), options.overwrite)
    print(f"{options.file} restored")
    return 0


def _database(options: argparse.Namespace) -> str:
    return from_environment(os.environ, database=options.database).database


def follow(client: Client, job: str) -> int:
    """Show the progress of a job until it has ended; 0 when all items succeeded."""
    bar = Bar(sys.stderr)
    end = client.wait(job, bar.show)
    bar.end(end)
    return 0 if end["state"] == "succeeded" and not end["progress"]["failed"] else 1


class Bar:
    """A line that is written over on a terminal; elsewhere a new line now and then."""

    def __init__(self, stream: TextIO) -> None:
        self._stream, self._next, self._width = stream, 0.0, 0

    def show(self, job: dict[str, Any]) -> None:
        """Show where a job is."""
        if self._stream.isatty():
            line = text(job)
            self._stream.write("\r" + line.ljust(self._width))
            self._width = len(line)
        elif monotonic() >= self._next:
            self._stream.write(text(job) + "\n")
            self._next = monotonic() + LINES
        self._stream.flush()

    def end(self, job: dict[str, Any]) -> None:
        """Leave the last line."""
        self._next = 0.0
        self.show(job)
        if self._stream.isatty():
            self._stream.write("\n")


def text(job: dict[str, Any]) -> str:
    """A line about a job: a bar, the state, counts, rate and time left."""
    progress = job["progress"]
    done = int(WIDTH * progress["fraction"])
    words = [
        f"[{'#' * done}{'.' * (WIDTH - done)}]",
        f"{100 * progress['fraction']:.0f} %",
        job["state"],
        _counted(job),
    ]
    if progress["rate"]:
        words.append(f"{progress['rate']:.3g}/s")
    if progress["eta_seconds"] is not None:
        words.append(f"{_time(progress['eta_seconds'])} left")
    return "  ".join(words)


def _counted(job: dict[str, Any]) -> str:
    progress = job["progress"]
    failed = f", {progress['failed']:,} failed" if progress["failed"] else ""
    return f"{progress['done']:,} of {progress['total']:,}{failed}"


def _time(seconds: float) -> str:
    minutes, rest = divmod(round(seconds), 60)
    hours, minutes = divmod(minutes, 60)
    return f"{hours} h {minutes} min" if hours else f"{minutes} min {rest} s" if minutes else f"{rest} s"
