"""What a coupled model stores, over any scalars.

=====================  ===========  ==========================================================================
output                 shape        meaning
=====================  ===========  ==========================================================================
metric                 n n          g_ab [kg m^2, kg m, kg]
christoffel            n n n        Gamma_abc, first kind, first index = equation
gravity                n            generalised gravity forces
bias                   n            Gamma_abc q'^b q'^c, in the way with the fewest operations
nonlinear_effects      n            Gamma_abc q'^b q'^c - Q_a of gravity, with which forward dynamics begins
forces                 n            Q_a: gravity, loads, joint springs and dampers, actuators
inverse_dynamics       n            g_ab q''^b + Gamma_abc q'^b q'^c - Q_a, by recursion
potential_energy                    of gravity (zero at the world's origin) and of all forces that have one [J]
linear_momentum        n 3          momentum of unit velocity q'^a, world axes
angular_momentum       n 3          moment of momentum of unit velocity q'^a about the world's origin, world axes
position               frames 3     origin of every body frame and port in the world [m]
rotation               frames 3 3   from the axes of the frame to those of the world
U, Omega               frames n 3   partial velocities of the origin, partial angular velocities; axes of the frame
closure.*              m ...        of a tree with closures: see :mod:`substructures.tree.closures`
position_rates         m            of a state q with ball joints: q', p' = R v and Q' = 1/2 Q (0, w)
limits                 n 2          lowest and highest value of the coordinates that have limits
friction               n 4          F_c, F_s, v_s (0: none) and v_0 of the coordinates that have dry friction
friction_load          n 2          what the force that a joint transmits adds to F_c: beside its axis, along it
dependent              z            of a tree with loops in its formulas (reduced level): its dependent coordinates
=====================  ===========  ==========================================================================

A tree with more than :data:`substructures.mechanics.formula_size.MOST_CHRISTOFFEL` Christoffel symbols has no
christoffel.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence

from substructures.expr.graph import Expr
from substructures.expr.program import Formulas, array
from substructures.mechanics.balls import accelerations as in_joints
from substructures.mechanics.balls import at_constant_rates
from substructures.mechanics.linear3 import Scalar, add, apply, cross, transpose
from substructures.mechanics.state_names import ball_rows, positions_of
from substructures.part.balls import position_rates
from substructures.part.outputs import over_formulas
from substructures.part.relations import of_coordinates, of_rates
from substructures.tree.assembly import Assembly
from substructures.tree.closures import closure_formulas
from substructures.tree.coupling import Coupled
from substructures.tree.inverse_dynamics import bias_forces, inverse_dynamics
from substructures.tree.model import KINEMATICS
from substructures.tree.mounted_part import PlacedPart, balls_in, balls_of, ratios_of

MOMENTUM = ("linear_momentum", "angular_momentum")


def model_outputs(
    assembly: Assembly,
    coupled: Coupled,
    rates: Sequence[Scalar],
    accelerations: Sequence[Scalar],
    names: frozenset[str] | None = None,
    forces: Callable[[], Mapping[str, Sequence[Scalar]]] | None = None,
) -> dict[str, Formulas]:
    """The table above, over the scalars of the assembly; ``names``: those that are wanted, and some more.

    ``rates``, ``accelerations``: of all joints; ``forces``: ``bias`` and ``nonlinear_effects``, if not by Newton and
    Euler's recursion.
    """
    n, placed = len(coupled.gravity), coupled.placed

    def wanted(*some: str) -> bool:
        """Whether all outputs are wanted, or one of these."""
        return names is None or not names.isdisjoint(some)

    outputs = _equations(coupled, n)
    # by recursion, so that neither needs the Christoffel symbols
    if wanted("inverse_dynamics"):
        outputs["inverse_dynamics"] = _inverse_dynamics(coupled, rates, accelerations)
    if wanted("bias", "nonlinear_effects"):
        found = by_recursion(coupled, rates) if forces is None else forces()
        outputs |= {name: array((n,), lambda a, some=some: some[a]) for name, some in found.items()}
    if wanted(*MOMENTUM):
        outputs |= _momentum(placed, n)
    outputs |= {name: found for name, found in _joint_laws(assembly, n).items() if wanted(name)}
    if assembly.balls and names is None:
        outputs["position_rates"] = _position_rates(assembly, rates)
    if assembly.cuts and names is None:
        outputs |= closure_formulas(placed, assembly.cuts, rates)
    if assembly.dependent.values and wanted("dependent"):
        outputs["dependent"] = _dependent(assembly)
    outputs |= _kinematics(placed, n) if wanted(*KINEMATICS) else {}
    # by joint up to here: rates of balls for single joints first, then coordinates for joints (section 6)
    rotors = [here.evaluated.own.scalar("armature", c) for here in placed for c in range(len(here.links))]
    return of_coordinates(of_rates(outputs, balls_in(placed), rotors.__getitem__), coupled.ratios)


def _equations(coupled: Coupled, n: int) -> dict[str, Formulas]:
    """g_ab, Gamma_abc where they are stored, and Q_a with its parts."""
    found = {"metric": Formulas((n, n), coupled.metric, "symmetric")}
    if coupled.christoffel is not None:
        found["christoffel"] = Formulas((n, n, n), coupled.christoffel, "christoffel")
    return found | {
        "gravity": array((n,), lambda a: coupled.gravity[a]),
        "forces": array((n,), lambda a: coupled.forces[a]),
        "potential_energy": array((), lambda: coupled.potential),
    }


def _inverse_dynamics(coupled: Coupled, rates: Sequence[Scalar], accelerations: Sequence[Scalar]) -> Formulas:
    found = inverse_dynamics(coupled.placed, rates, accelerations)
    # loads between parts are no wrenches of carriers here, which the recursion would have taken in
    for a, Q in coupled.loads.items():
        found[a] = found[a] - Q
    return array((len(found),), lambda a: found[a])


def _position_rates(assembly: Assembly, rates: Sequence[Scalar]) -> Formulas:
    """q', and of ball joints p' = R v and Q' = 1/2 Q (0, w); ``rates``: of all joints, as formulas."""
    graph, pairs = assembly.scope.graph, list(zip(assembly.instances, assembly.mounted, strict=True))
    names = [f"{i.name}.{joint.coordinate}" for i, m in pairs for joint in m.part.topology.joints]
    found, movers = (
        dict(zip(names, rates, strict=True)),
        [m.first + c for _, m in pairs for c in m.part.topology.movers],
    )
    for ball in assembly.balls:
        moved = position_rates(graph, ball.positions, [graph.lift(rates[a]) for a in ball.joints])
        found |= zip(ball.positions, moved, strict=True)
    left = [names[a] for a in movers if names[a] not in assembly.dependent.values]
    order = positions_of(left, ball_rows(assembly.balls, names))
    return array((len(order),), lambda i: found[order[i]])


def _dependent(assembly: Assembly) -> Formulas:
    """The symbols of dependent coordinates, in the order of the coordinates."""
    pairs = zip(assembly.instances, assembly.mounted, strict=True)
    every = [f"{i.name}.{q}" for i, m in pairs for q in m.part.coordinates]
    symbols = [assembly.scope.graph.symbol(q) for q in every if q in assembly.dependent.values]
    return array((len(symbols),), lambda i: symbols[i])


def _joint_laws(assembly: Assembly, n: int) -> dict[str, Formulas]:
    """Limits and friction, of trees in which a joint has some."""
    given: dict[str, tuple[int, Mapping[int, tuple[Expr, ...]]]] = {
        "limits": (2, assembly.limits),
        "friction": (4, assembly.friction),
        "friction_load": (2, assembly.friction_load),
    }
    return {
        name: Formulas((n, width), {(a, i): x for a, row in rows.items() for i, x in enumerate(row)})
        for name, (width, rows) in given.items()
        if rows
    }


def by_recursion(coupled: Coupled, rates: Sequence[Scalar]) -> dict[str, Sequence[Scalar]]:
    """Velocity forces, alone and less the gravity forces, by Newton and Euler's recursion."""
    bias = bias_forces(coupled.placed, rates, second=at_constant_rates(balls_in(coupled.placed), rates))
    return {"bias": bias, "nonlinear_effects": [x - q for x, q in zip(bias, coupled.gravity, strict=True)]}


def rate_symbols(assembly: Assembly) -> tuple[list[Expr], list[Expr]]:
    """q' [rad/s, m/s] and q'' [rad/s^2, m/s^2] of all joints: the symbols, or what relations (q'^a = mu_a y'^i) and
    rates of balls (q'' = v' + c v v, notation.md, section 14) make of them.
    """
    rates: list[Expr] = []
    accelerations: list[Expr] = []
    for instance, m in zip(assembly.instances, assembly.mounted, strict=True):
        for name, kind in zip(m.part.coordinates, m.part.joints, strict=True):
            whole, unit = f"{instance.name}.{name}", "m" if kind == "P" else "rad"
            rates.append(assembly.scope.declare(f"{whole}'", "velocity", f"{unit}/s"))
            accelerations.append(assembly.scope.declare(f"{whole}''", "acceleration", f"{unit}/s^2"))
    ratios = ratios_of(over_formulas(assembly.scope.graph), assembly.mounted)
    lift = assembly.scope.graph.lift
    first, second = ([lift(x) for x in ratios.rates(some)] for some in (rates, accelerations))
    return first, [lift(x) for x in in_joints(balls_of(assembly.mounted), first, second)]


def _momentum(placed: Sequence[PlacedPart], n: int) -> dict[str, Formulas]:
    """Linear momentum, and angular momentum about the world's origin, in world axes."""
    linear: dict[tuple[int, ...], Scalar] = {}
    angular: dict[tuple[int, ...], Scalar] = {}
    for here in placed:
        for c, momentum in enumerate(here.evaluated.momenta):
            # R_c^T p_c   and   R_c^T H_c + r_c x R_c^T p_c
            pose = here.pose(c)
            back = transpose(pose.R)
            p = apply(back, momentum.p)
            L = add(apply(back, momentum.H), cross(pose.r, p))
            linear |= {(here.first + c, i): p[i] for i in range(3)}
            angular |= {(here.first + c, i): L[i] for i in range(3)}
    return {"linear_momentum": Formulas((n, 3), linear), "angular_momentum": Formulas((n, 3), angular)}


def _kinematics(placed: Sequence[PlacedPart], n: int) -> dict[str, Formulas]:
    entries: dict[str, dict[tuple[int, ...], Scalar]] = {name: {} for name in KINEMATICS}
    f = 0
    for here in placed:
        for frame in range(len(here.part.frames)):
            pose, twists = here.frame_kinematics(frame)
            entries["position"] |= {(f, i): pose.r[i] for i in range(3)}
            # from the axes of the frame to those of the world: R^T
            entries["rotation"] |= {(f, j, i): pose.R[i][j] for i in range(3) for j in range(3)}
            # U_fa, Omega_fa in the axes of the frame f
            entries["U"] |= {(f, a, i): t.U[i] for a, t in twists.items() for i in range(3)}
            entries["Omega"] |= {(f, a, i): t.Omega[i] for a, t in twists.items() for i in range(3)}
            f += 1
    shapes = {"position": (f, 3), "rotation": (f, 3, 3), "U": (f, n, 3), "Omega": (f, n, 3)}
    return {name: Formulas(shapes[name], some) for name, some in entries.items()}
