"""A document as it was written, which is all that a certificate knows of it."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from substructures.certificate.numbers import Plain
from substructures.documents import Document
from substructures.documents.units import read_unit
from substructures.expr.direct import ball


def plain(document: Document) -> Plain:
    """The document as it was written, with its numbers in SI, which is all that a certificate knows of it."""
    return _declaring(document.model_dump(exclude_defaults=True, by_alias=True))


def _declaring(document: Plain) -> Plain:
    """A definition or tree: units of its parameters are those of their symbols, not of numbers."""
    apart = ("parameters", "inputs", "start", "ranges", "poses", "instances")
    found = {name: _in_si(value) for name, value in document.items() if name not in apart}
    declared = {kind: document[kind] for kind in ("parameters", "inputs") if kind in document}
    for kind, some in declared.items():
        found[kind] = {name: {**given, "value": _in_si(given.get("value"))} for name, given in some.items()}
    # what is by names of the user: two of them may be called "value" and "unit"
    found |= {field: _named(document[field]) for field in ("start", "ranges") if field in document}
    if "poses" in document:
        found["poses"] = {pose: _named(given) for pose, given in document["poses"].items()}
    if "instances" in document:
        found["instances"] = [_instance(given) for given in document["instances"]]
    return found


def _named(given: Plain) -> Plain:
    return {name: _in_si(value) for name, value in given.items()}


def _instance(given: Plain) -> Plain:
    inline = {"definition": _declaring(given["definition"])} if given.get("definition") else {}
    bound = {"parameters": _named(given["parameters"])} if "parameters" in given else {}
    return {name: _in_si(value) for name, value in given.items() if name not in ("definition", *bound)} | bound | inline


def _in_si(given: Any) -> Any:
    """What was given, with numbers in place of values with units."""
    if isinstance(given, Mapping):
        if set(given) == {"value", "unit"}:
            return read_unit(given["unit"]).in_si(given["value"])
        return {name: _in_si(value) for name, value in given.items()}
    return [_in_si(value) for value in given] if isinstance(given, (list, tuple)) else given


def defaults_of(definition: Plain, prefix: str = "") -> dict[str, Any]:
    """The default values of parameters as balls; ``prefix``: of their names."""
    given = {name: parameter.get("value") for name, parameter in definition.get("parameters", {}).items()}
    return {f"{prefix}{name}": ball(value, precision=1100) for name, value in given.items() if value is not None}
