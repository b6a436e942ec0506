"""Frames between a service and its runners."""

from __future__ import annotations

import pytest

from service.jobs.engine import AttemptReport, Budget, Outcome, Work
from service.jobs.wire import Message, MessageReader, WireError, read_report, read_work, report_frame, work_frame

from .jobs_library import BUDGET


def test_frames_arrive_in_any_pieces() -> None:
    work = Work("a", "verify", {"x": 1, "y": [0.1, "pi"]}, {"sha256:1": b"\x00\xff", "sha256:2": b""}, Budget(1.5, 7))
    report = AttemptReport("b", 1.0, Outcome({"n": 2}, {"f": b"12", "g": b""}, {"code": "x"}))
    data = work_frame(work).to_bytes() + report_frame(report).to_bytes()
    for size in (1, 7, len(data)):
        reader = MessageReader()
        first, second = (f for k in range(0, len(data), size) for f in reader.feed(data[k : k + size]))
        again = read_work(first, {})
        assert (again.id, again.blobs, again.budget) == (work.id, work.blobs, work.budget)
        assert [float(again.item["y"][0]), again.item["y"][1]] == [0.1, "pi"]
        assert read_report(second) == report


def test_blobs_are_sent_once() -> None:
    blobs: dict[str, bytes] = {}
    work = Work("a", "verify", {}, {"1": b"one", "2": b"two"}, BUDGET)
    assert read_work(work_frame(work), blobs).blobs == work.blobs
    again = work_frame(work, frozenset(("1", "2")))
    assert set(again.contents) == {"item"}
    assert read_work(again, blobs).blobs == work.blobs
    read_work(work_frame(Work("b", "verify", {}, {}, BUDGET), frozenset(), ("1",)), blobs)
    assert set(blobs) == {"2"}
    with pytest.raises(WireError, match="'1'"):
        read_work(again, blobs)


@pytest.mark.parametrize(
    ("data", "message"),
    [
        (b"\xff\xff\xff\xff", "a head of 4294967295 bytes"),
        (b"\x00\x00\x00\x02[]", "cannot be read"),
        (b"\x00\x00\x00\x02{}", "cannot be read: 'contents'"),
        (b'\x00\x00\x00\x28{"protocol": 3, "contents": [["a", -1]]}', "impossible size"),
        (b"\x00\x00\x00\x03nul", "cannot be read"),
    ],
)
def test_bytes_that_are_no_frame_are_refused(data: bytes, message: str) -> None:
    with pytest.raises(WireError, match=message):
        list(MessageReader().feed(data + b" " * 100))


def test_a_head_without_what_a_report_needs_is_refused() -> None:
    with pytest.raises(WireError, match="not a report: 'fraction'"):
        read_report(Message({"id": "x"}))


def test_the_other_version_of_a_cluster_is_named() -> None:
    data = work_frame(Work("a", "verify", {}, {}, BUDGET)).to_bytes().replace(b'"protocol":3', b'"protocol":9')
    with pytest.raises(WireError, match="protocol 9 instead of 3: the service and its workers differ in version"):
        list(MessageReader().feed(data))
