"""Analyses of closed trees do not see where the world stands, though decimals leave rows of rounding across a plane."""

# ruff: noqa: N806 -- symbols of the notation

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
from closed_trees import tree_model
from in_depth import deep
from random_trees import Plain
from simulated import simulated

from substructures import Model, equilibria, evaluate, linearise, simulate
from substructures.analysis.closed.loops import loop_state
from substructures.analysis.simulate import ClosedMotion, Outputs
from substructures.mechanics.closure_rows import RowBounds, row_sizes

from .closed_motions import METHODS
from .moved_worlds import motions, moved

INERTIA = {"xx": 0.01, "yy": 0.01, "zz": 0.01}
RIGHT_ANGLE = 1.5707963267948966


def bar(name: str, parent: str, place: Any, length: float, **joint: Any) -> Plain:
    turning = {"type": "revolute", "coordinate": name, "placement": {"position": place}} | joint
    centre = [length / 2, 0, 0]
    return {"name": name, "parent": parent, "mass": 1, "com": centre, "inertia": INERTIA, "joint": turning}


def linkage(bodies: list[Plain], closures: dict[str, tuple[str, str]], kind: str, **more: Any) -> tuple[Plain, Plain]:
    """Plane bodies, each chain from the base a part of its own, whose tips are ports; ``closures``: tied bodies."""
    chains: dict[str, list[Plain]] = {}
    of = {}
    for body in bodies:
        of[body["name"]] = root = of.get(body["parent"], body["name"])
        chains.setdefault(root, []).append(body)
    definitions, instances = {}, []
    for root, chain in chains.items():
        ends = [{"name": f"{b['name']}_end", "body": b["name"], "position": [2 * b["com"][0], 0, 0]} for b in chain]
        place = chain[0]["joint"].pop("placement")
        definitions[root] = {"name": root, "bodies": chain, "ports": ends}
        instances.append({"name": f"on_{root}", "substructure": root, "placement": place})
    ties = [
        {"name": name, "type": kind, "from": f"on_{of[a]}.{a}_end", "to": f"on_{of[b]}.{b}_end"} | more
        for name, (a, b) in closures.items()
    ]
    return {"gravity": [0, -9.81, 0], "instances": instances, "closures": ties}, definitions


def four_bar_links() -> list[Plain]:
    return [bar("a", "base", [0, 0, 0], 0.1), bar("b", "a", [0.1, 0, 0], 0.35), bar("c", "base", [0.4, 0, 0], 0.25)]


def four_bar(kind: str) -> tuple[Plain, Plain]:
    return linkage(four_bar_links(), {"pin": ("b", "c")}, kind)


def two_loops() -> tuple[Plain, Plain]:
    bodies = [*four_bar_links(), bar("d", "c", [0.2, 0, 0], 0.4), bar("e", "base", [0.9, 0, 0], 0.3)]
    return linkage(bodies, {"pin": ("b", "c"), "other": ("d", "e")}, "pin")


def cranks_on_a_rod() -> tuple[Plain, Plain]:
    bodies = [bar("a", "base", [0, 0, 0], 0.2), bar("b", "base", [0.3, 0, 0], 0.25)]
    return linkage(bodies, {"rod": ("a", "b")}, "rod", length=0.3)


def slider_crank(angle: Any) -> tuple[Plain, Plain]:
    """Crank and rod of one part, a piston of another, each turned by a right ``angle``."""
    crank = [
        bar("q1", "base", [0, 0, 0], 0.2),
        bar("q2", "q1", [0, 0, 0], 0.6) | {"joint": {"type": "revolute", "coordinate": "q2", "d": 0.25}},
    ]
    piston = {"name": "piston", "parent": "base", "mass": 1, "inertia": INERTIA}
    piston["joint"] = {"type": "prismatic", "coordinate": "x"}
    ports = [{"name": "tip", "body": "q2", "position": [0.6, 0, 0]}]
    definitions = {
        "arms": {"name": "arms", "bodies": crank, "ports": ports},
        "slide": {"name": "slide", "bodies": [piston]},
    }
    instances = [
        {"name": "one", "substructure": "arms", "placement": {"rpy": [angle, 0, 0.3]}},
        {"name": "two", "substructure": "slide", "placement": {"rpy": [0, angle, 0.3]}},
    ]
    ball = {"name": "c", "type": "ball", "from": "one.tip", "to": "two.piston"}
    return {"gravity": [0, 0, -9.81], "instances": instances, "closures": [ball]}, definitions


SLIDER = [1.0102173524509361, -1.3708804650658368, 0.6943169742238795]
FRICTION = {"friction": {"coulomb": 0.1, "velocity": 0.01}}
TREES: dict[str, tuple[tuple[Plain, Plain], list[float]]] = {
    **{kind: (four_bar(kind), [0.7, 0.2, 1.2]) for kind in ("pin", "ball", "cylindrical", "universal", "planar")},
    "two loops": (two_loops(), [0.7, 0.2, 1.2, -1, 1.2]),
    "rod": (cranks_on_a_rod(), [0.9, 1.1]),
    "slider-crank": (slider_crank(RIGHT_ANGLE), SLIDER),
}


def pairs(name: str) -> tuple[Model, list[Model], list[float]]:
    (document, definitions), q = TREES[name]
    others = [tree_model(moved(document, motion), definitions) for motion in motions(len(name), 2)]
    return tree_model(document, definitions), others, q


@pytest.mark.parametrize("name", TREES)
def test_what_moves_and_what_holds(name: str) -> None:
    here, others, q = pairs(name)
    expected = loop_state(here, q)
    assert expected.is_right, expected
    state = expected.consistent.q
    for model in others:
        found = loop_state(model, q)
        assert found.is_right, found
        assert found.mobility.rank == expected.mobility.rank
        assert found.mobility.independent_coordinates == expected.mobility.independent_coordinates
        np.testing.assert_allclose(found.consistent.q, state, atol=1e-12)
        np.testing.assert_allclose(found.qdd, expected.qdd, rtol=1e-9, atol=1e-9)
        for one, other in zip(found.reactions, expected.reactions, strict=True):
            np.testing.assert_allclose([one.force, one.moment], [other.force, other.moment], rtol=1e-9, atol=1e-9)
        evaluated = evaluate(model, ["forward_dynamics"], q=state)
        np.testing.assert_allclose(evaluated["forward_dynamics"], expected.qdd, rtol=1e-9, atol=1e-9)


@pytest.mark.parametrize(
    ("name", "reduction"),
    [("pin", "projection"), ("slider-crank", "partitioning"), *deep(*((n, r) for n in TREES for r in METHODS))],
)
def test_motions(name: str, reduction: Any) -> None:
    here, others, q = pairs(name)
    expected = simulate(here, q, (0, 0.1), kind=ClosedMotion(reduction=reduction), outputs=Outputs(count=3))
    assert expected.is_right, expected.message
    for model in others:
        found = simulate(model, q, (0, 0.1), kind=ClosedMotion(reduction=reduction), outputs=Outputs(count=3))
        assert found.is_right, found.message
        np.testing.assert_allclose(found.q, expected.q, atol=1e-8)


@pytest.mark.parametrize("name", ["pin", *deep("two loops")])
def test_motions_with_given_cranks_and_with_friction(name: str) -> None:
    (document, definitions), q = TREES[name]
    part = definitions["a"]
    first = part["bodies"][0]
    rough = definitions | {"a": part | {"bodies": [first | {"joint": first["joint"] | FRICTION}, *part["bodies"][1:]]}}
    for request in ({"prescribed": {"on_a.a": "0.7+3*t"}}, {"friction": "exact"}):
        worlds = [document, *(moved(document, motion) for motion in motions(4, 1))]
        runs = [simulated(tree_model(world, rough), q, (0, 0.1), count=3, **request) for world in worlds]
        for found in runs:
            assert found.is_right, found.message
            np.testing.assert_allclose(found.q, runs[0].q, atol=1e-8)
            np.testing.assert_allclose(found.series["actuation"], runs[0].series["actuation"], rtol=1e-6, atol=1e-8)


@pytest.mark.parametrize("name", ["pin", *deep(*(name for name in TREES if name != "pin"))])
def test_equilibria_and_their_vibrations(name: str) -> None:
    here, others, _ = pairs(name)
    expected = equilibria(here, count=6)
    assert expected.is_right
    assert len(expected.found) > 1
    for model in others:
        found = equilibria(model, count=6)
        assert found.is_right
        assert [one.verdict for one in found.found] == [one.verdict for one in expected.found]
        for one, other in zip(found.found, expected.found, strict=True):
            np.testing.assert_allclose(one.q, other.q, atol=1e-9)
            np.testing.assert_allclose(one.at.A, other.at.A, rtol=1e-7, atol=1e-7)


def test_a_linearised_motion() -> None:
    here, others, q = pairs("two loops")
    state = loop_state(here, q, qd=[3, 0, 0, 0, 0], fixed=["on_a.a"]).consistent
    expected = linearise(here, state.q, qd=state.qd)
    assert expected.status == "finished"
    assert len(expected.A) == 2
    for model in others:
        np.testing.assert_allclose(linearise(model, state.q, qd=state.qd).A, expected.A, rtol=1e-8, atol=1e-7)


@pytest.mark.parametrize("angle", ["pi/2", RIGHT_ANGLE])
def test_a_slider_crank_falls_however_its_mounting_is_written(angle: Any) -> None:
    """q(0.1 s) by an independent integration of the one equation that is left."""
    model = tree_model(*slider_crank(angle))
    found = loop_state(model, SLIDER)
    assert (found.mobility.rank, found.mobility.degrees_of_freedom, found.mobility.dependent) == (2, 1, ("c.z",))
    np.testing.assert_allclose(found.qdd, [-7.84306, 9.70002, 2.05385], atol=1e-5)
    motion = simulate(model, SLIDER, (0, 0.1), outputs=Outputs(count=2))
    assert motion.is_right
    np.testing.assert_allclose(motion.q[-1], [0.970282, -1.321209, 0.704699], atol=1e-6)


def test_rows_of_rounding_are_as_long_as_the_geometry_allows() -> None:
    """A row of 1e-17 beside columns of 2 m is none; one of 1e-9 beside columns of 1e-9 m is one, whatever is long."""

    def look(q: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        G = np.array([[1e-17, 0.0], [1e-9, 1e-17]])
        return np.tile(G, (len(q), 1, 1)), np.tile([3e-17, 2e-9], (len(q), 1))

    def bounds(q: np.ndarray) -> RowBounds:
        columns = np.array([[2.0, 0.0], [1e-9, 1.0]])
        return RowBounds(np.tile(columns, (len(q), 1, 1)), np.tile([5.0, 1.0], (len(q), 1)))

    found = row_sizes("RP", np.zeros((1, 2)), look, bounds)
    np.testing.assert_allclose(found.reach[0], [2, 1e-9])
    np.testing.assert_allclose(found.width[0], [5, 2e-9])
