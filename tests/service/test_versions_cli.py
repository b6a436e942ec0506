"""The commands ``versions``, ``diff``, ``uses``, ``withdraw`` and ``publish``, against a server."""

from __future__ import annotations

import json
import re
from collections.abc import Iterator
from pathlib import Path

import pytest

from service.cli.main import main
from service.server import background
from service.settings import Settings
from substructures.client import Client

from .conftest import PENDULUM, TREE


@pytest.fixture(scope="module")
def address(tmp_path_factory: pytest.TempPathFactory) -> Iterator[str]:
    path: Path = tmp_path_factory.mktemp("versions") / "x.db"
    with background(Settings(database=f"sqlite:///{path}", catalogue=False, workers=1)) as found:
        with Client(found) as client:
            client.submit(PENDULUM)
            client.create_tree(TREE)
            heavy = {**PENDULUM["parameters"], "m": {"value": 2.1, "unit": "kg"}}
            client.submit({**PENDULUM, "parameters": heavy, "note": "heavier", "derived_from": "pendulum@1"})
            client.request(
                "POST", "/v1/substructures/pendulum@1/withdraw", {"reason": "light", "successor": "pendulum@2"}
            )
        yield found


def run(address: str, capsys: pytest.CaptureFixture[str], *words: str, code: int = 0) -> str:
    assert main([*words, "--server", address]) == code
    shown = capsys.readouterr()
    return shown.err if code else shown.out


def test_versions_and_their_difference(address: str, capsys: pytest.CaptureFixture[str]) -> None:
    first, second = run(address, capsys, "versions", "pendulum").splitlines()
    assert first.startswith("pendulum@2 ")
    assert first.endswith("of pendulum@1; heavier")
    assert second.endswith("WITHDRAWN (light, take pendulum@2)")
    assert json.loads(run(address, capsys, "versions", "pendulum", "--json"))[0]["version"] == 2
    told = run(address, capsys, "diff", "pendulum@1", "pendulum")
    assert told.splitlines() == [
        "pendulum@1 -> pendulum@2",
        "  parameter m 2 -> 2.1 kg: changes 1 of 1 entries of M, at most 5 %",
    ]
    assert "did you mean 'pendulum'" in run(address, capsys, "diff", "pendulum", "pendulun", code=1)
    for words in (("versions", "cell"), ("diff", "cell@1", "cell")):
        assert "; for trees there is --tree\n" in run(address, capsys, *words, code=1)
    assert "--tree" not in run(address, capsys, "versions", "cel", "--tree", code=1)


def test_nothing_uses_a_part(address: str, capsys: pytest.CaptureFixture[str]) -> None:
    with Client(address) as client:
        client.submit({**PENDULUM, "name": "lone"})
    assert main(["uses", "lone", "--server", address]) == 0
    assert capsys.readouterr() == ("", "nothing uses lone\n")
    assert run(address, capsys, "uses", "lone", "--json") == "[]\n"


def test_what_is_withdrawn_is_shown_where_it_is_used(address: str, capsys: pytest.CaptureFixture[str]) -> None:
    assert "\n  WITHDRAWN: light; take pendulum@2\n" in run(address, capsys, "show", "pendulum@1")
    assert "WITHDRAWN" not in run(address, capsys, "show", "pendulum@2")
    assert main(["show", "cell", "--server", address]) == 0
    assert capsys.readouterr().err == "warning: arm: pendulum@1 is withdrawn: light; take pendulum@2\n"


def test_a_version_is_withdrawn(address: str, capsys: pytest.CaptureFixture[str]) -> None:
    old, new = {**PENDULUM, "name": "old"}, {**PENDULUM, "name": "new"}
    with Client(address) as client:
        client.submit(old)
        client.submit(new)
        client.create_tree({**TREE, "name": "with-old", "instances": [{"name": "arm", "substructure": "old"}]})
    assert "none such" in run(address, capsys, "withdraw", "old@1", "--instead", "none such", code=1)
    told = run(address, capsys, "withdraw", "old@1", "--reason", "too light", "--instead", "new")
    assert told == "old@1 is withdrawn: too light; take new@1\n"
    assert "WITHDRAWN (too light, take new@1)" in run(address, capsys, "versions", "old")
    assert main(["show", "with-old", "--server", address]) == 0
    assert "old@1 is withdrawn: too light; take new@1" in capsys.readouterr().err
    assert json.loads(run(address, capsys, "withdraw", "new@1", "--json"))["is_withdrawn"] is True


def test_a_part_of_which_all_is_withdrawn(address: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    """It is not said to be unknown; reason and successor are told wherever it is asked for."""
    for name in ("gone", "better"):
        with Client(address) as client:
            client.submit({**PENDULUM, "name": name})
    words = ["withdraw", "gone@1", "--reason", "wrong mass", "--instead", "better@1", "--server", address]
    assert main(words) == 0
    expected = "all versions of 'gone' are withdrawn, the last one as gone@1: wrong mass; take better@1"
    for asked in (["show", "gone"], ["tree", "t", "--part", "a=gone"], ["couple", "cell", "gone", "--name", "x"]):
        assert main([*asked, "--server", address]) == 1
        assert expected in re.sub(r"[\s│]+", " ", capsys.readouterr().err)
    assert main(["show", "gone@7", "--server", address]) == 1
    assert "there is no substructure 'gone@7'; the last version is gone@1" in capsys.readouterr().err
    folder = tmp_path / "parts"
    folder.mkdir()
    (folder / "gone.yaml").write_text(json.dumps({**PENDULUM, "name": "gone"}))
    for _ in range(2):
        assert main(["catalogue", "import", str(folder), "--server", address]) == 0
        told = capsys.readouterr().out
        assert "gone@1 already, which is withdrawn" in told
        assert "0 new, 0 changed, 1 same" in told


def test_a_tree_as_a_part(address: str, capsys: pytest.CaptureFixture[str]) -> None:
    words = "publish", "cell", "--name", "module", "--port", "end=arm.tip", "--note", "as one"
    assert run(address, capsys, *words) == "module@1 published: ports end\n"
    assert run(address, capsys, *words) == "module@1 was published already: ports end\n"
    assert "part     module@1    arm @1" in run(address, capsys, "uses", "pendulum")
    assert run(address, capsys, "versions", "cell", "--tree").startswith("cell@1 ")
    assert "nothing differs" in run(address, capsys, "diff", "cell@1", "cell", "--tree")
    wrong = run(address, capsys, "publish", "cell", "--name", "other", "--port", "end=arm.tap", code=1)
    assert "did you mean 'arm.tip'" in wrong
