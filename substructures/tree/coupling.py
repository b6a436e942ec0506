"""Coupling of stored substructures: one pass from the leaves (payloads), one from the root (twists, gravity).

Works from the stored programs alone: the inside of a substructure (its E, Z, own U, Omega, metric, Christoffel
symbols and composites) is replayed with its symbols renamed or bound; only the host's columns are carried to its
joints, where their products with the stored momenta give the coupled entries (mathematics.md, sections 5 and 6).
Measured against expressing those products in the interface frame (f, n, K), this needs fewer operations.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass

from substructures.expr.graph import Graph
from substructures.expr.replay import replay
from substructures.mechanics.base_functions import Twist, carried, transport
from substructures.mechanics.inertia import Inertia
from substructures.mechanics.joints import Link, lean_rotation, path
from substructures.mechanics.linear3 import E3, Matrix, Scalar, Vector, add, cross, dot
from substructures.mechanics.metric import christoffel_block, joint_momentum, pairing
from substructures.part.outputs import Stored
from substructures.part.part import Part
from substructures.part.topology import INTERFACE
from substructures.tree.mounted_part import WORLD, Mounted, Pose, State, applied_wrenches, frame_link

#: outputs of a stored program that coupling uses
USED = (
    *("E.tilt", "E.turn", "E.full", "Z", "tau", "U", "Omega", "subtree.m", "subtree.s", "subtree.J"),
    *("metric", "christoffel", "composite.m", "composite.s", "composite.J", "applied", "potential"),
    *("frame.E", "frame.position", "load.at", "load.vector"),
)
WITHOUT_CHRISTOFFEL = tuple(name for name in USED if name != "christoffel")
FRAMES = ("frame.E", "frame.position")
OWN = ("inertia.m", "inertia.s", "inertia.J", "base.m", "base.s", "base.J", "armature")

#: all lists of outputs that coupling asks a part for
ASKED = (OWN, FRAMES, WITHOUT_CHRISTOFFEL, USED)

#: the outputs of a part's stored program, by name, for the given values of its symbols
Run = Callable[[Part, Mapping[str, Scalar], Sequence[str]], Stored]


@dataclass
class Coupled:
    """The result, by indices of the tree's coordinates."""

    metric: dict[tuple[int, ...], Scalar]
    christoffel: dict[tuple[int, ...], Scalar]
    gravity: list[Scalar]
    forces: list[Scalar]
    potential: Scalar
    states: list[State]


def over_formulas(graph: Graph) -> Run:
    """Stored programs as formulas in a graph."""

    def run(part: Part, bindings: Mapping[str, Scalar], names: Sequence[str]) -> Stored:
        lifted = {name: graph.lift(x) for name, x in bindings.items()}
        return Stored(replay(part.program, graph, lifted, names))

    return run


def couple_parts(run: Run, mounted: Sequence[Mounted], gravity: Vector, christoffel: bool = True) -> Coupled:
    """Metric, Christoffel symbols and forces of a tree of parts; hosts come before what is mounted on them.

    ``run`` gives the outputs of a stored program over the scalars of the bindings: formulas, floats or arrays.
    ``christoffel``: False leaves the Christoffel symbols out.
    """
    n = 0
    for part in mounted:
        part.first, n = n, n + part.part.dof
    states, total = _pass_up(run, mounted, USED if christoffel else WITHOUT_CHRISTOFFEL)
    result = Coupled({}, {}, [0] * n, [0] * n, -dot(gravity, total.s), states)
    for m, state in zip(mounted, states, strict=True):
        _place(m, state, mounted, states, gravity)
        _twists(m, state)
        _dynamics(m, state, result, christoffel)
        _gravity(m, state, result)
        _applied(m, state, result)
    return result


def _pass_up(run: Run, mounted: Sequence[Mounted], names: Sequence[str]) -> tuple[list[State], Inertia]:
    """Runs every program with the inertia of what is mounted on it; the total is about the world's origin."""
    payload: list[dict[int, Inertia]] = [{} for _ in mounted]
    states: list[State] = []
    total = Inertia()
    for i in reversed(range(len(mounted))):
        m = mounted[i]
        state = _state(run, m, payload[i], names)
        states.insert(0, state)
        whole = state.stored.inertia("composite") + payload[i].get(INTERFACE, Inertia())
        if m.host == WORLD:
            total = total + _moved(whole, m.E, m.position)
        else:
            _pay(run, mounted, payload, m, whole)
    return states, total


def _moved(inertia: Inertia, E: Matrix, position: Vector) -> Inertia:
    return inertia.turned_back(lean_rotation(E, 1, 0)).shifted(position)


def _pay(run: Run, mounted: Sequence[Mounted], payload: list[dict[int, Inertia]], m: Mounted, whole: Inertia) -> None:
    """Add the composite of a part to what the carrier of its frame has to carry."""
    host = mounted[m.host].part
    frame = run(host, mounted[m.host].bindings, FRAMES)
    E, position = frame.matrix("frame.E", m.frame), frame.vector("frame.position", m.frame)
    carrier = host.frame_carriers[m.frame]
    inertia = _moved(_moved(whole, m.E, m.position), E, position)
    payload[m.host][carrier] = payload[m.host].get(carrier, Inertia()) + inertia


def _state(run: Run, m: Mounted, payload: dict[int, Inertia], names: Sequence[str]) -> State:
    own = run(m.part, m.bindings, OWN)
    bindings = dict(m.bindings)
    for k, symbols in m.part.inertia_symbols.items():
        carried_here = own.inertia("inertia", k) + payload.get(k, Inertia())
        values = (carried_here.m, *carried_here.s, *carried_here.J)
        bindings |= zip(symbols, values, strict=True)
    stored = run(m.part, bindings, names)
    joints = m.part.topology.joints
    links = [Link(j.parent, j.s, stored.rotation(c), stored.vector("Z", c)) for c, j in enumerate(joints)]
    momenta = [joint_momentum(j.s, stored.inertia("subtree", c)) for c, j in enumerate(joints)]
    return State(stored, own, links, [stored.scalar("tau", c) for c in range(len(joints))], momenta)


def _place(m: Mounted, state: State, mounted: Sequence[Mounted], states: list[State], gravity: Vector) -> None:
    """Host columns at the interface; poses of the interface and of all joint frames."""
    if m.host == WORLD:
        gamma = lean_rotation(m.E, 1, 0).forward(gravity)
        state.poses[INTERFACE] = Pose(m.E, m.position)
    else:
        host, h = states[m.host], mounted[m.host]
        link = frame_link(h, host, m.frame, m.E, m.position)
        carrier = link.parent
        source = host.outside if carrier == INTERFACE else host.columns[carrier]
        slides = h.first + carrier if carrier != INTERFACE and host.links[carrier].s else None
        state.outside = {a: carried(twist, link, a == slides) for a, twist in source.items()}
        gamma = link.rotation.forward(host.gamma[carrier])
        state.host, state.link = host, link
    state.gamma = [gamma]
    for c, joint in enumerate(state.links):
        state.gamma.insert(c, joint.rotation.forward(state.gamma[joint.parent]))


def _twists(m: Mounted, state: State) -> None:
    """The host's columns carried to every joint, and the stored own ones."""
    state.columns = transport(state.links, state.outside)
    for c in range(len(state.links)):
        for a in path(state.links, c):
            state.columns[c][m.first + a] = Twist(state.stored.vector("U", c, a), state.stored.vector("Omega", c, a))


def _dynamics(m: Mounted, state: State, result: Coupled, christoffel: bool) -> None:
    """The stored own entries, and the products of host columns with the joint momenta."""
    first, own = m.first, state.stored.outputs
    result.metric |= {(first + a, first + c): x for (a, c), x in own["metric"].entries.items()}
    if christoffel:
        entries = own["christoffel"].entries
        result.christoffel |= {(first + a, first + b, first + c): x for (a, b, c), x in entries.items()}
    for c, momentum in enumerate(state.momenta if state.outside else ()):
        columns = state.columns[c]
        result.metric |= {(a, first + c): pairing(columns[a], momentum.p, momentum.H) for a in state.outside}
        if christoffel:
            block = christoffel_block(first + c, columns, momentum, inside=first)
            result.christoffel |= {(a, b, first + c): x for (a, b), x in block.items()}


def _gravity(m: Mounted, state: State, result: Coupled) -> None:
    """Q_c = gamma_c . p_c."""
    for c, momentum in enumerate(state.momenta):
        q = dot(state.gamma[c], momentum.p)
        result.gravity[m.first + c] = q
        result.forces[m.first + c] = q + state.stored.scalar("applied", c)
    result.potential = result.potential + state.stored.scalar("potential")


def _applied(m: Mounted, state: State, result: Coupled) -> None:
    """Forces and torques on bodies: Q_a += f . U_ka + n . Omega_ka for all coordinates on the path to the body."""
    for carrier, force, n in applied_wrenches(m, state):
        columns = state.outside if carrier == INTERFACE else state.columns[carrier]
        if carrier != INTERFACE:
            n = add(n, cross((0, 0, state.tau[carrier]), force))
        for a, twist in columns.items():
            if carrier != INTERFACE and a == m.first + carrier and state.links[carrier].s:
                twist = Twist(add(twist.U, E3), twist.Omega)
            result.forces[a] = result.forces[a] + pairing(twist, force, n)
