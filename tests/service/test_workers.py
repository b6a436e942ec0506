"""Runners that compute for those that answer: what they make comes back as it was said; they may be killed."""

from __future__ import annotations

import contextlib
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

from service.content.cache import Cache

from .conftest import PENDULUM, TREE
from .farm import Server, running
from .jobs_library import chain as serial_chain

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
    with httpx2.Client(base_url=server.address, timeout=60, verify=False) as client:
        assert client.post("/v1/substructures", json=PENDULUM).status_code in (200, 201)
        assert client.post(TREES, json=TREE).status_code in (200, 201)
        yield client


def used(pid: int) -> int:
    """Ticks of CPU time."""
    fields = Path(f"/proc/{pid}/stat").read_text().rpartition(")")[2].split()
    return int(fields[11]) + int(fields[12])


def test_what_takes_long_is_done_by_another_process(server: Server, http: httpx2.Client) -> None:
    until(server.computing)
    [answers] = server.serving()
    before = used(answers), sum(map(used, server.computing()))
    for i in range(12):
        # each of another shape: what is known is not computed again
        instances = [{**arm, "at": f"p{k - 1}.tip" if k else "world"} for k, arm in enumerate(chain(3 + i))]
        assert http.post(TREES, json={"name": f"t{i}", "instances": instances}).status_code == 201
    spent = used(answers) - before[0], sum(map(used, server.computing())) - before[1]
    assert spent[1] > 2 * spent[0]


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
    for computes in server.computing():
        os.kill(computes, signal.SIGKILL)
    assert http.post(f"{TREES}/{TREE['name']}/simulations", json=MOTION).status_code == 200
    assert http.get(METRIC).status_code == 200


def chain(count: int) -> list[dict[str, Any]]:
    return [{"name": f"p{i}", "substructure": PENDULUM["name"]} for i in range(count)]


def test_killed_at_work_another_one_does_it(server: Server, http: httpx2.Client) -> None:
    """A runner stores nothing, so that what it did is done again; whoever asked notices nothing."""
    found: list[httpx2.Response] = []
    until(server.computing)
    before = {pid: used(pid) for pid in server.computing()}
    document = {"name": "long", "instances": chain(40)}
    thread = threading.Thread(target=lambda: found.append(http.post(TREES, json=document)))
    thread.start()
    until(lambda: [pid for pid in before if used(pid) > before[pid] + 2])
    [busy] = [pid for pid in before if used(pid) > before[pid] + 2]
    os.kill(busy, signal.SIGKILL)
    thread.join()
    assert (found[0].status_code, found[0].json()["revision"]) == (201, 1)
    again = http.post(TREES, json=document)
    assert (again.status_code, again.json()["revision"]) == (200, 1)


def test_a_line_in_the_log_for_each_request(server: Server, http: httpx2.Client) -> None:
    http.post(TREES, json={**TREE, "name": "logged"}, headers={"X-Request-Id": "logged-once"})
    until(lambda: "logged-once" in server.log.read_text())
    lines = [line for line in server.log.read_text().splitlines() if "logged-once" in line]
    assert len(lines) == 1, lines


HOSTILE = {
    "derive": ("/v1/substructures", serial_chain(60, "hostile")),
    "couple": (TREES, {"name": "hostile", "instances": chain(150)}),
    "compare": ("/v1/equivalences", {"a": serial_chain(30, "one"), "b": serial_chain(30, "two")}),
    "simulate": (f"{TREES}/{TREE['name']}/simulations", {"q": [0.5], "span": [0, 1e6], "relative_tolerance": 1e-12}),
}


def asked(server: Server) -> list[threading.Thread]:
    """Threads that ask for all that takes long, each several times."""

    def ask(path: str, body: Any) -> None:
        with contextlib.suppress(httpx2.HTTPError):
            httpx2.post(server.address + path, json=body, timeout=60, verify=False)

    return [threading.Thread(target=ask, args=HOSTILE[what]) for what in HOSTILE for _ in range(3)]


@pytest.fixture
def patient(tmp_path: Path) -> Server:
    """A server whose requests may take long."""
    one = Server(f"sqlite:///{tmp_path / 'x.db'}", tmp_path / "log", ("--workers", "1"))
    one.environment |= {"SUBSTRUCTURES_LIMIT_SYNC_SECONDS": "600", "SUBSTRUCTURES_LIMIT_SYNC_NODES": "10000000"}
    one.environment |= {"SUBSTRUCTURES_LIMIT_PROGRAM_NODES": "10000000", "TMPDIR": str(tmp_path)}
    return one


def test_told_to_end_it_ends_whatever_is_done(patient: Server) -> None:
    """In ten seconds, with nothing left behind, while it derives, couples, compares and simulates; reads go on."""
    with running([patient]), httpx2.Client(base_url=patient.address, timeout=60, verify=False) as client:
        assert client.post("/v1/substructures", json=PENDULUM).status_code == 201
        assert client.post(TREES, json=TREE).status_code == 201
        threads = asked(patient)
        for thread in threads:
            thread.start()
        until(lambda: len(patient.computing()) > 1)
        assert client.get(f"{TREES}/{TREE['name']}").status_code == 200
        processes = [*patient.serving(), *patient.workers()]
        assert patient.process is not None
        start = time.monotonic()
        patient.process.terminate()
        assert patient.process.wait(30) == 0
        assert time.monotonic() - start < 10
        for thread in threads:
            thread.join(10)
    assert not [pid for pid in processes if Path(f"/proc/{pid}").exists()]


def test_a_parent_that_is_killed_leaves_nothing(patient: Server, tmp_path: Path) -> None:
    with running([patient]):
        until(patient.computing)
        processes = [*patient.serving(), *patient.workers()]
        patient.kill()
        until(lambda: not [pid for pid in processes if Path(f"/proc/{pid}").exists()], 10)
        assert {path.name.partition(".")[0] for path in tmp_path.iterdir()} == {"x", "log"}


def test_what_takes_too_long_is_told_as_that(tmp_path: Path) -> None:
    """Not as a process that was ended; what is no job is 503 with the limit, the rest becomes one."""
    one = Server(f"sqlite:///{tmp_path / 'x.db'}", tmp_path / "log", ("--workers", "1"))
    one.environment |= {"SUBSTRUCTURES_LIMIT_SYNC_SECONDS": "0.5", "SUBSTRUCTURES_LIMIT_SYNC_NODES": "10000000"}
    one.environment |= {"SUBSTRUCTURES_LIMIT_PROGRAM_NODES": "10000000"}  # not refused for its size before that
    with running([one]), httpx2.Client(base_url=one.address, timeout=60, verify=False) as client:
        path, body = HOSTILE["compare"]
        late = client.post(path, json=body)
        assert (late.status_code, late.json()["code"], late.json()["limit"]) == (503, "took-too-long", 0.5), late.text
        assert "retry-after" not in late.headers
        assert "longer than 0.5 s" in late.json()["detail"]
        path, body = HOSTILE["derive"]
        assert client.post(path, json=body).status_code == 202


@pytest.mark.deep  # 6 s of CPU: two more processes, each with its imports
def test_each_of_several_processes_has_its_own(tmp_path: Path) -> None:
    one = Server(f"sqlite:///{tmp_path / 'x.db'}", tmp_path / "log", ("--workers", "1", "--processes", "2"))
    with running([one]), ThreadPoolExecutor(8) as pool:
        until(lambda: len(one.computing()) >= len(one.serving()) == 2)

        def trees(k: int) -> int:
            with httpx2.Client(base_url=one.address, timeout=60, verify=False) as client:
                client.post("/v1/substructures", json=PENDULUM)
                found = [client.post(TREES, json={"name": f"t{k}-{i}", "instances": chain(8)}) for i in range(5)]
                return sum(each.status_code == 201 for each in found)

        assert list(pool.map(trees, range(8))) == [5] * 8
        spent = [sum(map(used, one.computing(pid))) for pid in one.serving()]
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
