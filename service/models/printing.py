"""Formulas as text: which outputs a quantity has, and the formats."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Any

import orjson

from service.messages.refusals import not_found
from service.models.binding import Parameters, bound, bound_names
from service.models.exporting import NAME
from service.models.formulas import OF_PARTS, QUANTITIES, check_options
from service.models.formulas.entry import Made, Options
from service.models.numbers import OFFERED
from service.models.source import Source
from substructures.analysis.identification.base_parameters import BaseParameters
from substructures.analysis.identification.told import base_symbols
from substructures.certificate.agreement import not_judged_warnings
from substructures.errors import InvalidInput, TooLarge, meant
from substructures.export import Interface, render
from substructures.expr.program import Program
from substructures.printers import entries
from substructures.printers.definitions import Definitions
from substructures.printers.render import LIMIT
from substructures.printers.symmetry import symmetry_rule
from substructures.quantities.numbers.result import plain_names
from substructures.quantities.numbers.workspace import momentum
from substructures.quantities.quantity import REACTIONS, TABLE, askable, needs_parts
from substructures.quantities.sources import Sources
from substructures.quantities.stored_outputs import require_stored
from substructures.tree.glossary import glossary
from substructures.tree.model import Model

JSON = "json"
CHRISTOFFEL, BASE = "christoffel", "base_parameters"
#: formats that have a title
DOCUMENTS = ("latex-document", "mathml")
#: formats that people read, and outputs that programs judge others by: D_k / |g_kk| and |g_kk|
TO_READ, JUDGES = ("text", "latex", "latex-document", "mathml"), ("pivots", "inertias")


@dataclass(frozen=True, slots=True)
class Style:
    """How formulas are printed: format, form (one of FORMS), text of ``bind=``, prefix of functions."""

    format: str
    form: str
    bind: str = ""
    name: str = NAME

    @property
    def identity(self) -> tuple[str, ...]:
        """What an ETag depends on beside the content."""
        return self.format, self.form, self.bind, self.name

    def of(self, what: str, quantity: str) -> Style:
        """Itself; a document that has no other name is entitled with whose quantity it is."""
        is_untitled = self.format in DOCUMENTS and self.name == NAME
        return replace(self, name=f"{quantity} of {what}") if is_untitled else self


def check_quantity(model: Model, quantity: str) -> None:
    """Raise Refused 404 unless the model has the quantity, InvalidDocument for what a large one does not store."""
    known = askable(model.program.outputs)
    if quantity in known:
        return
    if quantity == CHRISTOFFEL:  # of a large model, which says why
        require_stored(model.program, [quantity])
    if quantity in OFFERED:
        raise not_found(f"'{quantity}' are numbers, not formulas: POST a request to this path", "unknown-quantity")
    names = list(dict.fromkeys([*known, *QUANTITIES]))
    there = meant(quantity, [*names, *OFFERED]) or f"; there are {', '.join(names)}"
    raise not_found(f"there is no quantity '{quantity[:80]}'{there}", "unknown-quantity")


def has_parts(quantity: str) -> bool:
    """Whether a quantity, also one that follows from a model, needs the parts of the tree."""
    return needs_parts(quantity) or quantity in OF_PARTS


def options_of_quantity(quantity: str) -> tuple[str, ...]:
    """The options that a quantity of a model has."""
    return TABLE[quantity].options if quantity in TABLE else ()


def with_options(sources: Sources, quantity: str, options: Options) -> Sources:
    """The sources for a quantity with its options. Raises InvalidDocument (pointers into the query)."""
    check_options(quantity, options, options_of_quantity(quantity))
    if not options.get("joints"):
        return sources
    found = replace(sources, joints=tuple(options["joints"]))
    try:
        found.of(REACTIONS)
    except InvalidInput as error:
        raise error.moved(lambda pointer: f"/query{pointer}") from None
    return found


def described(sources: Sources, quantity: str) -> tuple[dict[str, Any], Parameters]:
    """What is said beside the formulas of a quantity, and the parameters that may be bound in them."""
    row, told = TABLE.get(quantity), dict[str, Any]()
    if row is None:
        return told, sources.model.parameters
    if needs_parts(quantity):
        told = {axis: plain_names(names) for axis, names in sources.labels([quantity]).items()}
    told |= {"momenta": [momentum(name) for name in sources.model.coordinates]} if row.of_momenta else {}
    told |= {name: text for name, text in (("symmetry_rule", row.rule), ("note", row.note)) if text}
    return told, sources.parameters([quantity])


def with_numbers(program: Program, parameters: Parameters, inputs: Parameters, style: Style) -> Program:
    """Formulas with the numbers of ``bind=``; ``defaults`` are those of inputs, too, but in code, whose arguments are
    complete. Raises as :func:`bound`.
    """
    return bound(program, parameters, style.bind, inputs if style.format in (*TO_READ, JSON) else None)


def names_of_steps(
    style: Style, parameters: Parameters, inputs: Parameters, make: Callable[[], Program]
) -> Program | None:
    """What steps of a derivation are called, with the same numbers; None where there are no steps that people read."""
    if style.format not in TO_READ or style.form not in ("readable", "compact"):
        return None
    return with_numbers(make(), parameters, inputs, style)


def text_of(
    program: Program,
    style: Style,
    quantity: str,
    interface: Interface,
    members: Mapping[str, Any] | None = None,
    limit: int = LIMIT,
    definitions: Definitions | None = None,
    glossary: Program | None = None,
) -> str:
    """The program in the format chosen; ``interface``: of what it was made for; ``members`` are put before it in JSON;
    ``definitions``: of symbols that stand for formulas, ``glossary``: of steps of derivations, both for people.

    Raises TooLarge for more than ``limit`` nodes, InvalidArgument for a bad name of a function."""
    if style.format in TO_READ:
        program = program.select([name for name in program.outputs if name not in JUDGES] or list(program.outputs))
    warnings = not_judged_warnings([quantity] if program.not_judged else [])
    members = {**(members or {}), **({"warnings": warnings} if warnings else {})}
    text = _rendered(program, style, quantity, interface, limit, definitions, glossary, warnings)
    if style.format == JSON and CHRISTOFFEL in program.outputs:
        text = _with_entries(text, program, style, interface.vectors["q"].names)
    if style.format == "text" and "note" in members:
        return f"{text.rstrip()}\n{members['note']}\n"
    return _joined(members, text) if style.format == JSON and members else text


def _rendered(
    program: Program,
    style: Style,
    quantity: str,
    interface: Interface,
    limit: int,
    definitions: Definitions | None = None,
    glossary: Program | None = None,
    warnings: Sequence[Mapping[str, str]] = (),
) -> str:
    """The program, as a function of what was not bound where it is code."""
    left = interface.bound(bound_names(interface.vectors["p"].with_default, style.bind))
    try:
        more = definitions, glossary, warnings
        return render(program, style.format, style.form, style.name, limit, left, quantity, *more)
    except InvalidInput as error:
        raise error.moved(lambda pointer: f"/query{pointer}") from None


def source_glossary(source: Source, style: Style, parameters: Parameters) -> Program | None:
    """What steps of derivations from a tree are called; None where its parts are not there, and as above."""
    model, parts = source.model, source.parts
    if parts is None:
        return None
    return names_of_steps(style, parameters, model.inputs, lambda: glossary(*parts(), model=model.program))


def made_text(
    found: Made, quantity: str, interface: Interface, source: Source, style: Style, limit: int = LIMIT
) -> str:
    """A quantity that follows from a model in the format chosen, with its description in JSON, that of first integrals
    in text, and base parameters as symbols for people. Raises as :func:`bound`, and TooLarge."""
    model = source.model
    if isinstance(found.value, BaseParameters) and quantity == BASE and style.format in TO_READ:
        return _base_text(found.value, interface, model, style, limit)
    members = dict(found.members)
    warnings = [*members.get("warnings", ()), *not_judged_warnings([quantity] if found.program.not_judged else [])]
    if warnings:
        members["warnings"] = warnings
    program = with_numbers(found.program, model.parameters, model.inputs, style)
    named = source_glossary(source, style, model.parameters)
    text = _rendered(program, style, quantity, interface, limit, glossary=named, warnings=warnings)
    if style.format == JSON and members:
        return _joined(members, text)
    if style.format != "text":
        return text
    return "\n".join([text.rstrip("\n"), *_notes(found.members), ""])


def _base_text(base: BaseParameters, interface: Interface, model: Model, style: Style, limit: int) -> str:
    """Every base parameter with its formula and what was grouped into it."""
    symbols, called, notes = base_symbols(base)
    definitions = Definitions(with_numbers(symbols, model.parameters, model.inputs, style), notes)
    return _rendered(Program(called, (), {}), style, BASE, interface, limit, definitions)


def _notes(members: Mapping[str, Any]) -> Iterator[str]:
    """What is said for people about first integrals."""
    for each in members.get("integrals", ()):
        yield f"{each['name']} in {each['unit']}, {each['rule']}: {each['reason']}"


def _with_entries(text: str, program: Program, style: Style, coordinates: Sequence[str]) -> str:
    """The JSON program with the sparse list of Christoffel symbols; formulas too long to stand alone are null."""
    try:
        listed = entries(program, CHRISTOFFEL, "text", style.form)
    except TooLarge:
        listed = [{"index": list(index), "formula": None} for index in program.outputs[CHRISTOFFEL].index]
    members = {
        "coordinates": list(coordinates),
        "symmetry_rule": symmetry_rule(program.outputs[CHRISTOFFEL].symmetry, "Gamma"),
        "indices_from": 0,
        "entries": [dict(zip("abc", e["index"], strict=True)) | {"formula": e["formula"]} for e in listed],
    }
    return _joined(members, text)


def _joined(members: Mapping[str, Any], text: str) -> str:
    """A JSON object with further members before those of another one."""
    return orjson.dumps(members).decode()[:-1] + "," + text[1:]
