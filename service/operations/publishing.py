"""Trees as parts: the definition of all of a tree, verified and stored like any other."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

from service.content.derivation import recipe_of
from service.content.summaries import PartContent
from service.database.connections import Connection
from service.jobs.kinds.requested.publication import publication_of
from service.jobs.worker import Worker
from service.messages.refusals import Refused
from service.messages.viewer import PRIVATE, PUBLIC, Viewer
from service.operations import catalogue, owners, trees
from service.operations.sharing.provenance import Origin
from service.operations.sharing.sources import pinned_tree, tree_parts
from service.queries import content
from service.queries.owners import private_parts
from service.queries.trees import Tree
from service.schemas.entries import PartEntry
from service.schemas.publishing import PublishRequest
from service.store.store import Store
from substructures.documents import read_json, read_model
from substructures.tree.publishing.published import Published, published


@dataclass(frozen=True, slots=True)
class Module:
    """A ``tree`` as a definition that is to be stored; ``request``: what it was asked to be."""

    found: Published
    tree: Tree
    request: Any
    entry: PartEntry
    origin: Origin
    recipe: str

    def document(self) -> dict[str, Any]:
        """As it would be submitted."""
        plain: dict[str, Any] = read_json(self.found.definition.canonical())
        return plain | self.entry.model_dump(exclude_none=True)


def module(store: Store, viewer: Viewer, text: str, request: Any) -> Module:
    """The definition of a tree as a part; ``request``: the body of a PublishRequest.

    Raises Refused 404, 403, 409, InvalidDocument.
    """
    wanted = read_model(PublishRequest, request)
    with store.database.read() as connection:
        tree = trees.find(connection, viewer, text)
        name = wanted.name or tree.name
        hidden = PRIVATE if not tree.is_public and wanted.visibility is None else wanted.visibility
        entry = PartEntry(visibility=hidden, note=wanted.note or None, derived_from=wanted.derived_from)
        spec, parts = tree_parts(store, tree)
        uses = {instance: part.definition.digest for instance, part in parts.items()}
        _require_visible(connection, viewer, tree, name, entry, uses)
        recipes = {instance: content.get_recipe(connection, digest) for instance, digest in uses.items()}
    how = publication_of(wanted, name)
    found = published(spec, parts, how)
    origin = Origin("tree", tree.name, tree.revision, uses)
    return Module(found, tree, request, entry, origin, recipe_of(spec, parts, recipes, how))


def _require_visible(
    connection: Connection, viewer: Viewer, tree: Tree, name: str, entry: PartEntry, uses: Mapping[str, str]
) -> None:
    """Raise Refused 403 for a name of others, 409 where others would see what is private."""
    whose = owners.wanted(connection, viewer, "substructure", name, entry)
    if whose.visibility == PUBLIC and not tree.is_public:
        detail = f"the tree '{tree.name}' is private, and the part would be public: make the tree public first"
        raise Refused(409, "private-tree", detail + f" (PUT /v1/trees/{tree.name}/visibility), or the part private")
    for part, owner in private_parts(connection, uses.values()).values():
        if owner != whose.owner:
            raise Refused(409, "private-part", f"the tree has a part that is private to '{owner}'")
        if whose.visibility == PUBLIC:
            raise Refused(409, "private-part", f"'{part}' is private, and the part would be public: make it public")


def prepare(store: Store, viewer: Viewer, worker: Worker, found: Module) -> catalogue.PartSubmission:
    """Couple, verify and certify it. Raises as :func:`service.operations.catalogue.prepare`."""
    definition = found.found.definition

    def make() -> PartContent:
        """What is stored of it, coupled of the stored formulas."""
        pinned, blobs = pinned_tree(store, found.tree)
        item = {"parts": pinned["parts"], "request": found.request, "name": definition.name, **store.work_limits}
        item["recipe"] = found.recipe
        return PartContent.of_files(worker("publish", item, blobs).files)

    return catalogue.prepare(store, viewer, definition, found.entry, found.origin, make)
