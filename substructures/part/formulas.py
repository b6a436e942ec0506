"""What is stored of a substructure, as formulas of its own coordinates and parameters (notation.md, section 6).

The inertia (m, s, J) of every moving part enters as ten symbols, to which its own values and whatever a host mounts on
it are bound later; binding the own values alone folds the program to its shortest form.

=================  ==========  ===========================================================================
output             shape       meaning (n joints c; own a, b <= c; I: interface frame)
=================  ==========  ===========================================================================
E                  n 3 3       rotation: components in frame L(c) -> frame c (E.tilt, E.turn, E.full: its factors)
Z, tau             n 3, n      from O_L(c) to O_c in frame L(c); body frame origin = O_c + tau e3
R, r               n 3 3, n 3  rotation I -> frame c, and O_c in I
U, Omega           n n 3       kinematic base functions U_ca, Omega_ca in frame c
subtree.m, .s, .J  n ...       mass and moments of everything carried by joint c, about O_c in frame c
f, n               n 3         linear and angular momentum of joint c's unit velocity, in I about its origin
K                  n 3 3       K_c^I
kappa              n n 3       kappa_ac at [a, c]
F, N               n n 3       F_bc, N_bc at [b, c]
metric             n n         own metric (armature included)
christoffel        n n n       own Christoffel symbols
composite.m .s .J              mass and moments of the whole about the origin of I
base.m .s .J                   own values of what is fixed to the interface, about its origin
armature           n           rotor inertia of every joint (part of the metric)
applied            n           joint springs, dampers and stops, actuators, joint loads, springs, potentials
potential                      potential energy of as much of them as has one
inertia.m .s .J    n ...       own values for the inertia symbols, about the body frame origins
frame.E .position  frames ...  constant placement of bodies and ports in their carrier's body frame
port.R .r .U .Omega ports ...  ports with respect to I; own base functions in port axes
load.at, .vector   loads 3     point (carrier's body frame) and vector of forces and torques
=================  ==========  ===========================================================================

Where relations move joints, axes a, b and those of f, n, K, kappa, F, N, applied are by coordinate, all other axes n by
joint, and there are by joint c: multiplier mu and offset delta (n) of q^c = mu y + delta. Where there are ball joints,
christoffel, F and N are those of rates (:mod:`substructures.mechanics.balls`), each symmetric in b and c.

A part with more than :data:`substructures.mechanics.formula_size.MOST_CHRISTOFFEL` Christoffel symbols is stored
without christoffel, kappa, F and N.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

from substructures.expr.program import Formulas, array
from substructures.mechanics.composite_form import (
    Inertia,
    JointMomentum,
    composites,
    joint_momentum,
)
from substructures.mechanics.evaluation_frames import InertialEntries
from substructures.mechanics.frame_choice import evaluation_frames
from substructures.mechanics.kinematics import (
    INTERFACE,
    Columns,
    Link,
    base_functions,
    carrier_link,
    columns_beyond,
    links,
)
from substructures.mechanics.linear3 import (
    SYMMETRIC_INDEX,
    Matrix,
    Planar,
    Scalar,
    Vector,
    add,
    apply,
    cross,
    multiply,
    skew,
    sub,
    subtract,
    transpose,
)
from substructures.mechanics.parallel_axes import ByAngles, ParallelAxes, absolute
from substructures.part.forces.applied_forces import Loads, applied_forces
from substructures.part.forces.wrenches import AppliedWrench
from substructures.part.frames import joined_turns
from substructures.part.inertia_symbols import inertia_symbols
from substructures.part.kinematics import Kinematics, frame_link, kinematics, point_kinematics
from substructures.part.mechanism import Mechanism
from substructures.part.relations import MULTIPLIER, OFFSET, of_coordinates, of_rates


@dataclass(frozen=True)
class Coupled:
    """What is known of a part that was coupled of others: links, own columns by carrier, the inertia of everything that
    a carrier carries (of the interface without what is fixed to it), and the outputs metric and christoffel.
    """

    chain: tuple[Link, ...]
    columns: dict[int, Columns]
    carried: Mapping[int, Inertia]
    equations: Mapping[str, Formulas]


def formulas(m: Mechanism, loads: Loads, large: bool = False, coupled: Coupled | None = None) -> dict[str, Formulas]:
    """All outputs of the table above; of a ``large`` part without christoffel, kappa, F and N. What is known of a
    ``coupled`` part is not derived again.

    Metric and Christoffel symbols come first: of several equal formulas the graph keeps the one it met first.
    """
    if coupled is None:
        chain, bodies = links(m.joints), inertia_symbols(m.scope, m.topology)
        axes, parallel = parallel_axes(chain, bodies), absolute(chain)
        g = axes.metric(parallel)
        columns = base_functions(chain)
        carried: Mapping[int, Inertia] = composites(m.joints, bodies)
        # after the composites, of which it has products: these are what a host with other axes takes
        by_angles = ByAngles(parallel, g, {} if large else axes.christoffel(parallel))
    else:
        chain, columns, carried = coupled.chain, coupled.columns, coupled.carried
    momenta = [joint_momentum(joint.s, carried[c]) for c, joint in enumerate(m.joints)]
    outputs = own_dynamics(m, chain, columns, momenta, by_angles, large) if coupled is None else dict(coupled.equations)
    k = kinematics(chain, columns)
    outputs |= _joint_outputs(m, k)
    outputs |= _inertia_outputs("subtree", [carried[c] for c in range(len(m.joints))])
    outputs |= _inertia_outputs("inertia", list(m.own))
    outputs |= _inertia_outputs("composite", [carried[INTERFACE] + m.base], scalar=True)
    outputs |= _inertia_outputs("base", [m.base], scalar=True)
    outputs["armature"] = array((len(m.laws),), lambda c: m.laws[c].armature)
    outputs |= _interface_outputs(k, momenta, large)
    # what acts between bodies of the part does no work when the interface alone moves: complete without a host
    forces, potential = applied_forces(m, loads, k)
    outputs["applied"] = array((len(forces),), lambda c: forces[c])
    outputs["potential"] = array((), lambda: potential)
    outputs |= _frame_outputs(m, k)
    places = [_wrench_point(k, wrench) for wrench in loads.wrenches]
    outputs["load.at"] = array((len(places), 3), lambda i, x: places[i][x])
    outputs["load.vector"] = array((len(places), 3), lambda i, x: loads.wrenches[i].vector[x])
    if not m.ratios.is_identity:
        outputs[MULTIPLIER] = array((len(m.joints),), lambda a: m.ratios.multipliers[a])
        outputs[OFFSET] = array((len(m.joints),), lambda a: m.offsets[a])
    return of_coordinates(of_rates(outputs, m.topology.balls, lambda c: m.laws[c].armature), m.ratios)


def _wrench_point(k: Kinematics, wrench: AppliedWrench) -> Vector:
    """``at`` in the body frame of the carrier."""
    if wrench.point_of is None:
        return wrench.at
    # R_k (x - r_k) - tau e3
    pose, tau = k.pose(wrench.carrier), carrier_link(k.links, wrench.carrier).tau
    return sub(apply(pose.R, sub(point_kinematics(k, wrench.point_of, wrench.at).position, pose.r)), (0, 0, tau))


def _joint_outputs(m: Mechanism, k: Kinematics) -> dict[str, Formulas]:
    n = len(m.joints)
    E = [link.rotation.matrix() for link in k.links]
    # E = (turn about e3) (tilt about e1), or one full matrix: what coupling replays instead of E
    # (absent where a factor is 1, so that readers know the kind of a rotation by what is stored)
    factors: dict[str, dict[tuple[int, ...], Scalar]] = {"tilt": {}, "turn": {}, "full": {}}
    for c, link in enumerate(k.links):
        if not link.rotation.is_planar:
            factors["full"] |= {(c, i, j): E[c][i][j] for i in range(3) for j in range(3)}
            continue
        for factor in link.rotation.factors:
            if isinstance(factor, Planar):
                key = "tilt" if factor.axis == 0 else "turn"
                factors[key] |= {(c, 0): factor.c, (c, 1): factor.s}
    # U_ca, Omega_ca for a <= c
    own = {(c, a): twist for c in range(n) for a, twist in k.columns[c].items()}
    return {
        "E": array((n, 3, 3), lambda c, i, j: E[c][i][j]),
        "E.tilt": Formulas((n, 2), factors["tilt"]),
        "E.turn": Formulas((n, 2), factors["turn"]),
        "E.full": Formulas((n, 3, 3), factors["full"]),
        "Z": array((n, 3), lambda c, i: k.links[c].Z[i]),
        "tau": array((n,), lambda c: m.joints[c].tau),
        "R": array((n, 3, 3), lambda c, i, j: k.poses[c].R[i][j]),
        "r": array((n, 3), lambda c, i: k.poses[c].r[i]),
        "U": _sparse((n, n, 3), {i: twist.U for i, twist in own.items()}),
        "Omega": _sparse((n, n, 3), {i: twist.Omega for i, twist in own.items()}),
    }


def _sparse(shape: tuple[int, ...], vectors: dict[tuple[int, int], Vector]) -> Formulas:
    return Formulas(shape, {(*i, x): v[x] for i, v in vectors.items() for x in range(3)})


def _inertia_outputs(prefix: str, values: list[Inertia], scalar: bool = False) -> dict[str, Formulas]:
    """m, s and J of a list of inertias (or of one, without the leading axis)."""
    shape = () if scalar else (len(values),)
    index = [()] if scalar else [(k,) for k in range(len(values))]
    pairs = list(zip(index, values, strict=True))
    return {
        f"{prefix}.m": Formulas(shape, {k: v.m for k, v in pairs}),
        f"{prefix}.s": Formulas((*shape, 3), {(*k, i): v.s[i] for k, v in pairs for i in range(3)}),
        f"{prefix}.J": Formulas(
            (*shape, 3, 3),
            {(*k, i, j): v.J[SYMMETRIC_INDEX[i][j]] for k, v in pairs for i in range(3) for j in range(3)},
        ),
    }


def _interface_outputs(k: Kinematics, momenta: list[JointMomentum], large: bool) -> dict[str, Formulas]:
    """What couples the part to any host, in the interface frame about its origin (notation.md, section 6)."""
    n = len(momenta)
    names = ("f", "n") if large else ("f", "n", "kappa", "F", "N")
    values: dict[str, dict[tuple[int, ...], Vector]] = {name: {} for name in names}
    K: list[Matrix] = []
    for c, momentum in enumerate(momenta):
        R, r = k.poses[c].R, k.poses[c].r
        back = transpose(R)
        # f_c = R_c^T p_c,   n_c = R_c^T H_c + r_c x f_c
        f = apply(back, momentum.p)
        K_c = momentum.matrix()
        values["f"][(c,)] = f
        values["n"][(c,)] = add(apply(back, momentum.H), cross(r, f))
        # K_c^I = R_c^T K_c R_c - skew(r_c) skew(f_c)
        K.append(subtract(multiply(back, multiply(K_c, R)), multiply(skew(r), skew(f))))
        # a <= c alone: F_ca = F_ac, N_ca = N_ac and kappa_ca = -kappa_ac (section 6)
        for a, twist in () if large else k.columns[c].items():
            # F_ac = R_c^T (Omega_ca x p_c),   N_ac = R_c^T K_c Omega_ca + r_c x F_ac
            F = apply(back, cross(twist.Omega, momentum.p))
            values["F"][a, c] = F
            values["N"][a, c] = add(apply(back, momentum.moment(twist.Omega)), cross(r, F))
            if a != c:
                # kappa_ac = R_c^T (p_c x U_ca + K_c^T Omega_ca)
                moment = add(cross(momentum.p, twist.U), apply(transpose(K_c), twist.Omega))
                values["kappa"][a, c] = apply(back, moment)
    outputs = {
        name: Formulas(
            (n, 3) if name in ("f", "n") else (n, n, 3), {(*i, x): v[x] for i, v in some.items() for x in range(3)}
        )
        for name, some in values.items()
    }
    return outputs | {"K": array((n, 3, 3), lambda c, i, j: K[c][i][j])}


def parallel_axes(chain: Sequence[Link], bodies: Sequence[Inertia]) -> ParallelAxes:
    """Over formulas; ``bodies``: about their body frame origins."""
    # z = tau e3 from O_k to the body frame origin
    return ParallelAxes(chain, lambda k: bodies[k].shifted((0, 0, chain[k].tau)), joined_turns)


def own_dynamics(
    m: Mechanism,
    chain: tuple[Link, ...],
    columns: dict[int, Columns],
    momenta: list[JointMomentum],
    by_angles: ByAngles,
    large: bool = False,
) -> dict[str, Formulas]:
    """Metric g_ab (n, n) [kg m^2, kg m, kg] and Christoffel symbols Gamma_abc (n, n, n) of the part on an interface at
    rest (notation.md, section 5); of a ``large`` one the metric alone. ``by_angles``: what is known of them.
    """
    n = len(momenta)
    entries = InertialEntries(chain, columns, evaluation_frames(chain, not large))
    g, gamma = dict(by_angles.metric), dict(by_angles.christoffel)
    for c, momentum in enumerate(momenta):
        if c not in by_angles.joints:
            g |= entries.metric(c, momentum)
        # the rotor of joint c turns with q'^c alone: no composite has it, and no Christoffel symbol
        g[c, c] = g[c, c] + m.laws[c].armature
        if not large and c not in by_angles.joints:
            gamma |= entries.christoffel(c, momentum)
    metric = {"metric": Formulas((n, n), g, "symmetric")}
    return metric if large else metric | {"christoffel": Formulas((n, n, n), gamma, "christoffel")}


def _frame_outputs(m: Mechanism, k: Kinematics) -> dict[str, Formulas]:
    frames = [*m.bodies.values(), *m.ports.values()]
    n = len(m.joints)
    outputs = {
        "frame.E": array((len(frames), 3, 3), lambda i, x, y: frames[i].E[x][y]),
        "frame.position": array((len(frames), 3), lambda i, x: frames[i].position[x]),
    }
    U: dict[tuple[int, int], Vector] = {}
    Omega: dict[tuple[int, int], Vector] = {}
    R, r = [], []
    for i, frame in enumerate(m.ports.values()):
        link = frame_link(k, frame)
        # R = E R_k,   r = r_k + R_k^T z
        pose = k.poses[frame.carrier]
        R.append(multiply(frame.E, pose.R))
        r.append(add(pose.r, apply(transpose(pose.R), link.Z)))
        for a, twist in columns_beyond(k.links, k.columns, link).items():
            U[i, a], Omega[i, a] = twist.U, twist.Omega
    ports = len(m.ports)
    return outputs | {
        "port.R": array((ports, 3, 3), lambda i, x, y: R[i][x][y]),
        "port.r": array((ports, 3), lambda i, x: r[i][x]),
        "port.U": _sparse((ports, n, 3), U),
        "port.Omega": _sparse((ports, n, 3), Omega),
    }
