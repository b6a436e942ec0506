"""Evaluations that are at hand: one state of a pinned tree, by kernels in memory, on the event loop itself
(:mod:`service.http.one_state`).

They take less time than a change of threads. Everything else, also what is asked for the first time, goes the long way,
which leaves behind here what the next request of the same kind needs. Pinned trees never change, but are removed: every
now and then a request goes the long way, which finds out.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import dataclass, replace
from time import monotonic
from typing import Any

from service.messages.answers import Answer, json_answer
from service.messages.viewer import Viewer
from service.operations import evaluations
from service.operations.exchange import TreeEvaluation
from service.queries.trees import Tree
from service.schemas.numbers import EvaluationRequest
from service.store.store import Store
from substructures.documents import read_json
from substructures.expr.program import Program
from substructures.quantities.numbers.one_state import OneState, prepared
from substructures.quantities.numbers.states import longest
from substructures.quantities.quantity import OF_PARTS, REACTIONS
from substructures.quantities.sources import Sources, cost, steps

EVERYBODY = ""  # no owner
BODY = 4096  # bytes of the request
OPERATIONS, NUMBERS = 20_000, 2_000  # for one state: some tens of microseconds
SECONDS = 1.0  # for which a tree that was there is taken to be there
KEPT = 4_000  # operations whose memory is that of what is prepared for one state


@dataclass(slots=True)
class AtHand:
    """An evaluation with the programs it takes by source, and their outputs; ``seen``: when the tree was there."""

    evaluation: TreeEvaluation
    programs: Mapping[str, tuple[Program, list[str]]]
    one_state: OneState | None
    seen: float

    def is_ready(self, store: Store) -> bool:
        """Whether all kernels are in memory."""
        return all(store.kernels.has(program, names) for program, names in self.programs.values())

    def weight(self) -> int:
        """Operations, and what memory of kernels is kept beside them counts as much as."""
        return sum(len(program) for program, _ in self.programs.values()) + (0 if self.one_state is None else KEPT)


def answer(store: Store, viewer: Viewer, ref: str, body: bytes) -> Answer | None:
    """The answer to a JSON request, None when it is not at hand. Raises as :meth:`TreeEvaluation.json`."""
    data = read_json(body)
    names = data.get("quantities") if isinstance(data, Mapping) else None
    found: AtHand | None = None
    if isinstance(names, list):
        kept = store.caches.evaluations
        found = kept.get(_key(EVERYBODY, ref, names)) or kept.get(_key(viewer.owner, ref, names))
    if found is None or monotonic() - found.seen >= SECONDS or not found.is_ready(store):
        return None
    quick = None if found.one_state is None else found.one_state.at(data)
    if quick is not None:
        return json_answer(evaluations.as_json(quick, found.evaluation.digest))
    arguments = EvaluationRequest.read(data).arguments()
    return found.evaluation.json(arguments) if longest(arguments) == 1 else None


def remember(store: Store, tree: Tree, ref: str, request: EvaluationRequest, evaluation: TreeEvaluation) -> None:
    """Keep what answers the same quantities of a pinned tree for another state, if that is short work.

    The size of one state was checked for the request that comes to be remembered; what is private is kept for its
    owner.
    """
    sources, names = evaluation.sources, request.quantities
    kept, key = store.caches.evaluations, _key(EVERYBODY if tree.is_public else tree.owner, ref, names)
    known: AtHand | None = kept.get(key)
    if known is not None:
        known.seen = monotonic()
        return
    operations, numbers = cost(sources, names)
    if operations > OPERATIONS or numbers > NUMBERS or sources.model.closures or REACTIONS in names:
        return
    programs = {source: (program, outputs) for source, program, outputs in steps(sources, names) if program}
    own = {source: sources.of(source) for source in programs if source in OF_PARTS}
    derived = lambda _, source: programs[source][0]  # noqa: E731 -- nothing is derived anew
    at_hand = Sources(sources.model, derived, own.__getitem__, sources.plausibility)
    found = AtHand(replace(evaluation, sources=at_hand), programs, None, monotonic())
    if found.is_ready(store):
        one_state = prepared(at_hand, names, lambda program, outputs: store.kernels.compiled(program, outputs)[0])
        kept.put(key, replace(found, one_state=one_state))


def _key(owner: str, ref: str, quantities: Iterable[Any]) -> tuple[str, ...]:
    return (owner, ref, *map(str, quantities))
