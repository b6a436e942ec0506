"""What the adjoint equations of optimal control have to be, from a model's certified program and texts of costs."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from functools import partial
from typing import Any

from flint import arb, arb_mat

from substructures.certificate.derived.integrals import Rows
from substructures.certificate.derived.model_at import ModelAt, dot, times, total
from substructures.certificate.derived.model_formulas import Expectation, symmetric_of, vector_of
from substructures.certificate.linear import Ball
from substructures.certificate.numbers import Numbers
from substructures.certificate.outputs import Outputs
from substructures.certificate.stored import Stored
from substructures.certificate.texts import slope

#: rows B, b at a state, and the program with B and B' q'
Held = tuple[Rows, Stored]
#: changes of the numbers of a state with ball joints
CHANGES = "position_rates"
COSTS = ("running", "terminal")


def adjoint(
    controls: Sequence[str],
    costs: Mapping[str, Any],
    varied_by: Sequence[str],
    rows: Sequence[str],
    positions: Sequence[str],
    held: Held | None = None,
) -> Expectation:
    """The adjoint equations; ``costs``: texts of ``running`` and ``terminal``; ``rows``: of closures; ``positions``:
    the numbers of q, coordinates but for ball joints. ``held``: (B, b) of velocity constraints in place of closures,
    and the program that has B and B' q', whose changes are those of what is compared.
    """
    return partial(_adjoint, controls, costs, varied_by, rows, positions, held)


def _adjoint(
    controls: Sequence[str],
    costs: Mapping[str, Any],
    varied_by: Sequence[str],
    rows: Sequence[str],
    positions: Sequence[str],
    held: Held | None,
    m: ModelAt,
) -> Outputs:
    result, rates, (running, terminal) = Outputs(), [f"{q}'" for q in m.coordinates], map(costs.get, COSTS)
    costates = [m.values[f"lambda.{name}"] for name in (*positions, *rates)]
    turning = tuple(positions) != tuple(m.coordinates)
    mu, weight = [m.values[f"mu.{name}"] for name in m.coordinates], m.values["lambda.0"]
    read = Numbers(m.values).read

    def rate(name: str) -> Ball:
        """d(lambda_0 l - mu . ID)/dz, and what closures add."""
        needed = m.changed({name: arb(1)}, m.second)
        own = weight * slope(running, m.values, name) - total(x * y for x, y in zip(mu, needed, strict=True))
        own += dot(costates[: len(positions)], _changes(m.by(name), len(positions))) if turning else arb(0)
        return own + _opening(ties.by(name), m, rows, mu) if rows else own

    ties = m if held is None else ModelAt(held[1], m.coordinates, m.values)
    if rows:
        _closures(result, rows, m, held)
    symmetric_of(result, "metric", m.matrix("metric"))
    vector_of(result, "force", [-x for x in m.needed([arb(0)] * m.n)])
    result.scalar("running_cost", read(running))
    changes = _moved(result, m, len(positions)) if turning else m.rates
    pairs = zip(costates, [*changes, *m.second], strict=True)
    result.scalar("hamiltonian", weight * read(running) + total(x * y for x, y in pairs))
    vector_of(result, "adjoint_q", [-rate(name) for name in positions])
    vector_of(result, "adjoint_qd", [-((0 if turning else costates[a]) + rate(x)) for a, x in enumerate(rates)])
    vector_of(result, "control_gradient", [rate(name) for name in controls])
    vector_of(result, "parameter_gradient", [rate(name) for name in varied_by])
    result.scalar("terminal_cost", read(terminal))
    for name, by in (("q", positions), ("qd", rates), ("parameters", varied_by)):
        vector_of(result, f"terminal_{name}", [slope(terminal, m.values, z) for z in by])
    return result


def _moved(result: Outputs, m: ModelAt, size: int) -> list[Ball]:
    """q' of a state with ball joints, which are an output, too."""
    found = _changes(m, size)
    vector_of(result, CHANGES, found)
    return found


def _changes(m: ModelAt, size: int) -> list[Ball]:
    """q' of the numbers of a state with ball joints."""
    found = m.elements(CHANGES)
    return [found.get((k,), arb(0)) for k in range(size)]


def _closures(result: Outputs, rows: Sequence[str], m: ModelAt, held: Held | None) -> None:
    """G and c."""
    size = (len(rows), m.n)
    if held is None:
        G, c = m.matrix("closure.jacobian"), m.elements("closure.acceleration")
        rests = [c.get((k,), arb(0)) for k in range(size[0])]
    else:
        G = arb_mat(*size, [x for row in held[0](m) for x in row[:-1]])
        moving = m.time() | dict(zip(m.coordinates, m.rates, strict=True))
        rests = times(ModelAt(held[1], m.coordinates, m.values).along(moving).matrix("closure.jacobian"), m.rates)
    result.matrix("closure.jacobian", size, (), G)
    vector_of(result, "closure.acceleration", rests)


def _opening(by: ModelAt, m: ModelAt, rows: Sequence[str], mu: Sequence[Ball]) -> Ball:
    """mu . (dG/dz)^T rho - nu . (dG/dz q'' + dc/dz), from the changes ``by`` z of what the model has."""
    rho, nu = ([m.values[f"{prefix}.{row}"] for row in rows] for prefix in ("rho", "nu"))
    change, c = by.matrix("closure.jacobian"), by.elements("closure.acceleration")
    held, opened = times(change, mu), times(change, m.second)
    return total(x * y for x, y in zip(rho, held, strict=True)) - total(
        y * (x + c.get((k,), arb(0))) for k, (x, y) in enumerate(zip(opened, nu, strict=True))
    )
