"""A robot cut at named links: a part for every link that is named, with all that it carries, and a tree of them.

A part begins with the joint of its link, so that nothing of the file is computed anew: its interface is where the frame
of the link's parent was, and there it is mounted.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Any

from substructures.errors import InvalidArgument, listed, meant
from substructures.interchange.as_part import PartOfFile, as_part, place_of
from substructures.interchange.files.wanted import Options
from substructures.interchange.names import Names, library_name
from substructures.interchange.numbers import Triple
from substructures.interchange.report import refuse
from substructures.interchange.robot import Loop, NamedFrame, Robot, Tendon
from substructures.tree.document import MAX_INSTANCES

#: the instance that keeps what was not cut off
MAIN = "robot"
WORLD = "world"


@dataclass(frozen=True)
class TreeOfFile:
    """A tree document as plain data; ``names``, ``bindings``: as of a part, with those of its instances."""

    tree: dict[str, Any]
    names: dict[str, str]
    bindings: list[dict[str, Any]]


def cut_robot(robot: Robot, links: Sequence[str], options: Options, name: str | None) -> TreeOfFile:
    """The tree of a robot that is cut at links, by their names in the file; ``name``: of the tree and of its main part.

    Raises InvalidArgument for links that are not there and where nothing would remain, InvalidDocument as of parts.
    """
    pieces = _pieces(robot, links)
    called = Names((WORLD, "tau"))
    instances = {piece: called.new(piece or MAIN) for piece in dict.fromkeys(pieces.values())}
    library = library_name(name or robot.name)
    parts = {
        piece: as_part(
            _robot_of(robot, piece, pieces), _options(robot, piece, options), part_name(library, piece or MAIN)
        )
        for piece in instances
    }
    parents = {link.name: link.parent for link in robot.links}
    documents: list[dict[str, Any]] = []
    for piece, instance in instances.items():
        one: dict[str, Any] = {"name": instance, "definition": parts[piece].definition}
        host = parents.get(piece)
        if host is not None:
            one["at"] = _frame(f"{piece}_mount", pieces[host], robot, instances, parts)
        documents.append(one)
    tree: dict[str, Any] = {"name": library, **gravity_of(robot), "instances": documents}
    if robot.loops:
        tree["closures"] = [_closure(loop, pieces, robot, instances, parts) for loop in robot.loops]
    if loads := _loads(robot, pieces, instances, parts):
        tree["loads"] = loads
    return TreeOfFile(tree, _names(instances, parts), _bindings(robot, instances, parts))


def part_name(tree: str, piece: str) -> str:
    """The name of a part of a tree, which is not that of the tree: what is meant by a name is clear."""
    return library_name(f"{tree}-{piece}")


def gravity_of(robot: Robot) -> dict[str, Any]:
    """The field of a tree, where the file says it; else the tree is warned of."""
    return {} if robot.gravity is None else {"gravity": list(robot.gravity)}


def _pieces(robot: Robot, links: Sequence[str]) -> dict[str, str]:
    """Of every link the one that its part begins with; empty for the main part."""
    known, wanted = {link.name: link for link in robot.links}, frozenset(links)
    for link in links:
        if link not in known:
            message = f"there is no link '{link[:80]}' to be cut at{meant(link, known)}; there are {listed(known)}"
            raise InvalidArgument.at("/cut", "unknown-link", message)
    if len(wanted) >= MAX_INSTANCES:
        raise InvalidArgument.at("/cut", "too-many-parts", f"a tree has at most {MAX_INSTANCES} instances")
    found: dict[str, str] = {}
    for each in robot.links:  # parents first
        found[each.name] = each.name if each.name in wanted else "" if each.parent is None else found[each.parent]
    if "" not in found.values():
        message = f"nothing remains before '{robot.links[0].name[:80]}', which carries all others: cut behind it"
        raise InvalidArgument.at("/cut", "nothing-remains", message)
    # the main part comes first
    return dict(sorted(found.items(), key=lambda item: item[1] != ""))


def _robot_of(robot: Robot, piece: str, pieces: Mapping[str, str]) -> Robot:
    """One part as a robot of its own, with frames where others are mounted and where loops end."""
    links = tuple(
        replace(link, parent=None) if link.name == piece else link for link in robot.links if pieces[link.name] == piece
    )
    ends = [
        NamedFrame(f"{link.name}_mount", link.parent)
        for link in robot.links
        if link.parent is not None and pieces[link.name] == link.name
    ]
    for loop in robot.loops:
        ends.append(NamedFrame(f"{loop.name}_from", loop.link, loop.position, loop.rpy))
        if loop.other is not None:
            ends.append(NamedFrame(f"{loop.name}_to", loop.other, loop.other_position, loop.other_rpy))
    frames = tuple(frame for frame in (*ends, *robot.frames) if pieces[frame.link] == piece)
    moved = {motion.name for link in links for motion in link.motions}
    mimics = tuple(mimic for mimic in robot.mimics if mimic.joint in moved)
    tendons = tuple(tendon for tendon in robot.tendons if _home(tendon, robot, pieces) == piece)
    return replace(robot, links=links, frames=frames, mimics=mimics, loops=(), tendons=tendons)


def _home(tendon: Tendon, robot: Robot, pieces: Mapping[str, str]) -> str | None:
    """The part that a tendon is a load of; None where it is one of the tree."""
    carriers = {motion.name: link.name for link in robot.links for motion in link.motions}
    parents: dict[str, str | None] = {link.name: link.parent for link in robot.links}
    links = [*(carriers[joint] for joint, _ in tendon.joints), *(link for link, _ in tendon.points)]
    found = {pieces[link] for link in links if link is not None}
    piece = found.pop() if len(found) == 1 else None
    # of a part that is mounted on another one, what carries all is not the world
    return None if piece is None or (None in links and parents.get(piece) is not None) else piece


def _loads(
    robot: Robot, pieces: Mapping[str, str], instances: Mapping[str, str], parts: Mapping[str, PartOfFile]
) -> list[dict[str, Any]]:
    """The tendons between several parts; joints that follow others have no coordinate in a tree."""
    coordinates: dict[str, str] = {}
    for piece, part in parts.items():
        moved = {relation["coordinate"] for relation in part.definition.get("relations", ())}
        own = part.coordinates.items()
        coordinates |= {joint: f"{instances[piece]}.{name}" for joint, name in own if name not in moved}

    def point(link: str | None, at: Triple) -> dict[str, Any]:
        """A point of a link, or of the world, as loads name it."""
        place = place_of({} if link is None else parts[pieces[link]].seats, link, at)
        return place | {"frame": WORLD if link is None else f"{instances[pieces[link]]}.{place['frame']}"}

    loads, called = [], Names()
    for tendon in (each for each in robot.tendons if _home(each, robot, pieces) is None):
        if all(joint in coordinates for joint, _ in tendon.joints):
            loads += [{"name": called.new(tendon.name), **load} for load in tendon.loads(coordinates, point)]
        else:
            message = "a tendon over joints of several parts, one of which moves with another, is left out"
            robot.report.lost(tendon.place, message)
    return loads


def _options(robot: Robot, piece: str, options: Options) -> Options:
    """What was cut off does not float: it hangs on its host."""
    cut_off = any(link.name == piece and link.parent is not None for link in robot.links)
    return replace(options, base="fixed") if cut_off else options


def _frame(name: str, piece: str, robot: Robot, instances: Mapping[str, str], parts: Mapping[str, PartOfFile]) -> str:
    """A frame that was added, as a place in the tree. Raises InvalidDocument where the part has too many ports."""
    port = parts[piece].names[f"frame {name}"]
    if all(each["name"] != port for each in parts[piece].definition.get("ports", ())):
        message = f"the frame '{port}' is beyond the ports that a part may have: drop fixed frames (fixed=dropped)"
        raise refuse(robot.links[0].place, "too-many-ports", message)
    return f"{instances[piece]}.{port}"


def _closure(
    loop: Loop,
    pieces: Mapping[str, str],
    robot: Robot,
    instances: Mapping[str, str],
    parts: Mapping[str, PartOfFile],
) -> dict[str, Any]:
    """A loop between two parts, or in one."""
    start = _frame(f"{loop.name}_from", pieces[loop.link], robot, instances, parts)
    closure: dict[str, Any] = {"name": Names().of(loop.name), "type": loop.kind, "from": start}
    if loop.other is None:
        return closure | {"placement": {"position": list(loop.other_position), "rpy": list(loop.other_rpy)}}
    return closure | {"to": _frame(f"{loop.name}_to", pieces[loop.other], robot, instances, parts)}


def _names(instances: Mapping[str, str], parts: Mapping[str, PartOfFile]) -> dict[str, str]:
    """Of all parts, ``instance.name``."""
    return {
        there: ", ".join(f"{instances[piece]}.{one}" for one in here.split(", "))
        for piece, part in parts.items()
        for there, here in part.names.items()
    }


def _bindings(robot: Robot, instances: Mapping[str, str], parts: Mapping[str, PartOfFile]) -> list[dict[str, Any]]:
    """Mimic joints between parts, and others that are no relations."""
    names: dict[str, str] = {}
    for piece, part in parts.items():
        names |= {motion: f"{instances[piece]}.{name}" for motion, name in part.coordinates.items()}
    left = [mimic for part in parts.values() for mimic in part.unbound]
    return [m.plain(names[m.joint], names[m.of]) for m in robot.mimics if m in left]
