"""The documentation is a promise: every page's requests, commands, dialogues and scripts are run as they stand there.

Of a page, in its order: a ``yaml`` block behind "Save as `FILE`" is written to that file; of ``sh`` blocks the requests
and the commands of ours are run; in ``console`` blocks every line is what the command prints; ``python`` scripts run.
"""

from __future__ import annotations

import json
import re
import shlex
import shutil
import subprocess
import sys
from collections.abc import Iterator
from pathlib import Path

import pytest
import reference_pages

from service.cli.main import COMMANDS, main
from service.server import background
from service.settings import Settings

ROOT = Path(__file__).parent.parent
README = ROOT / "README.md"
PAGES = [README, *sorted((ROOT / "docs").rglob("*.md"))]
GUIDES = [page for page in PAGES if page.parent.name in ("tutorial", "how-to") and "```" in page.read_text()]
RUN = [README, *GUIDES]
ADDRESS = "http://127.0.0.1:8000"
BLOCK = re.compile(
    r"(?:Save\s+as\s+`(?P<file>[\w.-]+)`:\n\n)?^```(?P<language>\w+)\n(?P<text>.*?)^```$", re.DOTALL | re.MULTILINE
)
LINK = re.compile(r"\]\(([^)#\s]+)(?:#[\w-]*)?\)")
#: of the set-up, which tests of the clone and of the wheel run
SET_UP = ("python3 -m venv", ". .venv/bin/activate")


@pytest.fixture(scope="module")
def address(tmp_path_factory: pytest.TempPathFactory) -> Iterator[str]:
    path = tmp_path_factory.mktemp("docs") / "store.db"
    with background(Settings(database=f"sqlite:///{path}")) as found:
        yield found


@pytest.fixture
def folder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """An empty folder to work in, with the files of the clone that pages name."""
    (tmp_path / "substructures").symlink_to(ROOT / "substructures")
    monkeypatch.chdir(tmp_path)
    return tmp_path


@pytest.mark.skipif(shutil.which("curl") is None, reason="the requests of the pages need curl")
@pytest.mark.parametrize("page", RUN, ids=lambda page: page.stem)
def test_page(
    page: Path, address: str, folder: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.setenv("SUBSTRUCTURES_SERVER", address)
    for block in BLOCK.finditer(page.read_text()):
        text, language = block["text"].replace(ADDRESS, address), block["language"]
        if language == "yaml":
            (folder / block["file"]).write_text(text)
        elif language == "sh":
            for line in commands(text):
                run_command(line)
        elif language == "console":
            dialogue(text, capsys)
        elif language == "python":
            script(text, folder)
        elif language == "json":  # what the request before answers, shortened
            shown = {name: value for name, value in json.loads(text).items() if name != "..."}
            said = json.loads((folder / "answer").read_text())
            assert shown == {name: said[name] for name in shown}
        else:
            assert language == "matlab", language


def commands(text: str) -> list[str]:
    """The commands of a block, each on a line or, quoted, on several."""
    found: list[str] = []
    for line in text.splitlines():
        if found and (found[-1].endswith("\\") or found[-1].count("'") % 2):
            found[-1] += f"\n{line}"
        else:
            found.append(line)
    return found


def run_command(line: str) -> None:
    """A request or a command of ours; anything but success fails."""
    if line.startswith("curl -sS "):
        done = subprocess.run(
            ["/bin/bash", "-c", f"{line} --fail-with-body"], capture_output=True, text=True, check=False
        )
        assert done.returncode == 0, f"{line}\n{done.stdout}{done.stderr}"
        Path("answer").write_text(done.stdout)
    elif line.startswith("substructures "):
        assert main(shlex.split(line)[1:]) == 0, line
    else:
        assert line.startswith(SET_UP), line


def dialogue(text: str, capsys: pytest.CaptureFixture[str]) -> None:
    """Every line is what the command prints, where some are shown; ``| grep PATTERN`` is done here."""
    capsys.readouterr()
    for command, *expected in (part.splitlines() for part in text.split("$ substructures ")[1:]):
        words, _, pattern = command.partition(" | grep ")
        assert main(shlex.split(words)) == 0, command
        shown = capsys.readouterr().out.splitlines()
        if pattern:
            shown = [line for line in shown if re.search(shlex.split(pattern)[0], line)]
        assert not expected or shown == expected, command


def script(text: str, folder: Path) -> None:
    """A script, in a process of its own."""
    (folder / "example.py").write_text(text)
    done = subprocess.run([sys.executable, "example.py"], capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stderr
    assert done.stdout


@pytest.mark.parametrize("page", PAGES, ids=lambda page: str(page.relative_to(ROOT)))
def test_links_lead_somewhere(page: Path) -> None:
    for link in LINK.findall(page.read_text()):
        assert "://" in link or (page.parent / link).exists(), link


@pytest.mark.parametrize("page", [*PAGES, ROOT / "CHANGELOG.md"], ids=lambda page: str(page.relative_to(ROOT)))
def test_lines_can_be_read(page: Path) -> None:
    """But for tables and what is copied to a terminal."""
    text = re.sub(r"^ *```.*?^ *```$", "", page.read_text(), flags=re.DOTALL | re.MULTILINE)
    assert not [line for line in text.splitlines() if len(line) > 120 and not line.startswith(("|", "    "))]


def test_the_index_names_every_page() -> None:
    index = (ROOT / "docs" / "index.md").read_text() + (ROOT / "docs" / "reference" / "http" / "index.md").read_text()
    assert not [page.name for page in PAGES[1:] if page.name != "index.md" and page.name not in index]


def test_the_readme_is_read_in_two_minutes() -> None:
    assert len(README.read_text().split()) <= 750


@pytest.mark.parametrize("name", reference_pages.PAGES)
def test_reference_pages_are_true(name: str) -> None:
    """``PYTHONPATH=tests/tools python tests/reference_pages.py`` writes them."""
    assert (reference_pages.FOLDER / name).read_text() == reference_pages.PAGES[name]()


def test_help_of_a_command_that_is_kept_is_shown_at_once() -> None:
    command = [sys.executable, "-m", "service.cli.main", "serve", "--help"]
    done = subprocess.run(command, capture_output=True, text=True, check=False, timeout=60)
    assert done.returncode == 0, done.stderr
    assert "Usage: substructures serve" in done.stdout


@pytest.mark.parametrize("page", PAGES, ids=lambda page: str(page.relative_to(ROOT)))
def test_commands_that_are_named_exist(page: Path) -> None:
    named = set(re.findall(r"`substructures ([a-z]+)", page.read_text()))
    assert named <= {command.name for command in COMMANDS}
