"""The commands ``versions``, ``diff``, ``uses`` and ``publish``: what became of parts and trees on a server."""

from __future__ import annotations

import argparse
import json
from collections.abc import Iterator
from typing import Any
from urllib.parse import quote

from service.cli.options import Add, add_server
from service.cli.progress import follow
from substructures.client import Client
from substructures.client.connection import step


def _add_versions(command: argparse.ArgumentParser) -> None:
    command.set_defaults(command=_versions)
    command.add_argument("name", help="of a part, or with --tree of a tree")
    _add_common(command)


def _add_diff(command: argparse.ArgumentParser) -> None:
    command.set_defaults(command=_diff)
    command.add_argument("a", metavar="REF", help="name@1; a bare name is the latest")
    command.add_argument("b", metavar="REF", help="what it is compared with, also another part")
    _add_common(command)


def _add_uses(command: argparse.ArgumentParser) -> None:
    command.set_defaults(command=_uses)
    command.add_argument("ref", help="name@1, or a name for all versions")
    command.add_argument("--json", action="store_true", help="print JSON")
    add_server(command)


def _add_publish(command: argparse.ArgumentParser) -> None:
    command.set_defaults(command=_publish)
    command.add_argument("tree", help="name, or name@2")
    command.add_argument("--name", help="of the part (that of the tree)")
    command.add_argument(
        "--port", action="append", type=_pair, metavar="NAME=INSTANCE.PORT", help="may be repeated (all)"
    )
    command.add_argument(
        "--free", action="append", metavar="PARAMETER", help="that is bound to a number; may be repeated"
    )
    command.add_argument("--note", default="", help="why, in words")
    command.add_argument("--private", action="store_true", help="for the keys of its owner alone")
    command.add_argument("--wait", action="store_true", help="wait where it takes so long that it becomes a job")
    add_server(command)


def _add_common(command: argparse.ArgumentParser) -> None:
    command.add_argument("--tree", action="store_true", help="trees in place of parts")
    command.add_argument("--json", action="store_true", help="print JSON")
    add_server(command)


def _pair(text: str) -> tuple[str, str]:
    name, sign, place = text.partition("=")
    if not sign:
        raise argparse.ArgumentTypeError(f"NAME=INSTANCE.PORT is needed, found '{text}'")
    return name, place


def _items(client: Client, path: str) -> Iterator[dict[str, Any]]:
    """The items of all pages."""
    link: str | None = f"{path}?page_size=200"
    while link is not None:
        page = client.request("GET", link).json()
        yield from page["items"]
        link = page["links"]["next"]


def _versions(options: argparse.Namespace) -> int:
    kind, number = ("revisions", "revision") if options.tree else ("versions", "version")
    with Client(options.server, options.key) as client:
        path = f"/v1/{'trees' if options.tree else 'substructures'}/{step(options.name)}/{kind}"
        found = list(_items(client, path))
    if options.json:
        print(json.dumps(found, indent=1))
        return 0
    for each in found:
        whence = [f"of {each[name]}" for name in ("derived_from", "tree") if each.get(name)]
        whence += [f"changes @{each['based_on']}"] if each.get("based_on") else []
        if each.get("yanked"):
            instead = f", take {each['successor']}" if each["successor"] else ""
            whence.append(f"WITHDRAWN ({each['yank_reason'] or 'no reason given'}{instead})")
        reference = f"{each['name']}@{each[number]}"
        words = "; ".join(filter(None, [*whence, each["note"]]))
        print(f"{reference:<20} {each['created'][:16]}  {each['owner']:<12} {words}".rstrip())
    return 0


def _diff(options: argparse.Namespace) -> int:
    kind = "trees" if options.tree else "substructures"
    with Client(options.server, options.key) as client:
        found = client.request("GET", f"/v1/{kind}/{step(options.a)}/difference?to={quote(options.b)}").json()
    if options.json:
        print(json.dumps(found, indent=1))
        return 0
    print(f"{found['a']} -> {found['b']}")
    for words in found["words"]:
        print(f"  {words}")
    return 0


def _uses(options: argparse.Namespace) -> int:
    with Client(options.server, options.key) as client:
        found = list(_items(client, f"/v1/substructures/{step(options.ref)}/uses"))
    if options.json:
        print(json.dumps(found, indent=1))
        return 0
    for each in found:
        instances = ", ".join(f"{name} @{version}" for name, version in each["instances"].items())
        reference = f"{each['name']}@{each['number']}"
        print(f"{each['kind']:<8} {reference:<20} {instances}".rstrip())
    return 0


def _publish(options: argparse.Namespace) -> int:
    body: dict[str, Any] = {"note": options.note, "free": options.free or []}
    body |= {"name": options.name} if options.name else {}
    body |= {"ports": dict(options.port)} if options.port else {}
    body |= {"visibility": "private"} if options.private else {}
    with Client(options.server, options.key) as client:
        answer = client.request("POST", f"/v1/trees/{step(options.tree)}/publish", body)
        found = answer.json()
        if answer.status_code == 202:
            print(f"became the job {found['id']}")
            return follow(client, found["id"]) if options.wait else 0
    stored = "published" if answer.status_code == 201 else "was published already"
    print(f"{found['name']}@{found['version']} {stored}: ports {', '.join(found['ports']) or 'none'}")
    return 0


ADD: Add = {"versions": _add_versions, "diff": _add_diff, "uses": _add_uses, "publish": _add_publish}
