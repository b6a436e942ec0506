"""Formulas as text: which outputs a quantity has, and the formats."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Any

import orjson

from service.analyses.binding import Parameters, bound, bound_names
from service.analyses.formulas import OF_PARTS, QUANTITIES, Made, Options, check_options
from service.analyses.source import Source
from service.refusals import not_found
from substructures.analysis.identification.base_parameters import BaseParameters
from substructures.analysis.identification.told import base_symbols
from substructures.errors import InvalidInput, TooLarge, meant
from substructures.export import Interface, render
from substructures.expr.hoist import hoisted
from substructures.expr.operations import Symbol
from substructures.expr.program import Program
from substructures.printers import entries
from substructures.printers.definitions import Definitions
from substructures.printers.render import LIMIT
from substructures.printers.symmetry import symmetry_rule
from substructures.quantities.canonical import MOMENTA, momentum
from substructures.quantities.evaluation import POWERS, REACTIONS, REGRESSOR, Sources
from substructures.quantities.formulas import DERIVED
from substructures.quantities.regressor import OUTPUTS
from substructures.tree.glossary import glossary
from substructures.tree.model import Model, require_stored

JSON = "json"
#: prefix of functions where none is given
NAME = "model"
#: quantities that consist of several outputs
GROUPS = {
    "kinematics": ("position", "rotation", "U", "Omega"),
    "momentum": ("linear_momentum", "angular_momentum"),
    "closures": ("closure.residual", "closure.jacobian", "closure.acceleration", "closure.direction"),
    "interface": ("f", "n", "K", "kappa", "F", "N", "composite"),
}
CHRISTOFFEL, BASE = "christoffel", "base_parameters"
#: formats that have a title
DOCUMENTS = ("latex-document", "mathml")
#: formats that people read, and outputs that programs judge others by: D_k / |g_kk| and |g_kk|
TO_READ, JUDGES = ("text", "latex", "latex-document", "mathml"), ("pivots", "inertias")
#: of what has one beside g_ab = g_ba
SYMMETRY_RULES = {"christoffel_second_kind": "Gamma^a_bc = Gamma^a_cb"}


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


def quantities(name: str) -> tuple[str, ...]:
    """The quantities that a name stands for."""
    return GROUPS.get(name, (name,))


def check_quantity(model: Model, quantity: str) -> None:
    """Raise Refused 404 unless the model has the quantity, InvalidDocument for what a large one does not store."""
    if quantity in (*DERIVED, *OUTPUTS, REACTIONS, POWERS) or any(
        name in model.program.outputs for name in quantities(quantity)
    ):
        return
    if quantity == CHRISTOFFEL:  # of a large model, which says why
        require_stored(model.program, [quantity])
    names = [*model.program.outputs, *DERIVED, *OUTPUTS, REACTIONS, POWERS, "kinematics", "momentum", *QUANTITIES]
    known = ", ".join(dict.fromkeys(names))
    like = meant(quantity, names)
    raise not_found(f"there is no quantity '{quantity[:80]}'{like or f'; there are {known}'}", "unknown-quantity")


def needs_parts(quantity: str) -> bool:
    """Whether a quantity needs the parts of the tree, beside its formulas."""
    return quantity in (*OUTPUTS, REACTIONS, POWERS, *OF_PARTS)


def options_of_quantity(quantity: str) -> tuple[str, ...]:
    """The options that a quantity of a model has."""
    return ("joints",) if quantity == REACTIONS else ()


def with_options(sources: Sources, quantity: str, options: Options) -> Sources:
    """The sources for a quantity with its options. Raises InvalidDocument (pointers into the query)."""
    check_options(quantity, options, options_of_quantity(quantity))
    if not options.get("joints"):
        return sources
    found = replace(sources, joints=tuple(options["joints"]))
    try:
        found.transmitted()
    except InvalidInput as error:
        raise error.moved(lambda pointer: f"/query{pointer}") from None
    return found


def model_quantity(sources: Sources, quantity: str) -> Program:
    """The program of one quantity of a model. Raises TooLarge, InvalidDocument."""
    if quantity in DERIVED:
        return sources.program(quantity)
    if quantity in (REACTIONS, POWERS):
        return sources.program(quantity)
    if quantity in OUTPUTS:
        return sources.program(REGRESSOR).select([quantity])
    wanted, whole = quantities(quantity), sources.model.program
    return hoisted(whole.select([name for name in whole.outputs if name in wanted]))


def described(sources: Sources, quantity: str) -> tuple[dict[str, Any], Mapping[str, Any]]:
    """What is said beside the formulas of a quantity, and the parameters that may be bound in them."""
    if quantity == REACTIONS:
        return {"joints": sources.transmitted().rows}, sources.model.parameters
    if quantity == POWERS:
        return {"loads": sources.by_load().rows}, sources.model.parameters
    if quantity in MOMENTA:
        return {"momenta": [momentum(name) for name in sources.model.coordinates]}, sources.model.parameters
    if quantity in SYMMETRY_RULES:
        return {"symmetry_rule": SYMMETRY_RULES[quantity]}, sources.model.parameters
    if quantity not in OUTPUTS:
        return {}, sources.model.parameters
    found = sources.columns()
    return {"columns": {"names": found.names, "units": found.units}}, found.parameters


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
    text = _rendered(program, style, quantity, interface, limit, definitions, glossary)
    if style.format == JSON and CHRISTOFFEL in program.outputs:
        text = _with_entries(text, program, style, interface.vectors["q"].names)
    return _joined(members, text) if style.format == JSON and members else text


def _rendered(
    program: Program,
    style: Style,
    quantity: str,
    interface: Interface,
    limit: int,
    definitions: Definitions | None = None,
    glossary: Program | None = None,
) -> str:
    """The program, as a function of what was not bound where it is code."""
    left = interface.bound(bound_names(interface.vectors["p"].with_default, style.bind))
    try:
        return render(program, style.format, style.form, style.name, limit, left, quantity, definitions, glossary)
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
    program = with_numbers(found.program, model.parameters, model.inputs, style)
    named = source_glossary(source, style, model.parameters)
    text = _rendered(program, style, quantity, interface, limit, glossary=named)
    if style.format == JSON and found.members:
        return _joined(found.members, text)
    if style.format != "text":
        return text
    return "\n".join([text.rstrip("\n"), *_notes(found.members), ""])


def _base_text(base: BaseParameters, interface: Interface, model: Model, style: Style, limit: int) -> str:
    """Every base parameter with its formula and what was grouped into it."""
    symbols, notes = base_symbols(base)
    units = dict(zip(base.standard, base.units, strict=True))
    called = (
        Symbol(name, "base parameter", units[standard])
        for name, standard in zip(symbols.outputs, base.names, strict=True)
    )
    definitions = Definitions(with_numbers(symbols, model.parameters, model.inputs, style), notes)
    return _rendered(Program(tuple(called), (), {}), style, BASE, interface, limit, definitions)


def _notes(members: Mapping[str, Any]) -> Iterator[str]:
    """What is said for people about first integrals and quasi-velocities."""
    for warning in members.get("warnings", ()):
        yield f"Warning: {warning['message']}"
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
        "symmetry_rule": symmetry_rule(CHRISTOFFEL, "Gamma"),
        "indices_from": 0,
        "entries": [dict(zip("abc", e["index"], strict=True)) | {"formula": e["formula"]} for e in listed],
    }
    return _joined(members, text)


def _joined(members: Mapping[str, Any], text: str) -> str:
    """A JSON object with further members before those of another one."""
    return orjson.dumps(members).decode()[:-1] + "," + text[1:]
