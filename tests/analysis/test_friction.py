"""Dry friction of joints: the smooth law, and motions that stick exactly, against solutions in closed form."""

# ruff: noqa: N806 -- symbols of the notation

from __future__ import annotations

from dataclasses import replace
from decimal import Decimal
from itertools import product
from typing import Any

import numpy as np
import pytest
from in_depth import seeds
from random_trees import Plain, model_of
from simulated import simulated

from substructures import InvalidArgument, InvalidDocument, InvalidInput, Model
from substructures.analysis.motion.conditions import read_conditions
from substructures.analysis.motion.friction.dry_friction import DryMotion, friction_laws
from substructures.analysis.motion.integrators.tableaux import TABLEAUX
from substructures.analysis.motion.problems.start import Start
from substructures.analysis.motion.right_hand_side import RightHandSide
from substructures.analysis.simulate import Event, FixedStep, Table
from substructures.compile import target
from substructures.compile.motion import CompiledRun
from substructures.quantities.numbers.evaluation import evaluate

G = 9.81


def exactly(x: float) -> Decimal:
    return Decimal(repr(float(x)))


def block(friction: Plain, gravity: float = 0, mass: float = 2, loads: Any = (), **parameters: Any) -> Model:
    """A mass on a slide, pulled along it by ``gravity``."""
    joint = {"type": "prismatic", "coordinate": "x", "friction": {"velocity": exactly(1e-3)} | friction}
    body: Plain = {"name": "b", "parent": "base", "mass": mass, "joint": joint}
    given = {name: {"value": exactly(x)} for name, x in parameters.items()}
    return model_of(
        {"name": "a", "bodies": [body], "loads": list(loads), "parameters": given}, (0, 0, exactly(gravity))
    )


def test_the_smooth_law() -> None:
    """-(F_c + (F_s - F_c) exp(-(v/v_s)^2)) tanh(v/v_0), also far beyond v_0, and without Stribeck's part."""
    v = np.array([0.0, 4e-4, -0.05, 0.3, -20, 1e6])
    law = {"coulomb": "2*mu", "static": 3, "stribeck": exactly(0.1)}
    found = evaluate(block(law, mu=0.5), "forces", np.zeros((6, 1)), v[:, None])["forces"][:, 0]
    np.testing.assert_allclose(found, -(1 + 2 * np.exp(-((v / 0.1) ** 2))) * np.tanh(v / 1e-3), rtol=1e-13, atol=1e-15)
    found = evaluate(block({"coulomb": 2, "static": 3}), "forces", np.zeros((6, 1)), v[:, None])["forces"][:, 0]
    np.testing.assert_allclose(found, -2 * np.tanh(v / 1e-3), rtol=1e-13, atol=1e-15)


@pytest.mark.parametrize("way", [1, -1])
def test_a_block_on_an_incline(way: int) -> None:
    """It stops after v / a at v^2 / (2 a), a = g (mu cos + sin) upwards, (mu cos - sin) downwards, and stays there."""
    mu, angle, v, m = 0.6, 0.3, 1.7, 2.0
    normal, along = m * G * float(np.cos(angle)), -G * float(np.sin(angle))
    model = block({"coulomb": exactly(mu * normal)}, along)
    motion = simulated(
        model,
        [0.2],
        (0, 3),
        qd=[way * v],
        count=31,
        friction="exact",
        events=[Event("v", "x.x'", 1e-2, action="record")],
    )
    assert motion.is_right, motion.checks
    assert {"friction", "energy-balance", "energy", "steps"} == {check.name for check in motion.checks}
    a = mu * normal / m - way * along
    T = v / a
    rest = motion.t > T
    assert rest.any()
    np.testing.assert_allclose(motion.q[rest, 0], 0.2 + way * v**2 / (2 * a), rtol=0, atol=1e-12)
    assert not motion.qd[rest].any()
    moving = motion.t < T
    np.testing.assert_allclose(
        motion.q[moving, 0], 0.2 + way * (v - a * motion.t[moving] / 2) * motion.t[moving], atol=1e-12
    )
    # while it moves all of the friction, at rest what holds it against gravity, whatever the direction before
    np.testing.assert_allclose(motion.series["friction"][moving, 0], -way * mu * normal, rtol=1e-14)
    np.testing.assert_allclose(motion.series["friction"][rest, 0], -m * along, rtol=1e-14)
    if way > 0:
        # the last event: v = 0.01 at T - 0.01 / a
        (slow,) = (event.t for event in motion.events if not event.kind)
        np.testing.assert_allclose(slow, T - 1e-2 / a, atol=1e-12)


def test_a_block_that_is_too_steep_slides_on() -> None:
    """Up to rest, then down with less acceleration: mu < tan of the angle."""
    mu, angle, v, m = 0.2, 0.5, 1.0, 2.0
    normal, along = m * G * float(np.cos(angle)), -G * float(np.sin(angle))
    motion = simulated(
        block({"coulomb": exactly(mu * normal)}, along), [0.0], (0, 1), qd=[v], count=11, friction="exact"
    )
    up, down = mu * normal / m - along, -mu * normal / m - along
    T, top = v / up, v**2 / (2 * up)
    late = motion.t > T
    np.testing.assert_allclose(motion.q[late, 0], top - down * (motion.t[late] - T) ** 2 / 2, atol=1e-12)
    assert motion.is_right


def test_a_stick_slip_oscillator() -> None:
    """A block pulled over a spring k at constant speed V (E. Rabinowicz 1958; B. N. J. Persson, Sliding Friction, 2000)
    sticks for 2 (F_s - F_c) / (k V), slips for 2 (pi - atan(D)) / w with D = (F_s - F_c) w / (k V).
    """
    m, k, V, F_s, F_c = 2.0, 50.0, 0.1, 3.0, 2.0
    pull = {"type": "joint", "coordinate": "x", "force": "k*(V*t - x)"}
    model = block({"coulomb": 2, "static": 3}, mass=2, loads=[pull], k=k, V=V)
    ways = [Event("moves", "x.x'", 1e-6, "rising", "record"), Event("stops", "x.x'", 1e-6, "falling", "record")]
    motion = simulated(model, [0.0], (0, 6), count=3001, friction="exact", events=ways)
    assert motion.is_right, motion.checks
    w = np.sqrt(k / m)
    D = (F_s - F_c) * w / (k * V)
    stick, slip = 2 * (F_s - F_c) / (k * V), 2 * (np.pi - np.arctan(D)) / w
    starts = [e.t for e in motion.events if e.name == "moves"]
    ends = [e.t for e in motion.events if e.name == "stops"]
    assert len(ends) == 4
    # the first time it takes F_s / (k V); near rest v changes by 1e-6 in some 1e-6 s
    np.testing.assert_allclose(starts[0], F_s / (k * V), atol=5e-6)
    np.testing.assert_allclose(np.diff(starts[:4]), stick + slip, atol=1e-8)
    np.testing.assert_allclose(np.subtract(ends[:4], starts[:4]), slip, atol=5e-6)
    # breaking away and sticking are events by themselves
    told = [(e.kind, e.t) for e in motion.events if e.kind]
    assert [kind for kind, _ in told] == [*["slip", "stick"] * 4, "slip"]
    np.testing.assert_allclose(told[0][1], F_s / (k * V), atol=1e-9)
    np.testing.assert_allclose(np.diff([t for _, t in told])[:2], [slip, stick], atol=1e-8)
    # v = V (1 - cos wt) + V D sin wt, at most V (1 + sqrt(1 + D^2)); friction is between F_c and F_s
    tau = motion.t - F_s / (k * V)
    first = (tau > 0) & (tau < slip)
    np.testing.assert_allclose(
        motion.qd[first, 0], V * (1 - np.cos(w * tau[first]) + D * np.sin(w * tau[first])), atol=1e-9
    )
    sticks = motion.qd[:, 0] == 0
    assert 0.1 < sticks.mean() < 0.9
    np.testing.assert_allclose(motion.series["friction"][~sticks, 0], -F_c, rtol=1e-13)
    np.testing.assert_allclose(
        motion.series["friction"][sticks, 0], -(k * (V * motion.t - motion.q[:, 0]))[sticks], atol=1e-9
    )


def test_the_smooth_law_creeps_where_the_exact_one_sticks() -> None:
    """The smooth one is near it as long as it moves, and then creeps with v_0 atanh(load/F_c)."""
    model, given = block({"coulomb": 4}, -1.0), {"q": [0.0], "span": (0, 1), "qd": [1.0], "count": 11}
    exact, smooth = simulated(model, **given, friction="exact"), simulated(model, **given)
    assert smooth.is_right
    np.testing.assert_allclose(smooth.q, exact.q, atol=2e-3)
    np.testing.assert_allclose(smooth.qd[-1], -1e-3 * np.arctanh(2 / 4), rtol=1e-6)
    assert exact.qd[-1] == 0


def chain(count: int, limits: Any) -> Model:
    """Slides one on the other, each with friction."""
    bodies: list[Plain] = []
    for i in range(count):
        friction = {"coulomb": exactly(0.8 * limits[i]), "static": exactly(limits[i]), "velocity": exactly(1e-3)}
        turned = {"psi": exactly(0.4 * i), "theta": exactly(0.5 + 0.3 * i)}
        joint = {"type": "prismatic", "coordinate": f"q{i}", "friction": friction, "d": exactly(0.1)} | turned
        bodies.append({"name": f"b{i}", "parent": bodies[-1]["name"] if i else "base", "mass": 1 + i, "joint": joint})
    return model_of({"name": "a", "bodies": bodies}, (3, -2, 4))


@pytest.mark.parametrize("seed", seeds(3, 6))
def test_who_sticks_when_several_are_at_rest(seed: int) -> None:
    """All ways to slip and stick are tried by hand: what is found meets |f| <= F_s of what sticks, and what slips goes
    the way it slips.
    """
    rng = np.random.default_rng(seed)
    limits = rng.uniform(1, 12, 3).round(2)
    model = chain(3, limits)
    tau = {f"tau.{name}": float(x) for name, x in zip(model.coordinates, rng.uniform(-15, 15, 3), strict=True)}
    conditions = read_conditions(model, Start([0, 0, 0], inputs=tau), (0, 1), ["metric", "bias", "forces"])
    laws = friction_laws(model, conditions.values)
    dry = DryMotion(RightHandSide(model, conditions.values, conditions.zero, conditions), conditions, laws)
    signs, _ = dry.decided(0.0, np.zeros(7))
    found = evaluate(model, ["metric", "forces"], [0, 0, 0], inputs=tau)
    g, Q = found["metric"], found["forces"]
    met = []
    for ways in product((-1, 0, 1), repeat=3):
        stuck = [i for i in range(3) if not ways[i]]
        # g a = Q + f, a = 0 where it sticks, f = -s F_c where it slips
        unknown = np.zeros((6, 6))
        unknown[:3, :3], unknown[:3, 3:] = g, -np.eye(3)
        right = np.concatenate([Q, [0 if i in stuck else -ways[i] * 0.8 * limits[i] for i in range(3)]])
        for i in range(3):
            unknown[3 + i, i if i in stuck else 3 + i] = 1
        a, f = np.split(np.linalg.solve(unknown, right), 2)
        if all(abs(f[i]) <= limits[i] if i in stuck else a[i] * ways[i] > 0 for i in range(3)):
            met.append(ways)
    assert tuple(int(s) for s in signs) in met
    motion = simulated(model, [0, 0, 0], (0, 0.05), inputs=tau, count=3, friction="exact")
    assert motion.is_right, motion.checks
    assert np.array_equal(np.sign(motion.qd[-1]), signs)


@pytest.mark.skipif(not target.available(), reason="machine code cannot be made, or is not wanted")
def test_steps_are_machine_code_whoever_sticks(monkeypatch: pytest.MonkeyPatch) -> None:
    """Accelerations and powers as by hand, what sticks without any; and a motion as in Python."""
    model, rng = chain(3, [30.0, 25.0, 16.0]), np.random.default_rng(1)
    table = Table([0, 0.2, 0.5, 0.8, 1], [0, 30, -39, 48, 0], "cubic")
    start = Start([0, 0, 0], inputs={f"tau.{model.coordinates[1]}": table})
    conditions = read_conditions(model, start, (0, 1), ["metric", "bias", "forces"])
    laws = replace(friction_laws(model, conditions.values), stribeck=np.array([0.1, 0.0, 0.3]))
    dry = DryMotion(RightHandSide(model, conditions.values, conditions.zero, conditions), conditions, laws)
    for ways in product((-1, 0, 1), repeat=3):
        dry.signs = np.array(ways)
        x = np.concatenate([rng.uniform(-1, 1, 3), rng.uniform(0, 0.5, 3) * dry.signs, [0.0]])
        rates = dry.compiled()
        assert rates is not None
        run = CompiledRun(TABLEAUX["RK23"], rates, (1.0, 1.0))
        run.begin(0.4, x, 0.4, 1.0)
        run.advance(0)
        assert rates.power is not None
        ours, watts = rates.written[0].copy(), rates.power.copy()
        second, _, power = dry.moved(0.4, x, dry.signs)
        np.testing.assert_allclose(ours, second, rtol=1e-12, atol=1e-12)
        assert not ours[dry.signs == 0].any()
        np.testing.assert_allclose(watts, power, rtol=1e-12, atol=1e-12)
    given = {"span": (0, 1), "inputs": start.inputs, "count": 41, "friction": "exact"}
    found = simulated(model, [0, 0, 0], **given)
    monkeypatch.setattr(DryMotion, "compiled", lambda _: None)
    plain = simulated(model, [0, 0, 0], **given)
    assert found.is_right
    assert [(e.name, e.kind) for e in found.events] == [(e.name, e.kind) for e in plain.events]
    assert len(found.events) > 5
    np.testing.assert_allclose([e.t for e in found.events], [e.t for e in plain.events], rtol=0, atol=1e-8)
    np.testing.assert_allclose(found.qd, plain.qd, rtol=0, atol=1e-8)


def test_two_blocks_and_a_spring_come_to_rest() -> None:
    """The energy of the start is work of friction; the end is at rest, and stays so."""
    friction = {"coulomb": 4, "static": 5, "stribeck": exactly(0.05), "velocity": exactly(1e-3)}
    joints = [{"type": "prismatic", "coordinate": f"x{i}", "friction": friction} for i in range(2)]
    bodies = [{"name": f"b{i}", "parent": "base", "mass": 1 + i, "joint": joints[i]} for i in range(2)]
    load = {"type": "potential", "potential": "20*(x1 - x0)^2"}
    model = model_of({"name": "a", "bodies": bodies, "loads": [load]}, (0, 0, 0))
    motion = simulated(model, [0.0, 0.7], (0, 5), qd=[0.5, 0], count=101, friction="exact")
    assert motion.is_right, motion.checks
    assert not motion.qd[-1].any()
    np.testing.assert_allclose(motion.q[-1], motion.q[-10], rtol=0, atol=1e-12)
    np.testing.assert_allclose(
        motion.series["friction"][-1], 40 * (motion.q[-1, 1] - motion.q[-1, 0]) * np.array([-1, 1])
    )
    lost = motion.series["energy"][0] - motion.series["energy"][-1]
    np.testing.assert_allclose(-motion.series["work"][-1], lost, rtol=1e-9)


@pytest.mark.parametrize(
    ("given", "pointer"),
    [
        ({"coulomb": -1}, "/friction/coulomb"),
        ({"velocity": 0}, "/friction/velocity"),
        ({"stribeck": 0}, "/friction/stribeck"),
        ({"coulomb": "1*x"}, "/friction/coulomb"),
        ({"coulomb": {"value": 2, "unit": "N m"}}, "/friction/coulomb"),
    ],
)
def test_laws_that_are_none(given: Plain, pointer: str) -> None:
    with pytest.raises(InvalidDocument) as error:
        block({"coulomb": 1} | given)
    assert any(fault.pointer.endswith(pointer) for fault in error.value.faults), error.value


def test_motions_that_cannot_stick_exactly() -> None:
    sliding = block({"coulomb": "F"}, F=1.0)
    frictionless = model_of(
        {
            "name": "a",
            "bodies": [{"name": "b", "parent": "base", "mass": 1, "joint": {"type": "prismatic", "coordinate": "x"}}],
        }
    )
    for model, more, pointer in (
        (frictionless, {}, "/friction"),
        (sliding, {"fixed_step": FixedStep(0.01)}, "/friction"),
        (sliding, {"parameters": {"x.F": -1.0}}, "/parameters"),
        (sliding, {"friction": "sticky"}, "/friction"),
    ):
        with pytest.raises(InvalidInput) as error:
            simulated(model, [0.0], (0, 1), **{"friction": "exact"} | more)
        assert error.value.faults[0].pointer.startswith(pointer), error.value
    with pytest.raises(InvalidArgument):
        friction_laws(frictionless, {})
