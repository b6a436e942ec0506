"""LLVM assembly of the functions of a lowered program: one basic block each, vectors of ``width`` states."""

from __future__ import annotations

from collections import Counter
from collections.abc import Callable, Collection, Iterable, Iterator, Mapping, Sequence
from itertools import chain
from typing import NamedTuple

from substructures.compile.assembler import attributes, literal, vector
from substructures.compile.lowering import Lowered, Place, StageFunction
from substructures.compile.order import REGIONS
from substructures.expr.program import Operation, operands

BINARY = {"add": "fadd", "sub": "fsub", "mul": "fmul", "div": "fdiv"}
#: a product may be contracted with the sum or difference that it goes into (fused multiply-add where the host has it)
CONTRACTED = frozenset(("add", "sub", "mul"))
INTRINSICS = {"sqrt": "sqrt", "abs": "fabs"}
#: doubles in a vector of AVX-512, of which it has 32 registers; storing one takes two cycles
WIDE = 8
#: values that stay in registers there; the others are left for what one instruction needs
KEPT = 30
#: beside the regions: the array of a function for values that wait
WAITING = "w"
NEVER = 2**62


def assembly(lowered: Lowered, ops: Sequence[Operation], width: int) -> str:
    """A module with the functions part0, part1, ... of the scratch arrays of the stages and of the outputs."""
    kind = _Sparing if width == WIDE else _Emitter
    emitters = (kind(lowered, part, ops, width) for part in lowered.parts)
    given = ", ".join(f"ptr %{region}" for region in (*REGIONS, "o"))
    bodies = [f"define void @part{k}({given}) #0 {{\n{e.text()}\n}}\n" for k, e in enumerate(emitters)]
    value = vector(width)
    declared = [f"declare {value} @llvm.{name}.v{width}f64({value})\n" for name in INTRINSICS.values()]
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
        stores = self._stores()
        for i in self.part.operations:
            self.name[i] = self._operation(i, self.ops[i])
            for place in stores.pop(i, ()):
                self._store(i, place)
        for i, places in stores.items():
            for place in places:
                self._store(i, place)
        self.lines.append("ret void")
        return "\n".join(self.lines)

    def _stores(self) -> dict[int, list[Place]]:
        """Where values go to."""
        stores: dict[int, list[Place]] = {}
        for i, place in self.part.stores:
            stores.setdefault(i, []).append(place)
        return stores

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
                found = self._load(self.part.loads[i])
            self.name[i] = found
        return found

    def _load(self, place: Place) -> str:
        return self._new(f"load {self.kind}, ptr {self._pointer(place)}, align {self._alignment(place)}")

    def _store(self, i: int, place: Place) -> None:
        value, pointer = self._value(i), self._pointer(place)
        self.lines.append(f"store {self.kind} {value}, ptr {pointer}, align {self._alignment(place)}")

    def _alignment(self, place: Place) -> int:
        """Of a vector; results may go straight to an array of the caller."""
        return 8 if place[0] == "o" else 8 * self.width

    def _pointer(self, place: Place) -> str:
        return self._new(f"getelementptr i8, ptr %{place[0]}, i64 {8 * self.width * place[1]}")


class _Instruction(NamedTuple):
    """An operation with the products that go into one instruction with it, the values that it reads, when its result
    is needed first, and when these are needed again.
    """

    operation: int
    products: list[int]
    reads: list[int]
    first: int
    again: list[int]


class _Sparing(_Emitter):
    """The same with KEPT values in registers: of more the one waits in memory that is needed again last (L. A. Belady,
    A study of replacement algorithms for a virtual-storage computer, IBM Systems Journal 5, 1966). It is stored unless
    memory has it, and loaded where it is needed. LLVM, left alone, stores twice as often.
    """

    def __init__(self, lowered: Lowered, part: StageFunction, ops: Sequence[Operation], width: int) -> None:
        super().__init__(lowered, part, ops, width)
        self.same = dict[int, int]()
        #: values in registers, and when they are needed again
        self.held: dict[int, int] = {}
        # kept as their negatives: another operation has their value
        for i in part.operations:
            x: int = ops[i][1] if ops[i][0] == "neg" else -1
            if x in lowered.minus:
                self.same[i] = self.same.get(x, x)
        #: where values lie in memory
        self.home = {self.same.get(i, i): place for i, place in part.loads.items()}
        self.waiting, self.free = 0, list[Place]()

    def text(self) -> str:
        """All instructions; results are stored where they arise, copies at the end."""
        stores = self._stores()
        for instruction in self._instructions(stores):
            self._write(instruction, stores.pop(instruction.operation, ()))
        for i, places in stores.items():
            for place in places:
                self._store(i, place)
        array = f"%{WAITING} = alloca [{self.waiting} x {self.kind}], align {8 * self.width}"
        return "\n".join([*([array] if self.waiting else []), *self.lines, "ret void"])

    def _stores(self) -> dict[int, list[Place]]:
        stores: dict[int, list[Place]] = {}
        for i, place in self.part.stores:
            stores.setdefault(self.same.get(i, i), []).append(place)
        return stores

    def _write(self, instruction: _Instruction, places: Iterable[Place]) -> None:
        """What it reads from memory, itself, its result where it belongs, and what cannot stay."""
        i, products, reads, first, again = instruction
        for x in reads:
            if x not in self.held:
                self.name[x] = self._load(self.home[x])
        for x in (*products, i):
            self.name[x] = self._operation(x, self.ops[x])
        for place in places:
            self._store(i, place)
            self.home[i] = place
        for x, needed in zip((*reads, i), (*again, first), strict=True):
            self._hold(x, needed)
        while len(self.held) > KEPT:
            self._put_off()

    def _instructions(self, stores: Collection[int]) -> list[_Instruction]:
        """In their order, a product where the sum or difference is that it goes into."""
        mine = [i for i in self.part.operations if i not in self.same]
        values = {i: [self.same.get(x, x) for x in operands(self.ops[i])] for i in mine}
        products = self._products(values, stores)
        within = set(products.values())
        order = [i for i in mine if i not in within]
        found, needed = list[_Instruction](), dict[int, int]()
        for t, i in zip(range(len(order) - 1, -1, -1), reversed(order), strict=True):
            own = [products[i]] if i in products else []
            every = chain(*(values[x] for x in own), values[i])
            reads = [x for x in dict.fromkeys(every) if x not in own and x not in self.lowered.literals]
            again = [needed.get(x, NEVER) for x in reads]
            found.append(_Instruction(i, own, reads, needed.pop(i, NEVER), again))
            needed.update(dict.fromkeys(reads, t))
        return found[::-1]

    def _products(self, values: Mapping[int, list[int]], stores: Collection[int]) -> dict[int, int]:
        """Of sums and differences the product that becomes one instruction with them: nothing else needs it."""
        users, found, sharp = Counter(chain.from_iterable(values.values())), dict[int, int](), self.lowered.sharp
        for i, some in values.items():
            if self.ops[i][0] in ("add", "sub") and i not in sharp:
                for x in some:
                    if x in values and self.ops[x][0] == "mul" and users[x] == 1 and x not in stores and x not in sharp:
                        found[i] = x
                        break
        return found

    def _hold(self, x: int, needed: int) -> None:
        """Keep a value in its register until it is needed, or no longer."""
        if needed < NEVER:
            self.held[x] = needed
            return
        self.held.pop(x, None)
        place = self.home.get(x)
        if place is not None and place[0] == WAITING:
            self.free.append(self.home.pop(x))

    def _put_off(self) -> None:
        """The value that is needed last is not held any more."""
        x = max(self.held, key=self.held.__getitem__)
        del self.held[x]
        if x not in self.home:
            if not self.free:
                self.free.append((WAITING, self.waiting))
                self.waiting += 1
            self.home[x] = self.free.pop()
            self._store(x, self.home[x])

    def _value(self, i: int) -> str:
        return super()._value(self.same.get(i, i))
