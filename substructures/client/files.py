"""Files that are written whole or not at all."""

from __future__ import annotations

import os
import shutil
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from secrets import token_hex


@contextmanager
def whole(target: Path) -> Iterator[Path]:
    """Where to write what takes the place of a file at the end of the block, and never before: a full disk leaves what
    was there. A pipe or a device, which nothing may take the place of, is written itself, and so is a file in a folder
    that may not be written. Raises OSError with the name of the file.
    """
    try:
        if target.exists() and not (target.is_file() and os.access(target.resolve().parent, os.W_OK)):
            yield target
            return
        place = target.resolve()  # what a link leads to
        beside = place.with_name(f".{token_hex(8)}")
        try:
            yield beside
            if place.exists():
                shutil.copymode(place, beside)
            beside.replace(place)
        finally:
            beside.unlink(missing_ok=True)
    except OSError as error:
        raise type(error)(error.errno, error.strerror, str(target)) if error.errno else error from None


def save(target: Path, data: bytes) -> int:
    """Write a file as :func:`whole` says; its size in bytes."""
    with whole(target) as file:
        return file.write_bytes(data)
