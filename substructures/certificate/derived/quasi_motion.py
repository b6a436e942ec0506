"""What accelerations in quasi-velocities, and their variations, have to be, from the certified equations in them."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from functools import partial
from typing import Any

from flint import arb

from substructures.certificate.derived.model_at import ModelAt, solve, times, total
from substructures.certificate.derived.model_formulas import Expectation, columns_of, vector_of
from substructures.certificate.linear import Ball
from substructures.certificate.numbers import Numbers
from substructures.certificate.outputs import Outputs
from substructures.certificate.stored import Stored
from substructures.certificate.texts import slope


def solved(source: Stored, velocities: Sequence[str]) -> Expectation:
    """q', v' with g* v' + bias = forces, q'' and the power of the equations ``source``."""
    return partial(_solved, source, velocities)


def varied(source: Stored, velocities: Sequence[str], parameters: Sequence[str]) -> Expectation:
    """q', v' and their variations along the symbols ``d.*`` of states and parameters."""
    return partial(_varied, source, velocities, parameters)


def first_order(source: Stored, velocities: Sequence[str], texts: Sequence[Any], inputs: Sequence[str]) -> Expectation:
    """A, B, C, D of x = (q, v), x' and y; ``texts``: of y."""
    return partial(_first_order, source, velocities, texts, inputs)


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
    dv = _accelerations(here, velocities)
    vector_of(result, "rates", here.vector("rates"))
    vector_of(result, "acceleration", dv)
    moved = here.along({name: m.values[f"d.{name}"] for name in (*m.coordinates, *velocities, *parameters)})
    vector_of(result, "rates_variation", moved.vector("rates"))
    vector_of(result, "variation", _changed(here, moved, dv))
    return result


def _first_order(
    source: Stored, velocities: Sequence[str], texts: Sequence[Any], inputs: Sequence[str], m: ModelAt
) -> Outputs:
    result, here = Outputs(), ModelAt(source, m.coordinates, m.values)
    rates, dv = here.vector("rates"), _accelerations(here, velocities)
    names, n = [f"{name}'" for name in m.coordinates], m.n + len(velocities)
    values = {**m.values, **dict(zip(names, rates, strict=True))}

    def columns(name: str) -> tuple[list[Ball], list[Ball]]:
        """Of A and C, or of B and D."""
        moved = here.by(name)
        along = dict(zip(names, moved.vector("rates"), strict=True))
        along |= {} if name in velocities else {name: arb(1)}
        seen = [total(slope(text, values, c) * x for c, x in along.items()) for text in texts]
        return [*moved.vector("rates"), *_changed(here, moved, dv)], seen

    for whole, part, some in (("A", "C", (*m.coordinates, *velocities)), ("B", "D", inputs)):
        found = [columns(name) for name in some]
        columns_of(result, whole, n, [column for column, _ in found])
        columns_of(result, part, len(texts), [seen for _, seen in found])
    vector_of(result, "derivative", [*rates, *dv])
    vector_of(result, "output", [Numbers(values).read(text) for text in texts])
    return result


def _changed(here: ModelAt, moved: ModelAt, dv: Sequence[Ball]) -> list[Ball]:
    """dv' with g* dv' = -(dg* v' + dbias - dforces)."""
    inertia, bias, forces = times(moved.matrix("metric"), dv), moved.elements("bias"), moved.elements("forces")
    change = [x + _at(bias, i) - _at(forces, i) for i, x in enumerate(inertia[: len(dv)])]
    return solve(here.matrix("metric"), [-x for x in change])


def _accelerations(here: ModelAt, velocities: Sequence[str]) -> list[Ball]:
    """v'."""
    bias, forces = here.elements("bias"), here.elements("forces")
    return solve(here.matrix("metric"), [_at(forces, i) - _at(bias, i) for i in range(len(velocities))])


def _at(found: Mapping[tuple[int, ...], Ball], i: int) -> Ball:
    return found.get((i,), arb(0))
