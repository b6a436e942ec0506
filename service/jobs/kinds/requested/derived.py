"""What evaluations need of a stored tree beside its model, derived and certified by runners: the programs of derived
quantities, and what is formed from the parts, with the names of its rows.

An item is that of a tree with its parts, and names the ``source`` (:mod:`substructures.quantities.quantity`).
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import fields
from typing import Any, get_type_hints

from service.content.integrity import reading
from service.jobs.engines.engine import Outcome
from service.jobs.kinds.kind import Blobs
from service.jobs.kinds.trees import sources_of
from service.schemas.jobs import ItemDocument
from substructures.expr.program import Program
from substructures.quantities.formulas import derived
from substructures.quantities.quantity import OF_PARTS, PROGRAMS
from substructures.tree.cuts import ClosureRows

CLOSURES = "closures"
PROGRAM = "program"


def derived_of(item: ItemDocument, blobs: Blobs) -> Outcome:
    """A program, or the fields of what is formed from parts: programs as files, their ``not_judged`` outputs and all
    else in the summary. Raises TooLarge, InvalidDocument."""
    sources, source = sources_of(item, blobs), item["source"]
    if source not in OF_PARTS:
        return _told({PROGRAM: derived(sources.model, source, item["nodes"])})
    found = sources.of(source)
    return _told({field.name: getattr(found, field.name) for field in fields(found)})


def _told(values: Mapping[str, Any]) -> Outcome:
    programs = {name: value for name, value in values.items() if isinstance(value, Program)}
    plain = {name: value for name, value in values.items() if name not in programs}
    if CLOSURES in plain:
        plain[CLOSURES] = [rows.plain() for rows in plain[CLOSURES]]
    marks = {name: sorted(program.not_judged) for name, program in programs.items()}
    return Outcome({"not_judged": marks, **plain}, {name: found.to_bytes() for name, found in programs.items()})


def read_derived(source: str, outcome: Outcome) -> Any:
    """What a runner has derived: a program, or what its function forms from parts. Raises Refused for damage."""
    told, marks = dict(outcome.summary), outcome.summary["not_judged"]
    with reading("a derived program", source):
        for name, content in outcome.files.items():
            told[name] = Program.from_bytes(content).marked(marks[name])
    if source not in OF_PARTS:
        return told[PROGRAM]
    if CLOSURES in told:
        told[CLOSURES] = [ClosureRows.read(plain) for plain in told[CLOSURES]]
    kind = get_type_hints(PROGRAMS[source].function)["return"]
    values = {field.name: told[field.name] for field in fields(kind)}
    return kind(**{name: tuple(value) if isinstance(value, list) else value for name, value in values.items()})


REQUESTED = {"derived": derived_of}
