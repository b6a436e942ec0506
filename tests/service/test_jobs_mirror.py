"""Mirrors: all public parts of another server, over HTTP, and what is missing where one was interrupted."""

from __future__ import annotations

import json
import socket
from collections.abc import Iterator
from http.server import BaseHTTPRequestHandler, ThreadingHTTPServer
from pathlib import Path
from threading import Thread
from threading import enumerate as enumerate_threads
from typing import Any, ClassVar
from urllib.parse import urlsplit

import pytest
from fastapi.testclient import TestClient

from service.app import open_store
from service.operations.sharing import mirrors
from service.queue import mirroring
from service.server import background
from service.settings import Settings, SettingsError, from_environment
from service.sources import read_source, source_of
from service.store import keys
from service.store.store import Store
from substructures.client import Client, ProblemError
from substructures.documents import write_json

from .bundle_files import consistent, packed, unpacked
from .conftest import PENDULUM, SLIDER, make_client
from .damaged_bundles import bump
from .fake_engine import FakeEngine, eventually, finished, items, running, submitted

NAMES = [f"part-{k:02}" for k in range(7)]
SECRET = "sub_0123_secret-of-the-source"


@pytest.fixture(scope="module")
def source(tmp_path_factory: pytest.TempPathFactory) -> Iterator[str]:
    """The address of a server with some parts, one of them private, and of one an older version."""
    path = tmp_path_factory.mktemp("source") / "store.db"
    with background(Settings(database=f"sqlite:///{path}", catalogue=False, engine="none")) as address:
        with Client(address) as client:
            client.submit({**SLIDER, "name": NAMES[0], "title": "older"})
            for name in NAMES:
                client.submit({**SLIDER, "name": name})
            client.submit({**PENDULUM, "name": "hush", "visibility": "private"})
        yield address


@pytest.fixture
def settings(tmp_path: Path, source: str) -> Settings:
    """Of the server that mirrors; the key of the source is not one, and the source asks for none."""
    listed = (source.replace("://", f"://{SECRET}@"), "https://parts.example.org")
    return Settings(
        database=f"sqlite:///{tmp_path / 'store.db'}", catalogue=False, key_seconds=0, mirror_sources=listed
    )


def mirror(source: str) -> dict[str, Any]:
    return {"kind": "mirror", "items": [{"source": source}]}


def names(client: TestClient, **headers: str) -> list[str]:
    found = client.get("/v1/substructures?page_size=1000", headers=headers).json()["items"]
    return [item["name"] for item in found]


def test_all_public_parts(source: str, client: TestClient, store: Store) -> None:
    with running(store, FakeEngine()):
        job = submitted(client, mirror(source))
        assert finished(client, job)["state"] == "succeeded"
        (item,) = items(client, job)
        result = item["result"]
        assert (result["source"], result["offered"]) == (source, len(NAMES))
        numbered = [f"{NAMES[0]}@2", *(f"{name}@1" for name in NAMES[1:])]  # as there
        assert result["stored"] == {"count": len(NAMES), "items": numbered}
        assert [result[name]["count"] for name in ("same", "differing", "refused")] == [0, 0, 0]
        assert names(client) == NAMES
        version = client.get(f"/v1/substructures/{NAMES[0]}").json()
        assert (version["title"], version["origin"]) == (SLIDER["title"], "import")
        again = submitted(client, mirror(source))
        assert finished(client, again)["state"] == "succeeded"
        (item,) = items(client, again)
        assert [item["result"][name]["count"] for name in ("stored", "same", "refused")] == [0, len(NAMES), 0]
        for path in ("", "/result", "/archive", "/events"):
            assert SECRET not in client.get(f"/v1/jobs/{job}{path}").text


def test_numbers_that_mean_another_content_are_refused(source: str, client: TestClient, store: Store) -> None:
    """And stop none of the others."""
    own = client.post("/v1/substructures", json={**SLIDER, "name": NAMES[1], "title": "own"}).json()
    with running(store, FakeEngine()):
        job = submitted(client, mirror(source))
        assert finished(client, job)["state"] == "succeeded"
        result = items(client, job)[0]["result"]
    assert [result[name]["count"] for name in ("stored", "refused")] == [len(NAMES) - 1, 1]
    (refused,) = result["refused"]["items"]
    assert (refused["name"], refused["code"]) == (NAMES[1], "version-taken")
    assert own["digest"] in refused["message"]
    assert refused["digest"] in refused["message"]
    assert client.get(f"/v1/substructures/{NAMES[1]}").json()["title"] == "own"


@pytest.mark.parametrize("moment", ["/v1/substructures", "/v1/bundles"])
def test_it_goes_on_after_a_failure(
    moment: str, source: str, client: TestClient, store: Store, monkeypatch: pytest.MonkeyPatch
) -> None:
    """The source stops to answer in the middle; what was stored stays, and is not fetched again."""
    monkeypatch.setattr(mirrors, "AT_ONCE", 3)
    monkeypatch.setattr(mirrors, "PAUSES", (0.0,))
    original = Client.request
    asked: list[str] = []
    left = {"/v1/substructures": 1, "/v1/bundles": 1}
    left[moment] -= 1

    def failing(self: Client, method: str, path: str, *rest: Any, **options: Any) -> Any:
        if left[path] <= 0:
            raise ProblemError(503, {"detail": "no answer today"})
        left[path] -= 1
        asked.append(options["params"].get("refs", ""))
        return original(self, method, path, *rest, **options)

    monkeypatch.setattr(Client, "request", failing)
    if moment == "/v1/bundles":
        left[moment] += 1  # one of three
    with running(store, FakeEngine()):
        job = submitted(client, mirror(source))
        assert finished(client, job)["state"] == "failed"
        (item,) = items(client, job)
        problem, stored = item["problem"], 0 if moment == "/v1/substructures" else 3
        assert (problem["code"], problem["stored"], item["subject"]) == ("source-failed", stored, source)
        assert "no answer today" in problem["detail"]
        assert names(client) == NAMES[:stored]
        left |= dict.fromkeys(left, 100)
        asked.clear()
        again = client.post(f"/v1/jobs/{job}/retry", json={}).json()["id"]
        assert finished(client, again)["state"] == "succeeded"
        (item,) = items(client, again)
        assert [item["result"][name]["count"] for name in ("stored", "same")] == [len(NAMES) - stored, stored]
    assert names(client) == NAMES
    assert not any(name in refs for refs in asked for name in NAMES[:stored])


def test_it_goes_on_after_the_server_died(
    source: str, client: TestClient, store: Store, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Whoever had the item is gone in the middle: the next server takes it over, and stores what is missing."""
    original = mirrors.Mirror._store_part
    stored: list[str] = []

    def dying(self: mirrors.Mirror, part: Any) -> None:
        if len(stored) == 3:
            raise mirroring.Stopped  # as good as killed: nothing more is heard of it
        original(self, part)
        stored.append(part.name)

    monkeypatch.setattr(mirrors.Mirror, "_store_part", dying)
    with running(store, FakeEngine()):
        job = submitted(client, mirror(source))
        eventually(client, job, lambda _: len(stored) == 3)
        assert client.get(f"/v1/jobs/{job}").json()["state"] == "running"
    monkeypatch.setattr(mirrors.Mirror, "_store_part", original)
    with running(store, FakeEngine()):
        assert finished(client, job)["state"] == "succeeded"
    (item,) = items(client, job)
    assert [item["result"][name]["count"] for name in ("stored", "same")] == [len(NAMES) - 3, 3]
    assert names(client) == NAMES


def test_it_can_be_cancelled(source: str, client: TestClient, store: Store, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(mirrors, "PAUSES", (0.05,) * 1000)

    def silent(*_: Any, **__: Any) -> Any:
        raise ProblemError(503, {"detail": "later"})

    monkeypatch.setattr(Client, "request", silent)
    with running(store, FakeEngine(slots=1)):
        job = submitted(client, mirror(source))
        eventually(client, job, lambda view: view["state"] == "running")
        client.post(f"/v1/jobs/{job}/cancel", json={})
        assert finished(client, job)["state"] == "cancelled"
        for thread in enumerate_threads():
            if thread.name.startswith("mirror"):
                thread.join(5)
                assert not thread.is_alive()
        other = submitted(client, {"kind": "derive", "items": [PENDULUM]})  # its place is free again
        assert finished(client, other)["state"] == "succeeded"


def key(store: Store, owner: str, *scopes: str) -> dict[str, str]:
    with store.database.write() as connection:
        return {"Authorization": f"Bearer {keys.create(connection, '', scopes, None, owner)}"}


def test_names_of_others_are_told_and_passed_over(
    source: str, client: TestClient, store: Store, monkeypatch: pytest.MonkeyPatch
) -> None:
    """They are not even fetched. What is stored belongs to the owner of the job."""
    original, asked = Client.request, []

    def noted(self: Client, method: str, path: str, *rest: Any, **options: Any) -> Any:
        asked.append(options["params"].get("refs", ""))
        return original(self, method, path, *rest, **options)

    monkeypatch.setattr(Client, "request", noted)
    acme, bolt = (key(store, owner, "read", "write", "jobs") for owner in ("acme", "bolt"))
    for name, visibility in ((NAMES[1], "public"), (NAMES[2], "private")):
        body = {**PENDULUM, "name": name, "visibility": visibility}
        assert client.post("/v1/substructures", json=body, headers=acme).status_code == 201
    with running(store, FakeEngine()):
        job = submitted(client, mirror(source), **bolt)
        client.headers.update(bolt)
        assert finished(client, job)["state"] == "succeeded"
        (item,) = items(client, job)
    assert not any(name in refs for refs in asked for name in NAMES[1:3])
    refused = item["result"]["refused"]
    assert [(each["name"], each["code"]) for each in refused["items"]] == [
        (NAMES[1], "name-taken"),
        (NAMES[2], "name-taken"),
    ]
    assert ["acme" in each["message"] for each in refused["items"]] == [True, False]
    assert item["result"]["stored"]["count"] == refused["count"] + 3 == 5
    owners = {each["name"]: each["owner"] for each in client.get("/v1/substructures").json()["items"]}
    assert owners == {NAMES[1]: "acme", **{name: "bolt" for name in NAMES if name not in NAMES[1:3]}}


def test_who_may(source: str, client: TestClient, store: Store) -> None:
    answer = client.post("/v1/jobs", json=mirror(source), headers=key(store, "acme", "read", "jobs"))
    assert (answer.status_code, answer.json()["code"], answer.json()["scope"]) == (403, "scope-missing", "write")


@pytest.mark.parametrize(
    ("given", "code"),
    [
        ("https://elsewhere.example.org", "source-not-allowed"),
        ("http://parts.example.org", "source-not-allowed"),
        ("https://parts.example.org:8443", "source-not-allowed"),
        ("http://169.254.169.254", "source-not-allowed"),
        ("https://parts.example.org.evil.org", "source-not-allowed"),
        ("https://parts.example.org@evil.org", "bad-source"),
        ("https://sub_mine@parts.example.org", "bad-source"),
        ("https://parts.example.org/v1", "bad-source"),
        ("https://parts.example.org?x=1", "bad-source"),
        ("file:///etc/passwd", "bad-source"),
        ("parts.example.org", "bad-source"),
        ("https://parts.example.org:99999", "bad-source"),
        ("", "bad-source"),
        (7, "string-type"),
    ],
)
def test_no_other_source_is_asked(given: Any, code: str, client: TestClient, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(Client, "request", lambda *_, **__: pytest.fail("it was asked"))
    answer = client.post("/v1/jobs", json=mirror(given))
    error = answer.json()["errors"][0]
    assert (answer.status_code, error["code"], error["pointer"]) == (422, code, "/items/0/source")
    assert "sub_mine" not in answer.text
    if code == "source-not-allowed":
        assert "SUBSTRUCTURES_MIRROR_SOURCES" in error["message"]


def test_addresses_mean_the_same(client: TestClient) -> None:
    for given in ("https://PARTS.example.org/", "https://parts.example.org"):
        assert client.post("/v1/jobs", json=mirror(given)).status_code == 202


def test_a_source_that_is_listed_no_more(source: str, client: TestClient, store: Store) -> None:
    job = submitted(client, mirror(source))
    store.settings = store.settings.model_copy(update={"mirror_sources": ()})
    with running(store, FakeEngine()):
        assert finished(client, job)["state"] == "failed"
    (item,) = items(client, job)
    assert item["problem"]["code"] == "source-not-allowed"


def test_settings() -> None:
    found = from_environment({"SUBSTRUCTURES_MIRROR_SOURCES": f"https://{SECRET}@a.org, http://b.org:80/"})
    sources = [read_source(text) for text in found.mirror_sources]
    assert [(each.address, each.key) for each in sources] == [("https://a.org", SECRET), ("http://b.org:80", None)]
    assert SECRET not in repr(found) + repr(sources)
    assert source_of("https://c.org", found.mirror_sources) is None
    for wrong in (f"ftp://{SECRET}@a.org", f"https://{SECRET}@a.org/x", f"https://u:{SECRET}@a.org", f"{SECRET}@a.org"):
        with pytest.raises(SettingsError, match="SUBSTRUCTURES_MIRROR_SOURCES, number 1") as caught:
            from_environment({"SUBSTRUCTURES_MIRROR_SOURCES": wrong})
        assert SECRET not in str(caught.value)


class Liar(BaseHTTPRequestHandler):
    """A server that answers whatever it was told to, and notes what it is asked for."""

    answers: ClassVar[dict[str, tuple[int, Any]]] = {}
    asked: ClassVar[list[tuple[str, str | None]]] = []

    def do_GET(self) -> None:
        self.asked.append((self.path, self.headers["Authorization"]))
        status, body = self.answers[urlsplit(self.path).path]
        data = body if isinstance(body, bytes) else json.dumps(body).encode()
        self.send_response(status)
        if status == 302:
            self.send_header("Location", "/stolen")
        if status >= 400:
            self.send_header("Content-Type", "application/problem+json")
        self.send_header("Content-Length", str(len(data)))
        self.end_headers()
        self.wfile.write(data)

    def log_message(self, *_: Any) -> None:
        """Nothing."""


@pytest.fixture
def liar(monkeypatch: pytest.MonkeyPatch) -> Iterator[str]:
    monkeypatch.setattr(Liar, "asked", [])
    monkeypatch.setattr(mirrors, "PAUSES", ())
    with ThreadingHTTPServer(("127.0.0.1", 0), Liar) as server:
        Thread(target=server.serve_forever, daemon=True).start()
        yield f"http://127.0.0.1:{server.server_port}"
        server.shutdown()


OFFER = {"name": "x", "digest": "sha256:" + "0" * 64, "visibility": "public"}
LIES: dict[str, tuple[Any, str]] = {
    "no JSON": ((200, b"<html>"), "no JSON object"),
    "a list": ((200, []), "no JSON object"),
    "no items": ((200, {"items": 3}), "list of parts"),
    "an item that is none": ((200, {"items": [3]}), "without a name"),
    "a name that is none": ((200, {"items": [{**OFFER, "name": "x,y"}]}), "without a name"),
    "a list without an end": ((200, {"items": [], "next_page_token": "x"}), "no end"),
    "a token that is none": ((200, {"items": [OFFER], "next_page_token": ["x"]}), "no end"),
    "a redirect": ((302, b""), "answered with 302"),
    "a problem that is none": ((500, []), "cannot be read"),
    "an error": ((500, {"detail": "broken", "errors": []}), "broken"),
}


@pytest.mark.parametrize("lie", LIES)
def test_a_source_that_lies(lie: str, liar: str, client: TestClient, store: Store) -> None:
    Liar.answers = {"/v1/substructures": LIES[lie][0]}
    store.settings = store.settings.model_copy(update={"mirror_sources": (liar.replace("//", f"//{SECRET}@"),)})
    with running(store, FakeEngine()):
        job = submitted(client, mirror(liar))
        assert finished(client, job)["state"] == "failed"
    (item,) = items(client, job)
    assert (item["problem"]["status"], item["problem"]["code"]) == (502, "source-failed")
    assert LIES[lie][1] in item["problem"]["detail"]
    assert {authorization for _, authorization in Liar.asked} == {f"Bearer {SECRET}"}
    assert "/stolen" not in [path for path, _ in Liar.asked]


def said(client: TestClient, store: Store, listed: str, address: str) -> str:
    """Why a mirror of a source fails."""
    store.settings = store.settings.model_copy(update={"mirror_sources": (listed,)})
    with running(store, FakeEngine()):
        job = submitted(client, mirror(address))
        assert finished(client, job)["state"] == "failed"
    problem = items(client, job)[0]["problem"]
    assert (problem["status"], problem["code"]) == (502, "source-failed")
    return str(problem["detail"])


@pytest.mark.parametrize("path", ["/v1/substructures", "/v1/bundles"])
@pytest.mark.parametrize(
    ("status", "code", "is_sent", "words"),
    [
        (401, "key-missing", False, "it asks for an API key, which the operator of this instance gives "),
        (401, "key-revoked", True, "it does not take the API key that it is sent (key-revoked); "),
        (403, "scope-missing", True, "it does not take the API key that it is sent (scope-missing); "),
    ],
)
def test_a_source_that_wants_another_key(
    path: str, status: int, code: str, is_sent: bool, words: str, liar: str, client: TestClient, store: Store
) -> None:
    """Who gives it is said, and not how a header is written; also where it is revoked in the middle."""
    page = {"items": [OFFER], "next_page_token": None}
    Liar.answers = {"/v1/substructures": (200, page)} | {path: (status, {"detail": "no header", "code": code})}
    told = said(client, store, liar.replace("//", f"//{SECRET}@") if is_sent else liar, liar)
    given = f"in SUBSTRUCTURES_MIRROR_SOURCES, as {liar.replace('//', '//KEY@')}; try the job again for the rest"
    assert told.startswith(f"{liar}: {words}")
    assert told.endswith(given)


def test_a_source_that_is_none(liar: str, client: TestClient, store: Store) -> None:
    Liar.answers = {"/v1/substructures": (404, {})}
    assert "404: no details; is this the address of such a service?" in said(client, store, liar, liar)


def test_a_source_that_is_away(client: TestClient, store: Store, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(mirrors, "PAUSES", ())
    with socket.socket() as taken:  # nobody listens there
        taken.bind(("127.0.0.1", 0))
        address = f"http://127.0.0.1:{taken.getsockname()[1]}"
        told = said(client, store, address, address)
    assert told.startswith(f"{address}: nothing answers at {address} (")
    assert "ConnectError" not in told
    assert "serve" not in told


def test_links_of_a_source_are_not_followed(liar: str, client: TestClient, store: Store) -> None:
    """Of a page the token counts; and bundles that are none are told part by part."""
    hidden = {**OFFER, "name": "hidden", "visibility": "private"}
    page = {"items": [OFFER, hidden], "next_page_token": None, "links": {"next": "http://169.254.169.254/latest"}}
    Liar.answers = {"/v1/substructures": (200, page), "/v1/bundles": (200, b"no zip")}
    store.settings = store.settings.model_copy(update={"mirror_sources": (liar,)})
    with running(store, FakeEngine()):
        job = submitted(client, mirror(liar))
        assert finished(client, job)["state"] == "succeeded"
    (item,) = items(client, job)
    refused = item["result"]["refused"]["items"]
    assert [(each["name"], each["code"]) for each in refused] == [("x", "invalid-bundle")]
    assert [urlsplit(path).path for path, _ in Liar.asked] == ["/v1/substructures", "/v1/bundles"]


def test_other_parts_than_were_asked_for(liar: str, source: str, client: TestClient, store: Store) -> None:
    """A bundle that is right, of something else."""
    with Client(source) as known:
        data = known.request("GET", "/v1/bundles", params={"refs": NAMES[0]}).content
    page = {"items": [OFFER, {**OFFER, "name": "y"}], "next_page_token": None}
    Liar.answers = {"/v1/substructures": (200, page), "/v1/bundles": (200, data)}
    store.settings = store.settings.model_copy(update={"mirror_sources": (liar,)})
    with running(store, FakeEngine()):
        job = submitted(client, mirror(liar))
        assert finished(client, job)["state"] == "succeeded"
    assert items(client, job)[0]["result"]["refused"]["count"] == 2
    assert names(client) == []


def test_formulas_of_a_source_are_not_stored(source: str, liar: str, client: TestClient, store: Store) -> None:
    """The public part of a source, with other formulas than those of its definition: told, and derived here."""
    with Client(source) as known:
        data = known.request("GET", "/v1/bundles", params={"refs": NAMES[0]}).content
        version = known.request("GET", f"/v1/substructures/{NAMES[0]}").json()
    files = unpacked(data)
    path = next(name for name in files if name.endswith("/program"))
    program = json.loads(files[path])
    bump(program)
    page = {"items": [{**OFFER, "name": NAMES[0], "digest": version["digest"]}], "next_page_token": None}
    forged = packed(consistent(files, path, write_json(program)))
    Liar.answers = {"/v1/substructures": (200, page), "/v1/bundles": (200, forged)}
    store.settings = store.settings.model_copy(update={"mirror_sources": (liar,)})
    with running(store, FakeEngine()):
        job = submitted(client, mirror(liar))
        assert finished(client, job)["state"] == "succeeded"
    result = items(client, job)[0]["result"]
    assert [result[name]["count"] for name in ("stored", "refused")] == [1, 0]
    assert result["differing"] == {"count": 1, "items": [f"{NAMES[0]}@2"]}
    assert client.get(f"/v1/substructures/{NAMES[0]}").json()["program"] == version["program"]


def test_one_part_that_is_refused_does_not_stop_the_others(
    source: str, client: TestClient, store: Store, monkeypatch: pytest.MonkeyPatch
) -> None:
    """A bundle that the source refuses is asked for part by part."""
    original = Client.request

    def choosy(self: Client, method: str, path: str, *rest: Any, **options: Any) -> Any:
        if NAMES[3] in options["params"].get("refs", ""):
            raise ProblemError(500, {"detail": "damaged there", "code": "damaged-content"})
        return original(self, method, path, *rest, **options)

    monkeypatch.setattr(Client, "request", choosy)
    with running(store, FakeEngine()):
        job = submitted(client, mirror(source))
        assert finished(client, job)["state"] == "succeeded"
    result = items(client, job)[0]["result"]
    assert [(each["name"], each["code"]) for each in result["refused"]["items"]] == [(NAMES[3], "damaged-content")]
    assert names(client) == [name for name in NAMES if name != NAMES[3]]


def test_between_servers(source: str, tmp_path: Path) -> None:
    """With the engine of a server, whose workers have no store."""
    settings = Settings(
        database=f"sqlite:///{tmp_path / 'there.db'}", catalogue=False, workers=1, mirror_sources=(source,)
    )
    with background(settings) as address, Client(address) as client:
        job = client.submit_job(mirror(source))
        assert client.wait(job["id"])["state"] == "succeeded"
        assert client.submit({**SLIDER, "name": NAMES[6]})[1] is False
    with open_store(settings) as store, make_client(store) as again:
        assert names(again) == NAMES
