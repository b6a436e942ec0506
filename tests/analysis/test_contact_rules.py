"""Rules of contacts: rows against differences, impulses against least squares, planted faults, and what is refused."""

from __future__ import annotations

import math
from typing import Any

import numpy as np
import pytest
import scipy
from contact_models import BALL, G, block, of
from in_depth import deep

from substructures import (
    Contact,
    Event,
    FixedStep,
    Integrator,
    InvalidArgument,
    Model,
    Outputs,
    TreeMotion,
    evaluate,
    simulate,
)
from substructures.analysis.motion.contacts import contact_motion, deciding
from substructures.analysis.motion.contacts.complementarity import Cones, coulomb
from substructures.analysis.motion.contacts.pivoting import lemke
from substructures.analysis.motion.contacts.rows import contact_rows
from substructures.analysis.motion.trajectory import Trajectory
from substructures.analysis.verdict import Check
from substructures.array import Array
from substructures.expr.interpret import interpret

SLIDING = [Contact(name, f"b.{name}", type="point_line", friction=0.3) for name in "lr"]


def arm() -> Model:
    """Five joints whose axes are skew."""
    kinds = ("revolute", "prismatic", "revolute", "revolute", "revolute")
    bodies = [
        {"name": f"b{k}", "parent": f"b{k - 1}" if k else "base", "mass": 1, "com": [0.1, 0.2, 0.1],
         "joint": {"type": kind, "coordinate": f"q{k}",
                   "placement": {"position": [0.3, 0.1 * k, 0.2], "rpy": [1, k, 2]}}}
        for k, kind in enumerate(kinds)
    ]  # fmt: skip
    return of("arm", {"name": "arm", "bodies": bodies}, [0, 0, -G])


def test_rows_are_slopes_of_the_place_of_a_point_in_the_axes_of_its_plane() -> None:
    """Gap, normal and tangents against differences of positions and rotations by another program."""
    model, rng, h = arm(), np.random.default_rng(3), 1e-6
    frames = list(model.frames)
    point, plane = "arm.b4", "arm.b1"
    program = contact_rows(model, [Contact("c", point, plane=plane)])

    def place(q: Array) -> Array:
        """R_p^T (c - p), normal first."""
        found = evaluate(model, ["kinematics"], q)["kinematics"]
        k, p = frames.index(point), frames.index(plane)
        local = found["rotation"][p].T @ (found["position"][k] - found["position"][p])
        return np.asarray(local[[2, 0, 1]])

    def rows(q: Array, qd: Array) -> Any:
        values = {name: float(q[a]) for a, name in enumerate(model.coordinates)}
        values |= {f"{name}'": float(qd[a]) for a, name in enumerate(model.coordinates)}
        return interpret(program, values, ["gap", "rows", "bias"])

    for _ in range(3):
        q, qd = rng.uniform(-1, 1, model.dof), rng.uniform(-1, 1, model.dof)
        found = rows(q, qd)
        assert found["gap"][0] == pytest.approx(place(q)[0], abs=1e-13)
        for a, step in enumerate(h * np.eye(model.dof)):
            assert found["rows"][0, :, a] == pytest.approx((place(q + step) - place(q - step)) / (2 * h), abs=1e-8)
        change = (rows(q + h * qd, qd)["rows"] - rows(q - h * qd, qd)["rows"]) / (2 * h)
        assert found["bias"][0] == pytest.approx(change[0] @ qd, abs=1e-7)


def random_contacts(rng: np.random.Generator, n: int, k: int, rough: float, spatial: bool) -> Cones:
    """Contacts of a mechanism of n coordinates, with velocities that it can have."""
    root, rows = rng.standard_normal((n, n)), rng.standard_normal((k, 3, n))
    inverse = np.linalg.inv(root @ root.T + 0.1 * np.eye(n))
    moved = np.einsum("ian,nm,jbm->iajb", rows, inverse, rows)
    there = np.array([[rough > 0, rough > 0 and spatial]] * k)
    b = rows @ rng.standard_normal(n)
    return Cones(moved, b, np.full(k, rough), there, np.einsum("iaia->ia", moved)[:, 0])


def test_impulses_without_friction_are_least_squares() -> None:
    """J. J. Moreau: least energy of the change over impulses that press; by SciPy's non-negative least squares."""
    rng = np.random.default_rng(1)
    for _ in range(200):
        n, k = int(rng.integers(2, 9)), int(rng.integers(1, 7))
        cones = random_contacts(rng, n, k, 0.0, False)
        matrix, b = cones.A[:, 0, :, 0], cones.b[:, 0]
        p = coulomb(cones)[:, 0]
        # W = C^T C: least |C p + C^-T b|
        values, vectors = np.linalg.eigh(matrix)
        kept = values > 1e-10 * values[-1]
        root = np.sqrt(values[kept])[:, None] * vectors[:, kept].T
        other, _ = scipy.optimize.nnls(root, -(vectors[:, kept] / np.sqrt(values[kept])).T @ b)
        assert matrix @ p == pytest.approx(matrix @ other, abs=1e-7 * np.abs(b).max())


@pytest.mark.parametrize("spatial", [False, True])
def test_forces_meet_coulombs_law(spatial: bool) -> None:
    """Normal forces press only where nothing opens; friction is at its most against a slip, or less where none is."""
    rng = np.random.default_rng(2)
    for _ in range(100):
        cones = random_contacts(rng, int(rng.integers(6, 13)), int(rng.integers(1, 4)), 0.6, spatial)
        p = coulomb(cones)
        w, size, force = cones.left(p), np.abs(cones.b).max(), max(np.abs(p).max(), 1e-6)
        assert (p[:, 0] >= -1e-9 * force).all()
        assert (w[:, 0] >= -1e-8 * size).all()
        assert np.abs(p[:, 0] * w[:, 0]).max() <= 1e-8 * size * force
        for i in range(len(p)):
            slip, drag = np.where(cones.tangents[i], w[i, 1:], 0), p[i, 1:]
            assert np.hypot(*drag) <= 0.6 * p[i, 0] + 1e-8 * force
            if np.hypot(*slip) > 1e-6 * size and p[i, 0] > 1e-6 * force:
                assert drag == pytest.approx(-0.6 * p[i, 0] * slip / np.hypot(*slip), abs=1e-6 * force)


@pytest.mark.parametrize("count", [6, 8, 16, *deep(3, 12, 24)])
@pytest.mark.parametrize("way", [(0.4, 0, -1.4, 0, 0, 0), (0.3, 0.1, -1, 0.5, 0.2, 0), (0.5, 0.2, -0.5, 1, -2, 10)])
def test_points_alike_on_a_ring_find_their_impulses(count: int, way: tuple[float, ...]) -> None:
    """A disc (m = 2, J = 0.02, 0.02, 0.03) that comes down flat, tilting, and spinning: 3 count unknowns, of rank 6."""
    angle = 2 * np.pi * np.arange(count) / count
    arms = np.stack([np.cos(angle) / 10, np.sin(angle) / 10, np.full(count, -0.05)], axis=1)
    # v + omega x r of unit velocities, the normal first
    turns = np.cross(np.eye(3), arms[:, None]).transpose(0, 2, 1)
    rows = np.concatenate([np.broadcast_to(np.eye(3), turns.shape), turns], axis=2)[:, [2, 0, 1]]
    moved = np.einsum("ian,n,jbn->iajb", rows, 1 / np.array([2, 2, 2, 0.02, 0.02, 0.03]), rows)
    yields = np.einsum("iaia->ia", moved)[:, 0]
    cones = Cones(moved, rows @ np.array(way), np.full(count, 0.4), np.ones((count, 2), dtype=bool), yields)
    p = coulomb(cones)
    assert cones.violation(p) < 1e-12
    assert p[:, 0].sum() == pytest.approx(-2 * way[2])


@pytest.mark.parametrize("seed", [1594, 1, *deep(*range(2, 100))])
def test_points_on_a_line_find_their_forces(seed: int) -> None:
    """Of a body that tips over a bar of its feet: velocities along it and normal to it depend on each other."""
    rng = np.random.default_rng(seed)
    count = int(rng.integers(2, 7))
    arms = np.column_stack([rng.uniform(-0.3, 0.3, count), np.full(count, 0.1), np.full(count, -0.4)])
    rows = np.array([[[*way, *np.cross(arm, way)] for way in np.eye(3)[[2, 0, 1]]] for arm in arms])
    moved = np.einsum("ian,n,jbn->iajb", rows, 1 / np.array([1, 1, 1, 0.02, 0.03, 0.04]), rows)
    b = rows @ np.array([*rng.normal(size=2) * 3, -G, *rng.normal(size=3)])
    yields = np.einsum("iaia->ia", moved)[:, 0]
    cones = Cones(moved, b, np.full(count, 0.6), np.ones((count, 2), dtype=bool), yields)
    assert cones.violation(coulomb(cones)) < 1e-9


def test_pivoting_solves_or_ends_on_a_ray() -> None:
    assert lemke(np.array([[2.0, 1.0], [1.0, 2.0]]), np.array([-5.0, -6.0])) == pytest.approx([4 / 3, 7 / 3])
    with pytest.raises(ArithmeticError, match="Coulomb"):
        lemke(np.array([[-1.0]]), np.array([-1.0]))


def move(contacts: list[Contact], q: list[float], qd: list[float], end: float, gravity: Any = (0, 0, -G)) -> Trajectory:
    model = of("b", block(0.3, 0.2), list(gravity))
    return simulate(model, q, (0, end), qd=qd, kind=TreeMotion(contacts=contacts), outputs=Outputs(count=11))


def broken(motion: Trajectory) -> list[Check]:
    return [check for check in motion.checks if check.holds is False]


def dropped(end: float) -> Trajectory:
    """A ball that reaches the floor after 0.45 s."""
    kind = TreeMotion(contacts=[Contact("floor", "b.body", restitution=0.5)])
    return simulate(of("b", BALL, [0, 0, -G]), [1], (0, end), kind=kind, outputs=Outputs(count=11))


def test_an_impulse_of_the_wrong_sign_is_found(monkeypatch: pytest.MonkeyPatch) -> None:
    assert dropped(0.5).is_right
    monkeypatch.setattr(deciding, "coulomb", lambda cones: -coulomb(cones))
    assert {"impact-energy", "impacts"} <= {check.name for check in broken(dropped(0.5))}


def test_a_gap_that_nobody_sees_closing_is_found(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(contact_motion.ContactMotion, "_gap", lambda *_: lambda *_: 1.0)
    assert [check.name for check in broken(dropped(0.5))] == ["penetration"]


def test_a_friction_cone_that_is_left_out_is_found(monkeypatch: pytest.MonkeyPatch) -> None:
    """Points stick whatever that needs."""

    def rough(cones: Cones) -> Array:
        return coulomb(Cones(cones.A, cones.b, 10 * cones.friction, cones.tangents, cones.yields))

    slope = (G * math.sin(0.5), 0, -G * math.cos(0.5))
    assert move(SLIDING, [0, 0.2, 0], [0, 0, 0], 0.2, slope).is_right
    monkeypatch.setattr(deciding, "coulomb", rough)
    monkeypatch.setattr(deciding.DecidedContacts, "_share", lambda *_: None)
    motion = move(SLIDING, [0, 0.2, 0], [0, 0, 0], 0.2, slope)
    assert [check.name for check in broken(motion)] == ["contacts"]
    impact = move(SLIDING, [0, 0.3, 0.2], [1, 0, 0], 0.3)
    assert "impacts" in {check.name for check in broken(impact)}


@pytest.mark.parametrize(
    ("contact", "pointer", "message"),
    [
        ({"point": "b.bdy"}, "/contacts/0/point", "did you mean 'b.body'"),
        ({"plane": "table"}, "/contacts/0/plane", "unknown frame 'table'"),
        ({"when": "b.z"}, "/contacts/0/when", "not one comparison"),
        ({"when": "b.y > 0"}, "/contacts/0/when", "did you mean 'b.z'"),
    ],
)
def test_what_a_contact_names_has_to_be_there(contact: Any, pointer: str, message: str) -> None:
    contacts = [Contact(**{"name": "floor", "point": "b.body", **contact})]
    with pytest.raises(InvalidArgument, match=message) as caught:
        simulate(of("b", BALL, [0, 0, -G]), [1], (0, 1), kind=TreeMotion(contacts=contacts))
    assert caught.value.faults[0].pointer == pointer


@pytest.mark.parametrize(
    ("contact", "pointer"),
    [
        ({"restitution": 1.1}, "/restitution"),
        ({"friction": -1}, "/friction"),
        ({"rest_velocity": 0}, "/rest_velocity"),
        ({"type": "disc"}, "/type"),
        ({"plane": "b.body"}, "/plane"),
    ],
)
def test_bad_numbers_of_contacts_are_refused(contact: Any, pointer: str) -> None:
    with pytest.raises(InvalidArgument) as caught:
        Contact("floor", "b.body", **contact)
    assert caught.value.faults[0].pointer == pointer


def test_what_contacts_do_not_go_with_is_told() -> None:
    model = of("b", BALL, [0, 0, -G])
    floor = [Contact("floor", "b.body")]

    def refused(place: str, **given: Any) -> None:
        kind = {"contacts": floor, **given.pop("kind", {})}
        with pytest.raises(InvalidArgument) as caught:
            simulate(model, given.pop("q", [1]), (0, 1), kind=TreeMotion(**kind), **given)
        assert caught.value.faults[0].pointer == place

    reset = Event("e", "b.z", direction="falling", reset={"b.z'": 1})
    refused("/method", integrator=Integrator("BDF"))
    refused("/fixed_step", integrator=Integrator(FixedStep(0.01)))
    refused("/events/0/reset", outputs=Outputs(events=[reset]))
    refused("/friction", kind={"friction": "exact"})
    refused("/q", q=[-0.1])
    refused("/contacts/1/name", kind={"contacts": floor * 2})
    late = simulate(model, [-0.1], (0, 1), kind=TreeMotion(contacts=[Contact("f", "b.body", when="t > 5")]))
    assert late.q[-1] == pytest.approx([-0.1 - G / 2])
    assert late.is_right
