"""What a trajectory states about its drift holds for the arrays that are returned, for all kinds of motion."""

from __future__ import annotations

from itertools import product
from typing import Any

import numpy as np
import pytest
from analysis_models import catalogue_model
from closed_trees import at, bricard, four_bar, slider_crank
from in_depth import deep
from random_trees import Plain
from rolling_bodies import BLADE, FLOOR, FORWARD, R, disc, sleigh
from simulated import simulated

from substructures import Model
from substructures.analysis.equations import kernels
from substructures.analysis.motion.trajectory import Trajectory
from substructures.analysis.simulate import ClosedMotion, Event, FixedStep, Outputs, simulate
from substructures.analysis.verdict import Check
from substructures.compile import Kernel
from substructures.expr.program import Program
from substructures.quantities.numbers.evaluation import evaluate

TREES: dict[str, tuple[str, Plain]] = {
    "acrobot": ("acrobot", {"q": [1.2, 0], "span": [0, 5], "step": 0.02}),
    "late results only": ("acrobot", {"q": [1.2, 0], "span": [0, 5], "times": [3.1, 3.2, 4.9]}),
    "many results in a step": ("double-pendulum", {"q": [1, 0.5], "span": [0, 2], "count": 2001}),
    "damped": ("furuta-pendulum", {"q": [0.1, 0.4], "qd": [3, 0], "span": [0, 3]}),
    "driven": ("acrobot", {"q": [0.3, 0.1], "span": [0, 3], "inputs": {"tau.x.q2": "sin(3*t) - x.q2'/10"}}),
    "arm": ("puma560", {"q": [0.1, 0.2, 0.3, 0.4, 0.5, 0.6], "qd": [0.5] * 6, "span": [0, 2]}),
}
METHODS: dict[str, Plain] = {name: {"method": name} for name in ("DOP853", "RK45", "RK23", "Radau", "BDF", "LSODA")}
METHODS |= {name: {"fixed_step": FixedStep(0.013, name)} for name in ("rk4", "semi-implicit-euler")}
#: every tree with one method, every method with results between steps; the others are deep
QUICK = [(tree, method) for tree in TREES for method in METHODS if method == "DOP853" or tree == "late results only"]
OTHERS = [pair for pair in product(TREES, METHODS) if pair not in QUICK]


def stated(motion: Trajectory, *names: str) -> Check:
    """The check of one of these names."""
    return next(check for check in motion.checks if check.name in names)


def energies(model: Model, q: Any, qd: Any) -> np.ndarray:
    """T + V, by a way that the judges do not go."""
    found = evaluate(model, ["metric", "potential_energy"], q=q, qd=qd)
    return np.asarray(0.5 * np.einsum("ka,kab,kb->k", qd, found["metric"], qd) + found["potential_energy"])


def assert_stated(check: Check, values: np.ndarray, rounding: float = 1e-13) -> None:
    """No two of the values are further apart than the check says."""
    assert np.ptp(values) <= check.worst + rounding * max(check.scale, float(np.abs(values).max())), check


def assert_energy_is_stated(model: Model, motion: Trajectory) -> None:
    """Of results, and of results and events together."""
    check = stated(motion, "energy-balance", "energy")
    work = motion.series.get("work", np.zeros(len(motion.t)))
    energy = energies(model, motion.q, motion.qd)
    assert_stated(check, energy - work)
    if not work.any() and motion.events:
        q, qd = (np.array([getattr(event, name) for event in motion.events]) for name in ("q", "qd"))
        assert_stated(check, np.concatenate([energy, energies(model, q, qd)]))


@pytest.mark.parametrize(("name", "method"), [*QUICK, *deep(*OTHERS)])
def test_trees(name: str, method: str) -> None:
    entry, request = TREES[name]
    model = catalogue_model(entry)
    coarse = {"relative_tolerance": 1e-6, "absolute_tolerance": 1e-8} if method in ("RK23", "BDF") else {}
    motion = simulated(model, **request | METHODS[method] | coarse)
    assert motion.status == "finished", motion.message
    assert_energy_is_stated(model, motion)
    if entry == "puma560":
        first = evaluate(model, ["metric"], q=motion.q)["metric"][:, 0]
        assert_stated(stated(motion, "momentum.x.q1"), np.einsum("ka,ka->k", first, motion.qd))


def test_all_momenta_of_a_free_body() -> None:
    model = catalogue_model("free-body", (0, 0, 0))
    motion = simulate(model, [0] * 6, (0, 5), qd=[0.3, -0.2, 0.1, 0.4, 0.2, 0.5])
    found = evaluate(model, ["momentum"], q=motion.q, qd=motion.qd)["momentum"]
    for kind in ("linear", "angular"):
        for k, axis in enumerate("xyz"):
            assert_stated(stated(motion, f"{kind}_momentum.{axis}"), found[kind][:, k])


def test_states_of_events_are_judged() -> None:
    """Recorded between steps and results, and the one that stops."""
    model = catalogue_model("acrobot")
    events = [
        Event("level", "x.q1", level=0.3, action="record"),
        Event("end", "x.q1'", level=-1.0, direction="falling"),
    ]
    motion = simulate(model, [1.2, 0], (0, 5), outputs=Outputs(times=[0, 4.9], events=events))
    assert (motion.status, motion.events[-1].name) == ("stopped", "end")
    assert_energy_is_stated(model, motion)


def assert_pin_is_stated(model: Model, motion: Trajectory, ends: tuple[str, str]) -> None:
    """Gap and relative velocity of two points in the plane, by kinematics; both are below 1e-9."""
    place = evaluate(model, ["kinematics"], q=motion.q)["kinematics"]
    one, two = (model.frames.index(name) for name in ends)
    gap = np.abs(place["position"][:, one] - place["position"][:, two]).max()
    turned = np.einsum("kfij,kfaj,ka->kfi", place["rotation"], place["U"], motion.qd)
    rate = np.abs(turned[:, one] - turned[:, two]).max()
    for size, name in ((gap, "position residual"), (rate, "velocity residual")):
        check = stated(motion, name)
        assert check.holds
        assert check.limit == 1e-9
        assert size <= 1.5 * check.worst + 1e-14 * max(1.0, float(np.abs(motion.qd).max())), check


@pytest.mark.parametrize("reduction", ["projection", "partitioning"])
@pytest.mark.parametrize("count", [7, 801, *deep(4001)])
def test_closed_motions(reduction: str, count: int) -> None:
    """Residuals and energy of the results between steps."""
    four, crank = four_bar((0, -9.81, 0)), slider_crank()
    for model, request, ends in (
        (
            four,
            {"q": at(four, crank=0.7, coupler=0.2, rocker=1.2), "qd": at(four, crank=9)},
            ("coupler_end", "rocker_end"),
        ),
        (crank, {"q": at(crank, crank=0.3, piston=0.17), "qd": at(crank, crank=40)}, ("rod_end", "pin")),
    ):
        common = {"fixed": ["x.crank"], "span": [0, 0.2], "count": count, "reduction": reduction}
        motion = simulated(model, **request | common)
        assert motion.is_right, motion.checks
        assert_energy_is_stated(model, motion)
        assert_pin_is_stated(model, motion, (f"x.{ends[0]}", f"x.{ends[1]}"))


@pytest.mark.parametrize("reduction", ["projection", "partitioning"])
def test_closed_motions_in_space_driven_and_with_events(reduction: str) -> None:
    a = 1.9
    b = np.arccos(-np.cos(a) / (1 + np.cos(a)))
    model = bricard()
    event = Event("half", "l0.q", level=1.7, action="record")
    motion = simulate(
        model,
        [a, b, a, b, a],
        (0, 1.5),
        kind=ClosedMotion(reduction=reduction),
        outputs=Outputs(count=30, events=[event]),
    )
    assert motion.events
    assert_energy_is_stated(model, motion)
    model = slider_crank()
    request: Plain = {"q": at(model, crank=0.3, piston=0.17), "qd": at(model, crank=20), "fixed": ["x.crank"]}
    request |= {"span": [0, 0.3], "inputs": {"tau.x.crank": "-x.crank'/100"}}
    assert_energy_is_stated(model, simulated(model, **request, reduction=reduction))


def test_nothing_is_wanted_but_the_judgement() -> None:
    """No times: series without rows, and the checks of all steps."""
    model = slider_crank()
    request: Plain = {"q": at(model, crank=0.3, piston=0.17), "qd": at(model, crank=20), "fixed": ["x.crank"]}
    motion = simulated(model, **request, span=(0, 0.1), times=[])
    assert {len(values) for values in motion.arrays().values()} == {0}
    assert stated(motion, "energy").worst > 0


@pytest.mark.parametrize("form", ["voronets", "boltzmann-hamel"])
def test_rolling_motions(form: str) -> None:
    """Energy, the velocity across the blade, and the height of the disc over the floor."""
    model = disc()
    start = [0, 0, R * np.sin(1.2), 0.2, 1.2, 0]
    request: Plain = {"constraints": [FLOOR], "q": start, "v": [1.0, 0.5, 6.0], "span": [0, 3], "form": form}
    motion = simulated(model, **request, count=2001)
    assert motion.is_right, motion.checks
    assert_energy_is_stated(model, motion)
    assert_stated(stated(motion, "gaps"), motion.q[:, 2] - R * np.sin(motion.q[:, 4]))
    model = sleigh()
    request = {"constraints": [BLADE], "velocities": FORWARD, "q": [0, 0, 0.4], "v": [1.0, 0.5], "form": form}
    event = Event("turned", "s.f", level=0.6, action="record")
    motion = simulated(model, **request, span=(0, 2), times=[0.3, 1.1], events=[event])
    assert motion.events
    assert_energy_is_stated(model, motion)
    across = np.cos(motion.q[:, 2]) * motion.qd[:, 1] - np.sin(motion.q[:, 2]) * motion.qd[:, 0]
    assert np.abs(across).max() <= stated(motion, "constraints").worst + 1e-15


def test_verdicts_of_many_motions_are_by_a_kernel(monkeypatch: pytest.MonkeyPatch) -> None:
    """From the motion on at which interpreting has taken as long as compiling; the numbers are the same."""
    model, made = catalogue_model("double-pendulum"), list[int]()
    compile_it = kernels.program_kernel

    def noted(source: Program) -> Kernel:
        made.append(len(source))
        return compile_it(source)

    monkeypatch.setattr(kernels, "program_kernel", noted)
    monkeypatch.setattr(kernels, "INTERPRETED", kernels.LINE / 8)
    monkeypatch.setattr(kernels, "COMPILED", 0.0)
    monkeypatch.setattr(kernels, "VALUE", 0.0)
    kernels._spent.cache_clear()
    motions = [simulated(model, q=[0.3, 0.2], span=[0, 1], count=11) for _ in range(12)]
    assert len(made) == 4
    first, last = motions[0], motions[-1]
    assert [c.name for c in first.checks] == [c.name for c in last.checks]
    assert last.is_right
    for name, series in first.series.items():
        np.testing.assert_allclose(last.series[name], series, rtol=1e-13, atol=1e-13)
