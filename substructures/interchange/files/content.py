"""Whether a file is a robot file, by its content: nothing that reads one is imported for it."""

from __future__ import annotations

import re

_CELLS = re.compile(rb"[,;\t]")
_MARK = re.compile(rb"\(\*|^\s*N[LJF]\s*=", re.MULTILINE)


def is_foreign(data: bytes) -> bool:
    """Whether a file is no document of ours, by its content: XML, USD, a table or a SYMORO file."""
    return is_xml(data) or is_usd(data) or is_par(data) or is_table(data)


def is_usd(data: bytes) -> bool:
    """Whether a file is USD, as text or binary."""
    return data.startswith((b"#usda ", b"PXR-USDC"))


def is_xml(data: bytes) -> bool:
    """Whether a file begins as XML does, in any of the encodings that XML has."""
    beginning = data[:4000].lstrip(b"\xef\xbb\xbf\xff\xfe\x00 \t\r\n")
    return beginning[:1] == b"<"


def is_table(data: bytes) -> bool:
    """A DH table: a head with its four columns, or JSON with its rows."""
    beginning = data[:4000].lstrip(b"\xef\xbb\xbf \t\r\n")
    if beginning[:1] == b"{":
        return b'"dh"' in beginning
    head = next((line for line in beginning.splitlines() if line.strip() and not line.startswith(b"#")), b"")
    return {b"a", b"alpha", b"d", b"theta"} <= {cell.strip() for cell in _CELLS.split(head)}


def is_par(data: bytes) -> bool:
    """Whether a file looks like one of SYMORO."""
    return bool(_MARK.search(data[:4000])) and b"sigma" in data.lower()
