"""The commands ``tree``, ``couple`` and ``rm``: trees of a server."""

from __future__ import annotations

from collections.abc import Mapping
from contextlib import nullcontext
from pathlib import Path
from typing import Annotated, Any

import typer

from service.cli import completion
from service.cli.documents import is_document, named, read_document
from service.cli.options import Json, Note, Private, Server, Wait, with_server
from service.cli.output import print_json, tell_warnings, waiting
from service.cli.progress import became_job
from service.cli.values import value, values
from substructures.client.steps import step

Name = Annotated[str, typer.Argument(metavar="TREE", autocompletion=completion.trees)]
Several = list[str] | None
Set = Annotated[
    Several,
    typer.Option("--set", metavar="NAME=VALUE", help="A parameter of the part, also '500 mm'; may be repeated."),
]
Vector = str | None


@with_server
def tree(
    server: Server,
    tree: Annotated[str, typer.Argument(metavar="FILE|NAME", help="A document, JSON or YAML, or a name.")],
    part: Annotated[
        Several,
        typer.Option(metavar="[NAME=]PART", help="A part on the world, for a tree by its name; may be repeated."),
    ] = None,
    gravity: Annotated[str, typer.Option(metavar="X,Y,Z", help="Acceleration in the world, m/s^2.")] = "0,0,-9.81",
    note: Note = "",
    private: Private = False,
    wait: Wait = True,
    json: Json = False,
) -> int:
    """Make a tree of a document, or begin one with parts on the world; one of that name is there still, as a revision
    before.
    """
    if is_document(tree):
        body = read_document(Path(tree))
        if part:
            raise typer.BadParameter("--part goes with a name, not with a document")
    elif not part:
        what = f"a document or '--part NAME=PART' says what '{tree}' is to be made of"
        raise typer.BadParameter(
            f"{what}; 'substructures show {tree}' shows a tree, 'couple {tree} PART' goes on with it"
        )
    else:
        body = {
            "name": tree,
            "gravity": _vector("--gravity", gravity),
            "instances": [_instance(each) for each in part or ()],
        }
    if isinstance(body, dict):
        body |= {"note": note} if note else {}
        body |= {"visibility": "private"} if private else {}
    with named(Path(tree)) if is_document(tree) else nullcontext():
        return _changed(server, "POST", "/v1/trees", body, wait, json)


@with_server
def couple(
    server: Server,
    tree: Name,
    part: Annotated[
        str, typer.Argument(metavar="PART", help="Name in the catalogue; also NAME@2.", autocompletion=completion.parts)
    ],
    at: Annotated[
        str,
        typer.Option(metavar="INSTANCE.PORT", help="Where it is mounted.", autocompletion=completion.places),
    ] = "world",
    name: Annotated[str | None, typer.Option(help="Of the instance (that of the part).")] = None,
    set: Set = None,  # noqa: A002 -- name of the option
    position: Annotated[Vector, typer.Option(metavar="X,Y,Z", help="In m, also '0,0,50 mm', and expressions.")] = None,
    rpy: Annotated[Vector, typer.Option(metavar="X,Y,Z", help="Roll, pitch, yaw in rad, also '0,0,90 deg'.")] = None,
    wait: Wait = True,
    json: Json = False,
) -> int:
    """Couple a part onto a tree, which makes a new revision."""
    body: dict[str, Any] = {**_instance(part), "at": at, "parameters": values(set)}
    body |= {"name": name} if name else {}
    placement = {
        key: _vector(f"--{key}", text) for key, text in (("position", position), ("rpy", rpy)) if text is not None
    }
    body |= {"placement": placement} if placement else {}
    return _changed(server, "POST", f"/v1/trees/{step(tree)}/couplings", body, wait, json)


@with_server
def remove(
    server: Server,
    trees: Annotated[list[str], typer.Argument(metavar="TREE...", help="Names.", autocompletion=completion.trees)],
    json: Json = False,
) -> int:
    """Remove trees with all their revisions; the parts stay."""
    with server.client() as client:
        for name in trees:
            client.request("DELETE", f"/v1/trees/{step(name)}")
    if json:
        print_json({"removed": trees})
    return 0


def _changed(server: Server, method: str, path: str, body: Any, wait: bool, as_json: bool) -> int:
    with server.client() as client:
        with waiting("coupling"):
            answer = client.request(method, path, body)
        found = answer.json()
        if answer.status_code == 202:
            return became_job(client, found, wait, as_json)
    if as_json:
        print_json(found)
        return 0
    what = "was there already" if answer.status_code == 200 else "made"
    if path == "/v1/trees" and what == "made" and found["revision"] > 1:
        what += f" in place of {found['name']}@{found['revision'] - 1}, which stays"
    print(f"{found['name']}@{found['revision']} {what}: {found['dof']} coordinates, {_instances(found)}")
    tell_warnings(found)
    return 0


def _instances(found: Mapping[str, Any]) -> str:
    return ", ".join(f"{i['name']} at {i.get('at', 'world')}" for i in found["instances"]) or "no instances"


def _instance(text: str) -> dict[str, Any]:
    """``arm=puma560@2``, or ``puma560@2``, whose name is made of that of the part."""
    name, sign, part = text.rpartition("=")
    return {"name": name if sign else part.partition("@")[0].replace("-", "_"), "substructure": part}


def _vector(option: str, text: str) -> list[Any]:
    """Three numbers, also with units, or expressions."""
    found = [each.strip() for each in text.split(",")]
    if len(found) != 3 or not all(found):
        raise typer.BadParameter(f"{option}: X,Y,Z is needed, found '{text}'")
    return [value(each) for each in found]


COMMANDS = {"tree": tree, "couple": couple, "rm": remove}
