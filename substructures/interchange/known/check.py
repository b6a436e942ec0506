"""Attributes and elements that a format has not got: told once each, with what may have been meant.

A vocabulary is text, ``parent/element: attribute attribute``, with ``|`` between several of either; ``*`` in the place
of attributes: anything may be in this element.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, field

from substructures.errors import listed, meant
from substructures.interchange.report import MOST_REMARKS, Place, Report
from substructures.interchange.xml import SHOWN, Node

ANYTHING = "*"


@dataclass(frozen=True)
class Vocabulary:
    """``attributes``: of an element in its parent, None for anything; ``children``: of an element; ``homes``: of an
    element, those that may hold it.
    """

    attributes: Mapping[tuple[str, str], frozenset[str] | None]
    children: Mapping[str, list[str]] = field(default_factory=dict)
    homes: Mapping[str, list[str]] = field(default_factory=dict)

    @classmethod
    def read(cls, text: str) -> Vocabulary:
        """Of its text."""
        attributes: dict[tuple[str, str], frozenset[str] | None] = {}
        children: dict[str, list[str]] = {}
        homes: dict[str, list[str]] = {}
        for line in filter(None, map(str.strip, text.replace("\\\n", " ").splitlines())):
            head, _, names = line.partition(":")
            parents, _, tags = head.rpartition("/")
            for parent in parents.split("|"):
                for tag in tags.split("|"):
                    words = names.split()
                    attributes[parent, tag] = None if words == [ANYTHING] else frozenset(words)
                    children.setdefault(parent, []).append(tag)
                    homes.setdefault(tag, []).append(parent)
        return cls(attributes, children, homes)

    def tell(self, root: Node, report: Report) -> None:
        """A warning for every name that is not known where it stands."""
        found: dict[str, list[Place]] = {}
        for place, message in self._unknown(root):
            found.setdefault(message, []).append(place)
            if len(found) > MOST_REMARKS:
                break
        for message, places in found.items():
            more = f" (and in {len(places) - 1} more places)" if places[1:] else ""
            report.warning(places[0], message + more)

    def _unknown(self, root: Node) -> Iterator[tuple[Place, str]]:
        waiting = [("", root)]
        while waiting:
            parent, node = waiting.pop()
            attributes = self.attributes[parent, node.tag]
            if attributes is None:
                continue
            for name in node.attributes:
                if name not in attributes:
                    there = meant(name, attributes) or self._at_home(name)
                    yield node.place, f"the attribute '{name[:SHOWN]}' is not known here and ignored{there}"
            for child in node.children:
                if (node.tag, child.tag) in self.attributes:
                    waiting.append((node.tag, child))
                else:
                    there = self._element_at_home(child.tag) or meant(child.tag, self.children.get(node.tag, ()))
                    yield child.place, f"<{child.tag[:SHOWN]}> is not known in <{node.tag[:SHOWN]}> and ignored{there}"

    def _at_home(self, name: str) -> str:
        """Where an attribute would belong."""
        found = {tag for (_, tag), names in self.attributes.items() if names and name in names}
        return f"; it belongs in {listed(sorted(f'<{tag}>' for tag in found), 3)}" if found else ""

    def _element_at_home(self, tag: str) -> str:
        found = sorted({f"<{home}>" for home in self.homes.get(tag, ()) if home})
        return f"; it belongs in {listed(found, 3)}" if found else ""


def acting(node: Node, harmless: Mapping[str, Sequence[str]]) -> Iterator[Node]:
    """The elements in ``node``, itself among them, that are mechanics: those that have the names of ``harmless``, or
    attributes of these names, with other values.
    """
    waiting = [node]
    while waiting:
        here = waiting.pop()
        waiting += here.children
        given = here.attributes | {here.tag: here.attributes.get("value", here.text)}
        if any(name in harmless and x.strip().lower() not in harmless[name] for name, x in given.items()):
            yield here
