"""What becomes of a work when waiting for its task of Dask ends without a result."""

from __future__ import annotations

import asyncio
from collections.abc import Generator
from types import SimpleNamespace
from typing import Any

import pytest
from distributed.comm.core import CommClosedError

from service.jobs.engines.dask import DaskEngine
from service.jobs.engines.engine import AttemptReport, Budget, Work

WORK = Work("a", "verify", {}, {}, Budget(60.0, 2**30))


class Future:
    """A task that ends with an error."""

    def __init__(self, error: Exception) -> None:
        self.error = error

    def __await__(self) -> Generator[None, None, Any]:
        yield
        raise self.error

    def release(self) -> None:
        """Nothing is held."""


def reports(error: Exception) -> list[AttemptReport]:
    """What an engine reports whose client has not noticed anything yet."""
    found: list[AttemptReport] = []
    client = SimpleNamespace(status="running", submit=lambda *_, **__: Future(error))
    engine: Any = SimpleNamespace(_tasks={}, _end=found.append)
    asyncio.run(DaskEngine._follow(engine, SimpleNamespace(client=client, doubt=lambda: None), WORK, frozenset()))
    return found


def test_a_broken_connection_is_no_end_of_the_attempt() -> None:
    """The scheduler was restarted while the result was fetched: the next look submits the work again."""
    assert reports(CommClosedError("in <TCP (closed) ConnectionPool.gather>: ConnectionResetError")) == []


@pytest.mark.parametrize("error", [OSError("no space left"), ValueError("wrong")])
def test_an_error_of_the_task_is(error: Exception) -> None:
    (report,) = reports(error)
    assert str(error) in str(report.death)
