"""Results of analyses as JSON, npz, CSV, Arrow and pictures."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, fields, is_dataclass
from importlib import import_module
from typing import Any

import numpy as np
import orjson

from substructures.analysis.motion.trajectory import Trajectory
from substructures.analysis.motion.writers import to_csv
from substructures.formats import arrays, arrow
from substructures.tree.model import Model

#: of pictures alone
DRAWINGS = "substructures.analysis.drawings"
JSON, CSV, SVG = "application/json", "text/csv", "image/svg+xml"
#: formats by their names in files and items of jobs
MEDIA_TYPES = {"json": JSON, "npz": arrays.MEDIA_TYPE, "csv": CSV, "svg": SVG, "arrow": arrow.MEDIA_TYPE}
#: what every result can be, what trajectories can be, and what root loci and their like can be
PLAIN = (JSON, arrays.MEDIA_TYPE)
TRAJECTORY = (*PLAIN, CSV, SVG, arrow.MEDIA_TYPE)
DRAWN = (*PLAIN, SVG)
#: by class, properties that are written beside the fields, each with the field that it is written before
PROPERTIES: dict[str, dict[str, str]] = {
    "Linearisation": {"is_equilibrium": "modes"},
    "ConstrainedLinearisation": {"is_steady": "modes"},
    "BallLinearisation": {"is_steady": "modes"},
    "Identification": {"is_right": "checks"},
    "ConsistentInertia": {"is_right": "checks"},
    "Orbit": {"is_right": "checks"},
    "Family": {"is_right": "found"},
    "LyapunovExponents": {"is_right": "checks"},
    "FoundPlaces": {"is_right": "message", "checks": "message"},
    "CostGradient": {"is_right": "trajectory", "checks": "trajectory"},
    "ReducedEquations": {"is_right": "checks"},
    "Optimum": {"is_right": "trajectory", "checks": "trajectory"},
    "BestParameters": {"is_right": "checks"},
    "FrequencyResponse": {"magnitude": "response", "phase": "response"},
    "Regulator": {"is_right": "checks"},
    "Mode": {"frequency": "shape", "hertz": "shape", "damping_ratio": "shape"},
}


@dataclass(frozen=True)
class Answered:
    """A result with warnings about what it was asked for (pointer, code, message)."""

    result: Any
    warnings: Sequence[Mapping[str, str]] = ()


def written(result: Any, media: str, model: Model) -> bytes:
    """A result, with its warnings if it is Answered, in a media type that it can have."""
    warnings: Sequence[Mapping[str, str]] = ()
    if isinstance(result, Answered):
        result, warnings = result.result, result.warnings
    if media == JSON:
        return orjson.dumps(_told(result, warnings), option=orjson.OPT_SERIALIZE_NUMPY, default=_listed)
    if media == arrays.MEDIA_TYPE:
        return _npz(_told(result, warnings))
    motion = trajectory_of(result)
    if media == SVG:
        drawn: str = import_module(DRAWINGS).draw(result if motion is None else motion, model.joints)
        return drawn.encode()
    if motion is None:
        raise ValueError(f"no motion to be written as {media}")
    if media == CSV:
        return to_csv(motion).encode()
    return _arrow(motion, warnings)


def _told(result: Any, warnings: Sequence[Mapping[str, str]]) -> Any:
    members = plain(result)
    return {**members, "warnings": list(warnings)} if isinstance(members, dict) else members


def trajectory_of(result: Any) -> Trajectory | None:
    """The motion in a result, if there is one."""
    result = result.result if isinstance(result, Answered) else result
    motion = result if isinstance(result, Trajectory) else getattr(result, "trajectory", None)
    return motion if isinstance(motion, Trajectory) else None


def plain(value: Any) -> Any:
    """Dataclasses as objects by field, complex numbers as pairs; arrays stay. In JSON what is not finite is null."""
    if isinstance(value, Trajectory):
        return {**value.summary(), "t": value.t, "q": value.q, "qd": value.qd, "series": dict(value.series)}
    for name in ("summary", "plain"):
        if callable(method := getattr(value, name, None)):
            return plain(method())
    if is_dataclass(value):
        return {name: plain(getattr(value, name)) for name in _members(value)}
    if isinstance(value, Mapping):
        return {str(name): plain(item) for name, item in value.items()}
    if isinstance(value, list | tuple):
        return [plain(item) for item in value]
    if isinstance(value, complex):
        return [value.real, value.imag]
    return _pairs(value) if isinstance(value, np.ndarray) else value


def _members(value: Any) -> list[str]:
    """The fields of a dataclass, and its properties that are written, too."""
    names = [f.name for f in fields(value)]
    for kind in type(value).__mro__:
        for name, before in PROPERTIES.get(kind.__name__, {}).items():
            names.insert(names.index(before), name)
    return names


def _pairs(value: np.ndarray[Any, Any]) -> np.ndarray[Any, Any]:
    if value.dtype.kind == "c":
        return np.stack([value.real, value.imag], axis=-1)
    return np.ascontiguousarray(value) if value.ndim else value


def _listed(value: Any) -> Any:
    """What orjson does not write itself: arrays in other orders, scalars of numpy."""
    if isinstance(value, np.ndarray | np.generic):
        return value.tolist()
    raise TypeError(f"no JSON for {type(value).__name__}")


def _npz(members: Mapping[str, Any]) -> bytes:
    """Arrays by the names of the JSON answer, nested ones joined by dots, and ``summary``: the rest, as JSON."""
    data = arrays.flat(members)
    found = {name: np.asarray(x) for name, x in data.items() if _is_array(x)}
    rest = {name: x for name, x in data.items() if name not in found}
    found["summary"] = np.array(orjson.dumps(rest, option=orjson.OPT_SERIALIZE_NUMPY, default=_listed).decode())
    return b"".join(arrays.write_npz(found).pieces)


def _is_array(x: Any) -> bool:
    return isinstance(x, np.ndarray) or (isinstance(x, list) and bool(x) and all(isinstance(item, str) for item in x))


def _arrow(motion: Trajectory, warnings: Sequence[Mapping[str, str]]) -> bytes:
    """A row for every time: t, q, qd, and ``series.<name>``; the rest in the metadata of the schema, as JSON."""
    columns = {"t": motion.t, "q": motion.q, "qd": motion.qd}
    columns |= {f"series.{name}": np.asarray(x, dtype=np.float64) for name, x in motion.series.items()}
    metadata = {**plain(motion.summary()), "warnings": list(warnings)}
    return b"".join(map(bytes, arrow.write_tables([arrow.ArrowTable(columns)], metadata)))
