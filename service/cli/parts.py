"""The commands ``derive`` and ``submit``: one part, here or on a server."""

from __future__ import annotations

from typing import Annotated

import typer

from service.cli.choices import Format
from service.cli.documents import definition_of, named
from service.cli.options import File, Json, Note, Private, Server, Wait, with_server
from service.cli.output import print_json, tell_warnings, waiting
from service.cli.progress import became_job
from service.cli.robots import read_definition
from substructures.export import interface_of_part, render
from substructures.part.outputs import with_own_inertia
from substructures.part.part import Part
from substructures.part.part import derive as derived


def derive(
    file: File,
    show: Annotated[str, typer.Option(help="Print this stored quantity, e.g. metric.", metavar="QUANTITY")] = "",
    format: Format = "text",  # noqa: A002 -- name of the option
    name: Annotated[str, typer.Option(help="Prefix of functions, where the format is a language.")] = "model",
    json: Json = False,
) -> int:
    """Derive and verify a definition here, without a server."""
    document = read_definition(file)
    with named(file), waiting("deriving"):
        part = derived(definition_of(document))
    if show:
        print(_shown(part, show, format, name))
    elif json:
        known = {"name": part.name, "dof": part.dof, "joints": part.joints, "coordinates": part.coordinates}
        known |= {"bodies": part.bodies, "ports": part.ports, "digest": part.definition.digest}
        print_json({**known, "operations": part.operations, "certificate": part.certificate})
    else:
        _tell(part)
    return 0


def _shown(part: Part, quantity: str, format_: str, name: str) -> str:
    names = [n for n in part.program.outputs if n == quantity or n.startswith(f"{quantity}.")]
    if not names:
        raise ValueError(f"there is no quantity '{quantity}'; there are {', '.join(part.program.outputs)}")
    program, interface = with_own_inertia(part, part.program.select(names)), interface_of_part(part)
    return render(program, format_, name=name, interface=interface, quantity=quantity)


def _tell(part: Part) -> None:
    print(f"{part.name}: {part.dof} coordinates ({part.joints or 'none'}), bodies {', '.join(part.bodies)}")
    for title, figures in (("operations", part.operations), ("certificate", part.certificate)):
        print(f"{title}:")
        for name, figure in figures.items():
            if name != "warnings":
                print(f"  {name}: {figure}")
    print(f"digest: {part.definition.digest}")
    tell_warnings(part.certificate)


@with_server
def submit(
    server: Server, file: File, note: Note = "", private: Private = False, wait: Wait = False, json: Json = False
) -> int:
    """Submit a definition to a server, which derives, verifies and stores it."""
    document = read_definition(file)
    if isinstance(document, dict):
        document |= {"note": note} if note else {}
        document |= {"visibility": "private"} if private else {}
    with server.client() as client:
        with waiting("deriving"), named(file):
            answer = client.request("POST", "/v1/substructures", document)
        version = answer.json()
        if answer.status_code == 202:
            return became_job(client, version, wait, json)
    if json:
        print_json(version)
        return 0
    stored = "stored" if answer.status_code == 201 else "was stored already"
    print(f"{version['name']}@{version['version']} {stored}, {version['digest']}")
    tell_warnings(version)
    return 0


COMMANDS = {"derive": derive, "submit": submit}
