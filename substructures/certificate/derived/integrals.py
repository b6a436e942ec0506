"""What first integrals and Routh's equations have to be, from a model's certified program.

That a quantity is constant is checked with it: its derivative along the equations of motion vanishes.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from functools import partial
from math import prod
from typing import Any

from flint import arb, arb_mat

from substructures.certificate.derived.displaced import BallRows, motion
from substructures.certificate.derived.model_at import Index, ModelAt, dot, solve, total
from substructures.certificate.derived.model_formulas import Expectation, power_of, symmetric_of, vector_of
from substructures.certificate.linear import Ball, Matrix
from substructures.certificate.numbers import Numbers
from substructures.certificate.outputs import Outputs
from substructures.certificate.slopes import tangents
from substructures.certificate.stored import Stored, operations_in_balls
from substructures.errors import VerificationFailed

AXES = "xyz"
#: of a sum beside its terms
TOLERANCE = 2.0**-40
#: kinds with the mass centre, which a model does not store: s' = P is what the vanishing derivative of both says
WITH_CENTRE = ("galilei", "spin")


#: (B, b) of rows B q' + b = 0 that hold the motion, at a state
Rows = Callable[[ModelAt], Sequence[Sequence[Ball]]]


def constant(
    program: Stored,
    integrals: Sequence[Mapping[str, Any]],
    multipliers: Sequence[str],
    rows: Rows | None = None,
    balls: BallRows = (),
    beside: Mapping[str, str] | None = None,
) -> Expectation:
    """Energies, momenta and combinations of them, and the power; ``integrals``: name, kind, rule and direction of each.

    ``program``: of the integrals, whose derivatives along the motion have to vanish. ``multipliers``: symbols of the
    reactions of closures, or of all ``rows``. ``beside``: outputs of the model by the names that they have there.
    """
    return partial(_constant, _Held(program, multipliers, rows, balls), integrals, beside or {})


@dataclass(frozen=True)
class _Held:
    """The program of integrals, and what holds the motion along which they are constant."""

    program: Stored
    multipliers: Sequence[str]
    rows: Rows | None
    balls: BallRows


def _constant(given: _Held, integrals: Sequence[Mapping[str, Any]], beside: Mapping[str, str], m: ModelAt) -> Outputs:
    program, balls = given.program, given.balls
    result = Outputs()
    found = {"linear_momentum": m.momentum("linear"), "angular_momentum": m.momentum("angular")}
    for each in integrals:
        name, kind = each["name"], each["kind"]
        if kind == "energy":
            value = m.energy()
        elif kind == "subsystem":
            value = _energy_of(m, each["coordinates"], balls)
        elif kind == "impulse":
            i = AXES.index(name.removeprefix("impulse."))
            value = found["linear_momentum"][i] - _rate_of_momentum(m, balls)[i] * m.values.get("t", arb(0))
        elif each["terms"]:
            value = _sum_of_terms(m, each["terms"])
        elif kind in WITH_CENTRE:
            value = _own(program, name, m)
        elif kind == "cyclic":
            value = m.momenta()[m.coordinates.index(name.removeprefix("momentum."))]
        elif kind == "symmetry":
            weights, momenta = Numbers(m.values), m.momenta()
            pairs = ((text, momenta[m.coordinates.index(q)]) for q, text in each["direction"].items())
            value = total(weights.read(text) * p for text, p in pairs)
        else:
            value = _component(m, found, kind, name.removeprefix(f"{kind}."), balls)
        result.scalar(name, value)
    power_of(result, "power", m, balls)
    for name, source in beside.items():
        output = m.program.outputs[source]
        values = (m.found[entry] for entry in output.entries)
        result.array(name, output.shape, output.symmetry).update(zip(output.index, values, strict=True))
    held = [each for each in integrals if each["rule"] == "constant"]
    _require_constant(given, held, m)
    return result


def _energy_of(m: ModelAt, names: Sequence[str], balls: BallRows) -> Ball:
    """p_a q'^a / 2 of some coordinates, and V where all others are zero. Raises VerificationFailed for a closure that
    does work on them, as it moves others, too."""
    rows = m.elements("closure.jacobian") if "closure.jacobian" in m.program.outputs else {}
    own, others = ({k for k, a in rows if (m.coordinates[a] in names) is within} for within in (True, False))
    if own & others:
        raise VerificationFailed(f"a closure joins {', '.join(names)} with other coordinates")
    at_zero = {name: arb(0) for name in m.coordinates if name not in names}
    resting = (ball["positions"] for ball in balls if ball["velocities"][0] not in names)
    at_zero |= {name: arb(int(k == len(some) - 4)) for some in resting for k, name in enumerate(some)}
    alone = m.at(at_zero)
    twice = total(p * v for name, p, v in zip(m.coordinates, m.momenta(), m.rates, strict=True) if name in names)
    return twice / 2 + alone.scalar("potential_energy")


def _sum_of_terms(m: ModelAt, terms: Sequence[tuple[str, Sequence[str]]]) -> Ball:
    """Coefficients, texts, times momenta ``p.arm.q1`` or velocities ``arm.q1'``."""
    factors = dict(zip((f"{name}'" for name in m.coordinates), m.rates, strict=True))
    factors |= dict(zip((f"p.{name}" for name in m.coordinates), m.momenta(), strict=True))
    weights = Numbers({"t": arb(0), **m.values})
    return total(prod((factors[w] for w in some), start=weights.read(text)) for text, some in terms)


def _own(program: Stored, name: str, m: ModelAt) -> Ball:
    """The value of an output itself."""
    found = operations_in_balls(program, m.values)
    return total(found[entry] for entry in program.outputs[name].entries)


def _component(m: ModelAt, found: Mapping[str, list[Ball]], kind: str, label: str, balls: BallRows) -> Ball:
    """A momentum of the whole along an axis of the world, the axis of a joint, a constant force, or across that."""
    momentum = found[kind]
    if label in AXES:
        return momentum[AXES.index(label)]
    if label.startswith("axis-of-"):
        return dot(momentum, _axis(m, m.coordinates.index(label.removeprefix("axis-of-"))))
    # p' along the motion is the force, of which components that are zero come as such, or as small balls
    pull = _rate_of_momentum(m, balls)
    first = next(i for i, x in enumerate(pull) if not x.contains(0))
    if label == "force":
        return dot(momentum, [x / pull[first] for x in pull])
    i = AXES.index(label.removesuffix("-normal-to-force"))
    return momentum[i] - momentum[first] * (pull[i] / pull[first])


def _axis(m: ModelAt, a: int) -> list[Ball]:
    """The direction in the world of a joint's axis."""
    rotation = m.elements("rotation")
    for name in ("Omega", "U"):
        columns = m.elements(name)
        frame = min((k for k, b, _ in columns if b == a), default=None)
        if frame is not None:
            pairs = [[(rotation.get((frame, j, i)), columns.get((frame, a, i))) for i in range(3)] for j in range(3)]
            return [total(r * c for r, c in some if r is not None and c is not None) for some in pairs]
    raise VerificationFailed(f"no frame moves with {m.coordinates[a]}")


def _rate_of_momentum(m: ModelAt, balls: BallRows) -> list[Ball]:
    """d/dt of sum_a p_a q'^a along the equations of motion."""
    second = m.accelerations()
    moved, own = m.along(motion(m, balls, second)).elements("linear_momentum"), m.elements("linear_momentum")
    pairs = list(enumerate(zip(m.rates, second, strict=True)))
    zero = arb(0)
    return [total(moved.get((a, i), zero) * v + own.get((a, i), zero) * w for a, (v, w) in pairs) for i in range(3)]


def _require_constant(given: _Held, integrals: Sequence[Mapping[str, Any]], m: ModelAt) -> None:
    """Raise VerificationFailed for an integral that changes along the motion, whatever the reactions of closures and of
    velocity constraints are; they do no work."""
    program, multipliers, rows = given.program, given.multipliers, given.rows
    values = {**m.values, **dict.fromkeys(multipliers, arb(1))}
    found = operations_in_balls(program, values)

    def changes(way: Mapping[str, Ball]) -> list[dict[int, Ball]]:
        """By velocities, and by all else."""
        parts = ({x: v for x, v in way.items() if x.endswith("'") is is_rate} for is_rate in (True, False))
        return [tangents(program, found, part) for part in parts]

    free = held = changes(motion(m, given.balls, m.accelerations()))
    if multipliers:
        G = m.matrix("closure.jacobian") if rows is None else _held(rows(m), integrals)
        beside = (arb_mat(1, len(multipliers), [k + 1 for k in range(len(multipliers))]) * G).entries()
        held = changes(m.motion(m.accelerations(beside)))
    for each in integrals:
        way = free if each["kind"] in ("energy", "subsystem") else held
        if not all(_cancel(*(x.get(k, arb(0)) for x in way)) for k in program.outputs[each["name"]].entries):
            raise VerificationFailed(f"{each['name']} changes along the motion")


def _cancel(x: Ball, y: Ball) -> bool:
    """Whether a sum is zero, but for what steps of Newton's method in the formulas leave of it."""
    return bool((x + y).contains(0) or (x + y).abs_upper() <= TOLERANCE * (x.abs_lower() + y.abs_lower()))


def _held(rows: Sequence[Sequence[Ball]], integrals: Sequence[Mapping[str, Any]]) -> Matrix:
    """B. Raises VerificationFailed for an energy where rows with a b do work."""
    if any(not row[-1].contains(0) for row in rows) and any(i["kind"] in ("energy", "subsystem") for i in integrals):
        raise VerificationFailed("velocity constraints that move do work")
    return arb_mat(len(rows), len(rows[0]) - 1, [x for row in rows for x in row[:-1]])


def reduced(cyclic: Sequence[str], rest: Sequence[str]) -> Expectation:
    """Routh's equations in the coordinates ``rest``; symbols ``p.*``: the momenta of those that are ``cyclic``."""
    return partial(_reduced, cyclic, rest)


def _reduced(cyclic: Sequence[str], rest: Sequence[str], m: ModelAt) -> Outputs:
    c, r = ([m.coordinates.index(name) for name in names] for names in (cyclic, rest))
    g, Q, n = m.matrix("metric"), m.vector("forces"), range(len(r))
    block = arb_mat(len(c), len(c), [g[i, j] for i in c for j in c])
    p = [m.values[f"p.{name}"] for name in cyclic]
    # q' = P q'_r + w, P = (1, -g_cc^-1 g_cr), w = (0, g_cc^-1 p)
    pushed = [dict(zip(c, solve(block, [-g[i, a] for i in c]), strict=True)) | {a: arb(1)} for a in r]
    w = dict(zip(c, solve(block, p), strict=True))
    gamma, v = m.elements("christoffel"), [m.rates[a] for a in r]
    h = arb_mat(len(r), len(r), [_bilinear(g, pushed[a], pushed[b]) for a in n for b in n])
    result = Outputs()
    symmetric_of(result, "metric", h)
    _velocity_terms(result, gamma, pushed, w)
    vector_of(result, "forces", [Q[r[a]] - _trilinear(gamma, pushed[a], w, w) for a in n])
    amended = m.scalar("potential_energy") + dot(p, [w[i] for i in c]) / 2
    result.scalar("amended_potential", amended)
    kinetic = total(h[a, b] * v[a] * v[b] for a in n for b in n) / 2
    coupling = total(w[i] * g[i, a] * x for i in c for a, x in zip(r, v, strict=True))
    result.scalar("routhian", kinetic + coupling - amended)
    vector_of(result, "cyclic_velocities", [w[i] + total(pushed[a][i] * v[a] for a in n) for i in c])
    return result


def _velocity_terms(
    result: Outputs, gamma: Mapping[Index, Ball], pushed: Sequence[Mapping[int, Ball]], w: Mapping[int, Ball]
) -> None:
    """Gamma of the coordinates that are left, and what is linear in their rates: 2 Gamma(P_a, P_b, w)."""
    n = range(len(pushed))
    christoffel, gyroscopic = result.array("christoffel", (len(n),) * 3), result.array("gyroscopic", (len(n),) * 2)
    for a in n:
        for b in n:
            gyroscopic[a, b] = 2 * _trilinear(gamma, pushed[a], pushed[b], w)
            christoffel |= {(a, b, k): _trilinear(gamma, pushed[a], pushed[b], pushed[k]) for k in n}


def _bilinear(g: Any, x: Mapping[int, Ball], y: Mapping[int, Ball]) -> Ball:
    return total(g[i, j] * s * t for i, s in x.items() for j, t in y.items())


def _trilinear(
    gamma: Mapping[Index, Ball], x: Mapping[int, Ball], y: Mapping[int, Ball], z: Mapping[int, Ball]
) -> Ball:
    """Gamma_ijk x_i y_j z_k."""
    return total(value * x[i] * y[j] * z[k] for (i, j, k), value in gamma.items() if i in x and j in y and k in z)
