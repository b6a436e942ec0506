"""The interface of models and parts, and their quantities as functions."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

from substructures.export.interface import TIME, Interface, Vector
from substructures.part.part import Part
from substructures.quantities.states import default_number
from substructures.tree.model import EFFORTS, Model

_RATES = {"q": ("", "rad", "m"), "qd": ("'", "rad/s", "m/s"), "qdd": ("''", "rad/s^2", "m/s^2")}


def interface_of_model(model: Model, reference: str = "", digest: str = "") -> Interface:
    """Vectors in the order of the tree: its coordinates, inputs (of loads, then actuators), all its parameters."""
    efforts = [f"tau.{name}" for name in model.coordinates]
    inputs = [*dict.fromkeys(name for name in (*model.inputs, *efforts))]
    vectors = _states(model.coordinates, model.joints) | _others(model.parameters, inputs, model.units)
    return Interface(vectors, reference, digest or model.program.digest, model.frames)


def interface_of_part(part: Part, reference: str = "", digest: str = "") -> Interface:
    """Vectors in the order of the definition."""
    efforts = {f"tau.{name}": EFFORTS[kind] for name, kind in zip(part.coordinates, part.joints, strict=True)}
    inputs = {name: str(given.unit or "") for name, given in part.definition.inputs.items()} | efforts
    units = {name: str(given.get("unit", "")) for name, given in part.parameters.items()} | inputs
    vectors = _states(part.coordinates, part.joints) | _others(part.parameters, list(inputs), units)
    return Interface(vectors, reference, digest or part.definition.digest, part.frames)


def _states(coordinates: Sequence[str], joints: str) -> dict[str, Vector]:
    found = {"t": TIME}
    for symbol, (primes, turn, slide) in _RATES.items():
        names = tuple(f"{name}{primes}" for name in coordinates)
        found[symbol] = Vector(symbol, names, tuple(slide if kind == "P" else turn for kind in joints))
    return found


def _others(
    parameters: Mapping[str, Mapping[str, Any]], inputs: Sequence[str], units: Mapping[str, str]
) -> dict[str, Vector]:
    values = [p.get("value") for p in parameters.values()]
    defaults = tuple(float("nan") if value is None else default_number(value) for value in values)
    names = tuple(parameters)
    return {
        "u": Vector("u", tuple(inputs), tuple(units.get(name, "") for name in inputs)),
        "p": Vector("p", names, tuple(units.get(name, "") for name in names), defaults),
    }
