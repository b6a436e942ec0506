"""The commands ``pull``, ``push``, ``bundle`` and ``mirror``: parts between servers, as files and by a job."""

from __future__ import annotations

import sys
from collections.abc import Sequence
from pathlib import Path
from typing import Annotated, Any

import typer

from service.cli.options import Json, Private, Server, with_server
from service.cli.output import print_json, waiting
from service.cli.progress import follow
from service.messages.viewer import PRIVATE
from substructures.client import Client
from substructures.client.files import save as save_file
from substructures.errors import listed

ZIP = "application/zip"
Other = Annotated[str, typer.Argument(metavar="URL", help="Address of the other server.")]
OtherKey = Annotated[
    str | None,
    typer.Option(metavar="KEY", envvar="SUBSTRUCTURES_OTHER_KEY", help="API key of the other server."),
]
Visibility = Annotated[
    bool | None,
    typer.Option(
        "--private/--public", help="For the keys of their owner alone, or for all, also parts that were private."
    ),
]
NAMED = 5  # private parts in a message
References = Annotated[list[str], typer.Argument(metavar="REF...", help="NAME, NAME@2 or NAME@ALIAS.")]


@with_server
def pull(
    server: Server,
    url: Other,
    refs: References,
    other_key: OtherKey = None,
    private: Visibility = None,
    json: Json = False,
) -> int:
    """Copy parts of another server to this one, which derives them anew."""
    with _other(url, other_key).client() as other:
        content = _bundle(other, refs)
        _require_decision(other, refs, private)
    with server.client() as client:
        return _told(_stored(client, content, private), json)


@with_server
def push(
    server: Server,
    url: Other,
    refs: References,
    other_key: OtherKey = None,
    private: Visibility = None,
    json: Json = False,
) -> int:
    """Copy parts of this server to another one, which derives them anew."""
    with server.client() as client:
        content = _bundle(client, refs)
        _require_decision(client, refs, private)
    with _other(url, other_key).client() as other:
        return _told(_stored(other, content, private), json)


@with_server
def save(
    server: Server, file: Annotated[Path, typer.Argument(metavar="FILE")], refs: References, json: Json = False
) -> int:
    """Write parts with their formulas and certificates to a file, which does not say which of them are private."""
    with server.client() as client:
        content = _bundle(client, refs)
        hidden = _private(client, refs)
    if hidden:
        advice = "whoever loads the file makes them public, unless by 'bundle load --private'"
        print(f"warning: private: {listed(hidden, NAMED)}; {advice}", file=sys.stderr)
    save_file(file, content)
    if json:
        print_json({"file": str(file), "bytes": len(content)})
    else:
        print(f"{file}: {len(content)} bytes")
    return 0


@with_server
def load(
    server: Server,
    file: Annotated[Path, typer.Argument(metavar="FILE")],
    private: Private = False,
    json: Json = False,
) -> int:
    """Derive and store what is in a file; all of it, or nothing."""
    content = file.read_bytes()
    with server.client() as client:
        return _told(_stored(client, content, private), json)


@with_server
def mirror(
    server: Server,
    url: Other,
    wait: Annotated[bool, typer.Option(help="Wait until it has ended.")] = True,
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
        elif wait:
            _tell_mirrored(client, job["id"])
    return code


def _tell_mirrored(client: Client, job: str) -> None:
    """How many parts there were, and what became of them; which were refused, and why."""
    for item in client.job_items(job, state="succeeded"):
        found = item["result"]
        for each in found["refused"]["items"]:
            print(f"refused: {each['name']}: {each['message']}", file=sys.stderr)
        counts = ", ".join(f"{found[name]['count']} {name}" for name in ("stored", "same", "refused"))
        print(f"{found['offered']} parts at {found['source']}: {counts}")
        for each in found["differing"]["items"]:
            print(f"{each}: formulas derived here, those of the source differ")


def _other(url: str, key: str | None) -> Server:
    return Server(url, key, key_from="--other-key KEY, or the variable SUBSTRUCTURES_OTHER_KEY", is_other=True)


def _bundle(client: Client, refs: Sequence[str]) -> bytes:
    with waiting("reading"):
        content: bytes = client.request("GET", "/v1/bundles", params={"refs": ",".join(refs)}).content
    return content


def _private(client: Client, refs: Sequence[str]) -> list[str]:
    """The names of those that only their owner sees."""
    names = dict.fromkeys(ref.strip().partition("@")[0] for text in refs for ref in text.split(",") if ref.strip())
    return [name for name in names if client.visibility(name)["visibility"] == PRIVATE]


def _require_decision(client: Client, refs: Sequence[str], private: bool | None) -> None:
    """Raise ValueError where private parts would become public, for good, and nobody said so."""
    hidden = _private(client, refs) if private is None else []
    if hidden:
        advice = "--private keeps them so, --public shows them to all, for good"
        raise ValueError(f"nothing was copied, for there are private parts: {listed(hidden, NAMED)}; {advice}")


def _stored(client: Client, content: bytes, private: bool | None) -> list[dict[str, Any]]:
    wanted = {"visibility": PRIVATE} if private else {}
    with waiting("deriving"):
        answer = client.request("POST", "/v1/bundles", content=content, headers={"Content-Type": ZIP}, params=wanted)
    found: list[dict[str, Any]] = answer.json()["items"]
    return found


def _told(found: Sequence[dict[str, Any]], as_json: bool) -> int:
    if as_json:
        print_json(found)
        return 0
    for each in found:
        what = "stored" if each["outcome"] == "stored" else "was stored already"
        differ = "; formulas derived here, those of the bundle differ" if each["formulas"] == "differ" else ""
        print(f"{each['name']}@{each['version']} {what}, {each['digest']}{differ}")
    return 0


COMMANDS = {"pull": pull, "push": push, "bundle": {"save": save, "load": load}, "mirror": mirror}
