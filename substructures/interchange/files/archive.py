"""A robot file among the files that it includes and takes meshes from, as in a folder or a zip."""

from __future__ import annotations

import posixpath
import re
from collections.abc import Callable, Iterable, Iterator, Mapping

from substructures.errors import InvalidDocument, among

#: endings of files that may hold a robot
ROBOTS = (".urdf", ".xml", ".mjcf", ".sdf", ".usd", ".usda", ".usdc", ".csv", ".json", ".par", ".xacro")
#: a zip whose first file is the robot
PACKAGE = ".usdz"
_INCLUDED = re.compile(rb"<include\s[^<>]*?file\s*=\s*[\"']([^\"'<>]{1,500})|<uri>\s*([^<>]{1,500}?)\s*</uri>")
#: where what ``model://`` names may lie, from the file that names it
_MODELS = ("", "..", "models", "../models")


class Beside(Mapping[str, bytes]):
    """Files by their paths from the folder of one of them; ``read`` gives their bytes."""

    def __init__(self, main: str, names: Iterable[str], read: Callable[[str], bytes]) -> None:
        self._folder, self._read = posixpath.dirname(main), read
        self._names = {posixpath.normpath(name) for name in names}

    def _path(self, name: object) -> str:
        return posixpath.normpath(posixpath.join(self._folder, str(name)))

    def __contains__(self, name: object) -> bool:
        return self._path(name) in self._names

    def __getitem__(self, name: str) -> bytes:
        if name not in self:
            raise KeyError(name)
        return self._read(self._path(name))

    def __iter__(self) -> Iterator[str]:
        return (posixpath.relpath(name, self._folder or ".") for name in self._names)

    def __len__(self) -> int:
        return len(self._names)


def main_of(names: Iterable[str], read: Callable[[str], bytes], wanted: str = "") -> str:
    """The robot file among others: the one that is ``wanted``, or the only one that no other includes; of a USD package
    the first one.

    Raises InvalidDocument with those that there are.
    """
    known = list(names)
    if wanted in known:
        return wanted
    if wanted.lower().endswith(PACKAGE) and known and known[0].lower().endswith(ROBOTS):
        return known[0]
    left = _not_included(sorted(known), read, wanted)
    if len(left) == 1:
        return left[0]
    if not left:
        raise InvalidDocument.at("", "no-robot", f"there is no robot file ({', '.join(ROBOTS)}) among these files")
    said = f"{', '.join(left[:10])}{among(wanted, left) if wanted else ''}"
    raise InvalidDocument.at("", "several-robots", f"there are several robot files: say which by 'file': {said}")


def _not_included(known: list[str], read: Callable[[str], bytes], wanted: str) -> list[str]:
    """The robot files that no other includes; all of them where that is none. Those of a name, if there are some."""
    robots = [name for name in known if name.lower().endswith(ROBOTS) and not _is_hidden(name)]
    if wanted and posixpath.basename(wanted) == wanted:
        robots = [name for name in robots if posixpath.basename(name) == wanted] or robots
    included = {path for name in robots for path in _included_by(name, read(name))}
    return [name for name in robots if name not in included and posixpath.dirname(name) not in included] or robots


def models_at(uri: str) -> Iterator[str]:
    """The paths at which a file or folder that SDF includes may be, from the file that has its uri."""
    scheme, colon, path = uri.partition("://")
    if not colon:
        yield uri
    elif scheme in ("model", "package"):
        yield from (posixpath.join(place, path) for place in _MODELS)
    elif scheme == "file":
        yield path


def _included_by(name: str, data: bytes) -> Iterator[str]:
    """Files and folders of models that a robot file includes, as far as they may be meant."""
    for file, uri in _INCLUDED.findall(data):
        paths = models_at(uri.decode("utf-8", "replace")) if uri else [file.decode("utf-8", "replace")]
        for path in paths:
            found = posixpath.normpath(posixpath.join(posixpath.dirname(name), path))
            if found not in (".", posixpath.dirname(name)):
                yield found


def _is_hidden(name: str) -> bool:
    """What other programs leave behind (macOS: __MACOSX, .DS_Store)."""
    return any(step.startswith((".", "__")) for step in name.split("/"))
