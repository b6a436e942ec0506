"""The linear quadratic regulator of a tree about an equilibrium."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
import scipy

from substructures.analysis.arguments import by_name, real
from substructures.analysis.given import StateArray
from substructures.analysis.stability.linear_system import SURE, Reach, eigenvalues, is_complete, linear_system, reach
from substructures.analysis.stability.linearisation_result import (
    ClosedLinearisation,
    ConstrainedLinearisation,
    Linearisation,
)
from substructures.analysis.verdict import About, Check, verdict
from substructures.array import Array, ComplexArray
from substructures.documents import escape
from substructures.errors import Fault, InvalidArgument, among
from substructures.tree.model import Model

#: relative, of the residual of Riccati's equation
RICCATI = 1e-8
#: derivatives that are zero, of the largest
NOTHING = 1e-10


@dataclass(frozen=True, repr=False)
class Regulator:
    """u = u_0 - K (x - x_0) that makes the integral of x^T Q x + u^T R u least, x = (q, q'); of ball joints x has the
    displacement and the rotation vector in the axes of the body that they carry, by the names of rates without
    prime; on closures x = (y, y') of the independent ``coordinates`` y, with velocity constraints x = (y, v) of what
    has to be known: ``states`` are the names of x, and x_0 moves on at the rates of the steady motion.

    ``gain`` K (m, s), ``cost`` P (s, s) with x_0^T P x_0 the least integral, ``eigenvalues`` of A - B K [1/s].
    ``controllable``, ``observable`` (by what is weighted): None where rounding decides; ``reached``, ``seen``: by mode.
    """

    coordinates: tuple[str, ...]
    states: tuple[str, ...]
    inputs: tuple[str, ...]
    gain: Array
    cost: Array
    eigenvalues: ComplexArray
    controllable: bool | None
    observable: bool | None
    reached: tuple[Reach, ...]
    seen: tuple[Reach, ...]
    checks: tuple[Check, ...] = ()
    status: str = "finished"
    message: str = ""

    def __repr__(self) -> str:
        return f"Regulator(inputs={len(self.inputs)}, states={self.gain.shape[-1]})\n{self.message or self.status}"

    @property
    def is_right(self) -> bool | None:
        """Whether all checks hold; None where there is no regulator."""
        return verdict(self.checks, self.status == "finished")


def regulator(
    model: Model,
    q: StateArray,
    *,
    weights: Mapping[str, float] | None = None,
    efforts: Mapping[str, float] | None = None,
    **point: Any,
) -> Regulator:
    """The linear quadratic regulator of a tree about an equilibrium, on its closures, or about a steady motion with
    velocity constraints (Kalman 1960).

    A^T P + P A - P B R^-1 B^T P + Q = 0, K = R^-1 B^T P. ``weights``: the diagonal of Q by coordinate (``arm.q``) and
    velocity (``arm.q'``), by default 1 for coordinates, with velocity constraints for those that are not ignorable;
    ``efforts``: the diagonal of R by input, by default 1; ``point``: further arguments of :func:`linearise`,
    ``inputs`` that hold the equilibrium among them, and ``of_inputs`` that act. On closures coordinates that move with
    others may be weighted, too. With velocity constraints what is not weighted, and moves nothing else, is left out of
    x: the place on the plane, where it does not matter. Where a mode is not reached, or not seen and not damped,
    ``status`` is ``failed``, and ``message`` names what it consists of. Raises InvalidInput, also where the state is no
    equilibrium (steady motion), or where what is weighted changes its rates on the way.
    """
    system = linear_system(model, q, point, {}, "regulators")
    _require_steady(system)
    of = [name for name in model.coordinates if name not in getattr(system, "ignorable", ())]
    names = [*model.coordinates, *(f"{name}'" for name in model.coordinates)]
    weight = np.array(_diagonal(weights, names, "weights", dict.fromkeys(of, 1.0), 0.0))[:, None]
    x = _fed_back(system, weight[:, 0])
    Q = x.whole.T @ (weight * x.whole)
    R = np.diag(_diagonal(efforts, system.inputs, "efforts", dict.fromkeys(system.inputs, 1.0), 1.0, positive=True))
    reached, seen = reach(x.A, x.B, x.states), reach(x.A.T, (np.sqrt(weight) * x.whole).T, x.states)
    known: dict[str, Any] = {"coordinates": x.coordinates, "states": x.states, "inputs": system.inputs}
    known |= {"controllable": is_complete(reached), "observable": is_complete(seen)}
    known |= {"reached": reached, "seen": seen}
    found = _least_cost(x, Q, R)
    if found is None:
        gain, poles = np.full((len(system.inputs), len(Q)), np.nan), np.full(len(Q), np.nan + 0j)
        known |= {"status": "failed", "message": _why(system, reached, seen)}
        return Regulator(gain=gain, cost=np.full_like(Q, np.nan), eigenvalues=poles, **known)
    return Regulator(**found, **known)


def _least_cost(x: _System, Q: Array, R: Array) -> dict[str, Any] | None:
    """P and K with the poles and checks; None where Riccati's equation has no solution that makes all die out."""
    try:
        P = scipy.linalg.solve_continuous_are(x.A, x.B, Q, R)
    except (np.linalg.LinAlgError, ValueError):
        return None
    # K = R^-1 B^T P
    gain = np.linalg.solve(R, x.B.T @ P)
    poles = eigenvalues(x.A - x.B @ gain)
    return {"gain": gain, "cost": P, "eigenvalues": poles, "checks": _checks(x, Q, P, gain, poles)}


def _require_steady(system: Linearisation) -> None:
    """Raises InvalidArgument (``/q``)."""
    if isinstance(system, ConstrainedLinearisation):
        if not system.is_steady:
            largest = float(np.abs(system.vd).max(initial=0))
            message = (
                f"the motion is not steady (v' up to {largest:.3g}): give 'inputs' that hold it, and 'qd' that meets "
                "the constraints, with which all coordinates rest that are not ignorable"
            )
            raise InvalidArgument.at("/q", "not-steady", message)
    elif not system.is_equilibrium:
        largest = float(np.abs(system.qdd).max(initial=0))
        message = f"the state is no equilibrium (accelerations up to {largest:.3g}): give 'inputs' that hold it"
        raise InvalidArgument.at("/q", "no-equilibrium", message)


@dataclass(frozen=True)
class _System:
    """x' = A x + B u of what is fed back; ``whole``: what (q, q') of all is of it."""

    coordinates: tuple[str, ...]
    states: tuple[str, ...]
    A: Array
    B: Array
    whole: Array


def _fed_back(system: Linearisation, weight: Array) -> _System:
    """What the regulator of a linearisation knows: dq = N dy on closures. Raises InvalidArgument (``/weights/c``)."""
    if isinstance(system, ConstrainedLinearisation):
        return _constrained(system, weight)
    y, whole = system.coordinates, np.eye(2 * len(system.coordinates))
    if isinstance(system, ClosedLinearisation):
        y, whole = system.independent, np.asarray(np.kron(np.eye(2), system.tangent), dtype=np.float64)
    return _System(y, (*y, *(f"{name}'" for name in y)), system.A, system.B, whole)


def _constrained(at: ConstrainedLinearisation, weight: Array) -> _System:
    """x = (y, v) with dq = N dy that keeps the gaps, without what moves nothing else and is not weighted."""
    n, p = len(at.q), len(at.v)
    N = scipy.linalg.null_space(at.gaps) if len(at.gaps) else np.eye(n)
    # independent coordinates: the rows in which N is far from singular
    rows = np.sort(scipy.linalg.qr(N.T, mode="r", pivoting=True)[1][: N.shape[1]]) if N.size else np.arange(0)
    N = N @ np.linalg.inv(N[rows])
    inside, of_x = scipy.linalg.block_diag(N, np.eye(p)), np.concatenate((rows, np.arange(n, n + p)))
    A, B = (at.A @ inside)[of_x], at.B[of_x]
    # q' = R q + T v
    whole = np.vstack([np.eye(n, n + p), np.hstack([at.R, at.T])]) @ inside
    least, some = (NOTHING * float(np.abs(x).max(initial=0)) for x in (A, whole))
    kept, seen = list(range(len(of_x))), (np.abs(whole[weight > 0]) > some).any(axis=0)
    while gone := [i for i in kept if not seen[i] and (np.abs(A[kept, i]) <= least).all()]:
        kept = [i for i in kept if i not in gone]
    if not kept:
        message = "nothing is weighted, as all coordinates are ignorable: give 'weights' of those that matter"
        raise InvalidArgument.at("/weights", "missing", message)
    names = [*at.coordinates, *at.velocities]
    states = tuple(names[of_x[i]] for i in kept)
    if turning := [name for name in at.varying if name in states]:
        message = f"the rate of '{turning[0]}' changes along the motion: weigh it no more, or take a straight motion"
        raise InvalidArgument.at(f"/weights/{escape(turning[0])}", "not-steady", message)
    return _System(states[: sum(i < len(rows) for i in kept)], states, A[np.ix_(kept, kept)], B[kept], whole[:, kept])


def _diagonal(
    given: Mapping[str, float] | None,
    names: Sequence[str],
    field: str,
    default: Mapping[str, float],
    rest: float,
    positive: bool = False,
) -> list[float]:
    faults = []
    for name, x in by_name(given, field).items():
        if name not in names:
            message = f"there is no '{name[:80]}'{among(name, names)}"
            faults.append(Fault(f"/{field}/{escape(name)}", "unknown-name", message))
        elif (number := real(x, f"/{field}/{escape(name)}")) < 0 or (positive and number == 0):
            message = f"a number {'above' if positive else 'of at least'} 0 is needed"
            faults.append(Fault(f"/{field}/{escape(name)}", "out-of-range", message))
    if faults:
        raise InvalidArgument(faults)
    chosen = default if given is None else given
    return [float(chosen.get(name, rest)) for name in names]


def _why(system: Linearisation, reached: Sequence[Reach], seen: Sequence[Reach]) -> str:
    rest = ", or take what does not matter out of 'weights'" if isinstance(system, ConstrainedLinearisation) else ""
    ways = (reached, "no input moves", f"give more inputs{rest}"), (seen, "no weight sees", "weigh more")
    for some, what, way in ways:
        for each in some:
            if each.distance < SURE and each.eigenvalue.real > -1e-9 * (1 + abs(each.eigenvalue)):
                parts = ", ".join(f"'{name}'" for name in each.parts)
                return f"{what} the mode {each.eigenvalue:.4g} 1/s of {parts}, which does not die out by itself: {way}"
    return "Riccati's equation has no stabilising solution: change weights and efforts"


def _checks(system: _System, Q: Array, P: Array, gain: Array, closed: ComplexArray) -> tuple[Check, ...]:
    at = np.zeros(1)
    A, B = system.A, system.B
    # (A - B K)^T P + P (A - B K) + Q + K^T R K = 0, R K = B^T P
    terms = (A.T @ P, P @ A, Q, gain.T @ B.T @ P)
    residual = terms[0] + terms[1] + terms[2] - terms[3]
    scale = max(float(np.abs(x).max(initial=0)) for x in terms)
    reason = "A^T P + P A - P B R^-1 B^T P + Q = 0 (Riccati)"
    about: About = ("riccati", "zero", reason, "")
    decay: About = ("decay", "zero", "all motions with the regulator die out", "1/s")
    slowest = max(float(closed.real.max(initial=-np.inf)), 0.0)
    least = min(float(np.linalg.eigvalsh((P + P.T) / 2).min(initial=np.inf)), 0.0)
    cost: About = ("cost", "zero", "the cost is not negative", "")
    return (
        Check.of(about, np.array([np.abs(residual).max(initial=0)]), at, scale, RICCATI),
        Check.of(decay, np.array([slowest]), at, float(np.abs(closed).max(initial=1)), 1e-12),
        Check.of(cost, np.array([least]), at, float(np.abs(P).max(initial=1)), 1e-9),
    )
