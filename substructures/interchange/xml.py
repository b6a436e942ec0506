"""XML with the line of every element, without entities, external files and document types (defusedxml).

Limits are on bytes, depth and number of elements; what exceeds them is refused before anything is built of it. Names
are taken without their prefixes, which need not be declared, and the XML declaration may stand behind blank lines and
comments: many robot files are written so.
"""

from __future__ import annotations

import re
from collections.abc import Iterator
from dataclasses import dataclass, field
from typing import Any
from xml.sax import SAXParseException
from xml.sax.handler import ContentHandler

from defusedxml.common import DefusedXmlException
from defusedxml.expatreader import DefusedExpatParser

from substructures.errors import InvalidDocument
from substructures.interchange.numbers import Number, number_of
from substructures.interchange.report import Place, refuse

MAX_BYTES = 16 * 2**20
MAX_DEPTH = 200
MAX_ELEMENTS = 200_000
#: most characters of a name or value that are shown
SHOWN = 60
_NAMED = ("name", "class", "link", "joint", "body")
_BEGINNING = re.compile(rb"^(?:\xef\xbb\xbf)?\s*<!doctype\s+html|^(?:\xef\xbb\xbf)?\s*<html", re.IGNORECASE)
#: blank space, or the beginning of a comment
_BEFORE = re.compile(rb"\s+|(<!--)")
_DECLARATION = re.compile(rb"<\?xml\s[^<>]{0,200}\?>")


@dataclass(slots=True)
class Node:
    """An element: tag (without namespace), attributes, children, text, line; ``file``: of one that is included."""

    tag: str
    attributes: dict[str, str]
    line: int
    children: list[Node] = field(default_factory=list)
    text: str = ""
    file: str = ""

    @property
    def place(self) -> Place:
        """Line and element, with the attribute that names it."""
        named = next((f' {k}="{self.attributes[k][:SHOWN]}"' for k in _NAMED if k in self.attributes), "")
        file = f" of {self.file[:SHOWN]}" if self.file else ""
        return Place(self.line, f"<{self.tag[:SHOWN]}{named}>{file}")

    def all(self, *tags: str) -> Iterator[Node]:
        """The children with one of the tags."""
        return (child for child in self.children if child.tag in tags)

    def one(self, tag: str) -> Node | None:
        """The child with this tag, None where there is none. Raises InvalidDocument for several."""
        found = list(self.all(tag))
        if len(found) > 1:
            raise refuse(found[1].place, "duplicate-element", f"a second <{tag}> in {self.place.element}: leave one")
        return found[0] if found else None

    def text_of(self, name: str, default: str | None = None) -> str:
        """An attribute. Raises InvalidDocument where it is missing and has no default."""
        found = self.attributes.get(name, default)
        if found is None:
            raise refuse(self.place, "missing-attribute", f"the attribute '{name}' is needed")
        return found

    def number(self, name: str, default: Number | None = None) -> Number:
        """A finite decimal number. Raises InvalidDocument."""
        if name not in self.attributes and default is not None:
            return default
        return number_of(self.text_of(name), self.place, name)

    def numbers(self, name: str, count: int | None, default: tuple[Number, ...] | None = None) -> tuple[Number, ...]:
        """So many finite decimal numbers (None: any number). Raises InvalidDocument."""
        if name not in self.attributes and default is not None:
            return default
        return numbers_in(self.text_of(name), count, self.place, name)


def numbers_in(text: str, count: int | None, place: Place, name: str) -> tuple[Number, ...]:
    """Finite decimal numbers, separated by white space. Raises InvalidDocument."""
    words = text.split()
    if count is not None and len(words) != count:
        message = f"'{name}' needs {count} numbers separated by spaces, found '{text.strip()[:SHOWN]}'"
        raise refuse(place, "wrong-length", message)
    return tuple(number_of(word, place, name) for word in words)


class _Builder(ContentHandler):
    """Builds nodes; counts depth and elements."""

    def __init__(self, parser: DefusedExpatParser, file: str) -> None:
        super().__init__()
        self.parser, self.file = parser, file
        self.stack: list[Node] = []
        self.root: Node | None = None
        self.count = 0
        self.spaces: dict[str, str] = {}  #: namespaces by prefix

    def startElement(self, name: str, attrs: Any) -> None:
        """A node below the one that is open. Raises InvalidDocument for too many, and what points to other files."""
        given = dict(attrs.items())
        self.spaces |= {key[6:]: uri for key, uri in given.items() if key.startswith("xmlns:")}
        plain = {key: x for key, x in given.items() if ":" not in key and key != "xmlns"}
        prefixed = {_local(key): x for key, x in given.items() if ":" in key and not key.startswith("xmlns:")}
        node = Node(_local(name), prefixed | plain, self.parser.getLineNumber(), file=self.file)
        self.count += 1
        if self.count > MAX_ELEMENTS:
            raise refuse(node.place, "too-large", f"more than {MAX_ELEMENTS:,} elements")
        if len(self.stack) >= MAX_DEPTH:
            raise refuse(node.place, "nesting", f"nested deeper than {MAX_DEPTH} levels")
        prefix = name.partition(":")[0] if ":" in name else ""
        space = self.spaces.get(prefix, "") + prefix
        if "XInclude" in space or space == "xi":
            raise refuse(node.place, "external-file", "XInclude is not followed: put the file's content here")
        if "xacro" in space:
            raise refuse(node.place, "xacro", "this is a xacro file: expand it first, `xacro file.xacro > file.urdf`")
        if self.stack:
            self.stack[-1].children.append(node)
        else:
            self.root = node
        self.stack.append(node)

    def endElement(self, name: str) -> None:  # noqa: ARG002
        """The node above is open again."""
        self.stack.pop()

    def characters(self, content: str) -> None:
        """Lines come one by one, and their ends alone."""
        if self.stack and (self.stack[-1].text or not content.isspace()):
            self.stack[-1].text += " " if content.isspace() else content


def _local(name: str) -> str:
    return name.rpartition(":")[2]


def _declared_first(data: bytes) -> bytes:
    """The file with its XML declaration at the beginning, where XML wants it; all lines keep their numbers."""
    here = 3 if data.startswith(b"\xef\xbb\xbf") else 0
    while found := _BEFORE.match(data, here):
        end = data.find(b"-->", found.end()) + 3 if found[1] else found.end()
        if end < found.end():
            return data  # a comment that is not closed
        here = end
    declaration = _DECLARATION.match(data, here)
    if declaration is None:
        return data
    return declaration[0] + data[:here].removeprefix(b"\xef\xbb\xbf") + data[declaration.end() :]


def read_xml(data: bytes, file: str = "") -> Node:
    """The root element; ``file``: the name of one that is included, which places tell.

    Raises InvalidDocument with the line for what is not well-formed, too large, or dangerous.
    """
    if len(data) > MAX_BYTES:
        raise InvalidDocument.at("", "too-large", f"the file has {len(data):,} bytes; the limit is {MAX_BYTES:,}")
    if _BEGINNING.match(data[:200]):
        raise refuse(Place(1, "<html>"), "html", "this is a web page, no robot: download the raw file")
    parser = DefusedExpatParser(forbid_dtd=True, forbid_entities=True, forbid_external=True)
    target, of_file = _Builder(parser, file), f" of {file[:SHOWN]}" if file else ""
    parser.setContentHandler(target)
    try:
        parser.feed(_declared_first(data))
        parser.close()
    except DefusedXmlException as error:
        message = f"document types, entities and external files are refused ({type(error).__name__}): write them out"
        raise refuse(Place(parser.getLineNumber() or 1, f"<!DOCTYPE>{of_file}"), "forbidden-xml", message) from None
    except SAXParseException as error:
        place = Place(error.getLineNumber() or 1, f"XML{of_file}")
        raise refuse(place, "not-well-formed", error.getMessage()) from None
    except (ValueError, LookupError) as error:  # encodings that are not known, or not of one byte
        raise refuse(Place(1, "<?xml?>"), "encoding", f"{error}: save the file as UTF-8") from None
    if target.root is None:
        raise refuse(Place(1, "XML"), "not-well-formed", "the file has no element")
    return target.root
