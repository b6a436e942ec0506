"""The command ``simulate``: a motion of a tree document here, without a server, or of a stored tree on a server."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from service.cli.numbers import Out, Tree, Wanted, numbers
from service.cli.options import Json, Server, with_server


@with_server
def simulate(
    server: Server,
    tree: Tree,
    request: Annotated[Path, typer.Argument(metavar="REQUEST", help="JSON or YAML: q, qd, span, ...")],
    out: Out = None,
    json: Json = False,
) -> int:
    """Simulate a tree and judge the motion by its first integrals."""
    return numbers(Wanted(server.client, tree, out, json), "simulations", request)


COMMANDS = {"simulate": simulate}
