"""What the programs that are served beside the outputs of a model have to be, from its certified program alone.

Nothing is built: values in balls, forward differentiation of the certified operations, and systems of equations solved
by elimination with pivots, where the served formulas come from substitution and differentiation in a graph, and from
g = L^T D L without exchange of rows (notation.md, section 7).
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from functools import partial

from flint import arb

from substructures.certificate.derived.displaced import BallRows, displacements, moved
from substructures.certificate.derived.model_at import ModelAt, dot, total
from substructures.certificate.linear import Ball, Matrix
from substructures.certificate.outputs import Outputs

#: what one quantity has to be at a state
Expectation = Callable[[ModelAt], Outputs]


def vector_of(result: Outputs, name: str, values: Sequence[Ball]) -> None:
    """An output of one axis."""
    result.array(name, (len(values),)).update({(a,): x for a, x in enumerate(values)})


def columns_of(result: Outputs, name: str, rows: int, columns: Sequence[Sequence[Ball]]) -> None:
    """An output of two axes by its columns."""
    entries = result.array(name, (rows, len(columns)))
    entries |= {(a, b): x for b, column in enumerate(columns) for a, x in enumerate(column)}


def symmetric_of(result: Outputs, name: str, matrix: Matrix) -> None:
    """A symmetric output."""
    n = matrix.nrows()
    entries = result.array(name, (n, n), "symmetric")
    entries |= {(a, b): matrix[a, b] for a in range(n) for b in range(a, n)}


def directions(m: ModelAt, kinds: Sequence[str] = ("", "'", "''")) -> dict[str, Ball]:
    """The direction that the symbols ``d.*`` of states and inputs are the components of."""
    states = [f"{name}{primes}" for name in m.coordinates for primes in kinds]
    inputs = [symbol.name for symbol in m.program.symbols if symbol.kind == "input"]
    return {name: m.values[f"d.{name}"] for name in (*states, *inputs)}


def _coriolis(m: ModelAt) -> Outputs:
    """C_ab = Gamma_abc q'^c."""
    result = Outputs()
    entries = result.array("coriolis", (m.n, m.n))
    for (a, b, c), gamma in m.elements("christoffel").items():
        entries[a, b] = entries.get((a, b), arb(0)) + gamma * m.rates[c]
    return result


def _inverse_dynamics(m: ModelAt) -> Outputs:
    result = Outputs()
    vector_of(result, "inverse_dynamics", m.needed(m.second))
    return result


def _kinetic_energy(m: ModelAt) -> Outputs:
    result = Outputs()
    T = m.kinetic_energy()
    if "ignored_rates" in m.program.outputs:
        # of R + V by powers of the rates the first and the last: T = p_a q'^a - R - V
        T = dot(m.momenta(), m.rates) - T
    result.scalar("kinetic_energy", T)
    return result


def _lagrangian(m: ModelAt) -> Outputs:
    """T - V."""
    result = Outputs()
    result.scalar("lagrangian", m.kinetic_energy() - m.scalar("potential_energy"))
    return result


def _generalised_momenta(m: ModelAt) -> Outputs:
    """dT/dq'^a."""
    result = Outputs()
    vector_of(result, "generalised_momenta", m.momenta())
    return result


def _total_momentum(m: ModelAt) -> Outputs:
    result = Outputs()
    for kind in ("linear", "angular"):
        vector_of(result, kind, m.momentum(kind))
    return result


def _inverse_dynamics_derivative(m: ModelAt) -> Outputs:
    """dID along all directions."""
    result = _inverse_dynamics(m)
    vector_of(result, "inverse_dynamics_derivative", m.changed(directions(m), m.second))
    return result


def inverse_dynamics_jacobians(m: ModelAt, balls: BallRows = ()) -> Outputs:
    """dID_a/dq^b, of ball joints along displacements, and dID_a/dq'^b."""
    result = _inverse_dynamics(m)
    rates = [{f"{name}'": arb(1)} for name in m.coordinates]
    for name, directions in (("inverse_dynamics_q", displacements(m, balls)), ("inverse_dynamics_qd", rates)):
        columns_of(result, name, m.n, [m.changed(each, m.second) for each in directions])
    return result


def _forward_dynamics(m: ModelAt) -> Outputs:
    """g q'' = Q - Gamma q' q', pivots D_k of g = L^T D L as parts of |g_kk|."""
    result, g = Outputs(), m.matrix("metric")
    vector_of(result, "forward_dynamics", m.accelerations())
    vector_of(result, "pivots", relative_pivots(g))
    vector_of(result, "inertias", [abs(g[k, k]) for k in range(m.n)])
    return result


def relative_pivots(g: Matrix) -> list[Ball]:
    """D_k as parts of |g_kk|."""
    return [D / abs(g[k, k]) for k, D in enumerate(pivots(g))]


def pivots(g: Matrix) -> list[Ball]:
    """D of g = L^T D L: what is left of g_kk when all coordinates after k are eliminated."""
    n = g.nrows()
    left = [[g[a, b] for b in range(n)] for a in range(n)]
    for k in reversed(range(n)):
        rows = [a for a in range(k) if not left[a][k].is_zero()]
        for a in rows:
            factor = left[a][k] / left[k][k]
            for b in rows:
                left[a][b] = left[a][b] - factor * left[k][b]
    return [left[k][k] for k in range(n)]


def _forward_dynamics_derivative(m: ModelAt) -> Outputs:
    """g d(q'') = -dID at q'' = FD, dq'' = 0."""
    result, found = _forward_dynamics(m), m.accelerations()
    change = m.changed(directions(m, ("", "'")), found)
    vector_of(result, "forward_dynamics_derivative", m.solved([-x for x in change]))
    return result


def _power(m: ModelAt) -> Outputs:
    result = Outputs()
    vector_of(result, "power", [Q * x for Q, x in zip(m.vector("forces"), m.rates, strict=True)])
    return result


def _inverse_metric(m: ModelAt) -> Outputs:
    """g x = e_b."""
    result, g = Outputs(), m.matrix("metric")
    columns = [m.solved([arb(a == b) for a in range(m.n)]) for b in range(m.n)]
    entries = result.array("inverse_metric", (m.n, m.n), "symmetric")
    entries |= {(a, b): columns[b][a] for b in range(m.n) for a in range(b + 1)}
    vector_of(result, "pivots", relative_pivots(g))
    return result


def _christoffel_second_kind(m: ModelAt) -> Outputs:
    """g x = Gamma_.bc."""
    result, gamma = Outputs(), m.elements("christoffel")
    entries = result.array("christoffel_second_kind", (m.n,) * 3)
    for b in range(m.n):
        for c in range(m.n):
            column = m.solved([gamma.get((d, b, c), arb(0)) for d in range(m.n)])
            entries |= {(a, b, c): x for a, x in enumerate(column)}
    vector_of(result, "pivots", relative_pivots(m.matrix("metric")))
    return result


def _hamiltonian(m: ModelAt) -> Outputs:
    """p_a q'^a - T + V at dT/dq' = p."""
    result, p = Outputs(), _momentum_symbols(m)
    rates = _rates(m)
    here = m.at({f"{name}'": x for name, x in zip(m.coordinates, rates, strict=True)})
    result.scalar("hamiltonian", dot(p, rates) - here.kinetic_energy() + m.scalar("potential_energy"))
    vector_of(result, "pivots", relative_pivots(m.matrix("metric")))
    return result


def _canonical_equations(m: ModelAt) -> Outputs:
    """p'_a = Q_a + d_a T at dT/dq' = p."""
    result = Outputs()
    rates = _rates(m)
    here = m.at({f"{name}'": x for name, x in zip(m.coordinates, rates, strict=True)})
    slopes = [here.kinetic_change({name: arb(1)}) for name in m.coordinates]
    vector_of(result, "coordinate_rates", rates)
    vector_of(result, "momentum_rates", [Q + x for Q, x in zip(here.vector("forces"), slopes, strict=True)])
    vector_of(result, "pivots", relative_pivots(m.matrix("metric")))
    return result


def _rates(m: ModelAt) -> list[Ball]:
    """q' with dT/dq' = p."""
    return m.solved([p - x for p, x in zip(_momentum_symbols(m), m.drives(), strict=True)])


def _momentum_symbols(m: ModelAt) -> list[Ball]:
    return [m.values[f"p.{name}"] for name in m.coordinates]


#: by name of the quantity
SERVED: dict[str, Expectation] = {
    "coriolis": _coriolis,
    "inverse_dynamics": _inverse_dynamics,
    "kinetic_energy": _kinetic_energy,
    "lagrangian": _lagrangian,
    "generalised_momenta": _generalised_momenta,
    "power": _power,
    "total_momentum": _total_momentum,
    "inverse_metric": _inverse_metric,
    "christoffel_second_kind": _christoffel_second_kind,
    "hamiltonian": _hamiltonian,
    "canonical_equations": _canonical_equations,
    "inverse_dynamics_derivative": _inverse_dynamics_derivative,
    "forward_dynamics": _forward_dynamics,
    "forward_dynamics_derivative": _forward_dynamics_derivative,
}


def simulated(positions: Sequence[str], balls: BallRows) -> Expectation:
    """What simulations run on: accelerations, pivots D, and the power Q_a q'^a + V' of the forces without potential;
    with ball joints before them the changes of the ``positions`` of states.
    """
    return partial(_simulated, positions, balls)


def _simulated(positions: Sequence[str], balls: BallRows, m: ModelAt) -> Outputs:
    result = Outputs()
    if balls:
        changes = moved(m, balls, m.rates)
        vector_of(result, "position_rates", [changes[name] for name in positions])
    vector_of(result, "forward_dynamics", m.accelerations())
    vector_of(result, "pivots", pivots(m.matrix("metric")))
    power_of(result, "power", m, balls)
    return result


def with_power(names: Sequence[str]) -> Expectation:
    """Outputs of the model, and the power of the forces without potential."""
    return partial(_with_power, names)


def _with_power(names: Sequence[str], m: ModelAt) -> Outputs:
    result = Outputs()
    for name in dict.fromkeys([*names, "forces", "potential_energy"]):
        output = m.program.outputs[name]
        entries = result.array(name, tuple(output.shape), output.symmetry)
        entries |= {i: m.found[entry] for i, entry in zip(output.index, output.entries, strict=True)}
    power_of(result, "lost_power", m)
    return result


def power_of(result: Outputs, name: str, m: ModelAt, balls: BallRows = ()) -> None:
    """Q_a q'^a + V' - d_t T at fixed inputs; the metric depends on the time where motions are given. A power of zero is
    small beside the Q_a q'^a, which cancel V'.
    """
    gained = m.change("potential_energy", m.time() | moved(m, balls, m.rates))
    work = [Q * x for Q, x in zip(m.vector("forces"), m.rates, strict=True)]
    result.scalar(name, total(work) + gained - m.kinetic_change(m.time()))
    result[name].scale = total(map(abs, work)).abs_lower()
