"""A table of joints cut at named bodies: a part for every body that is named, with all that it carries, and their tree.

As of robots with links (:mod:`substructures.interchange.cut`): a part begins with the joint of its body, and its
interface is where the body before was. Of a table in the standard convention that joint has a row of its own. Closures
are those of the tree.
"""

from __future__ import annotations

import re
from collections.abc import Iterator, Mapping, Sequence
from typing import Any

from substructures.errors import InvalidArgument, listed, meant
from substructures.interchange.cut import MAIN, WORLD, part_name
from substructures.interchange.names import Names
from substructures.part.topology import BASE
from substructures.tree.document import MAX_INSTANCES

Body = Mapping[str, Any]
_WORD = re.compile(r"[A-Za-z]\w*", re.ASCII)


def cut_rows(definition: Mapping[str, Any], names: Sequence[str]) -> dict[str, Any]:
    """The tree document of a definition that is cut at bodies.

    Raises InvalidArgument for bodies that are not there and where nothing would remain.
    """
    bodies: Mapping[str, Body] = {body["name"]: body for body in definition["bodies"]}
    pieces = _pieces(bodies, names)
    called = Names((WORLD, "tau"))
    instances = {piece: called.new(piece or MAIN) for piece in dict.fromkeys(pieces.values())}
    starts: dict[str, str] = {}  # the first body of every piece
    for each, piece in pieces.items():
        starts.setdefault(piece, each)
    mounts: dict[str, str] = {}
    ports: dict[str, list[dict[str, Any]]] = {piece: [] for piece in instances}
    taken = Names((*bodies, *(port["name"] for port in definition.get("ports", ()))))
    for piece in instances:
        if piece:
            host = bodies[starts[piece]]["parent"]
            port = taken.new(f"{piece}_mount")
            ports[pieces.get(host, "")].append({"name": port, "body": host})
            mounts[piece] = f"{instances[pieces.get(host, '')]}.{port}"
    for port in definition.get("ports", ()):
        ports[pieces[port["body"]]].append(port)
    documents = [
        {
            "name": instance,
            "definition": _part(definition, piece, starts[piece], pieces, ports[piece]),
            **({"at": mounts[piece]} if piece else {}),
        }
        for piece, instance in instances.items()
    ]
    closures = [
        closure | {end: f"{instances[pieces[closure[end]]]}.{closure[end]}" for end in ("from", "to")}
        for closure in definition.get("closures", ())
    ]
    return {"name": definition["name"], "instances": documents, **({"closures": closures} if closures else {})}


def _pieces(bodies: Mapping[str, Body], names: Sequence[str]) -> dict[str, str]:
    """Of every body the one that its part is called after; empty for the main part, which comes first."""
    for name in names:
        if name not in bodies:
            message = f"there is no body '{name[:80]}' to be cut at{meant(name, bodies)}; there are {listed(bodies)}"
            raise InvalidArgument.at("/cut", "unknown-link", message)
    if len(names) >= MAX_INSTANCES:
        raise InvalidArgument.at("/cut", "too-many-parts", f"a tree has at most {MAX_INSTANCES} instances")
    first = {_start(bodies, name): name for name in names}
    found: dict[str, str] = {}
    for name, body in bodies.items():  # parents first
        found[name] = first.get(name, found.get(body["parent"], ""))
    if "" not in found.values():
        message = f"nothing remains before {listed(list(first.values()))}: cut behind the first body"
        raise InvalidArgument.at("/cut", "nothing-remains", message)
    return dict(sorted(found.items(), key=lambda item: item[1] != ""))


def _start(bodies: Mapping[str, Body], name: str) -> str:
    """The body whose joint moves a body: one without mass that carries nothing else, or itself."""
    body = bodies[name]
    before = bodies.get(body["parent"])
    carried = sum(each["parent"] == body["parent"] for each in bodies.values())
    is_seat = body["joint"]["type"] == "fixed" and before is not None and "mass" not in before and carried == 1
    return str(body["parent"]) if is_seat else name


def _part(
    definition: Mapping[str, Any], piece: str, start: str, pieces: Mapping[str, str], ports: Sequence[Mapping[str, Any]]
) -> dict[str, Any]:
    """The bodies of one piece as a definition of its own, with the parameters that occur in them."""
    bodies = [
        {**body, "parent": BASE} if piece and body["name"] == start else body
        for body in definition["bodies"]
        if pieces[body["name"]] == piece
    ]
    used = {word for body in bodies for key in body if key not in ("name", "parent") for word in _words(body[key])}
    parameters = {name: value for name, value in definition.get("parameters", {}).items() if name in used}
    own = ("bodies", "parameters", "ports", "closures", *(("left_out",) if piece else ()))
    kept = {key: value for key, value in definition.items() if key not in own}
    name = part_name(definition["name"], piece or MAIN)
    made = kept | {"name": name, "bodies": bodies, "ports": list(ports)}
    return made | ({"parameters": parameters} if parameters else {})


def _words(value: Any) -> Iterator[str]:
    """The names in all texts of plain data, those of parameters among them."""
    if isinstance(value, Mapping):
        value = list(value.values())
    if isinstance(value, list):
        for each in value:
            yield from _words(each)
    elif isinstance(value, str):
        yield from _WORD.findall(value)
