"""What is kept of a motion with closures, and its judges: residuals and the energy balance."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Any, Literal

import numpy as np
from numpy.typing import NDArray

from substructures.analysis.constrained import Array, Constrained
from substructures.analysis.events import Occurrence
from substructures.analysis.loops import least_multipliers
from substructures.analysis.trajectory import Check, Trajectory

#: largest residuals of positions [m, 1] and velocities [per s] along a right motion
RESIDUAL = 1e-9
#: largest relative error of the energy balance
ENERGY = 1e-7
Status = Literal["finished", "stopped", "failed"]


@dataclass
class Record:
    """What is kept of the motion."""

    rows: list[dict[str, Any]] = field(default_factory=list)
    worst: dict[str, tuple[float, float | None]] = field(default_factory=dict)
    occurrences: list[Occurrence] = field(default_factory=list)
    steps: int = 0

    def residuals(self, s: Constrained) -> tuple[float, float]:
        """Note the residuals where s is."""
        position = float(np.abs(s.phi).max(initial=0))
        velocity = float(np.abs(s.velocity_residual).max(initial=0))
        self._residual("position", position, s.t)
        self._residual("velocity", velocity, s.t)
        return position, velocity

    def _residual(self, name: str, size: float, t: float) -> None:
        worst, first = self.worst.get(name, (0.0, None))
        if first is None and not size <= RESIDUAL:
            first = t
        self.worst[name] = max(worst, size), first

    def keep(self, s: Constrained, rows: NDArray[np.int64], work: float) -> None:
        """Record the state where s is. Raises Singular."""
        qdd, _ = s.accelerations(rows)
        kinetic, potential = s.energies
        position, velocity = self.residuals(s)
        multipliers = least_multipliers(s, qdd)
        row = {"t": s.t, "q": s.q, "qd": s.qd, "qdd": qdd, "multipliers": multipliers, "work": work}
        row |= {"kinetic_energy": kinetic, "potential_energy": potential, "actuation": multipliers[s.closed :]}
        self.rows.append(row | {"position_residual": position, "velocity_residual": velocity})


def judged(s: Constrained, record: Record, status: Status, message: str) -> Trajectory:
    """The recorded motion with its checks."""
    columns = {name: np.array([row[name] for row in record.rows]) for name in record.rows[0]}
    t, q, qd = (columns.pop(name) for name in ("t", "q", "qd"))
    checks = [
        _residual_check("position", "m, 1", "the closures (and prescribed motions) are met", record),
        _residual_check("velocity", "m/s, 1/s", "G q' + phi_t = 0", record),
        energy_check(t, columns, s.conservative),
    ]
    events = np.array([one.time for one in record.occurrences])
    series = columns | {"event_times": events}
    return Trajectory(s.model.coordinates, t, q, qd, series, tuple(checks), status, message, record.steps)


def _residual_check(name: str, unit: str, reason: str, record: Record) -> Check:
    worst, time = record.worst[name]
    return Check(f"{name} residual", "zero", reason, unit, worst, 1.0, RESIDUAL, time)


def energy_check(t: Array, columns: Mapping[str, Array], conservative: bool) -> Check:
    """T + V - work is constant; relative to the largest of T, the change of V and the work."""
    V = columns["potential_energy"]
    total = columns["kinetic_energy"] + V - columns["work"]
    sizes = (columns["kinetic_energy"], V - V[0], columns["work"])
    scale = max(float(np.abs(x).max()) for x in sizes) or 1.0
    drift = np.abs(total - total[0])
    bad = np.flatnonzero(~(drift <= ENERGY * scale))
    reason = "T + V is constant: the forces have a potential, constraints do no work"
    if not conservative:
        reason = "T + V changes by the work of forces without potential and of prescribed motions only"
    return Check(
        "energy", "constant", reason, "J", float(drift.max()), scale, ENERGY, float(t[bad[0]]) if len(bad) else None
    )
