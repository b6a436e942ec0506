"""Systems with too many Christoffel symbols to store: all else is there, certified, and agrees with another engine."""

from __future__ import annotations

from dataclasses import replace
from functools import partial
from typing import Any

import numpy as np
import pytest

from substructures import (
    Definition,
    InvalidDocument,
    Model,
    Part,
    TooLarge,
    TreeSpec,
    couple,
    derive,
)
from substructures.analysis.equations.curvature import curvature
from substructures.certificate import part_outputs
from substructures.errors import VerificationFailed
from substructures.expr.program import Program
from substructures.mechanics import formula_size
from substructures.part.derive import recheck
from substructures.quantities.from_parts import NumericTree
from substructures.quantities.numbers.evaluation import evaluate
from substructures.quantities.sources import Sources, steps
from substructures.tree.certificate import certify_tree

pin = pytest.importorskip("pinocchio", reason="Pinocchio is in the test extra (not on Windows)")
from pinocchio_trees import engine_of  # noqa: E402 -- the engine is optional

LARGE = ("christoffel", "kappa", "F", "N")


def chain(count: int, name: str = "chain") -> dict[str, Any]:
    """Revolute joints whose axes turn from body to body; every seventh is prismatic."""
    bodies = []
    for k in range(count):
        kind = "prismatic" if k % 7 == 3 else "revolute"
        bodies.append(
            {
                "name": f"b{k}",
                "parent": f"b{k - 1}" if k else "base",
                "joint": {"type": kind, "coordinate": f"q{k}", "theta": "pi/2" if k % 3 else 0, "d": "1/8"},
                "mass": (k % 5 + 1) * 0.25,
                "com": ["1/16", "1/32", 0],
                "inertia": {"xx": 0.01, "yy": 0.011, "zz": 0.0125, "xy": 0.001},
            }
        )
    end = {"name": "tip", "body": f"b{count - 1}", "position": ["1/8", 0, 0]}
    return {"name": name, "bodies": bodies, "ports": [end]}


@pytest.fixture(scope="module")
def part() -> Part:
    return derive(Definition.read(chain(80)))


@pytest.fixture(scope="module")
def model(part: Part) -> Model:
    return couple(TreeSpec.read(TREE), {"a": part})


TREE = {"name": "t", "gravity": ["0.3", 0, "-9.81"], "instances": [{"name": "a", "substructure": "chain"}]}
GRAVITY = (0.3, 0.0, -9.81)


def states(n: int) -> tuple[Any, Any, Any]:
    q, qd, qdd = np.random.default_rng(5).uniform(-0.5, 0.5, (3, n))
    return q, qd, qdd


# takes seconds: a part of 80 degrees of freedom is derived and certified, once for all tests of this file
def test_all_but_the_christoffel_symbols_is_stored(part: Part, model: Model) -> None:
    assert not set(LARGE) & part.program.outputs.keys()
    assert not part.has_christoffel
    assert "christoffel not stored" in repr(part)
    assert part.certificate["direct_form"]["max_relative_error"].keys() == part.program.outputs.keys()
    again = Part.load(part.definition, part.program.to_bytes(), part.certificate)
    assert recheck(again)["direct_form"] == part.certificate["direct_form"]
    assert "christoffel" not in model.program.outputs
    assert Model.load(model.summary(), model.program.to_bytes()).operations == model.operations


def test_it_agrees_with_another_engine(model: Model) -> None:
    q, qd, qdd = states(80)
    wanted = ["metric", "gravity", "bias", "inverse_dynamics", "forward_dynamics"]
    found = evaluate(model, wanted, q, qd, qdd)
    engine = engine_of(chain(80), GRAVITY).model
    data = engine.createData()
    upper = np.triu(pin.crba(engine, data, q))
    metric = upper + np.triu(upper, 1).T
    bias = pin.nonLinearEffects(engine, data, q, qd).copy()
    weight = pin.computeGeneralizedGravity(engine, data, q).copy()
    needed = pin.rnea(engine, data, q, qd, qdd).copy()
    expected = {"metric": metric, "gravity": -weight, "bias": bias - weight, "inverse_dynamics": needed}
    for name, some in expected.items():
        np.testing.assert_allclose(found[name], some, atol=1e-11 * np.abs(some).max(), err_msg=name)
    np.testing.assert_allclose(metric @ found["forward_dynamics"], -bias, atol=1e-9 * np.abs(bias).max())


def test_numbers_of_the_christoffel_symbols_come_from_the_parts(part: Part, model: Model) -> None:
    """Gamma_abc q'^b q'^c is what the recursion finds without them; symmetries as ever."""
    tree = NumericTree(TreeSpec.read(TREE), {"a": part})
    q, qd, _ = states(80)
    values = dict(zip(tree.coordinates, q, strict=True)) | {
        f"{name}'": x for name, x in zip(tree.coordinates, qd, strict=True)
    }
    found = tree.evaluate(values, ["christoffel", "bias", "metric"])
    gamma = found["christoffel"]
    size = np.abs(found["bias"]).max()
    np.testing.assert_allclose(np.einsum("abc,b,c", gamma, qd, qd), found["bias"], atol=1e-11 * size)
    np.testing.assert_array_equal(gamma, gamma.swapaxes(1, 2))
    expected = evaluate(model, ["bias", "metric"], q, qd)
    np.testing.assert_allclose(found["bias"], expected["bias"], atol=1e-11 * size)
    np.testing.assert_allclose(found["metric"], expected["metric"], atol=1e-11 * np.abs(expected["metric"]).max())


def lower(monkeypatch: pytest.MonkeyPatch, most: int) -> None:
    """Another limit, for the derivation and for its certificate."""
    monkeypatch.setattr(formula_size, "MOST_CHRISTOFFEL", most)
    for name in ("MOST_CHRISTOFFEL", "ONCE_CHRISTOFFEL"):
        monkeypatch.setattr(part_outputs, name, most)


def test_large_parts_couple_with_small_ones(monkeypatch: pytest.MonkeyPatch) -> None:
    """The same numbers as from parts that have all; large on small, small on large, large trees of small parts."""
    tree = {
        "name": "t",
        "gravity": ["0.3", 0, "-9.81"],
        "instances": [
            {"name": "a", "substructure": "one"},
            {"name": "b", "substructure": "two", "at": "a.tip", "placement": {"rpy": ["0.3", "0.1", 0]}},
            {"name": "c", "substructure": "one", "at": "b.b1"},
        ],
    }
    spec = TreeSpec.read(tree)
    definitions = {"one": Definition.read(chain(3, "one")), "two": Definition.read(chain(6, "two"))}
    whole = {name: derive(d) for name, d in definitions.items()}
    q, qd, qdd = states(12)
    wanted = ["metric", "bias", "forces", "inverse_dynamics", "forward_dynamics", "kinetic_energy", "kinematics"]
    complete = couple(spec, {"a": whole["one"], "b": whole["two"], "c": whole["one"]})
    expected = evaluate(complete, [*wanted, "christoffel"], q, qd, qdd)
    lower(monkeypatch, 50)
    lean = {name: derive(d) for name, d in definitions.items()}
    assert [lean[name].has_christoffel for name in ("one", "two")] == [True, False]
    for parts in (lean, whole):
        mounted = {"a": parts["one"], "b": parts["two"], "c": parts["one"]}
        model = couple(spec, mounted)
        assert "christoffel" not in model.program.outputs
        found = evaluate(model, wanted, q, qd, qdd)
        for name in wanted[:-1]:
            np.testing.assert_allclose(found[name], expected[name], rtol=1e-11, atol=1e-12)
        numbers = NumericTree(spec, mounted)
        values = {
            f"{name}{p}": x for p, some in (("", q), ("'", qd)) for name, x in zip(model.coordinates, some, strict=True)
        }
        gamma = numbers.evaluate(values, ["christoffel"])["christoffel"]
        np.testing.assert_allclose(gamma, expected["christoffel"], rtol=1e-11, atol=1e-12)
        batch = {name: np.array([x, 2 * x]) for name, x in values.items()}
        np.testing.assert_allclose(
            numbers.evaluate(batch, ["christoffel"])["christoffel"][0], gamma, rtol=1e-12, atol=1e-13
        )


def test_what_has_to_be_stored_is_not_left_to_the_derivation(monkeypatch: pytest.MonkeyPatch) -> None:
    """A certificate counts for itself: neither less nor more is accepted."""
    definition = Definition.read(chain(6))
    monkeypatch.setattr(formula_size, "MOST_CHRISTOFFEL", 50)
    with pytest.raises(VerificationFailed):
        derive(definition)
    lower(monkeypatch, 50)
    monkeypatch.setattr(formula_size, "MOST_CHRISTOFFEL", 100_000)
    with pytest.raises(VerificationFailed, match="no output that the documents know of"):
        derive(definition)


def test_what_older_versions_stored_is_certified(monkeypatch: pytest.MonkeyPatch) -> None:
    """Of parts and trees that are large today, and were not; their Christoffel symbols are compared like all else."""
    tree = TreeSpec.read({**TREE, "instances": [{"name": "a", "substructure": "one"}]})
    old = derive(Definition.read(chain(6, "one")))
    model = couple(tree, {"a": old})
    monkeypatch.setattr(formula_size, "MOST_CHRISTOFFEL", 50)
    monkeypatch.setattr(part_outputs, "MOST_CHRISTOFFEL", 50)
    tree_again = partial(certify_tree, tree, {"a": old.definition}, model.summary())
    assert "christoffel" in recheck(old)["direct_form"]["max_relative_error"]
    assert "christoffel" in tree_again(model.program)["direct_form"]["max_relative_error"]
    assert "christoffel" not in couple(tree, {"a": old}).program.outputs
    with pytest.raises(VerificationFailed, match="christoffel"):
        recheck(replace(old, program=spoilt(old.program)))
    with pytest.raises(VerificationFailed, match="christoffel"):
        tree_again(spoilt(model.program))


def spoilt(program: Program) -> Program:
    """Two Christoffel symbols have changed places."""
    output = program.outputs["christoffel"]
    first, second, *others = output.entries
    return replace(
        program, outputs={**program.outputs, "christoffel": replace(output, entries=(second, first, *others))}
    )


def test_accelerations_need_no_formulas_of_them(model: Model) -> None:
    """The metric is solved by numbers: its factors would be a million operations."""
    [(_, program, names)] = steps(Sources(model), ["forward_dynamics"])
    assert program is model.program
    assert names == ["metric", "bias", "forces"]


@pytest.mark.parametrize("quantity", ["christoffel", "coriolis"])
def test_what_needs_formulas_of_them_says_so(model: Model, quantity: str) -> None:
    with pytest.raises(InvalidDocument, match=r"more than 23,000 Christoffel symbols no formulas are stored"):
        evaluate(model, quantity, np.zeros(80))
    with pytest.raises(InvalidDocument, match="there is no christoffel"):
        curvature(model)


def test_a_metric_may_be_too_large_as_well(monkeypatch: pytest.MonkeyPatch) -> None:
    """Known by its numbers, before anything is derived."""
    with pytest.raises(TooLarge, match=r"the mechanism \(in elements of its metric\): 11,325; the limit is 10,000"):
        derive(Definition.read(chain(150)))
    one = {"name": "a", "substructure": "chain"}
    spec = TreeSpec.read({**TREE, "instances": [one, {"name": "b", "substructure": "chain", "at": "a.tip"}]})
    half = derive(Definition.read(chain(6)))
    monkeypatch.setattr(formula_size, "MOST_METRIC", 50)
    with pytest.raises(TooLarge, match=r"the tree \(in elements of its metric\): 78"):
        couple(spec, {"a": half, "b": half})
