"""What accelerations in quasi-velocities, and their variations, have to be, from the certified equations in them."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from functools import partial

from flint import arb

from substructures.certificate.derived.model_at import ModelAt, solve, times
from substructures.certificate.derived.model_formulas import Expectation, vector_of
from substructures.certificate.linear import Ball
from substructures.certificate.outputs import Outputs
from substructures.certificate.stored import Stored


def solved(source: Stored, velocities: Sequence[str]) -> Expectation:
    """q', v' with g* v' + bias = forces, q'' and the power of the equations ``source``."""
    return partial(_solved, source, velocities)


def varied(source: Stored, velocities: Sequence[str], parameters: Sequence[str]) -> Expectation:
    """q', v' and their variations along the symbols ``d.*`` of states and parameters."""
    return partial(_varied, source, velocities, parameters)


def _solved(source: Stored, velocities: Sequence[str], m: ModelAt) -> Outputs:
    result, here = Outputs(), ModelAt(source, m.coordinates, m.values)
    rates, dv = here.vector("rates"), _accelerations(here, velocities)
    vector_of(result, "rates", rates)
    vector_of(result, "acceleration", dv)
    # at v', of which the power of constraints is a function
    moving = here.at({f"{name}'": x for name, x in zip(velocities, dv, strict=True)})
    power = moving.scalar("lost_power")
    if "constraint_power" in source.outputs:
        power = power + moving.scalar("constraint_power")
    result.scalar("power", power)
    direction = {"t": arb(1), **dict(zip(m.coordinates, rates, strict=True)), **dict(zip(velocities, dv, strict=True))}
    vector_of(result, "second", here.along(direction).vector("rates"))
    return result


def _varied(source: Stored, velocities: Sequence[str], parameters: Sequence[str], m: ModelAt) -> Outputs:
    result, here = Outputs(), ModelAt(source, m.coordinates, m.values)
    dv, p = _accelerations(here, velocities), len(velocities)
    vector_of(result, "rates", here.vector("rates"))
    vector_of(result, "acceleration", dv)
    moved = here.along({name: m.values[f"d.{name}"] for name in (*m.coordinates, *velocities, *parameters)})
    vector_of(result, "rates_variation", moved.vector("rates"))
    # g* dv' = -(dg* v' + dbias - dforces)
    inertia, bias, forces = times(moved.matrix("metric"), dv), moved.elements("bias"), moved.elements("forces")
    change = [x + _at(bias, i) - _at(forces, i) for i, x in enumerate(inertia[:p])]
    vector_of(result, "variation", solve(here.matrix("metric"), [-x for x in change]))
    return result


def _accelerations(here: ModelAt, velocities: Sequence[str]) -> list[Ball]:
    """v'."""
    bias, forces = here.elements("bias"), here.elements("forces")
    return solve(here.matrix("metric"), [_at(forces, i) - _at(bias, i) for i in range(len(velocities))])


def _at(found: Mapping[tuple[int, ...], Ball], i: int) -> Ball:
    return found.get((i,), arb(0))
