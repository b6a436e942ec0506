"""Formulas of parts and models for people and programs: select, bind, print."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from itertools import product

import orjson

from service.messages.refusals import unprocessable
from service.queries.searching.formulas import FormulaRow
from substructures.expr.program import Output, Program
from substructures.part.part import INTERNAL, Part
from substructures.quantities.quantity import outputs_of


@dataclass(frozen=True, slots=True)
class Wanted:
    """Which formulas of a part: of a quantity all, or those of a body, a coordinate, a component.

    ``component`` is an index such as ``1`` or ``0,2``, counted from 0: into the vector or tensor that a formula is, or
    into the array whose elements are stored one by one (metric, christoffel).
    """

    quantity: str
    body: str | None = None
    coordinate: str | None = None
    component: str | None = None

    @property
    def is_whole(self) -> bool:
        """Whether all formulas of the quantity are wanted."""
        return self.body is self.coordinate is self.component is None


def part_formulas(part: Part, rows: Sequence[FormulaRow], wanted: Wanted, first: int) -> Program | None:
    """The program of the stored formulas ``rows`` that were wanted; of those that vanish, which are not stored, zeros.

    ``first``: what indices in the names of single formulas count from. None for what the part does not have. Raises
    Refused 422 for a component that there is not.
    """
    names = [name for name in part.program.outputs if name not in INTERNAL]
    names = [name for name in names if {name, name.partition(".")[0]} & set(outputs_of(wanted.quantity))]
    if wanted.is_whole:
        return part.program.select(names) if names else None
    return _entries(part.program, rows, wanted.component, first) if rows else _zeros(part, names, wanted, first)


def _entries(program: Program, rows: Sequence[FormulaRow], component: str | None, first: int) -> Program:
    """The program of stored formulas, or of one component of each. Raises Refused 422."""
    outputs: dict[str, Output] = {}
    operations, not_judged = list(program.operations), set[str]()

    def negated(entry: int) -> int:
        """The number of an operation that negates another."""
        operations.append(("neg", entry))
        return len(operations) - 1

    for row in rows:
        lead, shape = tuple(orjson.loads(row.entry)), tuple(orjson.loads(row.shape))
        whole = program.outputs[row.output]
        if component is not None:
            lead = lead + _component(component, shape) if shape else _component(component, whole.shape)
        outputs[called := _called(row.output, lead, first)] = _slice(whole, lead, negated)
        not_judged |= {called} if row.output in program.not_judged else set()
    return Program(program.symbols, tuple(operations), outputs, frozenset(not_judged)).select(list(outputs))


def _zeros(part: Part, names: Sequence[str], wanted: Wanted, first: int) -> Program | None:
    """Formulas that vanish, by the places that they would have."""
    outputs: dict[str, Output] = {}
    for name in names:
        shape, axes = part.program.outputs[name].shape, [a for a in part.axes_of(name) if part.labels(a)]
        places = [
            _places(part.labels(axis), wanted.coordinate if axis == "coordinate" else wanted.body) for axis in axes
        ]
        if (wanted.body and not {"joint", "mover", "port"} & set(axes)) or (
            wanted.coordinate and "coordinate" not in axes
        ):
            continue
        for lead in product(*places):
            rest = shape[len(lead) :]
            if wanted.component is None:
                outputs[_called(name, lead, first)] = Output(rest, (), ())
            else:
                single = len(part.axes_of(name)) == len(shape)  # elements are stored one by one
                index = _component(wanted.component, shape if single else rest)
                outputs[_called(name, index if single else lead + index, first)] = Output((), (), ())
    return Program((), (), outputs).marked(outputs if part.program.not_judged & set(names) else ()) if outputs else None


def _places(labels: Sequence[str], label: str | None) -> list[int]:
    return [i for i, each in enumerate(labels) if label in (None, each)]


def _called(output: str, lead: Sequence[int], first: int) -> str:
    return output + (f"[{','.join(str(i + first) for i in lead)}]" if lead else "")


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
