"""Bytes to plain data and back, with exact numbers.

A document is text in JSON or YAML; plain data are dicts with string keys, lists, strings, booleans, ``None``,
``int`` and ``decimal.Decimal``. A number is taken exactly as its decimal text, never through binary floating point.
Both readers refuse the same things: duplicate keys, nesting deeper than ``MAX_DEPTH``, numbers of more than
``MAX_DIGITS`` digits (written out without an exponent), NaN and infinities, lone surrogates and invalid UTF-8.
All functions raise :class:`substructures.errors.InvalidDocument` and nothing else. ``DocumentPart`` and ``Document``
are the bases of what is read from plain data by ``read_model``.

Sources: RFC 8259 (JSON), RFC 6901 (pointers), YAML 1.2.2 section 10.3 (core schema).
"""

from substructures.documents.faults import message_of, require_object
from substructures.documents.fields import DocumentPart
from substructures.documents.from_json import read_json
from substructures.documents.from_yaml import located, places, read_yaml
from substructures.documents.numbers import MAX_DIGITS
from substructures.documents.schema import Document, read_model
from substructures.documents.text import DOCUMENTS, MAX_DEPTH, escape, pointer_step
from substructures.documents.to_json import write_json
from substructures.documents.to_yaml import write_yaml

__all__ = [
    "DOCUMENTS",
    "MAX_DEPTH",
    "MAX_DIGITS",
    "Document",
    "DocumentPart",
    "escape",
    "located",
    "message_of",
    "places",
    "pointer_step",
    "read_json",
    "read_model",
    "read_yaml",
    "require_object",
    "write_json",
    "write_yaml",
]
