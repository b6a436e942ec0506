"""Which format a file has, by its content, and its reader."""

from __future__ import annotations

from collections.abc import Callable, Mapping

from substructures.errors import InvalidDocument
from substructures.interchange.mjcf.reader import read_mjcf
from substructures.interchange.report import refuse
from substructures.interchange.robot import Robot
from substructures.interchange.urdf import read_urdf
from substructures.interchange.xml import Node, read_xml

#: what reads a root element, with the contents of included files by name
Reader = Callable[[Node, Mapping[str, bytes]], Robot]
#: by the root element of XML formats
_ROOTS: Mapping[str, tuple[str, Reader]] = {
    "robot": ("urdf", lambda root, _: read_urdf(root)),
    "mujoco": ("mjcf", read_mjcf),
}
KINDS = ("urdf", "mjcf")


def is_foreign(data: bytes) -> bool:
    """Whether a file is no document of ours, by its content: XML, in any of the encodings that XML has."""
    beginning = data[:4000].lstrip(b"\xef\xbb\xbf\xff\xfe\x00 \t\r\n")
    return beginning[:1] == b"<"


def read_robot(data: bytes, kind: str | None = None, included: Mapping[str, bytes] | None = None) -> tuple[str, Robot]:
    """The kind of a file and the robot in it; ``kind``: what it has to be (None: anything). Raises InvalidDocument."""
    if kind is not None and kind not in KINDS:
        raise InvalidDocument.at("", "unknown-kind", f"kind '{kind[:40]}' is none of {', '.join(KINDS)}")
    root = read_xml(data)
    found = _ROOTS.get(root.tag)
    if found is None:
        raise refuse(
            root.place, "unknown-format", f"not one of {', '.join(KINDS)}: their roots are {', '.join(_ROOTS)}"
        )
    name, reader = found
    if kind is not None and kind != name:
        raise refuse(root.place, "wrong-kind", f"this is {name.upper()}, not {kind.upper()}")
    return name, reader(root, {} if included is None else included)
