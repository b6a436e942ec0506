"""Friction by the load of joints, against elementary mechanics."""

from __future__ import annotations

from decimal import Decimal
from typing import Any

import numpy as np
import pytest
import scipy
from random_trees import Plain, tree_of
from simulated import simulated

from substructures import Definition, InvalidArgument, InvalidDocument, Model, couple, derive
from substructures.analysis.motion.friction import loaded_friction
from substructures.analysis.motion.trajectory import Trajectory
from substructures.analysis.simulate import FixedStep
from substructures.expr.interpret import interpret
from substructures.quantities.numbers.evaluation import evaluate
from substructures.quantities.part_models import ReactionModel
from substructures.quantities.reactions import reactions

G = 9.81
CHECK = "friction-load"


def exactly(x: float) -> Decimal:
    return Decimal(repr(float(x)))


def built(bodies: list[Plain], gravity: tuple[float, float, float], **parameters: float) -> tuple[Model, ReactionModel]:
    given = {name: {"value": exactly(x)} for name, x in parameters.items()}
    definition: Plain = {"name": "a", "bodies": bodies, "parameters": given}
    tree, parts = tree_of(definition, tuple(map(exactly, gravity))), {"x": derive(Definition.read(definition))}
    return couple(tree, parts), reactions(tree, parts)


def loaded(pair: tuple[Model, ReactionModel], *start: Any, **given: Any) -> Trajectory:
    return simulated(pair[0], *start, friction="loaded", bearings=pair[1], **given)


def block(angle: float, coulomb: float = 0, **load: Any) -> tuple[Model, ReactionModel]:
    """2 kg on a slide down an incline, x along it."""
    friction = {"coulomb": exactly(coulomb), "velocity": exactly(1e-3), "load": load}
    joint = {"type": "prismatic", "coordinate": "x", "friction": friction}
    body = {"name": "b", "parent": "base", "mass": 2, "joint": joint}
    return built([body], (0, -G * np.cos(angle), G * np.sin(angle)), mu=0.25)


@pytest.mark.parametrize("coulomb", [0, 1.5])
def test_a_block_on_an_incline(coulomb: float) -> None:
    """x'' = g (sin - mu cos) - F_c / m; it falls, and its energy by the work of friction."""
    angle, mu = 0.7, 0.25
    found = loaded(block(angle, coulomb, coefficient="mu"), [0], (0, 2), qd=[1], count=21)
    a = G * (np.sin(angle) - mu * np.cos(angle)) - coulomb / 2
    np.testing.assert_allclose(found.q[:, 0], found.t + a / 2 * found.t**2, rtol=1e-12)
    np.testing.assert_allclose(found.series["friction"][:, 0], -mu * 2 * G * np.cos(angle) - coulomb, rtol=1e-12)
    np.testing.assert_allclose(found.series["qdd"][:, 0], a, rtol=1e-12)
    assert found.is_right
    assert {CHECK, "energy-balance", "steps"} <= {check.name for check in found.checks}
    work = found.series["friction"][:, 0] * found.q[:, 0]
    np.testing.assert_allclose(found.series["work"], work, rtol=1e-9, atol=1e-12)


#: of the pendulum: mass, length, own inertia, gravity across its axis and along it
M, L, J, ACROSS, ALONG = 2.0, 0.5, 0.1, 9.0, 4.0


def pendulum(mu: float, r: float = 0.1, r_a: float = 0.05) -> tuple[Model, ReactionModel]:
    load = {"coefficient": exactly(mu), "radius": exactly(r), "axial_radius": exactly(r_a)}
    joint = {"type": "revolute", "coordinate": "q", "friction": {"coulomb": 0, "velocity": exactly(0.2), "load": load}}
    inertia = dict.fromkeys(("xx", "yy", "zz"), exactly(J)) | {"about": "com"}
    body = {"name": "b", "parent": "base", "mass": exactly(M), "com": [exactly(L), 0, 0], "inertia": inertia}
    return built([body | {"joint": joint}], (ACROSS, 0, -ALONG))


def moment(q: float, v: float, mu: float, r: float = 0.1, r_a: float = 0.05) -> float:
    """q'' of the pendulum, from m a = m g + R with a = L (q'' e_t - q'^2 e_r)."""

    def excess(a: float) -> float:
        """(J + m L^2) q'' - M."""
        radial = -M * L * v**2 - M * ACROSS * np.cos(q)
        tangential = M * L * a + M * ACROSS * np.sin(q)
        friction = mu * (r * np.hypot(radial, tangential) + r_a * M * ALONG) * np.tanh(v / 0.2)
        return float((J + M * L**2) * a + M * ACROSS * L * np.sin(q) + friction)

    return float(scipy.optimize.brentq(excess, -1e3, 1e3, xtol=1e-14, rtol=1e-15))


def test_a_pendulum_in_a_journal_bearing() -> None:
    mu = 0.4
    found = loaded(pendulum(mu), [1.2], (0, 6), qd=[1.0], count=31)
    own = scipy.integrate.solve_ivp(
        lambda _, y: [y[1], moment(*y, mu)], (0, 6), [1.2, 1.0], "DOP853", found.t, rtol=1e-12, atol=1e-13
    )
    np.testing.assert_allclose(found.q[:, 0], own.y[0], atol=1e-9)
    np.testing.assert_allclose(found.qd[:, 0], own.y[1], atol=1e-9)
    assert found.is_right
    # it has lost more than half of its energy
    assert np.abs(found.q[-10:]).max() < 0.7


def test_a_bearing_that_jams() -> None:
    """An arm of friction that is longer than the pendulum: no motion that the law determines."""
    found = loaded(pendulum(30.0, r_a=0), [1.2], (0, 1), qd=[1.0])
    assert found.status == "failed"
    assert "jams" in found.message
    later = loaded(pendulum(30.0, r_a=0), [0], (0, 1), inputs={"tau.x.q": "1000*t"})
    assert later.status == "failed"
    assert "jams" in later.message
    assert later.t[-1] > 0


def test_two_joints_and_a_motor() -> None:
    """Each loads the other; reactions that are shown are those that the friction is of."""
    bodies = []
    for k, parent in enumerate(("base", "b0")):
        load = {"coefficient": exactly(0.2), "radius": exactly(0.05)}
        friction = {"coulomb": exactly(0.1), "velocity": exactly(0.05), "load": load}
        joint = {"type": "revolute", "coordinate": f"q{k}", "sigma": k, "friction": friction}
        inertia = dict.fromkeys(("xx", "yy", "zz"), exactly(0.1))
        bodies.append({"name": f"b{k}", "parent": parent, "mass": 1, "com": [1, 0, 0], "joint": joint})
        bodies[-1]["inertia"] = inertia | {"about": "com"}
    pair = built(bodies, (0, -G, 0))
    found = loaded(pair, [0.3, -0.4], (0, 2), inputs={"tau.x.q0": "2*sin(5*t)"}, reactions=pair[1], count=41)
    assert found.is_right
    x, y = found.series["reaction_force"][:, :2, 0], found.series["reaction_force"][:, :2, 1]
    size = 0.1 + 0.2 * 0.05 * np.hypot(x, y)
    np.testing.assert_allclose(found.series["friction"], -size * np.tanh(found.qd / 0.05), rtol=1e-9, atol=1e-12)


def test_the_verdict_sees_friction_that_does_not_agree(monkeypatch: pytest.MonkeyPatch) -> None:
    """A planted fault: the reactions of the motion without this friction."""
    monkeypatch.setattr(loaded_friction, "AGREED", 10.0)
    found = loaded(pendulum(0.4), [1.2], (0, 1), qd=[1.0])
    assert found.is_right is False
    assert [check.name for check in found.checks if not check.holds] == [CHECK]


def test_formulas_leave_it_out_and_tell() -> None:
    model, _ = block(0.7, 1.5, coefficient="mu")
    np.testing.assert_allclose(evaluate(model, "forces", [0], [1.0])["forces"], 2 * G * np.sin(0.7) - 1.5)
    np.testing.assert_allclose(interpret(model.program, {"mu": 0.25}, ["friction_load"])["friction_load"], [[0.25, 0]])
    assert "friction-left-out" in {each["code"] for each in model.certificate["warnings"]}


@pytest.mark.parametrize(
    ("joint", "load", "pointer", "code"),
    [
        ("revolute", {"coefficient": 1}, "/radius", "missing"),
        ("prismatic", {"coefficient": 1, "radius": 1}, "/radius", "bad-friction"),
        ("prismatic", {"coefficient": -1}, "/coefficient", "bad-friction"),
        ("revolute", {"coefficient": 1, "radius": {"value": 1, "unit": "s"}}, "/radius", "unit-mismatch"),
    ],
)
def test_what_is_refused(joint: str, load: Plain, pointer: str, code: str) -> None:
    friction = {"coulomb": 0, "velocity": 1, "load": load}
    body = {"name": "b", "parent": "base", "joint": {"type": joint, "coordinate": "q", "friction": friction}}
    with pytest.raises(InvalidDocument) as caught:
        derive(Definition.read({"name": "a", "bodies": [body | {"mass": 1}]}))
    assert [(f.pointer, f.code) for f in caught.value.faults] == [(f"/bodies/0/joint/friction/load{pointer}", code)]


def test_what_it_does_not_go_with() -> None:
    pair = block(0.7, coefficient="mu")
    for given in ({"fixed_step": FixedStep(0.1)}, {"geodesic": True}, {"prescribed": {"x.x": 0}}):
        with pytest.raises(InvalidArgument) as caught:
            loaded(pair, [0], (0, 1), **given)
        assert caught.value.faults[0].code == "not-supported"
    with pytest.raises(InvalidArgument, match="bearings"):
        simulated(pair[0], [0], (0, 1), friction="loaded")
    plain = built(
        [{"name": "b", "parent": "base", "mass": 1, "joint": {"type": "prismatic", "coordinate": "x"}}], (0, 0, 0)
    )
    with pytest.raises(InvalidArgument, match="load"):
        loaded(plain, [0], (0, 1))
    with pytest.raises(InvalidArgument, match="negative"):
        loaded(pair, [0], (0, 1), parameters={"mu": -1})
