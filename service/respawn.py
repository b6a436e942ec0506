"""A server that is there again when its process died: a small parent holds its sockets and starts it anew.

Native code, or a system that is short of memory, can end a process at any moment. What was in flight then breaks off;
what was acknowledged is in the database; connections that come meanwhile wait in the sockets, which stay open. Whoever
ends the server on purpose, and a server that ends by itself, with whatever status, is not started again; nor is one
that died before it listened.

A server may be several processes. The first prepares the store, listens, and says how many there are to be; the parent
starts the others then. All accept from the same sockets, each is started again for itself, and all end together. What
the parent holds it hands to all: the sockets, and the file that is locked for the server as a whole (its claim).

Told to end, they have some seconds for what they have begun; then they are killed, whatever they do.
"""

from __future__ import annotations

import errno
import faulthandler
import logging
import os
import signal
import socket
import stat
import sys
import threading
import time
from collections.abc import Sequence
from contextlib import ExitStack, suppress
from dataclasses import dataclass, field
from selectors import EVENT_READ, DefaultSelector
from typing import Any

from service import turns
from service.lifetime import end_with
from service.turns import Listener, Turns

logger = logging.getLogger(__name__)

#: of a server: process of its parent, its number, descriptors of the channel to the parent, of turns, of what it holds
VARIABLE = "_SUBSTRUCTURES_PARENT"
MOST = 64  # descriptors
LAST = 8.0  # seconds from being told to end until those are killed that are there still
#: seconds until a server that died is started again: none at first, more for one that dies young again and again
YOUNG, FIRST, LONGEST = 30.0, 0.5, 10.0


def keep() -> int:
    """Run the command of this process, a server, in others, each again when it is killed; its exit status.

    Signals to end are passed on.
    """
    logging.basicConfig(level=logging.INFO, format="%(asctime)s %(levelname)s %(name)s %(message)s")
    return _Parent([sys.executable, *sys.orig_argv[1:]]).run()


def is_kept() -> bool:
    """Whether this process was started by :func:`keep`."""
    return VARIABLE in os.environ


@dataclass(eq=False)
class _Child:
    """One process of the server; ``pid`` None: it died, and is ``due`` to be started again."""

    number: int
    pid: int | None = None
    start: float = 0.0
    pause: float = 0.0
    due: float = 0.0


class _Parent:
    """Starts the processes, holds what they share, waits."""

    def __init__(self, command: Sequence[str]) -> None:
        self.command = command
        self.held: list[int] = []
        self.children = [_Child(0)]
        self.stopping = False
        self.last = float("inf")  # when those are killed that do not end
        self.status = 0
        self._selector = DefaultSelector()
        self._shared = turns.new()
        self._turns = Turns(self._shared)
        self._ended: dict[int, int] = {}  # exit statuses of processes that were waited for

    def run(self) -> int:
        """Until the server ends by itself or is told to end."""
        told, tells = socket.socketpair()
        tells.setblocking(False)
        signal.set_wakeup_fd(tells.fileno())  # it is told of a signal in a byte
        for each in (signal.SIGTERM, signal.SIGINT):
            signal.signal(each, lambda *_: None)
        self._selector.register(told, EVENT_READ)
        while not self.stopping or self._running():
            for child in self.children:
                if child.pid is None and not self.stopping and child.due <= time.monotonic():
                    self._start(child)
            for key, _ in self._selector.select(self._rest()):
                if key.data is None:
                    self._pass_on(told.recv(1)[0])
                else:
                    self._hear(*key.data)
            if time.monotonic() >= self.last:
                self.last = float("inf")
                self._signal(signal.SIGKILL)
        return self.status

    def _running(self) -> list[_Child]:
        return [child for child in self.children if child.pid is not None]

    def _rest(self) -> float | None:
        """Seconds until a process is due, or all are to be gone."""
        due = [self.last] if self.stopping else [child.due for child in self.children if child.pid is None]
        return max(0.0, min(due) - time.monotonic()) if due and min(due) < float("inf") else None

    def _start(self, child: _Child) -> None:
        ours, theirs = socket.socketpair()
        with theirs:
            for each in (theirs.fileno(), self._shared, *self.held):
                os.set_inheritable(each, True)
            told = (os.getpid(), child.number, theirs.fileno(), self._shared, *self.held)
            environment = {**os.environ, VARIABLE: " ".join(map(str, told))}
            # a group of its own: what a terminal sends to its group comes once, through here
            child.pid = os.posix_spawn(self.command[0], list(self.command), environment, setpgroup=0)
        child.start = time.monotonic()
        self._selector.register(ours, EVENT_READ, (child, ours))

    def _hear(self, child: _Child, channel: socket.socket) -> None:
        """What the first process hands over, once; nothing else comes from any but the end."""
        message, descriptors, *_ = socket.recv_fds(channel, 16, MOST)
        if message and not self.stopping:
            self.held = list(descriptors)
            self.children += [_Child(number) for number in range(1, int(message))]
        elif message:  # nobody would let go of them
            for each in descriptors:
                os.close(each)
        else:
            self._selector.unregister(channel)
            channel.close()
            self._end(child)

    def _end(self, child: _Child) -> None:
        """A process has ended: by itself, or as it was told to; otherwise it is started again."""
        code = self._status_of(child)
        self._turns.note(child.number)
        if self.stopping and code in (-signal.SIGTERM, -signal.SIGKILL):  # before it listened to that, or by us
            code = 0
        if code >= 0 or self.stopping or not self.held:
            self.status = max(self.status, code if code >= 0 else 128 - code)  # as shells tell it
            if not self.stopping:
                self._stop(signal.SIGTERM)
            return
        now = time.monotonic()
        child.pause = 0.0 if now - child.start > YOUNG else child.pause
        logger.error("the server was killed by signal %d and is started again in %g s", -code, child.pause)
        child.due = now + child.pause
        child.pause = min(max(FIRST, 2 * child.pause), LONGEST)

    def _status_of(self, child: _Child) -> int:
        """Wait for it, and for others whose parents have gone where this is the first process of all; the exit status,
        minus the signal of one that was killed.
        """
        pid, child.pid = child.pid, None
        while pid not in self._ended:
            ended, status = os.wait()
            self._ended[ended] = os.waitstatus_to_exitcode(status)
        code = self._ended[pid]
        known = {each.pid for each in self._running()}
        self._ended = {each: status for each, status in self._ended.items() if each in known}
        return code

    def _pass_on(self, received: int) -> None:
        if not self._running() and received != signal.SIGTERM:  # all wait to be started again
            self.status = 128 + received
        self._stop(received)

    def _stop(self, received: int) -> None:
        self.stopping = True
        self.last = min(self.last, time.monotonic() + LAST)
        while self.held:  # nobody waits in them any longer
            os.close(self.held.pop())
        self._signal(received)

    def _signal(self, number: int) -> None:
        for child in self._running():
            if child.pid is not None and child.pid not in self._ended:
                with suppress(ProcessLookupError):
                    os.kill(child.pid, number)


@dataclass
class Kept:
    """What a process of a server has from its parent, or nothing.

    ``number``: from 0; the first one looks after the store. ``claim``: the descriptor of the file that is locked for
    the server, None at its first start and where there is none.
    """

    number: int = 0
    sockets: list[int] = field(default_factory=list)
    claim: int | None = None
    channel: socket.socket | None = None
    turns: Turns | None = None

    def note(self, count: int) -> None:
        """So many connections are open, of those that any process may take."""
        if self.turns is not None:
            self.turns.note(self.number, count)

    @property
    def is_start(self) -> bool:
        """Whether no process of this server has been at work before."""
        return not self.sockets


kept = Kept()


def end_with_parent() -> None:
    """Let this process, a server that is kept, end with its parent, whatever it does."""
    parent, number, channel, shared, *held = map(int, os.environ[VARIABLE].split())
    end_with(parent)
    for each in (channel, shared, *held):
        os.set_inheritable(each, False)
    faulthandler.enable()  # native code that fails tells where
    kept.number, kept.channel, kept.turns = number, socket.socket(fileno=channel), Turns(shared)
    for each in held:
        if stat.S_ISSOCK(os.fstat(each).st_mode):
            kept.sockets.append(each)
        else:
            kept.claim = each
    threading.Thread(target=_end_with, args=(kept.channel,), daemon=True).start()


def _end_with(channel: socket.socket) -> None:
    """The same where the kernel does not see for it: nothing ever comes but the end."""
    channel.recv(1)
    os.kill(os.getpid(), signal.SIGKILL)


def listeners(host: str, port: int, claim: int | None = None, processes: int = 1) -> list[socket.socket]:
    """The sockets that the parent holds; at the first time new ones, for it to hold together with the descriptor
    ``claim``, and to start so many processes on. Raises OSError.
    """
    if kept.channel is None or kept.turns is None:
        return bound(host, port)
    if not kept.sockets:
        kept.sockets += [each.detach() for each in bound(host, port)]
        held = kept.sockets + ([] if claim is None else [claim])
        socket.send_fds(kept.channel, [str(processes).encode()], held)
    return [Listener(each, kept.turns, kept.number) for each in kept.sockets]


def bound(host: str, port: int) -> list[socket.socket]:
    """Listening sockets for all addresses of a host, on one port; 0 takes a free one. Raises OSError."""
    addresses = dict.fromkeys(
        (family, address)
        for family, _, _, _, address in socket.getaddrinfo(host, port, type=socket.SOCK_STREAM, flags=socket.AI_PASSIVE)
    )
    sockets: list[socket.socket] = []
    missing: OSError | None = None
    with ExitStack() as opened:
        for family, (name, _, *rest) in addresses:
            chosen = port or (sockets[0].getsockname()[1] if sockets else 0)
            try:
                sockets.append(opened.enter_context(_bound(family, (name, chosen, *rest))))
            except OSError as error:
                if error.errno not in (errno.EADDRNOTAVAIL, errno.EAFNOSUPPORT):
                    raise
                missing = error  # a name may have addresses of a family that this machine does not use
        if missing is not None and not sockets:
            raise missing
        opened.pop_all()
    return sockets


def _bound(family: socket.AddressFamily, address: tuple[Any, ...]) -> socket.socket:
    with ExitStack() as opened:
        one = opened.enter_context(socket.socket(family))
        one.setsockopt(socket.SOL_SOCKET, socket.SO_REUSEADDR, 1)
        if family == socket.AF_INET6:
            one.setsockopt(socket.IPPROTO_IPV6, socket.IPV6_V6ONLY, 1)
        one.bind(address)
        one.listen()
        opened.pop_all()
        return one
