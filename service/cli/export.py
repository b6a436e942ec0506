"""The command ``export``: a file here, or a stored tree or part on a server, as files for another tool."""

from __future__ import annotations

import argparse
from pathlib import Path

from service.analyses.exporting import ALL_TARGETS, FMI, PRECISIONS, ExportRequest, Package, part_package, tree_package
from service.cli.analysis import coupled_source, is_document
from service.cli.options import Add, add_server
from service.cli.robots import part_or_tree
from service.settings import Limits
from substructures.client import Client
from substructures.part.part import Part
from substructures.quantities.evaluation import Sources


def _add_export(command: argparse.ArgumentParser) -> None:
    command.set_defaults(command=_export)
    command.add_argument("tree", help="tree or definition (JSON, YAML), robot file, or the name of a tree on a server")
    command.add_argument("--target", required=True, choices=ALL_TARGETS)
    command.add_argument("--quantities", default="", help="name,... (metric, christoffel, forces)")
    command.add_argument("--name", default="", help="prefix of functions (the name of the tree)")
    command.add_argument("--bind", default="", help="numbers in formulas: name:value,... or defaults")
    command.add_argument("--together", action="store_true", help="also a function with all quantities, NAME_all")
    command.add_argument("--packed", action="store_true", help="of metric and christoffel the independent elements")
    command.add_argument("--fmi", choices=FMI, default=FMI[0], help="of fmu: version of the interface")
    command.add_argument("--precision", choices=PRECISIONS, default=PRECISIONS[0], help="of c: of the numbers")
    command.add_argument("--stages", action="store_true", help="of c: NAME_prepare(p, w), once per set of parameters")
    command.add_argument("--part", action="store_true", help="the name is that of a part on a server")
    command.add_argument("--out", type=Path, help="file to be written; default its own name, in this directory")
    add_server(command)


def _export(options: argparse.Namespace) -> int:
    names = tuple(text for text in options.quantities.split(",") if text)
    flags = options.together, options.packed, options.fmi, options.precision, options.stages
    request = ExportRequest(options.target, names, options.name, options.bind, *flags)
    package = _local(Path(options.tree), request) if _is_file(options.tree) else _remote(options, request)
    path = options.out or Path(package.name)
    path.write_bytes(package.data)
    print(f"{path}: {len(package.data)} bytes")
    return 0


def _is_file(given: str) -> bool:
    return is_document(given) or ("." in given and Path(given).is_file())


def _local(path: Path, request: ExportRequest) -> Package:
    read, limit = part_or_tree(path), Limits().program_nodes
    if isinstance(read, Part):
        return part_package(read, path.name, read.definition.digest, request, limit)
    source = coupled_source(*read)
    sources = Sources(source.model, regressor=source.regressor, reactions=source.reactions)
    return tree_package(sources, path.stem, path.name, source.digest, request, limit, lambda: read)


def _remote(options: argparse.Namespace, request: ExportRequest) -> Package:
    kind = "substructures" if options.part else "trees"
    with Client(options.server, options.key) as client:
        answer = client.export(
            kind,
            options.tree,
            request.target,
            request.quantities,
            request.name,
            request.bind,
            request.together,
            request.packed,
            request.fmi,
            request.precision,
            request.stages,
        )
    name = answer.headers["content-disposition"].partition('filename="')[2].rstrip('"')
    return Package(Path(name).name, answer.headers["content-type"], answer.content)


ADD: Add = {"export": _add_export}
