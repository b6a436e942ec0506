"""Numbers in arguments: finite, and in SI where they come as ``{"value": 30, "unit": "deg"}``, one or a list of them.

One mechanism for states, times, inputs, parameters and whatever else has a dimension: what stands in a place is told by
the SI unit there, and :func:`si_values` takes the arguments as they came and hands them on in SI.
"""

from __future__ import annotations

import math
import sys
from collections.abc import Iterator, Mapping
from decimal import Decimal
from fractions import Fraction
from numbers import Real
from typing import Any

import numpy as np

from substructures.array import Array
from substructures.documents import escape
from substructures.documents.fields import unit_advice
from substructures.documents.units import Unit, UnknownUnitError, read_unit
from substructures.errors import InvalidArgument
from substructures.expr.construction.exact import nearest_float
from substructures.expr.units.dimensions import Dimensioned
from substructures.expr.units.unit_check import dimension_of

#: the SI unit of a place, empty where it is not known: one for all numbers, or by name (of lists: in that order)
PlaceUnits = str | Mapping[str, "PlaceUnits"]
_PLAIN = frozenset((float, int, Decimal, str, bool, type(None)))


def si_values(given: Any, units: PlaceUnits, pointer: str) -> Any:
    """The same with numbers in SI in the places of ``{"value", "unit"}``; all else is handed on as it came.

    Raises InvalidArgument: ``number-expected``, ``unknown-unit``, ``unit-mismatch``, with the place and its name.

    >>> si_values([{"value": 1200, "unit": "mm"}, 2], "m", "/q")
    [1.2, 2]
    """
    if _is_plain(given):
        return given
    if isinstance(given, Mapping):
        return _of_mapping(given, units, pointer)
    each = list(units.items()) if isinstance(units, Mapping) else []
    return [
        si_values(x, units if isinstance(x, list | tuple) or not each else dict(each[i : i + 1]), f"{pointer}/{i}")
        for i, x in enumerate(given)
    ]


def _is_plain(given: Any) -> bool:
    """Whether nothing in it can have a unit: numbers, lists of them, and lists of these, are told by their types."""
    kind = type(given)
    if kind is not list and kind is not tuple:
        return kind in _PLAIN or not isinstance(given, Mapping | list | tuple)
    if _PLAIN.issuperset(map(type, given)):
        return True
    return all(type(row) is list and _PLAIN.issuperset(map(type, row)) for row in given)


def _of_mapping(given: Mapping[str, Any], units: PlaceUnits, pointer: str) -> Any:
    """A quantity, or values by name."""
    is_quantity = "value" in given or "unit" in given
    if isinstance(units, str):
        return _si_numbers(given, {"": units}, pointer) if is_quantity else given
    if is_quantity and not units.keys() & {"value", "unit"}:
        return _si_numbers(given, units, pointer)
    return {name: si_values(x, units.get(name, ""), f"{pointer}/{escape(name)}") for name, x in given.items()}


def _si_numbers(given: Mapping[str, Any], units: Mapping[str, PlaceUnits], pointer: str) -> Any:
    """One number, or as many as there are, in SI; ``units``: of the places where they stand."""
    if set(given) != {"value", "unit"} or not isinstance(given["unit"], str):
        raise InvalidArgument.at(pointer, "number-expected", "a number is needed, or 'value' and 'unit'")
    try:
        found = read_unit(given["unit"])
    except UnknownUnitError as error:
        raise InvalidArgument.at(pointer, "unknown-unit", str(error)) from None
    for message in _contradictions(found, given["unit"], units):
        raise InvalidArgument.at(pointer, "unit-mismatch", message)
    values = numeric(given["value"], f"{pointer}/value")
    scaled = _all_scaled(values, found) if values.ndim else np.asarray(_scaled(given["value"], found))
    if not np.isfinite(scaled).all():
        raise InvalidArgument.at(f"{pointer}/value", "number-not-finite", "in SI the number is not finite")
    if not scaled.ndim:
        return float(scaled)
    return scaled if isinstance(given["value"], np.ndarray) else scaled.tolist()


def _contradictions(found: Unit, text: str, units: Mapping[str, PlaceUnits]) -> Iterator[str]:
    for name, unit in units.items():
        expected = dimension_of(unit) if isinstance(unit, str) else None
        if isinstance(expected, Dimensioned) and expected.dimension != found.dimension:
            yield f"{expected} expected{f' for {name!r}' if name else ''}, found {text}"


def _all_scaled(values: Array, unit: Unit) -> Array:
    """Numbers in SI; one by one where the factor itself is beyond the range of doubles, or has lost digits there."""
    if math.isinf(unit.scale) or unit.scale < sys.float_info.min:
        return np.array([_scaled(x, unit) for x in values.flat], dtype=np.float64).reshape(values.shape)
    with np.errstate(over="ignore"):
        return values * unit.scale


def _scaled(given: Any, unit: Unit) -> float:
    """One number in SI, correctly rounded; a float stands for its shortest decimal text."""
    exact = Fraction(repr(float(given)) if isinstance(given, float | np.floating) else str(given)) * unit.factor
    return nearest_float(exact) * math.pi**unit.pi if unit.pi else nearest_float(exact)


def numeric(given: Any, pointer: str) -> Array:
    """A finite array of doubles from nested lists of numbers, or of arrays. Raises InvalidArgument with the first
    fault's place.
    """
    if type(given) is float and math.isfinite(given):  # most are
        return np.array(given)
    if isinstance(given, np.ndarray) and given.dtype.kind in "fiu":
        values = given.astype(np.float64, copy=False)
    else:
        _check_numbers(given, pointer)
        try:
            values = np.asarray(given, dtype=np.float64)
        except (ValueError, TypeError, OverflowError):
            raise InvalidArgument.at(pointer, "wrong-length", "a rectangular array of numbers is needed") from None
    if not np.isfinite(values).all():
        where = "".join(f"/{int(i)}" for i in np.argwhere(~np.isfinite(values))[0])
        raise InvalidArgument.at(pointer + where, "number-not-finite", "the number is not finite")
    return values


def _check_numbers(given: Any, pointer: str, depth: int = 0) -> None:
    if isinstance(given, np.ndarray) and given.dtype.kind in "fiu":
        return
    if isinstance(given, (list, tuple)) and depth < 3:
        for i, x in enumerate(given):
            if not isinstance(x, (int, float, Decimal, Real)) or isinstance(x, bool):
                _check_numbers(x, f"{pointer}/{i}", depth + 1)
    elif isinstance(given, bool) or not isinstance(given, (int, float, Decimal, Real)):
        raise InvalidArgument.at(pointer, "number-expected", f"a number is needed, found {_shown(given)}")


def _shown(given: Any) -> str:
    if given is None:
        return "null, as MATLAB writes NaN"
    return repr(given)[:40] + (unit_advice(given) if isinstance(given, str) else "")
