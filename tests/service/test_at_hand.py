"""One state of a pinned tree by kernels in memory: answered without a change of threads, and the same."""

from __future__ import annotations

from typing import Any

import pytest
from fastapi.testclient import TestClient

from service.operations import at_hand
from service.store import keys
from service.store.store import Store

QUANTITIES = ["metric", "forces", "forward_dynamics"]
STATE: dict[str, Any] = {"quantities": QUANTITIES, "q": [0.1], "qd": [0.2]}
URL = "/v1/trees/cell@1/evaluations"


@pytest.fixture
def warm(filled: TestClient, monkeypatch: pytest.MonkeyPatch) -> TestClient:
    """The tree ``cell`` with kernels; it is looked for again much later."""
    monkeypatch.setattr(at_hand, "SECONDS", 600.0)
    assert filled.post("/v1/trees/cell@1/kernels", json={"quantities": QUANTITIES}).status_code == 201
    return filled


@pytest.fixture
def threads(store: Store, monkeypatch: pytest.MonkeyPatch) -> list[object]:
    """The works that threads were given."""
    given: list[object] = []
    pool = store.runtime.threads["evaluate"]
    submit = pool.submit

    def spied(*arguments: Any) -> Any:
        given.append(arguments)
        return submit(*arguments)

    monkeypatch.setattr(pool, "submit", spied)
    return given


def test_the_second_request_needs_no_thread(warm: TestClient, threads: list[object]) -> None:
    first = warm.post(URL, json=STATE)
    assert (first.status_code, len(threads)) == (200, 1)
    second = warm.post(URL, json=STATE)
    assert (second.status_code, second.content, second.headers["content-type"]) == (
        200,
        first.content,
        first.headers["content-type"],
    )
    other = warm.post(URL, json={**STATE, "q": {"arm.q": 0.7}, "parameters": {"arm.m": 3}, "inputs": {"tau.arm.q": 1}})
    assert (other.status_code, len(threads)) == (200, 1)
    assert other.json()["forces"] != first.json()["forces"]


def test_a_tree_that_was_removed(warm: TestClient, threads: list[object], monkeypatch: pytest.MonkeyPatch) -> None:
    """It is looked for again after a while, and is at hand again where it is there."""
    assert [warm.post(URL, json=STATE).status_code for _ in range(2)] == [200, 200]
    with monkeypatch.context() as now:
        now.setattr(at_hand, "SECONDS", 0.0)
        assert (warm.post(URL, json=STATE).status_code, len(threads)) == (200, 2)
    assert (warm.post(URL, json=STATE).status_code, len(threads)) == (200, 2)
    assert warm.delete("/v1/trees/cell").status_code == 204
    monkeypatch.setattr(at_hand, "SECONDS", 0.0)
    assert warm.post(URL, json=STATE).status_code == 404


def test_other_methods_are_refused(warm: TestClient) -> None:
    """Also where the answer to a POST is at hand."""
    warm.post(URL, json=STATE)
    assert warm.post(URL, json=STATE).status_code == 200
    for method in ("PUT", "PATCH", "DELETE"):
        answer = warm.request(method, URL, json=STATE)
        assert (answer.status_code, answer.headers["allow"]) == (405, "POST")


@pytest.mark.parametrize(
    ("url", "body", "headers"),
    [
        ("/v1/trees/cell/evaluations", {}, {}),
        (URL, {}, {"Idempotency-Key": "1"}),
        (URL, {}, {"Prefer": "wait=5"}),
        (URL, {}, {"Accept": "application/x-npz"}),
        (URL, {"q": [[0.1], [0.2]], "qd": [[0], [0]]}, {}),
        (URL, {"quantities": ["metric"]}, {}),
        (URL, {"t": [0] * at_hand.BODY}, {}),
    ],
)
def test_all_others_do(
    warm: TestClient, threads: list[object], url: str, body: dict[str, Any], headers: dict[str, str]
) -> None:
    warm.post(URL, json=STATE)
    answer = warm.post(url, json=STATE | body, headers=headers)
    assert (answer.status_code, len(threads)) == (200, 2), answer.text


@pytest.mark.parametrize(
    "fault", [{"q": [[0.1, 0.2]]}, {"qdd": ["x"]}, {"unknown": 1}, {"parameters": {"no": 1}}, {"q": "1"}]
)
def test_faults_are_the_same(warm: TestClient, threads: list[object], fault: dict[str, Any]) -> None:
    slow = warm.post(URL, json=STATE | fault)
    assert slow.status_code == 422
    warm.post(URL, json=STATE)
    quick = warm.post(URL, json=STATE | fault)
    assert (quick.status_code, quick.json()["errors"]) == (422, slow.json()["errors"])
    assert len(threads) == 2
    assert warm.post(URL, content=b"{", headers={"Content-Type": "application/json"}).status_code == 422


def test_only_keys_that_may_read_are_answered(warm: TestClient, store: Store, threads: list[object]) -> None:
    warm.post(URL, json=STATE)
    with store.database.write() as connection:
        reader, writer = (keys.create(connection, "test", [scope], None) for scope in ("read", "write"))
    before = len(threads)
    for key, status in (("", 401), ("sub_x_y", 401), (writer, 403), (reader, 200)):
        answer = warm.post(URL, json=STATE, headers={"Authorization": f"Bearer {key}"} if key else {})
        assert answer.status_code == status
    assert len(threads) == before


def test_it_is_counted_under_its_route(warm: TestClient) -> None:
    warm.post(URL, json=STATE)
    counted = 'substructures_requests_total{method="POST",route="/v1/trees/{ref}/evaluations",status="200"}'
    before = _shown(warm, counted)
    warm.post(URL, json=STATE)
    assert _shown(warm, counted) == before + 1
    assert _shown(warm, "process_cpu_seconds_total") > 0


def _shown(client: TestClient, name: str) -> float:
    lines = client.get("/metrics").text.splitlines()
    return next(float(line.rsplit(" ", 1)[1]) for line in lines if line.startswith(f"{name} "))


def test_the_regressor_is_at_hand_too(warm: TestClient, threads: list[object]) -> None:
    """With the names of its columns, which come from the parts of the tree."""
    state = {"quantities": ["regressor", "inertial_parameters"], "q": [0.1], "qd": [0.2], "qdd": [0.3]}
    warm.post("/v1/trees/cell@1/kernels", json={"quantities": state["quantities"]})
    first = warm.post(URL, json=state)
    before = len(threads)
    again = warm.post(URL, json=state)
    assert (first.status_code, again.status_code, len(threads)) == (200, 200, before)
    assert again.json()["columns"] == first.json()["columns"]
    assert again.json()["inertial_parameters"] == pytest.approx(first.json()["inertial_parameters"])


def test_long_work_is_never_at_hand(warm: TestClient, threads: list[object], monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(at_hand, "NUMBERS", 2)
    for _ in range(2):
        assert warm.post(URL, json=STATE).status_code == 200
    assert len(threads) == 2


def test_kernels_that_were_dropped_from_memory(
    warm: TestClient, store: Store, threads: list[object], monkeypatch: pytest.MonkeyPatch
) -> None:
    first = warm.post(URL, json=STATE)
    monkeypatch.setattr(store.kernels, "has", lambda *_: False)
    assert warm.post(URL, json=STATE).content == first.content
    assert len(threads) == 2
