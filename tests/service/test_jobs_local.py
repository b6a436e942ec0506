"""The pool of runners: what it computes is what is computed in place; limits, kills and broken runners are survived."""

from __future__ import annotations

import os
import pwd
import signal
import subprocess
import sys
import time
from collections.abc import Iterator
from pathlib import Path

import pytest

from service.jobs.engines.engine import Budget, Work
from service.jobs.engines.local import LocalEngine
from service.jobs.engines.process import lacked_memory, rights_of
from service.jobs.kinds import run
from service.queue.engines import engine_of
from service.settings import Settings, SettingsError
from substructures.documents import write_json

from .conftest import PENDULUM, SLIDER, TREE
from .jobs_library import BUDGET, MemoryLibrary, chain, compute

linux = pytest.mark.skipif(sys.platform != "linux", reason="the kernel's limits and /proc are those of Linux")


@pytest.fixture(scope="module")
def library() -> MemoryLibrary:
    return MemoryLibrary([PENDULUM, SLIDER], [TREE])


@pytest.fixture(scope="module")
def pool() -> Iterator[LocalEngine]:
    engine = LocalEngine(1)
    yield engine
    engine.close()


def ready(engine: LocalEngine) -> None:
    for _ in range(200):
        if engine.free:
            return
        engine.reports(0.1)
    raise AssertionError("no runner became ready")


def process_of(engine: LocalEngine) -> int:
    ready(engine)
    (process,) = engine.processes
    return process


def long_work(name: str = "long", budget: Budget = BUDGET) -> Work:
    library = MemoryLibrary([])
    (work,) = library.works("derive", {"items": [chain(40, name)]}, budget)
    return work


def is_gone(pid: int) -> bool:
    for _ in range(200):
        try:
            state = Path(f"/proc/{pid}/stat").read_text().rpartition(")")[2].split()[0]
        except (FileNotFoundError, ProcessLookupError):
            return True
        if state == "Z":
            return True
        time.sleep(0.02)
    return False


def test_pool_computes_what_is_computed_in_place(library: MemoryLibrary, pool: LocalEngine) -> None:
    works = [
        *library.works("assemble", {"items": [{**TREE, "name": f"cell-{k}"} for k in range(3)]}),
        *library.works("verify", {"items": [{"substructure": "*"}]}),
        *library.works("export", {"items": [{"tree": "cell", "quantity": "metric", "format": "text"}]}),
    ]
    for name, report in compute(pool, works).items():
        work = next(work for work in works if work.id == name)
        expected = run(work.kind, dict(work.item), work.blobs, lambda _: None)
        assert report.outcome is not None
        assert report.outcome.problem is None is expected.problem
        timed = {"certificate", "summary", "summary.digests"}
        assert {n: x for n, x in report.outcome.files.items() if n not in timed} == {
            n: x for n, x in expected.files.items() if n not in timed
        }
        assert write_json(dict(report.outcome.summary)) == write_json(dict(expected.summary))


def test_item_that_fails_carries_its_problem_and_the_runner_goes_on(library: MemoryLibrary, pool: LocalEngine) -> None:
    before = process_of(pool)
    slider = {"name": "x", "substructure": "slider", "at": "arm.tip", "parameters": {"k": "2*nothing"}}
    bad = {**TREE, "instances": [*TREE["instances"], slider]}
    reports = compute(pool, library.works("assemble", {"items": [bad, TREE]}))
    outcome = reports["assemble-0"].outcome
    assert outcome is not None
    assert outcome.problem is not None
    assert outcome.problem["status"] == 422
    assert outcome.problem["errors"][0]["pointer"] == "/instances/1/parameters/k"
    assert reports["assemble-1"].outcome is not None
    assert reports["assemble-1"].outcome.problem is None
    assert process_of(pool) == before


@linux
def test_cpu_limit_is_a_problem_of_the_item(pool: LocalEngine, library: MemoryLibrary) -> None:
    works = [long_work(budget=Budget(0.2, 2**31)), *library.works("verify", {"items": [{"substructure": "pendulum"}]})]
    reports = compute(pool, works)
    outcome = reports["derive-0"].outcome
    assert outcome is not None
    assert outcome.problem is not None
    assert outcome.problem["code"] == "cpu-limit"
    assert reports["verify-0"].outcome is not None


@linux
@pytest.mark.parametrize("megabytes", [100, 140])
def test_memory_limit_is_a_problem_of_the_item(pool: LocalEngine, megabytes: int) -> None:
    before = process_of(pool)
    report = compute(pool, [long_work(budget=Budget(60.0, megabytes * 2**20))])["derive-0"]
    assert report.outcome is not None
    assert report.outcome.problem is not None
    assert report.outcome.problem["code"] == "memory-limit"
    assert process_of(pool) != before


@pytest.mark.parametrize(
    "printed",
    [
        "Fatal Python error: _PyErr_NormalizeException: Cannot recover from MemoryErrors while normalizing exceptions.",
        "terminate called after throwing an instance of 'std::bad_alloc'\n  what():  std::bad_alloc",
        "Flint exception (Unable to allocate memory):",
        "memory allocation of 8388608 bytes failed",
        "python3: out of memory",
    ],
)
def test_last_words_of_a_crash_tell_that_memory_was_missing(printed: str) -> None:
    assert lacked_memory(0, 2**30, printed)


def test_other_crashes_are_not_taken_for_a_lack_of_memory() -> None:
    assert not lacked_memory(2**29, 2**30, "free(): invalid pointer")
    assert not lacked_memory(0, 2**30, "Fatal Python error: Segmentation fault\n  File 'memory.py', line 3 in memory")
    assert lacked_memory(int(0.71 * 2**30), 2**30, "")


def test_killed_runner_is_reported_and_replaced(pool: LocalEngine, library: MemoryLibrary) -> None:
    victim = process_of(pool)
    work = long_work()
    pool.start(work)
    os.kill(victim, signal.SIGKILL)
    (report,) = pool.reports(10.0)
    assert report.id == work.id
    assert "signal 9" in report.death
    assert process_of(pool) != victim
    reports = compute(pool, library.works("verify", {"items": [{"substructure": "pendulum"}]}))
    assert reports["verify-0"].outcome is not None


def test_idle_runner_that_is_killed_is_replaced(pool: LocalEngine) -> None:
    victim = process_of(pool)
    os.kill(victim, signal.SIGKILL)
    for _ in range(100):
        assert pool.reports(0.05) == []
        if pool.free and process_of(pool) != victim:
            return
    raise AssertionError("the runner was not replaced")


@linux
def test_stop_kills_and_nothing_is_reported(pool: LocalEngine) -> None:
    victim = process_of(pool)
    work = long_work()
    pool.start(work)
    pool.stop(work.id)
    assert is_gone(victim)
    pool.stop("nothing")
    ready(pool)
    assert pool.reports(0.2) == []


@linux
def test_runner_has_nothing_of_its_parent(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("SUBSTRUCTURES_DATABASE", "postgresql://user:secret@host/database")
    monkeypatch.setenv("PGPASSWORD", "secret")
    with Path(os.devnull).open() as inherited:
        os.set_inheritable(inherited.fileno(), True)
        engine = LocalEngine(1)
        try:
            pid = process_of(engine)
            environment = Path(f"/proc/{pid}/environ").read_text()
            assert "secret" not in environment
            assert "SUBSTRUCTURES" not in environment
            assert "OMP_NUM_THREADS=1" in environment
            descriptors = {str(link.readlink()) for link in Path(f"/proc/{pid}/fd").iterdir()}
            assert all(target.startswith("pipe:") for target in descriptors)
            assert len(descriptors) == 3
            assert os.getsid(pid) == pid
        finally:
            engine.close()
    assert is_gone(pid)


@linux
def test_runner_ends_with_its_parent() -> None:
    script = (
        "import sys, time\n"
        "from service.jobs.engines.local import LocalEngine\n"
        "engine = LocalEngine(1)\n"
        "while not engine.free: engine.reports(0.1)\n"
        "print(*engine.processes, flush=True)\n"
        "time.sleep(60)\n"
    )
    root = str(Path(__file__).parents[2])
    parent = subprocess.Popen([sys.executable, "-c", script], stdout=subprocess.PIPE, text=True, cwd=root)
    assert parent.stdout is not None
    with parent.stdout:
        pid = int(parent.stdout.readline())
    parent.kill()
    parent.wait()
    assert is_gone(pid)


def test_runner_that_cannot_start_is_tried_again_after_a_pause(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("PYTHONHOME", "/nowhere")
    engine = LocalEngine(1)
    try:
        for _ in range(5):
            assert engine.reports(0.1) == []
        assert engine.free == 0
        monkeypatch.delenv("PYTHONHOME")
        ready(engine)
    finally:
        engine.close()


@linux
def test_runners_give_up_rights(pool: LocalEngine) -> None:
    """They gain none (set-user-ID programs), fill no disk, and leave no image of their memory."""
    process = process_of(pool)
    assert "NoNewPrivs:\t1\n" in Path(f"/proc/{process}/status").read_text()
    limits = Path(f"/proc/{process}/limits").read_text().splitlines()
    found = {line[:26].strip(): line[26:].split()[:2] for line in limits[1:]}
    assert found["Max file size"] == ["16777216", "16777216"]
    assert found["Max core file size"] == ["0", "0"]


@linux
@pytest.mark.skipif(os.geteuid() != 0, reason="only a privileged process may give a process to another user")
def test_runners_of_another_user(library: MemoryLibrary) -> None:
    said = subprocess.run(["/usr/bin/id"], capture_output=True, text=True, check=True, **rights_of("nobody")).stdout
    assert said.startswith(f"uid={pwd.getpwnam('nobody').pw_uid}(nobody)")
    assert "root" not in said
    settings = Settings(runner_user="nobody", workers=1)
    python = Path(sys.executable)
    folders = {*python.parents, *python.resolve().parents}
    if any(folder.stat().st_mode & 0o005 != 0o005 for folder in folders):
        with pytest.raises(SettingsError, match="no process of 'nobody' can be started"):  # it may not read this Python
            engine_of(settings)
        return
    make = engine_of(settings)
    assert make is not None
    engine = make()
    try:
        (process,) = engine.processes
        while not engine.free:
            engine.reports(0.1)
        assert Path(f"/proc/{process}").stat().st_uid == pwd.getpwnam("nobody").pw_uid
        assert "Groups:\t \n" in Path(f"/proc/{process}/status").read_text()
        (work,) = library.works("export", {"items": [{"tree": "cell", "quantity": "metric", "format": "text"}]}, BUDGET)
        engine.start(work)
        assert [report.outcome for report in engine.reports(60) if report.is_final]
    finally:
        engine.close()


def test_users_that_there_are_not() -> None:
    with pytest.raises(SettingsError, match="no process of 'nobody-of-this-name'"):
        engine_of(Settings(runner_user="nobody-of-this-name"))
