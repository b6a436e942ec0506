"""What a linearisation is: matrices of second and of first order about states, modes, and the verdict on stability."""

from __future__ import annotations

from dataclasses import dataclass

from substructures.analysis.stability.vibrations import Mode, Stability
from substructures.array import Array


@dataclass(frozen=True, repr=False)
class Linearisation:
    """M dq'' + D dq' + K dq = F du and dx' = A dx + B du, dy = C dx + Dy du with x = (q, q').

    For n coordinates, m ``inputs`` u and k ``outputs`` y, with a leading axis N of states in front of all where several
    states were given:

    ===================  ==========  =================================================================================
    ``M``, ``D``, ``K``  (n, n)      mass, damping and gyroscopic, stiffness and circulatory matrix
    ``F``                (n, m)      dQ/du
    ``A``, ``B``         (2n, 2n|m)  of the first order equations
    ``C``, ``Dy``        (k, 2n|m)   of the outputs
    ``qdd``              (n,)        accelerations about which is linearised [rad/s^2, m/s^2]
    ``residual``         (n,)        g q'' + Gamma q' q' - Q [N m, N], zero where the state belongs to a motion
    ===================  ==========  =================================================================================

    At an equilibrium (one state, q' = q'' = 0, residual 0) also ``modes``, slowest first, and ``stability``. ``status``
    ``failed``: ``message`` says what to change, and the matrices are not finite.
    """

    coordinates: tuple[str, ...]
    inputs: tuple[str, ...]
    outputs: tuple[str, ...]
    M: Array
    D: Array
    K: Array
    F: Array
    A: Array
    B: Array
    C: Array
    Dy: Array
    qdd: Array
    residual: Array
    modes: tuple[Mode, ...] = ()
    stability: Stability | None = None
    status: str = "finished"
    message: str = ""

    def __repr__(self) -> str:
        # (N, n, n) for N states, (n, n) for one
        states = self.M.shape[0] if self.M.ndim == 3 else 1
        sizes = f"n={self.M.shape[-1]}, inputs={len(self.inputs)}, outputs={len(self.outputs)}, states={states}"
        return f"{type(self).__name__}({sizes})\n{self._finding()}"

    def _finding(self) -> str:
        if self.status == "failed":
            return f"failed: {self.message}"
        if self.stability is None:
            return "about states along a motion" if self.M.ndim == 3 else "about a state that is no equilibrium"
        return f"about an equilibrium, {self.stability.verdict}: {self.stability.reason}"

    @property
    def is_equilibrium(self) -> bool:
        """Whether modes and stability were found."""
        return self.stability is not None


class MovingLinearisation(Linearisation):
    """About a state that moves at rates ``qd`` (n,); where the motion is steady its neighbours have modes, too."""

    qd: Array

    def _finding(self) -> str:
        if self.stability is None or not self.qd.any():
            return super()._finding()
        return f"about a steady motion, {self.stability.verdict}: {self.stability.reason}"

    @property
    def is_steady(self) -> bool:
        """Whether modes and stability are those of a steady motion, or of an equilibrium."""
        return self.stability is not None

    @property
    def is_equilibrium(self) -> bool:
        """Whether the steady motion is rest."""
        return self.is_steady and not self.qd.any()


@dataclass(frozen=True, kw_only=True, repr=False)
class BallLinearisation(MovingLinearisation):
    """Of a tree with ball joints, whose rates v are no derivatives: M dv' + D dv + K dq = F du, dq' = dv + R dq;
    x = (dq, dv). Of such a joint dq are the displacement of a floating one [m] and the rotation vector [rad], in the
    axes of the body that it carries, as its rates are: dQ = 1/2 Q (0, dq). ``R`` (n, n) is 0 at rest; ``positions``:
    names of the numbers of a state; ``qd`` (n,): its rates. Where v' = 0 and A stays as it is at constant rates, the
    motion is steady (a top upright, a body about a principal axis): ``modes`` and ``stability`` of its neighbours.
    """

    positions: tuple[str, ...]
    R: Array
    qd: Array


@dataclass(frozen=True, kw_only=True, repr=False)
class ClosedLinearisation(Linearisation):
    """As Linearisation, with M, D, K (r, r), F (r, m), A (2r, 2r), ... in the coordinates ``independent`` (r names).

    ``q``, ``qd`` (n,): the closed state. ``tangent`` (n, r): N of dq = N dy. ``multipliers`` (c,) of least norm [N,
    N m], of the rows ``constraints``. In all n coordinates are ``qdd`` and ``residual`` (n,):
    g q'' + Gamma q'q' - Q - G^T lambda, and the shapes of modes.
    """

    independent: tuple[str, ...]
    constraints: tuple[str, ...]
    q: Array
    qd: Array
    tangent: Array
    multipliers: Array


@dataclass(frozen=True, kw_only=True, repr=False)
class ConstrainedLinearisation(MovingLinearisation):
    """Of a motion with velocity constraints: M dv' + D dv + K dq = F du and dq' = T dv + R dq; x = (q, v).

    For p quasi-``velocities`` and the ``constraints`` that hold: M, D (p, p), K (p, n), F (p, m), A (n+p, n+p),
    B (n+p, m), C (k, n+p), R (n, n), T (n, p). ``q``, ``qd`` (n,), ``v``, ``vd`` (p,): the state and v' about which is
    linearised; ``residual`` (p,). ``gaps`` (k, n): dq keeps closed what is closed where gaps dq = 0. ``ignorable``:
    coordinates that change nothing but rates of such; ``varying``: those of them whose linearised rates change on the
    way (the place on the plane in a turn). Where v' = 0 and all others rest the motion is steady: ``modes`` of its
    neighbours that keep the gaps, shapes in all coordinates, and ``stability`` of what is not ignorable.
    """

    velocities: tuple[str, ...]
    constraints: tuple[str, ...]
    q: Array
    qd: Array
    v: Array
    vd: Array
    R: Array
    T: Array
    gaps: Array
    ignorable: tuple[str, ...]
    varying: tuple[str, ...] = ()
