"""Versions between two servers, by each way that there is: numbers, holes, withdrawals and conflicts."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from contextlib import ExitStack
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import pytest

from service.cli.main import main
from service.server import background
from service.settings import Settings
from substructures.client import Client, ProblemError

from .conftest import PENDULUM

WAYS = ("pull", "push", "bundle", "mirror")
Shown = tuple[int, str, str]


@dataclass
class Two:
    """Two servers that run: ``there`` has the versions that ``here`` gets."""

    way: str
    there: Client
    here: Client
    carry: Callable[[str], Shown]

    def versions(self) -> list[tuple[int, str]]:
        """Numbers and digests here, the newest first."""
        return [(each["version"], each["digest"]) for each in self.here.versions("many")]


def titled(client: Client, title: str) -> str:
    """The digest of another version of the part."""
    return str(client.submit({**PENDULUM, "name": "many", "title": title})[0]["digest"])


@pytest.fixture(params=WAYS)
def two(
    request: pytest.FixtureRequest,
    tmp_path: Path,
    capsys: pytest.CaptureFixture[str],
    monkeypatch: pytest.MonkeyPatch,
) -> Iterator[Two]:
    way: str = request.param
    monkeypatch.setenv("XDG_CONFIG_HOME", str(tmp_path))
    with ExitStack() as stack:

        def server(name: str, **settings: Any) -> str:
            found = Settings(database=f"sqlite:///{tmp_path / name}.db", catalogue=False, **settings)
            return stack.enter_context(background(found))

        there = server("there", engine="none")
        runs: dict[str, Any] = {"workers": 1} if way == "mirror" else {"engine": "none"}
        here = server("here", mirror_sources=(there,), **runs)

        def carry(ref: str) -> Shown:
            """Bring a version of ``there``; a mirror brings the latest one, whatever is named."""
            file = str(tmp_path / "parts.zip")
            commands = {
                "pull": [["pull", there, ref, "--server", here]],
                "push": [["push", here, ref, "--server", there]],
                "bundle": [
                    ["bundle", "save", file, ref, "--server", there],
                    ["bundle", "load", file, "--server", here],
                ],
                "mirror": [["mirror", there, "--server", here]],
            }
            code = [main(words) for words in commands[way]][-1]
            shown = capsys.readouterr()
            return code, shown.out, shown.err

        clients = [stack.enter_context(Client(address)) for address in (there, here)]
        yield Two(way, *clients, carry)


def test_numbers_mean_the_same_on_both(two: Two) -> None:
    """A hole stays one, an older version is not the newest, and a number that means something else is refused."""
    digests = [titled(two.there, f"{k}") for k in (1, 2, 3)]
    assert two.carry("many@3")[0] == 0
    assert two.versions() == [(3, digests[2])]
    with pytest.raises(ProblemError, match="many@3") as refused:  # which it names in place of the hole
        two.here.substructure("many@1")
    assert refused.value.status == 404

    two.there.withdraw("many@3", "wrong mass", successor="many@2")
    assert two.carry("many@2")[0] == 0
    assert two.versions() == [(3, digests[2]), (2, digests[1])]
    assert two.here.substructure("many")["version"] == 3  # each server withdraws for itself
    two.here.withdraw("many@3", "wrong mass", successor="many@2")
    assert two.carry("many@3")[0] == 0
    assert two.here.substructure("many")["version"] == 2  # what is withdrawn here is not offered again

    own, other = titled(two.here, "own"), titled(two.there, "other")
    assert [two.here.substructure("many")["version"], two.there.substructure("many")["version"]] == [4, 4]
    before = two.versions()
    code, out, err = two.carry("many@4")
    assert (code, "0 stored, 0 same, 1 refused" in out) == ((0, True) if two.way == "mirror" else (1, False))
    said = "".join(err.replace("│", "").split())  # as wide as the terminal is
    assert own in said
    assert other in said
    assert two.versions() == before


@pytest.mark.parametrize("two", ["mirror"], indirect=True)
def test_a_mirror_is_found_by_its_label(two: Two) -> None:
    """Where it runs, by each word of it, and nowhere else."""
    titled(two.there, "1")
    labels = {"study": "night", "arm": "long"}
    request = {"kind": "mirror", "items": [{"source": two.there.address}], "labels": labels}
    made = two.here.wait(two.here.submit_job(request)["id"])
    assert made["label"] == "study:night arm:long"
    for label in ("study:night", "arm:long", made["label"]):
        assert [each["id"] for each in two.here.jobs(label=label)] == [made["id"]]
    assert not list(two.here.jobs(label="study:day"))
    assert not list(two.there.jobs(label="study:night"))
