"""springdamper="timeconst dampratio" of joints as numbers: stiffness k and damping c of the inertia that a joint moves.

    I = 1/(M^-1)_aa at the reference,   k = I/(timeconst dampratio)^2,   c = 2 I/timeconst

M is the metric of the file with all joints free, rotors included, where nothing is moved (``ref``).
Source: https://mujoco.readthedocs.io/en/stable/XMLreference.html#body-joint-springdamper
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace

import numpy as np

from substructures.expr.interpret import interpret
from substructures.interchange.as_part import as_part
from substructures.interchange.files.wanted import Options
from substructures.interchange.merge import plus
from substructures.interchange.numbers import ZERO, decimal_of, value
from substructures.interchange.report import Report, refuse
from substructures.interchange.robot import Motion, Robot
from substructures.mechanics.accelerations import condition
from substructures.part.definition import Definition
from substructures.part.one_piece import metric_in_one_piece
from substructures.part.topology import topology

#: divisors are no less there
_LEAST = 1e-15
#: condition numbers of metrics that have an inverse to rounding
_MOST = 1e12


def with_springs(robot: Robot, given: Mapping[str, tuple[float, float]]) -> Robot:
    """The robot with the springs and dampers of its joints; ``given``: timeconst [s] and dampratio by joint.

    Raises InvalidDocument where joints move no mass, or more of them than can move.
    """
    if not given:
        return robot
    inertias = _inertias(robot)
    links = []
    for link in robot.links:
        motions = [
            _sprung(m, inertias[m.name], given[m.name], robot.report) if m.name in given else m for m in link.motions
        ]
        links.append(replace(link, motions=tuple(motions)))
    return replace(robot, links=tuple(links))


def _sprung(motion: Motion, inertia: float, given: tuple[float, float], report: Report) -> Motion:
    """Damping of actuators is added."""
    if not 0 < inertia < np.inf:
        message = "springdamper needs an inertia, and the metric of all joints is singular: give stiffness and damping"
        raise refuse(motion.place, "not-read", message)
    timeconst, dampratio = given
    product = timeconst * dampratio
    k, c = inertia / max(product * product, _LEAST), 2 * inertia / max(timeconst, _LEAST)
    message = f"springdamper: stiffness {k:.6g} and damping {c:.6g} for the inertia {inertia:.6g} at the reference"
    report.merged(motion.place, message)
    damping = plus((motion.damping, ZERO, ZERO), (decimal_of(c), ZERO, ZERO))[0]
    return replace(motion, stiffness=decimal_of(k), damping=damping)


def _inertias(robot: Robot) -> dict[str, float]:
    """1/(M^-1)_aa by joint of one coordinate; NaN where M has no inverse."""
    part = as_part(
        replace(robot, report=Report(), frames=(), mimics=(), loops=(), tendons=()), Options("none", "dropped")
    )
    definition = Definition.read(part.definition)
    coordinates = topology(definition).coordinates
    joints = {part.coordinates[m.name]: m for link in robot.links for m in link.motions}
    at = {c: value(joints[c].offset) if c in joints else 0.0 for c in coordinates}
    M = interpret(metric_in_one_piece(definition), at, ["metric"])["metric"]
    is_regular = condition(M[None])[0] < _MOST
    inertias = 1 / np.diag(np.linalg.inv(M)) if is_regular else np.full(len(M), np.nan)
    return {joints[c].name: float(x) for c, x in zip(coordinates, inertias, strict=True) if c in joints}
