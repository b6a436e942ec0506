"""Jobs of the kind evaluate: states as lists, grids and samples give the numbers of one evaluation."""

from __future__ import annotations

import io
from typing import Any

import numpy as np
import pytest

from service.jobs.kinds.states import DRAWS, sample_states
from service.settings import Limits
from substructures.formats.arrays import read_npz
from substructures.formats.arrow import read_tables

from .job_outcomes import evaluated, faults, joined, known_library, outcomes
from .jobs_library import MemoryLibrary


@pytest.fixture(scope="module")
def library() -> MemoryLibrary:
    return known_library()


def test_listed_states_are_split_and_nothing_else_changes(library: MemoryLibrary) -> None:
    q = [[0.1 * k] for k in range(7)]
    request = {
        "quantities": ["metric", "forces"],
        "q": q,
        "qd": [0.5],
        "parameters": {"arm.m": [1.0 + k for k in range(7)]},
        "t": 0,
    }
    made = outcomes(library, "evaluate", {"items": [{"tree": "cell", "request": request}]}, Limits(job_states=3))
    assert [outcome.summary["range"] for outcome in made] == [[0, 3], [3, 6], [6, 7]]
    expected = evaluated(library, "cell", request)
    assert np.array_equal(joined(made, "metric"), expected["metric"])
    assert np.array_equal(joined(made, "forces"), expected["forces"])
    by_name = {**request, "q": {"arm.q": [0.1 * k for k in range(7)]}}
    made = outcomes(library, "evaluate", {"items": [{"tree": "cell", "request": by_name}]}, Limits(job_states=3))
    assert np.array_equal(joined(made, "forces"), expected["forces"])
    # of one coordinate numbers are states, as many as there are, or one for all times
    for flat in ({"q": [0.1 * k for k in range(7)]}, {"q": 0.3, "t": list(range(7))}):
        item = {"tree": "cell", "request": {**request, **flat}}
        made = outcomes(library, "evaluate", {"items": [item]}, Limits(job_states=3))
        assert np.array_equal(joined(made, "forces"), evaluated(library, "cell", {**request, **flat})["forces"])


def test_grids_of_trees_with_ball_joints() -> None:
    """What a grid does not name turns nothing; samples are of coordinates."""
    body = {"name": "b", "parent": "base", "mass": "m", "joint": {"type": "floating"}}
    part = {"name": "free", "parameters": {"m": {}}, "bodies": [body]}
    tree = {"name": "t", "gravity": [0, 0, -9.81], "instances": [{"name": "x", "substructure": "free"}]}
    library, item = MemoryLibrary([part], [tree]), {"tree": "t", "request": {"quantities": ["forces", "kinematics"]}}
    grid = {"x.m": [1, 2], "x.r_b_x": [0, 3], "x.v_b_y'": [5]}
    made = outcomes(library, "evaluate", {"items": [{**item, "grid": grid}]})
    assert joined(made, "forces")[:, 2] == pytest.approx(-9.81 * np.array([1, 1, 2, 2]))
    assert joined(made, "kinematics.position")[:, -1, 0].tolist() == [0, 3, 0, 3]
    refused = faults(library, "evaluate", {"items": [{**item, "sample": {"count": 2}}]})
    assert refused == {("/items/0/sample", "has-balls")}


def test_samples_are_of_the_coordinates_that_are_left() -> None:
    """Not of one whose motion is given: q_1 = pi t."""
    joints = [{"type": "revolute", "coordinate": name, "theta": "pi/2"} for name in ("q1", "q2")]
    bodies = [{"name": f"b{k}", "parent": f"b{k - 1}" if k else "base", "joint": x} for k, x in enumerate(joints)]
    part = {"name": "arm", "bodies": [{**body, "mass": 1, "com": [1, 0, 0]} for body in bodies]}
    tree = {"name": "t", "gravity": [0, 0, 0], "instances": [{"name": "x", "substructure": "arm"}]}
    library = MemoryLibrary([part], [{**tree, "driven": {"x.q1": "pi*t"}}])
    item = {"tree": "t", "request": {"quantities": ["metric"]}, "sample": {"count": 5}}
    made = outcomes(library, "evaluate", {"items": [item]})
    assert joined(made, "metric").shape == (5, 1, 1)


def test_arrow_says_what_npz_says(library: MemoryLibrary) -> None:
    pytest.importorskip("pyarrow")
    item = {
        "tree": "cell",
        "request": {"quantities": ["metric", "forward_dynamics", "kinematics"], "parameters": {"arm.m": [1, 0, 2]}},
        "grid": {"arm.q": [0.1, 0.2, 0.3]},
        "format": "arrow",
    }
    single = {"tree": "cell", "request": {"quantities": ["metric"], "q": [0.3]}, "format": "arrow"}
    both = outcomes(library, "evaluate", {"items": [item, {**item, "format": "npz"}, single]})
    assert [each.summary["media_type"].rpartition("/")[2] for each in both[:2]] == ["vnd.apache.arrow.stream", "x-npz"]
    (table,) = read_tables(io.BytesIO(both[0].files["result"]))
    arrays = read_npz(io.BytesIO(both[1].files["result"]), 2**20)
    assert np.array_equal(table["states.arm.q"], [0.1, 0.2, 0.3])
    for name in ("metric", "kinematics.position", "states.arm.q"):
        assert np.array_equal(table[name], arrays[name])
    assert [failure["state"] for failure in table["failures"]] == list(arrays["failures.state"])
    (row,) = read_tables(io.BytesIO(both[2].files["result"]))
    assert row["metric"].shape == (1, 1, 1)


def test_one_state_is_one_item(library: MemoryLibrary) -> None:
    request = {"quantities": ["metric"], "q": [0.3]}
    (outcome,) = outcomes(library, "evaluate", {"items": [{"tree": "cell", "request": request}]})
    assert read_npz(io.BytesIO(outcome.files["result"]), 2**20)["metric"].shape == (1, 1)


def test_grid_is_every_combination(library: MemoryLibrary) -> None:
    grid = {"arm.q": {"from": -1, "to": 1, "count": 5}, "arm.q'": [0, 2], "arm.m": [1, 3], "tau.arm.q": 7}
    item = {"tree": "cell", "request": {"quantities": ["forces", "kinetic_energy"]}, "grid": grid}
    made = outcomes(library, "evaluate", {"items": [item]}, Limits(job_states=6))
    assert len(made) == 4
    axes = np.meshgrid(np.linspace(-1, 1, 5), [0.0, 2.0], [1.0, 3.0], [7.0], indexing="ij")
    q, rate, mass, torque = (axis.ravel() for axis in axes)
    request = {
        "quantities": ["forces", "kinetic_energy"],
        "q": {"arm.q": q},
        "qd": {"arm.q": rate},
        "parameters": {"arm.m": mass},
        "inputs": {"tau.arm.q": torque},
    }
    expected = evaluated(library, "cell", request)
    assert np.array_equal(joined(made, "forces"), expected["forces"])
    assert np.array_equal(joined(made, "kinetic_energy"), expected["kinetic_energy"])
    assert np.array_equal(joined(made, "states.arm.m"), mass)


def test_sample_does_not_depend_on_how_it_is_split(library: MemoryLibrary) -> None:
    item = {
        "tree": "bounded",
        "request": {"quantities": ["metric"]},
        "sample": {"count": 50, "seed": 3, "ranges": {"p.q'": [1, 2]}},
    }
    whole = outcomes(library, "evaluate", {"items": [item]})
    split = outcomes(library, "evaluate", {"items": [item]}, Limits(job_states=7))
    assert (len(whole), len(split)) == (1, 8)
    for name in ("metric", "states.a.x", "states.p.q", "states.p.q'"):
        assert np.array_equal(joined(whole, name), joined(split, name)), name
    x, angle, rate = (joined(whole, f"states.{name}") for name in ("a.x", "p.q", "p.q'"))
    assert -0.25 <= x.min() < 0.2 < 1.5 < x.max() <= 2  # the joint limits
    assert -np.pi <= angle.min() < -2 < 2 < angle.max() <= np.pi
    assert 1 <= rate.min() < rate.max() <= 2


@pytest.mark.parametrize("columns", [1, DRAWS, DRAWS + 1])
def test_any_part_of_a_sample_can_be_made_alone(columns: int) -> None:
    sample = {"seed": 5, "ranges": {f"x{k}": [0, 1] for k in range(columns)}}
    whole = sample_states(sample, 0, 100)
    part = sample_states(sample, 41, 67)
    assert all(np.array_equal(whole[name][41:67], part[name]) for name in whole)
    everything = np.concatenate(list(whole.values()))
    assert len(np.unique(everything)) == len(everything)


def test_compiled_items_agree_with_interpreted_ones(library: MemoryLibrary) -> None:
    item = {"tree": "bounded", "request": {"quantities": ["metric", "christoffel"]}, "sample": {"count": 3000}}
    compiled = outcomes(library, "evaluate", {"items": [item]})
    interpreted = outcomes(library, "evaluate", {"items": [item]}, Limits(job_states=500))
    for name in ("metric", "christoffel"):
        np.testing.assert_allclose(joined(compiled, name), joined(interpreted, name), rtol=1e-13, atol=1e-13)


def test_state_that_fails_is_listed_and_the_item_goes_on(library: MemoryLibrary) -> None:
    request = {"quantities": ["forces"], "q": [[0.0], [1.0]], "parameters": {"arm.m": [1.0, 1e308], "g": 1e308}}
    (outcome,) = outcomes(library, "evaluate", {"items": [{"tree": "cell", "request": request}]})
    assert outcome.summary["failures"] == 1
    missing = {"quantities": ["forces"], "q": [[0.0]]}
    (outcome,) = outcomes(library, "evaluate", {"items": [{"tree": "free", "request": missing}]})
    assert outcome.problem is not None
    assert outcome.problem["code"] == "missing-value"


def test_what_is_null_is_absent_beside_a_grid(library: MemoryLibrary) -> None:
    request = {"quantities": ["forces"], "inputs": None, "parameters": None, "t": None}
    made = outcomes(library, "evaluate", {"items": [{"tree": "cell", "request": request, "grid": {"arm.q": [0, 1]}}]})
    expected = evaluated(library, "cell", {"quantities": ["forces"], "q": [[0], [1]]})
    assert np.array_equal(joined(made, "forces"), expected["forces"])


def test_what_is_given_for_every_state_of_a_grid_is_split_with_it(library: MemoryLibrary) -> None:
    request = {"quantities": ["inverse_dynamics"], "qdd": [[1], [2], [3]], "parameters": {"arm.m": [1, 2, 3]}}
    item = {"tree": "cell", "request": request, "grid": {"arm.q": [0, 1, 2]}}
    made = outcomes(library, "evaluate", {"items": [item]}, Limits(job_states=2))
    expected = evaluated(library, "cell", {**request, "q": [[0], [1], [2]]})
    assert np.array_equal(joined(made, "inverse_dynamics"), expected["inverse_dynamics"])


@pytest.mark.parametrize("row", [[0.3], {"arm.q": 0.3}])
def test_one_row_of_coordinates_and_many_times_are_many_states(library: MemoryLibrary, row: Any) -> None:
    request = {"quantities": ["metric"], "q": row, "t": [0, 1, 2]}
    made = outcomes(library, "evaluate", {"items": [{"tree": "cell", "request": request}]}, Limits(job_states=2))
    assert [outcome.summary["range"] for outcome in made] == [[0, 2], [2, 3]]
    assert joined(made, "metric").shape == (3, 1, 1)


def test_items_tell_warnings(library: MemoryLibrary) -> None:
    item = {
        "tree": "bounded",
        "request": {"quantities": ["metric"], "parameters": {"p.m": {"value": -500, "unit": "g"}}},
    }
    grid = {"a.x": [0, 1, 3]}
    (made,) = outcomes(library, "evaluate", {"items": [{**item, "grid": grid}]})
    found = [(warning["pointer"], warning["code"]) for warning in made.summary["warnings"]]
    impossible = [("/parameters", "negative-mass"), ("/parameters", "impossible-inertia")]
    assert found == [("/gravity", "gravity-not-given"), *impossible, ("/q", "limits-left")]
    assert list(read_npz(io.BytesIO(made.files["result"]), 2**20)["warnings.code"]) == [code for _, code in found]
    request = {"q": [1.9, 0], "qd": [1, 0], "span": [0, 1]}
    (motion,) = outcomes(library, "simulate", {"items": [{"tree": "bounded", "request": request}]})
    assert [warning["code"] for warning in motion.summary["warnings"]] == ["gravity-not-given", "limits-left"]
