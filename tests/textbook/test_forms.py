"""Textbook forms are exact, canonical and stable; on all shipped entries and on random formulas."""

from __future__ import annotations

from collections.abc import Mapping
from fractions import Fraction
from functools import cache
from typing import Any

import flint
import numpy as np
import pytest
from closed_trees import tree_model
from random_trees import Plain

from substructures import Model, Program, catalogue
from substructures.errors import TooLarge
from substructures.expr.graph import Expr, Graph
from substructures.expr.operations import Symbol
from substructures.expr.parse import parse
from substructures.expr.program import Formulas
from substructures.expr.program import program as collect
from substructures.printers import entries, render
from substructures.printers.numbers import shortest_decimal
from substructures.quantities.formulas import derived
from substructures.textbook import AT_ONCE, Sum, Trig, read

PRECISION = 400
#: what is not read at once, of those asked for here
LARGE = {("kuka-iiwa-14", "metric"), ("kuka-iiwa-14", "christoffel")}
LARGE |= {(name, "christoffel") for name in ("puma560", "humanoid-arm", "humanoid-leg", "free-body")}


@cache
def entry(name: str) -> Model:
    gravity = {"gravity": [0, 0, "-g"], "parameters": {"g": {"value": 9.81, "unit": "m/s^2"}}}
    return tree_model(gravity | {"instances": [{"name": "x", "substructure": name}]}, {name: catalogue.load(name)})


def operation(op: str, args: list[Any]) -> Any:
    """One operation in balls."""
    if op in ("add", "sub", "mul", "div", "neg"):
        names = {"div": "__truediv__"}
        return getattr(args[0], names.get(op, f"__{op}__"))(*args[1:])
    if op == "abs":
        return abs(args[0])
    if op == "sign":
        return args[0].sgn()
    return flint.arb.atan2(*args) if op == "atan2" else getattr(args[0], op)()


def number(value: Fraction) -> Any:
    return flint.arb(flint.fmpq(value.numerator, value.denominator))


def of_program(program: Program, point: Mapping[str, Any]) -> list[Any]:
    """The values of all operations of a program."""
    values: list[Any] = []
    for op, *rest in program.operations:
        if op == "sym":
            values.append(point[program.symbols[rest[0]].name])
        elif op in ("int", "rat"):
            values.append(number(Fraction(*map(int, rest))))
        elif op == "powi":
            values.append(values[rest[0]] ** rest[1])
        else:
            values.append(operation(op, [values[i] for i in rest]))
    return values


def of_node(node: Expr, point: Mapping[str, Any]) -> Any:
    if node.op == "sym":
        return point[str(node.value)]
    return (
        number(Fraction(node.value)) if node.is_number else operation(node.op, [of_node(a, point) for a in node.args])
    )


def of_form(form: Sum, point: Mapping[str, Any]) -> Any:
    """The value of a textbook form."""
    total = flint.arb(0)
    for term in form.terms:
        product = number(term.coefficient)
        for factor, n in term.factors:
            if isinstance(factor, Sum):
                value = of_form(factor, point)
            elif isinstance(factor, Trig):
                angle = sum((of_node(a, point) * number(c) for a, c in factor.angle), flint.arb(0))
                value = angle.cos() if factor.op == "cos" else angle.sin()
            else:
                value = of_node(factor, point)
            product *= value**n
        total += product
    return total


def assert_equal(program: Program, forms: Mapping[str, Any]) -> None:
    """Every form has the value of its element, to 100 digits, at a random point."""
    rng = np.random.default_rng(len(program))
    with flint.ctx.workprec(PRECISION):
        point = {s.name: number(Fraction(int(rng.integers(100, 900)), 400)) for s in program.symbols}
        values = of_program(program, point)
        for name, output in program.outputs.items():
            for index, i, form in zip(output.index, output.entries, forms[name], strict=True):
                difference = of_form(form, point) - values[i]
                assert difference.contains(0), (name, index)
                assert float(difference.rad()) < 1e-80, (name, index)


def quantity(name: str, output: str) -> Program:
    model = entry(name)
    found = derived(model, output) if output == "forward_dynamics" else model.program
    return found.select([output])


@pytest.mark.parametrize("name", catalogue.names())
def test_every_shipped_formula_is_equal_to_its_textbook_form(name: str) -> None:
    outputs = entry(name).program.outputs
    for output in ("metric", "christoffel", "forces", "gravity", "potential_energy", "position", "forward_dynamics"):
        if output in outputs or (output == "forward_dynamics" and entry(name).dof):
            program = quantity(name, output)
            try:
                forms = read(program, AT_ONCE).outputs
            except TooLarge:
                assert (name, output) in LARGE or output == "forward_dynamics"
                continue
            assert_equal(program, forms)


def lines(program: Program, form: str = "textbook") -> list[str]:
    return [x for x in render(program, "text", form).splitlines() if not x.startswith("#")]


@pytest.mark.parametrize(
    ("name", "output"),
    [
        ("scara", "metric"),
        ("furuta-pendulum", "christoffel"),
        ("planar-3r", "metric"),
        ("spherical-wrist", "metric"),
        ("acrobot", "forward_dynamics"),
        ("trolley-crane", "bias"),
        ("ur5", "metric"),
    ],
)
def test_one_function_has_one_form(name: str, output: str) -> None:
    """However it was computed: from shared subexpressions, from sums of products, and from the form itself."""
    program = quantity(name, output)
    forms = ("textbook",) if output == "forward_dynamics" else ("textbook", "expanded")
    for form in forms:
        other = Program.from_bytes(render(program, "json", form).encode())
        assert other.operations != program.operations
        assert lines(other) == lines(program)


def test_one_more_parameter_changes_only_the_lines_that_it_occurs_in() -> None:
    """A mass centre beside the axis of link 4 of a Puma; every second line of the compact form changes."""
    definition: Plain = catalogue.load("puma560")
    shifted = definition | {"parameters": definition["parameters"] | {"cx4": {"value": 0.01, "unit": "m"}}}
    shifted["bodies"] = [b | {"com": ["cx4", 0, "cy4"]} if b["name"] == "link4" else b for b in definition["bodies"]]
    gravity = {"gravity": [0, 0, "-9.81"], "instances": [{"name": "x", "substructure": "puma"}]}
    names = ["metric", "gravity"]
    old, new = (tree_model(gravity, {"puma": d}).program.select(names) for d in (definition, shifted))
    before, after = set(lines(old)), lines(new)
    changed = [line for line in after if line not in before]
    assert changed
    assert all("cx4" in line for line in changed)
    # with the parameter gone the lines are the old ones
    assert len(after) == len(before)


def formula(text: str, **units: str) -> str:
    """The textbook form of an expression; ``units`` of its parameters, coordinates are q1 ... q9."""
    graph = Graph()
    expr = parse(graph, text, graph.symbol)
    symbols = {
        name: Symbol(name, "coordinate" if name[0] == "q" else "parameter", units.get(name, "m"))
        for name in graph.symbols
    }
    return str(entries(collect(graph, {"f": Formulas((), {(): expr})}, symbols), "f", form="textbook")[0]["formula"])


@pytest.mark.parametrize(
    ("text", "expected"),
    [
        ("1/2*A - 1/2*A*cos(2*q1)", "A*sin(q1)^2"),
        ("1/2*(2*A - C) + 1/2*C", "A"),
        ("0.913 + cos(q1)/2 + cos(q1)/2 + 1", "1.913 + cos(q1)"),
        ("cos(q1)*cos(q2) - sin(q1)*sin(q2)", "cos(q1 + q2)"),
        ("a*sin(q1)*cos(q2) - a*cos(q1)*sin(q2)", "a*sin(q1 - q2)"),
        ("sin(q1)^2/(1 - cos(q1))", "1 + cos(q1)"),
        ("sin(q1)/cos(q1) - tan(q1) + a", "a"),
        ("(a^2 - b^2)/(a + b)", "a - b"),
        ("(cos(q1)*sin(q2) + sin(q1)*cos(q2)*cos(q3))^2", "(cos(q1)*sin(q2) + sin(q1)*cos(q2)*cos(q3))^2"),
        ("(cos(q1) + 2)^3*a/(2 + cos(q1))", "a*(2 + cos(q1))^2"),
        ("a*x + b*x + a*y + b*y", "(a + b)*(x + y)"),
        ("0.00000000000000014675868410114648*a", "1.4675868410114648e-16*a"),
        ("0.00383740004217323332*a", "0.00383740004217323332*a"),
        ("a/3 + b/4", "1/3*a + 1/4*b"),
        ("a/(2*b*sin(q1)^2)", "a/(2*b*sin(q1)^2)"),
        ("sin(q1/2)*cos(q1/2)*a", "1/2*a*sin(q1)"),
        ("sqrt(2)*sqrt(3)*a/sqrt(2)", "sqrt(3)*a"),
        ("cos(q1 + pi/6)*a", "1/2*sqrt(3)*a*cos(q1) - 1/2*a*sin(q1)"),
        ("sqrt(a^2 - 2*a*b + b^2 + (a + b)^2)", "sqrt(2*a^2 + 2*b^2)"),
        ("a/(a + sqrt(b))", "a/(a + sqrt(b))"),
    ],
)
def test_small_formulas(text: str, expected: str) -> None:
    assert formula(text) == expected


def test_masses_are_collected() -> None:
    units = dict.fromkeys(("m1", "m2", "m3"), "kg")
    assert formula("m1*a^2 + m2*a^2 + m2*b^2", **units) == "(m1 + m2)*a^2 + m2*b^2"
    assert formula("m1*a^2 + m1*b^2 + m2*c + m3*c", **units) == "(m2 + m3)*c + m1*(a^2 + b^2)"


@pytest.mark.parametrize("seed", range(30))
def test_random_rational_functions(seed: int) -> None:
    """Sums, products and quotients of random linear combinations of cosines, sines and parameters."""
    rng = np.random.default_rng(seed)
    graph = Graph()
    q, a = ([graph.symbol(f"{name}{n}") for n in range(1, 4)] for name in "qa")
    angles = [q[0], q[1], q[0] + q[1], 2 * q[0], q[2] / 2, q[1] - q[2] + graph.pi / 4]
    exprs = [*a, *(f(graph, op, x) for x in angles for f, op in [(_trig, "cos"), (_trig, "sin")])]
    for _ in range(int(rng.integers(4, 9))):
        x, y = (exprs[int(rng.integers(len(exprs)))] for _ in range(2))
        divides = rng.random() < 0.2 and not y.is_zero
        exprs.append(x / y if divides else x * y if rng.random() < 0.5 else x * int(rng.integers(1, 4)) - y)
    kinds = {s: Symbol(s, "coordinate" if s[0] == "q" else "parameter", "") for s in graph.symbols}
    program = collect(graph, {"f": Formulas((4,), {(k,): e for k, e in enumerate(exprs[-4:])})}, kinds)
    assert_equal(program, read(program).outputs)


def _trig(graph: Graph, op: str, x: Expr) -> Expr:
    return parse(graph, f"{op}(x)", {"x": x}.__getitem__)


def test_decimals() -> None:
    assert shortest_decimal(Fraction("1200.50")) == ("1200.5", 0)
    assert shortest_decimal(Fraction("0.00001230")) == ("1.23", -5)
    assert shortest_decimal(Fraction(1, 7)) is None


def test_what_does_not_fit_is_printed_compact_with_the_reason() -> None:
    program = quantity("kuka-iiwa-14", "metric")
    with pytest.raises(TooLarge):
        render(program, "text", "textbook")
    text = render(program, "text", "readable")
    assert text.splitlines()[1].startswith("# compact, since there is no textbook form: the textbook form (in terms")
    assert text.splitlines()[2:] == render(program, "text").splitlines()[1:]
    assert render(quantity("scara", "metric"), "text", "readable") == render(
        quantity("scara", "metric"), "text", "textbook"
    )


@pytest.mark.parametrize("taken", [False, True])
def test_abbreviations_leave_the_names_of_symbols_alone(taken: bool) -> None:
    """Where many cosines are written, c2 is cos(q2), unless a parameter is called c2."""
    graph = Graph()
    known = {"a": "m", "q2": "rad"} | ({"c2": "m"} if taken else {})
    exprs = [parse(graph, f"a^{n}*cos(q2)" + "*c2" * taken, graph.symbol) for n in range(1, 31)]
    symbols = {n: Symbol(n, "coordinate" if n == "q2" else "parameter", unit) for n, unit in known.items()}
    program = collect(graph, {"f": Formulas((30,), {(k,): e for k, e in enumerate(exprs)})}, symbols)
    text = render(program, "text", "textbook")
    assert ("c2 = cos(q2)\n" in text) is not taken
    assert ("f[3] = a^3*c2*cos(q2)\n" if taken else "f[3] = a^3*c2\n") in text
