"""Formulas of parts and models for people and programs: select, bind, print."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from typing import Any

import orjson

from service.analyses.printing import Style, bound, check_quantity, described, model_quantity, quantities, text_of
from service.answers import Answer
from service.negotiation import MEDIA_TYPES
from service.queries.content import FormulaRow
from service.refusals import unprocessable
from substructures.expr.program import Output, Program

__all__ = [
    "Style",
    "bound",
    "check_quantity",
    "described",
    "model_quantity",
    "part_entries",
    "part_quantity",
    "printed",
    "quantities",
]


def part_quantity(program: Program, rows: Sequence[FormulaRow]) -> Program:
    """The program of all outputs that the rows belong to."""
    return program.select(list(dict.fromkeys(row.output for row in rows)))


def part_entries(program: Program, rows: Sequence[FormulaRow], component: str | None) -> Program:
    """The program of stored formulas, or of one component of each.

    ``component`` is an index such as ``1`` or ``0,2``, counted from 0: into the vector or tensor that a formula is, or
    into the array whose elements are stored one by one (metric, christoffel). Raises Refused 422.
    """
    outputs: dict[str, Output] = {}
    operations = list(program.operations)

    def negated(entry: int) -> int:
        """The number of an operation that negates another."""
        operations.append(("neg", entry))
        return len(operations) - 1

    for row in rows:
        lead, shape = tuple(orjson.loads(row.entry)), tuple(orjson.loads(row.shape))
        whole = program.outputs[row.output]
        if component is not None:
            lead = lead + _component(component, shape) if shape else _component(component, whole.shape)
        name = row.output + (f"[{','.join(map(str, lead))}]" if lead else "")
        outputs[name] = _slice(whole, lead, negated)
    return Program(program.symbols, tuple(operations), outputs).select(list(outputs))


def _component(text: str, shape: tuple[int, ...]) -> tuple[int, ...]:
    fields = text.split(",")
    index = tuple(int(f) for f in fields if f.isascii() and f.isdigit() and len(f) < 6)
    if len(index) != len(fields) or len(index) != len(shape) or any(i >= n for i, n in zip(index, shape, strict=True)):
        detail = f"component '{text[:40]}' is no index into shape {list(shape)}; write for example 0 or 0,2"
        raise unprocessable("component", detail, "/query/component")
    return index


def _slice(whole: Output, lead: tuple[int, ...], negated: Callable[[int], int]) -> Output:
    """What remains of an output for one index of its leading axes, with all elements that follow from a symmetry."""
    if not lead:
        return whole
    kept = {
        index[len(lead) :]: entry if sign > 0 else negated(entry)
        for index, entry, sign in whole.expanded()
        if index[: len(lead)] == lead
    }
    return Output(whole.shape[len(lead) :], tuple(sorted(kept)), tuple(kept[index] for index in sorted(kept)))


def printed(
    program: Program, style: Style, coordinates: Sequence[str] = (), members: Mapping[str, Any] | None = None
) -> Answer:
    """The program in the format chosen; ``members`` are put before it in JSON. Raises TooLarge."""
    text = text_of(program, style, coordinates, members)
    return Answer(200, text.encode(), {"Content-Type": MEDIA_TYPES[style.format]})
