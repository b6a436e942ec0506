"""Coupling of stored substructures: one pass from the leaves (payloads), one from the root (twists, gravity).

Works from the stored programs alone: the inside of a substructure (its E, Z, own U, Omega, metric, Christoffel
symbols and composites) is replayed with its symbols renamed or bound; the host's columns are carried to its joints, or
the stored momenta to where the host's columns are, and their products give the coupled entries (notation.md, sections 5
and 6, and :mod:`.inertial`).
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field, replace

from substructures.loads.pairs import wrench_forces
from substructures.mechanics.composite_form import Inertia, joint_momentum, with_moments_about_axes
from substructures.mechanics.kinematics import (
    INTERFACE,
    Columns,
    Link,
    Twist,
    base_functions,
    carried,
    carrier_link,
    constant_rotation,
    fixed_columns,
    joined,
    path,
)
from substructures.mechanics.linear3 import ZERO, Rotation, Scalar, Vector, add, apply, dot, transpose
from substructures.mechanics.parallel_axes import ByAngles, ParallelAxes
from substructures.mechanics.ratios import Ratios
from substructures.part.frames import joined_turns
from substructures.part.outputs import OWN_INERTIA, PartOutputs, Run, frame_placement, inertia_bindings, links_of
from substructures.part.part import Part
from substructures.part.relations import MULTIPLIER
from substructures.tree.grouping import Admitted, Inertias, as_they_are, fixed_inertia, grouped, numbers
from substructures.tree.inertial import EQUATIONS, FRAMES, Plan, inertial_entries, planned
from substructures.tree.mounted_part import WORLD, EvaluatedPart, MountedPart, PlacedPart, ratios_of

#: outputs of a stored program that coupling uses
USED = (
    *("E.tilt", "E.turn", "E.full", "Z", "tau", "U", "Omega", "subtree.m", "subtree.s", "subtree.J"),
    *("applied", "potential"),
    *("frame.E", "frame.position", "load.at", "load.vector"),
)
OWN = (*OWN_INERTIA, "armature")


def asked(part: Part) -> tuple[tuple[str, ...], ...]:
    """All lists of outputs that coupling asks a part for."""
    if part.topology.is_related:
        return (OWN, FRAMES, USED, (MULTIPLIER,))
    most = () if part.topology.balls else EQUATIONS if part.has_christoffel else EQUATIONS[:1]
    equations = dict.fromkeys((most[:1], most))
    return (OWN, FRAMES, *((*USED, *names) for names in equations))


@dataclass(frozen=True, slots=True)
class Hanging:
    """What hangs on an interface, in the frame and about the point to which a link leads; ``moves``: on a joint."""

    link: Link
    inertia: Inertia
    moves: bool


@dataclass(frozen=True)
class Coupled:
    """The result, by indices of the tree's joints: g_ab for a <= b [kg m^2, kg m, kg], Gamma_abc for a < c, b <= c, Q_a
    of gravity and of all forces [N m, N], V [J].

    ``chain``: the links from joint to joint; ``ratios``: the coordinates that move them; ``loads``: Q_a of the tree's.
    """

    metric: dict[tuple[int, ...], Scalar]
    christoffel: dict[tuple[int, ...], Scalar] | None
    gravity: list[Scalar]
    forces: list[Scalar]
    potential: Scalar
    placed: list[PlacedPart]
    chain: Sequence[Link]
    ratios: Ratios
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
    evaluated = with_momenta(plan.chain, evaluated, body if chosen else None)
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
        for i, c in enumerate(here.part.topology.movers):
            Q[here.first + c] = Q[here.first + c] + here.outputs.scalar("applied", i)
        V = V + here.outputs.scalar("potential") + _dead_potential(here)
        _add_wrenches(here, Q)
    ratios = ratios_of(run, mounted)
    return Coupled(inertial.metric, inertial.christoffel, Q_gravity, Q, V, placed, plan.chain, ratios)


def _by_angles(plan: Plan, body: Callable[[int], Inertia], gravity: Vector, christoffel: bool) -> ByAngles:
    """What absolute angles give, from links and from what is fixed in the carriers alone."""
    before: dict[int, Vector] = {}
    for here in plan.outlined:
        root = here
        while root.host is not None:
            root = root.host
        before |= {here.first + c: root.seat.rotation.forward(gravity) for c in range(len(here.links))}
    return ParallelAxes(plan.chain, body, joined_turns).by_angles(plan.by_angles, christoffel, before)


def with_momenta(
    chain: Sequence[Link], evaluated: Sequence[EvaluatedPart], body: Callable[[int], Inertia] | None
) -> list[EvaluatedPart]:
    """With what the joints do to the masses that they carry.

    ``body``: what is fixed in the carrier of a joint of the tree, from which moments about parallel axes have their
    short form, over the borders of parts; None: they stay as they are.
    """
    inertias = [inertia for part in evaluated for inertia in part.carried]
    if body is not None:
        # before J_xx + J_yy of any is added up: of equal formulas the graph keeps the first
        inertias = with_moments_about_axes(chain, inertias, body)
    momenta = [joint_momentum(link.s, inertia) for link, inertia in zip(chain, inertias, strict=True)]
    return [
        replace(part, momenta=tuple(momenta[part.mounted.first : part.mounted.first + part.mounted.part.joint_count]))
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
    carried = [dict(some) for some in inertias]
    hanging: list[list[Hanging]] = [[] for _ in mounted]
    evaluated: list[EvaluatedPart] = []
    total = Inertia()
    for i in reversed(range(len(mounted))):
        m = mounted[i]
        evaluated.insert(0, _evaluated(run, m, carried[i], own[i], inertias[i], names[i]))
        seat = _seat(run, mounted, m)
        for each in _gathered([*hanging[i], *_roots(evaluated[0])], seat):
            way = joined(seat, each.link)
            # fixed to the interface of the host, which no joint of the host moves: it hangs on what the host hangs on
            if m.host != WORLD and way.parent == INTERFACE:
                hanging[m.host].append(replace(each, link=way))
                continue
            inertia = each.inertia.in_parent(way.rotation, way.Z)
            if m.host == WORLD:
                total = total + inertia
            else:
                carried[m.host][way.parent] = carried[m.host][way.parent] + inertia
    return evaluated, total


def _seat(run: Run, mounted: Sequence[MountedPart], m: MountedPart) -> Link:
    """From the body frame of the carrier in the host, or from the world, to the interface of a part."""
    if m.host == WORLD:
        return Link(INTERFACE, 0, constant_rotation(m.E), m.position)
    host = mounted[m.host]
    placement = frame_placement(run(host.part, host.bindings, FRAMES), m.frame, m.E, m.position)
    return Link(host.part.frame_carriers[m.frame], 0, *placement)


def _roots(part: EvaluatedPart) -> Iterator[Hanging]:
    """What a part has on its interface: all that its first joints carry, last one first, and what is fixed there."""
    for c in reversed(range(len(part.links))):
        if part.links[c].parent == INTERFACE:
            yield Hanging(part.links[c], part.carried[c], True)
    if INTERFACE in part.inertias:
        yield Hanging(Link(INTERFACE, 0, Rotation(), ZERO), part.inertias[INTERFACE], False)


def _gathered(hanging: Sequence[Hanging], seat: Link) -> list[Hanging]:
    """With one inertia at the interface for what is fixed there, and for joints, where there are several and the seat
    turns nothing: it is shifted once.
    """
    several = not seat.rotation.factors and sum(each.moves for each in hanging) > 1
    apart = [each for each in hanging if each.moves and not several]
    total = Inertia()
    for each in hanging:
        if several or not each.moves:
            total = total + each.inertia.in_parent(each.link.rotation, each.link.Z)
    return [*apart, Hanging(Link(INTERFACE, 0, Rotation(), ZERO), total, several)]


def _evaluated(
    run: Run, m: MountedPart, carried: Inertias, own: PartOutputs, inertias: Inertias, names: Sequence[str]
) -> EvaluatedPart:
    """The stored formulas with what its carriers carry, own bodies and what is mounted, for its inertia symbols."""
    outputs = run(m.part, {**m.bindings, **inertia_bindings(m.part, carried)}, names)
    links = links_of(m.part, outputs)
    subtrees = tuple(outputs.inertia("subtree", c) for c in range(len(links)))
    return EvaluatedPart(m, outputs, own, links, subtrees, inertias)


def place(part: EvaluatedPart, placed: Sequence[PlacedPart], gravity: Vector) -> PlacedPart:
    """From the root: the host's columns and gravity carried to every joint, and to the interface.

    ``placed``: the parts before this one, its host among them; ``gravity``: in world axes.
    """
    m = part.mounted
    columns, gamma = dict[int, Columns](), dict[int, Vector]()
    if m.host == WORLD:
        host, seat = None, Link(INTERFACE, 0, constant_rotation(m.E), m.position)
        columns[INTERFACE], gamma[INTERFACE] = Columns(), seat.rotation.forward(gravity)
    else:
        host = placed[m.host]
        seat = host.frame_link(m.frame, m.E, m.position)
    here = PlacedPart(part, host, seat, columns, gamma)
    # where relations move joints, what is stored is of the coordinates: of the joints it is formed again
    own = base_functions(part.links) if m.part.topology.is_related else None
    for c, link in enumerate(part.links):
        # of a first joint over the interfaces, from the carrier in the host: z = r + tau_host e3
        before, way = here.from_carrier(link)
        # gamma_k = E_k gamma_p;   Omega_ka = E Omega_ha;   U_ka = E (U_ha + s_a [a = h] e3 + Omega_ha x z)
        gamma[c] = way.rotation.forward(before.gamma[way.parent])
        if link.parent == INTERFACE:
            columns[c] = before.columns_beyond(way)
        else:
            # the host's columns, whose numbers are lower, are carried on; own ones are stored
            columns[c] = {a: carried(twist, link) for a, twist in columns[link.parent].items() if a < m.first}
        for a in path(part.links, c):
            columns[c][m.first + a] = _stored_twist(part, c, a) if own is None else own[c][a]
    if host is not None:
        columns[INTERFACE], gamma[INTERFACE] = host.columns_beyond(seat), seat.rotation.forward(host.gamma[seat.parent])
    return here


def _stored_twist(part: EvaluatedPart, c: int, a: int) -> Twist:
    return Twist(part.outputs.vector("U", c, a), part.outputs.vector("Omega", c, a))


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
