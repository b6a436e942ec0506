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
    """Text of one function. Values are called %v and the number of their operation."""

    def __init__(self, lowered: Lowered, part: StageFunction, ops: Sequence[Operation], width: int) -> None:
        self.lowered, self.part, self.ops, self.width = lowered, part, ops, width
        self.kind = vector(width)
        self.lines: list[str] = []
        self.name: dict[int, str] = {}
        self.special: dict[str, Callable[[str, str, Operation], None]] = {
            "neg": self._neg,
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
            self._operation(i)
            for place in stores.pop(i, ()):
                self._store(i, place)
        for i, places in stores.items():
            for place in places:
                self._store(i, place)
        self.lines.append("ret void")
        return "\n".join(self.lines)

    def _operation(self, i: int) -> None:
        operation = self.ops[i]
        op, result = operation[0], f"%v{i}"
        if op == "neg" and operation[1] in self.lowered.minus:
            result = self._value(operation[1])
        elif op in BINARY:
            self._binary(result, i, *operation)
        else:
            self.special[op](result, self._value(operation[1]), operation)
        self.name[i] = result

    def _binary(self, result: str, i: int, op: str, x: int, y: int) -> None:
        """One instruction, where operands or result may be kept as negatives; and one more where a sign remains."""
        first, second, whole = (k in self.lowered.minus for k in (x, y, i))
        flag = " contract" if op in CONTRACTED and i not in self.lowered.sharp else ""
        a, b = self._value(x), self._value(y)
        if op not in ("add", "sub"):
            product = f"{result}.p" if first ^ second ^ whole else result
            self.lines.append(f"{product} = {BINARY[op]}{flag} {self.kind} {a}, {b}")
            if product != result:
                self._neg(result, product, ())
            return
        first, second = first ^ whole, second ^ whole ^ (op == "sub")
        if first and not second:
            a, b, first, second = b, a, second, first
        if first:
            # -a - b: where a or b is a product, the compiler takes the sign into it
            self._neg(f"{result}.n", a, ())
            a = f"{result}.n"
        self.lines.append(f"{result} = {BINARY['sub' if second else 'add']}{flag} {self.kind} {a}, {b}")

    def _neg(self, result: str, x: str, _: Operation) -> None:
        self.lines.append(f"{result} = fneg {self.kind} {x}")

    def _intrinsic(self, result: str, x: str, operation: Operation) -> None:
        name = INTRINSICS[operation[0]]
        self.lines.append(f"{result} = call {self.kind} @llvm.{name}.v{self.width}f64({self.kind} {x})")

    def _sign(self, result: str, x: str, _: Operation) -> None:
        """-1, 0, 1, or NaN."""
        k, zero = self.kind, literal(0.0, self.width)
        mask, one, minus = f"<{self.width} x i1>", literal(1.0, self.width), literal(-1.0, self.width)
        self.lines += [
            f"{result}.g = fcmp ogt {k} {x}, {zero}",
            f"{result}.l = fcmp olt {k} {x}, {zero}",
            f"{result}.u = fcmp uno {k} {x}, {zero}",
            f"{result}.0 = select {mask} {result}.u, {k} {x}, {k} {zero}",
            f"{result}.1 = select {mask} {result}.l, {k} {minus}, {k} {result}.0",
            f"{result} = select {mask} {result}.g, {k} {one}, {k} {result}.1",
        ]

    def _power(self, result: str, x: str, operation: Operation) -> None:
        """Repeated squaring; the reciprocal of the power for negative exponents."""
        exponent = operation[2]
        factors = list(self._squares(result, x, abs(exponent)))
        product = factors[0] if factors else literal(1.0, self.width)
        for j, factor in enumerate(factors[1:]):
            self.lines.append(f"{result}.m{j} = fmul {self.kind} {product}, {factor}")
            product = f"{result}.m{j}"
        op, first = ("fdiv", literal(1.0, self.width)) if exponent < 0 else ("fmul", literal(1.0, self.width))
        self.lines.append(f"{result} = {op} {self.kind} {first}, {product}")

    def _squares(self, result: str, x: str, exponent: int) -> Iterator[str]:
        """x^(2^j) for every bit j of the exponent."""
        for j in range(exponent.bit_length()):
            if j:
                self.lines.append(f"{result}.s{j} = fmul {self.kind} {x}, {x}")
                x = f"{result}.s{j}"
            if exponent >> j & 1:
                yield x

    def _value(self, i: int) -> str:
        """Name of a value; loaded or written as a literal at its first use."""
        if i not in self.name:
            if i in self.lowered.literals:
                self.name[i] = literal(self.lowered.literals[i], self.width)
            else:
                pointer = self._pointer(f"%l{i}", self.part.loads[i])
                self.lines.append(f"%v{i} = load {self.kind}, ptr {pointer}, align {8 * self.width}")
                self.name[i] = f"%v{i}"
        return self.name[i]

    def _store(self, i: int, place: Place) -> None:
        value = self._value(i)
        pointer = self._pointer(f"%t{len(self.lines)}", place)
        # results may go straight to an array of the caller
        align = 8 if place[0] == "o" else 8 * self.width
        self.lines.append(f"store {self.kind} {value}, ptr {pointer}, align {align}")

    def _pointer(self, name: str, place: Place) -> str:
        self.lines.append(f"{name} = getelementptr i8, ptr %{place[0]}, i64 {8 * self.width * place[1]}")
        return name
