"""Base parameters as a change of binding: masses that a joint does not move are counted with what carries it.

A distribution along the axis of a revolute joint (m, s_3 and J_33 about a point of it) is at rest against the parent of
the joint, and so is J of what a prismatic joint carries, if m and s stay (M. Gautier, W. Khalil, Direct calculation of
minimum set of inertial parameters of serial robots, IEEE Transactions on Robotics and Automation 6(3), 1990). What is
bound to the inertia symbols of stored programs changes; the formulas and all that they give for the tree do not.
"""

from __future__ import annotations

from collections.abc import Callable, Collection, Sequence

from substructures.expr.graph import Expr
from substructures.mechanics.composite_form import Inertia
from substructures.mechanics.kinematics import INTERFACE, Link, constant_rotation, from_body
from substructures.mechanics.linear3 import E3, ZERO, ZERO6, add, exactly, scale
from substructures.part.outputs import PartOutputs, frame_placement
from substructures.tree.mounted_part import WORLD, MountedPart, PlacedPart

#: inertia of the carriers of a part about their body frame origins, of the interface about its own
Inertias = dict[int, Inertia]
#: whether an inertia may be moved, and another one be moved onto it
Admitted = Callable[[Inertia], bool]
#: operations whose results are numbers where all operands are
_EXACT = ("add", "sub", "mul", "neg", "powi")


def every(_: Inertia) -> bool:
    """All that may be moved is."""
    return True


def numbers(inertia: Inertia) -> bool:
    """Numbers alone: to move them takes no operations."""
    return all(not isinstance(x, Expr) or x.is_number for x in (inertia.m, *inertia.s, *inertia.J))


def numbers_and(constants: Collection[str]) -> Admitted:
    """Numbers, and sums and products of them and of symbols that stand for numbers, ``constants``."""
    known: list[bool] = []

    def is_number(x: Expr) -> bool:
        """Of a node of the one graph there is."""
        # operands have lower numbers than what is made of them; no node is looked at twice
        for node in x.graph.nodes[len(known) :]:
            is_named = node.op == "sym" and node.value in constants
            is_made = node.op in _EXACT and all(known[operand.index] for operand in node.args)
            known.append(node.is_number or is_named or is_made)
        return known[x.index]

    return lambda inertia: all(not isinstance(x, Expr) or is_number(x) for x in (inertia.m, *inertia.s, *inertia.J))


def as_they_are(mounted: Sequence[MountedPart], own: Sequence[PartOutputs]) -> list[Inertias]:
    """The own inertias of all parts."""
    return [
        {k: outputs.own_inertia(k) for k in (INTERFACE, *m.part.inertia_symbols)}
        for m, outputs in zip(mounted, own, strict=True)
    ]


def grouped(
    outlined: Sequence[PlacedPart], own: Sequence[PartOutputs], admitted: Admitted
) -> tuple[list[Inertias], Inertia]:
    """The own inertias of all parts with what is moved, and what is left on the ground, about the world's origin.

    ``outlined``: links and seats of the parts; hosts come first, what is mounted is looked at first.
    """
    result = as_they_are([here.mounted for here in outlined], own)
    ground = Inertia()
    # from the leaves: what is moved onto a carrier may be moved on with the carrier's own masses
    for i in reversed(range(len(outlined))):
        here, inertias = outlined[i], result[i]
        for k in sorted(here.part.inertia_symbols, reverse=True):
            link = here.links[k]
            if not admitted(inertias[k]):
                continue
            moved, left = _unmoved(link, inertias[k])
            host, carrier, above = carried_by(outlined, i, link.parent, _before(here.links, link, moved))
            onto = ground if host == WORLD else result[host].get(carrier)
            # None: within a compound joint there is no body, and no symbol that masses could be bound to
            if onto is None or not (admitted(above) and admitted(onto)):
                continue
            inertias[k] = left
            if host == WORLD:
                ground = onto + above
            else:
                result[host][carrier] = onto + above
    return result, ground


def fixed_inertia(outlined: Sequence[PlacedPart], inertias: Sequence[Inertias]) -> Callable[[int], Inertia]:
    """What is fixed in the carrier of joint a of the tree, interfaces of parts with it, about O_a in frame a.

    ``inertias``: of the carriers of all parts, and of what is fixed to their interfaces.
    """
    places = [(i, k) for i, here in enumerate(outlined) for k in range(len(here.links))]
    fixed: dict[int, list[int]] = {}
    for i, here in enumerate(outlined):
        part = here
        # over interfaces on interfaces to the carrier that moves them; there is none where these lead to the world
        while part.host is not None and part.seat.parent == INTERFACE:
            part = part.host
        if part.host is not None:
            fixed.setdefault(part.host.first + part.seat.parent, []).append(i)

    def inertia(a: int) -> Inertia:
        """Formed when it is asked for."""
        part, k = places[a]
        total = inertias[part].get(k, Inertia())
        for i in fixed.get(a, ()):
            if INTERFACE in inertias[i]:
                total = total + carried_by(outlined, i, INTERFACE, inertias[i][INTERFACE])[2]
        return total.shifted((0, 0, outlined[part].links[k].tau))

    return inertia


def carried_by(outlined: Sequence[PlacedPart], i: int, carrier: int, inertia: Inertia) -> tuple[int, int, Inertia]:
    """The part and the carrier that move what is fixed in a carrier of part i, and it in the body frame of that one."""
    while carrier == INTERFACE:
        m = outlined[i].mounted
        inertia = inertia.in_parent(constant_rotation(m.E), m.position)
        if m.host == WORLD:
            return WORLD, INTERFACE, inertia
        host = outlined[m.host]
        E, position = host.outputs.matrix("frame.E", m.frame), host.outputs.vector("frame.position", m.frame)
        inertia = inertia.in_parent(constant_rotation(E), position)
        i, carrier = m.host, host.part.frame_carriers[m.frame]
    return i, carrier, inertia


def on_carriers(placed: Sequence[PlacedPart]) -> list[Inertias]:
    """The inertias of all parts, with what is fixed to interfaces counted with the carriers that move it."""
    result = [dict(here.evaluated.inertias) for here in placed]
    # from the leaves, so that what comes onto an interface from another one is moved on
    for here, inertias in zip(reversed(placed), reversed(result), strict=True):
        fixed, m = inertias.pop(INTERFACE, Inertia()), here.mounted
        if here.host is not None and not all(exactly(x, 0) for x in (fixed.m, *fixed.s, *fixed.J)):
            fixed = fixed.in_parent(*frame_placement(here.host.outputs, m.frame, m.E, m.position))
            host = result[m.host]
            host[here.seat.parent] = host.get(here.seat.parent, Inertia()) + fixed
    return result


def _unmoved(link: Link, own: Inertia) -> tuple[Inertia, Inertia]:
    """What the joint of a link does not move, in the axes and about the origin of its body frame, and what it does."""
    if link.s:
        # a slide does not turn against its parent, and J is of turning alone, about whatever point
        return Inertia(0, ZERO, own.J), Inertia(own.m, own.s, ZERO6)
    x, y, z = own.s
    # m, s_3 and J_33 lie on the axis; no body has what is left, (s_1, s_2) without mass, but all is linear in it
    xx, yy, zz, xy, xz, yz = own.J
    return Inertia(own.m, (0, 0, z), (0, 0, zz, 0, 0, 0)), Inertia(0, (x, y, 0), (xx, yy, 0, xy, xz, yz))


def _before(links: Sequence[Link], link: Link, moved: Inertia) -> Inertia:
    """In the body frame of the parent, whatever the coordinate of the joint is."""
    if link.s:
        return moved.turned_back(link.rotation)
    # the axis of the joint, which its turn leaves as it is, and r = Z - tau_p e3 + tau_k z
    z = link.rotation.back(E3)
    r = add(from_body(links, link), scale(link.tau, z))
    # s_3 z and J_33 z z^T about r
    zz = moved.J[2]
    along = scale(zz, z)
    J = (along[0] * z[0], along[1] * z[1], along[2] * z[2], along[0] * z[1], along[0] * z[2], along[1] * z[2])
    return Inertia(moved.m, scale(moved.s[2], z), J).shifted(r)
