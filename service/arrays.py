"""npz in and out. Nothing is unpickled, and no header is believed before it fits the bytes that follow it."""

from __future__ import annotations

import io
import math
import struct
import zipfile
from collections.abc import Iterator, Mapping
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
PIECE = 2**20  # bytes at a time: the check sum is taken, and the piece sent, while it is in the cache


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
class Npz:
    """An uncompressed npz file to be sent: its length, and its pieces, which are made one after the other. Arrays are
    not copied. Sizes and check sums follow the data, as in any zip that is written to a pipe.
    """

    size: int
    pieces: Iterator[memoryview]


def write_npz(arrays: Mapping[str, Any]) -> Npz:
    """Arrays of numbers and texts as npz. Raises TypeError for others, ValueError for 2 GiB and more."""
    found = {name: np.asarray(value, order="C") for name, value in arrays.items()}
    for name, array in found.items():
        if array.dtype.kind not in KINDS:
            raise TypeError(f"'{name}' is no array of numbers or texts")
    data = sum(array.nbytes for array in found.values())
    if data > zipfile.ZIP64_LIMIT:  # beyond it the directory has fields of other lengths
        raise ValueError(f"{data} bytes are too many for an npz file to be sent")
    return Npz(sum(map(len, _pieces(found, with_data=False))) + data, _pieces(found, with_data=True))


def _pieces(arrays: Mapping[str, np.ndarray[Any, Any]], with_data: bool) -> Iterator[memoryview]:
    sink = _Sink()
    with zipfile.ZipFile(sink, "w", zipfile.ZIP_STORED) as archive:
        for name, array in arrays.items():
            with archive.open(f"{name}.npy", "w") as file:
                npy.write_array_header_1_0(file, npy.header_data_from_array_1_0(array))
                data = array.reshape(-1).view(np.uint8).data
                for start in range(0, array.nbytes if with_data else 0, PIECE):
                    file.write(data[start : start + PIECE])
                    yield from sink.taken()
    yield from sink.taken()


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


def as_npz(answer: Mapping[str, Any]) -> Npz:
    """The answer as npz: arrays by name, nested names joined by dots, ``failures`` as parallel arrays."""
    rows = answer["failures"]
    failures = {"state": np.array([row["state"] for row in rows], np.int64)}
    failures |= {key: np.array([row[key] for row in rows], np.str_) for key in ("quantity", "code", "message")}
    return write_npz(flat({**answer, "failures": failures}))


def as_answer(arrays: Mapping[str, np.ndarray[Any, Any]]) -> dict[str, Any]:
    """The inverse of :func:`as_npz`: the answer as JSON would have it, with arrays for the quantities."""
    result = nested({name: a if a.dtype.kind == "f" else a.tolist() for name, a in arrays.items()})
    failures = result["failures"]
    rows = zip(*failures.values(), strict=True)
    return {**result, "failures": [dict(zip(failures, row, strict=True)) for row in rows]}
