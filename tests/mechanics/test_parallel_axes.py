"""Runs of parallel axes by absolute angles: the same functions as in evaluation frames, in fewer operations."""

from __future__ import annotations

import copy
import json
import re
from dataclasses import replace
from typing import Any

import numpy as np
import pytest
from random_cuts import all_cuts, owners
from random_trees import Plain

from benchmarks.operations import chain as on_the_ground
from substructures import Definition, Model, TreeSpec, couple, derive
from substructures.expr.hoist import hoisted
from substructures.expr.program import Program
from substructures.mechanics.composite_form import (
    Inertia,
    about_one_direction,
    composites,
    joint_momentum,
    with_moments_about_axes,
)
from substructures.mechanics.evaluation_frames import InertialEntries
from substructures.mechanics.kinematics import INTERFACE, Link, OneDofJoint, base_functions, links, path
from substructures.mechanics.linear3 import Planar, Rotation, Turn
from substructures.mechanics.parallel_axes import MOST, ParallelAxes, absolute
from substructures.part.mechanism import mechanism
from substructures.part.one_piece import derive_in_one_piece

EQUATIONS = ("metric", "christoffel")
GRAVITY = ["2*g", "-g", "g/3"]


def turn(angle: float) -> Planar:
    return Planar(2, float(np.cos(angle)), float(np.sin(angle)))


def random_tree(rng: np.random.Generator, n: int, tilted: bool) -> tuple[list[OneDofJoint], list[Inertia]]:
    """Joints of both kinds in numbers, branches among them; ``tilted``: some axes are not parallel."""
    joints, bodies = [], []
    for k in range(n):
        parent = int(rng.integers(max(k - 2, -1), k)) if k else INTERFACE
        s, q, psi = int(rng.random() < 0.25), rng.uniform(-2, 2), rng.uniform(-2, 2)
        factors = [turn(psi)] if s else [turn(psi + q)]
        if tilted and rng.random() < 0.4:
            factors = [Planar(0, np.cos(psi), np.sin(psi)), turn(q)]
        x, y, z = rng.uniform(-1, 1, 3)
        joints.append(OneDofJoint(parent, s, Rotation(tuple(factors)), (x, y, z), q if s else rng.uniform(-1, 1)))
        m, *rest = rng.uniform(0.5, 2, 10)
        bodies.append(Inertia(m, tuple(rest[:3]), tuple(rest[3:])))
    return joints, bodies


def axes_of(joints: list[OneDofJoint], bodies: list[Inertia]) -> ParallelAxes:
    chain = links(joints)
    return ParallelAxes(chain, lambda k: bodies[k].shifted((0, 0, chain[k].tau)))


def turned_over(rng: np.random.Generator, joints: list[OneDofJoint]) -> list[OneDofJoint]:
    """The same with some axes in the opposite direction, and one that slides anywhere before the first ones."""
    slide = OneDofJoint(INTERFACE, 1, Rotation((Planar(0, 0.6, 0.8),)), (0, 0, 0), 0.3)
    half = Planar(0, -1, 0)
    return [slide] + [
        replace(
            joint,
            parent=joint.parent + 1,
            rotation=Rotation((half, *joint.rotation.factors)) if rng.random() < 0.5 else joint.rotation,
        )
        for joint in joints
    ]


@pytest.mark.parametrize("seed", range(12))
def test_moments_about_axes_by_their_sums(seed: int) -> None:
    """J_xx + J_yy from the axis beyond, in whatever direction, is the sum of the two."""
    rng = np.random.default_rng(seed)
    joints, bodies = random_tree(rng, 7, tilted=seed % 2 == 1)
    joints, bodies = turned_over(rng, joints), [bodies[0], *bodies]
    chain, carried, parallel = links(joints), composites(joints, bodies), about_one_direction(joints)
    assert not any(parallel[k] for k, joint in enumerate(joints) if joint.parent <= 0 and joints[joint.parent].s)
    apart = [replace(carried[k], polar=None) for k in range(len(joints))]
    again = with_moments_about_axes(chain, apart, lambda k: bodies[k].shifted((0, 0, chain[k].tau)))
    assert any(parallel) or seed % 2
    for k in range(len(joints)):
        x, y = carried[k].J[:2]
        assert carried[k].about_third_axis == pytest.approx(x + y, rel=1e-12)
        assert again[k].about_third_axis == pytest.approx(x + y, rel=1e-12)
        summed = any(parallel[c] for c, joint in enumerate(joints) if joint.parent == k)
        assert (again[k].polar is not None) == (carried[k].polar is not None) == summed


@pytest.mark.parametrize(
    ("tilt", "keeps"),
    [(Planar(0, -1, 0), True), (Planar(0, 0, 1), False), (Turn(((0, 1, 0), (1, 0, 0), (0, 0, -1))), True)],
)
def test_axes_in_opposite_directions_are_parallel(tilt: Planar | Turn, keeps: bool) -> None:
    assert Rotation((tilt, turn(0.3))).keeps_line_of_third_axis == keeps
    assert Rotation((turn(0.3),)).keeps_line_of_third_axis


@pytest.mark.parametrize("seed", range(12))
def test_metric_and_christoffel_symbols_in_numbers(seed: int) -> None:
    joints, bodies = random_tree(np.random.default_rng(seed), 7, tilted=False)
    chain, carried = links(joints), composites(joints, bodies)
    by_angles = axes_of(joints, bodies).by_angles(frozenset(range(len(chain))), True)
    entries = InertialEntries(chain, base_functions(chain), range(len(chain)))
    g: dict[Any, Any] = {}
    gamma: dict[Any, Any] = {}
    for c, joint in enumerate(joints):
        momentum = joint_momentum(joint.s, carried[c])
        g |= entries.metric(c, momentum)
        gamma |= entries.christoffel(c, momentum)
    for expected, found in ((g, by_angles.metric), (gamma, by_angles.christoffel)):
        assert found.keys() == expected.keys()
        assert [found[i] for i in expected] == pytest.approx(list(expected.values()), rel=0, abs=1e-12)


@pytest.mark.parametrize("tilted", [False, True])
@pytest.mark.parametrize("seed", range(12))
def test_gravity_in_numbers(seed: int, tilted: bool) -> None:
    rng = np.random.default_rng(seed)
    joints, bodies = random_tree(rng, 9, tilted)
    chain, carried = links(joints), composites(joints, bodies)
    gamma = {INTERFACE: tuple(rng.uniform(-9, 9, 3))}
    for k, link in enumerate(chain):
        gamma[k] = link.rotation.forward(gamma[link.parent])
    momenta = [joint_momentum(joint.s, carried[k]) for k, joint in enumerate(joints)]
    before = dict.fromkeys(range(len(chain)), gamma[INTERFACE])
    by_angles = axes_of(joints, bodies).by_angles(frozenset(), False, before)
    found = by_angles.gravity([gamma[k] for k in range(len(chain))], momenta)
    expected = [np.dot(gamma[k], momentum.p) for k, momentum in enumerate(momenta)]
    assert found == pytest.approx(expected, rel=0, abs=1e-12)
    assert tilted or len(by_angles.lumps) == sum(not link.s for link in chain) - len(alone(chain))


def alone(chain: tuple[Link, ...]) -> list[int]:
    """Revolute joints without another one in their run, all axes being parallel."""
    turning = [[a for a in path(chain, k) if not chain[a].s] for k in range(len(chain))]
    return [k for k, link in enumerate(chain) if not link.s and all(x in ([], [k]) for x in turning if not x or k in x)]


# --- formulas of trees of parts


def planar(parents: list[int], prismatic: tuple[int, ...] = (), above: tuple[Plain, ...] = ()) -> Plain:
    """A tree of parallel axes with offsets of angles and ten parameters of inertia; ``above``: joints of a chain on
    its last body, about other axes.
    """
    joints = [
        {
            "type": "prismatic" if k in prismatic else "revolute",
            "d": f"l{k}" if k else 0,
            "phi": f"p{k}" if k % 2 else 0,
        }
        for k in range(len(parents))
    ]
    parents = [*parents, *range(len(parents) - 1, len(parents) + len(above) - 1)]
    bodies, used = [], set[str]()
    for k, joint in enumerate([*joints, *above]):
        com, tensor = [f"c{x}{k}" for x in "xyz"], {x: f"I{x}{k}" for x in ("xx", "yy", "zz", "xy", "xz", "yz")}
        body = {"name": f"b{k}", "parent": f"b{parents[k]}" if parents[k] >= 0 else "base"}
        body |= {"joint": {"coordinate": f"q{k}", **joint}, "mass": f"m{k}", "com": com}
        bodies.append(body | {"inertia": tensor | {"about": "origin"}})
        used |= {f"m{k}", *com, *tensor.values(), *(x for x in joint.values() if re.fullmatch(r"[a-z]\d", str(x)))}
    return {"name": "planar", "parameters": {x: {} for x in sorted(used)}, "bodies": bodies}


def in_pieces(definition: Plain, cut: tuple[str, ...], group: bool = False) -> Model:
    """The mechanism with the bodies of a cut as roots of parts of their own, under gravity."""
    owner = owners(definition, cut)
    host = {
        owner[b["name"]]: f"{owner[b['parent']]}.{b['parent']}"
        for b in definition["bodies"]
        if b["name"] in cut and b["parent"] != "base"
    }
    instances, parts = [], {}
    for name in dict.fromkeys(owner[b["name"]] for b in definition["bodies"]):
        bodies = [copy.deepcopy(b) for b in definition["bodies"] if owner[b["name"]] == name]
        for body in bodies:
            body["parent"] = "base" if body["name"] in cut else body["parent"]
        used = sorted(set(re.findall(r"[A-Za-z_]\w*", json.dumps(bodies))) & definition["parameters"].keys())
        text = {"name": name.replace("_", "-"), "parameters": {x: {} for x in used}, "bodies": bodies}
        parts[name] = derive(Definition.read(text))
        instance = {"name": name, "substructure": text["name"], "at": host.get(name, "world")}
        instances.append(instance | {"parameters": {x: x for x in used}})
    parameters = definition["parameters"] | {"g": {}}
    tree = {"name": "tree", "gravity": GRAVITY, "parameters": parameters, "instances": instances}
    return couple(TreeSpec.read(tree), parts, group=group)


def counted(program: Program) -> list[int]:
    return [
        hoisted(program.select(names)).count(per_state=True)["total"]
        for names in (["metric"], ["christoffel"], EQUATIONS, ["gravity"])
    ]


def in_one_piece(definition: Plain) -> Program:
    whole = Definition.read(definition | {"parameters": definition["parameters"] | {"g": {}}})
    return derive_in_one_piece(whole, (GRAVITY[0], GRAVITY[1], GRAVITY[2]))


WRIST = ({"type": "revolute", "theta": "pi/2", "d": "a1"}, {"type": "revolute", "theta": "-pi/2", "tau": "a2"})
SHAPES = {
    "chain": planar([-1, 0, 1, 2]),
    "branched": planar([-1, 0, 0, 1, 1]),
    "with slides": planar([-1, 0, 1, 2], prismatic=(2,)),
    "on a slide": planar([-1, 0, 1], prismatic=(0,)),
    "longer than the price allows": planar([-1, 0, 1, 2, 3]),
    "with a wrist": planar([-1, 0, 1], above=WRIST),
}


@pytest.mark.parametrize("name", SHAPES)
def test_no_cut_costs_more_than_one_piece(name: str) -> None:
    """Every model is compared with what it has to be, computed from the documents alone, when it is coupled."""
    definition = SHAPES[name]
    whole = counted(in_one_piece(definition))
    cuts = list(all_cuts(definition))
    for cut in [cuts[i] for i in np.random.default_rng(2).permutation(len(cuts))[:5]]:
        found = counted(in_pieces(definition, cut).program)
        assert all(x <= y for x, y in zip(found, whole, strict=True)), (cut, found, whole)


@pytest.mark.parametrize("cut", [(), ("b2",), ("b1", "b2", "b3")])
def test_base_parameters_leave_the_functions(cut: tuple[str, ...]) -> None:
    whole, model = counted(in_one_piece(SHAPES["chain"])), in_pieces(SHAPES["chain"], cut, group=True)
    assert all(x <= y for x, y in zip(counted(model.program), whole, strict=True))


def test_parts_turned_on_each_other() -> None:
    """By a parameter, so that no sum of angles is written in the stored formulas; the certificate compares numbers."""
    arm = derive(Definition.read(planar([-1, 0])))
    instances = [
        {"name": "a", "substructure": "planar", "at": "world"},
        {"name": "b", "substructure": "planar", "at": "a.b1", "placement": {"rpy": [0, 0, "yaw"]}},
        {"name": "c", "substructure": "planar", "at": "a.b0", "placement": {"rpy": ["pi/2", 0, "yaw"]}},
    ]
    for chosen in (instances[:2], instances):
        tree = {"name": "tree", "gravity": GRAVITY, "parameters": {"yaw": {}, "g": {}}, "instances": chosen}
        assert couple(TreeSpec.read(tree), {each["name"]: arm for each in chosen}).certificate


@pytest.mark.parametrize(
    ("name", "metric", "christoffel", "gravity"),
    [("planar4", 36, 27, 18), ("planar4x", 24, 15, 10), ("planar8", 221, 193, 38), ("planar8x", 205, 177, 22)],
)
def test_operations_per_state(name: str, metric: int, christoffel: int, gravity: int) -> None:
    """In evaluation frames and by composites planar4 has 52, 40 and 56, and 124 for gravity of planar8."""
    found = counted(on_the_ground(name, True).program)
    assert found[:2] == [metric, christoffel]
    assert found[3] == gravity


def test_where_absolute_angles_are_chosen() -> None:
    def chosen(definition: Plain) -> int:
        return len(absolute(links(mechanism(Definition.read(definition)).joints)))

    assert chosen(planar([-1])) == 0
    assert chosen(planar(list(range(-1, MOST - 1)))) == MOST
    assert chosen(planar(list(range(-1, MOST)))) == 0
    assert chosen(SHAPES["with slides"]) == 4
    assert chosen(SHAPES["with a wrist"]) == 0
