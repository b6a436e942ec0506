"""The files of a zip from outside: read into memory and nowhere else, and no further than they may be long.

What its directory says of sizes is not believed; what it says of anything but plain files is refused.
"""

from __future__ import annotations

import stat
import zipfile
from collections.abc import Callable
from typing import IO

from service.messages.refusals import Refused, unprocessable
from substructures.documents import pointer_step
from substructures.errors import TooLarge
from substructures.formats.arrays import DAMAGED, ENCRYPTED, check_directory

PIECE = 2**16  # bytes that are unpacked at a time
SHOWN = 100  # characters of a name


def unzipped(file: IO[bytes], most_files: int, most_bytes: int, limit: Callable[[str], int]) -> dict[str, bytes]:
    """Contents by name; ``most_bytes``: of all together, ``limit``: of the file of a name, both unpacked.

    Raises Refused 422 with a pointer to the file.
    """
    found: dict[str, bytes] = {}
    left = most_bytes
    try:
        check_directory(file, "bundle")
        with zipfile.ZipFile(file) as archive:
            members = archive.infolist()
            if len(members) > most_files:
                raise too_large("", "the number of files", len(members), most_files)
            for member in members:
                _check(member, found)
                found[member.filename] = _read(archive, member, min(left, limit(member.filename)))
                left -= len(found[member.filename])
    except TooLarge as error:
        raise too_large("", error.what, error.size, error.limit) from None
    except DAMAGED as error:
        raise invalid("", f"not a zip that can be read: {error}") from None
    return found


def invalid(name: str, message: str) -> Refused:
    """422: a bundle that is none, with a pointer to the file."""
    place = f"{name[:SHOWN]}: " if name else ""
    return unprocessable("invalid-bundle", f"{place}{message}; nothing was stored", file_pointer(name))


def too_large(name: str, what: str, size: int, limit: int) -> Refused:
    """422: over a limit, with a pointer to the file."""
    detail = f"{what}: {size:,}; the limit is {limit:,}; nothing was stored"
    return unprocessable("too-large", detail, file_pointer(name), what=what, size=size, limit=limit)


def file_pointer(name: str) -> str:
    """The pointer to a file inside of a bundle: its path, with a slash before it."""
    return "".join(pointer_step(step) for step in name[:SHOWN].split("/")) if name else ""


def _check(member: zipfile.ZipInfo, found: dict[str, bytes]) -> None:
    """Raise Refused for what is no plain file with a name of its own below the root of the zip."""
    name, mode = member.filename, member.external_attr >> 16
    if name.startswith("/") or ":" in name or "\\" in name or {"", ".", ".."} & set(name.rstrip("/").split("/")):
        raise invalid(name, "the path of a file leads out of the bundle, or is none")
    if member.is_dir() or (stat.S_IFMT(mode) and not stat.S_ISREG(mode)):
        raise invalid(name, "a link, a folder or a device; there are plain files alone in a bundle")
    if name in found:
        raise invalid(name, "the bundle has this file twice")
    if member.flag_bits & ENCRYPTED or member.compress_type not in (zipfile.ZIP_STORED, zipfile.ZIP_DEFLATED):
        raise invalid(name, "encrypted, or packed in another way than by deflate")


def _read(archive: zipfile.ZipFile, member: zipfile.ZipInfo, limit: int) -> bytes:
    """The bytes of a file, unpacked piece by piece."""
    data = bytearray()
    with archive.open(member) as file:
        while piece := file.read(PIECE):
            data += piece
            if len(data) > limit:
                raise too_large(member.filename, "an unpacked file (in bytes)", len(data), limit)
    return bytes(data)
