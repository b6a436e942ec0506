"""A server follows a folder: what is new or changed is stored, what is gone withdrawn, what is wrong told."""

from __future__ import annotations

import json
import os
import re
import shutil
import time
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

import httpx2
import pytest

from service import following
from service.app import open_store
from service.cli.main import main
from service.messages.refusals import Refused
from service.operations.sharing.folder import Folder
from service.queries import folders
from service.settings import Limits, Settings
from service.store.store import Store
from substructures.documents import write_yaml

from .conftest import PENDULUM, SLIDER, at_once, make_client
from .databases import fresh
from .farm import Server, running

Found = dict[str, Any]


class Followed:
    """A folder, the store of the server that follows it, and a client."""

    def __init__(self, store: Store, parts: Path) -> None:
        self.store, self.parts, self.client = store, parts, make_client(store)
        self.folder = Folder(store)

    def write(self, name: str, document: Any) -> None:
        """A file; bytes as they are, other documents as YAML or JSON."""
        file = self.parts / name
        file.parent.mkdir(parents=True, exist_ok=True)
        as_json = name.endswith(".json")
        data = document if isinstance(document, bytes) else write_yaml(document)
        file.write_bytes(json.dumps(document).encode() if as_json and not isinstance(document, bytes) else data)

    def look(self) -> Found:
        """What is told after two looks: at the first one a file may still be being written."""
        self.folder.look()
        self.folder.look()
        return self.told()

    def told(self) -> Found:
        answer = self.client.get("/v1/folder")
        assert answer.status_code == 200, answer.text
        return dict(answer.json())

    def restart(self) -> Found:
        """What is told after the first look of another server on the same store."""
        self.folder = Folder(self.store)
        self.folder.look()
        return self.told()

    def versions(self, name: str) -> dict[int, str | None]:
        """Of all versions why they are withdrawn, None of those that are not."""
        items = self.client.get(f"/v1/substructures/{name}/versions").json()["items"]
        return {each["version"]: each["withdrawal_reason"] for each in reversed(items)}

    def latest(self, name: str) -> Any:
        return self.client.get(f"/v1/substructures/{name}").json().get("version")


def files(told: Found) -> dict[str, str]:
    return {each["file"]: f"{each['part']}@{each['version']}" for each in told["files"]}


def refused(told: Found) -> dict[str, str]:
    """Code and message of the first fault of each file."""
    errors = {each["file"]: each["errors"][0] for each in told["refused"]}
    return {name: f"{each['pointer']} {each['code']}: {each['message']}" for name, each in errors.items()}


def heavier(mass: float) -> Found:
    return {**PENDULUM, "parameters": {**PENDULUM["parameters"], "m": {"value": mass, "unit": "kg"}}}


@pytest.fixture
def parts(tmp_path: Path) -> Path:
    (tmp_path / "parts").mkdir()
    return tmp_path / "parts"


@pytest.fixture
def settings(settings: Settings, parts: Path) -> Settings:
    return settings.model_copy(update={"folder": str(parts), "limits": Limits(json_bytes=20_000)})


@pytest.fixture
def one(store: Store, parts: Path) -> Followed:
    return Followed(store, parts)


def test_all_definitions_are_read(one: Followed, caplog: pytest.LogCaptureFixture) -> None:
    caplog.set_level("INFO", "service")
    one.write("pendulum.yaml", {**PENDULUM, "note": "of the team"})
    one.write("deep/er/slider.JSON".lower(), SLIDER)
    one.write(".git/config.json", b"{")
    one.write("robot.urdf", b"<robot/>")
    one.write("README.md", b"Parts")
    told = one.look()
    assert files(told) == {"pendulum.yaml": "pendulum@1", "deep/er/slider.json": "slider@1"}
    assert told["refused"] == told["gone"] == told["waiting"] == []
    assert told["not_read"] == {"count": 2, "items": ["README.md", "robot.urdf"]}
    found = one.client.get("/v1/substructures/pendulum").json()
    assert [found[name] for name in ("author", "owner", "note", "origin")] == [
        *("folder", "local", "of the team", "definition")
    ]
    assert caplog.text.count("README.md, robot.urdf") == 1
    assert "2 files are read, 0 refused" in caplog.text
    assert files(one.restart()) == files(told)  # and nothing is new
    assert one.versions("pendulum") == one.versions("slider") == {1: None}
    assert one.told() == told


def test_changes_become_versions_and_go_back(one: Followed) -> None:
    """As ``git revert`` does: a content that was there already is the latest again."""
    earlier = "its file has the content of an earlier version again"
    one.write("pendulum.yaml", heavier(1))
    one.look()
    one.write("pendulum.yaml", heavier(2))
    one.folder.look()
    assert files(one.told()) == {"pendulum.yaml": "pendulum@1"}  # it may still be being written
    assert files(one.look()) == {"pendulum.yaml": "pendulum@2"}
    one.write("pendulum.yaml", heavier(3))
    assert files(one.look()) == {"pendulum.yaml": "pendulum@3"}
    one.write("pendulum.yaml", heavier(1))
    assert files(one.look()) == {"pendulum.yaml": "pendulum@1"}
    assert one.versions("pendulum") == {1: None, 2: earlier, 3: earlier}
    assert one.client.get("/v1/substructures/pendulum@3").json()["successor"] == "pendulum@1"
    assert one.latest("pendulum") == 1
    one.write("pendulum.yaml", heavier(2))
    assert files(one.look()) == {"pendulum.yaml": "pendulum@2"}
    assert one.versions("pendulum") == {1: None, 2: None, 3: earlier}
    one.write("pendulum.yaml", heavier(4))
    one.look()
    assert one.versions("pendulum") == {1: None, 2: None, 3: None, 4: None}
    with one.store.database.read() as connection:
        assert folders.latest(connection, "pendulum") == 4


def test_what_is_wrong_is_told_and_stops_nothing(one: Followed, caplog: pytest.LogCaptureFixture) -> None:
    one.write("a.yaml", b"name: a\nbodies: [")
    one.write("pendulum.yaml", {**PENDULUM, "bodies": [{**PENDULUM["bodies"][0], "mass": "mm"}]})
    one.write("tree.json", {"name": "cell", "instances": []})
    one.write("text.yml", b"\xff")
    one.write("many.json", {"name": "many", **dict.fromkeys("abcdef", 1)})
    one.write("list.json", [1])
    one.write("slider.yaml", SLIDER)
    told = one.look()
    assert files(told) == {"slider.yaml": "slider@1"}
    wrong = refused(told)
    assert wrong["a.yaml"].startswith("/bodies/0 syntax: expected the node content")
    assert wrong["a.yaml"].endswith("(line 2, column 10)")
    assert wrong["pendulum.yaml"].startswith("/bodies/0/mass unknown-name: unknown name 'mm'")
    assert "line" in wrong["pendulum.yaml"]
    assert "unknown field 'instances'" in json.dumps(told["refused"])
    assert wrong["text.yml"].startswith(" encoding")
    assert wrong["list.json"].startswith(" object-expected")
    assert "refused: a.yaml#/bodies/0: expected the node content" in caplog.text
    assert re.search(
        r"refused: many.json#/\w+: .*; many.json#/\w+: .*; many.json#/\w+: .*; ... \(\d faults\)\n", caplog.text
    )
    page = one.client.get("/").text
    assert "6 files of the folder of parts are refused" in page
    assert 'href="/v1/folder"' in page
    caplog.clear()
    one.look()
    assert "refused" not in caplog.text  # once
    for name in ("a.yaml", "tree.json", "text.yml", "list.json", "many.json"):
        (one.parts / name).unlink()
    assert "1 file of the folder of parts is refused" in (one.look() and one.client.get("/").text)
    one.write("pendulum.yaml", PENDULUM)
    assert files(one.look()) == {"pendulum.yaml": "pendulum@1", "slider.yaml": "slider@1"}
    assert "refused" not in one.client.get("/").text


def test_what_was_stored_of_a_file_that_is_wrong_now_stays(one: Followed) -> None:
    """Also where the server was started anew meanwhile, which reads no name in the file."""
    one.write("x.yaml", PENDULUM)
    one.look()
    one.write("x.yaml", b"name: [")
    told = one.look()
    assert [each["part"] for each in told["refused"]] == ["pendulum"]
    assert (told["gone"], one.versions("pendulum")) == ([], {1: None})
    told = one.restart()
    assert [each["part"] for each in told["refused"]] == ["pendulum"]
    assert (told["gone"], one.versions("pendulum")) == ([], {1: None})


@pytest.mark.parametrize("is_restarted", [False, True])
def test_what_is_gone_is_withdrawn_until_it_is_back(one: Followed, is_restarted: bool) -> None:
    gone = "its file is gone"
    look: Callable[[], Found] = one.restart if is_restarted else one.look
    one.write("pendulum.yaml", heavier(1))
    one.look()
    one.write("pendulum.yaml", heavier(2))
    one.write("slider.yaml", SLIDER)
    one.look()
    (one.parts / "pendulum.yaml").unlink()
    told = look()
    assert (told["gone"], files(told)) == (["pendulum"], {"slider.yaml": "slider@1"})
    assert one.versions("pendulum") == {1: gone, 2: gone}
    assert gone in one.client.get("/v1/substructures/pendulum").json()["detail"]
    assert one.client.get("/v1/substructures/pendulum@2/definition").status_code == 200
    one.write("elsewhere/other.yml", heavier(2))
    told = look()
    assert (told["gone"], files(told)["elsewhere/other.yml"]) == ([], "pendulum@2")
    assert one.versions("pendulum") == {1: None, 2: None}
    assert one.latest("pendulum") == 2
    acts = [each["action"] for each in one.client.get("/v1/audit?key=folder").json()["items"]]
    assert acts.count("substructure.offer") == acts.count("substructure.withdraw") == 2


def test_a_file_may_be_renamed_and_a_part_too(one: Followed) -> None:
    one.write("a.yaml", PENDULUM)
    one.look()
    (one.parts / "a.yaml").rename(one.parts / "b.yaml")
    assert files(one.look()) == {"b.yaml": "pendulum@1"}
    assert one.versions("pendulum") == {1: None}
    one.write("slider.yaml", SLIDER)
    one.look()
    (one.parts / "b.yaml").unlink()
    one.folder.look()
    one.write("c.yaml", PENDULUM)  # which may still be being written when b.yaml is gone for good
    one.folder.look()
    assert one.versions("pendulum") == {1: None}
    assert files(one.look()) == {"c.yaml": "pendulum@1", "slider.yaml": "slider@1"}
    assert "substructure.withdraw" not in one.client.get("/v1/audit?key=folder").text
    one.write("c.yaml", {**PENDULUM, "name": "rod"})
    told = one.look()
    assert (files(told), told["gone"]) == ({"c.yaml": "rod@1", "slider.yaml": "slider@1"}, ["pendulum"])


def test_two_files_of_one_name_are_both_refused(one: Followed) -> None:
    one.write("a.yaml", heavier(1))
    one.look()
    one.write("b/c.yaml", heavier(2))
    told = one.look()
    assert files(told) == {}
    assert refused(told)["a.yaml"].startswith("/name duplicate-name: 'pendulum' is described by b/c.yaml, too")
    assert refused(told)["b/c.yaml"].startswith("/name duplicate-name: 'pendulum' is described by a.yaml, too")
    assert all("line" in each for each in refused(told).values())
    assert one.versions("pendulum") == {1: None}
    (one.parts / "a.yaml").unlink()
    assert files(one.look()) == {"b/c.yaml": "pendulum@2"}
    assert one.told()["refused"] == []


def test_links_that_lead_out_are_not_followed(one: Followed, tmp_path: Path) -> None:
    (tmp_path / "secret").mkdir()
    (tmp_path / "secret" / "pendulum.yaml").write_bytes(write_yaml(PENDULUM))
    (one.parts / "out.yaml").symlink_to(tmp_path / "secret" / "pendulum.yaml")
    (one.parts / "folder").symlink_to(tmp_path / "secret")
    (one.parts / "nothing.yaml").symlink_to("nowhere")
    (one.parts / "notes").symlink_to(tmp_path / "secret" / "pendulum.yaml")
    one.write("slider.yaml", SLIDER)
    (one.parts / "same.yaml").symlink_to("slider.yaml")
    one.write("table.yaml", {**SLIDER, "name": "table", "tables": {"bump": {"file": "../secret/pendulum.yaml"}}})
    told = one.look()
    assert files(told) == {"slider.yaml": "slider@1"}
    wrong = refused(told)
    leads = " leads-out: a link that leads out of the folder is not followed"
    assert (wrong.pop("out.yaml"), wrong.pop("folder")) == (leads, leads)
    assert wrong.pop("nothing.yaml") == " unreadable: cannot be read: No such file or directory"
    assert wrong.pop("table.yaml").startswith("/tables/bump/file bad-file: '../secret/pendulum.yaml' is not in")
    assert wrong == {}
    assert told["not_read"]["items"] == ["notes", "same.yaml"]


def test_folders_that_are_put_in_place_by_links(one: Followed, tmp_path: Path) -> None:
    """As Kubernetes mounts files, each a link into a hidden folder, and as releases are switched by one link."""
    for release, mass in (("one", 1), ("two", 2)):
        (tmp_path / release / "..data").mkdir(parents=True)
        (tmp_path / release / "..data" / "pendulum.yaml").write_bytes(write_yaml(heavier(mass)))
        (tmp_path / release / "pendulum.yaml").symlink_to("..data/pendulum.yaml")
    one.parts.rmdir()
    one.parts.symlink_to("one")
    assert files(one.restart()) == {"pendulum.yaml": "pendulum@1"}
    one.parts.unlink()
    one.parts.symlink_to("two")
    assert files(one.look()) == {"pendulum.yaml": "pendulum@2"}


def test_files_that_are_no_friends(one: Followed) -> None:
    """Too large, bombs, pipes that nobody writes to, names that are no text."""
    one.write("huge.yaml", b"name: huge\ntitle: " + b"x" * 20_000)
    one.write("bomb.yaml", b"a: &a [x, x]\nb: &b [*a, *a]\n")
    one.write("deep.json", b"[" * 10_000)
    os.mkfifo(one.parts / "pipe.yaml")
    os.mkfifo(one.parts / "pipe.csv")
    one.write("tables.yaml", {**SLIDER, "tables": {"bump": {"file": "pipe.csv"}}})
    one.write("many.yaml", {**SLIDER, "name": "many", "tables": {f"t{k}": {"file": "t.csv"} for k in range(100)}})
    one.write("t.csv", b"0,0\n" * 100)
    (one.parts / "a\nb\u202e.yaml").write_text("[]")
    Path(os.fsdecode(os.fsencode(one.parts) + b"/\xff.yaml")).write_text("[]")
    told = one.look()
    assert files(told) == {}
    wrong = refused(told)
    assert wrong["huge.yaml"].startswith(" too-large: more than 20,000 bytes")
    assert wrong["many.yaml"].startswith(" too-large: more than 20,000 bytes with its tables")
    assert wrong["bomb.yaml"].startswith("/a anchor: anchors and aliases are not allowed (line 1")
    assert wrong["deep.json"].startswith(" nesting")
    assert wrong["pipe.yaml"].startswith(" no-file")
    assert wrong["tables.yaml"].startswith("/tables/bump/file bad-file: 'pipe.csv' cannot be read: it is no file")
    assert {"a\ufffdb\ufffd.yaml", "\ufffd.yaml"} <= wrong.keys()
    assert one.client.get("/").status_code == 200


def test_the_files_of_tables_are_followed_too(one: Followed) -> None:
    spring = {"type": "joint", "coordinate": "x", "force": "table(x; curve)"}
    one.write("curve.csv", b"0,0\n1,5\n")
    one.write("slider.yaml", {**SLIDER, "loads": [spring], "tables": {"curve": {"file": "curve.csv"}}})
    told = one.look()
    assert (told["refused"], told["not_read"]["count"]) == ([], 0)
    one.write("curve.csv", b"0,0\n1,6\n")
    assert files(one.look()) == {"slider.yaml": "slider@2"}
    (one.parts / "curve.csv").unlink()
    assert "'curve.csv' cannot be read" in refused(one.look())["slider.yaml"]
    one.write("curve.csv", b"0,0\n1,5\n")
    assert files(one.look()) == {"slider.yaml": "slider@1"}


def test_files_may_refer_to_each_other_in_any_order(one: Followed) -> None:
    one.write("a.yaml", {**SLIDER, "derived_from": "pendulum"})
    assert "/derived_from unknown-substructure: there is no substructure 'pendulum'" in refused(one.look())["a.yaml"]
    one.write("b.yaml", PENDULUM)
    assert files(one.look()) == {"a.yaml": "slider@1", "b.yaml": "pendulum@1"}
    assert one.client.get("/v1/substructures/slider").json()["derived_from"] == "pendulum@1"


def test_what_is_refused_names_nothing_private(one: Followed) -> None:
    one.client.post("/v1/substructures", json={**PENDULUM, "visibility": "private"})
    for reference in ("pendulm", "pendulum", "pendulum@1"):
        one.write("a.yaml", {**SLIDER, "derived_from": reference})
        told = refused(one.look())["a.yaml"]
        assert "there is no substructure" in told
        assert "pendulum" not in told.replace(reference, "")


def test_names_of_others_and_what_is_private_are_refused(one: Followed) -> None:
    one.write("a.yaml", {**SLIDER, "visibility": "private"})
    one.client.post("/v1/substructures", json={**PENDULUM, "visibility": "private"})
    one.write("b.yaml", PENDULUM)
    wrong = refused(one.look())
    assert wrong["a.yaml"].startswith("/visibility private-part: what is in a folder is for all")
    assert wrong["b.yaml"].startswith(" private-part: 'pendulum' is not public")


def test_what_others_store_and_withdraw_stays(one: Followed) -> None:
    one.write("pendulum.yaml", heavier(1))
    one.look()
    assert one.client.post("/v1/substructures", json=heavier(2)).status_code == 201
    told = one.restart()
    assert "pendulum@2 is offered" in told["files"][0]["remark"]
    assert one.latest("pendulum") == 2
    one.write("pendulum.yaml", heavier(3))
    assert one.look()["files"][0]["remark"] == ""
    assert one.client.post("/v1/substructures/pendulum@3/withdraw", json={"reason": "wrong"}).status_code == 200
    assert "others have withdrawn it" in one.restart()["files"][0]["remark"]
    (one.parts / "pendulum.yaml").unlink()
    one.look()
    assert one.versions("pendulum") == {1: "its file is gone", 2: None, 3: "wrong"}


def test_a_folder_that_cannot_be_read_withdraws_nothing(one: Followed) -> None:
    one.write("pendulum.yaml", PENDULUM)
    one.look()
    shutil.move(one.parts, one.parts.with_name("away"))
    for told in (one.look(), one.restart()):
        assert (told["waiting"], told["gone"]) == (["pendulum"], [])
        assert refused(told) == {".": " unreadable: cannot be read: No such file or directory"}
    assert one.versions("pendulum") == {1: None}
    shutil.move(one.parts.with_name("away"), one.parts)
    told = one.look()
    assert (files(told), told["waiting"], told["refused"]) == ({"pendulum.yaml": "pendulum@1"}, [], [])


def test_a_look_that_fails_is_made_again(one: Followed, monkeypatch: pytest.MonkeyPatch) -> None:
    one.write("slider.yaml", SLIDER)
    one.look()
    one.write("pendulum.yaml", PENDULUM)
    one.folder.look()
    with monkeypatch.context() as patch:
        patch.setattr(folders, "note", lambda *_: 1 / 0)
        with pytest.raises(ZeroDivisionError):
            one.folder.look()
    one.folder.look()
    assert files(one.told()) == {"pendulum.yaml": "pendulum@1", "slider.yaml": "slider@1"}


def test_what_may_pass_is_tried_again(one: Followed, monkeypatch: pytest.MonkeyPatch) -> None:
    def busy(*_: object, **__: object) -> None:
        raise Refused(503, "restarting", "the server is being stopped")

    one.write("pendulum.yaml", PENDULUM)
    with monkeypatch.context() as patch:
        patch.setattr("service.operations.catalogue.prepare", busy)
        assert refused(one.look()) == {"pendulum.yaml": " restarting: the server is being stopped"}
        assert refused(one.look()) == {"pendulum.yaml": " restarting: the server is being stopped"}
    assert files(one.look()) == {"pendulum.yaml": "pendulum@1"}


def test_what_takes_too_long_is_refused(one: Followed, monkeypatch: pytest.MonkeyPatch) -> None:
    def late(*_: object, **__: object) -> None:
        raise TimeoutError

    one.write("pendulum.yaml", PENDULUM)
    monkeypatch.setattr("service.operations.catalogue.derived", late)
    assert refused(one.look()) == {
        "pendulum.yaml": " took-too-long: to derive it takes longer than 600 s, the limit of a job"
    }


def test_errors_of_the_service_are_told_of_the_file(one: Followed, monkeypatch: pytest.MonkeyPatch) -> None:
    one.write("pendulum.yaml", PENDULUM)
    with monkeypatch.context() as patch:
        patch.setattr("service.operations.sharing.folder.read", lambda *_: 1 / 0)
        assert refused(one.look()) == {"pendulum.yaml": " internal-error: an error in the service: ZeroDivisionError"}
    assert "internal-error" in str(refused(one.look()))  # until it is changed, or the server is started again
    assert files(one.restart()) == {"pendulum.yaml": "pendulum@1"}


def test_servers_share_a_database_and_a_folder(settings: Settings, parts: Path, tmp_path: Path) -> None:
    """Whichever looks first stores; all tell the same."""
    with (
        fresh("postgresql", tmp_path) as address,
        open_store(settings.model_copy(update={"database": address})) as first,
        open_store(settings.model_copy(update={"database": address})) as second,
    ):
        servers = [Followed(first, parts), Followed(second, parts)]
        for mass in (1, 2, 1):
            servers[0].write("pendulum.yaml", heavier(mass))
            at_once(Followed.look, servers)
            told = [each.look() for each in servers]
            assert told[0] == told[1]
            assert files(told[0]) == {"pendulum.yaml": f"pendulum@{mass}"}
        (parts / "pendulum.yaml").unlink()
        at_once(Followed.look, servers)
        assert [each.look()["gone"] for each in servers] == [["pendulum"]] * 2


def test_a_server_follows_in_the_background(
    store: Store, parts: Path, monkeypatch: pytest.MonkeyPatch, caplog: pytest.LogCaptureFixture
) -> None:
    monkeypatch.setattr(following, "POLL", 0.01)
    (parts / "pendulum.yaml").write_bytes(write_yaml(PENDULUM))
    client = make_client(store)
    with following.followed(store):
        assert client.get("/v1/substructures/pendulum").status_code == 200  # at once
        (parts / "slider.yaml").write_bytes(write_yaml(SLIDER))
        _until(lambda: client.get("/v1/substructures/slider").status_code == 200)
        with monkeypatch.context() as patch:
            patch.setattr("service.operations.sharing.folder.listed", lambda *_: 1 / 0)
            time.sleep(0.1)
        assert caplog.text.count("the folder is not read: division by zero") == 1
        (parts / "slider.yaml").unlink()
        _until(lambda: client.get("/v1/substructures/slider").status_code == 404)


def test_without_a_folder(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    with open_store(Settings(database=f"sqlite:///{tmp_path / 'x.db'}", catalogue=False)) as store:
        client = make_client(store)
        with following.followed(store):
            answer = client.get("/v1/folder")
        assert (answer.status_code, answer.json()["code"]) == (404, "no-folder")
        assert "refused" not in client.get("/").text
    database = ("--database", f"sqlite:///{tmp_path / 'y.db'}", "--port", "0")
    assert main(["serve", "--folder", str(tmp_path / "nothing"), *database]) == 1
    assert f"--folder: there is no folder '{tmp_path / 'nothing'}'" in capsys.readouterr().err
    assert not (tmp_path / "y.db").exists()


def _until(condition: Callable[[], bool], seconds: float = 30) -> None:
    end = time.monotonic() + seconds
    while not condition():
        assert time.monotonic() < end
        time.sleep(0.02)


@pytest.fixture(params=["1", "2"])
def server(request: pytest.FixtureRequest, tmp_path: Path, parts: Path) -> Iterator[Server]:
    """By the command line, as one process and as two."""
    settings = ("--folder", str(parts), "--processes", request.param, "--workers", "1")
    one = Server(f"sqlite:///{tmp_path / 'x.db'}", tmp_path / "log", settings)
    (parts / "pendulum.yaml").write_bytes(write_yaml(heavier(1)))
    (parts / "wrong.yaml").write_text("name: [")
    with running([one]):
        yield one


@pytest.mark.deep  # 8 s: processes of their own
def test_a_server_by_the_command_line(server: Server, parts: Path) -> None:
    def latest() -> Any:
        return httpx2.get(f"{server.address}/v1/substructures/pendulum", timeout=30, verify=False).json().get("version")

    def told() -> set[str]:
        """By whichever process answers."""
        return {httpx2.get(f"{server.address}/v1/folder", timeout=30, verify=False).text for _ in range(8)}

    assert latest() == 1
    assert len(told()) == 1
    (parts / "pendulum.yaml").write_bytes(write_yaml(heavier(2)))
    _until(lambda: latest() == 2)
    (parts / "wrong.yaml").unlink()
    _until(lambda: len(found := told()) == 1 and json.loads(found.pop())["refused"] == [])
    log = server.log.read_text()
    assert log.count("refused: wrong.yaml") == 1
    assert log.count("pendulum.yaml: pendulum@2") == 1
