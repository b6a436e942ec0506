"""The reduced level of instances: planted faults, what is told, and what is refused."""

from __future__ import annotations

import json
import math
import re
from dataclasses import replace
from fractions import Fraction
from typing import Any

import numpy as np
import pytest
from closed_trees import tree_model, tree_parts
from mechanics.reduced_parts import BENNETT, WISHBONE, Plain

from substructures import (
    Definition,
    InvalidInput,
    TreeSpec,
    catalogue,
    couple,
    derive,
    evaluate,
    sensitivities,
    simulate,
)
from substructures.errors import VerificationFailed
from substructures.expr.graph import Graph
from substructures.expr.interpret import interpret
from substructures.expr.operations import Symbol
from substructures.expr.program import array, program
from substructures.expr.walk import transfer
from substructures.quantities import reactions as module
from substructures.quantities.reactions import reactions
from substructures.tree.certificate import certify_tree
from substructures.tree.given.loops import newton, reduction
from substructures.tree.given.loops.dependent import Dependent
from substructures.tree.shape import shape_digest

from .test_reduced_level import NAMES, STAY, between_arms

EDGE: Plain = {"name": "edge", "type": "knife_edge", "frame": "hand.tip"}


def test_planted_faults_are_found(monkeypatch: pytest.MonkeyPatch) -> None:
    """Another branch than that of the start; a wrong second derivative; a level that the documents do not say."""
    definition, tree = NAMES["rod"], {"name": "t", "instances": [{"name": "x", "substructure": "rod"}]}
    part = derive(Definition.read(definition))
    spec, right = TreeSpec.read(tree), reduction.dependent(part)
    assert isinstance(right, Dependent)
    model = couple(spec, {"x": part})
    full = TreeSpec.read({"name": "t", "instances": [{"name": "x", "substructure": "rod", "level": "full"}]})
    with pytest.raises(VerificationFailed, match="reduced"):
        certify_tree(full, {"x": part.definition}, model.described(), model.program)
    bend = {q: {at: x * 2 for at, x in row.items()} for q, row in right.H.items()}
    mirrored = reduction._Solver(part)
    mirrored._gap = lambda found: -reduction._Solver._gap(mirrored, found)  # type: ignore[method-assign]
    for wrong, told in ((replace(right, H=bend), "christoffel"), (mirrored.solve(), "branch")):
        with monkeypatch.context() as patch:
            patch.setattr("substructures.tree.reading.dependent", lambda _, wrong=wrong: wrong)
            with pytest.raises(VerificationFailed, match=told):
                couple(spec, {"x": part})


def test_faults_in_forces_of_loops_are_found(monkeypatch: pytest.MonkeyPatch) -> None:
    """Beside a closure and an edge of the tree, of which the loop's own forces depend."""
    tree = tree_parts(*between_arms("rod", closures=[STAY], velocity_constraints=[EDGE]))
    found = reactions(*tree)
    assert {"lambda.stay.length", "lambda.edge"} <= {s.name for s in found.program.symbols}
    assert not any(s.name.startswith("lambda.x.") for s in found.program.symbols)
    right = module.loop_multipliers
    for name in ("lambda.stay.length", "lambda.edge", "x.r"):

        def wrong(known: Dependent, *given: Any, name: str = name) -> Any:
            """What does not know one of them."""
            more = {name: known.graph.zero}
            made = right(known, *given)
            return dict(zip(made, transfer(made.values(), known.graph, more), strict=True))

        with monkeypatch.context() as patch:
            patch.setattr(module, "loop_multipliers", wrong)
            with pytest.raises(VerificationFailed, match="reaction"):
                reactions(*tree)


def test_shapes_tell_levels_and_branches_apart() -> None:
    """Programs that were kept for trees with all coordinates are not those of the reduced level; nor are those of other
    independent coordinates, and of angles about another start."""
    others: tuple[Plain, ...] = (
        {},
        {"independent": ["psi"]},
        {"start": {"phi": "1", "psi": "-0.6", "chi": "-1.5"}},
        {"start": {"phi": "1", "psi": "-0.5", "chi": "1.4"}},
        {"start": {"phi": "1", "psi": "5.6", "chi": "1.5"}},
    )
    specs = [
        tree_parts(
            {"instances": [{"name": "x", "substructure": "bar"} | level]},
            {"bar": {**NAMES["crank-rocker"], "name": "bar", **each}},
        )
        for level, each in (({"level": "full"}, {}), *(({}, each) for each in others))
    ]
    assert len({shape_digest(*spec) for spec in specs}) == 6


def test_what_is_outside_of_a_loop_is_told() -> None:
    """A range that is left, a position that cannot be closed, a motion into a dead centre: coordinate and closure."""
    narrow = {**NAMES["slider-pin"], "name": "narrow", "ranges": {"phi": ["-0.3", "0.5"]}}
    model = tree_model({"instances": [{"name": "x", "substructure": "narrow"}]}, {"narrow": narrow})
    found = evaluate(model, ["metric", "forward_dynamics"], [1.4], parameters={"x.l": 0.2})
    assert {(f.quantity, f.state) for f in found.failures} == {("metric", 0), ("forward_dynamics", 0)}
    assert all("'x.loop' at 'x.phi'" in f.message for f in found.failures)
    assert [w["code"] for w in found.warnings] == ["gravity-not-given", "range-left"]
    motion = simulate(model, [0.1], (0, 1), qd=[9.0], parameters={"x.l": 0.2})
    assert not motion.is_right
    assert {"range-left", "loop-singular"} <= {w["code"] for w in motion.warnings}
    # not even at the start: SciPy makes steps without end there
    assert sensitivities(model, [1.4], (0, 1), ["x.r"], parameters={"x.l": 0.2}).status == "failed"
    with pytest.raises(InvalidInput, match=r"depends on 'x\.phi'"):
        evaluate(model, "metric", {"x.phi": 0.1, "x.x": 1.0})


@pytest.mark.parametrize(
    ("entry", "level", "code", "told"),
    [
        ("andrews-squeezer", "reduced", "not-reduced", "names no independent"),
        ("simple-pendulum", "reduced", "not-reduced", "names no independent"),
        ("five-bar", "half", "literal-error", "'full' or 'reduced'"),
    ],
)
def test_levels_that_there_are_not(entry: str, level: str, code: str, told: str) -> None:
    with pytest.raises(InvalidInput, match=told) as raised:
        tree_model(
            {"instances": [{"name": "x", "substructure": entry, "level": level}]}, {entry: catalogue.load(entry)}
        )
    assert [(fault.pointer, fault.code) for fault in raised.value.faults] == [("/instances/0/level", code)]


def test_what_does_not_take_it_says_so() -> None:
    """Loops in space keep their closures without ranges, and say why; so do two positions that are as near."""
    wide = {x: value for x, value in catalogue.load("delta-robot").items() if x != "ranges"}
    delta = tree_model({"instances": [{"name": "x", "substructure": "delta-robot"}]}, {"delta-robot": wide})
    warnings = delta.certificate["warnings"]
    assert [w["code"] for w in warnings] == ["full-level", "gravity-not-given"]
    assert "the closure 'bars1': of the coordinates around it 3 are unknown" in warnings[0]["message"]
    assert "'ranges'" in warnings[0]["message"]
    assert len(delta.closures) == 3
    some = {**wide, "ranges": {"q1": [0, "0.1"], "q2": [0, "0.1"]}}
    assert "'q3', which has no 'ranges'" in str(reduction.dependent(derive(Definition.read(some))))
    even = {**NAMES["crank-rocker"], "name": "even", "start": {}}
    told = tree_model({"instances": [{"name": "x", "substructure": "even"}]}, {"even": even}).certificate["warnings"]
    assert "two positions are as near" in told[0]["message"]


@pytest.mark.parametrize(
    ("change", "told"),
    [
        ({"ranges": {"lower": ["-2", "0.4"]}}, r"open, or beyond a dead centre, at lower = -0\.\d+"),
        ({"start": {"lower": "0", "upper": "2", "c": "2"}}, "open, or beyond a dead centre, at lower ="),
        ({"closures": [{**WISHBONE["closures"][0], "type": "planar"}]}, "does not tell the coordinates"),
    ],
)
def test_steps_that_lead_nowhere_are_told(change: Plain, told: str) -> None:
    part = derive(Definition.read({**WISHBONE, **change}))
    assert re.search(told, str(reduction.dependent(part)))


def test_faults_of_steps_are_found(monkeypatch: pytest.MonkeyPatch) -> None:
    """Too few of them; another rod; a wrong second derivative; no number anywhere."""
    part, spec = derive(Definition.read(WISHBONE)), {"instances": [{"name": "x", "substructure": "wishbone"}]}
    right = reduction.dependent(part)
    assert isinstance(right, Dependent)
    bend = {q: {at: x * 2 for at, x in row.items()} for q, row in right.H.items()}
    with monkeypatch.context() as patch:
        patch.setattr(newton, "LAST", 0)
        patch.setattr(newton, "SAME", 1.0)
        patch.setattr(newton, "OPEN", 1)
        early = reduction._Solver(part).solve()
    other = {**WISHBONE, "closures": [WISHBONE["closures"][0], {**WISHBONE["closures"][1], "length": "0.33"}]}
    longer = reduction._Solver(derive(Definition.read(other))).solve()
    gone = right.graph.function("asin", right.graph.symbol("l") + 2)
    nowhere = replace(right, values={q: x + gone for q, x in right.values.items()})
    for wrong in (early, longer, replace(right, H=bend), nowhere):
        with monkeypatch.context() as patch:
            patch.setattr("substructures.tree.reading.dependent", lambda _, wrong=wrong: wrong)
            with pytest.raises(VerificationFailed, match=r"by the documents|branch"):
                couple({"name": "t", **spec}, {"x": part})


def test_steps_have_no_number_where_they_lead_elsewhere() -> None:
    """Of cos z = y: at roots of the other slope, at places without a root, and where angles turn round."""
    graph, y = Graph(), np.linspace(-0.9, 2, 59)
    row = graph.function("cos", graph.symbol("z")) - graph.symbol("y")

    def found(z: str, at: str, angles: frozenset[str]) -> Any:
        start = {"z": graph.number(Fraction(z)), "y": graph.number(Fraction(at))}
        loop = newton.Newton(graph, newton.Rows((row,), (graph.one,)), ("z",), ("y",), start, angles)
        made = {"z": array((1,), lambda _: loop.values(1, [0])["z"])}
        return interpret(program(graph, made, {"y": Symbol("y", "parameter", "")}), {"y": y})["z"][:, 0]

    places = found("-0.5", "0.8776", frozenset())
    there = np.isfinite(places)
    np.testing.assert_allclose(np.cos(places[there]), y[there], rtol=0, atol=1e-12)
    assert (np.sin(places[there]) < 0).all()
    assert there[y <= 1].any()
    assert not there[y > 1].any()
    assert (np.abs(found("-0.1", "0.995", frozenset())) > 4).any()
    assert not (np.abs(found("-0.1", "0.995", frozenset({"z"}))) > 4).any()


@pytest.mark.parametrize("ends", [("end", "tip"), ("end", "coupler"), ("end", "end")])
def test_closures_that_tell_nothing_are_told(ends: tuple[str, str]) -> None:
    """Once more the same one, and within one body."""
    own = {"name": "again", "type": "pin", "from": ends[0], "to": ends[1]}
    bar = {**NAMES["crank-rocker"], "ranges": {"phi": ["-0.5", "1.5"]}}
    part = derive(Definition.read({**bar, "closures": [*bar["closures"], own]}))
    assert reduction.dependent(part) == "the closure 'again': of the coordinates around it 0 are unknown"


def test_rows_that_meet_by_rounding_are_told() -> None:
    """A linkage with more rows than unknown coordinates exists by formulas of its lengths, not by their decimals."""
    text = json.dumps(BENNETT).replace("asin(b*sin(alpha)/a)", repr(math.asin(0.55 * math.sin(0.7) / 0.4)))
    assert "to the digits of numbers" in str(reduction.dependent(derive(Definition.read(json.loads(text)))))
