"""One runner as its parent sees it: started with a clean environment, fed, listened to, killed."""

from __future__ import annotations

import contextlib
import fcntl
import os
import pwd
import re
import signal
import subprocess
import sys
import time
from collections import OrderedDict, deque
from dataclasses import replace
from pathlib import Path
from typing import Any

from service.jobs.engines.engine import AttemptReport, Work
from service.jobs.engines.wire import Message, MessageReader, WireError, read_report, work_frame
from service.jobs.kinds import failed
from service.messages.refusals import Refused
from substructures.compile.setting import VARIABLES

#: what a runner gets of the environment; nothing that says where the database is, and no credentials
ENVIRONMENT = ("PATH", "LANG", "LC_ALL", "LC_CTYPE", "TZ", "TMPDIR", "LD_LIBRARY_PATH", "PYTHONPATH", "PYTHONHOME")
THREADS = ("OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS", "MKL_NUM_THREADS")
ROOT = Path(__file__).parents[3]
NICE = 10  # of jobs: a service that answers requests goes first
CHUNK = 2**20
OUTPUT = 1000  # characters that are kept of what a runner printed, of its beginning and of its end each
BLOBS = 64 * 2**20  # bytes of blobs that a runner keeps
ITEMS = 2000  # after so many items a runner is replaced
#: wall-clock time that an item may take: so much, and so many times its CPU time
GRACE, SLOWNESS = 60.0, 10.0
PATIENCE = 0.1  # seconds
PAGE = os.sysconf("SC_PAGE_SIZE")  # bytes
#: Where memory runs out, libraries crash in many ways: a crash of a process that had so much of its budget is that, and
#: so is one whose last words are about memory (it may have taken the rest since we looked).
CLOSE = 0.7
LAST_WORDS = re.compile(r"MemoryError|bad_alloc|memory allocation|\b(allocate|out of|not enough) memory", re.IGNORECASE)


def environment() -> dict[str, str]:
    """The environment of a runner."""
    result = {name: os.environ[name] for name in (*ENVIRONMENT, *VARIABLES) if name in os.environ}
    if ROOT.name not in ("site-packages", "dist-packages"):  # not installed: run from a checkout
        result["PYTHONPATH"] = os.pathsep.join(filter(None, (str(ROOT), result.get("PYTHONPATH"))))
    return result | dict.fromkeys(THREADS, "1")


def rights_of(user: str) -> dict[str, Any]:
    """The arguments of ``subprocess.Popen`` for a process of another user. Raises LookupError when there is none."""
    entry = pwd.getpwnam(user)
    return {"user": entry.pw_uid, "group": entry.pw_gid, "extra_groups": []}


class Process:
    """A runner. Nothing here blocks: descriptors are to be watched by the owner."""

    def __init__(self, user: str = "", niceness: int = NICE) -> None:
        """``user``: whose rights it has, in place of ours. Raises OSError or LookupError when it cannot be started."""
        self.reports, inherited = _pipe()
        told = map(str, (inherited, os.getpid(), niceness))
        command = [sys.executable, "-P", "-m", "service.jobs.engines.runner", *told]
        try:
            self._child = subprocess.Popen(
                command,
                stdin=subprocess.PIPE,
                stdout=subprocess.PIPE,
                stderr=subprocess.STDOUT,
                pass_fds=(inherited,),
                env=environment(),
                cwd="/",
                start_new_session=True,
                **(rights_of(user) if user else {}),
            )
        finally:
            os.close(inherited)
        if self._child.stdin is None or self._child.stdout is None:
            raise RuntimeError("the pipes of the runner are missing")
        self._input, self._output = self._child.stdin, self._child.stdout
        self.work, self.output = self._input.fileno(), self._output.fileno()
        for descriptor in (self.reports, self.work, self.output):
            os.set_blocking(descriptor, False)
        self._sizes = -1
        with contextlib.suppress(OSError):
            self._sizes = os.open(f"/proc/{self._child.pid}/statm", os.O_RDONLY | os.O_CLOEXEC)
        self._reader = MessageReader()
        self._outgoing: deque[memoryview] = deque()
        self._blobs: OrderedDict[str, int] = OrderedDict()
        self._printed = ""
        self._items, self._resident, self._most = 0, 0, 0
        self.current: Work | None = None
        self.deadline = float("inf")
        self.is_ready = self.is_last = False

    @property
    def pid(self) -> int:
        """The id of the process."""
        return self._child.pid

    @property
    def is_sending(self) -> bool:
        """Whether something waits to be written."""
        return bool(self._outgoing)

    @property
    def is_worn(self) -> bool:
        """Whether it should be replaced: many items, much memory, or it says so itself."""
        return self.is_last or self._items >= ITEMS

    def start(self, work: Work) -> None:
        """Let it compute a work."""
        self._most = 0
        self.measure()
        self.current, self._printed = replace(work, blobs={}), ""
        self.deadline = time.monotonic() + GRACE + SLOWNESS * work.budget.cpu_seconds
        known = frozenset(self._blobs)
        forget = self._remember(work)
        self._outgoing.append(memoryview(work_frame(work, known, forget).to_bytes()))
        self.flush()

    def _remember(self, work: Work) -> tuple[str, ...]:
        """Note which blobs the runner has from now on; those that it should forget."""
        for digest, data in work.blobs.items():
            self._blobs[digest] = len(data)
            self._blobs.move_to_end(digest)
        forget = []
        while sum(self._blobs.values()) > BLOBS and (oldest := next(iter(self._blobs))) not in work.blobs:
            del self._blobs[oldest]
            forget.append(oldest)
        return tuple(forget)

    def flush(self) -> None:
        """Write what can be written."""
        try:
            while self._outgoing:
                rest = self._outgoing[0][os.write(self.work, self._outgoing[0]) :]
                if rest:
                    self._outgoing[0] = rest
                else:
                    self._outgoing.popleft()
        except BlockingIOError:
            return
        except BrokenPipeError:  # it is dead: the end of its reports says so
            self._outgoing.clear()

    def listen(self) -> bool:
        """Keep what it printed; False when it closed its output."""
        try:
            data = os.read(self.output, CHUNK)
        except BlockingIOError:
            return True
        self._printed = _ends(self._printed + data.decode(errors="replace"))
        return bool(data)

    def receive(self) -> list[AttemptReport] | None:
        """News of the current work; None when the process has ended. Raises WireError."""
        try:
            data = os.read(self.reports, CHUNK)
        except BlockingIOError:
            return []
        if not data:
            return None
        return [report for frame in self._reader.feed(data) for report in self._news(frame)]

    def _news(self, frame: Message) -> list[AttemptReport]:
        if "ready" in frame.head:
            self.is_ready = True
            return []
        report = read_report(frame)
        if self.current is None or report.id != self.current.id:
            raise WireError(f"a report about {report.id[:80]}, which is not being computed")
        if report.is_final:
            self._items += 1
            self.measure()
            is_large = self._resident > self.current.budget.memory_bytes // 2
            self.is_last = is_large or bool(frame.head["last"])
            self.current, self.deadline = None, float("inf")
        return [report]

    @property
    def printed(self) -> str:
        """What it printed since its work began; of much, the beginning and the end."""
        return self._printed.strip()

    def measure(self) -> None:
        """Note how much memory is resident, and the most that the kernel counted towards the budget since the work
        began (data, resident or not), where the system says so."""
        with contextlib.suppress(OSError, IndexError):
            sizes = os.pread(self._sizes, 200, 0).split()
            self._resident, self._most = int(sizes[1]) * PAGE, max(self._most, int(sizes[5]) * PAGE)

    def excess(self) -> AttemptReport | None:
        """The last report about a work that takes more than it may: memory, or far too long."""
        if self.current is None:
            return None
        self.measure()
        if self._resident > self.current.budget.memory_bytes:
            return self._out_of_memory(self.current)
        if time.monotonic() >= self.deadline:
            return AttemptReport(
                self.current.id, death="the process was killed: it took far longer than its CPU time allows"
            )
        return None

    def _out_of_memory(self, work: Work) -> AttemptReport:
        return _problem(work, "memory-limit", f"{work.budget.memory_bytes:,} bytes of memory")

    def kill(self) -> None:
        """End it at once, with whatever it started."""
        if self._child.poll() is None:
            os.killpg(self.pid, signal.SIGKILL)

    def seen(self, work: Work) -> AttemptReport:
        """The last report about the work of a process that has ended: its own failure, or what was seen."""
        try:
            code = self._child.wait(PATIENCE)  # it closed its pipe a moment before
        except subprocess.TimeoutExpired:
            self.kill()
            code = self._child.wait()
        self.listen()
        if code == -signal.SIGPROF:
            return _problem(work, "cpu-limit", f"{work.budget.cpu_seconds:g} s of CPU time")
        if code != -signal.SIGKILL and lacked_memory(self._most, work.budget.memory_bytes, self._printed):
            return self._out_of_memory(work)
        what = f"exit code {code}" if code >= 0 else f"killed by signal {-code} ({signal.strsignal(-code)})"
        what = what if self.is_ready else f"{what} before it was ready"
        printed = f"; it printed: {self.printed}" if self.printed else ""
        return AttemptReport(work.id, death=f"the process ended: {what}{printed}")

    def close(self) -> None:
        """Kill it, wait for the end and release everything."""
        self.kill()
        self._child.wait()
        self._outgoing.clear()
        for stream in (self._input, self._output):
            stream.close()
        os.close(self.reports)
        if self._sizes >= 0:
            os.close(self._sizes)


def lacked_memory(most: int, budget: int, printed: str) -> bool:
    """Whether a process that crashed was without memory: by the most it was seen to have, in bytes, or by its words."""
    return most > CLOSE * budget or LAST_WORDS.search(printed) is not None


def _ends(text: str) -> str:
    """A text, without its middle if it is long."""
    return text if len(text) <= 2 * OUTPUT else f"{text[:OUTPUT]}{text[-OUTPUT:]}"


def _pipe() -> tuple[int, int]:
    """A pipe with room for the report of most items, so that nobody waits for us to read it."""
    ends = os.pipe()
    if sys.platform == "linux":
        with contextlib.suppress(OSError):  # the user has many pipes
            fcntl.fcntl(ends[0], fcntl.F_SETPIPE_SZ, CHUNK)
    return ends


def _problem(work: Work, code: str, limit: str) -> AttemptReport:
    return AttemptReport(work.id, 1.0, failed(Refused(422, code, f"the item needs more than {limit}")))
