"""The command ``catalogue``: the parts of a server as a folder of YAML files that lives well in git, and back."""

from __future__ import annotations

import sys
from collections.abc import Iterator
from pathlib import Path
from typing import Annotated, Any
from urllib.parse import urlencode

import typer

from service.cli.documents import named, read_document
from service.cli.options import Json, Private, Server, with_server
from service.cli.output import print_json
from service.messages.viewer import PRIVATE
from service.schemas.entries import PartEntry
from substructures.client import Client, ProblemError
from substructures.client.files import save
from substructures.client.steps import step
from substructures.documents import DOCUMENTS, read_json, write_yaml
from substructures.errors import InvalidInput
from substructures.part.definition import Definition

Folder = Annotated[Path, typer.Argument(metavar="DIR")]
Owner = Annotated[str, typer.Option(help="Only parts of this owner; an import tells which of them have no file.")]


@with_server
def export(server: Server, folder: Folder, owner: Owner = "", json: Json = False) -> int:
    """Write the latest version of every part to a file, in an order and a form of their own; others stay.

    The file of a private part says that it is private.
    """
    folder.mkdir(parents=True, exist_ok=True)
    counts, hidden = dict.fromkeys(("new", "changed", "same"), 0), 0
    with server.client() as client:
        for part in _parts(client, owner):
            content = client.request("GET", f"/v1/substructures/{step(part['name'])}/definition").content
            path = folder / f"{part['name']}.yaml"
            text = _text(Definition.stored(read_json(content)), part["visibility"])
            hidden += part["visibility"] == PRIVATE
            before = path.read_bytes() if path.exists() else None
            told = "new" if before is None else "same" if before == text else "changed"
            counts[told] += 1
            if told != "same":
                save(path, text)
                if not json:
                    print(f"{told}: {path}")
    if hidden and not json:
        print(f"private: {hidden}; their files say so, and 'catalogue import' keeps them so")
    _tell(counts | ({"private": hidden} if json else {}), json)
    return 0


@with_server
def read(server: Server, folder: Folder, owner: Owner = "", private: Private = False, json: Json = False) -> int:
    """Derive, verify and store what is new or changed among the files of a folder, and say what that is.

    What is new is private where its file says "visibility: private", or with --private all of it, and public otherwise.
    With --private a change of a part that is public is refused.
    """
    files = sorted(path for path in folder.iterdir() if path.suffix in DOCUMENTS)
    if not files:
        print(f"{folder} has no definition in it ({', '.join(f'*{suffix}' for suffix in DOCUMENTS)})", file=sys.stderr)
    found = {path: _definition(path) for path in files}
    wanted = {"visibility": PRIVATE} if private else {}
    names = [each[0].name for each in found.values() if each is not None]
    counts = dict.fromkeys(("new", "changed", "same", "gone", "refused"), 0)
    counts["refused"] = len(found) - len(names)
    with server.client() as client:
        known = {part["name"]: part["digest"] for part in _parts(client, owner)}
        for path, given in found.items():
            if given is not None:
                definition, entry = given
                document = {**read_json(definition.canonical()), **entry.model_dump(exclude_none=True), **wanted}
                told, words = _stored(client, path, document, definition.digest, known.get(definition.name))
                counts[told] += 1
                if words:
                    print(words, file=sys.stderr if json or told == "refused" else sys.stdout)
        gone = sorted(known.keys() - set(names)) if owner else []
    counts["gone"] = len(gone)
    for name in gone:
        print(f"gone: {name} has no file; it stays on the server", file=sys.stderr if json else sys.stdout)
    _tell(counts, json)
    return 1 if counts["refused"] else 0


def _tell(counts: dict[str, int], as_json: bool) -> None:
    if as_json:
        print_json(counts)
    else:
        print(", ".join(f"{count} {told}" for told, count in counts.items()))


def _definition(path: Path) -> tuple[Definition, PartEntry] | None:
    """The definition in a file, and what is said beside it; what is wrong is told."""
    try:
        given = read_document(path)
        with named(path):
            entry, document = PartEntry.parted(given)
            return Definition.read(document), entry
    except InvalidInput as error:
        print(f"refused: {error}", file=sys.stderr)
        return None


def _stored(client: Client, path: Path, document: dict[str, Any], digest: str, latest: str | None) -> tuple[str, str]:
    """What became of a definition: ``same`` as the latest version, ``new``, ``changed`` or ``refused``; in words."""
    if digest == latest:
        return "same", ""
    try:
        version, is_new = client.submit(document)
    except ProblemError as error:
        return "refused", f"refused: {path}: {error}"
    if not is_new:
        why = "which is withdrawn" if version["is_withdrawn"] else "and the latest version stays another"
        return "same", f"same: {path} is {version['name']}@{version['version']} already, {why}"
    told = "new" if latest is None else "changed"
    return told, f"{told}: {path} is {version['name']}@{version['version']}"


def _parts(client: Client, owner: str) -> Iterator[dict[str, Any]]:
    """The latest version of every part."""
    link: str | None = "/v1/substructures?" + urlencode({"page_size": 200} | ({"owner": owner} if owner else {}))
    while link is not None:
        page: dict[str, Any] = client.request("GET", link).json()
        yield from page["items"]
        link = page["links"]["next"]


def _text(definition: Definition, visibility: str) -> bytes:
    """In the order of the fields, defaults left out; behind the name that it is private, if it is."""
    document = definition.model_dump(exclude_defaults=True, by_alias=True)
    hidden = {"visibility": PRIVATE} if visibility == PRIVATE else {}
    return write_yaml({"name": document.pop("name"), **hidden, **document})


COMMANDS = {"catalogue": {"export": export, "import": read}}
