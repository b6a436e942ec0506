"""Theorems of mechanics on random trees at random states (notation.md, section 9)."""

# ruff: noqa: N806 -- symbols of the notation

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import independent
import numpy as np
import pytest
from in_depth import seeds
from independent import Moving
from random_trees import GRAVITY, Kind, model_of, random_definition, random_states, with_parameters

from substructures import Model
from substructures.quantities.numbers.evaluation import evaluate

N = 3
STEP = 1e-4
QUANTITIES = ["metric", "christoffel", "forces", "gravity", "potential_energy", "kinetic_energy", "kinematics"]
QUANTITIES += ["momentum", "coriolis", "forward_dynamics"]
INPUTS = {"u1": 0.7, "u2": -0.4}
TIME = 0.3


@dataclass
class Case:
    """A random tree with everything evaluated at random states."""

    definition: dict[str, Any]
    model: Model
    states: dict[str, Any]
    answer: dict[str, Any]

    @property
    def coordinates(self) -> list[str]:
        return [c.removeprefix("x.") for c in self.model.coordinates]

    @property
    def moving(self) -> Moving:
        return Moving(self.answer, self.states["qd"])

    def at(self, quantities: list[str], q: Any, qd: Any) -> dict[str, Any]:
        """Quantities at other states; inputs and actuators as in the case."""
        n = len(q)
        actuators = {f"tau.{c}": 0.1 * i for i, c in enumerate(self.model.coordinates)}
        named = {f"x.{name}": value for name, value in INPUTS.items()} | actuators
        known = {s.name for s in self.model.program.symbols if s.kind == "input"}
        inputs = {name: [value] * n for name, value in named.items() if name in known}
        return evaluate(self.model, quantities, q=q, qd=qd, t=TIME, inputs=inputs)

    def slope(self, quantity: str) -> Any:
        """Central differences of fourth order for all coordinates: (N, ..., n)."""
        q, qd = self.states["q"], self.states["qd"]
        columns = []
        for e in np.eye(self.model.dof):
            f = {k: self.at([quantity], q + k * STEP * e, qd)[quantity] for k in (-2, -1, 1, 2)}
            columns.append((8 * (f[1] - f[-1]) - (f[2] - f[-2])) / (12 * STEP))
        return np.stack(columns, axis=-1)


KINDS = [
    Kind(3, chain=True, massive=True),
    Kind(5, massive=True, joints=("revolute", "prismatic", "fixed")),
    Kind(4, massive=True),
    Kind(6, chain=True, massive=True, joints=("revolute", "prismatic"), loads=4, springs=2),
    Kind(2, massive=True, joints=("free", "planar", "spherical", "universal"), depth=9),
    Kind(5, massive=True, loads=5, springs=2),
]


@pytest.fixture(scope="module", params=seeds(len(KINDS), 2 * len(KINDS)), ids=lambda i: f"tree{i}")
def case(request: pytest.FixtureRequest) -> Case:
    rng = np.random.default_rng(500 + request.param)
    kind = KINDS[request.param % len(KINDS)]
    definition = random_definition(rng, kind)
    while not any("coordinate" in b["joint"] for b in definition["bodies"]):
        definition = random_definition(rng, kind)
    model = model_of(with_parameters(rng, definition, [0, 0.4, 1][request.param % 3]))
    states = random_states(rng, N, model.dof)
    result = Case(definition, model, states, {})
    result.answer = result.at(QUANTITIES, states["q"], states["qd"])
    return result


def close(found: Any, expected: Any, tolerance: float = 1e-11) -> None:
    """Relative to the largest entry expected."""
    scale = max(float(np.abs(expected).max(initial=0)), 1.0)
    np.testing.assert_allclose(found, expected, rtol=0, atol=tolerance * scale)


def test_metric_is_symmetric_and_positive_definite(case: Case) -> None:
    g = case.answer["metric"]
    assert np.array_equal(g, np.swapaxes(g, 1, 2))
    assert np.all(np.linalg.eigvalsh(g) > 0)
    assert case.answer.failures == ()


def test_base_functions_are_the_velocities(case: Case) -> None:
    """R U = dr/dq, and the angular velocity of R is R Omega."""
    q, qd = case.states["q"], case.states["qd"]
    k = case.answer["kinematics"]
    R = k["rotation"]
    for a, e in enumerate(np.eye(case.model.dof)):
        f = {j: case.at(["kinematics"], q + j * STEP * e, qd)["kinematics"] for j in (-2, -1, 1, 2)}
        dr, dR = ((8 * (f[1][x] - f[-1][x]) - (f[2][x] - f[-2][x])) / (12 * STEP) for x in ("position", "rotation"))
        close(np.einsum("nfij,nfj->nfi", R, k["U"][:, :, a]), dr, 1e-10)
        x, y, z = np.moveaxis(k["Omega"][:, :, a], -1, 0)
        o = np.zeros_like(x)
        skew = np.stack([np.stack(row, -1) for row in ((o, -z, y), (z, o, -x), (-y, x, o))], -2)
        close(R @ skew, dR, 1e-10)


def test_kinetic_energy_is_the_sum_over_bodies(case: Case) -> None:
    rotors = independent.by_coordinate(case.definition, "armature", case.coordinates)
    close(case.answer["kinetic_energy"], independent.kinetic_energy(case.definition, case.moving, rotors))


def test_momentum_is_the_sum_over_bodies(case: Case) -> None:
    linear, angular = np.zeros((N, 3)), np.zeros((N, 3))
    for body in case.definition["bodies"]:
        m, c, theta = independent.inertia_of(body)
        x, u = case.moving.point(body["name"], c)
        R, w = case.moving.turning(body["name"])
        v = np.einsum("nai,na->ni", u, case.states["qd"])
        omega = np.einsum("nai,na->ni", w, case.states["qd"])
        linear += m * v
        angular += m * np.cross(x, v) + np.einsum("nij,jk,nlk,nl->ni", R, theta, R, omega)
    close(case.answer["momentum"]["linear"], linear)
    close(case.answer["momentum"]["angular"], angular)


def test_christoffel_symbols_are_the_slopes_of_the_metric(case: Case) -> None:
    """Gamma_abc = (d_b g_ac + d_c g_ab - d_a g_bc)/2, d_c g_ab = Gamma_abc + Gamma_bac; symmetric in b, c."""
    dg, gamma = case.slope("metric"), case.answer["christoffel"]
    expected = 0.5 * (np.einsum("nacb->nabc", dg) + dg - np.einsum("nbca->nabc", dg))
    close(gamma, expected, 1e-10)
    close(gamma + np.swapaxes(gamma, 1, 2), dg, 1e-10)
    assert np.array_equal(gamma, np.swapaxes(gamma, 2, 3))


def test_the_slope_of_the_metric_minus_twice_coriolis_is_skew(case: Case) -> None:
    gamma, qd, C = case.answer["christoffel"], case.states["qd"], case.answer["coriolis"]
    slope = np.einsum("nabc,nc->nab", gamma + np.swapaxes(gamma, 1, 2), qd)
    skew = slope - 2 * C
    close(skew, -np.swapaxes(skew, 1, 2), 1e-14)
    close(np.einsum("nab,na,nb->n", skew, qd, qd), np.zeros(N))


def test_gravity_forces_and_energy(case: Case) -> None:
    """All potentials by hand; conservative forces are minus their gradient."""
    gravity = independent.gravity_energy(case.definition, case.moving, GRAVITY)
    springs = independent.springs_energy(case.definition, case.moving, case.states["q"], case.coordinates)
    loads, held = independent.conservative_loads(case.definition, case.moving, case.states["q"], case.coordinates)
    close(case.answer["potential_energy"], gravity + springs + loads)
    forces = case.answer["forces"] - case.answer["gravity"]
    names = dict(INPUTS) | {"t": TIME}
    for i, c in enumerate(case.coordinates):
        names |= {c: case.states["q"][:, i], f"{c}_dot": case.states["qd"][:, i]}
    forces = forces - independent.applied_forces(case.definition, case.moving, case.coordinates, names)
    forces = forces - independent.dissipative_forces(case.definition, case.moving, case.coordinates)
    forces = forces - 0.1 * np.arange(case.model.dof)
    close(case.answer["gravity"] + forces + held, -case.slope("potential_energy"), 1e-9)


def test_power_balance(case: Case) -> None:
    """dT/dt = q' . Q along the motion, by differences along the flow."""
    q, v, a = case.states["q"], case.states["qd"], case.answer["forward_dynamics"]
    h = STEP
    T = {
        k: case.at(["kinetic_energy"], q + k * h * v + 0.5 * (k * h) ** 2 * a, v + k * h * a)["kinetic_energy"]
        for k in (-2, -1, 1, 2)
    }
    # the path is exact to second order in h, and what is missing of it vanishes in the quotient to the same order
    slope = (8 * (T[1] - T[-1]) - (T[2] - T[-2])) / (12 * h)
    power = np.einsum("na,na->n", v, case.answer["forces"])
    scale = np.abs(T[1]).max() + np.abs(power).max() + np.abs(a).max()
    np.testing.assert_allclose(slope, power, rtol=0, atol=1e-6 * scale)
