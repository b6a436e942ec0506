"""One quantity as text: formulas for people (:mod:`substructures.printers`), or a function in some language."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace
from math import prod

from substructures.display import shown
from substructures.errors import InvalidArgument, InvalidDocument, TooLarge, meant
from substructures.export.exported import Exported, Function, check_name
from substructures.export.interface import Interface
from substructures.export.languages.c import C
from substructures.export.languages.code import Code
from substructures.export.languages.cpp import Cpp
from substructures.export.languages.fortran import Fortran
from substructures.export.languages.fricas import Fricas
from substructures.export.languages.jax import Jax
from substructures.export.languages.julia import Julia
from substructures.export.languages.maple import Maple
from substructures.export.languages.mathematica import Mathematica
from substructures.export.languages.matlab import Matlab
from substructures.export.languages.maxima import Maxima
from substructures.export.languages.modelica import Modelica
from substructures.export.languages.python import Python
from substructures.export.languages.reduce import Reduce
from substructures.export.languages.rust import Rust
from substructures.export.languages.sympy import SymPy
from substructures.export.software import SOFTWARE
from substructures.expr.operations import MAX_ELEMENTS
from substructures.expr.program import Program
from substructures.printers.definitions import Definitions
from substructures.printers.listing import compact, expanded
from substructures.printers.render import FORMATS as WRITTEN
from substructures.printers.render import LIMIT, check_form, write
from substructures.printers.render import first_index as first_written
from substructures.printers.textbook import textbook
from substructures.quantities.quantity import made_of, outputs_of

_LISTINGS = {"expanded": expanded, "textbook": textbook}
#: by name in the contract
LANGUAGES: Mapping[str, type[Code]] = {
    "sympy": SymPy,
    "python": Python,
    "jax": Jax,
    "c": C,
    "cpp": Cpp,
    "fortran": Fortran,
    "rust": Rust,
    "matlab": Matlab,
    "julia": Julia,
    "maxima": Maxima,
    "reduce": Reduce,
    "maple": Maple,
    "fricas": Fricas,
    "mathematica": Mathematica,
    "modelica": Modelica,
}
#: media type of every format
FORMATS: Mapping[str, str] = {**WRITTEN, **{name: language.media for name, language in LANGUAGES.items()}}


def first_index(format: str) -> int:  # noqa: A002 -- the name in the contract
    """What indices count from in one of FORMATS: 1 where people or the language do, else 0."""
    return LANGUAGES[format].first if format in LANGUAGES else first_written(format)


def render(
    program: Program,
    format: str,  # noqa: A002 -- the name in the contract
    form: str = "compact",
    name: str = "model",
    limit: int = LIMIT,
    interface: Interface | None = None,
    quantity: str = "",
    definitions: Definitions | None = None,
    glossary: Program | None = None,
    warnings: Sequence[Mapping[str, str]] = (),
) -> str:
    """A program in one of FORMATS, ``form`` compact or expanded; notebooks show text and LaTeX as mathematics.

    In a language it is the function ``name_quantity`` on the calling convention of the ``interface`` that it needs
    (:func:`substructures.export.interface_of_model`); ``quantity``: default, its only output. ``definitions``: of
    symbols, ``glossary``: names of intermediate quantities, both for formats for people; ``warnings``
    (pointer, code, message): what readers must know, in formats for people and in comments of code.
    Raises as :func:`substructures.printers.render.write`, and InvalidArgument for a bad name, without an interface,
    and for a quantity that depends on what its signature does not have.

    >>> from substructures import couple, derive
    >>> tree = {"name": "clock", "instances": [{"name": "p", "substructure": "simple-pendulum"}]}
    >>> program = couple(tree, {"p": derive("simple-pendulum")}).program.select(["metric"])
    >>> print(render(program, "text", "expanded").splitlines()[-1])
    metric[1, 1] = l^2*m
    """
    if format not in FORMATS:
        message = f"{format[:40]!r} is not one of {', '.join(FORMATS)}{meant(format, FORMATS)}"
        raise InvalidDocument.at("/format", "unknown-format", message)
    if format not in LANGUAGES:
        notes = [f"Warning: {each['message']}" for each in warnings]
        text = write(program, format, form, name, limit, definitions, glossary, notes)
        return shown(text, format, lambda: write(program, "latex", form, name, limit, definitions, glossary, notes))
    if interface is None:
        message = "code needs the interface, which says what stands where in its arguments: interface_of_model(model)"
        raise InvalidArgument.at("/interface", "missing", message)
    function = _function(program, quantity, interface)
    exported = Exported(check_name(name), interface, (function,), form, warnings=tuple(warnings))
    return text_of(exported, LANGUAGES[format], limit)


def _function(program: Program, quantity: str, interface: Interface) -> Function:
    if made_of(quantity) is not None:  # without what tells whether it could be computed
        program = program.select([name for name in program.outputs if name in outputs_of(quantity)])
    function = Function(quantity or "_".join(program.outputs)[:64], program, interface)
    function.require_signature()
    return function


def text_of(exported: Exported, language: type[Code], limit: int) -> str:
    """All functions in one file. Raises TooLarge, ZeroDivisionError when there is no expanded form."""
    if not language.has_steps:
        exported = replace(exported, functions=tuple(replace(each, glossary=None) for each in exported.functions))
    return language.file(exported, definitions(exported, language, limit), SOFTWARE)


def definitions(exported: Exported, language: type[Code], limit: int) -> list[list[str]]:
    """The lines of every function. Raises as :func:`text_of`."""
    check_form(exported.form)
    listing = _LISTINGS.get(exported.form, compact)
    found = []
    for function in exported.functions:
        for output in function.program.outputs.values():
            if prod(output.shape) > MAX_ELEMENTS:
                raise TooLarge("an array (in elements)", prod(output.shape), MAX_ELEMENTS)
        code = language(function, exported)
        found.append(code.with_steps(code.define(listing(function.program, code, limit))))
    return found
