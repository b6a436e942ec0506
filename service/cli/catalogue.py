"""The command ``catalogue``: the parts of a server as a folder of YAML files that lives well in git, and back."""

from __future__ import annotations

import argparse
import sys
from collections.abc import Iterator
from pathlib import Path
from typing import Any
from urllib.parse import urlencode

from service.cli.options import Add, add_action, add_server, named, read_document
from substructures.client import Client, ProblemError
from substructures.client.connection import step
from substructures.documents import read_json, write_yaml
from substructures.errors import InvalidInput
from substructures.part.definition import Definition

ENDINGS = (".yaml", ".yml", ".json")


def _add_catalogue(command: argparse.ArgumentParser) -> None:
    actions = command.add_subparsers(dest="action", required=True, metavar="ACTION")
    text = "write the latest version of every part to a file, in an order and a form of their own; others stay"
    export = add_action(actions, "export", _export, text)
    export.add_argument("folder", type=Path, metavar="DIR")
    text = "derive, verify and store what is new or changed among the files of a folder, and say what that is"
    read = add_action(actions, "import", _import, text)
    read.add_argument("folder", type=Path, metavar="DIR")
    for each in (export, read):
        each.add_argument("--owner", help="only parts of this owner; an import tells which of them have no file")
        add_server(each)


def _export(options: argparse.Namespace) -> int:
    options.folder.mkdir(parents=True, exist_ok=True)
    counts = dict.fromkeys(("new", "changed", "same"), 0)
    with Client(options.server, options.key) as client:
        for name, _ in _parts(client, options.owner):
            content = client.request("GET", f"/v1/substructures/{step(name)}/definition").content
            path = options.folder / f"{name}.yaml"
            text = _text(Definition.stored(read_json(content)))
            before = path.read_bytes() if path.exists() else None
            told = "new" if before is None else "same" if before == text else "changed"
            counts[told] += 1
            if told != "same":
                path.write_bytes(text)
                print(f"{told}: {path}")
    print(", ".join(f"{count} {told}" for told, count in counts.items()))
    return 0


def _import(options: argparse.Namespace) -> int:
    files = sorted(path for path in options.folder.iterdir() if path.suffix in ENDINGS)
    read = {path: _definition(path) for path in files}
    names = [each.name for each in read.values() if each is not None]
    counts = dict.fromkeys(("new", "changed", "same", "gone", "refused"), 0)
    counts["refused"] = len(read) - len(names)
    with Client(options.server, options.key) as client:
        known = dict(_parts(client, options.owner))
        for path, definition in read.items():
            if definition is not None:
                told = _stored(client, path, definition, known.get(definition.name))
                counts[told] += 1
        gone = sorted(known.keys() - set(names)) if options.owner else []
    counts["gone"] = len(gone)
    for name in gone:
        print(f"gone: {name} has no file; it stays on the server")
    print(", ".join(f"{count} {told}" for told, count in counts.items()))
    return 1 if counts["refused"] else 0


def _definition(path: Path) -> Definition | None:
    """The definition in a file; what is wrong is told."""
    try:
        document = read_document(path)
        with named(path):
            return Definition.read(document)
    except InvalidInput as error:
        print(f"refused: {error}", file=sys.stderr)
        return None


def _stored(client: Client, path: Path, definition: Definition, digest: str | None) -> str:
    """What became of a definition: ``same`` as the latest version, ``new``, ``changed`` or ``refused``."""
    if digest == definition.digest:
        return "same"
    try:
        version, _ = client.submit(read_json(definition.canonical()))
    except ProblemError as error:
        print(f"refused: {path}: {error}", file=sys.stderr)
        return "refused"
    told = "new" if digest is None else "changed"
    print(f"{told}: {path} is {version['name']}@{version['version']}")
    return told


def _parts(client: Client, owner: str | None) -> Iterator[tuple[str, str]]:
    """Name and digest of the latest version of every part."""
    link: str | None = "/v1/substructures?" + urlencode({"page_size": 200} | ({"owner": owner} if owner else {}))
    while link is not None:
        page: dict[str, Any] = client.request("GET", link).json()
        yield from ((item["name"], item["digest"]) for item in page["items"])
        link = page["links"]["next"]


def _text(definition: Definition) -> bytes:
    """In the order of the fields, defaults left out."""
    return write_yaml(definition.model_dump(exclude_defaults=True, by_alias=True))


ADD: Add = {"catalogue": _add_catalogue}
