"""The process that computes: ``python -m service.jobs.engines.runner <report fd> <parent> <niceness>``, by an engine.

Items of jobs and works of requests are the same to it.

Works arrive on its standard input, reports leave by a descriptor of their own, so that nothing printed can disturb
them. It serves many items, ends with its input, and on Linux with its parent. The kernel enforces the budget of an
item: memory by RLIMIT_DATA, CPU time by an interval timer whose signal, SIGPROF, ends the process.
"""

from __future__ import annotations

import ctypes
import gc
import os
import resource
import signal
import sys
from collections.abc import Callable
from time import monotonic, process_time

from service.jobs.engines.engine import AttemptReport, Budget, Outcome, Work
from service.jobs.engines.wire import Message, MessageReader, read_work, report_frame
from service.jobs.kinds import failed, load, run
from service.messages.refusals import Refused
from service.processes.lifetime import end_with

CHUNK = 2**20
PR_SET_NO_NEW_PRIVS = 38  # <linux/prctl.h>
FILE = 2**24  # bytes that it may write to a file; items need none
SOON = 0.98  # of the CPU time of a work: then it ends itself where it can
INTERVAL = 0.2  # between reports of progress, seconds


def main(arguments: list[str]) -> int:
    """Serve until the input ends."""
    reports, parent, niceness = map(int, arguments)
    end_with(parent)  # elsewhere than on Linux the end of the input does
    _give_up_rights()
    os.nice(niceness)
    load()
    gc.freeze()  # what was imported stays: nothing to look at whenever there is something to collect
    _send(reports, Message({"ready": os.getpid()}))
    reader = MessageReader()
    blobs: dict[str, bytes] = {}
    while data := os.read(sys.stdin.fileno(), CHUNK):
        for frame in reader.feed(data):
            if not _serve(read_work(frame, blobs), reports):
                return 0
    return 0


def _give_up_rights() -> None:
    """Let this process, and whatever it may start, gain no rights, fill no disk and leave no memory image."""
    if sys.platform == "linux":
        ctypes.CDLL(None).prctl(PR_SET_NO_NEW_PRIVS, 1, 0, 0, 0)
    for what, limit in ((resource.RLIMIT_FSIZE, FILE), (resource.RLIMIT_CORE, 0)):
        _, hard = resource.getrlimit(what)
        most = limit if hard == resource.RLIM_INFINITY else min(limit, hard)
        resource.setrlimit(what, (most, most))


def _serve(work: Work, reports: int) -> bool:
    """Compute and report; False when the process should not be used again."""
    begun = process_time()
    outcome, is_sound = _computed(work, _throttled(lambda fraction: _send(reports, _progress(work, fraction))))
    report = AttemptReport(work.id, 1.0, outcome, cpu_seconds=process_time() - begun)
    _send(reports, report_frame(report, last=not is_sound))
    return is_sound


def _computed(work: Work, tell: Callable[[float], None]) -> tuple[Outcome, bool]:
    end = process_time() + SOON * work.budget.cpu_seconds

    def progress(fraction: float) -> None:
        """Tell; who does ends by itself when its time is over, and is not killed."""
        if process_time() > end:
            raise Refused(422, "cpu-limit", f"the item needs more than {work.budget.cpu_seconds:g} s of CPU time")
        tell(fraction)

    _limit(work.budget)
    try:
        try:
            return run(work.kind, dict(work.item), work.blobs, progress), True
        finally:
            _limit(None)  # before anything else is done: even that would need memory
    except MemoryError:
        return failed(out_of_memory(work.budget)), False


def _limit(budget: Budget | None) -> None:
    """Enforce a budget; None: no longer."""
    signal.setitimer(signal.ITIMER_PROF, budget.cpu_seconds if budget else 0.0)
    _, hard = resource.getrlimit(resource.RLIMIT_DATA)
    memory = budget.memory_bytes if budget else hard
    resource.setrlimit(resource.RLIMIT_DATA, (memory if hard == resource.RLIM_INFINITY else min(memory, hard), hard))


def out_of_memory(budget: Budget) -> Refused:
    """The problem of an item that needs more memory than it may use."""
    limit = budget.memory_bytes
    return Refused(422, "memory-limit", f"the item needs more than {limit:,} bytes of memory", limit=limit)


def _progress(work: Work, fraction: float) -> Message:
    return report_frame(AttemptReport(work.id, fraction))


def _throttled(send: Callable[[float], None]) -> Callable[[float], None]:
    latest = monotonic()

    def progress(fraction: float) -> None:
        """Tell, unless something was told a moment ago."""
        nonlocal latest
        if monotonic() - latest >= INTERVAL:
            latest = monotonic()
            send(fraction)

    return progress


def _send(descriptor: int, frame: Message) -> None:
    data = memoryview(frame.to_bytes())
    while data:
        data = data[os.write(descriptor, data) :]


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
