"""Frames on carriers, the interface among them, and parts in the order in which a tree learns of them."""

# ruff: noqa: N803, N806 -- symbols of the notation

from __future__ import annotations

from dataclasses import FrozenInstanceError
from functools import cache

import numpy as np
import pytest
from catalogue_entries import shipped_part

from substructures import Part, TreeSpec, catalogue
from substructures.mechanics.kinematics import (
    INTERFACE,
    Link,
    OneDofJoint,
    Pose,
    base_functions,
    carrier_link,
    columns_beyond,
    constant_rotation,
    fixed_link,
    from_body,
    joint_rotation,
    links,
)
from substructures.mechanics.linear3 import IDENTITY, ZERO, Matrix, Rotation, Turn
from substructures.part.outputs import over_formulas
from substructures.tree.assembly import assemble
from substructures.tree.coupling import Coupled, couple_parts

KINDS = (0, 1, 0, 1)
PARENTS = (INTERFACE, 0, 1, 0)


def turned(rng: np.random.Generator) -> Matrix:
    """A random rotation, as floats."""
    q, _ = np.linalg.qr(rng.standard_normal((3, 3)))
    q = q * np.linalg.det(q)
    x, y, z = ((float(a), float(b), float(c)) for a, b, c in q)
    return x, y, z


def chain(q: np.ndarray) -> tuple[Link, ...]:
    """A branched chain of revolute and prismatic joints at q, the same random one each time."""
    rng = np.random.default_rng(3)
    joints = []
    for parent, s, q_k in zip(PARENTS, KINDS, q, strict=True):
        phi, tau = rng.uniform(-1, 1, 2)
        phi, tau = (phi, tau + q_k) if s else (phi + q_k, tau)
        offset = tuple(map(float, rng.uniform(-1, 1, 3)))
        rotation = joint_rotation(turned(rng), float(np.cos(phi)), float(np.sin(phi)))
        joints.append(OneDofJoint(parent, s, rotation, offset, float(tau)))
    return links(joints)


def pose(q: np.ndarray, carrier: int, E: Matrix, position: tuple[float, float, float]) -> tuple[np.ndarray, np.ndarray]:
    """R and r of a frame in a carrier, in the interface frame."""
    some = chain(q)
    poses = {INTERFACE: Pose(IDENTITY, ZERO)}
    for k, link in enumerate(some):
        poses[k] = poses[link.parent].beyond(link)
    found = poses[carrier].beyond(fixed_link(some, carrier, constant_rotation(E), position))
    return np.array(found.R, dtype=float), np.array(found.r, dtype=float)


@pytest.mark.parametrize("carrier", [INTERFACE, 0, 1, 2, 3])
def test_columns_of_a_frame_are_the_derivatives_of_its_pose(carrier: int) -> None:
    """U_a = R d_a r and skew(Omega_a) = R d_a R^T, in the axes of the frame."""
    rng = np.random.default_rng(7)
    q, E, at, step = rng.uniform(-1, 1, 4), turned(rng), (0.3, -0.2, 0.5), 1e-6
    some = chain(q)
    columns = columns_beyond(some, base_functions(some), fixed_link(some, carrier, constant_rotation(E), at))
    R, _ = pose(q, carrier, E, at)
    for a in range(4):
        (R_1, r_1), (R_2, r_2) = (pose(q + sign * step * np.eye(4)[a], carrier, E, at) for sign in (-1, 1))
        spin = R @ (R_2 - R_1).T / (2 * step)
        U, Omega = (columns[a].U, columns[a].Omega) if a in columns else (ZERO, ZERO)
        np.testing.assert_allclose(np.array(U, dtype=float), R @ (r_2 - r_1) / (2 * step), atol=1e-8)
        np.testing.assert_allclose(np.array(Omega, dtype=float), [spin[2, 1], spin[0, 2], spin[1, 0]], atol=1e-8)


@pytest.mark.parametrize("carrier", [INTERFACE, 0, 1, 2, 3])
def test_placements_are_seen_from_the_body_frame_or_from_the_joint(carrier: int) -> None:
    """z = r + tau e3 and back."""
    some = chain(np.array([0.1, 0.2, 0.3, 0.4]))
    link = fixed_link(some, carrier, Rotation((Turn(IDENTITY),)), (0.25, 0.5, 0.75))
    shift = np.array(link.Z, dtype=float) - [0.25, 0.5, 0.75]
    expected = 0 if carrier == INTERFACE else some[carrier].tau
    assert shift == pytest.approx([0, 0, expected])
    assert from_body(some, link) == pytest.approx((0.25, 0.5, 0.75))
    assert (carrier_link(some, carrier).s, link.parent) == (0 if carrier == INTERFACE else KINDS[carrier], carrier)


@cache
def humanoid() -> tuple[TreeSpec, dict[str, Part]]:
    """The shipped tree of seven parts."""
    spec = TreeSpec.read(catalogue.load_tree("humanoid"))
    return spec, {i.name: shipped_part(str(i.substructure)) for i in spec.instances}


def coupled() -> Coupled:
    """The humanoid over formulas."""
    assembly = assemble(*humanoid())
    return couple_parts(over_formulas(assembly.scope.graph), assembly.mounted, assembly.gravity)


def test_first_coordinates_follow_each_other() -> None:
    firsts = [(here.first, here.part.dof) for here in coupled().placed]
    assert [first for first, _ in firsts] == [sum(n for _, n in firsts[:i]) for i in range(len(firsts))]
    assert sum(n for _, n in firsts) == 34


def test_poses_follow_from_the_host_whichever_is_asked_for_first() -> None:
    placed = coupled().placed
    for here in reversed(placed):
        here.pose(here.part.dof - 1)
    for here in placed:
        assert (here.host is None) == (here is placed[0])
        before = Pose(here.mounted.E, here.mounted.position)
        if here.host is not None:
            before = here.host.pose(here.seat.parent).beyond(here.seat)
        assert here.pose(INTERFACE) == before
        for k, link in enumerate(here.links):
            assert here.pose(k) == here.pose(link.parent).beyond(link)


def test_what_is_known_of_a_part_does_not_change() -> None:
    here = coupled().placed[1]
    for value, name in ((here, "columns"), (here.evaluated, "links"), (here.mounted, "first")):
        with pytest.raises(FrozenInstanceError):
            setattr(value, name, None)
