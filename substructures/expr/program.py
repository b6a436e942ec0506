"""A formula as an immutable straight-line program: what is stored, sent, printed and compiled.

``operations`` is a list in which an operand refers only to earlier entries; ``outputs`` are named arrays with
shape, symmetry and the index of every independent, structurally non-zero entry. The canonical bytes are RFC 8785
JSON (sorted keys, no spaces, integers only), their SHA-256 is the identity of the program.
"""

from __future__ import annotations

import hashlib
from collections import Counter
from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass, field, replace
from fractions import Fraction
from functools import cached_property
from typing import Any

import orjson

from substructures.errors import InvalidProgram
from substructures.expr.graph import Expr, Graph
from substructures.expr.needs import check_demands, needed, totals
from substructures.expr.operations import (
    ARITHMETIC,
    ARITY,
    BINARY,
    CONSTANT,
    FORMAT,
    KINDS,
    SYMMETRIES,
    VERSION,
    Operation,
    Output,
    Symbol,
    images,
    operands,
    read_parts,
)

__all__ = [
    "ARITHMETIC",
    "ARITY",
    "FORMAT",
    "KINDS",
    "SYMMETRIES",
    "VERSION",
    "Entries",
    "Formulas",
    "Operation",
    "Output",
    "Program",
    "Symbol",
    "array",
    "operands",
    "program",
    "read_program",
    "renumbered",
]


@dataclass(frozen=True)
class Program:
    """Symbols, operations and named outputs. Build with :func:`program`, read with :meth:`from_bytes`.

    ``not_judged``: outputs of which a certificate could not tell whether they are right, as what they have to be has
    no finite value at any state that was tried; not part of what is stored.
    """

    symbols: tuple[Symbol, ...]
    operations: tuple[Operation, ...]
    outputs: Mapping[str, Output] = field(hash=False)
    not_judged: frozenset[str] = field(default=frozenset(), compare=False)

    def __len__(self) -> int:
        return len(self.operations)

    def __repr__(self) -> str:
        """Two lines: its size, and its outputs with their shapes."""
        outputs = ", ".join(f"{name} {'x'.join(map(str, x.shape)) or 'scalar'}" for name, x in self.outputs.items())
        return f"Program, {len(self.operations)} operations of {len(self.symbols)} symbols\n{outputs or 'no outputs'}"

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
        return orjson.dumps(document, option=orjson.OPT_SORT_KEYS)

    def to_bytes(self) -> bytes:
        """Canonical bytes (RFC 8785)."""
        return self._encoded

    @cached_property
    def digest(self) -> str:
        """``sha256:`` and 64 hex digits of the canonical bytes."""
        return "sha256:" + hashlib.sha256(self._encoded).hexdigest()

    @classmethod
    def from_bytes(cls, data: bytes) -> Program:
        """Read and validate. Raises InvalidProgram with the position of the first bad operation, and MemoryError."""
        try:
            document = orjson.loads(data)
        except (ValueError, RecursionError) as error:
            if str(error).startswith("Not enough memory"):  # which says nothing about the document
                raise MemoryError from None
            raise InvalidProgram(f"not a JSON document: {error}") from None
        return read_program(document)

    @cached_property
    def _reachable(self) -> dict[tuple[str, ...] | None, list[int]]:
        return {}

    def reachable(self, names: Iterable[str] | None = None) -> list[int]:
        """Sorted indices of the operations that the named outputs (default: all) need."""
        key = None if names is None else tuple(names)
        if key not in self._reachable:
            wanted = self.outputs.values() if key is None else [self.outputs[name] for name in key]
            self._reachable[key] = needed(self.operations, (entry for o in wanted for entry in o.entries))
        return self._reachable[key]

    @cached_property
    def _needs(self) -> dict[tuple[str, ...], tuple[str, ...]]:
        return {}

    def needs(self, names: Iterable[str]) -> tuple[str, ...]:
        """The names of the symbols that the outputs depend on."""
        key = tuple(names)
        if key not in self._needs:
            found = (self.operations[i] for i in self.reachable(key))
            self._needs[key] = tuple(self.symbols[op[1]].name for op in found if op[0] == "sym")
        return self._needs[key]

    def select(self, names: Sequence[str]) -> Program:
        """The part of the program that computes the named outputs. Raises KeyError for an unknown name."""
        keep = self.reachable(names)
        new = {old: i for i, old in enumerate(keep)}
        used = sorted({self.operations[i][1] for i in keep if self.operations[i][0] == "sym"})
        symbol = {old: i for i, old in enumerate(used)}
        return Program(
            tuple(self.symbols[i] for i in used),
            tuple(renumbered(self.operations[i], new, symbol) for i in keep),
            {n: replace(x, entries=tuple([new[i] for i in x.entries])) for n in names for x in (self.outputs[n],)},
            self.not_judged & frozenset(names),
        )

    def marked(self, not_judged: Iterable[str]) -> Program:
        """The program with more of its outputs not judged."""
        more = (self.outputs.keys() & not_judged) - self.not_judged
        return replace(self, not_judged=self.not_judged | more) if more else self

    def count(self, names: Iterable[str] | None = None, per_state: bool = False) -> dict[str, int]:
        """Operations by name; ``total`` = additions, subtractions, multiplications and divisions.

        As in the literature the total leaves out signs, symbols, constants and functions. ``per_state``: without
        operations of parameters alone, which are done once for all states.
        """
        key = None if names is None else tuple(names), per_state
        if key not in self._counts:
            counts = Counter(self.operations[i][0] for i in self.reachable(key[0]) if not per_state or self.of_state[i])
            told = {op: counts[op] for op in sorted(counts) if op not in ("int", "rat", "sym")}
            self._counts[key] = told | {"total": sum(counts[op] for op in ARITHMETIC)}
        return dict(self._counts[key])

    @cached_property
    def _counts(self) -> dict[tuple[tuple[str, ...] | None, bool], dict[str, int]]:
        return {}

    @cached_property
    def of_state(self) -> list[bool]:
        """Of every operation, whether it depends on more than parameters and inertia symbols."""
        constant = [symbol.kind in CONSTANT for symbol in self.symbols]
        result: list[bool] = []
        for operation in self.operations:
            if operation[0] in BINARY:
                result.append(result[operation[1]] or result[operation[2]])
            else:
                is_symbol = operation[0] == "sym"
                result.append(not constant[operation[1]] if is_symbol else any(result[i] for i in operands(operation)))
        return result

    def totals(self) -> dict[str, int]:
        """``count([name])["total"]`` of every output, in one pass."""
        return dict(self._totals)

    @cached_property
    def _totals(self) -> dict[str, int]:
        return dict(zip(self.outputs, self.totals_of([o.entries for o in self.outputs.values()]), strict=True))

    def totals_of(self, groups: Sequence[Sequence[int]]) -> list[int]:
        """Arithmetic operations that each group of entries needs, each operation counted once for a group."""
        return totals(self.operations, groups)


def renumbered(operation: Operation, new: Mapping[int, int], symbol: Mapping[int, int]) -> Operation:
    """The operation with its operands (or symbol number) replaced."""
    op = operation[0]
    if op in BINARY:
        return op, new[operation[1]], new[operation[2]]
    if op in ARITY:
        return (op, *[new[i] for i in operation[1:]])
    if op == "sym":
        return op, symbol[operation[1]]
    return (op, new[operation[1]], operation[2]) if op == "powi" else operation


#: expressions by index
Entries = dict[tuple[int, ...], Expr]


@dataclass(frozen=True, slots=True)
class Formulas:
    """An output outside of a program: scalars by index, an element without one is zero.

    Expressions and exact integers where it is to become part of a program (:func:`program` leaves zeros out); numbers
    or arrays where a stored program was evaluated.
    """

    shape: tuple[int, ...]
    entries: Mapping[tuple[int, ...], Any]
    symmetry: str = "none"

    def expanded(self) -> dict[tuple[int, ...], Expr | int]:
        """All elements by index, those that follow from the symmetry (:class:`Output`) included."""
        pairs = ((x, image, sign) for i, x in self.entries.items() for image, sign in images(i, self.symmetry))
        return {image: x if sign > 0 else -x for x, image, sign in pairs}


def array(shape: tuple[int, ...], value: Callable[..., Any]) -> Formulas:
    """Formulas of a dense array from a function of its indices."""
    index: list[tuple[int, ...]] = [()]
    for size in shape:
        index = [(*i, j) for i in index for j in range(size)]
    return Formulas(shape, {i: value(*i) for i in index})


def program(graph: Graph, outputs: Mapping[str, Formulas], symbols: Mapping[str, Symbol]) -> Program:
    """Collect the nodes that the outputs need into a program; ``symbols`` describes the symbols by name."""
    given = {name: {i: graph.lift(e) for i, e in formulas.entries.items()} for name, formulas in outputs.items()}
    entries = {name: {i: e for i, e in some.items() if not e.is_zero} for name, some in given.items()}
    nodes = _reachable_nodes(graph, (e for some in entries.values() for e in some.values()))
    position = [0] * len(graph)
    for i, node in enumerate(nodes):
        position[node.index] = i
    names = sorted({str(n.value) for n in nodes if n.op == "sym"})
    number = {name: i for i, name in enumerate(names)}
    return Program(
        tuple(symbols[name] for name in names),
        tuple([_operation(n, position, number) for n in nodes]),
        {
            name: Output(
                outputs[name].shape,
                tuple(sorted(some)),
                tuple(position[some[i].index] for i in sorted(some)),
                outputs[name].symmetry,
            )
            for name, some in sorted(entries.items())
        },
    )


def _reachable_nodes(graph: Graph, roots: Iterable[Expr]) -> list[Expr]:
    """Needed nodes in the order of their creation, operands first."""
    needed = bytearray(len(graph))
    for node in roots:
        needed[node.index] = 1
    for i in range(len(needed) - 1, -1, -1):
        if needed[i]:
            for operand in graph.nodes[i].args:
                needed[operand.index] = 1
    return [graph.nodes[i] for i, flag in enumerate(needed) if flag]


def _operation(node: Expr, position: Sequence[int], number: Mapping[str, int]) -> Operation:
    args = node.args
    if len(args) == 2:
        return node.op, position[args[0].index], position[args[1].index]
    if len(args) == 1:
        return node.op, position[args[0].index]
    if node.op == "int":
        return "int", str(node.value)
    if node.op == "rat":
        value = Fraction(node.value)
        return "rat", str(value.numerator), str(value.denominator)
    return "sym", number[str(node.value)]


def read_program(document: Any) -> Program:
    """A program from its JSON document. Raises InvalidProgram."""
    symbols, operations, outputs = read_parts(document)
    check_demands(operations, outputs.values())
    return Program(symbols, operations, outputs)
