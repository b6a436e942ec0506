"""What pydantic finds wrong, for people: faults with pointers, in words that say what is wanted instead."""

from __future__ import annotations

import re
from collections.abc import Iterator, Mapping, Sequence
from functools import cache
from typing import Any

from pydantic import BaseModel, ValidationError

from substructures.documents.patterns import PATTERNS
from substructures.documents.text import escape
from substructures.documents.to_json import write_json
from substructures.errors import Fault, InvalidDocument, listed, meant

#: so many characters of a value are shown in a message
SHOWN = 80

Step = int | str
Error = Mapping[str, Any]


def require_object(data: Any) -> None:
    """Raise InvalidDocument for what is no object."""
    if not isinstance(data, Mapping):
        found = "; there is nothing" if data is None else _found(data)
        message = f'an object of fields is needed, as in {{"name": "arm"}}{found}'
        raise InvalidDocument.at("", "object-expected", message)


def faults_of(error: ValidationError, data: Any, model: type[BaseModel]) -> list[Fault]:
    """The faults of a document; of what is none of several alternatives those of the one that it is most like."""
    return [
        Fault(
            _pointer(e["loc"], e["type"] == "missing", data) + _tag(e) + e.get("ctx", {}).get("below", ""),
            e["type"].replace("_", "-"),
            message_of(e, model),
        )
        for e in _likely(error.errors(include_url=False), data)
        if not _is_long_enough(e)
    ]


def _is_long_enough(error: Error) -> bool:
    """Pydantic calls a list too short that would be long enough, were all its entries right."""
    return error["type"] == "too_short" and len(error["input"]) >= error["ctx"]["min_length"]


def _likely(errors: Sequence[Any], data: Any) -> Iterator[Any]:
    """Without the errors of other alternatives: pydantic tells those of all."""
    branches: dict[tuple[Step, ...], dict[Step, list[Any]]] = {}
    for each in errors:
        for place, branch in _choices(each, data):
            branches.setdefault(place, {}).setdefault(branch, []).append(each)
    taken = {place: max(found, key=lambda branch: _fit(found[branch])) for place, found in branches.items()}
    for each in errors:
        if all(taken[place] == branch for place, branch in _choices(each, data)):
            yield each


def _choices(error: Error, data: Any) -> Iterator[tuple[tuple[Step, ...], Step]]:
    """Where on the way to a place there were alternatives, and which it was; those are steps that pydantic adds."""
    here, loc = data, error["loc"][:-1] if error["type"] == "missing" else error["loc"]
    for k, step in enumerate(loc):
        if _has(here, step):
            here = here[step]
        elif step != "[key]":
            yield loc[:k], step


def _fit(errors: Sequence[Any]) -> tuple[float, int]:
    """How well a value fits an alternative: how deep the first value of a wrong kind is, and how few are."""
    wrong = [len(each["loc"]) for each in errors if each["type"].endswith("_type") or each["type"] == "number-expected"]
    return (min(wrong, default=float("inf")), -len(wrong))


def _tag(error: Error) -> str:
    """A union chosen by a field complains about the object as a whole."""
    found = re.fullmatch(r"'(\w+)'", error.get("ctx", {}).get("discriminator", ""))
    return f"/{found[1]}" if found and error["type"] == "union_tag_invalid" else ""


def message_of(error: Mapping[str, Any], model: type[BaseModel] | None = None) -> str:
    """What pydantic's error says, with the name of what is missing or unknown, and otherwise with what was found.

    ``model``: whose fields may have been meant by one that is unknown.
    """
    name, kind, given = error["loc"][-1] if error["loc"] else "", error["type"], error["input"]
    if kind == "missing":
        return f"'{name}' is needed" if isinstance(name, str) else "an entry is missing here"
    if kind == "extra_forbidden":
        fields = () if model is None else _field_names(model)
        like = "" if name in fields else meant(str(name), fields)
        known = () if model is None or len(error["loc"]) > 1 else _schema(model).get("properties", ())
        there = f"; there are {listed(known)}" if known else ""
        return f"unknown field '{str(name)[:80]}'{like or there}"
    if "below" in error.get("ctx", ()):
        return str(error["msg"])
    if kind == "model_type" and model is not None:
        fields = _schema(model).get("$defs", {}).get(error["ctx"]["class_name"], {}).get("properties", ())
        return f"an object is needed, with {listed(fields)}{_found(given)}"
    if kind == "union_tag_invalid":
        return _type_of(error)
    if kind in _EXPECTED:
        return _EXPECTED[kind].format(**error.get("ctx", {})) + _found(given)
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
    "model_attributes_type": "an object with a 'type' is needed",
    "string_type": "a text is needed",
    **dict.fromkeys(("bool_type", "bool_parsing"), "true or false is needed"),
    **dict.fromkeys(("int_type", "int_parsing", "int_from_float"), "a whole number is needed"),
    **dict.fromkeys(("float_type", "float_parsing"), "a number is needed"),
    "too_long": "at most {max_length} entries are allowed",
    "too_short": "at least {min_length} entries are needed",
    "string_too_long": "at most {max_length} characters are allowed",
    "string_too_short": "at least {min_length} characters are needed",
    "less_than_equal": "at most {le} is allowed",
    "greater_than_equal": "at least {ge} is needed",
    "less_than": "less than {lt} is needed",
    "greater_than": "more than {gt} is needed",
}


def _type_of(error: Error) -> str:
    """Of an object that is of no known type, or has none (see ``BY_TYPE`` of :mod:`substructures.documents.fields`)."""
    field, given = error["ctx"]["discriminator"].strip("'"), error["input"]
    names = error["ctx"]["expected_tags"].replace("'", "").split(", ")
    tag = given.get(field) if isinstance(given, Mapping) else getattr(given, field, None)
    if tag != "":
        what = f"'{tag[:SHOWN]}'" if isinstance(tag, str) else _found(tag).removeprefix(", found ")
        return f"unknown {field} {what}; there are {', '.join(names)}{meant(str(tag), names)}"
    near = [name for name in given if meant(str(name), [field])] if isinstance(given, Mapping) else []
    instead = next((f", found '{str(name)[:SHOWN]}'" for name in near if name != field), "")
    return f"'{field}' is needed{instead}; there are {', '.join(names)}"


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
        if _has(here, step):
            pointer, here = f"{pointer}/{escape(step)}", here[step]
    return f"{pointer}/{escape(loc[-1])}" if missing else pointer


def _has(data: Any, step: Step) -> bool:
    """Whether a step leads into the data, and is none that pydantic adds."""
    return step in data if isinstance(data, Mapping) else isinstance(data, list | tuple) and isinstance(step, int)
