"""The adjoint gradient against finite differences, the adjoint equations against the variational ones."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
from analysis_models import shipped
from in_depth import seeds
from random_trees import Kind, Plain, model_of, random_definition, with_parameters
from scipy.integrate import solve_ivp

from substructures import InvalidInput, MissingValue, Model
from substructures.analysis.control.adjoint import adjoint_equations
from substructures.analysis.control.closed_start import start_state
from substructures.analysis.control.cost_gradient import cost_gradient
from substructures.analysis.control.from_fields import control_arguments
from substructures.analysis.control.problem import ControlProblem, Cost, inputs_of
from substructures.analysis.control.shooting import Shooting
from substructures.export import FORMATS, Interface, render
from substructures.expr.interpret import interpret
from substructures.quantities.derivative_directions import Direction
from substructures.quantities.numbers.evaluation import EvaluationOptions, evaluate

STENCIL = np.array([-2, -1, 1, 2])


def central(values: Any, h: float) -> float:
    """Derivative from values at the points of STENCIL."""
    return float(values[0] - 8 * values[1] + 8 * values[2] - values[3]) / (12 * h)


def random_problem(seed: int) -> tuple[Model, Plain]:
    """A tree with loads, springs, dampers and parameters, and a cost that depends on everything."""
    rng = np.random.default_rng(5100 + seed)
    definition: Plain = {"bodies": []}
    while not 2 <= sum(np.size(b["joint"].get("coordinate", [])) for b in definition["bodies"]) <= 6:
        kind = Kind(4, chain=seed % 2 == 0, joints=("revolute", "revolute", "prismatic", "universal"), massive=True)
        definition = random_definition(rng, kind)
    model = model_of(with_parameters(rng, definition, 0.3))
    n, inputs, parameters = model.dof, inputs_of(model), list(model.parameters)
    controls = [str(name) for name in rng.permutation(inputs)[:2]]
    some = [str(name) for name in rng.permutation(parameters)[:3]]
    q, v, u = model.coordinates[0], f"{model.coordinates[-1]}'", controls[0]
    running = f"{u}^2 + sin({q})*{v} + 0.1*t*{v}^2" + (f" + {some[0]}*{q}^2" if some else "")
    terminal = f"{v}^2 + cos({q})" + (f"*{some[-1]}" if some else "")
    request = {
        "controls": controls,
        "cost": Cost(running, terminal),
        "horizon": 0.4,
        "intervals": 3,
        "steps": 2,
        "hold": ("linear", "constant")[seed % 2],
        "q": list(rng.uniform(-0.5, 0.5, n)),
        "qd": list(rng.uniform(-0.5, 0.5, n)),
        "t": 0.2,
        "inputs": {name: 0.3 for name in inputs if name not in controls},
        "vary": some,
    }
    nodes = 4 - seed % 2
    return model, request | {"values": {name: list(rng.uniform(-1, 1, nodes)) for name in controls}}


@pytest.mark.parametrize("seed", seeds(3, 6))
def test_gradient_against_finite_differences(seed: int) -> None:
    """By the controls, the states at the starts, and parameters, of the cost and of the state at an end: 1e-6."""
    model, request = random_problem(seed)
    segments = (1, 3)[seed // 3]
    vary = request["vary"]
    problem = ControlProblem(**{name: x for name, x in request.items() if name not in ("values", "vary")})
    begin = start_state(model, problem)
    shooting = Shooting(model, problem, begin, vary, segments)
    rng, nominal = np.random.default_rng(seed), dict(shooting.values)
    controls = rng.uniform(-1, 1, (problem.nodes, 2))
    start = begin.x + rng.uniform(-0.1, 0.1, (segments, 2 * model.dof))
    weight = rng.uniform(-1, 1, start.shape)
    slope = shooting.pullback(shooting.run(start, controls), np.stack([0 * weight, weight]), np.array([1.0, 0.3]))

    def along(dx: Any, du: Any, dp: Plain) -> Any:
        """Derivatives of the two numbers by central differences."""
        found = []
        for k in STENCIL * 1e-3:
            shooting.values = nominal | {name: nominal[name] + k * x for name, x in dp.items()}
            run = shooting.run(start + k * dx, controls + k * du)
            found.append([run.cost, float(np.sum(weight * run.end)) + 0.3 * run.cost])
        return (found[0] - 8 * np.array(found[1]) + 8 * np.array(found[2]) - found[3]) / (12e-3)

    for _ in range(4):
        dx, du = rng.uniform(-1, 1, start.shape), rng.uniform(-1, 1, controls.shape)
        exact = np.einsum("wsx,sx->w", slope.start, dx) + np.einsum("wkm,km->w", slope.controls, du)
        np.testing.assert_allclose(exact, along(dx, du, {}), rtol=1e-6, atol=1e-7 * np.abs(exact).max())
    for i, name in enumerate(vary):
        exact = slope.parameters[:, i]
        np.testing.assert_allclose(exact, along(0, 0, {name: 1}), rtol=1e-6, atol=1e-7 * np.abs(slope.parameters).max())


def test_gradient_of_a_request() -> None:
    """The same from the document, entry by entry."""
    model = shipped("cart-pendulum")
    request: Plain = {
        "controls": ["tau.x.q0"],
        "cost": Cost("tau.x.q0^2 + x.m1*x.q1'^2", "(x.q0 - 1)^2"),
        "horizon": 0.5,
        "intervals": 3,
        "q": {"x.q0": 0.1, "x.q1": 2},
        "qd": [0.3, -0.4],
        "values": {"tau.x.q0": [1, -1, 2, 0]},
        "vary": ["x.m1"],
    }
    found, h = cost_gradient(model, **control_arguments(**request)), 1e-3

    def slope(changed: Any) -> Any:
        return pytest.approx(
            central([cost_gradient(model, **control_arguments(**request | changed(h * k))).cost for k in STENCIL], h),
            rel=1e-8,
        )

    assert found.status == "finished"
    assert found.q[1] == slope(lambda e: {"q": [0.1, 2 + e]})
    assert found.qd[0] == slope(lambda e: {"qd": [0.3 + e, -0.4]})
    assert found.controls[2, 0] == slope(lambda e: {"values": {"tau.x.q0": [1, -1, 2 + e, 0]}})
    assert found.parameters["x.m1"] == slope(lambda e: {"parameters": {"x.m1": 0.2 + e}})
    motion = found.trajectory
    np.testing.assert_allclose(motion.series["controls"][:, 0], [1, -1, 2, 0], atol=1e-15)
    assert (motion.t[-1], motion.steps) == (pytest.approx(0.5), 3)
    assert motion.series["costates"][-1] == pytest.approx([2 * (motion.q[-1, 0] - 1), 0, 0, 0])


def test_adjoint_equations_are_transposed_perturbation_equations() -> None:
    """lambda . (df/dx dx) from the formulas equals lambda_q . dq' + lambda_qd . d(q'') by forward mode."""
    model, request = random_problem(2)
    rng, n = np.random.default_rng(3), model.dof
    e = adjoint_equations(model, request["controls"], Cost())
    q, qd, dq, dqd, lq, lqd = rng.uniform(-0.7, 0.7, (6, n))
    du = {name: float(rng.uniform(-1, 1)) for name in request["controls"]}
    state = {"q": q, "qd": qd, "t": 0.3, "inputs": {"x.u1": 0.4} if "x.u1" in inputs_of(model) else {}}
    along = {"q": dq, "qd": dqd, "inputs": du}
    quantities = ["forward_dynamics", "forward_dynamics_derivative", "metric"]
    answer = evaluate(model, quantities, **state, options=EvaluationOptions(along=Direction(**along)))
    slope = answer["forward_dynamics_derivative"]
    values: dict[str, Any] = {name: float(p["value"]) for name, p in model.parameters.items()}
    values |= dict.fromkeys(inputs_of(model), 0.0) | state["inputs"] | {"t": 0.3, "lambda.0": 1.0}
    for names, x in (
        (e.names(), q),
        (e.names(primes="'"), qd),
        (e.names(primes="''"), answer["forward_dynamics"]),
        (e.names("lambda."), lq),
        (e.names("lambda.", "'"), lqd),
        (e.names("mu."), np.linalg.solve(answer["metric"], lqd)),
    ):
        values |= dict(zip(names, x, strict=True))
    found = interpret(e.program, values)
    by_adjoint = -found["adjoint_q"] @ dq - found["adjoint_qd"] @ dqd
    by_adjoint += found["control_gradient"] @ [du[name] for name in e.controls]
    assert by_adjoint == pytest.approx(lq @ dqd + lqd @ slope, rel=1e-11)
    assert found["hamiltonian"] == pytest.approx(lq @ qd + lqd @ answer["forward_dynamics"])


def test_multipliers_converge_to_the_costates() -> None:
    """A pendulum with q'' = -a sin q + b u: the continuous adjoint equations integrated to 1e-10."""
    model = shipped("simple-pendulum")
    (q,), (u,) = model.coordinates, inputs_of(model)
    answer = evaluate(model, ["metric", "gravity"], q=[0.5])
    request: Plain = {
        "controls": [u],
        "cost": Cost(f"{q}^2 + {u}^2", f"3*{q}'"),
        "horizon": 1.0,
        "intervals": 40,
        "steps": 10,
        "q": [0.5],
        "values": {u: 0.2},
    }
    found = cost_gradient(model, **control_arguments(**request))
    g = float(answer["metric"][0, 0])
    a, b = -float(answer["gravity"][0]) / g / np.sin(0.5), 1 / g

    def rates(_t: float, x: Any) -> Any:
        return [x[1], -a * np.sin(x[0]) + 0.2 * b]

    motion = solve_ivp(rates, (0, 1), [0.5, 0], rtol=1e-11, atol=1e-12, dense_output=True)

    def adjoint(t: float, lam: Any) -> Any:
        return [-(2 * motion.sol(t)[0] - a * np.cos(motion.sol(t)[0]) * lam[1]), -lam[0]]

    back = solve_ivp(adjoint, (1, 0), [0, 3], rtol=1e-11, atol=1e-12, t_eval=[1, 0.5, 0])
    lam = found.trajectory.series["costates"]
    np.testing.assert_allclose(lam[[-1, 200, 0]], back.y.T, rtol=1e-7, atol=1e-8)
    assert found.trajectory.q[-1, 0] == pytest.approx(motion.y[0, -1], rel=1e-9)


@pytest.mark.parametrize("hold", ["linear", "constant"])
def test_the_hamiltonian_at_every_time_and_at_the_end(hold: Any) -> None:
    """A mass on a slide, m q'' = u: H = q^2 + t u + lambda_q q' + lambda_qd u / m, and lambda(T) = (2 q, 3)."""
    slide = {"name": "b", "parent": "base", "joint": {"type": "prismatic", "coordinate": "q"}, "mass": 2}
    model = model_of({"name": "slide", "bodies": [slide]}, (0, 0, 0))
    u = [0.5, -1.0, 2.0, 7.0][: 3 + (hold == "linear")]
    request: Plain = {
        "controls": ["tau.x.q"],
        "cost": Cost("x.q^2 + t*tau.x.q", "x.q^2 + 3*x.q'"),
        "q": [0.4],
        "qd": [1.0],
    }
    request |= {"horizon": 0.6, "intervals": 3, "steps": 2, "hold": hold, "t": 0.3, "values": {"tau.x.q": u}}
    motion = cost_gradient(model, **control_arguments(**request)).trajectory
    nodes = 0.3 + 0.2 * np.arange(len(u))
    force = np.interp(motion.t, nodes, u) if hold == "linear" else np.repeat(u, [2, 2, 3])
    q, qd, lam = motion.q[:, 0], motion.qd[:, 0], motion.series["costates"]
    expected = q**2 + motion.t * force + lam[:, 0] * qd + lam[:, 1] * force / 2
    np.testing.assert_allclose(lam[-1], [2 * q[-1], 3], rtol=1e-13)
    np.testing.assert_allclose(motion.series["hamiltonian"], expected, rtol=1e-12)


def test_formulas_print_in_every_format_and_cost_little() -> None:
    model = shipped("puma560")
    controls = inputs_of(model)
    program = adjoint_equations(model, controls, Cost(running=" + ".join(f"{u}^2" for u in controls))).program
    primal = model.program.count(["metric", "bias", "forces"])["total"]
    assert program.count(["adjoint_q", "adjoint_qd", "control_gradient"])["total"] < 3 * primal
    assert type(program).from_bytes(program.to_bytes()) == program
    small = adjoint_equations(shipped("simple-pendulum"), inputs_of(shipped("simple-pendulum")), Cost()).program
    interface = Interface.of_symbols(small.symbols)
    for form in FORMATS:
        assert "adjoint" in render(small, form, interface=interface)


@pytest.mark.parametrize(
    ("change", "pointer", "code"),
    [
        ({"controls": ["tau.x.q9"]}, "/controls/0", "unknown-input"),
        ({"controls": ["tau.x.q1", "tau.x.q1"]}, "/controls/1", "repeated"),
        ({"cost": Cost("tau.x.q1^")}, "/cost/running", "bad-expression"),
        ({"cost": Cost(terminal="tau.x.q1")}, "/cost/terminal", "unknown-name"),
        ({"cost": Cost("x.q1''")}, "/cost/running", "unknown-name"),
        ({"horizon": 0}, "/horizon", "greater-than"),
        ({"intervals": 9000, "steps": 9000}, "/steps", "too-many-steps"),
        ({"values": {"tau.x.q1": [1, 2]}}, "/values/tau.x.q1", "wrong-length"),
        ({"values": {"u": [1, 2]}}, "/values/u", "unknown-value"),
        ({"vary": ["x.z"]}, "/vary/0", "unknown-parameter"),
        ({"inputs": {"tau.x.q1": 1}}, "/inputs/tau.x.q1", "unknown-input"),
        ({"parameters": {"x.z": 1}}, "/parameters/x.z", "unknown-parameter"),
        ({"q": [[1, 2]]}, "/q", "wrong-length"),
        ({"q": [1, 2]}, "/q", "too-many-states"),
        ({"controls": "tau.x.q1"}, "/controls", "list-expected"),
        ({"hold": "cubic"}, "/hold", "literal-error"),
        ({"steps": 0}, "/steps", "greater-than-equal"),
    ],
)
def test_refusals(change: Plain, pointer: str, code: str) -> None:
    request = {"controls": ["tau.x.q1"], "horizon": 1, "intervals": 4, "q": [0], "cost": Cost("tau.x.q1^2")}
    with pytest.raises(InvalidInput) as error:
        cost_gradient(shipped("simple-pendulum"), **control_arguments(**request | change))
    assert [(f.pointer, f.code) for f in error.value.faults] == [(pointer, code)]


def test_failures_are_values() -> None:
    """Too large a step for a stiff motion; a parameter without a value."""
    model = shipped("simple-pendulum")
    request: Plain = {"controls": ["tau.x.q1"], "horizon": 1e9, "intervals": 60, "q": [1e200]}
    found = cost_gradient(model, **control_arguments(**request | {"values": {"tau.x.q1": 1e300}}))
    assert found.status == "failed"
    assert "steps" in found.message
    assert np.isfinite(found.trajectory.q).all()
    assert len(found.trajectory.t) < 61
    cusp = {"controls": ["tau.x.q1"], "horizon": 1, "intervals": 2, "q": [0], "cost": Cost("sqrt(x.q1^2)")}
    found = cost_gradient(model, **control_arguments(**cusp))
    assert found.status == "failed"
    assert "smooth" in found.message
    joint = {"type": "revolute", "coordinate": "q1"}
    body = {"name": "b", "parent": "base", "joint": joint, "mass": "m", "com": [1, 0, 0]}
    bare = model_of({"name": "x", "parameters": {"m": {}}, "bodies": [body]})
    with pytest.raises(MissingValue):
        cost_gradient(bare, ControlProblem(controls=["tau.x.q1"], horizon=1, intervals=2, q=[0]))
