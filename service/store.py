"""The database with a cache of decoded parts and models in front."""

from __future__ import annotations

from collections.abc import Mapping
from concurrent.futures import ThreadPoolExecutor
from threading import Event
from typing import Any

from service.cache import Cache
from service.database.connections import Connection, Database
from service.kernels import Kernels
from service.keys import Authorisations
from service.metrics import Metrics
from service.queries import content
from service.queries.trees import Tree
from service.settings import Settings
from substructures.documents import read_json
from substructures.expr.program import Program
from substructures.part.definition import Definition
from substructures.part.part import Part
from substructures.quantities.formulas import derived
from substructures.quantities.from_parts import NumericTree
from substructures.quantities.regressor import RegressorModel
from substructures.tree.document import TreeSpec
from substructures.tree.model import Model, couple

THREADS = 16
PICTURES = 16 * 2**20  # characters
BLOBS = 64 * 2**20  # bytes of definitions, programs and uploads


class Store:
    """What every operation works on. Content never changes, so a cached value is never out of date."""

    def __init__(self, settings: Settings, database: Database, metrics: Metrics) -> None:
        self.settings, self.database, self.metrics = settings, database, metrics
        self._parts: Cache[Part] = Cache(settings.cache_nodes // 4, lambda part: len(part.program))
        self._models: Cache[Model] = Cache(settings.cache_nodes // 4, lambda model: len(model.program))
        self._derived: Cache[Program] = Cache(settings.cache_nodes // 4, len)
        self.regressors: Cache[RegressorModel] = Cache(settings.cache_nodes // 8, lambda found: len(found.program))
        self.numeric_trees: Cache[NumericTree] = Cache(settings.cache_nodes // 8, NumericTree.weight)
        self.at_hand: Cache[Any] = Cache(settings.cache_nodes // 8, lambda found: found.weight())  # of its operation
        self.pictures: Cache[str] = Cache(PICTURES, len)
        self._blobs: Cache[bytes] = Cache(BLOBS, len)
        self.kernels = Kernels(settings.kernel_folder)
        self.authorisations = Authorisations(settings.key_seconds)
        self.threads = ThreadPoolExecutor(THREADS, thread_name_prefix="request")  # requests that may be given up
        self.wake = Event()  # set when there is something new for the supervisor of this process
        self.stopping = Event()  # set when the server stops: answers without an end are ended

    def close(self) -> None:
        """Stop what computes in the background, and give the database up."""
        self.threads.shutdown(wait=True, cancel_futures=True)
        self.kernels.close()
        self.database.close()

    def part(self, connection: Connection, digest: str) -> Part | None:
        """The part with this digest, decoded; None when it is not stored."""
        part = self._parts.get(digest)
        self.metrics.cache("part", part is not None)
        if part is None and (stored := content.get_part(connection, digest)) is not None:
            definition = Definition.read(read_json(stored.definition))
            part = Part.load(definition, stored.program, read_json(stored.certificate))
            self._parts.put(digest, part)
        return part

    def blob(self, digest: str) -> bytes:
        """The definition, the program or the uploaded states with this digest. Raises LookupError."""
        blob = self._blobs.get(digest)
        if blob is None:
            with self.database.read() as connection:
                blob = content.get_blob(connection, digest)
            if blob is None:
                raise LookupError(f"{digest} is not in the store")
            self._blobs.put(digest, blob)
        return blob

    def remember_part(self, part: Part) -> None:
        """Keep a part that was just derived."""
        self._parts.put(part.definition.digest, part)

    def model(self, connection: Connection, tree: Tree) -> Model:
        """The model of a revision, decoded."""
        model = self._models.get(tree.digest)
        self.metrics.cache("model", model is not None)
        if model is None:
            program = content.get_program(connection, tree.program)
            if program is None:
                raise LookupError(f"the program of tree {tree.name}@{tree.revision} is missing")
            model = Model.load(read_json(tree.summary.encode()), program)
            self._models.put(tree.digest, model)
        return model

    def coupled(self, spec: TreeSpec, parts: Mapping[str, Part]) -> Model:
        """The model of a tree that is not stored, coupled unless it is remembered. Raises as ``couple`` does."""
        model = self._models.get(spec.digest)
        self.metrics.cache("model", model is not None)
        if model is None:
            model = couple(spec, parts, self.settings.limits.program_nodes)
            self._models.put(spec.digest, model)
        return model

    def derived(self, model: Model, quantity: str) -> Program:
        """A program of :data:`substructures.quantities.formulas.DERIVED`. Raises as ``derived`` does."""
        key = model.program.digest, model.coordinates, quantity
        program = self._derived.get(key)
        self.metrics.cache("derived", program is not None)
        if program is None:
            program = derived(model, quantity, self.settings.limits.program_nodes)
            self._derived.put(key, program)
        return program

    def remember_model(self, digest: str, model: Model) -> None:
        """Keep a model that was just coupled."""
        self._models.put(digest, model)
