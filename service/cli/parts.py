"""The commands ``derive`` and ``submit``: one part, here or on a server."""

from __future__ import annotations

import argparse
from pathlib import Path

from service.cli.options import Add, add_server, named, tell_warnings
from service.cli.progress import follow
from service.cli.robots import read_definition
from substructures.client import Client
from substructures.export import FORMATS, interface_of_part, render
from substructures.part.definition import Definition
from substructures.part.outputs import with_own_inertia
from substructures.part.part import derive


def _add_derive(command: argparse.ArgumentParser) -> None:
    command.set_defaults(command=_derive)
    command.add_argument("file", type=Path, help="definition, JSON or YAML, or a robot file")
    command.add_argument("--show", metavar="QUANTITY", help="print this stored quantity, e.g. metric")
    command.add_argument("--format", choices=sorted(FORMATS), default="text")
    command.add_argument("--name", default="model", help="prefix of functions, where the format is a language")


def _add_submit(command: argparse.ArgumentParser) -> None:
    command.set_defaults(command=_submit)
    command.add_argument("file", type=Path, help="definition, JSON or YAML, or a robot file")
    command.add_argument("--wait", action="store_true", help="wait where it takes so long that it becomes a job")
    add_server(command)


def _derive(options: argparse.Namespace) -> int:
    document = read_definition(options.file)
    with named(options.file):
        part = derive(Definition.read(document))
    if options.show:
        names = [n for n in part.program.outputs if n == options.show or n.startswith(f"{options.show}.")]
        if not names:
            raise ValueError(f"there is no quantity '{options.show}'; there are {', '.join(part.program.outputs)}")
        program, interface = with_own_inertia(part, part.program.select(names)), interface_of_part(part)
        print(render(program, options.format, name=options.name, interface=interface, quantity=options.show))
        return 0
    print(f"{part.name}: {part.dof} coordinates ({part.joints or 'none'}), bodies {', '.join(part.bodies)}")
    for title, figures in (("operations", part.operations), ("certificate", part.certificate)):
        print(f"{title}:")
        for name, figure in figures.items():
            if name != "warnings":
                print(f"  {name}: {figure}")
    print(f"digest: {part.definition.digest}")
    tell_warnings(part.certificate)
    return 0


def _submit(options: argparse.Namespace) -> int:
    with Client(options.server, options.key) as client:
        answer = client.request("POST", "/v1/substructures", read_definition(options.file))
        version = answer.json()
        if answer.status_code == 202:
            print(f"became the job {version['id']}")
            return follow(client, version["id"]) if options.wait else 0
    stored = "stored" if answer.status_code == 201 else "was stored already"
    print(f"{version['name']}@{version['version']} {stored}, {version['digest']}")
    tell_warnings(version)
    return 0


ADD: Add = {"derive": _add_derive, "submit": _add_submit}
