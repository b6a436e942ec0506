"""Trajectories as CSV."""

from __future__ import annotations

import csv
import io

import numpy as np

from substructures.analysis.motion.trajectory import Trajectory
from substructures.array import Array
from substructures.certificate.derived.powers import OUTPUT as POWERS


def to_csv(trajectory: Trajectory) -> str:
    """One row for every time: t, coordinates, velocities (q'), series (components numbered from 1, those of reactions
    named by joint and axis, powers ``power.<row>``); 17 digits.
    """
    columns: list[tuple[str, Array]] = [("t", trajectory.t)]
    columns += [(name, trajectory.q[:, a]) for a, name in enumerate(trajectory.positions or trajectory.coordinates)]
    columns += [(f"{name}'", trajectory.qd[:, a]) for a, name in enumerate(trajectory.coordinates)]
    for name, values in trajectory.series.items():
        flat, many = values.reshape(len(trajectory.t), -1), values.ndim > 1
        labels = [str(k + 1) for k in range(flat.shape[1])]
        if values.ndim == 3 and values.shape[1] == len(trajectory.joints):
            labels = [f"{joint}.{axis}" for joint in trajectory.joints for axis in "xyz"]
        if name == POWERS and trajectory.loads:
            name, labels = "power", list(trajectory.loads)
        columns += [(f"{name}.{label}" if many else name, x) for label, x in zip(labels, flat.T, strict=True)]
    text = io.StringIO()
    writer = csv.writer(text, lineterminator="\n")
    writer.writerow(name for name, _ in columns)
    # repr of a double: the shortest text that is read back as the same number
    writer.writerows(np.stack([values for _, values in columns], axis=1).tolist())
    return text.getvalue()
