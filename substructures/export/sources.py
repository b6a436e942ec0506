"""The interface of models and parts.

Coordinates stand in their order, inputs and parameters in that of their names: documents that say the same but for the
order of members have the same digest, and so the same interface.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

from substructures.export.interface import TIME, Interface, Vector, has_time
from substructures.mechanics.state_names import BallRow, ball_rows, effort_units, positions_of, state_units
from substructures.part.parameters import described_inputs
from substructures.part.part import Part
from substructures.quantities.numbers.defaults import default_number, input_defaults
from substructures.tree.model import Model

_PRIMES = {"q": "", "qd": "'", "qdd": "''"}


def interface_of_model(model: Model, reference: str = "", digest: str = "") -> Interface:
    """The vectors of a tree: its coordinates, inputs (of loads, then actuators), all its parameters."""
    efforts = [name for name in model.units if name.startswith("tau.")]
    inputs = [*sorted(frozenset(model.inputs).difference(efforts)), *efforts]
    states = _states(model.coordinates, model.joints, model.balls)
    vectors = states | _others(model.parameters, inputs, model.units, input_defaults(model.inputs))
    always = ("t", "u") if model.driven else ()
    return Interface(
        vectors, reference, digest or model.program.digest, model.frames, always, has_time(model.program.symbols)
    )


def interface_of_part(part: Part, reference: str = "", digest: str = "") -> Interface:
    """The vectors of a part as it stands alone."""
    efforts = effort_units(part.coordinates, part.joints)
    given = part.definition.inputs
    told = described_inputs(given)
    defaults = {name: default_number(x["default"]) for name, x in told.items() if "default" in x}
    inputs = {name: str(given[name].unit or "") for name in sorted(given)} | efforts
    units = {name: str(given.get("unit", "")) for name, given in part.parameters.items()} | inputs
    balls = ball_rows(part.topology.balls, [joint.coordinate for joint in part.topology.joints])
    vectors = _states(part.coordinates, part.joints, balls) | _others(part.parameters, list(inputs), units, defaults)
    digest = digest or part.definition.digest
    return Interface(vectors, reference, digest, part.frames, has_time=has_time(part.program.symbols))


def _states(coordinates: Sequence[str], joints: str, balls: Sequence[BallRow]) -> dict[str, Vector]:
    found, units = {"t": TIME}, state_units(coordinates, joints, balls)
    upright = {ball["positions"][-4] for ball in balls}
    for symbol, primes in _PRIMES.items():
        # of ball joints quaternions and places stand in place of coordinates
        names = positions_of(coordinates, balls) if symbol == "q" else tuple(f"{name}{primes}" for name in coordinates)
        starts = tuple(float(name in upright) for name in names) if symbol == "q" and balls else ()
        found[symbol] = Vector(symbol, names, tuple(units[symbol].values()), starts)
    return found


def _others(
    parameters: Mapping[str, Mapping[str, Any]],
    inputs: Sequence[str],
    units: Mapping[str, str],
    of_inputs: Mapping[str, float],
) -> dict[str, Vector]:
    """``of_inputs``: the defaults of inputs that have one."""
    names = tuple(sorted(parameters))
    values = [parameters[name].get("value") for name in names]
    defaults = tuple(float("nan") if value is None else default_number(value) for value in values)
    starts = tuple(of_inputs.get(name, 0.0) for name in inputs) if of_inputs else ()
    return {
        "u": Vector("u", tuple(inputs), tuple(units.get(name, "") for name in inputs), starts),
        "p": Vector("p", names, tuple(units.get(name, "") for name in names), defaults),
    }
