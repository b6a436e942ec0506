"""Trees with velocity constraints: derivatives of motions, root loci, and what perturbs a motion, as formulas."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
from closed_trees import tree_model
from random_trees import Plain
from rolling_bodies import FORWARD, A, C, M, R, disc_part, sleigh_part

from substructures import ConstrainedMotion, Model, catalogue, sensitivities, simulate
from substructures.analysis.equations.nonholonomic.quasi_velocities import quasi_velocity_equations
from substructures.analysis.equations.nonholonomic.solved import solved
from substructures.analysis.equations.nonholonomic.velocity_constraints import closing
from substructures.analysis.from_fields import sensitivity_arguments
from substructures.analysis.motion.problems.outputs import Outputs, SensitivityOutputs
from substructures.analysis.stability.root_locus import root_locus
from substructures.errors import InvalidInput
from substructures.expr.interpret import interpret

EDGE = {"name": "blade", "type": "knife_edge", "frame": "s.b"}
FLOOR = {"name": "floor", "type": "rolling", "frame": "s.disc", "radius": "s.r"}

ANGLES = ["s.psi", "s.th", "s.ph"]


def tied(part: Plain, constraints: list[Plain], gravity: Any = (0, 0, -9.81), **more: Any) -> Model:
    tree = {"gravity": list(gravity), "instances": [{"name": "s", "substructure": "p"}], **more}
    return tree_model({**tree, "velocity_constraints": constraints}, {"p": part})


def moved(model: Model, kind: ConstrainedMotion, start: Plain, parameter: str, value: float) -> Any:
    """(q, q') of a simulation with another value of a parameter."""
    request = {name: x for name, x in start.items() if name != "count"}
    motion = simulate(model, **request, parameters={parameter: value}, kind=kind, outputs=Outputs(count=start["count"]))
    assert motion.is_right
    return np.concatenate([motion.q, motion.qd], axis=1)


@pytest.mark.parametrize("parameter", ["s.a", "s.m", "s.I"])
def test_derivatives_of_a_sleigh_are_those_of_its_motion(parameter: str) -> None:
    """By the motion itself, simulated on both sides of the parameter."""
    model = tied(sleigh_part(), [EDGE], (0, 0, 0))
    kind = ConstrainedMotion(closing(model), velocities=FORWARD, v={"u": 2.0, "w": 1.0})
    start: Plain = {"q": [0, 0, 0.4], "span": (0, 2), "count": 5}
    found = sensitivities(model, start["q"], start["span"], [parameter], kind=kind, outputs=SensitivityOutputs(count=5))
    assert found.is_right, found.checks
    value, h = {"s.a": 0.25, "s.m": 2.0, "s.I": 0.3}[parameter], 1e-3
    one, two, three, four = (moved(model, kind, start, parameter, value + k * h) for k in (-2, -1, 1, 2))
    # differences of fourth order
    expected = (one - 8 * two + 8 * three - four) / (12 * h)
    np.testing.assert_allclose(found.series[f"d.{parameter}"], expected, atol=2e-8 * np.abs(expected).max())
    assert np.abs(expected[-1]).min() > 1e-4


def test_derivatives_by_the_start_keep_the_constraint() -> None:
    """Of a rolling disc: columns by q_0 and v_0 are those of neighbouring motions, all of which roll."""
    model = tied(disc_part(), [FLOOR])
    kind = ConstrainedMotion(closing(model), independent=ANGLES, v=[1.0, 0.2, -6.0])
    q = np.array([0, 0, R * np.sin(1.2), 0.2, 1.2, 0])
    found = sensitivities(model, q, (0, 1), kind=kind, outputs=SensitivityOutputs(count=3, of_start=True))
    assert found.is_right, found.checks
    columns = found.series["d.start"]
    assert columns.shape == (3, 12, 9)
    h = 1e-4
    for k, (place, change) in enumerate([(4, q), (6, kind.v), (8, kind.v)]):
        sides = []
        for side in (h, -h):
            v, at = np.array(kind.v, dtype=float), q.copy()
            (at if change is q else v)[place if change is q else place - 6] += side
            other = ConstrainedMotion(kind.constraints, independent=kind.independent, v=v)
            motion = simulate(model, at, (0, 1), kind=other, outputs=Outputs(count=3))
            sides.append(np.concatenate([motion.q, motion.qd], axis=1))
        expected = (sides[0] - sides[1]) / (2 * h)
        np.testing.assert_allclose(columns[:, :, place], expected, atol=2e-6 * np.abs(expected).max(), err_msg=str(k))
    # dx = x' dt is one of these changes: S of x' at the start is x' at the end
    at_start = np.concatenate([found.qd[0], accelerations(model, found.q[0], found.series["v"][0])])
    at_end = columns[-1] @ at_start
    np.testing.assert_allclose(at_end[:6], found.qd[-1], atol=1e-8)


def accelerations(model: Model, q: Any, v: Any) -> Any:
    """v' of the disc."""
    program = solved(quasi_velocity_equations(model, independent=ANGLES))
    values = dict(zip(model.coordinates, q, strict=True)) | dict(zip([f"{x}'" for x in ANGLES], v, strict=True))
    values |= {"s.r": R, "s.m": M} | {s.name: 0.0 for s in program.symbols if s.kind == "input"}
    return interpret(program, values)["acceleration"]


def test_derivatives_of_a_closed_mechanism() -> None:
    """A four-bar under gravity by a mass, against its simulations; by a length the start would not stay closed."""
    pin = {"name": "pin", "type": "pin", "from": "f.coupler_end", "to": "f.rocker_end"}
    tree: Plain = {"gravity": [0, -9.81, 0], "instances": [{"name": "f", "substructure": "four-bar"}]}
    model = tree_model({**tree, "closures": [pin]}, {"four-bar": catalogue.load("four-bar")})
    q = [0.6, -0.2, 1.5]
    found = sensitivities(model, q, (0, 0.3), ["f.m2"], outputs=SensitivityOutputs(count=3))
    assert found.is_right, found.checks
    # the start was moved onto the closure
    assert np.abs(found.q[0] - q).max() > 0.01
    start: Plain = {"q": found.q[0], "span": (0, 0.3), "count": 3}
    kind, h = ConstrainedMotion(closing(model)), 1e-3
    sides = [moved(model, kind, start, "f.m2", 1.4 + k * h) for k in (-1, 1)]
    expected = (sides[1] - sides[0]) / (2 * h)
    np.testing.assert_allclose(found.series["d.f.m2"], expected, atol=1e-5 * np.abs(expected).max())
    assert np.abs(expected[-1]).min() > 1e-3
    with pytest.raises(InvalidInput) as caught:
        sensitivities(model, q, (0, 0.3), ["f.l2"])
    assert (caught.value.faults[0].pointer, caught.value.faults[0].code) == ("/by/0", "opens-closure")


def test_what_means_nothing_to_derivatives_says_so() -> None:
    model = tied(sleigh_part(), [EDGE], (0, 0, 0))
    start: Plain = {"q": [0, 0, 0.4], "span": (0, 1), "by": ["s.a"]}
    for given, pointer, code in (
        ({"v": {"w": 1}}, "/v", "unknown-velocity"),
        ({"qd": [1, 1, 0]}, "/qd", "violated"),
        ({"independent": ["s.z", "s.f"]}, "/independent/0", "unknown-coordinate"),
        ({"by": ["s.b"]}, "/by/0", "unknown-parameter"),
    ):
        with pytest.raises(InvalidInput) as caught:
            sensitivities(model, **sensitivity_arguments(model, **{**start, **given}))
        assert (caught.value.faults[0].pointer, caught.value.faults[0].code) == (pointer, code)
    free = tied(sleigh_part(), [], (0, 0, 0))
    with pytest.raises(InvalidInput, match="means nothing to a motion"):
        sensitivity_arguments(free, **start, v=[1, 2])


def test_accelerations_of_a_rolling_disc() -> None:
    """q'' is the derivative of q' along the motion; the steady circle has th'' = 0 (E. J. Routh, 1884, article 244)."""
    model = tied(disc_part(), [FLOOR])
    program = solved(quasi_velocity_equations(model, independent=ANGLES))
    th, psi = 1.2, 1.5
    spin = (A * psi**2 * np.sin(th) * np.cos(th) - M * 9.81 * R * np.cos(th)) / ((C + M * R * R) * psi * np.sin(th))
    values = {"s.r": R, "s.m": M, "s.th": th, "s.psi": 0.3, "s.ph": 0.1, "s.x": 0, "s.y": 0, "s.z": R * np.sin(th)}
    values |= {"s.psi'": psi, "s.th'": 0.0, "s.ph'": spin - psi * np.cos(th)}
    values |= {s.name: 0.0 for s in program.symbols if s.kind == "input"}
    found = interpret(program, values)
    np.testing.assert_allclose(found["acceleration"], 0, atol=1e-12)
    # the centre goes round: its acceleration is psi' times its velocity, turned by a right angle
    x, y, z = found["rates"][:3]
    np.testing.assert_allclose(found["second"][:3], [-psi * y, psi * x, 0], atol=1e-12)
    assert abs(z) < 1e-12
    assert abs(float(found["power"])) < 1e-12


def test_a_pendulum_on_a_rolling_disc_swings_faster_the_lighter_the_disc() -> None:
    """w^2 = m g l (N + m) / ((J + m l^2) (N + m) - m^2 l^2) with N = M + C/r^2 of the disc, hanging (a cart)."""
    free = {"type": "planar", "coordinate": ["x", "z", "turn"], "placement": {"rpy": ["pi/2", 0, 0]}}
    hinge = {"type": "revolute", "coordinate": "q", "placement": {"position": [0, 0, 0]}}
    wheel: Plain = {"mass": "M", "inertia": {"xx": "C/2", "yy": "C/2", "zz": "C"}}
    rod: Plain = {"mass": 1, "com": [0, -0.3, 0], "inertia": {"xx": 0.02, "zz": 0.02}}
    bodies: list[Plain] = [
        {"name": "disc", "parent": "base", "joint": free, **wheel},
        {"name": "rod", "parent": "disc", "joint": hinge, **rod},
    ]
    parameters = {"M": {"value": 2, "unit": "kg"}, "C": {"value": 0.25, "unit": "kg*m^2"}}
    part: Plain = {"name": "p", "bodies": bodies, "parameters": parameters}
    model = tied(part, [{**FLOOR, "radius": 0.5}])
    masses = [2.0, 1.5, 1.0, 0.5]
    locus = root_locus(model, "s.M", masses, [0, 0.5, 0, 0])
    assert (locus.status, len(locus.values)) == ("finished", 4)
    for mass, roots in zip(masses, locus.eigenvalues, strict=True):
        cart, m, length, inertia = mass + 0.25 / 0.25, 1.0, 0.3, 0.02
        square = m * 9.81 * length * (cart + m) / ((inertia + m * length**2) * (cart + m) - (m * length) ** 2)
        np.testing.assert_allclose(np.abs(roots).max(), np.sqrt(square), rtol=1e-9)
        np.testing.assert_allclose(roots.real, 0, atol=1e-6)
