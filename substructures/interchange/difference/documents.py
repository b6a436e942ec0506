"""Two documents field by field: what is named is compared by its name, wherever it stands."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Any

from substructures.documents.fields import Quantity, in_si
from substructures.documents.units import read_unit

#: fields that no formula depends on
WORDS = frozenset(("name", "title", "description", "tags", "license", "source", "poses", "left_out"))
#: fields whose members have values and units
DECLARED = ("parameters", "inputs")
#: units of numbers of a definition, in words about a change
UNITS = {
    **dict.fromkeys(("com", "position", "d", "sigma", "tau", "at", "length"), "m"),
    **dict.fromkeys(("psi", "theta", "phi", "rpy"), "rad"),
    **dict.fromkeys(("xx", "yy", "zz", "xy", "xz", "yz"), "kg m^2"),
    "mass": "kg",
    "gravity": "m/s^2",
}
#: what one of a list is called
ONE = {
    "bodies": "body",
    "ports": "port",
    "loads": "load",
    "parameters": "parameter",
    "inputs": "input",
    "instances": "instance",
    "closures": "closure",
}


@dataclass(frozen=True, slots=True)
class Change:
    """A field that differs: its path, names in place of numbers where a list has them; ``kind``: changed, new, gone."""

    path: tuple[str | int, ...]
    kind: str
    a: Any = None
    b: Any = None

    @property
    def place(self) -> str:
        """The path as text."""
        return "".join(f"/{step}" for step in self.path)

    @property
    def is_words(self) -> bool:
        """Whether it is about words alone."""
        return self.path[-1] in WORDS or self.path[0] in WORDS

    @property
    def is_default(self) -> bool:
        """Whether a parameter or an input has a default on one side alone."""
        return self.kind != "changed" and self.path[0] in DECLARED and self.path[2:] == ("value",)

    def told(self, units: Mapping[str, str], reference: Callable[[str], str] = str) -> str:
        """In words; ``units``: of parameters, ``reference``: how one with a digest is called."""
        match self.path:
            case ("instances", instance, "definition", _, *_):
                own = {name.removeprefix(f"{instance}."): unit for name, unit in units.items()}
                return f"in instance {instance}: {replace(self, path=self.path[3:]).told(own)}"
            case ("instances", instance, "substructure"):
                return f"instance {instance}: {_parts(*(reference(str(x)) for x in (self.a, self.b)))}"
            case ("instances", instance, "at"):
                return f"instance {instance}: at {self.a or 'world'} -> {self.b or 'world'}"
        name, unit = _called(self.path), _unit(self.path, units)
        if self.is_default:
            a, b = ("none" if x is None else _with_unit(x, unit) for x in (self.a, self.b))
            return f"default of {self.path[1]} {a} -> {b}"
        if self.kind != "changed":
            return f"{name} is {self.kind}" if self.kind == "gone" else f"{name} is new{_new(self.b)}"
        if isinstance(self.a, Mapping) or isinstance(self.b, Mapping):  # with a unit of its own
            return f"{name} {_with_unit(self.a, unit)} -> {_with_unit(self.b, unit)}"
        unit = unit if _is_number(self.a) and _is_number(self.b) else ""
        return f"{name} {_shown(self.a)} -> {_shown(self.b)}{unit}"

    def plain(self, units: Mapping[str, str], reference: Callable[[str], str] = str) -> dict[str, Any]:
        """As JSON data."""
        words = self.told(units, reference)
        return {"place": self.place, "change": self.kind, "a": self.a, "b": self.b, "words": words}


def changes(a: Mapping[str, Any], b: Mapping[str, Any]) -> list[Change]:
    """All fields in which two documents (as plain data, defaults left out) differ."""
    return list(_changes(a, b, ()))


def applied(document: Mapping[str, Any], change: Change) -> dict[str, Any]:
    """A document with one change made in it. Raises LookupError where it has no such place."""
    found: dict[str, Any] = _applied(document, change.path, change)
    return found


def _applied(given: Any, path: tuple[str | int, ...], change: Change) -> Any:
    step, rest = path[0], path[1:]
    if isinstance(given, Mapping):
        if rest:
            return {**given, step: _applied(given.get(step, {}), rest, change)}
        kept = {key: x for key, x in given.items() if key != step}
        return kept if change.kind == "gone" else {**kept, step: change.b}
    places = [k for k, x in enumerate(given) if step in (k, _name(x))]
    if rest:
        return [_applied(x, rest, change) if k == places[0] else x for k, x in enumerate(given)]
    if change.kind == "new":
        return [*given, change.b]
    return [change.b if k == places[0] else x for k, x in enumerate(given) if change.kind != "gone" or k != places[0]]


def _changes(a: Any, b: Any, path: tuple[str | int, ...]) -> Iterator[Change]:
    is_declared = len(path) == 2 and path[0] in DECLARED  # whose value and unit are fields
    if (_is_tree(a) and _is_tree(b)) or (is_declared and isinstance(a, Mapping) and isinstance(b, Mapping)):
        yield from _members(a, b, path)
    elif _is_list_of_trees(a) and _is_list_of_trees(b):
        ours, theirs = _named(a), _named(b)
        yield from _members(ours, theirs, path)
        common = [name for name in ours if name in theirs]
        moved = [name for name in theirs if name in ours]
        if common != moved:
            yield Change((*path, "order"), "changed", common, moved)
    elif not _is_same(a, b):
        yield Change(path, "changed", a, b)


def _members(a: Mapping[Any, Any], b: Mapping[Any, Any], path: tuple[str | int, ...]) -> Iterator[Change]:
    for key in [*a, *(key for key in b if key not in a)]:
        x, y, here = a.get(key), b.get(key), (*path, key)
        if key in a and key in b:
            yield from _changes(x, y, here)
        elif _is_list_of_trees(x or y) and (x or y):
            yield from _changes(x or [], y or [], here)
        elif key in DECLARED and isinstance(x or y, Mapping):
            yield from _changes(x or {}, y or {}, here)
        else:
            yield Change(here, "gone", x) if key in a else Change(here, "new", None, y)


def _is_same(a: Any, b: Any) -> bool:
    """Also of numbers that are written with other units or other decimals."""
    if isinstance(a, list) and isinstance(b, list) and len(a) == len(b):
        return all(_is_same(x, y) for x, y in zip(a, b, strict=True))
    return bool(_number(a) == _number(b))


def _number(given: Any) -> Any:
    if isinstance(given, Mapping) and set(given) == {"value", "unit"}:
        return read_unit(given["unit"]).in_si(given["value"])
    return in_si(given) if isinstance(given, Quantity) else given


def _is_tree(given: Any) -> bool:
    """Whether it has fields of its own; a number with its unit is one value."""
    return isinstance(given, Mapping) and set(given) != {"value", "unit"}


def _is_list_of_trees(given: Any) -> bool:
    return isinstance(given, list) and all(isinstance(x, Mapping) and set(x) != {"value", "unit"} for x in given)


def _name(given: Any) -> Any:
    return given.get("name") if isinstance(given, Mapping) else None


def _named(given: Sequence[Mapping[str, Any]]) -> dict[str | int, Any]:
    """The members of a list by their names, or else by their numbers."""
    return {x.get("name", k): x for k, x in enumerate(given)}


def _called(path: tuple[str | int, ...]) -> str:
    """The place in words: ``mass of link3``, ``parameter l1``."""
    *before, last = path
    if len(path) == 1:
        return str(last)
    if path[0] == "parameters" and len(path) > 1:
        return f"parameter {path[1]}" + (
            f" ({' '.join(map(str, path[2:]))})" if path[2:] not in ((), ("value",)) else ""
        )
    if before and before[-1] in ONE and len(path) == 2:
        return f"{ONE[str(before[-1])]} {last}"
    if path[0] in ONE:
        kind = "" if path[0] == "bodies" else f"{ONE[str(path[0])]} "
        return f"{' '.join(map(str, path[2:]))} of {kind}{path[1]}"
    return " ".join(map(str, path))


def _parts(a: str, b: str) -> str:
    """Which part takes the place of which.

    >>> _parts("arm@1", "arm@2"), _parts("arm@1", "leg@4")
    ('arm version 1 -> 2', 'part arm@1 -> leg@4')
    """
    (name, _, old), (other, _, new) = a.partition("@"), b.partition("@")
    return f"{name} version {_short(old)} -> {_short(new)}" if name == other else f"part {a} -> {b}"


def _short(version: str) -> str:
    """Of a digest the first digits."""
    return f"{version[:15]}..." if version.startswith("sha256:") else version


def _with_unit(given: Any, unit: str) -> str:
    return _shown(given) + (unit if _is_number(given) else "")


def _unit(path: tuple[str | int, ...], units: Mapping[str, str]) -> str:
    if path[0] == "parameters" and path[2:] == ("value",):
        unit = units.get(str(path[1]), "")
    else:
        unit = next((UNITS[str(step)] for step in reversed(path) if step in UNITS), "")
    return f" {unit}" if unit else ""


def _is_number(given: Any) -> bool:
    if isinstance(given, list):
        return all(map(_is_number, given))
    return not isinstance(given, str | bool | Mapping) and given is not None


def _new(given: Any) -> str:
    return f": {_shown(given)}" if not isinstance(given, Mapping | list) or _is_number(given) else ""


def _shown(given: Any) -> str:
    if isinstance(given, list):
        return f"[{', '.join(map(_shown, given))}]"
    if isinstance(given, Mapping):
        return f"{given['value']} {given['unit']}" if set(given) == {"value", "unit"} else "(...)"
    text = str(given)
    return text if len(text) <= 80 else f"{text[:80]}..."
