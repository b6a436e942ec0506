"""Textbook forms end: their work is counted and bounded, and what is found has the values of what was stored."""

from __future__ import annotations

from fractions import Fraction
from functools import cache
from typing import Any

import numpy as np
import pytest
import random_cuts
from in_depth import deep, seeds
from random_trees import Kind, random_definition, with_parameters

from substructures import Definition, Model, Program, TreeSpec, couple, derive
from substructures.errors import TooLarge
from substructures.export import render
from substructures.expr.graph import Graph
from substructures.expr.hoist import hoisted
from substructures.expr.interpret import interpret
from substructures.expr.operations import Symbol
from substructures.expr.program import Formulas, array, program
from substructures.expr.trigonometry import cos, sin
from substructures.printers.textbook import at_once
from substructures.quantities.formulas import DERIVED, derived
from substructures.textbook import LIMITS, Limits, read
from substructures.textbook import reading as textbook_reading
from substructures.textbook.forms import to_expr
from substructures.textbook.work import Work

Plain = dict[str, Any]
#: a tilted gravity, one angle in decimals, and squares of sines of parameters: never ended
TILTED: Plain = {
    "name": "tilted-pair",
    "parameters": {name: {} for name in ("a", "b", "c", "d", "e", "f")},
    "bodies": [
        {"name": "b0", "parent": "base", "mass": 1, "joint": {"type": "revolute", "coordinate": "q0"}},
        {
            "name": "b1",
            "parent": "b0",
            "mass": 1,
            "com": ["a + 0.01*sin(b)^2/2", "c + 0.01*sin(d)^2/2", "e"],
            "joint": {"type": "revolute", "coordinate": "q1", "d": "f", "psi": "-1.8031", "theta": "pi/2"},
        },
    ],
}


@cache
def tilted() -> Model:
    one = {"name": "k", "substructure": "tilted-pair"}
    tree = {"name": "t", "gravity": ["1/2", 0, "-g"], "parameters": {"g": {"value": 9.81}}, "instances": [one]}
    return couple(TreeSpec.read(tree), {"k": derive(Definition.read(TILTED))})


@pytest.mark.parametrize("quantity", ["gravity", "forces", "metric", "bias", "christoffel"])
@pytest.mark.parametrize("format_", ["text", "latex"])
def test_an_angle_in_decimals_has_a_textbook_form(quantity: str, format_: str) -> None:
    some = tilted().program.select([quantity])
    text = render(some, format_, "readable")
    assert "since there is no textbook form" not in text
    assert same_values(some, Limits())
    if quantity == "gravity":
        assert ("cos(q0 - 1.8031)" if format_ == "text" else r"\cos(q_{0} - 1.8031)") in text


def same_values(given: Program, limits: Limits) -> bool:
    """Whether the forms of a program have its values at random states."""
    found, graph = read(given, limits), Graph()
    moved = found.atoms_in(graph)
    formulas = {}
    for name, output in given.outputs.items():
        forms = zip(output.index, found.outputs[name], strict=True)
        formulas[name] = Formulas(output.shape, {i: to_expr(f, graph, moved) for i, f in forms}, output.symmetry)
    other = program(graph, formulas, {s.name: s for s in given.symbols})
    rng = np.random.default_rng(3)
    values = {s.name: rng.uniform(0.3, 1.3, 5) for s in given.symbols}
    old, new = interpret(given, values), interpret(other, values)
    return all(np.allclose(old[name], new[name], rtol=1e-8, atol=1e-8, equal_nan=True) for name in old)


@cache
def random_model(number: int) -> Model:
    rng = np.random.default_rng(7000 + number)
    kind = Kind(bodies=2 + number % 2, loads=1, springs=number % 2, depth=2 + number % 3, massive=True)
    share = (0.2, 0.5, 0.9)[number % 3]
    definition = with_parameters(rng, random_definition(rng, kind), share, odd=bool(number % 4))
    cut = (definition["bodies"][-1]["name"],) if number % 2 else ()
    return random_cuts.coupled(random_cuts.cut_tree(rng, definition, cut))


#: trees of which no quantity has a form within the work that is allowed
WITHOUT = (4, 13)


@pytest.mark.parametrize("number", seeds([0, 1], 28))
def test_forms_of_random_trees_are_bounded_and_right(number: int, monkeypatch: pytest.MonkeyPatch) -> None:
    """About a second of work at most, whatever is asked for: so many units, counted before they are spent."""
    spent: list[Work] = []

    class Watched(Work):
        """Noted."""

        def __init__(self, limit: int) -> None:
            super().__init__(limit)
            spent.append(self)

    monkeypatch.setattr(textbook_reading, "Work", Watched)
    model, found = random_model(number), 0
    programs = {name: hoisted(model.program.select([name])) for name in ("metric", "gravity", "bias", "forces")}
    programs |= {name: derived(model, name) for name in DERIVED if number % 2 == 0 or name == "inverse_dynamics"}
    for each in programs.values():
        try:
            assert same_values(each, at_once(each))
            found += 1
        except TooLarge:
            continue
    assert bool(found) is (number not in WITHOUT)
    assert all(work.spent <= work.limit for work in spent)
    assert max((work.limit for work in spent), default=0) <= 1_000_000


def trigonometric(multiple: Fraction, power: int) -> Program:
    """cos(multiple*x + y)^power times sin(x)."""
    graph = Graph()
    x, y = graph.symbol("x"), graph.symbol("y")
    node = cos(graph.number(multiple) * x + y) ** power * sin(x)
    symbols = {name: Symbol(name, "coordinate", "rad") for name in ("x", "y")}
    return program(graph, {"f": array((), lambda: node)}, symbols)


@pytest.mark.parametrize(
    ("multiple", "power"), [(Fraction(900), 2), *deep((Fraction(18031, 10000), 4), (Fraction(1, 997), 3))]
)
def test_multiples_of_an_angle_are_bounded(multiple: Fraction, power: int) -> None:
    """As in gears with a ratio in decimals: the form that is found is right, or there is none, with the reason."""
    given = trigonometric(multiple, power)
    try:
        assert same_values(given, LIMITS)
    except TooLarge:
        assert "compact, since there is no textbook form: " in render(given, "text", "readable")


def test_the_same_form_has_the_same_work() -> None:
    """Nothing that was found before, and no clock, decides whether there is a form."""
    some = tilted().program.select(["bias"])

    def is_found(limit: int) -> bool:
        work = Limits(LIMITS.terms, limit)
        try:
            return bool(read(some, work).outputs)
        except TooLarge:
            return False

    first = [is_found(limit) for limit in (10, 1000, 100_000)]
    assert [is_found(limit) for limit in (10, 1000, 100_000)] == first


def product_of(*factors: str) -> Program:
    """A product in which constants and rates stand with cosines."""
    graph = Graph()
    symbols = {
        "m": Symbol("m", "parameter", "kg"),
        "q": Symbol("q", "coordinate", "rad"),
        "q'": Symbol("q'", "velocity", "rad/s"),
    }
    found: dict[str, Any] = {name: graph.symbol(name) for name in symbols}
    found |= {"cos 0.3": cos(graph.number(Fraction(3, 10))), "cos q": cos(found["q"]), "sin q": sin(found["q"])}
    node = graph.one
    for factor in factors:
        node = node * found[factor]
    return program(graph, {"f": array((), lambda: node)}, symbols)


@pytest.mark.parametrize(
    ("factors", "latex"),
    [
        (("m", "cos 0.3"), r"m \, \cos 0.3"),
        (("m", "cos 0.3", "q'"), r"m \, \cos(0.3) \, \dot{q}"),
        (("m", "cos q", "q'"), r"m \, \cos(q) \, \dot{q}"),
        (("cos q", "cos q", "q'"), r"\cos^{2}(q) \, \dot{q}"),
        (("m", "sin q", "cos q"), r"m \, \sin q \, \cos q"),
    ],
)
def test_an_argument_ends_where_its_function_does(factors: tuple[str, ...], latex: str) -> None:
    """Without parentheses it does before nothing, or before another function."""
    made = product_of(*factors)
    assert latex in render(made, "latex", "textbook")
    page = render(made, "mathml", "textbook")
    assert ("&#x2061;</mo><mrow><mo>(</mo>" in page) == ("q'" in factors)
    assert ("&#x2061;</mo><mspace" in page) == ("q'" not in factors)
