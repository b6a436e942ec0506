"""Given motions of coordinates in the formulas of a tree (rheonomic; notation.md, section 12).

With q^m = s(t) of the driven coordinates m, and a, b, c of those that are left, which are free:

    g_a0 = g_am s'^m        g_00 = g_mk s'^m s'^k        Gamma_ab0 = Gamma_abm s'^m
    Gamma_a00 = Gamma_amk s'^m s'^k + g_am s''^m
    g_ab q''^b + Gamma_abc q'^b q'^c + 2 Gamma_ab0 q'^b + Gamma_a00 = Q_a
    T = T_2 + T_1 + T_0 = 1/2 g_ab q'^a q'^b + g_a0 q'^a + 1/2 g_00

====================  ==========  =================================================================================
output                shape       meaning
====================  ==========  =================================================================================
g_a0, g_00            n, ()       what the drives add to the metric
Gamma_ab0, Gamma_a00  n n, n      what they add to the Christoffel symbols
T_2, T_1, T_0         ()          the kinetic energy by powers of the free velocities [J]
drive_forces          driven      row m of the equations of all coordinates: what moves m so [N m, N]
drive_powers          driven      these forces times s' [W]
linear_momentum_0     3           momentum of the world's axes where the free velocities are zero; angular_momentum_0
U_0, Omega_0          frames 3    velocity of the origin, angular velocity there; axes of the frame
closure.rate          rows        phi_t of closures phi(q, t) = 0, whose closure.acceleration has G_km s''^m, too
closure.drives        rows driven G_km: reactions of closures add -G_km lambda_k to the forces of the drives
====================  ==========  =================================================================================

``bias`` is Gamma_abc q'^b q'^c + 2 Gamma_ab0 q'^b + Gamma_a00, ``nonlinear_effects`` this less gravity. An actuator of
a driven coordinate has no force beside that of the drive.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

from substructures.documents import escape
from substructures.documents.fields import in_si
from substructures.errors import among
from substructures.expr.calculus.corners import corners, has_smooth_rate, rates
from substructures.expr.graph import Expr, Graph
from substructures.expr.laws.formulas import SLOPES
from substructures.expr.operations import Symbol
from substructures.expr.program import Formulas, array
from substructures.expr.steps import Knots
from substructures.expr.units.unit_check import steps_of
from substructures.expr.walk import transfer
from substructures.part.relations import OF_COORDINATES
from substructures.tree.assembly import Assembly
from substructures.tree.document import DrivenInput, DrivenTable
from substructures.tree.given.projection import changed
from substructures.tree.given.reduced import reduced

Elements = Mapping[tuple[int, ...], Any]
#: s, s', s''
Given = tuple[Expr, Expr, Expr]
PRIMES = ("", "'", "''")
#: functions whose derivatives jump, and smooth ones that formulas take from both sides of a corner
JUMPING, SMOOTH = frozenset(("abs", "sign", "min", "max")), frozenset(("step", "tanh"))
VELOCITY_FORCES = ("bias", "nonlinear_effects")
#: what is of the coordinates that move, one by one
MOTIONS = frozenset(("linear_momentum", "angular_momentum", "U", "Omega"))
#: axes of outputs that are coordinates
AXES: dict[str, tuple[int, ...]] = {**OF_COORDINATES, "g_a0": (0,), "Gamma_ab0": (0, 1), "Gamma_a00": (0,)}


def every_coordinate(assembly: Assembly) -> dict[str, str]:
    """The kinds of all coordinates of all parts by name, dependent ones among them: R or P."""
    pairs = zip(assembly.instances, assembly.mounted, strict=True)
    return {
        f"{instance.name}.{name}": kind
        for instance, m in pairs
        for name, kind in zip(m.part.coordinates, m.part.joints, strict=True)
    }


def all_coordinates(assembly: Assembly) -> dict[str, str]:
    """Those that do not depend on others, free, driven and ignored."""
    values = assembly.dependent.values
    return {name: kind for name, kind in every_coordinate(assembly).items() if name not in values}


def driven_names(assembly: Assembly) -> tuple[str, ...]:
    """Those whose motion is given, in the order of the coordinates."""
    return tuple(name for name in all_coordinates(assembly) if name in assembly.reading.spec.driven)


def driven_inputs(assembly: Assembly) -> dict[str, dict[str, object]]:
    """The inputs that driven coordinates and their two derivatives are, as they are described."""
    kinds, given = all_coordinates(assembly), assembly.reading.spec.driven
    return {
        f"{name}{primes}": {"unit": f"{'m' if kinds[name] == 'P' else 'rad'}{per}"}
        for name in driven_names(assembly)
        if isinstance(given[name], DrivenInput)
        for primes, per in zip(PRIMES, ("", "/s", "/s^2"), strict=True)
    }


def given_motions(assembly: Assembly) -> dict[str, Given]:
    """s [rad, m], s' and s'' of all driven coordinates by name.

    Raises InvalidDocument (``/driven/name``): unknown coordinates, expressions that cannot be read or have a kink.
    """
    reading, scope, names = assembly.reading, assembly.scope, all_coordinates(assembly)
    given = reading.spec.driven
    for name in sorted(given.keys() - names.keys()):
        message = f"there is no coordinate '{name}'{among(name, names)}"
        if name in assembly.dependent.values:
            message = f"'{name}' follows from the independent coordinates of its loops: drive one of these, or "
            message += f"give '{name.partition('.')[0]}' the level 'full'"
        scope.fault(f"/driven/{escape(name)}", "unknown-coordinate", message)
    found: dict[str, Given] = {}
    for name in driven_names(assembly):
        pointer, motion = f"/driven/{escape(name)}", given[name]
        if isinstance(motion, DrivenInput):
            x, v, a = (scope.graph.symbol(f"{name}{primes}") for primes in PRIMES)
            found[name] = x, v, a
        else:
            time = scope.declare("t", "time", "s")
            motion = str(motion) if isinstance(motion, DrivenTable) else motion
            s = scope.read(motion, pointer, lambda word: time if word == "t" else reading.parameter(word))  # noqa: B023
            if _has_kink(motion, s):
                message = (
                    "the velocity of a driven coordinate must not jump, as with |t|, sign, min, max (but in powers, as "
                    "max(0, t - 1)^2), linear tables, and at the ends of monotone ones that do not end flat"
                )
                scope.fault(pointer, "kink", f"{message}: take step, tanh or smooth tables, or give {{'input': true}}")
            else:
                found[name] = s, *rates(s, "t")
    scope.finish()
    scope.symbols |= {name: Symbol(name, "input", str(told["unit"])) for name, told in driven_inputs(assembly).items()}
    return found


def _has_kink(motion: Any, s: Expr) -> bool:
    """Whether a motion may have one: by the functions in its text, and corners beside those that are smooth there, as
    max(0, t)^2 is.
    """
    steps = [step for step in steps_of(str(in_si(motion))) if step.op in ("call", "table")]
    if any(isinstance(step.value, Knots) and not _ends_flat(step.value) for step in steps):
        return True
    if any(step.value in JUMPING for step in steps):
        return not has_smooth_rate(s, "t")
    is_smooth = any(step.value in SMOOTH or isinstance(step.value, Knots) for step in steps)
    return not is_smooth and bool(corners([s]))


def _ends_flat(knots: Knots) -> bool:
    """Whether a table has a slope everywhere, zero at its ends, before and after which it rests."""
    slopes = SLOPES[knots.kind](knots) if knots.kind in SLOPES else None
    return slopes is not None and slopes[0] == slopes[-1] == 0


def put_in(
    assembly: Assembly, outputs: Mapping[str, Formulas], axes: Mapping[str, Sequence[int]] = AXES
) -> dict[str, Formulas]:
    """Outputs of all coordinates with dependent coordinates and given motions in them: along axes of coordinates those
    that are free, beside them what the table says. ``axes``: those of coordinates by output. Raises as
    :func:`given_motions`.
    """
    # loops first: where a driven coordinate moves dependent ones, z(y) is a function of it, and s is put in there, too
    outputs = reduced(assembly.dependent, list(every_coordinate(assembly)), outputs, axes)
    motions = given_motions(assembly)
    if not motions:
        return dict(outputs)
    graph, names = assembly.scope.graph, list(all_coordinates(assembly))
    moving = _substituted(graph, outputs, motions)
    speeds, second = ({names.index(name): motion[k] for name, motion in motions.items()} for k in (1, 2))
    free = [a for a in range(len(names)) if a not in speeds]
    if "metric" in moving:
        moving |= _inertial(moving, speeds, second, {a: graph.symbol(f"{names[a]}'") for a in free})
    for name in sorted(MOTIONS & moving.keys()):
        axis = AXES[name][0]
        rest = _contracted(moving[name].entries, axis, speeds)
        moving[f"{name}_0"] = Formulas(_without(moving[name].shape, axis), rest)
    if "closure.jacobian" in moving:
        moving |= _closed(moving, speeds, second)
    if "inverse_dynamics" in moving:
        rows = moving["inverse_dynamics"].entries
        drives = [(rows.get((m,), graph.zero), v) for m, v in speeds.items()]
        moving["drive_forces"] = array((len(drives),), lambda k: drives[k][0])
        moving["drive_powers"] = array((len(drives),), lambda k: drives[k][0] * drives[k][1])
    return {name: _free(each, axes.get(name, ()), free) for name, each in moving.items()}


def _inertial(
    moving: Mapping[str, Formulas], rates: Mapping[int, Expr], second: Mapping[int, Expr], free: Mapping[int, Expr]
) -> dict[str, Formulas]:
    """What the drives add to the metric, the Christoffel symbols and the velocity forces; powers of the free velocities
    in the kinetic energy.
    """
    n, metric = moving["metric"].shape[0], moving["metric"].expanded()
    zero = next(iter(rates.values())).graph.zero
    # g_am s'^m and g_am s''^m, of driven rows a, too: g_00 is made of these, and `put_in` leaves them out at the end
    mixed, pull = _contracted(metric, 1, rates), _contracted(metric, 1, second)
    last = _contracted(mixed, 0, rates).get((), zero)
    own = _contracted(_contracted(metric, 1, free), 0, free).get((), zero)
    found = {
        "g_a0": Formulas((n,), mixed),
        "g_00": Formulas((), {(): last}),
        "T_2": Formulas((), {(): own / 2}),
        "T_1": Formulas((), {(): _contracted(mixed, 0, free).get((), zero)}),
        "T_0": Formulas((), {(): last / 2}),
    }
    if "christoffel" in moving:
        gamma = _contracted(moving["christoffel"].expanded(), 2, rates)
        found["Gamma_ab0"] = Formulas((n, n), gamma)
        found["Gamma_a00"] = _sum((n,), _contracted(gamma, 1, rates), pull)
    # Gamma_abc q'^b q'^c of all coordinates, and g_am s''^m
    return found | {name: _sum((n,), moving[name].entries, pull) for name in VELOCITY_FORCES if name in moving}


def _closed(
    moving: Mapping[str, Formulas], rates: Mapping[int, Expr], second: Mapping[int, Expr]
) -> dict[str, Formulas]:
    """phi_t = G_km s'^m, c = G' q' + G_km s''^m, and G_km."""
    rows, columns = moving["closure.jacobian"].shape[0], moving["closure.jacobian"].entries
    place = {m: i for i, m in enumerate(rates)}
    drives: dict[tuple[int, ...], Any] = {(k, place[m]): x for (k, m), x in columns.items() if m in place}
    return {
        "closure.rate": Formulas((rows,), _contracted(columns, 1, rates)),
        "closure.acceleration": _sum((rows,), moving["closure.acceleration"].entries, _contracted(columns, 1, second)),
        "closure.drives": Formulas((rows, len(place)), drives),
    }


def _sum(shape: tuple[int, ...], some: Elements, others: Elements) -> Formulas:
    """The sum of two arrays."""
    added = {i: some[i] + x if i in some else x for i, x in others.items()}
    return Formulas(shape, {**some, **added})


def _substituted(graph: Graph, outputs: Mapping[str, Formulas], motions: Mapping[str, Given]) -> dict[str, Formulas]:
    """The outputs with s, s', s'' for driven coordinates, and no force of their actuators."""
    values = {f"{name}{p}": x for name, motion in motions.items() for p, x in zip(PRIMES, motion, strict=True)}
    values |= {f"tau.{name}": graph.zero for name in motions}
    return changed(graph, outputs, lambda every: transfer(every, graph, values))


def _free(each: Formulas, axes: Sequence[int], free: Sequence[int]) -> Formulas:
    """The elements of free coordinates. Their order stays, and so does a symmetry."""
    place = {a: i for i, a in enumerate(free)}
    shape = tuple(len(free) if axis in axes else size for axis, size in enumerate(each.shape))
    entries = {
        tuple(place[k] if axis in axes else k for axis, k in enumerate(index)): x
        for index, x in each.entries.items()
        if all(index[axis] in place for axis in axes)
    }
    return Formulas(shape, entries, each.symmetry)


def _without(shape: tuple[int, ...], axis: int) -> tuple[int, ...]:
    return shape[:axis] + shape[axis + 1 :]


def _contracted(elements: Elements, axis: int, by: Mapping[int, Expr]) -> dict[tuple[int, ...], Expr]:
    """x_..m.. v^m for the driven coordinates m."""
    result: dict[tuple[int, ...], Expr] = {}
    # sorted, so that sums have one order, and programs one digest, however the elements came about
    for index, x in sorted(elements.items()):
        if index[axis] in by:
            at, term = _without(index, axis), by[index[axis]] * x
            result[at] = result[at] + term if at in result else term
    return result
