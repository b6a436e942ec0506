"""<replicate> written out: copies of what is in it, each in a frame that is displaced and turned once more.

Copy k is turned by R_k = R(k euler) and stands at r_k+1 = r_k + R_k offset, r_0 = 0, as MuJoCo does it: about several
axes R_k is no power of R_1. Names get ``sep`` and k, with as many digits as the last one has.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from substructures.array import Array
from substructures.interchange.mjcf.settings import Compiler, orientation
from substructures.interchange.numbers import ORIGIN, value
from substructures.interchange.report import refuse
from substructures.interchange.xml import Node

TAG = "replicate"
MOST_COPIES = 1000
#: of all copies together
MOST_ELEMENTS = 10_000


def written_out(node: Node, compiler: Compiler) -> Node:
    """The element without any <replicate> in it. Raises InvalidDocument for more elements than a file may have."""
    return _Writer(compiler).written(node, "")


class _Writer:
    """Counts the elements that it makes."""

    def __init__(self, compiler: Compiler) -> None:
        self.compiler, self.count = compiler, 0

    def written(self, node: Node, suffix: str) -> Node:
        """A copy with a suffix to all names."""
        self.count += bool(suffix)
        if self.count > MOST_ELEMENTS:
            raise refuse(node.place, "too-large", f"more than {MOST_ELEMENTS:,} elements, when copies are written out")
        children: list[Node] = []
        for child in node.children:
            children += self._copies(child, suffix) if child.tag == TAG else [self.written(child, suffix)]
        named = {"name": node.attributes["name"] + suffix} if suffix and "name" in node.attributes else {}
        return replace(node, attributes=node.attributes | named, children=children)

    def _copies(self, node: Node, suffix: str) -> list[Node]:
        """One <frame> for each."""
        count = value(node.number("count"))
        if count != int(count) or not 1 <= count <= MOST_COPIES:
            raise refuse(node.place, "bad-value", f"count is a whole number from 1 to {MOST_COPIES}")
        offset = np.array([value(x) for x in node.numbers("offset", 3, ORIGIN)])
        angles, place = node.numbers("euler", 3, ORIGIN), np.zeros(3)
        digits, sep, frames = len(str(int(count) - 1)), node.attributes.get("sep", ""), []
        inner = {key: x for key, x in node.attributes.items() if key == "childclass"}
        for k in range(int(count)):
            turned = {"euler": " ".join(str(k * x) for x in angles)}
            own = f"{sep}{k:0{digits}d}{suffix}"
            frame = replace(node, tag="frame", attributes={**inner, "pos": _text(place), **turned})
            frames.append(self.written(frame, own))
            place = place + orientation(frame, self.compiler) @ offset
        return frames


def _text(numbers: Array) -> str:
    return " ".join(f"{float(x):.17g}" if abs(x) > 1e-16 else "0" for x in numbers)
