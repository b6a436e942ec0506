"""Bundles: what one store gives another derives anew and stores; what is wrong is refused whole, with its place."""

from __future__ import annotations

import io
import json
import zipfile
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from pathlib import Path
from time import sleep
from typing import Any

import pytest
from fastapi.testclient import TestClient

from service.app import open_store
from service.content.bundles import LIST, MOST_PARTS, BundledPart, write_bundle
from service.messages.refusals import Refused
from service.settings import Limits, Settings
from service.store import keys
from service.store.store import Store

from .bundle_files import (
    BUNDLES,
    Files,
    fetched,
    listed,
    packed,
    path_of,
    sent,
    unpacked,
)
from .conftest import PENDULUM, SLIDER, copied, make_client
from .damaged_bundles import (
    FOREIGN,
    WRONG,
    heavier,
    with_certificate,
    with_definition,
)

Rows = Callable[[], dict[str, int]]


@contextmanager
def opened(folder: Path, **settings: Any) -> Iterator[TestClient]:
    """Another server with an empty store."""
    folder.mkdir()
    found = Settings(database=f"sqlite:///{folder / 'store.db'}", catalogue=False, key_seconds=0, **settings)
    with open_store(found) as store, make_client(store) as client:
        yield client


@pytest.fixture(scope="module")
def source(template: Path, tmp_path_factory: pytest.TempPathFactory) -> Iterator[TestClient]:
    """A server that knows pendulum and slider."""
    path = tmp_path_factory.mktemp("source") / "store.db"
    copied(template, path)
    with open_store(Settings(database=f"sqlite:///{path}", catalogue=False)) as store, make_client(store) as client:
        yield client


@pytest.fixture(scope="module")
def files(source: TestClient) -> Files:
    """The files of a bundle of both."""
    return unpacked(fetched(source, "pendulum,slider"))


def test_there_and_back(source: TestClient, client: TestClient) -> None:
    """The other store has the same definitions, programs and formulas, and gives what it got."""
    data = fetched(source, "slider@1,pendulum,slider")
    answer = sent(client, data)
    assert answer.status_code == 201, answer.text
    items = answer.json()["items"]
    assert [(item["name"], item["version"], item["outcome"]) for item in items] == [
        ("slider", 1, "stored"),
        ("pendulum", 1, "stored"),
    ]
    for item in items:
        there, here = (each.get(f"/v1/substructures/{item['name']}").json() for each in (source, client))
        told = ("digest", "program", "operations", "parameters", "coordinates", "warnings", "title", "tags")
        assert [there[name] for name in told] == [here[name] for name in told]
        assert here["certificate"]["direct_form"] == there["certificate"]["direct_form"]
        assert (here["origin"], item["links"]["self"]) == ("import", f"/v1/substructures/{item['name']}@1")
        index = [each.get(f"/v1/substructures/{item['name']}/formulas").json() for each in (source, client)]
        assert index[0] == index[1]
    definitions = [path for path in unpacked(data) if path != LIST and not path.endswith("certificate.json")]
    again = unpacked(fetched(client, "slider,pendulum"))
    assert {path: again[path] for path in definitions} == {path: unpacked(data)[path] for path in definitions}
    tree = {"name": "both", "instances": [{"name": "a", "substructure": "slider"}]}
    assert client.post("/v1/trees", json=tree).status_code == 201


def test_the_same_bytes_for_the_same_versions(source: TestClient, files: Files) -> None:
    answers = [source.get(BUNDLES, params={"refs": refs}) for refs in ("pendulum,slider", "pendulum@1, slider@1")]
    assert answers[0].content == answers[1].content
    tags = [answer.headers["etag"] for answer in answers]
    assert tags[0] == tags[1] != source.get(BUNDLES, params={"refs": "slider,pendulum"}).headers["etag"]
    assert not tags[0].startswith("W/")
    caching = [answer.headers["cache-control"] for answer in answers]
    assert (caching[0], "immutable" in caching[1]) == ("no-cache", True)
    known = source.get(BUNDLES, params={"refs": "pendulum,slider"}, headers={"If-None-Match": tags[0]})
    assert (known.status_code, known.content) == (304, b"")
    with zipfile.ZipFile(io.BytesIO(answers[0].content)) as archive:
        assert {member.date_time for member in archive.infolist()} == {(1980, 1, 1, 0, 0, 0)}
    document = json.loads(files[LIST])
    assert [part["name"] for part in document["parts"]] == ["pendulum", "slider"]
    assert set(document["parts"][0]) == {"name", "number", "digest", "program", "folder", "files"}
    assert "author" not in files[LIST].decode()


def test_the_same_again_changes_nothing(source: TestClient, client: TestClient, rows: Rows) -> None:
    data = fetched(source, "pendulum,slider")
    assert sent(client, data).status_code == 201
    before = rows()
    again = sent(client, data)
    assert (again.status_code, {item["outcome"] for item in again.json()["items"]}) == (200, {"same"})
    assert rows() == before


def test_what_is_new_in_part(source: TestClient, client: TestClient) -> None:
    client.post("/v1/substructures", json=SLIDER)
    answer = sent(client, fetched(source, "pendulum,slider"))
    assert (answer.status_code, [item["outcome"] for item in answer.json()["items"]]) == (201, ["stored", "same"])
    newer = client.post("/v1/substructures", json={**PENDULUM, "title": "newer"})
    assert newer.json()["version"] == 2


@pytest.fixture
def versions(source: TestClient) -> list[str]:
    """Digests of three versions of a part there."""
    made = [source.post("/v1/substructures", json={**PENDULUM, "name": "many", "title": f"{k}"}) for k in range(3)]
    return [answer.json()["digest"] for answer in made]


def test_versions_keep_their_numbers(source: TestClient, client: TestClient, versions: list[str]) -> None:
    """What is missing stays missing, and what comes later is no newest one."""
    path = "/v1/substructures/many"
    assert sent(client, fetched(source, "many@3")).json()["items"][0]["version"] == 3
    assert client.get(f"{path}@1").status_code == 404
    assert sent(client, fetched(source, "many@1")).json()["items"][0]["links"]["self"] == f"{path}@1"
    assert client.get(path).json()["version"] == 3
    assert client.get(f"{path}@2").status_code == 404
    told = client.get(f"{path}/versions").json()["items"]
    assert [(each["version"], each["digest"]) for each in told] == [(3, versions[2]), (1, versions[0])]
    assert told[0]["links"]["difference"] == f"{path}@1/difference?to=many@3"
    assert "difference" not in told[1]["links"]
    assert client.get(told[0]["links"]["difference"]).status_code == 200
    assert "what changed since @1" in client.get("/substructures/many@3").text
    own = client.post("/v1/substructures", json={**PENDULUM, "name": "many", "title": "own"}).json()
    assert own["version"] == 4
    aliased = client.put(f"{path}/aliases/first", json={"version": 1})
    assert aliased.status_code in (200, 201)
    items = sent(client, fetched(source, "many@2,many@3")).json()["items"]
    assert [(each["version"], each["outcome"]) for each in items] == [(2, "stored"), (3, "same")]
    assert client.get(path).json()["version"] == 4


def test_a_number_that_means_another_content_is_refused(
    source: TestClient, client: TestClient, versions: list[str], rows: Rows
) -> None:
    own = client.post("/v1/substructures", json={**PENDULUM, "name": "many", "title": "own"}).json()
    before = rows()
    answer = sent(client, fetched(source, "pendulum,many@1"))
    assert (answer.status_code, answer.json()["code"]) == (409, "version-taken")
    assert (answer.json()["here"], answer.json()["there"]) == (own["digest"], versions[0])
    assert answer.json()["errors"][0]["pointer"].startswith("/many@")
    assert rows() == before
    assert sent(client, fetched(source, "many@2")).json()["items"][0]["version"] == 2


def test_the_same_content_keeps_the_number_that_it_has_here(
    source: TestClient, client: TestClient, versions: list[str]
) -> None:
    client.post("/v1/substructures", json={**PENDULUM, "name": "many", "title": "1"})
    (item,) = sent(client, fetched(source, "many@2")).json()["items"]
    assert (item["version"], item["digest"], item["outcome"]) == (1, versions[1], "same")


def test_bundles_of_the_first_format_have_no_numbers(client: TestClient, files: Files) -> None:
    def first(document: Any) -> None:
        document["version"] = 1
        for part in document["parts"]:
            del part["number"]

    client.post("/v1/substructures", json={**PENDULUM, "title": "another"})
    items = sent(client, packed(listed(files, first))).json()["items"]
    assert [(item["name"], item["version"]) for item in items] == [("pendulum", 2), ("slider", 1)]


def test_a_key_replays_the_answer(source: TestClient, client: TestClient) -> None:
    data, key = fetched(source, "pendulum"), {"Idempotency-Key": "b1"}
    first, again = sent(client, data, **key), sent(client, data, **key)
    assert (first.status_code, again.status_code, again.headers["idempotency-replayed"]) == (201, 201, "true")
    other = sent(client, fetched(source, "slider"), **key)
    assert (other.status_code, other.json()["code"]) == (422, "idempotency-key-reused")


def test_what_others_packed_is_taken(files: Files, client: TestClient) -> None:
    assert sent(client, packed(files, zipfile.ZIP_DEFLATED)).status_code == 201


@pytest.mark.parametrize(
    ("refs", "status", "code"),
    [
        ("", 422, "refs"),
        (",", 422, "refs"),
        (",".join(["pendulum"] * (MOST_PARTS + 1)), 422, "refs"),
        ("pendulum,nothing", 404, "unknown-substructure"),
        ("pendulum@7", 404, "unknown-substructure"),
        ("not a reference", 404, "not-found"),
    ],
)
def test_references_that_are_none(refs: str, status: int, code: str, source: TestClient) -> None:
    answer = source.get(BUNDLES, params={"refs": refs})
    assert (answer.status_code, answer.json()["code"]) == (status, code)


@pytest.mark.parametrize("case", WRONG)
def test_what_is_wrong_is_refused_whole(case: str, files: Files, client: TestClient, rows: Rows) -> None:
    """The part that is right in it is not stored either."""
    wrong, before = WRONG[case], rows()
    answer = sent(client, wrong.make(files))
    problem = answer.json()
    assert (answer.status_code, problem["code"]) == (422, wrong.code), answer.text
    assert problem["errors"][0]["pointer"].endswith(wrong.pointer)
    assert wrong.words in problem["detail"]
    assert rows() == before
    assert sent(client, packed(files)).status_code == 201


@pytest.mark.parametrize("case", FOREIGN)
@pytest.mark.parametrize("is_known", [False, True])
def test_formulas_of_others_are_never_stored(
    case: str, is_known: bool, source: TestClient, files: Files, client: TestClient, rows: Rows
) -> None:
    """Forged or of another version: what is stored was derived here, and that the bundle's formulas differ is told."""
    if is_known:
        assert sent(client, packed(files)).status_code == 201
    before = rows()
    answer = sent(client, FOREIGN[case](files))
    assert answer.status_code == (200 if is_known else 201), answer.text
    told = {item["name"]: item["formulas"] for item in answer.json()["items"]}
    assert told == {"pendulum": "differ", "slider": "equal"}
    assert not is_known or rows() == before
    for path in ("", "/formulas", "/formulas/metric"):
        there, here = (each.get(f"/v1/substructures/pendulum{path}").json() for each in (source, client))
        told = ("program", "operations", "formulas", "parameters", "symbols")
        assert [there.get(name) for name in told] == [here.get(name) for name in told]
    tree = {"name": "t", "instances": [{"name": "a", "substructure": "pendulum"}]}
    assert client.post("/v1/trees", json=tree).status_code == 201
    request = {"q": [0.5], "quantities": ["metric"]}
    assert client.post("/v1/trees/t/evaluations", json=request).json()["metric"] == [[2.2]]  # m l^2 + m l^2 / 10


def test_who_submits_the_definition_of_a_forged_bundle_gets_its_own_formulas(
    source: TestClient, files: Files, client: TestClient
) -> None:
    """Content is found by the digest of its definition, whoever brought it first."""
    acme, bolt = (key(client, owner, "read", "write") for owner in ("acme", "bolt"))
    assert sent(client, FOREIGN["a bump"](files), **acme).status_code == 201
    answer = client.post("/v1/substructures", json=PENDULUM, headers=bolt)
    assert (answer.status_code, answer.json()["version"]) == (200, 1)
    assert answer.json()["program"] == source.get("/v1/substructures/pendulum").json()["program"]


def test_another_definition_has_its_own_formulas(files: Files, client: TestClient) -> None:
    """A heavier body with the formulas of the lighter one."""
    answer = sent(client, with_definition(heavier)(files))
    assert [item["formulas"] for item in answer.json()["items"]] == ["equal", "differ"]
    metric = client.get("/v1/substructures/slider/formulas/metric?form=compact").text
    assert "2" in metric


@pytest.mark.parametrize(
    "certificate",
    [[], 1, {"direct_form": 1}, {"direct_form": {"max_relative_error": 3}}, {"states": 10**6, "praise": "best"}],
)
def test_a_certificate_is_made_here(certificate: Any, source: TestClient, files: Files, client: TestClient) -> None:
    """What the other side says of a part is not what is said here."""
    assert sent(client, with_certificate(certificate)(files)).status_code == 201
    there, here = (each.get("/v1/substructures/pendulum").json()["certificate"] for each in (source, client))
    assert {**there, "seconds": None} == {**here, "seconds": None}


def test_what_takes_too_long_is_not_gone_on_with(files: Files, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    begun: list[str] = []

    def slow(_store: Any, _viewer: Any, part: Any, *_: Any) -> Any:
        begun.append(part.name)
        sleep(0.6)

    monkeypatch.setattr("service.operations.sharing.bundles.prepare", slow)
    with opened(tmp_path / "slow", limits=Limits(sync_seconds=0.05)) as client:
        answer = sent(client, packed(files))
        assert (answer.status_code, answer.json()["code"]) == (503, "took-too-long")
        sleep(0.7)
    assert begun == ["pendulum"]


def test_other_media_types(client: TestClient) -> None:
    answer = client.post(BUNDLES, json={})
    assert (answer.status_code, answer.headers["accept"]) == (415, "application/zip")


def test_no_more_parts_are_read_than_a_bundle_may_have() -> None:
    digest = "sha256:" + 64 * "0"
    parts = iter([BundledPart(name, 1, digest, digest, b"x" * 700, b"", b"{}") for name in "abc"])
    with pytest.raises(Refused, match="1,404 bytes and more; the limit is 1,000"):
        write_bundle(parts, 1000)
    assert [part.name for part in parts] == ["c"]


def test_limits(source: TestClient, tmp_path: Path) -> None:
    data = fetched(source, "pendulum")
    for name, limit, status, code in (
        ("binary_bytes", len(data) - 1, 413, "body-too-large"),
        ("program_nodes", 10, 422, "too-large"),
        ("sync_seconds", 1e-6, 503, "took-too-long"),
    ):
        with opened(tmp_path / name, limits=Limits(**{name: limit})) as client:
            answer = sent(client, data)
            assert (answer.status_code, answer.json()["code"]) == (status, code)
            assert client.get("/v1/substructures").json()["items"] == []
    with opened(tmp_path / "small", limits=Limits(binary_bytes=len(data) // 2)) as client:
        client.post("/v1/substructures", json=PENDULUM)
        answer = client.get(BUNDLES, params={"refs": "pendulum"})
        assert (answer.status_code, answer.json()["errors"][0]["pointer"]) == (422, "/query/refs")


def key(client: TestClient, owner: str, *scopes: str) -> dict[str, str]:
    store: Store = client.app.state.store  # type: ignore[attr-defined]
    with store.database.write() as connection:
        return {"Authorization": f"Bearer {keys.create(connection, '', scopes, None, owner)}"}


def test_names_of_others(files: Files, client: TestClient, rows: Rows) -> None:
    """One name that belongs to somebody else refuses the bundle whole; what is the same as theirs does not."""
    acme, bolt = (key(client, owner, "read", "write") for owner in ("acme", "bolt"))
    client.post("/v1/substructures", json={**SLIDER, "title": "theirs"}, headers=acme)
    before = rows()
    answer = sent(client, packed(files), **bolt)
    assert (answer.status_code, answer.json()["code"]) == (403, "name-taken")
    assert answer.json()["errors"][0]["pointer"] == "/" + path_of(files, "slider", "/program").split("/")[0]
    assert rows() == before
    client.post("/v1/substructures", json=SLIDER, headers=acme)  # number 2 here, 1 there
    answer = sent(client, packed(files), **bolt)
    assert [(item["version"], item["outcome"]) for item in answer.json()["items"]] == [(1, "stored"), (2, "same")]
    owners = [client.get(f"/v1/substructures/{name}", headers=bolt).json()["owner"] for name in ("pendulum", "slider")]
    assert owners == ["bolt", "acme"]


def test_private_parts(files: Files, client: TestClient) -> None:
    acme, bolt = (key(client, owner, "read", "write") for owner in ("acme", "bolt"))
    assert sent(client, packed(files), "?visibility=private", **acme).status_code == 201
    assert client.get("/v1/substructures/slider", headers=acme).json()["visibility"] == "private"
    for refs in ("slider", "slider@1", "slider@" + json.loads(files[LIST])["parts"][1]["digest"]):
        assert client.get(BUNDLES, params={"refs": refs}, headers=acme).headers["cache-control"] == "no-cache"
        answers = [
            client.get(BUNDLES, params={"refs": ref}, headers=bolt) for ref in (refs, refs.replace("slider", "slidar"))
        ]
        told = [{**answer.json(), "request_id": ""} for answer in answers]
        assert [answer.status_code for answer in answers] == [404, 404]
        assert json.dumps(told[0]) == json.dumps(told[1]).replace("slidar", "slider")
    taken = sent(client, packed(files), **bolt)
    assert (taken.status_code, taken.json()["code"], "acme" in taken.text) == (403, "name-taken", False)
    shown = sent(client, packed(files), "?visibility=public", **acme)
    assert (shown.status_code, shown.json()["code"]) == (409, "visibility-differs")


def test_who_only_reads(files: Files, client: TestClient) -> None:
    reads = key(client, "acme", "read")
    assert sent(client, packed(files), **reads).json()["code"] == "scope-missing"
