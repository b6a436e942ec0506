"""The command ``derive``: a part here, without a server."""

from __future__ import annotations

from collections.abc import Mapping
from importlib import import_module
from typing import Annotated, Any

import typer

from service.cli import completion
from service.cli.choices import NAME, Format
from service.cli.documents import definition_of, named
from service.cli.models import read_definition
from service.cli.options import File, Json
from service.cli.output import print_json, tell_warnings, waiting
from substructures.part.derive import derive as derived
from substructures.part.part import LEADING, OF_FRAMES, Part

FORMULAS = "service.cli.formulas"


def derive(
    file: File,
    show: Annotated[
        str,
        typer.Option(
            help="Print this stored quantity, e.g. metric.",
            metavar="QUANTITY",
            autocompletion=completion.words((*LEADING, *OF_FRAMES)),
        ),
    ] = "",
    format: Format = "text",  # noqa: A002 -- name of the option
    name: Annotated[str, typer.Option(help="Prefix of functions, where the format is a language.")] = NAME,
    json: Json = False,
) -> int:
    """Derive and verify a definition here, without a server."""
    document = read_definition(file)
    with named(file), waiting("deriving"):
        part = derived(definition_of(document))
    if show:
        print(import_module(FORMULAS).shown(part, show, "json" if json else format, name).rstrip("\n"))
    elif json:
        known = {"name": part.name, "dof": part.dof, "joints": part.joints, "coordinates": part.coordinates}
        known |= {"bodies": part.bodies, "ports": part.ports, "digest": part.definition.digest}
        print_json({**known, "operations": part.operations, "certificate": part.certificate})
    else:
        _tell(part)
    return 0


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


COMMANDS = {"derive": derive}
