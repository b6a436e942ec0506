"""What the adjoint equations of optimal control have to be, from a model's certified program and texts of costs."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from functools import partial
from typing import Any

from flint import arb

from substructures.certificate.derived.model_at import ModelAt, times, total
from substructures.certificate.derived.model_formulas import Expectation, symmetric_of, vector_of
from substructures.certificate.linear import Ball
from substructures.certificate.numbers import Numbers
from substructures.certificate.outputs import Outputs
from substructures.certificate.texts import slope


def adjoint(
    controls: Sequence[str], costs: Mapping[str, Any], varied_by: Sequence[str], rows: Sequence[str]
) -> Expectation:
    """The adjoint equations; ``costs``: texts of ``running`` and ``terminal``; ``rows``: of closures."""
    return partial(_adjoint, controls, costs, varied_by, rows)


def _adjoint(
    controls: Sequence[str], costs: Mapping[str, Any], varied_by: Sequence[str], rows: Sequence[str], m: ModelAt
) -> Outputs:
    result, rates = Outputs(), [f"{name}'" for name in m.coordinates]
    running, terminal = costs["running"], costs["terminal"]
    costates = [m.values[f"lambda.{name}"] for name in (*m.coordinates, *rates)]
    mu, weight = [m.values[f"mu.{name}"] for name in m.coordinates], m.values["lambda.0"]
    read = Numbers(m.values).read

    def rate(name: str) -> Ball:
        """d(lambda_0 l - mu . ID)/dz, and what closures add."""
        needed = m.changed({name: arb(1)}, m.second)
        own = weight * slope(running, m.values, name) - total(x * y for x, y in zip(mu, needed, strict=True))
        return own + _opening(m.by(name), m, rows, mu) if rows else own

    if rows:
        G, c = m.matrix("closure.jacobian"), m.elements("closure.acceleration")
        result.matrix("closure.jacobian", (len(rows), m.n), (), G)
        vector_of(result, "closure.acceleration", [c.get((k,), arb(0)) for k in range(len(rows))])

    symmetric_of(result, "metric", m.matrix("metric"))
    vector_of(result, "force", [-x for x in m.needed([arb(0)] * m.n)])
    result.scalar("running_cost", read(running))
    pairs = zip(costates, [*m.rates, *m.second], strict=True)
    result.scalar("hamiltonian", weight * read(running) + total(x * y for x, y in pairs))
    vector_of(result, "adjoint_q", [-rate(name) for name in m.coordinates])
    vector_of(result, "adjoint_qd", [-(costates[a] + rate(name)) for a, name in enumerate(rates)])
    vector_of(result, "control_gradient", [rate(name) for name in controls])
    vector_of(result, "parameter_gradient", [rate(name) for name in varied_by])
    result.scalar("terminal_cost", read(terminal))
    for name, by in (("q", m.coordinates), ("qd", rates), ("parameters", varied_by)):
        vector_of(result, f"terminal_{name}", [slope(terminal, m.values, z) for z in by])
    return result


def _opening(by: ModelAt, m: ModelAt, rows: Sequence[str], mu: Sequence[Ball]) -> Ball:
    """mu . (dG/dz)^T rho - nu . (dG/dz q'' + dc/dz), from the changes ``by`` z of what the model has."""
    rho, nu = ([m.values[f"{prefix}.{row}"] for row in rows] for prefix in ("rho", "nu"))
    change, c = by.matrix("closure.jacobian"), by.elements("closure.acceleration")
    held, opened = times(change, mu), times(change, m.second)
    return total(x * y for x, y in zip(rho, held, strict=True)) - total(
        y * (x + c.get((k,), arb(0))) for k, (x, y) in enumerate(zip(opened, nu, strict=True))
    )
