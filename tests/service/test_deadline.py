"""The deadline of a request: who is in time answers, and no error vanishes behind it."""

from __future__ import annotations

import asyncio
import logging
from collections.abc import Callable
from concurrent.futures import ThreadPoolExecutor
from threading import Event

import pytest
from fastapi import Response

from service.http.deadline import Deadline

LATE = Response(status_code=202)


def answered(seconds: float, work: Callable[[], int], late: Callable[[], int] = lambda: 503) -> Response:
    """The answer of an endpoint that does ``work`` under a deadline; its status is what the work gives."""
    deadline = Deadline(seconds)

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
