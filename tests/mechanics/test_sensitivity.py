"""Derivatives of inverse and forward dynamics against central differences and identities."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
from catalogue_entries import shipped_part
from random_trees import Kind, Plain, model_of, random_definition, random_states, with_parameters

from substructures import Definition, MissingValue, Model, Program, TreeSpec, couple, derive
from substructures.errors import InvalidArgument
from substructures.expr.interpret import interpret
from substructures.mechanics.accelerations import cholesky_solve
from substructures.quantities.derivative_directions import Direction
from substructures.quantities.derivatives import inverse_dynamics_derivative, inverse_dynamics_jacobians
from substructures.quantities.numbers.defaults import default_number
from substructures.quantities.numbers.evaluation import EvaluationOptions, evaluate

N = 2
#: of central differences of fourth order; their error is about STEP^4 and 1e-16 / STEP
STEP = 1e-3
TOLERANCE = 1e-6
TIME = 0.3
CHOSEN = ["acrobot", "ball-pendulum", "excavator-arm", "flyball-governor", "free-body", "kuka-iiwa-14", "quadruped-leg"]
CHOSEN += ["quarter-car", "satellite", "scara", "slider-crank", "stewart-leg", "ur5"]
KINDS = [Kind(3, massive=True), Kind(5, massive=True, joints=("revolute", "prismatic", "fixed"), springs=2)]


def catalogue_model(name: str) -> Model:
    part = shipped_part(name)
    document = {"name": "t", "gravity": [0.2, -1, -9.81], "instances": [{"name": "x", "substructure": name}]}
    return couple(TreeSpec.read(document), {"x": part})


def random_model(number: int) -> Model:
    rng = np.random.default_rng(800 + number)
    kind = KINDS[number % len(KINDS)]
    definition = random_definition(rng, kind)
    while not any("coordinate" in b["joint"] for b in definition["bodies"]):
        definition = random_definition(rng, kind)
    return model_of(with_parameters(rng, definition, 0.3 * (number % 3)))


@pytest.fixture(scope="module", params=[*CHOSEN, *range(6)], ids=str)
def model(request: pytest.FixtureRequest) -> Model:
    return catalogue_model(request.param) if isinstance(request.param, str) else random_model(request.param)


def inputs_of(model: Model) -> list[str]:
    return [s.name for s in model.program.symbols if s.kind == "input"]


def state(model: Model, seed: int = 0) -> Plain:
    """q, qd, qdd (N, n), and all inputs."""
    rng = np.random.default_rng(seed)
    states = random_states(rng, N, model.dof)
    return states | {"inputs": {name: rng.uniform(-1, 1, N) for name in inputs_of(model)}}


def values(model: Model, x: Plain, d: Plain) -> Plain:
    """Values of all symbols of the programs at a state along a direction."""
    result: Plain = {name: default_number(p["value"]) for name, p in model.parameters.items()} | {"t": TIME}
    for prefix, some in (("", x), ("d.", d)):
        for key, primes in (("q", ""), ("qd", "'"), ("qdd", "''")):
            result |= {f"{prefix}{name}{primes}": some[key][:, a] for a, name in enumerate(model.coordinates)}
        result |= {f"{prefix}{name}": value for name, value in some["inputs"].items()}
    return result


def moved(x: Plain, d: Plain, h: float) -> Plain:
    inputs = {name: value + h * d["inputs"][name] for name, value in x["inputs"].items()}
    return {key: x[key] + h * d[key] for key in ("q", "qd", "qdd")} | {"inputs": inputs}


def slope(model: Model, quantity: str, x: Plain, d: Plain) -> Any:
    """Central difference of fourth order of a quantity along a direction."""
    f = {}
    for k in (-2, -1, 1, 2):
        request = moved(x, d, k * STEP) | {"quantities": [quantity], "t": TIME}
        f[k] = evaluate(model, **request)[quantity]
    return (8 * (f[1] - f[-1]) - (f[2] - f[-2])) / (12 * STEP)


def close(found: Any, expected: Any, tolerance: float = TOLERANCE) -> None:
    """Relative to the largest entry expected."""
    scale = max(float(np.abs(expected).max(initial=0)), 1.0)
    np.testing.assert_allclose(found, expected, rtol=0, atol=tolerance * scale)


def forward_dynamics_derivative(model: Model, request: Plain, along: Plain) -> Any:
    wanted = request | {
        "quantities": ["forward_dynamics_derivative"],
        "options": EvaluationOptions(along=None if along is None else Direction(**along)),
    }
    answer = evaluate(model, **wanted)
    assert not answer.failures
    return answer["forward_dynamics_derivative"]


def directional(model: Model, program: Program, x: Plain, d: Plain) -> Any:
    return interpret(program, values(model, x, d))["inverse_dynamics_derivative"]


def test_inverse_dynamics_along_a_direction(model: Model) -> None:
    """Against differences; along dq'' it is g dq'', and it is linear in the direction."""
    program = inverse_dynamics_derivative(model)
    x, d, e = state(model), state(model, 1), state(model, 2)
    along = directional(model, program, x, d)
    close(along, slope(model, "inverse_dynamics", x, d))
    other = directional(model, program, x, e)
    close(directional(model, program, x, moved(d, e, 2.5)), along + 2.5 * other, 1e-12)
    rest = {key: np.zeros_like(d["q"]) for key in ("q", "qd")} | {"inputs": dict.fromkeys(d["inputs"], np.zeros(N))}
    metric = evaluate(model, ["metric"], **x, t=TIME)["metric"]
    close(directional(model, program, x, d | rest), np.einsum("nab,nb->na", metric, d["qdd"]), 1e-12)


def test_symbols_of_the_direction(model: Model) -> None:
    """d.<name> has the kind and unit of <name>; the program survives storage, and carries inverse dynamics, too."""
    program = inverse_dynamics_derivative(model)
    symbols = {s.name: s for s in program.symbols}
    for name, symbol in symbols.items():
        if name.startswith("d.") and name[2:] in symbols:
            assert (symbols[name[2:]].kind, symbols[name[2:]].unit) == (symbol.kind, symbol.unit)
        assert not (name.startswith("d.") and symbol.kind in ("parameter", "time"))
    assert Program.from_bytes(program.to_bytes()) == program
    x = state(model)
    found = interpret(program, values(model, x, state(model, 1)), ["inverse_dynamics"])["inverse_dynamics"]
    close(found, evaluate(model, **(x | {"quantities": ["inverse_dynamics"], "t": TIME}))["inverse_dynamics"], 1e-12)


def test_one_walk_costs_a_small_multiple(model: Model) -> None:
    totals = inverse_dynamics_derivative(model).totals()
    assert totals["inverse_dynamics_derivative"] <= 4 * totals["inverse_dynamics"] + 10 * model.dof


def test_jacobians(model: Model) -> None:
    """Columns are derivatives along unit directions."""
    x, zero = state(model), moved(state(model), state(model), -1)
    found = interpret(inverse_dynamics_jacobians(model), values(model, x, zero))
    program = inverse_dynamics_derivative(model)
    for b, key in ((b, key) for b in range(model.dof) for key in ("q", "qd")):
        unit = zero | {key: np.eye(model.dof)[[b] * N]}
        close(found[f"inverse_dynamics_{key}"][:, :, b], directional(model, program, x, unit), 1e-12)


def test_jacobian_by_velocity_is_twice_coriolis() -> None:
    """UR5: no dampers, no loads."""
    robot = catalogue_model("ur5")
    x = state(robot)
    found = interpret(inverse_dynamics_jacobians(robot), values(robot, x, x))
    coriolis = evaluate(robot, **(x | {"quantities": ["coriolis"], "t": TIME}))["coriolis"]
    close(found["inverse_dynamics_qd"], 2 * coriolis, 1e-12)


def test_forward_dynamics_along_a_direction(model: Model) -> None:
    """Against differences, for all states and for one."""
    x, d = state(model), state(model, 1)
    request = {"q": x["q"], "qd": x["qd"], "inputs": x["inputs"], "t": TIME}
    along = {"q": d["q"], "qd": d["qd"], "inputs": d["inputs"]}
    found = forward_dynamics_derivative(model, request, along)
    metric = evaluate(model, **(request | {"quantities": ["metric"]}))["metric"]
    assert np.linalg.eigvalsh(metric).min() > 0
    close(found, slope(model, "forward_dynamics", x, d), 1e-6)
    one = {"q": x["q"][0], "qd": x["qd"][0], "inputs": {name: v[:1] for name, v in x["inputs"].items()}, "t": TIME}
    first = {"q": d["q"][:1], "qd": d["qd"][0], "inputs": {name: float(v[0]) for name, v in d["inputs"].items()}}
    close(forward_dynamics_derivative(model, one, first), found[0], 1e-12)


def test_accelerations_by_actuators_are_the_inverse_metric() -> None:
    robot = catalogue_model("ur5")
    x = state(robot)
    request = {"q": x["q"], "qd": x["qd"]}
    columns = [
        forward_dynamics_derivative(robot, request, {"inputs": {f"tau.{name}": 1}}) for name in robot.coordinates
    ]
    metric = evaluate(robot, **(request | {"quantities": ["metric"]}))["metric"]
    np.testing.assert_allclose(metric @ np.stack(columns, axis=2), [np.eye(6)] * N, atol=1e-11)


def test_singular_metric_gives_nan_in_that_state_alone() -> None:
    g = np.stack([np.eye(2), np.ones((2, 2)), [[2, 1], [1, 2.0]]])
    x = cholesky_solve(g, np.ones((3, 2)))
    assert np.isnan(x[1]).all()
    np.testing.assert_allclose(x[[0, 2]], [[1, 1], [1 / 3, 1 / 3]])


@pytest.mark.parametrize(
    ("along", "pointer"),
    [
        ({"q": [1, 2, 3]}, "/along/q"),
        ({"qd": {"x.q1": 1}}, "/along/qd"),
        ({"q": [[1, 2], ["x", 2]]}, "/along/q/1/0"),
        ({"q": [[1, 2], [1, 2]]}, "/along/q"),
        ({"inputs": {"tau.y": 1}}, "/along/inputs/tau.y"),
        ({"inputs": {"tau.x.q1": [1, 2]}}, "/along/inputs/tau.x.q1"),
        ({"inputs": 3}, "/along/inputs"),
        (None, "/along"),
    ],
)
def test_refused_directions(along: Any, pointer: str) -> None:
    with pytest.raises(InvalidArgument) as error:
        forward_dynamics_derivative(catalogue_model("planar-2r"), {"q": [0.1, 0.2]}, along)
    assert error.value.faults[0].pointer == pointer


def test_a_parameter_without_value_is_missing() -> None:
    definition = {
        "name": "one",
        "parameters": {"m": {}},
        "bodies": [{"name": "b", "parent": "base", "joint": {"type": "prismatic"}, "mass": "m"}],
    }
    part = derive(Definition.read(definition))
    model = couple(TreeSpec.read({"name": "t", "instances": [{"name": "x", "definition": definition}]}), {"x": part})
    with pytest.raises(MissingValue):
        forward_dynamics_derivative(model, {"q": [0]}, {"q": [1]})
