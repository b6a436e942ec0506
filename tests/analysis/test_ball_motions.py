"""Motions of ball and floating joints: tops in closed form, a satellite past 90 degrees, chains of angles beside."""

# ruff: noqa: N806 -- symbols of the notation

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np
import pytest
from scipy.special import ellipj

from substructures import (
    Event,
    FixedStep,
    Geodesic,
    Integrator,
    InvalidDocument,
    Model,
    Outputs,
    TreeMotion,
    TreeSpec,
    couple,
    derive,
    evaluate,
    simulate,
)
from substructures.analysis.motion.right_hand_side import forward_dynamics
from substructures.analysis.motion.writers import to_csv
from substructures.certificate.derived.model_formulas import simulated
from substructures.errors import InvalidInput, VerificationFailed
from substructures.expr.program import Program
from substructures.quantities.certificate import certified
from substructures.quantities.powers import powers
from substructures.quantities.reactions import reactions

Plain = dict[str, Any]


def model_of(bodies: list[Plain], gravity: Any = (0, 0, 0), **more: Any) -> Model:
    definition = {"name": "d", "bodies": bodies, **more}
    tree = {"name": "t", "gravity": list(gravity), "instances": [{"name": "x", "substructure": "d"}]}
    return couple(tree, {"x": derive(definition)})


def body(name: str, parent: str, joint: Plain, inertia: Any = (1, 2, 3), mass: Any = 1, com: Any = (0, 0, 0)) -> Plain:
    tensor = dict(zip(("xx", "yy", "zz"), inertia, strict=True))
    return {"name": name, "parent": parent, "mass": mass, "com": list(com), "inertia": tensor, "joint": joint}


def turn(axis: int, angle: float) -> np.ndarray:
    c, s = np.cos(angle), np.sin(angle)
    i, j = (axis + 1) % 3, (axis + 2) % 3
    R = np.eye(3)
    R[i, i], R[i, j], R[j, i], R[j, j] = c, -s, s, c
    return R


def quaternion(turned: np.ndarray) -> np.ndarray:
    """Of a turn by less than 180 degrees."""
    R, w = turned, np.sqrt(1 + np.trace(turned)) / 2
    return np.array([w, *(np.array([R[2, 1] - R[1, 2], R[0, 2] - R[2, 0], R[1, 0] - R[0, 1]]) / (4 * w))])


def places(model: Model, q: np.ndarray) -> np.ndarray:
    return np.asarray(evaluate(model, "position", q)["position"])


def test_kovalevskayas_top() -> None:
    """A = B = 2 C, the mass centre on the first axis: |(p + i q)^2 - (m g l / C)(g1 + i g2)|^2 is constant for the
    vertical g in the axes of the body (S. Kowalevski, Acta Mathematica 12, 1889), through every attitude.
    """
    C, length, gravity = 1.0, 0.5, 9.81
    about_centre = (2 * C, 2 * C - length**2, C - length**2)
    model = model_of([body("top", "base", {"type": "ball"}, about_centre, 1, (length, 0, 0))], (0, 0, -gravity))
    motion = simulate(model, [0.8, 0.36, 0.48, 0], (0, 6), qd=[0.5, -0.4, 0.9], outputs=Outputs(count=200))
    assert motion.is_right is True
    a, x, y, z = motion.q.T
    vertical = 2 * (x * z - a * y) + 2j * (y * z + a * x)
    w = motion.qd[:, 0] + 1j * motion.qd[:, 1]
    found = np.abs(w**2 - gravity * length / C * vertical) ** 2
    np.testing.assert_allclose(found, found[0], rtol=1e-8)
    assert np.ptp(np.abs(w)) > 0.2


def test_eulers_top_in_elliptic_functions() -> None:
    """w = (a cn, b sn, c dn) of (p t, k^2); L. D. Landau and E. M. Lifshitz, Mechanics, section 37."""
    A, B, C = 1.0, 2.0, 3.0
    model = model_of([body("top", "base", {"type": "ball"})])
    a, c = 0.4, 1.0
    p = c * np.sqrt((C - B) * (C - A) / (A * B))
    b = (C - A) / B * c * a / p
    k2 = (B - A) / C * a * b / (c * p)
    motion = simulate(model, [0.6, 0, 0.8, 0], (0, 30), qd=[a, 0, c])
    assert motion.is_right is True
    momenta = {f"angular_momentum.{axis}" for axis in "xyz"}
    assert {check.name for check in motion.checks} == {"energy", *momenta, "quaternions", "steps"}
    sn, cn, dn, _ = ellipj(p * motion.t, k2)
    np.testing.assert_allclose(motion.qd, np.stack([a * cn, b * sn, c * dn], axis=1), atol=1e-8)
    np.testing.assert_allclose(np.linalg.norm(motion.q, axis=1), 1, rtol=1e-14)
    L = evaluate(model, "momentum", motion.q, motion.qd)["momentum"]["angular"]
    np.testing.assert_allclose(L, np.broadcast_to(L[0], L.shape), atol=1e-8)


@pytest.mark.parametrize(("method", "order", "error"), [("rk4", 4, 2e-8), ("semi-implicit-euler", 1, 0.05)])
def test_fixed_steps_have_the_order_of_their_method(method: Any, order: int, error: float) -> None:
    """Beside the closed form of the turning, and of the place of a body that slides meanwhile; Euler's steps are turns,
    which keep quaternions at length 1.
    """
    model = model_of([body("top", "base", {"type": "floating"}, (1, 1, 2), 3)])
    w, W, v = 0.7, 1.1, np.array([0.3, -0.2, 0.5])  # w_z = W, w_x + i w_y = w exp(i W t): Euler's equations of A = B
    gaps, norms = [], []
    for step in (0.02, 0.01):
        motion = simulate(
            model, [0, 0, 0, 1, 0, 0, 0], (0, 2), qd=[*v, w, 0, W], integrator=Integrator(FixedStep(step, method))
        )
        turning = w * np.exp(1j * W * motion.t)
        rates = np.stack([turning.real, turning.imag, W + 0 * motion.t], axis=1)
        expected = np.concatenate([np.outer(motion.t, v), rates], axis=1)
        gaps.append(np.abs(np.concatenate([motion.q[:, :3], motion.qd[:, 3:]], axis=1) - expected).max())
        norms.append({check.name: check for check in motion.checks}["quaternions"].relative)
    assert gaps[0] < error
    assert np.log2(gaps[0] / gaps[1]) == pytest.approx(order, abs=0.15)
    assert max(norms) < (1e-8 if order == 4 else 1e-14)


def test_events_act_on_balls() -> None:
    """A body that falls upright is thrown back with half of its velocity: t = sqrt(2 h/g) (1 + 2 e + 2 e^2 ...), and
    one that is turned upside down goes on there.
    """
    model = model_of([body("hull", "base", {"type": "floating", "velocities": [*"abc", "wx", "wy", "wz"]})], (0, 0, -2))
    bounce = Event("bounce", "x.r_hull_z", direction="falling", reset={"x.c'": "-x.c'/2"})
    found = simulate(model, [0, 0, 1, 1, 0, 0, 0], (0, 2.8), outputs=Outputs(events=[bounce]))
    assert found.is_right is True
    np.testing.assert_allclose([each.t for each in found.events], [1, 2, 2.5, 2.75], rtol=1e-9)
    np.testing.assert_allclose(
        [each.energy_change for each in found.events], -0.75 * 2 / 4.0 ** np.arange(4), rtol=1e-8
    )
    over = replace(bounce, reset={"x.c'": "x.c'", "x.q_hull_w": 0, "x.q_hull_x": 3})
    found = simulate(model, [0, 0, 1, 1, 0, 0, 0], (0, 2), outputs=Outputs(events=[over]))
    assert found.is_right is True
    np.testing.assert_allclose(found.q[-1], [0, 0, 0 + 2 * 1 - 1, 0, 1, 0, 0], atol=1e-9)


def test_lagranges_top_precesses_steadily() -> None:
    """A O^2 cos(theta) - C w_3 O + m g l = 0 (H. Goldstein, Classical Mechanics, section 5.7)."""
    m, l, g, A, C, theta, O = 2.0, 0.3, 9.81, 0.5, 0.2, 0.6, 1.5  # noqa: E741 -- the length of the arm
    model = model_of(
        [body("top", "base", {"type": "ball"}, (A - m * l * l, A - m * l * l, C), 2, (0, 0, "0.3"))],
        (0, 0, "-9.81"),
        ports=[{"name": "tip", "body": "top", "position": [0, 0, "0.3"]}],
    )
    w3 = (A * O**2 * np.cos(theta) + m * g * l) / (C * O)
    motion = simulate(model, quaternion(turn(0, theta)), (0, 5), qd=[0, O * np.sin(theta), w3])
    assert motion.is_right is True
    tip = places(model, motion.q)[:, model.frames.index("x.tip")]
    expected = [turn(2, O * t) @ turn(0, theta) @ [0, 0, l] for t in motion.t]
    np.testing.assert_allclose(tip, expected, atol=1e-8)
    np.testing.assert_allclose(motion.qd[:, 2], w3, rtol=1e-12)


def test_what_holds_a_top_and_what_works_on_it() -> None:
    """Its point is held with m g upwards and m O^2 l sin(th) towards the vertical; with a damper at its tip the powers
    of gravity, of joints and of loads are all that changes its kinetic energy.
    """
    m, l, g, A, C, th, O = 2.0, 0.3, 9.81, 0.5, 0.2, 0.6, 1.5  # noqa: E741 -- the length of the arm
    moments = (A - m * l * l, A - m * l * l, C)
    damper = {"type": "spring", "from": {"body": "base", "at": [1, 0, 0]}, "to": {"body": "top", "at": [0, 0, "0.3"]},
              "stiffness": 3, "damping": "0.4", "length": "0.2"}  # fmt: skip
    for loads in ([], [damper]):
        definition = {"name": "d", "loads": loads,
                      "bodies": [body("top", "base", {"type": "ball"}, moments, 2, (0, 0, "0.3"))]}  # fmt: skip
        tree = {"name": "t", "gravity": [0, 0, "-9.81"], "instances": [{"name": "x", "substructure": "d"}]}
        spec, parts = TreeSpec.read(tree), {"x": derive(definition)}
        model = couple(spec, parts)
        w3 = (A * O**2 * np.cos(th) + m * g * l) / (C * O)
        wanted = Outputs(count=6, reactions=reactions(spec, parts), powers=powers(spec, parts))
        motion = simulate(
            model, quaternion(turn(0, th)), (0, 1), qd=[0, O * np.sin(th), w3], outputs=wanted,
            inputs={"tau.x.w_top_x": "0.3*cos(2*t)"} if loads else None,
        )  # fmt: skip
        assert motion.is_right is True
        assert "power" in {check.name for check in motion.checks}
        if not loads:
            force = motion.series["reaction_force_world"][:, 0]
            towards = [turn(2, O * t) @ [0, m * O**2 * l * np.sin(th), m * g] for t in motion.t]
            np.testing.assert_allclose(force, towards, atol=1e-7)


def satellite() -> Model:
    wheel = {"type": "revolute", "coordinate": "spin", "theta": "0.3", "d": "0.2", "damping": "0.01"}
    hull = body("hull", "base", {"type": "floating", "velocities": ["vx", "vy", "vz", "wx", "wy", "wz"]}, mass=5)
    return model_of([hull, body("wheel", "hull", wheel, ("0.1", "0.1", "0.2"), 1, ("0.1", 0, 0))])


def test_a_satellite_turns_past_a_pitch_of_90_degrees() -> None:
    model = satellite()
    start, rates = [1, 2, 3, 1, 0, 0, 0, 0.2], [0.1, 0, 0.2, 0.05, 1.0, 0.02, 1.5]
    motion = simulate(model, start, (0, 8), qd=rates)
    assert motion.is_right is True
    assert motion.positions == model.positions
    R = evaluate(model, "rotation", motion.q)["rotation"][:, model.frames.index("x.hull")]
    assert np.abs(R[:, 2, 0]).max() > 0.999  # the sine of the pitch
    momentum = evaluate(model, "momentum", motion.q, motion.qd)["momentum"]
    for found in momentum.values():
        np.testing.assert_allclose(found, np.broadcast_to(found[0], found.shape), atol=1e-7)
    assert to_csv(motion).splitlines()[0].startswith("t,x.r_hull_x,x.r_hull_y,x.r_hull_z,x.q_hull_w,")


def test_inputs_events_and_series_name_positions() -> None:
    model = satellite()
    half = Event("upside down", "x.q_hull_w", action="stop")
    outputs = Outputs(events=[half], series={"height": "x.r_hull_z", "pull": "x.wy'"})
    found = simulate(model, [0, 0, 0, 1, 0, 0, 0, 0], (0, 60), qd=[0] * 7, inputs={"tau.x.wy": "0.1"}, outputs=outputs)
    assert (found.status, found.is_right) == ("stopped", True)
    assert found.events[0].q[3] == pytest.approx(0, abs=1e-9)
    assert found.series["pull"][-1] > 0
    assert found.series["work"][-1] == pytest.approx(found.series["energy"][-1] - found.series["energy"][0], rel=1e-7)


def test_events_have_quaternions_of_length_one() -> None:
    """As results have them, however roughly they were integrated."""
    rough = Integrator(relative_tolerance=1e-3, absolute_tolerance=1e-4)
    outputs = Outputs(events=[Event("half", "x.q_hull_w")])
    start, turning = [0, 0, 0, 1, 0, 0, 0, 0], [0, 0, 0, 0.4, 0.9, 0.2, 0]
    found = simulate(satellite(), start, (0, 60), qd=turning, integrator=rough, outputs=outputs)
    assert {check.name: check for check in found.checks}["quaternions"].relative > 1e-9
    lengths = [np.linalg.norm(event.q[3:7]) for event in found.events]
    np.testing.assert_allclose(lengths, np.ones(len(lengths)), rtol=1e-14)
    assert lengths


def test_two_balls_move_as_two_chains_of_angles() -> None:
    """Away from a pitch of 90 degrees, with springs, dampers and a force of the world."""

    def pendulum(kind: str) -> Model:
        links = [
            body("upper", "base", {"type": kind}, ("0.1", "0.2", "0.3"), 1, (0, 0, "-0.5")),
            body("lower", "upper", {"type": kind, "placement": {"position": [0, 0, -1]}}, ("0.2", "0.1", "0.3"), 2,
                 ("0.1", 0, "-0.4")),
        ]  # fmt: skip
        loads = [
            {"type": "force", "body": "lower", "at": [0, 0, -1], "vector": ["0.5", 0, 0], "frame": "world"},
            {"type": "spring", "from": {"body": "base", "at": [1, 0, 0]}, "to": {"body": "lower", "at": [0, 0, -1]},
             "stiffness": 3, "damping": "0.2", "length": "0.5"},
        ]  # fmt: skip
        port = {"name": "tip", "body": "lower", "position": [0, 0, -1]}
        return model_of(links, (0, 0, "-9.81"), loads=loads, ports=[port])

    chain, balls = pendulum("spherical"), pendulum("ball")
    angles, rates = np.array([0.2, 0.3, -0.1, 0.4, -0.2, 0.5]), np.array([0.3, -0.2, 0.5, 0.1, 0.4, -0.3])
    q, v = [], []
    for (yaw, pitch, roll), (dy, dp, dr) in zip(angles.reshape(2, 3), rates.reshape(2, 3), strict=True):
        X, Y = turn(0, roll), turn(1, pitch)
        q.append(quaternion(turn(2, yaw) @ Y @ X))
        # in the axes of the body
        v.append(X.T @ (Y.T @ [0, 0, dy] + [0, dp, 0]) + [dr, 0, 0])
    times = Outputs(count=21)
    one = simulate(chain, angles, (0, 1.5), qd=rates, outputs=times)
    two = simulate(balls, np.concatenate(q), (0, 1.5), qd=np.concatenate(v), outputs=times)
    assert one.is_right is two.is_right is True
    np.testing.assert_allclose(places(balls, two.q), places(chain, one.q), atol=1e-8)
    E = [each.series["energy"] - each.series["energy"][0] for each in (one, two)]
    np.testing.assert_allclose(E[0], E[1], atol=1e-8)


def test_what_is_not_known_is_refused() -> None:
    model = satellite()
    start = [0, 0, 0, 1, 0, 0, 0, 0]
    with pytest.raises(InvalidInput, match="DOP853"):
        simulate(model, start, (0, 1), integrator=Integrator("Taylor"))
    with pytest.raises(InvalidInput, match="do not stop for events"):
        simulate(
            model, start, (0, 1), integrator=Integrator(FixedStep(0.01)), outputs=Outputs(events=[Event("e", "t")])
        )
    with pytest.raises(InvalidInput, match="no joint of the tree has"):
        simulate(model, start, (0, 1), kind=TreeMotion("exact"))
    with pytest.raises(InvalidDocument, match="'spherical' and 'free'"):
        simulate(model, start, (0, 1), kind=Geodesic())
    with pytest.raises(InvalidInput, match="norm of the quaternion"):
        simulate(model, [0, 0, 0, 1, 0, 0, 1, 0], (0, 1))


def test_wrong_equations_are_found() -> None:
    """Each number of the program of a motion, doubled."""
    model = satellite()
    right = forward_dynamics(model)
    expected, found = simulated(model.positions, model.balls), 0
    for i, operation in enumerate(right.operations):
        if operation[0] == "rat":
            wrong = (
                *right.operations[:i],
                ("rat", operation[1], str(int(operation[2]) + 1)),
                *right.operations[i + 1 :],
            )
            with pytest.raises(VerificationFailed):
                certified(Program(right.symbols, wrong, right.outputs), model, expected, "equations")
            found += 1
    assert found > 2


def test_a_motion_that_loses_its_quaternion_is_not_right() -> None:
    rough = Integrator("RK23", relative_tolerance=1e-2, absolute_tolerance=1e-2)
    motion = simulate(
        model_of([body("top", "base", {"type": "ball"})]), [1, 0, 0, 0], (0, 20), qd=[1, 2, 0.5], integrator=rough
    )
    assert motion.is_right is False
    assert {check.name for check in motion.checks if check.holds is False} >= {"quaternions"}
