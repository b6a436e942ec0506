"""The command ``evaluate``: numbers at one state, of a tree document here or of a tree on a server."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Annotated, Any

import numpy as np
import orjson
import typer

from service.cli import completion
from service.cli.documents import is_document
from service.cli.options import Json, Server, with_server
from service.cli.output import print_json, tell_warnings, waiting
from service.cli.tree_files import local_source
from service.cli.values import Inputs, Numbers, Parameters, numbers_by_name, numbers_in
from substructures.client.steps import step
from substructures.documents.grouped import take
from substructures.mechanics.state_names import BallRow, positions_of, resting_state
from substructures.quantities.numbers.evaluation import EvaluationOptions
from substructures.quantities.numbers.evaluation import evaluate as evaluated
from substructures.quantities.numbers.states import STATE, wrong_length
from substructures.quantities.quantity import QUANTITIES, TABLE, labels_of


@with_server
def evaluate(
    server: Server,
    tree: Annotated[
        str,
        typer.Argument(
            help="Tree document (JSON or YAML), or the name of a tree on a server.", autocompletion=completion.trees
        ),
    ],
    quantities: Annotated[
        list[str],
        typer.Argument(
            metavar="QUANTITY...", help=f"{', '.join(QUANTITIES)}.", autocompletion=completion.words(QUANTITIES)
        ),
    ],
    q: Numbers = None,
    qd: Numbers = None,
    qdd: Numbers = None,
    t: Annotated[float, typer.Option(help="Time, s.")] = 0.0,
    set: Parameters = None,  # noqa: A002 -- name of the option
    input: Inputs = None,  # noqa: A002 -- name of the option
    json: Json = False,
) -> int:
    """Numbers at a state: metric, christoffel, forces, inverse dynamics, ..."""
    given = {"q": q, "qd": qd, "qdd": qdd}
    states = {name: numbers_in(f"--{name}", text) for name, text in given.items() if text is not None}
    request: dict[str, Any] = {"quantities": quantities, "t": t, **states}
    request |= {"parameters": numbers_by_name(set), "inputs": numbers_by_name(input)}
    with waiting("evaluating"):
        found = _here(Path(tree), request) if is_document(tree) else _there(server, tree, request)
    if json:
        print_json(found)
    else:
        _print_all(quantities, found)
    tell_warnings(found)
    return _failed(found)


def _print_all(quantities: Sequence[str], found: Mapping[str, Any]) -> None:
    for name in quantities:
        _print(name, found[name], found)
        if TABLE[name].note:
            print(f"  {TABLE[name].note}")


def _failed(found: Mapping[str, Any]) -> int:
    """1 where there are states without a result, which are told."""
    failures = found.get("failures", ())
    for failure in failures:
        print(f"no result: {failure['message']}")
    return int(bool(failures))


def _here(path: Path, request: Mapping[str, Any]) -> dict[str, Any]:
    model = (source := local_source(path)).model
    given = {"q": _resting(request, model.coordinates, model.balls), **request}
    quantities, options = given.pop("quantities"), take(EvaluationOptions, given)
    result = evaluated(source.sources, quantities, **given, options=options)
    plain: dict[str, Any] = orjson.loads(orjson.dumps(result.plain(), option=orjson.OPT_SERIALIZE_NUMPY))
    return plain


def _there(server: Server, tree: str, request: Mapping[str, Any]) -> dict[str, Any]:
    with server.client() as client:
        known = client.request("GET", f"/v1/trees/{step(tree)}").json()
        q = _resting(request, known["coordinates"], known.get("balls", ()))
        return dict(client.evaluate(tree, **{"q": q, **request}))


def _resting(request: Mapping[str, Any], coordinates: Sequence[str], balls: Sequence[BallRow]) -> list[float]:
    """The state q that nothing is said of. Raises BadParameter for other lengths than of one state, which is meant also
    of one coordinate, where requests may have many.
    """
    positions = positions_of(coordinates, balls)
    for name in STATE:
        names = positions if name == "q" else coordinates
        if name in request and len(request[name]) != len(names):
            raise typer.BadParameter(f"--{name}: {wrong_length(len(request[name]), names)}")
    return resting_state(positions, balls)


def _print(name: str, value: Any, told: Mapping[str, Any]) -> None:
    """A number; a vector or matrix by the names of its rows; what has more axes by its elements that are not zero."""
    if isinstance(value, dict):
        for inner, each in value.items():
            _print(f"{name}.{inner}", each, told)
        return
    numbers = np.asarray(value, dtype=np.float64)
    if not numbers.ndim:
        print(f"{name}  {numbers:.10g}")
        return
    if numbers.ndim > 2 and not numbers.any():
        print(f"{name}  all 0")
        return
    print(name)
    named = [
        labels if len(labels) == n else [str(k + 1) for k in range(n)]
        for labels, n in zip(labels_of(name, told), numbers.shape, strict=True)
    ]
    if numbers.ndim > 2:
        for place in np.argwhere(numbers):
            where = ", ".join(labels[k] for labels, k in zip(named, place, strict=True))
            print(f"  [{where}]  {numbers[tuple(place)]:.10g}")
        return
    width = max(map(len, named[0]), default=0)
    for label, row in zip(named[0], numbers.reshape(len(numbers), -1), strict=True):
        print(f"  {label:<{width}}  {'  '.join(f'{x + 0.0:13.6g}' for x in row)}")


COMMANDS = {"evaluate": evaluate}
