"""Two owners on one server: what is private shows nowhere else, who takes names, and whose keys these are."""

from __future__ import annotations

import base64
import json
from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest
import sqlalchemy as sa
from fastapi.testclient import TestClient

from service.app import open_store
from service.cli.main import main
from service.database.migrate import upgrade
from service.messages.viewer import Viewer
from service.queries.jobs.jobs import get_job
from service.settings import Settings
from service.store import keys
from service.store.store import Store

from .conftest import PENDULUM
from .fake_engine import FakeEngine, export, finished, running
from .two_owners import CAMERA, FORM, MARK, NAMES, PART, TREE, Headers, World, served, store_of, world

__all__ = ["served", "world"]  # fixtures


def test_lists_have_what_one_sees(served: TestClient, world: World) -> None:
    acme, reads, bolt = world.keys
    for address, names in ((f"{PART}?facets=true", ("hush", "known")), (TREE, ("hush-cell", "known-cell"))):
        for headers, expected in ((acme, names), (reads, names), (bolt, names[1:]), (world.admin, names)):
            found = served.get(address, headers=headers).json()
            assert tuple(item["name"] for item in found["items"]) == expected
            if "facets" in found:
                assert found["facets"]["dof"] == {"1": len(expected)}
    for query, expected in (("owner=acme", ["known"]), ("owner=bolt", []), ("q=hus", [])):
        found = served.get(f"{PART}?{query}", headers=bolt).json()["items"]
        assert [item["name"] for item in found] == expected
    for query, expected in (("q=cell", ["known-cell"]), ("uses=known", ["known-cell"]), ("uses=hush", [])):
        found = served.get(f"{TREE}?{query}", headers=bolt).json()["items"]
        assert [item["name"] for item in found] == expected
    assert [item["name"] for item in served.get(f"{TREE}?uses=hush", headers=acme).json()["items"]] == ["hush-cell"]


def put(client: TestClient, headers: Headers, address: str, body: Any, status: int = 201) -> Any:
    answer = client.post(address, json=body, headers=headers)
    assert answer.status_code == status, answer.text
    return answer.json()


def test_what_is_private_shows_in_no_list_of_a_public_part(served: TestClient, world: World) -> None:
    """What acme has of bolt's public part: made from it, built with it, published with it, named as its successor."""
    acme, reads, bolt = world.keys
    put(served, bolt, PART, {**PENDULUM, "name": "open", "title": "of bolt"})
    hidden = {"visibility": "private"}
    put(served, acme, PART, {**PENDULUM, "name": "hush-made", "title": MARK, "derived_from": "open@1", **hidden})
    instances = [{"name": "a", "substructure": "open"}]
    put(served, acme, TREE, {"name": "hush-tree", "gravity": [0, 0, 0], "instances": instances, **hidden})
    put(served, acme, f"{TREE}/hush-tree/publish", {"name": "hush-built", **hidden})
    used = f"{PART}/open@1/uses"
    everything = {("derived", "hush-made"), ("part", "hush-built"), ("tree", "hush-tree")}
    for headers, expected in ((acme, everything), (reads, everything), (world.admin, everything), (bolt, set())):
        found = served.get(used, headers=headers).json()
        assert {(each["kind"], each["name"]) for each in found["items"]} == expected
        assert served.get(f"{PART}/open/uses", headers=headers).json()["items"] == found["items"]
    for address in (
        *(f"{PART}/open{rest}" for rest in ("", "@1", "/versions", "/uses", "@1/uses?page_size=1", "/visibility")),
        *(f"{TREE}?uses=open", f"{PART}?q=open&facets=true", "/substructures/open@1", "/substructures/open"),
    ):
        answer = served.get(address, headers=bolt)
        assert MARK not in answer.text, address
        assert "next_page_token" not in answer.text or answer.json()["next_page_token"] is None


def test_what_is_public_does_not_name_what_is_private(served: TestClient, world: World) -> None:
    """A public version that was made from a private one, and one whose successor is private."""
    acme, reads, bolt = world.keys
    put(served, acme, PART, {**PENDULUM, "name": "open", "title": "made", "derived_from": "hush@1"})
    put(served, acme, PART, {**PENDULUM, "name": "old", "title": "old"})
    put(served, acme, f"{PART}/old@1/withdraw", {"reason": "", "successor": "hush@1"}, 200)
    names = {"open@1": "derived_from", "old@1": "successor"}
    for ref, member in names.items():
        for headers, is_seen in ((acme, True), (reads, True), (world.admin, True), (bolt, False)):
            found = served.get(f"{PART}/{ref}", headers=headers).json()
            assert (found[member] is not None) == is_seen, (ref, member)
        for address in (f"{PART}/{ref}", f"{PART}/{ref.partition('@')[0]}/versions", f"/substructures/{ref}"):
            assert MARK not in served.get(address, headers=bolt).text, address


def test_tokens_of_pages_do_not_count_what_is_private(served: TestClient, world: World) -> None:
    """The same search has the same token, however much of others there is that is not seen."""
    acme, _, bolt = world.keys

    def token(*names: str) -> str:
        for name in names:
            put(served, bolt, PART, {**PENDULUM, "name": name, "title": name})
        found = served.get(f"{PART}?q=pair&page_size=1", headers=bolt).json()
        assert [each["name"] for each in found["items"]] == ["pair-one"]
        following = served.get(f"{PART}?q=pair&page_size=1&page_token={found['next_page_token']}", headers=bolt).json()
        assert [each["name"] for each in following["items"]] == ["pair-two"]
        return str(found["next_page_token"])

    for k in range(3):
        put(served, acme, PART, {**PENDULUM, "name": f"hush-{k}", "title": MARK, "visibility": "private"})
    text = base64.urlsafe_b64decode(token("pair-one", "pair-two") + "==").decode()
    assert json.loads(text)[1:] == [1, "pair-one"]
    mark = json.loads(text)[0]
    for name in ("hush", "nothing"):  # what is not seen is not there
        forged = base64.urlsafe_b64encode(json.dumps([mark, 1, name]).encode()).decode().rstrip("=")
        answer = served.get(f"{PART}?q=pair&page_size=1&page_token={forged}", headers=bolt)
        assert (answer.status_code, answer.json()["code"]) == (422, "page-token")


def test_evaluations_at_hand_are_kept_for_their_owner(served: TestClient, world: World) -> None:
    """The short way, which looks into no database, is closed to others."""
    acme, reads, bolt = world.keys
    body = {"quantities": ["metric"], "q": [0.1, 0.2]}
    assert served.post(f"{TREE}/hush-cell@1/kernels", json=body, headers=acme).status_code == 201
    for headers, status in ((acme, 200), (acme, 200), (reads, 200), (bolt, 404), (world.admin, 200), (bolt, 404)):
        answer = served.post(f"{TREE}/hush-cell@1/evaluations", json=body, headers=headers)
        assert answer.status_code == status
    kept = store_of(served).caches.evaluations
    assert kept.get(("acme", "hush-cell@1", "metric")) is not None  # otherwise nothing was tested


@pytest.mark.parametrize("how", ["tree", "job", "coupling"])
def test_no_private_part_in_a_public_tree(how: str, served: TestClient, world: World) -> None:
    acme = world.keys[0]
    if how == "coupling":
        answer = served.post(f"{TREE}/known-cell/couplings", json={**CAMERA, "substructure": "hush"}, headers=acme)
        assert answer.json()["errors"][0]["pointer"] == "/substructure"
    else:
        tree = {**FORM, "name": "one", "instances": [{"name": "a", "substructure": "hush"}]}
        if how == "tree":
            answer = served.post(TREE, json=tree, headers=acme)
            pointer = "/instances/0/substructure"
        else:
            answer = served.post("/v1/jobs", json={"kind": "assemble", "items": [tree]}, headers=acme)
            pointer = "/items/0/instances/0/substructure"
        assert answer.json()["errors"][0]["pointer"] == pointer
        private = {**tree, "visibility": "private"}
        again = served.post(TREE, json=private, headers=acme)
        assert (again.status_code, again.json().get("visibility")) == (201, "private")
    assert (answer.status_code, answer.json()["errors"][0]["code"]) == (422, "private-part")
    assert "'hush' is private" in answer.text


def test_what_jobs_store_belongs_to_their_owner(served: TestClient, world: World) -> None:
    """Also where two owners ask for the same: the second does not get the first one's tree."""
    acme, _, bolt = world.keys
    store: Store = store_of(served)
    item = {**FORM, "name": "both", "instances": [{"name": "a", "substructure": "known"}], "visibility": "private"}
    ids = [
        served.post("/v1/jobs", json={"kind": "assemble", "items": [item]}, headers=headers).json()["id"]
        for headers in (acme, bolt)
    ]
    part = {**PENDULUM, "name": "derived", "visibility": "private"}
    ids.append(served.post("/v1/jobs", json={"kind": "derive", "items": [part]}, headers=bolt).json()["id"])
    with running(store, FakeEngine()):
        for headers, job in zip((acme, bolt, bolt), ids, strict=True):
            served.headers.update(headers)
            finished(served, job)
    results = [
        served.get(f"/v1/jobs/{job}/result", headers=headers).json()["items"][0]
        for headers, job in zip((acme, bolt, bolt), ids, strict=True)
    ]
    assert [each["state"] for each in results] == ["succeeded", "failed", "succeeded"]
    assert results[1]["problem"]["code"] == "name-taken"
    assert served.get(f"{TREE}/both", headers=acme).json()["owner"] == "acme"
    assert served.get(f"{TREE}/both", headers=bolt).status_code == 404
    assert served.get(f"{PART}/derived", headers=bolt).json()["visibility"] == "private"
    assert served.get(f"{PART}/derived", headers=acme).status_code == 404
    taken = served.post("/v1/jobs", json={"kind": "assemble", "items": [item]}, headers=bolt)
    assert taken.json()["errors"][0]["pointer"] == "/items/0/name"


def test_shared_jobs_show_nothing_private(served: TestClient, world: World) -> None:
    acme = world.keys[0]
    answer = served.post("/v1/jobs", json={**export("hush-cell", "metric"), "shared": True}, headers=acme)
    assert (answer.status_code, answer.json()["errors"][0]["pointer"]) == (422, "/shared")


def test_what_becomes_public(served: TestClient, world: World) -> None:
    acme, _, bolt = world.keys
    assert served.put(f"{TREE}/hush-cell/visibility", json={"visibility": "public"}, headers=acme).status_code == 409
    assert served.put(f"{PART}/hush/visibility", json={"visibility": "public"}, headers=acme).status_code == 200
    assert served.get(f"{PART}/hush", headers=bolt).json()["visibility"] == "public"
    assert served.put(f"{TREE}/hush-cell/visibility", json={"visibility": "public"}, headers=acme).status_code == 200
    assert served.get(f"{TREE}/hush-cell", headers=bolt).status_code == 200
    for address in (f"{TREE}/hush-cell", f"{PART}/hush"):
        back = served.put(f"{address}/visibility", json={"visibility": "private"}, headers=acme)
        assert (back.status_code, back.json()["code"]) == (409, "was-public")
    again = served.post(PART, json={**PENDULUM, "name": "hush", "visibility": "private"}, headers=acme)
    assert (again.status_code, again.json()["code"]) == (409, "visibility-differs")


def test_what_is_private_is_not_kept_by_caches(served: TestClient, world: World) -> None:
    acme = world.keys[0]
    for address in (f"{PART}/{{}}@1/definition", f"{TREE}/{{}}-cell@1/metric", f"{TREE}/{{}}-cell@1/picture"):
        kept = {
            name: served.get(address.format(name), headers=acme).headers["cache-control"] for name in NAMES.values()
        }
        assert (kept["hush"], "immutable" in kept["known"]) == ("no-cache", True)


def test_inline_definitions_do_not_tell_what_is_private(
    served: TestClient, world: World, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Whoever sends the content of a private part, it is derived as if nobody had it: it takes as long."""
    derived: list[str] = []
    original: Callable[..., Any] = __import__("service.jobs.kinds.assemble", fromlist=["derive"]).derive

    def noted(definition: Any, *rest: Any) -> Any:
        derived.append(definition.name)
        return original(definition, *rest)

    monkeypatch.setattr("service.jobs.kinds.assemble.derive", noted)
    definition = {**PENDULUM, "name": "hush", "title": "hush"}
    for k, headers in enumerate((world.keys[2], world.keys[0])):
        tree = {"name": f"own-{k}", "visibility": "private", "instances": [{"name": "a", "definition": definition}]}
        assert served.post(TREE, json=tree, headers=headers).status_code == 201
        assert derived == ["hush"]
        derived.clear()


def test_names_are_taken_by_who_comes_first(served: TestClient, world: World) -> None:
    """Nobody puts another arm under a name that others use; whoever sends the same again is told that it is there."""
    acme, _, bolt = world.keys
    other = {**PENDULUM, "name": "known", "title": "known", "tags": ["changed"]}
    refused = served.post(PART, json=other, headers=bolt)
    assert (refused.status_code, refused.json()["code"]) == (403, "name-taken")
    assert "belongs to 'acme'; take another name, for example 'known-bolt'" in refused.json()["detail"]
    assert served.get(f"{PART}/known", headers=bolt).json()["version"] == 1
    same = served.post(PART, json={**PENDULUM, "name": "known", "title": "known"}, headers=bolt)
    assert (same.status_code, same.json()["owner"], same.json()["version"]) == (200, "acme", 1)
    assert served.post(PART, json={**other, "name": "known-bolt"}, headers=bolt).json()["owner"] == "bolt"
    assert served.post(PART, json=other, headers=acme).json()["version"] == 2
    assert served.post(PART, json={**other, "tags": ["admin"]}, headers=world.admin).json()["owner"] == "acme"


def test_the_audit(served: TestClient, world: World) -> None:
    acme, _, bolt = world.keys
    served.post(f"{PART}/known@1/withdraw", json={"reason": "old"}, headers=acme)
    entries = served.get("/v1/audit?owner=acme&page_size=1000", headers=world.admin).json()["items"]
    actions = [entry["action"] for entry in entries]
    assert actions[0] == "substructure.withdraw"
    assert entries[0]["detail"] == {"reason": "old"}
    assert {"key.create", "substructure.submit", "tree.store", "alias.set", "job.submit"} <= set(actions)
    assert [entry["seq"] for entry in entries] == sorted((entry["seq"] for entry in entries), reverse=True)
    served.post(f"{PART}/known@1/withdraw", json={"reason": "not mine"}, headers=bolt)
    again = served.get("/v1/audit?subject=known@1&action=substructure.withdraw", headers=world.admin).json()["items"]
    assert len(again) == 1
    first = served.get("/v1/audit?page_size=1", headers=world.admin).json()
    following = served.get(first["links"]["next"], headers=world.admin).json()
    assert following["items"][0]["seq"] == first["items"][0]["seq"] - 1


@pytest.mark.parametrize("change", ["UPDATE audit SET owner = 'x'", "DELETE FROM audit"])
def test_the_audit_stays_as_it_is(change: str, served: TestClient) -> None:
    store: Store = store_of(served)
    with pytest.raises(Exception, match="append-only"), store.database.write() as connection:
        connection.exec_driver_sql(change)


def test_what_was_there_before_has_an_owner(tmp_path: Path) -> None:
    """Names and keys are local's, a job stays with its key; shipped names go to the catalogue."""
    url = f"sqlite:///{tmp_path / 'store.db'}"
    with open_store(Settings(database=url)) as store, store.database.write() as connection:
        identifier = keys.create(connection, "", ["read", "jobs"]).split("_")[1]
        other = keys.create(connection, "", ["read", "jobs"]).split("_")[1]
        connection.exec_driver_sql("UPDATE substructures SET owner = 'local'")
        connection.exec_driver_sql("INSERT INTO substructures (name) VALUES ('own')")
        row = f"('old', 'export', '{identifier}', 'queued', 1, 0, 0, 0, '', '{identifier}')"
        names = "id, kind, principal, state, total, done, failed, attempts, created, owner"
        connection.exec_driver_sql(f"INSERT INTO jobs ({names}) VALUES {row}")  # noqa: S608 -- ours
    with open_store(Settings(database=url)) as store, store.database.read() as connection:
        owners = dict(connection.exec_driver_sql("SELECT name, owner FROM substructures").all())
        assert (owners.pop("own"), set(owners.values())) == ("local", {"catalogue"})
        job = get_job(connection, "old")
        assert job is not None
        seen = [job.is_seen_by(Viewer(key, "local", ("read",))) for key in (identifier, other)]
        assert seen == [True, False]


def test_migrating_jobs(tmp_path: Path) -> None:
    engine = sa.create_engine(f"sqlite:///{tmp_path / 'x.db'}")
    upgrade(engine, "0007")
    names = "id, kind, principal, state, total, done, failed, attempts, created"
    with engine.begin() as connection:
        row = "('old', 'export', 'k', 'queued', 1, 0, 0, 0, '')"
        connection.exec_driver_sql(f"INSERT INTO jobs ({names}) VALUES {row}")  # noqa: S608 -- ours
    upgrade(engine)
    with engine.connect() as connection:
        assert connection.exec_driver_sql("SELECT owner FROM jobs").scalar() == "k"
    engine.dispose()


def test_rotating_and_deleting_keys(served: TestClient, world: World) -> None:
    store, acme = store_of(served), world.keys[0]
    identifier = acme["Authorization"].split("_")[1]
    with store.database.write() as connection:
        with pytest.raises(ValueError, match="in use"):
            keys.delete(connection, identifier)
        text = keys.rotate(connection, identifier)
    new = {"Authorization": f"Bearer {text}"}
    assert served.get(f"{PART}/hush", headers=acme).json()["code"] == "key-revoked"
    assert served.get(f"{PART}/hush", headers=new).status_code == 200
    assert served.get(f"{PART}/hush", headers=new).json()["owner"] == "acme"
    with store.database.write() as connection:
        again = {"Authorization": f"Bearer {keys.rotate(connection, text.split('_')[1], hours=1)}"}
        keys.delete(connection, identifier)
        with pytest.raises(ValueError, match="there is no key"):
            keys.rotate(connection, identifier)
    for headers in (new, again):
        assert served.get(f"{PART}/hush", headers=headers).status_code == 200
    with store.database.write() as connection:
        keys.revoke(connection, text.split("_")[1])
        with pytest.raises(ValueError, match="is revoked"):
            keys.rotate(connection, text.split("_")[1])


def test_the_command_key(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    database = ["--database", f"sqlite:///{tmp_path / 'x.db'}"]
    assert main(["key", "create", "--owner", "acme", "--scope", "write", *database]) == 0
    identifier = capsys.readouterr().out.split("_")[1]
    assert main(["key", "rotate", identifier, *database]) == 0
    new = capsys.readouterr().out.split("_")[1]
    assert main(["key", "list", *database]) == 0
    listed = capsys.readouterr().out.splitlines()
    assert [line.split()[:3] for line in listed] == [[identifier, "acme", "write"], [new, "acme", "write"]]
    assert main(["key", "delete", new, *database]) == 1
    assert "revoke it first" in capsys.readouterr().err
    assert main(["key", "revoke", new, *database]) == 0
    assert "the last key" in capsys.readouterr().err
    for each in (identifier, new):
        assert main(["key", "delete", each, *database]) == 0
    assert main(["key", "list", *database]) == 0
    assert capsys.readouterr().out == ""
    assert main(["key", "create", "--owner", "No Such", *database]) == 1
    assert "is no owner" in capsys.readouterr().err
