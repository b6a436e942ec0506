"""Plain data to frozen values: pydantic models, and the identity of whole documents."""

from __future__ import annotations

import hashlib
from collections.abc import Mapping
from decimal import Decimal
from functools import cached_property
from typing import Any, Self, TypeVar

from pydantic import BaseModel, ValidationError

from substructures.documents.faults import faults_of, require_object
from substructures.documents.fields import DocumentPart
from substructures.documents.from_json import read_json
from substructures.documents.to_json import write_json
from substructures.errors import InvalidDocument

#: lists of lists that a value may stand alone for
NESTED = 3
#: values that are put into lists of one
MOST_LISTED = 200


class Document(DocumentPart):
    """Base of documents that stand for themselves; the digest of the canonical bytes is the identity."""

    @classmethod
    def read(cls, data: Any) -> Self:
        """The document from plain data. Raises InvalidDocument with a pointer to every fault."""
        return read_model(cls, data)

    @classmethod
    def stored(cls, data: Any) -> Self:
        """The document from what was stored: as :meth:`read`, and what older versions accepted keeps its meaning."""
        return read_model(cls, data, stored=True)

    @classmethod
    def kept(cls, canonical: bytes) -> Self:
        """The :meth:`stored` document of canonical bytes, whose digest is its own. Raises InvalidDocument."""
        found = cls.stored(read_json(canonical))
        found.__dict__["_canonical"] = canonical
        return found

    @cached_property
    def _canonical(self) -> bytes:
        return write_json(self.plain())

    def plain(self) -> dict[str, Any]:
        """Plain data of what was given, defaults left out: what :meth:`canonical` writes."""
        return self.model_dump(exclude_defaults=True, by_alias=True)

    def canonical(self) -> bytes:
        """Canonical bytes of what was given: RFC 8785, numbers as their decimal text, defaults left out."""
        return self._canonical

    @property
    def digest(self) -> str:
        """``sha256:`` and 64 hex digits of the canonical bytes (references of a tree should be pinned before)."""
        return "sha256:" + hashlib.sha256(self._canonical).hexdigest()


M = TypeVar("M", bound=BaseModel)


def read_model(model: type[M], data: Any, *, stored: bool = False, context: Mapping[str, Any] | None = None) -> M:
    """Validate plain data against a pydantic model; pydantic's errors become faults with RFC 6901 pointers.

    ``stored``: the data were accepted before, perhaps by an older version (``stored`` of the validation context).
    ``context``: what else validators are told. A fault below of what a validator takes as a whole has ``below`` in its
    context: the rest of the pointer. What stands alone in the place of a list is a list of one, as MATLAB writes those.
    """
    require_object(data)
    told = {**(context or {}), **({"stored": True} if stored else {})} or None
    try:
        return model.model_validate(data, context=told)
    except ValidationError as error:
        first = error
    found, faults = data, first
    for _ in range(NESTED):
        listed = _lists_of_one(faults, found)
        if listed is found:
            break
        found = listed
        try:
            return model.model_validate(found, context=told)
        except ValidationError as error:
            faults = error
    raise InvalidDocument(faults_of(first, data, model))


def _lists_of_one(error: ValidationError, data: Any) -> Any:
    """The data with lists of one in the places where one is expected and a value stands alone; as they are where these
    are more than MOST_LISTED, since every one of them is a copy.
    """
    if error.error_count() > MOST_LISTED:
        return data
    for each in error.errors(include_url=False):
        if each["type"] in ("tuple_type", "list_type") and isinstance(
            each["input"], str | int | Decimal | float | Mapping
        ):
            data = _listed(data, each["loc"])
    return data


def _listed(data: Any, loc: tuple[int | str, ...]) -> Any:
    """A copy with a list of one at a pydantic location; steps that pydantic adds are passed over."""
    if not loc:
        return data if isinstance(data, list | tuple) else [data]
    step, rest = loc[0], loc[1:]
    if isinstance(data, Mapping) and step in data:
        return {**data, step: _listed(data[step], rest)}
    if isinstance(data, list | tuple) and isinstance(step, int):
        return [*data[:step], _listed(data[step], rest), *data[step + 1 :]]
    return _listed(data, rest)
