"""npz files written array by array, uncompressed: whole ones, and one whose numbers come in parts.

Numbers start at multiples of 64 bytes, so that they can be used where they lie. Source: APPNOTE.TXT 6.3, sections 4.3.7
(header of a file), 4.3.9 (data descriptor, behind a file whose check sum was not known before), 4.3.12 (directory).
"""

from __future__ import annotations

import io
import struct
import zipfile
from math import prod
from typing import Any

import numpy as np
from numpy.lib import format as npy
from numpy.typing import NDArray
from zlib_ng.zlib_ng import crc32

KINDS = "biufU"  # booleans, integers, floats, text
ALIGNMENT = 64  # bytes
# of a zip file: a header before each file, what may stand behind it, a line of the directory, its end, a field that
# other readers pass over
LOCAL, DESCRIPTOR = struct.Struct("<4s5H3I2H"), struct.Struct("<4s3I")
LISTED, END, PADDING = struct.Struct("<4s6H3I5H2I"), struct.Struct("<4s4H2IH"), struct.Struct("<2H")
VERSION, UTF_8, DESCRIBED, FIRST_DAY, PADDING_ID = 20, 0x800, 8, 0x21, 0xD935  # 2.0; 1 January 1980; as zipalign's
UNIX, READABLE = 3 << 8, 0o644 << 16  # whose names and permissions these are


class NpzWriter:
    """Gives the pieces of a file one after the other. Arrays are not copied.

    All methods raise TypeError for an array that is none of numbers or texts, ValueError for 2 GiB and more.
    """

    def __init__(self) -> None:
        self.size = 0  # bytes so far
        self._directory, self._count = bytearray(), 0
        self._name, self._start, self._checked, self._length = b"", 0, 0, 0

    def whole(self, name: str, array: NDArray[Any]) -> list[memoryview]:
        """One array."""
        header = memoryview(self._header(name, array.shape, array.dtype))
        data = _bytes(np.asarray(array, order="C"))
        self._add(header)
        self._add(data)
        local = self._local(UTF_8, self._checked, self._length)
        self._list(UTF_8)
        return [memoryview(local + header), data]

    def begin(self, name: str, shape: tuple[int, ...], dtype: np.dtype[Any]) -> memoryview:
        """Begin an array whose numbers come by :meth:`go_on`, until :meth:`end`."""
        header = self._header(name, shape, dtype)
        self._add(memoryview(header))
        return memoryview(self._local(UTF_8 | DESCRIBED, 0, 0) + header)

    def go_on(self, part: NDArray[Any]) -> memoryview:
        """The next numbers, row by row."""
        data = _bytes(np.asarray(part, order="C"))
        self._add(data)
        return data

    def end(self) -> memoryview:
        """What stands behind the array that was begun."""
        descriptor = DESCRIPTOR.pack(b"PK\7\10", self._checked, self._length, self._length)
        self._list(UTF_8 | DESCRIBED)
        self.size += len(descriptor)
        return memoryview(descriptor)

    def directory(self) -> memoryview:
        """The end of the file."""
        end = END.pack(b"PK\5\6", 0, 0, self._count, self._count, len(self._directory), self.size, 0)
        self.size += len(self._directory) + len(end)
        return memoryview(self._directory + end)

    def _header(self, name: str, shape: tuple[int, ...], dtype: np.dtype[Any]) -> bytes:
        """Begin a file, and give the header of its array."""
        if dtype.kind not in KINDS:
            raise TypeError(f"'{name}' is no array of numbers or texts")
        header = io.BytesIO()
        described = {"descr": npy.dtype_to_descr(dtype), "fortran_order": False, "shape": shape}
        npy.write_array_header_1_0(header, described)
        self._name, self._start, self._checked, self._length = f"{name}.npy".encode(), self.size, 0, 0
        if self.size + prod(shape) * dtype.itemsize > zipfile.ZIP64_LIMIT:  # beyond it there are other fields
            raise ValueError(f"'{name}' makes an npz file too long to be sent")
        return header.getvalue()

    def _add(self, data: memoryview) -> None:
        self._checked = crc32(data, self._checked)
        self._length += len(data)

    def _local(self, flags: int, checked: int, length: int) -> bytes:
        """What stands before a file, and the place where it begins in the whole."""
        start = self._start + LOCAL.size + len(self._name) + PADDING.size
        padding = PADDING.pack(PADDING_ID, -start % ALIGNMENT) + bytes(-start % ALIGNMENT)
        common = (VERSION, flags, zipfile.ZIP_STORED, 0, FIRST_DAY, checked, length, length, len(self._name))
        local = LOCAL.pack(b"PK\3\4", *common, len(padding)) + self._name + padding
        self.size += len(local)
        return local

    def _list(self, flags: int) -> None:
        """The line of a file that has ended in the directory."""
        common = (VERSION, flags, zipfile.ZIP_STORED, 0, FIRST_DAY, self._checked, self._length, self._length)
        listed = LISTED.pack(
            b"PK\1\2", UNIX | VERSION, *common, len(self._name), 0, 0, 0, 0, READABLE, self._start
        )  # fmt: skip
        self._directory += listed + self._name
        self._count += 1
        self.size += self._length


def _bytes(array: NDArray[Any]) -> memoryview:
    return array.reshape(-1).view(np.uint8).data
