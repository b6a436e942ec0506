"""What leaves: functions of an interface under one name, from which all languages work."""

from __future__ import annotations

import re
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field
from functools import cached_property
from typing import Any

from substructures.certificate.agreement import not_judged_warnings
from substructures.errors import InvalidArgument, among
from substructures.export.contacts import ContactLaw
from substructures.export.interface import ORDER, PREPARE, WORK, Interface, Vector, has_time, signature
from substructures.export.packed import Indices, packed
from substructures.expr.graph import Graph
from substructures.expr.hoist import hoisted
from substructures.expr.program import Program, program
from substructures.expr.replay import replay
from substructures.part.outputs import with_own_inertia
from substructures.part.part import INTERNAL, Part
from substructures.printers.meanings import LETTERS, Label, meanings
from substructures.printers.meanings import OUTPUTS as LETTERS_OF_OUTPUTS
from substructures.printers.symmetry import symmetry_rule
from substructures.quantities.quantity import TABLE, askable, made_of, outputs_of
from substructures.quantities.sources import Sources
from substructures.quantities.stored_outputs import require_stored

ALL = "all"
#: operations of a program that names are looked for in
MOST_NAMED = 20_000
#: puts numbers into a program
Bind = Callable[[Program], Program]
_NAME = re.compile(r"[A-Za-z][A-Za-z0-9_]{0,31}", re.ASCII)
_WORDS = (
    "abs abstract add algorithm alias all allocatable allocate and any array as assert assign async await auto",
    "begin block bool boolean break by call case catch char class classdef close common complex const constexpr",
    "contains continue cos crate cycle data deallocate def default define del delete die diff dimension do double",
    "each elif else elseif elsewhere encapsulated end endif endfor endfunction enum equation eval except exit exp",
    "explicit export extends extern external false final finally flow fn for forall format friend from function",
    "generic global goto if impl implicit import in inline inner input inquire int integer intent interface",
    "intrinsic is lambda lcm let library list local logical long loop macro match math matrix mod module mut",
    "mutable namespace new nil none nonlocal not null nullify of off on only open operator optional or out outer",
    "output package parameter parfor partial pass persistent pi pointer print private procedure program protected",
    "pub public pure quote quit raise read real record recursive redeclare ref register repeat replaceable",
    "restrict result return save select self sequence short sign signed sin size sizeof sqrt static stop struct",
    "subroutine sum super switch symbolic tan target template test then this throw to trait true try type typedef",
    "typename uint union unless unsafe unsigned until use using value vector virtual void volatile when where",
    "while with within write xor yield numpy np sympy std core e i t q qd qdd u p x w",
)
#: names that functions cannot have
KEYWORDS = frozenset(word for line in _WORDS for word in line.split())


def check_name(name: str) -> str:
    """The prefix of functions. Raises InvalidArgument for what is no identifier, or a word of a target language."""
    if not _NAME.fullmatch(name):
        message = f"{name[:40]!r} is no identifier: a letter, then at most 31 letters, digits and _"
        raise InvalidArgument.at("/name", "bad-name", message)
    if name.lower() in KEYWORDS:
        message = f"'{name}' is a word of one of the target languages; take another, such as 'my_{name}'"
        raise InvalidArgument.at("/name", "reserved-name", message)
    return name


def identifier_of(text: str) -> str:
    """The text with _ for what an identifier cannot have, or an empty text."""
    found = re.sub(r"[.-]", "_", text)
    return found if _NAME.fullmatch(found) or re.fullmatch(r"[A-Za-z][A-Za-z0-9_]{0,63}", found, re.ASCII) else ""


@dataclass(frozen=True)
class Function:
    """A quantity as a function: its outputs are those of the program; ``packed``: what stands where in packed ones;
    ``glossary``: what intermediate values are called (:mod:`substructures.tree.glossary`)."""

    quantity: str
    program: Program
    interface: Interface
    packed: Indices = field(default_factory=dict, kw_only=True)
    glossary: Program | None = field(default=None, kw_only=True, repr=False)

    @cached_property
    def steps(self) -> Mapping[int, Label]:
        """Operations that are quantities of mechanics, but for the elements of its own outputs."""
        if self.glossary is None or len(self.program.operations) > MOST_NAMED:
            return {}
        found, outputs = meanings(self.program, self.glossary).items(), self.program.outputs
        return {i: x for i, x in found if not x.is_negative and LETTERS_OF_OUTPUTS.get(x.key) not in outputs}

    @cached_property
    def further(self) -> Vector:
        """Symbols of the program that stand in no vector of the interface."""
        known = self.interface.places
        some = [s for s in self.program.symbols if s.name not in known]
        return Vector("x", tuple(s.name for s in some), tuple(s.unit for s in some))

    @cached_property
    def arguments(self) -> tuple[str, ...]:
        """Symbols of the arguments: those of the quantity, ``x`` where it has further symbols."""
        found = {*signature(self.quantity), *self.interface.always, *(["x"] if self.further.names else [])}
        found |= {WORK} if WORK in self.interface.vectors and self.quantity != PREPARE else set()
        if not self.interface.has_time and not has_time(self.program.symbols):
            found.discard("t")
        return tuple(symbol for symbol in (*ORDER, WORK) if symbol in found)

    @cached_property
    def places(self) -> tuple[tuple[str, int], ...]:
        """(vector, position) of every symbol of the program."""
        known = {**self.interface.places, **{name: ("x", i) for name, i in self.further.place.items()}}
        return tuple(known[s.name] for s in self.program.symbols)

    def vector(self, symbol: str) -> Vector:
        """An argument."""
        return self.further if symbol == "x" else self.interface.vectors[symbol]

    def require_signature(self) -> None:
        """Raises InvalidArgument when the quantity depends on what its signature does not have."""
        for symbol, (vector, _) in zip(self.program.symbols, self.places, strict=True):
            if vector not in self.arguments:
                message = f"'{self.quantity}' depends on '{symbol.name[:80]}', which its arguments do not have"
                raise InvalidArgument.at("/quantities", "signature", message)

    def document(self, name: str) -> dict[str, Any]:
        """Plain data: the signature, and shapes of the outputs."""
        outputs: list[dict[str, Any]] = [
            {"name": n, "shape": list(o.shape), "symmetry": o.symmetry, "rule": symmetry_rule(o.symmetry, n)}
            for n, o in self.program.outputs.items()
        ]
        for each in outputs:
            if each["name"] in self.packed:
                each["packed"] = [list(index) for index in self.packed[each["name"]]]
        told: dict[str, Any] = {"name": name, "quantity": self.quantity, "arguments": list(self.arguments)}
        further = {"x": self.further.document()} if self.further.names else {}
        counted = {"operations": self.program.count()["total"], "digest": self.program.digest}
        return told | {"outputs": outputs} | further | counted


@dataclass(frozen=True)
class Exported:
    """Functions under one name. ``form``: compact or expanded; ``precision``: double or, in C, single; ``ranges``:
    lowest and highest values that the bound of its rounding is for; ``standard``: of C, c99 or c89; ``warnings``
    (pointer, code, message): what those who use them must know; ``contacts``: of the function CONTACTS.
    """

    name: str
    interface: Interface
    functions: tuple[Function, ...]
    form: str = "compact"
    precision: str = "double"
    standard: str = "c99"
    ranges: Mapping[str, tuple[float, float]] = field(default_factory=dict)
    warnings: tuple[Mapping[str, str], ...] = ()
    contacts: tuple[ContactLaw, ...] = ()

    @property
    def real(self) -> str:
        """The type of numbers in C."""
        return "float" if self.precision == "single" else "double"

    def called(self, function: Function) -> str:
        """The name of a function: the prefix, then its quantity."""
        suffix = identifier_of(function.quantity) or f"f{self.functions.index(function)}"
        return f"{self.name}_{suffix}"

    @property
    def legend(self) -> list[str]:
        """What the letters of intermediate values mean."""
        used = {label.key for each in self.functions for label in each.steps.values()}
        said = [f"{key.partition('.')[0]}: {text}" for key, text in LETTERS.items() if key in used]
        return ["Values within, of joints numbered from 1 in the order of the coordinates:", *said] if said else []

    @cached_property
    def symbols(self) -> tuple[str, ...]:
        """All arguments that some function has, but ``x``, which is another for each."""
        found = {symbol for each in self.functions for symbol in each.arguments}
        return tuple(symbol for symbol in (*ORDER, WORK) if symbol in found and symbol != "x")

    def document(self, software: str) -> dict[str, Any]:
        """The description of everything, as plain data: the target ``interface``."""
        work = [WORK] if WORK in self.interface.vectors else []
        return {
            "format": "substructures.interface",
            "version": 1,
            "name": self.name,
            "made_from": {"reference": self.interface.reference, "digest": self.interface.digest, "by": software},
            "order": "row-major, indices from 0",
            "call": {"name": f"{self.name}_call", "vectors": [*ORDER, *work]},
            "vectors": {
                symbol: self.interface.vectors[symbol].document() for symbol in (*ORDER, *work) if symbol != "x"
            },
            "frames": list(self.interface.frames),
            "functions": [each.document(self.called(each)) for each in self.functions],
            "warnings": [dict(warning) for warning in self.warnings],
        }


def exported_model(
    sources: Sources,
    interface: Interface,
    quantities: Sequence[str],
    name: str,
    bind: Any = None,
    together: bool = False,
    packed: bool = False,
    glossary: Program | None = None,
    others: Mapping[str, Callable[[], Program]] | None = None,
) -> Exported:
    """Quantities of a model as functions ``name_quantity``; ``bind``: what puts numbers into a program;
    ``together``: also ``name_all``, in which they share their subexpressions; ``packed``: of the metric and of the
    Christoffel symbols the independent elements alone (:mod:`substructures.formats.packing`); ``glossary``: what
    intermediate values are called (:mod:`substructures.tree.glossary`); ``others``: what makes the formulas of
    quantities that follow from the model by an analysis.

    Raises InvalidArgument for unknown quantities and bad names, TooLarge, InvalidDocument for what is not stored.
    """
    check_name(name)
    made = others or {}
    programs = {q: made[q]() if q in made else quantity_program(sources, q) for q in dict.fromkeys(quantities)}
    return _exported(programs, interface, name, bind, together, packed, glossary)


def exported_part(
    part: Part,
    interface: Interface,
    quantities: Sequence[str],
    name: str,
    bind: Bind | None = None,
    together: bool = False,
    packed: bool = False,
    glossary: Program | None = None,
) -> Exported:
    """Quantities of a part as it stands alone, nothing mounted on it. Arguments and errors as of exported_model."""
    check_name(name)
    known = [output for output in part.program.outputs if output not in INTERNAL]
    for quantity in quantities:
        if quantity not in known:
            message = f"there is no quantity '{quantity[:80]}'{among(quantity, known)}"
            raise InvalidArgument.at("/quantities", "unknown-quantity", message)
    programs = {q: with_own_inertia(part, part.program.select([q])) for q in dict.fromkeys(quantities)}
    return _exported(programs, interface, name, bind, together, packed, glossary)


def _exported(
    programs: Mapping[str, Program],
    interface: Interface,
    name: str,
    bind: Bind | None,
    together: bool,
    pack: bool,
    glossary: Program | None,
) -> Exported:
    if glossary is not None and bind is not None:
        glossary = bind(glossary)
    bound = {q: each if bind is None else bind(each) for q, each in programs.items()}
    made = {q: hoisted(each) for q, each in bound.items()}
    if together:
        made[ALL] = hoisted(joined(list(bound.values())))
    outputs = {q: packed(each) if pack else (each, {}) for q, each in made.items()}
    functions = tuple(
        Function(q, each, interface, packed=table, glossary=glossary) for q, (each, table) in outputs.items()
    )
    for each in functions:
        each.require_signature()
    warnings = not_judged_warnings(q for q, each in bound.items() if each.not_judged)
    return Exported(name, interface, functions, warnings=tuple(warnings))


def quantity_program(sources: Sources, quantity: str) -> Program:
    """The program of a quantity, with the outputs that belong to it alone. Raises InvalidArgument, TooLarge."""
    model, wanted = sources.model, list(outputs_of(quantity))
    if made_of(quantity) is not None:
        found = sources.program(TABLE[quantity].source)
        return found.select([name for name in found.outputs if name in wanted])
    if quantity == "christoffel":
        require_stored(model.program, wanted)
    if any(name not in model.program.outputs for name in wanted):
        message = f"there is no quantity '{quantity[:80]}'{among(quantity, askable(model.program.outputs))}"
        raise InvalidArgument.at("/quantities", "unknown-quantity", message)
    return model.program.select(wanted)


def joined(programs: Sequence[Program]) -> Program:
    """One program with the outputs of all, which share what they have in common. Raises InvalidArgument where two have
    an output of one name that is not the same."""
    graph = Graph()
    symbols = {s.name: s for each in programs for s in each.symbols}
    outputs: Mapping[str, Any] = {}
    for each in programs:
        found = replay(each, graph, {})
        for name in outputs.keys() & found.keys():
            if outputs[name].entries != found[name].entries:
                message = f"'{name[:80]}' is another array in each of two quantities: ask for these one by one"
                raise InvalidArgument.at("/together", "two-outputs", message)
        outputs = {**outputs, **found}
    return program(graph, outputs, symbols)
