"""Programs as a module of WebAssembly: ``NAME(address of every argument, ..., address of every result)``.

Addresses are bytes in the memory that the module exports; arrays are doubles, dense and row-major. From ``heap`` on the
memory belongs to the caller. Trigonometric and other functions that WebAssembly lacks come from the import ``math``
(JavaScript's ``Math``); sines and cosines of |x| < 2^17 are computed by the module itself.
"""

from __future__ import annotations

import struct
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from math import prod

from substructures.errors import TooLarge
from substructures.export.webassembly import encoding as wasm
from substructures.export.webassembly.encoding import F64, I32, Body
from substructures.export.webassembly.sincos import sincos
from substructures.export.webassembly.straight import HOST, PART, Places, hosted, straight
from substructures.expr.operations import Output, flat
from substructures.expr.program import Program

#: address of the first byte that is used: 0 stays an address of nothing
START = 16
#: bytes of a module
LIMIT = 64 * 2**20


@dataclass(frozen=True)
class Argument:
    """An argument: a vector of symbols by name, given by its address; or one symbol, given as a double."""

    symbols: tuple[str, ...]
    scalar: bool = False


@dataclass(frozen=True)
class Function:
    """A function to export: the named ``outputs`` of a program, whose symbols are among the arguments."""

    name: str
    program: Program
    outputs: tuple[str, ...]
    arguments: tuple[Argument, ...]


@dataclass(frozen=True)
class Module:
    """The bytes, and the first free address of the memory."""

    content: bytes
    heap: int


def module(functions: Sequence[Function], part: int = PART) -> Module:
    """Functions of about ``part`` operations each. Raises TooLarge for a module of more than LIMIT bytes, KeyError for
    unknown outputs and symbols.
    """
    return _Writer(functions, part).module()


class _Writer:
    """``types``, ``kinds`` (of functions), ``bodies``, ``data`` grow function by function."""

    def __init__(self, functions: Sequence[Function], part: int) -> None:
        self.functions, self.part = functions, part
        called = set[str]().union(*(hosted(f.program, f.outputs) for f in functions))
        self.host = [name for name in HOST if name in called]
        self.numbers = {name: k for k, name in enumerate(self.host)}
        self.types: list[bytes] = []
        self.kinds: list[int] = []
        self.bodies: list[Body] = []
        self.exports: list[bytes] = []
        self.data = bytearray()
        self.scratch = 0
        if "sin" in self.numbers:
            body = sincos(self.numbers["sin"], self.numbers["cos"])
            self.numbers["sincos"] = self._add(body, wasm.function_type([F64], [F64, F64]))

    def module(self) -> Module:
        """All sections."""
        mirrors = [self._mirrors(f) for f in self.functions]
        scratch = START + -(-len(self.data) // 8) * 8
        for function, tables in zip(self.functions, mirrors, strict=True):
            self._function(function, tables, scratch)
        heap = scratch + self.scratch
        imports = [
            wasm.text("math") + wasm.text(name) + bytes([wasm.FUNCTION_KIND]) + wasm.unsigned(self._host_type(name))
            for name in self.host
        ]
        pages = wasm.unsigned(-(-heap // wasm.PAGE) or 1)
        self.exports.append(wasm.text("memory") + bytes([wasm.MEMORY_KIND, 0]))
        sections = [
            (wasm.TYPES, wasm.sequence(self.types)),
            (wasm.IMPORTS, wasm.sequence(imports)),
            (wasm.FUNCTIONS, wasm.sequence([wasm.unsigned(k) for k in self.kinds])),
            (wasm.MEMORY, wasm.sequence([b"\0" + pages])),
            (wasm.EXPORTS, wasm.sequence(self.exports)),
            (wasm.CODE, wasm.sequence([body.encoded() for body in self.bodies])),
            (wasm.DATA, wasm.sequence([self._segment()])),
        ]
        content = wasm.HEAD + b"".join(wasm.section(n, content) for n, content in sections)
        if len(content) > LIMIT:
            raise TooLarge("a module of WebAssembly (in bytes)", len(content), LIMIT)
        return Module(content, heap)

    def _segment(self) -> bytes:
        """The tables, from START on."""
        at = Body(0)
        at.integer(START)
        return b"\0" + bytes(at.code) + b"\x0b" + wasm.unsigned(len(self.data)) + bytes(self.data)

    def _host_type(self, name: str) -> int:
        return self._type(wasm.function_type([F64] * HOST[name], [F64]))

    def _type(self, encoded: bytes) -> int:
        if encoded not in self.types:
            self.types.append(encoded)
        return self.types.index(encoded)

    def _add(self, body: Body, kind: bytes) -> int:
        """The number of a new function."""
        self.kinds.append(self._type(kind))
        self.bodies.append(body)
        return len(self.host) + len(self.bodies) - 1

    def _function(self, function: Function, tables: Sequence[_Mirrors], scratch: int) -> None:
        """The parts, and the exported function that calls them between clearing and mirroring the arrays."""
        count = len(function.arguments)
        places = Places(
            count + len(function.outputs), _symbols(function), _results(function, count), scratch, self.numbers
        )
        parts, size = straight(function.program, places, self.part)
        self.scratch = max(self.scratch, size)
        kinds = [F64 if a.scalar else I32 for a in function.arguments] + [I32] * len(function.outputs)
        kind = wasm.function_type(kinds, [])
        numbers = [self._add(body, kind) for body in parts]
        whole = Body(len(kinds))
        for k, name in enumerate(function.outputs):
            _clear(whole, count + k, function.program.outputs[name])
        for number in numbers:
            for k in range(len(kinds)):
                whole.get(k)
            whole.call(number)
        for k, table in enumerate(tables):
            table.copy(whole, count + k)
        number = self._add(whole, kind)
        self.exports.append(wasm.text(function.name) + bytes([wasm.FUNCTION_KIND]) + wasm.unsigned(number))

    def _mirrors(self, function: Function) -> list[_Mirrors]:
        result = []
        for name in function.outputs:
            pairs = _dependent(function.program.outputs[name])
            spans = []
            for sign in (1, -1):
                begin = START + len(self.data)
                for pair in pairs[sign]:
                    self.data += struct.pack("<II", *pair)
                spans.append((begin, START + len(self.data)))
            result.append(_Mirrors(*spans))
        return result


@dataclass(frozen=True)
class _Mirrors:
    """Tables of (offset of an element, offset of the independent one): equal ones, and ones of the opposite sign."""

    equal: tuple[int, int]
    opposite: tuple[int, int]

    def copy(self, b: Body, array: int) -> None:
        """Loops over the tables."""
        for (begin, end), opposite in ((self.equal, False), (self.opposite, True)):
            if begin < end:
                _copy(b, array, begin, end, opposite)


def _copy(b: Body, array: int, begin: int, end: int, opposite: bool) -> None:
    """x[table[i]] = (-)x[table[i + 1]] for the pairs from begin to end."""
    at = b.local(I32)
    b.integer(begin)
    b.set(at)
    b.begin_loop()
    for offset in (0, 4):
        b.get(array)
        b.get(at)
        b.load_integer(offset)
        b.do("i32.add")
    b.load(0)
    if opposite:
        b.do("f64.neg")
    b.store(0)
    b.get(at)
    b.integer(8)
    b.do("i32.add")
    b.tee(at)
    b.integer(end)
    b.do("i32.lt_u")
    b.again()
    b.do("end")


def _clear(b: Body, array: int, output: Output) -> None:
    """All elements 0 where some are."""
    if sum(1 for _ in output.expanded()) < prod(output.shape):
        b.get(array)
        b.integer(0)
        b.integer(8 * prod(output.shape))
        b.fill()


def _symbols(function: Function) -> dict[int, tuple[int, int | None]]:
    """The local and the offset of every symbol of the program."""
    place: dict[str, tuple[int, int | None]] = {}
    for k, argument in enumerate(function.arguments):
        place |= {s: (k, None if argument.scalar else 8 * j) for j, s in enumerate(argument.symbols)}
    return {n: place[s.name] for n, s in enumerate(function.program.symbols) if s.name in place}


def _results(function: Function, first: int) -> Mapping[int, list[tuple[int, int]]]:
    """The places of every entry that is independent."""
    result: dict[int, list[tuple[int, int]]] = {}
    for k, name in enumerate(function.outputs):
        output = function.program.outputs[name]
        for index, entry in zip(output.index, output.entries, strict=True):
            result.setdefault(entry, []).append((first + k, 8 * flat(index, output.shape)))
    return result


def _dependent(output: Output) -> dict[int, list[tuple[int, int]]]:
    """By sign: offsets of every dependent element and of the independent one that it follows from."""
    result: dict[int, list[tuple[int, int]]] = {1: [], -1: []}
    independent = set(output.index)
    source = 0
    for index, _, sign in output.expanded():
        if index in independent:
            source = 8 * flat(index, output.shape)
        else:
            result[sign].append((8 * flat(index, output.shape), source))
    return result
