"""The command ``show``: a part or a tree, one of its formulas, its picture, or its structure drawn in text."""

from __future__ import annotations

import sys
from collections.abc import Mapping
from importlib import import_module
from pathlib import Path
from typing import Annotated, Any

import typer

from service.cli import completion
from service.cli.choices import FORMS, Form, Format
from service.cli.options import Json, Server, with_server
from service.cli.output import console, further, print_json, table, tell_warnings
from substructures.client import Client, ProblemError
from substructures.client.files import save
from substructures.client.steps import step

#: formulas of trees whose first index is that of a frame
OF_FRAMES = ("position", "rotation", "U", "Omega")
#: what trees have lists of, told by name
LISTED = ("closures", "loads", "velocity_constraints", "contacts")


@with_server
def show(
    server: Server,
    name: Annotated[
        str,
        typer.Argument(help="Of a part, or else of a tree; also NAME@2.", autocompletion=completion.parts_and_trees),
    ],
    quantity: Annotated[
        str,
        typer.Argument(help="A formula of it: metric, christoffel, forces, ...", autocompletion=completion.formulas),
    ] = "",
    tree: Annotated[bool, typer.Option("--tree", help="The tree, where there is a part of this name, too.")] = False,
    drawing: Annotated[bool, typer.Option("--drawing", help="Its structure, drawn in text.")] = False,
    svg: Annotated[Path | None, typer.Option(metavar="FILE", help="Write its picture to this file.")] = None,
    format: Format = "text",  # noqa: A002 -- name of the option
    form: Form = FORMS[0],
    bind: Annotated[str, typer.Option(help="Numbers in formulas: name:value,... or defaults.")] = "",
    json: Json = False,
) -> int:
    """Show a part, a tree, one of its formulas, or its structure as a drawing in text."""
    with server.client() as client:
        path, found = _found(client, name, tree)
        if quantity:
            style = {"format": "json" if json else format, "form": form, "bind": bind}
            _tell_formula(client, path, found, quantity, style)
            return 0
        if svg is not None:
            size = save(svg, client.request("GET", f"{path}/picture").content)
            print(f"{svg}: {size} bytes")
            return 0
        if json:
            print_json(found)
        elif drawing:
            draw = import_module("service.cli.drawing")
            drawn = draw.drawn_tree(client, found) if "revision" in found else draw.drawn_part(client, path, found)
            console().print(drawn)
        else:
            _tell(found)
    return 0


def _found(client: Client, name: str, is_tree: bool) -> tuple[str, dict[str, Any]]:
    """The path and the answer: a part, or a tree where there is no such part or where it is wanted."""
    part, tree = (f"/v1/{kind}/{step(name)}" for kind in ("substructures", "trees"))
    if is_tree:
        return tree, client.request("GET", tree).json()
    try:
        return part, client.request("GET", part).json()
    except ProblemError as unknown:
        if unknown.status != 404:
            raise
        try:
            return tree, client.request("GET", tree).json()
        except ProblemError as error:
            if error.status == 404:
                raise ValueError(further(unknown.problem["detail"], error.problem["detail"])) from None
            raise


def _tell_formula(client: Client, path: str, found: Mapping[str, Any], quantity: str, style: dict[str, str]) -> None:
    if quantity in OF_FRAMES and "frames" in found and style["format"] == "text":
        print(f"# frames: {', '.join(f'{k} {frame}' for k, frame in enumerate(found['frames'], 1))}")
    inner = "" if path.startswith("/v1/trees") else "formulas/"
    print(client.request("GET", f"{path}/{inner}{step(quantity)}", params=style).text.rstrip("\n"))


def _tell(found: Mapping[str, Any]) -> None:
    is_tree = "revision" in found
    print(f"{found['name']}@{found['revision' if is_tree else 'version']}", found.get("title") or "", sep="  ")
    facts = {"owner": f"{found['owner']} ({found['visibility']})", "created": found["created"][:16]}
    facts |= {"note": found["note"]} if found["note"] else {}
    facts |= (
        {"WITHDRAWN": _instead(found["withdrawal_reason"], found["successor"])} if found.get("is_withdrawn") else {}
    )
    facts["coordinates"] = f"{found['dof']} ({found['joints'] or 'none'}): {', '.join(found['coordinates'])}"
    if is_tree:
        facts["instances"] = ", ".join(f"{i['name']} at {i.get('at', 'world')}" for i in found["instances"])
        facts |= {
            kind.replace("_", " "): ", ".join(x["name"] for x in found[kind]) for kind in LISTED if found.get(kind)
        }
        facts |= {kind: ", ".join(found[kind]) for kind in ("driven", "ignored") if found.get(kind)}
    else:
        facts |= {"bodies": ", ".join(found["bodies"]), "ports": ", ".join(found["ports"]) or "none"}
    counts = (
        f"{name} {found['operations'][name]}" for name in ("metric", "christoffel") if name in found["operations"]
    )
    facts |= {"operations": ", ".join(counts), "digest": found["digest"]}
    for name, text in facts.items():
        print(f"  {name}: {text}")
    if found["parameters"]:
        print("  parameters:")
        rows = [(f"    {name}", *_value(given), given["description"]) for name, given in found["parameters"].items()]
        table(("", "value", "unit", ""), rows)
    for part in found["withdrawn"]:
        told = _instead(part["reason"], part["successor"])
        print(f"warning: {part['instance']}: {part['substructure']} is withdrawn: {told}", file=sys.stderr)
    tell_warnings(found)


def _instead(reason: str, successor: str | None) -> str:
    return (reason or "no reason given") + (f"; take {successor}" if successor else "")


def _value(given: Mapping[str, Any]) -> tuple[str, str]:
    return "-" if given["value"] is None else str(given["value"]), given["unit"]


COMMANDS = {"show": show}
