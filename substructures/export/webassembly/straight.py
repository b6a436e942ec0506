"""Straight-line code of a program: functions of some hundred operations, and values that cross between them in memory.

What is used once is computed where it is used, on the stack; what is used more often, and every pair of a sine and a
cosine, has a local. A value that a later function needs has a place in the scratch memory besides.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

from substructures.compile.lowering import MAX_PRODUCT
from substructures.compile.order import depth_first
from substructures.export.webassembly.encoding import Body
from substructures.expr.interpret import constant
from substructures.expr.program import Operation, Program, operands

#: operations in one function, which engines compile one by one, the larger ones slower than in proportion
PART = 1000
#: functions that the host gives, with the number of their arguments
HOST = {"sin": 1, "cos": 1, "tan": 1, "asin": 1, "acos": 1, "atan": 1, "atan2": 2, "exp": 1, "log": 1, "pow": 2}
_BINARY = {"add": "f64.add", "sub": "f64.sub", "mul": "f64.mul", "div": "f64.div"}
_UNARY = {"neg": "f64.neg", "sqrt": "f64.sqrt", "abs": "f64.abs"}
_PAIRED = ("sin", "cos")


def hosted(program: Program, names: Sequence[str]) -> set[str]:
    """The functions of the host that the named outputs call."""
    found = {_called(program.operations[i]) for i in program.reachable(names)} - {""}
    return found | set(_PAIRED) if found & set(_PAIRED) else found


def _called(operation: Operation) -> str:
    op: str = operation[0]
    if op == "powi":
        return "pow" if abs(operation[2]) > MAX_PRODUCT else ""
    return op if op in HOST else ""


@dataclass(frozen=True)
class Places:
    """Where values are: ``symbols``: by number, the local of an address (or of the value itself) and the offset;
    ``results``: by entry, the local of an address and the offsets; ``scratch``: the address of the scratch memory;
    ``functions``: numbers of the functions of the host, and of "sincos".
    """

    arguments: int
    symbols: Mapping[int, tuple[int, int | None]]
    results: Mapping[int, Sequence[tuple[int, int]]]
    scratch: int
    functions: Mapping[str, int]


def straight(program: Program, places: Places, part: int = PART) -> tuple[list[Body], int]:
    """The functions that write the ``results``, to be called in order, and the scratch memory in bytes."""
    code = _Code(program, places, part)
    return [code.body(k) for k in range(code.parts)], 8 * len(code.slots)


class _Code:
    """The order of operations, who uses what, and which value has a place."""

    def __init__(self, program: Program, places: Places, part: int) -> None:
        self.ops, self.places = program.operations, places
        order = depth_first(self.ops, sorted(places.results))
        self.order = [i for i in order if self.ops[i][0] not in ("sym", "int", "rat")]
        self.parts = max(1, -(-len(self.order) // part))
        self.part = {i: j // part for j, i in enumerate(self.order)}
        self.other = self._pairs()
        users: dict[int, list[int]] = {i: [] for i in order}
        for i in self.order:
            for x in operands(self.ops[i]):
                users[x].append(self.part[i])
        #: computed where it is used
        self.inline = {
            i for i in self.order if users[i] == [self.part[i]] and i not in places.results and i not in self.other
        }
        crossing = (i for i in self.order if any(k > self.part[i] for k in users[i]))
        self.slots = {i: places.scratch + 8 * j for j, i in enumerate(crossing)}

    def _pairs(self) -> dict[int, tuple[int, int]]:
        """Of every sine and cosine: both of the same argument, -1 for none. Their part is that of the first."""
        found: dict[int, list[int]] = {}
        for i in self.order:
            if self.ops[i][0] in _PAIRED:
                found.setdefault(self.ops[i][1], [-1, -1])[_PAIRED.index(self.ops[i][0])] = i
        result = {}
        for sine, cosine in found.values():
            both = [i for i in (sine, cosine) if i >= 0]
            first = min(self.part[i] for i in both)
            for i in both:
                self.part[i] = first
                result[i] = (sine, cosine)
        return result

    def body(self, number: int) -> Body:
        """The function of one part."""
        return _Part(self, number).body


class _Part:
    """One function. ``held``: locals of values."""

    def __init__(self, code: _Code, number: int) -> None:
        self.code, self.body, self.held = code, Body(code.places.arguments), dict[int, int]()
        for i in code.order:
            if code.part[i] == number and i not in code.inline and i not in self.held:
                self._compute(i)
        if number == code.parts - 1:
            for i in code.places.results:
                if code.ops[i][0] in ("sym", "int", "rat"):
                    self._write(i)

    def _compute(self, i: int) -> None:
        """A value gets its local, and is written where it is wanted."""
        b = self.body
        if i in self.code.other:
            pair = self.code.other[i]
            self._push(self.code.ops[i][1])
            b.call(self.code.places.functions["sincos"])
            held = [b.local(), b.local()]
            b.set(held[1])
            b.set(held[0])
            self.held |= {x: local for x, local in zip(pair, held, strict=True) if x >= 0}
        else:
            self._tree(i)
            pair, self.held[i] = (i, -1), b.local()
            b.set(self.held[i])
        for x in pair:
            if x >= 0:
                self._write(x)

    def _write(self, i: int) -> None:
        b = self.body
        if i in self.code.slots:
            b.integer(0)
            self._push(i)
            b.store(self.code.slots[i])
        for local, offset in self.code.places.results.get(i, ()):
            b.get(local)
            self._push(i)
            b.store(offset)

    def _tree(self, root: int) -> None:
        """The value of an operation on the stack, with all that is computed only for it."""
        waiting = [(root, False)]
        while waiting:
            i, ready = waiting.pop()
            if ready:
                self._operation(self.code.ops[i])
            elif i == root or i in self.code.inline:
                waiting.append((i, True))
                waiting += [(x, False) for x in reversed(operands(self.code.ops[i]))]
            else:
                self._push(i)

    def _push(self, i: int) -> None:
        """A value that has a place, a constant, or one that is computed here."""
        b, operation = self.body, self.code.ops[i]
        if i in self.held:
            b.get(self.held[i])
        elif operation[0] in ("int", "rat"):
            b.number(constant(operation))
        elif i in self.code.inline:
            self._tree(i)
        elif operation[0] == "sym":
            local, offset = self.code.places.symbols[operation[1]]
            b.get(local)
            if offset is not None:
                b.load(offset)
                self._hold(i)
        else:
            b.integer(0)
            b.load(self.code.slots[i])
            self._hold(i)

    def _hold(self, i: int) -> None:
        self.held[i] = self.body.local()
        self.body.tee(self.held[i])

    def _operation(self, operation: Operation) -> None:
        b, op = self.body, operation[0]
        if op in _BINARY:
            b.do(_BINARY[op])
        elif op in _UNARY:
            b.do(_UNARY[op])
        elif op == "sign":
            _sign(b)
        elif op == "powi" and abs(operation[2]) <= MAX_PRODUCT:
            _power(b, operation[2])
        else:
            if op == "powi":
                b.number(float(operation[2]))
            b.call(self.code.places.functions[_called(operation)])


def _sign(b: Body) -> None:
    """1 or -1 where |v| > 0, else v."""
    v = b.local()
    b.set(v)
    b.number(1.0)
    b.get(v)
    b.do("f64.copysign")
    b.get(v)
    b.get(v)
    b.do("f64.abs")
    b.number(0.0)
    b.do("f64.gt", "select")


def _power(b: Body, exponent: int) -> None:
    """Products by squaring."""
    base = b.local()
    b.set(base)
    if exponent < 0:
        b.number(1.0)
    bits = bin(abs(exponent))[3:]
    if exponent == 0:
        b.number(1.0)
    else:
        b.get(base)
    for bit in bits if exponent else "":
        square = b.local()
        b.tee(square)
        b.get(square)
        b.do("f64.mul")
        if bit == "1":
            b.get(base)
            b.do("f64.mul")
    if exponent < 0:
        b.do("f64.div")
