"""Metric and Christoffel symbols of a tree whose base floats: integrals over the mass that documents put on carriers.

With the velocity u_a = v_a + w_a x x of the point x for the rate a = 1, the axes e_i of the base, which are those of
the world at this state, and integrals over what rate c moves (all there is, for rates of the base):

    g_ab = int u_a . u_b dm
    Gamma_abc = int u_a . (w_b x u_c) dm                          joints b <= c, or the base's turn b and joint c
    Gamma_abc = int u_a . 1/2 (w_b x u_c + w_c x u_b) dm          both of the base

An element with a joint a beyond c has the mass that a carries. Nothing of the host is in it, on which they are derived.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence

from flint import arb

from substructures.certificate.bodies import Bodies, Moments, massless, theta_of
from substructures.certificate.dynamics import Carried, carried_by_joints
from substructures.certificate.linear import Ball, Matrix, cross, dot, unit, zeros
from substructures.certificate.numbers import Plain
from substructures.certificate.outputs import Outputs, images_of
from substructures.certificate.tree_outputs import built

METRIC, SYMBOLS = "floating_metric", "floating_christoffel"
BASE = 6
Index = tuple[int, ...]


def floating_metric_outputs(
    tree: Plain, definitions: Mapping[str, Plain], _: Sequence[str], values: Mapping[str, Ball]
) -> Outputs:
    """g~ of the documents."""
    bodies = built(tree, definitions, values)[1]
    carried = carried_by_joints(bodies, bodies.own)
    result, entries = Outputs(), dict[Index, Ball]()
    whole, twists = _whole(bodies), _twists()
    for a in range(BASE):
        p, L = _momentum(whole, *twists[a])
        entries |= {(a, b): dot(p, twists[b][0]) + dot(L, twists[b][1]) for b in range(a, BASE)}
        for c, each in enumerate(carried):
            entries[a, BASE + c] = dot(each.f, twists[a][0]) + dot(each.n, twists[a][1])
    for c, each in enumerate(carried):
        for a, g in zip(each.path, each.metric().entries(), strict=True):
            entries[BASE + a, BASE + c] = g
        entries[BASE + c, BASE + c] += bodies.joints[c].armature
    size = _contracted(bodies, entries, "symmetric")
    result.array(METRIC, (size[0], size[0]), "symmetric").update(size[1])
    return result


def floating_christoffel_outputs(
    tree: Plain, definitions: Mapping[str, Plain], _: Sequence[str], values: Mapping[str, Ball]
) -> Outputs:
    """Gamma~ of the documents; of trees with instances of the reduced level also g~, with which they are reduced."""
    bodies = built(tree, definitions, values)[1]
    carried = carried_by_joints(bodies, bodies.own)
    entries = dict(_symbols(_whole(bodies), carried))
    n, found = _contracted(bodies, entries, "connection")
    result = floating_metric_outputs(tree, definitions, (), values) if tree.get("reduced") else Outputs()
    result.array(SYMBOLS, (n, n, n), "connection").update(found)
    return result


def _whole(bodies: Bodies) -> Moments:
    """Of all that there is, what is fixed to the base with it."""
    return sum(bodies.own.values(), massless())


def _twists() -> list[tuple[Matrix, Matrix]]:
    """v and w of the rates of the base."""
    axes, zero = [unit(i) for i in range(3)], zeros(3, 1)
    return [*((e, zero) for e in axes), *((zero, e) for e in axes)]


def _momentum(mass: Moments, v: Matrix, w: Matrix) -> tuple[Matrix, Matrix]:
    """int u dm and int x x u dm."""
    return v * mass.m + cross(w, mass.s), cross(mass.s, v) + theta_of(mass.J) * w


def _symbols(whole: Moments, carried: Sequence[Carried]) -> Iterator[tuple[Index, Ball]]:
    """All elements that may not be zero, those with b <= c."""
    twists, turns = _twists(), range(3, BASE)
    for b in range(BASE):
        for c in range(max(b, 3), BASE):
            yield from _of_base(whole, carried, b, c)
    for c, each in enumerate(carried):
        F, N = each.forces()
        for place, b in enumerate(each.path):
            force, moment = _column(F, place), _column(N, place)
            for a, (v, w) in enumerate(twists):
                yield (a, *sorted((BASE + b, BASE + c))), dot(v, force) + dot(w, moment)
        for b in turns:
            e = unit(b - 3)
            force, moment = cross(e, each.f), each.K * e
            for a, (v, w) in enumerate(twists):
                yield (a, b, BASE + c), dot(v, force) + dot(w, moment)
            for place, a in enumerate(each.path):
                x = dot(_column(each.V, place), force) + dot(_column(each.W, place), moment)
                yield (BASE + a, b, BASE + c), x
                if a != c:  # int u_c . (e x u_a) = -int u_a . (e x u_c)
                    yield (BASE + c, b, BASE + a), -x
        yield from _of_joints(each, c)


def _of_joints(each: Carried, c: int) -> Iterator[tuple[Index, Ball]]:
    found = each.christoffel().entries()
    width = len(each.path)
    for k, x in enumerate(found):
        a, b = each.path[k // width], each.path[k % width]
        for image, sign in dict(images_of((a, b, c), "christoffel")).items():
            if image[1] <= image[2]:
                yield tuple(BASE + i for i in image), x * sign


def _of_base(whole: Moments, carried: Sequence[Carried], b: int, c: int) -> Iterator[tuple[Index, Ball]]:
    """Both of the base: half of w_b x u_c + w_c x u_b."""
    half, twists = arb("0.5"), _twists()

    def pair(mass: Moments) -> tuple[Matrix, Matrix]:
        """The integrals of it, and of x x it, over a mass."""
        (v_b, w_b), (v_c, w_c) = twists[b], twists[c]
        # w x (v + u x x): int = w x (m v + u x s);   int x x (w x (u x x)) = (J w) x u
        force = cross(w_b, v_c * mass.m + cross(w_c, mass.s)) + cross(w_c, v_b * mass.m + cross(w_b, mass.s))
        moment = cross(mass.s, cross(w_b, v_c) + cross(w_c, v_b)) + cross(mass.J * w_b, w_c) + cross(mass.J * w_c, w_b)
        return force * half, moment * half

    force, moment = pair(whole)
    for a, (v, w) in enumerate(twists):
        yield (a, b, c), dot(v, force) + dot(w, moment)
    for a, each in enumerate(carried):
        force, moment = pair(each.moments)
        yield (BASE + a, b, c), dot(each.v, force) + dot(each.w, moment)


def _column(matrix: Matrix, place: int) -> Matrix:
    found = zeros(3, 1)
    for i in range(3):
        found[i, 0] = matrix[i, place]
    return found


def _contracted(bodies: Bodies, entries: Mapping[Index, Ball], symmetry: str) -> tuple[int, dict[Index, Ball]]:
    """With coordinates in place of joints, where relations move some: x_i = N_ai x_a."""
    left = [a for a, joint in enumerate(bodies.joints) if joint.coordinate == joint.mover]
    number = {bodies.joints[a].coordinate: BASE + i for i, a in enumerate(left)}
    if len(left) == len(bodies.joints):
        return BASE + len(left), dict(entries)
    found = dict[Index, Ball]()
    for index, x in _all(entries, symmetry):
        joints = [None if i < BASE else bodies.joints[i - BASE] for i in index]
        at = tuple(i if joint is None else number[joint.mover] for i, joint in zip(index, joints, strict=True))
        for joint in joints:
            x = x if joint is None else x * joint.slope
        if at[-2:] == tuple(sorted(at[-2:])):
            found[at] = found.get(at, arb(0)) + x
    return BASE + len(left), found


def _all(entries: Mapping[Index, Ball], symmetry: str) -> Iterator[tuple[Index, Ball]]:
    for index, x in entries.items():
        for image in {image for image, _ in images_of(index, symmetry)}:
            yield image, x
