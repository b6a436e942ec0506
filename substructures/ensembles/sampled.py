"""Members that are drawn: columns of samples become starts, parameters and inputs."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import numpy as np

from substructures.analysis.motion.problems.kinds import ConstrainedMotion
from substructures.array import Array
from substructures.documents import escape
from substructures.documents.units import read_unit
from substructures.ensembles.samples import Distribution, Sampler, Samples
from substructures.errors import Fault, InvalidArgument, among
from substructures.expr.units.dimensions import Dimensioned
from substructures.expr.units.unit_check import dimension_of
from substructures.quantities.numbers.quaternions import at_zero
from substructures.quantities.numbers.states import longest, read_states
from substructures.tree.model import Model

MOST = 10_000_000
STATE = {"q": "", "qd": "'"}


def with_samples(
    model: Model, samples: Samples | None, given: Mapping[str, Any], kind: ConstrainedMotion | None = None
) -> dict[str, Any]:
    """The arguments ``q, qd, v, parameters, inputs`` of an ensemble with the samples in their places, numbers in SI.

    ``samples.of``: coordinates, velocities (``arm.q1'``), parameters, inputs by name; what is sampled of a state stands
    in place of what is given, 0 where nothing is. ``kind``: with constraints velocities are quasi-velocities. Raises
    InvalidArgument (``/samples/of/name``, ``/samples/count``).
    """
    if samples is None:
        return dict(given)
    named = {} if kind is None else dict.fromkeys(kind.velocities or (), "")
    _check(model, samples, given, named)
    sampler = Sampler(samples)
    drawn = sampler.rows(0, sampler.size)
    found = dict(given)
    for field in ("parameters", "inputs"):
        known = model.parameters if field == "parameters" else model.input_names
        found[field] = {**(given.get(field) or {}), **{name: x for name, x in drawn.items() if name in known}}
    if kind is not None:
        places = {*named, *(f"{name}'" for name in model.coordinates)}
        found["v"] = _quasi_velocities(given.get("v"), {name: x for name, x in drawn.items() if name in places})
    for field, primes in STATE.items() if kind is None else [("q", "")]:
        names = model.positions if field == "q" else model.coordinates
        columns = {a: drawn[c + primes] for a, c in enumerate(names) if c + primes in drawn}
        if columns or field == "q":
            found[field] = _state(model, field, given.get(field), columns, sampler.size)
    return found


def _quasi_velocities(v: Any, drawn: Mapping[str, Array]) -> Any:
    """Those that are given, with what is drawn in place of them. Raises InvalidArgument (``/v``)."""
    if not drawn:
        return v
    if v is not None and not isinstance(v, Mapping):
        raise InvalidArgument.at("/v", "by-name", "give quasi-velocities beside samples of others by name")
    return {**(v or {}), **drawn}


def _state(model: Model, field: str, given: Any, columns: Mapping[int, Array], count: int) -> Array:
    start = {"q": at_zero(model.positions, model.balls)} | ({} if given is None else {field: given})
    states = read_states(model, start, 1)
    base = states.q if field == "q" else states.qd
    state = np.repeat(base, count, axis=0)
    for a, column in columns.items():
        state[:, a] = column
    return state


def _check(model: Model, samples: Samples, given: Mapping[str, Any], named: Mapping[str, str]) -> None:
    units = {**model.units, **named}
    for field, primes in STATE.items():
        units |= {f"{name}{primes}": unit for name, unit in model.state_units[field].items()}
    faults = []
    for k, (name, of) in enumerate(samples.of.items()):
        pointer = f"/samples/of/{escape(name)}"
        if name not in units:
            message = f"the tree has no coordinate, velocity, parameter or input '{name[:80]}'{among(name, units, k)}"
            faults.append(Fault(pointer, "unknown-name", message))
        elif not _fits(of, units[name]):
            message = f"a unit of {units[name] or 'a plain number'} is needed for '{name}', found {of.unit}"
            faults.append(Fault(f"{pointer}/unit", "wrong-unit", message))
    if Sampler(samples).size > MOST:
        faults.append(Fault("/samples/count", "too-many", f"at most {MOST:,} members"))
    if longest(given) > 1:
        faults.append(Fault("/samples", "given-twice", "either samples, or lists of states, parameters and inputs"))
    if faults:
        raise InvalidArgument(faults)


def _fits(of: Distribution, unit: str) -> bool:
    place = dimension_of(unit)
    return not of.unit or not isinstance(place, Dimensioned) or read_unit(of.unit).dimension == place.dimension
