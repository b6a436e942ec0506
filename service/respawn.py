"""A server that is there again when its process died: a small parent holds its sockets and starts it anew.

Native code, or a system that is short of memory, can end a process at any moment. What was in flight then breaks off;
what was acknowledged is in the database; connections that come meanwhile wait in the sockets, which stay open. Whoever
ends the server on purpose, and a server that ends by itself, with whatever status, is not started again; nor is one
that died before it listened.
"""

from __future__ import annotations

import errno
import faulthandler
import logging
import os
import signal
import socket
import sys
import threading
import time
from collections.abc import Sequence
from contextlib import ExitStack, suppress
from typing import Any

from service.lifetime import end_with

logger = logging.getLogger(__name__)

#: of a server: process of its parent, descriptors of the channel to it and of the sockets that it holds
VARIABLE = "_SUBSTRUCTURES_PARENT"
MOST = 64  # sockets
#: seconds until a server that died is started again: none at first, more for one that dies young again and again
YOUNG, FIRST, LONGEST = 30.0, 0.5, 10.0


def keep() -> int:
    """Run the command of this process, a server, in another one, again when that is killed; its exit status.

    Signals to end are passed on.
    """
    logging.basicConfig(level=logging.INFO, format="%(asctime)s %(levelname)s %(name)s %(message)s")
    return _Parent([sys.executable, *sys.orig_argv[1:]]).run()


def is_kept() -> bool:
    """Whether this process was started by :func:`keep`."""
    return VARIABLE in os.environ


class _Parent:
    """Starts the process, holds its sockets, waits."""

    def __init__(self, command: Sequence[str]) -> None:
        self.command = command
        self.sockets: list[int] = []
        self.child: int | None = None
        self.stopping = 0  # the signal that said so

    def run(self) -> int:
        """Until the server ends by itself or is told to end."""
        for each in (signal.SIGTERM, signal.SIGINT):
            signal.signal(each, self._pass_on)
        pause = 0.0
        while True:
            start = time.monotonic()
            code = self._life()
            if code >= 0:
                return code
            if self.stopping or not self.sockets:
                return 128 - code  # as shells tell it
            pause = 0.0 if time.monotonic() - start > YOUNG else pause
            logger.error("the server was killed by signal %d and is started again in %g s", -code, pause)
            time.sleep(pause)
            pause = min(max(FIRST, 2 * pause), LONGEST)

    def _life(self) -> int:
        """The exit status of the server from its start to its end; of one that was killed minus the signal."""
        ours, theirs = socket.socketpair()
        with ours:
            with theirs:
                self.child = self._started(theirs.fileno())
            if not self.sockets:
                self.sockets = list(socket.recv_fds(ours, 1, MOST)[1])
            return self._end()

    def _started(self, channel: int) -> int:
        for each in (channel, *self.sockets):
            os.set_inheritable(each, True)
        environment = {**os.environ, VARIABLE: " ".join(map(str, (os.getpid(), channel, *self.sockets)))}
        # a group of its own: what a terminal sends to its group comes once, through here
        return os.posix_spawn(self.command[0], list(self.command), environment, setpgroup=0)

    def _end(self) -> int:
        """Wait for the server, and for others whose parents have gone where this is the first process of all."""
        while True:
            ended, status = os.wait()
            if ended == self.child:
                self.child = None
                return os.waitstatus_to_exitcode(status)

    def _pass_on(self, received: int, _frame: object = None) -> None:
        self.stopping = received
        if self.child is None:
            sys.exit(128 + received)
        while self.sockets:  # nobody waits in them any longer
            os.close(self.sockets.pop())
        with suppress(ProcessLookupError):  # it has just ended
            os.kill(self.child, received)


_held: list[socket.socket] = []  # the channel, while this process lives


def end_with_parent() -> None:
    """Let this process, a server that is kept, end with its parent, whatever it does."""
    parent, channel, *_ = map(int, os.environ[VARIABLE].split())
    end_with(parent)
    os.set_inheritable(channel, False)
    faulthandler.enable()  # native code that fails tells where
    _held[:] = [socket.socket(fileno=channel)]
    threading.Thread(target=_end_with, args=_held, daemon=True).start()


def _end_with(channel: socket.socket) -> None:
    """The same where the kernel does not see for it: nothing ever comes but the end."""
    channel.recv(1)
    os.kill(os.getpid(), signal.SIGKILL)


def listeners(host: str, port: int) -> list[socket.socket]:
    """The sockets that the parent holds; at the first time new ones, for it to hold. Raises OSError."""
    if not _held:
        return bound(host, port)
    descriptors = list(map(int, os.environ[VARIABLE].split()[2:]))
    if descriptors:
        for each in descriptors:
            os.set_inheritable(each, False)
        return [socket.socket(fileno=each) for each in descriptors]
    sockets = bound(host, port)
    socket.send_fds(_held[0], [b"."], [each.fileno() for each in sockets])
    return sockets


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
