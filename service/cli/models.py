"""Parts and trees in files of any kind: JSON, YAML, or a robot file by its content, whose readers are imported then."""

from __future__ import annotations

from collections.abc import Mapping
from importlib import import_module
from pathlib import Path
from typing import TYPE_CHECKING, Any

from service.cli.documents import definition_of, named, read_document
from service.cli.output import tell_warnings
from service.cli.tree_files import parts_beside
from substructures.interchange.content import is_foreign
from substructures.part.part import Part, derive
from substructures.tree.document import TreeSpec

if TYPE_CHECKING:
    from substructures.interchange.importing import Imported

ROBOTS = "service.cli.robots"


def read_definition(path: Path) -> Any:
    """A definition as plain data, also out of a robot file; its warnings are told. Raises InvalidDocument."""
    if not is_foreign(path.read_bytes()):
        return read_document(path)
    found = _read_robot_file(path)
    remarks = [{"pointer": r["place"], "message": r["message"]} for r in found.report if r["level"] == "warning"]
    tell_warnings({"warnings": remarks})
    return found.definition


def part_or_tree(path: Path) -> Part | tuple[TreeSpec, Mapping[str, Part]]:
    """A definition, derived, or a tree with its parts, found beside it or in the catalogue; also of robot files."""
    if is_foreign(path.read_bytes()):
        found = _read_robot_file(path)
        document = found.definition if found.tree is None else found.tree
    else:
        document = read_document(path)
    with named(path):
        if isinstance(document, dict) and "instances" in document:
            spec = TreeSpec.read(document)
            return spec, parts_beside(spec, path.parent)
        return derive(definition_of(document))


def _read_robot_file(path: Path) -> Imported:
    found: Imported = import_module(ROBOTS).read_robot_file(path)
    return found
