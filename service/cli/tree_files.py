"""The parts of a tree document: inline definitions, files beside it, or entries of the shipped catalogue."""

from __future__ import annotations

from pathlib import Path

from service.cli.documents import DOCUMENTS, definition_of, named, read_document
from substructures import catalogue
from substructures.errors import InvalidDocument
from substructures.part.definition import Definition
from substructures.part.part import Part, derive
from substructures.tree.document import Instance, TreeSpec


def parts_beside(spec: TreeSpec, folder: Path) -> dict[str, Part]:
    """The part of every instance. Raises InvalidDocument for one that is nowhere."""
    return {i.name: _part(k, i, folder) for k, i in enumerate(spec.instances)}


def _part(index: int, instance: Instance, folder: Path) -> Part:
    if instance.definition is not None:
        return derive(instance.definition)
    name = (instance.substructure or "").partition("@")[0]
    files = [file for suffix in DOCUMENTS if (file := folder / f"{name}{suffix}").is_file()]
    if files:
        document = read_document(files[0])
        with named(files[0]):
            return derive(definition_of(document))
    if name not in catalogue.names():
        message = f"'{name}' is neither a file beside the tree nor in the shipped catalogue"
        raise InvalidDocument.at(f"/instances/{index}/substructure", "unknown-substructure", message)
    return derive(Definition.read(catalogue.load(name)))
