"""The binary format of WebAssembly 2.0: numbers, vectors, sections, and the instructions that formulas need."""

from __future__ import annotations

import struct
from collections.abc import Iterable, Sequence

HEAD = b"\0asm\x01\0\0\0"
#: types of values
I32, F64 = 0x7F, 0x7C
#: sections by their number
TYPES, IMPORTS, FUNCTIONS, MEMORY, EXPORTS, CODE, DATA = 1, 2, 3, 5, 7, 10, 11
#: kinds of what is imported and exported
FUNCTION_KIND, MEMORY_KIND = 0, 2
PAGE = 65_536

INSTRUCTIONS = {
    "end": 0x0B,
    "else": 0x05,
    "return": 0x0F,
    "select": 0x1B,
    "i32.eqz": 0x45,
    "i32.lt_u": 0x49,
    "f64.eq": 0x61,
    "f64.lt": 0x63,
    "f64.gt": 0x64,
    "i32.add": 0x6A,
    "i32.and": 0x71,
    "f64.abs": 0x99,
    "f64.neg": 0x9A,
    "f64.nearest": 0x9E,
    "f64.sqrt": 0x9F,
    "f64.add": 0xA0,
    "f64.sub": 0xA1,
    "f64.mul": 0xA2,
    "f64.div": 0xA3,
    "f64.copysign": 0xA6,
    "i32.trunc_f64_s": 0xAA,
}


def unsigned(n: int) -> bytes:
    """LEB128 of a number >= 0."""
    result = bytearray()
    while n > 0x7F:
        result.append(n & 0x7F | 0x80)
        n >>= 7
    result.append(n)
    return bytes(result)


def signed(n: int) -> bytes:
    """Signed LEB128."""
    result = bytearray()
    while not -64 <= n < 64:
        result.append(n & 0x7F | 0x80)
        n >>= 7
    result.append(n & 0x7F)
    return bytes(result)


def sequence(items: Sequence[bytes]) -> bytes:
    """A vector: its length, then its items."""
    return unsigned(len(items)) + b"".join(items)


def text(name: str) -> bytes:
    """A name, in UTF-8."""
    return sequence([bytes([b]) for b in name.encode()])


def section(number: int, content: bytes) -> bytes:
    """A section with its size."""
    return bytes([number]) + unsigned(len(content)) + content


def function_type(arguments: Iterable[int], results: Iterable[int]) -> bytes:
    """The type of a function."""
    return b"\x60" + sequence([bytes([k]) for k in arguments]) + sequence([bytes([k]) for k in results])


class Body:
    """The code of one function; ``arguments``: how many locals the caller gives."""

    def __init__(self, arguments: int) -> None:
        self.code = bytearray()
        self.arguments = arguments
        #: types of the locals after the arguments
        self.kinds: list[int] = []

    def local(self, kind: int = F64) -> int:
        """The number of a new local."""
        self.kinds.append(kind)
        return self.arguments + len(self.kinds) - 1

    def do(self, *names: str) -> None:
        """Instructions without operands of their own."""
        self.code += bytes(INSTRUCTIONS[name] for name in names)

    def get(self, number: int) -> None:
        """Push a local."""
        self.code += b"\x20" + unsigned(number)

    def set(self, number: int) -> None:
        """Pop into a local."""
        self.code += b"\x21" + unsigned(number)

    def tee(self, number: int) -> None:
        """Copy the top of the stack into a local."""
        self.code += b"\x22" + unsigned(number)

    def number(self, value: float) -> None:
        """Push a double."""
        self.code += b"\x44" + struct.pack("<d", value)

    def integer(self, value: int) -> None:
        """Push an i32."""
        self.code += b"\x41" + signed(value)

    def load(self, offset: int) -> None:
        """Replace an address by the double at address + offset."""
        self.code += b"\x2b\x03" + unsigned(offset)

    def store(self, offset: int) -> None:
        """Pop a double and an address, write to address + offset."""
        self.code += b"\x39\x03" + unsigned(offset)

    def load_integer(self, offset: int) -> None:
        """Replace an address by the i32 at address + offset."""
        self.code += b"\x28\x02" + unsigned(offset)

    def call(self, function: int) -> None:
        """Call a function by its number."""
        self.code += b"\x10" + unsigned(function)

    def begin_if(self) -> None:
        """Pop a condition; up to ``end``."""
        self.code += b"\x04\x40"

    def begin_loop(self) -> None:
        """Up to ``end``; :meth:`again` begins anew."""
        self.code += b"\x03\x40"

    def again(self) -> None:
        """Pop a condition, begin the innermost loop anew if it holds."""
        self.code += b"\x0d\x00"

    def fill(self) -> None:
        """memory.fill: pop size, byte, address."""
        self.code += b"\xfc\x0b\x00"

    def encoded(self) -> bytes:
        """Locals in runs of one type, code, end; with the size in front."""
        runs: list[list[int]] = []
        for kind in self.kinds:
            if runs and runs[-1][1] == kind:
                runs[-1][0] += 1
            else:
                runs.append([1, kind])
        content = sequence([unsigned(n) + bytes([kind]) for n, kind in runs]) + bytes(self.code) + b"\x0b"
        return unsigned(len(content)) + content
