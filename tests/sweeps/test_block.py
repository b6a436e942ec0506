"""Rows of sweeps: they are what their trees are, whatever the ranges in which they were computed."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np
import pytest
from catalogue_entries import shipped_part

from substructures import couple, linearise
from substructures.errors import InvalidInput
from substructures.sweeps import block as blocks
from substructures.sweeps.block import disagreement, joined
from tests.sweeps.in_process import Sweep
from tests.sweeps.test_analyses import ROD, SPRUNG

STATE = {"q": [0.2, 0.4, -0.3], "qd": [0.1, 0.2, 0.3], "qdd": [1, 0, 2]}
REST = {"q": [0, 0, 0]}
CRANE: dict[str, Any] = {
    "template": {
        "name": "crane",
        "gravity": [0, 0, "-g"],
        "parameters": {"g": {"value": 9.81, "unit": "m/s^2"}},
        "instances": [
            {"name": "rail", "substructure": "linear-rail"},
            {"name": "load", "substructure": "acrobot", "at": "rail.mount", "placement": {"rpy": [0, 0, 0]}},
        ],
    },
    "choices": {
        "load": ["acrobot", {"substructure": "acrobot", "parameters": {"m1": 3}}, "simple-pendulum"],
    },
    "samples": {
        "method": "random",
        "count": 40,
        "seed": 2,
        "of": {"rail.m": {"uniform": [1, 9]}, "g": {"uniform": [1, 9]}},
    },
    "columns": {
        "mass": "mass",
        "force": {"quantity": "inverse_dynamics", "of": "rail.x", "over": STATE},
        "worst": {
            "quantity": "inverse_dynamics",
            "over": {"q": [[0, 0.1, 0.2], [0, 0.2, 0.1]], "qd": [[1, 2, 3], [3, 2, 1]], "qdd": [[1, 1, 1], [0, 0, 0]]},
            "take": "largest_absolute",
        },
        "inertia": {"quantity": "metric", "of": ["rail.x", "rail.x"], "over": {"q": STATE["q"]}},
        "x": {"quantity": "mass_centre.position", "of": "x", "over": {"q": STATE["q"]}},
        "use": "force/mass - rail.m",
    },
    "where": "mass > 0",
}


def test_rows_are_what_their_trees_are() -> None:
    sweep = Sweep(CRANE)
    found = sweep.rows()
    # two options of one part have one shape, the pendulum has other coordinates than the columns are given for
    assert len(sweep.made) == 2
    assert sweep.plan.rows == 120
    assert found.rows.tolist() == list(range(80))
    assert {code: each["rows"] for code, each in sweep.refusals.by_code.items()} == {"wrong-length": 40}
    for k in (0, 17, 40, 79):
        slow, condition = sweep.slow(int(found.rows[k]))
        assert not disagreement({name: float(found.columns[name][k]) for name in slow}, slow, condition)
    # what is bound for the second option
    mass = found.columns["mass"]
    assert mass[40:] - mass[:40] == pytest.approx(mass[40] - mass[0])


def test_options_of_one_part_at_other_places_have_one_shape() -> None:
    places = [({"value": 300, "unit": "mm"}, 0.2), (0.4, 0.7), (0.5, 0.2), (0.5, "pi/5")]
    load = [{"substructure": "acrobot", "placement": {"position": [0, 0, z], "rpy": [0, r, 0]}} for z, r in places]
    sweep = Sweep(CRANE, choices={"load": load})
    found = sweep.rows()
    assert (len(sweep.made), len(found.rows)) == (2, 160)  # pi/5 is no number
    for k in (0, 41, 82, 123):
        slow, condition = sweep.slow(k)
        fast = {name: float(found.columns[name][k]) for name in slow}
        assert not disagreement(fast, slow, condition)
    assert len({float(x) for x in found.columns["x"][::40]}) == 3  # heights do not move it


def test_ranges_do_not_matter() -> None:
    sweep = Sweep(CRANE)
    whole = sweep.rows()
    parts = joined(sweep.plan, [sweep.rows(a, b) for a, b in ((0, 7), (7, 55), (55, 120))], 120)
    assert parts.rows.tolist() == whole.rows.tolist()
    assert all(np.array_equal(parts.columns[name], x) for name, x in whole.columns.items())


def test_frequencies_are_those_of_the_linearisation() -> None:
    takes = ("lowest_frequency", "highest_frequency", "least_damping", "largest_real_part", "is_stable")
    hanging = {"q": [0, -np.pi / 2, 0]}
    columns: dict[str, Any] = {take: {"analysis": "linearisation", "at": hanging, "take": take} for take in takes}
    columns["free"] = {"analysis": "linearisation", "at": REST}
    held = {"held": {"analysis": "linearisation", "at": REST, "held": True, "take": "highest_frequency"}}
    sweep = Sweep(CRANE, columns={name: x for name, x in columns.items() if name != "free"}, where="", choices={})
    found = sweep.rows()
    for row in (0, 5):
        parts = {"rail": shipped_part("linear-rail"), "load": shipped_part("acrobot")}
        linear = linearise(couple(sweep.plan.tree(row), parts), hanging["q"])
        sizes = [mode.frequency for mode in linear.modes]
        assert len(sizes) > 2
        assert found.columns["highest_frequency"][row] == pytest.approx(max(sizes), rel=1e-9)
        assert found.columns["lowest_frequency"][row] == pytest.approx(min(sizes), abs=1e-6)
        assert found.columns["least_damping"][row] == pytest.approx(
            min(m.damping_ratio for m in linear.modes), abs=1e-6
        )
        assert found.columns["is_stable"][row] == ("unstable" not in linear.stability.verdict)
    # what falls has no modes, unless it is held
    falling = Sweep(CRANE, columns=columns, where="", choices={})
    assert not len(falling.rows().rows)
    assert "'free'" in falling.refusals.by_code["not-finite"]["example"]["message"]
    assert len(Sweep(CRANE, columns=held, where="", choices={}).rows().rows) == 40


def test_a_planted_fault_is_found(monkeypatch: pytest.MonkeyPatch) -> None:
    sweep = Sweep(CRANE)
    slow, condition = sweep.slow(3)
    right = {name: float(x[3]) for name, x in sweep.rows().columns.items() if name in slow}
    assert not disagreement(right, slow, condition)
    real = blocks.values_of
    monkeypatch.setattr(blocks, "values_of", lambda some: {n: x * (1 + 1e-9) for n, x in real(some).items()})
    wrong = {name: float(x[3]) for name, x in Sweep(CRANE).rows().columns.items() if name in slow}
    assert "by the tree of this row" in disagreement(wrong, slow, condition)


def test_what_cancels_is_rounding() -> None:
    """A balance with 0.3 kg at 0.7 m and 2.1 kg at 0.1 m, whose moments are 0 in exact numbers alone."""
    other = {"name": "other", "parent": "rod", "joint": {"type": "fixed"}, "mass": "M", "com": ["-L", 0, 0]}
    numbers = {"m": 0.3, "l": 0.7, "M": 2.1, "L": 0.1}
    beam = {**ROD, "parameters": {name: {} for name in (*numbers, "c", "d")}, "bodies": [*ROD["bodies"], other]}
    samples = {
        "method": "list",
        "of": {f"a.{name}": {"values": [x]} for name, x in (numbers | {"c": 0, "d": 0}).items()},
    }
    columns = {"moment": {"quantity": "forces", "of": "a.q", "over": {"q": [0.3]}}}
    sweep = Sweep({"template": SPRUNG["template"], "samples": samples, "columns": columns}, {"rod": beam})
    (moment,), (slow, condition) = sweep.rows().columns["moment"].tolist(), sweep.slow(0)
    assert 0 < abs(moment) < 1e-15
    assert slow == {"moment": 0}
    assert not disagreement({"moment": moment}, slow, condition, (), lambda: sweep.moved(0))
    assert disagreement({"moment": moment + 1e-10}, slow, condition, (), lambda: sweep.moved(0))


def test_the_front_is_kept_first() -> None:
    sweep = Sweep(CRANE, pareto={"minimise": ["mass"], "maximise": ["x"]}, keep=9, choices={})
    kept, every = joined(sweep.plan, [sweep.rows()], 40), Sweep(CRANE, choices={}).rows()
    assert len(kept.rows) == 9
    assert every.columns["mass"].argmin() in kept.rows
    assert every.columns["x"].argmax() in kept.rows


@pytest.mark.parametrize("keep", [1, 2, 3, 5])
def test_ranges_do_not_matter_for_what_is_kept(keep: int) -> None:
    """What is first on the front of a range may be beaten by other ranges."""
    values = {"rail.m": [1, 1.1, 2, 0.5, 0.6, 3], "g": [5, 4.9, 1, 4, 4.5, 3]}
    samples = {"method": "list", "of": {name: {"values": x} for name, x in values.items()}}
    goals = {"pareto": {"minimise": ["m", "a"]}, "columns": {"m": "rail.m + 0", "a": "g + 0"}, "where": ""}
    sweep = Sweep(CRANE, samples=samples, choices={}, keep=keep, **goals)
    for size in (1, 2, 3, 6):
        parts = joined(sweep.plan, [sweep.rows(k, k + size) for k in range(0, 6, size)], 6)
        assert parts.rows.tolist() == sorted([3, 2, 4, 0, 1, 5][:keep])


def test_an_option_without_a_number_leaves_the_others() -> None:
    own = {"rod": {**ROD, "parameters": {**ROD["parameters"], "m": {}}}}
    choices = {"a": ["rod", {"substructure": "rod", "parameters": {"m": 3}}]}
    columns = {"f": {"quantity": "forces", "of": "a.q", "over": {"q": [0]}}}
    sweep = Sweep({"template": SPRUNG["template"], "choices": choices, "columns": columns}, own)
    found = sweep.rows()
    assert (found.rows.tolist(), found.columns["f"]) == ([1], pytest.approx([-3 * 9.81]))
    assert list(sweep.refusals.by_code) == ["missing-value"]


def test_numbers_over_states_have_units() -> None:
    over = {"q": [[0, 0, 0], [0, 1, 0]], "inputs": {"tau.rail.x": {"value": [1, 2], "unit": "kN"}}, "t": [3]}
    column = {"quantity": "forces", "of": "rail.x", "over": over, "take": "largest"}
    assert Sweep(CRANE, columns={"f": column}, where="", choices={}).rows().columns["f"] == pytest.approx([2000] * 40)


def test_columns_are_not_called_as_samples() -> None:
    with pytest.raises(InvalidInput, match="a parameter that varies"):
        Sweep(CRANE, columns={"g": "mass"}, where="").rows()


def test_rows_without_finite_numbers_are_told() -> None:
    sweep = Sweep(CRANE, columns={"mass": "mass", "bad": "sqrt(mass - 4.5)"}, where="", choices={})
    found = sweep.rows()
    bad = sweep.refusals.by_code["not-finite"]
    assert 0 < bad["rows"] == 40 - len(found.rows)
    assert "'bad'" in bad["example"]["message"]


def test_trees_of_rows_have_their_numbers_bound() -> None:
    plan = Sweep(CRANE).plan
    tree = plan.tree(41)
    sample = {name: float(x[0]) for name, x in plan.sampler.rows(1, 2).items()}
    assert tree["instances"][0]["parameters"] == {"m": sample["rail.m"]}
    assert tree["instances"][1]["parameters"] == {"m1": 3}
    assert tree["parameters"]["g"] == {"value": sample["g"], "unit": "m/s^2"}
    for given in ({"value": 981, "unit": "cm/s^2"}, {"value": {"value": 981, "unit": "cm/s^2"}}):
        template = {**CRANE["template"], "parameters": {"g": given}}
        assert Sweep(CRANE, template=template).plan.tree(41)["parameters"] == tree["parameters"]
    assert replace(plan).shown(41) == {"load": "acrobot"}
