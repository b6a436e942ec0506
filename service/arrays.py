"""npz in and out. Nothing is unpickled, and no header is believed before it fits the bytes that follow it."""

from __future__ import annotations

import io
import math
import struct
import zipfile
from collections.abc import Iterable, Iterator, Mapping
from dataclasses import dataclass
from typing import IO, Any

import numpy as np
from numpy.lib import format as npy
from numpy.typing import NDArray

from substructures.errors import InvalidDocument, TooLarge

MEDIA_TYPE = "application/x-npz"
KINDS = "biufU"  # booleans, integers, floats, text
MAX_ARRAYS = 10_000
MAX_HEADER = 10_000  # bytes
SMALL = 2**16  # bytes; shorter pieces are put together


def read_npz(file: IO[bytes], limit: int) -> dict[str, np.ndarray[Any, Any]]:
    """The arrays of an npz file of at most ``limit`` bytes unpacked. Raises InvalidDocument naming the array."""
    try:
        with zipfile.ZipFile(file) as archive:
            members = archive.infolist()
            if len(members) > MAX_ARRAYS:
                raise TooLarge("the number of arrays", len(members), MAX_ARRAYS)
            size = sum(member.file_size for member in members)
            if size > limit:
                raise TooLarge("the unpacked npz file", size, limit)
            # reading stops at the size that the directory gives, so a false one cannot unpack to more
            return {m.filename.removesuffix(".npy"): _array(m.filename, archive.read(m)) for m in members}
    except (zipfile.BadZipFile, NotImplementedError, RuntimeError, EOFError, OSError) as error:
        raise InvalidDocument.at("", "npz", f"not an npz file: {error}") from None


def view_npz(data: NDArray[np.uint8]) -> dict[str, np.ndarray[Any, Any]]:
    """The arrays of an uncompressed npz file in memory, where they lie; check sums are passed over."""
    result = {}
    with zipfile.ZipFile(io.BufferedReader(_Memory(data))) as archive:
        for found in archive.infolist():
            # the local header: 26 bytes, lengths of the name and of the extra field, both of these, the data
            name, extra = struct.unpack_from("<HH", data.data, found.header_offset + 26)
            start = found.header_offset + 30 + name + extra
            array = _array(found.filename, data[start : start + found.file_size].data)
            result[found.filename.removesuffix(".npy")] = array
    return result


class _Memory(io.RawIOBase):
    """Bytes in memory as a file."""

    def __init__(self, data: NDArray[np.uint8]) -> None:
        self._data, self._position = data, 0

    def readable(self) -> bool:
        return True

    def seekable(self) -> bool:
        return True

    def seek(self, offset: int, whence: int = io.SEEK_SET) -> int:
        self._position = offset + (0, self._position, len(self._data))[whence]
        return self._position

    def readinto(self, buffer: Any) -> int:
        part = self._data[self._position : self._position + len(buffer)]
        buffer[: len(part)] = part.data
        self._position += len(part)
        return len(part)


def _array(name: str, data: bytes | memoryview) -> np.ndarray[Any, Any]:
    stream = io.BytesIO(data[:MAX_HEADER])
    pointer = "/" + name.removesuffix(".npy").replace("~", "~0").replace("/", "~1")
    try:
        version = npy.read_magic(stream)
        read_header = npy.read_array_header_1_0 if version == (1, 0) else npy.read_array_header_2_0
        shape, fortran, dtype = read_header(stream, max_header_size=MAX_HEADER)
    except ValueError as error:
        raise InvalidDocument.at(pointer, "npy", f"not an npy array: {error}") from None
    if dtype.kind not in KINDS:
        raise InvalidDocument.at(pointer, "dtype", f"arrays of type {dtype} are not accepted")
    start = stream.tell()
    if math.prod(shape) * dtype.itemsize != len(data) - start or any(n < 0 for n in shape):
        raise InvalidDocument.at(pointer, "npy", f"shape {shape} does not fit {len(data) - start} bytes")
    flat = np.frombuffer(data, dtype, math.prod(shape), start) if math.prod(shape) else np.zeros(0, dtype)
    return np.require(flat.reshape(shape, order="F" if fortran else "C"), requirements="A")


@dataclass(frozen=True, slots=True)
class Member:
    """An array of an npz file whose rows come in ``parts``."""

    name: str
    shape: tuple[int, ...]
    dtype: np.dtype[Any]
    parts: Iterable[np.ndarray[Any, Any]]


def member(name: str, value: Any) -> Member:
    """An array that is complete."""
    array = np.asarray(value)
    if array.dtype.kind not in KINDS:
        raise TypeError(f"'{name}' is no array of numbers or texts")
    return Member(name, array.shape, array.dtype, (array,))


def npz_pieces(members: Iterable[Member]) -> Iterator[memoryview]:
    """An uncompressed npz file, piece by piece; arrays are not copied. Sizes follow the data, as in any zip that is
    written to a pipe.
    """
    sink = _Sink()
    with zipfile.ZipFile(sink, "w", zipfile.ZIP_STORED) as archive:
        for each in members:
            is_large = math.prod(each.shape) * each.dtype.itemsize >= zipfile.ZIP64_LIMIT
            with archive.open(f"{each.name}.npy", "w", force_zip64=is_large) as file:
                file.write(_npy_header(each))
                for part in each.parts:
                    file.write(np.ascontiguousarray(part).reshape(-1).view(np.uint8).data)
                    yield from sink.taken()
    yield from sink.taken()


def _npy_header(each: Member) -> bytes:
    header = io.BytesIO()
    fields = {"descr": npy.dtype_to_descr(each.dtype), "fortran_order": False, "shape": each.shape}
    npy.write_array_header_1_0(header, fields)
    return header.getvalue()


class _Sink(io.RawIOBase):
    """What is written, as it is; like a pipe it cannot go back."""

    def __init__(self) -> None:
        self._pieces: list[memoryview] = []
        self._small = bytearray()

    def writable(self) -> bool:
        return True

    def write(self, data: Any) -> int:
        view = memoryview(data)
        if view.nbytes < SMALL:
            self._small += view
        else:
            self._pieces += [*self._gathered(), view]
        return view.nbytes

    def taken(self) -> list[memoryview]:
        """What was written since the last time."""
        pieces, self._pieces = [*self._pieces, *self._gathered()], []
        return pieces

    def _gathered(self) -> list[memoryview]:
        small, self._small = self._small, bytearray()
        return [memoryview(small)] if small else []


def flat(value: Mapping[str, Any], prefix: str = "") -> dict[str, Any]:
    """Nested mappings as one, names joined by dots."""
    result: dict[str, Any] = {}
    for name, item in value.items():
        if isinstance(item, Mapping):
            result.update(flat(item, f"{prefix}{name}."))
        elif item is not None:
            result[prefix + name] = item
    return result


def nested(columns: Mapping[str, Any]) -> dict[str, Any]:
    """The inverse of :func:`flat`, for names with at most one dot."""
    result: dict[str, Any] = {}
    for name, item in columns.items():
        group, _, key = name.partition(".")
        if key:
            result.setdefault(group, {})[key] = item
        else:
            result[name] = item
    return result


def as_npz(result: Mapping[str, Any]) -> bytes:
    """The answer of an evaluation as npz; nested names are joined by dots, ``failures`` become parallel arrays."""
    failures = result["failures"]
    columns = {key: [str(f[key]) for f in failures] for key in ("quantity", "code", "message")}
    values = flat({**result, "failures": {"state": [f["state"] for f in failures], **columns}})
    return b"".join(npz_pieces(member(name, value) for name, value in values.items()))
