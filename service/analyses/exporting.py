"""Exports: quantities of trees and parts as files of a target, one file as it is, several as a zip."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

from service.analyses.binding import bound, bound_names
from service.analyses.printing import NAME
from substructures.errors import InvalidArgument
from substructures.export import (
    Exported,
    Interface,
    archive,
    exported_model,
    exported_part,
    files,
    interface_of_model,
    interface_of_part,
)
from substructures.export.exported import check_name
from substructures.expr.program import Program
from substructures.part.part import Part
from substructures.quantities.evaluation import Sources

ZIP = "application/zip"
_MEDIA = {"json": "application/json", "zip": ZIP}
#: quantities of a tree and of a part where none are named; those that are not stored are left out
OF_TREES, OF_PARTS = ("metric", "christoffel", "forces"), ("metric", "christoffel")


@dataclass(frozen=True, slots=True)
class ExportRequest:
    """``together``: also a function with all quantities."""

    target: str
    quantities: tuple[str, ...] = ()
    name: str = ""
    bind: str = ""
    together: bool = False

    @property
    def identity(self) -> tuple[str, ...]:
        """What an ETag depends on beside the content."""
        return "export", self.target, ",".join(self.quantities), self.name, self.bind, str(self.together)


@dataclass(frozen=True, slots=True)
class Package:
    """A file: its name, media type and content."""

    name: str
    media: str
    data: bytes


def prefix(wanted: str, called: str) -> str:
    """The prefix of functions: what is wanted, or the name of the tree or part where it can be one."""
    if wanted:
        return wanted
    try:
        return check_name(called.replace("-", "_"))
    except InvalidArgument:
        return NAME


def tree_package(
    sources: Sources, called: str, reference: str, digest: str, request: ExportRequest, limit: int
) -> Package:
    """A tree for a target. Raises InvalidArgument, InvalidDocument, TooLarge, Refused 422 for bad bindings."""
    parameters = sources.model.parameters
    outputs = sources.model.program.outputs
    names = request.quantities or tuple(name for name in OF_TREES if name in outputs)
    interface = _left(interface_of_model(sources.model, reference, digest), request)

    def numbers(program: Program) -> Program:
        """The program with numbers in place of parameters."""
        return bound(program, parameters, request.bind)

    exported = exported_model(sources, interface, names, prefix(request.name, called), numbers, request.together)
    return _package(exported, request, limit)


def part_package(part: Part, reference: str, digest: str, request: ExportRequest, limit: int) -> Package:
    """A part for a target, as it stands alone. Raises as :func:`tree_package`."""
    names = request.quantities or tuple(name for name in OF_PARTS if name in part.program.outputs)
    interface = _left(interface_of_part(part, reference, digest), request)

    def numbers(program: Program) -> Program:
        """The program with numbers in place of parameters."""
        return bound(program, part.parameters, request.bind)

    exported = exported_part(part, interface, names, prefix(request.name, part.name), numbers, request.together)
    return _package(exported, request, limit)


def _left(interface: Interface, request: ExportRequest) -> Interface:
    return interface.bound(bound_names(interface.vectors["p"].with_default, request.bind))


def _package(exported: Exported, request: ExportRequest, limit: int) -> Package:
    made = files(exported, request.target, limit)
    if len(made) > 1:
        return Package(f"{exported.name}_{request.target}.zip", ZIP, archive(made))
    ((name, data),) = made.items()
    return Package(name, _MEDIA.get(name.rpartition(".")[2], "text/plain; charset=utf-8"), data)


def read_item(item: Mapping[str, Any]) -> ExportRequest:
    """The export that an item of a job asks for; its fields are checked already."""
    given = tuple(item["quantities"])
    return ExportRequest(item["target"], given, item["name"], item["bind"], item["together"])
