"""The commands ``simulate`` and ``analyse``: a tree document here, without a server, or a stored tree on a server."""

from __future__ import annotations

import sys
from collections.abc import Mapping
from contextlib import nullcontext
from dataclasses import dataclass
from pathlib import Path
from typing import Annotated, Any

import orjson
import typer

from service.analyses.exporting import NAME
from service.analyses.formulas import OPTIONS, QUANTITIES, Options, made
from service.analyses.numbers import ANALYSES
from service.analyses.printing import (
    Style,
    check_quantity,
    described,
    made_text,
    source_glossary,
    text_of,
    with_numbers,
    with_options,
)
from service.analyses.results import JSON, MEDIA_TYPES, written
from service.cli import completion
from service.cli.choices import Form, Format
from service.cli.documents import is_document, named, read_document
from service.cli.options import Json, Server, with_more, with_server
from service.cli.output import tell_warnings, waiting
from service.cli.tree_files import local_source
from substructures.client.connection import step
from substructures.errors import meant
from substructures.export import interface_of_model
from substructures.printers import FORMS

#: what is said of results that are not known to be right
VERDICTS = {False: "WRONG: a necessary condition is violated", None: "NOT KNOWN to be right: it was not checked"}


@dataclass(frozen=True)
class _Wanted:
    """A tree that is a document or on a server, and where the result goes."""

    server: Server
    tree: str
    out: Path | None
    as_json: bool = False


Tree = Annotated[
    str,
    typer.Argument(
        help="Tree document (JSON or YAML), or the name of a tree on a server.", autocompletion=completion.trees
    ),
]
Out = Annotated[
    Path | None,
    typer.Option(
        metavar="FILE",
        help=f"For the result; its ending says what it is: {', '.join(f'.{name}' for name in MEDIA_TYPES)}.",
    ),
]
Several = list[str] | None


@with_server
def simulate(
    server: Server,
    tree: Tree,
    request: Annotated[Path, typer.Argument(metavar="REQUEST", help="JSON or YAML: q, qd, span, ...")],
    out: Out = None,
    json: Json = False,
) -> int:
    """Simulate a tree and judge the motion by its first integrals."""
    return _numbers(_Wanted(server, tree, out, json), "simulations", request)


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
    out: Out = None,
    format: Format = "text",  # noqa: A002 -- name of the option
    form: Form = FORMS[0],
    bind: Annotated[str, typer.Option(help="Numbers in formulas: name:value,... or defaults.")] = "",
    name: Annotated[str, typer.Option(help="Prefix of functions, where the format is a language.")] = NAME,
    json: Json = False,
    **options: Any,
) -> int:
    """Formulas and numbers that follow from the equations of motion."""
    wanted = _Wanted(server, tree, out, json)
    if what in ANALYSES:
        return _numbers(wanted, what, request)
    if request is not None:
        raise ValueError(f"'{what}' is a formula: it has options, but no request{meant(what, ANALYSES)}")
    chosen = {name: tuple(",".join(texts).split(",")) for name, texts in options.items() if texts}
    text = _formula(wanted, what, Style("json" if json else format, form, bind, name), chosen)
    if out is not None:
        out.write_bytes(text)
        print(f"{out}: {len(text)} bytes", file=sys.stderr)
    else:
        print(text.decode().rstrip("\n"))
    return 0


def _formula(wanted: _Wanted, what: str, style: Style, chosen: Options) -> bytes:
    if not is_document(wanted.tree):
        given = {name: list(texts) for name, texts in chosen.items()}
        asked = {"format": style.format, "form": style.form, "bind": style.bind, "name": style.name, **given}
        with wanted.server.client() as client:
            found: bytes = client.request("GET", f"/v1/trees/{step(wanted.tree)}/{step(what)}", params=asked).content
            return found
    source = local_source(Path(wanted.tree))
    interface = interface_of_model(source.model, digest=source.digest)
    if what in QUANTITIES:
        return made_text(made(source, what, chosen), what, interface, source, style).encode()
    check_quantity(source.model, what)
    sources = with_options(source.sources, what, chosen)
    members, parameters = described(sources, what)
    program = with_numbers(sources.formulas(what), parameters, source.model.inputs, style)
    named_steps = source_glossary(source, style, parameters)
    return text_of(program, style, what, interface, members, glossary=named_steps).encode()


def _numbers(wanted: _Wanted, name: str, given: Path | None) -> int:
    request = {} if given is None else read_document(given)
    media = _media(wanted.out, name)
    source = local_source(Path(wanted.tree)) if is_document(wanted.tree) else None
    with waiting(name), nullcontext() if given is None else named(given):
        if source is not None:
            result = ANALYSES[name].compute(source, request, lambda _: None)
            told, data = orjson.loads(written(result, JSON, source.model)), written(result, media, source.model)
        else:
            with wanted.server.client() as client:
                data, told = client.analysis(wanted.tree, name, request, media)
            told = orjson.loads(data) if media == JSON else told
    return _tell(told, data, wanted.out, wanted.as_json)


def _media(out: Path | None, name: str) -> str:
    media = MEDIA_TYPES.get(out.suffix.removeprefix(".")) if out is not None else JSON
    if media is None or media not in ANALYSES[name].media:
        known = [f".{suffix}" for suffix, each in MEDIA_TYPES.items() if each in ANALYSES[name].media]
        raise ValueError(f"the result of '{name}' can be written as {', '.join(known)}")
    return media


def _tell(told: Mapping[str, Any], data: bytes, out: Path | None, as_json: bool) -> int:
    """Write the result; of a motion say what came of it. 1 when it failed or is wrong."""
    is_motion = "checks" in told and "t" in told
    if out is not None:
        out.write_bytes(data)
        print(f"{out}: {len(data)} bytes", file=sys.stderr if as_json else sys.stdout)
    if as_json:
        print(data.decode() if out is None else orjson.dumps(told).decode())
    elif out is not None or is_motion:
        _summary(told)
    else:
        print(data.decode())
    return int(told.get("status") == "failed" or told.get("is_right") is False)


def _summary(told: Mapping[str, Any]) -> None:
    words = [str(told[key]) for key in ("status", "message") if told.get(key)]
    print(*words, *([VERDICTS[told["is_right"]]] if told.get("is_right", True) is not True else []))
    for check in told.get("checks", []):
        print(f"{check['name']}: {check['rule']}, {_found(check)}: {check['reason']}")
    tell_warnings(told)
    for event in told.get("events", []):
        print(f"{event['name']} at t = {event['t']:.9g} s")
    if "t" in told and "q" in told:
        last = ", ".join(f"{n} = {x:.9g}" for n, x in zip(told["coordinates"], told["q"][-1], strict=True))
        print(f"t = {told['t'][-1]:.9g} s: {last}")


def _found(check: Mapping[str, Any]) -> str:
    """What became of a check."""
    if check["holds"] is None:
        return "not made"
    verdict = "holds" if check["holds"] else f"VIOLATED from t = {check['time']:.9g} s"
    return f"{verdict}, {_short(check['relative'])} (limit {_short(check['limit'])})"


def _short(number: float | None) -> str:
    return "not finite" if number is None else f"{number:.2g}"


COMMANDS = {"simulate": simulate, "analyse": analyse}
