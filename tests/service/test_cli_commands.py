"""Commands about parts and trees: on a server, on a store of their own, and what they say when something is wrong."""

from __future__ import annotations

import json
import re
import socket
from collections.abc import Iterator
from pathlib import Path

import pytest

from service import keys
from service.cli.main import main
from service.database.connections import Database
from service.queries.keys import list_keys
from service.server import background
from service.settings import Settings
from substructures.client import Client

from .conftest import PENDULUM, TREE


@pytest.fixture(scope="module")
def address(tmp_path_factory: pytest.TempPathFactory) -> Iterator[str]:
    path: Path = tmp_path_factory.mktemp("commands") / "x.db"
    with background(Settings(database=f"sqlite:///{path}", catalogue=False, workers=1)) as found:
        with Client(found) as client:
            client.submit(PENDULUM)
            client.create_tree(TREE)
        yield found


@pytest.fixture
def run(address: str, capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> Runner:
    monkeypatch.setenv("SUBSTRUCTURES_SERVER", address)
    monkeypatch.setenv("XDG_CONFIG_HOME", str(tmp_path))
    return Runner(capsys)


class Runner:
    def __init__(self, capsys: pytest.CaptureFixture[str]) -> None:
        self.capsys = capsys

    def __call__(self, *words: str, code: int = 0) -> str:
        """What is printed, and for another code than 0 what is said of it."""
        found = main(words)
        shown = self.capsys.readouterr()
        assert found == code, shown.err
        return re.sub(r"[\s│]+", " ", shown.err) if code else shown.out


def test_list_search_and_show(run: Runner) -> None:
    assert run("list") == "pendulum@1  1  R  local  Pendulum\n"
    assert run("list", "--tree").startswith("cell@1  1  local  20")
    assert run("search", "pendulun") == run("list")
    assert run("search", "--joints", "P") == ""
    assert json.loads(run("search", "pendulum", "--json"))[0]["name"] == "pendulum"
    assert run("search", "--tree", "--uses", "pendulum").startswith("cell@1")
    assert "bodies: rod" in run("show", "pendulum")
    assert "instances: arm at world" in run("show", "cell")
    assert run("show", "cell", "--drawing").splitlines()[:3] == ["cell@1", "└── world", "    └── arm (pendulum)"]
    assert "metric[1, 1] = " in run("show", "pendulum", "metric")
    assert "arm.l^2*arm.m" in run("show", "cell", "metric", "--form", "expanded")
    assert "metric" in json.loads(run("show", "cell", "metric", "--json"))["outputs"]
    told = run("show", "pendulun", code=1)
    assert "there is no substructure 'pendulun'; did you mean 'pendulum'?" in told
    assert "there is no tree 'pendulun'" in told


def test_pictures_go_to_files(run: Runner, tmp_path: Path) -> None:
    run("show", "cell", "--svg", str(tmp_path / "cell.svg"))
    assert (tmp_path / "cell.svg").read_text().startswith("<svg")


def test_a_tree_grows_and_goes(run: Runner) -> None:
    assert (
        run("tree", "grown", "--part", "a=pendulum", "--gravity", "0,0,-9.81")
        == "grown@1 made: 1 coordinates, a at world\n"
    )
    assert "was there already" in run("tree", "grown", "--part", "a=pendulum", "--gravity", "0,0,-9.81")
    words = "couple", "grown", "pendulum", "--name", "b", "--at", "a.tip", "--set", "l=0.5", "--position", "0,0,0.1"
    made = json.loads(run(*words, "--json"))
    assert (made["revision"], made["instances"][1]["placement"]["position"]) == (2, ["0", "0", "0.1"])
    assert "/at: 'a' has no port or body 'tap'" in run("couple", "grown", "pendulum", "--at", "a.tap", code=1)
    assert "NAME=VALUE is needed, found 'l'" in run("couple", "grown", "pendulum", "--set", "l", code=2)
    assert "X,Y,Z is needed" in run("couple", "grown", "pendulum", "--rpy", "1,2", code=2)
    run("rm", "grown")
    assert "there is no tree 'grown'" in run("rm", "grown", code=1)
    assert run("tree", "grown", "--part", "pendulum").startswith("grown@3 made")  # no number is two trees
    assert "not 'grown@3'" in run("rm", "grown@3", code=1)


def test_faults_that_the_server_finds_have_their_lines(run: Runner, tmp_path: Path) -> None:
    part, tree = tmp_path / "part.yaml", tmp_path / "tree.yaml"
    part.write_text("name: a\nbodies:\n  - {name: b, parent: base, mass: m, joint: {type: revolute, coordinate: q}}\n")
    told = run("submit", str(part), code=1)
    assert f"{part}#/bodies/0/mass: unknown name 'm'" in told
    assert "(line 3, column " in told
    tree.write_text("name: t\ninstances:\n  - {name: a, substructure: pendulum, at: b.tip}\n")
    assert f"{tree}#/instances/0/at: " in run("tree", str(tree), code=1)


def test_numbers_here_and_there(run: Runner, tmp_path: Path) -> None:
    (tmp_path / "cell.json").write_text(json.dumps(TREE))
    (tmp_path / "pendulum.json").write_text(json.dumps(PENDULUM))
    words = "metric", "forces", "kinematics", "christoffel", "--q", "0.3", "--qd", "1", "--set", "arm.m=3"
    there, here = (run("evaluate", tree, *words) for tree in ("cell", str(tmp_path / "cell.json")))
    assert there == here
    assert there.startswith("metric\n  arm.q ")
    answer = json.loads(run("evaluate", "cell", *words, "--json"))
    assert f"{answer['metric'][0][0]:.6g}" in there
    assert "unknown parameter 'arm.mm'" in run("evaluate", "cell", "metric", "--set", "arm.mm=3", code=1)
    assert "numbers between commas" in run("evaluate", "cell", "metric", "--q", "a", code=2)
    assert "did you mean 'metric'" in run("evaluate", "cell", "metrik", code=1)


def test_a_store_without_a_server(
    tmp_path: Path, capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setenv("SUBSTRUCTURES_CATALOGUE", "no")
    url = f"sqlite:///{tmp_path / 'own.db'}"
    (tmp_path / "pendulum.json").write_text(json.dumps(PENDULUM))
    run = Runner(capsys)
    assert "pendulum@1 stored" in run("submit", str(tmp_path / "pendulum.json"), "--database", url)
    database = Database(url, exclusive=False)
    with database.write() as connection:
        keys.create(connection, "somebody's", ["read"])
    assert run("list", "--database", url).startswith("pendulum@1")  # whoever has the file needs no key
    with database.read() as connection:
        assert [key.label for key in list_keys(connection)] == ["somebody's"]
    database.close()
    assert "either --server or --database" in run("list", "--database", url, "--server", "http://127.0.0.1:9", code=1)


def test_address_and_keys_from_a_file(
    address: str, run: Runner, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.delenv("SUBSTRUCTURES_SERVER")
    file = tmp_path / "substructures" / "client.toml"
    file.parent.mkdir()
    file.write_text(f'server = "{address}"\n\n[keys]\n"https://other.example" = "sub_x"\n')
    assert run("list").startswith("pendulum@1")
    file.write_text('sever = "x"')
    assert "'sever' is not known" in run("list", code=1)
    file.write_text("server = ")
    assert "client.toml: " in run("list", code=1)


def test_doctor(run: Runner, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    told = run("doctor")
    assert "the server answers" in told
    assert "there is none yet" in told
    found = {each["subject"]: each for each in json.loads(run("doctor", "--json"))}
    assert not any(each["wrong"] for each in found.values())
    (tmp_path / "substructures.db").write_text("no database")
    assert main(["doctor"]) == 1
    assert "WRONG: sqlite:///substructures.db: " in run.capsys.readouterr().out


def test_parts_between_servers(run: Runner, address: str, tmp_path: Path) -> None:
    other = Settings(
        database=f"sqlite:///{tmp_path / 'other.db'}", catalogue=False, workers=1, mirror_sources=(address,)
    )
    with background(other) as target:
        assert run("pull", address, "pendulum", "--server", target).startswith("pendulum@1 stored, sha256:")
        assert run("push", target, "pendulum@1").startswith("pendulum@1 was stored already")
        run("bundle", "save", str(tmp_path / "parts.zip"), "pendulum")
        assert (
            json.loads(run("bundle", "load", str(tmp_path / "parts.zip"), "--server", target, "--json"))[0]["outcome"]
            == "same"
        )
        content = (tmp_path / "parts.zip").read_bytes()
        (tmp_path / "parts.zip").write_bytes(content.replace(b'"pendulum"', b'"pendulun"'))
        assert "422: " in run("bundle", "load", str(tmp_path / "parts.zip"), "--server", target, code=1)
        assert "there is no substructure 'nothing'" in run("pull", address, "nothing", "--server", target, code=1)
        run("mirror", address, "--wait", "--server", target)
        assert "SUBSTRUCTURES_MIRROR_SOURCES" in run("mirror", "http://127.0.0.1:10", "--server", target, code=1)


def test_upgrade(tmp_path: Path, capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("SUBSTRUCTURES_CATALOGUE", "no")
    url, run = f"sqlite:///{tmp_path / 'x.db'}", Runner(capsys)
    (tmp_path / "pendulum.json").write_text(json.dumps(PENDULUM))
    run("submit", str(tmp_path / "pendulum.json"), "--database", url)
    told = run("upgrade", "--database", url)
    assert told.splitlines()[-1] == "1 looked at, 0 could not be derived"
    assert json.loads(run("upgrade", "--database", url, "--json"))[0]["what"] == "substructure pendulum@1"


def test_a_port_in_use_makes_no_store(tmp_path: Path, run: Runner, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("service.logs.configure", lambda: None)
    with socket.create_server(("127.0.0.1", 0)) as taken:
        port = str(taken.getsockname()[1])
        told = run("serve", "--port", port, "--database", f"sqlite:///{tmp_path / 'new.db'}", code=1)
    assert "Address already in use; is another server running?" in told
    assert list(tmp_path.iterdir()) == []
