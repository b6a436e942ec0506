"""A server in this process behind a door of its own: from outside it dies, hangs and comes back as a process does."""

from __future__ import annotations

import contextlib
import socket
import threading
from collections.abc import Callable
from urllib.parse import urlsplit

from service.server import background
from service.settings import Settings

from .farm import free_port


class Door:
    """Passes on what comes to its port. ``kill`` closes all connections, and ``start`` opens the store anew."""

    def __init__(self, settings: Settings) -> None:
        self.settings, self.port = settings, free_port()
        self.address = f"http://127.0.0.1:{self.port}"
        self._passing = threading.Event()
        self._sockets: list[socket.socket] = []
        self._server = contextlib.ExitStack()

    def start(self) -> None:
        to = urlsplit(self._server.enter_context(background(self.settings)))
        listener = socket.create_server(("127.0.0.1", self.port))
        self._sockets = [listener]
        self._passing.set()
        _thread(self._accept, listener, (to.hostname or "", to.port or 0))

    def kill(self) -> None:
        """Nobody listens any more, and nothing was said."""
        for each in self._sockets:
            with contextlib.suppress(OSError):
                each.shutdown(socket.SHUT_RDWR)
            each.close()
        self._server.close()

    def hang(self) -> None:
        """Connections are taken, and nothing is answered."""
        self._passing.clear()

    def go_on(self) -> None:
        self._passing.set()

    def _accept(self, listener: socket.socket, to: tuple[str, int]) -> None:
        with contextlib.suppress(OSError):
            while True:
                outside, inside = listener.accept()[0], socket.create_connection(to)
                self._sockets += [outside, inside]
                _thread(self._pass_on, outside, inside)
                _thread(self._pass_on, inside, outside)

    def _pass_on(self, one: socket.socket, other: socket.socket) -> None:
        with contextlib.suppress(OSError):
            while data := one.recv(65536):
                self._passing.wait()
                other.sendall(data)
            other.shutdown(socket.SHUT_RDWR)


def _thread(work: Callable[..., None], *given: object) -> None:
    threading.Thread(target=work, args=given, daemon=True).start()
