"""CasADi loads the external functions, and differentiates through them by their own Jacobians."""

from __future__ import annotations

import re
from typing import Any

import numpy as np
import pytest
from exported_models import exported_of, tree_of, write
from run_code import STRICT, arguments, shared, state

from substructures.export import Exported, Function, files
from substructures.expr.interpret import interpret
from substructures.printers.render import LIMIT

casadi = pytest.importorskip("casadi", reason="the wheel casadi is not installed")


@pytest.fixture(scope="module")
def loaded(tmp_path_factory: pytest.TempPathFactory) -> tuple[Exported, str]:
    exported = exported_of(tree_of("scara", "camera"))
    (path,) = write(exported, "casadi", tmp_path_factory.mktemp("casadi"))
    return exported, shared([path], STRICT)._name


def as_matrix(value: Any) -> np.ndarray[Any, Any]:
    array = np.asarray(value, dtype=float)
    return array.reshape(array.shape[0], -1) if array.ndim else array.reshape(1, 1)


def called(external: Any, given: list[Any]) -> list[np.ndarray[Any, Any]]:
    found = external(*given)
    return [np.asarray(x.full()) for x in (found if isinstance(found, tuple) else (found,))]


def external(loaded: tuple[Exported, str], function: Function) -> Any:
    return casadi.external(loaded[0].called(function), loaded[1])


def test_values_are_those_of_the_interpreter(loaded: tuple[Exported, str]) -> None:
    for function in loaded[0].functions:
        values = state(function.interface)
        found = called(external(loaded, function), list(arguments(function, values).values()))
        expected = interpret(function.program, values)
        for x, y in zip(found, expected.values(), strict=True):
            np.testing.assert_allclose(x, as_matrix(y), rtol=1e-12, atol=1e-12)


def test_jacobians_are_differences(loaded: tuple[Exported, str]) -> None:
    """Central differences of the interpreter, of every argument of every function."""
    for function in loaded[0].functions:
        values = state(function.interface)
        given = list(arguments(function, values).values())
        f = external(loaded, function)
        found = called(f.jacobian(), [*given, *f.call([casadi.DM(x) for x in given])])
        blocks = iter(found)
        for output in function.program.outputs:
            for symbol in function.arguments:
                block = next(blocks)
                for j, name in enumerate(function.vector(symbol).names):
                    step = 1e-5 * (abs(values[name]) or 1.0)  # small inertias have small steps
                    up, down = (
                        as_matrix(interpret(function.program, {**values, name: values[name] + s})[output]).T.ravel()
                        for s in (step, -step)
                    )
                    expected = (up - down) / (2 * step)
                    limit = 1e-6 * max(1.0, np.abs(expected).max(initial=0.0))
                    np.testing.assert_allclose(block[:, j], expected, rtol=1e-6, atol=limit)


def test_casadi_differentiates_through_it(loaded: tuple[Exported, str]) -> None:
    """The gradient of the kinetic energy by the velocities is the metric times these."""
    by_name = {f.quantity: f for f in loaded[0].functions}
    energy = by_name["kinetic_energy"]
    values = state(energy.interface)
    q, qd, p = arguments(energy, values).values()
    v = casadi.MX.sym("v", len(qd))
    slope = casadi.Function("slope", [v], [casadi.gradient(external(loaded, energy)(q, v, p), v)])
    metric = np.asarray(interpret(by_name["metric"].program, values)["metric"])
    np.testing.assert_allclose(slope(qd).full().ravel(), metric @ qd, rtol=1e-12, atol=1e-12)


def test_ipopt_takes_it_with_the_option_that_the_file_names(loaded: tuple[Exported, str]) -> None:
    """T - p . v is least where the momentum g v is p; second derivatives are approximated."""
    exported, _ = loaded
    by_name = {f.quantity: f for f in exported.functions}
    energy = by_name["kinetic_energy"]
    values = state(energy.interface)
    q, qd, p = arguments(energy, values).values()
    momentum = np.linspace(1, 2, len(qd))
    v = casadi.MX.sym("v", len(qd))
    problem = {"x": v, "f": external(loaded, energy)(q, v, p) - casadi.dot(momentum, v)}
    ((name, value),) = re.findall(
        r'"(ipopt\.\w+)": "([\w-]+)"', files(exported, "casadi", LIMIT)["demo_casadi.c"].decode()
    )
    quiet = {"print_time": False, "ipopt.print_level": 0, "ipopt.sb": "yes", "ipopt.tol": 1e-11}
    solver = casadi.nlpsol("solver", "ipopt", problem, {**quiet, name: value})
    found = solver(x0=0)["x"].full().ravel()
    metric = np.asarray(interpret(by_name["metric"].program, values)["metric"])
    np.testing.assert_allclose(metric @ found, momentum, rtol=1e-7)
