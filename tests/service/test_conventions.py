"""Conventions of all endpoints (HTTP contract, section 6)."""

from __future__ import annotations

import gzip
import json
from collections.abc import Iterator
from pathlib import Path
from threading import Event
from typing import Any

import pytest
from fastapi.testclient import TestClient

from service.app import open_store
from service.jobs.engines import process
from service.queue.supervisor import sweep
from service.schemas.resources import Problem
from service.settings import Limits, Settings, SettingsError, from_environment
from service.store.store import Store

from .conftest import PENDULUM, TREE, make_client

JSON = {"Content-Type": "application/json"}


def problem(answer: Any, status: int, code: str) -> dict[str, Any]:
    assert answer.status_code == status, answer.text
    assert answer.headers["content-type"] == "application/problem+json"
    document = dict(answer.json())
    Problem.model_validate(document)
    assert (document["status"], document["code"]) == (status, code)
    assert document["request_id"] == answer.headers["x-request-id"]
    assert document["instance"] == answer.request.url.path
    return document


def test_problems(client: TestClient) -> None:
    assert "/openapi.json" in problem(client.get("/nothing"), 404, "not-found")["detail"]
    problem(client.get("/v1/trees/"), 404, "not-found")
    problem(client.get("/v1/trees/nothing"), 404, "unknown-tree")
    wrong = client.put("/v1/substructures", json={})
    detail = problem(wrong, 405, "method-not-allowed")["detail"]
    assert detail == "PUT is not possible at this path, but GET, HEAD, POST"
    assert set(wrong.headers["allow"].replace(" ", "").split(",")) == {"GET", "HEAD", "POST"}
    problem(
        client.post("/v1/substructures", content=b"{}", headers={"Content-Type": "text/plain"}),
        415,
        "unsupported-media-type",
    )
    coded = {**JSON, "Content-Encoding": "gzip"}
    packed = client.post("/v1/substructures", content=gzip.compress(b"{}"), headers=coded)
    assert "send the body as it is" in problem(packed, 415, "unsupported-media-type")["detail"]
    problem(client.post("/v1/substructures", content=b"{", headers=JSON), 422, "invalid-document")
    assert problem(client.get("/v1/substructures?page_size=0"), 422, "invalid-request")["detail"].endswith('found "0"')
    for body, message in (({}, "'name' is needed"), ({"name": "x", "colour": 1}, "unknown field 'colour'")):
        assert message in problem(client.post("/v1/trees", json=body), 422, "invalid-document")["detail"]


def test_heads_are_those_of_get(filled: TestClient) -> None:
    """Of streams, too, whose end nobody waits for."""
    job = filled.post("/v1/jobs", json={"kind": "verify", "items": [{"tree": "cell"}]}).json()["id"]
    for path in (
        "/livez",
        "/",
        "/v1/trees/cell",
        "/v1/trees/cell/metric",
        "/v1/trees/nothing",
        f"/v1/jobs/{job}/archive",
    ):
        head, get = filled.head(path), filled.get(path)
        assert (head.status_code, head.content) == (get.status_code, b"")
        assert {**head.headers, "x-request-id": ""} == {**get.headers, "x-request-id": ""}
    events = filled.head(f"/v1/jobs/{job}/events")
    assert (events.status_code, events.headers["content-type"]) == (200, "text/event-stream; charset=utf-8")


def test_defects_are_500_without_details(
    client: TestClient, monkeypatch: pytest.MonkeyPatch, caplog: pytest.LogCaptureFixture
) -> None:
    def broken(*_: object) -> None:
        raise RuntimeError("secret detail")

    monkeypatch.setattr("service.routes.trees.trees.find", broken)
    document = problem(client.get("/v1/trees/cell"), 500, "internal-error")
    assert "secret" not in str(document)
    assert "secret detail" in caplog.text


def test_request_ids(client: TestClient) -> None:
    assert client.get("/livez", headers={"X-Request-Id": "my-id.1"}).headers["x-request-id"] == "my-id.1"
    for harmful in ("a b", "x" * 200, "<script>"):
        given = client.get("/livez", headers={"X-Request-Id": harmful}).headers["x-request-id"]
        assert len(given) == 16
    assert client.get("/livez").headers["x-request-id"] != client.get("/livez").headers["x-request-id"]


@pytest.mark.parametrize(
    ("host", "status"),
    [
        ("localhost", 200),
        ("127.0.0.1:8000", 200),
        ("[::1]:8000", 200),
        ("LOCALHOST", 200),
        ("[0::1]", 200),
        ("evil.example", 400),
        ("localhost.evil.example", 400),
    ],
)
def test_host_is_checked(client: TestClient, host: str, status: int) -> None:
    answer = client.get("/livez", headers={"Host": host})
    assert answer.status_code == status
    if status == 400:
        assert "SUBSTRUCTURES_ALLOWED_HOSTS" in problem(answer, 400, "host-not-allowed")["detail"]


NO_HOSTS = (
    *("", "127.0.0.1:abc", "[::1]evil", "127.0.0.1:80?x=", "127.0.0.1:1@evil.com", "localhost:65536", "localhost:"),
    *(
        "[::1",
        "::1",
        "[1.2.3.4]",
        "localhost/",
        "localhost#",
        "local host",
        "localhost:80, localhost",
        "l\u00f6calhost",
    ),
)


@pytest.mark.parametrize("host", NO_HOSTS)
def test_what_is_no_host_is_refused(client: TestClient, host: str) -> None:
    """Whatever is done with a request; nothing of it becomes part of an address."""
    for send in (client.get, client.post):
        answer = send("/v1/trees", headers={"Host": host.encode("latin-1")})
        assert "no host" in problem(answer, 400, "invalid-host")["detail"]


def test_a_request_names_one_host(client: TestClient) -> None:
    answer = client.get("/livez", headers=[("Host", "localhost"), ("Host", "localhost")])
    assert "one Host header, not 2" in problem(answer, 400, "invalid-host")["detail"]


def test_health(client: TestClient, store: Store, monkeypatch: pytest.MonkeyPatch) -> None:
    assert client.get("/livez").json() == client.get("/readyz").json() == {"status": "ok"}

    def fail() -> None:
        raise RuntimeError

    monkeypatch.setattr(store.database, "ping", fail)
    assert client.get("/livez").status_code == 200
    assert client.get("/readyz").status_code == 500


def test_metrics(filled: TestClient) -> None:
    filled.get("/v1/trees/cell@1")
    text = filled.get("/metrics").text
    assert 'substructures_requests_total{method="GET",route="/v1/trees/{ref}",status="200"} 1.0' in text
    assert "substructures_request_seconds_bucket" in text


def test_limits_are_shown(client: TestClient) -> None:
    shown = client.get("/v1/limits").json()
    assert shown.items() >= Limits().model_dump().items()
    assert (shown["json_bytes"], shown["binary_bytes"]) == (2 * 2**20, 64 * 2**20)
    assert (shown["number_digits"], shown["exponent"], shown["nesting"], shown["program_nodes"]) == (
        400,
        64,
        64,
        100_000,
    )


def test_versions_revalidate_and_definitions_are_immutable(filled: TestClient) -> None:
    version = filled.get("/v1/substructures/pendulum@1")
    assert version.headers["cache-control"] == "no-cache"
    known = {"If-None-Match": version.headers["etag"]}
    assert filled.get("/v1/substructures/pendulum@1", headers=known).status_code == 304
    filled.put("/v1/substructures/pendulum/aliases/best", json={"version": 1})
    assert filled.get("/v1/substructures/pendulum@1", headers=known).status_code == 200
    for path in (
        "substructures/pendulum@1/definition",
        "substructures/pendulum@1/formulas",
        "substructures/pendulum@1/formulas/metric",
        "trees/cell@1/metric",
    ):
        first = filled.get(f"/v1/{path}")
        assert "immutable" in first.headers["cache-control"], path
        again = filled.get(f"/v1/{path}", headers={"If-None-Match": first.headers["etag"]})
        assert (again.status_code, again.headers["etag"]) == (304, first.headers["etag"])
    for reference in ("cell", "cell@1"):  # parts of the tree may be withdrawn
        assert filled.get(f"/v1/trees/{reference}").headers["cache-control"] == "no-cache"


def test_lists_may_stand_on_several_lines(filled: TestClient) -> None:
    """RFC 9110, section 5.3: lines of one name are one list."""
    latex = filled.get("/v1/trees/cell/metric", headers=[("Accept", "image/png"), ("Accept", "application/x-latex")])
    assert (latex.status_code, latex.headers["content-type"].partition(";")[0]) == (200, "application/x-latex")
    path = "/v1/substructures/pendulum@1/formulas"
    tag = filled.get(path).headers["etag"]
    assert filled.get(path, headers=[("If-None-Match", '"other"'), ("If-None-Match", tag)]).status_code == 304
    seen = [("If-Match", '"other"'), ("If-Match", filled.get("/v1/trees/cell").headers["etag"])]
    assert filled.request("DELETE", "/v1/trees/cell/couplings/hand", headers=seen).status_code == 404


@pytest.fixture
def small(tmp_path: Path) -> Iterator[TestClient]:
    """A server with tiny limits."""
    limits = Limits(
        json_bytes=4000, binary_bytes=2000, program_nodes=300, states=5, page_size=3, evaluation_operations=10**6
    )
    settings = Settings(database=f"sqlite:///{tmp_path / 'small.db'}", catalogue=False, limits=limits)
    with open_store(settings) as store:
        client = make_client(store)
        client.post("/v1/substructures", json=PENDULUM)
        client.post("/v1/trees", json=TREE)
        yield client


def test_bodies_that_are_too_long(small: TestClient) -> None:
    long = b'{"name": "' + b"x" * 5000 + b'"}'
    document = problem(small.post("/v1/substructures", content=long, headers=JSON), 413, "body-too-large")
    assert document["limit"] == 4000
    chunks = (long[i : i + 100] for i in range(0, len(long), 100))
    problem(small.post("/v1/substructures", content=chunks, headers=JSON), 413, "body-too-large")


def test_programs_that_are_too_large(small: TestClient) -> None:
    links = [{**PENDULUM["bodies"][0], "name": f"b{k}", "parent": f"b{k - 1}" if k else "base"} for k in range(6)]
    for k, link in enumerate(links):
        link["joint"] = {"type": "revolute", "coordinate": f"q{k}", "d": "l", "theta": 1}
    definition = {**PENDULUM, "name": "chain", "bodies": links, "ports": []}
    document = problem(small.post("/v1/substructures", content=json.dumps(definition), headers=JSON), 422, "too-large")
    assert document["limit"] == 300
    assert document["size"] > 300


def test_evaluations_that_are_too_large(small: TestClient) -> None:
    def post(states: int, quantity: str) -> Any:
        return small.post("/v1/trees/cell/evaluations", json={"quantities": [quantity], "q": [[0]] * states})

    assert post(5, "metric").status_code == 200
    assert post(6, "metric").status_code == 422
    problem(post(5, "kinematics"), 422, "too-large")


def test_pages_that_are_too_long(small: TestClient) -> None:
    assert small.get("/v1/trees?page_size=3").status_code == 200
    assert small.get("/v1/trees?page_size=4").json()["errors"][0]["pointer"] == "/query/page_size"


def test_slow_work_that_cannot_be_queued(
    filled: TestClient, store: Store, monkeypatch: pytest.MonkeyPatch, rows: Any
) -> None:
    before = rows()
    limits = store.settings.limits.model_copy(update={"sync_seconds": 1e-6})
    monkeypatch.setattr(store, "settings", store.settings.model_copy(update={"limits": limits}))
    answer = filled.post("/v1/trees/cell/kernels", json={"quantities": ["metric"]})
    problem(answer, 503, "took-too-long")
    assert rows() == before


def test_settings_from_the_environment() -> None:
    settings = from_environment(
        {
            "SUBSTRUCTURES_PORT": "9",
            "SUBSTRUCTURES_LIMIT_STATES": "7",
            "SUBSTRUCTURES_ALLOWED_HOSTS": "a, b",
            "SUBSTRUCTURES_KEY": "of the client",
            "HOME": "/",
        },
        host="::1",
        database=None,
    )
    assert (settings.port, settings.host, settings.limits.states, settings.allowed_hosts) == (9, "::1", 7, ("a", "b"))
    for name, value in (
        ("SUBSTRUCTURES_PROT", "9"),
        ("SUBSTRUCTURES_PORT", "x"),
        ("SUBSTRUCTURES_LIMIT_STATES", "0"),
        ("SUBSTRUCTURES_LIMIT_STATE", "1"),
        ("SUBSTRUCTURES_KEYS", "1"),
        ("SUBSTRUCTURES_KEY_SECONDS", "inf"),
        ("SUBSTRUCTURES_WORKERS", "1000000"),
        ("SUBSTRUCTURES_LIMIT_JOB_DAYS", "1e9"),
        ("SUBSTRUCTURES_LIMIT_JOB_CPU_SECONDS", "1e300"),
        ("SUBSTRUCTURES_LIMIT_JOB_MEMORY_BYTES", "1" + "0" * 20),
    ):
        with pytest.raises(SettingsError, match=name):
            from_environment({name: value})


@pytest.mark.parametrize("name", Limits.model_fields)
@pytest.mark.parametrize("value", ["inf", "nan", "1" + "0" * 20])
def test_limits_have_bounds(name: str, value: str) -> None:
    with pytest.raises(SettingsError, match=f"SUBSTRUCTURES_LIMIT_{name.upper()}"):
        from_environment({f"SUBSTRUCTURES_LIMIT_{name.upper()}": value})


def test_the_setting_of_the_compiler() -> None:
    """It is no setting of the server, but a wrong one is told at the start."""
    known = {"SUBSTRUCTURES_CPU": "x86-64", "SUBSTRUCTURES_CONTRACTION": "off"}
    assert from_environment(known) == Settings()
    for name in known:
        with pytest.raises(SettingsError, match=f"{name}: 'znver5' is none of"):
            from_environment({name: "znver5"})


def test_runners_have_the_setting_of_the_compiler(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("SUBSTRUCTURES_CPU", "none")
    monkeypatch.setenv("SUBSTRUCTURES_DATABASE", "sqlite:///other.db")
    assert process.environment()["SUBSTRUCTURES_CPU"] == "none"
    assert "SUBSTRUCTURES_DATABASE" not in process.environment()


def test_no_limit_breaks_a_server(tmp_path: Path) -> None:
    largest = {
        name: bound.le
        for name, field in Limits.model_fields.items()
        for bound in field.metadata
        if hasattr(bound, "le")
    }
    assert largest.keys() == Limits.model_fields.keys()
    settings = Settings(database=f"sqlite:///{tmp_path / 'x.db'}", catalogue=False, limits=Limits(**largest))
    with open_store(settings) as store:
        sweep(store, Event())
        client = make_client(store)
        assert client.get("/v1/limits").json().items() >= largest.items()
        answer = client.post("/v1/substructures", json=PENDULUM, headers={"Idempotency-Key": "a"})
        assert answer.status_code == 201


@pytest.mark.parametrize(
    ("prefer", "status", "applied"),
    [
        ("respond-async", 202, "respond-async"),
        ("wait=5", 200, "wait=5"),
        ("wait=5, respond-async", 202, "respond-async, wait=5"),
        ("wait=0", 202, "wait=0"),
        ("wait=100000", 200, None),
        ("handling=strict", 200, None),
        ("", 200, None),
    ],
)
def test_preferences_that_were_followed_are_told(
    filled: TestClient, prefer: str, status: int, applied: str | None
) -> None:
    body = {"quantities": ["metric"], "q": [0]}
    answer = filled.post("/v1/trees/cell/evaluations", json=body, headers={"Prefer": prefer})
    assert (answer.status_code, answer.headers.get("preference-applied")) == (status, applied)


@pytest.mark.parametrize(
    ("path", "allowed"),
    [
        ("cell/evaluations", "POST"),
        ("cell/metric", "GET, HEAD"),
        ("cell/couplings/arm", "DELETE, PATCH"),
        ("cell", "DELETE, GET, HEAD, PATCH"),
    ],
)
def test_methods_that_a_path_has(filled: TestClient, path: str, allowed: str) -> None:
    answer = filled.request("PUT", f"/v1/trees/{path}")
    assert (answer.status_code, answer.headers["allow"]) == (405, allowed)


def test_what_a_browser_has_keeps_its_policy(filled: TestClient) -> None:
    """Headers of a 304 take the place of those that are kept (RFC 9111, section 3.2): a page would lose its style."""
    for path in ("/jobs", "/docs", "/v1/trees/cell/report?format=mathml", "/v1/trees/cell"):
        first = filled.get(path)
        again = filled.get(path, headers={"If-None-Match": first.headers["etag"]})
        assert (first.status_code, again.status_code) == (200, 304)
        policy = again.headers.get("content-security-policy", first.headers["content-security-policy"])
        assert policy == first.headers["content-security-policy"], path


def test_everything_served_is_guarded(filled: TestClient) -> None:
    """Nothing is taken for another type than it has, and nothing but pages may load anything."""
    paths = [
        "/livez",
        "/v1/trees/cell",
        "/v1/trees/cell/metric?format=latex",
        "/nowhere",
        "/openapi.json",
        "/",
        "/metrics",
    ]
    for path in [*paths, "/v1/trees/cell/picture", "/style.css", "/v1/limits"]:
        answer = filled.get(path)
        assert answer.headers["x-content-type-options"] == "nosniff", path
        assert "default-src 'none'" in answer.headers["content-security-policy"], path
