"""Given motions in the formulas: against the tree with all coordinates, against differences, and faults that are found.

d/dt dT/dq' - dT/dq by differences shares nothing with the formulas, nor with their certificate.
"""

# ruff: noqa: N806 -- symbols of the notation

from __future__ import annotations

import json
from functools import lru_cache
from itertools import pairwise
from typing import Any

import numpy as np
import pytest
from catalogue_entries import open_entry
from damaged import damages, found_in_tree, has_effect
from in_depth import seeds
from random_trees import GRAVITY, Kind, random_definition, random_states
from related import joints_of, with_relations
from scipy.integrate import solve_ivp
from scipy.interpolate import CubicSpline, PchipInterpolator, PPoly

from substructures import Definition, InvalidDocument, Model, Part, TreeSpec, couple, derive, evaluate
from substructures.analysis.simulate import Integrator, simulate
from substructures.errors import VerificationFailed
from substructures.expr.graph import Expr
from substructures.part.topology import topology
from substructures.quantities.sources import Sources, of_parts
from substructures.tree.given import driven

Plain = dict[str, Any]
#: s, s', s'' of "a*sin(w*t + k) + t^2/10"
A, W, T = 0.4, 1.7, 0.31
VALUES = [
    "metric",
    "christoffel",
    "forces",
    "bias",
    "nonlinear_effects",
    "gravity",
    "inverse_dynamics",
    "kinetic_energy",
]
VALUES += ["generalised_momenta", "momentum", "potential_energy", "kinematics", "lagrangian"]
DRIVES = [
    "g_a0",
    "g_00",
    "Gamma_ab0",
    "Gamma_a00",
    "T_2",
    "T_1",
    "T_0",
    "drive_forces",
    "drive_powers",
    "U_0",
    "Omega_0",
]
OF_PARTS = ["regressor", "reactions", "powers", "mass_centre", "centroidal_momentum_matrix"]


def law(k: int) -> str:
    return f"a*sin(w*t + {k}) + t^2/10"


def rates_of(k: int, t: float) -> tuple[float, float, float]:
    x = W * t + k
    return A * np.sin(x) + t**2 / 10, A * W * np.cos(x) + t / 5, -A * W * W * np.sin(x) + 0.2


def document(definition: Plain, given: Plain) -> Plain:
    parameters = {"a": {"value": A}, "w": {"value": W, "unit": "rad/s"}}
    instances = [{"name": "x", "definition": definition}]
    tree = {"name": "tree", "gravity": list(GRAVITY), "parameters": parameters, "instances": instances}
    return tree | ({"driven": given} if given else {})


@lru_cache(maxsize=4)
def derived(definition: str) -> Part:
    return derive(Definition.read(json.loads(definition)))


def sources(definition: Plain, given: Plain) -> Sources:
    spec, parts = TreeSpec.read(document(definition, given)), {"x": derived(json.dumps(definition, default=str))}
    return Sources(couple(spec, parts), of_parts=of_parts(spec, parts))


def model(definition: Plain, given: Plain) -> Model:
    return sources(definition, given).model


def random_driven(seed: int, relations: int = 0) -> tuple[Plain, list[str], list[int]]:
    """A mechanism, its coordinates, and the places of those that are driven."""
    rng = np.random.default_rng(seed)
    definition = random_definition(rng, Kind(int(rng.integers(3, 6)), bool(rng.integers(2)), loads=3, springs=1))
    while len(joints_of(definition)) < 3:
        definition = random_definition(rng, Kind(4, True, loads=3, springs=1))
    if relations:
        definition = with_relations(rng, definition, relations)
    names = [f"x.{name}" for name in topology(Definition.read(definition)).coordinates]
    chosen = sorted(rng.choice(len(names), int(rng.integers(1, max(2, len(names)))), replace=False).tolist())
    return definition, names, chosen


def deviation(found: Any, expected: Any) -> float:
    assert np.shape(found) == np.shape(expected)
    assert np.isfinite(found).all()
    return float(np.abs(found - expected).max(initial=0) / max(np.abs(expected).max(initial=0), 1e-2))


@pytest.mark.parametrize("seed", seeds(6, 60))
def test_driven_is_the_whole_tree_at_the_given_motions(seed: int) -> None:
    definition, names, chosen = random_driven(seed, seed % 3)
    free, n = [a for a in range(len(names)) if a not in chosen], len(names)
    here, whole = sources(definition, {names[m]: law(m) for m in chosen}), sources(definition, {})
    assert here.model.coordinates == tuple(names[a] for a in free)
    assert here.model.driven == tuple(names[m] for m in chosen)
    states = {name: x[0] for name, x in random_states(np.random.default_rng(seed), 1, n).items()}
    given = np.array([rates_of(m, T) for m in chosen]).T
    for name, x in zip(("q", "qd", "qdd"), given, strict=True):
        states[name][chosen] = x
    inputs = {"x.u1": 0.3, "x.u2": -0.7}
    own = {name: x[free] for name, x in states.items()}
    found = evaluate(here, [*VALUES, *DRIVES, *OF_PARTS], **own, t=T, inputs=inputs)
    all_of = evaluate(whole, [*VALUES, *OF_PARTS], **states, t=T, inputs=inputs)
    g, Gamma, v, a = all_of["metric"], all_of["christoffel"], given[1], given[2]
    pull = g[np.ix_(free, chosen)] @ a
    expected = {
        "metric": g[np.ix_(free, free)],
        "christoffel": Gamma[np.ix_(free, free, free)],
        **{name: all_of[name][free] for name in ("forces", "gravity", "inverse_dynamics", "generalised_momenta")},
        **{name: all_of[name][free] + pull for name in ("bias", "nonlinear_effects")},
        **{name: all_of[name] for name in ("kinetic_energy", "potential_energy", "lagrangian")},
        "g_a0": g[np.ix_(free, chosen)] @ v,
        "g_00": v @ g[np.ix_(chosen, chosen)] @ v,
        "Gamma_ab0": Gamma[np.ix_(free, free, chosen)] @ v,
        "Gamma_a00": Gamma[np.ix_(free, chosen, chosen)] @ v @ v + pull,
        "T_2": own["qd"] @ g[np.ix_(free, free)] @ own["qd"] / 2,
        "T_1": own["qd"] @ g[np.ix_(free, chosen)] @ v,
        "T_0": v @ g[np.ix_(chosen, chosen)] @ v / 2,
        "drive_forces": all_of["inverse_dynamics"][chosen],
        "drive_powers": all_of["inverse_dynamics"][chosen] * v,
        "U_0": np.einsum("fai,a->fi", all_of["kinematics"]["U"][:, chosen], v),
        "Omega_0": np.einsum("fai,a->fi", all_of["kinematics"]["Omega"][:, chosen], v),
        "regressor": all_of["regressor"][free],
        "centroidal_momentum_matrix": all_of["centroidal_momentum_matrix"][:, free],
        "powers": all_of["powers"],
    }
    for name, x in expected.items():
        assert deviation(found[name], x) < 1e-10, name
    for name, field in (("momentum", "linear"), ("momentum", "angular"), ("mass_centre", "velocity"),
                        ("kinematics", "position"), ("reactions", "force"), ("reactions", "moment")):  # fmt: skip
        assert deviation(found[name][field], all_of[name][field]) < 1e-10, name


@pytest.mark.parametrize("seed", seeds(3, 20))
def test_equations_are_those_of_lagrange_by_differences(seed: int) -> None:
    definition, names, chosen = random_driven(100 + seed)
    m = model({**definition, "loads": []}, {names[k]: law(k) for k in chosen})
    rng = np.random.default_rng(seed)
    q, qd, qdd = (rng.uniform(-1, 1, m.dof) for _ in range(3))
    h = 1e-4

    def energy(t: float, x: Any, v: Any) -> float:
        found = evaluate(m, ["T_2", "T_1", "T_0"], q=x, qd=v, t=t)
        return float(found["T_2"] + found["T_1"] + found["T_0"])

    def momentum(tau: float) -> Any:
        x, v = q + tau * qd + tau**2 * qdd / 2, qd + tau * qdd
        return np.array([(energy(T + tau, x, v + e) - energy(T + tau, x, v - e)) / 2 for e in np.eye(m.dof)])

    left = (momentum(h) - momentum(-h)) / (2 * h)
    left -= np.array([(energy(T, q + h * e, qd) - energy(T, q - h * e, qd)) / (2 * h) for e in np.eye(m.dof)])
    found = evaluate(m, ["metric", "bias", "christoffel", "Gamma_ab0", "Gamma_a00"], q=q, qd=qd, t=T)
    assert deviation(found["metric"] @ qdd + found["bias"], left) < 1e-5
    written = found["christoffel"] @ qd @ qd + 2 * found["Gamma_ab0"] @ qd + found["Gamma_a00"]
    assert deviation(written, found["bias"]) < 1e-12


def test_every_fault_is_found() -> None:
    definition, names, chosen = random_driven(3)
    given = {names[k]: law(k) for k in chosen}
    here, spec = model(definition, given), TreeSpec.read(document(definition, given))
    parts, rng, missed = {"x": derive(Definition.read(definition))}, np.random.default_rng(0), []
    for kind, place, wrong in damages(here.program, rng, kinds=2):
        if has_effect(here.program, wrong) and found_in_tree(spec, parts, here, wrong) is None:
            missed.append((kind, place))
    assert not missed


def test_an_acceleration_that_is_left_out_is_found(monkeypatch: pytest.MonkeyPatch) -> None:
    """Gamma_a00 without g_am s''."""
    definition, names, chosen = random_driven(4)
    motions = driven.given_motions

    def uniform(assembly: Any) -> dict[str, tuple[Expr, Expr, Expr]]:
        return {name: (s, rate, rate.graph.zero) for name, (s, rate, _) in motions(assembly).items()}

    monkeypatch.setattr(driven, "given_motions", uniform)
    with pytest.raises(VerificationFailed, match=r"Gamma_a00|bias|nonlinear_effects|inverse_dynamics"):
        model(definition, {names[k]: law(k) for k in chosen})


LAWS: list[Any] = [
    {"times": [0, 1, 2], "values": [0.1, 0.3, 0.25], "interpolation": each} for each in ("smooth", "monotone")
]
LAWS += ["step(t, 1, a)", "a*tanh(w*t)", "atan2(t, 3)", "exp(-t)*(t + 2)^a", "asin(t/4)*log(t + 3)"]
LAWS += ["table(t; 0:0, 1:0.3, 2:0.5; smooth)", "table(2*t; -1:0, 0:0, 1:1, 2:0.5, 3:0.5; monotone)"]


@pytest.mark.parametrize("text", LAWS)
def test_laws_have_two_derivatives(text: Any) -> None:
    """g_00 = m s'^2 and the force of the drive m s'', against differences."""
    joint = {"type": "prismatic", "coordinate": "a"}
    definition = {"name": "one", "bodies": [{"name": "b", "parent": "base", "mass": 1, "joint": joint}]}
    m = model(definition, {"x.a": text})
    h = 1e-4
    for t in (0.4, 1.3, 1.7):
        s = [evaluate(m, ["position"], q=[], t=t + k * h)["position"][1, 2] for k in (-1, 0, 1)]
        found = evaluate(m, ["g_00", "drive_forces", "gravity", "linear_momentum_0"], q=[], qdd=[], t=t)
        assert found["linear_momentum_0"][2] == pytest.approx((s[2] - s[0]) / (2 * h), abs=1e-6)
        assert found["g_00"] == pytest.approx(((s[2] - s[0]) / (2 * h)) ** 2, abs=1e-6)
        weight = float(found["drive_forces"][0]) - (s[2] - 2 * s[1] + s[0]) / h**2
        assert weight == pytest.approx(-GRAVITY[2], abs=1e-5)


TABLES: list[Any] = [
    {"times": [0, 0.5, 1.2, 2], "values": [0.1, 0.4, 0.4, -0.3], "interpolation": each}
    for each in ("smooth", "monotone")
]


@pytest.mark.parametrize("table", TABLES)
def test_motions_along_tables_are_right(table: Any) -> None:
    """From the first place of a table to behind the last one: the energy is balanced, also where pieces meet, and the
    motion is that by SciPy's splines as inputs, integrated from place to place.
    """
    definition = open_entry("cart-pendulum")
    integrator = Integrator(relative_tolerance=1e-10, absolute_tolerance=1e-12)
    found = simulate(model(definition, {"x.q0": table}), q=[0.3], span=(0, 2.5), integrator=integrator)
    assert (found.status, found.is_right) == ("finished", True)
    t, s = [-1.0, *table["times"], 3.0], [table["values"][0], *table["values"], table["values"][-1]]
    curve: Any = PchipInterpolator(t, s)
    if table["interpolation"] == "smooth":
        inner = CubicSpline(table["times"], table["values"], bc_type="clamped")
        curve = PPoly(np.hstack([np.eye(4)[:, 3:] * s[0], inner.c, np.eye(4)[:, 3:] * s[-1]]), t)
    free = model(definition, {"x.q0": {"input": True}})

    def rate(time: float, x: Any) -> Any:
        inputs = {f"x.q0{primes}": float(curve(time, k)) for k, primes in enumerate(("", "'", "''"))}
        return x[1], evaluate(free, "forward_dynamics", q=[x[0]], qd=[x[1]], inputs=inputs)["forward_dynamics"][0]

    x = np.array([0.3, 0.0])
    for start, end in pairwise([*table["times"], 2.5]):
        inside = (start + 1e-12, end - 1e-12)
        x = solve_ivp(rate, inside, x, "DOP853", rtol=1e-10, atol=1e-12).y[:, -1]
    np.testing.assert_allclose([found.q[-1, 0], found.qd[-1, 0]], x, atol=1e-7)


def test_inputs_may_drive() -> None:
    definition, names, chosen = random_driven(5)
    laws = model(definition, {names[k]: law(k) for k in chosen})
    given = model(definition, {names[k]: {"input": True} for k in chosen})
    state = {name: x[0] for name, x in random_states(np.random.default_rng(5), 1, laws.dof).items()}
    rates = {f"{names[k]}{p}": x for k in chosen for p, x in zip(("", "'", "''"), rates_of(k, T), strict=True)}
    assert rates.keys() <= set(given.input_names)
    assert {given.units[f"{names[k]}''"] for k in chosen} <= {"rad/s^2", "m/s^2"}
    found, expected = (
        evaluate(m, ["inverse_dynamics", "drive_forces", "forward_dynamics"], **state, t=T, inputs=u)
        for m, u in ((given, rates), (laws, {}))
    )
    for name in ("inverse_dynamics", "drive_forces", "forward_dynamics"):
        assert deviation(found[name], expected[name]) < 1e-10


@pytest.mark.parametrize(
    ("given", "pointer", "code", "message"),
    [
        ({"x.b": "t"}, "/driven/x.b", "unknown-coordinate", "no coordinate 'x.b'; did you mean 'x.a'"),
        ({"a": "t"}, "/driven/a", "string-pattern-mismatch", "a name with its instance"),
        ({"x.a": "abs(t)"}, "/driven/x.a", "kink", "must not jump, .* take step"),
        ({"x.a": "max(0, t)*(t - 1)"}, "/driven/x.a", "kink", r"as max\(0, t - 1\)\^2"),
        ({"x.a": "max(0, sin(t))^2"}, "/driven/x.a", "kink", "must not jump"),
        ({"x.a": "max(0, t)^2*sign(t - 1)"}, "/driven/x.a", "kink", "must not jump"),
        ({"x.a": "table(t; 0:0, 1:1)"}, "/driven/x.a", "kink", "linear tables"),
        ({"x.a": "table(t; 0:0, 1:1, 2:0.5; monotone)"}, "/driven/x.a", "kink", "monotone ones that do not end flat"),
        (
            {"x.a": {"times": [0, "1/2"], "values": [0, 1]}},
            "/driven/x.a",
            "number-expected",
            "the points of a table are numbers, and '1/2' is none",
        ),
        (
            {"x.a": {"times": [0, 1], "values": [0, 1], "interpolation": "linear"}},
            "/driven/x.a/interpolation",
            "literal-error",
            "'smooth' or 'monotone', found \"linear\"",
        ),
        ({"x.a": {"times": [0, 1, 2], "values": [0, 1]}}, "/driven/x.a", "wrong-length", "2 values for 3 times"),
        ({"x.a": "x.c*t"}, "/driven/x.a", "unknown-name", "unknown name 'x.c'"),
        ({"x.a": "sin("}, "/driven/x.a", "bad-expression", "expected a number"),
        ({"x.a": {"value": 1, "unit": "m"}}, "/driven/x.a", "unit-mismatch", "expected, found 1 m"),
        ({"x.a": {"input": False}}, "/driven/x.a/input", "literal-error", "expected True, found false"),
    ],
)
def test_what_cannot_drive_is_told(given: Plain, pointer: str, code: str, message: str) -> None:
    joint = {"type": "revolute", "coordinate": "a"}
    definition = {"name": "one", "bodies": [{"name": "b", "parent": "base", "mass": 1, "joint": joint}]}
    with pytest.raises(InvalidDocument, match=message) as caught:
        model(definition, given)
    assert [(fault.pointer, fault.code) for fault in caught.value.faults] == [(pointer, code)]


def test_every_fault_of_moving_closures_is_found() -> None:
    definition, names, chosen = random_driven(6)
    last = definition["bodies"][-1]["name"]
    rod = {"name": "rod", "type": "rod", "from": f"x.{last}", "to": "world", "length": 1.5}
    pin = {"name": "pin", "type": "pin", "from": f"x.{last}", "to": "world", "placement": {"position": [1, 0, 1]}}
    given = {names[k]: law(k) for k in chosen}
    spec = TreeSpec.read(document(definition, given) | {"closures": [rod, pin]})
    parts, rng = {"x": derive(Definition.read(definition))}, np.random.default_rng(0)
    here, missed, seen = couple(spec, parts), [], 0
    for kind, place, wrong in damages(here.program, rng):
        if place.startswith("closure") and has_effect(here.program, wrong):
            seen += 1
            missed += [(kind, place)] if found_in_tree(spec, parts, here, wrong) is None else []
    assert seen > 20
    assert not missed
