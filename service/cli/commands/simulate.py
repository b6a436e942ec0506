"""The command ``simulate``: a motion of a tree document here, without a server, or of a stored tree on a server."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from service.cli.numbers import Out, Tree, Wanted, numbers
from service.cli.options import Json, Server, with_server
from service.cli.values import Inputs, Numbers, Parameters, numbers_by_name, numbers_in


@with_server
def simulate(
    server: Server,
    tree: Tree,
    request: Annotated[
        Path | None, typer.Argument(metavar="[REQUEST]", help="JSON or YAML: q, qd, span, ...; or by options:")
    ] = None,
    q: Annotated[
        str | None, typer.Option(metavar="X,Y,...", help="The start, in the order of the coordinates, also '30 deg'.")
    ] = None,
    qd: Numbers = None,
    until: Annotated[float | None, typer.Option(metavar="SECONDS", help="The end; the motion begins at 0.")] = None,
    set: Parameters = None,  # noqa: A002 -- name of the option
    input: Inputs = None,  # noqa: A002 -- name of the option
    out: Out = None,
    json: Json = False,
) -> int:
    """Simulate a tree and judge the motion by its first integrals."""
    if request is None and (q is None or until is None):
        raise typer.BadParameter("a motion needs --q and --until, or the file of a request")
    given = {
        "q": q and numbers_in("--q", q),
        "qd": qd and numbers_in("--qd", qd),
        "span": None if until is None else [0, until],
        "parameters": numbers_by_name(set),
        "inputs": numbers_by_name(input),
    }
    members = {name: each for name, each in given.items() if each}
    return numbers(Wanted(server.client, tree, out, json), "simulations", request, members=members)


COMMANDS = {"simulate": simulate}
