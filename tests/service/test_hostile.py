"""Nothing from outside is ever executed: payloads through every string of every document, path and query.

Each of 17 payloads takes the place of each of some 90 strings, and what is stored is printed in 8 formats: some 10 s.
"""

from __future__ import annotations

import copy
import sys
from collections.abc import Iterator
from pathlib import Path
from typing import Any
from urllib.parse import quote

import pytest
from fastapi.testclient import TestClient

from substructures.compile.target import math_library

from .conftest import HAND, PENDULUM, SLIDER, TREE
from .one_store import double, filled, store

__all__ = ["double", "filled", "store"]  # fixtures

PAYLOADS = [
    "__import__('os').system('touch executed')",
    "().__class__.__base__.__subclasses__()",
    "exec('import os')",
    "{{7*7}}${7*7}<%= 7*7 %>#{7*7}",
    "%(x)s %s {0.__class__}",
    "'; DROP TABLE versions; --",
    "\" OR 1=1 --",
    "../../../../etc/passwd",
    "<script>alert(1)</script>",
    "*/ system(\"touch executed\"); /*",
    "\n#include <stdlib.h>\n",
    "\\input{/etc/passwd}\\write18{touch executed}",
    "$(touch executed)`touch executed`",
    "x" * 5000,
    "1e400",
    "9" * 1000,
    "\u202e\u0000\ud7ff\U0001f4a3",
]  # fmt: skip
FULL = {
    **PENDULUM,
    "description": "text",
    "license": "text",
    "source": "text",
    "inputs": {"u": {"unit": "N", "description": "text"}},
    "loads": [
        {"type": "force", "body": "rod", "at": [0, 0, 0], "vector": ["u", 0, 0], "frame": "world"},
        {"type": "spring", "from": {"body": "base"}, "to": {"body": "rod"}, "stiffness": "m"},
        {"type": "joint", "coordinate": "q", "force": "sin(q) + q' + t"},
    ],
}


def strings(document: Any, path: tuple[Any, ...] = ()) -> Iterator[tuple[tuple[Any, ...], bool]]:
    """Where a document has strings: path, and whether it is a key."""
    if isinstance(document, dict):
        for key, value in document.items():
            yield (*path, key), True
            yield from strings(value, (*path, key))
    elif isinstance(document, list):
        for index, value in enumerate(document):
            yield from strings(value, (*path, index))
    else:
        yield path, False


def infected(document: Any, path: tuple[Any, ...], is_key: bool, payload: str) -> Any:
    """The document with one string replaced."""
    result = copy.deepcopy(document)
    here = result
    for step in path[:-1]:
        here = here[step]
    if is_key:
        here[payload] = here.pop(path[-1])
    else:
        here[path[-1]] = payload
    return result


SPAWNING = ("os.system", "os.exec", "os.posix_spawn", "os.spawn", "os.startfile", "subprocess.Popen", "pty.spawn")


class Watch:
    """An audit hook (it cannot be removed, so there is one): notes processes and compiled payloads while active."""

    def __init__(self) -> None:
        self.is_active = False
        self.executed: list[str] = []

    def __call__(self, event: str, arguments: tuple[Any, ...]) -> None:
        if not self.is_active:
            return
        source = str(arguments[0]) if event == "compile" else ""
        if event in SPAWNING or any(payload in source for payload in PAYLOADS):
            self.executed.append(f"{event} {arguments}")


WATCH = Watch()
sys.addaudithook(WATCH)


@pytest.fixture
def _guard(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Iterator[None]:
    """Starting a process or compiling a payload fails the test."""
    monkeypatch.chdir(tmp_path)
    math_library()  # is looked for by a process, once, when the first kernel is compiled
    WATCH.is_active, WATCH.executed = True, []
    yield
    WATCH.is_active = False
    assert WATCH.executed == []
    assert not (tmp_path / "executed").exists()


@pytest.fixture
def guarded(filled: TestClient, _guard: None) -> TestClient:
    """A client of a server that knows pendulum, slider and cell@1."""
    return filled


@pytest.fixture
def guarded_parts(double: TestClient, _guard: None) -> TestClient:
    """A client of another server, on which there may be any number of pendulums."""
    return double


def test_the_watch_sees(guarded: TestClient) -> None:
    assert guarded
    assert eval(PAYLOADS[1])  # noqa: S307 -- shows that the payload would be seen
    assert len(WATCH.executed) == 1
    WATCH.executed.clear()


FORMATS = ("text", "latex", "sympy", "python", "c", "matlab", "julia", "json")


def check(client: TestClient, path: str, document: Any) -> None:
    """Refused with a problem document, or harmlessly stored and printed."""
    answer = client.post(f"/v1/{path}", json=document)
    assert answer.status_code in (200, 201, 422), answer.text
    if answer.status_code == 422:
        assert answer.headers["content-type"] == "application/problem+json"
        return
    location = answer.headers.get("location")
    if location is None:
        return
    assert client.get(location).status_code == 200
    formulas = f"{location}/formulas/metric" if "/substructures/" in location else f"{location}/forces"
    for name in FORMATS:
        printed = client.get(formulas, params={"format": name})
        assert printed.status_code == 200, printed.text
        assert "49" not in printed.text or "7*7" in printed.text


@pytest.mark.parametrize("payload", PAYLOADS)
def test_every_string_of_a_definition(guarded_parts: TestClient, payload: str) -> None:
    for path, is_key in strings(FULL):
        check(guarded_parts, "substructures", infected(FULL, path, is_key, payload))


@pytest.mark.parametrize("payload", PAYLOADS)
def test_every_string_of_trees_couplings_and_evaluations(guarded: TestClient, payload: str) -> None:
    guarded.post("/v1/substructures", json=SLIDER)
    evaluation = {"quantities": ["metric"], "q": [0], "parameters": {"arm.m": 1}, "inputs": {"tau.arm.q": 1}, "t": 0}
    for path, document in (("trees", TREE), ("trees/cell@1/couplings", HAND), ("trees/cell@1/evaluations", evaluation)):
        for where, is_key in strings(document):
            check(guarded, path, infected(document, where, is_key, payload))


@pytest.mark.parametrize("payload", PAYLOADS)
def test_every_part_of_addresses(guarded: TestClient, rows: Any, payload: str) -> None:
    before, text = rows(), quote(payload, safe="")
    paths = [
        f"/v1/substructures/{text}", f"/v1/substructures/pendulum@{text}", f"/v1/substructures/pendulum/{text}",
        f"/v1/substructures/pendulum/formulas/{text}", f"/v1/substructures/pendulum/formulas/metric?component={text}",
        f"/v1/substructures/pendulum/formulas/Omega?body={text}", f"/v1/substructures/pendulum/aliases/{text}",
        f"/v1/substructures?q={text}", f"/v1/substructures?tag={text}", f"/v1/substructures?sort={text}",
        f"/v1/substructures?joints={text}", f"/v1/substructures?page_token={text}", f"/v1/trees?page_token={text}",
        f"/v1/trees/{text}", f"/v1/trees/cell/{text}", f"/v1/trees/cell/metric?bind={text}",
        f"/v1/trees/cell/metric?bind=arm.m:{text}", f"/v1/trees/cell/metric?format={text}",
        f"/v1/trees/cell/metric?form={text}",
    ]  # fmt: skip
    for path in paths:
        answer = guarded.get(path)
        assert answer.status_code in (200, 404, 422), (path, answer.text)
        if answer.status_code != 200:
            assert answer.headers["content-type"] == "application/problem+json"
    headers = {name: payload.encode() for name in ("Accept", "If-None-Match", "Authorization", "X-Request-Id")}
    for name, value in headers.items():
        if b"\n" not in value and b"\0" not in value:
            assert guarded.get("/v1/trees/cell@1/metric", headers={name: value}).status_code in (200, 406)
    assert rows() == before
