"""The reference pages that are made of the program: the command line, the settings, what goes together.

``PYTHONPATH=tests/tools python tests/reference_pages.py`` writes them; a test compares them with what is there.
"""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path
from textwrap import wrap
from typing import Any

import tied_combinations
from pydantic import BaseModel

from service.cli.main import COMMANDS, loaded
from service.settings import Limits, Settings

FOLDER = Path(__file__).parent.parent / "docs" / "reference"
SERVER = ("server", "key", "database")  # options of most commands, told once


def command_line() -> str:
    """All commands with their arguments and options."""
    lines = [
        "# The command line",
        "",
        "`substructures COMMAND --help` says the same; `--install-completion` teaches the shell commands and names.",
        "Commands that talk to a server take `--server URL` (`http://127.0.0.1:8000`; `SUBSTRUCTURES_SERVER`),",
        "`--key KEY` (`SUBSTRUCTURES_KEY`), or `--database URL` for the store itself. Exit codes: 0 done, 1 not done,",
        "2 called wrongly, 3 some items of a job failed, 4 all did, 5 it was cancelled, 6 items were skipped.",
    ]
    panel = ""
    for command in COMMANDS:
        if command.panel != panel:
            panel = command.panel
            lines += ["", f"## {panel}"]
        found = loaded(command.name)
        lines += ["", f"### {command.name}", "", _sentence(command.text)]
        for name, each in getattr(found, "commands", {command.name: found}).items():
            lines += list(_command(each, command.name if each is found else f"{command.name} {name}"))
    return "\n".join(lines) + "\n"


def _command(command: Any, name: str) -> Iterator[str]:
    shown = [each for each in command.params if each.name not in (*SERVER, "help")]
    words = [_argument(each) for each in shown if each.param_type_name == "argument"]
    yield from ("", f"`substructures {' '.join((name, *words))}`")
    if " " in name:
        yield from ("", *wrap(_sentence((command.help or "").split("\b")[0]), 118))
    options = [each for each in shown if each.param_type_name == "option" and not each.hidden]
    if options:
        yield ""
    for each in options:
        yield from wrap(f"* `{', '.join(each.opts)}`: {_sentence(each.help or '')}", 118, subsequent_indent="  ")


def _argument(argument: Any) -> str:
    word = (argument.metavar or argument.name).upper()
    word = f"{word} ..." if argument.nargs != 1 else word
    return word if argument.required else f"[{word}]"


def _sentence(text: str) -> str:
    flat = " ".join(text.split()).rstrip(".")
    return f"{flat[:1].upper()}{flat[1:]}."


def settings() -> str:
    """All settings and limits."""
    lines = [
        "# Settings",
        "",
        "Each is an environment variable `SUBSTRUCTURES_<NAME>`; `host`, `port`, `database`, `processes`, `engine`,",
        "`engine_address`, `workers` and `folder` are options of `substructures serve`, too. Lists are separated by",
        "commas.",
        "",
        *_table(Settings, "SUBSTRUCTURES_"),
        "",
        "## Limits",
        "",
        "`GET /v1/limits` shows those of a server.",
        "",
        *_table(Limits, "SUBSTRUCTURES_LIMIT_"),
    ]
    return "\n".join(lines) + "\n"


def _table(model: type[BaseModel], prefix: str) -> Iterator[str]:
    yield from ("| variable | default | |", "|---|---|---|")
    for name, field in model.model_fields.items():
        if name != "limits":
            default = field.default
            text = ",".join(default) if isinstance(default, tuple) else str(default)
            yield f"| `{prefix}{name.upper()}` | {f'`{text}`' if text else ''} | {field.description} |"


PAGES = {"command-line.md": command_line, "settings.md": settings, "combinations.md": tied_combinations.page}

if __name__ == "__main__":
    for page, made in PAGES.items():
        (FOLDER / page).write_text(made())
