"""First integrals of trees with ball and floating joints: tops, free bodies, and the theorem behind cyclic rates."""

# ruff: noqa: N806 -- symbols of the notation

from __future__ import annotations

from fractions import Fraction
from typing import Any

import numpy as np
import pytest
from ball_trees import random_balls, random_position
from scipy.spatial.transform import Rotation

from substructures import Integrator, Model, Outputs, couple, derive, first_integrals, simulate
from substructures.analysis.equations.first_integrals import acting_inputs
from substructures.analysis.equations.formulas import ModelFormulas
from substructures.certificate.derived.integrals import constant
from substructures.errors import VerificationFailed
from substructures.expr.interpret import interpret
from substructures.expr.program import Program, array, program
from substructures.quantities.certificate import certified

Plain = dict[str, Any]
NEEDS = ("metric", "bias", "forces", "potential_energy", "linear_momentum", "angular_momentum")
WHOLE = [f"{kind}.{axis}" for kind in ("linear_momentum", "angular_momentum") for axis in "xyz"]


def model_of(*bodies: Plain, gravity: Any = (0, 0, "-9.81"), **more: Any) -> Model:
    tree = {"name": "t", "gravity": list(gravity), "instances": [{"name": "x", "substructure": "d"}]}
    return couple(tree, {"x": derive({"name": "d", "bodies": list(bodies), **more})})


def body(joint: str, inertia: Plain, com: Any = (0, 0, 0), name: str = "b", parent: str = "base") -> Plain:
    return {"name": name, "parent": parent, "mass": 2, "com": list(com), "inertia": inertia, "joint": {"type": joint}}


def round_about(axis: str, own: str = "3/10", across: str = "1/5") -> Plain:
    return {name: own if name == axis * 2 else across for name in ("xx", "yy", "zz")}


def names_of(model: Model, rule: str = "constant", **more: Any) -> set[str]:
    return {each.name for each in first_integrals(model, **more).integrals if each.rule == rule}


def at(model: Model, q: Any, qd: Any, **more: float) -> dict[str, float]:
    """The values of all integrals at a state."""
    found = first_integrals(model)
    values = dict(zip(model.positions, q, strict=True)) | {"t": 0.0} | more
    values |= {f"{name}'": x for name, x in zip(model.coordinates, qd, strict=True)}
    values = {s.name: values[s.name] for s in found.program.symbols}
    names = [each.name for each in found.integrals]
    return {name: float(x) for name, x in interpret(found.program, values, names).items()}


def test_tops() -> None:
    """Of Euler's top the momentum in space is constant, of Lagrange's C w_z and that about the vertical; of both the
    energy, and nothing else where three moments of inertia differ.
    """
    triple = {"xx": "1/5", "yy": "1/4", "zz": "3/10"}
    assert names_of(model_of(body("ball", triple), gravity=(0, 0, 0))) == {"energy", *WHOLE[3:]}
    assert names_of(model_of(body("ball", triple, (0, 0, "1/2")))) == {"energy", "angular_momentum.z"}
    lagrange = model_of(body("ball", round_about("z"), (0, 0, "1/2")))
    assert names_of(lagrange) == {"energy", "angular_momentum.z", "momentum.x.w_b_z"}
    assert first_integrals(lagrange).cyclic == ("x.w_b_z",)
    assert names_of(model_of(body("ball", round_about("z"), ("1/9", 0, "1/2")))) == {"energy", "angular_momentum.z"}
    turn, w = Rotation.from_rotvec([0.3, -0.5, 0.2]), np.array([0.4, 0.1, 2.0])
    found = at(lagrange, turn.as_quat(scalar_first=True), w)
    J = np.diag([0.2 + 2 / 4, 0.2 + 2 / 4, 0.3])
    assert found["momentum.x.w_b_z"] == pytest.approx(0.3 * 2.0)
    assert found["angular_momentum.z"] == pytest.approx((turn.apply(J @ w))[2])
    assert found["energy"] == pytest.approx(w @ J @ w / 2 + 2 * 9.81 * turn.apply([0, 0, 0.5])[2])
    motion = simulate(lagrange, turn.as_quat(scalar_first=True), (0, 3), qd=w, outputs=Outputs(count=11))
    assert motion.is_right is True
    assert {"momentum.x.w_b_z", "angular_momentum.z"} < {check.name for check in motion.checks if check.holds}
    np.testing.assert_allclose(motion.series["momentum.x.w_b_z"], 0.6, rtol=1e-9)


def test_a_body_that_is_round_about_an_axis_between_those_of_its_joint() -> None:
    n = np.array([3, 4, 0]) / 5
    J = 0.2 * np.eye(3) + 0.1 * np.outer(n, n)
    found = first_integrals(
        model_of(
            body("ball", {"xx": "118/500", "yy": "132/500", "zz": "1/5", "xy": "24/500"}, (0, 0, 0)), gravity=(0, 0, 0)
        )
    )
    assert pytest.approx([0.236, 0.264, 0.048]) == [J[0, 0], J[1, 1], J[0, 1]]
    (along,) = [each for each in found.integrals if each.kind == "symmetry"]
    c = {name: float(Fraction(x)) for name, x in along.direction.items()}
    assert c["x.w_b_y"] / c["x.w_b_x"] == pytest.approx(4 / 3)


def test_a_free_body_in_gravity() -> None:
    """Ten independent integrals of six coordinates with the time: their values by Newton and Euler."""
    com = np.array([0.1, -0.2, 0.3])
    model = model_of(body("floating", {"xx": "1/5", "yy": "1/4", "zz": "3/10"}, ("1/10", "-1/5", "3/10")))
    expected = {"energy", *WHOLE[:2], "angular_momentum.z", "impulse.z", "spin.x", "spin.y"}
    assert names_of(model) == expected | {f"galilei.{axis}" for axis in "xyz"}
    turn, place = Rotation.from_rotvec([0.7, 0.2, -0.4]), np.array([1.0, 2.0, 0.5])
    v, w, t = np.array([0.3, -0.1, 0.2]), np.array([0.5, 0.6, -0.7]), 0.8
    found = at(model, [*place, *turn.as_quat(scalar_first=True)], [*v, *w], t=t)
    P = 2 * turn.apply(v + np.cross(w, com))
    spin, s = turn.apply(np.diag([0.2, 0.25, 0.3]) @ w), 2 * (place + turn.apply(com))
    F = np.array([0, 0, -2 * 9.81])
    for i, axis in enumerate("xyz"):
        assert found[f"galilei.{axis}"] == pytest.approx((s - P * t + F * t * t / 2)[i])
    assert found["impulse.z"] == pytest.approx(P[2] - F[2] * t)
    assert [found["spin.x"], found["spin.y"]] == pytest.approx(spin[:2])
    assert found["angular_momentum.z"] == pytest.approx((spin + np.cross(s / 2, P))[2])


def test_pendulums_side_by_side_have_energies_of_their_own() -> None:
    joined = [body("ball", {"xx": 1, "yy": 1, "zz": 1}, (0, 0, "-1/2"), name, "base") for name in "ab"]
    found = names_of(model_of(*joined))
    assert {"energy", "energy.x.w_a_x", "energy.x.w_b_x", "momentum.x.w_a_z", "momentum.x.w_b_z"} <= found
    rough = simulate(model_of(*joined), [1, 0, 0, 0] * 2, (0, 9), qd=[1, 2, 3, 3, 2, 1],
                     integrator=Integrator("RK23", 1e-3, 1e-3))  # fmt: skip
    assert rough.is_right is False
    assert "energy.x.w_a_x" in {check.name for check in rough.checks if check.holds is False}


@pytest.mark.parametrize("seed", [3, 8])
def test_momenta_change_by_what_stands_for_slopes_of_the_metric(seed: int) -> None:
    """p_c' = 1/2 d_c g_ab v^a v^b + Q_c along the equations of motion, of all rates of random trees."""
    definition, rng = random_balls(seed, 2)
    model = couple(
        {"name": "t", "gravity": [1, 2, -9], "instances": [{"name": "x", "substructure": "d"}]},
        {"x": derive(definition)},
    )
    f = ModelFormulas(model)
    twice = [f.graph.zero] * f.n
    for (a, b, c), x in f.metric_slopes.items():
        twice[c] = twice[c] + (1 + (a != b)) * x * f.rates[a] * f.rates[b]
    left = [rate - x / 2 - Q for rate, x, Q in zip(f.rate(f.momenta), twice, f.vector("forces"), strict=True)]
    source = program(
        f.graph, {"left": array((f.n,), left.__getitem__), "size": array((f.n,), twice.__getitem__)}, f.symbols
    )
    values = {s.name: float(x) for s, x in zip(source.symbols, rng.uniform(0.5, 1.5, 400), strict=False)}
    values |= dict(zip(model.positions, random_position(rng, model), strict=True))
    found = interpret(source, values, ["left", "size"])
    np.testing.assert_allclose(found["left"], 0, atol=1e-10 * np.abs(found["size"]).max())


def test_what_is_not_constant_is_found() -> None:
    """Each number of the program of the integrals, changed; and a momentum that is none."""
    model = model_of(body("ball", round_about("z"), (0, 0, "1/2")))
    right = first_integrals(model)
    told = [vars(each) for each in right.integrals]

    def require(source: Program, integrals: list[Plain]) -> None:
        unused = {s.name for s in model.program.symbols if s.kind == "input"} - set(acting_inputs(model))
        certified(source, model, constant(source, integrals, (), None, model.balls), "x", needs=NEEDS, zero=unused)

    require(right.program, told)
    numbers = [i for i, operation in enumerate(right.program.operations) if operation[0] == "rat"]
    for i in numbers:
        op, top, bottom = right.program.operations[i]
        wrong = [*right.program.operations[:i], (op, str(int(top) + 7), bottom), *right.program.operations[i + 1 :]]
        with pytest.raises(VerificationFailed):
            require(Program(right.program.symbols, tuple(wrong), right.program.outputs), told)
    assert len(numbers) > 2
    triple = model_of(body("ball", {"xx": "1/5", "yy": "1/4", "zz": "3/10"}, (0, 0, "1/2")))
    expected = constant(right.program, told, (), None, triple.balls)
    with pytest.raises(VerificationFailed):
        certified(right.program, triple, expected, "x", needs=NEEDS)
