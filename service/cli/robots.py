"""The command ``import``, and documents of any kind: JSON, YAML, or a robot file by its content."""

from __future__ import annotations

import argparse
import sys
from collections.abc import Iterator
from pathlib import Path
from typing import Any, get_args

from service.cli.options import Add, add_server, named, read_document, tell_warnings
from service.cli.tree_files import parts_beside
from substructures.client import Client
from substructures.documents import write_json
from substructures.interchange.as_part import Base, Fixed, Options, Parameters
from substructures.interchange.equivalence import equivalence
from substructures.interchange.importing import Imported, import_file
from substructures.interchange.kinds import KINDS, is_foreign
from substructures.interchange.sides import Side
from substructures.part.definition import Definition
from substructures.part.part import Part, derive
from substructures.tree.document import TreeSpec

#: an included file is read when it is in the folder of the file, or below it
_MOST_BYTES = 4 * 2**20


def read_definition(path: Path) -> Any:
    """A definition as plain data, also out of a robot file; its warnings are told. Raises InvalidDocument."""
    if not is_foreign(path.read_bytes()):
        return read_document(path)
    found = read_robot_file(path)
    tell_warnings({"warnings": _warnings(found)})
    return found.definition


def read_robot_file(
    path: Path,
    options: Options = Options(),  # noqa: B008 -- frozen
    **more: Any,
) -> Imported:
    """A robot file with the files beside it that it includes. Raises InvalidDocument naming the file."""
    with named(path):
        return import_file(path.read_bytes(), options, file=path.name, included=_Beside(path.parent), **more)


class _Beside(dict[str, bytes]):
    """The files in a folder, read when they are asked for by their relative names; none outside of it."""

    def __init__(self, folder: Path) -> None:
        super().__init__()
        self._folder = folder.resolve()

    def __contains__(self, name: object) -> bool:
        return self._path(str(name)) is not None

    def __getitem__(self, name: str) -> bytes:
        path = self._path(name)
        if path is None:
            raise KeyError(name)
        return path.read_bytes()

    def _path(self, name: str) -> Path | None:
        path = (self._folder / name).resolve()
        inside = path.is_relative_to(self._folder) and path.is_file() and path.stat().st_size <= _MOST_BYTES
        return path if inside else None


def _add_import(command: argparse.ArgumentParser) -> None:
    command.set_defaults(command=_import)
    command.add_argument("file", type=Path, help=f"robot file: {', '.join(KINDS)}, found by its content")
    command.add_argument("--kind", choices=KINDS, help="what the file has to be")
    command.add_argument("--name", help="name of the part (default: the robot's)")
    command.add_argument(
        "--parameters",
        choices=get_args(Parameters),
        default="inertia",
        help="what becomes a parameter (inertia)",
    )
    command.add_argument(
        "--fixed", choices=get_args(Fixed), default="ports", help="what links on fixed joints become (ports)"
    )
    command.add_argument("--base", choices=get_args(Base), default="fixed", help="whether the root moves (fixed)")
    command.add_argument("--license", default="", help="licence of the file")
    command.add_argument("--out", type=Path, help="write the definition (or tree) to this JSON file")
    command.add_argument("--submit", action="store_true", help="derive and store it on the server")
    add_server(command)


def _import(options: argparse.Namespace) -> int:
    chosen = Options(options.parameters, options.fixed, options.base)
    found = read_robot_file(options.file, chosen, kind=options.kind, name=options.name, license_of_file=options.license)
    document = found.definition if found.tree is None else found.tree
    for line in _told(found):
        print(line, file=sys.stderr)
    if options.out:
        options.out.write_bytes(write_json(document) + b"\n")
    elif not options.submit:
        print(write_json(document).decode())
    if options.submit:
        path = "/v1/substructures" if found.tree is None else "/v1/trees"
        with Client(options.server, options.key) as client:
            answer = client.request("POST", path, document).json()
        print(f"{answer['name']} {answer.get('digest', answer.get('id'))}")
    return 0


def _warnings(found: Imported) -> list[dict[str, str]]:
    return [{"pointer": r["place"], "message": r["message"]} for r in found.report if r["level"] == "warning"]


def _told(found: Imported) -> Iterator[str]:
    for remark in found.report:
        yield f"{remark['level']}: {remark['place']}: {remark['message']}"
    checks = ", ".join(
        f"{name} {'passed' if told['passed'] else '{warnings} warning(s)'.format(**told)}"
        for name, told in found.checks.items()
    )
    renamed = sum(a.removeprefix("joint ") != b for a, b in found.names.items())
    yield f"{found.kind}: checks of {checks}; {renamed} of {len(found.names)} names changed"


def _add_same(command: argparse.ArgumentParser) -> None:
    command.set_defaults(command=_same)
    for name in ("a", "b"):
        command.add_argument(name, type=Path, help="definition or tree (JSON, YAML), or a robot file")
    command.add_argument("--coordinates", default="", metavar="A=B,...", help="names in a that are others in b")


def _same(options: argparse.Namespace) -> int:
    """0 when they are the same, 1 when not."""
    read = [_part_or_tree(path) for path in (options.a, options.b)]
    like = next((x.spec for x in read if isinstance(x, Side)), None)
    a, b = (x if isinstance(x, Side) else Side.of_part(x, like) for x in read)
    given = dict(pair.strip().partition("=")[::2] for pair in options.coordinates.split(",") if pair.strip())
    found = equivalence(a, b, given)
    worst = max((told["error"] for told in found.quantities.values()), default=0.0)
    if found.equal:
        how = "as formulas" if found.level == "formulas" else f"in numbers, to {worst:.1e}"
        print(f"the same {how}: {', '.join(found.quantities)}")
        return 0
    print(f"not the same: {write_json(found.first_difference).decode()}")
    for culprit in found.culprits:
        print(f"{culprit.body}: {culprit.parameter} {culprit.a} here, {culprit.b} there")
    return 1


def _part_or_tree(path: Path) -> Part | Side:
    """A tree is coupled, as by ``simulate``; its parts are found beside it or in the catalogue."""
    if is_foreign(path.read_bytes()):
        found = read_robot_file(path)
        document = found.definition if found.tree is None else found.tree
    else:
        document = read_document(path)
    with named(path):
        if isinstance(document, dict) and "instances" in document:
            spec = TreeSpec.read(document)
            return Side.of_tree(spec, parts_beside(spec, path.parent))
        return derive(Definition.read(document))


ADD: Add = {"import": _add_import, "same": _add_same}
