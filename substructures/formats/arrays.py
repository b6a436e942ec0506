"""npz in and out. Nothing is unpickled, and no header is believed before it fits the bytes that follow it."""

from __future__ import annotations

import io
import math
import re
import struct
import zipfile
import zlib
from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from itertools import chain
from typing import IO, Any

import numpy as np
from numpy.lib import format as npy
from numpy.typing import NDArray
from zlib_ng.zlib_ng import crc32

from substructures.errors import InvalidDocument, TooLarge
from substructures.formats.npz_writer import END, KINDS, LOCAL, NpzWriter

MEDIA_TYPE = "application/x-npz"
#: what an answer says about states, and the fields that it has beside state, quantity, code and message
NOTES: dict[str, tuple[str, ...]] = {"failures": (), "warnings": ("pointer",)}
MAX_ARRAYS = 10_000
MAX_HEADER = 10_000  # bytes
MAX_LISTED = 2**21  # bytes of the directory of a zip file, for which its reader takes many times as much memory
ENCRYPTED = 1  # the flag of a file in a zip
MAX_DIMENSIONS = 32
#: an entry of the header of an array, which is a dictionary of Python; there is no need to read any other literal
_ENTRY = re.compile(
    r"""\s*(['"])(descr|fortran_order|shape)\1\s*:\s*"""
    r"""(?:(['"])([<>|=]?[A-Za-z?][0-9]{0,9})\3|(True|False)|\(([0-9L,\s]*)\))\s*(?:,|(?=\}))"""
)
_LENGTH = re.compile(r"[0-9]{1,18}L?")
#: what the standard library raises for a damaged zip file
DAMAGED = (zipfile.BadZipFile, RuntimeError, EOFError, OSError, ValueError, struct.error, zlib.error)


def read_npz(file: IO[bytes], limit: int) -> dict[str, np.ndarray[Any, Any]]:
    """The arrays of an npz file of at most ``limit`` bytes unpacked. Raises InvalidDocument naming the array."""
    try:
        check_directory(file, "npz file")
        with zipfile.ZipFile(file) as archive:
            members = archive.infolist()
            if len(members) > MAX_ARRAYS:
                raise TooLarge("the number of arrays", len(members), MAX_ARRAYS)
            size = sum(member.file_size for member in members)
            if size > limit:
                raise TooLarge("the unpacked npz file", size, limit)
            return {m.filename.removesuffix(".npy"): _array(m.filename, _read(archive, m, file)) for m in members}
    except DAMAGED as error:
        raise InvalidDocument.at("", "npz", f"not an npz file: {error}") from None


def _read(archive: zipfile.ZipFile, member: zipfile.ZipInfo, file: IO[bytes]) -> bytes:
    """A file in a zip, no longer than its directory says; if it is not compressed, in a third of the library's time."""
    if member.compress_type not in (zipfile.ZIP_STORED, zipfile.ZIP_DEFLATED):  # others unpack into any memory
        raise zipfile.BadZipFile(f"'{member.filename}' is packed in a way that npz files do not have")
    if member.compress_type != zipfile.ZIP_STORED or member.flag_bits & ENCRYPTED:
        return archive.read(member)
    file.seek(member.header_offset)
    file.seek(_after_header(member, file.read(LOCAL.size)))
    data = file.read(member.file_size)
    if crc32(data) != member.CRC:
        raise zipfile.BadZipFile(f"wrong check sum of '{member.filename}'")
    return data


def check_directory(file: IO[bytes], what: str) -> None:
    """Refuse a directory of a zip that is larger than that of any npz file, before it is read. Raises BadZipFile,
    TooLarge.
    """
    size = file.seek(0, io.SEEK_END)
    file.seek(max(0, size - END.size - 2**16))
    tail = file.read()
    place = tail.rfind(b"PK\5\6")
    if place < 0 or place + END.size > len(tail):
        raise zipfile.BadZipFile("it has no directory")
    listed = END.unpack_from(tail, place)[5]
    if listed > MAX_LISTED or tail[:place].endswith(b"PK\6\7", max(0, place - 20), max(0, place - 16)):
        raise TooLarge(f"the directory of the {what} (in bytes)", listed, MAX_LISTED)
    file.seek(0)


def _after_header(member: zipfile.ZipInfo, header: bytes | memoryview) -> int:
    """Where the data of a file in a zip begin."""
    *_, name, extra = LOCAL.unpack(header)
    return int(member.header_offset + LOCAL.size + name + extra)


def view_npz(data: NDArray[np.uint8]) -> dict[str, np.ndarray[Any, Any]]:
    """The arrays of an uncompressed npz file in memory, where they lie; check sums are passed over."""
    result = {}
    with zipfile.ZipFile(io.BufferedReader(_Memory(data))) as archive:
        for found in archive.infolist():
            start = _after_header(found, data[found.header_offset :][: LOCAL.size].data)
            array = _array(found.filename, data[start : start + found.file_size].data)
            result[found.filename.removesuffix(".npy")] = array
    return result


class _Memory(io.RawIOBase):
    """Bytes in memory as a file."""

    def __init__(self, data: NDArray[np.uint8]) -> None:
        self._data, self._position = data, 0

    def readable(self) -> bool:
        """Yes."""
        return True

    def seekable(self) -> bool:
        """Yes."""
        return True

    def seek(self, offset: int, whence: int = io.SEEK_SET) -> int:
        """Move to a place in the bytes."""
        self._position = offset + (0, self._position, len(self._data))[whence]
        return self._position

    def readinto(self, buffer: Any) -> int:
        """Copy from the place at hand."""
        part = self._data[self._position : self._position + len(buffer)]
        buffer[: len(part)] = part.data
        self._position += len(part)
        return len(part)


def _array(name: str, data: bytes | memoryview) -> np.ndarray[Any, Any]:
    pointer = "/" + name.removesuffix(".npy").replace("~", "~0").replace("/", "~1")
    try:
        shape, fortran, dtype, start = _header(io.BytesIO(data[:MAX_HEADER]))
    except (ValueError, TypeError, OverflowError, struct.error) as error:
        raise InvalidDocument.at(pointer, "npy", f"not an npy array: {str(error)[:80]}") from None
    if dtype.kind not in KINDS:
        raise InvalidDocument.at(pointer, "dtype", f"arrays of type {dtype} are not accepted")
    if math.prod(shape) * dtype.itemsize != len(data) - start:
        raise InvalidDocument.at(pointer, "npy", f"shape {shape} does not fit {len(data) - start} bytes")
    flat = np.frombuffer(data, dtype, math.prod(shape), start) if math.prod(shape) else np.zeros(0, dtype)
    return np.require(flat.reshape(shape, order="F" if fortran else "C"), requirements="A")


def _header(stream: io.BytesIO) -> tuple[tuple[int, ...], bool, np.dtype[Any], int]:
    """Shape, order (Fortran's?), type and beginning of the data. Raises ValueError and the like."""
    length = struct.Struct("<H" if npy.read_magic(stream) == (1, 0) else "<I")
    size = length.unpack(stream.read(length.size))[0]
    text = stream.read(size)
    if len(text) < size:
        raise ValueError("its header is longer than the file, or than any")
    found, inside = dict[str, str](), text.decode("latin1").strip()
    end = int(inside.startswith("{"))
    while place := _ENTRY.match(inside, end):
        _, name, _, *values = place.groups()
        found[name] = next(value for value in values if value is not None)
        end = place.end()
    if inside[end:].strip() != "}" or not end or len(found) != 3:
        raise ValueError("its header does not have 'descr', 'fortran_order' and 'shape' alone")
    lengths = [each.strip() for each in found["shape"].split(",")]
    lengths = lengths[:-1] if not lengths[-1] else lengths
    if len(lengths) > MAX_DIMENSIONS or not all(map(_LENGTH.fullmatch, lengths)):
        raise ValueError("its shape has too many numbers, or other things")
    shape = tuple(int(each.rstrip("L")) for each in lengths)
    return shape, found["fortran_order"] == "True", np.dtype(found["descr"]), stream.tell()


@dataclass(frozen=True, slots=True)
class Npz:
    """An uncompressed npz file to be sent: its length and its pieces. Arrays are not copied."""

    size: int
    pieces: Sequence[memoryview]


def write_npz(arrays: Mapping[str, Any]) -> Npz:
    """Arrays of numbers and texts as npz. Raises TypeError for others, ValueError for 2 GiB and more.

    The numbers start at multiples of 64 bytes, so that they can be used where they lie (:func:`view_npz`).
    """
    writer = NpzWriter()
    pieces = [piece for name, value in arrays.items() for piece in writer.whole(name, np.asarray(value))]
    pieces.append(writer.directory())
    return Npz(writer.size, pieces)


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
    """The answer as npz: arrays by name, nested ones joined by dots, ``failures`` and ``warnings`` parallel arrays."""
    return write_npz(flat({**answer, **parallel(answer)}))


def npz_parts(answers: Iterable[Mapping[str, Any]], names: Sequence[str], count: int) -> Iterator[memoryview]:
    """The pieces of :func:`as_npz` for an answer of ``count`` states that comes in parts, each as soon as it is there.

    The largest of the arrays ``names`` leaves part by part, the others are kept until it has ended.
    """
    rest = iter(answers)
    first = next(rest)
    columns = flat({name: first[name] for name in names})
    largest = max(columns, key=lambda name: columns[name].nbytes)
    waiting = {name: np.empty((count, *x.shape[1:]), x.dtype) for name, x in columns.items() if name != largest}
    notes: dict[str, list[dict[str, Any]]] = {name: [] for name in NOTES}
    writer, done = NpzWriter(), 0
    yield writer.begin(largest, (count, *columns[largest].shape[1:]), columns[largest].dtype)
    for answer in chain([first], rest):
        part = flat({name: answer[name] for name in names})
        yield writer.go_on(part[largest])
        for name, kept in waiting.items():
            kept[done : done + answer["count"]] = part[name]
        for kind, told in notes.items():
            told += [placed(note, done) for note in answer[kind]]
        done += answer["count"]
    yield writer.end()
    order = {name: k for k, name in enumerate(names)}
    for rows in notes.values():  # as of the whole: by quantity, then by state, behind what is about no state
        rows.sort(key=lambda row: (order[row["quantity"]], row["state"]) if "state" in row else (-1, -1))
    about = {key: x for key, x in first.items() if key not in {*names, *NOTES}} | {"count": count}
    for name, value in flat({**waiting, **about, **parallel(notes)}).items():
        yield from writer.whole(name, np.asarray(value))
    yield writer.directory()


def placed(note: Mapping[str, Any], first: int) -> dict[str, Any]:
    """What is said of a state of a part, whose first one has this number in the whole."""
    if "state" not in note:
        return dict(note)
    state = note["state"] + first
    return {**note, "state": state} | ({"pointer": f"/q/{state}"} if "pointer" in note else {})


def parallel(answer: Mapping[str, Any]) -> dict[str, dict[str, np.ndarray[Any, Any]]]:
    """What an answer says about states as parallel arrays."""
    return {name: _parallel(answer.get(name, ()), also) for name, also in NOTES.items()}


def _parallel(rows: Sequence[Mapping[str, Any]], also: tuple[str, ...]) -> dict[str, np.ndarray[Any, Any]]:
    """Rows of the same fields as arrays; state -1 and no text where a row does not have them."""
    arrays: dict[str, np.ndarray[Any, Any]] = {"state": np.array([row.get("state", -1) for row in rows], np.int64)}
    fields = ("quantity", "code", "message", *also)
    return arrays | {key: np.array([row.get(key, "") for row in rows], np.str_) for key in fields}


def as_answer(arrays: Mapping[str, np.ndarray[Any, Any]]) -> dict[str, Any]:
    """The inverse of :func:`as_npz`: the answer as JSON would have it, with arrays for the quantities."""
    result = nested({name: a if a.dtype.kind == "f" else a.tolist() for name, a in arrays.items()})
    told = {name: _rows(result[name]) for name in NOTES if name in result}
    return {**result, **told}


def _rows(columns: Mapping[str, Sequence[Any]]) -> list[dict[str, Any]]:
    """The inverse of :func:`_parallel`."""
    rows = (dict(zip(columns, row, strict=True)) for row in zip(*columns.values(), strict=True))
    return [{key: x for key, x in row.items() if x not in (-1, "")} for row in rows]
