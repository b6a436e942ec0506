"""The commands ``derive`` and ``submit``: one part, here or on a server."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from typing import Annotated, Any

import typer

from service.cli import completion
from service.cli.choices import Format
from service.cli.documents import definition_of, named
from service.cli.options import File, Json, Note, Private, Server, Wait, with_server
from service.cli.output import print_json, tell_warnings, waiting
from service.cli.progress import became_job
from service.cli.robots import read_definition
from substructures.export import interface_of_part, render
from substructures.part.outputs import with_own_inertia
from substructures.part.part import LEADING, Part
from substructures.part.part import derive as derived

_OF_FRAMES = dict.fromkeys(("frame.E", "frame.position"), ("frame",))


def derive(
    file: File,
    show: Annotated[
        str,
        typer.Option(
            help="Print this stored quantity, e.g. metric.",
            metavar="QUANTITY",
            autocompletion=completion.words((*LEADING, *_OF_FRAMES)),
        ),
    ] = "",
    format: Format = "text",  # noqa: A002 -- name of the option
    name: Annotated[str, typer.Option(help="Prefix of functions, where the format is a language.")] = "model",
    json: Json = False,
) -> int:
    """Derive and verify a definition here, without a server."""
    document = read_definition(file)
    with named(file), waiting("deriving"):
        part = derived(definition_of(document))
    if show:
        print(_shown(part, show, "json" if json else format, name).rstrip("\n"))
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
    text = render(program, format_, name=name, interface=interface, quantity=quantity)
    return "".join(_numbered(part, names)) + text if format_ == "text" else text


def _numbered(part: Part, names: Sequence[str]) -> Iterator[str]:
    """What the leading indices of quantities stand for, as comments."""
    known = {"frame": part.frames, **{axis: part.labels(axis) for axis in ("joint", "port", "coordinate")}}
    axes = dict.fromkeys(axis for name in names for axis in LEADING.get(name, _OF_FRAMES.get(name, ())))
    for axis in axes:
        if labels := known.get(axis):
            of = " carry" if axis == "joint" else ""
            yield f"# {axis}s{of}: {', '.join(f'{k} {label}' for k, label in enumerate(labels, 1))}\n"


def _tell(part: Part) -> None:
    coordinates = "1 coordinate" if part.dof == 1 else f"{part.dof} coordinates"
    print(f"{part.name}: {coordinates} ({part.joints or 'none'}), bodies {', '.join(part.bodies)}")
    for title, figures in (("operations", part.operations), ("certificate", part.certificate)):
        print(f"{title}:")
        for name, figure in figures.items():
            if name != "warnings":
                print(f"  {name}: {_words(figure)}")
    print(f"digest: {part.definition.digest}")
    tell_warnings(part.certificate)


def _words(figure: Any) -> str:
    """A figure of a certificate; of errors by quantity the largest."""
    match figure:
        case {"max_relative_error": Mapping() as errors} if errors:
            worst = max(errors, key=errors.__getitem__)
            return f"max_relative_error {errors[worst]:.2g} ({worst}) of {len(errors)} quantities"
        case Mapping():
            return ", ".join(f"{name} {_words(each)}" for name, each in figure.items()) or "none"
        case list() | tuple():
            return ", ".join(map(_words, figure)) or "none"
        case bool():
            return "yes" if figure else "no"
        case float():
            return f"{figure:.3g}"
    return str(figure)


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
