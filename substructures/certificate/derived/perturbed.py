"""What perturbation equations, state spaces and sensitivities have to be, from a model's certified program."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from functools import partial
from typing import Any

from flint import arb, arb_mat, arb_series

from substructures.certificate.derived.displaced import (
    BallRows,
    change_of_rates,
    displacement_rates,
    displacements,
    moved,
)
from substructures.certificate.derived.model_at import ModelAt, times, total
from substructures.certificate.derived.model_formulas import (
    Expectation,
    columns_of,
    inverse_dynamics_jacobians,
    symmetric_of,
    vector_of,
)
from substructures.certificate.linear import Ball
from substructures.certificate.numbers import Numbers
from substructures.certificate.outputs import Outputs
from substructures.certificate.stored import Pruned, Stored, operations_in_balls, pruned
from substructures.certificate.texts import slope
from substructures.expr.operations import Output


def perturbed(inputs: Sequence[str], multipliers: Sequence[str], balls: BallRows) -> Expectation:
    """M, D, K, F and the residual; with closures also G and its derivatives along the motion; with balls R."""
    return partial(_perturbed, inputs, multipliers, balls)


def _perturbed(inputs: Sequence[str], multipliers: Sequence[str], balls: BallRows, m: ModelAt) -> Outputs:
    result, found = Outputs(), inverse_dynamics_jacobians(m, balls)
    symmetric_of(result, "metric", m.matrix("metric"))
    result["damping"], result["stiffness"] = found["inverse_dynamics_qd"], found["inverse_dynamics_q"]
    # F = dQ/du
    # of driven coordinates that are inputs, the inertia, too
    columns_of(result, "input", m.n, [[-x for x in m.changed({name: arb(1)}, m.second)] for name in inputs])
    result["residual"] = found["inverse_dynamics"]
    if balls:
        columns_of(result, "rates_by_position", m.n, displacement_rates(m, balls))
    if multipliers:
        _closed(result, m, [m.values[name] for name in multipliers])
    return result


def _closed(result: Outputs, m: ModelAt, multipliers: Sequence[Ball]) -> None:
    """K less lambda_k d_b G_ka, the residual less G^T lambda; G, G' and G''."""
    names = "closure.residual", "closure.jacobian"
    G, shape = m.matrix(names[1]), m.program.outputs[names[1]].shape
    K, residual = result["stiffness"].entries, result["residual"].entries
    weights = arb_mat(1, shape[0], list(multipliers))
    for a, x in enumerate((weights * G).entries()):
        residual[a,] = residual[a,] - x
    for b, name in enumerate(m.coordinates):
        for a, x in enumerate((weights * m.by(name).matrix(names[1])).entries()):
            K[a, b] = K[a, b] - x
    phi = m.elements(names[0])
    vector_of(result, names[0], [phi.get((k,), arb(0)) for k in range(shape[0])])
    result.matrix(names[1], shape, (), G)
    # G at q + q' h + q'' h^2 / 2: the coefficients of h and h^2
    series = {name: arb_series([x]) for name, x in m.values.items()}
    series |= {
        name: arb_series([q, v, w / 2]) for name, q, v, w in zip(m.coordinates, m.q, m.rates, m.second, strict=True)
    }
    found, output = _along(pruned(m.program, names[1:]), series)
    for name, order, factor in (("closure.jacobian_rate", 1, 1), ("closure.jacobian_second", 2, 2)):
        entries = result.array(name, shape)
        for index, entry in zip(output.index, output.entries, strict=True):
            entries[index] = _coefficient(found[entry], order) * factor


def _along(program: Pruned, series: Mapping[str, Any]) -> tuple[list[Any], Output]:
    """G as power series of the time, operations and all; nowhere else than in G is a root or a quotient looked at. Not
    numbers where one of them has no series.
    """
    (output,) = program.outputs.values()
    try:
        return operations_in_balls(program, series), output
    except ValueError:  # a divisor whose enclosure has 0 in it
        return [arb_series([arb("nan")] * 3)] * len(program.operations), output


def _coefficient(x: Any, order: int) -> Ball:
    return x[order] if isinstance(x, arb_series) else arb(0)


def constrained(source: Stored, velocities: Sequence[str], inputs: Sequence[str]) -> Expectation:
    """The equations ``source`` in quasi-velocities, certified before, linearised."""
    return partial(_constrained, source, velocities, inputs)


def _constrained(source: Stored, velocities: Sequence[str], inputs: Sequence[str], m: ModelAt) -> Outputs:
    result, here, p = Outputs(), ModelAt(source, m.coordinates, m.values), len(velocities)
    second = [m.values[f"{name}'"] for name in velocities]

    def missing(at: ModelAt) -> list[Ball]:
        """g* v' + bias - forces, or its change at fixed v'."""
        inertia, bias, forces = times(at.matrix("metric"), second), at.elements("bias"), at.elements("forces")
        return [x + bias.get((i,), arb(0)) - forces.get((i,), arb(0)) for i, x in enumerate(inertia)]

    by_position = [here.by(name) for name in m.coordinates]
    symmetric_of(result, "metric", here.matrix("metric"))
    columns_of(result, "damping", p, [missing(here.by(name)) for name in velocities])
    columns_of(result, "stiffness", p, [missing(at) for at in by_position])
    columns_of(result, "input", p, [[-x for x in missing(here.by(name))] for name in inputs])
    vector_of(result, "residual", missing(here))
    result.matrix("T", (m.n, p), (), here.matrix("T"))
    columns_of(result, "rates_by_position", m.n, [at.vector("rates") for at in by_position])
    if "gaps" in source.outputs:
        (k,) = source.outputs["gaps"].shape
        changes = [at.elements("gaps") for at in by_position]
        columns_of(result, "gaps_by_position", k, [[x.get((i,), arb(0)) for i in range(k)] for x in changes])
    return result


def first_order(texts: Sequence[Any], inputs: Sequence[str], positions: Sequence[str], balls: BallRows) -> Expectation:
    """A, B, C, D, x' and y; ``texts``: of y."""
    return partial(_first_order, texts, inputs, positions, balls)


def _first_order(
    texts: Sequence[Any], inputs: Sequence[str], positions: Sequence[str], balls: BallRows, m: ModelAt
) -> Outputs:
    result, found, zero = Outputs(), m.accelerations(), [arb(0)] * m.n
    by_rate, by_input = ([{name: arb(1)} for name in some] for some in ([f"{q}'" for q in m.coordinates], inputs))
    by_position = displacements(m, balls)
    own = [[arb(int(a == b)) for a in range(m.n)] for b in range(m.n)]
    turned = displacement_rates(m, balls)

    def column(kinematic: Sequence[Ball], along: Mapping[str, Ball]) -> list[Ball]:
        """Of A or B: the changes of d' = dv + R d, and of q''."""
        return [*kinematic, *m.solved([-x for x in m.changed(along, found)])]

    pairs = [*zip(turned, by_position, strict=True), *zip(own, by_rate, strict=True)]
    columns_of(result, "A", 2 * m.n, [column(*pair) for pair in pairs])
    columns_of(result, "B", 2 * m.n, [column(zero, along) for along in by_input])
    for matrix, directions in (("C", [*by_position, *by_rate]), ("D", by_input)):
        columns_of(result, matrix, len(texts), [[_slope_along(text, m, each) for text in texts] for each in directions])
    changes = moved(m, balls, m.rates)
    vector_of(result, "derivative", [*(changes[name] for name in positions), *found])
    vector_of(result, "output", [Numbers(m.values).read(text) for text in texts])
    return result


def _slope_along(text: Any, m: ModelAt, along: Mapping[str, Ball]) -> Ball:
    """The change of an expression."""
    return total(slope(text, m.values, name) * x for name, x in along.items())


def by_parameters(parameters: Sequence[str], quantities: Sequence[str]) -> Expectation:
    """Outputs of the model differentiated by parameters."""
    return partial(_by_parameters, parameters, quantities)


def _by_parameters(parameters: Sequence[str], quantities: Sequence[str], m: ModelAt) -> Outputs:
    result = Outputs()
    for parameter in parameters:
        moved = m.by(parameter)
        for quantity in quantities:
            output = m.program.outputs[quantity]
            entries = result.array(f"{quantity}:{parameter}", tuple(output.shape), output.symmetry)
            entries |= {i: moved.found[e] for i, e in zip(output.index, output.entries, strict=True)}
    return result


def varied(parameters: Sequence[str], positions: Sequence[str] = (), balls: BallRows = ()) -> Expectation:
    """Accelerations and their variation along the symbols ``d.*`` of states and parameters; with balls, whose states
    consist of ``positions``, also changes of these.
    """
    return partial(_varied, parameters, positions, balls)


def _varied(parameters: Sequence[str], positions: Sequence[str], balls: BallRows, m: ModelAt) -> Outputs:
    result, found = Outputs(), m.accelerations()
    names = [*(positions or m.coordinates), *(f"{name}'" for name in m.coordinates), *parameters]
    if balls:
        changes, slopes = moved(m, balls, m.rates), change_of_rates(m, balls)
        vector_of(result, "rates", [changes[name] for name in positions])
        vector_of(result, "rates_variation", [slopes[name] for name in positions])
    change = m.changed({name: m.values[f"d.{name}"] for name in names}, found)
    vector_of(result, "acceleration", found)
    vector_of(result, "variation", m.solved([-x for x in change]))
    return result


def curved(m: ModelAt) -> Outputs:
    """R_abcd = d_c Gamma_abd - d_d Gamma_abc + g^ef (Gamma_ead Gamma_fbc - Gamma_eac Gamma_fbd), R_bd, S, g^ab, and
    Gamma^a_bc: every element of them.
    """
    result, n = Outputs(), range(m.n)
    try:
        inverse = m.matrix("metric").inv()
    except ZeroDivisionError:
        inverse = arb_mat(m.n, m.n, [arb("nan")] * m.n**2)
    first = _blocks(m)
    slopes = [_blocks(m.by(name)) for name in m.coordinates]
    second = [[inverse * arb_mat(m.n, 1, first[b][c]) for c in n] for b in n]
    riemann = result.array("riemann", (m.n,) * 4)
    for a, b, c, d in ((a, b, c, d) for a in n for b in n for c in n for d in n):
        turned = total(second[a][d][e, 0] * first[b][c][e] - second[a][c][e, 0] * first[b][d][e] for e in n)
        riemann[a, b, c, d] = slopes[c][b][d][a] - slopes[d][b][c][a] + turned
    ricci = arb_mat(m.n, m.n, [total(inverse[a, c] * riemann[a, b, c, d] for a in n for c in n) for b in n for d in n])
    symmetric_of(result, "ricci", ricci)
    result.scalar("scalar_curvature", total(inverse[b, d] * ricci[b, d] for b in n for d in n))
    symmetric_of(result, "inverse_metric", inverse)
    entries = result.array("christoffel_second", (m.n,) * 3)
    entries |= {(a, b, c): second[b][c][a, 0] for a in n for b in n for c in n}
    return result


def _blocks(m: ModelAt) -> list[list[list[Ball]]]:
    """Gamma_abc at [b][c][a]."""
    found, n = m.elements("christoffel"), range(m.n)
    return [[[found.get((a, b, c), arb(0)) for a in n] for c in n] for b in n]


def steady(still: Sequence[int], moving: Sequence[int], multipliers: Sequence[str]) -> Expectation:
    """E_x and its derivatives, momenta g_ss w and theirs, at rest in the coordinates x = ``still``."""
    return partial(_steady, still, moving, multipliers)


def _steady(still: Sequence[int], moving: Sequence[int], multipliers: Sequence[str], m: ModelAt) -> Outputs:
    names, result, zero = m.coordinates, Outputs(), [arb(0)] * m.n
    here = m.at({f"{names[a]}'": arb(0) for a in still})
    weights = arb_mat(1, len(multipliers), [m.values[name] for name in multipliers])

    def E(at: ModelAt) -> list[Ball]:
        """Gamma_xbc q'^b q'^c - Q_x - lambda_k G_kx, or its change."""
        held = (weights * at.matrix("closure.jacobian")).entries() if multipliers else zero
        needed = at.needed(zero)
        return [needed[a] - held[a] for a in still]

    def p(g: ModelAt) -> list[Ball]:
        """g_ss w."""
        metric = g.matrix("metric")
        return [total(metric[s, b] * m.rates[b] for b in moving) for s in moving]

    metric = here.matrix("metric")
    columns_of(result, "metric", m.n, [[metric[a, b] for a in range(m.n)] for b in range(m.n)])
    vector_of(result, "residual", E(here))
    for name, by in (("position", [names[a] for a in still]), ("velocity", [f"{names[a]}'" for a in still])):
        columns_of(result, f"by_{name}", len(still), [E(here.by(x)) for x in by])
    columns_of(result, "by_rate", len(still), [E(here.by(f"{names[s]}'")) for s in moving])
    vector_of(result, "momenta", p(here))
    columns_of(result, "momenta_by_position", len(moving), [p(here.by(names[a])) for a in still])
    if multipliers:
        phi, G, rows = here.elements("closure.residual"), here.matrix("closure.jacobian"), range(len(multipliers))
        vector_of(result, "closure.residual", [phi.get((k,), arb(0)) for k in rows])
        columns_of(result, "closure.jacobian", len(rows), [[G[k, a] for k in rows] for a in still])
    return result
