"""A motion to be judged, what must hold along it, and the balance of its energy."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from substructures.analysis.equations.kernels import evaluated, program_kernel
from substructures.analysis.verdict import Check, Rule
from substructures.array import Array
from substructures.expr.program import Program
from substructures.tree.model import Model

#: of a sum, relative to its value; a state on closures is known to such a part, too
ROUNDING = 3e-14
#: results next to a singular position are known to so many times the limit, or they are not right
DOUBTED = 100


@dataclass(frozen=True)
class MotionStates:
    """A motion to be judged, or many, with an axis of them before the others: times (..., K), q, qd (..., K, n), values
    of all other symbols, numbers or (..., K), work W (..., K), None if unknown.
    """

    t: Array
    q: Array
    qd: Array
    values: Mapping[str, float | Array]
    work: Array | None

    def symbols(self, model: Model) -> dict[str, float | Array]:
        """Values of all symbols, one after the other where they vary."""
        values = {name: np.ravel(x) if isinstance(x, np.ndarray) and x.ndim else x for name, x in self.values.items()}
        values["t"] = np.ravel(self.t)
        values |= {name: np.ravel(self.q[..., a]) for a, name in enumerate(model.positions)}
        return values | {f"{name}'": np.ravel(self.qd[..., a]) for a, name in enumerate(model.coordinates)}

    def found(self, model: Model, source: Program, names: Sequence[str]) -> dict[str, Array]:
        """Outputs of a program along the motions, (..., K) and their own axes."""
        values, count = self.symbols(model), self.t.size
        if self.t.ndim == 1:
            return evaluated(source, values, names, count)
        flat = program_kernel(source.select(list(names))).evaluate(values, names)
        axes = {name: source.outputs[name].shape for name in names}
        return {
            n: np.broadcast_to(x, (count, *axes[n])).reshape(*self.t.shape, *axes[n]).copy() for n, x in flat.items()
        }


@dataclass(frozen=True)
class Condition:
    """What must hold along motions: ``violation`` (..., K), allowed up to limit * ``scale`` (...) + ``noise`` (...);
    ``applies`` (...): whether it has to.
    """

    about: tuple[str, Rule, str, str]
    violation: Array
    scale: Array
    noise: Array
    applies: Array


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
    """The largest difference of two values up to each, along the last axis: drift whatever it is counted from."""
    return np.asarray(np.maximum.accumulate(values, axis=-1) - np.minimum.accumulate(values, axis=-1))
