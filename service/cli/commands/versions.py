"""The commands ``versions``, ``diff``, ``uses``, ``withdraw`` and ``publish``: what became of parts and trees on a
server."""

from __future__ import annotations

import sys
from collections.abc import Iterator
from contextlib import contextmanager
from typing import Annotated, Any
from urllib.parse import quote

import typer

from service.cli import completion
from service.cli.options import Json, Note, OfTrees, Private, Server, Wait, with_server
from service.cli.output import further, print_json, table, waiting
from service.cli.pages import items
from service.cli.progress import became_job
from substructures.client.problems import ProblemError
from substructures.client.steps import step

Reference = Annotated[
    str,
    typer.Argument(metavar="REF", help="name@1; a bare name is the latest.", autocompletion=completion.parts_or_trees),
]


@with_server
def versions(
    server: Server,
    name: Annotated[
        str, typer.Argument(help="Of a part, or with --tree of a tree.", autocompletion=completion.parts_or_trees)
    ],
    tree: OfTrees = False,
    json: Json = False,
) -> int:
    """List the versions of a part, or the revisions of a tree, the newest first."""
    kind, number = ("revisions", "revision") if tree else ("versions", "version")
    with server.client() as client, _of_parts():
        found = list(items(client, f"/v1/{'trees' if tree else 'substructures'}/{step(name)}/{kind}"))
    if json:
        print_json(found)
        return 0
    rows = []
    for each in found:
        words = "; ".join(filter(None, [*_whence(each), each["note"]]))
        rows.append((f"{each['name']}@{each[number]}", each["created"][:16], each["owner"], words))
    table(("version", "created", "owner", "what"), rows)
    return 0


@contextmanager
def _of_parts() -> Iterator[None]:
    """Say of a part that is not there how trees are meant. Raises ProblemError."""
    try:
        yield
    except ProblemError as error:
        if error.problem.get("code") != "unknown-substructure":
            raise
        told = {"detail": further(error.problem["detail"], "for trees there is --tree")}
        raise ProblemError(error.status, {**error.problem, **told}) from None


def _whence(each: dict[str, Any]) -> list[str]:
    found = [f"of {each[name]}" for name in ("derived_from", "tree") if each.get(name)]
    found += [f"changes @{each['based_on']}"] if each.get("based_on") else []
    if each.get("is_withdrawn"):
        instead = f", take {each['successor']}" if each["successor"] else ""
        found.append(f"WITHDRAWN ({each['withdrawal_reason'] or 'no reason given'}{instead})")
    return found


@with_server
def diff(
    server: Server,
    a: Reference,
    b: Annotated[
        str,
        typer.Argument(
            metavar="REF", help="What it is compared with, also another part.", autocompletion=completion.parts_or_trees
        ),
    ],
    tree: OfTrees = False,
    json: Json = False,
) -> int:
    """Tell how two versions, or two revisions of a tree, differ."""
    kind = "trees" if tree else "substructures"
    with server.client() as client, _of_parts():
        found = client.request("GET", f"/v1/{kind}/{step(a)}/difference?to={quote(b)}").json()
    if json:
        print_json(found)
        return 0
    print(f"{found['a']} -> {found['b']}")
    for words in found["words"]:
        print(f"  {words}")
    return 0


@with_server
def uses(
    server: Server,
    ref: Annotated[
        str, typer.Argument(metavar="REF", help="name@1, or a name for all versions.", autocompletion=completion.parts)
    ],
    json: Json = False,
) -> int:
    """List what uses a part: revisions of trees, parts that such trees became, versions made of it."""
    with server.client() as client:
        found = list(items(client, f"/v1/substructures/{step(ref)}/uses"))
    if json:
        print_json(found)
        return 0
    rows = []
    for each in found:
        instances = ", ".join(f"{name} @{version}" for name, version in each["instances"].items())
        rows.append((each["kind"], f"{each['name']}@{each['number']}", instances))
    if not rows:
        print(f"nothing uses {ref}", file=sys.stderr)
        return 0
    table(("kind", "what", "instances"), rows)
    return 0


@with_server
def withdraw(
    server: Server,
    ref: Annotated[str, typer.Argument(metavar="REF", help="name@1.", autocompletion=completion.parts)],
    reason: Annotated[str, typer.Option(help="Why; it is shown wherever the version is used.")] = "",
    instead: Annotated[
        str | None, typer.Option(metavar="REF", help="What to take in its place.", autocompletion=completion.parts)
    ] = None,
    json: Json = False,
) -> int:
    """Withdraw a version of a part: what uses it goes on and is told, and it is the latest no more."""
    body = {"reason": reason} | ({"successor": instead} if instead else {})
    with server.client() as client:
        found = client.request("POST", f"/v1/substructures/{step(ref)}/withdraw", body).json()
    if json:
        print_json(found)
        return 0
    told = f"; take {found['successor']}" if found["successor"] else ""
    print(f"{found['name']}@{found['version']} is withdrawn: {found['withdrawal_reason'] or 'no reason given'}{told}")
    return 0


@with_server
def publish(
    server: Server,
    tree: Annotated[str, typer.Argument(help="name, or name@2.", autocompletion=completion.trees)],
    name: Annotated[str, typer.Option(help="Of the part (that of the tree).")] = "",
    port: Annotated[
        list[str] | None,
        typer.Option(metavar="NAME=INSTANCE.PORT", help="May be repeated (all).", autocompletion=completion.places),
    ] = None,
    free: Annotated[
        list[str] | None, typer.Option(metavar="PARAMETER", help="That is bound to a number; may be repeated.")
    ] = None,
    note: Note = "",
    private: Private = False,
    wait: Wait = True,
    json: Json = False,
) -> int:
    """Make a part of a tree."""
    body: dict[str, Any] = {"note": note, "free": free or []}
    body |= {"name": name} if name else {}
    body |= {"ports": dict(map(_pair, port))} if port else {}
    body |= {"visibility": "private"} if private else {}
    with server.client() as client:
        with waiting("deriving"):
            answer = client.request("POST", f"/v1/trees/{step(tree)}/publish", body)
        found = answer.json()
        if answer.status_code == 202:
            return became_job(client, found, wait, json)
    if json:
        print_json(found)
        return 0
    stored = "published" if answer.status_code == 201 else "was published already"
    print(f"{found['name']}@{found['version']} {stored}: ports {', '.join(found['ports']) or 'none'}")
    return 0


def _pair(text: str) -> tuple[str, str]:
    name, sign, place = text.partition("=")
    if not sign:
        raise typer.BadParameter(f"NAME=INSTANCE.PORT is needed, found '{text}'")
    return name, place


COMMANDS = {"versions": versions, "diff": diff, "uses": uses, "withdraw": withdraw, "publish": publish}
