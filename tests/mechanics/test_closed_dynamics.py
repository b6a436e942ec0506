"""Forward dynamics of trees with closures: the constrained accelerations in numbers, and what refuses closures."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np
import pytest
from catalogue_entries import shipped_part
from closed_trees import at, bricard, four_bar, governor, slider_crank, stewart, tree_model
from random_trees import Plain

from substructures import InvalidDocument, InvalidInput, Model, TreeSpec, catalogue
from substructures.analysis.closed.constrained import Constrained
from substructures.analysis.closed.loops import loop_state
from substructures.analysis.equations.curvature import curvature
from substructures.analysis.equations.nonholonomic.quasi_velocities import quasi_velocity_equations
from substructures.analysis.equations.perturbation import state_space
from substructures.analysis.equations.routh import routh
from substructures.analysis.identification.base_parameters import base_parameters
from substructures.analysis.motion.variation import variational
from substructures.quantities.formulas import derived, kept
from substructures.quantities.numbers.evaluation import evaluate
from substructures.quantities.regressor import regressor

FD = "forward_dynamics"
DOWN = (0, -9.81, 0)


def accelerations(model: Model, q: Any, qd: Any, **more: Any) -> Plain:
    return evaluate(model, [FD], q=q, qd=qd, **more)


@pytest.mark.parametrize("make", [lambda: four_bar(DOWN), lambda: slider_crank(DOWN), bricard, governor, stewart])
def test_accelerations_are_those_of_the_loops(make: Callable[[], Model]) -> None:
    """One by one by the factors of [g G^T; G 0], and many at a time; redundant closures included."""
    model = make()
    rng = np.random.default_rng(3)
    inputs = {f"tau.{model.coordinates[0]}": 0.7}
    states, expected = [], []
    while len(states) < 3:
        request = {"q": rng.uniform(-0.4, 0.4, model.dof), "qd": rng.uniform(-1, 1, model.dof), "inputs": inputs}
        found = loop_state(model, **request)
        if not found.message:
            states.append(found.consistent)
            expected.append(found.qdd)
    q, qd = (np.array([getattr(s, name) for s in states]) for name in ("q", "qd"))
    answer = accelerations(model, q, qd, inputs=inputs)
    assert answer.failures == ()
    scale = np.abs(expected).max()
    np.testing.assert_allclose(answer[FD], expected, rtol=0, atol=1e-8 * scale)
    one = accelerations(model, q[1], qd[1], inputs=inputs)[FD]
    np.testing.assert_allclose(one, expected[1], rtol=0, atol=1e-8 * scale)


def test_forces_are_not_judged_beside_moments(monkeypatch: pytest.MonkeyPatch) -> None:
    """1 mN on a rail beside 1 GN m on a loop: a wrong acceleration on the rail is found."""
    mass = {"name": "mass", "parent": "base", "joint": {"type": "prismatic", "coordinate": "x"}, "mass": 1}
    instances = [{"name": "loop", "substructure": "four-bar"}, {"name": "light", "substructure": "rail"}]
    closures = [{"name": "c", "type": "pin", "from": "loop.coupler_end", "to": "loop.rocker_end"}]
    definitions = {"four-bar": catalogue.load("four-bar"), "rail": {"name": "rail", "bodies": [mass]}}
    model = tree_model({"instances": instances, "closures": closures}, definitions)
    forces = {"tau.loop.crank": 1e9, "tau.light.x": 1e-3}
    request: Any = {"q": [0.7, 0.2, 1.2, 0.0], "inputs": forces}
    assert loop_state(model, **request).is_right
    right = Constrained.accelerations
    wrong = {"light.x": 2.0}

    def accelerations(s: Constrained, rows: Any) -> Any:
        qdd, multipliers = right(s, rows)
        return qdd * [wrong.get(name, 1.0) for name in model.coordinates], multipliers

    monkeypatch.setattr(Constrained, "accelerations", accelerations)
    found = loop_state(model, **request)
    assert found.is_right is False
    (check,) = (check for check in found.checks if not check.holds)
    assert (check.name, check.unit, check.worst) == ("equations of motion", "N", pytest.approx(1e-3))


def test_open_and_singular_states_have_no_accelerations() -> None:
    """Open positions, open velocities, and a branching point: two links that are folded; other states keep theirs."""
    model = four_bar(DOWN)
    good = loop_state(model, [0.7, 0.2, 1.2], qd=[1, 0, 0]).consistent
    rest = np.zeros(3)
    answer = accelerations(model, np.array([good.q, good.q + 0.1, good.q]), np.array([good.qd, rest, good.qd + 0.1]))
    assert np.isfinite(answer[FD][0]).all()
    assert np.isnan(answer[FD][1:]).all()
    assert [f.state for f in answer.failures] == [1, 2]
    assert "loop states" in answer.failures[0].message
    lengths = {"x.l0": 0.4, "x.l1": 0.1, "x.l2": 0.4, "x.l3": 0.1}
    folded = accelerations(model, rest, rest, parameters=lengths)
    assert np.isnan(folded[FD]).all()


def test_one_position_for_many_velocities_and_inputs() -> None:
    model = four_bar(DOWN)
    state = loop_state(model, [0.7, 0.2, 1.2], qd=[1, 0, 0]).consistent
    speeds, torque = np.array([0.0, 1.0, 3.0]), {"tau.x.crank": [0.0, 1.0, 2.0]}
    many = accelerations(model, state.q, speeds[:, None] * state.qd, inputs=torque)[FD]
    for k, speed in enumerate(speeds):
        one = accelerations(model, state.q, speed * state.qd, inputs={"tau.x.crank": torque["tau.x.crank"][k]})[FD]
        np.testing.assert_allclose(many[k], one, rtol=1e-12)


def test_a_redundant_closure_does_not_lock_what_is_nearly_closed() -> None:
    """1e-8 beside a closed position of Bricard's linkage five rows are independent: nothing could move."""
    model = bricard()
    state = loop_state(model, [2, 0.1, 2, 0.1, 2]).consistent
    beside = state.q + 1e-8 * np.array([1, 2, -1, 0, 0])
    answer = accelerations(model, np.array([state.q, beside]), np.zeros(5))
    assert np.abs(answer[FD][0]).max() > 0.1
    assert np.isnan(answer[FD][1]).all()


def test_numbers_do_not_make_formulas() -> None:
    """What accelerations are computed from is not kept as their formula."""
    model = four_bar()
    state = loop_state(model, [0.7, 0.2, 1.2]).consistent
    accelerations(model, state.q, state.qd)
    with pytest.raises(InvalidDocument, match="'pin'"):
        kept(model, FD)


def refused() -> list[tuple[str, Callable[[Model], Any]]]:
    return [
        ("evaluate it", lambda m: derived(m, FD)),
        ("linearisations", lambda m: derived(m, f"{FD}_derivative")),
        ("independent coordinates", curvature),
        ("perturbation", state_space),
        ("first integrals", routh),
        ("simulations", lambda m: variational(m, [])),
        ("'type': 'closure'", lambda m: quasi_velocity_equations(m, [])),
    ]


@pytest.mark.parametrize(("advice", "call"), refused())
def test_closures_are_refused_by_name_and_with_advice(advice: str, call: Callable[[Model], Any]) -> None:
    with pytest.raises(InvalidInput, match="'pin'") as caught:
        call(four_bar())
    assert advice in caught.value.faults[0].message
    assert caught.value.faults[0].code in ("has-closures", "open-closure")


def test_base_parameters_of_a_closed_tree_are_refused() -> None:
    """The reactions of its closures are not known."""
    pin = {"name": "pin", "type": "pin", "from": "x.coupler_end", "to": "x.rocker_end"}
    document = {"name": "t", "instances": [{"name": "x", "substructure": "four-bar"}], "closures": [pin]}
    parts = {"x": shipped_part("four-bar")}
    with pytest.raises(InvalidDocument, match=r"'pin'.*regressor"):
        base_parameters(regressor(TreeSpec.read(document), parts))


def test_a_dead_centre_at_rest() -> None:
    """Crank and rod in line, the crank drives: regular; the piston cannot drive there, but is not asked to."""
    model = slider_crank(DOWN)
    state = loop_state(model, at(model, crank=0.0, rod=0.0, piston=0.2), fixed=["x.crank"])
    assert not state.message
    answer = accelerations(model, state.consistent.q, state.consistent.qd)
    np.testing.assert_allclose(answer[FD], state.qdd, atol=1e-8)


def two_four_bars(size: float) -> Model:
    """A four-bar of metres and the same one of another size, side by side: nothing is between them."""
    instances = []
    for name, unit in (("large", 1.0), ("small", size)):
        lengths = {f"l{k}": x * unit for k, x in enumerate((0.4, 0.1, 0.35, 0.25))}
        instances.append({"name": name, "substructure": "four-bar", "parameters": lengths})
    pins = [
        {"name": f"pin_{name}", "type": "pin", "from": f"{name}.coupler_end", "to": f"{name}.rocker_end"}
        for name in ("large", "small")
    ]
    document = {"gravity": list(DOWN), "instances": instances, "closures": pins}
    return tree_model(document, {"four-bar": catalogue.load("four-bar")})


@pytest.mark.parametrize("size", [1e-4, 1e-7, 1e-9, 1e-11])
def test_rows_are_judged_beside_their_own_sizes(size: float) -> None:
    """Closures of nanometres beside closures of metres: both mechanisms move as each of them alone."""
    model = two_four_bars(size)
    state = loop_state(model, [0.7, 0.2, 1.2] * 2, qd=[1, 0, 0, 2, 0, 0], fixed=["large.crank", "small.crank"])
    assert not state.message
    q, qd = state.consistent.q, state.consistent.qd
    found = accelerations(model, q, qd)
    assert found.failures == ()
    alone = []
    for k, unit in enumerate((1.0, size)):
        lengths = {f"x.l{i}": x * unit for i, x in enumerate((0.4, 0.1, 0.35, 0.25))}
        some = slice(3 * k, 3 * k + 3)
        alone.append(accelerations(four_bar(DOWN), q[some], qd[some], parameters=lengths)[FD])
    for k in range(2):
        np.testing.assert_allclose(found[FD][3 * k : 3 * k + 3], alone[k], rtol=1e-6)
        np.testing.assert_allclose(state.qdd[3 * k : 3 * k + 3], alone[k], rtol=1e-6)


@pytest.mark.parametrize("size", [1e-9, 1e-4, 1.0, 1e4])
def test_openness_is_judged_beside_lengths(size: float) -> None:
    """A loop that is open by a part of 1e-6 of its links is open, however short they are; by 1e-12 it is closed."""
    model = four_bar(DOWN)
    lengths = {f"x.l{k}": x * size for k, x in enumerate((0.4, 0.1, 0.35, 0.25))}
    state = loop_state(model, [0.7, 0.2, 1.2], qd=[1, 0, 0], parameters=lengths).consistent
    q = state.q + np.array([[0, 0, 0], [1e-12, 0, 0], [1e-6, 0, 0], [0, 0, 0]])
    qd = state.qd + np.array([[0, 0, 0], [0, 0, 0], [0, 0, 0], [0.01, 0, 0]])
    found = accelerations(model, q, qd, parameters=lengths)
    assert [failure.state for failure in found.failures] == [2, 3]
    np.testing.assert_allclose(found[FD][1], found[FD][0], rtol=1e-6)


def test_a_state_is_judged_alone() -> None:
    """Lengths may be other ones in every state of a batch; a verdict is that of the state by itself."""
    model = four_bar(DOWN)
    sizes = np.array([1.0, 1e-9, 1e5])
    lengths = {f"x.l{k}": x * sizes for k, x in enumerate((0.4, 0.1, 0.35, 0.25))}
    state = loop_state(model, [0.7, 0.2, 1.2], qd=[1, 0, 0], parameters={n: x[0] for n, x in lengths.items()})
    q = state.consistent.q + np.array([[0, 0, 0], [1e-7, 0, 0], [0, 0, 0]])
    together = accelerations(model, q, state.consistent.qd, parameters=lengths)
    for k in range(3):
        one = accelerations(model, q[k], state.consistent.qd, parameters={n: x[k] for n, x in lengths.items()})
        np.testing.assert_array_equal(one[FD], together[FD][k])
    assert [failure.state for failure in together.failures] == [1]


def test_blocks_of_states(monkeypatch: pytest.MonkeyPatch) -> None:
    model = four_bar(DOWN)
    states = [loop_state(model, [0.7 + k / 10, 0.2, 1.2], qd=[1, 0, 0], fixed=["x.crank"]).consistent for k in range(5)]
    q, qd = (np.array([getattr(s, name) for s in states]) for name in ("q", "qd"))
    torque = {"tau.x.crank": np.arange(5.0)}
    whole = accelerations(model, q, qd, inputs=torque)[FD]
    monkeypatch.setattr("substructures.quantities.accelerations.BLOCK", 2 * 8 * model.dof**2)
    np.testing.assert_array_equal(accelerations(model, q, qd, inputs=torque)[FD], whole)
    assert np.isfinite(whole).all()
