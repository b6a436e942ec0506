"""The commands ``import`` and ``same``: robot files, and models side by side."""

from __future__ import annotations

import sys
import zipfile
from collections.abc import Callable, Iterator, Mapping
from itertools import islice
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

from service.cli.choices import one_of
from service.cli.documents import named
from service.cli.options import Json, Server, Wait, with_server
from service.cli.output import print_json, waiting
from service.cli.tree_files import part_or_tree
from substructures.client.files import save
from substructures.documents import write_json
from substructures.errors import InvalidDocument
from substructures.interchange.equivalence import Equivalence, equivalence
from substructures.interchange.files.archive import PACKAGE, Beside, main_of
from substructures.interchange.files.wanted import KINDS, Base, Fixed, Options, Parameters, Rotations
from substructures.interchange.importing import Imported, import_file
from substructures.interchange.sides import sides

if TYPE_CHECKING:
    from substructures.client import Client

#: an included file or mesh is read when it is in the folder of the file, or below it
_MOST_BYTES = 64 * 2**20
_MOST_FILES = 20_000
Cut = Annotated[
    str,
    typer.Option(
        metavar="LINK,...", help="Links that begin parts of their own, in a tree, which waits until they are stored."
    ),
]


def read_robot_file(
    path: Path,
    options: Options = Options(),  # noqa: B008 -- frozen
    **more: Any,
) -> Imported:
    """A robot file with the files beside it that it includes and takes meshes from; of a folder or a zip the robot file
    that is there. Raises InvalidDocument naming the file."""
    with named(path):
        files = _files_of(path)
        if files is None:
            return import_file(path.read_bytes(), options, file=path.name, included=_Beside(path.parent), **more)
        names, read = files
        main = main_of(names, read, path.name if path.suffix.lower() == PACKAGE else "")
        return import_file(read(main), options, file=main, included=Beside(main, names, read), **more)


def _files_of(path: Path) -> tuple[list[str], Callable[[str], bytes]] | None:
    """The files of a folder or a zip, by their paths in it; None for any other file."""
    if path.is_dir():
        found = list(islice((file for file in path.rglob("*") if file.is_file()), _MOST_FILES))
        return [file.relative_to(path).as_posix() for file in found], lambda name: (path / name).read_bytes()
    if path.suffix.lower() not in (".zip", PACKAGE):
        return None
    try:
        with zipfile.ZipFile(path) as archive:
            files = {each.filename: archive.read(each) for each in archive.infolist() if not each.is_dir()}
    except zipfile.BadZipFile as error:
        raise InvalidDocument.at("", "invalid-zip", f"not a zip that can be read: {error}") from None
    return list(files), files.__getitem__


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


@with_server
def read(
    server: Server,
    file: Annotated[
        Path,
        typer.Argument(
            metavar="FILE", help=f"Robot file ({', '.join(KINDS)}), or a folder or zip of one with its meshes."
        ),
    ],
    kind: Annotated[str | None, one_of(KINDS, help="What the file has to be.")] = None,
    name: Annotated[str | None, typer.Option(help="Name of the part (default: the robot's).")] = None,
    parameters: Annotated[Parameters, typer.Option(help="What becomes a parameter.")] = "inertia",
    fixed: Annotated[Fixed, typer.Option(help="What links on fixed joints become.")] = "ports",
    base: Annotated[Base, typer.Option(help="Whether the root moves.")] = "fixed",
    rotations: Annotated[Rotations, typer.Option(help="With what ball and free joints turn.")] = "angles",
    cut: Cut = "",
    license: Annotated[str, typer.Option(help="Licence of the file.")] = "",  # noqa: A002 -- name of the option
    out: Annotated[
        Path | None, typer.Option(metavar="FILE", help="Write the definition (or tree) to this JSON file.")
    ] = None,
    submit: Annotated[bool, typer.Option("--submit", help="Derive and store it on the server.")] = False,
    wait: Wait = True,
    json: Annotated[bool, typer.Option("--json", help="Print JSON: also the report, and what was stored.")] = False,
) -> int:
    """Read a robot file as a definition, with a report of what became of everything in it."""
    chosen = Options(parameters, fixed, base, rotations)
    links = [text.strip() for text in cut.split(",") if text.strip()]
    found = read_robot_file(file, chosen, kind=kind, name=name, license_of_file=license, cut=links)
    document = found.definition if found.tree is None else found.tree
    for line in _told(found):
        print(line, file=sys.stderr)
    if out:
        size = save(out, write_json(document) + b"\n")
        print(f"{out}: {size} bytes", file=sys.stderr)
    if not submit:
        if json:
            print(write_json({**found.plain(), "stored": None}).decode())
        elif not out:
            print(write_json(document).decode())
        return 0
    return _submitted(server, found, document, wait, json)


def _submitted(server: Server, found: Imported, document: Any, wait: bool, json: bool) -> int:
    with server.client() as client:
        with waiting("deriving"):
            if found.tree is None:
                answer = client.request("POST", "/v1/substructures", document)
            else:
                answer = client.request("POST", "/v1/trees", _with_names(client, document))
        stored = answer.json()
        if answer.status_code == 202:
            from service.cli.progress import became_job  # noqa: PLC0415 -- with the client, of a server alone

            return became_job(client, stored, wait, json)
    if json:
        print(write_json({**found.plain(), "stored": stored}).decode())
    else:
        print(f"{stored['name']} {stored['digest']}")
    return 0


def _with_names(client: Client, tree: Mapping[str, Any]) -> dict[str, Any]:
    """The tree whose parts are stored under their names, once, and are called by them."""
    stored = [client.submit(each["definition"])[0] for each in tree["instances"]]
    instances = [
        {**{name: x for name, x in each.items() if name != "definition"}, "substructure": part.ref}
        for each, part in zip(tree["instances"], stored, strict=True)
    ]
    return {**tree, "instances": instances}


def _told(found: Imported) -> Iterator[str]:
    alike = dict[tuple[str, str, str], list[dict[str, Any]]]()
    for remark in found.report:
        alike.setdefault((remark["level"], remark["element"], remark["message"]), []).append(remark)
    for (level, _, message), some in alike.items():
        more = f" and {len(some) - 1} more" if len(some) > 1 else ""
        yield f"{level}: {some[0]['place']}{more}: {message}"
    checks = ", ".join(
        f"{name} {'passed' if told['passed'] else '{warnings} warning(s)'.format(**told)}"
        for name, told in found.checks.items()
    )
    # in a tree they are instance.name
    plain = {a.removeprefix("joint ").removeprefix("frame "): b.rpartition(".")[2] for a, b in found.names.items()}
    renamed = sum(a != b for a, b in plain.items())
    yield f"{found.kind}: checks of {checks}; {renamed} of {len(found.names)} names changed"


def same(
    a: Annotated[Path, typer.Argument(metavar="A", help="Definition or tree (JSON, YAML), or a robot file.")],
    b: Annotated[list[Path], typer.Argument(metavar="B...", help="The same; each is compared with the first.")],
    coordinates: Annotated[str, typer.Option(metavar="A=B,...", help="Names in A that are others in B.")] = "",
    json: Json = False,
) -> int:
    """Tell whether two models are the same, and which body and parameter differ; 1 when not."""
    given = dict(pair.strip().partition("=")[::2] for pair in coordinates.split(",") if pair.strip())
    ours = part_or_tree(a)
    differing, told = 0, []
    for path in b:
        ours_here, theirs = sides(ours, part_or_tree(path))
        found = equivalence(ours_here, theirs, given)
        differing += not found.equal
        lines = list(_verdict(found))
        told.append({"b": str(path), "equal": found.equal, "level": found.level, "words": lines})
        if not json:
            for line in lines:
                print(f"{path}: {line}" if len(b) > 1 else line)
    if json:
        print_json(told)
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


COMMANDS = {"import": read, "same": same}
