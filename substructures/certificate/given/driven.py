"""Coordinates whose motion is given: their values from the text, and Lagrange's equations of those that are left.

    d/dt (dT/dq'^a) - dT/dq^a = g_ab q''^b + d_c g_ab q'^b q'^c - 1/2 d_a g_bc q'^b q'^c

of all joints, with the derivatives of the metric as exact sums of values of it. In the angle of a revolute joint it is
a trigonometric polynomial of degree two, and in the shift of a prismatic one a polynomial of degree two, so that

    f'(0) = 1/8 sum over k = 1 .. 4 of  (-1)^(k+1) f(x_k) / sin^2(x_k / 2),   x_k = (2 k - 1) pi / 4    (M. Riesz, 1914)
    f'(0) = 1/2 (f(1) - f(-1))

No Christoffel symbol and no formula for given motions is used: all of them follow by putting in velocities.
"""

from __future__ import annotations

from collections.abc import Collection, Mapping, Sequence
from dataclasses import replace
from decimal import Decimal
from typing import Any

from flint import arb, arb_mat, fmpq

from substructures.certificate.bodies import Bodies, Moments
from substructures.certificate.by_coordinate import AXES, along, gathered
from substructures.certificate.dynamics import carried_by_joints
from substructures.certificate.linear import Ball, Matrix, cross, identity, turn, zeros
from substructures.certificate.numbers import Bindings, Plain
from substructures.certificate.outputs import Outputs, Values
from substructures.certificate.texts import with_rates

PRIMES = ("", "'", "''")
#: what drives add to outputs of coordinates, by the output
MOTIONS = {"linear_momentum": 0, "angular_momentum": 0, "U": 1, "Omega": 1}


def driven_symbols(tree: Plain, kinds: Mapping[str, str]) -> dict[str, str]:
    """The kinds of symbols without those of driven coordinates; three inputs of those that are given so."""
    found = dict(kinds)
    for name, motion in tree.get("driven", {}).items():
        del found[f"tau.{name}"]
        for p in PRIMES:
            del found[f"{name}{p}"]
            if _is_input(motion):
                found[f"{name}{p}"] = "input"
    return found


def _is_input(motion: Any) -> bool:
    return isinstance(motion, Mapping) and "input" in motion


def _text(motion: Any) -> Any:
    """What the document says, of a table as an expression."""
    if not isinstance(motion, Mapping):
        return motion
    points = [(Decimal(t), Decimal(x)) for t, x in zip(motion["times"], motion["values"], strict=True)]
    kind = motion.get("interpolation", "smooth")
    if kind == "monotone":  # at rest before and after: two equal values make a slope of zero
        (first, x), (last, y) = points[0], points[-1]
        points = [(first - 1, x), *points, (last + 1, y)]
    return f"table(t; {', '.join(f'{t:f}:{x:f}' for t, x in points)}; {kind})"


def with_driven(tree: Plain, values: Mapping[str, Ball]) -> Mapping[str, Ball]:
    """The values of all symbols of the tree, those of driven coordinates with their rates and no actuators among them.

    ``values``: of the symbols that are left.
    """
    given = tree.get("driven", {})
    if not given:
        return values
    bound = {f"{i['name']}.{p}": x for i in tree.get("instances", ()) for p, x in i.get("parameters", {}).items()}
    names, found = Bindings(values, bound), dict(values)
    for name, motion in given.items():
        found[f"tau.{name}"] = arb(0)
        if not _is_input(motion):
            found |= zip((f"{name}{p}" for p in PRIMES), with_rates(_text(motion), names, "t"), strict=True)
    return found


def of_free(result: Outputs, coordinates: Sequence[str], driven: Collection[str]) -> Outputs:
    """The outputs along axes of coordinates for those that are free; ``coordinates``: all."""
    place = {a: i for i, a in enumerate(a for a, name in enumerate(coordinates) if name not in driven)}
    if len(place) < len(coordinates):
        for name, values in result.items():
            result[name] = _of_free(values, AXES.get(name, ()), place)
    return result


def _of_free(values: Values, axes: Sequence[int], place: Mapping[int, int]) -> Values:
    if values.along and not place:
        # nothing is left to differentiate by, and at given motions nothing is known of what was found
        return Values((), entries={(): arb("nan")})
    if values.along:
        # a gradient by all coordinates, and a value behind it
        axes, place = (0,), {**place, len(values.along): len(place)}
    shape = tuple(len(place) if axis in axes else size for axis, size in enumerate(values.shape))

    def at(index: tuple[int, ...]) -> tuple[int, ...]:
        """Where an element is."""
        return tuple(place[k] if axis in axes else k for axis, k in enumerate(index))

    left = [i for i in {**values.entries, **values.others} if all(i[axis] in place for axis in axes)]
    return replace(
        values,
        shape=shape,
        entries={at(i): values.entries[i] for i in left if i in values.entries},
        others={at(i): values.others[i] for i in left if i in values.others},
        along=tuple(name for a, name in enumerate(values.along) if a in place),
    )


def driven_outputs(result: Outputs, bodies: Bodies, values: Mapping[str, Ball], driven: Collection[str]) -> Outputs:
    """What given motions make of the outputs of joints (``result``), by coordinate, driven ones among them; ``values``:
    of all symbols.
    """
    lagrange, found = Lagrange(bodies, result["metric"]), Outputs()
    every, second = ([values[f"{j.mover}{p}"] * j.slope for j in bodies.joints] for p in PRIMES[1:])
    v, a = (
        [x if joint.mover in driven else arb(0) for x, joint in zip(some, bodies.joints, strict=True)]
        for some in (every, second)
    )
    free = [x - y for x, y in zip(every, v, strict=True)]
    momenta = lagrange.momenta(v)
    for name, x in (("T_2", lagrange.energy(free)), ("T_1", _dot(momenta, free)), ("T_0", lagrange.energy(v))):
        found.scalar(name, x)
    found.scalar("g_00", 2 * lagrange.energy(v))
    rows = {"g_a0": momenta, "Gamma_a00": lagrange.equations(v, a), "bias": lagrange.equations(every, a)}
    for name, inertia, force in (
        ("nonlinear_effects", rows["bias"], "gravity"),
        ("inverse_dynamics", lagrange.equations(every, second), "forces"),
    ):
        rows[name] = [x - result[force].entries.get((b,), arb(0)) for b, x in enumerate(inertia)]
    for name, some in rows.items():
        _row(found, name, bodies, some)
    _mixed(found, bodies, lagrange, v)
    for name, axis in MOTIONS.items():
        _moved(found, name, result[name], axis, v)
    moving = [i for i, b in enumerate(along(bodies)) if bodies.joints[b].coordinate in driven]
    forces = found["inverse_dynamics"].entries
    rates = [values[f"{bodies.joints[along(bodies)[i]].coordinate}'"] for i in moving]
    found.array("drive_forces", (len(moving),)).update({(k,): forces[i,] for k, i in enumerate(moving)})
    found.array("drive_powers", (len(moving),)).update({(k,): forces[i,] * rates[k] for k, i in enumerate(moving)})
    if "closure.jacobian" in result:
        _closed(found, result, bodies, (v, a), [bodies.joints[along(bodies)[i]].coordinate for i in moving])
    if "christoffel" not in result:
        del found["Gamma_ab0"], found["Gamma_a00"]
    return found


def _closed(
    found: Outputs, result: Outputs, bodies: Bodies, motions: tuple[list[Ball], list[Ball]], driven: Sequence[str]
) -> None:
    """phi_t, G' q' + G_km s''^m, and G_km; ``motions``: velocities and accelerations of the drives by joint."""
    v, a = motions
    jacobian, before = result["closure.jacobian"], result["closure.acceleration"]
    m = jacobian.shape[0]
    rate, drives = found.array("closure.rate", (m,)), found.array("closure.drives", (m, len(driven)))
    bent = dict(before.entries)
    for (k, b), x in jacobian.entries.items():
        rate[k,] = rate.get((k,), arb(0)) + x * v[b]
        bent[k,] = bent.get((k,), arb(0)) + x * a[b]
        joint = bodies.joints[b]
        if joint.mover in driven:
            at = k, driven.index(joint.mover)
            drives[at] = drives.get(at, arb(0)) + x * joint.slope
    found["closure.acceleration"] = replace(before, entries=bent)


def _row(found: Outputs, name: str, bodies: Bodies, of_joints: Sequence[Ball]) -> None:
    """An output by coordinate of what there is by joint."""
    left, terms = along(bodies), gathered(bodies, dict(enumerate(of_joints)))
    found.array(name, (len(left),)).update({(i,): terms.get(a, arb(0)) for i, a in enumerate(left)})


def _mixed(found: Outputs, bodies: Bodies, lagrange: Lagrange, v: Sequence[Ball]) -> None:
    """Gamma_ab0: what velocities of the drives and of one coordinate do together, four times."""
    left, zero = along(bodies), [arb(0)] * len(v)
    entries = found.array("Gamma_ab0", (len(left), len(left)))
    for i, b in enumerate(left):
        unit = [j.slope if j.mover == bodies.joints[b].coordinate else arb(0) for j in bodies.joints]
        ends = ([x + sign * e for x, e in zip(v, unit, strict=True)] for sign in (1, -1))
        ahead, behind = (lagrange.equations(some, zero) for some in ends)
        change = gathered(bodies, {a: (x - y) / 4 for a, (x, y) in enumerate(zip(ahead, behind, strict=True))})
        entries |= {(k, i): change.get(a, arb(0)) for k, a in enumerate(left)}


def _moved(found: Outputs, name: str, of_unit: Values, axis: int, v: Sequence[Ball]) -> None:
    """x_..a.. v^a of all joints."""
    entries = found.array(f"{name}_0", of_unit.shape[:axis] + of_unit.shape[axis + 1 :])
    for index, x in of_unit.entries.items():
        at = index[:axis] + index[axis + 1 :]
        entries[at] = entries.get(at, arb(0)) + x * v[index[axis]]


class Lagrange:
    """Left sides of Lagrange's equations of all joints at one state, of a metric with its derivatives."""

    def __init__(self, bodies: Bodies, metric: Values) -> None:
        self.n = len(bodies.joints)
        self.g = arb_mat(self.n, self.n)
        for (a, b), x in metric.entries.items():
            self.g[a, b] = self.g[b, a] = x
        self.slopes = [_slope(bodies, k) for k in range(self.n)]

    def momenta(self, rates: Sequence[Ball]) -> list[Ball]:
        """g_ab q'^b."""
        return _times(self.g, rates)

    def energy(self, rates: Sequence[Ball]) -> Ball:
        """1/2 g_ab q'^a q'^b."""
        return _dot(self.momenta(rates), rates) / 2

    def equations(self, rates: Sequence[Ball], second: Sequence[Ball]) -> list[Ball]:
        """d/dt (dT/dq'^a) - dT/dq^a."""
        changes = [_times(slope, rates) for slope in self.slopes]
        result = []
        for a, inertia in enumerate(self.momenta(second)):
            # d_c g_ab q'^b q'^c
            carried = sum((changes[c][a] * rate for c, rate in enumerate(rates)), arb(0))
            result.append(inertia + carried - _dot(changes[a], rates) / 2)
        return result


def _slope(bodies: Bodies, k: int) -> Matrix:
    """d_k g_ab from what the metric is where joint k has moved on."""
    if bodies.joints[k].prismatic:
        return (_metric(bodies, k, arb(1)) - _metric(bodies, k, arb(-1))) * arb(fmpq(1, 2))
    result = arb_mat(len(bodies.joints), len(bodies.joints))
    for i in range(4):
        angle = arb.pi() * (2 * i + 1) / 4
        result += _metric(bodies, k, angle) * ((-1) ** i / (8 * (angle / 2).sin() ** 2))
    return result


def _metric(bodies: Bodies, k: int, shift: Ball) -> Matrix:
    """The metric, without rotors, where joint k has moved on by an angle or a length."""
    joint, there = bodies.joints[k], Bodies()
    A, p = identity(), zeros(3, 1)
    if joint.prismatic:
        p = joint.v * shift
    else:
        A = joint.A * turn(2, shift) * joint.A.transpose()
        p = joint.O - A * joint.O
    masses: dict[int, Moments] = {}
    for c, each in enumerate(bodies.joints):
        path, mass = bodies.path(c), bodies.own[c]
        masses[c] = mass.outwards(A, p) if k in path else mass
        if k in path[:-1]:
            w = A * each.w
            each = replace(each, w=w, v=A * each.v + cross(p, w))
        there.joints.append(each)
    g = arb_mat(len(there.joints), len(there.joints))
    for c, some in enumerate(carried_by_joints(there, masses)):
        for i, a in enumerate(some.path):
            g[a, c] = g[c, a] = some.metric()[0, i]
    return g


def _times(matrix: Matrix, x: Sequence[Ball]) -> list[Ball]:
    return [] if not x else (matrix * arb_mat(len(x), 1, list(x))).entries()


def _dot(x: Sequence[Ball], y: Sequence[Ball]) -> Ball:
    return sum((a * b for a, b in zip(x, y, strict=True)), arb(0))
