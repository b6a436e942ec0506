"""Identification on closures: parameters that closed motions tell, recovered from motions of which all is known."""

# ruff: noqa: N803, N806 -- symbols of the notation

from __future__ import annotations

from dataclasses import replace
from functools import cache
from typing import Any

import numpy as np
import pytest
from catalogue_entries import shipped_part
from closed_trees import four_bar, tree_model
from in_depth import deep
from random_trees import Plain

from substructures import InvalidInput, Model, TreeSpec, derive
from substructures.analysis.closed.loops import loop_state
from substructures.analysis.identification import on_closures
from substructures.analysis.identification.base_parameters import BaseParameters, base_parameters
from substructures.analysis.identification.consistent import consistent_inertia
from substructures.analysis.identification.fit import excitation, identify
from substructures.expr.interpret import interpret
from substructures.quantities.numbers.defaults import default_numbers
from substructures.quantities.regressor import regressor
from substructures.quantities.regressor_model import RegressorModel

DOWN = (0, -9.81, 0)
MOTION = "0.9 + 0.5*sin(2*t) + 0.3*cos(3.1*t) - 0.2*sin(5*t)"


@cache
def linkage() -> tuple[Model, RegressorModel, BaseParameters]:
    """A four-bar linkage, its regressor, and the base parameters of its open tree."""
    tree = {"name": "t", "gravity": list(DOWN), "instances": [{"name": "x", "substructure": "four-bar"}]}
    Y = regressor(TreeSpec.read(tree), {"x": shipped_part("four-bar")})
    return four_bar(DOWN), Y, base_parameters(replace(Y, closures=()))


@cache
def measured(samples: int = 60) -> Plain:
    """q, q', q'' and the torque of the crank, which moves as MOTION says."""
    model, near, rows = linkage()[0], np.array([0.9, 0.2, 1.2]), list[Any]()
    for t in np.linspace(0, 6, samples):
        state = loop_state(model, near, t=float(t), prescribed={"x.crank": MOTION})
        assert state.is_right
        near = state.consistent.q
        rows.append((near, state.consistent.qd, state.qdd, [state.actuation["x.crank"], 0, 0]))
    return {name: np.array(x) for name, x in zip(("q", "qd", "qdd", "tau"), zip(*rows, strict=True), strict=True)}


def truth(base: BaseParameters, Y: RegressorModel, combinations: Any) -> Any:
    """The combinations of what the parameters of the tree are."""
    values = default_numbers(Y.parameters)
    beta = dict(zip(base.names, interpret(base.program, values, ["base_parameters"])["base_parameters"], strict=True))
    return np.array([sum(c * beta[name] for name, c in some.items()) for some in combinations.values()])


def test_a_four_bar_is_identified_by_the_torque_of_its_crank() -> None:
    """The rocker and the coupler have no drive; of the parameters of the open tree fewer are told."""
    model, Y, base = linkage()
    found = identify(base, **measured(), closed=model)
    assert (found.status, found.is_right) == ("identified", True)
    assert found.independent is not None
    assert len(found.independent) == 1
    assert found.combinations is not None
    assert list(found.combinations) == list(found.names)
    assert 2 < len(found.names) < base.count
    np.testing.assert_allclose(found.values, truth(base, Y, found.combinations), rtol=1e-6, atol=1e-8)
    assert found.residual.max() < 1e-9
    given = {name: measured()[name] for name in ("q", "qd", "qdd")}
    shown = excitation(base, **given, closed=model)
    assert (shown.names, shown.rank) == (found.names, len(found.names))


def test_their_number_is_the_rank_of_what_actuators_do() -> None:
    """The least number that explains the torques of random closed motions, by singular values, without any of ours."""
    model, Y, base = linkage()
    loops = on_closures.Loops.of(model, base, measured()["q"], {})
    rng, rows = np.random.default_rng(3), list[Any]()
    for k in range(0, 60, 2):
        q = measured()["q"][k]
        unit = loop_state(model, q, qd=rng.uniform(-1, 1, 3)).consistent.qd
        state = loop_state(model, q, qd=unit, inputs={"tau.x.crank": float(rng.uniform(-9, 9))})
        found = Y.evaluate(q=q, qd=state.consistent.qd, qdd=state.qdd, parameters=default_numbers(Y.parameters))
        # virtual work along the velocity that the closures leave
        rows.append(unit @ found["regressor"])
    sizes = np.linalg.svd(np.array(rows) / np.linalg.norm(rows, axis=0).clip(1e-12), compute_uv=False)
    assert len(loops.kept) == int(np.sum(sizes > 1e-7 * sizes[0]))


def test_noise_is_told_and_inertia_is_consistent() -> None:
    """Samples kept back are predicted; every body gets an inertia that a distribution of mass has."""
    model, Y, base = linkage()
    noisy = {**measured(), "tau": measured()["tau"] + 0.01 * np.random.default_rng(1).standard_normal((60, 3))}
    found = identify(base, **noisy, closed=model, held_out=0.2)
    assert found.combinations is not None
    assert found.held_out is not None
    away = np.abs(found.values - truth(base, Y, found.combinations)) / found.deviations
    assert away.max() < 5
    inertia = consistent_inertia(base, Y, found)
    assert inertia.is_right
    assert (inertia.least_eigenvalues[np.isfinite(inertia.least_eigenvalues)] > -1e-12).all()


RAIL: Plain = {
    "name": "rail",
    "bodies": [{"name": "cart", "parent": "base", "joint": {"type": "prismatic", "coordinate": "s"}, "mass": 2}],
    "ports": [{"name": "top", "body": "cart"}],
}


def test_of_welded_carts_the_sum_of_the_masses_is_told() -> None:
    pair = [{"name": name, "substructure": "rail"} for name in "ab"]
    weld = {"name": "weld", "type": "weld", "from": "a.top", "to": "b.top"}
    spec = {"name": "loop", "instances": pair, "closures": [weld]}
    model = tree_model(spec, {"rail": RAIL})
    Y = regressor(TreeSpec.read(spec), dict.fromkeys("ab", derive(RAIL)))
    base = base_parameters(replace(Y, closures=()), ("viscous",))
    t = np.linspace(0, 3, 40)
    q, qd, qdd = (np.stack([x, x], axis=1) for x in (np.sin(t), np.cos(t), -np.sin(t)))
    # by the one and by the other drive
    tau = np.stack([3 * qdd[:, 0], qdd[:, 0] + 0.5 * qd[:, 0]], axis=1)
    found = identify(base, q, qd, qdd, tau, closed=model)
    assert found.combinations == {
        "a.cart.m": {"a.cart.m": pytest.approx(1), "b.cart.m": pytest.approx(1)},
        "a.s.viscous": {"a.s.viscous": pytest.approx(1), "b.s.viscous": pytest.approx(1)},
    }
    np.testing.assert_allclose(found.values, [4, 0.5], rtol=1e-9)


def test_open_measurements_are_refused() -> None:
    model, _, base = linkage()
    far = {name: x + (10.0 if name == "q" else 0) for name, x in measured().items()}
    with pytest.raises(InvalidInput, match="could be closed") as caught:
        identify(base, **far, closed=model, parameters={"x.l3": 20})
    assert (caught.value.faults[0].pointer, caught.value.faults[0].code) == ("/q", "open-closure")


@pytest.mark.parametrize("sign", [1, *deep(-1)])
def test_a_planted_fault_is_seen(sign: int, monkeypatch: pytest.MonkeyPatch) -> None:
    """Velocities that the closures do not leave: reactions are taken for inertia."""
    model, _, base = linkage()
    right = on_closures.Loops.tangents
    monkeypatch.setattr(on_closures.Loops, "tangents", lambda self, q: right(self, q) + 0.1 * sign)
    assert not identify(base, **measured(), closed=model, error_limit=0.01).is_right
