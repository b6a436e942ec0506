"""What texts of robot files share: numbers with as many digits as bring the same double back, and remarks."""

from __future__ import annotations

import re
from collections.abc import Iterable, Sequence
from xml.etree import ElementTree as Tree

import numpy as np

from substructures.array import Array
from substructures.export.software import SOFTWARE

#: below this it is rounding of products of rotations
_ROUNDING = 1e-15


def document(root: Tree.Element, reference: str, digest: str, remarks: Iterable[str]) -> bytes:
    """The file, with comments at its beginning: where it is from, and remarks."""
    title, _, number = reference.partition("@")
    version = f" version {number}" if number else ""
    head = f"{title}{version}, {digest}, written by {SOFTWARE}; units: m, kg, rad, s"
    for k, line in enumerate((head, *remarks)):
        root.insert(k, Tree.Comment(f" {re.sub('-(?=-|$)', '- ', line)} "))
    Tree.indent(root)
    return b'<?xml version="1.0" encoding="UTF-8"?>\n' + Tree.tostring(root, "us-ascii", xml_declaration=False) + b"\n"


def cleaned(x: Array, scale: float | None = None) -> Array:
    """Without what is only rounding."""
    largest = float(np.abs(x).max(initial=0)) if scale is None else scale
    return np.where(np.abs(x) <= _ROUNDING * largest, 0.0, x)


def numbers(x: Sequence[float] | Array) -> str:
    """Several numbers."""
    return " ".join(map(number, x))


def number(x: float) -> str:
    """The shortest decimal that is this double; 0 and 2 without a point."""
    x = float(x) + 0.0
    return str(int(x)) if x.is_integer() and abs(x) < 1e15 else repr(x)
