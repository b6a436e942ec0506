"""Stability of a steady motion by its first integrals (E. J. Routh; A. M. Lyapunov; N. G. Chetaev).

A steady motion is a stationary point of the energy H at constant values of the other integrals I_k: dH = l_k dI_k.
Where the second variation of H - l_k I_k is definite for all disturbances that keep dI_k = 0, positive or negative, H
and the I_k together bound the motion, and it is stable but for shifts of the coordinates s that move anyway. Where
the dI_k depend on each other, so that the l_k are not unique, one choice that makes it definite is enough (Chetaev's
proof for the sleeping top). An I_k that changes with s counts when its derivative by s vanishes: then it is a
component, zero in the steady motion, of a vector whose square does not change with s. With ball joints the numbers of
a state have the squares of their quaternions among the integrals, and shifts are turns about axes of bodies.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from functools import lru_cache

import numpy as np
import scipy

from substructures.analysis.equations.first_integrals import first_integrals
from substructures.analysis.motion.conditions import state_names
from substructures.array import Array
from substructures.expr.differentiate import gradient
from substructures.expr.graph import Expr, Graph
from substructures.expr.interpret import interpret
from substructures.expr.known import Known
from substructures.expr.program import Program, Symbol, array, program
from substructures.expr.replay import replay
from substructures.quantities.numbers.memo import known_model
from substructures.quantities.numbers.quaternions import by_displacements
from substructures.tree.model import Model

#: coordinates of models that are looked at: second derivatives of all integrals are formed
MOST = 12
#: what counts as zero, relative to the largest of its kind; and the least eigenvalue that counts as definite
NOTHING, DEFINITE = 1e-9, 1e-7
#: |Q|^2, which every motion keeps
LENGTH = "|Q|"


def bounded_by_integrals(
    model: Model, values: Mapping[str, float], shifts: Array, zero: Sequence[str] = ()
) -> str | None:
    """Why the steady motion at ``values`` (of all symbols) is stable, None where this does not tell.

    ``shifts`` (k, m + n): changes of a state that lead along the motion, see :func:`shifts_along`. ``zero``: parameters
    that are 0. All inputs are 0, and the energy is constant. No closures.
    """
    if model.dof > MOST:
        return None
    names, source = _derivatives(known_model(model), frozenset(zero))
    if "energy" not in names:
        return None
    found = interpret(source, {s.name: values[s.name] for s in source.symbols}, ["first", "second"])
    if not all(np.isfinite(x).all() for x in found.values()):
        return None
    H = names.index("energy")
    unit = _units(model, found["second"][H])
    shifts = shifts / unit
    shifts /= np.linalg.norm(shifts, axis=1, keepdims=True)
    found = _sized({"first": found["first"] * unit, "second": found["second"] * unit * unit[:, None]})
    # z = (x, q'): without the shifts s
    z = scipy.linalg.null_space(shifts) if len(shifts) else np.eye(shifts.shape[1])
    used = [k for k in range(len(names)) if k != H and _is_invariant(found["first"][k], shifts)]
    dH, dI = found["first"][H] @ z, found["first"][used] @ z
    second = np.einsum("kab,ai,bj->kij", found["second"], z, z)
    multipliers, family = _multipliers(dH, dI)
    if multipliers is None:
        return None
    kernel = _kernel(dI)
    W = [kernel.T @ second[k] @ kernel for k in (H, *used)]
    base = W[0] - sum((x * w for x, w in zip(multipliers, W[1:], strict=True)), np.zeros_like(W[0]))
    more = [sum((x * w for x, w in zip(row, W[1:], strict=True)), np.zeros_like(W[0])) for row in family]
    for sign, word in ((1.0, "minimum"), (-1.0, "maximum")):
        if _can_be_definite(sign * base, more):
            kept = ", ".join(names[k] for k in used if names[k] != LENGTH) or "no other integral"
            return f"the energy has a strict {word} at constant {kept} (Routh, Lyapunov)"
    return None


@lru_cache(maxsize=16)
def _derivatives(known: Known, zero: frozenset[str]) -> tuple[tuple[str, ...], Program]:
    """Names of the constant integrals, and their first (k, 2n) and second (k, 2n, 2n) derivatives by (q, q')."""
    model: Model = known.source
    found = first_integrals(model, (), zero)
    # energies of subsystems are parts of the one that is minimised
    lasting = [i.name for i in found.integrals if i.rule == "constant" and i.kind != "subsystem"]
    # a bound in the time is none
    timed = {name for name in lasting if any(s.kind == "time" for s in found.program.select([name]).symbols)}
    names = tuple(name for name in lasting if name not in timed)
    graph = Graph()
    outputs = replay(found.program, graph, dict.fromkeys(zero, graph.zero), names)
    integrals: list[Expr] = [graph.lift(outputs[name].entries.get((), 0)) for name in names]
    for ball in model.balls:
        integrals.append(graph.sum(graph.symbol(name) * graph.symbol(name) for name in ball["positions"][-4:]))
        names = (*names, LENGTH)
    z = state_names(model)
    first = gradient(integrals, z)
    second = [gradient(row, z) for row in first]
    size = (len(names), len(z))
    formulas = {
        "first": array(size, lambda k, a: first[k][a]),
        "second": array((*size, len(z)), lambda k, a, b: second[k][a][b]),
    }
    symbols = {s.name: s for s in found.program.symbols}
    symbols |= {name: Symbol(name, "coordinate", unit) for name, unit in model.state_units["q"].items()}
    return names, program(graph, formulas, symbols)


def shifts_along(model: Model, values: Mapping[str, float], displacements: Array) -> Array:
    """Changes (k, m + n) of a state with ``displacements`` (k, n), of ball joints turns about axes of the body."""
    states = model.positions, model.coordinates, model.balls
    displaced = np.linalg.pinv(by_displacements(*states, np.array([values[name] for name in model.positions])))
    return np.concatenate((displacements @ displaced.T, np.zeros((len(displacements), model.dof))), axis=1)


def _units(model: Model, second: Array) -> Array:
    """What a state (m + n,) is measured in, whatever the masses and lengths: coordinates and their rates in what has
    the same energy, g_aa^(-1/2) beside the largest; quaternions in 1. ``second``: derivatives of the energy.
    """
    inertia = np.diag(second)[len(model.positions) :]
    rates = np.where(inertia > 0, 1 / np.sqrt(np.where(inertia > 0, inertia, 1.0)), 0.0)
    rates = np.where(rates > 0, rates / (rates.max(initial=0) or 1.0), 1.0)
    by_name = dict(zip(model.coordinates, rates.tolist(), strict=True))
    return np.array([*(by_name.get(name, 1.0) for name in model.positions), *rates])


def _sized(found: Mapping[str, Array]) -> dict[str, Array]:
    """Derivatives (k, ...) of each integral over the largest of it, whatever the masses and lengths."""
    sizes = np.fmax(*(np.abs(x).reshape(len(x), -1).max(axis=1, initial=0) for x in found.values()))
    return {name: (x.T / np.where(sizes > 0, sizes, 1.0)).T for name, x in found.items()}


def _is_invariant(first: Array, shifts: Array) -> bool:
    """Whether an integral does not change with s, to first order."""
    return bool(np.abs(shifts @ first).max(initial=0) <= NOTHING * max(1.0, float(np.abs(first).max(initial=0))))


def _multipliers(dH: Array, dI: Array) -> tuple[Array | None, Array]:
    """l with dH = l dI, None where there are none, and a basis of what may be added to l."""
    scale = max(1.0, float(np.abs(dH).max(initial=0)))
    multipliers = np.linalg.lstsq(dI.T, dH, rcond=NOTHING)[0] if len(dI) else np.zeros(0)
    if np.abs(dH - dI.T @ multipliers).max(initial=0) > 1e-7 * scale:
        return None, np.zeros((0, len(dI)))
    family = _kernel(dI.T).T if len(dI) else np.zeros((0, 0))
    return np.asarray(multipliers), family


def _kernel(rows: Array) -> Array:
    """An orthonormal basis (size, k) of what the rows take to zero."""
    _, sizes, directions = (
        np.linalg.svd(rows, full_matrices=True) if len(rows) else (0, np.zeros(0), np.eye(rows.shape[1]))
    )
    rank = int((sizes > NOTHING * max(1.0, float(sizes.max(initial=0)))).sum())
    return np.asarray(directions[rank:].T)


def _can_be_definite(base: Array, more: Sequence[Array]) -> bool:
    """Whether base + sum v_k more_k is positive definite for some v; its least eigenvalue is concave in v."""
    size = max((float(np.abs(x).max(initial=0)) for x in (base, *more)), default=0.0)
    if not len(base):
        return True
    if not size:
        return False

    def least(v: Array) -> float:
        """Minus the least eigenvalue, relative to the largest."""
        x = base + sum((a * b for a, b in zip(v, more, strict=True)), np.zeros_like(base))
        eigenvalues = np.linalg.eigvalsh(x)
        return float(-eigenvalues[0] / max(float(np.abs(eigenvalues).max()), 1e-9 * size))

    more = [x for x in more if np.abs(x).max(initial=0) > NOTHING * size]
    start = np.zeros(len(more))
    if least(start) < -DEFINITE or not len(more):
        return least(start) < -DEFINITE
    spread = size / max(float(np.abs(x).max(initial=0)) for x in more)
    for step in (0.1, 1.0, 10.0):
        for way in (step, -step):
            found = scipy.optimize.minimize(least, start + way * spread, method="Nelder-Mead", options={"maxiter": 400})
            if found.fun < -DEFINITE:
                return True
    return False
