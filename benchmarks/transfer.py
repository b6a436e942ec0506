"""Bytes over loopback from one process to another and back, with nothing but sockets: what any service must add.

python -m benchmarks.transfer IN OUT    serves: receives IN bytes, sends OUT bytes, again and again; prints its port
"""

from __future__ import annotations

import socket
import subprocess
import sys
from collections.abc import Callable, Iterator
from contextlib import contextmanager

import numpy as np


def receive(connection: socket.socket, buffer: memoryview) -> bool:
    """Fill the buffer; False at the end of the connection."""
    done = 0
    while done < len(buffer):
        got = connection.recv_into(buffer[done:])
        if not got:
            return False
        done += got
    return True


@contextmanager
def exchange(there: int, back: int) -> Iterator[Callable[[], None]]:
    """Something that sends ``there`` bytes to another process and receives ``back`` bytes in a fresh array."""
    command = [sys.executable, "-m", "benchmarks.transfer", str(there), str(back)]
    process = subprocess.Popen(command, stdout=subprocess.PIPE, text=True)
    if process.stdout is None:
        raise RuntimeError("no port")
    data = memoryview(bytes(there))
    with socket.create_connection(("127.0.0.1", int(process.stdout.readline()))) as connection:

        def work() -> None:
            connection.sendall(data)
            receive(connection, np.empty(back, np.uint8).data)

        yield work
    process.wait(10)


def main() -> None:
    """Serve one connection."""
    there, back = (int(word) for word in sys.argv[1:])
    buffer, data = memoryview(bytearray(there)), memoryview(bytes(back))
    with socket.create_server(("127.0.0.1", 0)) as listener:
        print(listener.getsockname()[1], flush=True)
        connection, _ = listener.accept()
        with connection:
            while receive(connection, buffer):
                connection.sendall(data)


if __name__ == "__main__":
    main()
