"""Commands about parts and trees: on a server, on a store of their own, and what they say when something is wrong."""

from __future__ import annotations

import json
import re
import socket
import sqlite3
from collections.abc import Iterator
from contextlib import closing
from pathlib import Path

import pytest

from service.cli.main import main
from service.database.connections import Database
from service.queries.keys import list_keys
from service.server import background
from service.settings import Settings
from service.store import keys
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
    assert main(["search", "--joints", "P"]) == 0
    assert run.capsys.readouterr() == ("", "no part is found\n")
    assert run("search", "--joints", "P", "--json") == "[]\n"
    assert json.loads(run("search", "pendulum", "--json"))[0]["name"] == "pendulum"
    assert run("search", "--tree", "--uses", "pendulum").startswith("cell@1")
    assert "bodies: rod" in run("show", "pendulum")
    assert "instances: arm at world" in run("show", "cell")
    assert run("show", "cell", "--drawing").splitlines()[:3] == ["cell@1", "└── world", "    └── arm (pendulum)"]
    assert "metric[1, 1] = " in run("show", "pendulum", "metric")
    assert "l^2*m" in run("show", "cell", "metric", "--form", "expanded")
    assert "metric" in json.loads(run("show", "cell", "metric", "--json"))["outputs"]
    told = run("show", "pendulun", code=1)
    assert "there is no substructure 'pendulun'; did you mean 'pendulum'?" in told
    assert "there is no tree 'pendulun'" in told


def test_frames_of_formulas_are_named(run: Runner) -> None:
    assert run("show", "cell", "position").startswith("# frames: 1 arm.base, 2 arm.rod, 3 arm.tip\n")
    assert run("show", "cell", "metric").startswith("#")
    assert "frames" not in run("show", "cell", "metric")
    json.loads(run("show", "cell", "position", "--json"))


def test_pictures_go_to_files(run: Runner, tmp_path: Path) -> None:
    run("show", "cell", "--svg", str(tmp_path / "cell.svg"))
    assert (tmp_path / "cell.svg").read_text().startswith("<svg")


def test_commands_that_change_answer_programs(run: Runner, tmp_path: Path) -> None:
    run("tree", "gone", "--part", "a=pendulum")
    assert json.loads(run("rm", "gone", "--json")) == {"removed": ["gone"]}
    file = tmp_path / "x.zip"
    told = json.loads(run("bundle", "save", str(file), "pendulum", "--json"))
    assert told == {"file": str(file), "bytes": file.stat().st_size}


def test_a_parameter_that_is_no_number(run: Runner) -> None:
    told = " ".join(run("evaluate", "cell", "metric", "--set", "arm.m=heavy", code=2).replace("│", " ").split())
    assert "a number is needed for 'arm.m', in SI units or with its unit, as in arm.m='500 mm'; found 'heavy'" in told


@pytest.mark.parametrize("mass", ["500 g", "500g", "0.5"])
def test_parameters_may_have_units(run: Runner, mass: str) -> None:
    found = json.loads(run("evaluate", "cell", "metric", "--set", f"arm.m={mass}", "--set", "arm.l=2", "--json"))
    assert found["metric"] == [[pytest.approx(0.5 * 4 * 1.1)]]
    told = run("evaluate", "cell", "metric", "--set", "arm.m=500 gg", code=1)
    assert "the unit 'gg' is not known; did you mean 'g'?" in told


def test_parts_are_coupled_with_parameters_in_units(run: Runner) -> None:
    run("tree", "measured", "--part", "a=pendulum")
    place = ("--at", "a.tip", "--position", "0, 0, 5 cm")
    run("couple", "measured", "pendulum", "--name", "b", *place, "--set", "l=500 mm")
    tree = json.loads(run("show", "measured", "--json"))
    assert tree["instances"][1]["placement"]["position"] == ["0", "0", {"value": "5", "unit": "cm"}]
    assert tree["instances"][1]["parameters"] == {"l": {"value": "500", "unit": "mm"}}
    run("rm", "measured")


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
    assert "has no parameter 'foo'; there are " in run("couple", "grown", "pendulum", "--set", "foo=1", code=1)
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
        counts = run("mirror", address, "--server", target).splitlines()[-1]
        assert counts == f"1 parts at {address}: 0 stored, 1 same, 0 refused"
        assert "progress" in json.loads(run("mirror", address, "--json", "--server", target))
        assert "SUBSTRUCTURES_MIRROR_SOURCES" in run("mirror", "http://127.0.0.1:10", "--server", target, code=1)


def test_what_a_mirror_may_not_store_is_named(run: Runner, address: str, tmp_path: Path) -> None:
    other = Settings(
        database=f"sqlite:///{tmp_path / 'other.db'}",
        catalogue=False,
        workers=1,
        key_seconds=0,
        mirror_sources=(address,),
    )
    with background(other) as target:
        with Client(target) as client:
            client.submit({**PENDULUM, "title": "Another"})
        database = Database(other.database, exclusive=False)
        with database.write() as connection:
            key = keys.create(connection, "", ("read", "write", "jobs"), None, "bolt")
        database.close()
        assert main(["mirror", address, "--server", target, "--key", key]) == 0
        shown = run.capsys.readouterr()
    assert shown.out.splitlines()[-1] == f"1 parts at {address}: 0 stored, 0 same, 1 refused"
    assert "refused: pendulum: the name 'pendulum' of a substructure belongs to 'local'" in shown.err


def test_private_parts_become_public_only_on_purpose(run: Runner, tmp_path: Path) -> None:
    names = [f"secret-{k}" for k in range(7)]
    told = "secret-0, secret-1, secret-2, secret-3, secret-4, ... (7 in all); "
    ours, theirs = (Settings(database=f"sqlite:///{tmp_path / name}.db", catalogue=False, workers=1) for name in "ab")
    with background(ours) as one, background(theirs) as other, Client(one) as client, Client(other) as receiver:
        for name in names:
            client.submit({**PENDULUM, "name": name, "visibility": "private"})
        client.submit(PENDULUM)
        for words in (("pull", one, "--server", other), ("push", other, "--server", one)):
            shown = run(*words, "pendulum", *names, code=1)
            assert f"private parts: {told}--private keeps them so, --public shows" in shown
        assert list(receiver.substructures()) == []
        run("pull", one, "secret-0@1,secret-1@1", "--private", "--server", other)
        run("push", other, "secret-2", "--public", "--server", one)
        assert [receiver.visibility(name)["visibility"] for name in names[:3]] == ["private", "private", "public"]
        assert main(["bundle", "save", str(tmp_path / "parts.zip"), *names, "--server", one]) == 0
        assert f"warning: private: {told}whoever loads the file makes them public" in run.capsys.readouterr().err
        assert main(["bundle", "save", str(tmp_path / "parts.zip"), "pendulum", "--server", one]) == 0
        assert run.capsys.readouterr().err == ""


def test_keys_that_do_not_do_come_with_a_remedy(run: Runner, tmp_path: Path) -> None:
    settings = Settings(database=f"sqlite:///{tmp_path / 'keyed.db'}", catalogue=False, workers=1)
    with background(settings) as address:
        database = Database(settings.database, exclusive=False)
        with database.write() as connection:
            keys.create(connection, "", ["read"])
            old = keys.create(connection, "", ["read"])
            keys.revoke(connection, old.split("_")[1])
        database.close()
        told = run("list", "--server", address, code=1)
        assert "; give it by --key KEY, or the variable SUBSTRUCTURES_KEY" in told
        for wrong in ("schl\u00fcssel", "sub_a\n"):
            assert "this is no key of a server" in run("list", "--server", address, "--key", wrong, code=1)
        told = run("list", "--server", address, "--key", old, code=1)
        assert "ask whoever runs the server for a new one ('substructures key create') and give it by --key" in told
        told = run("pull", address, "pendulum", code=1)
        assert "; give it by --other-key KEY, or the variable SUBSTRUCTURES_OTHER_KEY" in told


def test_addresses_that_do_not_do_come_with_a_remedy(run: Runner, address: str) -> None:
    plain = address.removeprefix("http://")
    assert f"begins with http:// or https://: write {address} " in run("list", "--server", plain, code=1)
    assert f"write {address} " in run("pull", plain, "pendulum", code=1)
    told = run("pull", f"{address}/v1/substructures", "pendulum", code=1)
    assert f"'{address}/v1/substructures' should be the address of such a server, as in http://127" in told
    told = run("pull", f"https://{plain}", "pendulum", code=1)
    assert f"nothing answers at https://{plain}: is this the URL of the other server, and does it run?" in told
    assert "without TLS it begins with http://" in told
    told = run("list", "--server", f"https://{plain}", code=1)
    assert f"nothing answers at https://{plain}; " in told
    assert "without TLS an address begins with http://" in told


@pytest.mark.parametrize(
    ("words", "expected"),
    [
        (
            ["--server", "http://127.0.0.1:9", "list"],
            "--server before the command; it stands behind: substructures list",
        ),
        (["--json", "jobs", "list"], "it stands behind: substructures jobs list --json"),
        (["jobs", "--key=x", "show"], "it stands behind: substructures jobs show --key"),
        (["--database", "sqlite:///x.db", "key", "list"], "it stands behind: substructures key list --database"),
        (["--json"], "it stands behind: substructures list --json"),
        (["--set", "a=1"], "it stands behind: substructures couple --set"),
        (["--nothing", "list"], "No such option: --nothing "),
        (["list", "--nothing"], "No such option: --nothing "),
    ],
)
def test_options_before_the_command(run: Runner, words: list[str], expected: str) -> None:
    told = run(*words, code=2)
    assert expected in told
    assert ("behind" in told) == ("behind" in expected)


def test_upgrade(tmp_path: Path, capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("SUBSTRUCTURES_CATALOGUE", "no")
    url, run = f"sqlite:///{tmp_path / 'x.db'}", Runner(capsys)
    (tmp_path / "pendulum.json").write_text(json.dumps(PENDULUM))
    run("submit", str(tmp_path / "pendulum.json"), "--database", url)
    told = run("upgrade", "--database", url)
    assert told.splitlines()[-1] == "1 looked at, 0 could not be derived"
    assert json.loads(run("upgrade", "--database", url, "--json"))[0]["what"] == "substructure pendulum@1"


def test_a_port_in_use_makes_no_store(tmp_path: Path, run: Runner) -> None:
    with socket.create_server(("127.0.0.1", 0)) as taken:
        port = str(taken.getsockname()[1])
        told = run("serve", "--port", port, "--database", f"sqlite:///{tmp_path / 'new.db'}", code=1)
    assert "Address already in use; is another server running?" in told
    assert list(tmp_path.iterdir()) == []


def test_a_tree_is_not_emptied_by_its_name(run: Runner) -> None:
    told = run("tree", "cell", code=2)
    assert "'substructures show cell' shows a tree, 'couple cell PART' goes on with it" in told
    assert run("tree", "again", "--part", "pendulum").startswith("again@1 made: ")
    told = run("tree", "again", "--part", "other=pendulum")
    assert told.startswith("again@2 made in place of again@1, which stays: ")
    run("rm", "again")


@pytest.mark.parametrize("words", [("key", "list"), ("key", "revoke", "x"), ("verify",), ("upgrade",)], ids=" ".join)
def test_what_reads_a_store_makes_none(run: Runner, words: tuple[str, ...], tmp_path: Path) -> None:
    told = run(*words, "--database", f"sqlite:///{tmp_path / 'typo.db'}", code=1)
    assert "there is no database" in told
    assert "substructures serve" in told
    assert not list(tmp_path.glob("typo*"))


@pytest.mark.parametrize("words", ["key list", "key create", "verify", "upgrade", "doctor", "list", "backup COPY"])
def test_what_is_no_store_stays_as_it_is(run: Runner, words: str, tmp_path: Path) -> None:
    notes, other = tmp_path / "notes.txt", tmp_path / "other.db"
    notes.write_text("of somebody")
    with closing(sqlite3.connect(other)) as connection:
        connection.execute("CREATE TABLE bookmarks (url)")
    before = {path: (path.read_bytes(), path.stat().st_mode) for path in (notes, other)}
    given = words.replace("COPY", str(tmp_path / "copy")).split()
    for path, fault in ((notes, "file is not a database"), (other, "is a database of something else")):
        assert main([*given, "--database", f"sqlite:///{path}"]) == 1
        told = " ".join("".join(run.capsys.readouterr()).split())
        assert fault in told
        assert "name the file of a store" in told
    assert {path: (path.read_bytes(), path.stat().st_mode) for path in tmp_path.iterdir() if path.is_file()} == before


def test_a_store_that_is_begun_with_a_key_is_private(run: Runner, tmp_path: Path) -> None:
    path = tmp_path / "new.db"
    assert run("key", "create", "--database", f"sqlite:///{path}").startswith("sub_")
    assert path.stat().st_mode & 0o077 == 0


def test_an_option_counts_more_than_a_variable(run: Runner, tmp_path: Path) -> None:
    """SUBSTRUCTURES_SERVER is set, and the store is asked."""
    url = f"sqlite:///{tmp_path / 'own.db'}"
    Database(url).close()
    assert "pendulum@1  1  R  local" not in run("list", "--database", url)
    assert "either --server or --database" in run("list", "--database", url, "--server", "http://127.0.0.1:1", code=1)
