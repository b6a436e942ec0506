"""States uploaded for a job, as npz and as Arrow streams, in both databases: checked, cut, kept, shared and removed."""

from __future__ import annotations

import io
from collections.abc import Iterator, Mapping
from datetime import timedelta
from threading import Event, current_thread
from typing import IO, Any

import numpy as np
import pytest
import sqlalchemy as sa
from fastapi.testclient import TestClient

from service.app import open_store
from service.database.job_tables import job_items, job_uploads, jobs, results, uploads
from service.operations.jobs import batches
from service.queries.common import now
from service.queue.supervisor import sweep
from service.settings import Limits, Settings
from service.store.store import Store
from substructures.formats.arrays import read_npz, write_npz
from substructures.formats.arrow import MEDIA_TYPE as ARROW
from substructures.formats.arrow import read_tables

from .conftest import HAND, PENDULUM, SLIDER, TREE, make_client
from .databases import fresh
from .fake_engine import FakeEngine, finished, items, running
from .queue_rounds import clear
from .test_arrow import lists, stream

NPZ = "application/x-npz"
URL = "/v1/trees/cell/evaluations"
N = 25
Q = np.linspace(-1, 1, 2 * N).reshape(N, 2)
MASSES = np.linspace(1, 2, N)
NAMES = ["metric", "forces"]


@pytest.fixture(scope="module", params=["sqlite", "postgresql"])
def opened(request: pytest.FixtureRequest, tmp_path_factory: pytest.TempPathFactory) -> Iterator[Store]:
    limits = Limits(job_states=10)
    with (
        fresh(request.param, tmp_path_factory.mktemp("uploads")) as address,
        open_store(Settings(database=address, catalogue=False, limits=limits)) as store,
    ):
        client = make_client(store)
        for path, body in (("substructures", PENDULUM), ("substructures", SLIDER), ("trees", TREE)):
            assert client.post(f"/v1/{path}", json=body).status_code == 201
        assert client.post("/v1/trees/cell/couplings", json=HAND).status_code == 201
        yield store


@pytest.fixture
def store(opened: Store) -> Iterator[Store]:
    """A store with a tree and without jobs."""
    yield opened
    clear(opened)


@pytest.fixture
def client(store: Store) -> TestClient:
    return make_client(store)


def npz(**arrays: Any) -> bytes:
    return b"".join(write_npz({name.replace("__", "."): x for name, x in arrays.items()}).pieces)


def whole(**more: Any) -> bytes:
    given = {"q": Q, "qd": [0.5, 0.1], "parameters__arm.m": MASSES, "inputs__tau.arm.q": 0.5}
    return npz(quantities=NAMES, **{**given, **more})


def upload(client: TestClient, body: bytes, sent: str = NPZ, **headers: str) -> Any:
    return client.post(URL, content=body, headers={"Content-Type": sent, "Prefer": "respond-async", **headers})


def count(store: Store, *tables: sa.Table) -> list[int]:
    with store.database.read() as connection:
        return [connection.execute(sa.select(sa.func.count()).select_from(table)).scalar_one() for table in tables]


def computed(client: TestClient, store: Store, job: str) -> list[dict[str, Any]]:
    with running(store, FakeEngine()):
        assert finished(client, job)["state"] == "succeeded"
    return items(client, job)


def expected(client: TestClient) -> Mapping[str, Any]:
    answer = client.post(URL, content=whole(), headers={"Content-Type": NPZ})
    assert answer.status_code == 200, answer.text
    return read_npz(io.BytesIO(answer.content), 2**20)


def test_npz_becomes_items_of_bounded_size(client: TestClient, store: Store) -> None:
    answer = upload(client, whole())
    assert (answer.status_code, answer.json()["progress"]["total"]) == (202, 3)
    assert answer.headers["location"] == f"/v1/jobs/{answer.json()['id']}"
    assert count(store, uploads, job_uploads) == [3, 3]
    engine = FakeEngine()
    with running(store, engine):
        assert finished(client, answer.json()["id"])["state"] == "succeeded"
    assert all(sum(map(len, work.blobs.values())) < len(whole()) + 20_000 for work in engine.started)
    assert {len(work.blobs) for work in engine.started} == {3}  # the program, the definition and a chunk
    found = items(client, answer.json()["id"])
    assert [item["result"]["range"] for item in found] == [[0, 10], [10, 20], [20, 25]]
    parts = [read_npz(io.BytesIO(client.get(item["files"][0]["href"]).content), 2**20) for item in found]
    known = expected(client)
    for name in NAMES:
        np.testing.assert_allclose(np.concatenate([part[name] for part in parts]), known[name], rtol=1e-13)


def test_record_batches_of_any_size_give_the_same_items(client: TestClient, store: Store) -> None:
    """Also the same chunks: nothing is stored, or computed, twice."""
    constants = {"quantities": NAMES, "inputs": {"tau.arm.q": 0.5}}
    rows = [slice(0, 1), slice(1, 2), slice(2, 24), slice(24, 25)]
    qd = np.tile([0.5, 0.1], (N, 1))
    parts = [{"q": lists(Q[r]), "qd": lists(qd[r]), "parameters.arm.m": MASSES[r]} for r in rows]
    first = upload(client, stream(parts, constants), ARROW)
    assert first.status_code == 202, first.text
    found = computed(client, store, first.json()["id"])
    tables = [next(read_tables(io.BytesIO(client.get(i["files"][0]["href"]).content))) for i in found]
    assert {item["files"][0]["media_type"] for item in found} == {ARROW}
    for name in NAMES:
        np.testing.assert_allclose(np.concatenate([t[name] for t in tables]), expected(client)[name], rtol=1e-13)
    again = upload(client, whole(qd=qd), NPZ, Accept=ARROW)
    assert (again.json()["state"], again.json()["progress"]["done"]) == ("succeeded", 3)
    assert count(store, uploads, job_uploads, results) == [3, 6, 3]


def test_one_state_and_lists(client: TestClient, store: Store) -> None:
    (item,) = computed(client, store, upload(client, npz(quantities=NAMES, q=Q[0])).json()["id"])
    result = read_npz(io.BytesIO(client.get(item["files"][0]["href"]).content), 2**20)
    assert result["metric"].shape == (2, 2)
    listed = {"quantities": NAMES, "q": Q[:3].tolist()}
    answer = client.post(URL, json=listed, headers={"Prefer": "respond-async", "Accept": ARROW})
    (item,) = computed(client, store, answer.json()["id"])
    assert item["files"][0]["media_type"] == ARROW


BROKEN = Q.copy()
BROKEN[17, 1] = np.nan


@pytest.mark.parametrize(
    ("arrays", "pointer"),
    [
        ({"q": BROKEN}, "/q/17/1"),
        ({"q": Q[:, :1]}, "/q"),
        ({"q": Q.astype(str)}, "/q/0/0"),
        ({"qd": Q[:3]}, "/qd"),
        ({"parameters__arm.m": MASSES[:3]}, "/parameters/arm.m"),
        ({"parameters__arm.mm": MASSES}, "/parameters/arm.mm"),
        ({"parameters__arm.m": BROKEN[:, 1]}, "/parameters/arm.m/17"),
        ({"speed": MASSES}, "/speed"),
        ({"quantities": ["metric", "beauty"]}, "/quantities/1"),
        ({"quantities": ["inverse_dynamics"]}, "/qdd"),
    ],
)
def test_bad_arrays_are_named(client: TestClient, store: Store, arrays: Mapping[str, Any], pointer: str) -> None:
    given = {"q": Q, "parameters__arm.m": MASSES, "quantities": NAMES, **arrays}
    answer = upload(client, npz(**given))
    assert (answer.status_code, answer.json()["errors"][0]["pointer"]) == (422, pointer)
    assert count(store, uploads, jobs) == [0, 0]


def test_faults_of_later_batches_have_the_place_in_the_stream(client: TestClient, store: Store) -> None:
    parts = [{"q": lists(part)} for part in (Q[:5], BROKEN[5:], Q)]
    answer = upload(client, stream(parts, {"quantities": NAMES}), ARROW)
    assert (answer.status_code, answer.json()["errors"][0]["pointer"]) == (422, "/q/17/1")
    columns = [{"q.arm.q": part[:, 0], "q.hand.q": part[:, 1]} for part in (Q[:5], BROKEN[5:])]
    answer = upload(client, stream(columns, {"quantities": NAMES}), ARROW)
    assert (answer.status_code, answer.json()["errors"][0]["pointer"]) == (422, "/q/hand.q/17")
    uneven = upload(client, stream(parts[:1], {"quantities": NAMES, "t": [0, 1]}), ARROW)
    assert (uneven.status_code, uneven.json()["errors"][0]["pointer"]) == (422, "/t")
    cut = upload(client, stream(parts[:1] * 3, {"quantities": NAMES})[:-100], ARROW)
    assert (cut.status_code, cut.json()["errors"][0]["code"]) == (422, "arrow")
    missing = {"name": "free", "instances": [{"name": "a", "substructure": "slider"}]}
    assert client.post("/v1/trees", json=missing).status_code == 201
    body, headers = npz(quantities=["forces"], q=Q[:, :1]), {"Content-Type": NPZ, "Prefer": "respond-async"}
    answer = client.post("/v1/trees/free/evaluations", content=body, headers=headers)
    assert (answer.status_code, answer.json()["code"]) == (422, "missing-value")
    assert "a.k" in answer.json()["detail"]
    assert count(store, jobs) == [0]


def test_limits(store: Store, monkeypatch: pytest.MonkeyPatch) -> None:
    for limits, status in (
        (Limits(job_states=10, job_items=2), 422),
        (Limits(job_states=10, job_queue=2), 422),
        (Limits(binary_bytes=100), 413),
    ):
        monkeypatch.setattr(store, "settings", store.settings.model_copy(update={"limits": limits}))
        assert upload(make_client(store), whole()).status_code == status
        assert count(store, jobs) == [0]


def test_a_full_queue_is_noticed_before_states_are_stored(store: Store, monkeypatch: pytest.MonkeyPatch) -> None:
    limits = Limits(job_states=10, job_queue=1)
    monkeypatch.setattr(store, "settings", store.settings.model_copy(update={"limits": limits}))
    assert upload(make_client(store), npz(quantities=NAMES, q=Q[:5])).status_code == 202
    answer = upload(make_client(store), whole())
    assert (answer.status_code, answer.json()["code"]) == (503, "queue-full")
    assert answer.headers["Retry-After"]
    assert count(store, uploads, jobs) == [1, 1]


def test_arrays_that_take_too_long_become_jobs(
    client: TestClient, store: Store, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Nobody reads where another thread is reading."""
    begun, go_on = Event(), Event()
    read = batches.npz_request

    def slow(file: IO[bytes], limits: Limits) -> Any:
        if current_thread().name.startswith("evaluate"):
            file.read(10)
            begun.set()
            go_on.wait(20)
        return read(file, limits)

    monkeypatch.setattr(batches, "npz_request", slow)
    limits = store.settings.limits.model_copy(update={"sync_seconds": 0.5})
    monkeypatch.setattr(store, "settings", store.settings.model_copy(update={"limits": limits}))
    answer = upload(client, whole(), Prefer="", **{"Idempotency-Key": "1"})
    assert begun.is_set()
    go_on.set()
    assert (answer.status_code, answer.json()["progress"]["total"]) == (202, 3)
    assert upload(client, whole(), Prefer="", **{"Idempotency-Key": "1"}).content == answer.content
    assert count(store, jobs, uploads) == [1, 3]


def test_uploads_go_with_their_jobs(client: TestClient, store: Store) -> None:
    old, young = (upload(client, body).json()["id"] for body in (whole(), whole(q=np.vstack([Q[:10], Q[10:] / 2]))))
    assert count(store, uploads, job_uploads) == [5, 6]
    for job in (old, young):
        computed(client, store, job)
    with store.database.write() as connection:
        connection.execute(uploads.update().values(touched=now(timedelta(hours=-2))))
        connection.execute(jobs.update().where(jobs.c.id == old).values(finished=now(timedelta(days=-40))))
    assert upload(client, npz(quantities=NAMES, q=Q[:, :1])).status_code == 422
    sweep(store, Event())
    assert client.get(f"/v1/jobs/{old}").status_code == 404
    assert count(store, uploads, job_uploads, job_items) == [3, 3, 3]
    assert client.get(items(client, young)[0]["files"][0]["href"]).status_code == 200
