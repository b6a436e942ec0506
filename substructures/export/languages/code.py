"""What the languages of functions have in common: arguments ``q[3]``, temporaries ``t1``, doubles, comments."""

from __future__ import annotations

from abc import abstractmethod
from collections.abc import Iterable, Iterator, Sequence
from fractions import Fraction
from math import isnan
from typing import ClassVar

from substructures.export.exported import Exported, Function, identifier_of
from substructures.export.interface import MEANINGS, Vector
from substructures.export.packed import table
from substructures.export.reference import Reference
from substructures.expr.interpret import constant
from substructures.expr.program import Output
from substructures.printers.language import NEGATION, Language, Listing, Piece
from substructures.printers.names import comment, identifier
from substructures.printers.symmetry import assignments, elements_rule

_WORDS = (
    "t q qd qdd u x p w work pi i j e d np math model sign auto break case char const continue default do double else",
    "enum extern float for goto if inline int long register restrict return short signed sizeof static struct",
    "switch typedef union unsigned void volatile while and as assert async await class def del elif except false",
    "finally from global import in is lambda none nonlocal not or pass raise true try with yield match type",
    "function end otherwise parfor persistent spmd classdef catch let local macro module quote using baremodule",
    "begin export abstract mutable primitive where outer nan inf zeros ones sin cos tan asin acos atan atan2 exp",
    "log sqrt abs fabs pow batch inputs outputs sign_of integer rational symbol mutabledensendimarray",
    "immutabledensendimarray main list len dict isinstance valueerror size_t real result program subroutine",
    "contains implicit intent use fn mut pub impl crate self super loop move ref trait unsafe dyn box final",
    "override typeof virtual block part output input array matrix vector table first last rest length nil numel",
    "error nargin limit limits",
)
_RESERVED = frozenset(word for line in _WORDS for word in line.split())
#: conditions under which functions are real, in terms of x
REAL = {"sqrt": "x >= 0", "log": "x >= 0", "asin": "abs(x) <= 1", "acos": "abs(x) <= 1"}
NOT_EXECUTED = "Not executed: the tests of the generator have no interpreter or compiler of this language."
YOURS = "This file is the output of a program and belongs to whoever had it made; it may be used for anything."


class Code(Language):
    """Writes one function; ``mark`` begins a comment line, ``suffix`` ends the name of a file, ``executed``: with what
    the tests run its files, empty where they do not."""

    width = 100
    powers = False
    mark = "#"
    suffix = ""
    infinity = "inf"
    executed: ClassVar[str] = ""
    brackets: ClassVar[tuple[str, str]] = ("[", "]")

    def __init__(self, function: Function, exported: Exported) -> None:
        super().__init__(function.program)
        self.function, self.exported, self.called = function, exported, exported.called(function)
        self.variables = _variables(list(function.program.outputs))

    @abstractmethod
    def define(self, listing: Listing) -> list[str]:
        """The lines of the function."""

    @classmethod
    def file(cls, exported: Exported, functions: Iterable[list[str]], software: str) -> str:
        """A file with functions; the head says what it was made from."""
        lines = [*cls.commented(head(exported, cls.first, software, cls.executed)), ""]
        for each in functions:
            lines += [*each, ""]
        return "\n".join(lines)

    @classmethod
    def commented(cls, lines: Iterable[str]) -> list[str]:
        """Lines as comments."""
        return [f"{cls.mark} {line}".rstrip() for line in lines]

    @classmethod
    def selftest(cls, exported: Exported, reference: Iterable[Reference]) -> dict[str, str]:  # noqa: ARG003 -- for languages that have one
        """Files of a program that compares with reference values, prints ``ok`` or what differs; none by default."""
        return {}

    def render(self, listing: Listing, name: str) -> str:  # noqa: ARG002 -- the function has its name already
        """The function alone."""
        return "\n".join(self.define(listing))

    def symbol(self, n: int) -> Piece:
        """The element of an argument that symbol n of the program is."""
        return Piece(self.element(*self.function.places[n]))

    def element(self, vector: str, n: int) -> str:
        """Element n, from 0, of an argument; the time is a number."""
        opening, closing = self.brackets
        return vector if vector == "t" else f"{vector}{opening}{n + self.first}{closing}"

    def number(self, value: Fraction) -> Piece:
        """The nearest double."""
        if value < 0:
            return Piece("-" + self.number(-value).text, NEGATION)
        double = constant(("rat", str(value.numerator), str(value.denominator)))
        return Piece(self.infinity if double == float("inf") else repr(double))

    def pairs(self, output: str, listing: Listing) -> list[tuple[str, str]]:
        """(element, formula) of every element of an output that is not zero."""
        array, v = self.program.outputs[output], self.variables[output]
        return list(assignments(array, listing.entries[output], lambda index: self.place(v, array, index)))

    def place(self, variable: str, array: Output, index: tuple[int, ...]) -> str:  # noqa: ARG002 -- for languages with flat arrays
        """An element of an output."""
        opening, closing = self.brackets
        return f"{variable}{opening}{', '.join(str(i + self.first) for i in index)}{closing}" if index else variable

    def partial(self) -> list[str]:
        """The functions that the program calls outside of constants, and that are not real everywhere."""
        ops = self.program.operations
        called = {op[0] for op in ops if op[0] in REAL and ops[op[1]][0] not in ("int", "rat")}
        return [name for name in REAL if name in called]

    def real_call(self, op: str, args: list[Piece]) -> Piece:
        """A function, with ``real_`` before its name where it is partial and the argument no constant."""
        plain = Language.call(self, op, args)
        return Piece(f"real_{plain.text}") if op in REAL and not args[0].text[0].isdigit() else plain

    def vectors(self) -> list[Vector]:
        """The arguments."""
        return [self.function.vector(symbol) for symbol in self.function.arguments]


def _variables(outputs: list[str]) -> dict[str, str]:
    """Variables of outputs: their own names where these are harmless and differ in more than capitals."""
    found: dict[str, str] = {}
    taken: set[str] = set()
    for k, name in enumerate(outputs):
        # capitals are macros, a letter with digits is a temporary or a Bessel function
        plain = identifier_of(name) if len(name) == 1 or not (name.isupper() or name[1:].isdigit()) else ""
        given = identifier(plain, _RESERVED | taken, "") or identifier(f"{plain}_out" if plain else "", taken, f"y{k}")
        found[name] = given
        taken.add(given.lower())
    return found


def head(exported: Exported, first: int, software: str, executed: str = "here") -> list[str]:
    """What a file says of itself: what it was made from, functions, and what stands where in their arguments."""
    interface = exported.interface
    lines = [f"{exported.name}: functions of a mechanism, made from formulas by {comment(software)}."]
    if interface.reference or interface.digest:
        reference = interface.reference.replace("@", " version ")
        lines.append(f"Made from {', '.join(comment(text) for text in (reference, interface.digest) if text)}.")
    lines.append(YOURS)
    if not executed:
        lines.append(NOT_EXECUTED)
    lines += [f"Warning: {comment(warning['message'])}." for warning in exported.warnings]
    lines.append("Functions:")
    for each in exported.functions:
        arguments = ", ".join(each.arguments)
        lines.append(f"  {exported.called(each)}({arguments}): {each.program.count()['total']} operations")
        lines += [f"    {line}" for line in _outputs(each, first)]
    lines.append(f"Arguments, indices from {first}:")
    for symbol in exported.symbols:
        lines += _elements(interface.vectors[symbol], first)
    for each in exported.functions:
        lines += _elements(each.further, first, f" of {exported.called(each)}")
    return lines


def _outputs(function: Function, first: int) -> Iterator[str]:
    variables = _variables(list(function.program.outputs))
    for output, array in function.program.outputs.items():
        shape = " x ".join(map(str, array.shape)) or "scalar"
        rule = f", indices from {first}; {elements_rule(array)}" if array.shape else ""
        indices = function.packed.get(output)
        if indices is None:
            yield f"{variables[output]}  {comment(output)}: {shape}{rule}"
        else:
            yield f"{variables[output]}  {comment(output)}: {shape}, packed: of the elements with these indices"
            yield from (f"  {line}" for line in table(indices, first))


def _elements(vector: Vector, first: int, of: str = "") -> Iterator[str]:
    if not vector.names:
        return
    length = "" if vector.symbol == "t" else f", {len(vector)}"
    yield f"  {vector.symbol}{of}: {MEANINGS[vector.symbol]}{length}"
    for i, (name, unit) in enumerate(zip(vector.names, vector.units, strict=True)):
        value = ""
        if vector.defaults:
            value = ", no default" if isnan(vector.defaults[i]) else f", default {vector.defaults[i]!r}"
        yield f"    {i + first}  {comment(name)} [{comment(unit)}]{value}"


def nested(array: Output, texts: Sequence[str], ends: tuple[str, str], zero: str) -> str:
    """All elements as nested lists."""
    rows: dict[tuple[int, ...], str] = {}
    formulas = dict(zip(array.entries, texts, strict=True))
    for index, entry, sign in array.expanded():
        rows[index] = formulas[entry] if sign > 0 else f"-({formulas[entry]})"

    def level(index: tuple[int, ...]) -> str:
        if len(index) == len(array.shape):
            return rows.get(index, zero)
        inner = (level((*index, i)) for i in range(array.shape[len(index)]))
        return f"{ends[0]}{', '.join(inner)}{ends[1]}"

    return level(())


def indented(lines: Iterable[str], by: str = "    ") -> list[str]:
    """Lines with indentation."""
    return [by + line if line else line for line in lines]
