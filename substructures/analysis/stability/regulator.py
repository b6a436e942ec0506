"""The linear quadratic regulator of a tree about an equilibrium."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
import scipy

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


@dataclass(frozen=True, repr=False)
class Regulator:
    """u = u_0 - K (x - x_0) that makes the integral of x^T Q x + u^T R u least, x = (q, q'); of ball joints x has the
    displacement and the rotation vector in the axes of the body that they carry, by the names of rates without
    prime; on closures x = (y, y') of the independent ``coordinates`` y.

    ``gain`` K (m, 2n), ``cost`` P (2n, 2n) with x_0^T P x_0 the least integral, ``eigenvalues`` of A - B K [1/s].
    ``controllable``, ``observable`` (by what is weighted): None where rounding decides; ``reached``, ``seen``: by mode.
    """

    coordinates: tuple[str, ...]
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
    """The linear quadratic regulator of a tree about an equilibrium, on its closures (Kalman 1960).

    A^T P + P A - P B R^-1 B^T P + Q = 0, K = R^-1 B^T P. ``weights``: the diagonal of Q by coordinate (``arm.q``) and
    velocity (``arm.q'``), by default 1 for coordinates; ``efforts``: the diagonal of R by input, by default 1;
    ``point``: further arguments of :func:`linearise`, ``inputs`` that hold the equilibrium among them, and
    ``of_inputs`` that act. On closures coordinates that move with others may be weighted, too. Where a mode is not
    reached, or not seen and not damped, ``status`` is ``failed``. Raises InvalidInput, also where the state is no
    equilibrium.
    """
    system = linear_system(model, q, point, {}, "regulators")
    _require_equilibrium(system)
    names = [*model.coordinates, *(f"{name}'" for name in model.coordinates)]
    moving, whole = _states(system)
    weight = np.array(_diagonal(weights, names, "weights", dict.fromkeys(model.coordinates, 1.0), 0.0))[:, None]
    Q = whole.T @ (weight * whole)
    R = np.diag(_diagonal(efforts, system.inputs, "efforts", dict.fromkeys(system.inputs, 1.0), 1.0, positive=True))
    reached, seen = reach(system.A, system.B), reach(system.A.T, (np.sqrt(weight) * whole).T)
    known: dict[str, Any] = {"coordinates": moving, "inputs": system.inputs, "reached": reached}
    known |= {"controllable": is_complete(reached), "observable": is_complete(seen), "seen": seen}
    try:
        P = scipy.linalg.solve_continuous_are(system.A, system.B, Q, R)
    except (np.linalg.LinAlgError, ValueError):
        P, known = np.full_like(Q, np.nan), known | {"status": "failed", "message": _why(reached, seen)}
        poles = np.full(len(Q), np.nan + 0j)
        return Regulator(gain=np.full((len(system.inputs), len(Q)), np.nan), cost=P, eigenvalues=poles, **known)
    # K = R^-1 B^T P
    gain = np.linalg.solve(R, system.B.T @ P)
    poles = eigenvalues(system.A - system.B @ gain)
    return Regulator(gain=gain, cost=P, eigenvalues=poles, checks=_checks(system, Q, P, gain, poles), **known)


def _require_equilibrium(system: Linearisation) -> None:
    """Raises InvalidArgument (``/q``, ``/constraints``)."""
    if isinstance(system, ConstrainedLinearisation):
        message = "regulators do not take velocity constraints into account: linearise gives A and B with them"
        raise InvalidArgument.at("/constraints", "not-supported", message)
    if not system.is_equilibrium:
        largest = float(np.abs(system.qdd).max(initial=0))
        message = f"the state is no equilibrium (accelerations up to {largest:.3g}): give 'inputs' that hold it"
        raise InvalidArgument.at("/q", "no-equilibrium", message)


def _states(system: Linearisation) -> tuple[tuple[str, ...], Array]:
    """The coordinates of x, and what (q, q') of all is of it: dq = N dy on closures."""
    if isinstance(system, ClosedLinearisation):
        return system.independent, np.asarray(np.kron(np.eye(2), system.tangent), dtype=np.float64)
    return system.coordinates, np.eye(2 * len(system.coordinates))


def _diagonal(
    given: Mapping[str, float] | None,
    names: Sequence[str],
    field: str,
    default: Mapping[str, float],
    rest: float,
    positive: bool = False,
) -> list[float]:
    faults = []
    for name, x in (given or {}).items():
        if name not in names:
            message = f"there is no '{name[:80]}'{among(name, names)}"
            faults.append(Fault(f"/{field}/{escape(name)}", "unknown-name", message))
        elif not np.isfinite(x) or x < 0 or (positive and x == 0):
            message = f"a number {'above' if positive else 'of at least'} 0 is needed"
            faults.append(Fault(f"/{field}/{escape(name)}", "out-of-range", message))
    if faults:
        raise InvalidArgument(faults)
    chosen = default if given is None else given
    return [float(chosen.get(name, rest)) for name in names]


def _why(reached: Sequence[Reach], seen: Sequence[Reach]) -> str:
    for some, what, way in ((reached, "no input moves", "give more inputs"), (seen, "no weight sees", "weigh more")):
        for each in some:
            if each.distance < SURE and each.eigenvalue.real > -1e-9 * (1 + abs(each.eigenvalue)):
                return f"{what} the mode {each.eigenvalue:.4g} 1/s, which does not die out by itself: {way}"
    return "Riccati's equation has no stabilising solution: change weights and efforts"


def _checks(system: Linearisation, Q: Array, P: Array, gain: Array, closed: ComplexArray) -> tuple[Check, ...]:
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
