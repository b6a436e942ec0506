"""A client that costs little: prepared requests over sockets, several at a time, and how many were answered.

python -m benchmarks.load {evaluations|trees} SECONDS THREADS NAME PORT...     (threads take the ports in turn)
"""

from __future__ import annotations

import json
import socket
import sys
import threading
from collections.abc import Callable
from itertools import count
from time import monotonic
from typing import Any

STATE = {"quantities": ["metric", "forces"], "q": [0.1] * 6}


def request(port: int, path: str, body: Any) -> bytes:
    content = json.dumps(body).encode()
    head = f"POST {path} HTTP/1.1\r\nHost: 127.0.0.1:{port}\r\nContent-Type: application/json\r\n"
    return f"{head}Content-Length: {len(content)}\r\n\r\n".encode() + content


def evaluations(port: int, _: str) -> Callable[[int], bytes]:
    """One state of a tree of 6 dof."""
    whole = request(port, "/v1/trees/cell@1/evaluations", STATE)
    return lambda _: whole


def trees(port: int, name: str) -> Callable[[int], bytes]:
    """Two arms of 6 dof coupled, verified and stored; never the same twice."""
    arms = [
        {"name": "arm", "substructure": "ur5", "at": "world"},
        {"name": "second", "substructure": "puma560", "at": "arm.flange"},
    ]

    def numbered(number: int) -> bytes:
        body = {"name": f"{name}-{number}", "gravity": [0, 0, "-9.81"], "instances": arms}
        return request(port, "/v1/trees", body)

    return numbered


def answer(one: socket.socket) -> None:
    """Read an answer to its end. Raises RuntimeError for any that is no success."""
    found = one.recv(65536)
    while b"\r\n\r\n" not in found:
        found += one.recv(65536)
    head, _, body = found.partition(b"\r\n\r\n")
    if not head.startswith(b"HTTP/1.1 20"):
        raise RuntimeError(found.decode())
    size = int(head.lower().partition(b"content-length: ")[2].partition(b"\r\n")[0])
    left = size - len(body)
    while left > 0:
        left -= len(one.recv(65536))


def main() -> None:
    """Print the number of answers in the seconds after the first of every thread."""
    kind, seconds, threads, name, *ports = sys.argv[1:]
    made = {"evaluations": evaluations, "trees": trees}[kind]
    ready = threading.Barrier(int(threads))
    answered = [0] * int(threads)

    def work(number: int) -> None:
        port = int(ports[number % len(ports)])
        body = made(port, f"{name}-{number}")
        with socket.create_connection(("127.0.0.1", port)) as one:
            one.setsockopt(socket.IPPROTO_TCP, socket.TCP_NODELAY, 1)
            one.sendall(body(0))
            answer(one)
            ready.wait()
            end = monotonic() + float(seconds)
            for each in count(1):
                one.sendall(body(each))
                answer(one)
                if monotonic() > end:
                    break
                answered[number] += 1

    started = [threading.Thread(target=work, args=(number,)) for number in range(int(threads))]
    for thread in started:
        thread.start()
    for thread in started:
        thread.join()
    print(sum(answered))


if __name__ == "__main__":
    main()
