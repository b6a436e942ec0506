"""Programs as they are stored: their canonical bytes, compressed where they were made, which takes its time."""

from __future__ import annotations

from zlib_ng import zlib_ng

from substructures.expr.program import Program

#: half of the time that zlib takes for it, for fewer bytes; the usual 6 takes three times as long for a thirtieth less
LEVEL = 3


def pack(program: Program) -> bytes:
    """The canonical bytes of a program, compressed (RFC 1950)."""
    return zlib_ng.compress(program.to_bytes(), LEVEL)


def unpack(content: bytes) -> bytes:
    """The canonical bytes of a packed program. Raises ValueError for what is none."""
    try:
        return zlib_ng.decompress(content)
    except zlib_ng.error as error:  # type: ignore[misc]  # its stubs do not say that it is an exception
        raise ValueError(str(error)) from None
