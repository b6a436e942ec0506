"""The process that computes for those that answer: what is passed on comes back as it was said; it may be killed."""

from __future__ import annotations

import os
import signal
import threading
import time
from collections.abc import Callable, Iterator
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path
from typing import Any

import httpx2
import pytest

from service.cache import Cache

from .conftest import PENDULUM, TREE
from .farm import Server, running

TREES = "/v1/trees"
MOTION = {"q": [0.5], "span": [0, 1]}
METRIC = f"{TREES}/{TREE['name']}@1/metric?format=latex"


def until(condition: Callable[[], Any], seconds: float = 60) -> None:
    end = time.monotonic() + seconds
    while not condition():
        assert time.monotonic() < end
        time.sleep(0.02)


@pytest.fixture(scope="module")
def server(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Server]:
    folder = tmp_path_factory.mktemp("away")
    one = Server(f"sqlite:///{folder / 'x.db'}", folder / "log", ("--workers", "1"))
    with running([one]):
        until(one.computing)
        yield one


@pytest.fixture
def http(server: Server) -> Iterator[httpx2.Client]:
    with httpx2.Client(base_url=server.address, timeout=60) as client:
        assert client.post("/v1/substructures", json=PENDULUM).status_code in (200, 201)
        assert client.post(TREES, json=TREE).status_code in (200, 201)
        yield client


def used(pid: int) -> int:
    """Ticks of CPU time."""
    fields = Path(f"/proc/{pid}/stat").read_text().rpartition(")")[2].split()
    return int(fields[11]) + int(fields[12])


def test_what_takes_long_is_done_by_another_process(server: Server, http: httpx2.Client) -> None:
    until(server.computing)
    [answers], [computes] = server.serving(), server.computing()
    before = used(answers), used(computes)
    arms = [{"name": f"p{i}", "substructure": PENDULUM["name"]} for i in range(8)]
    for i in range(12):
        instances = [{**arm, "placement": {"position": [0, 0, i + 1]}} for arm in arms]
        assert http.post(TREES, json={"name": f"t{i}", "instances": instances}).status_code == 201
    spent = used(answers) - before[0], used(computes) - before[1]
    assert spent[1] > 3 * spent[0]


def test_answers_come_back_as_they_were_said(http: httpx2.Client) -> None:
    made = http.post(TREES, json={**TREE, "name": "second"}, headers={"X-Request-Id": "mine", "Idempotency-Key": "k"})
    assert made.status_code == 201
    assert made.headers["location"].endswith("/second@1")
    assert int(made.headers["content-length"]) == len(made.content)  # not in chunks of no stated length
    assert made.headers["x-request-id"] == "mine"
    again = http.post(TREES, json={**TREE, "name": "second"}, headers={"Idempotency-Key": "k"})
    assert (again.status_code, again.json()) == (201, made.json())
    other = http.post(TREES, json={**TREE, "name": "third"}, headers={"Idempotency-Key": "k"})
    assert other.status_code == 422
    refused = http.post(TREES, json={"name": "bad name"})
    assert refused.headers["content-type"] == "application/problem+json"
    assert refused.json()["errors"][0]["pointer"] == "/name"
    assert [name for name, _ in refused.headers.multi_items()].count("x-request-id") == 1
    late = http.post(f"{TREES}/second/simulations", json=MOTION, headers={"Prefer": "respond-async"})
    assert (late.status_code, late.headers.get("preference-applied")) == (202, "respond-async")


def test_printed_formulas_are_kept_and_conditional(http: httpx2.Client) -> None:
    first, second = http.get(METRIC), http.get(METRIC)
    assert first.status_code == second.status_code == 200
    assert (first.text, first.headers["etag"]) == (second.text, second.headers["etag"])
    assert http.get(METRIC, headers={"If-None-Match": first.headers["etag"]}).status_code == 304
    refused = http.get(f"{TREES}/{TREE['name']}/metric?bind=nothing:1")
    assert (refused.status_code, refused.json()["errors"][0]["pointer"]) == (422, "/query/bind")


def test_what_is_kept_has_its_headers(http: httpx2.Client) -> None:
    """The name of a file, and that a page may have its style: asked twice, since the second answer is the kept one."""
    tree = f"{TREES}/{TREE['name']}@1"
    for _ in range(2):
        report, archive = http.get(f"{tree}/report?format=mathml"), http.get(f"{tree}/export?target=c")
        assert report.headers["content-security-policy"].startswith("default-src 'none'; style-src 'unsafe-inline'")
        assert "filename=" in archive.headers["content-disposition"]


def test_killed_it_is_there_again(server: Server, http: httpx2.Client) -> None:
    until(server.computing)
    [computes] = server.computing()
    os.kill(computes, signal.SIGKILL)
    # what stores nothing waits for the next process, and evaluations do without
    simulated = http.post(f"{TREES}/{TREE['name']}/simulations", json=MOTION)
    assert simulated.status_code == 200
    assert http.get(METRIC).status_code == 200
    assert server.computing() != [computes]


def test_killed_at_work_it_says_so(server: Server, http: httpx2.Client) -> None:
    chain = [{"name": f"p{i}", "substructure": PENDULUM["name"]} for i in range(60)]
    found: list[httpx2.Response] = []
    thread = threading.Thread(target=lambda: found.append(http.post(TREES, json={"name": "long", "instances": chain})))
    until(server.computing)
    [computes] = server.computing()
    before = used(computes)
    thread.start()
    until(lambda: used(computes) > before + 2)
    os.kill(computes, signal.SIGKILL)
    thread.join()
    if found[0].status_code != 201:  # unless it was quicker
        assert (found[0].status_code, found[0].json()["code"]) == (503, "restarting")
        assert found[0].headers["retry-after"] == "1"
    again = http.post(TREES, json={"name": "long", "instances": chain})
    assert again.status_code in (200, 201)
    assert again.json()["revision"] == 1


def test_the_socket_is_private_and_goes(server: Server) -> None:
    until(server.computing)
    [computes] = server.computing()
    inodes = {str(x.readlink()) for x in Path(f"/proc/{computes}/fd").iterdir() if x.is_symlink()}
    lines = [line.split() for line in Path("/proc/net/unix").read_text().splitlines()[1:]]
    [path] = {x[7] for x in lines if len(x) > 7 and f"socket:[{x[6]}]" in inodes and "/computing-" in x[7]}
    assert Path(path).parent.stat().st_mode & 0o077 == 0
    server.stop()
    assert not Path(path).parent.exists()


def test_each_of_several_processes_has_one_that_computes_for_it(tmp_path: Path) -> None:
    one = Server(f"sqlite:///{tmp_path / 'x.db'}", tmp_path / "log", ("--workers", "1", "--processes", "2"))
    with running([one]), ThreadPoolExecutor(8) as pool:
        until(lambda: len(one.computing()) == len(one.serving()) == 2)
        before = {pid: used(pid) for pid in one.computing()}

        def trees(k: int) -> int:
            with httpx2.Client(base_url=one.address, timeout=60) as client:
                client.post("/v1/substructures", json=PENDULUM)
                arms = [{"name": f"p{i}", "substructure": PENDULUM["name"]} for i in range(8)]
                found = [client.post(TREES, json={"name": f"t{k}-{i}", "instances": arms}) for i in range(5)]
                return sum(each.status_code == 201 for each in found)

        assert list(pool.map(trees, range(8))) == [5] * 8
        spent = [used(pid) - ticks for pid, ticks in before.items()]
    assert min(spent) > max(spent) / 10


def test_one_makes_what_many_ask_for() -> None:
    cache, made, ready = Cache[str](100, len), list[int](), threading.Event()

    def make() -> str:
        made.append(1)
        ready.wait(10)
        return "value"

    found: list[str] = []
    threads = [threading.Thread(target=lambda: found.append(cache.once("key", make))) for _ in range(8)]
    for thread in threads:
        thread.start()
    until(lambda: made)
    ready.set()
    for thread in threads:
        thread.join()
    assert (found, len(made)) == (["value"] * 8, 1)


def test_what_could_not_be_made_is_tried_again() -> None:
    cache = Cache[str](100, len)

    def fail() -> str:
        raise ValueError("no")

    with pytest.raises(ValueError, match="no"):
        cache.once("key", fail)
    assert cache.once("key", lambda: "value") == "value"
