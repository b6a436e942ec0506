"""What analyses are given about a model: states, names, numbers by name. Faults point to the argument."""

from __future__ import annotations

from collections.abc import Collection, Mapping, Sequence
from typing import Any

from substructures.analysis.arguments import by_name, real
from substructures.array import Array
from substructures.documents import escape
from substructures.errors import Fault, InvalidArgument, among

#: coordinates, velocities or accelerations: (n,), (N, n), or a number or column (N,) for each coordinate by name
StateArray = Sequence[float] | Sequence[Sequence[float]] | Array | Mapping[str, Any]


def unknown(field: str, kind: str, given: Mapping[str, Any] | Sequence[str], known: Collection[str]) -> list[Fault]:
    """Faults ``unknown-<kind>``: at ``/field/i`` of a sequence of names, at ``/field/name`` of values by name."""
    places = zip(map(escape, given), given, strict=True) if isinstance(given, Mapping) else enumerate(given)
    missing = [(place, str(name)) for place, name in places if name not in known]
    return [
        Fault(f"/{field}/{place}", f"unknown-{kind}", f"unknown {kind} '{name[:80]}'{among(name, known, k)}")
        for k, (place, name) in enumerate(missing)
    ]


def require_known(field: str, kind: str, given: Mapping[str, Any] | Sequence[str], known: Collection[str]) -> None:
    """Raises InvalidArgument for names that are not known, see :func:`unknown`, and for what is no list of names."""
    if isinstance(given, str) or not isinstance(given, Collection):
        message = f"names in a list are needed, found {repr(given)[:80]}"
        raise InvalidArgument.at(f"/{field}", "list-expected", message)
    faults = unknown(field, kind, given, known)
    if faults:
        raise InvalidArgument(faults)


def numbers(given: Mapping[str, Any] | None, field: str) -> dict[str, float]:
    """Finite numbers by name. Raises InvalidArgument (``/field``, ``/field/name``)."""
    return {name: real(value, f"/{field}/{escape(name)}") for name, value in by_name(given, field).items()}
