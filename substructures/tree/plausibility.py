"""What values may be beside being numbers: masses and inertias of rigid bodies, coordinates within their limits.

Computed straight from the definitions and the bindings of a tree, never through stored formulas. What is wrong is no
error but a warning ``{"pointer", "code", "message"}``: the equations hold for any numbers.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from functools import cached_property, lru_cache
from typing import Any

import numpy as np
from flint import arb, ctx

from substructures.array import Array
from substructures.documents.fields import in_si
from substructures.expr.direct import ball, steps_of, value
from substructures.expr.known import Known
from substructures.expr.steps import ExpressionError, needed_first
from substructures.expr.units.unit_check import Notice
from substructures.loads.names import names_in
from substructures.part.definition import Definition
from substructures.part.inertias import Tensor, faults_of, impossible, more
from substructures.part.limits import limits_in_numbers
from substructures.part.mass import PRECISION, ball_sum, number_of, rounded
from substructures.part.parameters import names_in_limits
from substructures.tree.document import TreeSpec

#: definitions of which it is remembered what they are by default
KEPT = 256
#: so much, relative to 1 and its size, a coordinate may be beside the value that a relation gives it
APART = 1e-6


class _Values(Mapping[str, Any]):
    """Values of parameters by their names in a tree: given, bound, or by default; computed when asked for."""

    def __init__(self, texts: Mapping[str, Any], given: Mapping[str, Any], read: Callable[..., Any] = value) -> None:
        self._texts, self._found, self._read = texts, dict(given), read

    def __getitem__(self, name: str) -> Any:
        for each in needed_first(name, self._unknown_in) if name not in self._found else ():
            self._found[each] = self._read(self._texts[each], self)
        return self._found[name]

    def _unknown_in(self, name: str) -> list[str]:
        return [each for each in names_in(self._texts[name]) if each in self._texts and each not in self._found]

    def __contains__(self, name: object) -> bool:
        return name in self._found or name in self._texts

    def __iter__(self) -> Iterator[str]:
        return iter({**self._texts, **self._found})

    def __len__(self) -> int:
        return len({**self._texts, **self._found})


def _names_of(values: _Values, prefix: str, names: Iterable[str]) -> dict[str, Any]:
    """The same by their names in one definition, without a ``prefix``; those that have a value."""
    found = {}
    for name in names:
        try:
            found[name] = values[f"{prefix}{name}"]
        except (KeyError, ExpressionError):
            continue
    return found


def _defaults(definition: Definition, read: Callable[..., Any], names: Iterable[str]) -> dict[str, Any]:
    """Values of its parameters by default."""
    texts = {name: in_si(each.value) for name, each in definition.parameters.items() if each.value is not None}
    return _names_of(_Values(texts, {}, read), "", names)


@lru_cache(maxsize=KEPT)
def _at_defaults(known: Known) -> tuple[tuple[str, Sequence[tuple[str, str]]], ...]:
    """Code and message of what its bodies cannot have, where no parameter is given."""
    definition: Definition = known.source
    names = _defaults(definition, value, definition.parameters)
    found = [(body.name, *faults_of(body, names, 0)) for body in definition.bodies]
    tensors = iter(impossible([tensor for *_, tensor in found if tensor is not None], 0))
    told = ((body, (*faults, *(() if tensor is None else next(tensors)))) for body, faults, tensor in found)
    return tuple((body, faults) for body, faults in told if faults)


@lru_cache(maxsize=KEPT)
def _mass_at_defaults(known: Known) -> Any:
    definition: Definition = known.source
    names = _defaults(definition, ball, _in_masses(definition))
    return ball_sum((body.mass, names) for body in definition.bodies)


def _in_masses(definition: Definition) -> set[str]:
    texts = (mass for body in definition.bodies if isinstance(mass := in_si(body.mass), str))
    return {str(step.value) for text in texts for step in steps_of(text) if step.op == "name"}


@dataclass(frozen=True)
class Plausibility:
    """A tree document with the definitions of its instances by name."""

    spec: TreeSpec
    definitions: Mapping[str, Definition] = field(hash=False)

    @cached_property
    def _texts(self) -> dict[str, Any]:
        """Bindings and defaults by name in the tree, in SI."""
        texts = {name: each.value for name, each in self.spec.parameters.items()}
        for instance in self.spec.instances:
            own = self.definitions[instance.name].parameters
            given = {name: each.value for name, each in own.items()} | instance.parameters
            texts |= {f"{instance.name}.{name}": x for name, x in given.items()}
        return {name: in_si(x) for name, x in texts.items() if x is not None}

    @cached_property
    def mass(self) -> float | None:
        """Of all bodies in kg where no parameter is given; None where that of one is not known then."""
        values, total = _Values(self._texts, {}, ball), arb(0)
        for instance in self.spec.instances:
            definition = self.definitions[instance.name]
            if instance.parameters:
                names = _names_of(values, f"{instance.name}.", _in_masses(definition))
                mass = ball_sum((body.mass, names) for body in definition.bodies)
            else:
                mass = _mass_at_defaults(Known(definition.digest, definition))
            if mass is None:
                return None
            with ctx.workprec(PRECISION):
                total += mass
        return rounded(total)

    @property
    def has_relations(self) -> bool:
        """Whether relations move joints of its parts."""
        return any(each.relations for each in self.definitions.values())

    def masses(self, given: Mapping[str, Any]) -> Any:
        """Of all bodies in kg, with the parameters ``given`` (numbers, or (N,)) and defaults; NaN without a value."""
        values, pairs = _Values(self._texts, given), self.definitions.items()
        names = {name: _names_of(values, f"{name}.", _in_masses(each)) for name, each in pairs}
        found = [number_of(body.mass, names[name]) for name, each in pairs for body in each.bodies]
        return sum((np.nan if x is None else x for x in found), 0.0)

    @cached_property
    def at_defaults(self) -> tuple[Notice, ...]:
        """:meth:`inertias` where no parameter is given."""
        return tuple(self.inertias({}))

    @cached_property
    def limiting(self) -> frozenset[str]:
        """The parameters that limits depend on."""
        pairs = self.definitions.items()
        return frozenset(f"{instance}.{name}" for instance, each in pairs for name in names_in_limits(each))

    @cached_property
    def limits_at_defaults(self) -> dict[str, tuple[Any, Any, str]]:
        """:meth:`limits` where no parameter is given."""
        return self.limits({})

    def inertias(self, given: Mapping[str, Any], first: int = 0) -> list[Notice]:
        """Bodies and rotors that there cannot be with the parameters ``given`` (numbers, or (N,)) and defaults.

        Pointers lead into the tree document, to the instance. ``first``: what states are counted from.
        """
        values, found = _Values(self._texts, given), list[tuple[str, str, Sequence[tuple[str, str]], Tensor | None]]()
        for i, instance in enumerate(self.spec.instances):
            definition, told = self.definitions[instance.name], f"instance '{instance.name}', body"
            if not given and not instance.parameters:
                known = _at_defaults(Known(definition.digest, definition))
                found += [(f"/instances/{i}", f"{told} '{body}'", faults, None) for body, faults in known]
                continue
            names = _names_of(values, f"{instance.name}.", definition.parameters)
            for body in definition.bodies:
                found.append((f"/instances/{i}", f"{told} '{body.name}'", *faults_of(body, names, first)))
        tensors = iter(impossible([tensor for *_, tensor in found if tensor is not None], first))
        return [
            {"pointer": pointer, "code": code, "message": f"{told}: {message}"}
            for pointer, told, faults, tensor in found
            for code, message in (*faults, *(() if tensor is None else next(tensors)))
        ]

    def limits(self, given: Mapping[str, Any]) -> dict[str, tuple[Any, Any, str]]:
        """Lowest and highest value of every coordinate that has limits, and its unit; (N,) where parameters are."""
        values, found = _Values(self._texts, given), dict[str, tuple[Any, Any, str]]()
        for instance in self.spec.instances:
            definition = self.definitions[instance.name]
            names = _names_of(values, f"{instance.name}.", definition.parameters)
            found |= {f"{instance.name}.{q}": ends for q, ends in limits_in_numbers(definition, names).items()}
        return found

    def left(self, coordinates: tuple[str, ...], q: Array, given: Mapping[str, Any], first: int = 0) -> list[Notice]:
        """Coordinates beyond their limits in states ``q`` (N, n); ``first``: what states are counted from."""
        limits = self.limits(given) if given else self.limits_at_defaults
        ends = _ends(limits, coordinates) if given else self._ends_at_defaults(coordinates)
        # mostly none is beyond: one comparison of all states and coordinates, before any name is looked up
        if np.logical_and.reduce((q >= ends[0]) & (q <= ends[1]), axis=None):
            return []
        notices = []
        for a, name in enumerate(coordinates):
            if name not in limits:
                continue
            low, high, unit = limits[name]
            bad = np.flatnonzero((q[:, a] < low) | (q[:, a] > high))
            if len(bad):
                k = int(bad[0])
                range_ = " to ".join(f"{np.broadcast_to(x, len(q))[k]:.6g}" for x in (low, high))
                value = f"{q[k, a]:.6g} {unit} in state {first + k}{more(len(bad))}"
                message = f"'{name}' is {value}; its joint has limits {range_}"
                notices.append({"pointer": "/q", "code": "limits-left", "message": message})
        return notices

    @cached_property
    def _relations(self) -> list[tuple[str, str, float, float]]:
        """Coordinate, the one that it follows, multiplier and offset of what definitions leave out."""
        return [
            (
                f"{name}.{r.coordinate}",
                f"{name}.{r.of}",
                float(value(in_si(r.multiplier))),
                float(value(in_si(r.offset))),
            )
            for name, definition in self.definitions.items()
            for r in (each.relation for each in definition.left_out)
            if r is not None
        ]

    def apart(self, coordinates: Sequence[str], q: Array, first: int = 0) -> list[Notice]:
        """Relations q_a = k q_b + c that definitions leave out and states ``q`` (N, n) do not fit."""
        notices = []
        for name, of, k, c in self._relations:
            if not {name, of} <= set(coordinates):
                continue
            left, right = q[:, coordinates.index(name)], k * q[:, coordinates.index(of)] + c
            bad = np.flatnonzero(np.abs(left - right) > APART * (1 + np.abs(left) + np.abs(right)))
            if len(bad):
                i = int(bad[0])
                message = (
                    f"'{name}' is {left[i]:.6g} in state {first + i}{more(len(bad))}, and not {k:g}*'{of}' + {c:g} = "
                    f"{right[i]:.6g}, as the source of its definition says: both coordinates are free here"
                )
                notices.append({"pointer": "/q", "code": "relation-left", "message": message})
        return notices

    def _ends_at_defaults(self, coordinates: tuple[str, ...]) -> tuple[Array, Array]:
        if coordinates not in self._kept:
            self._kept[coordinates] = _ends(self.limits_at_defaults, coordinates)
        return self._kept[coordinates]

    @cached_property
    def _kept(self) -> dict[tuple[str, ...], tuple[Array, Array]]:
        return {}


def _ends(limits: Mapping[str, tuple[Any, Any, str]], coordinates: Sequence[str]) -> tuple[Array, Array]:
    """Lower and upper limits (n,), or (N, n) where parameters differ from state to state; infinite without limits."""
    none = (-np.inf, np.inf, "")
    low, high = (np.broadcast_arrays(*(limits.get(name, none)[k] for name in coordinates)) for k in (0, 1))
    return np.stack(low, -1) if low else np.zeros(0), np.stack(high, -1) if high else np.zeros(0)
