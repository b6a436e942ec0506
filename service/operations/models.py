"""Formulas of parts and models for people and programs: select, bind, print."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import orjson

from service.analyses.formulas import QUANTITIES
from service.answers import Answer
from service.negotiation import JSON, MEDIA_TYPES
from service.problems import not_found, unprocessable
from service.queries.content import FormulaRow
from substructures.derived import DERIVED
from substructures.errors import InvalidDocument, TooLarge
from substructures.evaluation import REGRESSOR, Sources
from substructures.expr.bind import bind
from substructures.expr.program import Output, Program
from substructures.model import Model
from substructures.printers import entries, render
from substructures.printers.symmetry import symmetry_rule
from substructures.regressor import OUTPUTS

#: quantities that consist of several outputs
GROUPS = {
    "kinematics": ("position", "rotation", "U", "Omega"),
    "momentum": ("linear_momentum", "angular_momentum"),
    "closures": ("closure.residual", "closure.jacobian", "closure.acceleration", "closure.direction"),
    "interface": ("f", "n", "K", "kappa", "F", "N", "composite"),
}
CHRISTOFFEL = "christoffel"


@dataclass(frozen=True, slots=True)
class Style:
    """How formulas are printed: format, form (compact or expanded) and the text of ``bind=``."""

    format: str
    form: str
    bind: str = ""

    @property
    def identity(self) -> tuple[str, ...]:
        """What an ETag depends on beside the content."""
        return self.format, self.form, self.bind


def quantities(name: str) -> tuple[str, ...]:
    """The quantities that a name stands for."""
    return GROUPS.get(name, (name,))


def check_quantity(model: Model, quantity: str) -> None:
    """Raise Refused 404 unless the model has the quantity."""
    if quantity in (*DERIVED, *OUTPUTS) or any(name in model.program.outputs for name in quantities(quantity)):
        return
    names = [*model.program.outputs, *DERIVED, *OUTPUTS, "kinematics", "momentum", *QUANTITIES]
    known = ", ".join(dict.fromkeys(names))
    raise not_found(f"there is no quantity '{quantity[:80]}'; there are {known}", "unknown-quantity")


def model_quantity(sources: Sources, quantity: str) -> Program:
    """The program of one quantity of a model. Raises TooLarge, InvalidDocument."""
    if quantity in DERIVED:
        return sources.program(quantity)
    if quantity in OUTPUTS:
        return sources.program(REGRESSOR).select([quantity])
    wanted, whole = quantities(quantity), sources.model.program
    return whole.select([name for name in whole.outputs if name in wanted])


def described(sources: Sources, quantity: str) -> tuple[dict[str, Any], Mapping[str, Any]]:
    """What is said beside the formulas of a quantity, and the parameters that may be bound in them."""
    if quantity not in OUTPUTS:
        return {}, sources.model.parameters
    found = sources.columns()
    return {"columns": {"names": found.names, "units": found.units}}, found.parameters


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


def bound(program: Program, parameters: Mapping[str, Mapping[str, Any]], text: str) -> Program:
    """The program with numbers in place of parameters; ``text`` is ``name:value,...`` and may contain ``defaults``.

    Raises Refused 422 naming the parameter.
    """
    values: dict[str, Any] = {}
    for item in filter(None, (item.strip() for item in text.split(","))):
        name, colon, value = item.partition(":")
        if item == "defaults":
            given = {n: p["value"] for n, p in parameters.items() if p.get("value") is not None}
            values = {**given, **values}
        elif not colon:
            raise unprocessable("bind", f"'{item[:80]}' is not name:value", "/query/bind")
        elif name not in parameters:
            raise unprocessable("unknown-parameter", f"there is no parameter '{name[:80]}'", "/query/bind")
        else:
            values[name] = value
    used = {symbol.name for symbol in program.symbols}
    chosen = {name: value for name, value in values.items() if name in used}
    if not chosen:
        return program
    try:
        return bind(program, chosen)
    except InvalidDocument as error:
        message = "; ".join(fault.message for fault in error.faults)
        raise unprocessable("bind", message, "/query/bind") from None


def printed(
    program: Program, style: Style, coordinates: Sequence[str] = (), members: Mapping[str, Any] | None = None
) -> Answer:
    """The program in the format chosen; ``members`` are put before it in JSON. Raises TooLarge."""
    text = render(program, style.format, style.form)
    if style.format == JSON and CHRISTOFFEL in program.outputs:
        text = _with_entries(text, program, style, coordinates)
    if style.format == JSON and members:
        text = joined(members, text)
    return Answer(200, text.encode(), {"Content-Type": MEDIA_TYPES[style.format]})


def _with_entries(text: str, program: Program, style: Style, coordinates: Sequence[str]) -> str:
    """The JSON program with the sparse list of Christoffel symbols; formulas too long to stand alone are null."""
    try:
        listed = entries(program, CHRISTOFFEL, "text", style.form)
    except TooLarge:
        listed = [{"index": list(index), "formula": None} for index in program.outputs[CHRISTOFFEL].index]
    members = {
        "coordinates": list(coordinates),
        "symmetry_rule": symmetry_rule(CHRISTOFFEL, "Gamma"),
        "entries": [dict(zip("abc", e["index"], strict=True)) | {"formula": e["formula"]} for e in listed],
    }
    return joined(members, text)


def joined(members: Mapping[str, Any], text: str) -> str:
    """A JSON object with further members before those of another one."""
    return orjson.dumps(members).decode()[:-1] + "," + text[1:]
