"""What the languages of functions have in common: arguments ``q[3]``, temporaries ``t1``, doubles, comments."""

from __future__ import annotations

import re
from abc import abstractmethod
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from fractions import Fraction
from typing import ClassVar

from substructures.export.exported import Exported, Function, identifier_of
from substructures.export.interface import MEANINGS, Vector
from substructures.export.languages.named import constants, described
from substructures.export.languages.words import IN_HEADERS, RESERVED
from substructures.export.packed import table
from substructures.export.reference import Reference
from substructures.expr.interpret import constant
from substructures.expr.program import Output
from substructures.printers.language import NEGATION, Language, Listing, Piece
from substructures.printers.meanings import Label
from substructures.printers.names import comment, identifier
from substructures.printers.symmetry import assignments, elements_rule

#: conditions under which functions are real, in terms of x
REAL = {"sqrt": "x >= 0", "log": "x >= 0", "asin": "abs(x) <= 1", "acos": "abs(x) <= 1"}
#: characters of a name that every compiler takes
LONGEST = 63
_TEMPORARY = re.compile(r"t\d+|work", re.ASCII)
_NUMBERED = re.compile(r"\bt\d+\b", re.ASCII)
_WORD = re.compile(r"[A-Za-z]\w*", re.ASCII)
_NUMBER = re.compile(r"[\d.]+(e[+-]?\d+)?", re.ASCII)
NOT_EXECUTED = "Not executed: the tests of the generator have no interpreter or compiler of this language."
YOURS = "This file is the output of a program and belongs to whoever had it made; it may be used for anything."


class Code(Language):
    """Writes one function; ``mark`` begins a comment line, NAME and ``stem`` and ``suffix`` are the name of a file,
    ``executed``: with what the tests run its files, empty where they do not."""

    width = 100
    powers = False
    mark = "#"
    suffix, stem = "", ""
    infinity = "inf"
    executed: ClassVar[str] = ""
    brackets: ClassVar[tuple[str, str]] = ("[", "]")
    #: whether formulas have the names of symbols, ``arm_m2``, which are declared as elements of the arguments
    has_names = False
    #: whether intermediate values that are quantities of mechanics may have their names, such as Theta_1zz
    has_steps = True

    def __init__(self, function: Function, exported: Exported) -> None:
        super().__init__(function.program)
        self.function, self.exported, self.called = function, exported, exported.called(function)
        self.variables = _variables(list(function.program.outputs))
        self.names = _names(function, self.variables) if self.has_names else {}
        taken = {*RESERVED, *IN_HEADERS, *(name.lower() for name in (*self.variables.values(), *self.names.values()))}
        self.steps = _steps(function.steps, taken) if self.has_steps else {}
        self._made: dict[int, int] = {}

    @abstractmethod
    def define(self, listing: Listing) -> list[str]:
        """The lines of the function."""

    @classmethod
    def file(cls, exported: Exported, functions: Iterable[list[str]], software: str) -> str:
        """A file with functions; the head says what it was made from."""
        lines = [*cls.commented(head(exported, cls.first, software, cls.executed)), "", *cls.constants(exported)]
        for each in functions:
            lines += [*each, ""]
        return "\n".join(lines)

    @classmethod
    def constant(cls, name: str, place: int) -> str:  # noqa: ARG003 -- for languages that have them
        """A constant that is the place of an element in its argument; none by default."""
        return ""

    @classmethod
    def opening(cls, exported: Exported) -> str:
        """What names of constants begin with: nothing where a file is a namespace."""
        return f"{exported.name}_"

    @classmethod
    def alike(cls, name: str) -> str:
        """What is equal for names that the language does not tell apart."""
        return name

    @classmethod
    def constants(cls, exported: Exported) -> list[str]:
        """Places of coordinates, inputs and parameters by name, with units and defaults."""
        lines = []
        for each in constants(exported, cls.alike):
            text = cls.constant(f"{cls.opening(exported)}{each.vector.upper()}_{each.name}", each.place + cls.first)
            lines += [f"{text} {cls.commented([each.told])[0]}"] if text else []
        return [*lines, ""] if lines else []

    @classmethod
    def commented(cls, lines: Iterable[str]) -> list[str]:
        """Lines as comments."""
        return [f"{cls.mark} {line}".rstrip() for line in lines]

    @classmethod
    def selftest(cls, exported: Exported, reference: Iterable[Reference]) -> dict[str, str]:  # noqa: ARG003 -- for languages that have one
        """Files of a program that compares with reference values, prints ``ok`` or what differs; none by default."""
        return {}

    def call_temporary(self, n: int, operation: int) -> Piece:
        """Temporary n by its number; its name comes last."""
        self._made[n] = operation
        return self.temporary(n)

    def with_steps(self, lines: Iterable[str]) -> list[str]:
        """Lines with the names of mechanics in place of ``t17`` where a value has one."""
        names = {f"t{n}": self.steps[i] for n, i in self._made.items() if i in self.steps}
        return (
            [_NUMBERED.sub(lambda found: names.get(found[0], found[0]), line) for line in lines] if names else [*lines]
        )

    def render(self, listing: Listing, name: str) -> str:  # noqa: ARG002 -- the function has its name already
        """The function alone."""
        return "\n".join(self.define(listing))

    def symbol(self, n: int) -> Piece:
        """Symbol n of the program by its name, or as the element of an argument that it is."""
        return Piece(self.names.get(n) or self.element(*self.function.places[n]))

    def named(self, texts: Iterable[str]) -> list[tuple[str, str]]:
        """(name, element of an argument) of the symbols that are named in texts, in their order there."""
        found = {word for text in texts for word in _WORD.findall(text)}
        places = {name: self.function.places[n] for n, name in self.names.items() if name in found}
        order = {v.symbol: k for k, v in enumerate(self.vectors())}
        names = sorted(places, key=lambda name: (order[places[name][0]], places[name][1]))
        return [(name, self.element(*places[name])) for name in names]

    def texts(self, listing: Listing) -> Iterator[str]:
        """All formulas of the function."""
        yield from (text for _, text in listing.temporaries)
        yield from (text for some in listing.entries.values() for text in some)

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
        return Piece(f"real_{plain.text}") if op in REAL and not _NUMBER.fullmatch(args[0].text) else plain

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
        given = identifier(plain, RESERVED | taken, "") or identifier(f"{plain}_out" if plain else "", taken, f"y{k}")
        found[name] = given
        taken.add(given.lower())
    return found


def _names(function: Function, variables: dict[str, str]) -> dict[int, str]:
    """Names of the symbols of a program by their numbers, where these are harmless and differ in more than capitals.

    ``arm.q1'`` is ``arm_q1_dot``; capitals are macros, and a letter with digits is a temporary or a Bessel function.
    """
    taken = {*RESERVED, *IN_HEADERS, *(each.lower() for each in variables.values())}
    found: dict[int, str] = {}
    for n, (symbol, (vector, _)) in enumerate(zip(function.program.symbols, function.places, strict=True)):
        primes = len(symbol.name) - len(symbol.name.rstrip("'"))
        plain = identifier_of(symbol.name.rstrip("'"))
        name = plain + ("", "_dot", "_ddot")[primes] if plain and primes < 3 else ""
        if vector == "t" or not name or len(name) > LONGEST or name.isupper() or _TEMPORARY.fullmatch(name):
            continue
        if name.lower() not in taken:
            found[n] = name
            taken.add(name.lower())
    return found


def _steps(given: Mapping[int, Label], taken: set[str]) -> dict[int, str]:
    """Names of operations that differ from all others in more than capitals."""
    found: dict[int, str] = {}
    for i, label in given.items():
        if label.text.lower() not in taken:
            found[i] = label.text
            taken.add(label.text.lower())
    return found


def head(
    exported: Exported,
    first: int,
    software: str,
    executed: str = "here",
    called: Callable[[Exported, Function], str] = Exported.called,
) -> list[str]:
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
        lines.append(f"  {called(exported, each)}({arguments}): {each.program.count()['total']} operations")
        lines += [f"    {line}" for line in _outputs(each, first)]
    lines.append(f"Arguments, indices from {first}:")
    for symbol in exported.symbols:
        lines += _elements(interface.vectors[symbol], first)
    lines += [f"  {line}" if k else line for k, line in enumerate(exported.legend)]
    for each in exported.functions:
        lines += _elements(each.further, first, f" of {called(exported, each)}")
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
    yield from (f"    {i + first}  {described(vector, i)}" for i in range(len(vector)))


def nested(array: Output, texts: Sequence[str], ends: tuple[str, str], zero: str) -> str:
    """All elements as nested lists."""
    rows: dict[tuple[int, ...], str] = {}
    formulas = dict(zip(array.entries, texts, strict=True))
    for index, entry, sign in array.expanded():
        rows[index] = formulas[entry] if sign > 0 else f"-({formulas[entry]})"

    def level(index: tuple[int, ...]) -> str:
        """What stands behind these leading indices."""
        if len(index) == len(array.shape):
            return rows.get(index, zero)
        inner = (level((*index, i)) for i in range(array.shape[len(index)]))
        return f"{ends[0]}{', '.join(inner)}{ends[1]}"

    return level(())


def indented(lines: Iterable[str], by: str = "    ") -> list[str]:
    """Lines with indentation."""
    return [by + line if line else line for line in lines]
