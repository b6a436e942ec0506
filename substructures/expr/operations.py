"""The parts of a program (operations, symbols, outputs), and the checks they must pass when a stored one is read."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from math import prod
from typing import Any

from substructures.errors import InvalidProgram
from substructures.expr.construction.exact import MAX_BITS, MAX_EXPONENT
from substructures.expr.garbage import without_collections

FORMAT = "substructures.program"
VERSION = 1

#: number of operands of every operation that has operands (``powi`` has one, and an integer exponent)
ARITY = {
    **dict.fromkeys(("add", "sub", "mul", "div", "atan2"), 2),
    **dict.fromkeys(("neg", "sin", "cos", "tan", "asin", "acos", "atan", "exp", "log", "sqrt", "abs", "sign"), 1),
}
#: sums, products and quotients: most of what a program consists of
BINARY = ("add", "sub", "mul", "div")
#: all of them by name
NAMES = {name: name for name in (*ARITY, "powi", "int", "rat", "sym")}
#: operations that count in the literature
ARITHMETIC = ("add", "sub", "mul", "div", "powi")
#: kinds of symbols that are the same in all states
CONSTANT = ("parameter", "inertia")
KINDS = ("coordinate", "velocity", "acceleration", "parameter", "inertia", "input", "time")
SYMMETRIES = ("none", "symmetric", "christoffel", "connection")
#: elements that one output may have
MAX_ELEMENTS = 10_000_000

Operation = tuple[Any, ...]


@dataclass(frozen=True, slots=True)
class Symbol:
    """A named input: kind (one of KINDS) and unit (SI, as text)."""

    name: str
    kind: str
    unit: str = ""


@dataclass(frozen=True, slots=True)
class Output:
    """A named array of formulas: ``entries[i]`` is the operation that computes the element at ``index[i]``.

    All other elements follow from the symmetry or are zero:
    ``symmetric``: x[a, b] = x[b, a];
    ``christoffel``: entries have a < c, b <= c on a path; x[a, b, c] = x[a, c, b]; x[c, b, a] = -x[a, b, c] for b <= a.
    ``connection``: Christoffel symbols where coordinates depend on each other; entries have b <= c; x[a, b, c] =
    x[a, c, b].
    """

    shape: tuple[int, ...]
    index: tuple[tuple[int, ...], ...]
    entries: tuple[int, ...]
    symmetry: str = "none"

    def expanded(self) -> Iterable[tuple[tuple[int, ...], int, int]]:
        """(index, entry, sign) of every non-zero element, dependent ones included."""
        for index, entry in zip(self.index, self.entries, strict=True):
            for image, sign in images(index, self.symmetry):
                yield image, entry, sign


def images(index: tuple[int, ...], symmetry: str) -> Sequence[tuple[tuple[int, ...], int]]:
    """(index, sign) of every element that an independent one determines by a symmetry, itself first."""
    if symmetry == "symmetric":
        a, b = index
        return ((index, 1), ((b, a), 1)) if a != b else ((index, 1),)
    if symmetry not in ("christoffel", "connection"):
        return ((index, 1),)
    a, b, c = index
    if symmetry == "connection":
        return ((index, 1), ((a, c, b), 1)) if b != c else ((index, 1),)
    found = [(index, 1)]
    if b != c:
        found.append(((a, c, b), 1))
    if b <= a:
        found.append(((c, b, a), -1))
        if a != b:
            found.append(((c, a, b), -1))
    return found


def flat(index: Sequence[int], shape: Sequence[int]) -> int:
    """Position in row-major order."""
    result = 0
    for i, size in zip(index, shape, strict=True):
        result = result * size + i
    return result


def operands(operation: Operation) -> tuple[int, ...]:
    """The entries an operation refers to."""
    op = operation[0]
    if op in ARITY:
        return operation[1:]
    return operation[1:2] if op == "powi" else ()


@without_collections
def read_parts(document: Any) -> tuple[tuple[Symbol, ...], tuple[Operation, ...], dict[str, Output]]:
    """Symbols, operations and outputs of a JSON document. Raises InvalidProgram."""
    if not isinstance(document, dict) or document.get("format") != FORMAT:
        raise InvalidProgram(f"format is not '{FORMAT}'")
    version = document.get("version")
    if not _is_index(version) or version != VERSION:
        raise InvalidProgram(f"version {str(version)[:40]!r} is unknown; this reader knows {VERSION}")
    try:
        symbols = tuple(_read_symbol(s) for s in document["symbols"])
        # what is no list of an operation and more is refused by _check, at its position
        operations = tuple([_named(op) if isinstance(op, list) else () for op in document["operations"]])
        outputs = {n: _read_output(n, o, len(operations)) for n, o in document["outputs"].items()}
    except KeyError as error:
        raise InvalidProgram(f"{error} is missing") from None
    except (TypeError, AttributeError, ValueError) as error:
        raise InvalidProgram(f"malformed: {error}") from None
    if len({s.name for s in symbols}) != len(symbols):
        raise InvalidProgram("a symbol occurs twice")
    for i, operation in enumerate(operations):
        if len(operation) == 3 and operation[0] in BINARY:  # nearly all of them, without another call
            _, a, b = operation
            if type(a) is int and type(b) is int and 0 <= a < i and 0 <= b < i:
                continue
        _check(i, operation, len(symbols))
    return symbols, operations, outputs


def _named(document: list[Any]) -> Operation:
    """Its name is the one that all operations of this name have, which every walk compares by identity first."""
    if document and type(document[0]) is str:
        document[0] = NAMES.get(document[0], document[0])
    return tuple(document)


def _read_symbol(document: Any) -> Symbol:
    if isinstance(document, dict) and {"name", "kind"} <= document.keys() <= {"name", "kind", "unit"}:
        symbol = Symbol(**document)
        if symbol.kind in KINDS and isinstance(symbol.name, str) and isinstance(symbol.unit, str):
            return symbol
    raise ValueError(f"symbol {str(document)[:80]}: it has a name, a unit and one of the kinds {', '.join(KINDS)}")


def _read_output(name: str, document: Any, size: int) -> Output:
    if set(document) != {"shape", "symmetry", "index", "entries"}:
        raise ValueError(f"output {name[:80]!r}: shape, symmetry, index and entries are needed, nothing else")
    shape, entries, symmetry = tuple(document["shape"]), tuple(document["entries"]), document["symmetry"]
    output = Output(shape, tuple(tuple(i) for i in document["index"]), entries, symmetry)
    if not all(_is_index(n) for n in shape) or prod(shape) > MAX_ELEMENTS:
        raise ValueError(f"output {name[:80]!r}: shape {str(shape)[:80]}")
    if symmetry not in SYMMETRIES or len(output.index) != len(entries) or not _fits(symmetry, shape):
        raise ValueError(f"output {name[:80]!r}: symmetry or number of entries")
    if entries and not _are_in_range(entries, size):
        raise ValueError(f"output {name[:80]!r}: entry outside of the program")
    _check_elements(name, output)
    return output


def _fits(symmetry: str, shape: tuple[int, ...]) -> bool:
    rank = {"symmetric": 2, "christoffel": 3, "connection": 3}.get(symmetry)
    return rank is None or (len(shape) == rank and len(set(shape)) == 1)


def _check_elements(name: str, output: Output) -> None:
    """Every element is inside of the shape and determined once."""
    rank = len(output.shape)
    axes = list(zip(*output.index, strict=True)) if all(len(i) == rank for i in output.index) else None
    if axes is None or not all(map(_are_in_range, axes, output.shape)):
        wrong = next(i for i in output.index if len(i) != rank or not all(map(_in_range, i, output.shape)))
        raise ValueError(f"output {name[:80]!r}: index {str(wrong)[:80]} outside of shape {output.shape}")
    elements = [i for i, _, _ in output.expanded()]
    if len(set(elements)) < len(elements):
        twice = next(i for i, count in Counter(elements).items() if count > 1)
        raise ValueError(f"output {name[:80]!r}: element {twice} is given twice")


def _check(i: int, operation: Operation, symbols: int) -> None:
    op = operation[0] if operation and isinstance(operation[0], str) else None
    if op in ARITY or op == "powi":
        _check_operands(i, op, operation)
    elif op in ("int", "rat"):
        _check_number(i, operation)
    elif op == "sym":
        if len(operation) != 2 or not _in_range(operation[1], symbols):
            raise InvalidProgram("unknown symbol", i)
    else:
        raise InvalidProgram(f"unknown operation {str(op)[:80]!r}", i)


def _check_number(i: int, operation: Operation) -> None:
    op, *numbers = operation
    if len(numbers) != (1 if op == "int" else 2) or not all(_is_integer(n) for n in numbers):
        raise InvalidProgram(f"bad number {str(operation)[:80]}", i)
    if op == "rat" and int(numbers[1]) <= 0:
        raise InvalidProgram("denominator is not positive", i)


def _check_operands(i: int, op: str, operation: Operation) -> None:
    arity = ARITY.get(op, 1)
    if len(operation) != 1 + arity + (op == "powi"):
        raise InvalidProgram(f"'{op}' has {len(operation) - 1} operands", i)
    for x in operation[1 : 1 + arity]:
        if type(x) is not int or not 0 <= x < i:
            raise InvalidProgram("an operand does not refer to an earlier entry", i)
    if op == "powi" and not (_is_index(operation[2], signed=True) and abs(operation[2]) <= MAX_EXPONENT):
        raise InvalidProgram(f"exponent beyond {MAX_EXPONENT}", i)


def _are_in_range(numbers: Sequence[Any], n: int) -> bool:
    return set(map(type, numbers)) <= {int} and all(0 <= x < n for x in (min(numbers), max(numbers)))


def _in_range(x: Any, n: int) -> bool:
    return type(x) is int and 0 <= x < n


def _is_index(x: Any, signed: bool = False) -> bool:
    return isinstance(x, int) and not isinstance(x, bool) and (signed or x >= 0)


def _is_integer(text: Any) -> bool:
    if not isinstance(text, str) or len(text) > MAX_BITS // 3:
        return False
    digits = text[1:] if text.startswith("-") else text
    return digits.isascii() and digits.isdigit() and (digits == "0" or digits[0] != "0") and text != "-0"
