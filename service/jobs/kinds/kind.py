"""What a kind of job consists of: spread an item given, resolve it against the store, compute it."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping
from contextlib import contextmanager
from dataclasses import dataclass

from service.content.integrity import missing, reading
from service.jobs.engines.engine import Outcome
from service.jobs.kinds.library import Library, StoredTree, StoredVersion
from service.messages.refusals import LongWork
from service.schemas.entries import Entry
from service.schemas.jobs import ItemDocument
from service.settings import Limits
from substructures.errors import InvalidDocument, InvalidInput
from substructures.part.definition import Definition

Blobs = Mapping[str, bytes]
ItemProgress = Callable[[float], None]
#: field of an item that stores something: what its document says beside its content, left out where that is nothing
ENTRY = "entry"


@dataclass(frozen=True)
class Kind:
    """One kind. Pointers of all faults are relative to the item as it was given.

    ``spread(item, limits, library)``: the items that one item given stands for. ``resolve(item, library)``: such an
    item with references pinned to digests, and the digests of the blobs it needs. ``run(item, blobs, progress)``: its
    outcome; reads nothing but its arguments.
    """

    spread: Callable[[ItemDocument, Limits, Library], list[ItemDocument]]
    resolve: Callable[[ItemDocument, Library], tuple[ItemDocument, tuple[str, ...]]]
    run: Callable[[ItemDocument, Blobs, ItemProgress], Outcome]


@contextmanager
def inside(place: str) -> Iterator[None]:
    """Faults that are found here have pointers relative to this place of the item."""
    try:
        yield
    except InvalidInput as error:
        raise error.below(place) from None


def parted(document: ItemDocument, of: type[Entry] = Entry) -> tuple[ItemDocument, ItemDocument]:
    """The field ENTRY of an item, if there is one, and the document without what belongs there."""
    entry, rest = of.parted(document)
    given = entry.model_dump(exclude_none=True)
    return ({ENTRY: given} if given else {}), rest


def admitted(item: ItemDocument) -> Callable[[int], None] | None:
    """What refuses, by LongWork, a derivation or coupling of more operations than ``admit`` of the item says."""
    most = item.get("admit")

    def admit(operations: int) -> None:
        """Raise LongWork where so many operations would take others their time."""
        if most is not None and operations > most:
            raise LongWork(f"about {operations:,} operations")

    return None if most is None else admit


def stored_definition(digest: str, library: Library) -> Definition:
    """The definition of a version that is stored. Raises Refused for one that is damaged or gone."""
    content = library.blob(digest)
    if content is None:
        raise missing("a definition", digest)
    with reading("a definition", digest):
        return Definition.kept(content)


def recipe_member(version: StoredVersion, library: Library) -> ItemDocument:
    """The member of an item that says what a part that is a published tree is coupled of."""
    recipe = library.recipe(version.digest)
    return {} if recipe is None else {"recipe": recipe}


def known_tree(item: ItemDocument, library: Library) -> StoredTree:
    """The tree that an item refers to. Raises InvalidDocument."""
    tree = library.tree(item["tree"])
    if tree is None:
        raise InvalidDocument.at("/tree", "unknown-tree", library.absent("tree", item["tree"]))
    return tree


def known_part(item: ItemDocument, library: Library) -> StoredVersion:
    """The version of a part that an item refers to. Raises InvalidDocument."""
    version = library.version(item["substructure"])
    if version is None:
        message = library.absent("substructure", item["substructure"])
        raise InvalidDocument.at("/substructure", "unknown-substructure", message)
    return version
