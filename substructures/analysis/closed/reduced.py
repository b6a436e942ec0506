"""A tree with closures in independent coordinates y: q(y), N and the reduced equations of motion at a state.

With G N = 0, q' = N y' and d_(j N_bk) = d^2 q^b / dy^j dy^k = -G^+ (d_c G_a) N_aj N_ck (notation.md, section 10)

    g*_ij = N_ai g_ab N_bj              Gamma*_ijk = N_ai (Gamma_abc N_bj N_ck + g_ab d_(j N_bk))
    Q*_i = N_ai Q_a                     g*_ij y''^j + Gamma*_ijk y'^j y'^k = Q*_i

The forces that hold the closures are not in them: N^T G^T = 0. G' q' and Gamma_abc q'^b q'^c are quadratic in the
rates, so that the terms with N_j and N_k are found by their values at N_j, N_k and N_j + N_k.
q(y) is followed from a start (:mod:`.following`).
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, fields, replace
from pathlib import Path
from typing import Any

import numpy as np
import scipy

from substructures.analysis.arguments import real, reals
from substructures.analysis.closed.constrained import Constrained, Singular
from substructures.analysis.closed.following import Index, followed, tangent
from substructures.analysis.closed.loops import MET, SOLVED, independent_coordinates
from substructures.analysis.closed.projection import consistent_state
from substructures.analysis.motion.problems.signals import Signal
from substructures.analysis.motion.problems.start import Start
from substructures.analysis.verdict import About, Check, verdict
from substructures.array import Array
from substructures.errors import Fault, InvalidArgument, among, listed
from substructures.mechanics.accelerations import condition
from substructures.mechanics.closure_rows import rank_of
from substructures.quantities.numbers.defaults import default_number
from substructures.quantities.numbers.evaluation import evaluate
from substructures.tree.document import require_ungiven
from substructures.tree.model import Model

#: of independent coordinates by name, one or (K,)
Given = Mapping[str, float | Sequence[float] | Array]


@dataclass(frozen=True)
class ReducedEquations:
    """The equations of motion in r ``independent`` coordinates at a state ``q``, ``qd`` (n,) that meets the closures;
    at K states one after the other, with the axis K first.

    ``tangent`` (n, r): N; ``tangent_derivative`` (n, r, r): d_(j N_bk); ``metric`` (r, r), ``christoffel`` (r, r, r;
    first kind, the first index is the equation) and ``forces`` (r,) of the reduced equations; ``accelerations`` (r,)
    that follow from them, and ``qdd`` (n,) of all coordinates. From the state on that is not reached, for the reason in
    ``message``, nothing is finite.
    """

    independent: tuple[str, ...]
    q: Array
    qd: Array
    qdd: Array
    tangent: Array
    tangent_derivative: Array
    metric: Array
    christoffel: Array
    forces: Array
    accelerations: Array
    message: str = ""
    checks: tuple[Check, ...] = ()

    @property
    def is_right(self) -> bool | None:
        """Whether the closures are met and the accelerations are those with multipliers; None without a result."""
        return verdict(self.checks, not self.message)

    def __repr__(self) -> str:
        at = f"q = {', '.join(f'{x:.6g}' for x in self.q)}" if self.q.ndim == 1 else f"{len(self.q)} states"
        return f"ReducedEquations in {listed(self.independent)} at {at}\n{self.message or 'closed'}"


def reduced_equations(
    model: Model,
    q: Given | None = None,
    *,
    qd: Given | None = None,
    independent: Sequence[str] | None = None,
    start: Mapping[str, float] | None = None,
    t: float = 0.0,
    parameters: Mapping[str, float] | None = None,
    inputs: Mapping[str, Signal] | None = None,
    folder: Path | None = None,
) -> ReducedEquations:
    """The equations of motion in independent coordinates at one state, or at K states one after the other.

    ``q`` [rad, m], ``qd`` [rad/s, m/s; 0 by default]: of independent coordinates by name, a number or (K,); those that
    are not given are where they start. ``independent``, ``start`` (coordinates by name, near a closed position): by
    default what the definitions of the parts say, start 0. ``t`` [s]; ``parameters``: in place of their defaults;
    ``inputs`` [N m, N]: numbers, expressions or tables. ``folder``: a cache of compiled kernels.

    Raises InvalidInput: ``not-of-tree`` without closures, ``unknown-coordinate``, ``not-independent``,
    ``wrong-number`` where the closures leave more or fewer coordinates free, ``out-of-range``; and MissingValue. A
    start that cannot be closed and places that cannot be reached are messages in the result.
    """
    require_ungiven(model, "take simulations, or loop states")
    names, t = _independent(model, independent), real(t, "/t")
    begin = _start(model, start or {})
    y, rates, is_one = _states(model, names, {"q": q or {}, "qd": qd or {}}, begin)
    s = Constrained(model, Start(begin, None, parameters or {}, inputs or {}), (t, t), folder=folder)
    found: list[ReducedEquations] = []
    message = ""
    try:
        places = _begun(s, names)
        for target, rate in zip(y, rates, strict=True):
            s.move(t, followed(s, found[-1].q if found else s.q, places, target), np.zeros(s.n))
            found.append(_equations(s, names, places, rate, parameters or {}))
    except Singular as error:
        message = str(error)
    whole = [*found, *[_nothing(model, names)] * (len(y) - len(found))]
    return replace(whole[0] if is_one else _together(whole), message=message)


def _begun(s: Constrained, names: tuple[str, ...]) -> tuple[Index, Index]:
    """Close s at its start; the numbers of the independent and of the dependent coordinates. Raises Singular, and
    InvalidArgument where another number of them is free.
    """
    y = np.array([s.model.coordinates.index(name) for name in names], dtype=np.int64)
    closed = consistent_state(s, s.t, s.conditions.q, np.zeros(s.n), names)
    if not closed.found:
        free = consistent_state(s, s.t, s.conditions.q, np.zeros(s.n))
        if free.found:
            s.move(s.t, free.q, np.zeros(s.n))
            _require_number(s, names)
        raise Singular(f"at the start {closed.message}")
    s.move(s.t, closed.q, np.zeros(s.n))
    _require_number(s, names)
    return y, np.setdiff1d(np.arange(s.n), y)


def _independent(model: Model, given: Sequence[str] | None) -> tuple[str, ...]:
    """The names of independent coordinates. Raises InvalidArgument."""
    if not model.closures:
        message = "the tree has no closures: its metric, christoffel and forces are those of evaluations"
        raise InvalidArgument.at("/independent", "not-of-tree", message)
    names = model.reduction.independent if given is None else tuple(given)
    for i, name in enumerate(names):
        _require_known(model, name, f"/independent/{i}")
        if name in names[:i]:
            raise InvalidArgument.at(f"/independent/{i}", "duplicate-name", f"'{name}' is named twice")
    if given is None and not names:
        message = "the definitions do not name independent coordinates for all closures: name those of the tree here"
        raise InvalidArgument.at("/independent", "missing", f"{message}; it has {listed(model.coordinates)}")
    return names


def _require_known(model: Model, name: str, pointer: str) -> None:
    if name not in model.coordinates:
        message = f"unknown coordinate '{name[:80]}'{among(name, model.coordinates)}"
        raise InvalidArgument.at(pointer, "unknown-coordinate", message)


def _states(
    model: Model, names: Sequence[str], given: Mapping[str, Given], begin: Mapping[str, float]
) -> tuple[Array, Array, bool]:
    """Independent coordinates and rates (K, r), and whether there is one state alone. Raises InvalidArgument."""
    wanted, rates = (_given(names, given[field], field) for field in ("q", "qd"))
    _require_ranges(model, wanted)
    lists = [x for x in (*wanted.values(), *rates.values()) if isinstance(x, tuple)]
    count = len(lists[0]) if lists else 1
    if any(len(x) != count for x in lists) or not count:
        sizes = listed(sorted({str(len(x)) for x in lists}))
        message = f"as many numbers of every coordinate and rate are needed, one or more; there are {sizes}"
        raise InvalidArgument.at("/q", "wrong-length", message)
    y = [np.broadcast_to(wanted.get(name, begin[name]), count) for name in names]
    return np.stack(y, axis=1), np.stack([np.broadcast_to(rates.get(x, 0.0), count) for x in names], axis=1), not lists


def _given(names: Sequence[str], given: Given, field: str) -> dict[str, float | tuple[float, ...]]:
    """Values of independent coordinates. Raises InvalidArgument."""
    if not isinstance(given, Mapping):
        message = f"independent coordinates by name are needed, as in {{'{names[0]}': 0.1}}"
        raise InvalidArgument.at(f"/{field}", "object-expected", message)
    others = [name for name in given if name not in names]
    if others:
        message = f"'{others[0][:80]}' is not independent: {listed(names)} are"
        raise InvalidArgument.at(f"/{field}/{others[0]}", "not-independent", message)
    many = (list, tuple, np.ndarray)
    return {
        name: reals(x, f"/{field}/{name}") if isinstance(x, many) else real(x, f"/{field}/{name}")
        for name, x in given.items()
    }


def _require_ranges(model: Model, wanted: Mapping[str, float | tuple[float, ...]]) -> None:
    faults = []
    for name, (low, high) in model.reduction.ranges.items():
        least, most = default_number(low), default_number(high)
        beyond = [x for x in np.atleast_1d(wanted.get(name, least)) if not least <= x <= most]
        if beyond:
            message = f"{beyond[0]:.6g} is outside of the range of '{name}', from {least:.6g} to {most:.6g}"
            faults.append(Fault(f"/q/{name}", "out-of-range", message))
    if faults:
        raise InvalidArgument(faults)


def _start(model: Model, given: Mapping[str, float]) -> dict[str, float]:
    """All coordinates where the way begins. Raises InvalidArgument."""
    for name in given:
        _require_known(model, name, f"/start/{name}")
    said = {name: default_number(x) for name, x in model.reduction.start.items()}
    return dict.fromkeys(model.coordinates, 0.0) | said | {name: real(x, f"/start/{name}") for name, x in given.items()}


def _require_number(s: Constrained, names: Sequence[str]) -> None:
    """Raises InvalidArgument where the closures leave another number of coordinates free."""
    free = s.n - rank_of(s.balanced)
    if free != len(names):
        chosen = listed(s.model.coordinates[a] for a in independent_coordinates(s.balanced))
        message = f"the closures leave {free} coordinates free, and {len(names)} are independent"
        raise InvalidArgument.at("/independent", "wrong-number", f"{message}: name {free}, as {chosen or 'none'}")


def _equations(
    s: Constrained, names: tuple[str, ...], places: tuple[Index, Index], rates: Array, parameters: Mapping[str, float]
) -> ReducedEquations:
    """At the position where s is. Raises Singular."""
    (y, z), q = places, s.q
    N = tangent(s, y, z)
    bias, curved = _bilinear(s.model, q, N, parameters)
    second = np.zeros((s.n, len(y), len(y)))
    # G_z d_(j N_zk) = -(d_c G_a) N_aj N_ck
    flat = -(curved / s.reach[:, None, None]).reshape(len(s.reach), -1)
    second[z] = scipy.linalg.lstsq(s.balanced[:, z], flat)[0].reshape(len(z), len(y), len(y))
    g = s.g.copy()
    metric = N.T @ g @ N
    # Gamma*_ijk = N_ai (Gamma_abc N_bj N_ck + g_ab d_(j N_bk))
    christoffel = np.einsum("ai,ajk->ijk", N, bias + np.einsum("ab,bjk->ajk", g, second))
    qd = N @ rates
    s.move(s.t, q, qd)
    # Q = f + Gamma q' q'
    forces = N.T @ (s.f + np.einsum("ajk,j,k->a", bias, rates, rates))
    if not np.isfinite(metric).all() or not condition(metric[None])[0] < 1 / np.finfo(float).eps:
        raise Singular("no inertia moves along some of the independent coordinates: check masses and inertias")
    found = np.linalg.solve(metric, forces - np.einsum("ijk,j,k->i", christoffel, rates, rates))
    qdd = N @ found + np.einsum("bjk,j,k->b", second, rates, rates)
    checks = tuple(_checks(s, qdd))
    return ReducedEquations(names, q, qd, qdd, N, second, metric, christoffel, forces, found, "", checks)


def _bilinear(model: Model, q: Array, N: Array, parameters: Mapping[str, float]) -> tuple[Array, Array]:
    """Gamma_abc N_bj N_ck (n, r, r) and (d_c G_ka) N_aj N_ck (m, r, r), by their quadratic forms."""
    r = N.shape[1]
    pairs = [(j, k) for j in range(r) for k in range(j + 1, r)]
    v = np.concatenate([N.T, *(N[:, [j]].T + N[:, [k]].T for j, k in pairs)])
    names = ["bias", "closure.acceleration"]
    found = evaluate(model, names, q=np.tile(q, (len(v), 1)), qd=v, parameters=dict(parameters))
    result = []
    for name in names:
        values = found[name]
        whole = np.zeros((values.shape[1], r, r))
        for j in range(r):
            whole[:, j, j] = values[j]
        for x, (j, k) in zip(values[r:], pairs, strict=True):
            # 2 B(u, v) = B(u + v) - B(u) - B(v)
            whole[:, j, k] = whole[:, k, j] = (x - values[j] - values[k]) / 2
        result.append(whole)
    return result[0], result[1]


def _checks(s: Constrained, qdd: Array) -> Iterator[Check]:
    met: About = ("position residual", "zero", "the closures are met", "1")
    yield Check.at(met, s.opening, s.t, max(1.0, float(np.abs(s.q).max())), MET)
    other, _ = s.accelerations(s.independent_rows())
    same: About = ("accelerations", "accurate", "g q'' + Gamma q'q' = Q + G^T lambda, G q'' + c = 0", "rad/s^2, m/s^2")
    yield Check.at(same, float(np.abs(other - qdd).max()), s.t, max(1.0, float(np.abs(other).max())), SOLVED)


def _together(found: Sequence[ReducedEquations]) -> ReducedEquations:
    """States one after the other, with the worst of every check."""
    names = [x.name for x in fields(found[0]) if isinstance(getattr(found[0], x.name), np.ndarray)]
    arrays: dict[str, Any] = {name: np.stack([getattr(each, name) for each in found]) for name in names}
    pairs = zip(*(each.checks for each in found if each.checks), strict=True)
    checks = tuple(max(some, key=lambda check: check.worst / check.scale) for some in pairs)
    return replace(found[0], **arrays, checks=checks)


def _nothing(model: Model, names: tuple[str, ...]) -> ReducedEquations:
    """A state that is not reached."""
    n, r = (np.full(size, np.nan) for size in (model.dof, len(names)))
    nr, rr = np.full((len(n), len(r)), np.nan), np.full((len(r), len(r)), np.nan)
    nrr, rrr = (np.full((len(x), *rr.shape), np.nan) for x in (n, r))
    return ReducedEquations(names, n, n, n, nr, nrr, rr, rrr, r, r)
