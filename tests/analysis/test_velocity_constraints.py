"""Equations of rolling and knife edges as formulas; Voronets and Boltzmann-Hamel give the same."""

# ruff: noqa: N806 -- symbols of the notation

from __future__ import annotations

import numpy as np
import pytest
from analysis_models import catalogue_model
from closed_trees import at, slider_crank
from random_trees import Kind, Plain, model_of, random_definition
from rolling_bodies import BLADE, FLOOR, FORWARD, A, C, M, R, disc, single, sleigh
from simulated import simulated

from substructures import Model
from substructures.analysis.closed.loops import loop_state
from substructures.analysis.equations.nonholonomic.quasi_velocities import QuasiVelocities, quasi_velocity_equations
from substructures.analysis.equations.nonholonomic.velocity_constraints import Constraint
from substructures.analysis.simulate import Closed, KnifeEdge, Linear, Outputs, Rolling, simulate
from substructures.errors import InvalidInput
from substructures.export import Interface, render
from substructures.expr.graph import Graph
from substructures.expr.interpret import interpret
from substructures.expr.parse import parse
from substructures.expr.replay import replay
from substructures.expr.rings.expand import is_zero
from substructures.quantities.numbers.evaluation import evaluate


def exact(equations: QuasiVelocities, expected: Plain) -> None:
    """Outputs of a vector or matrix against formulas as text; elements not named are zero."""
    graph = Graph()
    for name, formulas in expected.items():
        found = replay(equations.program, graph, {}, [name])[name].entries
        for index in found.keys() | formulas.keys():
            text = formulas.get(index, "0")
            assert is_zero(graph.zero + found.get(index, 0) - parse(graph, text, graph.symbol)), (name, index)


def test_chaplygin_sleigh() -> None:
    """m u' = m a w^2, (I + m a^2) w' = -m a u w (S. A. Chaplygin 1911; Neimark and Fufaev 1972; A. M. Bloch,
    Nonholonomic Mechanics and Control, 2003, section 1.7), as formulas and in both forms.
    """
    equations = quasi_velocity_equations(sleigh(), [BLADE], velocities=FORWARD)
    bias = {(0,): "-s.m*s.a*w^2", (1,): "s.m*s.a*u*w"}
    metric = {(0, 0): "s.m", (1, 1): "s.I + s.m*s.a^2"}
    structure = {(2, 0, 1): "-1", (2, 1, 0): "1"}
    exact(equations, {"metric": metric, "bias": bias, "hamel_bias": bias, "structure": structure})
    # the blade carries m a_n: centre of mass accelerates across the blade by u w + a w'
    multiplier = {(0,): "s.m*(u*w + s.a*w') - cos(s.f)*tau.s.y + sin(s.f)*tau.s.x"}
    exact(equations, {"multipliers": multiplier})


def test_formulas_print_in_every_format() -> None:
    equations = quasi_velocity_equations(sleigh(), [BLADE], velocities=FORWARD)
    interface = Interface.of_symbols(equations.program.symbols)
    for language in ("text", "latex", "python", "c", "matlab", "julia", "sympy"):
        assert len(render(equations.program, language, interface=interface)) > 500


def test_equations_are_formed_once_however_their_constraints_are_written() -> None:
    first, again = (
        quasi_velocity_equations(disc(), [Rolling("floor", "s.disc", "s.r", normal=normal)])  # type: ignore[arg-type]
        for normal in ((0, 0, 1), [0, 0, 1])
    )
    assert again.program is first.program


def test_equations_are_formed_once_for_all_places_with_the_same_velocities() -> None:
    first, beside, turned = (quasi_velocity_equations(sleigh(), [BLADE], near={"s.f": f}) for f in (0.1, 0.2, 1.5))
    assert beside.program is first.program
    assert turned.velocities != first.velocities


def test_rolling_disc() -> None:
    """Euler's equations about the line of nodes, with w3 = ph' + psi' cos th (O. M. O'Reilly, Nonlinear Dynamics 10,
    1996; Neimark and Fufaev 1972):

        (A + m r^2) th'' + (C + m r^2) w3 psi' sin th - A psi'^2 sin th cos th + m g r cos th = 0
        A (psi'' sin th + 2 psi' th' cos th) - C w3 th' = 0        (C + m r^2) w3' = m r^2 psi' th' sin th
    """
    equations = quasi_velocity_equations(disc(), [FLOOR])
    assert equations.velocities == ("s.psi'", "s.th'", "s.ph'")
    assert not equations.dependent
    rng = np.random.default_rng(2)
    angles, v = rng.uniform(0.4, 1.4, (3, 20)), rng.uniform(-3, 3, (3, 20))
    values: Plain = {"s.m": M, "s.r": R} | {s.name: 0.0 for s in equations.program.symbols if s.kind == "input"}
    values |= dict(zip(["s.psi", "s.th", "s.ph", *equations.velocities], [*angles, *v], strict=True))
    for bias in ("bias", "hamel_bias"):
        out = interpret(equations.program, values, ["metric", bias, "forces"])
        accelerations = np.linalg.solve(out["metric"], (out["forces"] - out[bias])[..., None])[..., 0]
        (dpsi, dth, dph), (ddpsi, ddth, ddph) = v, accelerations.T
        sin, cos = np.sin(angles[1]), np.cos(angles[1])
        w3, dw3 = dph + dpsi * cos, ddph + ddpsi * cos - dpsi * dth * sin
        mr2 = M * R**2
        first = (A + mr2) * ddth + (C + mr2) * w3 * dpsi * sin - A * dpsi**2 * sin * cos + M * 9.81 * R * cos
        second = A * (ddpsi * sin + 2 * dpsi * dth * cos) - C * w3 * dth
        third = (C + mr2) * dw3 - mr2 * dpsi * dth * sin
        for residual in (first, second, third):
            np.testing.assert_allclose(residual, 0, atol=1e-11)


def test_cart_on_two_wheels() -> None:
    """x' cos f + y' sin f = r (left + right) / 2 and f' = r (right - left) / (2 b), b half the track; the wheels hold
    the cart across twice, and one of these rows is left out.
    """
    planar = {"type": "planar", "coordinate": ["x", "y", "f"]}
    bodies: list[Plain] = [
        {"name": "cart", "parent": "base", "joint": planar, "mass": 5, "inertia": {"xx": 1, "zz": 1}}
    ]
    ports = []
    for side, y in (("left", "b"), ("right", "-b")):
        seat = {"position": [0, y, "r"], "rpy": [0, 0, 0]}
        joint = {"type": "revolute", "coordinate": side, "placement": seat, "axis": [0, 1, 0]}
        bodies.append({"name": side, "parent": "cart", "joint": joint, "mass": 1, "inertia": {"yy": 0.02, "zz": 0.02}})
        ports.append({"name": f"{side}_axle", "body": side, "rotation": {"rpy": ["-pi/2", 0, 0]}})
    parameters = {"b": {"value": 0.3}, "r": {"value": 0.1}}
    model = single({"name": "cart", "parameters": parameters, "bodies": bodies, "ports": ports}, [0, 0, -9.81])
    wheels = [Rolling(side, f"s.{side}_axle", "s.r") for side in ("left", "right")]
    document: Plain = {"constraints": wheels, "independent": ["s.left", "s.right"]}
    equations = quasi_velocity_equations(model, **document)
    assert (len(equations.constraints), len(equations.dependent)) == (3, 1)
    along = {(0, 0): "s.r/2*cos(s.f)", (0, 1): "s.r/2*cos(s.f)", (1, 0): "s.r/2*sin(s.f)", (1, 1): "s.r/2*sin(s.f)"}
    turning = {(2, 0): "-s.r/(2*s.b)", (2, 1): "s.r/(2*s.b)", (3, 0): "1", (4, 1): "1"}
    exact(equations, {"T": along | turning})


def random_constraints(rng: np.random.Generator, model: Model, count: int, is_affine: bool) -> list[Constraint]:
    """Coefficients are cosines and sines of coordinates, and numbers; what is given depends on coordinates and time."""
    result: list[Constraint] = []
    for k in range(count):
        terms = []
        for name in model.coordinates:
            other = model.coordinates[rng.integers(model.dof)]
            shapes = ["1", f"cos({other})", f"(2 + sin({other}))", f"({other}/3 - 1)"]
            terms.append(f"{rng.uniform(0.5, 2):.2f}*{shapes[rng.integers(4)]}*{name}'")
        if is_affine:
            terms.append(f"(1 + sin({model.coordinates[0]}))*(2 - cos({3 + k}*t))")
        result.append(Linear(f"c{k}", " + ".join(terms)))
    return result


@pytest.mark.parametrize("is_affine", [False, True])
@pytest.mark.parametrize("seed", range(4))
def test_both_forms_equal_the_equations_with_multipliers(seed: int, is_affine: bool) -> None:
    """On random trees with random constraints: q'' and lambda of [g -B^T; B 0] with B', b' from differences."""
    rng = np.random.default_rng(seed)
    kind = Kind(4, joints=("revolute", "prismatic"), massive=True, depth=4, loads=1)
    model = model_of(random_definition(rng, kind))
    document = {"constraints": random_constraints(rng, model, 1 + seed % 2, is_affine)}
    equations = quasi_velocity_equations(model, **document)
    n, p = model.dof, len(equations.velocities)
    q, v = rng.uniform(-0.8, 0.8, n), rng.uniform(-1, 1, p)
    inputs = {s.name: 0.4 for s in model.program.symbols if s.kind == "input"}
    values: Plain = inputs | dict(zip(model.coordinates, q, strict=True)) | {"t": 0.2}
    values |= dict(zip(equations.velocities, v, strict=True))
    out = interpret(equations.program, values | {f"{x}'": 0.0 for x in equations.velocities})
    np.testing.assert_allclose(out["hamel_bias"], out["bias"], rtol=0, atol=1e-11 * np.abs(out["bias"]).max())
    dv = np.linalg.solve(out["metric"], out["forces"] - out["bias"])
    qd, h = out["rates"], 1e-4

    def at(name: str, shift: float) -> np.ndarray:
        moved = values | dict(zip(model.coordinates, q + shift * qd, strict=True)) | {"t": 0.2 + shift}
        return interpret(equations.program, moved, [name])[name]

    def slope(name: str) -> np.ndarray:
        return (8 * (at(name, h) - at(name, -h)) - at(name, 2 * h) + at(name, -2 * h)) / (12 * h)

    B, b = out["constraints"], out.get("given", np.zeros(n - p))
    changed = slope("given") if is_affine else 0
    given = {"q": q, "qd": qd, "inputs": inputs, "t": 0.2}
    x = evaluate(model, ["metric", "bias", "forces"], **given)
    kkt = np.block([[x["metric"], -B.T], [B, np.zeros((n - p, n - p))]])
    solution = np.linalg.solve(kkt, np.concatenate((x["forces"] - x["bias"], -slope("constraints") @ qd - changed)))
    scale = np.abs(solution).max()
    np.testing.assert_allclose(out["T"] @ dv + slope("rates"), solution[:n], rtol=0, atol=1e-9 * scale)
    found = interpret(equations.program, values | {f"{a}'": b for a, b in zip(equations.velocities, dv, strict=True)})
    np.testing.assert_allclose(found["multipliers"], solution[n:], rtol=0, atol=1e-9 * scale)
    np.testing.assert_allclose(B @ out["T"], 0, atol=1e-12)
    np.testing.assert_allclose(B @ qd + b, 0, atol=1e-12)
    if is_affine:
        # what the constraints do: T' of all forces at q', B^T lambda among them
        assert found["constraint_power"] == pytest.approx(solution[n:] @ B @ qd, rel=1e-8)


def test_closed_loops_in_independent_velocities() -> None:
    """A slider-crank as one equation for the crank: g* is the inertia that the crank feels, J(a) of the textbooks."""
    model = slider_crank()
    document: Plain = {"constraints": [Closed("wrist")], "independent": ["x.crank"]}
    equations = quasi_velocity_equations(model, **document)
    assert equations.constraints == ("wrist.x", "wrist.y")
    request = {"q": at(model, crank=0.5, piston=0.17), "qd": at(model, crank=30), "fixed": ["x.crank"]}
    state = loop_state(model, **request)
    q, qd = state.consistent.q, state.consistent.qd
    values = {name: float(p["value"]) for name, p in model.parameters.items()}
    values |= {s.name: 0.0 for s in equations.program.symbols if s.kind == "input"}
    values |= dict(zip(model.coordinates, q, strict=True)) | {"x.crank'": 30.0, "x.crank''": state.qdd[0]}
    for bias in ("bias", "hamel_bias"):
        out = interpret(equations.program, values, ["metric", bias, "forces", "rates", "multipliers"])
        np.testing.assert_allclose(out["rates"], qd, rtol=1e-12)
        np.testing.assert_allclose(out["forces"][0] - out[bias][0], out["metric"][0, 0] * state.qdd[0], rtol=1e-9)
        np.testing.assert_allclose(out["multipliers"], state.multipliers[:2], rtol=1e-9)
    motion = simulated(model, **document, q=q, v=[30], span=(0, 0.2), count=5)
    closed = simulate(model, q, (0, 0.2), qd=qd, outputs=Outputs(count=5))
    assert motion.is_right, motion.checks
    np.testing.assert_allclose(motion.q, closed.q, atol=1e-8)


def test_rows_that_follow_from_others_are_left_out() -> None:
    twice = [BLADE, KnifeEdge("again", BLADE.frame)]
    equations = quasi_velocity_equations(sleigh(), twice)
    assert (equations.constraints, equations.dependent) == (("blade",), ("again",))


def test_constraints_with_constant_coefficients() -> None:
    """A gear between two coordinates, q'_1 = 2 q'_2: the rows have no symbol, and rank and choice are found as well."""
    model = catalogue_model("double-pendulum")
    gears = [Linear(name, "x.q1' - 2*x.q2'") for name in ("gear", "again")]
    equations = quasi_velocity_equations(model, gears)
    assert (equations.constraints, equations.dependent) == (("gear",), ("again",))
    assert equations.velocities == ("x.q2'",)
    exact(equations, {"rates": {(0,): "2*x.q2'", (1,): "x.q2'"}})


def test_what_is_given_twice_has_to_agree() -> None:
    twice = [Linear("one", "s.x' - 1"), Linear("two", "2*s.x' - 2")]
    assert quasi_velocity_equations(sleigh(), twice).dependent == ("two",)
    with pytest.raises(InvalidInput, match="'two' contradicts"):
        quasi_velocity_equations(sleigh(), [twice[0], Linear("two", "2*s.x' - 1")])


def test_velocities_and_independent_coordinates_are_not_given_together() -> None:
    with pytest.raises(InvalidInput, match="/independent: give 'velocities' or 'independent', not both"):
        quasi_velocity_equations(sleigh(), [BLADE], velocities=FORWARD, independent=["s.x", "s.f"])
