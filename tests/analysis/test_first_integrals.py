"""First integrals and Routh's reduction: what is found, that it is constant, and that nothing is missed."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
from analysis_models import catalogue_model, random_model, values_at
from in_depth import seeds
from random_trees import Kind, Plain, add_inertia, model_of, random_definition, random_states

from substructures import InvalidArgument, InvalidInput, Model
from substructures.analysis.equations.first_integrals import _found, first_integrals
from substructures.analysis.equations.integral import FirstIntegrals
from substructures.analysis.equations.routh import routh
from substructures.expr.interpret import interpret
from substructures.quantities.numbers.evaluation import evaluate
from substructures.quantities.numbers.field_state import field_state
from substructures.quantities.numbers.memo import known_model

FALL = (0, 0, -9.81)
NONE = (0, 0, 0)
SLANTED = (1, 0, "-9.81")
CENTRE = {f"galilei.{e}" for e in "xyz"}
#: of one free body: the spin of a cyclic Euler angle, and the energy of turning
FLOATING = CENTRE | {"momentum.x.yaw", "energy.x.yaw"}
HORIZONTAL = {"linear_momentum.x", "linear_momentum.y", "angular_momentum.z"}


def constant(found: FirstIntegrals) -> set[str]:
    return {i.name for i in found.integrals if i.rule == "constant"}


def drift(model: Model, found: FirstIntegrals, seed: int = 0) -> dict[str, float]:
    """Largest derivative of every integral along the equations of motion at random states, by central differences."""
    rng, h = np.random.default_rng(seed), 1e-4
    x = random_states(rng, 4, model.dof)
    qdd = evaluate(model, ["forward_dynamics"], q=x["q"], qd=x["qd"])["forward_dynamics"]
    ends = []
    for s in (h, -h):
        q = x["q"] + s * x["qd"] + 0.5 * s * s * qdd
        ends.append(interpret(found.program, values_at(model, q, x["qd"] + s * qdd, t=s)))
    return {i.name: float(np.abs(ends[0][i.name] - ends[1][i.name]).max()) / (2 * h) for i in found.integrals}


@pytest.mark.parametrize(
    ("name", "gravity", "expected"),
    [
        ("free-body", NONE, {f"{k}_momentum.{e}" for k in ("linear", "angular") for e in "xyz"} | FLOATING),
        ("free-body", FALL, HORIZONTAL | FLOATING | {"impulse.z", "spin.x", "spin.y"}),
        (
            "quadruped-trunk",
            SLANTED,
            {"linear_momentum.y", "linear_momentum.z-normal-to-force", "angular_momentum.force", "impulse.x"}
            | {"spin.x", "spin.y", *CENTRE},
        ),
        ("puma560", FALL, {"momentum.x.q1"}),
        ("puma560", SLANTED, set()),
        ("cart-pendulum", FALL, {"linear_momentum.x", "galilei.x"}),
        ("simple-pendulum", FALL, set()),
        ("reaction-wheel-pendulum", FALL, {"momentum.x.q2", "linear.1"}),
        (
            "planar-hopper",
            FALL,
            {
                "linear_momentum.x",
                "symmetry.x.pitch-x.hip",
                "spin.y",
                "impulse.z",
                "galilei.x",
                "galilei.z",
                "linear.1",
            },
        ),
    ],
)
def test_known_machines(name: str, gravity: Any, expected: set[str]) -> None:
    """A free base keeps all momenta; with gravity the horizontal ones and the vertical moment of momentum."""
    model = catalogue_model(name, gravity)
    found = first_integrals(model)
    assert constant(found) - {"energy"} == expected
    slopes = drift(model, found)
    assert max(slopes[name] for name in constant(found)) < 1e-4, slopes


@pytest.mark.parametrize(
    ("name", "gravity"),
    [("planar-hopper", FALL), ("free-body", NONE), ("furuta-pendulum", FALL), ("cart-pendulum", SLANTED)],
)
def test_told_by_values(name: str, gravity: tuple[Any, ...], monkeypatch: pytest.MonkeyPatch) -> None:
    """What values in a field rule out, or find, is what formulas do."""
    model = catalogue_model(name, gravity)
    told = []
    for state in (field_state, lambda *_: None):
        monkeypatch.setattr("substructures.analysis.equations.first_integrals.field_state", state)
        found = _found.__wrapped__(known_model(model), frozenset(), frozenset(), 1)
        told.append((found.summary(), found.program.digest))
    assert field_state(model, model.input_names) is not None
    assert told[0] == told[1]


def test_a_base_that_moves_in_a_slanted_plane() -> None:
    """With an arm that swings out of the plane: momenta along the slides, and about the normal of the plane."""
    tensor = {"xx": 0.1, "yy": 0.2, "zz": 0.3}
    slide = {"type": "planar", "coordinate": ["x", "y", "turn"], "placement": {"rpy": [0.4, 0.7, 0.3]}}
    swing = {"type": "revolute", "coordinate": "swing", "theta": "pi/2", "d": 0.3}
    bodies: list[Plain] = [
        {"name": "base_body", "parent": "base", "joint": slide, "mass": 2, "com": [0.1, 0, 0.2], "inertia": tensor},
        {"name": "arm", "parent": "base_body", "joint": swing, "mass": 1, "com": [0.5, 0, 0.1], "inertia": tensor},
    ]
    model = model_of({"name": "slope", "bodies": bodies}, NONE)
    found = first_integrals(model)
    slides = {f"linear_momentum.axis-of-x.{c}" for c in "xy"}
    assert constant(found) == {"energy", "angular_momentum.axis-of-x.turn", *slides}
    assert found.cyclic == ("x.x", "x.y")
    assert max(v for k, v in drift(model, found).items() if k in constant(found)) < 1e-6


def test_every_integral_has_unit_and_reason() -> None:
    found = first_integrals(catalogue_model("satellite"))
    assert {i.unit for i in found.integrals} == {"J", "N s", "N m s", "kg m"}
    assert found.summary()["integrals"][0]["name"] == "energy"
    assert all(len(i.reason) > 20 for i in found.integrals)
    assert set(found.program.outputs) == {i.name for i in found.integrals} | {"power"}


@pytest.mark.parametrize("number", seeds((1, 2, 3), 8))
def test_derivative_of_the_energy_is_the_power(number: int) -> None:
    """Random trees with springs, dampers and loads; and without loads the energy is constant or falls."""
    model = random_model(number)
    found = first_integrals(model)
    (energy,) = (i for i in found.integrals if i.kind == "energy")
    rng, h = np.random.default_rng(number), 1e-5
    x = random_states(rng, 3, model.dof)
    state = {"q": x["q"], "qd": x["qd"], "t": 0.2}
    qdd = evaluate(model, ["forward_dynamics"], **state)["forward_dynamics"]
    f = [
        interpret(
            found.program,
            values_at(model, x["q"] + s * x["qd"] + s * s / 2 * qdd, x["qd"] + s * qdd, t=0.2 + s),
            ["energy", "power"],
        )
        for s in (-h, 0.0, h)
    ]
    slope = (f[2]["energy"] - f[0]["energy"]) / (2 * h)
    scale = 1 + np.abs(f[1]["power"]).max() + np.abs(f[1]["energy"]).max()
    np.testing.assert_allclose(slope, f[1]["power"], rtol=0, atol=1e-6 * scale)
    quiet = first_integrals(random_model(number, loads=0))
    assert next(i for i in quiet.integrals if i.kind == "energy").rule in ("constant", "falling")
    assert energy.rule in ("constant", "falling", "balance")


def floating(number: int) -> Model:
    """A random tree of bodies with springs between them on a free body."""
    rng = np.random.default_rng(number)
    kind = Kind(3, massive=True, joints=("revolute", "prismatic"), loads=0, depth=4)
    definition = random_definition(rng, kind)
    root: Plain = {"name": "root", "parent": "base", "joint": {"type": "free"}}
    add_inertia(rng, root, full=True)
    for body in definition["bodies"]:
        body["parent"] = "root" if body["parent"] == "base" else body["parent"]
        body["joint"] |= {"stiffness": 0.3, "damping": 0.1 * (number % 2)}
    for load in definition["loads"]:
        load["from"]["body"] = "root" if load["from"]["body"] == "base" else load["from"]["body"]
    definition["bodies"].append(root)
    return model_of(definition, (0, 0, 0))


@pytest.mark.parametrize("number", seeds((1, 2), 6))  # 0 and 3 take five seconds each
def test_a_random_tree_on_a_free_base(number: int) -> None:
    """Whatever hangs on a free base, all six momenta are constant without gravity and outer loads."""
    model = floating(number)
    found = first_integrals(model)
    assert {f"{k}_momentum.{e}" for k in ("linear", "angular") for e in "xyz"} <= constant(found)
    assert max(v for k, v in drift(model, found).items() if k in constant(found)) < 1e-4


@pytest.mark.parametrize("number", seeds(4, 8))
def test_cyclic_coordinates_are_those_that_nothing_depends_on(number: int) -> None:
    """Against numbers: moving a cyclic coordinate changes neither metric nor forces; moving another one does."""
    model = random_model(number, loads=0)
    found = first_integrals(model)
    x = random_states(np.random.default_rng(number), 2, model.dof)
    names = ["metric", "forces"]
    before = evaluate(model, names, q=x["q"], qd=x["qd"])
    for a, name in enumerate(model.coordinates):
        moved = x["q"] + 0.7 * np.eye(model.dof)[a]
        after = evaluate(model, names, q=moved, qd=x["qd"])
        same = np.allclose(after["metric"], before["metric"], rtol=1e-9, atol=1e-12)
        free = np.allclose(after["forces"][:, a], 0) and np.allclose(before["forces"][:, a], 0)
        assert (name in found.cyclic) == (same and free)


def assert_amended(full: Plain, reduced: Plain, p: np.ndarray, cyclic: list[int]) -> None:
    """V_p = V + 1/2 p_c . g_cc^-1 p_c, with the inverse in numbers."""
    block = full["metric"][:, cyclic][:, :, cyclic]
    kept = np.linalg.solve(block, p[:, cyclic, None])[..., 0]
    amended = full["potential_energy"] + 0.5 * np.einsum("nc,nc->n", p[:, cyclic], kept)
    np.testing.assert_allclose(reduced["amended_potential"], amended, atol=1e-9)


@pytest.mark.parametrize(
    ("name", "gravity"),
    [
        ("gimbal-gyroscope", FALL),
        ("ball-pendulum", FALL),
        ("reaction-wheel-pendulum", FALL),
        ("ur5", FALL),
        ("cart-pendulum", FALL),
        ("free-body", NONE),
        ("flyball-governor", FALL),
    ],
)
def test_routh_reduction_moves_like_the_whole(name: str, gravity: Any) -> None:
    """h q'' + Gamma^h q' q' + B q' = f has the accelerations of the model; B is skew; V_p and Routh's function."""
    model = catalogue_model(name, gravity)
    reduced = routh(model)
    rest = [model.coordinates.index(c) for c in reduced.coordinates]
    x = random_states(np.random.default_rng(3), 3, model.dof)
    state = {"q": x["q"], "qd": x["qd"]}
    full = evaluate(model, ["forward_dynamics", "metric", "potential_energy", "kinetic_energy"], **state)
    p = np.einsum("nab,nb->na", full["metric"], x["qd"])
    momenta = {f"p.{c}": p[:, model.coordinates.index(c)] for c in reduced.cyclic}
    f = interpret(reduced.program, values_at(model, x["q"], x["qd"]) | momenta)
    v = x["qd"][:, rest]
    right = (
        f["forces"] - np.einsum("nabc,nb,nc->na", f["christoffel"], v, v) - np.einsum("nab,nb->na", f["gyroscopic"], v)
    )
    qdd = np.linalg.solve(f["metric"], right[..., None])[..., 0]
    np.testing.assert_allclose(qdd, full["forward_dynamics"][:, rest], atol=1e-9)
    np.testing.assert_allclose(f["gyroscopic"], -np.swapaxes(f["gyroscopic"], 1, 2), atol=1e-10)
    cyclic = [model.coordinates.index(c) for c in reduced.cyclic]
    np.testing.assert_allclose(f["cyclic_velocities"], x["qd"][:, cyclic], atol=1e-10)
    # R = L - p q'_c
    lagrangian = full["kinetic_energy"] - full["potential_energy"]
    routhian = lagrangian - np.einsum("nc,nc->n", p[:, cyclic], x["qd"][:, cyclic])
    np.testing.assert_allclose(f["routhian"], routhian, atol=1e-9)
    assert_amended(full, f, p, cyclic)


def test_everything_cyclic_leaves_no_coordinate() -> None:
    reduced = routh(catalogue_model("simple-pendulum", NONE))
    assert reduced.coordinates == ()
    assert reduced.momenta == ("p.x.q1",)


def test_a_coordinate_that_is_not_cyclic_is_refused() -> None:
    model = catalogue_model("puma560")
    with pytest.raises(InvalidInput, match="not a cyclic coordinate") as error:
        routh(model, ["x.q2"])
    assert error.value.faults[0].pointer == "/coordinates/0"
    with pytest.raises(InvalidInput, match="no cyclic coordinate"):
        routh(catalogue_model("simple-pendulum"))


def test_unknown_names_are_refused() -> None:
    model = catalogue_model("simple-pendulum")
    for given, pointer in (({"inputs": ["tau.y"]}, "/inputs"), ({"zero": ["x.nothing"]}, "/parameters")):
        with pytest.raises(InvalidArgument) as error:
            first_integrals(model, **given)
        assert error.value.faults[0].pointer == pointer


def test_parameters_that_are_zero_give_more() -> None:
    """Without its spring the damper's slide alone is left; a moving input takes the momentum away."""
    joint = {"type": "prismatic", "coordinate": "s", "stiffness": "k"}
    body = {"name": "b", "parent": "base", "mass": 1, "joint": joint}
    model = model_of({"name": "a", "bodies": [body], "parameters": {"k": {"value": 0}}}, NONE)
    assert constant(first_integrals(model)) == {"energy"}
    assert constant(first_integrals(model, zero=["k"])) == {"energy", "linear_momentum.z", "galilei.z"}
    assert constant(first_integrals(model, ["tau.x.s"], ["k"])) == set()


def test_a_coordinate_without_inertia_is_named() -> None:
    bodies = [{"name": "b", "parent": "base", "joint": {"type": "revolute", "coordinate": "q1"}}]
    with pytest.raises(InvalidInput, match=r"'x\.q1' has no inertia"):
        first_integrals(model_of({"name": "empty", "bodies": bodies}))
