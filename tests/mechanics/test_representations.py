"""The same mechanics as formulas, bound formulas, floats and arrays."""

from __future__ import annotations

from decimal import Decimal
from fractions import Fraction
from typing import Any

import numpy as np
import pytest
from random_trees import GRAVITY, Plain, model_of, random_states

from substructures import Definition, Part, derive
from substructures.expr.bind import bind
from substructures.expr.graph import Expr, Graph
from substructures.expr.interpret import interpret
from substructures.mechanics.composite_form import (
    Inertia,
    composites,
    joint_momentum,
)
from substructures.mechanics.evaluation_frames import InertialEntries
from substructures.mechanics.frame_choice import evaluation_frames
from substructures.mechanics.kinematics import OneDofJoint, base_functions, links
from substructures.mechanics.linear3 import Rotation, Turn, dot, packed
from substructures.part.one_piece import derive_in_one_piece
from substructures.part.outputs import with_own_inertia
from substructures.quantities.numbers.evaluation import evaluate

from .samples import SEEDS, flat, pair, request_for, same


@pytest.mark.parametrize("seed", SEEDS)
def test_symbols_numbers_and_any_mixture_agree(seed: int) -> None:
    numeric, mixed = pair(seed, 0.5)
    _, symbolic = pair(seed, 1)
    expected = model_of(numeric)
    request = request_for(expected, seed)
    answer = flat(evaluate(expected, **request))
    for definition in (mixed, symbolic):
        same(answer, flat(evaluate(model_of(definition), **request)), 1e-11)


@pytest.mark.parametrize("seed", SEEDS)
def test_binding_some_or_all_parameters_changes_no_number(seed: int) -> None:
    _, symbolic = pair(seed, 1)
    model = model_of(symbolic)
    values = {name: p["value"] for name, p in symbolic["parameters"].items()}
    request = request_for(model, seed)
    numbers = (
        {s.name: 0.0 for s in model.program.symbols} | {k: float(v) for k, v in values.items()} | request["inputs"]
    )
    numbers |= {c: request["q"][:, i] for i, c in enumerate(model.coordinates)} | {"t": 0.3}
    numbers |= {f"{c}'": request["qd"][:, i] for i, c in enumerate(model.coordinates)}
    expected = interpret(model.program, numbers)
    known = [s.name for s in model.program.symbols if s.name in values]
    for count in (1, len(known) // 2, len(known)):
        chosen = list(np.random.default_rng(count).permutation(known)[:count])
        bound = bind(model.program, {str(name): values[name] for name in chosen})
        left = {s.name for s in bound.symbols}
        assert not left & set(chosen)
        # a formula in which only constants are left has no batch axis of its own
        same(expected, interpret(bound, {k: v for k, v in numbers.items() if k in left} | {"": np.zeros(3)}), 1e-10)
    assert bound.count()["total"] <= model.program.count()["total"]


def test_parameters_may_differ_from_state_to_state() -> None:
    _, symbolic = pair(2, 1)
    model = model_of(symbolic)
    name = next(iter(model.parameters))
    request = request_for(model, 0)
    default = float(model.parameters[name]["value"])
    lists = flat(evaluate(model, **(request | {"parameters": {name: [default, 2.0, default]}})))
    same(
        {k: x[[0, 2]] for k, x in flat(evaluate(model, **request)).items()},
        {k: x[[0, 2]] for k, x in lists.items()},
        1e-14,
    )
    same(
        {k: x[1:2] for k, x in flat(evaluate(model, **(request | {"parameters": {name: 2}}))).items()},
        {k: x[1:2] for k, x in lists.items()},
        1e-14,
    )


@pytest.mark.parametrize("seed", SEEDS)
def test_the_same_alone_and_derived_in_one_piece(seed: int) -> None:
    """Without coupling: stored formulas with the own inertia bound, and formulas that never had symbols for it."""
    _, symbolic = pair(seed, 0.3)
    part, model = derive(Definition.read(symbolic)), model_of(symbolic)
    states = random_states(np.random.default_rng(seed), 3, model.dof)
    expected = evaluate(model, ["metric", "christoffel", "gravity"], **states)
    whole = derive_in_one_piece(Definition.read(symbolic), tuple(Decimal(str(x)) for x in GRAVITY))
    values = {name: float(p["value"]) for name, p in symbolic["parameters"].items()}
    values |= {c.removeprefix("x."): states["q"][:, a] for a, c in enumerate(model.coordinates)}
    found = interpret(whole, values | {"": np.zeros(3)})
    alone = with_own_inertia(part, part.program.select(["metric", "christoffel"]))
    assert not any(s.kind == "inertia" for s in (*whole.symbols, *alone.symbols))
    same({name: expected[name] for name in ("metric", "christoffel", "gravity")}, found, 1e-11)
    same({n: expected[n] for n in ("metric", "christoffel")}, interpret(alone, values | {"": np.zeros(3)}), 1e-11)


# --- one recursion for every scalar


def recursion(joints: tuple[OneDofJoint, ...], bodies: tuple[Inertia, ...], gravity: Any) -> dict[tuple[Any, ...], Any]:
    """Metric, Christoffel symbols and gravity by calling the mechanics directly."""
    carried = composites(joints, bodies)
    chain = links(joints)
    entries = InertialEntries(chain, base_functions(chain), evaluation_frames(chain))
    result: dict[tuple[Any, ...], Any] = {}
    gamma: list[Any] = []
    for c, joint in enumerate(joints):
        momentum = joint_momentum(joint.s, carried[c])
        result |= {("g", *index): x for index, x in entries.metric(c, momentum).items()}
        result |= {("Gamma", *index): x for index, x in entries.christoffel(c, momentum).items()}
        gamma.append(joint.rotation.forward(gamma[joint.parent] if joint.parent >= 0 else gravity))
        result["Q", c] = dot(gamma[c], momentum.p)
    return result


def rows(part: Part, x: Plain, scalar: Any) -> tuple[tuple[OneDofJoint, ...], tuple[Inertia, ...]]:
    """Joints and bodies over other scalars; ``scalar(name, *index)`` is an element of a stored output."""

    def matrix(name: str, c: int) -> Any:
        return tuple(tuple(scalar(x[name], c, i, j) for j in range(3)) for i in range(3))

    joints, bodies, own = [], [], []
    for c, j in enumerate(part.topology.joints):
        tau = scalar(x["tau"], c)
        z = [scalar(x["Z"], c, i) for i in range(3)]
        # Z_k = offset + tau_p e3
        z[2] = z[2] - (own[j.parent] if j.parent >= 0 else 0)
        own.append(tau)
        joints.append(OneDofJoint(j.parent, j.s, Rotation((Turn(matrix("E", c)),)), tuple(z), tau))
        s = tuple(scalar(x["inertia.s"], c, i) for i in range(3))
        bodies.append(Inertia(scalar(x["inertia.m"], c), s, packed(matrix("inertia.J", c))))
    return tuple(joints), tuple(bodies)


ROWS = ("E", "Z", "tau", "inertia.m", "inertia.s", "inertia.J")


@pytest.mark.parametrize("seed", SEEDS)
def test_one_recursion_for_formulas_floats_and_arrays(seed: int) -> None:
    definition = pair(seed, 0)[0]
    for body in definition["bodies"]:
        body["joint"].pop("armature", None)
    part, model = derive(Definition.read(definition)), model_of(definition)
    request = request_for(model, seed)
    formulas = evaluate(model, **request)
    paths: list[list[int]] = []
    for c, joint in enumerate(part.topology.joints):
        paths.append([*(paths[joint.parent] if joint.parent >= 0 else []), c])
    entries = {("Q", c) for c in range(part.dof)} | {("g", a, c) for c, path in enumerate(paths) for a in path}
    entries |= {("Gamma", a, b, c) for c, path in enumerate(paths) for a in path[:-1] for b in path}
    values = {c: request["q"][:, i] for i, c in enumerate(part.coordinates)}
    x = interpret(part.program, values | {"": np.zeros(3)}, ROWS)

    def element(array: Any, *index: int) -> Any:
        return array[(slice(None), *index)]

    def mixed(array: Any, *index: int) -> Any:
        """Constant elements as floats, exact zeros and ones as integers, all others as arrays."""
        some = element(array, *index)
        if np.ptp(some) > 0:
            return some
        return int(some[0]) if some[0] in (0, 1) else float(some[0])

    def check(found: dict[tuple[Any, ...], Any], i: Any) -> None:
        assert found.keys() == entries
        names = {"g": "metric", "Gamma": "christoffel", "Q": "gravity"}
        for key, value in found.items():
            expected = formulas[names[key[0]]][(i, *key[1:])]
            np.testing.assert_allclose(value, expected, rtol=1e-10, atol=1e-10)

    check(recursion(*rows(part, x, element), GRAVITY), slice(None))
    check(recursion(*rows(part, x, mixed), GRAVITY), slice(None))
    for i in range(3):
        check(recursion(*rows(part, x, lambda array, *index, i=i: float(array[(i, *index)])), GRAVITY), i)


def test_formulas_mix_with_exact_numbers() -> None:
    """A pendulum with numbers for mass and length but symbols for the rest, through the recursion itself."""
    graph = Graph()
    c, s, inertia = graph.symbol("c"), graph.symbol("s"), graph.symbol("J")
    turn = Rotation((Turn(((c, s, 0), (-s, c, 0), (0, 0, 1))),))
    body = Inertia(2, (3, 0, 0), (inertia, 0, 0, 0, 0, 0))
    found = recursion((OneDofJoint(-1, 0, turn, (0, 0, Fraction(1, 2)), 0),), (body,), (-10, 0, 0))
    assert isinstance(found["g", 0, 0], Expr)
    assert found["g", 0, 0] is inertia
    assert found["Q", 0] is 30 * s


# --- linearity in the inertial parameters


@pytest.mark.parametrize("seed", SEEDS)
def test_everything_stored_is_linear_in_mass_and_moments(seed: int) -> None:
    part = derive(Definition.read(pair(seed, 0.3)[1]))
    rng = np.random.default_rng(seed)
    inertia = [s.name for s in part.program.symbols if s.kind == "inertia"]
    common = {s.name: rng.uniform(-1, 1) for s in part.program.symbols if s.kind != "inertia"}
    pi = [{name: rng.uniform(-1, 1) for name in inertia} for _ in range(2)]
    names = ["metric", "christoffel", "f", "n", "K", "kappa", "F", "N"]
    names += [f"{x}.{y}" for x in ("subtree", "composite") for y in "msJ"]

    def at(one: float, two: float) -> Plain:
        values = {name: one * pi[0][name] + two * pi[1][name] for name in inertia}
        return interpret(part.program, common | values, names)

    # what is fixed to the interface, and the rotors, do not depend on the symbols
    rest, x, y, both = at(0, 0), at(1, 0), at(0, 1), at(2, -3)
    same(both, {k: rest[k] + 2 * (x[k] - rest[k]) - 3 * (y[k] - rest[k]) for k in names}, 1e-12)
    same(
        {"metric": np.diag(interpret(part.program, common, ["armature"])["armature"])},
        {"metric": rest["metric"]},
        1e-15,
    )
