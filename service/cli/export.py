"""The command ``export``: a tree document here, or a stored tree or part on a server, as files for another tool."""

from __future__ import annotations

import argparse
from pathlib import Path

from service.analyses.exporting import ExportRequest, Package, tree_package
from service.cli.analysis import is_document, local_source
from service.cli.options import Add, add_server
from service.settings import Limits
from substructures.client import Client
from substructures.export import TARGETS
from substructures.quantities.evaluation import Sources


def _add_export(command: argparse.ArgumentParser) -> None:
    command.set_defaults(command=_export)
    command.add_argument("tree", help="tree document (JSON or YAML), or the name of a tree on a server")
    command.add_argument("--target", required=True, choices=tuple(TARGETS))
    command.add_argument("--quantities", default="", help="name,... (metric, christoffel, forces)")
    command.add_argument("--name", default="", help="prefix of functions (the name of the tree)")
    command.add_argument("--bind", default="", help="numbers in formulas: name:value,... or defaults")
    command.add_argument("--together", action="store_true", help="also a function with all quantities, NAME_all")
    command.add_argument("--part", action="store_true", help="the name is that of a part on a server")
    command.add_argument("--out", type=Path, help="file to be written; default its own name, in this directory")
    add_server(command)


def _export(options: argparse.Namespace) -> int:
    names = tuple(text for text in options.quantities.split(",") if text)
    request = ExportRequest(options.target, names, options.name, options.bind, options.together)
    package = _local(Path(options.tree), request) if is_document(options.tree) else _remote(options, request)
    path = options.out or Path(package.name)
    path.write_bytes(package.data)
    print(f"{path}: {len(package.data)} bytes")
    return 0


def _local(path: Path, request: ExportRequest) -> Package:
    source = local_source(path)
    sources = Sources(source.model, regressor=source.regressor)
    return tree_package(sources, path.stem, path.name, source.digest, request, Limits().program_nodes)


def _remote(options: argparse.Namespace, request: ExportRequest) -> Package:
    kind = "substructures" if options.part else "trees"
    with Client(options.server, options.key) as client:
        answer = client.export(
            kind, options.tree, request.target, request.quantities, request.name, request.bind, request.together
        )
    name = answer.headers["content-disposition"].partition('filename="')[2].rstrip('"')
    return Package(Path(name).name, answer.headers["content-type"], answer.content)


ADD: Add = {"export": _add_export}
