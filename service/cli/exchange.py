"""The commands ``pull``, ``push``, ``bundle`` and ``mirror``: parts between servers, as files and by a job."""

from __future__ import annotations

import os
from collections.abc import Sequence
from pathlib import Path
from typing import Annotated, Any

import typer

from service.cli.options import Json, Private, Server, with_server
from service.cli.output import print_json, waiting
from service.cli.progress import follow
from substructures.client import Client

ZIP = "application/zip"
Other = Annotated[str, typer.Argument(metavar="URL", help="Address of the other server.")]
OtherKey = Annotated[
    str | None,
    typer.Option(metavar="KEY", envvar="SUBSTRUCTURES_OTHER_KEY", help="API key of the other server."),
]
References = Annotated[list[str], typer.Argument(metavar="REF...", help="NAME, NAME@2 or NAME@ALIAS.")]


@with_server
def pull(
    server: Server,
    url: Other,
    refs: References,
    other_key: OtherKey = None,
    private: Private = False,
    json: Json = False,
) -> int:
    """Copy parts of another server to this one, which verifies them."""
    with Server(url, other_key).client() as other:
        content = _bundle(other, refs)
    with server.client() as client:
        return _told(_stored(client, content, private), json)


@with_server
def push(
    server: Server,
    url: Other,
    refs: References,
    other_key: OtherKey = None,
    private: Private = False,
    json: Json = False,
) -> int:
    """Copy parts of this server to another one, which verifies them."""
    with server.client() as client:
        content = _bundle(client, refs)
    with Server(url, other_key).client() as other:
        return _told(_stored(other, content, private), json)


@with_server
def save(server: Server, file: Annotated[Path, typer.Argument(metavar="FILE")], refs: References) -> int:
    """Write parts with their formulas and certificates to a file."""
    with server.client() as client:
        content = _bundle(client, refs)
    # never a part of a file under the name
    beside = file.with_name(f".{file.name}.{os.getpid()}")
    beside.write_bytes(content)
    beside.replace(file)
    print(f"{file}: {len(content)} bytes")
    return 0


@with_server
def load(
    server: Server,
    file: Annotated[Path, typer.Argument(metavar="FILE")],
    private: Private = False,
    json: Json = False,
) -> int:
    """Verify and store what is in a file; all of it, or nothing."""
    content = file.read_bytes()
    with server.client() as client:
        return _told(_stored(client, content, private), json)


@with_server
def mirror(
    server: Server,
    url: Other,
    wait: Annotated[bool, typer.Option("--wait", help="Wait until it has ended.")] = False,
    json: Json = False,
) -> int:
    """Copy all public parts of another server, as a job that goes on where it ended.

    The server does it, from addresses that its setting SUBSTRUCTURES_MIRROR_SOURCES names.
    """
    with server.client() as client:
        job = client.submit_job({"kind": "mirror", "items": [{"source": url}]})
        if not json:
            print(job["id"], flush=True)
        code = follow(client, job["id"]) if wait else 0
        if json:
            print_json(client.job(job["id"]))
    return code


def _bundle(client: Client, refs: Sequence[str]) -> bytes:
    with waiting("reading"):
        content: bytes = client.request("GET", "/v1/bundles", params={"refs": ",".join(refs)}).content
    return content


def _stored(client: Client, content: bytes, private: bool) -> list[dict[str, Any]]:
    wanted = {"visibility": "private"} if private else {}
    with waiting("verifying"):
        answer = client.request("POST", "/v1/bundles", content=content, headers={"Content-Type": ZIP}, params=wanted)
    found: list[dict[str, Any]] = answer.json()["items"]
    return found


def _told(found: Sequence[dict[str, Any]], as_json: bool) -> int:
    if as_json:
        print_json(found)
        return 0
    for each in found:
        what = "stored" if each["outcome"] == "stored" else "was stored already"
        print(f"{each['name']}@{each['version']} {what}, {each['digest']}")
    return 0


COMMANDS = {"pull": pull, "push": push, "bundle": {"save": save, "load": load}, "mirror": mirror}
