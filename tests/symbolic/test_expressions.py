"""Formulas as SymPy expressions, beside the numbers of evaluations."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
import sympy
from catalogue_entries import shipped_part
from sympy.physics.vector import dynamicsymbols

from substructures import InvalidArgument, Model, couple, derive, evaluate, to_sympy

QUANTITIES = ("metric", "christoffel", "forces", "bias", "kinetic_energy", "forward_dynamics", "kinematics")
STATE = {"q": 0.4, "qd": -0.7, "qdd": 0.2}


def model_of(name: str) -> Model:
    tree = {"name": "t", "gravity": [0, 0, -9.81], "instances": [{"name": "x", "substructure": name}]}
    return couple(tree, {"x": derive(name)})


def numbers(model: Model) -> dict[str, float]:
    """Of all symbols: parameters by default, coordinates all different."""
    values = {n: float(p["value"]) for n, p in model.parameters.items()}
    for field, stroke in (("q", ""), ("qd", "'"), ("qdd", "''")):
        values |= {f"{c}{stroke}": STATE[field] + k / 7 for k, c in enumerate(model.coordinates)}
    return values | dict.fromkeys(model.input_names, 0.3)


def value(expression: Any, values: dict[str, float]) -> Any:
    given = {symbol: values[symbol.name] for symbol in expression.free_symbols}
    array = expression.subs(given) if expression.free_symbols else expression
    return np.array(array.tolist() if hasattr(array, "tolist") else array, dtype=float)


@pytest.mark.parametrize("name", ["cart-pendulum", "acrobot", "screw-gripper", "ball-pendulum"])
def test_quantities_have_the_numbers_of_evaluations(name: str) -> None:
    model = model_of(name)
    n, values = model.dof, numbers(model)
    states = {field: [[x + k / 7 for k in range(n)]] for field, x in STATE.items()}
    found = evaluate(model, QUANTITIES, **states, inputs=dict.fromkeys(model.input_names, 0.3))
    for quantity in QUANTITIES:
        mine = to_sympy(model, quantity)
        for output, expression in (mine if isinstance(mine, dict) else {quantity: mine}).items():
            its = found[quantity][output] if isinstance(mine, dict) else found[quantity]
            expected = np.asarray(its[0])
            assert value(expression, values).reshape(expected.shape) == pytest.approx(expected, rel=1e-9, abs=1e-12)


def test_numbers_are_exact_and_symbols_real() -> None:
    forces = to_sympy(model_of("cart-pendulum"), "forces")
    assert not forces.atoms(sympy.Float)
    assert sympy.Rational(981, 100) in forces.atoms(sympy.Rational)
    assert all(symbol.is_real for symbol in forces.free_symbols)


def test_coordinates_are_functions_of_time_where_that_is_wanted() -> None:
    model, t = model_of("cart-pendulum"), dynamicsymbols._t
    bias = to_sympy(model, "bias", dynamic=True)
    angle = sympy.Function("x.q1")(t)
    assert bias.diff(angle.diff(t)) != sympy.zeros(2, 1)
    phi = sympy.Symbol("phi")
    assert to_sympy(model, "metric", symbols={"x.q1": phi})[0, 1].has(sympy.cos(phi))


def test_outputs_of_parts_and_programs() -> None:
    part = shipped_part("simple-pendulum")
    angle = sympy.Symbol("q0", real=True)
    found = to_sympy(part, "Omega")
    assert isinstance(found, sympy.ImmutableDenseNDimArray)
    assert found.shape == part.program.outputs["Omega"].shape
    assert to_sympy(part.program, "metric") == to_sympy(part, "metric")
    assert set(to_sympy(part.program)) == set(part.program.outputs)
    assert angle not in to_sympy(part, "metric").free_symbols


def test_lagranges_equations_by_sympy_are_ours() -> None:
    """d/dt dL/dq' - dL/dq of our L, differentiated by SymPy, is g q'' + Gamma q' q' - Q without the inputs."""
    model, t = model_of("cart-pendulum"), dynamicsymbols._t
    lagrangian, ours = (to_sympy(model, name, dynamic=True) for name in ("lagrangian", "inverse_dynamics"))
    for a, name in enumerate(model.coordinates):
        q = sympy.Function(name)(t)
        theirs = lagrangian.diff(q.diff(t)).diff(t) - lagrangian.diff(q)
        effort = sympy.Function(f"tau.{name}")(t)
        assert sympy.simplify(theirs - (ours[a] + effort)) == 0


@pytest.mark.parametrize(("name", "message"), [("metrik", "did you mean 'metric'"), ("u", "there is no quantity 'u'")])
def test_what_is_not_there_is_told(name: str, message: str) -> None:
    with pytest.raises(InvalidArgument, match=message):
        to_sympy(model_of("cart-pendulum"), name)
    with pytest.raises(InvalidArgument, match="there is no output"):
        to_sympy(shipped_part("simple-pendulum"), name)
