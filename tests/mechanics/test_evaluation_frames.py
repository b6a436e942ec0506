"""Metric and Christoffel symbols are the same in all evaluation frames, and the chosen ones need few operations."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
from random_trees import Kind, Plain, random_definition
from serial_chains import IIWA, RX90, SIX, SIX14, revolute

from substructures import Definition, TreeSpec, couple, derive
from substructures.expr.interpret import interpret
from substructures.expr.program import Formulas, program
from substructures.mechanics.composite_form import composites, joint_momentum
from substructures.mechanics.evaluation_frames import InertialEntries
from substructures.mechanics.frame_choice import evaluation_frames
from substructures.mechanics.kinematics import Link, base_functions, links, path
from substructures.mechanics.linear3 import Planar, Rotation, Turn
from substructures.part import formulas
from substructures.part.mechanism import Mechanism, mechanism

from .catalogue_cuts import bare

MANY = Kind(7, joints=("revolute", "prismatic", "universal", "fixed"), depth=8)
EQUATIONS = ("metric", "christoffel")


def entries(m: Mechanism, frames: list[int], values: dict[str, Any]) -> dict[str, Any]:
    """Metric and Christoffel symbols in the frames given, in numbers."""
    chain, n = links(m.joints), len(m.joints)
    carried = composites(m.joints, m.own)
    found = InertialEntries(chain, base_functions(chain), frames)
    g: dict[tuple[int, ...], Any] = {}
    gamma: dict[tuple[int, ...], Any] = {}
    for c, joint in enumerate(m.joints):
        momentum = joint_momentum(joint.s, carried[c])
        g |= found.metric(c, momentum)
        gamma |= found.christoffel(c, momentum)
    outputs = {"metric": Formulas((n, n), g, "symmetric"), "christoffel": Formulas((n,) * 3, gamma, "christoffel")}
    made = program(m.graph, outputs, m.scope.symbols)
    return interpret(made, {symbol.name: values[symbol.name] for symbol in made.symbols})


def any_frames(rng: np.random.Generator, chain: tuple[Link, ...]) -> list[int]:
    """Any carrier on the path of every joint."""
    return [int(rng.choice(path(chain, c))) for c in range(len(chain))]


@pytest.mark.parametrize("seed", range(6))
def test_all_frames_give_the_same_functions(seed: int) -> None:
    rng = np.random.default_rng(seed)
    m = mechanism(Definition.read(random_definition(rng, MANY)))
    chain = links(m.joints)
    values = {name: rng.uniform(-1, 1, 3) for name in m.scope.symbols}
    own = entries(m, list(range(len(chain))), values)
    for _ in range(4):
        other = entries(m, any_frames(rng, chain), values)
        for name, expected in own.items():
            assert np.abs(other[name] - expected).max(initial=0) < 1e-12 * max(1.0, np.abs(expected).max(initial=0))


@pytest.mark.parametrize("axis", range(3))
def test_matrices_are_turned_from_both_sides(axis: int) -> None:
    """E^T t E, of a matrix that is not symmetric, about every axis and by factors."""
    rng = np.random.default_rng(axis)
    t = rng.uniform(-1, 1, (3, 3))
    factors = Planar(axis, np.cos(0.7), np.sin(0.7)), Planar((axis + 2) % 3, np.cos(0.4), np.sin(0.4))
    for rotation in (Rotation(factors[:1]), Rotation(factors), Rotation((Turn(Rotation(factors).matrix()),))):
        back = np.array(rotation.matrix())
        assert np.allclose(rotation.back_matrix(tuple(map(tuple, t.tolist()))), back.T @ t @ back, rtol=0, atol=1e-14)


@pytest.mark.parametrize("seed", range(8))
def test_chosen_frames_are_on_the_path_and_nested(seed: int) -> None:
    m = mechanism(Definition.read(random_definition(np.random.default_rng(seed), MANY)))
    chain = links(m.joints)
    for christoffel in (True, False):
        frames = evaluation_frames(chain, christoffel)
        for c, e in enumerate(frames):
            assert e in path(chain, c)
            assert chain[c].parent < 0 or frames[chain[c].parent] <= e


@pytest.mark.parametrize(
    ("rows", "metric", "both"),
    [(RX90, 224, 476), (IIWA, 287, 911), (SIX14, 534, 1200), (SIX, 653, 1490)],
    ids=["rx90", "iiwa", "6r with 14 parameters", "6r"],
)
def test_operations_per_state(rows: list[Plain], metric: int, both: int) -> None:
    """In the frames of the joints these are 293 and 650, 442 and 1316, 596 and 1316, 760 and 1571."""
    program = derive(revolute(rows)).program
    assert program.count(["metric"], per_state=True)["total"] <= metric
    assert program.count(EQUATIONS, per_state=True)["total"] <= both


def test_parts_that_are_stored_in_the_frames_of_their_joints_are_coupled(monkeypatch: pytest.MonkeyPatch) -> None:
    """As those of older versions are: more operations, the same functions."""
    new = derive(Definition.read(bare("puma560")))
    with monkeypatch.context() as patch:
        patch.setattr(formulas, "evaluation_frames", lambda chain, _: range(len(chain)))
        old = derive(Definition.read(bare("puma560")))
    assert old.program.digest != new.program.digest
    spec = {"name": "tree", "instances": [{"name": "arm", "substructure": "puma560", "at": "world"}]}
    counts = [couple(TreeSpec.read(spec), {"arm": part}).operations["metric"] for part in (old, new)]
    assert counts[1] < counts[0]
