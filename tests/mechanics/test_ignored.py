"""Cyclic coordinates at given momenta: against the tree with all coordinates, against differences, refusals, faults.

Equations of all coordinates at the velocities that the momenta make share nothing with the reduction.
"""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
from damaged import damages, found_in_tree, has_effect
from in_depth import seeds
from random_trees import Kind, random_definition

from substructures import InvalidDocument, Model, TreeSpec, couple, derive, evaluate
from substructures.errors import VerificationFailed
from substructures.expr.interpret import interpret
from substructures.quantities.powers import powers
from substructures.quantities.reactions import reactions
from substructures.tree.given import ignored

Plain = dict[str, Any]
INERTIA = dict.fromkeys(("xx", "yy", "zz"), 1)
#: slides along x and y and turns about z; gravity along z acts on none of these
TABLE: Plain = {
    "name": "table",
    "parameters": {"b": {"value": 0, "unit": "N m s"}},
    "bodies": [
        {
            "name": "x",
            "parent": "base",
            "mass": 2,
            "joint": {"type": "prismatic", "coordinate": "x", "axis": [1, 0, 0], "placement": {"position": [0, 0, 0]}},
        },
        {
            "name": "y",
            "parent": "x",
            "mass": 1,
            "joint": {"type": "prismatic", "coordinate": "y", "axis": [0, 1, 0], "placement": {"position": [0, 0, 0]}},
        },
        {
            "name": "disc",
            "parent": "y",
            "mass": 3,
            "com": [0.1, 0.2, 0],
            "inertia": INERTIA,
            "joint": {
                "type": "revolute",
                "coordinate": "turn",
                "axis": [0, 0, 1],
                "placement": {"position": [0, 0, 0]},
            },
        },
    ],
    "ports": [{"name": "rim", "body": "disc", "position": [0.4, 0.1, 0.2]}],
}
MOMENTA = {"t.x": 0.7, "t.y": -0.4, "t.turn": 1.3}
ANY: dict[str, Any] = {"h": {"value": 1.3}, "k": {"value": 0.35}}
GIVEN: Plain = {"t.x": "2*k", "t.turn": "h"}


def document(definition: Plain | None, given: Plain, **more: Any) -> Plain:
    instances: list[Plain] = [{"name": "t", "definition": TABLE}]
    if definition is not None:
        placement = {"position": [0.1, -0.2, 0.3], "rpy": [0.3, "0.5", 0.2]}
        instances.append({"name": "m", "definition": definition, "at": "t.rim", "placement": placement})
    tree = {"name": "tree", "gravity": [0, 0, "-9.81"], "parameters": ANY, "instances": instances}
    return {**tree, **({"ignored": given} if given else {}), **more}


def model(tree: Plain) -> Model:
    spec = TreeSpec.read(tree)
    return couple(spec, {each.name: derive(each.definition) for each in spec.instances if each.definition})


def mechanism(seed: int, laws: bool = True) -> Plain:
    """One on which only gravity and its own joints act, these where they have laws; accelerations are determined."""
    kind = Kind(3, bool(seed % 2), laws=laws, springs=0, massive=True)
    return {**random_definition(np.random.default_rng(seed), kind), "loads": []}


def deviation(found: Any, expected: Any) -> float:
    assert np.shape(found) == np.shape(expected)
    return float(np.abs(found - expected).max(initial=0) / max(np.abs(expected).max(initial=0), 1e-2))


@pytest.mark.parametrize("names", [("t.x",), ("t.x", "t.y")])
@pytest.mark.parametrize("seed", seeds(3, 20))
def test_reduced_is_the_whole_tree_at_the_given_momenta(seed: int, names: tuple[str, ...]) -> None:
    """Of slides; the metric depends on the angle of the table, which is left."""
    definition, rng = mechanism(seed), np.random.default_rng(seed)
    whole, here = (model(document(definition, x)) for x in ({}, {name: str(MOMENTA[name]) for name in names}))
    compared(whole, here, [MOMENTA[name] for name in names], rng)


@pytest.mark.parametrize("seed", seeds(3, 20))
def test_a_turning_table_is_reduced(seed: int) -> None:
    """Of an angle that positions depend on: they are those of where it is zero."""
    table = {**TABLE, "bodies": [{**TABLE["bodies"][2], "parent": "base"}]}
    instances = [{"name": "t", "definition": table}, document(mechanism(seed), {})["instances"][1]]
    tree = {**document(None, {}), "instances": instances}
    whole, here = model(tree), model({**tree, "ignored": {"t.turn": "h"}})
    compared(whole, here, [1.3], np.random.default_rng(seed))


def compared(whole: Model, here: Model, p: list[float], rng: np.random.Generator) -> None:
    """Everything that has the same value in both, at a random state."""
    assert here.coordinates == tuple(name for name in whole.coordinates if name not in here.ignored)
    cyclic, rest = ([whole.coordinates.index(name) for name in some] for some in (here.ignored, here.coordinates))
    q, qd, qdd = rng.uniform(-1, 1, (3, whole.dof))
    q[cyclic] = 0
    found = evaluate(here, ["ignored_rates", *SAME, *OWN], q=q[rest], qd=qd[rest], qdd=qdd[rest])
    qd[cyclic] = found["ignored_rates"]
    every = evaluate(whole, ["metric", "christoffel", "forward_dynamics", *SAME], q=q, qd=qd, qdd=qdd)
    assert deviation(every["generalised_momenta"][cyclic], np.array(p)) < 1e-12
    assert deviation(found["forward_dynamics"], every["forward_dynamics"][rest]) < 1e-10
    assert deviation(found["generalised_momenta"], every["generalised_momenta"][rest]) < 1e-10
    for name in ("kinetic_energy", "potential_energy"):
        assert deviation(found[name], every[name]) < 1e-11, name
    for name, field in (("momentum", "linear"), ("momentum", "angular"), ("kinematics", "position")):
        assert deviation(found[name][field], every[name][field]) < 1e-10, name
    # R = T - V - p_c q'^c, H = T + V
    routhian = every["kinetic_energy"] - every["potential_energy"] - p @ qd[cyclic]
    assert deviation(found["lagrangian"], routhian) < 1e-11
    assert deviation(found["hamiltonian"], every["kinetic_energy"] + every["potential_energy"]) < 1e-11
    # what stands in the equations
    v = qd[rest]
    assert deviation(found["metric"] @ found["forward_dynamics"] + found["bias"], found["forces"]) < 1e-9
    written = found["christoffel"] @ v @ v + 2 * found["Gamma_ab0"] @ v + found["Gamma_a00"]
    assert deviation(written, found["bias"]) < 1e-10
    assert deviation(found["Gamma_ab0"], -found["Gamma_ab0"].T) < 1e-12
    assert deviation(found["inverse_dynamics"], found["metric"] @ qdd[rest] + found["bias"] - found["forces"]) < 1e-10


@pytest.mark.parametrize("given", [{"t.turn": "h"}, {"t.x": "0.7", "t.y": "-0.4"}])
@pytest.mark.parametrize("seed", seeds(1, 10))
def test_reactions_and_powers_are_those_of_the_whole_tree(seed: int, given: dict[str, str]) -> None:
    """At the velocities and accelerations of the ignored coordinates, which follow from their momenta."""
    table = TABLE if "t.x" in given else {**TABLE, "bodies": [{**TABLE["bodies"][2], "parent": "base"}]}
    instances = [{"name": "t", "definition": table}, document(mechanism(seed), {})["instances"][1]]
    free = TreeSpec.read({**document(None, {}), "instances": instances})
    spec = TreeSpec.read({**document(None, given), "instances": instances})
    parts = {each.name: derive(each.definition) for each in free.instances if each.definition}
    whole, here = couple(free, parts), couple(spec, parts)
    cyclic, rest = ([whole.coordinates.index(name) for name in some] for some in (here.ignored, here.coordinates))
    q, qd, qdd = np.random.default_rng(seed).uniform(-1, 1, (3, whole.dof))
    q[cyclic] = 0
    qd[cyclic] = evaluate(here, ["ignored_rates"], q=q[rest], qd=qd[rest])["ignored_rates"]
    equations = evaluate(whole, ["metric", "bias"], q=q, qd=qd)
    pull = equations["metric"][np.ix_(cyclic, rest)] @ qdd[rest] + equations["bias"][cyclic]
    qdd[cyclic] = np.linalg.solve(equations["metric"][np.ix_(cyclic, cyclic)], -pull)
    values = {"h": 1.3, "k": 0.35, "t": 0.0}
    for mark, x in (("", q), ("'", qd), ("''", qdd)):
        values |= {f"{name}{mark}": float(x[a]) for a, name in enumerate(whole.coordinates)}
    for make in (reactions, powers):
        one, two = make(free, parts), make(spec, parts)
        assert one.rows == two.rows
        known = {
            symbol.name: values.get(symbol.name, 0.3 if symbol.kind == "input" else 1.0)
            for symbol in one.program.symbols
        }
        known |= {f"tau.{name}": 0.0 for name in here.ignored} | values
        known |= {name: x["value"] for name, x in here.parameters.items() if x.get("value") is not None}
        expected, found = (interpret(each.program, known) for each in (one, two))
        for name in expected:
            assert deviation(np.asarray(found[name]), np.asarray(expected[name])) < 1e-10, name
        names = {symbol.name for symbol in two.program.symbols}
        assert not names & {
            f"{x}{name}{mark}" for name in given for x, mark in (("", ""), ("", "'"), ("", "''"), ("tau.", ""))
        }


SAME = ["generalised_momenta", "kinetic_energy", "potential_energy", "momentum", "kinematics"]
OWN = ["forward_dynamics", "lagrangian", "hamiltonian", "metric", "christoffel", "bias", "forces", "inverse_dynamics"]
OWN += ["Gamma_ab0", "Gamma_a00"]


@pytest.mark.parametrize("seed", seeds(2, 10))
def test_equations_are_those_of_rouths_function_by_differences(seed: int) -> None:
    m, rng = model(document(mechanism(seed, laws=False), {"t.x": "h", "t.y": "2"})), np.random.default_rng(seed)
    q, qd, qdd = rng.uniform(-1, 1, (3, m.dof))
    h = 1e-4

    def routhian(x: Any, v: Any) -> float:
        return float(evaluate(m, ["lagrangian"], q=x, qd=v)["lagrangian"])

    def momentum(tau: float) -> Any:
        x, v = q + tau * qd + tau**2 * qdd / 2, qd + tau * qdd
        return np.array([(routhian(x, v + e) - routhian(x, v - e)) / 2 for e in np.eye(m.dof)])

    left = (momentum(h) - momentum(-h)) / (2 * h)
    left -= np.array([(routhian(q + h * e, qd) - routhian(q - h * e, qd)) / (2 * h) for e in np.eye(m.dof)])
    assert deviation(evaluate(m, ["inverse_dynamics"], q=q, qd=qd, qdd=qdd)["inverse_dynamics"], left) < 1e-5


def test_momenta_are_numbers_with_units_or_expressions() -> None:
    rates = [
        evaluate(model(document(None, {"t.x": given})), ["ignored_rates"], q=[0, 0], qd=[0, 0])["ignored_rates"]
        for given in (3, "h + 1.7", {"value": 3000, "unit": "g*m/s"})
    ]
    assert rates == [pytest.approx([0.5])] * 3
    with pytest.raises(InvalidDocument) as caught:
        model(document(None, {"t.x": {"value": 3, "unit": "N m s"}}))
    assert caught.value.faults[0].pointer == "/ignored/t.x"


@pytest.mark.parametrize(
    ("given", "more", "pointer", "code", "text"),
    [
        ({"t.turn": 1}, {}, "/ignored/t.turn", "not-cyclic", "'metric' depends on it"),
        ({"t.turm": 1}, {}, "/ignored/t.turm", "unknown-coordinate", "did you mean 't.turn'?"),
        ({"t.x": "hh"}, {}, "/ignored/t.x", "unknown-name", "hh"),
        ({"t.x": 1}, {"gravity": [1, 0, 0]}, "/ignored/t.x", "not-cyclic", "a force acts on it, a constant one"),
        ({"t.x": 1}, {"driven": {"t.y": "t"}}, "/ignored", "not-supported", "'driven'"),
        (
            {"t.x": 1},
            {"velocity_constraints": [{"type": "linear", "name": "c", "expression": "t.x' - t.y'"}]},
            "/ignored",
            "not-supported",
            "'velocity_constraints'",
        ),
        (
            {"t.x": 1},
            {"closures": [{"name": "c", "type": "rod", "from": "t.rim", "length": 1}]},
            "/ignored",
            "not-supported",
            "'closures'",
        ),
        (
            {"t.y": 1},
            {"loads": [{"type": "joint", "name": "d", "coordinate": "t.y", "force": "-k*t.y'"}]},
            "/ignored/t.y",
            "not-cyclic",
            "which depends on k, t.y'",
        ),
    ],
)
def test_what_is_not_cyclic_is_refused_by_name(given: Plain, more: Plain, pointer: str, code: str, text: str) -> None:
    with pytest.raises(InvalidDocument) as caught:
        model(document(None, given, **more))
    fault = caught.value.faults[0]
    assert (fault.pointer, fault.code) == (pointer, code)
    assert text in fault.message


def test_dry_friction_is_not_cyclic() -> None:
    bodies = [dict(each) for each in TABLE["bodies"]]
    bodies[0]["joint"] = {**bodies[0]["joint"], "friction": {"coulomb": 2, "velocity": 0.1}}
    tree = document(None, {"t.x": 1})
    tree["instances"] = [{"name": "t", "definition": {**TABLE, "bodies": bodies}}]
    with pytest.raises(InvalidDocument, match=r"'t\.x' is not cyclic.*dry friction"):
        model(tree)


def test_every_fault_is_found() -> None:
    tree = document(mechanism(3), {"t.x": "h", "t.y": "k"})
    here, spec = model(tree), TreeSpec.read(tree)
    parts = {each.name: derive(each.definition) for each in spec.instances if each.definition}
    rng, missed = np.random.default_rng(0), []
    for kind, place, wrong in damages(here.program, rng, kinds=2):
        if has_effect(here.program, wrong) and found_in_tree(spec, parts, here, wrong) is None:
            missed.append((kind, place))
    assert not missed


def test_a_coordinate_that_is_not_cyclic_is_found_by_the_certificate(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(ignored, "_not_cyclic", lambda *_: "")
    with pytest.raises(VerificationFailed, match=r"depends on t\.turn, which is ignored"):
        model(document(None, {"t.turn": 1}))
    with pytest.raises(VerificationFailed, match=r"a force acts on t\.x, which is ignored"):
        model(document(None, {"t.x": 1}, gravity=[1, 0, 0]))
