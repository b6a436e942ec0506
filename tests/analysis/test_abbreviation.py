"""Abbreviated formulas: what is proven holds at random states, the criterion is kept, and bad requests are refused."""

from __future__ import annotations

from dataclasses import replace
from fractions import Fraction
from typing import Any

import numpy as np
import pytest
from analysis_models import catalogue_model
from catalogue_entries import shipped_part
from in_depth import seeds
from random_trees import Kind, model_of, number, random_definition

from substructures import InvalidArgument, TooLarge, catalogue, couple, derive
from substructures.abbreviation import abbreviate as module
from substructures.abbreviation.abbreviate import Abbreviation, abbreviate
from substructures.abbreviation.bound import Prover
from substructures.abbreviation.ranges import Interval
from substructures.abbreviation.sums import AngleSums, Differences
from substructures.expr.interpret import interpret
from substructures.part.definition import Definition
from substructures.tree.document import TreeSpec
from substructures.tree.model import Model

RANGES = {"velocities": (-2, 3), "accelerations": (-4, 4)}
KIND = Kind(
    bodies=3, chain=True, joints=("revolute", "revolute", "prismatic"), massive=True, laws=False, loads=0, springs=0
)


def random_model(seed: int) -> tuple[Model, dict[str, Any]]:
    rng = np.random.default_rng(seed)
    model = model_of(random_definition(rng, KIND))
    slides = [name for name, kind in zip(model.coordinates, model.joints, strict=True) if kind == "P"]
    return model, RANGES | {name: (number(rng, -1, 0), number(rng, 0.2, 1)) for name in slides}


def excess(found: Abbreviation, seed: int = 5, count: int = 4000) -> float:
    """The largest error at random states, many of them at ends of ranges, in units of what is proven."""
    rng = np.random.default_rng(seed)
    ends = {name: (float(x.low), float(x.high)) for name, x in found.ranges.items()}
    values = {
        name: np.where(rng.random(count) < 0.5, rng.choice(both, count), rng.uniform(*both, count))
        for name, both in ends.items()
    }
    values["beside"] = np.zeros(count)  # as many states also where nothing varies
    full, short = (interpret(p, values)[found.quantity] for p in (found.full, found.program))
    bounds = np.zeros(full.shape[1:])
    for error in found.errors:
        bounds[error.index] = error.bound
        if full.ndim == 3:
            bounds[error.index[::-1]] = error.bound
    rounding = 1e-12 * np.abs(full).max(initial=0.0) + 1e-300
    return float((np.abs(full - short) / (bounds + rounding)).max())


@pytest.mark.parametrize("quantity", ["inverse_dynamics", "metric", "gravity", "bias", "kinetic_energy"])
@pytest.mark.parametrize("seed", seeds(1, 8))
def test_errors_of_random_mechanisms_are_proven(seed: int, quantity: str) -> None:
    model, ranges = random_model(seed + 1)
    found = abbreviate(model, quantity, 0.05, ranges)
    assert found.operations <= found.operations_before
    assert found.bound <= 0.05
    assert excess(found) <= 1
    for error in found.errors:
        assert error.relative == error.bound / error.attained
        assert error.bound <= sum(part.largest for part in error.neglected) * (1 + 1e-9) or error.others


def test_something_is_left_out_of_a_random_mechanism() -> None:
    model, ranges = random_model(1)
    found = abbreviate(model, "inverse_dynamics", 0.05, ranges)
    assert found.operations < 0.95 * found.operations_before
    # and by much less error nothing would be said: the bounds are those of what was left out
    assert excess(found) > 0.1


def test_a_difference_without_one_of_its_products_is_seen(monkeypatch: pytest.MonkeyPatch) -> None:
    model, ranges = random_model(1)
    right = Differences.of

    def forgetful(self: Differences, other: Any) -> dict[Any, AngleSums]:
        """The largest product of every element counts for nothing."""
        return {i: without_largest(sums) for i, sums in right(self, other).items()}

    def without_largest(sums: AngleSums) -> AngleSums:
        m = int(np.argmax(sums.sizes))
        weights = sums.weights.copy()
        weights[sums.starts[m] : [*sums.starts, len(weights)][m + 1]] = 0
        return replace(sums, weights=weights)

    monkeypatch.setattr(module.Differences, "of", forgetful)
    assert excess(abbreviate(model, "inverse_dynamics", 0.05, ranges)) > 1


@pytest.mark.parametrize(
    ("low", "high", "largest"),
    [("-4", "4", 2**0.5 + 1), ("0", "1/10", np.cos(0.1) + np.sin(0.1) + 1), ("2", "3", abs(np.cos(3) + np.sin(3)) + 1)],
)
def test_bounds_of_known_sums(low: str, high: str, largest: float) -> None:
    one, two = Fraction(1), Fraction(2)
    # |cos q + sin q| + |cos 2p|
    multiples = ((one, 0 * one), (one, 0 * one), (0 * one, two))
    sums = AngleSums(("a", "b"), (0, 2), multiples, np.array([1, -1j, 1]))
    prover = Prover([Interval(Fraction(low), Fraction(high)), Interval(-two, two)])
    found = prover.bound(sums)
    assert largest * (1 - 1e-12) <= found.proven <= 1.05 * largest
    assert prover.bound(sums, largest * 1.02).proven <= 1.02 * largest
    assert prover.bound(sums, largest * 0.9).proven > 0.9 * largest


def test_what_was_given_up_is_no_answer_to_another_question() -> None:
    """|cos q| + |sin q|: 2 by its products alone, the root of 2 by both."""
    sums = AngleSums(("a", "b"), (0, 1), ((Fraction(1),), (Fraction(1),)), np.array([1, -1j]))
    prover = Prover([Interval(Fraction(-3), Fraction(3))])
    assert prover.bound(sums, 0.5).proven == pytest.approx(2)
    assert prover.bound(sums).proven <= 1.05 * np.sqrt(2)


def test_bounds_of_a_sum_that_is_flat_in_the_middle() -> None:
    """1 - cos q, zero with its slope at the centre of the box."""
    sums = AngleSums(("a",), (0,), ((Fraction(0),), (Fraction(1),)), np.array([1, -1 + 0j]))
    found = Prover([Interval(Fraction(-1), Fraction(1))]).bound(sums)
    assert 1 - np.cos(1) <= found.proven <= 1.05 * (1 - np.cos(1))


def test_nothing_is_left_out_where_nothing_may_be() -> None:
    model, ranges = random_model(3)
    found = abbreviate(model, "metric", 0, ranges)
    assert found.program is found.full
    assert found.errors == ()
    pendulum = catalogue_model("simple-pendulum")
    same = abbreviate(pendulum, "inverse_dynamics", 1e-6, RANGES)
    assert same.program.digest == same.full.digest
    assert same.bound == 0


def test_ranges_of_parameters() -> None:
    """m2 of a double pendulum is negligible where it is small, and only there."""
    model = catalogue_model("double-pendulum", m1=1, l1=1, l2=1)
    assert (light := abbreviate(model, "metric", 0.01, {"x.m2": ("1e-7", "1e-5")})).bound <= 0.01
    heavy = abbreviate(model, "metric", 0.01, {"x.m2": (1, 2)})
    assert light.operations < heavy.operations == heavy.operations_before
    assert {s.name for s in heavy.program.symbols} >= {"x.m2"}
    assert excess(light) <= 1


BAD: list[tuple[dict[str, Any], str, str]] = [
    ({"simplify": 1}, "/simplify", "not-in-range"),
    ({"simplify": -0.1}, "/simplify", "not-in-range"),
    ({"simplify": True}, "/simplify", "not-in-range"),
    ({"simplify": float("nan")}, "/simplify", "not-in-range"),
    ({"quantity": "metrik"}, "/quantity", "unknown-quantity"),
    ({"ranges": {}}, "/ranges/x.q1'", "missing"),
    ({"ranges": RANGES | {"x.q9": (0, 1)}}, "/ranges/x.q9", "unknown-name"),
    ({"ranges": RANGES | {"x.q1": (1, 0)}}, "/ranges/x.q1", "empty-range"),
    ({"ranges": RANGES | {"x.q1": ()}}, "/ranges/x.q1", "range-expected"),
    ({"ranges": RANGES | {"x.q1": 3}}, "/ranges/x.q1", "range-expected"),
    ({"ranges": RANGES | {"x.q1": (0, float("inf"))}}, "/ranges/x.q1/1", "number-expected"),
    ({"ranges": RANGES | {"x.q1": (0, "x")}}, "/ranges/x.q1/1", "number-expected"),
    ({"ranges": RANGES | {"x.q1": (0, "exp(800)")}}, "/ranges/x.q1/1", "number-not-finite"),
    ({"ranges": RANGES | {"x.q1": (None, 1)}}, "/ranges/x.q1/0", "number-expected"),
    ({"parameters": {"x.nothing": 1}}, "/parameters/x.nothing", "unknown-parameter"),
    ({"parameters": {"x.m1": 1}, "ranges": RANGES | {"x.m1": (1, 2)}}, "/parameters/x.m1", "twice"),
]


@pytest.mark.parametrize(("changes", "pointer", "code"), BAD)
def test_bad_requests(changes: dict[str, Any], pointer: str, code: str) -> None:
    given = {"quantity": "inverse_dynamics", "simplify": 0.01, "ranges": RANGES} | changes
    with pytest.raises(InvalidArgument) as error:
        abbreviate(catalogue_model("double-pendulum"), **given)
    assert (pointer, code) in [(fault.pointer, fault.code) for fault in error.value.faults]


def test_parameters_without_a_value_need_one() -> None:
    part = shipped_part("double-pendulum")
    tree = {
        "name": "t",
        "gravity": [0, 0, "-g"],
        "parameters": {"g": {}},
        "instances": [{"name": "x", "substructure": "d"}],
    }
    model = couple(TreeSpec.read(tree), {"x": part})
    with pytest.raises(InvalidArgument, match="'g' has no default"):
        abbreviate(model, "gravity", 0.01)
    assert abbreviate(model, "gravity", 0.01, {"g": (9, 10)}).bound <= 0.01
    assert abbreviate(model, "gravity", 0.01, parameters={"g": 9.81}).bound <= 0.01


def test_formulas_that_are_too_large(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(module, "MOST_OPERATIONS", 20)
    with pytest.raises(TooLarge):
        abbreviate(catalogue_model("double-pendulum"), "inverse_dynamics", 0.01, RANGES)


def puma560() -> Model:
    definition = catalogue.load("puma560")
    numbers = {name: each["value"] for name, each in definition["parameters"].items()}
    instance = {"name": "arm", "substructure": "puma560", "parameters": numbers}
    tree = {"name": "p", "gravity": [0, 0, -9.81], "instances": [instance]}
    return couple(TreeSpec.read(tree), {"arm": derive(Definition.read(definition))}, group=True)


@pytest.mark.deep
@pytest.mark.parametrize("most", [(1, 1, 260), (3, 10, 280)])
def test_inverse_dynamics_of_the_puma_560(most: tuple[int, int, int]) -> None:
    """Armstrong, Khatib and Burdick (1986): 305 operations at a criterion of 1 %."""
    v, a, operations = most
    found = abbreviate(puma560(), "inverse_dynamics", 0.01, {"velocities": (-v, v), "accelerations": (-a, a)})
    assert found.operations <= operations < 305
    assert found.bound <= 0.01
    assert excess(found, count=200_000) <= 1


def test_gravity_of_the_puma_560() -> None:
    found = abbreviate(puma560(), "gravity", 0.01)
    assert found.operations < 0.8 * found.operations_before
    assert excess(found) <= 1
