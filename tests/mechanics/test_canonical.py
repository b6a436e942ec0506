"""Inverse metric, Christoffel symbols of the second kind, Hamilton's equations and power, by theorems and by SymPy."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
import sympy as sp
from catalogue_entries import shipped_part

from substructures import Definition, InvalidArgument, Model, TreeSpec, couple, derive
from substructures.certificate.derived.model_formulas import SERVED
from substructures.errors import VerificationFailed
from substructures.expr.interpret import interpret
from substructures.quantities import canonical
from substructures.quantities.formulas import derived
from substructures.quantities.numbers.asked import check
from substructures.quantities.numbers.evaluation import evaluate
from substructures.quantities.sources import Sources

NAMES = ["acrobot", "cart-pendulum", "scara", "ur5", "quarter-car"]
ALL = ["inverse_metric", "christoffel_second_kind", "hamiltonian", "canonical_equations", "power"]


def model(name: str, *more: dict[str, Any]) -> Model:
    """One part in gravity."""
    spec = {"name": "own", "gravity": ["0.3", 0, "-9.81"], "instances": [{"name": "a", "substructure": name}]}
    part = shipped_part(name)
    return couple(TreeSpec.read({**spec, "loads": list(more)} if more else spec), {"a": part})


@pytest.fixture(params=NAMES)
def tree(request: pytest.FixtureRequest) -> Model:
    return model(request.param)


def states(tree: Model, count: int = 4) -> dict[str, np.ndarray]:
    rng = np.random.default_rng(7)
    return {"q": rng.uniform(-1, 1, (count, tree.dof)), "qd": rng.uniform(-1, 1, (count, tree.dof))}


def test_inverses(tree: Model) -> None:
    found = evaluate(tree, ["metric", "christoffel", "inverse_metric", "christoffel_second_kind"], **states(tree))
    unit = np.einsum("nab,nbc->nac", found["metric"], found["inverse_metric"])
    np.testing.assert_allclose(unit, np.broadcast_to(np.eye(tree.dof), unit.shape), atol=1e-10)
    lowered = np.einsum("nda,nabc->ndbc", found["metric"], found["christoffel_second_kind"])
    np.testing.assert_allclose(lowered, found["christoffel"], atol=1e-11)


def test_hamiltons_equations_are_lagranges_along_a_motion(tree: Model) -> None:
    """d/dt (g q') by differences along q'' = FD; and H = T + V, q' = dH/dp, sum of Q_a q'^a = dT/dt."""
    at = states(tree)
    names = ["canonical_equations", "hamiltonian", "forward_dynamics", "kinetic_energy", "potential_energy", "power"]
    found = evaluate(tree, names, **at)
    np.testing.assert_allclose(found["canonical_equations"]["coordinate_rates"], at["qd"], atol=1e-10)
    total = found["kinetic_energy"] + found["potential_energy"]
    np.testing.assert_allclose(found["hamiltonian"], total, rtol=1e-12, atol=1e-11)
    h, qdd = 1e-5, found["forward_dynamics"]

    def later(dt: float, name: str) -> Any:
        q, qd = at["q"] + dt * at["qd"] + dt * dt / 2 * qdd, at["qd"] + dt * qdd
        return evaluate(tree, name, q=q, qd=qd)[name]

    p, energy = ((later(h, x) - later(-h, x)) / (2 * h) for x in ("generalised_momenta", "kinetic_energy"))
    scale = 1 + np.abs(p).max()
    np.testing.assert_allclose(found["canonical_equations"]["momentum_rates"] / scale, p / scale, atol=1e-7)
    np.testing.assert_allclose(found["power"].sum(axis=1), energy, atol=1e-6 * scale)


def test_the_hamiltonian_of_the_cart_and_pendulum_by_sympy() -> None:
    """H of T = 1/2 p g^-1 p formed by SymPy from our metric, and its derivatives, at p given by hand."""
    tree = model("cart-pendulum")
    q, p = sp.symbols("q0 q1"), sp.symbols("p0 p1")
    values = {name: sp.Rational(str(each["value"])) for name, each in tree.parameters.items() if each["value"]}
    numbers = {name: float(x) for name, x in values.items()}
    at = {"q": [0.3, 0.7], "p": [1.1, -0.4]}

    def metric(x: Any) -> Any:
        return evaluate(tree, "metric", q=x)["metric"]

    # g_01 = c cos(q1) up to a constant, all else constant: fitted by three values, compared at a fourth
    g0, g1 = metric([0, 0]), metric([0, float(sp.pi.evalf(17)) / 2])
    shape = sp.Matrix(2, 2, lambda a, b: g1[a, b] + (g0[a, b] - g1[a, b]) * sp.cos(q[1]))
    np.testing.assert_allclose(np.array(shape.subs(q[1], 0.7), float), metric(at["q"]), atol=1e-12)
    kinetic = (sp.Matrix(p).T * shape.inv() * sp.Matrix(p))[0] / 2
    by_hand = {**dict(zip(q, at["q"], strict=True)), **dict(zip(p, at["p"], strict=True))}
    program = derived(tree, "hamiltonian")
    symbols = {s.name: numbers.get(s.name, 0.0) for s in program.symbols} | dict(
        zip([*tree.coordinates, *map(canonical.momentum, tree.coordinates)], [*at["q"], *at["p"]], strict=True)
    )
    potential = float(evaluate(tree, "potential_energy", q=at["q"])["potential_energy"])
    assert float(interpret(program, symbols)["hamiltonian"]) == pytest.approx(
        float(kinetic.subs(by_hand)) + potential, rel=1e-11
    )


def test_numbers_for_one_state_and_checks() -> None:
    tree = model("acrobot")
    found = evaluate(tree, ALL, q=[0.1, 0.2], qd=[0.3, 0.4])
    assert found["inverse_metric"].shape == (2, 2)
    assert found["canonical_equations"]["momentum_rates"].shape == (2,)
    assert check(Sources(tree), ALL, [0.1, 0.2]).count == 1
    with pytest.raises(InvalidArgument):
        evaluate(tree, "hamiltonian", q=[0.1])


def test_no_inertia_no_result() -> None:
    """A metric that is singular in every state: failures, in the shapes that results would have."""
    body = {
        "name": "rod",
        "parent": "base",
        "joint": {"type": "revolute", "coordinate": "q"},
        "mass": 0,
        "com": [0, 0, 0],
        "inertia": {},
    }
    part = derive(Definition.read({"name": "nothing", "bodies": [body]}))
    spec = TreeSpec.read({"name": "own", "instances": [{"name": "a", "substructure": "nothing"}]})
    found = evaluate(couple(spec, {"a": part}), ALL[:4], q=[[0.0], [1.0]])
    assert found["christoffel_second_kind"].shape == (2, 1, 1, 1)
    assert found["hamiltonian"].shape == (2,)
    assert {(each.quantity, each.state) for each in found.failures} == {(name, k) for name in ALL[:4] for k in (0, 1)}


@pytest.mark.parametrize("name", ALL)
def test_wrong_formulas_are_refused(name: str, monkeypatch: pytest.MonkeyPatch) -> None:
    """The certificate of each, against the formulas of another mechanism of the same size."""
    right = SERVED[name]

    def other(m: Any) -> Any:
        return right(m.at({m.coordinates[-1]: m.values[m.coordinates[-1]] * 2}))

    monkeypatch.setitem(SERVED, name, other)
    with pytest.raises(VerificationFailed):
        derived(model("acrobot"), name)
