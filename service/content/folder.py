"""Definitions in the files of a folder: which files there are, and what each says. Nothing outside of it is read."""

from __future__ import annotations

import os
import stat
from collections.abc import Iterable, Mapping
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

from service.schemas.entries import PartEntry
from substructures.documents import DOCUMENTS, located, read_json, read_yaml, require_object
from substructures.documents.tables import TABLES, with_tables
from substructures.errors import Fault, InvalidDocument, InvalidInput
from substructures.part.definition import Definition

HIDDEN = "."  # how names begin that are left out, such as .git
#: never through a link that was put there meanwhile, and never to wait for who writes a pipe
_FLAGS = os.O_RDONLY | sum(getattr(os, name, 0) for name in ("O_BINARY", "O_NOFOLLOW", "O_NONBLOCK"))

#: times of change, size and number of a file, and of the files that it names; without them where there is none
Stamp = tuple[tuple[int, ...], ...]


@dataclass
class Listing:
    """What is in a folder, by names relative to it: ``files``, each at its place, that may be definitions; ``refused``:
    what is not looked at, and why; ``others``: what is no definition. ``is_whole``: all folders in it could be listed.
    """

    root: Path
    files: dict[str, Path] = field(default_factory=dict)
    refused: dict[str, Fault] = field(default_factory=dict)
    others: list[str] = field(default_factory=list)
    is_whole: bool = True

    def fail(self, error: OSError) -> None:
        """Note a folder that cannot be listed."""
        name = Path(error.filename).relative_to(self.root).as_posix()
        self.refused[name] = Fault("", "unreadable", f"cannot be read: {error.strerror}")
        self.is_whole = False

    def enter(self, name: str, path: Path) -> None:
        """Note a file, or a link to whatever it is."""
        is_document = name.lower().endswith(DOCUMENTS)
        if not path.is_symlink():
            self._note(name, path, is_document)
            return
        file = Path(os.path.realpath(path))
        is_folder = file.is_dir()
        if file.is_relative_to(self.root):
            self._note(name, file, is_document and not is_folder)  # what is in a folder is listed there
        elif is_document or is_folder:
            self.refused[name] = Fault("", "leads-out", "a link that leads out of the folder is not followed")
        else:
            self.others.append(name)

    def _note(self, name: str, file: Path, is_document: bool) -> None:
        if is_document:
            self.files[name] = file
        else:
            self.others.append(name)


def listed(folder: Path) -> Listing:
    """What is in a folder and in those within it."""
    found = Listing(folder.resolve())
    for place, folders, files in os.walk(found.root, onerror=found.fail):
        here = Path(place)
        prefix = "" if here == found.root else f"{here.relative_to(found.root).as_posix()}/"
        folders[:] = sorted(name for name in folders if not name.startswith(HIDDEN))
        links = [name for name in folders if (here / name).is_symlink()]
        for name in sorted((*files, *links)):
            if not name.startswith(HIDDEN):
                found.enter(prefix + name, here / name)
    own = {file for name, file in found.files.items() if found.root / name == file}
    for name, file in list(found.files.items()):
        if file in own and found.root / name != file:  # a second name of a file that is there
            del found.files[name]
            found.others.append(name)
    return found


def stamp(files: Iterable[Path]) -> Stamp:
    """What changes when files do."""
    return tuple(map(_stamp, files))


def _stamp(file: Path) -> tuple[int, ...]:
    try:
        found = file.stat()
    except OSError:
        return ()
    return found.st_mtime_ns, found.st_ctime_ns, found.st_size, found.st_ino


def content_of(file: Path, most: int) -> bytes:
    """The bytes of a file. Raises InvalidDocument for what cannot be read, is no file or has more of them."""
    try:
        with os.fdopen(os.open(file, _FLAGS), "rb") as opened:
            if not stat.S_ISREG(os.fstat(opened.fileno()).st_mode):
                raise InvalidDocument.at("", "no-file", "neither a file nor a folder")
            data = opened.read(most + 1)
    except OSError as error:
        raise InvalidDocument.at("", "unreadable", f"cannot be read: {error.strerror}") from None
    _check_size(len(data), most)
    return data


def _check_size(size: int, most: int) -> None:
    if size > most:
        raise InvalidDocument.at(
            "", "too-large", f"more than {most:,} bytes with its tables, the limit of a definition"
        )


@dataclass(frozen=True)
class Read:
    """What a file says: a definition, and what it is submitted with, or ``faults``; ``uses``: files that it names."""

    definition: Definition | None = None
    entry: PartEntry = field(default_factory=PartEntry)
    faults: tuple[Fault, ...] = ()
    uses: tuple[Path, ...] = ()


def read(file: Path, most: int) -> Read:
    """What a file of at most so many bytes says."""
    data, uses = b"", tuple[Path, ...]()
    try:
        data = content_of(file, most)
        document = read_json(data) if file.suffix.lower() == ".json" else read_yaml(data)
        require_object(document)
        uses = tuple(_uses(document, file.parent))
        _check_size(len(data) + sum(size for _, _, size, _ in filter(None, stamp(uses))), most)
        entry, given = PartEntry.parted(with_tables(document, file.parent))
        return Read(Definition.read(given), entry, uses=uses)
    except InvalidInput as error:
        return Read(faults=tuple(located(error.faults, data)), uses=uses)


def _uses(document: Mapping[str, Any], folder: Path) -> Iterable[Path]:
    """The files of tables, those that are not there, too."""
    tables = document.get(TABLES)
    for each in tables.values() if isinstance(tables, Mapping) else ():
        name = each.get("file") if isinstance(each, Mapping) else None
        if isinstance(name, str) and "\0" not in name and (file := (folder / name).resolve()).is_relative_to(folder):
            yield file
