"""Coupling of stored substructures: one pass from the leaves (payloads), one from the root (twists, gravity).

Works from the stored programs alone: the inside of a substructure (its E, Z, own U, Omega, metric, Christoffel
symbols and composites) is replayed with its symbols renamed or bound; the host's columns are carried to its joints, or
the stored momenta to where the host's columns are, and their products give the coupled entries (notation.md, sections 5
and 6, and :mod:`.inertial`).
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field, replace

from substructures.mechanics.composite_form import Inertia, joint_momentum, with_moments_about_axes
from substructures.mechanics.kinematics import (
    INTERFACE,
    Columns,
    Link,
    Twist,
    carrier_link,
    constant_rotation,
    fixed_columns,
    path,
    transport,
)
from substructures.mechanics.linear3 import Scalar, Vector, add, apply, dot, transpose
from substructures.mechanics.parallel_axes import ByAngles, ParallelAxes
from substructures.part.frames import joined_turns
from substructures.part.outputs import OWN_INERTIA, PartOutputs, Run, inertia_bindings
from substructures.part.pairs import wrench_forces
from substructures.part.part import Part
from substructures.tree.grouping import Admitted, Inertias, as_they_are, fixed_inertia, grouped, numbers
from substructures.tree.inertial import EQUATIONS, FRAMES, Plan, inertial_entries, planned
from substructures.tree.mounted_part import WORLD, EvaluatedPart, MountedPart, PlacedPart, links_of

#: outputs of a stored program that coupling uses
USED = (
    *("E.tilt", "E.turn", "E.full", "Z", "tau", "U", "Omega", "subtree.m", "subtree.s", "subtree.J"),
    *("composite.m", "composite.s", "composite.J", "applied", "potential"),
    *("frame.E", "frame.position", "load.at", "load.vector"),
)
OWN = (*OWN_INERTIA, "armature")


def asked(part: Part) -> tuple[tuple[str, ...], ...]:
    """All lists of outputs that coupling asks a part for."""
    equations = [EQUATIONS[:1], EQUATIONS] if part.has_christoffel else [EQUATIONS[:1]]
    return (OWN, FRAMES, *((*USED, *names) for names in equations))


#: what a part has to carry, by carrier, about its body frame origin (of the interface: about its own)
Payload = dict[int, Inertia]


@dataclass(frozen=True)
class Coupled:
    """The result, by indices of the tree's coordinates; ``chain``: the links from joint to joint; ``loads``: what the
    loads of the tree add to the forces.
    """

    metric: dict[tuple[int, ...], Scalar]
    christoffel: dict[tuple[int, ...], Scalar] | None
    gravity: list[Scalar]
    forces: list[Scalar]
    potential: Scalar
    placed: list[PlacedPart]
    chain: Sequence[Link]
    loads: Mapping[int, Scalar] = field(default_factory=dict)

    def with_loads(self, loads: Mapping[int, Scalar], potential: Scalar) -> Coupled:
        """With the forces and the potential of the loads of the tree."""
        forces = [Q + loads[a] if a in loads else Q for a, Q in enumerate(self.forces)]
        return replace(self, forces=forces, potential=self.potential + potential, loads=loads)


def couple_parts(
    run: Run,
    mounted: Sequence[MountedPart],
    gravity: Vector,
    christoffel: bool = True,
    chosen: bool = True,
    group: Admitted = numbers,
) -> Coupled:
    """Metric, Christoffel symbols and forces of a tree of parts; hosts come before what is mounted on them.

    ``run`` gives the outputs of a stored program over the scalars of the bindings: formulas, floats or arrays.
    ``christoffel``: False leaves the Christoffel symbols out. ``chosen``: in evaluation frames for the fewest
    operations; False, for numbers of which none is known to be zero, in the frames of the joints, and nothing is moved;
    ``group``: which masses are moved to what carries them, see :mod:`.grouping`.
    """
    plan = planned(run, mounted, christoffel, chosen)
    # from the leaves, as they are evaluated: of equal formulas the graph keeps the first
    own = [run(m.part, m.bindings, OWN) for m in reversed(mounted)][::-1]
    inertias, ground = grouped(plan.outlined, own, group) if chosen else (as_they_are(mounted, own), Inertia())
    body = fixed_inertia(plan.outlined, inertias)
    by_angles = _by_angles(plan, body, gravity, christoffel) if chosen else ByAngles()
    evaluated, total = evaluate_parts(run, mounted, own, inertias, [(*USED, *names) for names in plan.stored])
    if chosen:
        evaluated = _about_axes(plan, body, evaluated)
    total = total + ground
    placed: list[PlacedPart] = []
    for part in evaluated:
        placed.append(place(part, placed, gravity))
    inertial = inertial_entries(plan, placed, christoffel, by_angles)
    gamma = [here.gamma[c] for here in placed for c in range(len(here.links))]
    Q_gravity = by_angles.gravity(gamma, [momentum for here in placed for momentum in here.evaluated.momenta])
    Q = list(Q_gravity)
    # V = -gamma . s of the whole about the world's origin, what every part has of its own, and constant forces
    V = -dot(gravity, total.s)
    for here in placed:
        for c in range(len(here.links)):
            Q[here.first + c] = Q[here.first + c] + here.outputs.scalar("applied", c)
        V = V + here.outputs.scalar("potential") + _dead_potential(here)
        _add_wrenches(here, Q)
    return Coupled(inertial.metric, inertial.christoffel, Q_gravity, Q, V, placed, plan.chain)


def _by_angles(plan: Plan, body: Callable[[int], Inertia], gravity: Vector, christoffel: bool) -> ByAngles:
    """What absolute angles give, from links and from what is fixed in the carriers alone."""
    before: dict[int, Vector] = {}
    for here in plan.outlined:
        root = here
        while root.host is not None:
            root = root.host
        before |= {here.first + c: root.seat.rotation.forward(gravity) for c in range(len(here.links))}
    return ParallelAxes(plan.chain, body, joined_turns).by_angles(plan.by_angles, christoffel, before)


def _about_axes(plan: Plan, body: Callable[[int], Inertia], evaluated: Sequence[EvaluatedPart]) -> list[EvaluatedPart]:
    """With the moments about parallel axes in their short form, over the borders of parts."""
    carried = [momentum.composite for part in evaluated for momentum in part.momenta]
    carried = with_moments_about_axes(plan.chain, carried, body)
    momenta = [joint_momentum(link.s, inertia) for link, inertia in zip(plan.chain, carried, strict=True)]
    return [
        replace(part, momenta=tuple(momenta[part.mounted.first : part.mounted.first + part.mounted.part.dof]))
        for part in evaluated
    ]


def evaluate_parts(
    run: Run,
    mounted: Sequence[MountedPart],
    own: Sequence[PartOutputs],
    inertias: Sequence[Inertias],
    names: Sequence[Sequence[str]],
) -> tuple[list[EvaluatedPart], Inertia]:
    """From the leaves: every program with what is mounted on its bodies; the inertia of all about the world's origin.

    By part: ``own`` values, ``inertias`` of the carriers, ``names`` of the outputs that are wanted. What is mounted on
    a port acts on the body that carries it as additional inertia (notation.md, section 6, payload).
    """
    payloads: list[Payload] = [{} for _ in mounted]
    evaluated: list[EvaluatedPart] = []
    total = Inertia()
    for i in reversed(range(len(mounted))):
        m, payload = mounted[i], payloads[i]
        part = _evaluated(run, m, payload, own[i], inertias[i], names[i])
        evaluated.insert(0, part)
        # (m, s, J) of the whole about the origin of I
        whole = part.outputs.inertia("composite") + payload.get(INTERFACE, Inertia())
        if m.host == WORLD:
            total = total + whole.in_parent(constant_rotation(m.E), m.position)
        else:
            add_payload(run, mounted[m.host], payloads[m.host], m, whole)
    return evaluated, total


def add_payload(run: Run, host: MountedPart, payload: Payload, m: MountedPart, whole: Inertia) -> None:
    """Add the whole of a part to what the carrier of its frame in the host has to carry."""
    frames = run(host.part, host.bindings, FRAMES)
    E, position = frames.matrix("frame.E", m.frame), frames.vector("frame.position", m.frame)
    carrier = host.part.frame_carriers[m.frame]
    # from the interface to the frame of the host, from there to the body frame of its carrier
    whole = whole.in_parent(constant_rotation(m.E), m.position).in_parent(constant_rotation(E), position)
    payload[carrier] = payload.get(carrier, Inertia()) + whole


def _evaluated(
    run: Run, m: MountedPart, payload: Payload, own: PartOutputs, inertias: Inertias, names: Sequence[str]
) -> EvaluatedPart:
    """The stored formulas with the inertia of every body + payload for its inertia symbols."""
    loaded = {k: inertias[k] + payload.get(k, Inertia()) for k in m.part.inertia_symbols}
    outputs = run(m.part, {**m.bindings, **inertia_bindings(m.part, loaded)}, names)
    joints = m.part.topology.joints
    links = links_of(m.part, outputs)
    momenta = tuple(joint_momentum(j.s, outputs.inertia("subtree", c)) for c, j in enumerate(joints))
    return EvaluatedPart(m, outputs, own, links, momenta, inertias)


def place(part: EvaluatedPart, placed: Sequence[PlacedPart], gravity: Vector) -> PlacedPart:
    """From the root: the host's columns and gravity carried to the interface and to every joint.

    ``placed``: the parts before this one, its host among them; ``gravity``: in world axes.
    """
    m = part.mounted
    if m.host == WORLD:
        host, outside = None, Columns()
        seat = Link(INTERFACE, 0, constant_rotation(m.E), m.position)
        gamma = {INTERFACE: seat.rotation.forward(gravity)}
    else:
        host = placed[m.host]
        # z = r + tau_host e3;   Omega_Ia = A Omega_ha;   U_Ia = A (U_ha + s_a [a = h] e3 + Omega_ha x z)
        seat = host.frame_link(m.frame, m.E, m.position)
        outside = host.columns_beyond(seat)
        gamma = {INTERFACE: seat.rotation.forward(host.gamma[seat.parent])}
    # gamma_k = E_k gamma_p
    for c, link in enumerate(part.links):
        gamma[c] = link.rotation.forward(gamma[link.parent])
    return PlacedPart(part, host, seat, _columns(part, outside), gamma)


def _columns(part: EvaluatedPart, outside: Columns) -> dict[int, Columns]:
    """The host's columns carried to every joint, and the stored own ones, by index in the tree."""
    columns = transport(part.links, outside)
    for c in range(len(part.links)):
        for a in path(part.links, c):
            own = Twist(part.outputs.vector("U", c, a), part.outputs.vector("Omega", c, a))
            columns[c][part.mounted.first + a] = own
    return columns


def _add_wrenches(here: PlacedPart, Q: list[Scalar]) -> None:
    """Forces and torques on bodies, for all coordinates on the path to the body."""
    for carrier, wrench in here.applied_wrenches():
        for a, q in wrench_forces(here, carrier, wrench).items():
            Q[a] = Q[a] + q


def _dead_potential(here: PlacedPart) -> Scalar:
    """V = -F . x of forces that are constant in the world, x their point, unless it is at rest."""
    V: Scalar = 0
    for i, (carrier, _, _) in enumerate(here.part.wrenches):
        if here.part.dead_loads[i] and fixed_columns(here.links, here.columns, carrier, here.first):
            at = here.outputs.vector("load.at", i)
            # x = r_k + R_k^T (at + tau e3)
            pose, along = here.pose(carrier), carrier_link(here.links, carrier).tau
            point = add(pose.r, apply(transpose(pose.R), add(at, (0, 0, along))))
            V = V - dot(here.outputs.vector("load.vector", i), point)
    return V
