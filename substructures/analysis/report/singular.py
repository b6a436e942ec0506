"""Conclusions about singular positions: where in the limits of joints a motion of the coordinates moves no mass."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from substructures.analysis.report.rest import MOST_COORDINATES, MOST_OPERATIONS
from substructures.analysis.report.sizes import SEED, missing_values, sampled
from substructures.analysis.report.statements import Figure, Names, Statement
from substructures.array import Array
from substructures.errors import listed
from substructures.expr.interpret import interpret_in_blocks
from substructures.expr.program import Program
from substructures.quantities.numbers.defaults import input_defaults
from substructures.quantities.numbers.states import read_states, symbol_values
from substructures.tree.model import Model

#: places about the worst one in each round of the search, rounds, and how much smaller each is
PLACES, ROUNDS, SMALLER = 64, 40, 0.7
#: least eigenvalues that count as zero, and parts of a direction that are told
ZERO, PART = 1e-8, 0.01


def singular_statements(model: Model, names: Names, address: str) -> Iterator[Statement]:
    """Where the least eigenvalue of the metric, each element g_ab over the largest sqrt(g_aa) sqrt(g_bb) of random
    states, is least: the worst of these states, improved by random places about it, closer in each round. ``address``:
    of the tree, for requests that tell more.
    """
    metric = model.program.select(["metric"])
    why = _unsearched(model, metric)
    if why or not model.dof:
        if model.dof:
            yield _left_out(why)
        return
    q, ranges = sampled(model)
    low, high = np.array(list(ranges.values())).T
    g = _metric(model, q)
    size = np.sqrt(np.abs(np.einsum("saa->sa", g)).max(axis=0))
    if not np.isfinite(g).all():
        yield _left_out("the mass matrix is not finite at some of the random states")
        return
    if not size.all():
        still = listed(names[c] for c, x in zip(model.coordinates, size, strict=True) if not x)
        yield Statement("singular", "singular", f"The mass matrix is singular everywhere: {still} moves no mass.")
        return
    roots = _least(g, size)
    place, least = q[roots.argmin()], roots.min()
    reach, rng = (high - low) / 2, np.random.default_rng(SEED)
    for _ in range(ROUNDS):
        near = np.clip(place + reach * rng.uniform(-1, 1, (PLACES, model.dof)), low, high)
        roots = _least(_metric(model, near), size)
        if roots.min() < least:
            place, least = near[roots.argmin()], roots.min()
        reach = SMALLER * reach
    yield _told(model, names, place, size, address)


def _unsearched(model: Model, metric: Program) -> str:
    """Why no search is made."""
    if model.dof > MOST_COORDINATES or len(metric) > MOST_OPERATIONS:
        size = f"{model.dof} coordinates and {len(metric):,} operations"
        return f"{size}; the limits are {MOST_COORDINATES} and {MOST_OPERATIONS:,}"
    missing = missing_values(model, metric)
    return f"parameters without a value: {listed(missing)}" if missing else ""


def _left_out(why: str) -> Statement:
    return Statement("singular", "not-looked-for", f"Singular positions were not looked for: {why}.")


def _told(model: Model, names: Names, place: Array, size: Array, address: str) -> Statement:
    """The worst place with the motion that moves least mass."""
    roots, vectors = np.linalg.eigh(_metric(model, place[None])[0] / np.outer(size, size))
    least, direction = max(float(roots[0]), 0.0), vectors[:, 0] / size
    direction /= direction[np.abs(direction).argmax()]
    used = {s.name for s in model.program.select(["metric"]).symbols}
    units = {c: "rad" if kind == "R" else "m" for c, kind in zip(model.coordinates, model.joints, strict=True)}
    at = {c: round(x, 6) + 0.0 for c, x in zip(model.coordinates, place.tolist(), strict=True) if c in used}
    where = f" at {listed(f'{names[c]} = {x:.4g} {units[c]}' for c, x in at.items())}" if at else ""
    figures = (Figure("least_eigenvalue", least, "1"), *(Figure(c, x, units[c]) for c, x in at.items()))
    moved = zip(model.coordinates, direction.tolist(), strict=True)
    rates = listed(f"{names[c]} {x:.3g}" for c, x in moved if abs(x) > PART)
    ends = f"its least eigenvalue, in units of its largest diagonal elements, is {least:.2g}"
    if least < ZERO:
        text = f"The mass matrix is singular{where} because {ends}: rates in the ratio {rates} move no mass."
    else:
        found = f"because {ends} at the worst place found{where}"
        text = f"No singular position was found in the limits of the joints {found}."
    request = f"POST {address}/evaluations" if address else ""
    return Statement("singular", "singular" if least < ZERO else "regular", text, (), tuple(at), figures, request)


def _metric(model: Model, q: Array) -> Array:
    """(N, n, n) at the default values."""
    states = read_states(model, {"q": q}, None)
    given = {"t": 0.0, "parameters": {}, "inputs": input_defaults(model.inputs)}
    values = symbol_values(model, given, states, ["metric"])
    with np.errstate(all="ignore"):
        found = interpret_in_blocks(model.program, values, ["metric"], len(q))["metric"]
    return np.asarray(found, dtype=np.float64)


def _least(g: Array, size: Array) -> Array:
    """The least eigenvalue (N,) of each metric in units of ``size``; infinite where it has none."""
    scaled = g / np.outer(size, size)
    good = np.isfinite(scaled).all(axis=(1, 2))
    return np.where(good, np.linalg.eigvalsh(np.where(np.isfinite(scaled), scaled, 0))[:, 0], np.inf)
