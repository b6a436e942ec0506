"""The deadline of a request: who is in time answers, and no error vanishes behind it."""

from __future__ import annotations

import asyncio
import logging
from collections.abc import Callable
from concurrent.futures import ThreadPoolExecutor
from threading import Event
from time import thread_time

import pytest
from fastapi import Response

from service.http.deadline import Deadline

LATE = Response(status_code=202)


def answered(
    seconds: float, work: Callable[[], int], late: Callable[[], int] = lambda: 503, limit: float | None = None
) -> Response:
    """The answer of an endpoint that does ``work`` under a deadline; its status is what the work gives."""
    deadline = Deadline(seconds, limit)

    def endpoint() -> Response:
        return Response(status_code=deadline.watched(work, late, lambda: LATE))

    async def asked() -> Response:
        with ThreadPoolExecutor(1) as threads:
            return await deadline.within(threads.submit, endpoint)

    return asyncio.run(asked())


def slow(error: Exception | None = None) -> Callable[[], int]:
    """Work that ends long after a short deadline."""

    def work() -> int:
        Event().wait(0.4)
        if error is not None:
            raise error
        return 200

    return work


def failing() -> int:
    raise ValueError("the true error")


def test_work_in_time_answers() -> None:
    assert answered(60, lambda: 200).status_code == 200


def test_another_thread_answers_for_work_that_takes_too_long() -> None:
    assert answered(0.05, slow()) is LATE


def test_the_limit_is_of_cpu_time() -> None:
    """What waits, for a busy machine or for others, is not late; what computes for longer is."""

    def waits() -> int:
        Event().wait(0.1)
        return 200

    def computes() -> int:
        begun = thread_time()
        while thread_time() < begun + 0.1:
            pass
        return 200

    assert answered(60, waits, limit=0.05).status_code == 200
    assert answered(60, computes, limit=0.05) is LATE


def test_work_that_looks_at_the_clock_is_late_by_itself() -> None:
    def work() -> int:
        raise TimeoutError

    assert answered(60, work).status_code == 503


def test_an_error_in_time_is_the_answer() -> None:
    with pytest.raises(ValueError, match="the true error"):
        answered(60, failing)


def test_an_error_of_abandoned_work_is_told(caplog: pytest.LogCaptureFixture) -> None:
    with caplog.at_level(logging.WARNING):
        assert answered(0.05, slow(ValueError("the true error"))) is LATE
    (record,) = caplog.records
    assert "the true error" in record.getMessage()


def test_abandoned_work_without_an_error_is_not_told(caplog: pytest.LogCaptureFixture) -> None:
    with caplog.at_level(logging.WARNING):
        assert answered(0.05, slow()) is LATE
        assert answered(0.05, slow(TimeoutError())) is LATE
    assert not caplog.records
