"""Frames between a service and the processes that compute: a JSON head and named contents. Nothing is ever unpickled.

::

    u32 length of the head | head: JSON with "contents": [[name, size], ...] | the contents, one after the other

Both sides have to speak the same protocol, whose number is in every head. Lengths are big endian. Items and summaries
travel as contents in canonical JSON, because their numbers are exact.
"""

from __future__ import annotations

import struct
from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field, replace
from typing import Any

import orjson

from service.jobs.engine import AttemptReport, Budget, Outcome, Work
from substructures.documents import read_json, write_json
from substructures.errors import InvalidDocument

_LENGTH = struct.Struct(">I")
PROTOCOL = 3  # 1: programs were not packed; 2: CPU time was not told
MAX_HEAD = 2**24
MAX_CONTENTS = 2**31
ITEM, SUMMARY, PROBLEM, FILE = "item", "summary", "problem", "file:"


class WireError(Exception):
    """Bytes that are no frame."""


@dataclass(frozen=True)
class Message:
    """A head and its contents."""

    head: Mapping[str, Any]
    contents: Mapping[str, bytes] = field(default_factory=dict)

    def to_bytes(self) -> bytes:
        """The frame as it is sent."""
        listed = [[name, len(data)] for name, data in self.contents.items()]
        head = orjson.dumps({**self.head, "protocol": PROTOCOL, "contents": listed})
        return b"".join((_LENGTH.pack(len(head)), head, *self.contents.values()))


class MessageReader:
    """Puts frames together out of whatever arrives."""

    def __init__(self) -> None:
        self._buffer = bytearray()

    def feed(self, data: bytes) -> Iterator[Message]:
        """The frames that are complete now. Raises WireError."""
        self._buffer += data
        while (frame := self._next()) is not None:
            yield frame

    def _next(self) -> Message | None:
        start = _LENGTH.size
        if len(self._buffer) < start:
            return None
        (length,) = _LENGTH.unpack_from(self._buffer)
        if length > MAX_HEAD:
            raise WireError(f"a head of {length} bytes")
        if len(self._buffer) < start + length:
            return None
        head, sizes = _head(bytes(self._buffer[start : start + length]))
        end = start + length + sum(sizes.values())
        if len(self._buffer) < end:
            return None
        contents, at = {}, start + length
        for name, size in sizes.items():
            contents[name] = bytes(self._buffer[at : at + size])
            at += size
        del self._buffer[:end]
        return Message(head, contents)


def _head(data: bytes) -> tuple[dict[str, Any], dict[str, int]]:
    try:
        head = orjson.loads(data)
        protocol = head.pop("protocol", 1)
        sizes = {str(name): int(size) for name, size in head.pop("contents")}
    except (ValueError, TypeError, KeyError, AttributeError) as error:
        raise WireError(f"a head that cannot be read: {error}") from None
    if protocol != PROTOCOL:
        raise WireError(f"protocol {protocol} instead of {PROTOCOL}: the service and its workers differ in version")
    if min(sizes.values(), default=0) < 0 or sum(sizes.values()) > MAX_CONTENTS:
        raise WireError("contents of impossible size")
    return head, sizes


def work_frame(work: Work, known: frozenset[str] = frozenset(), forget: tuple[str, ...] = ()) -> Message:
    """A work to be computed. Blobs that the receiver ``known`` are not sent again; it may ``forget`` some."""
    head = {
        "id": work.id,
        "kind": work.kind,
        "cpu_seconds": work.budget.cpu_seconds,
        "memory_bytes": work.budget.memory_bytes,
        "blobs": list(work.blobs),
        "forget": list(forget),
    }
    sent = {digest: data for digest, data in work.blobs.items() if digest not in known}
    return Message(head, {ITEM: write_json(dict(work.item)), **sent})


def read_work(frame: Message, blobs: dict[str, bytes]) -> Work:
    """The work of a frame; ``blobs`` are those kept from earlier ones, and brought up to date. Raises WireError."""
    try:
        head, contents = frame.head, dict(frame.contents)
        item = read_json(contents.pop(ITEM))
        for digest in head["forget"]:
            blobs.pop(digest, None)
        blobs.update(contents)
        budget = Budget(float(head["cpu_seconds"]), int(head["memory_bytes"]))
        return Work(head["id"], head["kind"], item, {digest: blobs[digest] for digest in head["blobs"]}, budget)
    except (KeyError, TypeError, ValueError, InvalidDocument) as error:
        raise WireError(f"not a work: {error}") from None


def report_frame(report: AttemptReport, **more: Any) -> Message:
    """News of an attempt."""
    head = {"id": report.id, "fraction": report.fraction, "death": report.death, "cpu": report.cpu_seconds, **more}
    outcome = report.outcome
    if outcome is None:
        return Message(head)
    contents = {SUMMARY: write_json(dict(outcome.summary))}
    contents |= {FILE + name: data for name, data in outcome.files.items()}
    if outcome.problem is not None:
        contents[PROBLEM] = write_json(dict(outcome.problem))
    return Message(head, contents)


def read_report(frame: Message) -> AttemptReport:
    """The report of a frame. Raises WireError."""
    try:
        head, contents = frame.head, frame.contents
        told = str(head["id"]), float(head["fraction"])
        report = AttemptReport(*told, None, str(head["death"]), float(head["cpu"]))
        if SUMMARY not in contents:
            return report
        files = {name.removeprefix(FILE): data for name, data in contents.items() if name.startswith(FILE)}
        problem = read_json(contents[PROBLEM]) if PROBLEM in contents else None
        return replace(report, fraction=1.0, outcome=Outcome(read_json(contents[SUMMARY]), files, problem))
    except (KeyError, TypeError, ValueError, InvalidDocument) as error:
        raise WireError(f"not a report: {error}") from None
