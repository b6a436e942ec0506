"""No equation is false: nothing that is introduced looks like a symbol, in text, LaTeX and MathML."""

from __future__ import annotations

import re
from functools import cache
from typing import Any

import pytest
from closed_trees import tree_parts
from in_depth import deep

from substructures import Program, catalogue, couple
from substructures.export import render
from substructures.expr.graph import Graph
from substructures.expr.hoist import hoisted
from substructures.expr.operations import Symbol
from substructures.expr.parse import parse
from substructures.expr.program import Formulas
from substructures.expr.program import program as collect
from substructures.printers.mathml_names import named
from substructures.printers.names import latex_names, short_names
from substructures.quantities.formulas import DERIVED, derived
from substructures.tree.glossary import glossary

FORMATS = ("text", "latex", "latex-document", "mathml")


def lefts(text: str, format_: str) -> list[str]:
    """The left sides of all equations."""
    if format_ == "text":
        return [line.partition(" = ")[0] for line in text.splitlines() if " = " in line]
    if format_ == "mathml":
        return re.findall(r"<p><math[^>]*><mrow>(.*?)<mo>=</mo>", text)
    return [line.partition(" &= ")[0] for line in text.splitlines() if " &= " in line]


def plain(written: str) -> str:
    """Without fonts and groups, which readers do not see."""
    return re.sub(r"\\math(rm|it)|[{}]|</?m(i|n|o|row)( [^>]*)?>", "", written)


def double_names(text: str, program: Program, format_: str) -> set[str]:
    """Left sides that look like a symbol, or that occur twice."""
    short = short_names(program.symbols)
    if format_ != "text":
        short = latex_names(short)
        short = [named(name) for name in short] if format_ == "mathml" else short
    found = [plain(left) for left in lefts(text, format_)]
    assert found
    return {left for left in found if found.count(left) > 1 or left in {plain(name) for name in short}}


@cache
def formula_and_glossary(name: str, quantity: str) -> tuple[Program, Any]:
    tree = {"name": "t", "gravity": [0, 0, -9.81], "instances": [{"name": "arm", "substructure": name}]}
    spec, parts = tree_parts(tree, {name: catalogue.load(name)})
    model = couple(spec, parts)
    program = (derived(model, quantity) if quantity in DERIVED else model.program).select([quantity])
    return program, glossary(spec, parts, model=model.program)


@pytest.mark.parametrize("name", ["puma560", "scara", *deep("kuka-iiwa-14")])
@pytest.mark.parametrize("format_", FORMATS)
@pytest.mark.parametrize("quantity", ["metric", "inverse_dynamics", "forward_dynamics"])
def test_no_step_looks_like_a_symbol(name: str, format_: str, quantity: str) -> None:
    """Puma has a mass m6, written m_{6}, as the mass of what joint 6 carries would be."""
    program, words = formula_and_glossary(name, quantity)
    text = render(hoisted(program), format_, "compact", glossary=words)
    assert not double_names(text, program, format_)
    if quantity == "metric" and name == "puma560" and format_ != "text":
        written = "<mover><mi>m</mi><mo>&#xAF;</mo></mover>" if format_ == "mathml" else r"\bar{m}_{5} &= "
        assert written in text
        assert "m with a bar: mass of what a joint carries" in text


def of_formula(formula: str, kinds: dict[str, str]) -> Program:
    graph = Graph()
    formulas = {"f": Formulas((), {(): parse(graph, formula, graph.symbol)})}
    return collect(graph, formulas, {name: Symbol(name, kind) for name, kind in kinds.items()})


@pytest.mark.parametrize("format_", FORMATS)
@pytest.mark.parametrize(("length", "is_free"), [("c_2", False), ("c2", False), ("c_02", True), ("b2", True)])
def test_no_abbreviation_looks_like_a_symbol(format_: str, length: str, is_free: bool) -> None:
    """Four angles make c2 of cos(q2); a parameter c_2 is written c_{2}, as this would be."""
    formula = f"a*{length}*cos(q2) + sin(q1)*sin(q3 + q4)"
    kinds = {"a": "parameter", length: "parameter"} | {f"q{k}": "coordinate" for k in range(1, 5)}
    program = of_formula(formula, kinds)
    text = render(program, format_, "textbook")
    assert not double_names(text, program, format_)
    is_abbreviated = len(lefts(text, format_)) > 1
    assert is_abbreviated == (is_free or (format_ == "text" and length == "c_2"))


@pytest.mark.parametrize("format_", ["latex", "mathml"])
def test_no_element_of_a_result_looks_like_a_symbol(format_: str) -> None:
    graph = Graph()
    metric = {(0, 0): graph.symbol("g11") * 2, (1, 1): graph.symbol("E") + 1}
    formulas = {
        "metric": Formulas((2, 2), metric, "symmetric"),
        "forces": Formulas((2,), {(0,): graph.symbol("Q_1") + 1}),
        "energy": Formulas((), {(): graph.symbol("E") * 3}),
        "coriolis": Formulas((2, 2), {(0, 0): graph.symbol("E") * 4}),
    }
    program = collect(graph, formulas, {name: Symbol(name, "parameter") for name in ("g11", "Q_1", "E")})
    text = render(program, format_, "compact")
    assert not double_names(text, program, format_)
    assert {"latex": "C_{11} &=", "mathml": "<msub><mi>C</mi>"}[format_] in text, "nothing else looks like it"


def tree_of(*names: str) -> tuple[Program, Program]:
    """Metric and glossary of parts beside each other."""
    instances = [{"name": f"x{k}", "substructure": name} for k, name in enumerate(names)]
    spec, parts = tree_parts(
        {"name": "t", "gravity": [0, 0, -9.81], "instances": instances}, {n: catalogue.load(n) for n in names}
    )
    model = couple(spec, parts)
    return model.program.select(["metric", "forces"]), glossary(spec, parts, model=model.program)


def test_instances_are_named_where_they_distinguish() -> None:
    one, _ = tree_of("scara")
    for form in ("textbook", "compact", "expanded", "readable"):
        text = render(one, "text", form)
        assert "# all names but those of the tree are of instance x0" in text
        assert "x0." not in text
        assert "tau_3" in text
    two, _ = tree_of("simple-pendulum", "double-pendulum")
    text = render(two, "text", "compact")
    assert "x0.q1" in text
    assert "x1.q1" in text
    # of several instances all names are in full: a reader of one formula does not know what is in the others
    clear, names = tree_of("humanoid-head", "scara")
    text = render(clear, "text", "compact", glossary=names)
    assert "# x1.q2 is coordinate [rad]" in text
    assert "tau.x1.q1" in text


def test_a_parameter_of_the_tree_is_not_that_of_the_instance() -> None:
    """The formula has arm.m, which is m in short; what joint 1 carries is a sum of parameters of the tree."""
    graph = Graph()
    known = {name: Symbol(name, "parameter") for name in ("m", "b", "arm.m", "arm.b", "arm.x")}
    inner, x = graph.symbol("arm.m") + graph.symbol("arm.b"), graph.symbol("arm.x")
    value = inner
    for k in range(40):
        value = value * x + inner * k
    program = collect(graph, {"f": Formulas((), {(): value})}, known)
    for owner, is_named in (("", False), ("arm.", True)):
        carried = graph.symbol(f"{owner}m") + graph.symbol(f"{owner}b")
        names = collect(graph, {"m 1": Formulas((), {(): carried})}, known)
        assert ("m_1 = m + b" in render(program, "text", "compact", glossary=names)) == is_named
