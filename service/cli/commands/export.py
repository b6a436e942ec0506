"""The command ``export``: a file here, or a stored tree or part on a server, as files for another tool."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from service.cli import completion
from service.cli.choices import one_of
from service.cli.documents import is_document, require_place
from service.cli.options import Json, Server, with_server
from service.cli.output import print_json, waiting
from service.cli.tree_files import coupled_source, part_or_tree
from service.models.exporting import (
    ALL_TARGETS,
    FMI,
    PRECISIONS,
    STANDARDS,
    ExportRequest,
    Package,
    part_package,
    tree_package,
)
from service.models.formulas import makers
from service.settings import Limits
from substructures.client.files import save
from substructures.client.steps import step
from substructures.part.part import Part

FORCE = "--force"

Tree = Annotated[
    str,
    typer.Argument(
        help="Tree or definition (JSON, YAML), robot file, or the name of a tree on a server.",
        autocompletion=completion.trees,
    ),
]
Target = Annotated[str, one_of(ALL_TARGETS, help=f"{', '.join(ALL_TARGETS)}.")]
Quantities = Annotated[
    str, typer.Option(help="name,... (metric, christoffel, forces).", autocompletion=completion.exported)
]
Prefix = Annotated[str, typer.Option(help="Prefix of functions (the name of the tree).")]
Bind = Annotated[str, typer.Option(help="Numbers in formulas: name:value,... or defaults.")]
Together = Annotated[bool, typer.Option("--together", help="Also a function with all quantities, NAME_all.")]
Packed = Annotated[bool, typer.Option("--packed", help="Of metric and christoffel the independent elements.")]
Fmi = Annotated[str, one_of(FMI, help="Of fmu: version of the interface.")]
Precision = Annotated[str, one_of(PRECISIONS, help="Of c: of the numbers.")]
Ranges = Annotated[
    str, typer.Option(help="Of single precision: name:lowest:highest,... that the bound of rounding is for.")
]
Stages = Annotated[bool, typer.Option("--stages", help="Of c: NAME_prepare(p, w), once per set of parameters.")]
Standard = Annotated[str, one_of(STANDARDS, help="Of c.")]
Independent = Annotated[str, typer.Option(help="Coordinates in whose velocities constrained motions are: name,...")]
OfPart = Annotated[bool, typer.Option("--part", help="The name is that of a part on a server.")]
Out = Annotated[
    Path | None, typer.Option(metavar="FILE", help="To be written; default its own name, in this directory.")
]
Force = Annotated[bool, typer.Option(FORCE, help="Write over another file of that name.")]


@with_server
def export(
    server: Server,
    tree: Tree,
    target: Target,
    quantities: Quantities = "",
    name: Prefix = "",
    bind: Bind = "",
    together: Together = False,
    packed: Packed = False,
    fmi: Fmi = FMI[0],
    precision: Precision = PRECISIONS[0],
    ranges: Ranges = "",
    stages: Stages = False,
    standard: Standard = STANDARDS[0],
    independent: Independent = "",
    part: OfPart = False,
    out: Out = None,
    force: Force = False,
    json: Json = False,
) -> int:
    """Functions of a tree for other tools: C, MATLAB, Fortran, computer algebra, FMU, ..."""
    names = tuple(text for text in quantities.split(",") if text)
    require_place(out)
    own = tuple(text for text in independent.split(",") if text)
    request = ExportRequest(target, names, name, bind, together, packed, fmi, precision, ranges, stages, standard, own)
    with waiting("writing"):
        package = _local(Path(tree), request) if _is_file(tree) else _remote(server, tree, part, request)
    path = _place(out, target, package, force)
    save(path, package.data)
    if json:
        print_json({"file": str(path), "bytes": len(package.data)})
    else:
        print(f"{path}: {len(package.data)} bytes")
    return 0


def _place(out: Path | None, target: str, package: Package, force: bool) -> Path:
    """Where it is written. Raises ValueError for another file that is there, and for one file in an archive."""
    path, ending = out or Path(package.name), Path(package.name).suffix
    if path.suffix == ".zip" != ending:
        raise ValueError(f"{target} is one file and no archive: --out {path.with_suffix(ending)}")
    if not force and path.exists() and (not path.is_file() or path.read_bytes() != package.data):
        raise ValueError(f"{path} is another file already: name one with --out, or write over it with {FORCE}")
    return path


def _is_file(given: str) -> bool:
    return is_document(given) or ("." in given and Path(given).is_file())


def _local(path: Path, request: ExportRequest) -> Package:
    read, limit = part_or_tree(path), Limits().program_nodes
    if isinstance(read, Part):
        return part_package(read, path.name, read.definition.digest, request, limit)
    source = coupled_source(*read)
    others = makers(source, request.independent)
    return tree_package(source.sources, path.stem, path.name, source.digest, request, limit, lambda: read, others)


def _remote(server: Server, tree: str, is_part: bool, request: ExportRequest) -> Package:
    kind = "substructures" if is_part else "trees"
    wanted = {
        "target": request.target,
        "quantities": ",".join(request.quantities),
        "name": request.name,
        "bind": request.bind,
        "together": request.together,
        "packed": request.packed,
        "fmi": request.fmi,
        "precision": request.precision,
        "ranges": request.ranges,
        "stages": request.stages,
        "standard": request.standard,
        "independent": ",".join(request.independent),
    }
    with server.client() as client:
        answer = client.request("GET", f"/v1/{kind}/{step(tree)}/export", params=wanted)
        name, content = client.file_of(answer)  # waits where it became a job
    return Package(Path(name).name, answer.headers["content-type"], content)


COMMANDS = {"export": export}
