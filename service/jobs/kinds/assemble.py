"""assemble: an item is a tree document as for ``POST /v1/trees``; its outcome is what is stored of the tree."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from functools import partial

from service.content.cache import Cache
from service.content.derivation import software
from service.content.summaries import part_content
from service.content.tree_summaries import tree_summary
from service.database.packed import pack
from service.jobs.engines.engine import Outcome
from service.jobs.kinds.decoded import part_of
from service.jobs.kinds.kind import ENTRY, Blobs, ItemProgress, Kind, admitted, parted, stored_definition
from service.jobs.kinds.library import Library, StoredVersion
from service.jobs.kinds.shapes import KNOWN, shapes_of
from service.messages.refusals import NotDerived
from service.schemas.jobs import ItemDocument
from service.settings import Limits
from substructures.analysis.equations.nonholonomic.independent_rows import check_constraints
from substructures.analysis.motion.contacts.rows import check_contacts
from substructures.documents import read_json
from substructures.documents.to_json import Written
from substructures.errors import Fault, InvalidDocument, InvalidInput, among
from substructures.part.definition import Definition
from substructures.part.derive import derive
from substructures.part.parameters import described
from substructures.part.part import Part
from substructures.tree.couple import couple_shape
from substructures.tree.document import Instance, TreeSpec, misplaced, with_levels
from substructures.tree.model import Model, no_coordinates
from substructures.tree.units import DescribedParameters, check_tree_units

NAMED = "named"  # field of an item whose parts that come along are to be called by name
DEFINITIONS = 1000  # kept decoded
PACKED = 10_000_000  # bytes
_definitions: Cache[Definition] = Cache(DEFINITIONS, lambda _: 1)
_described: Cache[DescribedParameters] = Cache(DEFINITIONS, lambda _: 1)  # parameters of definitions, likewise
_packed: Cache[bytes] = Cache(PACKED, len)  # programs of shapes


def _spread(item: ItemDocument, limits: Limits, _library: Library) -> list[ItemDocument]:
    entry, tree = parted(item)
    return [{"tree": tree, "nodes": limits.job_nodes, **entry}]


def pinned_tree(item: ItemDocument, library: Library, is_stored: bool = False) -> tuple[ItemDocument, tuple[str, ...]]:
    """References become ``name@sha256:...``; ``programs`` says which program belongs to which definition.

    ``is_stored``: the tree comes out of the store.
    """
    return pinned_spec(
        TreeSpec.stored(item["tree"]) if is_stored else TreeSpec.read(item["tree"]), item, library, is_stored
    )


def pinned_spec(
    spec: TreeSpec, item: ItemDocument, library: Library, is_stored: bool = False, is_checked: bool = False
) -> tuple[ItemDocument, tuple[str, ...]]:
    """As :func:`pinned_tree`, of a document that was read; ``is_checked``: it is compared with the definitions of its
    parts where it is coupled, unless there is a fault already.
    """
    versions = {i.name: library.version(i.substructure) for i in spec.instances if i.substructure is not None}
    faults = [
        Fault(f"/instances/{k}/substructure", "unknown-substructure", _unknown(instance, library))
        for k, instance in enumerate(spec.instances)
        if instance.name in versions and versions[instance.name] is None
    ]
    found = {name: version for name, version in versions.items() if version is not None}
    for version in found.values():
        if version.software != software():  # it may lack what is coupled today
            raise NotDerived("part", version.digest)
    if faults or not is_checked:
        spec = _compared(spec, found, library, is_stored, faults)
    pinned = tuple(_pin(instance, found.get(instance.name)) for instance in spec.instances)
    programs = {version.digest: version.program for version in found.values()}
    text = spec.model_copy(update={"instances": pinned}).canonical()
    tree = Written.of(read_json(text), text)
    entry = {ENTRY: item[ENTRY]} if ENTRY in item else {}
    return {"tree": tree, "programs": programs, "nodes": item["nodes"], **entry}, (*programs, *programs.values())


def _compared(
    spec: TreeSpec, found: Mapping[str, StoredVersion], library: Library, is_stored: bool, faults: Sequence[Fault]
) -> TreeSpec:
    """The tree, compared with the definitions of its parts. Raises InvalidDocument for these faults and more."""
    definitions = [_definition(each, found, library) for each in spec.instances]
    known = {i.name: each for i, each in zip(spec.instances, definitions, strict=True) if each is not None}
    units = () if is_stored else check_tree_units(spec, _parameters(known, found), known).faults
    if told := [*faults, *_faults(spec, definitions), *units]:
        raise InvalidDocument(told)
    return with_levels(spec, known) if is_stored else spec


def _faults(spec: TreeSpec, definitions: Sequence[Definition | None]) -> Iterator[Fault]:
    """Names that occur twice, hosts that do not exist, parameters and places of hosts that the ``definitions`` lack, of
    the instances that have one.
    """
    first: dict[str, Instance] = {}
    doubled = set[str]()
    for k, instance in enumerate(spec.instances):
        if first.setdefault(instance.name, instance) is not instance:
            doubled.add(instance.name)
            yield Fault(f"/instances/{k}/name", "duplicate-name", f"duplicate instance '{instance.name}'")
    frames = {
        instance.name: ["base", *(body.name for body in each.bodies), *(port.name for port in each.ports)]
        for instance, each in zip(spec.instances, definitions, strict=True)
        if each is not None and first[instance.name] is instance
    }
    unread = (first.keys() - frames.keys()) | doubled
    for k, (instance, definition) in enumerate(zip(spec.instances, definitions, strict=True)):
        if definition is not None:
            for name in instance.parameters:
                if name not in definition.parameters:
                    message = f"'{definition.name}' has no parameter '{name}'{among(name, definition.parameters)}"
                    yield Fault(f"/instances/{k}/parameters/{name}", "unknown-parameter", message)
        # of a host that cannot be read this is told elsewhere, and of two of one name it is not known which is meant
        found = misplaced(instance.at, frames) if instance.at.partition(".")[0] not in unread else None
        if found is not None:
            yield Fault(f"/instances/{k}/at", *found)


def _definition(instance: Instance, versions: Mapping[str, StoredVersion], library: Library) -> Definition | None:
    if instance.definition is not None:
        return instance.definition
    version = versions.get(instance.name)
    if version is None:
        return None
    found = _definitions.get(version.digest)
    if found is None:
        found = stored_definition(version.digest, library)
        _definitions.put(version.digest, found)
    return found


def _parameters(
    definitions: Mapping[str, Definition], versions: Mapping[str, StoredVersion]
) -> dict[str, DescribedParameters]:
    """Of every instance, by their names."""
    found: dict[str, DescribedParameters] = {}
    for name, each in definitions.items():
        make = partial(described, each.parameters)
        found[name] = _described.once(versions[name].digest, make) if name in versions else make()
    return found


def _unknown(instance: Instance, library: Library) -> str:
    return f"instance '{instance.name}': {library.absent('substructure', instance.substructure or '')}"


def _pin(instance: Instance, version: StoredVersion | None) -> Instance:
    if version is None:
        return instance
    return instance.model_copy(update={"substructure": f"{version.name}@{version.digest}"})


def _run(item: ItemDocument, blobs: Blobs, progress: ItemProgress) -> Outcome:
    """Files ``spec``, those of the summary, ``program`` (packed) unless it is known; of every inline definition
    ``<instance>.program``, ``.content``. Raises InvalidDocument, TooLarge.
    """
    given, parts = tree_parts(item, blobs)
    spec = _named(given, parts) if item.get(NAMED) else given
    progress(0.1)
    model = _coupled(spec, parts, item)
    definitions = {name: part.definition for name, part in parts.items()}
    spec = with_levels(spec, definitions, {each["instance"] for each in model.reduced})
    check_constraints(model)
    check_contacts(model)
    progress(0.9)
    known = item.get(KNOWN, ())
    files = {"spec": spec.canonical(), **tree_summary(spec, model).files(known)}
    if model.program.digest not in known:
        files["program"] = _packed.once(model.program.digest, lambda: pack(model.program))
    for instance in given.instances:
        if instance.definition is not None:
            content = part_content(parts[instance.name]).files()
            files |= {f"{instance.name}.{name}": data for name, data in content.items()}
    summary = {
        "name": spec.name,
        "digest": spec.digest,
        "program": model.program.digest,
        **({"numbers": {name: str(x) for name, x in model.numbers.items()}} if model.numbers else {}),
        "software": software(),
        "nodes": len(model.program),
        "dof": model.dof,
        "joints": model.joints,
        "mass": None if model.plausibility is None else model.plausibility.mass,
        "operations": model.operations["total"],
        "parts": {name: part.definition.digest for name, part in parts.items()},
        "warnings": [*model.certificate["warnings"], *no_coordinates(model.dof)],
    }
    return Outcome(summary, files)


def _coupled(spec: TreeSpec, parts: Mapping[str, Part], item: ItemDocument) -> Model:
    """The model. Raises InvalidDocument for all that is wrong with the tree, TooLarge."""
    try:
        return couple_shape(spec, parts, item["nodes"], admitted(item), known=shapes_of(item))
    except InvalidDocument:
        definitions = {name: part.definition for name, part in parts.items()}
        units = check_tree_units(spec, {name: part.parameters for name, part in parts.items()}, definitions)
        if told := [*_faults(spec, [definitions[each.name] for each in spec.instances]), *units.faults]:
            raise InvalidDocument(told) from None
        raise


def _named(spec: TreeSpec, parts: Mapping[str, Part]) -> TreeSpec:
    """The tree whose parts that come along are stored before it, and called by name."""
    named = [
        each.model_copy(update={"definition": None, "substructure": f"{part.name}@{part.definition.digest}"})
        for each, part in ((each, parts[each.name]) for each in spec.instances)
    ]
    return spec.model_copy(update={"instances": tuple(named)})


def tree_parts(item: ItemDocument, blobs: Blobs) -> tuple[TreeSpec, dict[str, Part]]:
    """The document of a pinned tree and its parts by instance. Raises InvalidDocument, TooLarge."""
    spec = TreeSpec.stored(item["tree"])
    return spec, {i.name: _part(k, i, item, blobs) for k, i in enumerate(spec.instances)}


def _part(index: int, instance: Instance, item: ItemDocument, blobs: Blobs) -> Part:
    if instance.definition is None:
        digest = (instance.substructure or "").partition("@")[2]
        return part_of(digest, item["programs"][digest], blobs)
    try:
        return derive(instance.definition, item["nodes"], admitted(item))
    except InvalidInput as error:
        raise error.below(f"/instances/{index}/definition") from None


KINDS = {"assemble": Kind(_spread, pinned_tree, _run)}
