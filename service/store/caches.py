"""What is kept decoded in memory, by kind. Content never changes, so a cached value is never out of date; programs
that take the place of others (:mod:`service.operations.upgrade`) have keys of their own."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

from service.content.cache import Cache
from service.messages.answers import Answer
from substructures.expr.program import Program
from substructures.part.part import Part
from substructures.quantities.from_parts import NumericTree
from substructures.tree.model import Model
from substructures.tree.plausibility import Plausibility

TREES = 1000  # with what judges their values
FACETS = 20_000  # values of facets
SHARED = 32  # combinations of parts
# bytes for each operation that is kept: of pictures, of stored bytes and uploads, of formulas as they were sent
PICTURES, BLOBS, PRINTED = 8, 32, 16


@dataclass(frozen=True)
class Caches:
    """Decoded values: ``parts`` by digests of definition and program, ``programs`` of trees by digest, ``models`` by
    those of the tree, ``derived`` by model and quantity, ``of_parts`` by digest of the tree, name and parts,
    ``numeric_trees`` and ``plausibilities`` by digest of the tree, ``evaluations`` that are at hand by reference and
    quantities, ``pictures`` in the standard pose and formulas of pages by digest, ``blobs`` by digest, ``printed``
    formulas by their ETag, and what browsers compute with, ``facets`` of searches by the last act that was noted,
    ``shared`` contents by digest that the latest trees of an owner and some programs of parts have in common.
    """

    parts: Cache[Part]
    programs: Cache[Program]
    models: Cache[Model]
    derived: Cache[Program]
    of_parts: Cache[Any]  # of substructures.quantities.of_parts
    numeric_trees: Cache[NumericTree]
    plausibilities: Cache[Plausibility]
    evaluations: Cache[Any]  # of service.operations.at_hand
    pictures: Cache[str]
    blobs: Cache[bytes]
    printed: Cache[Answer]
    facets: Cache[Any]  # of service.queries.searching.part_search
    shared: Cache[dict[str, bytes]]

    @classmethod
    def for_nodes(cls, nodes: int) -> Caches:
        """Caches that together hold programs of about so many operations, and what was made of these."""
        return cls(
            parts=Cache(nodes // 4, lambda part: len(part.program)),
            programs=Cache(nodes // 8, len),
            models=Cache(nodes // 4, lambda model: len(model.of_shape.program)),
            derived=Cache(nodes // 4, len),
            of_parts=Cache(nodes // 8, lambda found: len(found.program)),
            numeric_trees=Cache(nodes // 8, NumericTree.weight),
            plausibilities=Cache(TREES, lambda _: 1),
            evaluations=Cache(nodes // 8, lambda found: found.weight()),
            pictures=Cache(PICTURES * nodes, len),
            blobs=Cache(BLOBS * nodes, len),
            printed=Cache(PRINTED * nodes, lambda answer: len(answer.body)),
            facets=Cache(FACETS, lambda found: sum(map(len, found.values())) + 1),
            shared=Cache(SHARED, lambda _: 1),
        )
