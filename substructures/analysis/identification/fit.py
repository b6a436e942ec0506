"""Base parameters from measured motion: excitation, least squares, standard deviations.

With the base regressor of N samples stacked to W (N n, b), and the actuator forces to the vector tau

    beta = argmin |D^-1 (W beta - tau + known)|^2,        cov(beta) = (W^T D^-2 W)^-1

where D holds the standard deviation of every joint's force, estimated from its residual and used as weight in a second
pass (M. Gautier, Dynamic identification of robots with power model, IEEE ICRA 1997; J. Swevers et al., Optimal robot
excitation and identification, IEEE Transactions on Robotics and Automation 13(5), 1997). ``known`` are forces that are
no inertial forces: springs, dampers, loads and armature of a model with known values, where one is given.

Excitation is judged by the singular values of W with columns scaled to length one: a motion excites a combination of
parameters well when its singular value is not small beside the largest.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from substructures.analysis.arguments import positive, real
from substructures.analysis.equations.formulas import require_moving
from substructures.analysis.given import StateArray, require_known
from substructures.analysis.identification.base_parameters import BaseParameters
from substructures.analysis.identification.findings import LIMIT, Excitation, Identification
from substructures.analysis.identification.on_closures import Loops
from substructures.analysis.identification.on_constraints import Rolled
from substructures.analysis.verdict import Check
from substructures.array import Array
from substructures.errors import InvalidArgument, InvalidDocument
from substructures.expr.interpret import interpret_in_blocks
from substructures.quantities.measured import numeric
from substructures.quantities.numbers.evaluation import evaluate
from substructures.quantities.numbers.states import by_name, read_states, symbol_values
from substructures.tree.model import Model

#: relative size of a singular value that counts as zero
RANK = 1e-10
#: what the normal equations may leave
NORMAL = 1e-8
#: part of the force of a joint that may be unexplained or uncertain in a right result
ERROR_LIMIT = 0.1
REGRESSOR, OWN = "base_regressor", "base_parameters"


@dataclass(frozen=True)
class _Motion:
    """A motion that was given, and numbers in place of the defaults of parameters."""

    q: StateArray
    qd: StateArray | None
    qdd: StateArray | None
    parameters: Mapping[str, Any]


@dataclass(frozen=True)
class _Data:
    """A motion (N, n each), and outputs of the program along it."""

    q: Array
    qd: Array
    qdd: Array
    outputs: Mapping[str, Array]


def excitation(
    base: BaseParameters,
    q: StateArray,
    qd: StateArray | None,
    qdd: StateArray,
    *,
    parameters: Mapping[str, Any] | None = None,
    closed: Model | None = None,
) -> Excitation:
    """How well a motion shows the base parameters: singular values of the scaled regressor W = [Y_B(q, q', q'')].

    ``q``, ``qd``, ``qdd`` (N, n), or columns by coordinate [rad, m, s]; ``qd`` None: at rest. ``parameters``: kinematic
    ones, in place of their defaults; ``closed``: the tree, where it has closures or velocity constraints. Raises
    InvalidInput (``/q``, ``/qdd``, ``/parameters/name``, ...) and MissingValue. Source: J. Swevers et al., IEEE
    Transactions on Robotics and Automation 13(5), 1997.
    """
    data = _stacked(base, _Motion(q, qd, qdd, _of_base(base, parameters or {}, closed)))
    if closed is None:
        return _excitation(base.names, data.outputs[REGRESSOR])
    loops = _tied(closed).of(closed, base, data.q, parameters or {})
    fewer, W, _ = loops.reduced(base, data.q, data.outputs[REGRESSOR], None)
    return _excitation(fewer.names, W)


def identify(
    base: BaseParameters,
    q: StateArray,
    qd: StateArray | None,
    qdd: StateArray,
    tau: StateArray,
    *,
    parameters: Mapping[str, Any] | None = None,
    model: Model | None = None,
    closed: Model | None = None,
    held_out: float = 0.0,
    error_limit: float = ERROR_LIMIT,
) -> Identification:
    """Base parameters beta from a measured motion: beta = argmin |D^-1 (W beta - tau + known)|^2 (see above).

    ``q``, ``qd``, ``qdd``, ``tau`` (N, n) [rad, m, s, N m, N], or columns by coordinate; ``qd`` None: at rest.
    ``parameters``: kinematic ones, and those of the models, in place of their defaults. ``model``: whose springs,
    dampers, loads and armature are known, and do not depend on the time (its masses do not matter, drives are found as
    differences to its own); without one ``tau`` is explained by the base parameters alone. ``closed``: the tree, where
    it has closures or velocity constraints: ``base`` are those without them, of which motions with them tell
    ``combinations``, from what forces do along the independent coordinates. ``held_out``: part of the samples, the last
    ones, that is predicted and not fitted. Checks: the normal equations hold; the force that is not explained, and the
    force that any one standard deviation of a parameter makes, are parts of the force of every joint (root mean
    squares) that may reach ``error_limit``. A motion that does not excite all of them is a result with status
    ``failed``. Raises InvalidInput (``/q``, ``/tau``, ``/qdd``, ...; ``too-few``) and MissingValue. Source: M. Gautier,
    IEEE ICRA 1997.
    """
    given, names = parameters or {}, (REGRESSOR,) if model is None else (REGRESSOR, OWN)
    data = _stacked(base, _Motion(q, qd, qdd, _of_base(base, given, model, closed)), names)
    force = _forces(base, tau, data)
    limit, kept = positive(error_limit, "error_limit"), _fitted_samples(len(force), held_out)
    inertial, W = force if model is None else force - _known(model, given, data), data.outputs[REGRESSOR]
    told: dict[str, Any] = {}
    if closed is not None:
        loops = _tied(closed).of(closed, base, data.q, given)
        told = {"independent": loops.independent, "combinations": loops.combinations(base)}
        base, W, inertial = loops.reduced(base, data.q, W, inertial)
    found = replace(_fitted(base, W[:kept], inertial[:kept], limit), **told)
    return found if kept == len(W) else _predicted(found, W[kept:], inertial[kept:], limit)


def _of_base(base: BaseParameters, given: Mapping[str, Any], *models: Model | None) -> dict[str, Any]:
    """The parameters that the base parameters depend on. Raises InvalidArgument for those that none of all knows."""
    known = {*base.parameters, *(name for model in models if model is not None for name in model.parameters)}
    require_known("parameters", "parameter", given, known)
    return {name: x for name, x in given.items() if name in base.parameters}


def _tied(model: Model) -> type[Loops]:
    """Closures, or velocity constraints with them."""
    return Rolled if model.velocity_constraints else Loops


def _fitted_samples(count: int, held_out: float) -> int:
    """How many samples, the first ones, are fitted."""
    share = real(held_out, "/held_out")
    if not 0 <= share < 1:
        raise InvalidArgument.at("/held_out", "out-of-range", f"a part below 1 is needed, found {share:g}")
    return count - round(share * count)


def _predicted(found: Identification, W: Array, tau: Array, limit: float) -> Identification:
    """With what is left of the force of samples that took no part."""
    left = np.sqrt(np.mean((tau - W @ found.values) ** 2, axis=0))
    size = np.sqrt(np.mean(tau**2, axis=0))
    worst = float((left / np.where(size > 0, size, 1.0)).max(initial=0))
    how = "root mean square of the force that is not predicted, over that of the force, of the worst joint"
    check = Check.at(("held-out force", "accurate", how, "1"), worst, 0.0, 1.0, limit)
    return replace(found, held_out=left, checks=(*found.checks, check))


def _fitted(base: BaseParameters, W: Array, tau: Array, limit: float) -> Identification:
    """Least squares twice, the second time with the standard deviations of the first as weights."""
    b = base.count
    judged = _excitation(base.names, W)
    if W.shape[0] * W.shape[1] <= b:
        message = f"{len(W)} samples of {W.shape[1]} joints cannot determine {b} parameters: give more"
        raise InvalidArgument.at("/q", "too-few", message)
    flat, force = W.reshape(-1, b), tau.reshape(-1)
    first = _solved(flat, force)
    # D = diag sigma_a,  sigma_a^2 = mean over the samples of (tau - W beta)_a^2
    sigma = np.sqrt(np.mean((tau - W @ first) ** 2, axis=0))
    # a joint that is explained to rounding must not take all the weight
    least = 1e-12 * float(np.abs(tau).max(initial=0)) or 1.0
    weight = np.tile(1 / np.maximum(sigma, least), len(W))
    values = _solved(flat * weight[:, None], force * weight)
    residual = tau - W @ values
    covariance = _covariance(flat * weight[:, None], residual.reshape(-1) * weight)
    spread = np.sqrt(np.diag(covariance))
    full = judged.rank == b
    normal = flat * weight[:, None], residual.reshape(-1) * weight, force * weight
    return Identification(
        base.names,
        tuple(base.units[i] for i in base.base),
        values,
        spread,
        covariance,
        np.sqrt(np.mean(residual**2, axis=0)),
        judged,
        "identified" if full else "failed",
        "" if full else judged.advice,
        (_normal(*normal), *_explained(W, tau, residual, spread, limit)),
    )


def _normal(W: Array, residual: Array, tau: Array) -> Check:
    """The condition of least squares, W^T D^-2 r = 0, relative to W^T D^-2 tau."""
    with np.errstate(invalid="ignore"):
        sizes = np.linalg.norm(W, axis=0) * float(np.linalg.norm(tau))
        worst = float((np.abs(residual @ W) / np.where(sizes > 0, sizes, 1.0)).max(initial=0))
    return Check.at(("normal equations", "zero", "W^T D^-2 (tau - W beta) = 0", "1"), worst, 0.0, 1.0, NORMAL)


def _explained(W: Array, tau: Array, residual: Array, deviations: Array, limit: float) -> tuple[Check, ...]:
    """What is not explained, and what is uncertain, as parts of the force of a joint, the worst one."""
    size = np.sqrt(np.mean(tau**2, axis=0))
    # of rounding, where a joint needs no force at all
    size = np.maximum(size, 1e-12 * float(size.max(initial=0))) + (0.0 if size.any() else 1.0)
    left = float((np.sqrt(np.mean(residual**2, axis=0)) / size).max(initial=0))
    share = np.sqrt(np.mean(W**2, axis=0)) / size[:, None] * np.where(np.isfinite(deviations), deviations, 0.0)
    doubt = float(share.max(initial=0)) if np.isfinite(deviations).all() else np.inf
    explained = "root mean square of the force that is not explained, over that of the force, of the worst joint"
    known = "force that the standard deviation of a parameter makes, over that of the joint, of the worst of both"
    return (
        Check.at(("explained force", "accurate", explained, "1"), left, 0.0, 1.0, limit),
        Check.at(("deviations", "accurate", known, "1"), doubt, 0.0, 1.0, limit),
    )


def _stacked(base: BaseParameters, motion: _Motion, names: tuple[str, ...] = (REGRESSOR,)) -> _Data:
    """Outputs of the program along a motion."""
    view = _view(base)
    require_moving(view, "identifications")
    states = read_states(view, vars(motion), None)
    if states.qdd is None:
        raise InvalidArgument.at("/qdd", "missing", "accelerations 'qdd' are needed")
    values = symbol_values(view, vars(motion), states, ())
    values |= {f"{name}''": states.qdd[:, a] for a, name in enumerate(base.coordinates)}
    # one position for all accelerations, ...
    q, qd, qdd = (np.broadcast_to(x, (states.count, x.shape[1])) for x in (states.q, states.qd, states.qdd))
    return _Data(q, qd, qdd, interpret_in_blocks(base.program, values, names, states.count))


def _view(base: BaseParameters) -> Model:
    return Model(base.program, base.coordinates, base.joints, (), base.parameters, {}, balls=base.balls)


def _forces(base: BaseParameters, given: Any, data: _Data) -> Array:
    if given is None:
        raise InvalidArgument.at("/tau", "missing", "actuator forces 'tau' are needed")
    if isinstance(given, Mapping):
        given = by_name(_view(base), given, "tau")
    tau = numeric(given, "/tau")
    # of one coordinate one number for each state, as of the state itself
    tau = tau.reshape(data.qd.shape) if tau.ndim == 1 and tau.size == data.qd.size else tau
    if tau.shape != data.qd.shape:
        raise InvalidArgument.at("/tau", "wrong-length", f"shape {tau.shape} found, {data.qd.shape} expected")
    return tau


def _known(model: Model, parameters: Mapping[str, Any], data: _Data) -> Array:
    """Inverse dynamics of the model without its inertial forces: less Y_B beta of its own values."""
    if any(symbol.kind == "time" for symbol in model.program.select(["inverse_dynamics"]).symbols):
        message = "the model's loads depend on the time, which samples do not have: take it without these loads"
        raise InvalidDocument.at("", "not-steady", message)
    own = {name: x for name, x in parameters.items() if name in model.parameters}
    answer = evaluate(model, "inverse_dynamics", data.q, data.qd, data.qdd, parameters=own)
    # ID(q, q', q'') - Y_B beta
    inertial = np.einsum("nab,nb->na", data.outputs[REGRESSOR], data.outputs[OWN])
    return np.asarray(answer["inverse_dynamics"] - inertial, dtype=np.float64)


def _excitation(names: tuple[str, ...], W: Array) -> Excitation:
    flat = W.reshape(-1, len(names))
    length = np.linalg.norm(flat, axis=0)
    scaled = flat / np.where(length > 0, length, 1.0)
    _, s, V = np.linalg.svd(scaled, full_matrices=len(scaled) < len(names))
    # sigma_i of W diag(1/|W_i|); fewer samples than parameters leave zeros
    values = np.zeros(len(names))
    values[: len(s)] = s
    top = float(values.max(initial=0))
    bad = values * LIMIT < top if top else np.ones(len(names), dtype=bool)
    # the share of every parameter in the badly excited combinations
    share = np.sqrt(np.sum(V[bad] ** 2, axis=0)) if bad.any() else np.zeros(len(names))
    worst = [int(i) for i in np.argsort(-share, kind="stable") if share[i] > 0.3]
    least = float(values.min(initial=np.inf))
    condition = top / least if least > RANK * top else float("inf")
    return Excitation(names, values, condition, int(np.sum(values > RANK * top)), tuple(names[i] for i in worst))


def _solved(W: Array, tau: Array) -> Array:
    """Least squares with columns of length one."""
    length = np.linalg.norm(W, axis=0)
    scale = np.where(length > 0, length, 1.0)
    return np.asarray(np.linalg.lstsq(W / scale, tau, rcond=RANK)[0] / scale, dtype=np.float64)


def _covariance(W: Array, residual: Array) -> Array:
    """sigma^2 (W^T W)^-1; infinite where W has not full rank."""
    length = np.linalg.norm(W, axis=0)
    scale = np.where(length > 0, length, 1.0)
    _, s, V = np.linalg.svd(W / scale, full_matrices=False)
    if s.min(initial=np.inf) <= RANK * s.max(initial=0):
        return np.full((W.shape[1], W.shape[1]), np.inf)
    # cov = sigma^2 V diag(1/s^2) V^T,  sigma^2 = |r|^2 / (rows - columns)
    variance = float(residual @ residual) / (len(W) - W.shape[1])
    root = (V / s[:, None]) / scale
    return np.asarray(variance * (root.T @ root), dtype=np.float64)
