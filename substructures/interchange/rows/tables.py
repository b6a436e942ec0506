"""Tables of Denavit-Hartenberg parameters as definitions: CSV and JSON, standard and modified, with units.

    modified    Rx(alpha) Tx(a) Rz(theta) Tz(d)           the joint's axis is the third one of its own frame
    standard    Rz(theta) Tz(d) Tx(a) Rx(alpha)           the joint's axis is the third one of the frame before

(J. J. Craig, Introduction to Robotics; J. Denavit and R. S. Hartenberg, 1955). Masses are in the frame of the row.

CSV: comment lines ``# convention: modified``, ``# length: mm``, ``# angle: deg``, then a head and a row for each joint.
JSON: ``{"dh": [rows], "convention": ..., "length": ..., "angle": ...}``. Columns: name, type, a, alpha, d, theta, mass
[kg], cx, cy, cz, Ixx, Iyy, Izz, Ixy, Ixz, Iyz [kg m^2], armature, damping [SI], min, max; what moves has its offset
in the table. A cell may be an expression such as ``pi/2`` or ``L1 + L2`` in SI units, whose names are parameters; a
name alone where a joint moves (theta of a revolute, d of a prismatic one) is that of its coordinate.
"""

from __future__ import annotations

import csv
import re
from collections.abc import Iterable, Iterator, Mapping
from dataclasses import dataclass, field
from decimal import Decimal
from typing import Any

from substructures.documents.patterns import NAME
from substructures.documents.text import decoded
from substructures.documents.units import UnknownUnitError, read_unit
from substructures.errors import meant
from substructures.interchange.names import Names, Symbols, library_name, symbols_in, title_of
from substructures.interchange.numbers import number_of
from substructures.interchange.report import Place, Report, refuse

CONVENTIONS = ("standard", "modified")
_LENGTHS, _ANGLES = ("a", "d", "cx", "cy", "cz"), ("alpha", "theta")
_MOMENTS = ("xx", "yy", "zz", "xy", "xz", "yz")
_LAWS = ("armature", "damping")
_NUMBERS = (*_LENGTHS, *_ANGLES, "mass", "min", "max", *_LAWS, *(f"I{e}" for e in _MOMENTS))
_COLUMNS = ("name", "type", *_NUMBERS)
_TYPES = {"revolute": "revolute", "r": "revolute", "prismatic": "prismatic", "p": "prismatic"}
_MOST_ROWS = 200
_SETTINGS = ("convention", "length", "angle", "name")
_SI = {"length": "m", "angle": "rad", "mass": "kg", "I": "kg m^2"}
#: a name, perhaps with a constant added
_COORDINATE = re.compile(r"\s*([A-Za-z]\w*)\s*([-+].*)?", re.ASCII)


@dataclass
class _Table:
    """Rows as texts with their places, and what holds for all of them."""

    settings: dict[str, str]
    rows: list[tuple[Place, dict[str, str]]] = field(default_factory=list)


def read_csv(data: bytes, symbolic: bool = True) -> tuple[dict[str, Any], Report]:
    """The definition of a CSV table; ``symbolic``: with masses as parameters. Raises InvalidDocument."""
    text = decoded(data)
    settings: dict[str, str] = {}
    kept: list[tuple[int, str]] = []
    for number, line in enumerate(text.lstrip("\ufeff").splitlines(), 1):
        if line.lstrip().startswith("#"):
            key, colon, given = line.lstrip("# \t").partition(":")
            if colon and key.strip().lower() in _SETTINGS:
                settings[key.strip().lower()] = given.strip()
        elif line.strip():
            kept.append((number, line))
    if not 2 <= len(kept) <= _MOST_ROWS + 1:
        raise refuse(
            Place(1, "table"), "no-rows", f"a head and 1 to {_MOST_ROWS} rows are needed, found {len(kept)} lines"
        )
    head_line, head = kept[0]
    delimiter = ";" if ";" in head else "\t" if "\t" in head else ","
    names = [name.strip() for name in head.split(delimiter)]
    _known(Place(head_line, "head"), names)
    table = _Table(settings)
    for number, line in kept[1:]:
        place = Place(number, "row")
        try:
            cells = next(csv.reader([line], delimiter=delimiter), [])
        except csv.Error as error:
            raise refuse(place, "bad-row", f"{error}: a cell is a number or a name") from None
        if len(cells) != len(names):
            raise refuse(place, "wrong-length", f"{len(cells)} cells, the head has {len(names)}")
        table.rows.append((place, {n: c.strip() for n, c in zip(names, cells, strict=True) if c.strip()}))
    return _definition(table, symbolic)


def read_table(document: Mapping[str, Any], symbolic: bool = True) -> tuple[dict[str, Any], Report]:
    """The definition of a JSON table; ``symbolic``: with masses as parameters. Raises InvalidDocument."""
    place = Place(0, "/")
    unknown = [key for key in document if key not in ("dh", *_SETTINGS)]
    if unknown:
        raise refuse(place, "unknown-field", f"unknown field '{unknown[0][:40]}'; there are dh, {', '.join(_SETTINGS)}")
    rows = document["dh"]
    if not isinstance(rows, list) or not 1 <= len(rows) <= _MOST_ROWS:
        raise refuse(Place(0, "/dh"), "no-rows", f"a list of 1 to {_MOST_ROWS} rows is needed")
    table = _Table({key: str(document[key]) for key in _SETTINGS if key in document})
    for i, row in enumerate(rows):
        place = Place(0, f"/dh/{i}")
        if not isinstance(row, Mapping):
            raise refuse(place, "object-expected", "a row is an object")
        _known(place, list(row))
        if any(isinstance(x, Mapping | list | bool) or x is None for x in row.values()):
            raise refuse(place, "bad-number", "numbers and names are needed")
        table.rows.append((place, {k: str(x) for k, x in row.items()}))
    return _definition(table, symbolic)


def _known(place: Place, names: list[str]) -> None:
    for name in names:
        if name not in _COLUMNS:
            there = f"; there are {', '.join(_COLUMNS)}{meant(name, _COLUMNS)}"
            raise refuse(place, "unknown-column", f"unknown column '{name[:40]}'{there}")
    if len(set(names)) < len(names) or not {"a", "alpha", "d", "theta"} <= set(names):
        raise refuse(place, "missing-column", "the columns a, alpha, d and theta are needed, each once")


def _definition(table: _Table, symbolic: bool) -> tuple[dict[str, Any], Report]:
    report, names, symbols = Report(), Names(), Symbols()
    convention = table.settings.get("convention", "")
    if convention not in CONVENTIONS:
        message = f"say 'convention: standard' or 'convention: modified', found '{convention[:40]}'"
        raise refuse(Place(1, "table") if table.rows[0][0].line else Place(0, "/convention"), "convention", message)
    units = _unit(table, "length", "m"), _unit(table, "angle", "rad")
    bodies = list(_bodies(table, names, _Reading(units, symbols, report), convention == "standard"))
    if not any("mass" in row for _, row in table.rows):
        report.warning(table.rows[0][0], "no masses: the part has a geometry, but its metric is zero", "physics")
    title = table.settings.get("name", "")
    ports = [{"name": names.new("tip"), "body": bodies[-1]["name"]}]
    document = {"name": library_name(title, "dh-table"), "title": title_of(title), "bodies": bodies, "ports": ports}
    parameters = symbols.parameters(body["joint"]["coordinate"] for body in bodies if "coordinate" in body["joint"])
    if symbolic:
        parameters |= _parameters(bodies, parameters)
    return document | ({"parameters": parameters} if parameters else {}), report


def _parameters(bodies: list[dict[str, Any]], taken: Iterable[str]) -> dict[str, dict[str, Any]]:
    """Masses, mass centres and moments that are not zero, under names; these take their places in the bodies."""
    found: dict[str, dict[str, Any]] = {}
    names = Names((*taken, *(body["joint"].get("coordinate", "") for body in bodies)))

    def named(wanted: str, x: Any, unit: str) -> Any:
        """A name in the place of a number that is not zero."""
        if not x or isinstance(x, str):
            return x
        name = names.new(wanted)
        found[name] = dict(x) if isinstance(x, Mapping) else {"value": x, "unit": unit}
        return name

    for body in bodies:
        if "mass" in body:
            own = body["name"]
            body["mass"] = named(f"m_{own}", body["mass"], "kg")
            body["com"] = [named(f"c{e}_{own}", x, "m") for e, x in zip("xyz", body["com"], strict=True)]
            body["inertia"] = {e: named(f"I{e}_{own}", x, "kg m^2") for e, x in body["inertia"].items()}
    return found


def _unit(table: _Table, name: str, default: str) -> str:
    """The unit of lengths or angles. Raises InvalidDocument for one of something else."""
    given = table.settings.get(name, default)
    try:
        if read_unit(given).dimension == read_unit(default).dimension:
            return given
    except UnknownUnitError:
        pass
    place = Place(1, "table") if table.rows[0][0].line else Place(0, f"/{name}")
    raise refuse(place, "unknown-unit", f"'{given[:40]}' is no unit of a {name}; expected for example {default}")


def _bodies(table: _Table, names: Names, reading: _Reading, is_standard: bool) -> Iterator[dict[str, Any]]:
    parent = "base"
    coordinates = Names()
    for i, (place, row) in enumerate(table.rows, 1):
        name = names.new(row.get("name", f"link{i}"))
        row, coordinate = _without_coordinate(place, row, reading)
        cell = _Cells(place, row, reading)
        joint = _joint(place, row, cell) | {"coordinate": coordinates.new(coordinate or row.get("name", f"q{i}"))}
        seat = {"theta": cell("alpha", "angle"), "d": cell("a", "length")}
        mass = {"mass": cell("mass", ""), "com": [cell(c, "length") for c in ("cx", "cy", "cz")]}
        mass["inertia"] = {e: cell(f"I{e}", "") for e in _MOMENTS}
        if is_standard:
            moving = names.new(f"{name}_joint")
            yield {"name": moving, "parent": parent, "joint": joint}
            yield {"name": name, "parent": moving, "joint": {"type": "fixed", **seat}, **mass}
        else:
            yield {"name": name, "parent": parent, "joint": joint | seat, **mass}
        parent = name


def _without_coordinate(place: Place, row: dict[str, str], reading: _Reading) -> tuple[dict[str, str], str]:
    """A row with a constant in the place of what moves, and the name of the coordinate, where it stands there."""
    column = "d" if _TYPES.get(row.get("type", "r").lower()) == "prismatic" else "theta"
    text = row.get(column, "0")
    found = _COORDINATE.fullmatch(text)
    if found is None or not symbols_in(found[1]):
        return row, ""
    here = Place(place.line, f"{place.element}, {column}")
    reading.report.merged(here, f"'{found[1][:60]}' is the coordinate; what is added to it is its offset")
    return row | {column: (found[2] or "0").removeprefix("+").strip()}, found[1]


def _joint(place: Place, row: Mapping[str, str], cell: _Cells) -> dict[str, Any]:
    given = row.get("type", "revolute").lower()
    if given not in _TYPES:
        raise refuse(place, "unknown-type", f"type '{given[:40]}' is none of revolute, prismatic")
    kind = _TYPES[given]
    joint: dict[str, Any] = {"type": kind, "phi": cell("theta", "angle"), "tau": cell("d", "length")}
    joint |= {law: cell(law, "") for law in _LAWS if law in row}
    if "min" in row and "max" in row:
        unit = "angle" if kind == "revolute" else "length"
        joint["limits"] = [cell("min", unit), cell("max", unit)]
    elif "min" in row or "max" in row:
        cell.reading.report.warning(place, "one limit alone is left out: give both, min and max")
    return joint


@dataclass(frozen=True)
class _Reading:
    """What holds for all rows: units of lengths and angles, the symbols, the report."""

    units: tuple[str, str]
    symbols: Symbols
    report: Report


@dataclass(frozen=True)
class _Cells:
    """The numbers of a row, with the unit of the table."""

    place: Place
    row: Mapping[str, str]
    reading: _Reading

    def __call__(self, name: str, kind: str) -> Decimal | str | dict[str, Any]:
        """A number, or an expression in constants and parameters; 0 where the cell is empty."""
        text, place = self.row.get(name, "0"), Place(self.place.line, f"{self.place.element}, {name}")
        unit = {"length": self.reading.units[0], "angle": self.reading.units[1]}.get(kind, "")
        found = symbols_in(text)
        if found is None:
            number = number_of(text, place, name)
            return {"value": number, "unit": unit} if unit and number else number
        is_scaled = bool(unit) and not read_unit(unit).is_si
        if is_scaled and "pi" not in text and not found:
            return {"value": text, "unit": unit}
        if is_scaled and found != [text.strip()]:
            message = f"'{text[:60]}' beside numbers in {unit}: write the table in SI units, or a parameter alone"
            raise refuse(place, "unit-of-expression", message)
        for symbol in found:
            if re.match(NAME, symbol) is None:
                raise refuse(place, "bad-name", f"'{symbol[:60]}' is no name: a letter and letters, digits and '_'")
        self.reading.symbols.add(found, text, _SI.get(kind) or _SI.get(name[0] if name != "mass" else name, ""))
        return text.strip()
