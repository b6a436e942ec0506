"""Clusters that are not as they should be: workers of other versions, none at all, none any more, no scheduler."""

from __future__ import annotations

import logging
import signal
import socket
import sys
import threading
import time
from collections.abc import Callable, Iterator
from contextlib import closing, contextmanager
from pathlib import Path

import pytest

from service.jobs.engines import dask, dask_cluster
from service.jobs.engines.dask import DaskEngine

from .conftest import PENDULUM, SLIDER, TREE
from .jobs_library import BUDGET, MemoryLibrary, chain, compute
from .test_jobs_dask import Cluster, cells, check, check_limits, connected, runners

OTHER = "import service.jobs.engines.wire\nservice.jobs.engines.wire.PROTOCOL += 1\n"
WITHOUT = "import sys\nsys.modules['service'] = None\n"
linux = pytest.mark.skipif(sys.platform != "linux", reason="/proc is that of Linux")


@pytest.fixture(scope="module")
def library() -> MemoryLibrary:
    return MemoryLibrary([PENDULUM, SLIDER], [TREE])


def until(is_so: Callable[[], object], engine: DaskEngine, seconds: float = 40.0) -> None:
    """Wait while nothing dies."""
    end = time.monotonic() + seconds
    while not is_so():
        assert time.monotonic() < end
        assert not [report for report in engine.reports(0.05) if report.is_final]


def said(caplog: pytest.LogCaptureFixture, *words: str) -> list[str]:
    """The lines of the log with all these words."""
    lines = [record.getMessage() for record in caplog.records if record.name.startswith("service.jobs.engines.dask")]
    return [line for line in lines if all(word in line for word in words)]


@linux
def test_workers_of_other_versions_get_no_works_and_others_compute_within_limits(
    library: MemoryLibrary, tmp_path: Path, caplog: pytest.LogCaptureFixture
) -> None:
    """On one cluster: a scheduler, three workers and the runners, each with its imports, take 10 s of CPU."""
    for name, code in (("other", OTHER), ("without", WITHOUT)):
        (tmp_path / f"{name}.py").write_text(code)
    with closing(Cluster(0)) as cluster, closing(DaskEngine(cluster.address)) as engine:
        cluster.add_workers(1, "--preload", str(tmp_path / "other.py"))
        cluster.add_workers(1, "--preload", str(tmp_path / "without.py"))
        until(lambda: len(said(caplog, "gets no works")) == 2, engine)
        assert engine.free == 0
        cluster.add_workers(1)
        connected(engine)
        works = cells(library, 12)
        check(works, compute(engine, works))
        check_limits(cluster.workers[-1], engine, library)
    assert len(said(caplog, "gets no works: it speaks protocol")) == 1
    assert len(said(caplog, "gets no works: it has no package of this version")) == 1
    assert all("tcp://127.0.0.1:" in line for line in said(caplog, "gets no works"))


@linux
@pytest.mark.deep
def test_works_of_the_only_worker_go_to_the_next_one(library: MemoryLibrary) -> None:
    (work,) = library.works("derive", {"items": [chain(60)]}, BUDGET)
    with closing(Cluster(1)) as cluster, closing(DaskEngine(cluster.address)) as engine:
        connected(engine)
        engine.start(work)
        until(lambda: runners(cluster.workers[0]), engine)
        old = cluster.workers.pop()
        old.kill()
        old.wait()
        cluster.add_workers(1)
        until(lambda: runners(cluster.workers[0]), engine)


@linux
@pytest.mark.deep
def test_a_worker_replaced_by_another_version_at_its_address_fails_nothing(
    library: MemoryLibrary, tmp_path: Path, caplog: pytest.LogCaptureFixture
) -> None:
    (tmp_path / "other.py").write_text(OTHER)
    (work,) = library.works("derive", {"items": [chain(60)]}, BUDGET)
    with socket.create_server(("127.0.0.1", 0)) as free:
        port = str(free.getsockname()[1])
    with closing(Cluster(0)) as cluster, closing(DaskEngine(cluster.address)) as engine:
        cluster.add_workers(1, "--worker-port", port)
        connected(engine)
        engine.start(work)
        until(lambda: runners(cluster.workers[0]), engine)
        old = cluster.workers.pop()
        old.kill()
        old.wait()
        cluster.add_workers(1, "--worker-port", port, "--preload", str(tmp_path / "other.py"))
        until(lambda: said(caplog, f"127.0.0.1:{port}", "gets no works"), engine)
        cluster.add_workers(1)
        until(lambda: runners(cluster.workers[1]), engine)


@pytest.mark.deep
def test_a_worker_that_hangs_stops_no_other(
    library: MemoryLibrary, monkeypatch: pytest.MonkeyPatch, caplog: pytest.LogCaptureFixture
) -> None:
    caplog.set_level(logging.INFO)
    with closing(Cluster(2)) as cluster:
        with closing(DaskEngine(cluster.address)) as engine:
            until(lambda: engine.free == 2 * dask.AHEAD, engine)
        monkeypatch.setattr(dask_cluster, "CONNECT", 5.0)  # a busy machine takes seconds itself
        monkeypatch.setattr(dask_cluster, "AGAIN", 0.5)
        cluster.workers[0].send_signal(signal.SIGSTOP)
        with closing(DaskEngine(cluster.address)) as engine:
            connected(engine)
            works = cells(library, 4)
            check(works, compute(engine, works))
            until(lambda: said(caplog, "gets no works: it does not answer"), engine)
            cluster.workers[0].send_signal(signal.SIGCONT)
            until(lambda: engine.free == 2 * dask.AHEAD, engine)


@contextmanager
def web_server() -> Iterator[str]:
    """Something else that listens: it answers everything like a web server."""

    def answer() -> None:
        while True:
            try:
                connection, _ = listener.accept()
            except OSError:
                return
            with connection:
                connection.sendall(b"HTTP/1.1 400 Bad Request\r\nContent-Length: 0\r\n\r\n" * 4)

    with socket.create_server(("127.0.0.1", 0)) as listener:
        threading.Thread(target=answer, daemon=True).start()
        yield f"tcp://127.0.0.1:{listener.getsockname()[1]}"
        listener.shutdown(socket.SHUT_RDWR)


@pytest.mark.parametrize("address", ["foo://1.2.3.4:5", "nonsense", ""])
def test_what_is_no_scheduler_is_tried_again(
    address: str, monkeypatch: pytest.MonkeyPatch, caplog: pytest.LogCaptureFixture, capfd: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.setattr(dask, "WATCH", 0.05)
    monkeypatch.setattr(dask, "CONNECT", 1.0)
    tries = []
    monkeypatch.setattr(dask, "Client", lambda *a, _client=dask.Client, **k: tries.append(a) or _client(*a, **k))
    with web_server() as web, closing(DaskEngine(address or web)) as engine:
        until(lambda: len(tries) > 2, engine)
    engine.close()
    assert 1 <= len(said(caplog, "no scheduler at")) < len(tries)
    assert len(set(said(caplog))) == len(said(caplog))
    assert "Traceback" not in capfd.readouterr().err
    assert not [record for record in caplog.records if record.exc_info]


@pytest.mark.deep
def test_a_lost_scheduler_and_missing_workers_are_told_of_in_one_line_each(
    monkeypatch: pytest.MonkeyPatch, caplog: pytest.LogCaptureFixture, capfd: pytest.CaptureFixture[str]
) -> None:
    caplog.set_level(logging.INFO)
    monkeypatch.setattr(dask, "FINDING", 0.5)
    with closing(Cluster(0)) as cluster, closing(DaskEngine(cluster.address)) as engine:
        until(lambda: said(caplog, "has no workers of this version"), engine)
        cluster.add_workers(1)
        until(lambda: said(caplog, "has workers again"), engine)
        cluster.scheduler.kill()
        cluster.scheduler.wait()
        until(lambda: said(caplog, "works wait for the scheduler"), engine)
        cluster.workers.pop().wait(30)
        until(lambda: said(caplog, "no scheduler at"), engine)
        cluster.start_scheduler()
        until(lambda: said(caplog, "is there again"), engine)
    for words in ("is connected", "has workers again", "lost the scheduler", "is there again"):
        assert len(said(caplog, words)) == 1
    assert "Traceback" not in capfd.readouterr().err
    assert not [record for record in caplog.records if record.name.startswith("distributed")]
