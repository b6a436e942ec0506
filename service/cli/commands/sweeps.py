"""The command ``sweep``: many combinations of parts and numbers as a table."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from service.cli.documents import named, read_document
from service.cli.options import Server, with_server
from service.cli.progress import follow
from service.cli.rows import ROWS, Count, Front, Out, Sort, Where, print_rows, require_suffix
from substructures.client.jobs import PATIENCE

Json = Annotated[bool, typer.Option("--json", help="Print them as JSON.")]


@with_server
def sweep(
    server: Server,
    file: Annotated[Path, typer.Argument(metavar="FILE", help="The sweep, JSON or YAML; '-' reads from stdin.")],
    wait: Annotated[bool, typer.Option(help="Wait until it has ended, and print its table.")] = True,
    sort: Sort = "",
    where: Where = "",
    pareto: Front = False,
    out: Out = None,
    count: Count = ROWS,
) -> int:
    """Evaluate all combinations of parts and numbers of a tree; print the table.

    \b
    template: {name: pair, gravity: [0, 0, "-9.81"], instances: [{name: arm, substructure: puma560}, ...]}
    choices: {arm: [puma560, ur5], hand: {query: {tag: gripper}}}
    samples: {of: {hand.m: {uniform: [0.1, 2], count: 100}}}
    columns: {mass: mass, torque: {quantity: inverse_dynamics, of: arm.q2, over: {q: [...], qd: [...], qdd: [...]}}}
    where: torque < 180
    pareto: {minimise: [mass, torque]}
    """
    require_suffix(out)
    with server.client() as client:
        document = read_document(file)
        with named(file):
            job = client.submit_job({"kind": "sweep", **document})
        if not wait:
            print(job["id"])
            return 0
        code = follow(client, job["id"], PATIENCE)
        if code in (0, 3):
            print_rows(client, job["id"], {"sort": sort, "where": where}, pareto, out, count, False)
    return code


COMMANDS = {"sweep": sweep}
