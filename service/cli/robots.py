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
from substructures.interchange.equivalence import Equivalence, equivalence
from substructures.interchange.importing import Imported, import_file
from substructures.interchange.kinds import KINDS, is_foreign
from substructures.interchange.sides import Parts, sides
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
    command.add_argument("--cut", default="", metavar="LINK,...", help="links that begin parts of their own, in a tree")
    command.add_argument("--license", default="", help="licence of the file")
    command.add_argument("--out", type=Path, help="write the definition (or tree) to this JSON file")
    command.add_argument("--submit", action="store_true", help="derive and store it on the server")
    add_server(command)


def _import(options: argparse.Namespace) -> int:
    chosen = Options(options.parameters, options.fixed, options.base)
    links = [text.strip() for text in options.cut.split(",") if text.strip()]
    found = read_robot_file(
        options.file, chosen, kind=options.kind, name=options.name, license_of_file=options.license, cut=links
    )
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
    # in a tree they are instance.name
    plain = {a.removeprefix("joint ").removeprefix("frame "): b.rpartition(".")[2] for a, b in found.names.items()}
    renamed = sum(a != b for a, b in plain.items())
    yield f"{found.kind}: checks of {checks}; {renamed} of {len(found.names)} names changed"


def _add_same(command: argparse.ArgumentParser) -> None:
    command.set_defaults(command=_same)
    command.add_argument("a", type=Path, help="definition or tree (JSON, YAML), or a robot file")
    command.add_argument("b", type=Path, nargs="+", help="the same; each is compared with the first")
    command.add_argument("--coordinates", default="", metavar="A=B,...", help="names in a that are others in b")


def _same(options: argparse.Namespace) -> int:
    """0 when all are the same as the first, 1 when not."""
    given = dict(pair.strip().partition("=")[::2] for pair in options.coordinates.split(",") if pair.strip())
    ours = part_or_tree(options.a)
    differing = 0
    for path in options.b:
        a, b = sides(ours, part_or_tree(path))
        found = equivalence(a, b, given)
        differing += not found.equal
        for line in _verdict(found):
            print(f"{path}: {line}" if len(options.b) > 1 else line)
    return 1 if differing else 0


def _verdict(found: Equivalence) -> Iterator[str]:
    if found.equal:
        worst = max((told["error"] for told in found.quantities.values()), default=0.0)
        how = "as formulas" if found.level == "formulas" else f"in numbers, to {worst:.1e}"
        yield f"the same {how}: {', '.join(found.quantities)}"
        return
    yield f"not the same: {write_json(found.first_difference).decode()}"
    for culprit in found.culprits:
        yield f"{culprit.body}: {culprit.parameter} {culprit.a} here, {culprit.b} there"


def part_or_tree(path: Path) -> Part | Parts:
    """A definition, derived, or a tree with its parts, found beside it or in the catalogue; also of robot files."""
    if is_foreign(path.read_bytes()):
        found = read_robot_file(path)
        document = found.definition if found.tree is None else found.tree
    else:
        document = read_document(path)
    with named(path):
        if isinstance(document, dict) and "instances" in document:
            spec = TreeSpec.read(document)
            return spec, parts_beside(spec, path.parent)
        return derive(Definition.read(document))


ADD: Add = {"import": _add_import, "same": _add_same}
