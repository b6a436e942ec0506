"""Parts out of the files of a folder, such as the checkout of a repository, for as long as a server runs.

The folder is the source, the store keeps what was read: a file that is new or changed becomes a version as if it had
been submitted. Versions whose file is gone, or has the content of an earlier version again, are withdrawn, and offered
again when that is over; what others have stored or withdrawn stays as it is. What cannot be used is told, and what was
stored of it before stays.
"""

from __future__ import annotations

import logging
from collections.abc import Iterable, Mapping, Sequence
from contextlib import suppress
from dataclasses import asdict, dataclass
from functools import partial
from pathlib import Path
from time import monotonic
from typing import Any

from service.content.folder import Listing, Read, Stamp, content_of, listed, read, stamp
from service.messages.refusals import SHOWN, NotDerived, Refused, StaleError, known_refusal
from service.messages.viewer import FOLDER, PRIVATE, PUBLIC_ONLY
from service.operations import catalogue
from service.operations.sharing.provenance import derived_from
from service.queries import folders
from service.queries.common import is_conflict, is_outage
from service.settings import Settings
from service.store.store import Store
from substructures import errors
from substructures.documents import located
from substructures.errors import Fault, InvalidDocument

LISTED, FAULTS = 100, 3  # files that are no definitions, in what is told; faults of a file in the log
UNKNOWN = "unknown-substructure"  # which may be in another file
_log = logging.getLogger(__name__)


@dataclass
class _File:
    """``stamp``: as it was read, None where that has to be done again; ``part``: the name in it, or last in it;
    ``read``: what is not stored yet; ``is_definition``: it could be read; ``is_twice``: another one has its name, too;
    ``is_waiting``: for a part.
    """

    name: str
    place: Path
    part: str
    stamp: Stamp | None = None
    read: Read | None = None
    uses: tuple[Path, ...] = ()
    version: int | None = None
    remark: str = ""
    faults: tuple[Fault, ...] = ()
    is_definition: bool = False
    is_twice: bool = False
    is_waiting: bool = False


class Folder:
    """What is known of the folder of a store. For one thread."""

    def __init__(self, store: Store) -> None:
        self._store, self._most = store, store.settings.limits.json_bytes
        self._path = folders.path_of(store.settings)
        self._files: dict[str, _File] = {}
        self._seen: dict[str, Stamp] = {}
        self._listing = Listing(Path(self._path))
        self._others: set[str] = set()
        self._told: dict[str, str] = {}
        self._is_begun = self._is_told = False
        self.took = 0.0  # seconds, the last look without reading
        with store.database.read() as connection:
            known = folders.state(connection, store.settings) or folders.nothing(store.settings)
        self._known = {each["file"]: each["part"] or "" for each in (*known["files"], *known["refused"])}
        self._parts = {name for name in (*self._known.values(), *known["waiting"]) if name}
        self._gone = set[str](known["gone"])
        self._state = {name: each for name, each in known.items() if name != "changed"}

    def look(self) -> None:
        """Read what has changed, and store it. A file has to be as it was at the last look, for it may still be being
        written; at the first one all are read.
        """
        begun, known, before = monotonic(), self._listing, self._seen
        self._listing, self._seen = listed(Path(self._path)), {}
        for name, place in self._listing.files.items():
            self._seen[name] = stamp((place, *(self._files[name].uses if name in self._files else ())))
        still = [name for name, found in self._seen.items() if not before or before.get(name) == found]
        changed = [name for name in still if name not in self._files or self._files[name].stamp != self._seen[name]]
        gone = self._files.keys() - self._seen.keys() - before.keys()
        self.took = monotonic() - begun
        if self._is_told and not changed and not gone and (self._listing, self._seen) == (known, before):
            return
        self._is_told = False
        for name in changed:
            self._read(name, self._listing.files[name], self._seen[name])
        for name in gone:
            del self._files[name]
        self._compare_names()
        self._store_all()
        if not self._store.runtime.stopping.is_set():
            self._withdraw()
            self._tell()
            self._is_told = True

    def _read(self, name: str, place: Path, found: Stamp) -> None:
        file = self._files.setdefault(name, _File(name, place, self._known.get(_shown(name), "")))
        try:
            what = read(place, self._most)
        except Exception as error:
            what = Read(faults=tuple(_faults(error, self._store.settings)))
        file.place, file.read, file.faults = place, what, what.faults
        file.is_definition, file.is_twice, file.is_waiting = what.definition is not None, False, False
        if what.uses != file.uses:
            file.uses = what.uses
            found = self._seen[name] = (found[0], *stamp(what.uses))
        file.stamp = found
        if what.definition is not None:
            file.part = what.definition.name
            if what.entry.visibility == PRIVATE:
                message = "what is in a folder is for all: leave 'visibility' out"
                self._refuse(file, [Fault("/visibility", "private-part", message)])

    def _refuse(self, file: _File, faults: Iterable[Fault]) -> None:
        data = b""
        with suppress(InvalidDocument):
            data = content_of(file.place, self._most)
        file.faults = tuple(located(faults, data))

    def _compare_names(self) -> None:
        """Refuse files that describe the same part; one that is alone again is read again."""
        having: dict[str, list[_File]] = {}
        for file in self._files.values():
            if file.is_definition:
                having.setdefault(file.part, []).append(file)
        for part, files in having.items():
            for file in files:
                if len(files) > 1:
                    others = errors.listed(_shown(each.name) for each in files if each is not file)
                    message = f"'{part}' is described by {others}, too: give one of them another name"
                    self._refuse(file, [Fault("/name", "duplicate-name", message)])
                elif file.is_twice and file.name in self._seen:
                    self._read(file.name, file.place, self._seen[file.name])
                file.is_twice = len(files) > 1

    def _store_all(self) -> None:
        """Store what was read; what waits for a part is tried again when another one is new."""
        ready = [file for file in self._files.values() if file.read is not None and not file.faults]
        while ready:
            is_new = [self._store_one(file) for file in ready]
            waiting = [file for file in self._files.values() if file.is_waiting and not file.is_twice]
            ready = waiting if any(is_new) else []

    def _store_one(self, file: _File) -> bool:
        """Whether the file is a new version; what hinders it is noted."""
        if self._store.runtime.stopping.is_set() or file.read is None:
            return False
        try:
            file.version, file.remark, is_new = self._stored(file.read)
        except Exception as error:
            faults = _faults(error, self._store.settings)
            self._refuse(file, faults)
            file.is_waiting = any(fault.code == UNKNOWN for fault in faults)
            file.read = file.read if file.is_waiting else None
            file.stamp = None if _may_pass(error) else file.stamp
            return False
        if is_new or file.remark:
            _log.info("%s: %s@%d%s", _shown(file.name), file.part, file.version, file.remark and f"; {file.remark}")
        file.read, file.faults, file.is_waiting = None, (), False
        return is_new

    def _stored(self, found: Read) -> tuple[int, str, bool]:
        """The version, a remark, and whether it is new. Raises as operations of the catalogue."""
        store, definition = self._store, found.definition
        if definition is None:
            raise RuntimeError("a file without a definition")
        with store.database.read() as connection:
            derived_from(connection, PUBLIC_ONLY, found.entry)  # who reads what is refused may see no more
        limits = {"nodes": store.settings.limits.job_nodes}
        make = partial(catalogue.derived, store.job_worker(FOLDER.owner), definition, limits)
        submission = catalogue.prepare(store, FOLDER, definition, found.entry, make=make)
        with store.database.write() as connection:
            version, is_new = catalogue.submit(connection, FOLDER, submission)
            if not version.is_public:
                way = f"PUT /v1/substructures/{version.name}/visibility makes it so"
                raise Refused(409, "private-part", f"'{version.name}' is not public: {way}")
            return version.version, catalogue.follow(connection, FOLDER, version.name, version.version), is_new

    def _withdraw(self) -> None:
        """Withdraw parts whose file is gone; not while there are folders or files that are not read yet."""
        here = {file.part for file in self._files.values() if file.part}
        self._parts |= here
        self._gone -= here
        if not self._listing.is_whole or self._seen.keys() - self._files.keys():
            return
        for name in sorted(self._parts - here):
            with self._store.database.write() as connection:
                numbers = catalogue.withdraw_all(connection, FOLDER, name)
            what = f"{len(numbers)} versions are withdrawn" if numbers else "what others stored of it stays"
            _log.info("%s: its file is gone; %s", name, what)
            self._parts.discard(name)
            self._gone.add(name)

    def _tell(self) -> None:
        """Log what is new, and note it for whoever asks."""
        used = {each for file in self._files.values() for each in file.uses}
        others = [_shown(name) for name in self._listing.others if self._listing.root / name not in used]
        if unknown := sorted(set(others) - self._others):
            _log.info("not read, for a definition is YAML or JSON: %s", errors.listed(unknown))
        self._others |= set(others)
        known = sorted(self._files.items())
        refused = [(name, file.part or None, file.faults) for name, file in known if file.faults]
        refused += [(name, None, (fault,)) for name, fault in self._listing.refused.items()]
        told = {
            "folder": Path(self._path).name,
            "files": [
                {"file": _shown(name), "part": file.part, "version": file.version, "remark": file.remark}
                for name, file in known
                if not file.faults
            ],
            "refused": [
                {"file": _shown(name), "part": part, "errors": [asdict(each) for each in faults[:SHOWN]]}
                for name, part, faults in refused
            ],
            "gone": sorted(self._gone),
            "waiting": sorted(self._parts - {file.part for file in self._files.values()}),
            "not_read": {"count": len(others), "items": others[:LISTED]},
        }
        self._tell_refused(told["refused"])
        if not self._is_begun:
            _log.info("%s: %d files are read, %d refused", self._path, len(told["files"]), len(told["refused"]))
        self._is_begun = True
        if told != self._state:
            with self._store.database.write() as connection:
                folders.note(connection, self._store.settings, told)
            self._state = told

    def _tell_refused(self, refused: Iterable[Mapping[str, Any]]) -> None:
        """A line for every file that is refused, and again when that changes."""
        lines = {each["file"]: _line(each["file"], each["errors"]) for each in refused}
        for name, line in lines.items():
            if self._told.get(name) != line:
                _log.warning("refused: %s", line)
        for name in self._told.keys() - lines.keys():
            _log.info("%s is refused no more", name)
        self._told = lines


def _line(name: str, faults: Sequence[Mapping[str, str]]) -> str:
    """What is wrong with a file: the first faults with their places, and how many there are."""
    words = [f"{name}{'#' if x['pointer'] else ''}{x['pointer']}: {x['message']}" for x in faults[:FAULTS]]
    return _shown("; ".join(words) + (f"; ... ({len(faults)} faults)" if len(faults) > FAULTS else ""))


def _shown(text: str) -> str:
    """A text of others in one line."""
    return "".join(each if each.isprintable() else "\ufffd" for each in text)


def _may_pass(error: Exception) -> bool:
    """Whether the same may work later."""
    is_busy = is_outage(error) or is_conflict(error) or isinstance(error, NotDerived | StaleError)
    return is_busy or (isinstance(error, Refused) and error.status == 503)


def _faults(error: Exception, settings: Settings) -> Iterable[Fault]:
    """What is told of an error."""
    known = known_refusal(error)
    if known is not None:
        return known.faults or [Fault("", known.code, known.detail)]
    if isinstance(error, TimeoutError):
        limit = f"{settings.limits.job_cpu_seconds:g} s, the limit of a job"
        return [Fault("", "took-too-long", f"to derive it takes longer than {limit}")]
    if _may_pass(error):
        return [Fault("", "database-unavailable", "the database is busy or does not answer; it is tried again")]
    _log.error("a file of the folder cannot be stored", exc_info=error)
    return [Fault("", "internal-error", f"an error in the service: {type(error).__name__}")]
