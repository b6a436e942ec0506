"""Evaluation as a person calls it: names, arrays or columns in, arrays by name out."""

from __future__ import annotations

import numpy as np
import pytest
from analysis_models import catalogue_model

from substructures import InvalidArgument, InvalidInput
from substructures.documents.grouped import take
from substructures.quantities.derivative_directions import Direction
from substructures.quantities.numbers.evaluation import EvaluationOptions, evaluate
from substructures.quantities.numbers.result import Evaluation
from substructures.quantities.quantity import QUANTITIES, needs_parts


def test_one_quantity_by_its_name() -> None:
    model = catalogue_model("planar-2r")
    alone, listed = evaluate(model, "metric", [0.1, 0.2]), evaluate(model, ["metric"], q=[0.1, 0.2])
    assert alone["metric"].shape == (2, 2)
    assert np.array_equal(alone["metric"], listed["metric"])
    with pytest.raises(KeyError):
        alone["forces"]


def test_lists_arrays_and_columns_are_the_same_states() -> None:
    model = catalogue_model("planar-2r")
    q = np.random.default_rng(0).uniform(-1, 1, (4, 2))
    given = [q, q.tolist(), {"x.q1": q[:, 0], "x.q2": q[:, 1].tolist()}]
    found = [evaluate(model, ["metric", "kinematics"], each) for each in given]
    assert found[0].count == 4
    assert found[0].frames == model.frames
    for other in found[1:]:
        assert np.array_equal(other["metric"], found[0]["metric"])
        assert np.array_equal(other["kinematics"]["position"], found[0]["kinematics"]["position"])


def test_numbers_of_one_coordinate_are_states() -> None:
    model = catalogue_model("simple-pendulum")
    rates = evaluate(model, ["kinetic_energy", "inverse_dynamics"], [0.1], [1, 2, 3], [4, 5, 6])
    rows = evaluate(model, ["kinetic_energy", "inverse_dynamics"], [[0.1]] * 3, [[1], [2], [3]], [[4], [5], [6]])
    for name in rows.quantities:
        assert np.array_equal(rates[name], rows[name])


def test_it_is_shown_in_two_lines() -> None:
    found = evaluate(catalogue_model("planar-2r"), ["metric", "momentum"], np.zeros((3, 2)))
    head, shapes = repr(found).split("\n")
    assert head == "Evaluation of 3 state(s) of x.q1, x.q2"
    assert shapes == "  metric (3, 2, 2), momentum.linear (3, 3), momentum.angular (3, 3)"


def test_failures_are_values() -> None:
    """A point mass on a rotating joint has no inertia about it where it lies on the axis."""
    model = catalogue_model("planar-2r")
    found = evaluate(model, "forward_dynamics", [0.0, 0.0], parameters=dict.fromkeys(model.parameters, 0.0))
    assert isinstance(found, Evaluation)
    assert [(f.state, f.quantity, f.code) for f in found.failures] == [(0, "forward_dynamics", "not-finite")]
    assert "1 failures" in repr(found)


@pytest.mark.parametrize(
    ("arguments", "pointer"),
    [
        ({"quantities": "mass"}, "/quantities/0"),
        ({"quantities": ()}, "/quantities"),
        ({"q": [[0, 0], [0, "x"]]}, "/q/1/1"),
        ({"q": None}, "/q"),
        ({"qd": [1, 2, 3]}, "/qd"),
        ({"inputs": {"tau.x.q9": 1}}, "/inputs/tau.x.q9"),
        ({"parameters": {"x.l1": [1, 2]}, "q": np.zeros((3, 2))}, "/parameters/x.l1"),
        ({"quantities": "inverse_dynamics"}, "/qdd"),
        ({"quantities": "forward_dynamics_derivative"}, "/along"),
        ({"quantities": "forward_dynamics_derivative", "along": Direction(qd=[1])}, "/along/qd"),
        ({"quantities": "regressor", "qdd": [0, 0]}, "/quantities"),
    ],
)
def test_what_is_wrong_is_an_argument(arguments: dict[str, object], pointer: str) -> None:
    given = {"quantities": "metric", "q": [0, 0], **arguments}
    options = take(EvaluationOptions, given)
    with pytest.raises(InvalidArgument) as error:
        evaluate(catalogue_model("planar-2r"), **given, options=options)
    assert isinstance(error.value, InvalidInput)
    assert [fault.pointer for fault in error.value.faults] == [pointer]


def test_every_quantity_of_a_tree_has_an_array() -> None:
    model = catalogue_model("planar-2r")
    names = [name for name in QUANTITIES if not needs_parts(name)]
    options = EvaluationOptions(along=Direction(q=[1, 0]))
    found = evaluate(model, names, np.zeros((2, 2)), qdd=np.zeros((2, 2)), options=options)
    assert list(found.quantities) == names
    assert not found.failures
