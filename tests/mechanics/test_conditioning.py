"""Accelerations that rounding makes doubtful are told, with a number; scales of any size make no others wrong."""

# ruff: noqa: N806 -- symbols of the notation

from __future__ import annotations

from functools import cache
from typing import Any

import mpmath
import numpy as np
import pytest
from random_trees import Plain, model_of

from substructures import Definition, Model, TreeSpec, couple, derive
from substructures.expr.interpret import interpret_in_blocks
from substructures.mechanics.accelerations import condition, definite_solve
from substructures.quantities.derivative_directions import Direction
from substructures.quantities.derivatives import forward_dynamics
from substructures.quantities.formulas import derived
from substructures.quantities.numbers.evaluation import EvaluationOptions, evaluate
from substructures.quantities.sources import Sources

FD = "forward_dynamics"
EPS = float(np.finfo(float).eps)


@cache
def three_links(m: str = "", length: str = "") -> Model:
    """Point masses m0, m1, m2 at the ends of three links of lengths L0, L1, L2; or all alike, as numbers."""
    bodies: list[Plain] = []
    for k in range(3):
        row = {"theta": "pi/2"} if k == 0 else {"d": length or f"L{k - 1}"}
        joint = {"type": "revolute", "coordinate": f"q{k}", **row}
        parent = "base" if k == 0 else f"b{k - 1}"
        body = {"name": f"b{k}", "parent": parent, "joint": joint, "mass": m or f"m{k}"}
        bodies.append(body | {"com": [length or f"L{k}", 0, 0]})
    parameters = {f"{name}{k}": {"value": 1} for name in "mL" for k in range(3)}
    return model_of({"name": "x", "parameters": parameters, "bodies": bodies}, (0, 0, 0))


Q: Plain = {"q": [0.1, 0.7, 1.2], "qd": [0.3, 0.2, 0.1]}


@pytest.mark.parametrize("exponent", [-140, -120, -100, -86, -85, -84, -80, -60, 60, 80, 100, 140])
@pytest.mark.parametrize("of", ["L", "m"])
def test_free_motion_does_not_depend_on_the_scale(of: str, exponent: int) -> None:
    """m L^2 is a factor of g and Gamma alike: products of two entries of g leave the range of numbers long before g.

    The numbers are those of parameters, and are parts of the formulas.
    """
    exact, same = evaluate(three_links(), FD, **Q)[FD], evaluate(three_links(), "condition", **Q)["condition"]
    scaled = {f"{of}{k}": 10.0**exponent for k in range(3)}
    numbers = three_links("1", f"1e{exponent}") if of == "L" else three_links(f"1e{exponent}", "1")
    for found in (evaluate(three_links(), [FD, "condition"], **Q, parameters=scaled), evaluate(numbers, FD, **Q)):
        assert not found.failures
        assert not found.warnings
        np.testing.assert_allclose(found[FD], exact, rtol=1e-12)
    found = evaluate(three_links(), "condition", **Q, parameters=scaled)
    assert found["condition"] == pytest.approx(same, rel=1e-9)


def test_one_state_of_many_is_solved_anew_and_the_others_are_what_they_were() -> None:
    model = three_links()
    lengths = 10.0 ** np.array([0, -120, 0, 100, -151, 154, -170])
    found = evaluate(model, FD, q=np.tile(Q["q"], (7, 1)), qd=Q["qd"], parameters={f"L{k}": lengths for k in range(3)})
    np.testing.assert_allclose(found[FD][:4], np.tile(found[FD][0], (4, 1)), rtol=1e-12)
    told = {failure.state: (failure.code, failure.message) for failure in found.failures}
    assert sorted(told) == [4, 5, 6]
    assert told[4][0] == "underflow"
    assert told[5][0] == "overflow"
    assert "overflow" in told[5][1]
    assert "not positive definite" not in told[5][1]
    # all of g is 0: nobody can tell that from bodies without inertia
    assert "1e-308" in told[6][1]


def test_derivatives_out_of_range_have_no_result() -> None:
    model = three_links()
    along = Direction(q=[1, 0, 0])
    found = evaluate(
        model,
        f"{FD}_derivative",
        **Q,
        parameters={f"L{k}": 1e-90 for k in range(3)},
        options=EvaluationOptions(along=along),
    )
    (failure,) = found.failures
    assert failure.code == "out-of-range"
    assert not evaluate(model, f"{FD}_derivative", **Q, options=EvaluationOptions(along=along)).failures


def ball() -> Model:
    """A body on a spherical joint: yaw, pitch, roll."""
    joint = {"type": "spherical", "coordinate": ["a", "b", "c"]}
    inertia = {"xx": 0.1, "yy": 0.2, "zz": 0.25}
    body = {"name": "b", "parent": "base", "joint": joint, "mass": 2, "com": [0.1, 0.2, 0.3], "inertia": inertia}
    return model_of({"name": "ball", "bodies": [body]}, (0, 0, "-9.81"))


def euler(q: Any, qd: Any) -> Any:
    """The same by Euler's equations in 60 digits: J w' + w x J w = M, w = B(q) q' in the axes of the body."""
    mpmath.mp.dps = 60
    _, b, c = (mpmath.mpf(float(x)) for x in q)
    v = mpmath.matrix([mpmath.mpf(float(x)) for x in qd])
    sb, cb, sc, cc = mpmath.sin(b), mpmath.cos(b), mpmath.sin(c), mpmath.cos(c)
    B = mpmath.matrix([[-sb, 0, 1], [cb * sc, cc, 0], [cb * cc, -sc, 0]])
    # B' of q' = (a', b', c')
    rate = mpmath.matrix(
        [
            [-cb * v[1], 0, 0],
            [-sb * sc * v[1] + cb * cc * v[2], -sc * v[2], 0],
            [-sb * cc * v[1] - cb * sc * v[2], -cc * v[2], 0],
        ]
    )
    h = mpmath.matrix([mpmath.mpf(x) / 10 for x in (1, 2, 3)])
    J = mpmath.diag([mpmath.mpf(1) / 10, mpmath.mpf(2) / 10, mpmath.mpf(25) / 100])
    J += 2 * ((h.T * h)[0] * mpmath.eye(3) - h * h.T)
    down = mpmath.mpf(981) / 100 * mpmath.matrix([sb, -cb * sc, -cb * cc])

    def cross(x: Any, y: Any) -> Any:
        return mpmath.matrix([x[1] * y[2] - x[2] * y[1], x[2] * y[0] - x[0] * y[2], x[0] * y[1] - x[1] * y[0]])

    w = B * v
    moment = 2 * cross(h, down) - cross(w, J * w)
    found = mpmath.lu_solve(B, mpmath.lu_solve(J, moment) - rate * v)
    return np.array([float(x) for x in found])


def test_the_error_beside_a_singular_position_is_told() -> None:
    """2 % at 1e-7 rad: the stated error bounds the true one, and is not said where there is none."""
    model, rng = ball(), np.random.default_rng(7)
    distance = np.repeat(10.0 ** -np.array([0.5, 3, 5, 6, 7]), 8)
    angles, qd = rng.uniform(-3, 3, (2, len(distance))), rng.uniform(-1, 1, (len(distance), 3))
    q = np.stack([angles[0], np.pi / 2 - distance, angles[1]], axis=1)
    found = evaluate(model, [FD, "condition"], q=q, qd=qd)
    exact = np.array([euler(*pair) for pair in zip(q, qd, strict=True)])
    error = np.abs(found[FD] - exact).max(axis=1) / np.abs(exact).max(axis=1)
    assert not found.failures
    assert (error <= 30 * EPS * found["condition"]).all()
    # condition numbers of [[1, s], [s, 1]] are (1 + s)/(1 - s), 4 over the square of the distance
    assert (found["condition"][8:] * distance[8:] ** 2 > 1).all()
    warned = {warning["state"] for warning in found.warnings}
    assert warned == set(range(16, 40))
    assert max(error[32:]) > 1e-3
    one = evaluate(model, FD, q=q[-1], qd=qd[-1])
    (warning,) = one.warnings
    assert [warning[key] for key in ("pointer", "code", "quantity")] == ["/q", "ill-conditioned", FD]
    assert "condition number" in warning["message"]
    assert one.plain()["warnings"][0]["state"] == 0


def test_states_that_are_too_near_have_no_accelerations() -> None:
    found = evaluate(ball(), FD, q=[0.3, np.pi / 2, 0.4])
    (failure,) = found.failures
    assert failure.code == "not-finite"
    assert "singular" in failure.message
    assert not found.warnings


def test_accelerations_by_numbers_are_judged_like_those_by_formulas() -> None:
    """Models too large for formulas of q''."""

    def small(model: Model, name: str) -> Any:
        return forward_dynamics(model, 3) if name == FD else derived(model, name)

    model, q = ball(), [[0.3, 0.2, 0.1], [0.3, np.pi / 2 - 1e-6, 0.4], [0.3, np.pi / 2, 0.4]]
    for sources in (None, Sources(model, small)):
        found = evaluate(sources or model, FD, q=q, qd=[0.1, 0.2, 0.3])
        assert [warning["state"] for warning in found.warnings] == [1]
        assert [failure.state for failure in found.failures] == [2]


def test_closed_loops_are_warned_of() -> None:
    """The body on its spherical joint, and a rod from its tip to the world, far from and beside pitch = pi/2."""
    joint = {"type": "spherical", "coordinate": ["a", "b", "c"]}
    tip = {"name": "tip", "body": "b", "position": [0.5, 0.1, 0]}
    body = {"name": "b", "parent": "base", "joint": joint, "mass": 2, "inertia": {"xx": 0.1, "yy": 0.2, "zz": 0.25}}
    part = derive(Definition.read({"name": "ball", "bodies": [body], "ports": [tip]}))
    for pitch, warned in ((0.7, False), (np.pi / 2 - 1e-6, True)):
        q = [0.3, pitch, 0.4]
        instance = {"name": "x", "substructure": "ball"}
        place = evaluate(couple(TreeSpec.read({"name": "t", "instances": [instance]}), {"x": part}), "kinematics", q=q)
        length = float(np.linalg.norm(place["kinematics"]["position"][place.frames.index("x.tip")] - [1, 0, 1]))
        rod = {"name": "rod", "type": "rod", "from": "x.tip", "placement": {"position": [1, 0, 1]}, "length": length}
        model = couple(
            TreeSpec.read({"name": "t", "gravity": [0, 0, 0], "instances": [instance], "closures": [rod]}), {"x": part}
        )
        found = evaluate(model, FD, q=q)
        assert not found.failures, found.failures
        assert bool(found.warnings) is warned, (pitch, found.warnings)


def test_forces_that_are_not_finite_are_not_called_a_singular_metric() -> None:
    slide = {"name": "b", "parent": "base", "joint": {"type": "prismatic", "coordinate": "s"}, "mass": 1}
    force = {"type": "joint", "coordinate": "s", "force": "1/s"}
    found = evaluate(model_of({"name": "x", "bodies": [slide], "loads": [force]}), FD, q=[[0], [1]])
    (failure,) = found.failures
    assert (failure.state, failure.code) == (0, "not-finite")
    assert "vector of forces" in failure.message
    assert "definite" not in failure.message


def test_condition_numbers() -> None:
    """Of matrices whose eigenvalues are known; whatever the units; infinite and NaN where there is none."""
    s = np.array([0.5, 1 - 1e-6])
    g = np.stack([np.ones(2), s, s, np.ones(2)], axis=1).reshape(2, 2, 2)
    scale = np.diag([1e60, 1e-70])
    np.testing.assert_allclose(condition(g), (1 + s) / (1 - s), rtol=1e-9)
    np.testing.assert_allclose(condition(scale @ g @ scale), (1 + s) / (1 - s), rtol=1e-9)
    bad = np.array([[[1.0, 2], [2, 1]], [[0, 0], [0, 1]], [[np.nan, 0], [0, 1]], [[np.inf, 0], [0, 1]]])
    np.testing.assert_array_equal(condition(bad), [np.inf, np.inf, np.nan, np.nan])
    x, pivots = definite_solve(g, np.ones((2, 2)))
    np.testing.assert_allclose(np.einsum("nij,nj->ni", g, x), 1)
    np.testing.assert_allclose(pivots, np.stack([np.ones(2), 1 - s * s], axis=1), rtol=1e-9)


def test_formulas_alone_are_wrong_beyond_the_range() -> None:
    """What the careful way is for: without it these accelerations are finite, and off by tens of percent."""
    model = three_links("1", "1e-84")
    values = {name: np.full(1, x) for name, x in zip(model.coordinates, Q["q"], strict=True)}
    values |= {f"{name}'": np.full(1, x) for name, x in zip(model.coordinates, Q["qd"], strict=True)}
    program = derived(model, FD)
    values |= {s.name: np.zeros(1) for s in program.symbols if s.name not in values}
    bare = interpret_in_blocks(program, values, [FD], 1)[FD][0]
    assert np.isfinite(bare).all()
    assert np.abs(bare - evaluate(model, FD, **Q)[FD]).max() > 0.1
