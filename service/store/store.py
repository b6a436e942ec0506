"""The database with a cache of decoded parts and models in front."""

from __future__ import annotations

from collections.abc import Callable, Iterable
from pathlib import Path
from time import monotonic
from typing import Any

from service.content.derivation import software
from service.content.integrity import missing, reading
from service.database.connections import Connection, Database
from service.jobs.worker import Worker, Workers
from service.messages.refusals import NotDerived
from service.metrics import Metrics
from service.queries import content
from service.queries.trees import Tree
from service.settings import Settings
from service.store.caches import Caches
from service.store.idempotency import Claims
from service.store.job_events import Feed
from service.store.kernels import Kernels
from service.store.runtime import Runtime
from service.store.usage import Usage
from substructures.documents import read_json
from substructures.expr.program import Program
from substructures.part.definition import Definition
from substructures.part.part import Part
from substructures.tree.assembly import declared
from substructures.tree.document import TreeSpec
from substructures.tree.model import Model


class Store:
    """What every operation works on: the database, the caches in front of it, kernels, and the running process."""

    def __init__(self, settings: Settings, database: Database, metrics: Metrics, workers: Workers) -> None:
        self.settings, self.database, self.metrics, self.workers = settings, database, metrics, workers
        self.caches = Caches.for_nodes(settings.cache_nodes)
        self.kernels = Kernels(settings.kernel_folder, settings.limits.kernel_bytes)
        self.runtime = Runtime(settings.key_seconds)
        self.claims = Claims(database)
        self.usage = Usage(settings.limits)
        self.feed = Feed(database, self.runtime.stopping)

    def close(self) -> None:
        """Stop what computes, and give the database up."""
        self.workers.close()  # threads wait for it
        self.runtime.close()
        self.feed.close()
        self.claims.close()
        self.kernels.close()
        self.database.close()

    def part(self, connection: Connection, digest: str, is_newest: bool = False) -> Part | None:
        """The part with this digest, decoded; None when it is not stored. ``is_newest``: as this software derives it,
        for what is derived of it.

        Raises Refused for damaged content, NotDerived for what this server has not derived as it is.
        """
        program, made_by = content.program_of(connection, digest)
        if is_newest and program is not None and made_by != software():
            raise NotDerived("part", digest)
        part = self.caches.parts.get((digest, program))
        self.metrics.cache("part", part is not None)
        if part is None and (stored := content.get_part(connection, digest)) is not None:
            with reading("a part", digest):
                definition = Definition.stored(read_json(stored.definition))
                part = Part.load(definition, stored.program, read_json(stored.certificate))
            if not stored.is_derived:
                raise NotDerived("part", digest)
            self.caches.parts.put((digest, program), part)
        return part

    def required_part(self, connection: Connection, digest: str, is_newest: bool = False) -> Part:
        """The part of a version that is stored. Raises as :meth:`part`, and Refused for content that is gone."""
        part = self.part(connection, digest, is_newest)
        if part is None:
            raise missing("a definition", digest)
        return part

    @property
    def work_limits(self) -> dict[str, int]:
        """Fields of the items of works that derive or couple for a request: most operations at all, and those beyond
        which others would be kept waiting."""
        return {"nodes": self.settings.limits.program_nodes, "admit": self.settings.limits.sync_nodes}

    @property
    def work_folder(self) -> Path | None:
        """Where works keep compiled kernels: where this process does, unless they have the rights of another user."""
        return None if self.settings.runner_user else self.kernels.folder

    def job_worker(self, owner: str) -> Worker:
        """A worker that may take what an item of a job may, on behalf of an owner."""
        limits = self.settings.limits
        end = monotonic() + limits.job_seconds
        return Worker(self.workers, owner, limits.job_cpu_seconds, end, limits.job_memory_bytes)

    def blobs(self, digests: Iterable[str]) -> dict[str, bytes]:
        """Contents by digest. Raises Refused as :meth:`blob`."""
        return {digest: self.blob(digest) for digest in digests}

    def blob(self, digest: str) -> bytes:
        """The definition, the program or the uploaded states with this digest. Raises Refused as :meth:`part`."""
        blob = self.caches.blobs.get(digest)
        if blob is None:
            with self.database.read() as connection:
                blob = content.get_blob(connection, digest)
            if blob is None:
                raise missing("a content", digest)
            self.caches.blobs.put(digest, blob)
        return blob

    def model(self, connection: Connection, tree: Tree) -> Model:
        """The model of a revision, decoded. Raises Refused for content that is damaged or gone."""
        model = self.caches.models.get((tree.digest, tree.program))
        self.metrics.cache("model", model is not None)
        if model is None:
            with reading(f"the summary of tree {tree.name}@{tree.revision}", tree.summary_digest):
                summary = read_json(tree.summary.encode())
                if "inputs" not in summary:
                    summary |= self.declared(connection, tree)
                model = Model.load(summary, self._program_of(connection, tree))
            self.caches.models.put((tree.digest, tree.program), model)
        return model

    def _program_of(self, connection: Connection, tree: Tree) -> Program:
        """The program of a revision, which trees of one shape have in common. Raises Refused as :meth:`model`."""
        program = self.caches.programs.get(tree.program)
        if program is None:
            what = f"the program of tree {tree.name}@{tree.revision}"
            stored = content.get_program(connection, tree.program)
            if stored is None:
                raise missing(what, tree.program)
            with reading(what, tree.program):
                program = Program.from_bytes(stored)
            self.caches.programs.put(tree.program, program)
        return program

    def declared(self, connection: Connection, tree: Tree) -> dict[str, Any]:
        """All parameters and inputs of a tree that was stored when only those in its formulas were noted."""
        spec = TreeSpec.stored(read_json(tree.spec.encode()))
        parts = {each.name: self.part(connection, each.digest) for each in spec.instances}
        known = {name: part for name, part in parts.items() if part is not None}
        return declared(spec, known) if len(known) == len(parts) else {}

    def derived(self, model: Model, quantity: str, make: Callable[[], Program]) -> Program:
        """A program of :data:`substructures.quantities.quantity.DERIVED`, made unless it is remembered."""
        key = model.program.digest, model.coordinates, quantity
        program = self.caches.derived.get(key)
        self.metrics.cache("derived", program is not None)
        if program is None:
            program = make()
            self.caches.derived.put(key, program)
        return program
