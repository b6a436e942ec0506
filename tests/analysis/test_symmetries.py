"""First integrals of directions across the coordinates: screws, gears, bodies that move together."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
from analysis_models import catalogue_model, values_at
from independent import value
from random_trees import Plain, model_of, random_states

from substructures import Definition, Model, TreeSpec, couple, derive
from substructures.analysis.equations.first_integrals import first_integrals
from substructures.analysis.equations.integral import FirstIntegrals, Integral
from substructures.analysis.simulate import Outputs, simulate
from substructures.expr.interpret import interpret
from substructures.quantities.numbers.evaluation import evaluate

AT = {"p": 0.5}
PARAMETERS = {"m": {"value": 1.3}, "p": {"value": 0.5}, "k": {"value": 3}}


def two(*loads: Plain, gravity: float = 0) -> Model:
    """A mass m on the vertical x, and a turning one on y, with the inertia of its mass off the axis."""
    bodies: list[Plain] = [
        {"name": "a", "parent": "base", "mass": "m", "joint": {"type": "prismatic", "coordinate": "x"}},
        {
            "name": "b",
            "parent": "base",
            "mass": 2,
            "com": [0.3, 0, 0],
            "inertia": {"xx": 1, "yy": 1, "zz": 1},
            "joint": {"type": "revolute", "coordinate": "y"},
        },
    ]
    return model_of({"name": "a", "bodies": bodies, "loads": list(loads), "parameters": PARAMETERS}, (0, 0, -gravity))


def potential(text: str) -> Plain:
    return {"type": "potential", "potential": text}


def symmetries(found: FirstIntegrals) -> dict[str, Integral]:
    return {i.name: i for i in found.integrals if i.kind == "symmetry"}


def assert_constant(model: Model, found: FirstIntegrals, name: str) -> None:
    """Derivative along the equations of motion at random states, by central differences."""
    h, x = 1e-4, random_states(np.random.default_rng(1), 4, model.dof)
    qdd = evaluate(model, ["forward_dynamics"], q=x["q"], qd=x["qd"])["forward_dynamics"]
    ends = []
    for step in (h, -h):
        q, qd = x["q"] + step * x["qd"] + step * step / 2 * qdd, x["qd"] + step * qdd
        ends.append(interpret(found.program, values_at(model, q, qd), [name])[name])
    assert np.abs(ends[0]).max() > 0.1
    np.testing.assert_allclose((ends[0] - ends[1]) / (2 * h), 0, atol=1e-6)


@pytest.mark.parametrize(
    ("text", "direction"),
    [
        ("k*(x - p*y)^2", {"x.x": "p", "x.y": "1"}),
        ("k*(x - 2*y)^2", {"x.x": "2", "x.y": "1"}),
        ("k*cos(3*x + y/p)", {"x.x": "-1", "x.y": "3*p"}),
        ("k*cos((1 + p)*x + y)", {"x.x": "-1", "x.y": "p + 1"}),
    ],
)
def test_a_force_that_knows_one_combination_only(text: str, direction: dict[str, str]) -> None:
    """V(x - p y): a nut on its screw is free along it, c = (p, 1); a ratio of gears in general."""
    model = two(potential(text))
    found = first_integrals(model)
    (only,) = symmetries(found).values()
    x, y = (value(only.direction[name], AT) for name in ("x.x", "x.y"))
    wanted = [value(direction[name], AT) for name in ("x.x", "x.y")]
    np.testing.assert_allclose(x * wanted[1], y * wanted[0])
    assert found.cyclic == ()
    assert_constant(model, found, only.name)
    motion = simulate(model, [0.3, 0.4], (0, 2), qd=[1.0, -0.5], outputs=Outputs(count=3))
    assert motion.is_right
    assert only.name in {c.name for c in motion.checks}


@pytest.mark.parametrize(
    "loads",
    [
        [potential("k*(x - y^2)^2")],
        [potential("k*(x - p*y)^2 + m*x")],
        [potential("k*(x - p*y)^2"), {"type": "joint", "coordinate": "x", "force": "-x'"}],
        [potential("k*(x - p*y)^2 + k*cos(t)*x")],
    ],
)
def test_what_is_not_free(loads: list[Plain]) -> None:
    """A bent combination, a force along it, a damper against the world, a force in time."""
    assert symmetries(first_integrals(two(*loads))) == {}


def test_a_damper_between_both_leaves_the_momentum() -> None:
    loads = [
        {"type": "joint", "coordinate": "x", "force": "-(x' - p*y')"},
        {"type": "joint", "coordinate": "y", "force": "p*(x' - p*y')"},
    ]
    found = first_integrals(two(*loads))
    assert {i.kind: i.rule for i in found.integrals} == {
        "energy": "falling",
        "symmetry": "constant",
        "linear": "constant",
    }


def test_a_pitch_of_zero_is_no_infinite_direction() -> None:
    """Directions do not divide by parameters."""
    model = two(potential("k*(x - y/(1 + p))^2"))
    (only,) = symmetries(first_integrals(model)).values()
    assert only.direction == {"x.x": "1", "x.y": "1 + p"}
    screw = two(potential("k*(x - p*y)^2"))
    motion = simulate(screw, [0.3, 0.4], (0, 1), qd=[1.0, -0.5], parameters={"p": 0.0})
    assert motion.is_right


def test_a_screw_in_the_field_of_gravity_is_none() -> None:
    """Until a weight on the other coordinate balances it."""
    assert symmetries(first_integrals(two(potential("k*(x - p*y)^2"), gravity=9.81))) == {}
    balanced = two(potential("k*(x - p*y)^2 - 9.81*m*p*y"), gravity=9.81)
    assert len(symmetries(first_integrals(balanced))) == 1


def rails(closed: bool) -> Model:
    """Two carts on parallel rails with a spring between them, also with a rod; coordinates are those of the rails."""
    cart: Plain = {
        "name": "cart",
        "bodies": [{"name": "c", "parent": "base", "mass": "m", "joint": {"type": "prismatic", "coordinate": "s"}}],
        "parameters": {"m": {"value": 2}},
    }
    instances = [
        {"name": "a", "definition": cart, "placement": {"rpy": [0, "pi/2", 0]}},
        {"name": "b", "definition": cart, "placement": {"position": [0, 1, 0], "rpy": [0, "pi/2", 0]}},
    ]
    rod = {"name": "rod", "type": "rod", "from": "a.c", "to": "b.c", "length": 2}
    spec = {"name": "t", "gravity": [0, 0, -9.81], "instances": instances, "closures": [rod] if closed else []}
    part = derive(Definition.read(cart))
    return couple(TreeSpec.read(spec), {"a": part, "b": part})


def test_what_is_known_as_a_momentum_is_told_once() -> None:
    """A rod keeps both carts together: they move freely along the rails, which is the linear momentum along x."""
    found = first_integrals(rails(closed=True))
    assert found.cyclic == ()
    assert symmetries(found) == {}
    (momentum,) = (i for i in found.integrals if i.kind == "linear_momentum")
    assert momentum.name == "linear_momentum.x"
    assert "the closures 'rod' do not change either" in momentum.reason
    assert first_integrals(rails(closed=False)).cyclic == ("a.s", "b.s")


@pytest.mark.parametrize("name", ["puma560", "double-pendulum", "quarter-car", "trolley-crane", "flyball-governor"])
def test_no_machine_has_one_by_chance(name: str) -> None:
    assert symmetries(first_integrals(catalogue_model(name))) == {}


def test_springs_with_roots_are_looked_at_too() -> None:
    """Bodies at the ends of a spring of rest length 0.5 on parallel slides: c = (1, 1), with a square root in Q."""
    slide: Plain = {"type": "prismatic", "theta": 0.4}
    bodies: list[Plain] = [
        {"name": "a", "parent": "base", "mass": "m", "joint": slide | {"coordinate": "x"}},
        {"name": "b", "parent": "base", "mass": 2, "joint": slide | {"coordinate": "y"}},
    ]
    spring: Any = {"type": "spring", "from": {"body": "a", "at": [1, 0, 0]}, "to": {"body": "b"}}
    definition: Plain = {"name": "a", "bodies": bodies, "parameters": PARAMETERS}
    definition["loads"] = [spring | {"stiffness": "k", "length": 0.5}]
    found = first_integrals(model_of(definition, (0, 0, 0)))
    (only,) = symmetries(found).values()
    assert only.direction == {"x.x": "1", "x.y": "1"}
