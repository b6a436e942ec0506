"""What a browser computes with and asks about: modules of WebAssembly, origins and single entries of formulas, made by
workers and kept in memory."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field

from service.jobs.worker import Worker
from service.messages.answers import Answer
from service.messages.references import is_pinned
from service.messages.viewer import Viewer
from service.operations import catalogue, trees
from service.operations.sharing.sources import pinned_tree
from service.queries.catalogue import Version
from service.queries.trees import Tree
from service.schemas.jobs import ItemDocument
from service.store.store import Store
from substructures.errors import InvalidInput

Files = Mapping[str, bytes]


@dataclass(frozen=True)
class Subject:
    """A tree or a part that somebody may see; ``is_lasting``: what is told of it under this reference never changes."""

    store: Store
    digest: str
    program: str
    reference: str
    is_lasting: bool
    item: ItemDocument = field(hash=False)
    blobs: Files = field(hash=False, repr=False)


def of_tree(store: Store, viewer: Viewer, ref: str, has_parts: bool = False) -> Subject:
    """A revision; ``has_parts``: also its parts. Raises Refused 404."""
    with store.database.read() as connection:
        tree = trees.find(connection, viewer, ref)
    return of_revision(store, tree, is_pinned(ref) and tree.is_public, has_parts)


def of_revision(store: Store, tree: Tree, is_lasting: bool = False, has_parts: bool = False) -> Subject:
    """A revision that was found for whoever asks."""
    item, blobs = pinned_tree(store, tree, has_parts)
    return Subject(store, tree.digest, tree.program, f"{tree.name}@{tree.revision}", is_lasting, item, blobs)


def of_part(store: Store, viewer: Viewer, ref: str) -> Subject:
    """A version. Raises Refused 404."""
    with store.database.read() as connection:
        version = catalogue.find(connection, viewer, ref)
    return of_version(store, version, is_pinned(ref) and version.is_public)


def of_version(store: Store, version: Version, is_lasting: bool = False) -> Subject:
    """A version that was found for whoever asks."""
    item: ItemDocument = {"substructure": f"{version.name}@{version.digest}", "program": version.program}
    blobs = store.blobs((version.digest, version.program))
    reference = f"{version.name}@{version.version}"
    return Subject(store, version.digest, version.program, reference, is_lasting, item, blobs)


def program(subject: Subject, worker: Worker, quantities: Sequence[str]) -> Files:
    """Files ``wasm`` and ``json``, one as long as the other is kept. Raises InvalidInput with pointers into the query,
    TooLarge, TimeoutError."""

    def make() -> Answer:
        """Both in one body, the length of the first in a header."""
        try:
            files = made(subject, worker, "program", quantities=list(quantities))
        except InvalidInput as error:
            raise error.moved(lambda pointer: f"/query{pointer}") from None
        return Answer(200, files["wasm"] + files["json"], {"Length": str(len(files["wasm"]))})

    both = kept(subject, make, "program", *quantities)
    middle = int(both.headers["Length"])
    return {"wasm": both.body[:middle], "json": both.body[middle:]}


def origins(subject: Subject, worker: Worker) -> bytes:
    """The JSON document. Raises TimeoutError."""
    return kept(subject, lambda: Answer(200, made(subject, worker, "origins")["json"], {}), "origins").body


def integrals(subject: Subject, worker: Worker) -> bytes:
    """First integrals of a tree as JSON, without formulas. Raises TooLarge, TimeoutError."""
    return kept(subject, lambda: Answer(200, made(subject, worker, "integrals")["json"], {}), "integrals").body


def entry(subject: Subject, worker: Worker, quantity: str, index: Sequence[int]) -> bytes:
    """The JSON document of :func:`service.models.entries.entry`. Raises Refused 422, InvalidInput, TimeoutError."""

    def make() -> Answer:
        """One file."""
        return Answer(200, made(subject, worker, "entry", quantity=quantity, index=list(index))["json"], {})

    return kept(subject, make, "entry", quantity, *map(str, index)).body


def made(subject: Subject, worker: Worker, kind: str, **more: object) -> Files:
    """What a work about a subject makes. Raises as the worker does."""
    about = {"digest": subject.digest, "reference": subject.reference}
    nodes = subject.store.settings.limits.program_nodes
    return worker(kind, {**subject.item, **about, "nodes": nodes, **more}, subject.blobs).files


def kept(subject: Subject, make: Callable[[], Answer], *names: str) -> Answer:
    """What was made of a subject under these names, made unless it is remembered."""
    key = (subject.digest, subject.program, subject.reference, *names)
    return subject.store.caches.printed.once(key, make)
