"""A library in memory for the tests of jobs, and items made ready to be computed."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from typing import Any

from service.content.derivation import software
from service.content.tree_summaries import summary_text, tree_summary
from service.jobs.engines.engine import AttemptReport, Budget, Engine, Work
from service.jobs.kinds import expand, resolve, submission
from service.jobs.kinds.library import StoredTree, StoredVersion
from service.settings import Limits
from substructures.documents import write_json
from substructures.interchange.importing import document_of
from substructures.part.definition import Definition
from substructures.part.derive import derive
from substructures.part.part import Part
from substructures.tree.couple import couple_shape
from substructures.tree.document import TreeSpec

BUDGET = Budget(60.0, 2**31)


class MemoryLibrary:
    """Holds definitions and trees that are given as documents; references are by name."""

    def __init__(self, definitions: Sequence[Mapping[str, Any]], trees: Sequence[Mapping[str, Any]] = ()) -> None:
        self.blobs: dict[str, bytes] = {}
        self.parts: dict[str, Part] = {}
        self._trees: dict[str, StoredTree] = {}
        for document in definitions:
            part = derive(Definition.read(document))
            self.parts[part.name] = part
            self.blobs |= {part.definition.digest: part.definition.canonical()}
            self.blobs |= {part.program.digest: part.program.to_bytes()}
        for tree in trees:
            self._couple(TreeSpec.read(tree))

    def _couple(self, spec: TreeSpec) -> None:
        parts = {i.name: self.parts[i.substructure or ""] for i in spec.instances}
        pins = {name: f"{part.name}@{part.definition.digest}" for name, part in parts.items()}
        pinned = tuple(i.model_copy(update={"substructure": pins[i.name]}) for i in spec.instances)
        spec = spec.model_copy(update={"instances": pinned})
        model = couple_shape(spec, parts)
        self.blobs[model.program.digest] = model.program.to_bytes()
        document = spec.canonical().decode()
        made = tree_summary(spec, model)
        texts = document, summary_text(made.values, made.form, document)
        self._trees[spec.name] = StoredTree(spec.name, spec.digest, model.program.digest, *texts, 1, software())

    def file(self, given: Mapping[str, Any]) -> Mapping[str, Any]:
        return document_of(given)

    def version(self, reference: str) -> StoredVersion | None:
        part = self.parts.get(reference.partition("@")[0])
        return (
            None if part is None else StoredVersion(part.name, part.definition.digest, part.program.digest, software())
        )

    def wrong_number(self, _version: StoredVersion) -> str:
        return ""

    def tree(self, reference: str) -> StoredTree | None:
        return self._trees.get(reference.partition("@")[0])

    def catalogue(self) -> list[str]:
        return [f"{name}@1" for name in self.parts]

    def trees(self) -> list[str]:
        return list(self._trees)

    def own(self, kind: str) -> list[str]:
        return self.trees() if kind == "tree" else self.catalogue()

    def absent(self, kind: str, reference: str) -> str:
        return f"there is no {kind} '{reference}'"

    def may_change(self, kind: str, name: str) -> bool:
        return (kind, name) != ("substructure", "other")

    def recipe(self, digest: str) -> str | None:
        """No part is a published tree."""
        return dict[str, str]().get(digest)

    def blob(self, digest: str) -> bytes | None:
        return self.blobs.get(digest)

    def sources(self) -> list[str]:
        return ["https://parts.example.org"]

    def items(self, kind: str, request: Mapping[str, Any], limits: Limits | None = None) -> list[dict[str, Any]]:
        """Expanded and resolved; numbers as they are after they were stored."""
        expanded = expand(submission({"kind": kind, **request}), limits or Limits(), self)
        resolved = [resolve(kind, item, self) for item in expanded]
        assert all(digest in self.blobs for _, digests in resolved for digest in digests)
        assert all(write_json(item) for item, _ in resolved)
        return [item for item, _ in resolved]

    def works(self, kind: str, request: Mapping[str, Any], budget: Budget = BUDGET) -> list[Work]:
        """Works for an engine."""
        works = []
        for k, item in enumerate(self.items(kind, request)):
            _, digests = resolve(kind, item, self)
            works.append(Work(f"{kind}-{k}", kind, item, {d: self.blobs[d] for d in digests}, budget))
        return works


def compute(
    engine: Engine, works: Sequence[Work], seconds: float = 60.0, told: Callable[[int], None] = lambda _: None
) -> dict[str, AttemptReport]:
    """The final reports of works; ``told``: called with how many there are so far."""
    waiting, final = list(works), {}
    for _ in range(int(seconds / 0.05)):
        while waiting and engine.free:
            engine.start(waiting.pop(0))
        for report in engine.reports(0.05):
            if report.is_final:
                assert report.id not in final
                final[report.id] = report
        told(len(final))
        if len(final) == len(works):
            return final
    raise AssertionError(f"{len(final)} of {len(works)} works ended in time")


def chain(bodies: int, name: str = "chain") -> dict[str, Any]:
    """A general serial chain: what deriving it takes grows quickly with its length."""
    return {
        "name": name,
        "parameters": {f"{p}{k}": {"value": k + 1} for k in range(bodies) for p in "mdas"},
        "bodies": [
            {
                "name": f"b{k}",
                "parent": f"b{k - 1}" if k else "base",
                "joint": {"type": "revolute", "coordinate": f"q{k}", "theta": f"a{k}", "d": f"d{k}", "sigma": f"s{k}"},
                "mass": f"m{k}",
                "com": [f"d{k}/2", f"s{k}/3", f"d{k}/5"],
                "inertia": {"xx": f"m{k}", "yy": f"m{k}", "zz": f"m{k}"},
            }
            for k in range(bodies)
        ],
    }
