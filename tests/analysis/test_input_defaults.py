"""Inputs with a default: everything is as if they were given so, and as if they had none where another is given."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np
import pytest
from simulated import simulated

from substructures import Definition, Model, Part, TreeSpec, couple, derive
from substructures.analysis.closed.loops import loop_state
from substructures.analysis.control.cost_gradient import cost_gradient
from substructures.analysis.control.from_fields import control_arguments
from substructures.analysis.control.problem import Cost
from substructures.analysis.equations.first_integrals import first_integrals
from substructures.analysis.equations.routh import routh
from substructures.analysis.from_fields import sensitivity_arguments
from substructures.analysis.motion.parameter_sensitivity import sensitivities
from substructures.analysis.simulate import KnifeEdge, Outputs, simulate
from substructures.analysis.stability.equilibria import equilibria
from substructures.analysis.stability.linearise import linearise
from substructures.analysis.stability.root_locus import root_locus
from substructures.analysis.stability.steady_motions import steady_motions
from substructures.errors import InvalidArgument, InvalidDocument
from substructures.quantities.numbers.evaluation import evaluate
from substructures.tree.publishing.published import Publication, published

Plain = dict[str, Any]
PUSH: Plain = {"unit": "kN", "default": "3/1000"}
#: a swing on a turntable; the wind pushes it sideways, a spring of a variable stiffness holds it
SWING: Plain = {
    "name": "swing",
    "parameters": {"m": {"value": 2, "unit": "kg"}},
    "inputs": {"wind": {"unit": "N"}, "k": {"unit": "N m/rad"}},
    "bodies": [
        {"name": "table", "parent": "base", "joint": {"type": "revolute", "coordinate": "turn"},
         "inertia": {"xx": 1, "yy": 1, "zz": 1}},
        {"name": "rod", "parent": "table", "mass": "m", "com": [0, -0.5, 0],
         "joint": {"type": "revolute", "coordinate": "q", "theta": "pi/2", "d": 0.3, "damping": 0.1}},
    ],
    "ports": [{"name": "tip", "body": "rod", "position": [0, -0.5, 0]}],
    "loads": [{"type": "force", "body": "rod", "at": [0, -0.5, 0], "vector": ["wind", 0, 0]},
              {"type": "joint", "coordinate": "q", "force": "-k*q"}],
}  # fmt: skip
GIVEN = {"s.wind": 3.0, "s.k": 4.0, "lift": 1.5}


def swing(defaults: bool, **more: Any) -> Model:
    definition = {**SWING, "inputs": {"wind": PUSH, "k": {"default": 4, "unit": "N m/rad"}}} if defaults else SWING
    lift: Plain = {"unit": "N", "default": {"value": 1500, "unit": "mN"}} if defaults else {"unit": "N"}
    tree: Plain = {
        "name": "t", "gravity": [0, 0, -9.81], "inputs": {"lift": lift},
        "instances": [{"name": "s", "definition": definition}],
        "loads": [{"name": "up", "type": "force", "to": "s.tip", "vector": [0, 0, "lift"], "axes": "world"}],
    }  # fmt: skip
    parts: dict[str, Part] = {"s": derive(Definition.read(definition))}
    return couple(TreeSpec.read({**tree, **more}), parts)


@pytest.fixture(scope="module")
def plain() -> Model:
    return swing(False)


@pytest.fixture(scope="module")
def model() -> Model:
    return swing(True)


def same(a: Any, b: Any) -> None:
    np.testing.assert_allclose(np.asarray(a), np.asarray(b), rtol=1e-9, atol=1e-9)


START: Plain = {"q": [0.2, 0.4], "qd": [1, -0.5]}


def moved(model: Model, **given: Any) -> Any:
    found = simulated(model, START["q"], (0, 0.5), qd=START["qd"], count=5, **given)
    assert found.is_right, found
    return [found.q, found.qd, *(found.series[name] for name in ("energy",))]


def rolled(model: Model, **given: Any) -> Any:
    edge = KnifeEdge("skate", "s.tip")
    found = simulated(model, START["q"], (0, 0.3), count=3, constraints=[edge], **given)
    return [found.q, found.qd]


def driven(model: Model, **given: Any) -> Any:
    found = simulated(model, START["q"], (0, 0.3), count=3, prescribed={"s.turn": "0.2 + t^2"}, **given)
    assert found.is_right
    return [found.q, found.series["actuation"], found.series["work"]]


def linear(model: Model, **given: Any) -> Any:
    found = linearise(model, q=START["q"], **given)
    return [found.K, found.D, found.qdd]


def rests(model: Model, **given: Any) -> Any:
    found = equilibria(model, starts=[[0.0, 0.3]], count=0, **given).found
    assert found
    return [[each.q[1], *each.at.K.ravel()] for each in found]


def steady(model: Model, **given: Any) -> Any:
    found = steady_motions(model, rates={"s.turn": 2}, held="rates", starts=[[0, 0.3]], count=0, **given).found
    return [[*each.q, *each.K.ravel()] for each in found]


def locus(model: Model, **given: Any) -> Any:
    return root_locus(model, "s.m", [2, 2.5], [0, 0.2], **given).eigenvalues


def cost(model: Model, **given: Any) -> Any:
    fields: Plain = {"cost": Cost(running="s.q^2 + lift"), "horizon": 0.3, "intervals": 2, "steps": 10}
    found = cost_gradient(model, **control_arguments(controls=["tau.s.q"], q=START["q"], **fields, **given))
    return [found.cost]


def varied(model: Model, **given: Any) -> Any:
    found = sensitivities(model, START["q"], (0, 0.2), **sensitivity_arguments(by=["s.m"], count=3, **given))
    return [found.motion.q] if hasattr(found, "motion") else [found.q]


def numbers(model: Model, **given: Any) -> Any:
    return evaluate(model, "forward_dynamics", **START, **given)["forward_dynamics"]


@pytest.mark.parametrize(
    "ask", [numbers, moved, rolled, driven, linear, rests, steady, locus, cost, varied], ids=lambda f: f.__name__
)
def test_a_default_is_what_is_not_given(ask: Callable[..., Any], plain: Model, model: Model) -> None:
    by_default, given, none = ask(model), ask(plain, inputs=GIVEN), ask(plain)
    for a, b in zip(by_default, given, strict=True):
        same(a, b)
    # 0 that is given is 0
    for a, b in zip(ask(model, inputs=dict.fromkeys(GIVEN, 0.0)), none, strict=True):
        same(a, b)
    assert any(
        np.shape(a) != np.shape(b) or not np.allclose(a, b, atol=1e-6) for a, b in zip(by_default, none, strict=True)
    )


def test_of_closed_loops() -> None:
    closure = {"name": "rail", "type": "rod", "from": "s.tip", "to": "world", "length": 2}
    given = loop_state(swing(False, closures=[closure]), START["q"], inputs=GIVEN)
    found = loop_state(swing(True, closures=[closure]), START["q"])
    same(found.qdd, given.qdd)
    same(found.multipliers, given.multipliers)


def test_what_acts_is_no_symmetry(model: Model, plain: Model) -> None:
    """The wind turns with the table, and does work on it; the routhian keeps it as a symbol."""
    assert "angular_momentum.z" in {each.name for each in first_integrals(plain).integrals}
    assert first_integrals(model).integrals == first_integrals(plain, ["s.wind", "s.k", "lift"]).integrals
    assert first_integrals(model, ()).integrals == first_integrals(plain).integrals
    assert {"s.k", "s.wind"} <= {symbol.name for symbol in routh(model).program.symbols}


def test_a_drive_that_is_on_by_default_is_seen_by_judges() -> None:
    """It turns the table, so that its momentum is no first integral, and it moves at no constant rate by itself."""
    drive: Plain = {"type": "torque", "body": "table", "vector": [0, 0, "drive"]}
    motor = {"unit": "N m", "default": 0.5}
    definition = {**SWING, "inputs": {**SWING["inputs"], "drive": motor}, "loads": [*SWING["loads"], drive]}
    spec = TreeSpec.read(
        {"name": "t", "gravity": [0, 0, -9.81], "instances": [{"name": "s", "definition": definition}]}
    )
    model = couple(spec, {"s": derive(Definition.read(definition))})
    motion = simulate(model, START["q"], (0, 0.5), qd=START["qd"], outputs=Outputs(count=5))
    assert motion.is_right, motion.checks
    assert "angular_momentum.z" not in motion.series
    off = simulate(model, START["q"], (0, 0.5), qd=START["qd"], inputs={"s.drive": 0}, outputs=Outputs(count=5))
    assert off.is_right
    assert "angular_momentum.z" in off.series
    with pytest.raises(InvalidArgument, match="no cyclic coordinate"):
        steady_motions(model, momenta={"s.turn": 2})
    assert steady_motions(model, momenta={"s.turn": 2}, inputs={"s.drive": 0}).found


def test_digests_are_as_before_without_one() -> None:
    old = {**SWING, "inputs": {"wind": {"unit": "kN"}, "k": {"unit": "N m/rad", "description": "hold"}}}
    assert b"default" not in Definition.read(old).canonical()
    assert Definition.read(old).inputs["wind"].unit == "kN"
    kept = Definition.read({**SWING, "inputs": {"wind": PUSH, "k": {}}})
    assert Definition.stored(Definition.read(kept.model_dump(by_alias=True)).model_dump(by_alias=True)) == kept
    assert str(kept.inputs["wind"].default) == "3/1000 kN"
    assert kept.inputs["wind"].unit == "N"


@pytest.mark.parametrize(
    ("given", "pointer", "code"),
    [
        ({"default": {"value": 5, "unit": "kg"}, "unit": "N"}, "/inputs/wind/default", "unit-mismatch"),
        ({"default": "m*2"}, "/inputs/wind/default", "unknown-name"),
        ({"default": "1/0"}, "/inputs/wind/default", "bad-expression"),
        ({"default": True}, "/inputs/wind/default", "number-expected"),
        ({"default": {"value": 5, "unit": "florps"}}, "/inputs/wind/default", "unknown-unit"),
    ],
)
def test_what_is_refused(given: Plain, pointer: str, code: str) -> None:
    def read() -> Any:
        return derive(Definition.read({**SWING, "inputs": {"wind": given, "k": {}}}))

    def coupled() -> Any:
        return couple(TreeSpec.read({"name": "t", "inputs": {"wind": given}}), {})

    for make in (read, coupled):
        with pytest.raises(InvalidDocument) as raised:
            make()
        assert (raised.value.faults[0].pointer, raised.value.faults[0].code) == (pointer, code)


def test_a_published_tree_keeps_them() -> None:
    definition = {**SWING, "inputs": {"wind": PUSH, "k": {}}}
    spec = TreeSpec.read({"name": "t", "instances": [{"name": "s", "definition": definition}]})
    found = published(spec, {"s": derive(Definition.read(definition))}, Publication({"name": "module"})).definition
    assert str(found.inputs["s_wind"].default) == "3/1000 kN"
    outer = TreeSpec.read({"name": "o", "instances": [{"name": "x", "definition": found.model_dump(by_alias=True)}]})
    model = couple(outer, {"x": derive(found)})
    by_default = evaluate(model, "forces", q=[0, 0.3])["forces"]
    same(by_default, evaluate(model, "forces", q=[0, 0.3], inputs={"x.s_wind": 3})["forces"])
    assert not np.allclose(by_default, evaluate(model, "forces", q=[0, 0.3], inputs={"x.s_wind": 0})["forces"])
