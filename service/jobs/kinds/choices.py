"""Items from a template: every combination of the choices, put into copies of it.

A choice is named by an RFC 6901 pointer into the template (``/request/parameters/arm.m2``), or, in a tree document, by
an instance (what it is: a part, or an object of ``substructure, at, placement, parameters`` in place of the template's)
or ``instance.parameter`` (what that is bound to). The last choice varies fastest; a choice may lie in the value of one
before it.
"""

from __future__ import annotations

import copy
import re
from collections.abc import Mapping, Sequence
from itertools import product
from math import prod
from typing import Any

from substructures.documents import pointer_step
from substructures.errors import InvalidDocument, among, listed

MAX_NAME = 64
#: what a choice of an instance may replace
OWN = ("substructure", "at", "placement", "parameters")


def combinations(template: Mapping[str, Any], choices: Mapping[str, list[Any]], limit: int) -> list[Any]:
    """Copies of the template. Raises InvalidDocument with pointers ``/template`` and ``/choices``."""
    count = prod(len(values) for values in choices.values())
    if count > limit:
        raise InvalidDocument.at("/choices", "too-many-items", f"{count:,} combinations; the limit is {limit:,}")
    paths = {key: _path(template, key) for key in choices}
    for key, values in choices.items():
        _check_own(key, values)
    rows = [dict(zip(choices, row, strict=True)) for row in product(*choices.values())]
    items = [_filled(template, paths, row) for row in rows]
    return _named(items, rows) if _is_tree(template) and "/name" not in choices else items


def _is_tree(template: Mapping[str, Any]) -> bool:
    return isinstance(template.get("name"), str) and isinstance(template.get("instances"), list)


def _path(template: Mapping[str, Any], key: str) -> list[str]:
    """The steps of a choice from the template to the value."""
    if key.startswith("/"):
        return [step.replace("~1", "/").replace("~0", "~") for step in key.split("/")[1:]]
    instance, dot, parameter = key.partition(".")
    instances = template.get("instances")
    for k, each in enumerate(instances if isinstance(instances, list) else []):
        if isinstance(each, dict) and each.get("name") == instance:
            return ["instances", str(k), *(("parameters", parameter) if dot else ("substructure",))]
    raise _unknown(key, f"the template has no instance '{instance[:80]}'")


def _is_instance(key: str) -> bool:
    return not key.startswith("/") and "." not in key


def _check_own(key: str, values: Sequence[Any]) -> None:
    """Raise InvalidDocument for members that a choice of an instance has not got."""
    for k, value in enumerate(values):
        for name in value if _is_instance(key) and isinstance(value, Mapping) else ():
            if name not in OWN:
                place = f"/choices{pointer_step(key)}/{k}{pointer_step(name)}"
                message = f"a choice of an instance has {listed(OWN)}, and no '{name[:80]}'{among(name, OWN)}"
                raise InvalidDocument.at(place, "unknown-field", message)


def _unknown(key: str, message: str) -> InvalidDocument:
    return InvalidDocument.at("/choices" + pointer_step(key), "unknown-choice", message)


def _filled(template: Any, paths: Mapping[str, Sequence[str]], row: Mapping[str, Any]) -> Any:
    item = copy.deepcopy(template)
    for key, value in row.items():
        *steps, last = paths[key]
        try:
            here = item
            for step in steps:
                if step == "parameters" and isinstance(here, dict):
                    here.setdefault(step, {})  # may be left out
                here = here[_member(here, step)]
            if _is_instance(key) and isinstance(value, Mapping):
                here |= copy.deepcopy(dict(value))
            else:
                here[_member(here, last, is_new=True)] = value
        except LookupError:
            place = "".join(map(pointer_step, paths[key]))[:200]
            raise _unknown(key, f"the template, with the choices before this one, has no place '{place}'") from None
    return item


def _member(here: Any, step: str, is_new: bool = False) -> str | int:
    """The key or index that a step means; a new key may be one that is not there. Raises LookupError."""
    if isinstance(here, list) and step.isascii() and step.isdigit() and len(step) < 6 and int(step) < len(here):
        return int(step)
    if isinstance(here, dict) and (is_new or step in here):
        return step
    raise LookupError(step)


def _named(items: list[Any], rows: list[dict[str, Any]]) -> list[Any]:
    """Tree names out of the choices, ``cell-puma560-gripper``; numbered where these would be too long or not differ."""
    names = ["-".join([item["name"], *map(_word, row.values())]) for item, row in zip(items, rows, strict=True)]
    if len(set(names)) < len(names) or max(map(len, names)) > MAX_NAME:
        width = len(str(len(items)))
        names = [f"{item['name'][: MAX_NAME - width - 1]}-{k:0{width}d}" for k, item in enumerate(items, start=1)]
    return [{**item, "name": name} for item, name in zip(items, names, strict=True)]


def _word(value: Any) -> str:
    if isinstance(value, Mapping):
        return "-".join(_word(value[name]) for name in ("substructure", "at") if name in value) or _word(list(value))
    return re.sub(r"[^a-z0-9]+", "-", str(value).lower()).strip("-") or "x"
