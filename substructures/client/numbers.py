"""Numbers that were computed: evaluations for many states, and motions."""

from __future__ import annotations

import json
from collections.abc import Iterator, Mapping
from typing import Any

import numpy as np
from numpy.typing import NDArray

from substructures.client.frames import Array, Tabular, labelled, states
from substructures.formats.arrays import nested, view_npz
from substructures.quantities.quantity import LABELS, TABLE

#: what an evaluation answers beside quantities
BESIDE = ("coordinates", "count", "digest", *LABELS, "failures", "warnings", "range", "states")


class Evaluation(Tabular):
    """Quantities for N states: arrays where arrays were given, otherwise lists; ``failures`` and ``warnings``."""

    coordinates: list[str]
    count: int
    digest: str
    failures: list[dict[str, Any]]
    warnings: list[dict[str, Any]]

    def __init__(self, told: Mapping[str, Any], given: Mapping[str, Any] | None = None) -> None:
        """``given``: the request, whose states are columns of frames."""
        super().__init__(_with_dots(told))
        self._given = {**(given or {}), **self._sampled()}

    def _sampled(self) -> dict[str, Any]:
        """The states of a job that has a grid or a sample."""
        found: dict[str, Any] = {"q": {}, "qd": {}}
        for name, value in self.get("states", {}).items():
            if name.removesuffix("'") in self["coordinates"]:
                found["qd" if name.endswith("'") else "q"][name.removesuffix("'")] = value
        return {name: values for name, values in found.items() if values}

    def __repr__(self) -> str:
        names = ", ".join(name for name in self if name not in BESIDE)
        failed = f", {len(self['failures'])} failures" if self.get("failures") else ""
        return f"Evaluation: {names} for {self['count']:,} states of {len(self['coordinates'])} coordinates{failed}"

    def columns(self) -> dict[str, Array]:
        """``t``, ``q.<coordinate>``, ``qd.<coordinate>`` as given, and every element of every quantity, by names of
        coordinates (``metric.arm.q1.arm.q2``), frames, joints, loads and bodies' parameters, or by its place, which
        counts from 0.
        """
        names, count = [str(name) for name in self["coordinates"]], int(self["count"])
        found = states(self._given, names, count)
        for quantity, value in self._quantities():
            array = np.asarray(value, dtype=np.float64)
            array = array if self._has_rows() else array[np.newaxis]
            found.update(labelled(quantity, array, self._labels(quantity, array.shape[1:])))
        return found

    def _has_rows(self) -> bool:
        """Whether arrays have the axis of states, which is left out for one state given as (n,)."""
        q = _number(self._given.get("q"))
        by_name = isinstance(q, Mapping)
        ndim = np.ndim(_number(next(iter(q.values())))) if by_name and q else np.ndim(q)
        return self["count"] > 1 or ndim > (0 if by_name else 1)

    def _quantities(self) -> Iterator[tuple[str, Any]]:
        for name, value in self.items():
            if name not in BESIDE and isinstance(value, Mapping):
                yield from ((f"{name}.{part}", x) for part, x in value.items())
            elif name not in BESIDE:
                yield name, value


def _with_dots(told: Mapping[str, Any]) -> dict[str, Any]:
    """The answer with quantities whose names have dots, which arrays in files are nested by."""
    found = dict(told)
    for name in TABLE:
        group, dot, rest = name.partition(".")
        if dot and isinstance(told.get(group), Mapping) and rest in told[group]:
            found[name] = told[group][rest]
            found.pop(group, None)
    return found


def _number(value: Any) -> Any:
    """What stands in a number with a unit; all else as it is."""
    return value["value"] if isinstance(value, Mapping) and "value" in value else value


class Motion(Tabular):
    """A motion with its checks: ``t`` (K,), ``q`` and ``qd`` (K, n), ``series`` by name (K, ...)."""

    coordinates: list[str]
    count: int
    status: str
    message: str
    is_right: bool | None
    checks: list[dict[str, Any]]
    events: list[dict[str, Any]]
    warnings: list[dict[str, Any]]
    t: Array
    q: Array
    qd: Array
    series: dict[str, Array]

    def __repr__(self) -> str:
        kept = sum(check["holds"] is True for check in self["checks"])
        made = sum(check["holds"] is not None for check in self["checks"])
        verdict = f"is_right={self['is_right']}: {kept} of {made} checks hold"
        return f"Motion: {len(self['t']):,} states of {', '.join(self['coordinates'])}, {self['status']}; {verdict}"

    def columns(self) -> dict[str, Array]:
        """``t``, ``q.<coordinate>``, ``qd.<coordinate>`` and the series: ``energy``, ``reaction_force.<joint>.x``,
        ``powers.<load>``.

        Places without names count from 0.
        """
        names = [str(name) for name in self["coordinates"]]
        found = states(self, names, len(self["t"]))
        for series, array in self.get("series", {}).items():
            found.update(labelled(series, array, self._labels(series, array.shape[1:])))
        return found


def motion_of(content: bytes) -> Motion:
    """The motion in an npz file of the service."""
    told = arrays_of(content)
    return Motion({**told, "coordinates": [str(name) for name in told["coordinates"]]})


def arrays_of(content: bytes | NDArray[np.uint8]) -> dict[str, Any]:
    """The result of an analysis in an npz file: arrays by name, and what its ``summary`` tells."""
    data = np.frombuffer(content, np.uint8) if isinstance(content, bytes) else content
    found = nested(view_npz(data))
    return {**json.loads(str(found.pop("summary"))), **found}
