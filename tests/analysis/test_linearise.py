"""Perturbation equations, state space, vibrations, stability: closed forms, and differences on random trees."""

from __future__ import annotations

import dataclasses
from typing import Any

import numpy as np
import pytest
from analysis_models import catalogue_model, random_model, values_at
from in_depth import seeds
from random_trees import Plain, model_of, random_states
from scipy.interpolate import CubicSpline

from substructures import InvalidInput, Model, Program
from substructures.analysis.equations.perturbation import inputs_of, perturbation, state_space
from substructures.analysis.simulate import Outputs, simulate
from substructures.analysis.stability.equilibria import equilibria
from substructures.analysis.stability.linearise import linearise
from substructures.analysis.stability.vibrations import modes
from substructures.expr.interpret import interpret
from substructures.quantities.numbers.evaluation import evaluate

G = 9.81
STEP = 1e-4


def acceleration(model: Model, state: Plain) -> Any:
    return evaluate(model, ["forward_dynamics"], **state)["forward_dynamics"]


def slope(model: Model, state: Plain, key: str, name: Any) -> Any:
    """Central difference of the accelerations by a coordinate, a velocity or an input."""
    ends = []
    for h in (2 * STEP, STEP, -STEP, -2 * STEP):
        moved = dict(state)
        if key == "inputs":
            moved["inputs"] = state["inputs"] | {name: state["inputs"][name] + h}
        else:
            moved[key] = state[key] + h * np.eye(model.dof)[name]
        ends.append(acceleration(model, moved))
    return (8 * (ends[1] - ends[2]) - (ends[0] - ends[3])) / (12 * STEP)


@pytest.mark.parametrize("number", seeds((1, 2), 8))
def test_state_space_against_differences(number: int) -> None:
    """A and B of random trees with loads and inputs, at states of motion; as formulas and by M, D, K."""
    model = random_model(number)
    rng = np.random.default_rng(number)
    x = random_states(rng, 1, model.dof)
    inputs = {name: float(rng.uniform(-1, 1)) for name in inputs_of(model)}
    state = {"q": x["q"][0], "qd": x["qd"][0], "inputs": inputs, "t": 0.3}
    found = linearise(model, **state)
    n = model.dof
    lower = [[slope(model, state, key, a) for a in range(n)] for key in ("q", "qd")]
    expected = np.hstack([np.array(columns).T for columns in lower])
    scale = 1 + np.abs(expected).max()
    np.testing.assert_allclose(found.A[:n], np.eye(n, 2 * n, n))
    np.testing.assert_allclose(found.A[n:], expected, rtol=0, atol=1e-6 * scale)
    by_input = np.array([slope(model, state, "inputs", name) for name in inputs]).T
    np.testing.assert_allclose(found.B[n:], by_input, rtol=0, atol=1e-6 * (1 + np.abs(by_input).max()))
    formulas = state_space(model)
    values = values_at(model, x["q"], x["qd"], t=0.3) | inputs
    numbers = interpret(formulas, values)
    np.testing.assert_allclose(numbers["A"][0], found.A, rtol=0, atol=1e-9 * scale)
    np.testing.assert_allclose(numbers["B"][0], found.B, rtol=0, atol=1e-9 * (1 + np.abs(by_input).max()))


def test_outputs_of_the_state_space() -> None:
    """y = sin(q1) q2' + 3 tau1 with its derivatives, and x' = (q', q''), as formulas."""
    model, q, qd = catalogue_model("double-pendulum"), np.array([[0.4, -0.2]]), np.array([[0.5, 0.7]])
    source = state_space(model, ["sin(x.q1)*x.q2' + 3*tau.x.q1"], ["tau.x.q1"])
    found = interpret(source, values_at(model, q, qd) | {"tau.x.q1": 2.0})
    inputs = {"tau.x.q1": 2.0}
    accelerations = acceleration(model, {"q": q[0], "qd": qd[0], "inputs": inputs})
    np.testing.assert_allclose(found["C"][0], [[np.cos(0.4) * 0.7, 0, 0, np.sin(0.4)]])
    np.testing.assert_allclose(found["D"].ravel(), [3])
    np.testing.assert_allclose(found["output"].ravel(), [np.sin(0.4) * 0.7 + 6])
    np.testing.assert_allclose(found["derivative"][0], [*qd[0], *accelerations])


def test_along_a_trajectory() -> None:
    """Arrays with a leading axis, equal to the single states; the formulas survive storage."""
    model = catalogue_model("planar-3r")
    x = random_states(np.random.default_rng(1), 4, 3)
    many = linearise(model, x["q"], qd=x["qd"], outputs={"y": "x.q1 + x.q2'"})
    one = linearise(model, x["q"][2], qd=x["qd"][2], outputs={"y": "x.q1 + x.q2'"})
    for name in ("M", "D", "K", "F", "A", "B", "C", "Dy"):
        np.testing.assert_allclose(getattr(many, name)[2], getattr(one, name), atol=1e-12)
    assert one.C.tolist() == [[1, 0, 0, 0, 1, 0]]
    assert not one.is_equilibrium
    source = perturbation(model)
    assert Program.from_bytes(source.to_bytes()) == source


def test_along_a_driven_trajectory() -> None:
    """Inputs and times of a simulation, one for each state; the residual of a motion is zero."""
    model = catalogue_model("furuta-pendulum")
    name = f"tau.{model.coordinates[0]}"
    motion = simulate(model, [0, 0.3], (0, 1), inputs={name: "sin(5*t)/50"}, outputs=Outputs(count=5))
    request = {"q": motion.q, "qd": motion.qd, "t": motion.t, "inputs": {name: motion.series[name]}}
    found = linearise(model, **request)
    assert found.A.shape == (5, 4, 4)
    one = linearise(model, motion.q[3], qd=motion.qd[3], inputs={name: motion.series[name][3]})
    np.testing.assert_allclose(found.A[3], one.A, atol=1e-12)
    np.testing.assert_allclose(found.residual, 0, atol=1e-12)


def test_one_position_for_all_velocities() -> None:
    """What is given once holds for all states: q for all q', q'' for all q."""
    model = catalogue_model("double-pendulum")
    q, qd = np.array([0.3, -0.2]), np.array([[0, 0], [1, 2], [3, 1]])
    for found in (linearise(model, q, qd=qd), linearise(model, q[None], qd=qd)):
        np.testing.assert_array_equal(found.A, linearise(model, np.tile(q, (3, 1)), qd=qd).A)
    found = linearise(model, np.stack([q, 2 * q]), qdd=[1, 2])
    assert found.qdd.tolist() == [[1, 2], [1, 2]]
    np.testing.assert_array_equal(found.K[1], linearise(model, 2 * q, qdd=[1, 2]).K)


def test_damping_is_twice_coriolis_less_dampers() -> None:
    model = catalogue_model("ur5")
    x = random_states(np.random.default_rng(2), 1, 6)
    found = linearise(model, x["q"][0], qd=x["qd"][0])
    coriolis = evaluate(model, ["coriolis"], q=x["q"][0], qd=x["qd"][0])["coriolis"]
    np.testing.assert_allclose(found.D, 2 * coriolis, atol=1e-12)


def test_double_pendulum() -> None:
    """w^2 = g/l (2 -+ sqrt 2) for equal masses and rods (Landau and Lifshitz, section 23, problem 2)."""
    found = linearise(catalogue_model("double-pendulum"), [0, 0])
    assert found.stability is not None
    assert found.stability.verdict == "stable"
    squares = [mode.frequency**2 for mode in found.modes]
    np.testing.assert_allclose(squares, [G * (2 - np.sqrt(2)), G * (2 + np.sqrt(2))], rtol=1e-12)
    # absolute angles of the slow mode: 1 and sqrt 2
    shape = found.modes[0].shape.real
    np.testing.assert_allclose((shape[0] + shape[1]) / shape[0], np.sqrt(2), rtol=1e-12)


@pytest.mark.parametrize("damping", [0, 0.5])
def test_chain_of_five_masses(damping: float) -> None:
    """w_j = 2 sqrt(k/m) sin((2 j - 1) pi/22), damping ratio w_j b/(2 k) (one end fixed, one free)."""
    found = linearise(catalogue_model("mass-spring-chain", (0, 0, 0), b=damping), [0] * 5)
    exact = 2 * np.sqrt(100) * np.sin((2 * np.arange(1, 6) - 1) * np.pi / 22)
    np.testing.assert_allclose([mode.frequency for mode in found.modes], exact, rtol=1e-11)
    np.testing.assert_allclose([mode.damping_ratio for mode in found.modes], exact * damping / 200, atol=1e-12)
    assert found.stability is not None
    assert found.stability.verdict == ("asymptotically stable" if damping else "stable")


def test_upright_is_unstable() -> None:
    """Exponent sqrt(g/l)."""
    found = linearise(catalogue_model("simple-pendulum"), [np.pi])
    assert found.stability is not None
    assert found.stability.verdict == "unstable"
    assert sorted(mode.eigenvalue.real for mode in found.modes) == pytest.approx([-np.sqrt(G), np.sqrt(G)])
    assert found.stability.reason == "the eigenvalue 3.13209 1/s has a positive real part"


@pytest.mark.parametrize("more", [{}, {"qdd": [0, 0]}])
def test_a_state_at_rest_is_no_equilibrium_unless_forces_balance(more: Plain) -> None:
    """Released, it accelerates; held by given accelerations, a residual is left. Both have no modes."""
    found = linearise(catalogue_model("double-pendulum"), [0.3, 0], **more)
    assert (found.status, found.is_equilibrium, found.modes) == ("finished", False, ())
    assert max(np.abs(found.qdd).max(), np.abs(found.residual).max()) > 1


def test_where_the_linearisation_does_not_decide() -> None:
    """A free slide: eigenvalue 0; and s'' = -s^3, whose linear part is nothing."""
    slide = {"name": "a", "bodies": [{"name": "b", "parent": "base", "mass": 1, "joint": {"type": "prismatic"}}]}
    slide["bodies"][0]["joint"]["coordinate"] = "s"
    for loads in ([], [{"type": "joint", "coordinate": "s", "force": "-s^3"}]):
        found = linearise(model_of(slide | {"loads": loads}, (0, 0, 0)), [0])
        assert found.stability is not None
        assert found.stability.verdict == "undecided"


@pytest.mark.parametrize("sign", ["", "-"])
def test_dampers_that_vanish_at_rest_do_not_make_it_stable(sign: str) -> None:
    """s'' = -s + s^2 s' leaves its equilibrium, whose linearisation is an oscillator: (s'^2 + s^2)' = 2 s^2 s'^2."""
    slide = {"type": "prismatic", "coordinate": "s", "stiffness": 1}
    body = {"name": "b", "parent": "base", "mass": 1, "joint": slide}
    damped = {"name": "c", "parent": "base", "mass": 1, "joint": slide | {"coordinate": "z", "damping": 1}}
    loads = [{"type": "joint", "coordinate": "s", "force": f"{sign}c*s^2*s'"}]
    parameters = {"c": {"value": 1}}
    model = model_of({"name": "a", "bodies": [body, damped], "loads": loads, "parameters": parameters}, (0, 0, 0))
    verdicts = []
    for c in (0, 2):
        found = linearise(model, [0, 0], parameters=dict.fromkeys(model.parameters, c))
        assert found.stability is not None
        verdicts.append(found.stability.verdict)
    assert verdicts == ["stable", "undecided"]
    motion = simulate(model, [0.3, 0], (0, 50), outputs=Outputs(count=2))
    assert (motion.series["energy"][-1] > motion.series["energy"][0]) == (sign == "")


def test_modes_solve_the_eigenproblem() -> None:
    """(M z^2 + D z + K) shape = 0 for full random matrices."""
    rng = np.random.default_rng(5)
    mass, stiffness = (x @ x.T + np.eye(4) for x in rng.normal(size=(2, 4, 4)))
    for damping in (rng.normal(size=(4, 4)), np.zeros((4, 4))):
        for mode in modes(mass, damping, stiffness):
            z = mode.eigenvalue
            residual = (mass * z * z + damping * z + stiffness) @ mode.shape
            assert np.abs(residual).max() < 1e-10 * np.abs(stiffness).max()


def test_a_load_that_jumps_is_refused() -> None:
    """The message names the coordinate and says what to write instead."""
    model = catalogue_model("double-pendulum")
    program = model.program
    forces = program.outputs["forces"]
    operations = (*program.operations, ("sign", forces.entries[1]))
    outputs = dict(program.outputs) | {
        "forces": dataclasses.replace(forces, entries=(forces.entries[0], len(operations) - 1))
    }
    rough = dataclasses.replace(model, program=Program(program.symbols, operations, outputs))
    with pytest.raises(InvalidInput, match=r"the force on 'x\.q2' has no derivative.*sqrt") as error:
        linearise(rough, [0, 0])
    assert error.value.faults[0].code == "not-smooth"


def test_a_root_at_zero_is_a_failure_with_advice() -> None:
    body = {"name": "b", "parent": "base", "mass": 1, "joint": {"type": "prismatic", "coordinate": "s"}}
    loads = [{"type": "joint", "coordinate": "s", "force": "-sqrt(s'^2)"}]
    model = model_of({"name": "a", "bodies": [body], "loads": loads}, (0, 0, 0))
    found = linearise(model, [0], qd=[0])
    assert found.status == "failed"
    assert "root" in found.message
    moving = linearise(model, [0], qd=[2])
    assert moving.status == "finished"
    np.testing.assert_allclose(moving.D, [[1]])


def test_laws_have_their_derivative_where_their_pieces_meet() -> None:
    """|v| v at rest; a stiffness that is a smooth table at its places, of which one is the equilibrium, and at its end;
    not at the end of a monotone one, which is a corner."""
    body = {"name": "b", "parent": "base", "mass": 2, "joint": {"type": "prismatic", "coordinate": "s"}}

    def slide(force: str) -> Model:
        loads = [{"type": "joint", "coordinate": "s", "force": force}]
        return model_of({"name": "a", "bodies": [body], "loads": loads}, (0, 0, 0))

    damped = slide("-sqrt(s'^2)*s'")
    assert linearise(damped, [0], qd=[0]).status == "finished"
    np.testing.assert_allclose(linearise(damped, [0], qd=[0]).D, [[0]], atol=1e-8)
    np.testing.assert_allclose(linearise(damped, [0], qd=[2]).D, [[4]])
    x, y = [-1.0, 0.0, 1.1, 2.0], [-2.0, 0.0, 3.0, 4.0]
    spline, places = CubicSpline(x, y, bc_type="clamped"), ", ".join(f"{a}: {b}" for a, b in zip(x, y, strict=True))
    spring = slide(f"-table(s; {places}; smooth)")
    for at in (*x, 0.3):
        np.testing.assert_allclose(linearise(spring, [at]).K, [[spline(at, 1)]], atol=1e-7)
    (found,) = equilibria(spring, count=4).found
    np.testing.assert_allclose(found.q, [0], atol=1e-12)
    assert linearise(slide(f"-table(s; {places}; monotone)"), [2.0]).status == "failed"


@pytest.mark.parametrize(
    ("changes", "pointer"),
    [
        ({"q": [1]}, "/q"),
        ({"outputs": {"y": "x.q9"}}, "/outputs/y"),
        ({"of_inputs": ["tau.x.q1", "nothing"]}, "/of_inputs/1"),
        ({"parameters": {"x.nothing": 1}}, "/parameters/x.nothing"),
        ({"outputs": {"y": float("nan")}}, "/outputs/y"),
    ],
)
def test_faults_have_pointers(changes: Plain, pointer: str) -> None:
    with pytest.raises(InvalidInput) as error:
        linearise(catalogue_model("double-pendulum"), **{"q": [0, 0]} | changes)
    assert error.value.faults[0].pointer == pointer


def test_shown_in_two_lines() -> None:
    """Sizes, then the finding."""
    model = catalogue_model("double-pendulum")
    shown = repr(linearise(model, [0, 0])).splitlines()
    assert shown[0] == "Linearisation(n=2, inputs=2, outputs=0, states=1)"
    assert shown[1].startswith("about an equilibrium, stable: ")
    assert repr(linearise(model, [[0, 0], [1, 0]])).endswith("states=2)\nabout states along a motion")


@pytest.mark.parametrize("moment", [0.1, 0.3, 0.7, 2])
def test_a_metric_that_is_singular_but_for_rounding_fails_with_advice(moment: float) -> None:
    """Two joints on one axis and one body, g = J [1 1; 1 1]: the last pivot is 0, or what rounding leaves of it."""
    first: Plain = {"name": "a", "parent": "base", "joint": {"type": "revolute", "coordinate": "q1"}}
    inertia = {"xx": 1, "yy": 1, "zz": moment}
    second: Plain = {"name": "b", "parent": "a", "mass": 1, "inertia": inertia, "joint": {"type": "revolute"}}
    model = model_of({"name": "coaxial", "bodies": [first, second]}, (0, 0, -9.81))
    found = linearise(model, [0, 0])
    assert found.status == "failed"
    assert "the metric is singular" in found.message
    assert [place.verdict for place in equilibria(model, count=1).found] == ["failed"]


def test_a_soft_direction_beside_a_stiff_one_is_as_definite() -> None:
    """1e8 N/m beside m g l = 0.1 N m."""
    slide = {"type": "prismatic", "coordinate": "s", "stiffness": "10^8"}
    hinge = {"type": "revolute", "coordinate": "a", "placement": {"position": [0, 0, 0]}, "axis": [0, 1, 0]}
    bodies = [
        {"name": "frame", "parent": "base", "mass": 1000, "joint": slide},
        {"name": "bob", "parent": "frame", "mass": "1/100", "com": [0, 0, -1], "joint": hinge},
    ]
    model = model_of({"name": "stand", "bodies": bodies}, (0, 0, "-9.81"))
    verdicts = [
        linearise(model, [s, a]).stability for s, a in ((-9.81 * 1000.01 / 1e8, 0), (-9.81 * 1000.01 / 1e8, np.pi))
    ]
    assert [told and told.verdict for told in verdicts] == ["stable", "unstable"]
