"""The commands ``simulate`` and ``analyse``: a tree document here, without a server, or a stored tree on a server."""

from __future__ import annotations

import argparse
from collections.abc import Mapping
from pathlib import Path
from typing import Any

import orjson

from service.analyses.formulas import OPTIONS, QUANTITIES, Options
from service.analyses.numbers import ANALYSES
from service.analyses.printing import NAME
from service.analyses.results import JSON, MEDIA_TYPES, written
from service.analyses.source import Source
from service.answers import Answer
from service.cli.options import Add, add_server, named, read_document, tell_warnings
from service.cli.tree_files import SUFFIXES, parts_beside
from service.operations import models
from service.operations.analyses import printed
from service.operations.models import Style
from service.settings import Limits
from substructures.client import Client
from substructures.export import FORMATS, interface_of_model
from substructures.part.part import Part
from substructures.printers import FORMS
from substructures.quantities.evaluation import Sources
from substructures.quantities.reactions import reactions
from substructures.quantities.regressor import regressor
from substructures.quantities.warnings import BY_VALUE, TOLD
from substructures.tree.document import TreeSpec
from substructures.tree.model import couple

#: what is said of results that are not known to be right
VERDICTS = {False: "WRONG: a necessary condition is violated", None: "NOT KNOWN to be right: it was not checked"}


def _add_simulate(command: argparse.ArgumentParser) -> None:
    command.set_defaults(command=_simulate)
    _add_tree(command)
    command.add_argument("request", type=Path, help="request, JSON or YAML: q, qd, span, ...")
    _add_output(command)


def _add_analyse(command: argparse.ArgumentParser) -> None:
    command.set_defaults(command=_analyse)
    _add_tree(command)
    command.add_argument("what", help=f"numbers: {', '.join(ANALYSES)}; formulas: {', '.join(QUANTITIES)}, metric, ...")
    command.add_argument("request", type=Path, nargs="?", help="request of numbers, JSON or YAML")
    _add_output(command)
    command.add_argument("--format", choices=sorted(FORMATS), default="text", help="of formulas")
    command.add_argument("--form", choices=FORMS, default=FORMS[0], help="of formulas")
    command.add_argument("--bind", default="", help="numbers in formulas: name:value,... or defaults")
    command.add_argument("--name", default=NAME, help="prefix of functions, where the format is a language")
    for name, text in OPTIONS.items():
        command.add_argument(f"--{name}", action="append", help=text)


def _add_tree(command: argparse.ArgumentParser) -> None:
    command.add_argument("tree", help="tree document (JSON or YAML), or the name of a tree on a server")
    add_server(command)


def _add_output(command: argparse.ArgumentParser) -> None:
    known = ", ".join(f".{name}" for name in MEDIA_TYPES)
    command.add_argument("--out", type=Path, help=f"file for the result; its ending says what it is: {known}")


def _simulate(options: argparse.Namespace) -> int:
    return _numbers(options, "simulations")


def _analyse(options: argparse.Namespace) -> int:
    if options.what in ANALYSES:
        return _numbers(options, options.what)
    if options.request is not None:
        raise ValueError(f"'{options.what}' is a formula: it has options, but no request")
    chosen = {name: tuple(",".join(texts).split(",")) for name in OPTIONS if (texts := getattr(options, name))}
    text = _formula(options, chosen)
    if options.out is not None:
        options.out.write_bytes(text)
    else:
        print(text.decode().rstrip("\n"))
    return 0


def _formula(options: argparse.Namespace, chosen: Options) -> bytes:
    style, what = Style(options.format, options.form, options.bind, options.name), options.what
    if not is_document(options.tree):
        given = {name: list(texts) for name, texts in chosen.items()}
        with Client(options.server, options.key) as client:
            return client.formula(
                options.tree, what, style.format, style.form, style.bind, name=style.name, **given
            ).encode()
    source = local_source(Path(options.tree))
    if what in QUANTITIES:
        return printed(source, what, chosen, style).body
    return _model_formula(source, what, style, chosen).body


def _model_formula(source: Source, what: str, style: Style, chosen: Options) -> Answer:
    sources = Sources(source.model, regressor=source.regressor, reactions=source.reactions)
    models.check_quantity(source.model, what)
    sources = models.with_options(sources, what, chosen)
    members, parameters = models.described(sources, what)
    program = models.bound(models.model_quantity(sources, what), parameters, style.bind)
    interface = interface_of_model(source.model, digest=source.digest)
    return models.printed(program, style, what, interface, members)


def _numbers(options: argparse.Namespace, name: str) -> int:
    request = {} if options.request is None else read_document(options.request)
    media = _media(options.out, name)
    if is_document(options.tree):
        source = local_source(Path(options.tree))
        result = ANALYSES[name].compute(source, request, lambda _: None)
        told, data = orjson.loads(written(result, JSON, source.model)), written(result, media, source.model)
    else:
        with Client(options.server, options.key) as client:
            data, told = client.analysis(options.tree, name, request, media)
        told = orjson.loads(data) if media == JSON else told
    return _tell(told, data, options.out)


def _media(out: Path | None, name: str) -> str:
    media = MEDIA_TYPES.get(out.suffix.removeprefix(".")) if out is not None else JSON
    if media is None or media not in ANALYSES[name].media:
        known = [f".{suffix}" for suffix, each in MEDIA_TYPES.items() if each in ANALYSES[name].media]
        raise ValueError(f"the result of '{name}' can be written as {', '.join(known)}")
    return media


def _tell(told: Mapping[str, Any], data: bytes, out: Path | None) -> int:
    """Write the result; of a motion say what came of it. 1 when it failed or is wrong."""
    is_motion = "checks" in told and "t" in told
    if out is not None:
        out.write_bytes(data)
        print(f"{out}: {len(data)} bytes")
    if out is not None or is_motion:
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


def is_document(tree: str) -> bool:
    """Whether a tree is given as a file."""
    return tree.endswith(SUFFIXES)


def local_source(path: Path) -> Source:
    """A tree document coupled here. Its parts are inline definitions, files ``<name>.yaml`` or ``.json`` beside the
    document, or entries of the shipped catalogue. Raises InvalidDocument.
    """
    document = read_document(path)
    with named(path):
        spec = TreeSpec.read(document)
    parts = parts_beside(spec, path.parent)
    with named(path):
        return coupled_source(spec, parts)


def coupled_source(spec: TreeSpec, parts: Mapping[str, Part]) -> Source:
    """A tree of parts coupled here; its warnings are told. Raises InvalidDocument."""
    limits = Limits()
    model = couple(spec, parts, limits.program_nodes)
    # the others come with the result
    tell_warnings({"warnings": [w for w in model.certificate["warnings"] if w["code"] not in TOLD | BY_VALUE]})
    nodes = limits.program_nodes
    transmitted = lambda: reactions(spec, parts, nodes)  # noqa: E731 -- made when it is asked for
    return Source(model, spec.digest, lambda: regressor(spec, parts, nodes), limits, reactions=transmitted)


ADD: Add = {"simulate": _add_simulate, "analyse": _add_analyse}
