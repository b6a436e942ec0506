"""Trees out of files, coupled here; parts are inline definitions, files beside them, or of the shipped catalogue."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path

from service.cli.documents import definition_of, named, read_document
from service.cli.models import imported
from service.cli.output import tell_warnings
from service.models.source import Source
from service.settings import Limits
from substructures import catalogue
from substructures.analysis.equations.nonholonomic.independent_rows import check_constraints
from substructures.analysis.motion.contacts.rows import check_contacts
from substructures.documents import DOCUMENTS
from substructures.errors import InvalidDocument
from substructures.interchange.files.content import is_foreign
from substructures.part.definition import Definition
from substructures.part.derive import derive
from substructures.part.part import Part
from substructures.quantities.numbers.warnings import BY_VALUE, TOLD
from substructures.quantities.sources import Sources, of_parts
from substructures.tree.couple import couple
from substructures.tree.document import Instance, TreeSpec


def parts_beside(spec: TreeSpec, folder: Path) -> dict[str, Part]:
    """The part of every instance. Raises InvalidDocument for one that is nowhere."""
    return {i.name: _part(k, i, folder) for k, i in enumerate(spec.instances)}


def part_or_tree(path: Path) -> Part | tuple[TreeSpec, Mapping[str, Part]]:
    """A definition, derived, or a tree with its parts, found beside it or in the catalogue; also of robot files."""
    if is_foreign(path.read_bytes()):
        found = imported(path)
        document = found.definition if found.tree is None else found.tree
    else:
        document = read_document(path)
    with named(path):
        if isinstance(document, dict) and "instances" in document:
            spec = TreeSpec.read(document)
            return spec, parts_beside(spec, path.parent)
        return derive(definition_of(document))


def local_source(path: Path) -> Source:
    """A tree document coupled here. Its parts are inline definitions, files ``<name>.yaml`` or ``.json`` beside the
    document, or entries of the shipped catalogue. Raises InvalidDocument.
    """
    document = read_document(path)
    with named(path):
        spec = TreeSpec.read(document)
        return coupled_source(spec, parts_beside(spec, path.parent))


def coupled_source(spec: TreeSpec, parts: Mapping[str, Part]) -> Source:
    """A tree of parts coupled here; its warnings are told. Raises InvalidDocument."""
    limits = Limits()
    model = couple(spec, parts, limits.program_nodes)
    check_constraints(model)
    check_contacts(model)
    # the others come with the result
    tell_warnings({"warnings": [w for w in model.certificate["warnings"] if w["code"] not in TOLD | BY_VALUE]})
    sources = Sources(model, of_parts=of_parts(spec, parts, limits.program_nodes))
    return Source(sources, spec.digest, limits, parts=lambda: (spec, parts))


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
