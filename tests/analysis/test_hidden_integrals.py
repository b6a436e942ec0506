"""First integrals beyond momenta: with time, of subsystems, about the mass centre, quadratic; none where there is none.

All that are claimed are held against an integration, most of them also against what textbooks write.
"""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
import scipy
from analysis_models import catalogue_model, values_at
from random_trees import Plain, model_of, random_states

from benchmarks.chains import chain, general_rows, row_of
from substructures import InvalidArgument, Model, couple, derive
from substructures.analysis.equations import integral_search, subsystems
from substructures.analysis.equations.first_integrals import first_integrals
from substructures.analysis.equations.symmetries import Direction
from substructures.analysis.simulate import Outputs, simulate
from substructures.errors import VerificationFailed
from substructures.expr.calculus.corners import VanishingOnAllSides
from substructures.expr.graph import Expr
from substructures.expr.interpret import interpret

NONE, FALL = (0, 0, 0), (0, 0, "-9.81")


def constants(model: Model, **options: Any) -> dict[str, str]:
    """Constant integrals by name with their kinds."""
    return {i.name: i.kind for i in first_integrals(model, **options).integrals if i.rule == "constant"}


def assert_held(model: Model, seed: int = 1, **options: Any) -> None:
    """Along an integrated motion from a random state, every constant integral was held against it."""
    x = random_states(np.random.default_rng(seed), 1, model.dof)
    motion = simulate(model, 0.5 * x["q"][0] + 0.6, (0, 1.5), qd=x["qd"][0], outputs=Outputs(count=16), **options)
    assert motion.is_right, motion.checks
    wanted = {i.name for i in first_integrals(model).integrals if i.rule == "constant" and i.kind != "energy"}
    assert wanted <= {c.name for c in motion.checks if c.rule == "constant"}


def pendulums(damping: float = 0) -> Model:
    """Two pendulums of the world, the second one with friction."""
    joint = {"type": "revolute", "placement": {"rpy": ["pi/2", 0, 0]}}
    bodies: list[Plain] = [
        {"name": n, "parent": "base", "mass": m, "com": [0.5, 0, 0], "inertia": {"xx": 0.1, "yy": 0.1, "zz": 0.1}}
        | {"joint": joint | {"coordinate": n} | ({"damping": damping} if n == "b" and damping else {})}
        for n, m in (("a", "m1"), ("b", "m2"))
    ]
    parameters = {"m1": {"value": 1.5}, "m2": {"value": 2}}
    return model_of({"name": "two", "bodies": bodies, "parameters": parameters}, FALL)


def test_two_pendulums_have_two_energies() -> None:
    model = pendulums()
    assert constants(model) == {"energy": "energy", "energy.x.a": "subsystem", "energy.x.b": "subsystem"}
    assert_held(model)


def test_formulas_are_not_looked_through_where_the_metric_joins_all(monkeypatch: pytest.MonkeyPatch) -> None:
    model = catalogue_model("double-pendulum", (0, "-9.8", 0))
    monkeypatch.setattr(subsystems, "reachable", None)
    assert "energy" in constants(model)


def test_one_slope_shows_that_a_coordinate_varies(monkeypatch: pytest.MonkeyPatch) -> None:
    looked, vanishes = list[Expr](), VanishingOnAllSides.__call__

    def noted(test: VanishingOnAllSides, x: Expr) -> bool:
        looked.append(x)
        return vanishes(test, x)

    monkeypatch.setattr(VanishingOnAllSides, "__call__", noted)
    constants(catalogue_model("puma560", (0, "-9.8", 0)))
    assert len(looked) < 60


def test_what_falls_does_not_hide_what_is_constant() -> None:
    model = pendulums(0.2)
    rules = {i.name: i.rule for i in first_integrals(model).integrals}
    assert rules == {"energy": "falling", "energy.x.a": "constant", "energy.x.b": "falling"}
    assert_held(model)


def test_a_free_body_in_gravity() -> None:
    """P_z + m g t, the three of Galilei, the spin about the mass centre; twelve constants of six coordinates in all."""
    model = catalogue_model("free-body", FALL)
    found = constants(model)
    assert {"impulse.z", "galilei.x", "galilei.y", "galilei.z", "spin.x", "spin.y"} <= found.keys()
    assert "spin.z" not in found, "it is L_z less products of the others"
    assert_held(model)


TENSOR = {"xx": 0.1, "yy": 0.1, "zz": 0.1}
SPRINGS = "(k1*a^2 + k2*(a - b)^2 + k3*b^2)/2"
NEUMANN = "(k1*(cos(a)*cos(b))^2 + k2*(sin(a)*cos(b))^2 + k3*sin(b)^2)/2"
ACROSS = {"placement": {"rpy": [0, "pi/2", 0]}}


def with_parameters(bodies: list[Plain], text: str = "", gravity: Any = NONE, **values: float) -> Model:
    """Bodies x with a potential."""
    definition: Plain = {"name": "d", "bodies": bodies, "parameters": {n: {"value": v} for n, v in values.items()}}
    if text:
        definition["loads"] = [{"type": "potential", "potential": text}]
    return model_of(definition, gravity)


def slide(name: str, mass: str | None, parent: str = "base", **more: Any) -> Plain:
    """A mass on a slide."""
    body = {"name": f"on_{name}", "parent": parent, "joint": {"type": "prismatic", "coordinate": name} | more}
    return body | ({"mass": mass} if mass else {})


def carts() -> Model:
    """Two carts between three springs."""
    return with_parameters([slide("a", "m1"), slide("b", "m2")], SPRINGS, m1=1.3, m2=2.1, k1=3.0, k2=5.0, k3=4.0)


def planet(text: str = "-k/sqrt(x^2 + y^2)") -> Model:
    """A mass in the plane of two slides that are normal to each other."""
    return with_parameters([slide("x", None), slide("y", "m", "on_x", **ACROSS)], text, m=1.2, k=2.5)


def on_a_sphere(text: str = NEUMANN) -> Model:
    """A point of mass m on the unit sphere: x = (cos a cos b, sin a cos b, sin b)."""
    turned = {"placement": {"rpy": ["pi/2", 0, 0]}}
    bodies: list[Plain] = [
        {"name": "s", "parent": "base", "joint": {"type": "revolute", "coordinate": "a"}},
        {"name": "p", "parent": "s", "joint": {"type": "revolute", "coordinate": "b"} | turned, "mass": "m"}
        | {"com": [1, 0, 0]},
    ]
    return with_parameters(bodies, text, m=1.5, k1=1.0, k2=2.5, k3=4.0)


def on_a_plane(text: str, **values: float) -> Model:
    """A mass of 1.2 kg on two slides that are normal to each other."""
    return with_parameters([slide("x", None), slide("y", "m", "on_x", **ACROSS)], text, m=1.2, **values)


#: potentials that are separable in other axes, and the integral beside the energy: of x + y and x - y
#: p_x p_y + m U with U_x = V_y; of x^4 + 12 x^2 y^2 + 16 y^4, the case 1 : 12 : 16 of J. Hietarinta (Physics Reports
#: 147, 1987, 87-154), that of parabolic coordinates
SEPARABLE = {
    "x^4 + 6*x^2*y^2 + y^4": lambda x, y, px, py: px * py + 1.2 * (4 * x**3 * y + 4 * x * y**3),
    "x^2*y + y^3/3 + x^2 + y^2": lambda x, y, px, py: px * py + 1.2 * (x**3 / 3 + x * y**2 + 2 * x * y),
    "(x*cos(w) + y*sin(w))^4 + (y*cos(w) - x*sin(w))^2": lambda x, y, px, py: (
        (px * np.cos(0.3) + py * np.sin(0.3)) ** 2 / 2.4 + (x * np.cos(0.3) + y * np.sin(0.3)) ** 4
    ),
    "x^4 + 12*x^2*y^2 + 16*y^4": lambda x, y, px, py: y * px**2 - x * px * py - 1.2 * (4 * x**4 * y + 8 * x**2 * y**3),
}


@pytest.mark.parametrize("text", SEPARABLE)
def test_potentials_that_are_separable_in_turned_axes_have_a_second_integral(text: str) -> None:
    model = on_a_plane(text, **({"w": 0.3} if "w" in text else {}))
    found = [i.name for i in first_integrals(model).integrals if i.rule == "constant"]
    assert found == ["energy", "quadratic.1"]
    x, columns = values_of(model, *found)
    (a, b), (u, v) = x["q"].T, 1.2 * x["qd"].T
    known = SEPARABLE[text](a, b, u, v)
    # the published one is a combination of the two that are found
    _, left, _, _ = np.linalg.lstsq(columns, known, rcond=None)
    assert left[0] < 1e-20 * np.square(known).sum()
    assert_held(model)


def shaft(damping: float | str = "b") -> Model:
    """A pendulum on a vertical shaft with friction."""
    turned = {"placement": {"rpy": ["pi/2", 0, 0]}}
    bodies: list[Plain] = [
        {"name": "s", "parent": "base", "inertia": TENSOR}
        | {"joint": {"type": "revolute", "coordinate": "q1", "damping": damping}},
        {"name": "p", "parent": "s", "joint": {"type": "revolute", "coordinate": "q2"} | turned, "mass": "m"}
        | {"com": [0, "-l", 0], "inertia": TENSOR},
    ]
    return with_parameters(bodies, gravity=FALL, m=1.2, l=0.6, b=0.3)


def values_of(model: Model, *names: str) -> tuple[Plain, np.ndarray]:
    """Random states, and the integrals at them as columns."""
    x = random_states(np.random.default_rng(7), 40, model.dof)
    found = interpret(first_integrals(model).program, values_at(model, x["q"], x["qd"]), list(names))
    return x, np.stack([found[name] for name in names], axis=1)


def left_over(values: np.ndarray, columns: list[np.ndarray]) -> float:
    """What is left of values beside combinations of the columns, relative."""
    known = np.stack([np.ones(len(values)), *columns], axis=1)
    rest = values - known @ np.linalg.lstsq(known, values, rcond=None)[0]
    return float(np.abs(rest).max() / np.abs(values).max())


def test_modal_energies_of_two_carts() -> None:
    """The energy and one more, of which the energies of both modes are combinations."""
    model = carts()
    assert constants(model) == {"energy": "energy", "quadratic.1": "quadratic"}
    x, values = values_of(model, "energy", "quadratic.1")
    m, stiffness = np.array([1.3, 2.1]), np.array([[8.0, -5.0], [-5.0, 9.0]])
    squares, modes = scipy.linalg.eigh(stiffness, np.diag(m))
    # E_i = (y_i'^2 + w_i^2 y_i^2) / 2 with y = modes^T M q
    y, rates = (x[name] * m @ modes for name in ("q", "qd"))
    energies = (rates**2 + squares * y**2) / 2
    assert left_over(energies[:, 0], list(values.T)) < 1e-12
    assert left_over(energies[:, 1], list(values.T)) < 1e-12
    assert_held(model)


def test_runge_and_lenz() -> None:
    """Kepler's motion: (p x L) - m k r/|r|, both components in the plane."""
    model = planet()
    assert constants(model) == {"energy": "energy", "angular_momentum.y": "angular_momentum"} | dict.fromkeys(
        ("quadratic.1", "quadratic.2"), "quadratic"
    )
    x, values = values_of(model, "quadratic.1", "quadratic.2")
    q, p, m, k = x["q"], 1.2 * x["qd"], 1.2, 2.5
    spin, r = q[:, 0] * p[:, 1] - q[:, 1] * p[:, 0], np.hypot(*q.T)
    lenz = [p[:, 1] * spin - m * k * q[:, 0] / r, -p[:, 0] * spin - m * k * q[:, 1] / r]
    assert max(left_over(values[:, i], lenz) for i in range(2)) < 1e-12
    assert_held(model)


def test_henon_and_heiles() -> None:
    """With 2 y^3 beside x^2 y the motion is that of a fifth-order KdV wave: x^4 + 4 x^2 y^2 - 4 p (p y - q x) + ...

    J. Hietarinta, Direct methods for the search of the second invariant, Phys. Rep. 147, 1987, section 3.
    """
    model = planet("m*((x^2 + y^2)/2 + x^2*y + 2*y^3)")
    assert constants(model) == {"energy": "energy", "quadratic.1": "quadratic"}
    at, values = values_of(model, "quadratic.1", "energy")
    (x, y), (p, q) = at["q"].T, at["qd"].T
    wanted = x**4 + 4 * x**2 * y**2 - 4 * p * (p * y - q * x) + 4 * x**2 * y + 3 * (p**2 + x**2)
    assert left_over(values[:, 0], [wanted, values[:, 1]]) < 1e-12


def test_other_central_forces_have_no_such_vector() -> None:
    """Bertrand: the oscillator has a tensor, whose diagonal is one more beside energy and moment; k/r^2 none."""
    assert set(constants(planet("k/(x^2 + y^2)"))) == {"energy", "angular_momentum.y"}
    assert set(constants(planet("k*(x^2 + y^2)"))) >= {"energy", "angular_momentum.y", "quadratic.1"}
    assert_held(planet("k*(x^2 + y^2)"))


def test_neumann() -> None:
    """Uhlenbeck's F_i = x_i^2 + sum over j of (x_i v_j - x_j v_i)^2 m/(k_i - k_j), in two forms of one search."""
    model = on_a_sphere()
    assert constants(model) == {"energy": "energy", "quadratic.1": "quadratic"}
    x, values = values_of(model, "energy", "quadratic.1")
    (a, b), (da, db) = x["q"].T, x["qd"].T
    r = np.array([np.cos(a) * np.cos(b), np.sin(a) * np.cos(b), np.sin(b)])
    v = np.array(
        [
            -np.sin(a) * np.cos(b) * da - np.cos(a) * np.sin(b) * db,
            np.cos(a) * np.cos(b) * da - np.sin(a) * np.sin(b) * db,
            np.cos(b) * db,
        ]
    )
    k = (1.0, 2.5, 4.0)
    known = [
        r[i] ** 2 + sum((r[i] * v[j] - r[j] * v[i]) ** 2 * 1.5 / (k[i] - k[j]) for j in range(3) if j != i)
        for i in range(3)
    ]
    assert left_over(values[:, 1], known[:2]) < 1e-11
    assert_held(model)


def test_a_damped_cyclic_axis() -> None:
    """p_1 + b q_1, with the energy falling."""
    model = shaft()
    (one,) = (i for i in first_integrals(model).integrals if i.rule == "constant")
    assert (one.kind, one.unit) == ("linear", "N m s")
    assert set(one.terms) == {("b*x.q1", ()), ("1", ("p.x.q1",))}
    assert_held(model)


def test_a_falling_mass() -> None:
    model = with_parameters([slide("z", "m")], gravity=FALL, m=1.3)
    assert set(constants(model)) == {"energy", "impulse.z", "galilei.z"}
    assert_held(model)


@pytest.mark.parametrize(
    ("name", "expected"),
    [
        ("double-pendulum", {"energy"}),
        ("acrobot", {"energy"}),
        ("puma560", {"energy", "momentum.x.q1"}),
        ("quarter-car", set()),
        ("gimbal-gyroscope", {"energy", "angular_momentum.z", "momentum.x.spin"}),
        ("ball-pendulum", {"energy", "angular_momentum.z"}),
    ],
)
def test_nothing_is_claimed_that_is_none(name: str, expected: set[str]) -> None:
    """Double pendulums have their energy only, damped machines nothing; Lagrange's top its two momenta."""
    assert set(constants(catalogue_model(name, FALL))) == expected


@pytest.mark.parametrize(
    ("law", "expected"),
    [
        ("k1*cos(t)*a", {"momentum.x.b", "linear.1"}),
        ("k1*a^4 + k2*a^2*b^2 + k3*b^4", {"energy"}),
    ],
)
def test_forced_and_mixed_oscillators(law: str, expected: set[str]) -> None:
    """A force in time on one leaves the other, which is free; a mixed quartic potential has only its energy."""
    model = with_parameters([slide("a", "m1"), slide("b", "m1")], law, m1=1.0, k1=1.0, k2=2.0, k3=0.7)
    assert set(constants(model)) == expected


def test_kovalevskaya() -> None:
    """A = B = 2 C, the mass centre in the plane of A and B: her integral is of degree four, and is not looked for."""
    body = {"name": "top", "parent": "base", "joint": {"type": "spherical", "coordinate": ["a", "b", "c"]}, "mass": 1}
    body |= {"com": [0.5, 0, 0], "inertia": {"xx": 2, "yy": "1.75", "zz": "0.75"}}
    found = first_integrals(model_of({"name": "d", "bodies": [body]}, FALL))
    assert {i.name for i in found.integrals} == {"energy", "angular_momentum.z"}
    assert found.degree == 2


def test_the_degree_is_said() -> None:
    model = planet()
    less = first_integrals(model, degree=1)
    assert less.degree == 1
    assert "linear in the momenta" in less.searched
    assert {i.kind for i in less.integrals} == {"energy", "angular_momentum"}
    assert "of degree 2 in slides" in first_integrals(model).searched
    large = first_integrals(catalogue_model("kuka-iiwa-14", FALL))
    assert (large.degree, large.searched.partition(": ")[2]) == (1, "7 coordinates; the limit is 6")
    with pytest.raises(InvalidArgument, match="give 1 or 2") as error:
        first_integrals(model, degree=3)  # type: ignore[arg-type]
    assert error.value.faults[0].pointer == "/degree"


def test_functions_that_depend_on_each_other_are_no_candidates(monkeypatch: pytest.MonkeyPatch) -> None:
    """Products of harmonics with sums of them: combinations that vanish everywhere are not handed to exact algebra."""
    monkeypatch.setattr(integral_search, "exact_constants", lambda *_: pytest.fail("a candidate"))
    part = derive(chain("chain", general_rows(1)))
    found = first_integrals(couple(row_of([part.definition]), {"p0": part}))
    assert [each.name for each in found.integrals] == ["energy"]


def test_a_wrong_constant_is_found(monkeypatch: pytest.MonkeyPatch) -> None:
    """By the zero formula, and where that were blind, by the certificate."""
    right = integral_search.exact_constants

    def wrong(ansatz: Any, columns: Any) -> Any:
        found = right(ansatz, columns)
        return found and Direction({j: c * (2 if j else 1) for j, c in found.components.items()})

    monkeypatch.setattr(integral_search, "exact_constants", wrong)
    model = with_parameters([slide("x", None), slide("y", "m", "on_x", **ACROSS)], "-2*k/sqrt(x^2 + y^2)", m=1.7, k=1.5)
    assert "not told are 2" in first_integrals(model).searched
    monkeypatch.setattr(VanishingOnAllSides, "__call__", lambda *_: True)
    other = with_parameters([slide("x", None), slide("y", "m", "on_x", **ACROSS)], "-3*k/sqrt(x^2 + y^2)", m=1.9, k=1.5)
    with pytest.raises(VerificationFailed):
        first_integrals(other)
