"""Summaries of trees in two parts: a form that trees of one shape have in common, and what is in its holes."""

from __future__ import annotations

from collections.abc import Collection, Mapping
from dataclasses import dataclass
from itertools import chain
from typing import Any

from service.content.cache import Cache
from service.content.integrity import digest_of
from substructures.documents import read_json, write_json
from substructures.tree.document import TreeSpec
from substructures.tree.model import Model

HOLE = "\x1f"  # in a form; no text of a document has it
_HOLE = write_json(HOLE).decode()
SHORT = 16  # characters
FORMS = 2_000_000  # characters that are kept


@dataclass(frozen=True, slots=True)
class TreeSummary:
    """The summary of a tree with the digest of its text, in two parts (:func:`summary_text`): ``values``, and a
    ``form`` that trees of one shape have in common. Who knows its digest is not sent the form.
    """

    values: str
    digest: str
    form_digest: str | None = None
    form: str | None = None

    def columns(self) -> dict[str, Any]:
        """What a tree has of it."""
        parts = {"summary_values": self.values, "summary_form": self.form_digest, "form": self.form}
        return {**parts, "summary_digest": self.digest}

    def files(self, known: Collection[str] = ()) -> dict[str, bytes]:
        """As files of an outcome, for who has the contents with the ``known`` digests."""
        found = {"summary": self.values, "summary.digests": f"{self.digest} {self.form_digest or ''}"}
        sent = self.form is not None and self.form_digest not in known
        return {name: text.encode() for name, text in {**found, **({"form": self.form or ""} if sent else {})}.items()}

    @classmethod
    def of_files(cls, files: Mapping[str, bytes]) -> TreeSummary:
        """Out of the files of an outcome."""
        digest, form = files["summary.digests"].decode().split(" ")
        return cls(files["summary"].decode(), digest, form or None, files["form"].decode() if "form" in files else None)


def summary_text(values: str, form: str | None, spec: str) -> str:
    """The summary of the tree with this document, as canonical JSON.

    ``form``: JSON with holes; ``values``: what is in these, one a line: JSON, or ``=start:end`` of the document, which
    has it, too. Without a form the values are all of it.
    """
    pieces, given = (form or "").split(_HOLE), values.split("\n")
    if len(pieces) != len(given) + 1:
        return values
    filled = (_filled(value, spec) for value in given)
    return "".join(chain.from_iterable(zip(pieces, (*filled, ""), strict=True)))


def _filled(value: str, spec: str) -> str:
    if not value.startswith("="):
        return value
    start, _, end = value[1:].partition(":")
    return spec[int(start) : int(end)]


def tree_summary(spec: TreeSpec, model: Model) -> TreeSummary:
    """The summary of the model, with gravity and instances as they were given.

    The tree's own are numbers, warnings, times, and what its document says; all else follows from the shape.
    """
    canonical = spec.canonical()
    document, given = canonical.decode(), read_json(canonical)
    plain, values = model.summary(), list[Any]()
    plain |= {"gravity": given.get("gravity", [0, 0, 0]), "instances": given.get("instances", [])}
    plain |= {"loads": given["loads"]} if "loads" in given else {}

    def without(members: Mapping[str, Any], *names: str) -> dict[str, Any]:
        """Members with holes, in the order in which they are written."""
        own = [name for name in names if name in members]
        values.extend(members[name] for name in own)
        return {**members, **dict.fromkeys(own, HOLE)}

    holed = plain | {"certificate": without(plain["certificate"], "converted", "seconds", "warnings")}
    holed = without(holed, "gravity", "instances", "loads", "numbers")
    holed["parameters"] = {name: without(each, "given", "value") for name, each in sorted(plain["parameters"].items())}
    form = _form(model.program.digest, holed)
    if form.holes != len(values):  # an old document's description is a hole
        whole = write_json(plain)
        return TreeSummary(whole.decode(), digest_of(whole))
    lines = "\n".join(_placed(write_json(each).decode(), document) for each in values)
    digest = digest_of(summary_text(lines, form.text, document).encode())
    return TreeSummary(lines, digest, form.digest, form.text)


@dataclass(frozen=True, slots=True)
class _Form:
    """The text of a form, with its digest and the number of its holes."""

    data: Mapping[str, Any]
    text: str
    digest: str
    holes: int


_forms: Cache[_Form] = Cache(FORMS, lambda form: len(form.text))


def _form(program: str, data: Mapping[str, Any]) -> _Form:
    """Written once for trees of one shape: equal data have equal texts; the first of a program is kept."""
    found = _forms.get(program)
    if found is None or found.data != data:
        text = write_json(data).decode()
        found = _Form(data, text, digest_of(text.encode()), text.count(_HOLE))
        _forms.put(program, found)
    return found


def _placed(value: str, document: str) -> str:
    """Where it is in the document of the tree, if that is shorter."""
    start = document.find(value) if len(value) > SHORT else -1
    return value if start < 0 else f"={start}:{start + len(value)}"
