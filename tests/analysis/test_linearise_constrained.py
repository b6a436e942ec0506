"""Linearisation with velocity constraints: the benchmark bicycle, the rolling disc, differences of the motion."""

from __future__ import annotations

from functools import cache
from math import cos, pi, sin, sqrt

import numpy as np
import pytest
from closed_trees import at, slider_crank
from random_trees import Plain
from rolling_bodies import BLADE, FLOOR, FORWARD, FRONT, REAR, A, C, M, R, bicycle_part, disc, single, sleigh

from substructures import ConstrainedMotion, Model, linearise
from substructures.analysis.equations.nonholonomic.quasi_velocities import quasi_velocity_equations
from substructures.analysis.simulate import Closed, Linear, Rolling
from substructures.analysis.stability.equilibria import equilibria
from substructures.analysis.stability.linearisation_result import ClosedLinearisation, ConstrainedLinearisation
from substructures.errors import InvalidInput
from substructures.expr.interpret import interpret


@cache
def bicycle() -> Model:
    return single(bicycle_part(), [0, 0, -9.81])


WHEELS = (Rolling("rear", "s.rear_axle", REAR), Rolling("front", "s.front_axle", FRONT))


def rolling_at(speed: float) -> ConstrainedLinearisation:
    q = [0, 0, REAR, 0, 0, 0, 0, 0, 0]
    v = {"s.rear'": speed / REAR}
    kind = ConstrainedMotion(WHEELS, independent=["s.lean", "s.steer", "s.rear"], v=v)
    found = linearise(bicycle(), q, kind=kind)
    assert isinstance(found, ConstrainedLinearisation)
    return found


@pytest.mark.parametrize(
    ("speed", "published"),
    [
        (0, [-5.53094371765393, -3.13164324790656, 3.13164324790656, 5.53094371765393]),
        (5, [-14.07838969279822, -0.77534188219585 + 4.46486771378823j, -0.32286642900409]),
        (10, [-24.62459635017404, -3.72016840437287 + 10.90681139476287j, 0.16105338653172]),
    ],
)
def test_bicycle(speed: float, published: list[complex]) -> None:
    """Table 2 of the paper: weave, capsize and castering of a tree with two rolling wheels; the eigenvalue 0 is that of
    the speed. M of lean and steer, y and steer the other way, is that of its equation (5.3).
    """
    found = rolling_at(speed)
    assert found.ignorable == ("s.x", "s.y", "s.yaw", "s.rear", "s.front")
    assert found.is_steady
    eigenvalues = sorted((mode.eigenvalue for mode in found.modes if abs(mode.eigenvalue) > 1e-9), key=lambda z: z.real)
    np.testing.assert_allclose(eigenvalues, published, rtol=1e-12)
    assert len(found.modes) == len(published) + 1
    lean_steer = [[80.81722, -2.31941332208709], [-2.31941332208709, 0.29784188199686]]
    np.testing.assert_allclose(found.M[:2, :2], lean_steer, rtol=1e-12)
    assert found.stability is not None
    assert found.stability.verdict == ("stable" if speed == 5 else "unstable")


@pytest.mark.parametrize("spin", [0.0, 3.0, 12.0])
def test_disc(spin: float) -> None:
    """Upright and straight: s^2 = (m g r A - C (C + m r^2) w^2)/(A (A + m r^2)), stable beyond w^2 = g/(3 r) for a thin
    homogeneous disc (Ju. I. Neimark and N. A. Fufaev, Dynamics of Nonholonomic Systems, AMS 1972).
    """
    kind = ConstrainedMotion([FLOOR], independent=["s.psi", "s.th", "s.ph"], v={"s.ph'": spin})
    found = linearise(disc(), [0, 0, R, 0, pi / 2, 0], kind=kind)
    assert isinstance(found, ConstrainedLinearisation)
    assert set(found.ignorable) == {"s.x", "s.y", "s.psi", "s.ph"}
    square = (M * 9.81 * R * A - C * (C + M * R**2) * spin**2) / (A * (A + M * R**2))
    assert max(abs(mode.eigenvalue) for mode in found.modes) == pytest.approx(sqrt(abs(square)), rel=1e-9)
    assert found.stability is not None
    assert (found.stability.verdict == "unstable") == (spin**2 < 9.81 / (3 * R))


def test_sleigh() -> None:
    """Along its blade: (I + m a^2) w' = -m a u w, so straight with the mass centre ahead is stable."""
    found = linearise(sleigh(), [0, 0, 0.4], kind=ConstrainedMotion([BLADE], velocities=FORWARD, v={"u": 2, "w": 0}))
    assert isinstance(found, ConstrainedLinearisation)
    assert [round(mode.eigenvalue.real, 12) for mode in found.modes] == [0, round(-2 * 0.25 * 2 / (0.3 + 2 / 16), 12)]
    # each speed is a motion of its own
    assert found.stability is not None
    assert found.stability.verdict == "stable"
    # the heading is ignorable, and turns into a way aside
    np.testing.assert_allclose(found.A[:2, 2], [-2 * sin(0.4), 2 * cos(0.4)], atol=1e-14)
    turning = linearise(sleigh(), [0, 0, 0], kind=ConstrainedMotion([BLADE], velocities=FORWARD, v={"u": 2, "w": 1}))
    assert isinstance(turning, ConstrainedLinearisation)
    assert not turning.is_steady
    assert "no equilibrium" in repr(turning)


@pytest.mark.parametrize("given", ["", " + 0.4*sin(s.y)*cos(2*t) - 0.3"])
def test_against_differences_of_the_motion(given: str) -> None:
    """A, B, C, D of a sleigh in general motion, whose blade may stand on something that moves."""
    q, v, inputs = [0.3, -0.2, 0.4], [1.2, 0.7], {"tau.s.x": 0.6, "tau.s.f": -0.4}
    blade = Linear("blade", "cos(s.f)*s.y' - sin(s.f)*s.x'" + given)
    kind = ConstrainedMotion([blade], velocities=FORWARD, v=v)
    outputs = {"speed": "s.x'^2 + s.y'^2", "turn": "s.f*tau.s.f"}
    found = linearise(sleigh(), q, kind=kind, t=0.3, inputs=inputs, outputs=outputs)
    assert isinstance(found, ConstrainedLinearisation)
    equations = quasi_velocity_equations(sleigh(), [blade], velocities=FORWARD)
    names = [*equations.model.coordinates, *equations.velocities]

    def rates(x: np.ndarray, u: np.ndarray) -> np.ndarray:
        values: Plain = dict(zip(names, x, strict=True)) | dict(zip(found.inputs, u, strict=True)) | {"t": 0.3}
        values |= {"s.m": 2, "s.a": 0.25, "s.I": 0.3}
        out = interpret(equations.program, values, ["metric", "bias", "forces", "rates"])
        moved = np.concatenate([out["rates"], np.linalg.solve(out["metric"], out["forces"] - out["bias"])])
        return np.concatenate([moved, [moved[0] ** 2 + moved[1] ** 2, x[2] * values["tau.s.f"]]])

    x, u, h = np.array([*q, *v]), np.array([inputs.get(name, 0.0) for name in found.inputs]), 1e-5
    by_state = [(rates(x + step, u) - rates(x - step, u)) / (2 * h) for step in h * np.eye(5)]
    by_input = [(rates(x, u + step) - rates(x, u - step)) / (2 * h) for step in h * np.eye(len(u))]
    np.testing.assert_allclose(np.vstack([found.A, found.C]), np.transpose(by_state), atol=1e-8)
    np.testing.assert_allclose(np.vstack([found.B, found.Dy]), np.transpose(by_input), atol=1e-8)
    np.testing.assert_allclose(np.concatenate([found.qd, found.vd]), rates(x, u)[:5], atol=1e-14)


def test_closed_loops_as_constraints() -> None:
    """The vibrations of a slider-crank about an equilibrium, as in independent coordinates by multipliers."""
    model = slider_crank(gravity=[0, -9.81, 0])
    (best, *_) = equilibria(model, starts=at(model, crank=0.5, piston=0.17)).found
    assert isinstance(best.at, ClosedLinearisation)
    kind = ConstrainedMotion([Closed(model.closures[0].name)], independent=best.at.independent)
    found = linearise(model, best.q, kind=kind)
    assert isinstance(found, ConstrainedLinearisation)
    np.testing.assert_allclose(found.M, best.at.M, atol=1e-10)
    ours, theirs = ([mode.eigenvalue for mode in some] for some in (found.modes, best.at.modes))
    np.testing.assert_allclose(ours, theirs, atol=1e-7)
    with pytest.raises(InvalidInput, match="open by"):
        linearise(model, np.asarray(best.q) + 0.1, kind=kind)


@pytest.mark.parametrize(
    ("change", "pointer"),
    [
        ({"qdd": [0, 0, 0]}, "/qdd"),
        ({"q": [[0, 0, 0], [0, 0, 1]]}, "/q"),
        ({"qd": [1, 1, 0]}, "/qd"),
        ({"kind": ConstrainedMotion([BLADE], v=[1])}, "/v"),
    ],
)
def test_bad_arguments(change: Plain, pointer: str) -> None:
    given: Plain = {"q": [0, 0, 0], "kind": ConstrainedMotion([BLADE], velocities=FORWARD)} | change
    with pytest.raises(InvalidInput) as caught:
        linearise(sleigh(), **given)
    assert caught.value.faults[0].pointer == pointer


@pytest.mark.parametrize("force", ["-2*x' - x^3", "-2*x' + 1e-6*x^3"])
def test_what_no_family_passes_through_is_not_called_stable(force: str) -> None:
    """A spring that has only a cubic term: K = 0 at rest, and there is no other rest beside it."""
    definition = {
        "name": "cubic",
        "bodies": [
            {"name": name, "parent": "base", "mass": 1, "joint": {"type": "prismatic", "coordinate": name}}
            for name in ("x", "y")
        ],
        "loads": [{"type": "joint", "coordinate": "x", "force": force}],
    }
    kind = ConstrainedMotion([Linear("tied", "s.y' - s.x'")], independent=["s.x"])
    found = linearise(single(definition, [0, 0, 0]), [0, 0], kind=kind)
    assert found.stability is not None
    assert found.stability.verdict == "undecided"
    assert "higher order" in found.stability.reason
