"""What an evaluation gives: arrays by quantity, and the states that have no result."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping
from dataclasses import asdict, dataclass, field
from typing import Any

import numpy as np
from numpy.typing import NDArray

from substructures.errors import listed

#: an array, or several by the name of the field
Value = Any


@dataclass(frozen=True, slots=True)
class Failure:
    """A state in which a quantity has no finite result. ``state``: its place, ``code`` is for programs."""

    state: int
    quantity: str
    code: str
    message: str


@dataclass(frozen=True, slots=True)
class ParameterColumns:
    """Names and SI units of the inertial parameters, which are the columns of the regressor."""

    names: tuple[str, ...]
    units: tuple[str, ...]


def plain_names(names: Any) -> Any:
    """Names of places along an axis as plain data, with units where they have some."""
    if isinstance(names, ParameterColumns):
        return {"names": list(names.names), "units": list(names.units)}
    return list(names)


@dataclass(frozen=True)
class Evaluation:
    """Numbers of a model for N states, or for one.

    ``result["metric"]`` is an array (N, n, n), or (n, n) where one state was given without the axis of states;
    ``result["kinematics"]`` a mapping of arrays: ``position`` (N, frames, 3), ``rotation`` (N, frames, 3, 3), ``U`` and
    ``Omega`` (N, frames, n, 3); ``result["momentum"]`` one of ``linear`` and ``angular`` (N, 3).

    ``coordinates`` name the axes n, ``labels`` all others by their names in
    :mod:`substructures.quantities.quantity`: ``frames``, ``columns`` (of the regressor), ``joints``, ``loads``, ...
    ``count`` = N; ``digest``: of the model's program; ``failures``: where numbers are not finite; ``single``: no axis
    of states;
    ``warnings`` (pointer, code, message; state and quantity of some): parameters that no body can have, limits that
    states leave, accelerations that are doubtful, and more.
    """

    coordinates: tuple[str, ...]
    count: int
    digest: str
    quantities: Mapping[str, Value] = field(hash=False)
    failures: tuple[Failure, ...] = ()
    labels: Mapping[str, Any] = field(default_factory=dict, hash=False)
    single: bool = False
    warnings: tuple[Mapping[str, Any], ...] = ()

    def __getitem__(self, quantity: str) -> Value:
        """The array of a quantity, or a mapping of arrays. Raises KeyError for one that was not asked for."""
        return self.quantities[quantity]

    @property
    def frames(self) -> tuple[str, ...] | None:
        """The places of kinematics: bodies and ports."""
        return self.labels.get("frames")

    @property
    def columns(self) -> ParameterColumns | None:
        """The inertial parameters that columns of the regressor belong to."""
        return self.labels.get("columns")

    @property
    def joints(self) -> tuple[str, ...] | None:
        """The rows of reactions."""
        return self.labels.get("joints")

    @property
    def loads(self) -> tuple[str, ...] | None:
        """The rows of powers."""
        return self.labels.get("loads")

    def __repr__(self) -> str:
        shapes = ", ".join(f"{name} {shape}" for name, shape in _shapes(self.quantities))
        failed = f", {len(self.failures)} failures" if self.failures else ""
        failed += f", {len(self.warnings)} warnings" if self.warnings else ""
        warned = "".join(f"\n  warning: {warning['message']}" for warning in self.warnings[:3])
        return f"Evaluation of {self.count} state(s) of {listed(self.coordinates)}{failed}\n  {shapes}{warned}"

    def plain(self, digest: str | None = None) -> dict[str, Any]:
        """Plain data by name: what was asked, quantities, failures; arrays stay arrays.

        ``digest``: of what the caller asked for, when it is another than the program.
        """
        about: dict[str, Any] = {"coordinates": list(self.coordinates), "count": self.count}
        about["digest"] = self.digest if digest is None else digest
        about |= {axis: plain_names(names) for axis, names in self.labels.items()}
        about["warnings"] = [dict(warning) for warning in self.warnings]
        return {**about, **self.quantities, "failures": [asdict(failure) for failure in self.failures]}


def _shapes(values: Mapping[str, Value]) -> Iterable[tuple[str, tuple[int, ...]]]:
    for name, value in values.items():
        if isinstance(value, Mapping):
            yield from ((f"{name}.{field}", shape) for field, shape in _shapes(value))
        else:
            yield name, np.shape(value)


def without_axis(value: Value) -> Value:
    """The value of the only state: arrays (1, ...) without their first axis."""
    return {name: v[0] for name, v in value.items()} if isinstance(value, dict) else value[0]


def failures_of(results: Mapping[str, Value], advice: Callable[[str, int], tuple[str, str]]) -> tuple[Failure, ...]:
    """A failure for every quantity and state with a number that is not finite; arrays have the axis N.

    ``advice``: code and message for a quantity in a state.
    """
    bad = ((name, int(state)) for name, value in results.items() for state in _not_finite(value))
    return tuple(Failure(state, name, *advice(name, state)) for name, state in bad)


def _not_finite(value: Value) -> NDArray[np.int64]:
    """The states that have a number which is not finite."""
    bad = np.zeros(0, dtype=np.int64)
    for some in value.values() if isinstance(value, dict) else (value,):
        with np.errstate(invalid="ignore", over="ignore"):
            total = some.sum()  # much quicker than a look at every number, and finite only if all are
        if not np.isfinite(total):
            bad = np.union1d(bad, np.flatnonzero(~np.isfinite(some).all(axis=tuple(range(1, some.ndim)))))
    return bad
