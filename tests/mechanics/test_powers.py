"""The power of every load and joint: by hand, their sum, along motions, and faults that are seen."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
from catalogue_entries import shipped_part
from closed_trees import slider_crank
from random_trees import Kind, random_definition, tree_of
from simulated import simulated

from substructures import Definition, InvalidArgument, Model, Part, TreeSpec, couple, derive
from substructures.analysis.motion import load_powers
from substructures.analysis.motion.trajectory import Trajectory
from substructures.analysis.motion.writers import to_csv
from substructures.analysis.simulate import Geodesic, Outputs, simulate
from substructures.errors import VerificationFailed
from substructures.part.forces import load_forces as by_load
from substructures.quantities import powers as module
from substructures.quantities.numbers.evaluation import evaluate
from substructures.quantities.numbers.result import Evaluation
from substructures.quantities.part_models import PowerModel
from substructures.quantities.powers import powers
from substructures.quantities.sources import Sources

Plain = dict[str, Any]
LAW = {"stiffness": 30, "rest": 0.1, "damping": 2}
#: a mass on vertical rails with all that a joint may have
SLIDE: Plain = {
    "name": "slide",
    "inputs": {"pull": {"unit": "N"}},
    "parameters": {"m": {"value": 3, "unit": "kg"}},
    "bodies": [{
        "name": "mass", "parent": "base", "mass": "m",
        "joint": {"type": "prismatic", "coordinate": "z", **LAW,
                  "friction": {"coulomb": 1.5, "velocity": 0.001}, "limits": [-2, 0.4],
                  "limits_act": {"stiffness": 1000, "damping": 5}},
    }],
    "loads": [
        {"type": "force", "body": "mass", "vector": [0, 0, "pull"], "frame": "world"},
        {"type": "spring", "from": {"body": "base", "at": [0.3, 0, 0]}, "to": {"body": "mass"}, "stiffness": 7,
         "length": 0.2, "damping": 0.5},
        {"type": "joint", "coordinate": "z", "force": "-4*z^3"},
        {"type": "potential", "potential": "2*z^2"},
    ],
}  # fmt: skip


def made(tree: Plain) -> tuple[Model, PowerModel]:
    spec = TreeSpec.read({"name": "tree"} | tree)
    parts: dict[str, Part] = {i["name"]: derive(Definition.read(i["definition"])) for i in tree["instances"]}
    return couple(spec, parts), powers(spec, parts)


def slide(**more: Any) -> tuple[Model, PowerModel]:
    return made({"gravity": [0, 0, -9.81], "instances": [{"name": "s", "definition": SLIDE}], **more})


def answered(model: Model, by: PowerModel, *others: str, **state: Any) -> Evaluation:
    return evaluate(Sources(model, of_parts=lambda _: by), ["powers", *others], **state)


def rows_of(found: Evaluation) -> dict[str, float]:
    assert found.loads is not None
    return dict(zip(found.loads, found["powers"].tolist(), strict=True))


def test_a_mass_on_rails_by_hand() -> None:
    z, v, pull = 0.5, 1.3, 11.0
    load = {"name": "mount", "type": "bushing", "from": "world", "to": "s.mass", "damping": [0, 0, 3]}
    model, by = slide(loads=[load])
    state: Plain = {"q": [z], "qd": [v], "inputs": {"tau.s.z": 5, "s.pull": pull}}
    length = np.hypot(0.3, z)
    tension = 7 * (length - 0.2) + 0.5 * v * z / length
    # beyond the limit of 0.4
    stop = (1000 + 5 * v) * (z - 0.4)
    expected = {
        "gravity": -3 * 9.81 * v,
        "joint s.z": (-30 * (z - 0.1) - 2 * v - 1.5 * np.tanh(v / 0.001) - stop) * v,
        "tau.s.z": 5 * v,
        "force s.loads/0": pull * v,
        "spring s.loads/1": -tension * z / length * v,
        "joint s.loads/2": -4 * z**3 * v,
        "potential s.loads/3": -4 * z * v,
        "bushing mount": -3 * v * v,
    }
    found = answered(model, by, "power", **state)
    assert list(rows_of(found)) == list(expected)
    assert rows_of(found) == pytest.approx(expected, rel=1e-12)
    assert found["powers"].sum() == pytest.approx(found["power"].sum(), rel=1e-12)


def test_a_force_on_a_part_works_on_its_host_too() -> None:
    """A dead force at the tip of the second of two rods in a line: F l (q1' 2 + q2'), across them."""
    rod = {
        "name": "rod", "ports": [{"name": "tip", "body": "rod", "position": [1, 0, 0]}],
        "bodies": [{"name": "rod", "parent": "base", "joint": {"type": "revolute", "coordinate": "q"}, "mass": 1}],
        "loads": [{"type": "torque", "body": "rod", "vector": [0, 0, 0.5]},
                  {"type": "force", "body": "rod", "at": [1, 0, 0], "vector": [0, 3, 0]}],
    }  # fmt: skip
    first = {name: x for name, x in rod.items() if name != "loads"}
    instances = [{"name": "a", "definition": first}, {"name": "b", "definition": rod, "at": "a.tip"}]
    found = rows_of(answered(*made({"instances": instances}), q=[0.2, 0], qd=[0.7, -0.4]))
    assert found["torque b.loads/0"] == pytest.approx(0.5 * (0.7 - 0.4))
    assert found["force b.loads/1"] == pytest.approx(3 * (2 * 0.7 - 0.4))
    assert found["gravity"] == 0


@pytest.mark.parametrize("seed", range(4))
def test_the_rows_add_up_to_the_power(seed: int) -> None:
    rng = np.random.default_rng(seed)
    definition = random_definition(rng, Kind(4, loads=4, springs=2))
    spec, parts = tree_of(definition), {"x": derive(Definition.read(definition))}
    model, by = couple(spec, parts), powers(spec, parts)
    n = model.dof
    inputs = {name: rng.normal() for name in model.input_names}
    state: Plain = {"q": rng.normal(size=(3, n)), "qd": rng.normal(size=(3, n)), "inputs": inputs, "t": 0.3}
    found = answered(model, by, "power", **state)
    np.testing.assert_allclose(found["powers"].sum(axis=1), found["power"].sum(axis=1), rtol=1e-9, atol=1e-9)
    assert len(found.loads or ()) == 1 + 2 * n + 6


def test_along_a_motion_they_are_the_rate_of_the_energy() -> None:
    model, by = slide()
    inputs: Plain = {"tau.s.z": "3*sin(5*t)", "s.pull": 20}
    motion = simulate(model, [-0.3], (0, 1), inputs=inputs, outputs=Outputs(count=2001, powers=by))
    assert motion.is_right
    check = motion.checks[-1]
    assert (check.name, check.rule, check.unit, check.holds) == ("power", "zero", "W", True)
    assert check.relative < 1e-9
    assert motion.loads == by.rows
    # T = m v^2 / 2 by differences of the motion itself
    kinetic = 1.5 * motion.qd[:, 0] ** 2
    h = motion.t[1] - motion.t[0]
    rate = (kinetic[2:] - kinetic[:-2]) / (2 * h)
    total = motion.series["powers"].sum(axis=1)[1:-1]
    # the friction and the stop turn over a millimetre a second: differences see the rest
    smooth = np.abs(motion.qd[1:-1, 0]) > 0.05
    assert np.abs(total - rate)[smooth].max() < 1e-3 * np.abs(total).max()
    head = to_csv(motion).splitlines()[0].split(",")
    assert head[-len(by.rows) :] == [f"power.{row}" for row in by.rows]
    assert motion.summary()["loads"] == list(by.rows)


def test_friction_that_sticks_exactly() -> None:
    """A mass that sticks has no power; one that slips loses F_c |v|."""
    plain = {k: x for k, x in SLIDE.items() if k != "loads"}
    joint = {"type": "prismatic", "coordinate": "z", "friction": {"coulomb": 40, "static": 50, "velocity": 0.001}}
    body = {"name": "mass", "parent": "base", "mass": 3, "joint": joint}
    one = {"name": "s", "definition": {**plain, "inputs": {}, "bodies": [body]}}
    model, by = made({"gravity": [0, 0, -9.81], "instances": [one]})
    motion = simulated(model, [0], (0, 1), qd=[1], friction="exact", count=51, powers=by)
    assert motion.is_right
    found = dict(zip(motion.loads, motion.series["powers"].T, strict=True))
    # up against the weight and 40 N, until it rests
    v = np.maximum(1 - (9.81 + 40 / 3) * motion.t, 0)
    np.testing.assert_allclose(found["joint s.z"], -40 * v, atol=1e-6)
    np.testing.assert_allclose(found["gravity"], -3 * 9.81 * v, atol=1e-6)
    assert motion.checks[-1].holds


def driven_crank(**given: Any) -> tuple[PowerModel, Trajectory]:
    closure = {"name": "wrist", "type": "pin", "from": "x.rod_end", "to": "x.pin"}
    one = {"name": "x", "substructure": "slider-crank"}
    spec = TreeSpec.read({"name": "l", "gravity": [0, -9.81, 0], "instances": [one], "closures": [closure]})
    by = powers(spec, {"x": shipped_part("slider-crank")})
    model = slider_crank((0, -9.81, 0))
    return by, simulated(model, [0.3, -0.1, 0.17], (0, 0.1), count=11, powers=by, **given)


def test_closures_do_no_work() -> None:
    given: Plain = {"qd": [40, 0, 0], "inputs": {"tau.x.crank": "2*sin(20*t)"}, "fixed": ["x.crank"]}
    by, motion = driven_crank(**given)
    assert motion.is_right
    assert motion.loads == by.rows
    crank = motion.series["powers"][:, by.rows.index("tau.x.crank")]
    np.testing.assert_allclose(crank, 2 * np.sin(20 * motion.t) * motion.qd[:, 0], rtol=1e-12, atol=1e-12)
    assert motion.checks[-1].relative < 1e-9


def test_what_moves_a_prescribed_coordinate_does_work() -> None:
    by, motion = driven_crank(prescribed={"x.crank": "0.3 + 30*t + 200*t^2"})
    assert motion.is_right
    assert motion.loads == (*by.rows, "prescribed x.crank")
    power = motion.series["actuation"][:, 0] * (30 + 400 * motion.t)
    np.testing.assert_allclose(motion.series["powers"][:, -1], power, rtol=1e-9)
    assert motion.checks[-1].holds
    assert np.abs(power).max() > 1


def test_a_motion_that_does_not_begin_has_none() -> None:
    _, motion = driven_crank(prescribed={"x.crank": "0.3", "x.piston": "9"})
    assert motion.status == "failed"
    assert "powers" not in motion.series


def test_a_power_that_is_left_out_is_seen(monkeypatch: pytest.MonkeyPatch) -> None:
    model, by = slide()
    given = load_powers.evaluated

    def without_gravity(program: Any, *rest: Any) -> Any:
        found = given(program, *rest)
        if "powers" in found:
            found["powers"][:, 0] = 0
        return found

    monkeypatch.setattr(load_powers, "evaluated", without_gravity)
    motion = simulate(model, [-0.3], (0, 0.2), outputs=Outputs(powers=by))
    assert motion.is_right is False
    assert motion.checks[-1].holds is False


def test_where_they_mean_nothing() -> None:
    model, by = slide()
    with pytest.raises(InvalidArgument, match="'powers' needs the parts"):
        evaluate(model, "powers", [0])
    with pytest.raises(InvalidArgument, match="'powers' means nothing"):
        simulate(model, [0], (0, 1), kind=Geodesic(), outputs=Outputs(powers=by))


@pytest.mark.parametrize("fault", ["joint", "load", "wrench"])
def test_wrong_formulas_are_not_served(fault: str, monkeypatch: pytest.MonkeyPatch) -> None:
    """The certificate sees a joint's law, a load between bodies and a wrench that are forgotten."""
    definition = random_definition(np.random.default_rng(3), Kind(4, loads=3, springs=2))
    if fault == "wrench":
        monkeypatch.setattr(module, "wrench_forces", lambda *_: {})
    else:
        made_right = by_load.array
        monkeypatch.setattr(
            by_load,
            "array",
            lambda shape, of: made_right(shape, (lambda *_: 0) if (len(shape) == 1) == (fault == "joint") else of),
        )
    with pytest.raises(VerificationFailed, match=r"powers: powers\["):
        powers(tree_of(definition), {"x": derive(Definition.read(definition))})
