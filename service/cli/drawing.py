"""The structure of a part or tree as a drawing in text: what hangs on what, by which joints."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from typing import Any

from rich.tree import Tree

from substructures.client import Client
from substructures.client.steps import step

BASE, WORLD = "base", "world"


def drawn_part(client: Client, path: str, version: Mapping[str, Any]) -> Tree:
    """Bodies, joints with their coordinates, and ports."""
    definition = client.request("GET", f"{path}/definition").json()
    root = Tree(f"{version['name']}@{version['version']}")
    _bodies(root.add(BASE), BASE, definition, {})
    return root


def drawn_tree(client: Client, tree: Mapping[str, Any]) -> Tree:
    """The bodies of every instance, where they hang on others."""
    root = Tree(f"{tree['name']}@{tree['revision']}")
    definitions = {i["name"]: _definition(client, i) for i in tree["instances"]}
    mounted: dict[str, list[str]] = {}
    for instance in tree["instances"]:
        mounted.setdefault(instance.get("at", WORLD), []).append(instance["name"])

    def mount(node: Tree, place: str) -> None:
        """What hangs on a port or a body."""
        for name in mounted.get(place, ()):
            below = {inner: f"{name}.{inner}" for inner in _frames(definitions[name])}
            hung = node.add(f"{name} ({definitions[name]['name']})")
            mount(hung, f"{name}.{BASE}")
            _bodies(hung, BASE, definitions[name], below, mount)

    mount(root.add(WORLD), WORLD)
    for kind in ("closures", "loads"):
        for each in tree.get(kind, ()):
            along = [x if isinstance(x, str) else x["frame"] for x in each.get("along", ())]
            ends = filter(None, (each.get("from"), each.get("to"), each.get("coordinate"), *along))
            root.add(f"{each['name']}: {each['type']} {' - '.join(ends)}".rstrip())
    return root


def _definition(client: Client, instance: Mapping[str, Any]) -> Any:
    given = instance.get("definition")
    if given is not None:
        return given
    return client.request("GET", f"/v1/substructures/{step(instance['substructure'])}/definition").json()


def _frames(definition: Mapping[str, Any]) -> Iterable[str]:
    return (each["name"] for kind in ("bodies", "ports") for each in definition.get(kind, ()))


def _bodies(
    node: Tree, parent: str, definition: Mapping[str, Any], places: Mapping[str, str], mount: Any = None
) -> None:
    """What is fixed to or carried by a body; ``places``: names in the tree, with ``mount`` for what hangs there."""
    for port in definition.get("ports", ()):
        if port["body"] == parent:
            shown = node.add(f"> {port['name']}")
            if mount is not None:
                mount(shown, places[port["name"]])
    for body in definition.get("bodies", ()):
        if body["parent"] == parent:
            joint = body["joint"]
            named = joint.get("coordinate")
            coordinates = ", ".join(named) if isinstance(named, list) else named or ""
            shown = node.add(f"{body['name']}  [{' '.join(filter(None, (joint['type'], coordinates)))}]")
            if mount is not None:
                mount(shown, places[body["name"]])
            _bodies(shown, body["name"], definition, places, mount)
