"""Necessary conditions along a computed motion: first integrals are constant, energy falls where forces damp."""

from __future__ import annotations

from collections.abc import Collection, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from math import prod

import numpy as np

from substructures.analysis.equations.expressions import read_expressions
from substructures.analysis.equations.first_integrals import first_integrals
from substructures.analysis.equations.integral import SIZES, FirstIntegrals, Integral
from substructures.analysis.motion.judges.states import ROUNDING, Condition, MotionStates, spread
from substructures.analysis.verdict import Check, Rule
from substructures.array import Array
from substructures.expr.interpret import interpret
from substructures.tree.model import Model

#: kinds that are compared with the size of another quantity of the whole
SIZED = {
    "impulse": "linear_momentum",
    "galilei": "linear_momentum",
    "spin": "angular_momentum",
    "subsystem": "energy",
}


@dataclass(frozen=True)
class AlongMotion:
    """First integrals along motions: ``series``: all of them, and the power where there is any, (..., K); ``sizes``:
    what SIZES are, (..., K) and their own axes. What judges changes ``series``.
    """

    model: Model
    integrals: FirstIntegrals
    states: MotionStates
    series: dict[str, Array]
    sizes: Mapping[str, Array]

    @classmethod
    def of(cls, model: Model, integrals: FirstIntegrals, states: MotionStates) -> AlongMotion:
        """All of them at once."""
        source, numbers = integrals.along, {name: float(x) for name, x in integrals.numbers.items()}
        given = replace(states, values={**states.values, **numbers})
        found = given.found(model, source, list(source.outputs))
        sizes = {name: found.pop(size) for size, name in SIZES.items()}
        if not source.outputs["power"].entries or "energy" not in found:
            del found["power"]
        return cls(model, integrals, states, found, sizes)


def conditions(along: AlongMotion) -> Iterator[Condition | Check]:
    """What all integrals demand, a Check where it is left out."""
    scales, states, series = _Scales(along), along.states, along.series
    everywhere = np.ones(states.t.shape[:-1], dtype=bool)
    for integral in along.integrals.integrals:
        value = series[integral.name]
        scale = scales.of(integral, value)
        noise = ROUNDING * np.abs(value).max(axis=-1, initial=0)
        if integral.rule == "constant":
            yield Condition(_about(integral, "constant"), spread(value), scale, noise, everywhere)
            continue
        if integral.kind == "subsystem":
            # the work is known of the whole alone
            continue
        if states.work is None:
            why = "the work of the forces without potential was not integrated"
            yield Check.left_out("energy-balance", "constant", why)
            continue
        # H - W with W' = Q_a q'^a + V' is constant for every model
        balanced = value - states.work
        reason = "energy less the work of the forces without potential: H' = Q_a q'^a + V'"
        entry = replace(integral, name="energy-balance", reason=reason)
        scale = np.maximum(scale, np.abs(states.work).max(axis=-1, initial=0))
        yield Condition(_about(entry, "constant"), spread(balanced), scale, noise, everywhere)
        power = series["power"]
        is_lost = power.max(axis=-1, initial=0) <= 1e-12 * np.abs(power).max(axis=-1, initial=0)
        if is_lost.any():
            # H(t) less the least H before t
            rise = value - np.minimum.accumulate(value, axis=-1)
            entry = replace(integral, reason="the power of all forces without potential is nowhere positive")
            yield Condition(_about(entry, "falling"), rise, scale, noise, is_lost)


def judge(along: AlongMotion, limit: float) -> tuple[Check, ...]:
    """Checks of all integrals of a motion; ``limit``: of the violation over the scale."""
    return tuple(
        found
        if isinstance(found, Check)
        else Check.of(found.about, found.violation, along.states.t, float(found.scale), limit, float(found.noise))
        for found in conditions(along)
    )


def _about(integral: Integral, rule: Rule) -> tuple[str, Rule, str, str]:
    return integral.name, rule, integral.reason, integral.unit


class _Scales:
    """Sizes (...) that drifts are compared with: the largest sum of absolute values of what a quantity consists of."""

    def __init__(self, along: AlongMotion) -> None:
        self.states, self.found, self.model = along.states, along.sizes, along.model
        self.parameters, self.speed = along.states.values, np.abs(along.states.qd)

    @cached_property
    def momenta(self) -> Array:
        """Largest |g_ab| |q'^b| (..., n)."""
        return np.asarray(
            np.einsum("...kab,...kb->...ka", np.abs(self.found["metric"]), self.speed).max(axis=-2, initial=0)
        )

    def _energy(self) -> Array:
        """The largest kinetic energy, or the change of the potential energy."""
        # T = g_ab q'^a q'^b / 2
        qd, potential = self.states.qd, self.found["potential_energy"]
        kinetic = 0.5 * np.einsum("...kab,...ka,...kb->...k", self.found["metric"], qd, qd)
        change = np.ptp(potential, axis=-1) if potential.shape[-1] else np.zeros(potential.shape[:-1])
        return np.maximum(kinetic.max(axis=-1, initial=0), change)

    def _whole(self, kind: str) -> Array:
        """Of the whole: energy, momenta, or moments of mass."""
        if kind == "energy":
            return self._energy()
        # m s is the sum of P_a q^a where P does not change
        is_moment = kind == "mass_moment"
        columns = self.found["linear_momentum" if is_moment else kind]
        far = self._moved(np.abs(self.states.q)) if is_moment else self.speed
        return np.asarray(np.einsum("...kai,...ka->...k", np.abs(columns), far).max(axis=-1, initial=0))

    def _moved(self, q: Array) -> Array:
        """How far rates (n,) have moved the whole, of turns of ball joints at most as far as once around."""
        places = {name: q[..., k] for k, name in enumerate(self.model.positions)}
        for ball in self.model.balls:
            *slides, _, _, _ = ball["velocities"]
            far = np.sum([places[name] for name in ball["positions"][: len(slides)]], axis=0)
            places |= dict.fromkeys(slides, far) | dict.fromkeys(ball["velocities"][-3:], np.ones(q.shape[:-1]))
        return np.stack([places[name] for name in self.model.coordinates], axis=-1) if places else q

    def of(self, integral: Integral, value: Array) -> Array:
        """The size of one integral with these values."""
        if integral.kind == "cyclic":
            place = self.model.coordinates.index(integral.name.removeprefix("momentum."))
            return np.asarray(self.momenta[..., place])
        if integral.kind == "symmetry":
            # sum of |c^a| max |g_ab| |q'^b|
            c = read_expressions(self.model, {"c": [(x, "/direction") for x in integral.direction.values()]})
            first = {name: np.asarray(x)[..., 0] if np.ndim(x) else x for name, x in self.parameters.items()}
            sizes = np.abs(interpret(c, first, ["c"])["c"])
            places = [self.model.coordinates.index(name) for name in integral.direction]
            return np.asarray((sizes * self.momenta[..., places]).sum(axis=-1))
        if integral.terms:
            return self._of_terms(integral)
        size = self._whole(SIZED.get(integral.kind, integral.kind))
        if integral.kind in ("impulse", "galilei"):
            # P - F t, s - P t + F t^2 / 2
            longest = np.abs(self.states.t).max(axis=-1, initial=0) if integral.kind == "galilei" else 1.0
            size = size * longest + np.abs(value).max(axis=-1, initial=0)
        if integral.kind == "galilei":
            size = size + self._whole("mass_moment")
        return np.asarray(size)

    def _of_terms(self, integral: Integral) -> Array:
        """Of a sum of coefficients times momenta or velocities."""
        names = self.model.coordinates
        size = {f"p.{name}": self.momenta[..., a] for a, name in enumerate(names)}
        size |= {f"{name}'": self.speed[..., a].max(axis=-1, initial=0) for a, name in enumerate(names)}
        c = read_expressions(self.model, {"c": [(text, "/terms") for text, _ in integral.terms]})
        largest = np.abs(self.states.found(self.model, c, ["c"])["c"]).max(axis=-2, initial=0)
        each = [largest[..., k] * prod(size[w] for w in some) for k, (_, some) in enumerate(integral.terms)]
        return np.asarray(sum(each))


def integrals_along(model: Model, forces: Sequence[str], zero: Collection[str]) -> FirstIntegrals:
    """Those that all trees of its shape have, which are looked for once; but its own where more is searched for than
    symmetries, which may depend on its numbers, or where directions and reasons name these.
    """
    shape = model.of_shape
    found = first_integrals(shape, forces, zero)
    if shape is not model:
        told = str(found.summary()["integrals"])
        if found.degree > 1 or any(name in told for name in shape.numbers):
            return first_integrals(model, forces, zero)
    return replace(found, numbers=shape.numbers)
