"""npz in and out. Nothing is unpickled, and no header is believed before it fits the bytes that follow it."""

from __future__ import annotations

import io
import math
import zipfile
from collections.abc import Mapping
from typing import Any

import numpy as np
from numpy.lib import format as npy

from substructures.errors import InvalidDocument, TooLarge

KINDS = "biufU"  # booleans, integers, floats, text
MAX_ARRAYS = 10_000


def read_npz(data: bytes, limit: int) -> dict[str, np.ndarray[Any, Any]]:
    """The arrays of an npz file of at most ``limit`` bytes unpacked. Raises InvalidDocument naming the array."""
    try:
        with zipfile.ZipFile(io.BytesIO(data)) as archive:
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


def _array(name: str, data: bytes) -> np.ndarray[Any, Any]:
    stream = io.BytesIO(data)
    pointer = "/" + name.removesuffix(".npy").replace("~", "~0").replace("/", "~1")
    try:
        version = npy.read_magic(stream)
        read_header = npy.read_array_header_1_0 if version == (1, 0) else npy.read_array_header_2_0
        shape, fortran, dtype = read_header(stream, max_header_size=10_000)
    except ValueError as error:
        raise InvalidDocument.at(pointer, "npy", f"not an npy array: {error}") from None
    if dtype.kind not in KINDS:
        raise InvalidDocument.at(pointer, "dtype", f"arrays of type {dtype} are not accepted")
    body = data[stream.tell() :]
    if math.prod(shape) * dtype.itemsize != len(body) or any(n < 0 for n in shape):
        raise InvalidDocument.at(pointer, "npy", f"shape {shape} does not fit {len(body)} bytes")
    return np.frombuffer(body, dtype).reshape(shape, order="F" if fortran else "C")


def write_npz(arrays: Mapping[str, Any]) -> bytes:
    """An uncompressed npz file."""
    stream = io.BytesIO()
    with zipfile.ZipFile(stream, "w", zipfile.ZIP_STORED) as archive:
        for name, value in arrays.items():
            member = io.BytesIO()
            npy.write_array(member, np.ascontiguousarray(value), allow_pickle=False)
            archive.writestr(f"{name}.npy", member.getvalue())
    return stream.getvalue()


def flat(value: Mapping[str, Any], prefix: str = "") -> dict[str, Any]:
    """Nested mappings as one, names joined by dots."""
    result: dict[str, Any] = {}
    for name, item in value.items():
        if isinstance(item, Mapping):
            result.update(flat(item, f"{prefix}{name}."))
        elif item is not None:
            result[prefix + name] = item
    return result


def as_npz(result: Mapping[str, Any]) -> bytes:
    """The answer of an evaluation as npz; nested names are joined by dots, ``failures`` become parallel arrays."""
    failures = result["failures"]
    columns = {key: [str(f[key]) for f in failures] for key in ("quantity", "code", "message")}
    return write_npz(flat({**result, "failures": {"state": [f["state"] for f in failures], **columns}}))
