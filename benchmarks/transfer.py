"""Bytes over loopback from one process to another and back, with nothing but sockets: what any service must add.

python -m benchmarks.transfer IN OUT [--evaluate]

Serves: receives IN bytes, sends OUT bytes, again and again; prints its port. With --evaluate the bytes received are
states of the arm ur5, and what is sent are their M and Q by the kernel alone, on all threads, with the check sum that a
zip file has: what any service must do, whatever its protocol.
"""

from __future__ import annotations

import os
import socket
import subprocess
import sys
from collections.abc import Callable, Iterator
from contextlib import contextmanager

import numpy as np
from zlib_ng.zlib_ng import crc32

from substructures import Definition, TreeSpec, catalogue, couple, derive
from substructures.compile import compile_program
from substructures.quantities.numbers.defaults import default_numbers


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
def exchange(there: int, back: int, *more: str) -> Iterator[Callable[[], None]]:
    """Something that sends ``there`` bytes to another process and receives ``back`` bytes in a fresh array."""
    command = [sys.executable, "-m", "benchmarks.transfer", str(there), str(back), *more]
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


def arm() -> Callable[[memoryview], list[memoryview]]:
    """What makes M and Q of states (N, 6)."""
    spec = {"name": "own", "gravity": [0, 0, "-9.81"], "instances": [{"name": "arm", "substructure": "ur5"}]}
    model = couple(TreeSpec.read(spec), {"arm": derive(Definition.read(catalogue.load("ur5")))})
    kernel = compile_program(model.program, ["forces", "metric"])
    rest = dict.fromkeys((*(f"{name}'" for name in model.coordinates), *model.input_names), 0.0)
    values = rest | {"t": 0.0} | default_numbers(model.parameters)

    def evaluated(received: memoryview) -> list[memoryview]:
        """The results, whose check sums are found too."""
        q = np.frombuffer(received).reshape(-1, model.dof)
        found = kernel.evaluate(values, columns=[(model.coordinates, q)], threads=os.cpu_count() or 1)
        sent = [found[name].reshape(-1).view(np.uint8).data for name in ("forces", "metric")]
        for each in sent:
            crc32(each)
        return sent

    return evaluated


def main() -> None:
    """Serve one connection."""
    there, back = (int(word) for word in sys.argv[1:3])
    buffer, data = memoryview(bytearray(there)), memoryview(bytes(back))
    answer = arm() if "--evaluate" in sys.argv else lambda _: [data]
    with socket.create_server(("127.0.0.1", 0)) as listener:
        print(listener.getsockname()[1], flush=True)
        connection, _ = listener.accept()
        with connection:
            while receive(connection, buffer):
                for each in answer(buffer):
                    connection.sendall(each)


if __name__ == "__main__":
    main()
