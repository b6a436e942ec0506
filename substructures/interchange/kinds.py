"""Which format a file has, by its content, and its reader."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from typing import Any

from substructures.documents import read_json
from substructures.errors import InvalidDocument
from substructures.interchange.files.content import is_par, is_table, is_usd, is_xml
from substructures.interchange.files.wanted import KINDS
from substructures.interchange.mjcf.reader import read_mjcf
from substructures.interchange.report import Place, Report, refuse
from substructures.interchange.robot import Robot
from substructures.interchange.rows.symoro import read_par
from substructures.interchange.rows.tables import read_csv, read_table
from substructures.interchange.sdf.reader import read_sdf
from substructures.interchange.urdf.reader import read_urdf
from substructures.interchange.usd.reader import read_usd
from substructures.interchange.xml import Node, read_xml

#: what reads a root element, with the contents of included files by name
Reader = Callable[[Node, Mapping[str, bytes]], Robot]
#: by the root element of XML formats
_ROOTS: Mapping[str, tuple[str, Reader]] = {
    "robot": ("urdf", lambda root, _: read_urdf(root)),
    "mujoco": ("mjcf", read_mjcf),
    "sdf": ("sdf", read_sdf),
}
#: most bytes of what is no XML: 200 rows with long expressions
MAX_ROWS = 2**20
_NO_XML = (
    "this is neither XML (URDF, MJCF, SDF), nor USD, nor a SYMORO file, nor a table of Denavit-Hartenberg parameters: "
    "the first line of a table names its columns, a, alpha, d, theta among them (name,type,a,alpha,d,theta,mass, ...)"
)


def read_rows(data: bytes, kind: str | None = None, symbolic: bool = True) -> tuple[str, dict[str, Any], Report] | None:
    """Kind, definition and report of a DH table or a SYMORO file; None for XML. Raises InvalidDocument."""
    is_rows = kind in ("par", "dh") or (kind is None and not is_xml(data) and (is_par(data) or is_table(data)))
    if is_rows and len(data) > MAX_ROWS:
        raise InvalidDocument.at("", "too-large", f"the file has {len(data):,} bytes; the limit is {MAX_ROWS:,}")
    if kind == "par" or (kind is None and is_par(data) and not is_xml(data)):
        return "par", *read_par(data)
    if kind == "dh" or (kind is None and is_table(data)):
        if data.lstrip(b"\xef\xbb\xbf \t\r\n")[:1] != b"{":
            return "dh", *read_csv(data, symbolic)
        document = read_json(data.lstrip(b"\xef\xbb\xbf"))
        if not isinstance(document, dict) or "dh" not in document:
            raise InvalidDocument.at("/dh", "missing", "a table has its rows in 'dh'")
        return "dh", *read_table(document, symbolic)
    return None


def read_robot(data: bytes, kind: str | None = None, included: Mapping[str, bytes] | None = None) -> tuple[str, Robot]:
    """The kind of a file and the robot in it; ``kind``: what it has to be (None: anything). Raises InvalidDocument."""
    if kind is not None and kind not in KINDS:
        raise InvalidDocument.at("", "unknown-kind", f"kind '{kind[:40]}' is none of {', '.join(KINDS)}")
    if is_usd(data):
        if kind not in (None, "usd"):
            raise refuse(Place(0, "USD"), "wrong-kind", f"this is USD, not {kind.upper()}")
        return "usd", read_usd(data, included)
    if data.strip() and b"\0" not in data and not is_xml(data):  # it is text
        raise InvalidDocument.at("", "unknown-format", _NO_XML)
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
