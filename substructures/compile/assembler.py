"""LLVM assembly: types, constants, attributes, and a small writer for hand-written functions with loops."""

from __future__ import annotations

import struct
from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager


def vector(width: int) -> str:
    """The LLVM type of a value of ``width`` states."""
    return f"<{width} x double>"


def literal(value: float, width: int) -> str:
    """A constant in all lanes, exact to the bit."""
    bits = f"double 0x{struct.unpack('<Q', struct.pack('<d', value))[0]:016X}"
    return f"<{', '.join([bits] * width)}>"


def attributes(width: int) -> str:
    """Of functions: #0 with an aligned stack, where a spilled vector does not lie across two cache lines; #1 without:
    calling one takes less.
    """
    wide = f'nounwind "prefer-vector-width"="{64 * width}" "min-legal-vector-width"="{64 * width}"'
    return f"attributes #0 = {{ {wide} alignstack={8 * width} }}\nattributes #1 = {{ {wide} }}\n"


class AssemblyWriter:
    """Writes LLVM assembly; loops as context managers, so that control flow reads like a program."""

    def __init__(self, width: int, has_table: bool = False) -> None:
        """``has_table``: constants of :meth:`real` stand in memory as vectors, and instructions read them there. LLVM,
        left alone, makes each of them from one number before a loop, for which there are too few registers.
        """
        self.width, self.kind, self.lines, self.counter = width, vector(width), list[str](), 0
        self.block, self.table = "entry", dict[float, int]() if has_table else None

    def name(self) -> str:
        """A fresh value."""
        self.counter += 1
        return f"%x{self.counter}"

    def do(self, text: str) -> str:
        """An instruction with a result."""
        result = self.name()
        self.lines.append(f"{result} = {text}")
        return result

    def put(self, text: str) -> None:
        """An instruction without a result."""
        self.lines.append(text)

    def label(self, name: str) -> None:
        """Starts a basic block."""
        self.lines.append(f"{name}:")
        self.block = name

    @contextmanager
    def loop(self, start: str, stop: str, step: int = 1) -> Iterator[str]:
        """for i in range(start, stop, step)."""
        self.counter += 1
        n, before = self.counter, self.block
        self.put(f"br label %head{n}")
        self.label(f"head{n}")
        at = len(self.lines)
        self.put("")
        test = self.do(f"icmp slt i64 %i{n}, {stop}")
        self.put(f"br i1 {test}, label %body{n}, label %done{n}")
        self.label(f"body{n}")
        yield f"%i{n}"
        self.put(f"%n{n} = add i64 %i{n}, {step}")
        self.lines[at] = f"%i{n} = phi i64 [ {start}, %{before} ], [ %n{n}, %{self.block} ]"
        self.put(f"br label %head{n}")
        self.label(f"done{n}")

    @contextmanager
    def forever(self) -> Iterator[Callable[[str], None]]:
        """while True; what it gives leaves the loop on a condition."""
        self.counter += 1
        n = self.counter
        self.put(f"br label %again{n}")
        self.label(f"again{n}")

        def leave(condition: str) -> None:
            """if condition: break."""
            self.counter += 1
            self.put(f"br i1 {condition}, label %left{n}, label %stay{self.counter}")
            self.label(f"stay{self.counter}")

        yield leave
        self.put(f"br label %again{n}")
        self.label(f"left{n}")

    @contextmanager
    def when(self, condition: str) -> Iterator[None]:
        """if condition."""
        self.counter += 1
        n = self.counter
        self.put(f"br i1 {condition}, label %then{n}, label %end{n}")
        self.label(f"then{n}")
        yield
        self.put(f"br label %end{n}")
        self.label(f"end{n}")

    def offset(self, base: str, offset: str | int, unit: str = "i8") -> str:
        """Address of base[offset]."""
        return self.do(f"getelementptr {unit}, ptr {base}, i64 {offset}")

    def words(self, base: str, names: Sequence[str]) -> dict[str, str]:
        """The words of a row of a table by name."""
        return {n: self.do(f"load i64, ptr {self.offset(base, k, 'i64')}, align 8") for k, n in enumerate(names)}

    def pointer(self, word: str) -> str:
        """A word as an address."""
        return self.do(f"inttoptr i64 {word} to ptr")

    def copy(self, source: str, target: str, count: str) -> None:
        """So many doubles."""
        with self.loop("0", count) as i:
            value = self.do(f"load double, ptr {self.offset(source, i, 'double')}, align 8")
            self.put(f"store double {value}, ptr {self.offset(target, i, 'double')}, align 8")

    def arithmetic(self, op: str, a: str, b: str | int) -> str:
        """Integers."""
        return self.do(f"{op} i64 {a}, {b}")

    def real(self, op: str, a: str, b: str | float) -> str:
        """Vectors of doubles; a number stands for all lanes."""
        return self.do(f"{op} {self.kind} {a}, {self.constant(b) if isinstance(b, float) else b}")

    def constant(self, value: float) -> str:
        """In all lanes."""
        if self.table is None:
            return literal(value, self.width)
        place = self.offset("@table", self.table.setdefault(value, len(self.table)), self.kind)
        return self.do(f"load {self.kind}, ptr {place}, align {8 * self.width}")

    def fused(self, op: str, a: str, b: str | float) -> str:
        """The same; a product may be contracted with the sum or difference that it goes into."""
        return self.real(f"{op} contract", a, b)

    def function(self, name: str, arguments: str) -> str:
        """What has been written, as a function without a result, and with few vectors at a time."""
        rows = ", ".join(f"{self.kind} {literal(value, self.width)}" for value in self.table or ())
        table = f"@table = internal constant [{len(self.table)} x {self.kind}] [{rows}]\n" if self.table else ""
        return f"{table}define void @{name}({arguments}) #1 {{\nentry:\n" + "\n".join(self.lines) + "\nret void\n}\n"
