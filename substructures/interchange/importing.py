"""The bytes of a foreign file to a definition, with the report of what became of everything in it."""

from __future__ import annotations

import hashlib
from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

from substructures.interchange.as_part import Options, PartOfFile, as_part
from substructures.interchange.kinds import read_robot, read_rows
from substructures.interchange.names import library_name
from substructures.interchange.numbers import ORIGIN
from substructures.interchange.robot import Robot

#: most characters of the name of a file that are kept
_LONGEST = 200


@dataclass(frozen=True)
class Imported:
    """A definition as plain data, and what its reader has to say.

    ``tree``: where the file has loops, the definition as its instance ``robot``, closures and the file's gravity.

    ``report``: remarks with place and level; ``checks``: of form, topology and physics, whether there are warnings;
    ``names``: what was called otherwise in the file; ``bindings``: of coordinates, by mimic joints.
    """

    kind: str
    definition: dict[str, Any]
    tree: dict[str, Any] | None
    report: list[dict[str, Any]]
    checks: dict[str, dict[str, Any]]
    names: dict[str, str]
    bindings: list[dict[str, Any]]

    def plain(self) -> dict[str, Any]:
        """As JSON data."""
        return {
            "kind": self.kind,
            **({"definition": self.definition} if self.tree is None else {"tree": self.tree}),
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
    included: Mapping[str, bytes] | None = None,
) -> Imported:
    """Read a robot file as a definition; nothing is stored.

    ``kind``: of the file, default by its content; ``name``: of the part, default the robot's; ``file``: its name, kept
    with the digest in ``source``; ``included``: contents of the files that an MJCF file
    includes, by their names there. Raises InvalidDocument with line and element for what cannot be read.
    """
    rows = read_rows(data, kind, options.parameters != "none")
    if rows is not None:
        definition = _told(rows[1], rows[0], data, file, license_of_file)
        definition |= {} if name is None else {"name": library_name(name)}
        return Imported(rows[0], definition, None, rows[2].plain(), rows[2].checks(), {}, [])
    found, robot = read_robot(data, kind, included)
    part = as_part(robot, options, name)
    definition = _told(part.definition, found, data, file, license_of_file)
    tree, report = _tree(robot, part, definition), robot.report
    return Imported(found, definition, tree, report.plain(), report.checks(), part.names, part.bindings)


def _told(document: dict[str, Any], kind: str, data: bytes, file: str, license_of_file: str) -> dict[str, Any]:
    """With the source: file, digest, licence."""
    digest = hashlib.sha256(data).hexdigest()
    source = f"{kind.upper()} file{f' {file[:_LONGEST]}' if file else ''}, sha256:{digest}"
    told = {"license": license_of_file[:_LONGEST]} if license_of_file else {}
    return document | {"source": source, "tags": [kind]} | told


def _tree(robot: Robot, part: PartOfFile, definition: dict[str, Any]) -> dict[str, Any] | None:
    """The definition with the loops of the file closed."""
    if not robot.loops:
        return None
    closures = []
    for loop, (start, end) in zip(robot.loops, part.loop_ports, strict=True):
        closure: dict[str, Any] = {"name": part.names[f"loop {loop.name}"], "type": loop.kind, "from": f"robot.{start}"}
        if end is None:
            closure["placement"] = {"position": list(loop.other_position), "rpy": list(loop.other_rpy)}
        else:
            closure["to"] = f"robot.{end}"
        closures.append(closure)
    gravity = list(robot.gravity or ORIGIN)
    instance = {"name": "robot", "definition": definition}
    return {"name": definition["name"], "gravity": gravity, "instances": [instance], "closures": closures}
