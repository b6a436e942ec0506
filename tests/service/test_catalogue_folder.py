"""The command ``catalogue``: a folder of YAML files out of a server and into another, and what is told of changes."""

from __future__ import annotations

import json
from collections.abc import Iterator
from pathlib import Path

import pytest

from service.cli.main import main
from service.server import background
from service.settings import Settings
from substructures import Definition, catalogue
from substructures.client import Client
from substructures.documents import read_yaml, write_yaml

from .conftest import PENDULUM, SLIDER


def server(folder: Path, *parts: object) -> Iterator[str]:
    with background(Settings(database=f"sqlite:///{folder}/x.db", catalogue=False)) as address:
        with Client(address) as client:
            for part in parts:
                client.submit(part)
        yield address


@pytest.fixture
def one(tmp_path: Path) -> Iterator[str]:
    (tmp_path / "one").mkdir()
    yield from server(tmp_path / "one", PENDULUM, SLIDER, catalogue.load("scara"))


@pytest.fixture
def other(tmp_path: Path) -> Iterator[str]:
    (tmp_path / "other").mkdir()
    yield from server(tmp_path / "other", PENDULUM)


def call(
    capsys: pytest.CaptureFixture[str], action: str, folder: Path, address: str, *more: str
) -> tuple[int, str, str]:
    code = main(["catalogue", action, str(folder), "--server", address, *more])
    told = capsys.readouterr()
    return code, told.out, told.err


def test_out_of_one_server_and_into_another(
    one: str, other: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    folder = tmp_path / "parts"
    code, out, _ = call(capsys, "export", folder, one)
    assert (code, out.splitlines()[-1]) == (0, "3 new, 0 changed, 0 same")
    before = {path.name: path.read_bytes() for path in folder.iterdir()}
    assert sorted(before) == ["pendulum.yaml", "scara.yaml", "slider.yaml"]
    assert call(capsys, "export", folder, one)[1] == "0 new, 0 changed, 3 same\n"
    assert {path.name: path.read_bytes() for path in folder.iterdir()} == before
    for path in folder.iterdir():  # exactly what it was
        with Client(one) as client:
            version = client.substructure(path.stem)
        assert Definition.read(read_yaml(path.read_bytes())).digest == version["digest"]
    code, out, _ = call(capsys, "import", folder, other, "--owner", "local")
    assert (code, out.splitlines()[-1]) == (0, "2 new, 0 changed, 1 same, 0 gone, 0 refused")
    assert call(capsys, "import", folder, other)[1] == "0 new, 0 changed, 3 same, 0 gone, 0 refused\n"


def test_what_changed_is_told(one: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    folder = tmp_path / "parts"
    call(capsys, "export", folder, one)
    path = folder / "scara.yaml"
    path.write_text(path.read_text().replace("value: 0.325", "value: 0.35"))
    (folder / "slider.yaml").unlink()
    (folder / "bad.yaml").write_text("name: bad\nbodies: 3\n")
    code, out, err = call(capsys, "import", folder, one, "--owner", "local")
    assert code == 1
    assert f"changed: {path} is scara@2" in out
    assert "gone: slider has no file" in out
    assert out.splitlines()[-1] == "0 new, 1 changed, 1 same, 1 gone, 1 refused"
    assert "bad.yaml" in err
    assert "line 2" in err


@pytest.mark.parametrize("name", catalogue.names())
def test_every_shipped_part_is_written_and_read_back_exactly(name: str) -> None:

    definition = Definition.read(catalogue.load(name))
    text = write_yaml(definition.model_dump(exclude_defaults=True, by_alias=True))
    assert Definition.read(read_yaml(text)).digest == definition.digest


def test_what_is_private_stays_so(one: str, other: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    folder = tmp_path / "parts"
    with Client(one) as client:
        client.submit({**PENDULUM, "name": "secret", "visibility": "private"})
    code, out, _ = call(capsys, "export", folder, one)
    told = ["private: 1; their files say so, and 'catalogue import' keeps them so", "4 new, 0 changed, 0 same"]
    assert (code, out.splitlines()[-2:]) == (0, told)
    assert json.loads(call(capsys, "export", folder, one, "--json")[1])["private"] == 1
    assert (folder / "secret.yaml").read_text().startswith("name: secret\nvisibility: private\n")
    assert "visibility" not in (folder / "slider.yaml").read_text()
    assert call(capsys, "import", folder, other)[1].splitlines()[-1] == "3 new, 0 changed, 1 same, 0 gone, 0 refused"
    with Client(other) as client:
        assert client.visibility("secret")["visibility"] == "private"
        assert client.visibility("slider")["visibility"] == "public"
    assert main(["derive", str(folder / "secret.yaml")]) == 0  # and all else that reads files
    assert main(["same", str(folder / "secret.yaml"), str(folder / "pendulum.yaml")]) == 0
    (folder / "cell.json").write_text('{"name": "cell", "instances": [{"name": "a", "substructure": "secret"}]}')
    assert main(["evaluate", str(folder / "cell.json"), "metric"]) == 0


def test_a_whole_folder_that_is_private(
    one: str, other: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    """What the files say or not; and what is public there already does not get a version that all see."""
    folder = tmp_path / "parts"
    call(capsys, "export", folder, one)
    slider = folder / "slider.yaml"
    slider.write_text(slider.read_text().replace("name: slider\n", "name: slider\nvisibility: public\n"))
    pendulum = folder / "pendulum.yaml"
    code, out, _ = call(capsys, "import", folder, other, "--private")
    assert (code, out.splitlines()[-1]) == (0, "2 new, 0 changed, 1 same, 0 gone, 0 refused")
    pendulum.write_text(pendulum.read_text().replace("name: pendulum\n", "name: pendulum\ndescription: changed\n"))
    slider.write_text(slider.read_text() + "description: changed\n")
    code, out, err = call(capsys, "import", folder, other, "--private")
    assert (code, out.splitlines()[-1]) == (1, "0 new, 1 changed, 1 same, 0 gone, 1 refused")
    assert "'pendulum' is public already: what was public stays public" in err
    with Client(other) as client:
        assert {name: client.visibility(name)["visibility"] for name in ("pendulum", "slider", "scara")} == {
            **dict.fromkeys(("slider", "scara"), "private"),
            "pendulum": "public",
        }
        assert client.substructure("pendulum")["version"] == 1
