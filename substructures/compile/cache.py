"""Compiled kernels in a folder: found by what they were compiled from, for and with; damaged entries are ignored.

A file holds a mark, the SHA-256 of all that follows, a line of JSON (key, and how to run the functions) and the object
code. Nothing is loaded into executable memory whose checksum or key does not match. The folder must be writable by its
owner only: whoever can write there can run code.
"""

from __future__ import annotations

import contextlib
import hashlib
import json
import os
import tempfile
from pathlib import Path
from typing import Any

#: of the file format and of everything that decides about the machine code; raise it with every change of either
VERSION = 7
MARK = b"substructures kernel\n"


def key(digest: str, names: tuple[str, ...], host: str) -> str:
    """Digest of program, outputs, host, compiler and the version of this package's code generator."""
    document = json.dumps([VERSION, digest, names, host], separators=(",", ":"))
    return hashlib.sha256(document.encode()).hexdigest()


def read(folder: Path, wanted: str) -> tuple[Any, bytes] | None:
    """Plain data and object code, or None when there is no such entry or it is damaged."""
    try:
        data = _path(folder, wanted).read_bytes()
    except OSError:
        return None
    start = len(MARK) + 65
    if data[: len(MARK)] != MARK or data[len(MARK) : start] != _checksum(data[start:]):
        return None
    line, _, code = data[start:].partition(b"\n")
    with contextlib.suppress(OSError):
        os.utime(_path(folder, wanted))  # it was used now
    try:
        head = json.loads(line)
        return (head["data"], code) if head["key"] == wanted and code else None
    except (ValueError, KeyError, TypeError):
        return None


def write(folder: Path, wanted: str, plain: Any, code: bytes) -> None:
    """Stores an entry in one step, so that a reader never sees half of it. A full or read-only disk is no error."""
    head = json.dumps({"key": wanted, "data": plain}, separators=(",", ":"))
    body = head.encode() + b"\n" + code
    with contextlib.suppress(OSError):
        folder.mkdir(parents=True, exist_ok=True, mode=0o700)
        handle, name = tempfile.mkstemp(dir=folder, prefix=".new-")
        try:
            with os.fdopen(handle, "wb") as file:
                file.write(MARK + _checksum(body) + body)
            Path(name).replace(_path(folder, wanted))
        except BaseException:
            Path(name).unlink(missing_ok=True)
            raise


def prune(folder: Path, most: int) -> None:
    """Remove entries until all take at most so many bytes, beginning with those that were used least lately."""
    with contextlib.suppress(OSError):
        found = [(entry, entry.stat()) for entry in os.scandir(folder) if entry.name.endswith(".kernel")]
        size = sum(each.st_size for _, each in found)
        for entry, each in sorted(found, key=lambda one: one[1].st_mtime_ns):
            if size <= most:
                return
            Path(entry.path).unlink(missing_ok=True)
            size -= each.st_size


def _checksum(body: bytes) -> bytes:
    return hashlib.sha256(body).hexdigest().encode() + b"\n"


def _path(folder: Path, wanted: str) -> Path:
    return folder / f"{wanted}.kernel"
