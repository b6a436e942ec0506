"""Small vibrations of closed loops: cuts elsewhere, simulated periods, steady motion, root loci; what is refused."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np
import pytest
import sympy
from closed_trees import bricard, closed_entry, four_bar, governor, slider_crank, tree_model
from random_trees import Plain

from substructures import InvalidInput, Model
from substructures.analysis.drawings import draw_root_locus
from substructures.analysis.equations.first_integrals import first_integrals
from substructures.analysis.equations.perturbation import perturbation
from substructures.analysis.simulate import ClosedMotion, Event, Outputs, simulate
from substructures.analysis.stability.equilibria import equilibria
from substructures.analysis.stability.linearise import linearise
from substructures.analysis.stability.linearise_closed import ClosedLinearisation
from substructures.analysis.stability.root_locus import root_locus
from substructures.expr.program import Program

G = 9.81
DOWN = (0, -G, 0)


def bar(mass: float, length: str) -> Plain:
    """A uniform rod that turns about one end."""
    body = {"name": "rod", "parent": "base", "joint": {"type": "revolute", "coordinate": "q"}, "mass": mass}
    body |= {"com": [f"{length}/2", 0, 0], "inertia": dict.fromkeys(("yy", "zz"), f"{mass}*({length})^2/12")}
    return {"name": "bar", "bodies": [body], "ports": [{"name": "end", "body": "rod", "position": [length, 0, 0]}]}


def ring(cut: int) -> Model:
    """Bars of lengths 0.5, 0.8, 0.6 between pins in the world 1.1 apart; the joint with this number is cut."""
    names, bars = ("a", "b", "c"), (bar(1, "0.5"), bar(2, "0.8"), bar(1.5, "0.6"))
    hosts = ["world", "a.end", "b.end"]
    instances: list[Plain] = [{"name": x, "substructure": x, "at": hosts[k]} for k, x in enumerate(names[:cut])]
    for k in range(2, cut - 1, -1):
        at: Plain = {"at": f"{names[k + 1]}.end"} if k < 2 else {"placement": {"position": [1.1, 0, 0]}}
        instances.append({"name": names[k], "substructure": names[k], **at})
    ends = [f"{names[k]}.end" for k in (cut - 1, cut) if 0 <= k < 3]
    pin: Plain = {"name": "pin", "type": "pin", "from": ends[0], "to": [*ends, "world"][1]}
    pin |= {"placement": {"position": [1.1, 0, 0]}} if cut == 3 else {}
    return tree_model(
        {"gravity": list(DOWN), "instances": instances, "closures": [pin]}, dict(zip(names, bars, strict=True))
    )


def frequencies(model: Model) -> list[tuple[str, float]]:
    found = equilibria(model, count=24).found
    modes = [(e.at.stability.verdict, e.at.modes[-1].frequency) for e in found if e.at.stability]
    return sorted(modes)


def test_any_joint_may_be_cut() -> None:
    """Four cuts of one ring: the same equilibria with the same eigenvalues."""
    expected = frequencies(ring(3))
    assert [verdict for verdict, _ in expected].count("stable") >= 1
    for cut in range(3):
        found = frequencies(ring(cut))
        assert [verdict for verdict, _ in found] == [verdict for verdict, _ in expected]
        np.testing.assert_allclose([w for _, w in found], [w for _, w in expected], rtol=1e-9)


@pytest.mark.parametrize("make", [lambda: four_bar(DOWN), bricard, lambda: slider_crank(DOWN)])
def test_the_period_of_small_swings(make: Callable[[], Model]) -> None:
    """A simulation that begins 1e-3 rad from the stable equilibrium crosses it once a period."""
    model = make()
    stable = [e.at for e in equilibria(model).found if e.at.stability and e.at.stability.verdict == "stable"]
    at = next(x for x in stable if isinstance(x, ClosedLinearisation) and len(x.independent) == 1)
    name, period = at.independent[0], 2 * np.pi / at.modes[0].frequency
    start = at.q + 1e-3 * at.tangent[:, 0]
    level = float(at.q[model.coordinates.index(name)])
    event = Event("up", name, level=level, direction="rising", action="record")
    motion = simulate(model, start, (0, 3.2 * period), kind=ClosedMotion(fixed=[name]), outputs=Outputs(events=[event]))
    assert motion.is_right, motion.message
    np.testing.assert_allclose(np.diff([e.t for e in motion.events]), period, rtol=1e-5)


def test_a_governor_that_runs_steadily() -> None:
    """About steady motion: w^2 = V_p''/m with the amended potential V_p = V + p^2/(2 I) of Routh."""
    model = governor()
    v = {name.partition(".")[2]: sympy.Float(float(p["value"]), 30) for name, p in model.parameters.items()}
    alpha, p = sympy.symbols("alpha p")
    lift = v["hv"] - v["a"] * sympy.cos(alpha) - sympy.sqrt(v["ll"] ** 2 - (v["a"] * sympy.sin(alpha)) ** 2)
    inertia = v["Is"] + v["Iv"] + 2 * v["mb"] * (v["r"] + v["l"] * sympy.sin(alpha)) ** 2
    mass = 2 * v["mb"] * v["l"] ** 2 + v["mv"] * sympy.diff(lift, alpha) ** 2
    potential = -2 * v["mb"] * G * v["l"] * sympy.cos(alpha) + v["mv"] * G * lift + v["k"] * lift**2 / 2
    at = {alpha: sympy.Float(0.6, 30)}
    square = (sympy.diff(potential, alpha) * 2 * inertia**2 / sympy.diff(inertia, alpha)).subs(at)
    exact = float((sympy.diff(potential + p**2 / (2 * inertia), alpha, 2) / mass).subs({**at, p: sympy.sqrt(square)}))
    spin = float(sympy.sqrt(square) / inertia.subs(at))
    state = {"x.turn": 0.2, "x.right": 0.6, "x.left": 0.6, "x.lift": float(lift.subs(at))}
    rates = dict.fromkeys(model.coordinates, 0.0) | {"x.turn": spin}
    found = linearise(model, state, qd=rates)
    assert np.abs(found.qdd).max() < 1e-10
    assert not found.is_equilibrium
    values = np.linalg.eigvals(found.A)
    assert np.abs(values).max() == pytest.approx(np.sqrt(exact), rel=1e-9)
    assert np.sort(np.abs(values))[:2] == pytest.approx([0, 0], abs=1e-6)


def damped(**more: Any) -> Model:
    """The hanging parallelogram with a damper in its first crank."""
    cranks: list[Plain] = [
        {"name": f"c{k}", "parent": "base", "joint": {"type": "revolute", "coordinate": f"c{k}", "d": k}, "mass": 1}
        for k in (0, 1)
    ]
    for crank in cranks:
        crank |= {"com": [1, 0, 0]}
    cranks[0]["joint"] |= {"damping": "c"}
    table = {"name": "table", "parent": "c0", "mass": 2, "com": [0.5, 0, 0]}
    table |= {"joint": {"type": "revolute", "coordinate": "table", "d": 1}}
    part = {"name": "p", "bodies": [*cranks, table], "parameters": {"c": {"value": 1}}, **more}
    part["ports"] = [
        {"name": "a", "body": "table", "position": [1, 0, 0]},
        {"name": "b", "body": "c1", "position": [1, 0, 0]},
    ]
    pin = {"name": "pin", "type": "pin", "from": "x.a", "to": "x.b"}
    return tree_model(
        {"gravity": list(DOWN), "instances": [{"name": "x", "substructure": "p"}], "closures": [pin]}, {"p": part}
    )


def test_root_locus_over_a_damper() -> None:
    """4 s^2 + c s + 4 g = 0: 2r = 2 branches on a circle, then on the axis."""
    c, down = np.linspace(0, 30, 31), np.pi / 2
    found = root_locus(damped(), parameter="x.c", values=c.tolist(), q=[-down, -down, down])
    assert found.status == "finished", found.message
    root = np.sqrt(c.astype(complex) ** 2 - 64 * G)
    exact = np.stack([(-c + root) / 8, (-c - root) / 8], axis=1)
    np.testing.assert_allclose(np.sort_complex(found.eigenvalues), np.sort_complex(exact), atol=1e-7)
    assert found.stability[0] == "stable"
    assert set(found.stability[1:]) == {"asymptotically stable"}
    # a crank that turns all round under a torque that no weight balances
    push: Plain = {"values": [1], "q": [0.7, 0.2, 1.2], "inputs": {"tau.x.crank": 1e4}}
    lost = root_locus(four_bar(DOWN), parameter="x.m1", **push)
    assert (lost.status, lost.eigenvalues.shape[0]) == ("failed", 0)


def test_free_and_held_directions() -> None:
    """Without gravity every position of a four-bar is an equilibrium along its motion; the spindle is held."""
    (found, *_) = equilibria(four_bar(), starts=[[0.7, 0.2, 1.2]], count=0).found
    at = found.at
    assert isinstance(at, ClosedLinearisation)
    assert found.free.shape == (1, 3)
    np.testing.assert_allclose(np.abs(np.cross(found.free[0], at.tangent[:, 0])), 0, atol=1e-12)
    assert equilibria(governor(), count=2).held == ("x.turn",)


def test_inputs_hold_a_closed_loop() -> None:
    """tau = (m0 + m1 + m2) g l cos(angle) of the parallelogram: half of it at 60 degrees."""
    found = equilibria(damped(), starts=[[1, 1, -1]], inputs={"tau.x.c0": 2 * G}, count=0).found
    near = min(found, key=lambda e: float(np.abs(e.q - 1).min()))
    np.testing.assert_allclose(near.q, np.pi / 3 * np.array([1, 1, -1]), atol=1e-10)


def test_a_torque_that_nothing_balances() -> None:
    """On a slider-crank without gravity; its rod is longer than the crank, so that no position holds it."""
    assert equilibria(slider_crank(), inputs={"tau.x.crank": 1}, count=3).found == ()


def test_formulas_of_the_perturbation() -> None:
    """They survive storage; multipliers are symbols."""
    source = perturbation(slider_crank(DOWN))
    assert Program.from_bytes(source.to_bytes()) == source
    assert {"lambda.wrist.x", "lambda.wrist.y"} <= {s.name for s in source.symbols}
    assert source.outputs["closure.jacobian_second"].shape == (5, 3)
    pin = {"type": "pin", "from": "x.rod_end", "to": "x.pin"}
    for name in ("wrist", "pin"):  # the same program but for these names
        model = closed_entry("slider-crank", [pin | {"name": name}], DOWN)
        assert f"lambda.{name}.x" in {s.name for s in perturbation(model).symbols}
        assert f"'{name}'" in first_integrals(model).integrals[0].reason


def test_failures_have_advice() -> None:
    model = four_bar(DOWN)
    lengths = {"x.l0": 0.4, "x.l2": 0.4, "x.l1": 0.1, "x.l3": 0.1}
    folded = linearise(model, [0, 0, 0], parameters=lengths)
    assert folded.status == "failed"
    assert "singular" in folded.message
    assert np.isnan(folded.A).all()
    far = {"parameters": {"x.l0": 5}, "q": [0, 0, 0]}
    assert "pin" in linearise(model, **far).message
    nothing = equilibria(model, parameters={"x.l0": 5}, count=2)
    assert nothing.found == ()
    assert "closures cannot be met" in nothing.message
    massless = linearise(model, [0.7, 0.2, 1.2], parameters=dict.fromkeys(("x.m1", "x.m2", "x.m3"), 0))
    assert massless.status == "failed"
    assert "masses" in massless.message


def test_a_structure_does_not_move() -> None:
    """A rod to the coupler holds the four-bar: nothing is left, also for a root locus."""
    pin = {"name": "pin", "type": "pin", "from": "x.coupler_end", "to": "x.rocker_end"}
    rod = {"name": "rod", "type": "rod", "from": "x.coupler_end", "to": "world", "length": 0.3}
    model = closed_entry("four-bar", [pin, rod], DOWN)
    found = linearise(model, [0.7, 0.2, 1.2])
    assert (found.status, found.A.shape, found.modes) == ("finished", (0, 0), ())
    assert found.stability is not None
    assert found.stability.verdict == "stable"
    locus = root_locus(model, parameter="x.m1", values=[1, 2], q=[0.7, 0.2, 1.2])
    assert locus.eigenvalues.shape == (2, 0)
    assert draw_root_locus(locus).startswith("<svg")


def test_a_root_at_zero_is_named() -> None:
    """|v| has no derivative at rest; |v| v has, which is 0."""
    loads: list[Plain] = [{"type": "joint", "coordinate": "table", "force": "-sqrt(table'^2)"}]
    found = linearise(damped(loads=loads), [-np.pi / 2, -np.pi / 2, np.pi / 2])
    assert found.status == "failed"
    assert "'x.table'" in found.message
    loads[0]["force"] += "*table'"
    smooth = linearise(damped(loads=loads), [-np.pi / 2, -np.pi / 2, np.pi / 2])
    assert smooth.status == "finished"
    np.testing.assert_allclose(smooth.D, linearise(damped(), [-np.pi / 2, -np.pi / 2, np.pi / 2]).D, atol=1e-12)


def test_bodies_without_mass_between_others() -> None:
    """A massless coupler: the metric is singular, but not along the motion that is left."""
    found = linearise(damped(), [-np.pi / 2, -np.pi / 2, np.pi / 2], qd=[0, 0, 0])
    model = closed_entry(
        "slider-crank", [{"name": "w", "type": "pin", "from": "x.rod_end", "to": "x.pin"}], DOWN, mr=0, Jr=0
    )
    bare = linearise(model, [-np.pi / 2, -1.86, -0.134])
    assert found.is_equilibrium
    assert bare.status == "finished", bare.message


@pytest.mark.parametrize(
    ("change", "pointer", "code"),
    [
        ({"q": [[0.7, 0.2, 1.2]] * 2}, "/q", "one-state"),
        ({"qdd": [0, 0, 0]}, "/qdd", "not-supported"),
        ({"q": [1]}, "/q", "wrong-length"),
        ({"of_inputs": ["nothing"]}, "/of_inputs/0", "unknown-input"),
        ({"parameters": {"x.nothing": 1}}, "/parameters/x.nothing", "unknown-parameter"),
        ({"inputs": {"tau.x.crank": "x.crank"}}, "/inputs/tau.x.crank", "number-expected"),
    ],
)
def test_faults_have_pointers(change: Plain, pointer: str, code: str) -> None:
    with pytest.raises(InvalidInput) as caught:
        linearise(four_bar(), **{"q": [0.7, 0.2, 1.2]} | change)
    assert [(f.pointer, f.code) for f in caught.value.faults] == [(pointer, code)]
