"""derive: an item is a definition, for which a request may be too short; its outcome is what is stored of the part."""

from __future__ import annotations

from collections.abc import Collection, Iterator
from functools import lru_cache
from typing import Any

from service.content.summaries import part_content
from service.jobs.engines.engine import Outcome
from service.jobs.kinds.kind import Blobs, ItemProgress, Kind, admitted, parted
from service.jobs.kinds.library import Library
from service.schemas.entries import PartEntry
from service.schemas.jobs import ItemDocument
from service.settings import Limits
from substructures.documents import read_json
from substructures.errors import Fault, InvalidDocument, TooLarge, meant
from substructures.expr.graph import Expr, Graph
from substructures.expr.parse import parse
from substructures.expr.steps import ExpressionError
from substructures.part.definition import Definition
from substructures.part.derive import derive
from substructures.part.topology import topology
from substructures.part.units import check_units

#: fields of bodies and ports that are no expressions in parameters, or none that deriving reads
TEXTS = ("name", "parent", "type", "coordinate", "velocities", "about", "body", "limits", "unit")


def _spread(item: ItemDocument, limits: Limits, _library: Library) -> list[ItemDocument]:
    entry, definition = parted(item, PartEntry)
    return [{"definition": definition, "nodes": limits.job_nodes, **entry}]


def resolve_definition(item: ItemDocument, _library: Library) -> tuple[ItemDocument, tuple[str, ...]]:
    """The item with its definition in canonical form; no blobs. Raises InvalidDocument."""
    definition = Definition.read(item["definition"])
    check_units(definition, topology(definition)).require()
    plain = read_json(definition.canonical())
    faults = [
        fault
        for place in ("bodies", "ports")
        for pointer, text in _expressions(plain.get(place), f"/{place}")
        for fault in _faults(text, pointer, definition.parameters)
    ]
    if faults:
        raise InvalidDocument(faults)
    return {**item, "definition": plain}, ()


def _expressions(given: Any, pointer: str) -> Iterator[tuple[str, str]]:
    """Place and text of every expression in bodies and ports."""
    if isinstance(given, str):
        yield pointer, given
    elif isinstance(given, dict | list):
        members = given.items() if isinstance(given, dict) else enumerate(given)
        for key, value in members:
            if key not in TEXTS:
                yield from _expressions(value, f"{pointer}/{key}")


def _faults(text: str, pointer: str, known: Collection[str]) -> Iterator[Fault]:
    try:
        unknown = sorted(_names(text).difference(known))
    except ExpressionError as error:
        yield Fault(pointer, "bad-expression", str(error))
    except (ArithmeticError, ValueError, TooLarge):
        return  # deriving tells
    else:
        if unknown:
            yield Fault(pointer, "unknown-name", f"unknown name '{unknown[0][:80]}'{meant(unknown[0], known)}")


@lru_cache(maxsize=10_000)
def _names(text: str) -> frozenset[str]:
    """The names in an expression. Raises ExpressionError, ArithmeticError, TooLarge."""
    graph, found = Graph(), set[str]()

    def lookup(name: str) -> Expr:
        """Any name is a symbol, and noted."""
        found.add(name)
        return graph.symbol(name)

    parse(graph, text, lookup)
    return frozenset(found)


def _run(item: ItemDocument, _blobs: Blobs, _progress: ItemProgress) -> Outcome:
    """Files ``program``, ``content``. Raises InvalidDocument, TooLarge."""
    part = derive(Definition.read(item["definition"]), item["nodes"], admitted(item))
    summary = {
        "name": part.name,
        "digest": part.definition.digest,
        "program": part.program.digest,
        "nodes": len(part.program),
        "dof": part.dof,
        "operations": part.operations["total"],
        "warnings": part.certificate["warnings"],
    }
    return Outcome(summary, part_content(part).files())


KINDS = {"derive": Kind(_spread, resolve_definition, _run)}
