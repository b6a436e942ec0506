"""States and values as arrays: shapes, names and numbers are checked, faults have pointers.

Arguments are given by name, as in the call ``evaluate(model, quantities, q=..., parameters=...)``: ``q, qd, qdd, t,
inputs, parameters``. What is wrong with one is an InvalidArgument, whose pointer starts with the name.
"""

from __future__ import annotations

from collections.abc import Collection, Iterable, Mapping, Sequence
from dataclasses import dataclass
from decimal import Decimal
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from substructures.array import Array
from substructures.documents import escape
from substructures.errors import Fault, InvalidArgument, MissingValue, among, listed
from substructures.expr.program import Program
from substructures.quantities.measured import PlaceUnits, numeric, si_values
from substructures.quantities.numbers.defaults import (
    default_numbers,
    input_defaults,
)
from substructures.quantities.numbers.quaternions import with_unit_quaternions
from substructures.tree.model import Model

#: states: (n,), (N, n), or by coordinate name a number or (N,) numbers
StateInput = ArrayLike | Mapping[str, ArrayLike]
#: by name: one number, or (N,), one for every state
ValueInput = Mapping[str, ArrayLike]
NO_UNITS: Mapping[str, str] = {}
STATE = ("q", "qd", "qdd")
NAMED = 20  # coordinates in a message
#: arguments by name
ArgumentsByName = Mapping[str, Any]


@dataclass(frozen=True)
class States:
    """``count`` = N states by coordinate: (N, n), or (1, n) where all are alike; ``single``: one state was given
    without the leading axis.
    """

    q: Array
    qd: Array
    qdd: Array | None
    count: int
    single: bool


def read_states(model: Model, given: ArgumentsByName, limit: int | None) -> States:
    """q, qd, qdd of arguments. One q holds for all velocities, times, inputs, ... Raises InvalidArgument."""
    q = _state(model, given.get("q"), "q")
    if q is None:
        if model.dof:
            raise InvalidArgument.at("/q", "missing", "states 'q' are needed")
        q = np.zeros((1, 0)), True
    rates = {name: x[0] for name in STATE[1:] if (x := _state(model, given.get(name), name)) is not None}
    # one q stands for as many states as anything else has, also numbers of one coordinate
    most = max(longest(given), *(len(x) for x in rates.values() if limit != 1), 1)
    count = most if len(q[0]) == 1 else len(q[0])
    if limit is not None and count > limit:
        told = f"{count:,} states; the limit is {limit:,}"
        if limit == 1:
            why = f", as {_count_of(model.coordinates)}" if model.dof == 1 else ""
            told = f"{count:,} states{why}; one is needed here, several are a job with an item for each"
        raise InvalidArgument.at("/q", "too-many-states", told)
    if limit == 1 and not count:
        raise InvalidArgument.at("/q", "missing", "a state is needed")
    for name, rows in rates.items():
        if len(rows) not in (1, count):
            raise InvalidArgument.at(f"/{name}", "wrong-length", f"{len(rows)} states where there are {count}")
    qd = rates.get("qd", np.zeros((1, model.dof)))
    return States(q[0], qd, rates.get("qdd"), count, q[1] and count == 1)


def argument_units(model: Model) -> dict[str, PlaceUnits]:
    """The SI units of arguments by name, also of a direction ``along``, for :func:`si_values`."""
    states: dict[str, PlaceUnits] = {**model.state_units}
    direction: dict[str, PlaceUnits] = {**states, "inputs": model.units}
    return {**direction, "parameters": model.units, "t": "s", "along": direction}


def longest(given: ArgumentsByName) -> int:
    """The length of the longest list of states, times, inputs or parameters, at least 1; nothing is checked."""
    lengths = [1, _entries(given.get("t"))]
    for name in (*STATE, "inputs", "parameters"):
        found = given.get(name)
        if found is None:
            continue
        if isinstance(found, Mapping) and (name not in STATE or "value" not in found):
            lengths += map(_entries, found.values())
        elif name in STATE:
            rows = found.get("value") if isinstance(found, Mapping) else found
            if isinstance(rows, list | tuple | np.ndarray) and _entries(rows) and _entries(rows[0]):
                lengths.append(len(rows))
    return max(lengths)


def _entries(given: Any) -> int:
    """The length of a list, also of one with a unit, 0 if it is none."""
    if isinstance(given, list | tuple):
        return len(given)
    if isinstance(given, np.ndarray):
        return len(given) if given.ndim else 0
    # most are numbers, whose types are told sooner than that they are no mapping
    if isinstance(given, float | int | Decimal) or not isinstance(given, Mapping) or "value" not in given:
        return 0
    return 0 if isinstance(given["value"], Mapping) else _entries(given["value"])


def _state(model: Model, given: Any, name: str) -> tuple[Array, bool] | None:
    """(N, n) array of a state, and whether it was (n,); with n = 1 also of a number, or of (N,)."""
    if given is None:
        return None
    given = si_values(given, model.state_units[name], f"/{name}")
    if isinstance(given, Mapping):
        given = by_name(model, given, name)
    values, names = numeric(given, f"/{name}"), model.positions if name == "q" else model.coordinates
    if len(names) == 1 and (values.ndim == 0 or (values.ndim == 1 and len(values) != 1)):
        # one number for one coordinate, or one for each state, as MATLAB writes lists of one
        return values.reshape(-1, 1), values.ndim == 0
    if values.ndim not in (1, 2) or values.shape[-1] != len(names):
        if values.ndim in (1, 2):
            message = wrong_length(values.shape[-1], names)
        else:
            expected = f"(N, {len(names)}) or ({len(names)},)"
            message = f"shape {values.shape} found, {expected} expected, since {_count_of(names)}"
        raise InvalidArgument.at(f"/{name}", "wrong-length", message)
    balls, rows = model.balls if name == "q" else (), np.atleast_2d(values)
    return with_unit_quaternions(names, balls, rows), values.ndim == 1


def wrong_length(found: int, coordinates: Sequence[str]) -> str:
    """What is said of a state that has another number of numbers than there are coordinates.

    >>> wrong_length(1, ("x", "phi"))
    '1 number found, but there are 2 coordinates: x, phi'
    """
    return f"{found} number{'' if found == 1 else 's'} found, but {_count_of(coordinates)}"


def _count_of(coordinates: Sequence[str]) -> str:
    count = len(coordinates)
    more = ", ..." if count > NAMED else ""
    named = f": {', '.join(coordinates[:NAMED])}{more}" if count else ""
    return f"there {'is' if count == 1 else 'are'} {count} coordinate{'' if count == 1 else 's'}{named}"


def _given(coordinate: str, model: Model) -> str:
    """What is said of the state of a coordinate that is driven or ignored, or depends on others."""
    for level in model.reduced:
        if coordinate in level["dependent"]:
            movers = listed(f"'{name}'" for name in level["independent"])
            return f"'{coordinate}' depends on {movers} (reduced level): leave it out"
    what, field = ("motion", "driven") if coordinate in model.driven else ("momentum", "ignored")
    return f"the {what} of '{coordinate}' is given ('{field}'): leave it out"


def by_name(model: Model, given: Mapping[str, Any], name: str) -> Array:
    """(N, n) of columns by coordinate, in the order of the model; (n,) of numbers. Raises InvalidArgument below
    ``/name``.
    """
    names = model.positions if name == "q" else model.coordinates
    unknown = [str(key) for key in given if key not in names]
    taken = {*model.given, *model.dependent}
    faults = [
        Fault(
            f"/{name}/{escape(key)}",
            "unknown-coordinate",
            _given(key, model) if key in taken else f"unknown coordinate '{key[:80]}'{among(key, names, k)}",
        )
        for k, key in enumerate(unknown)
    ]
    faults += [Fault(f"/{name}", "missing", f"no value for coordinate '{c}'") for c in names if c not in given]
    if faults:
        raise InvalidArgument(faults)
    # columns by coordinate, in the order of the model: (N,) each, or numbers
    columns = {c: numeric(given[c], f"/{name}/{escape(c)}") for c in names}
    for c, column in columns.items():
        first = columns[names[0]]
        if column.shape != first.shape:
            message = f"shape {column.shape} found, but {first.shape} of '{names[0]}'"
            raise InvalidArgument.at(f"/{name}/{escape(c)}", "wrong-length", message)
    return np.stack(list(columns.values()), axis=-1) if columns else np.zeros((1, 0))


def symbol_values(model: Model, given: ArgumentsByName, states: States, needs: Iterable[str]) -> dict[str, Any]:
    """Values of all symbols that the needed outputs of the model depend on. Raises InvalidArgument, MissingValue."""
    values, shape, names = known_values(model, given, states, model.parameters), model.of_shape, list(needs)
    # what the formulas of the shape need is all that those with the numbers may
    if not values.keys() | shape.numbers.keys() >= set(shape.program.needs(names)):
        require(model.program, names, values)
    return values


def known_values(
    model: Model,
    given: ArgumentsByName,
    states: States,
    parameters: Mapping[str, Mapping[str, Any]],
    defaults: Mapping[str, float] | None = None,
) -> dict[str, Any]:
    """Values of coordinates, velocities, accelerations if given, time, inputs, and of ``parameters`` with a default or
    a value among the arguments; ``defaults``: these, where they are at hand. Raises InvalidArgument.
    """
    count = states.count
    values: dict[str, Any] = {}
    # q^a, q'^a, q''^a are the symbols arm.q1, arm.q1', arm.q1''
    for primes, columns in (("", states.q), ("'", states.qd), ("''", states.qdd)):
        if columns is not None:
            rows = columns if len(columns) == count else columns[0]  # numbers that are the same for all states
            names = model.coordinates if primes else model.positions
            values |= {f"{name}{primes}": rows[..., a] for a, name in enumerate(names)}
    values["t"] = read_times(given.get("t"), count)
    if not model.coordinates:
        # nothing else says how many states there are
        values["t"] = np.broadcast_to(values["t"], (count,))
    inputs = model.input_names
    values |= dict.fromkeys(inputs, 0.0) | input_defaults(model.inputs)
    values |= default_numbers(parameters) if defaults is None else defaults
    values |= given_values(given.get("inputs"), "inputs", "/inputs", count, inputs, model.units)
    if given.get("parameters") is not None:
        units = {name: str(p.get("unit", "")) for name, p in parameters.items()}
        values |= given_values(given["parameters"], "parameters", "/parameters", count, parameters, units)
    return values


def require(program: Program, names: Iterable[str], values: Mapping[str, Any]) -> None:
    """Raises MissingValue for the first symbol without a value that the outputs depend on."""
    for name in program.needs(names):
        if name not in values:
            raise MissingValue(name)


def given_values(
    given: Any, field: str, place: str, count: int, known: Collection[str], units: Mapping[str, str] = NO_UNITS
) -> dict[str, Any]:
    """Numbers by name in SI, one or one for every state, or ``{"value", "unit"}`` of these; ``field``: what they are,
    ``place``: pointer to the object, ``units``: SI units by name.
    """
    if given is None:
        return {}
    if not isinstance(given, Mapping):
        raise InvalidArgument.at(place, "object-expected", "an object of numbers by name is needed")
    result = {}
    for name, value in given.items():
        pointer = f"{place}/{escape(name)}"
        if name not in known:
            message = f"unknown {field[:-1]} '{str(name)[:80]}'{among(name, known)}"
            raise InvalidArgument.at(pointer, f"unknown-{field[:-1]}", message)
        result[name] = _per_state(numeric(si_values(value, units.get(name, ""), pointer), pointer), count, pointer)
    return result


def read_times(given: Any, count: int) -> Array:
    """t [s], one or one for every state; 0 where nothing is given."""
    return _per_state(numeric(si_values(0 if given is None else given, "s", "/t"), "/t"), count, "/t")


def _per_state(values: Array, count: int, pointer: str) -> Array:
    if values.ndim > 1 or (values.ndim == 1 and len(values) not in (1, count)):
        message = f"one number, or one for each of the {count} states is needed, found shape {values.shape}"
        raise InvalidArgument.at(pointer, "wrong-length", message)
    return values
