"""Parts and models out of blobs, kept decoded from one item to the next."""

from __future__ import annotations

from collections.abc import Mapping
from functools import lru_cache
from typing import Any

from service.content.cache import Cache
from service.content.integrity import reading
from service.jobs.kinds.library import StoredTree
from substructures.certificate.agreement import not_judged
from substructures.documents import read_json
from substructures.documents.to_json import Written
from substructures.expr.program import Program
from substructures.part.definition import Definition
from substructures.part.part import Part
from substructures.tree.model import Model

CAPACITY = 300_000  # operations

_parts: Cache[Part] = Cache(CAPACITY, lambda part: len(part.program))
_programs: Cache[Program] = Cache(CAPACITY, len)
_models: Cache[Model] = Cache(CAPACITY, lambda model: len(model.of_shape.program))


def part_of(definition: str, program: str, blobs: Mapping[str, bytes]) -> Part:
    """The part with these digests; its certificate is left out. Raises Refused for damaged content.

    A program is read once for all definitions that differ in numbers and words alone.
    """
    key = definition, program
    part = _parts.get(key)
    if part is None:
        with reading("a part", definition):
            read = _programs.once(program, lambda: Program.from_bytes(blobs[program]))
            part = Part(Definition.kept(blobs[definition]), read, {})
        _parts.put(key, part)
    return part


def marks_of(certificate: str) -> tuple[str, ...]:
    """The outputs that a stored certificate of a part, as JSON, could not decide."""
    return tuple(not_judged(read_json(certificate.encode()))) if "null" in certificate else ()


@lru_cache(maxsize=64)
def summary_of(text: str) -> dict[str, Any]:
    """The stored summary of a tree as plain data, which is not to be changed."""
    found: dict[str, Any] = read_json(text.encode())
    return found


def pinned_model(tree: StoredTree) -> Written:
    """What a model is beside its program, as plain data for an item."""
    return _pinned_model(tree.summary)


@lru_cache(maxsize=64)
def _pinned_model(text: str) -> Written:
    summary = summary_of(text)
    parameters = {
        name: {"value": given["value"], "unit": given["unit"]} for name, given in summary["parameters"].items()
    }
    kept = (
        *("coordinates", "joints", "frames", "closures", "reduction"),
        *("inputs", "limited", "driven", "ignored", "velocity_constraints", "contacts", "balls", "reduced", "numbers"),
    )
    told: dict[str, Any] = {"warnings": summary["certificate"].get("warnings", [])}
    if lost := not_judged(summary["certificate"]):
        told["direct_form"] = {"max_relative_error": dict.fromkeys(lost)}
    found = {name: summary[name] for name in kept if name in summary}
    return Written(found | {"parameters": parameters, "certificate": told})


def model_of(item: Mapping[str, Any], blobs: Mapping[str, bytes]) -> Model:
    """The model of an item with the fields ``tree``, ``program`` and ``model``. Raises Refused for damaged content."""
    key = item["tree"], item["program"]
    model = _models.get(key)
    if model is None:
        with reading("the program of a tree", item["program"]):
            program = _programs.once(item["program"], lambda: Program.from_bytes(blobs[item["program"]]))
            model = Model.load({"certificate": {}, **item["model"]}, program)
        _models.put(key, model)
    return model
