"""Rolling and knife edges against their textbook equations; Voronets and Boltzmann-Hamel give the same."""

# ruff: noqa: N806 -- symbols of the notation

from __future__ import annotations

import numpy as np
import pytest
from closed_trees import at, slider_crank, tree_model
from random_trees import Kind, Plain, model_of, random_definition

from substructures import InvalidDocument, Model
from substructures.analysis.loops import analyse_loops
from substructures.analysis.quasi_velocities import QuasiVelocities, quasi_velocity_equations
from substructures.analysis.simulate import simulate
from substructures.analysis.simulate_closed import simulate_closed
from substructures.analysis.simulate_rolling import FORMS, simulate_rolling
from substructures.evaluation import evaluate
from substructures.expr.expand import is_zero
from substructures.expr.graph import Graph
from substructures.expr.interpret import interpret
from substructures.expr.parse import parse
from substructures.expr.replay import replay
from substructures.printers import render


def single(part: Plain, gravity: list[float]) -> Model:
    return tree_model({"gravity": gravity, "instances": [{"name": "s", "substructure": "p"}]}, {"p": part})


def sleigh(gravity: tuple[float, ...] = (0, 0, 0)) -> Model:
    """A body in the plane with its blade at the origin of its frame and the mass centre at a on the blade's line."""
    joint = {"type": "planar", "coordinate": ["x", "y", "f"]}
    body = {
        "name": "b",
        "parent": "base",
        "joint": joint,
        "mass": "m",
        "com": ["a", 0, 0],
        "inertia": {"xx": "I", "zz": "I"},
    }
    parameters = {"m": {"value": 2}, "I": {"value": 0.3}, "a": {"value": 0.25}}
    return single({"name": "sleigh", "parameters": parameters, "bodies": [body]}, list(gravity))


BLADE: Plain = {"name": "blade", "type": "knife_edge", "frame": "s.b"}
FORWARD = {"u": "cos(s.f)*s.x' + sin(s.f)*s.y'", "w": "s.f'"}


def exact(equations: QuasiVelocities, expected: Plain) -> None:
    """Outputs of a vector or matrix against formulas as text; elements not named are zero."""
    graph = Graph()
    for name, formulas in expected.items():
        found = replay(equations.program, graph, {}, [name])[name].entries
        for index in found.keys() | formulas.keys():
            text = formulas.get(index, "0")
            assert is_zero(graph.zero + found.get(index, 0) - parse(graph, text, graph.symbol)), (name, index)


def test_chaplygin_sleigh() -> None:
    """m u' = m a w^2, (I + m a^2) w' = -m a u w (S. A. Chaplygin 1911; Neimark and Fufaev 1972; A. M. Bloch,
    Nonholonomic Mechanics and Control, 2003, section 1.7), as formulas and in both forms.
    """
    equations = quasi_velocity_equations(sleigh(), {"constraints": [BLADE], "velocities": FORWARD})
    bias = {(0,): "-s.m*s.a*w^2", (1,): "s.m*s.a*u*w"}
    metric = {(0, 0): "s.m", (1, 1): "s.I + s.m*s.a^2"}
    structure = {(2, 0, 1): "-1", (2, 1, 0): "1"}
    exact(equations, {"metric": metric, "bias": bias, "hamel_bias": bias, "structure": structure})
    # the blade carries m a_n: centre of mass accelerates across the blade by u w + a w'
    multiplier = {(0,): "s.m*(u*w + s.a*w') - cos(s.f)*tau.s.y + sin(s.f)*tau.s.x"}
    exact(equations, {"multipliers": multiplier})


def test_formulas_print_in_every_format() -> None:
    equations = quasi_velocity_equations(sleigh(), {"constraints": [BLADE], "velocities": FORWARD})
    for language in ("text", "latex", "python", "c", "matlab", "julia", "sympy"):
        assert len(render(equations.program, language)) > 500


@pytest.mark.parametrize("form", FORMS)
def test_skate_on_an_inclined_plane(form: str) -> None:
    """Released at rest with a spin w it does not slide down but goes along a cycloid: x = g sin(i) / (2 w^2) sin^2 wt
    down the slope, y = g sin(i) / (4 w^2) (2 wt - sin 2wt) across (Neimark and Fufaev 1972; Bloch 2003, section 1.6).
    """
    slope, w = 9.81 * 0.28, 1.7
    model = sleigh((slope, 0, -9.81 * 0.96))
    request = {"constraints": [BLADE], "velocities": FORWARD, "parameters": {"s.a": 0}, "q": [0, 0, 0], "v": {"w": w}}
    motion = simulate_rolling(model, request | {"span": [0, 5], "form": form})
    assert motion.status == "finished"
    assert motion.is_right, motion.checks
    wt = w * motion.t
    np.testing.assert_allclose(motion.q[:, 0], slope / (2 * w**2) * np.sin(wt) ** 2, atol=1e-9)
    np.testing.assert_allclose(motion.q[:, 1], slope / (4 * w**2) * (2 * wt - np.sin(2 * wt)), atol=1e-9)


R, M, A, C = 0.5, 2.0, 0.125, 0.25
FLOOR: Plain = {"name": "floor", "type": "rolling", "frame": "s.disc", "radius": "s.r"}


def disc() -> Model:
    """Centre (x, y, z), precession psi, nutation th (of the axis from the vertical), spin ph; thin and homogeneous."""
    bodies: list[Plain] = []
    axes = {"x": [1, 0, 0], "y": [0, 1, 0], "z": [0, 0, 1], "psi": [0, 0, 1], "th": [1, 0, 0], "ph": [0, 0, 1]}
    for k, (name, axis) in enumerate(axes.items()):
        kind = "prismatic" if k < 3 else "revolute"
        joint = {"type": kind, "coordinate": name, "placement": {"position": [0, 0, 0]}, "axis": axis}
        bodies.append({"name": "disc" if k == 5 else f"b{k}", "parent": f"b{k - 1}" if k else "base", "joint": joint})
    bodies[-1] |= {"mass": "m", "inertia": {"xx": "m*r^2/4", "yy": "m*r^2/4", "zz": "m*r^2/2"}}
    parameters = {"m": {"value": M}, "r": {"value": R}}
    return single({"name": "disc", "parameters": parameters, "bodies": bodies}, [0, 0, -9.81])


def test_rolling_disc() -> None:
    """Euler's equations about the line of nodes, with w3 = ph' + psi' cos th (O. M. O'Reilly, Nonlinear Dynamics 10,
    1996; Neimark and Fufaev 1972):

        (A + m r^2) th'' + (C + m r^2) w3 psi' sin th - A psi'^2 sin th cos th + m g r cos th = 0
        A (psi'' sin th + 2 psi' th' cos th) - C w3 th' = 0        (C + m r^2) w3' = m r^2 psi' th' sin th
    """
    equations = quasi_velocity_equations(disc(), {"constraints": [FLOOR]})
    assert equations.velocities == ("s.psi'", "s.th'", "s.ph'")
    assert not equations.dependent
    rng = np.random.default_rng(2)
    angles, v = rng.uniform(0.4, 1.4, (3, 20)), rng.uniform(-3, 3, (3, 20))
    values: Plain = {"s.m": M, "s.r": R} | {s.name: 0.0 for s in equations.program.symbols if s.kind == "input"}
    values |= dict(zip(["s.psi", "s.th", "s.ph", *equations.velocities], [*angles, *v], strict=True))
    for bias in ("bias", "hamel_bias"):
        out = interpret(equations.program, values, ["metric", bias, "forces"])
        accelerations = np.linalg.solve(out["metric"], (out["forces"] - out[bias])[..., None])[..., 0]
        (dpsi, dth, dph), (ddpsi, ddth, ddph) = v, accelerations.T
        sin, cos = np.sin(angles[1]), np.cos(angles[1])
        w3, dw3 = dph + dpsi * cos, ddph + ddpsi * cos - dpsi * dth * sin
        mr2 = M * R**2
        first = (A + mr2) * ddth + (C + mr2) * w3 * dpsi * sin - A * dpsi**2 * sin * cos + M * 9.81 * R * cos
        second = A * (ddpsi * sin + 2 * dpsi * dth * cos) - C * w3 * dth
        third = (C + mr2) * dw3 - mr2 * dpsi * dth * sin
        for residual in (first, second, third):
            np.testing.assert_allclose(residual, 0, atol=1e-11)


def test_rolling_disc_in_steady_motion_and_beyond() -> None:
    """th, psi', ph' stay where the first equation holds with th'' = 0; any motion keeps energy and contact."""
    th, dpsi = 1.2, 1.5
    mr2 = M * R**2
    w3 = (A * dpsi**2 * np.sin(th) * np.cos(th) - M * 9.81 * R * np.cos(th)) / ((C + mr2) * dpsi * np.sin(th))
    request: Plain = {"constraints": [FLOOR], "q": [0, 0, R * np.sin(th), 0.2, th, 0], "span": [0, 3]}
    steady = simulate_rolling(disc(), request | {"v": [dpsi, 0, w3 - dpsi * np.cos(th)]})
    assert steady.is_right
    np.testing.assert_allclose(steady.q[:, 4], th, atol=1e-9)
    # the centre goes along a circle of radius r |w3 / psi'|
    period = 2 * np.pi / dpsi
    whole = steady.q[steady.t <= period][:, :2]
    np.testing.assert_allclose(np.ptp(whole[:, 0]) / 2, R * abs(w3 / dpsi), rtol=5e-3)
    wild = simulate_rolling(disc(), request | {"v": {"s.psi'": 1.0, "s.th'": 0.5, "s.ph'": 6.0}})
    assert (wild.status, [c.holds for c in wild.checks]) == ("finished", [True, True, True])
    assert np.ptp(wild.q[:, 4]) > 0.1
    again = simulate_rolling(disc(), request | {"qd": wild.qd[0], "form": "boltzmann-hamel"})
    np.testing.assert_allclose(again.q[-1], wild.q[-1], atol=1e-8)


def test_cart_on_two_wheels() -> None:
    """x' cos f + y' sin f = r (left + right) / 2 and f' = r (right - left) / (2 b), b half the track; the wheels hold
    the cart across twice, and one of these rows is left out.
    """
    planar = {"type": "planar", "coordinate": ["x", "y", "f"]}
    bodies: list[Plain] = [
        {"name": "cart", "parent": "base", "joint": planar, "mass": 5, "inertia": {"xx": 1, "zz": 1}}
    ]
    ports = []
    for side, y in (("left", "b"), ("right", "-b")):
        seat = {"position": [0, y, "r"], "rpy": [0, 0, 0]}
        joint = {"type": "revolute", "coordinate": side, "placement": seat, "axis": [0, 1, 0]}
        bodies.append({"name": side, "parent": "cart", "joint": joint, "mass": 1, "inertia": {"yy": 0.02, "zz": 0.02}})
        ports.append({"name": f"{side}_axle", "body": side, "rotation": {"rpy": ["-pi/2", 0, 0]}})
    parameters = {"b": {"value": 0.3}, "r": {"value": 0.1}}
    model = single({"name": "cart", "parameters": parameters, "bodies": bodies, "ports": ports}, [0, 0, -9.81])
    wheels = [
        {"name": side, "type": "rolling", "frame": f"s.{side}_axle", "radius": "s.r"} for side in ("left", "right")
    ]
    document: Plain = {"constraints": wheels, "independent": ["s.left", "s.right"]}
    equations = quasi_velocity_equations(model, document)
    assert (len(equations.constraints), len(equations.dependent)) == (3, 1)
    along = {(0, 0): "s.r/2*cos(s.f)", (0, 1): "s.r/2*cos(s.f)", (1, 0): "s.r/2*sin(s.f)", (1, 1): "s.r/2*sin(s.f)"}
    turning = {(2, 0): "-s.r/(2*s.b)", (2, 1): "s.r/(2*s.b)", (3, 0): "1", (4, 1): "1"}
    exact(equations, {"T": along | turning})


def test_sphere_on_an_inclined_plane() -> None:
    """It accelerates by 5/7 g sin(i)."""
    joint = {"type": "free", "coordinate": ["x", "y", "z", "a", "b", "c"]}
    inertia = dict.fromkeys(("xx", "yy", "zz"), "2/5*m*r^2")
    body = {"name": "ball", "parent": "base", "joint": joint, "mass": "m", "inertia": inertia}
    parameters = {"m": {"value": 3}, "r": {"value": 0.2}}
    model = single({"name": "ball", "parameters": parameters, "bodies": [body]}, [0, 0, -9.81])
    tilt = 0.35
    normal = [round(float(np.sin(tilt)), 12), 0, round(float(np.cos(tilt)), 12)]
    floor = {
        "name": "slope",
        "type": "rolling",
        "frame": "s.ball",
        "radius": "s.r",
        "shape": "sphere",
        "normal": normal,
    }
    motion = simulate_rolling(model, {"constraints": [floor], "q": [0, 0, 0, 0, 0, 0], "span": [0, 0.5], "count": 11})
    assert motion.is_right
    down = motion.q[:, 0] * np.cos(tilt) - motion.q[:, 2] * np.sin(tilt)
    np.testing.assert_allclose(down, 5 / 14 * 9.81 * np.sin(tilt) * motion.t**2, atol=1e-10)


def random_constraints(rng: np.random.Generator, model: Model, count: int) -> list[Plain]:
    """Coefficients are cosines and sines of coordinates, and numbers."""
    result = []
    for k in range(count):
        terms = []
        for name in model.coordinates:
            other = model.coordinates[rng.integers(model.dof)]
            shapes = ["1", f"cos({other})", f"(2 + sin({other}))", f"({other}/3 - 1)"]
            terms.append(f"{rng.uniform(0.5, 2):.2f}*{shapes[rng.integers(4)]}*{name}'")
        result.append({"name": f"c{k}", "type": "linear", "expression": " + ".join(terms)})
    return result


@pytest.mark.parametrize("seed", range(4))
def test_both_forms_equal_the_equations_with_multipliers(seed: int) -> None:
    """On random trees with random constraints: q'' and lambda of [g -B^T; B 0] with B' from differences."""
    rng = np.random.default_rng(seed)
    kind = Kind(4, joints=("revolute", "prismatic"), massive=True, depth=4, loads=1)
    model = model_of(random_definition(rng, kind))
    document = {"constraints": random_constraints(rng, model, 1 + seed % 2)}
    equations = quasi_velocity_equations(model, document)
    n, p = model.dof, len(equations.velocities)
    q, v = rng.uniform(-0.8, 0.8, n), rng.uniform(-1, 1, p)
    inputs = {s.name: 0.4 for s in model.program.symbols if s.kind == "input"}
    values: Plain = inputs | dict(zip(model.coordinates, q, strict=True)) | {"t": 0.2}
    values |= dict(zip(equations.velocities, v, strict=True))
    out = interpret(equations.program, values | {f"{x}'": 0.0 for x in equations.velocities})
    np.testing.assert_allclose(out["hamel_bias"], out["bias"], rtol=0, atol=1e-11 * np.abs(out["bias"]).max())
    dv = np.linalg.solve(out["metric"], out["forces"] - out["bias"])
    qd, h = out["rates"], 1e-4

    def at(name: str, shift: float) -> np.ndarray:
        moved = values | dict(zip(model.coordinates, q + shift * qd, strict=True))
        return interpret(equations.program, moved, [name])[name]

    def slope(name: str) -> np.ndarray:
        return (8 * (at(name, h) - at(name, -h)) - at(name, 2 * h) + at(name, -2 * h)) / (12 * h)

    B = out["constraints"]
    given = {"q": q, "qd": qd, "inputs": inputs, "t": 0.2}
    x = evaluate(model, {"quantities": ["metric", "bias", "forces"], **given})
    kkt = np.block([[x["metric"], -B.T], [B, np.zeros((n - p, n - p))]])
    solution = np.linalg.solve(kkt, np.concatenate((x["forces"] - x["bias"], -slope("constraints") @ qd)))
    scale = np.abs(solution).max()
    np.testing.assert_allclose(out["T"] @ dv + slope("T") @ v, solution[:n], rtol=0, atol=1e-9 * scale)
    found = interpret(equations.program, values | {f"{a}'": b for a, b in zip(equations.velocities, dv, strict=True)})
    np.testing.assert_allclose(found["multipliers"], solution[n:], rtol=0, atol=1e-9 * scale)
    np.testing.assert_allclose(B @ out["T"], 0, atol=1e-12)


def test_other_quasi_velocities_describe_the_same_motion() -> None:
    request: Plain = {"constraints": [BLADE], "q": [0, 0, 0.4], "span": [0, 0.8], "inputs": {"tau.s.f": "sin(t)"}}
    one = simulate_rolling(sleigh(), request | {"velocities": FORWARD, "v": {"u": 1.0, "w": 0.5}})
    two = simulate_rolling(sleigh(), request | {"independent": ["s.x", "s.f"], "qd": one.qd[0]})
    assert one.is_right
    assert two.is_right
    np.testing.assert_allclose(two.q, one.q, atol=1e-8)
    assert np.abs(one.series["work"]).max() > 0.01


def test_rolling_motions_have_events_series_and_inputs_of_all_kinds() -> None:
    """A sleigh that is damped along by an input of its velocities, pushed by a table, and stopped by an event."""
    push = {"times": [0, 0.5, 9], "values": [1, 0, 0], "interpolation": "hold"}
    request: Plain = {"constraints": [BLADE], "velocities": FORWARD, "q": [0, 0, 0], "v": {"u": 0.1}, "span": [0, 9]}
    request |= {"inputs": {"tau.s.x": "-s.x'/2", "tau.s.f": push}, "series": {"speed": "sqrt(s.x'^2 + s.y'^2)"}}
    event = {"name": "turned", "quantity": "s.f", "level": 0.4}
    motion = simulate(sleigh(), request | {"events": [event]})
    assert (motion.status, [e.name for e in motion.events]) == ("stopped", ["turned"])
    assert motion.is_right, motion.checks
    np.testing.assert_allclose(motion.q[-1, 2], 0.4, atol=1e-10)
    np.testing.assert_allclose(motion.series["tau.s.x"], -motion.qd[:, 0] / 2)
    np.testing.assert_allclose(motion.series["speed"], np.hypot(motion.qd[:, 0], motion.qd[:, 1]))


def test_closed_loops_in_independent_velocities() -> None:
    """A slider-crank as one equation for the crank: g* is the inertia that the crank feels, J(a) of the textbooks."""
    model = slider_crank()
    document: Plain = {"constraints": [{"name": "wrist", "type": "closure"}], "independent": ["x.crank"]}
    equations = quasi_velocity_equations(model, document)
    assert equations.constraints == ("wrist.x", "wrist.y")
    request = {"q": at(model, crank=0.5, piston=0.17), "qd": at(model, crank=30), "fixed": ["x.crank"]}
    state = analyse_loops(model, request)
    q, qd = state.consistent.q, state.consistent.qd
    values = {name: float(p["value"]) for name, p in model.parameters.items()}
    values |= {s.name: 0.0 for s in equations.program.symbols if s.kind == "input"}
    values |= dict(zip(model.coordinates, q, strict=True)) | {"x.crank'": 30.0, "x.crank''": state.qdd[0]}
    for bias in ("bias", "hamel_bias"):
        out = interpret(equations.program, values, ["metric", bias, "forces", "rates", "multipliers"])
        np.testing.assert_allclose(out["rates"], qd, rtol=1e-12)
        np.testing.assert_allclose(out["forces"][0] - out[bias][0], out["metric"][0, 0] * state.qdd[0], rtol=1e-9)
        np.testing.assert_allclose(out["multipliers"], state.multipliers[:2], rtol=1e-9)
    motion = simulate_rolling(model, document | {"q": q, "v": [30], "span": [0, 0.2], "count": 5})
    closed = simulate_closed(model, {"q": q, "qd": qd, "span": [0, 0.2], "count": 5})
    assert motion.is_right, motion.checks
    np.testing.assert_allclose(motion.q, closed.q, atol=1e-8)


def test_rows_that_follow_from_others_are_left_out() -> None:
    twice = [BLADE, BLADE | {"name": "again"}]
    equations = quasi_velocity_equations(sleigh(), {"constraints": twice})
    assert (equations.constraints, equations.dependent) == (("blade",), ("again",))


def test_a_span_that_cannot_be_finished_fails_with_advice() -> None:
    request = {"constraints": [BLADE], "velocities": FORWARD, "q": [0, 0, 0.4], "v": [0.5, 1.0], "span": [0, 100]}
    motion = simulate_rolling(sleigh(), request | {"max_steps": 10})
    assert (motion.status, motion.steps) == ("failed", 10)
    assert "max_steps" in motion.message
    assert 0 < motion.t[-1] < 100
    assert simulate_rolling(sleigh(), request, lambda share: share < 0.1).status == "stopped"


def test_nothing_that_has_mass() -> None:
    request = {"constraints": [BLADE], "velocities": FORWARD, "q": [0, 0, 0.4], "v": [0.5, 1.0], "span": [0, 1]}
    motion = simulate_rolling(sleigh(), request | {"parameters": {"s.m": 0, "s.I": 0}})
    assert (motion.status, len(motion.t)) == ("failed", 1)
    assert "check masses" in motion.message


def test_a_disc_that_falls_flat() -> None:
    """Its contact is not determined any more; that is said, or the checks say that the numbers are wrong."""
    request = {"constraints": [FLOOR], "q": [0, 0, R * np.sin(1.0), 0, 1.0, 0], "v": [0, 0, 0], "span": [0, 2]}
    motion = simulate_rolling(disc(), request | {"max_steps": 5000})
    assert motion.status == "failed" or not motion.is_right


BAD: list[tuple[Plain, str, str]] = [
    ({"constraints": [{"name": "c", "type": "skid"}]}, "/constraints/0/type", "union-tag-invalid"),
    ({"constraints": [BLADE, BLADE]}, "/constraints/1/name", "duplicate-name"),
    ({"constraints": [BLADE | {"frame": "s.c"}]}, "/constraints/0/frame", "unknown-frame"),
    (
        {"constraints": [{"name": "c", "type": "linear", "expression": "s.x'*s.y'"}]},
        "/constraints/0/expression",
        "not-linear",
    ),
    (
        {"constraints": [{"name": "c", "type": "linear", "expression": "s.x' - 1"}]},
        "/constraints/0/expression",
        "not-linear",
    ),
    (
        {"constraints": [{"name": "c", "type": "linear", "expression": "s.q'"}]},
        "/constraints/0/expression",
        "unknown-name",
    ),
    ({"constraints": [{"name": "c", "type": "closure"}]}, "/constraints/0/name", "unknown-closure"),
    ({"velocities": {"u": "s.x'"}}, "/velocities", "wrong-length"),
    ({"velocities": {"u": "s.x'", "w": "s.x'"}}, "/velocities", "dependent"),
    ({"independent": ["s.x", "s.z"]}, "/independent/1", "unknown-coordinate"),
    ({"v": [1]}, "/v", "wrong-length"),
    ({"v": {"u": 1}}, "/v", "unknown-velocity"),
    ({"qd": [1, 1, 0]}, "/qd", "violated"),
    ({"independent": ["s.x", "s.f"], "q": [0, 0, "pi/2"]}, "/q/2", "number-expected"),
    ({"independent": ["s.y", "s.f"], "qd": [0, 0, 1]}, "/q", "singular-start"),
    ({"form": "lagrange"}, "/form", "literal-error"),
    (
        {"constraints": [{"name": "c", "type": "rolling", "frame": "s.b", "radius": 1}]},
        "/constraints/0/frame",
        "flat-disc",
    ),
]


@pytest.mark.parametrize(("change", "pointer", "code"), BAD)
def test_bad_requests(change: Plain, pointer: str, code: str) -> None:
    with pytest.raises(InvalidDocument) as caught:
        simulate_rolling(SLEIGH, {"constraints": [BLADE], "q": [0, 0, 0], "span": [0, 1]} | change)
    assert [(f.pointer, f.code) for f in caught.value.faults] == [(pointer, code)]


SLEIGH = sleigh()
