"""Options that commands share, and documents that they read."""

from __future__ import annotations

import argparse
import os
import re
import sys
from collections.abc import Callable, Iterator, Mapping
from contextlib import contextmanager
from dataclasses import replace
from pathlib import Path
from typing import IO, Any

from service.settings import Settings, from_environment
from substructures.documents import places, read_json, read_yaml
from substructures.errors import Fault, InvalidInput

#: endings of documents, in which places are found by line and column
DOCUMENTS = (".yaml", ".yml", ".json")
_TOLD = re.compile(r"\(line \d+, column \d+\)$")
SERVER = "http://127.0.0.1:8000"

CommandFunction = Callable[[argparse.Namespace], int]
#: adds the arguments of commands to their parsers, by name of the command
Add = Mapping[str, Callable[[argparse.ArgumentParser], None]]


def add_action(actions: Any, name: str, run: CommandFunction, text: str) -> argparse.ArgumentParser:
    """One more action of a command that is a group of them."""
    command: argparse.ArgumentParser = actions.add_parser(name, help=text, description=text)
    command.set_defaults(command=run)
    return command


def add_server(command: argparse.ArgumentParser) -> None:
    """The options of every command that talks to a server."""
    command.add_argument("--server", default=SERVER, help=f"address ({SERVER})")
    command.add_argument("--key", default=os.environ.get("SUBSTRUCTURES_KEY"), help="API key ($SUBSTRUCTURES_KEY)")


def tell_warnings(told: Mapping[str, Any]) -> None:
    """Print the warnings of an answer with their places, to the stream of errors."""
    for warning in told.get("warnings", ()):
        print(f"warning: {warning['pointer'] or '/'}: {warning['message']}", file=sys.stderr)


def add_database(command: argparse.ArgumentParser) -> None:
    """The option of every command that works on a database."""
    default = Settings().database
    command.add_argument("--database", help=f"URL: sqlite:///FILE or postgresql://... ({default})")


def settings_of(options: argparse.Namespace) -> Settings:
    """Settings from the environment, with those of the command line in their place. Raises SettingsError."""
    names = ("host", "port", "database", "engine", "engine_address", "workers", "processes")
    return from_environment(os.environ, **{name: getattr(options, name, None) for name in names})


def read_document(path: Path) -> Any:
    """A document in JSON or YAML. Raises InvalidDocument naming the file."""
    with path.open("rb") as file, named(path):
        return read_from(path, file)


def read_from(path: Path, file: IO[bytes]) -> Any:
    """A document in JSON or YAML, by the ending of its name. Raises InvalidDocument."""
    return read_json(file.read()) if path.suffix == ".json" else read_yaml(file.read())


@contextmanager
def named(path: Path) -> Iterator[None]:
    """Put the name of the file before the pointers of its faults, and line and column behind what they say. Raises
    InvalidDocument.
    """
    try:
        yield
    except InvalidInput as error:
        known = places(path.read_bytes()) if path.suffix in DOCUMENTS else {}
        faults = [replace(fault, message=fault.message + _where(fault, known)) for fault in error.faults]
        moved = type(error)(faults)
        raise moved.moved(lambda pointer: f"{path}#{pointer}" if pointer else str(path)) from None


def _where(fault: Fault, known: Mapping[str, tuple[int, int]]) -> str:
    """Line and column of the innermost place there is of a pointer; nothing where the fault says it itself."""
    pointer = fault.pointer
    while pointer and pointer not in known:
        pointer = pointer.rpartition("/")[0]
    if _TOLD.search(fault.message) or not fault.pointer or pointer not in known:
        return ""
    return " (line {}, column {})".format(*known[pointer])
