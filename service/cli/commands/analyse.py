"""The command ``analyse``: of a tree document here, without a server, or of a stored tree on a server."""

from __future__ import annotations

import sys
from importlib import import_module
from pathlib import Path
from typing import Annotated, Any

import typer

from service.cli import completion
from service.cli.choices import FORMS, NAME, Form, Format
from service.cli.documents import is_document
from service.cli.numbers import Out, Tree, Wanted, numbers
from service.cli.options import Json, Server, with_more, with_server
from service.models.formulas import OPTIONS, QUANTITIES
from service.models.numbers import ANALYSES
from substructures.client.files import save
from substructures.client.steps import step
from substructures.errors import meant

FORMULAS = "service.cli.tree_formulas"
Several = list[str] | None


@with_server
@with_more({name: Annotated[Several, typer.Option(f"--{name}", help=f"{text}.")] for name, text in OPTIONS.items()})
def analyse(
    server: Server,
    tree: Tree,
    what: Annotated[
        str,
        typer.Argument(
            help=f"Numbers: {', '.join(ANALYSES)}; formulas: {', '.join(QUANTITIES)}, metric, ...",
            autocompletion=completion.words([*ANALYSES, *QUANTITIES]),
        ),
    ],
    request: Annotated[
        Path | None, typer.Argument(metavar="REQUEST", help="Of numbers, JSON or YAML.", show_default=False)
    ] = None,
    log: Annotated[
        Path | None,
        typer.Option(metavar="FILE", help="A measured motion: .csv, .npz, .arrow.", show_default=False),
    ] = None,
    out: Out = None,
    format: Format = "text",  # noqa: A002 -- name of the option
    form: Form = FORMS[0],
    bind: Annotated[str, typer.Option(help="Numbers in formulas: name:value,... or defaults.")] = "",
    name: Annotated[str, typer.Option(help="Prefix of functions, where the format is a language.")] = NAME,
    json: Json = False,
    **options: Any,
) -> int:
    """Formulas and numbers that follow from the equations of motion."""
    wanted = Wanted(server.client, tree, out, json)
    if what in ANALYSES:
        return numbers(wanted, what, request, log)
    if request is not None or log is not None:
        raise ValueError(f"'{what}' is a formula: it has options, but no request{meant(what, ANALYSES)}")
    chosen = {name: tuple(",".join(texts).split(",")) for name, texts in options.items() if texts}
    style = {"format": "json" if json else format, "form": form, "bind": bind, "name": name}
    text = _formula(wanted, what, style, chosen)
    if out is not None:
        save(out, text)
        print(f"{out}: {len(text)} bytes", file=sys.stderr)
    else:
        print(text.decode().rstrip("\n"))
    return 0


def _formula(wanted: Wanted, what: str, style: dict[str, str], chosen: dict[str, tuple[str, ...]]) -> bytes:
    if is_document(wanted.tree):
        found: bytes = import_module(FORMULAS).of_tree(Path(wanted.tree), what, style, chosen)
        return found
    asked = {**style, **{name: list(texts) for name, texts in chosen.items()}}
    with wanted.connect() as client:
        answer = client.request("GET", f"/v1/trees/{step(wanted.tree)}/{step(what)}", params=asked)
    return answer.content


COMMANDS = {"analyse": analyse}
