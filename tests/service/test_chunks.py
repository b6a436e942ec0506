"""Heads leave with the first piece of a body, large pieces from a thread: whole and in order, for slow readers too."""

from __future__ import annotations

import asyncio
from http.client import HTTPConnection
from pathlib import Path
from time import sleep
from typing import Any, cast

import numpy as np
import pytest

from service.http import chunks
from service.http.chunks import Joined
from service.operations import exchange
from service.server import background
from service.settings import Settings
from substructures.client import Client
from substructures.formats.arrays import MEDIA_TYPE, view_npz, write_npz

from .conftest import PENDULUM, TREE

URL, NAMES = "/v1/trees/cell/evaluations", ["metric", "kinematics", "forces"]


class Written(asyncio.Transport):
    """A connection that only notes what is written."""

    def __init__(self) -> None:
        super().__init__()
        self.pieces: list[bytes] = []

    def write(self, data: Any) -> None:
        self.pieces.append(bytes(data))

    def close(self) -> None:
        self.pieces.append(b"closed")


@pytest.mark.parametrize(
    ("written", "sent"),
    [
        ([b"head", b"body", b"more"], [b"headbody", b"more"]),
        ([b"head", b"x" * 2**17], [b"head", b"x" * 2**17]),
        ([b"head", None, b"body"], [b"head", b"body"]),
        ([b"head"], [b"head", b"closed"]),
    ],
)
def test_a_head_waits_for_its_body_but_not_for_long(written: list[bytes | None], sent: list[bytes]) -> None:
    async def writing() -> list[bytes]:
        transport = Written()
        joined = Joined(asyncio.get_running_loop(), cast(asyncio.Transport, transport))
        for piece in written:
            if piece is None:
                await asyncio.sleep(0)
            else:
                joined.write(piece)
        if b"closed" in sent:
            joined.close()
        await asyncio.sleep(0)
        return transport.pieces

    assert asyncio.run(writing()) == sent


@pytest.mark.parametrize("pause", [0, 3 * chunks.LAG])
def test_every_reader_gets_all_in_order(tmp_path: Path, monkeypatch: pytest.MonkeyPatch, pause: float) -> None:
    """Also one whom no thread waits for."""
    pushed: list[bool] = []
    push = chunks._pushed

    def noted(connection: Any, body: memoryview) -> int:
        sent = push(connection, body)
        pushed.append(sent == len(body))
        return sent

    monkeypatch.setattr(chunks, "_pushed", noted)
    monkeypatch.setattr(exchange, "PART", 2**21)
    monkeypatch.setattr(exchange, "WHOLE", 1)
    q = np.random.default_rng(0).uniform(-3, 3, (60_000, 1))
    body = b"".join(write_npz({"q": q, "quantities": np.array(NAMES)}).pieces)
    settings = Settings(database=f"sqlite:///{tmp_path}/store.db", catalogue=False)
    with background(settings) as address, Client(address) as client:
        client.submit(PENDULUM)
        client.create_tree(TREE)
        client.request("POST", "/v1/trees/cell/kernels", {"quantities": NAMES})
        connection = HTTPConnection(address.removeprefix("http://"))
        connection.request("POST", URL, body, {"Content-Type": MEDIA_TYPE})
        answer, read = connection.getresponse(), list[bytes]()
        assert answer.headers["transfer-encoding"] == "chunked"
        while piece := answer.read(2**20):
            read.append(piece)
            sleep(pause)
        connection.close()
        expected = client.evaluate("cell", quantities=NAMES, q=q)
    found = view_npz(np.frombuffer(b"".join(read), np.uint8))
    for name in ("metric", "forces"):
        np.testing.assert_array_equal(found[name], expected[name])
    np.testing.assert_array_equal(found["kinematics.rotation"], expected["kinematics"]["rotation"])
    assert pushed
    if pause:
        assert False in pushed
