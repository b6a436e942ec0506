"""LLVM assembly of the functions of a lowered program: one basic block each, vectors of ``width`` states."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence

from substructures.compile.assembler import attributes, literal, vector
from substructures.compile.lowering import Lowered, Place, StageFunction
from substructures.compile.order import REGIONS
from substructures.expr.program import Operation

BINARY = {"add": "fadd", "sub": "fsub", "mul": "fmul", "div": "fdiv"}
#: a product may be contracted with the sum or difference that it goes into (fused multiply-add where the host has it)
CONTRACTED = frozenset(("add", "sub", "mul"))
INTRINSICS = {"sqrt": "sqrt", "abs": "fabs"}


def assembly(lowered: Lowered, ops: Sequence[Operation], width: int) -> str:
    """A module with the functions part0, part1, ... of the scratch arrays of the stages and of the outputs."""
    emitters = (_Emitter(lowered, part, ops, width) for part in lowered.parts)
    given = ", ".join(f"ptr %{region}" for region in (*REGIONS, "o"))
    bodies = [f"define void @part{k}({given}) #0 {{\n{e.text()}\n}}\n" for k, e in enumerate(emitters)]
    kind = vector(width)
    declared = [f"declare {kind} @llvm.{name}.v{width}f64({kind})\n" for name in INTRINSICS.values()]
    return "".join([*declared, *bodies, attributes(width)])


class _Emitter:
    """Text of one function. Values are numbered as they come, as LLVM does by itself: names would take it longer."""

    def __init__(self, lowered: Lowered, part: StageFunction, ops: Sequence[Operation], width: int) -> None:
        self.lowered, self.part, self.ops, self.width = lowered, part, ops, width
        self.kind = vector(width)
        self.lines: list[str] = []
        self.values = 0
        self.name: dict[int, str] = {}
        self.special: dict[str, Callable[[str, Operation], str]] = {
            "neg": lambda x, _: self._neg(x),
            "sign": self._sign,
            "powi": self._power,
            **dict.fromkeys(INTRINSICS, self._intrinsic),
        }

    def text(self) -> str:
        """All instructions; results are stored where they arise, copies at the end."""
        stores: dict[int, list[Place]] = {}
        for i, place in self.part.stores:
            stores.setdefault(i, []).append(place)
        for i in self.part.operations:
            self.name[i] = self._operation(i, self.ops[i])
            for place in stores.pop(i, ()):
                self._store(i, place)
        for i, places in stores.items():
            for place in places:
                self._store(i, place)
        self.lines.append("ret void")
        return "\n".join(self.lines)

    def _new(self, text: str) -> str:
        """The value of an instruction. The block itself has the number 0."""
        self.values += 1
        name = f"%{self.values}"
        self.lines.append(f"{name} = {text}")
        return name

    def _operation(self, i: int, operation: Operation) -> str:
        op = operation[0]
        if op in BINARY:
            return self._binary(i, *operation)
        if op == "neg" and operation[1] in self.lowered.minus:
            return self._value(operation[1])
        return self.special[op](self._value(operation[1]), operation)

    def _binary(self, i: int, op: str, x: int, y: int) -> str:
        """One instruction, where operands or result may be kept as negatives; and one more where a sign remains."""
        minus = self.lowered.minus
        first, second, whole = x in minus, y in minus, i in minus
        flag = "contract " if op in CONTRACTED and i not in self.lowered.sharp else ""
        a, b = self._value(x), self._value(y)
        if op not in ("add", "sub"):
            product = self._new(f"{BINARY[op]} {flag}{self.kind} {a}, {b}")
            return self._neg(product) if first ^ second ^ whole else product
        first, second = first ^ whole, second ^ whole ^ (op == "sub")
        if first and not second:
            a, b, first, second = b, a, second, first
        if first:
            # -a - b: where a or b is a product, the compiler takes the sign into it
            a = self._neg(a)
        return self._new(f"{BINARY['sub' if second else 'add']} {flag}{self.kind} {a}, {b}")

    def _neg(self, x: str) -> str:
        return self._new(f"fneg {self.kind} {x}")

    def _intrinsic(self, x: str, operation: Operation) -> str:
        return self._new(f"call {self.kind} @llvm.{INTRINSICS[operation[0]]}.v{self.width}f64({self.kind} {x})")

    def _sign(self, x: str, _: Operation) -> str:
        """-1, 0, 1, or NaN."""
        k, zero = self.kind, literal(0.0, self.width)
        mask, one, minus = f"<{self.width} x i1>", literal(1.0, self.width), literal(-1.0, self.width)
        above, below, none = (self._new(f"fcmp {test} {k} {x}, {zero}") for test in ("ogt", "olt", "uno"))
        result = self._new(f"select {mask} {none}, {k} {x}, {k} {zero}")
        result = self._new(f"select {mask} {below}, {k} {minus}, {k} {result}")
        return self._new(f"select {mask} {above}, {k} {one}, {k} {result}")

    def _power(self, x: str, operation: Operation) -> str:
        """Repeated squaring; the reciprocal of the power for negative exponents."""
        one, exponent = literal(1.0, self.width), operation[2]
        product = ""
        for factor in self._squares(x, abs(exponent)):
            product = self._new(f"fmul {self.kind} {product}, {factor}") if product else factor
        product = product or one
        return self._new(f"fdiv {self.kind} {one}, {product}") if exponent < 0 else product

    def _squares(self, x: str, exponent: int) -> Iterator[str]:
        """x^(2^j) for every bit j of the exponent."""
        for j in range(exponent.bit_length()):
            if j:
                x = self._new(f"fmul {self.kind} {x}, {x}")
            if exponent >> j & 1:
                yield x

    def _value(self, i: int) -> str:
        """Name of a value; loaded or written as a literal at its first use."""
        found = self.name.get(i)
        if found is None:
            if i in self.lowered.literals:
                found = literal(self.lowered.literals[i], self.width)
            else:
                pointer = self._pointer(self.part.loads[i])
                found = self._new(f"load {self.kind}, ptr {pointer}, align {8 * self.width}")
            self.name[i] = found
        return found

    def _store(self, i: int, place: Place) -> None:
        value, pointer = self._value(i), self._pointer(place)
        # results may go straight to an array of the caller
        align = 8 if place[0] == "o" else 8 * self.width
        self.lines.append(f"store {self.kind} {value}, ptr {pointer}, align {align}")

    def _pointer(self, place: Place) -> str:
        return self._new(f"getelementptr i8, ptr %{place[0]}, i64 {8 * self.width * place[1]}")
