"""One entry of a quantity for people: its formula and terms, as code, and as a module that a browser evaluates."""

from __future__ import annotations

from base64 import b64encode
from collections.abc import Mapping, Sequence
from dataclasses import replace
from typing import Any, NamedTuple

from service.messages.refusals import unprocessable
from service.models.exporting import NAME
from substructures.export import Exported, Interface, render
from substructures.export.exported import Function
from substructures.export.software import SOFTWARE
from substructures.export.webassembly.functions import webassembly
from substructures.export.webassembly.layout import layout
from substructures.expr.graph import Graph
from substructures.expr.operations import images
from substructures.expr.program import Formulas, Output, Program
from substructures.expr.program import program as collected
from substructures.expr.replay import replay
from substructures.printers.language import Language, Listing
from substructures.printers.listing import compact
from substructures.printers.mathml import MathML
from substructures.printers.render import readable
from substructures.printers.textbook import TextbookTerms
from substructures.textbook.forms import Sum, to_expr

#: lines of a formula on a page, and its characters of MathML
LINES, CHARACTERS = 40, 60_000
#: nodes of a formula that is printed
NODES = 20_000
LANGUAGES = ("latex", "python", "c", "matlab", "json", "text")
STEPS = "In steps, since the textbook form is too long for a page."
LONG = "The formula is too long for a page: take it as code, or as text from the interface."


class _Place(NamedTuple):
    """The independent entry that determines an element: its place, its operation, and the sign."""

    of: tuple[int, ...]
    entry: int
    sign: int


def entry(program: Program, quantity: str, index: tuple[int, ...], interface: Interface) -> dict[str, Any]:
    """An element of the first output of a quantity, as plain data.

    ``of`` is the independent element that it equals but for the ``sign``; of one that vanishes identically there is
    nothing more. Raises Refused 422 for an index that there is not, TooLarge.
    """
    name, output = next(iter(program.outputs.items()))
    if len(index) != len(output.shape) or any(i >= n for i, n in zip(index, output.shape, strict=True)):
        detail = f"index {','.join(map(str, index))[:40]} is none into shape {list(output.shape)}"
        raise unprocessable("component", detail, "/query/index")
    told: dict[str, Any] = {"quantity": quantity, "index": list(index)}
    place = _place(output, index)
    if place is None:
        return told | {"is_zero": True}
    alone = _alone(program, name, Output(output.shape, (place.of,), (place.entry,)))
    scalar = _alone(program, "_".join([name, *(str(i + 1) for i in place.of)]), Output((), ((),), (place.entry,)))
    told |= {"is_zero": False, "of": list(place.of), "sign": place.sign, "operations": alone.count()["total"]}
    told |= _formula(alone)
    terms = told.pop("split")
    told |= _module(scalar if terms is None else _split(scalar, alone, terms), quantity, interface)
    return told | {"texts": _texts(alone, scalar, quantity, interface)}


def _formula(alone: Program) -> dict[str, Any]:
    """``lines`` of MathML, none where they are too many for a page; ``terms`` of the textbook form, ``split``: these as
    they were read; ``remark``: why the form is what it is."""
    found = readable(lambda: MathML(alone), NODES, None)
    lines, terms = _lines(found.language, found.listing), found.terms
    if not _is_short(lines):
        language = MathML(alone)
        lines, terms = _lines(language, compact(alone, language, NODES)), None
        if not _is_short(lines):
            return {"lines": [], "terms": [], "split": None, "remark": LONG}
        return {"lines": lines, "terms": [], "split": None, "remark": STEPS}
    forms = () if terms is None else next(iter(terms.reading.outputs.values()))[0].terms
    texts = [terms.text(form) for form in forms] if terms else []
    return {"lines": lines, "terms": texts, "split": terms, "remark": found.reason}


def _lines(language: Language, listing: Listing) -> list[str]:
    if not isinstance(language, MathML):
        raise TypeError("MathML expected")
    return [line for line in language.formulas(listing) if "<math" in line]


def _is_short(lines: Sequence[str]) -> bool:
    return len(lines) <= LINES and sum(map(len, lines)) <= CHARACTERS


def _place(output: Output, index: tuple[int, ...]) -> _Place | None:
    for own, number in zip(output.index, output.entries, strict=True):
        for image, sign in images(own, output.symmetry):
            if image == index:
                return _Place(own, number, sign)
    return None


def _alone(program: Program, name: str, output: Output) -> Program:
    return replace(program, outputs={name: output}, not_judged=frozenset()).select([name])


def _split(scalar: Program, alone: Program, terms: TextbookTerms | None) -> Program:
    """The value, and ``terms``: the values of the terms of its textbook form."""
    if terms is None:
        return scalar
    graph = Graph()
    symbols = {symbol.name: symbol for symbol in alone.symbols}
    outputs: Mapping[str, Formulas] = replay(scalar, graph, {})
    (form,) = next(iter(terms.reading.outputs.values()))
    atoms = terms.reading.atoms_in(graph)
    each: dict[tuple[int, ...], Any] = {(k,): to_expr(Sum((term,)), graph, atoms) for k, term in enumerate(form.terms)}
    return collected(graph, {**outputs, "terms": Formulas((len(each),), each)}, symbols)


def _module(program: Program, quantity: str, interface: Interface) -> dict[str, Any]:
    """The program as WebAssembly, in base 64, and what stands where in its memory."""
    exported = Exported(NAME, interface, (Function(quantity, program, interface),))
    made = webassembly(exported)
    told = layout(exported, made, SOFTWARE)
    places = {s: {"at": v["at"], "length": v["length"]} for s, v in told["vectors"].items() if "at" in v}
    kept = {"pages": told["pages"], "vectors": places, "functions": told["functions"]}
    return {"module": b64encode(made.content).decode(), "layout": kept}


def _texts(alone: Program, scalar: Program, quantity: str, interface: Interface) -> dict[str, str]:
    """The formula to be copied; code is a function of the scalar."""
    formulas = ("latex", "text")
    return {
        language: render(alone, language, "readable", limit=NODES)
        if language in formulas
        else render(scalar, language, "compact", NAME, NODES, interface, quantity)
        for language in LANGUAGES
    }
