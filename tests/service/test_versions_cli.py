"""The commands ``versions``, ``diff``, ``uses`` and ``publish``, against a server."""

from __future__ import annotations

import json
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
            client.request("POST", "/v1/substructures/pendulum@1/yank", {"reason": "light", "successor": "pendulum@2"})
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


def test_a_tree_as_a_part(address: str, capsys: pytest.CaptureFixture[str]) -> None:
    words = "publish", "cell", "--name", "module", "--port", "end=arm.tip", "--note", "as one"
    assert run(address, capsys, *words) == "module@1 published: ports end\n"
    assert run(address, capsys, *words) == "module@1 was published already: ports end\n"
    assert "part     module@1    arm @1" in run(address, capsys, "uses", "pendulum")
    assert run(address, capsys, "versions", "cell", "--tree").startswith("cell@1 ")
    assert "nothing differs" in run(address, capsys, "diff", "cell@1", "cell", "--tree")
    wrong = run(address, capsys, "publish", "cell", "--name", "other", "--port", "end=arm.tap", code=1)
    assert "did you mean 'arm.tip'" in wrong
