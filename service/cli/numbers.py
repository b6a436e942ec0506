"""Results of analyses in numbers, computed here or on a server, and what is told of them."""

from __future__ import annotations

import sys
from collections.abc import Callable, Mapping
from contextlib import AbstractContextManager, nullcontext
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import orjson
import typer

from service.cli import completion
from service.cli.documents import is_document, named, read_document, require_place
from service.cli.output import tell_warnings, waiting
from service.cli.tree_files import local_source
from service.models.numbers import OFFERED, analysis_of
from service.models.results import JSON, MEDIA_TYPES, written
from substructures.client.files import save
from substructures.formats.logs import log_of

if TYPE_CHECKING:
    from substructures.client import Client

#: what is said of results that are not known to be right
VERDICTS = {False: "WRONG: a necessary condition is violated", None: "NOT KNOWN to be right: it was not checked"}


@dataclass(frozen=True)
class Wanted:
    """A tree that is a document or on a server, which ``connect`` gives a client of, and where the result goes."""

    connect: Callable[[], AbstractContextManager[Client]]
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


def numbers(
    wanted: Wanted, name: str, given: Path | None, log: Path | None = None, members: Mapping[str, Any] = {}
) -> int:
    """Compute, write and tell the result of an analysis; the exit code. ``given``: the file of its request; ``log``:
    that of a measured motion; ``members``: of the request, in place of those in the file.

    Raises InvalidInput, ProblemError, ValueError, OSError.
    """
    request = {**({} if given is None else read_document(given)), **members}
    if log is not None:
        request = {**request, "log": log_of(log)}
    media = _media(wanted.out, name)
    require_place(wanted.out)
    source = local_source(Path(wanted.tree)) if is_document(wanted.tree) else None
    with waiting(name), nullcontext() if given is None else named(given):
        if source is not None:
            result = analysis_of(name, source.model).compute(source, request, lambda _: None)
            told, data = orjson.loads(written(result, JSON, source.model)), written(result, media, source.model)
        else:
            with wanted.connect() as client:
                data, told = client.analysis(wanted.tree, name, request, media)
            told = orjson.loads(data) if media == JSON else told
    return _tell(told, data, wanted.out, wanted.as_json)


def _media(out: Path | None, name: str) -> str:
    media = MEDIA_TYPES.get(out.suffix.removeprefix(".")) if out is not None else JSON
    if media is None or media not in OFFERED[name].media:
        known = [f".{suffix}" for suffix, each in MEDIA_TYPES.items() if each in OFFERED[name].media]
        raise ValueError(f"the result of '{name}' can be written as {', '.join(known)}")
    return media


def _tell(told: Mapping[str, Any], data: bytes, out: Path | None, as_json: bool) -> int:
    """Write the result; of a motion say what came of it. 1 when it failed or is wrong."""
    is_motion = "checks" in told and "t" in told
    if out is not None:
        save(out, data)
        print(f"{out}: {len(data)} bytes", file=sys.stderr if as_json else sys.stdout)
    if as_json:
        print(data.decode() if out is None else orjson.dumps(told).decode())
    elif out is not None or is_motion:
        _summary(told)
    else:
        print(data.decode())
    return int(told.get("status") == "failed" or told.get("is_right") is False)


def _summary(told: Mapping[str, Any]) -> None:
    if "violation" in told:
        _members(told)
        return
    words = [str(told[key]) for key in ("status", "message") if told.get(key)]
    print(*words, *([VERDICTS[told["is_right"]]] if told.get("is_right", True) is not True else []))
    for check in told.get("checks", []):
        print(f"{check['name']}: {check['rule']}, {_found(check)}: {check['reason']}")
    tell_warnings(told)
    for event in told.get("events", []):
        act = f", the energy changes by {event['energy_change']:.6g} J" if "after" in event else ""
        kind = f", {event['kind']}" if "kind" in event else ""
        print(f"{event['name']}{kind} at t = {event['t']:.9g} s{act}")
    if told.get("t") and "q" in told:
        names = told.get("positions") or told["coordinates"]
        last = ", ".join(f"{n} = {x:.9g}" for n, x in zip(names, told["q"][-1], strict=True))
        print(f"t = {told['t'][-1]:.9g} s: {last}")


def _members(told: Mapping[str, Any]) -> None:
    """What became of an ensemble."""
    print(f"{told['count']:,} members: {told['right']:,} right, {told['failed']:,} failed")
    for check in told["checks"]:
        found = f"at most {_short(check['relative'])} (limit {_short(check['limit'])})"
        print(f"{check['name']}: {check['rule']}, violated by {check['violated']:,}, {found}: {check['reason']}")
    for each in told["failures"]:
        print(f"member {each['member']} at t = {each['t']:.9g} s: {each['message']}")
    tell_warnings(told)
    for name, column in told["statistics"].items():
        known = {key: x for key, x in column.items() if key != "quantiles" and x is not None}
        print(f"{name}: " + ", ".join(f"{key} {x:.6g}" for key, x in known.items()))


def _found(check: Mapping[str, Any]) -> str:
    """What became of a check."""
    if check["holds"] is None:
        return "not made"
    verdict = "holds" if check["holds"] else f"VIOLATED from t = {check['time']:.9g} s"
    return f"{verdict}, {_short(check['relative'])} (limit {_short(check['limit'])})"


def _short(number: float | None) -> str:
    return "not finite" if number is None else f"{number:.2g}"
