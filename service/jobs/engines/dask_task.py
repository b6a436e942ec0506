"""What runs on the workers of a Dask cluster. Dask pickles the names of these functions, and nothing else of ours.

Dask cannot stop a task that runs. So a task looks after itself: it kills its runner as soon as the worker no longer
wants its result (cancelled, client or scheduler gone).
"""

from __future__ import annotations

import threading
from typing import Any

from distributed import Status, get_worker

from service.jobs.engines.local import LocalEngine
from service.jobs.engines.wire import PROTOCOL, MessageReader, read_work, report_frame

TOPIC = "substructures-progress"
POLL = 0.1  # seconds between looks of a task at whether it is still wanted
_local = threading.local()


def protocol() -> int:
    """What every worker is asked before it gets works; servers of all versions ask for this very name."""
    return PROTOCOL


def compute(frame: bytes) -> bytes:
    """The task: compute a work on the worker, and answer with the frame of its last report (nothing when unwanted)."""
    worker = get_worker()
    key = worker.get_current_task()
    (first,) = MessageReader().feed(frame)
    work = read_work(first, {})
    engine = _engine()
    while not engine.free:
        engine.reports(POLL)
        if not _is_wanted(worker, key):
            return b""
    engine.start(work)
    while True:
        for report in engine.reports(POLL):
            if report.is_final:
                return report_frame(report).to_bytes()
            worker.log_event(TOPIC, {"id": work.id, "fraction": report.fraction})
        if not _is_wanted(worker, key):
            engine.stop(work.id)
            return b""


def _engine() -> LocalEngine:
    """The runner of this thread of the worker; it ends with the thread."""
    if not hasattr(_local, "engine"):
        _local.engine = LocalEngine(1)
    engine: LocalEngine = _local.engine
    return engine


def _is_wanted(worker: Any, key: Any) -> bool:
    task = worker.state.tasks.get(key)
    return worker.status in (Status.running, Status.paused) and task is not None and task.state == "executing"
