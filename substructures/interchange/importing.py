"""The bytes of a foreign file to a definition, with the report of what became of everything in it."""

from __future__ import annotations

import hashlib
from dataclasses import dataclass
from typing import Any

from substructures.interchange.as_part import Options, as_part
from substructures.interchange.kinds import read_robot

#: most characters of the name of a file that are kept
_LONGEST = 200


@dataclass(frozen=True)
class Imported:
    """A definition as plain data, and what its reader has to say (http-api.md, section 9).

    ``report``: remarks with place and level; ``checks``: of form, topology and physics, whether there are warnings;
    ``names``: what was called otherwise in the file; ``bindings``: of coordinates, by mimic joints.
    """

    kind: str
    definition: dict[str, Any]
    report: list[dict[str, Any]]
    checks: dict[str, dict[str, Any]]
    names: dict[str, str]
    bindings: list[dict[str, Any]]

    def plain(self) -> dict[str, Any]:
        """As JSON data."""
        return {
            "kind": self.kind,
            "definition": self.definition,
            "report": self.report,
            "checks": self.checks,
            "names": self.names,
            "bindings": self.bindings,
        }


def import_file(
    data: bytes,
    options: Options = Options(),  # noqa: B008 -- frozen
    *,
    kind: str | None = None,
    name: str | None = None,
    file: str = "",
    license_of_file: str = "",
) -> Imported:
    """Read a robot file as a definition; nothing is stored.

    ``kind``: of the file, default by its content; ``name``: of the part, default the robot's; ``file``: its name, kept
    with the digest in ``source``. Raises InvalidDocument with line and element for what cannot be read.
    """
    found, robot = read_robot(data, kind)
    part = as_part(robot, options, name)
    digest = hashlib.sha256(data).hexdigest()
    source = f"{found.upper()} file{f' {file[:_LONGEST]}' if file else ''}, sha256:{digest}"
    definition = part.definition | {"source": source, "tags": [found]}
    if license_of_file:
        definition["license"] = license_of_file[:_LONGEST]
    report = robot.report
    return Imported(found, definition, report.plain(), report.checks(), part.names, part.bindings)
