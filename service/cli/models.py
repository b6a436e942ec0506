"""Definitions in files of any kind: JSON, YAML, or a robot file by its content, whose readers are imported then."""

from __future__ import annotations

from importlib import import_module
from pathlib import Path
from typing import TYPE_CHECKING, Any

from service.cli.documents import read_document
from service.cli.output import tell_warnings
from substructures.interchange.files.content import is_foreign

if TYPE_CHECKING:
    from substructures.interchange.importing import Imported

ROBOTS = "service.cli.commands.robots"


def read_definition(path: Path) -> Any:
    """A definition as plain data, also out of a robot file; its warnings are told. Raises InvalidDocument."""
    content = path.read_bytes()
    if not is_foreign(content):
        return read_document(path, content)
    found = imported(path)
    remarks = [{"pointer": r["place"], "message": r["message"]} for r in found.report if r["level"] == "warning"]
    tell_warnings({"warnings": remarks})
    return found.definition


def imported(path: Path) -> Imported:
    """A robot file, read. Raises InvalidDocument."""
    found: Imported = import_module(ROBOTS).read_robot_file(path)
    return found
