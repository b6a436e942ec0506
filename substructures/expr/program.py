"""A formula as an immutable straight-line program: what is stored, sent, printed and compiled.

``operations`` is a list in which an operand refers only to earlier entries; ``outputs`` are named arrays with
shape, symmetry and the index of every independent, structurally non-zero entry. The canonical bytes are RFC 8785
JSON (sorted keys, no spaces, integers only), their SHA-256 is the identity of the program.
"""

from __future__ import annotations

import hashlib
import json
from collections import Counter
from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass, field
from fractions import Fraction
from functools import cached_property
from typing import Any

from substructures.errors import InvalidProgram
from substructures.expr.graph import MAX_BITS, MAX_EXPONENT, Expr, Graph

FORMAT = "substructures.program"
VERSION = 1

#: number of operands of every operation that has operands (``powi`` has one, and an integer exponent)
ARITY = {
    **dict.fromkeys(("add", "sub", "mul", "div", "atan2"), 2),
    **dict.fromkeys(("neg", "sin", "cos", "tan", "asin", "acos", "atan", "exp", "log", "sqrt", "abs", "sign"), 1),
}
#: operations that count in the literature
ARITHMETIC = ("add", "sub", "mul", "div", "powi")
KINDS = ("coordinate", "velocity", "acceleration", "parameter", "inertia", "input", "time")
SYMMETRIES = ("none", "symmetric", "christoffel")

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
    """

    shape: tuple[int, ...]
    index: tuple[tuple[int, ...], ...]
    entries: tuple[int, ...]
    symmetry: str = "none"

    def expanded(self) -> Iterable[tuple[tuple[int, ...], int, int]]:
        """(index, entry, sign) of every non-zero element, dependent ones included."""
        for index, entry in zip(self.index, self.entries, strict=True):
            yield index, entry, 1
            if self.symmetry == "symmetric" and index[0] != index[1]:
                yield (index[1], index[0]), entry, 1
            elif self.symmetry == "christoffel":
                a, b, c = index
                if b != c:
                    yield (a, c, b), entry, 1
                if b <= a:
                    yield (c, b, a), entry, -1
                    if a != b:
                        yield (c, a, b), entry, -1


@dataclass(frozen=True)
class Program:
    """Symbols, operations and named outputs. Build with :func:`program`, read with :meth:`from_bytes`."""

    symbols: tuple[Symbol, ...]
    operations: tuple[Operation, ...]
    outputs: Mapping[str, Output] = field(hash=False)

    def __len__(self) -> int:
        return len(self.operations)

    @cached_property
    def _encoded(self) -> bytes:
        document = {
            "format": FORMAT,
            "version": VERSION,
            "symbols": [{"name": s.name, "kind": s.kind, "unit": s.unit} for s in self.symbols],
            "operations": self.operations,
            "outputs": {
                name: {"shape": o.shape, "symmetry": o.symmetry, "index": o.index, "entries": o.entries}
                for name, o in self.outputs.items()
            },
        }
        return json.dumps(document, sort_keys=True, separators=(",", ":"), ensure_ascii=False).encode()

    def to_bytes(self) -> bytes:
        """Canonical bytes (RFC 8785)."""
        return self._encoded

    @cached_property
    def digest(self) -> str:
        """``sha256:`` and 64 hex digits of the canonical bytes."""
        return "sha256:" + hashlib.sha256(self._encoded).hexdigest()

    @classmethod
    def from_bytes(cls, data: bytes) -> Program:
        """Read and validate. Raises InvalidProgram with the position of the first bad operation."""
        try:
            document = json.loads(data)
        except (ValueError, RecursionError) as error:
            raise InvalidProgram(f"not a JSON document: {error}") from None
        return read_program(document)

    def reachable(self, names: Iterable[str] | None = None) -> list[int]:
        """Sorted indices of the operations that the named outputs (default: all) need."""
        wanted = self.outputs if names is None else {name: self.outputs[name] for name in names}
        needed = bytearray(len(self.operations))
        for output in wanted.values():
            for entry in output.entries:
                needed[entry] = 1
        for i in range(len(needed) - 1, -1, -1):
            if needed[i]:
                for operand in operands(self.operations[i]):
                    needed[operand] = 1
        return [i for i, flag in enumerate(needed) if flag]

    def select(self, names: Sequence[str]) -> Program:
        """The part of the program that computes the named outputs. Raises KeyError for an unknown name."""
        keep = self.reachable(names)
        new = {old: i for i, old in enumerate(keep)}
        used = sorted({self.operations[i][1] for i in keep if self.operations[i][0] == "sym"})
        symbol = {old: i for i, old in enumerate(used)}
        return Program(
            tuple(self.symbols[i] for i in used),
            tuple(renumbered(self.operations[i], new, symbol) for i in keep),
            {n: _moved(self.outputs[n], new) for n in names},
        )

    def count(self, names: Iterable[str] | None = None) -> dict[str, int]:
        """Operations by name; ``total`` = additions, subtractions, multiplications and divisions.

        As in the literature the total leaves out signs, symbols, constants and functions.
        """
        counts = Counter(self.operations[i][0] for i in self.reachable(names))
        result = {op: counts[op] for op in sorted(counts) if op not in ("int", "rat", "sym")}
        result["total"] = sum(counts[op] for op in ARITHMETIC)
        return result

    def count_entries(self, entries: Iterable[int]) -> int:
        """Arithmetic operations that the given entries need, each counted once."""
        seen: set[int] = set()
        stack = list(entries)
        while stack:
            i = stack.pop()
            if i not in seen:
                seen.add(i)
                stack.extend(operands(self.operations[i]))
        return sum(self.operations[i][0] in ARITHMETIC for i in seen)


def operands(operation: Operation) -> tuple[int, ...]:
    """The entries an operation refers to."""
    op = operation[0]
    if op in ARITY:
        return operation[1:]
    return operation[1:2] if op == "powi" else ()


def renumbered(operation: Operation, new: Mapping[int, int], symbol: Mapping[int, int]) -> Operation:
    """The operation with its operands (or symbol number) replaced."""
    op = operation[0]
    if op in ARITY:
        return (op, *(new[i] for i in operation[1:]))
    if op == "sym":
        return op, symbol[operation[1]]
    return (op, new[operation[1]], operation[2]) if op == "powi" else operation


def _moved(output: Output, new: Mapping[int, int]) -> Output:
    return Output(output.shape, output.index, tuple(new[i] for i in output.entries), output.symmetry)


@dataclass(frozen=True, slots=True)
class Formulas:
    """An output before it becomes part of a program: expressions by index; zeros are left out by :func:`program`."""

    shape: tuple[int, ...]
    entries: Mapping[tuple[int, ...], Expr | int]
    symmetry: str = "none"


def array(shape: tuple[int, ...], value: Callable[..., Any]) -> Formulas:
    """Formulas of a dense array from a function of its indices."""
    index: list[tuple[int, ...]] = [()]
    for size in shape:
        index = [(*i, j) for i in index for j in range(size)]
    return Formulas(shape, {i: value(*i) for i in index})


def program(graph: Graph, outputs: Mapping[str, Formulas], symbols: Mapping[str, Symbol]) -> Program:
    """Collect the nodes that the outputs need into a program; ``symbols`` describes the symbols by name."""
    entries = {
        name: {i: e if isinstance(e, Expr) else graph.number(e) for i, e in f.entries.items() if not _is_zero(e)}
        for name, f in outputs.items()
    }
    nodes = _reachable_nodes(e for some in entries.values() for e in some.values())
    position = {node: i for i, node in enumerate(nodes)}
    names = sorted({str(n.value) for n in nodes if n.op == "sym"})
    number = {name: i for i, name in enumerate(names)}
    return Program(
        tuple(symbols[name] for name in names),
        tuple(_operation(n, position, number) for n in nodes),
        {
            name: Output(
                outputs[name].shape,
                tuple(sorted(some)),
                tuple(position[some[i]] for i in sorted(some)),
                outputs[name].symmetry,
            )
            for name, some in sorted(entries.items())
        },
    )


def _is_zero(e: Expr | int) -> bool:
    return e.is_zero if isinstance(e, Expr) else e == 0


def _reachable_nodes(roots: Iterable[Expr]) -> list[Expr]:
    seen: set[Expr] = set()
    stack = list(roots)
    while stack:
        node = stack.pop()
        if node not in seen:
            seen.add(node)
            stack.extend(node.args)
    return sorted(seen, key=lambda node: node.index)


def _operation(node: Expr, position: Mapping[Expr, int], number: Mapping[str, int]) -> Operation:
    if node.op == "int":
        return "int", str(node.value)
    if node.op == "rat":
        value = Fraction(node.value)
        return "rat", str(value.numerator), str(value.denominator)
    if node.op == "sym":
        return "sym", number[str(node.value)]
    return (node.op, *(position[a] for a in node.args))


def read_program(document: Any) -> Program:
    """A program from its JSON document. Raises InvalidProgram."""
    if not isinstance(document, dict) or document.get("format") != FORMAT:
        raise InvalidProgram(f"format is not '{FORMAT}'")
    if document.get("version") != VERSION:
        raise InvalidProgram(f"version {document.get('version')!r} is unknown; this reader knows {VERSION}")
    try:
        symbols = tuple(_read_symbol(s) for s in document["symbols"])
        operations = tuple(tuple(op) for op in document["operations"])
        outputs = {str(n): _read_output(n, o, len(operations)) for n, o in document["outputs"].items()}
    except (KeyError, TypeError, AttributeError, ValueError) as error:
        raise InvalidProgram(f"malformed: {error}") from None
    if len({s.name for s in symbols}) != len(symbols):
        raise InvalidProgram("a symbol occurs twice")
    for i, operation in enumerate(operations):
        _check(i, operation, len(symbols))
    return Program(symbols, operations, outputs)


def _read_symbol(document: Any) -> Symbol:
    symbol = Symbol(**document)
    if symbol.kind not in KINDS or not isinstance(symbol.name, str) or not isinstance(symbol.unit, str):
        raise ValueError(f"symbol {document!r}")
    return symbol


def _read_output(name: Any, document: Any, size: int) -> Output:
    shape = tuple(document["shape"])
    index = tuple(tuple(i) for i in document["index"])
    entries, symmetry = tuple(document["entries"]), document["symmetry"]
    if symmetry not in SYMMETRIES or len(index) != len(entries):
        raise ValueError(f"output {name!r}")
    for i in index:
        if len(i) != len(shape) or not all(isinstance(x, int) and 0 <= x < n for x, n in zip(i, shape, strict=True)):
            raise ValueError(f"output {name!r}: index {i} outside of shape {shape}")
    if not all(isinstance(e, int) and 0 <= e < size for e in entries):
        raise ValueError(f"output {name!r}: entry outside of the program")
    return Output(shape, index, entries, symmetry)


def _check(i: int, operation: Operation, symbols: int) -> None:
    op = operation[0] if operation else None
    if op in ("int", "rat"):
        numbers = operation[1:]
        if len(numbers) != (1 if op == "int" else 2) or not all(_is_integer(n) for n in numbers):
            raise InvalidProgram(f"bad number {str(operation)[:80]}", i)
        if op == "rat" and int(numbers[1]) <= 0:
            raise InvalidProgram("denominator is not positive", i)
    elif op == "sym":
        if len(operation) != 2 or not _in_range(operation[1], symbols):
            raise InvalidProgram("unknown symbol", i)
    elif op in ARITY or op == "powi":
        arity = ARITY.get(op, 1)
        if len(operation) != 1 + arity + (op == "powi"):
            raise InvalidProgram(f"'{op}' has {len(operation) - 1} operands", i)
        if not all(_in_range(x, i) for x in operation[1 : 1 + arity]):
            raise InvalidProgram("an operand does not refer to an earlier entry", i)
        if op == "powi" and not (isinstance(operation[2], int) and abs(operation[2]) <= MAX_EXPONENT):
            raise InvalidProgram(f"exponent beyond {MAX_EXPONENT}", i)
    else:
        raise InvalidProgram(f"unknown operation {op!r}", i)


def _in_range(x: Any, n: int) -> bool:
    return isinstance(x, int) and not isinstance(x, bool) and 0 <= x < n


def _is_integer(text: Any) -> bool:
    if not isinstance(text, str) or len(text) > MAX_BITS // 3:
        return False
    digits = text[1:] if text.startswith("-") else text
    return digits.isascii() and digits.isdigit() and (digits == "0" or digits[0] != "0") and text != "-0"
