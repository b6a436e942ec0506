"""Necessary conditions along a computed motion: first integrals are constant, energy falls where forces damp."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np

from substructures.analysis.equations.expressions import read_expressions
from substructures.analysis.equations.first_integrals import FirstIntegrals, Integral
from substructures.analysis.verdict import Check, Rule
from substructures.array import Array
from substructures.expr.interpret import interpret, interpret_in_blocks
from substructures.tree.model import Model

#: of a sum, relative to its value; a state on closures is known to such a part, too
ROUNDING = 3e-14
#: results next to a singular position are known to so many times the limit, or they are not right
DOUBTED = 100
SCALES = ("metric", "linear_momentum", "angular_momentum", "potential_energy")


@dataclass(frozen=True)
class MotionStates:
    """A motion to be judged: times (K,), q, qd (K, n), values of all other symbols, work W (K,), None if unknown."""

    t: Array
    q: Array
    qd: Array
    values: Mapping[str, float | Array]
    work: Array | None

    def symbols(self, model: Model) -> dict[str, float | Array]:
        """Values of all symbols, (K,) each where they vary."""
        values = dict(self.values) | {"t": self.t}
        values |= {name: self.q[:, a] for a, name in enumerate(model.coordinates)}
        return values | {f"{name}'": self.qd[:, a] for a, name in enumerate(model.coordinates)}


def integral_series(model: Model, integrals: FirstIntegrals, states: MotionStates) -> dict[str, Array]:
    """All integrals, and the power where there is any, (K,)."""
    source = integrals.program
    found = interpret_in_blocks(source, states.symbols(model), list(source.outputs), len(states.t))
    series = {name: np.broadcast_to(x, states.t.shape).copy() for name, x in found.items()}
    if not source.outputs["power"].entries or "energy" not in series:
        del series["power"]
    return series


def judge(
    model: Model, integrals: FirstIntegrals, states: MotionStates, series: Mapping[str, Array], limit: float
) -> tuple[Check, ...]:
    """Checks of all integrals; ``series``: see integral_series; ``limit``: of the violation over the scale."""
    scales = _Scales(model, states)
    checks = []
    for integral in integrals.integrals:
        value, scale = series[integral.name], scales.of(integral)
        noise = ROUNDING * float(np.abs(value).max(initial=0))
        if integral.rule == "constant":
            checks.append(Check.of(_about(integral, "constant"), spread(value), states.t, scale, limit, noise))
            continue
        if states.work is None:
            why = "the work of the forces without potential was not integrated"
            checks.append(Check.left_out("energy-balance", "constant", why))
            continue
        # H - W with W' = Q_a q'^a + V' is constant for every model
        balanced = value - states.work
        reason = "energy less the work of the forces without potential: H' = Q_a q'^a + V'"
        entry = replace(integral, name="energy-balance", reason=reason)
        scale = max(scale, float(np.abs(states.work).max(initial=0)))
        checks.append(Check.of(_about(entry, "constant"), spread(balanced), states.t, scale, limit, noise))
        power = series["power"]
        if power.max(initial=0) <= 1e-12 * np.abs(power).max(initial=0):
            # H(t) less the least H before t
            rise = value - np.minimum.accumulate(value)
            entry = replace(integral, reason="the power of all forces without potential is nowhere positive")
            checks.append(Check.of(_about(entry, "falling"), rise, states.t, scale, limit, noise))
    return tuple(checks)


def _about(integral: Integral, rule: Rule) -> tuple[str, Rule, str, str]:
    return integral.name, rule, integral.reason, integral.unit


def energy_balance(
    t: Array, columns: Mapping[str, Array], conservative: bool, limit: float, doubt: Array | float = 0
) -> Check:
    """T + V - work is constant; relative to the largest of T, the change of V and the work.

    ``columns``: ``kinetic_energy``, ``potential_energy``, ``work``, (K,) each, and ``effort``, what forces do on the
    whole way where that is known: its rounding is in them, also where nothing moves. ``doubt`` (K,): what rounding
    next to singular positions makes of them [J]; no more than DOUBTED times the limit is put down to it.
    """
    T, V, work = (columns[name] for name in ("kinetic_energy", "potential_energy", "work"))
    known = float(np.maximum(np.abs(T + V), columns.get("effort", 0.0)).max(initial=0))
    scale = max(float(np.abs(x).max(initial=0)) for x in (T, V - V[0], work))
    # what is nothing but rounding is no scale
    scale = scale if scale > ROUNDING * known else known or 1.0
    reason = "T + V is constant: the forces have a potential, constraints do no work"
    if not conservative:
        reason = "T + V changes by the work of forces without potential and of prescribed motions only"
    noise = ROUNDING * known + np.minimum(doubt, DOUBTED * limit * scale)
    return Check.of(("energy", "constant", reason, "J"), spread(T + V - work), t, scale, limit, noise)


def unbalanced(names: Sequence[str]) -> Check:
    """In place of a balance of energy where the inputs ``names`` are part of the potential."""
    culprits = ", ".join(f"'{name}'" for name in names)
    why = f"no balance of energy is known with inputs in the potential ({culprits}): a second run judges instead"
    return Check.left_out("energy", "constant", why)


def spread(values: Array) -> Array:
    """The largest difference of two values up to each, along the first axis: drift whatever it is counted from."""
    return np.asarray(np.maximum.accumulate(values) - np.minimum.accumulate(values))


class _Scales:
    """Sizes that drifts are compared with: the largest sum of absolute values of what a quantity consists of."""

    def __init__(self, model: Model, states: MotionStates) -> None:
        found = interpret_in_blocks(model.program, states.symbols(model), list(SCALES), len(states.t))
        self.model, self.parameters, speed = model, states.values, np.abs(states.qd)
        # max over time of |g_ab| |q'^b|
        self.momenta = np.einsum("kab,kb->ka", np.abs(found["metric"]), speed).max(axis=0, initial=0)
        # T = g_ab q'^a q'^b / 2
        kinetic = 0.5 * np.einsum("kab,ka,kb->k", found["metric"], states.qd, states.qd)
        potential = found["potential_energy"]
        change = float(np.ptp(potential)) if len(potential) else 0.0
        self.whole = {
            "energy": max(float(kinetic.max(initial=0)), change),
            **{k: self._whole(found[k], speed) for k in ("linear_momentum", "angular_momentum")},
        }

    @staticmethod
    def _whole(columns: Array, speed: Array) -> float:
        return float(np.einsum("kai,ka->k", np.abs(columns), speed).max(initial=0))

    def of(self, integral: Integral) -> float:
        """The size of one integral."""
        if integral.kind == "cyclic":
            return float(self.momenta[self.model.coordinates.index(integral.name.removeprefix("momentum."))])
        if integral.kind == "symmetry":
            # sum of |c^a| max |g_ab| |q'^b|
            c = read_expressions(self.model, {"c": [(x, "/direction") for x in integral.direction.values()]})
            sizes = np.abs(interpret(c, dict(self.parameters), ["c"])["c"])
            places = [self.model.coordinates.index(name) for name in integral.direction]
            return float(sizes @ self.momenta[places])
        return self.whole[integral.kind]
