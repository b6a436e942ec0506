"""The bytes of a foreign file to a definition, with the report of what became of everything in it."""

from __future__ import annotations

import hashlib
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from functools import partial
from typing import Any

from substructures.errors import InvalidArgument
from substructures.interchange.as_part import PartOfFile, as_part
from substructures.interchange.cut import MAIN, TreeOfFile, cut_robot, gravity_of, part_name
from substructures.interchange.files.wanted import Options, text_of_file
from substructures.interchange.kinds import read_robot, read_rows
from substructures.interchange.names import library_name
from substructures.interchange.report import MOST_REMARKS, Report, refuse
from substructures.interchange.robot import Robot, tell_of_missing_masses
from substructures.interchange.rows.cut import cut_rows
from substructures.interchange.turning import is_turning

#: most characters of the name of a file that are kept
_LONGEST = 200


@dataclass(frozen=True)
class Imported:
    """A definition as plain data, and what its reader has to say.

    ``tree``: where the file has loops, the definition as its instance ``robot``, closures and the file's gravity; where
    it was cut, a part for every link that was named, mounted on the others.

    ``report``: remarks with place and level; ``checks``: of form, topology and physics, whether there are warnings;
    ``names``: what was called otherwise in the file; ``bindings``: those that are no relations; ``gravity``: of the
    file, which trees have, and parts have not.
    """

    kind: str
    definition: dict[str, Any]
    tree: dict[str, Any] | None
    report: list[dict[str, Any]]
    checks: dict[str, dict[str, Any]]
    names: dict[str, str]
    bindings: list[dict[str, Any]]
    gravity: list[Any] | None = None

    def plain(self) -> dict[str, Any]:
        """As JSON data."""
        return {
            "kind": self.kind,
            **({"definition": self.definition} if self.tree is None else {"tree": self.tree}),
            "report": self.report,
            "checks": self.checks,
            "names": self.names,
            "bindings": self.bindings,
            "gravity": self.gravity,
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
    cut: Sequence[str] = (),
) -> Imported:
    """Read a robot file as a definition; nothing is stored.

    ``kind``: of the file, default by its content; ``name``: of the part, default the robot's; ``file``: its name, kept
    with the digest in ``source``; ``included``: contents of the files that an MJCF file includes, by their names there;
    ``cut``: links that begin parts of their own in a tree. Raises InvalidDocument with line and element for what cannot
    be read, InvalidArgument for links that are not there, and for a name of which nothing is left.
    """
    if name and not library_name(name, otherwise=""):
        message = f"'{name[:40]}' has nothing of what names here are made of: a to z, 0 to 9 and '-'"
        raise InvalidArgument.at("/name", "invalid-name", message)
    rows = read_rows(data, kind, options.parameters != "none")
    if rows is not None:
        return _of_rows(
            rows, name, cut, partial(_told, kind=rows[0], data=data, file=file, license_of_file=license_of_file)
        )
    found, robot = read_robot(data, kind, included)
    tell_of_missing_masses(robot, floats=options.base == "floating")
    _require_open(robot, options)
    told = partial(_told, kind=found, data=data, file=file, license_of_file=license_of_file)
    if cut:
        return _of_links(found, robot, cut_robot(robot, cut, options, name), told)
    part = as_part(robot, options, name)
    definition = told(_with_losses(part.definition, robot.report))
    tree, report = _tree(robot, part, definition), robot.report
    gravity = gravity_of(robot).get("gravity")
    if tree is None and robot.gravity_place is not None:
        message = f'gravity is that of a tree: give it "gravity": [{", ".join(map(str, gravity or ()))}]'
        report.warning(robot.gravity_place, message)
    return Imported(found, definition, tree, report.plain(), report.checks(), part.names, [], gravity)


def _require_open(robot: Robot, options: Options) -> None:
    """Raises InvalidDocument for loops beside joints with quaternions."""
    floats = options.base == "floating"
    turning = [
        link.place
        for link in robot.links
        if any(map(is_turning, link.motions)) or (floats and link.parent is None and not link.motions)
    ]
    if robot.loops and turning and options.rotations == "quaternions":
        message = "the file has loops, which do not go with ball and floating joints: take rotations=angles"
        raise refuse(turning[0], "has-balls", message)


def document_of(given: Mapping[str, Any]) -> Mapping[str, Any]:
    """A definition or tree as it is; of ``{"file": text, "kind": ...}`` what is read of it. Raises InvalidDocument."""
    if "file" not in given:
        return given
    read = import_file(text_of_file(given), kind=given.get("kind"))
    return read.definition if read.tree is None else read.tree


def _with_losses(document: dict[str, Any], report: Report) -> dict[str, Any]:
    """With what is left out of the file."""
    left_out = [*document.get("left_out", ()), *report.losses()]
    return document | ({"left_out": left_out[:MOST_REMARKS]} if left_out else {})


def _of_links(kind: str, robot: Robot, made: TreeOfFile, told: Callable[[dict[str, Any]], dict[str, Any]]) -> Imported:
    """A robot whose links begin parts of a tree; ``told``: a document with its source."""
    instances, report = made.tree["instances"], robot.report
    instances[0]["definition"] = _with_losses(instances[0]["definition"], report)
    for instance in instances:
        instance["definition"] = told(instance["definition"])
    found = report.plain(), report.checks(), made.names, made.bindings, gravity_of(robot).get("gravity")
    return Imported(kind, instances[0]["definition"], made.tree, *found)


def _of_rows(
    rows: tuple[str, dict[str, Any], Report],
    name: str | None,
    cut: Sequence[str],
    told: Callable[[dict[str, Any]], dict[str, Any]],
) -> Imported:
    """Of a table of rows; ``told``: a document with its source."""
    kind, read, report = rows
    definition = _with_losses(read, report) | ({} if name is None else {"name": library_name(name)})
    tree = cut_rows(definition, cut) if cut else None
    for each in [] if tree is None else tree["instances"]:
        each["definition"] = told(each["definition"])
    return Imported(kind, told(definition), tree, report.plain(), report.checks(), {}, [])


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
        closure: dict[str, Any] = {
            "name": part.names[f"loop {loop.name}"],
            "type": loop.kind,
            "from": f"{MAIN}.{start}",
        }
        if end is None:
            closure["placement"] = {"position": list(loop.other_position), "rpy": list(loop.other_rpy)}
        else:
            closure["to"] = f"{MAIN}.{end}"
        closures.append(closure)
    instance = {"name": MAIN, "definition": definition | {"name": part_name(definition["name"], MAIN)}}
    return {"name": definition["name"], **gravity_of(robot), "instances": [instance], "closures": closures}
