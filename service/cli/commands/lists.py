"""The commands ``list`` and ``search``: parts or trees of a server."""

from __future__ import annotations

import sys
from itertools import islice
from typing import Annotated, Any

import typer

from service.cli import completion
from service.cli.options import Json, OfTrees, Server, with_server
from service.cli.output import print_json, table
from service.cli.pages import items

Owner = Annotated[str | None, typer.Option(help="Of this owner.")]
Count = Annotated[int, typer.Option(min=1, help="How many at most.")]


@with_server
def show_all(
    server: Server, tree: OfTrees = False, owner: Owner = None, count: Count = 1000, json: Json = False
) -> int:
    """List the parts of a server, each in its latest version, or its trees."""
    return _found(server, tree, {"owner": owner}, count, json)


@with_server
def search(
    server: Server,
    words: Annotated[list[str] | None, typer.Argument(help="In names, titles and descriptions.")] = None,
    tree: OfTrees = False,
    joints: Annotated[str | None, typer.Option(help="Types of the joints in order, e.g. RRP.")] = None,
    tag: Annotated[str | None, typer.Option(help="Of parts.")] = None,
    port: Annotated[
        str | None, typer.Option(help="Parts that have a port of this name.", autocompletion=completion.ports)
    ] = None,
    source: Annotated[str | None, typer.Option(help="Words in what a part says of its source.")] = None,
    uses: Annotated[str | None, typer.Option(help="Trees that have this part.")] = None,
    dof_min: Annotated[int | None, typer.Option(min=0, help="Coordinates at least.")] = None,
    dof_max: Annotated[int | None, typer.Option(min=0, help="Coordinates at most.")] = None,
    mass_min: Annotated[float | None, typer.Option(help="Mass at least, kg.")] = None,
    mass_max: Annotated[float | None, typer.Option(help="Mass at most, kg.")] = None,
    owner: Owner = None,
    count: Count = 20,
    json: Json = False,
) -> int:
    """Find parts, or trees, what fits best first; typing errors are forgiven."""
    wanted: dict[str, Any] = {"q": " ".join(words or []) or None, "joints": joints, "tag": tag, "port": port}
    wanted |= {"source": source, "uses": uses, "dof_min": dof_min, "dof_max": dof_max, "owner": owner}
    return _found(server, tree, {**wanted, "mass_min": mass_min, "mass_max": mass_max}, count, json)


def _found(server: Server, is_tree: bool, wanted: dict[str, Any], count: int, as_json: bool) -> int:
    path = "/v1/trees" if is_tree else "/v1/substructures"
    with server.client() as client:
        found = list(islice(items(client, path, wanted, min(count, 200)), count))
    if as_json:
        print_json(found)
    elif not found:
        print(f"no {'tree' if is_tree else 'part'} is found", file=sys.stderr)
    elif is_tree:
        rows = [(f"{x['name']}@{x['revision']}", x["dof"], x["owner"], x["created"][:16]) for x in found]
        table(("tree", "dof", "owner", "changed"), rows)
    else:
        parts = [(f"{x['name']}@{x['version']}", x["dof"], x["joints"], x["owner"], x["title"]) for x in found]
        table(("part", "dof", "joints", "owner", "title"), parts)
    return 0


COMMANDS = {"list": show_all, "search": search}
