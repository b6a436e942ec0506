"""Plain data to frozen values: pydantic models, their faults with pointers, and the identity of whole documents."""

from __future__ import annotations

import hashlib
from collections.abc import Callable, Mapping
from decimal import Decimal
from functools import cache, cached_property
from typing import Any, Self, TypeVar

from pydantic import BaseModel, ConfigDict, ValidationError

from substructures.documents.text import escape
from substructures.documents.to_json import write_json
from substructures.errors import Fault, InvalidDocument, listed, meant

#: so many characters of a value are shown in a message
SHOWN = 80
#: lists of lists that a value may stand alone for
NESTED = 3
#: values that are put into lists of one
MOST_LISTED = 200


class DocumentPart(BaseModel):
    """Base of all parts of documents: frozen, unknown fields refused."""

    model_config = ConfigDict(frozen=True, extra="forbid")


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

    @cached_property
    def _canonical(self) -> bytes:
        return write_json(self.model_dump(exclude_defaults=True, by_alias=True))

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
    if not isinstance(data, Mapping):
        raise InvalidDocument.at("", "object-expected", "expected a JSON object")
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
    raise InvalidDocument(_faults(first, data, model))


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


def _faults(error: ValidationError, data: Any, model: type[BaseModel]) -> list[Fault]:
    return [
        Fault(
            _pointer(e["loc"], e["type"] == "missing", data) + _tag(e["type"]) + e.get("ctx", {}).get("below", ""),
            e["type"].replace("_", "-"),
            message_of(e, model),
        )
        for e in error.errors(include_url=False)
    ]


def _tag(kind: str) -> str:
    """A union chosen by its field 'type' complains about the object as a whole."""
    return "/type" if kind.startswith("union_tag") else ""


def message_of(error: Mapping[str, Any], model: type[BaseModel] | None = None) -> str:
    """What pydantic's error says, with the name of what is missing or unknown, and otherwise with what was found.

    ``model``: whose fields may have been meant by one that is unknown.
    """
    name, kind, given = error["loc"][-1] if error["loc"] else "", error["type"], error["input"]
    if kind == "missing":
        return f"'{name}' is needed" if isinstance(name, str) else "an entry is missing here"
    if kind == "extra_forbidden":
        fields = () if model is None else _field_names(model)
        return f"unknown field '{str(name)[:80]}'" + ("" if name in fields else meant(str(name), fields))
    if "below" in error.get("ctx", ()):
        return str(error["msg"])
    if kind == "model_type" and model is not None:
        fields = _schema(model).get("$defs", {}).get(error["ctx"]["class_name"], {}).get("properties", ())
        return f"an object is needed, with {listed(fields)}{_found(given)}"
    if kind in _EXPECTED:
        return f"{_EXPECTED[kind]}{_found(given)}"
    if kind == "literal_error":
        expected = str(error["ctx"]["expected"])
        names = expected.replace(" or ", ", ").replace("'", "").split(", ")
        return f"expected {expected}{_found(given)}{meant(str(given), names)}"
    if kind == "string_pattern_mismatch" and error["ctx"]["pattern"] in PATTERNS:
        return f"{PATTERNS[error['ctx']['pattern']](str(given))}{_found(given)}"
    return str(error["msg"]) + _found(given)


_EXPECTED = {
    **dict.fromkeys(("tuple_type", "list_type"), "a list is needed, as in [1, 2, 3]"),
    **dict.fromkeys(("model_type", "dict_type", "mapping_type"), "an object is needed"),
}
#: by pattern, what is said about a text that does not match it
PATTERNS: dict[str, Callable[[str], str]] = {}


@cache
def _schema(model: type[BaseModel]) -> dict[str, Any]:
    """The JSON schema of a document, which takes milliseconds to make."""
    return model.model_json_schema()


@cache
def _field_names(model: type[BaseModel]) -> tuple[str, ...]:
    """The names of all fields of a document, wherever they stand."""
    schema = _schema(model)
    parts = [schema, *schema.get("$defs", {}).values()]
    return tuple(dict.fromkeys(name for part in parts for name in part.get("properties", ())))


def _found(given: Any) -> str:
    """What was found, as JSON and not longer than a line; nothing where it is no plain data."""
    try:
        shown = write_json(given).decode()
    except InvalidDocument:
        return ""
    return f", found {shown if len(shown) <= SHOWN else shown[:SHOWN] + '...'}"


def _pointer(loc: tuple[int | str, ...], missing: bool, data: Any) -> str:
    """The pointer of a pydantic location, without the steps that pydantic adds for unions and map keys."""
    pointer, here = "", data
    for step in loc[:-1] if missing else loc:
        known = step in here if isinstance(here, Mapping) else isinstance(here, (list, tuple)) and isinstance(step, int)
        if known:
            pointer, here = f"{pointer}/{escape(step)}", here[step]
    return f"{pointer}/{escape(loc[-1])}" if missing else pointer
