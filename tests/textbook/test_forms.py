"""Textbook forms are exact, canonical and stable; on all shipped entries and on random formulas."""

from __future__ import annotations

import re
from collections.abc import Mapping
from contextlib import suppress
from fractions import Fraction
from functools import cache
from typing import Any

import flint
import numpy as np
import pytest
from catalogue_entries import all_entries, open_entry
from closed_trees import tree_model
from random_trees import Plain

from substructures import Model, Program, catalogue
from substructures.errors import TooLarge
from substructures.export import render
from substructures.expr.graph import Expr, Graph
from substructures.expr.operations import Symbol
from substructures.expr.parse import parse
from substructures.expr.program import Formulas
from substructures.expr.program import program as collect
from substructures.printers import entries
from substructures.quantities.formulas import derived
from substructures.textbook import AT_ONCE, LIMITS, Sum, Trig, read

from .written_formula import formula

PRECISION = 400
#: what is not read at once, of those asked for here
LARGE = {("kuka-iiwa-14", "metric"), ("kuka-iiwa-14", "christoffel")}
LARGE |= {(name, "christoffel") for name in ("puma560", "humanoid-arm", "humanoid-leg", "free-body")}


@cache
def entry(name: str) -> Model:
    gravity = {"gravity": [0, 0, "-g"], "parameters": {"g": {"value": 9.81, "unit": "m/s^2"}}}
    return tree_model(gravity | {"instances": [{"name": "x", "substructure": name}]}, {name: open_entry(name)})


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


def assert_no_sum_begins_with_a_minus(form: Sum) -> None:
    for factor in (f for t in form.terms for f, _ in t.factors if isinstance(f, Sum)):
        assert factor.terms[0].coefficient > 0
        assert_no_sum_begins_with_a_minus(factor)


def quantity(name: str, output: str) -> Program:
    model = entry(name)
    found = derived(model, output) if output in ("forward_dynamics", "hamiltonian") else model.program
    return found.select([output])


@pytest.mark.parametrize("name", all_entries())
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
            for form in (f for some in forms.values() for f in some):
                assert_no_sum_begins_with_a_minus(form)


@pytest.mark.deep
@pytest.mark.parametrize("name", catalogue.names())
def test_every_shipped_formula_is_equal_to_the_textbook_form_that_is_asked_for(name: str) -> None:
    """With ``form=textbook``, which may take more work than the default; what is refused is refused in seconds."""
    of_model = {"metric", "christoffel", "forces", "gravity", "bias", "nonlinear_effects", "inverse_dynamics"}
    of_model &= set(entry(name).program.outputs)
    for output in sorted(of_model | ({"forward_dynamics", "hamiltonian"} if entry(name).dof else set())):
        program = quantity(name, output)
        with suppress(TooLarge):
            assert_equal(program, read(program, LIMITS).outputs)


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
        ("furuta-pendulum", "forward_dynamics"),
        ("pan-tilt", "forward_dynamics"),
        ("trolley-crane", "bias"),
        ("drill-spindle", "potential_energy"),
        ("flyball-governor", "potential_energy"),
        ("flyball-governor", "metric"),
        ("ur5", "metric"),
        ("flyball-governor", "forces"),
    ],
)
def test_one_function_has_one_form(name: str, output: str) -> None:
    """However it was computed: from shared subexpressions, from sums of products, and from the form itself."""
    program = quantity(name, output)
    # expanded, the square of a root of angles is what is under the root
    is_one_way = output == "forward_dynamics" or (name, output) == ("flyball-governor", "potential_energy")
    forms = ("textbook",) if is_one_way else ("textbook", "expanded")
    for form in forms:
        other = Program.from_bytes(render(program, "json", form).encode())
        assert other.operations != program.operations
        assert lines(other) == lines(program)


@pytest.mark.parametrize(
    ("link", "com", "outputs"),
    [("link4", ["new", 0, "cy4"], ["metric", "gravity"]), ("link5", [0, 0, "new"], ["forces"])],
)
def test_one_more_parameter_changes_only_the_lines_that_it_occurs_in(
    link: str, com: list[str | int], outputs: list[str]
) -> None:
    """A mass centre beside the axis of a link of a Puma; every second line of the compact form changes."""
    definition: Plain = catalogue.load("puma560")
    shifted = definition | {"parameters": definition["parameters"] | {"new": {"value": 0.01, "unit": "m"}}}
    shifted["bodies"] = [b | {"com": com} if b["name"] == link else b for b in definition["bodies"]]
    gravity = {"gravity": [0, 0, "-9.81"], "instances": [{"name": "x", "substructure": "puma"}]}
    old, new = (tree_model(gravity, {"puma": d}).program.select(outputs) for d in (definition, shifted))
    before, after = set(lines(old)), lines(new)
    changed = [line for line in after if line not in before and not re.match(r"[cs]\d+ = ", line)]
    assert changed
    assert all("new" in line for line in changed)
    # with the parameter gone the lines are the old ones
    gone = before - set(after)
    assert len(gone) == len(changed)


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
        ("a*(b + c/d)*cos(q1)", "a*(c/d + b)*cos(q1)"),
        ("1/2*(2*A - C)*sin(q1)", "(A - 1/2*C)*sin(q1)"),
        ("a*(b - c + q3)^2*cos(q2)", "a*(b - c + q3)^2*cos(q2)"),
        ("a*(1 - 2*sin(q1)^2)*cos(q2)", "a*cos(q2)*cos(2*q1)"),
        ("a*q1/3 + a*q1^2/2", "1/3*a*q1 + 1/2*a*q1^2"),
        ("a*q1^3/6 - a*q1", "-a*q1 + 1/6*a*q1^3"),
        ("a*(cos(q1) + 0.3*sin(q1))^2", "a*(cos(q1) + 0.3*sin(q1))^2"),
        ("J*tau_1 + m*l^2*tau_1 - J*b*q1' - m*l^2*b*q1'", "(J + m*l^2)*(tau_1 - b*q1')"),
        ("m*(g*l - l^2*q1'^2)*sin(q2)", "m*g*l*sin(q2) - m*l^2*sin(q2)*q1'^2"),
        (
            "tau/A + m*g*l*sin(q1)/A - C*sin(q1)*q1'*q2'/A - (C/A - 1)*sin(q1)*cos(q1)*q2'^2",
            "(tau + m*g*l*sin(q1) - C*sin(q1)*q1'*q2' + (A - C)*sin(q1)*cos(q1)*q2'^2)/A",
        ),
        ("(a + b)*(c + d) + a*e", "(a + b)*(c + d) + a*e"),
        ("(a + b)*(c + d) + e^2", "(a + b)*(c + d) + e^2"),
        ("(a + b^2)^2 + b^2*c^2", "(a + b^2)^2 + b^2*c^2"),
        ("1 - C/(2*A)", "1 - C/(2*A)"),
        ("m*(e + q1')^2*cos(q2)", "m*cos(q2)*(e + q1')^2"),
        ("(cos(q2)*q1' + sin(q2)*q3')^2*m", "m*(cos(q2)*q1' + sin(q2)*q3')^2"),
        ("a*q3*cos(q1)*cos(q2) + b*cos(q1)", "cos(q1)*(b + a*q3*cos(q2))"),
        ("a*b*cos(q1) + a*e*sin(q1)*cos(q1)", "a*cos(q1)*(b + e*sin(q1))"),
        ("a*cos(q1)*cos(q2) - a*sin(q1)*sin(q3)", "a*(cos(q1)*cos(q2) - sin(q1)*sin(q3))"),
        ("a*b*c*cos(q1) + a*b*e*cos(q2)", "a*b*(c*cos(q1) + e*cos(q2))"),
        # no shorter, or parentheses in parentheses
        ("m*b^2 + m*b*e*cos(q1)", "m*b^2 + m*b*e*cos(q1)"),
        ("e*(a + b)*cos(q1) + a*e*cos(q2)", "e*(a + b)*cos(q1) + a*e*cos(q2)"),
        # sin^2 + sin^2, also in squares of distances
        ("a*(2 - cos(q1)^2 - cos(q2)^2)", "a*(sin(q1)^2 + sin(q2)^2)"),
        ("a*(3 - cos(q1)^2 - cos(q2)^2)", "a*(3 - cos(q1)^2 - cos(q2)^2)"),
        ("J + m*((a + b*sin(q1))^2 + (a + b*sin(q2))^2)", "J + m*((a + b*sin(q1))^2 + (a + b*sin(q2))^2)"),
        ("J + m*(a*sin(q1) - b*sin(q2))^2", "J + m*(a*sin(q1) - b*sin(q2))^2"),
        ("J + m*a^2 + m*(a - b*cos(q1))^2", "J + m*a^2 + m*(a - b*cos(q1))^2"),
        (
            "J + m*(3*a^2/2 + 2*a*b*sin(q1) + b^2*sin(q1)^2)",
            "J + 3/2*m*a^2 + 2*m*a*b*sin(q1) + m*b^2*sin(q1)^2",
        ),
        # springs are squares, where all terms of the square are there
        ("e*q1 + k*q1^2/2 - k*a*q1 + k*a^2/2", "e*q1 + 1/2*k*(q1 - a)^2"),
        ("k*(q1 - q2 - a)^2/2 + k*(q3 - a)^2/2 + e*q3", "e*q3 + 1/2*k*((q1 - a - q2)^2 + (q3 - a)^2)"),
        ("k*(q1 + a - b)^2/2 + e*q1", "e*q1 + 1/2*k*(a - b + q1)^2"),
        ("k*(q1 - 1/4)^2 + e*q1", "e*q1 + k*(q1 - 1/4)^2"),
        ("k*(q1 - sqrt(2)*a)^2/2 + e*q1", "e*q1 + 1/2*k*(q1 - sqrt(2)*a)^2"),
        ("k*(q1 - sqrt(a^2 + b^2))^2/2 + e*q1", "e*q1 + 1/2*k*(q1 - sqrt(a^2 + b^2))^2"),
        ("k*(sqrt(a^2 + q1^2) - 3)^2 + e*q1", "e*q1 + k*(sqrt(a^2 + q1^2) - 3)^2"),
        ("k*(sqrt(a^2 + q1^2) - sqrt(2)*a)^2/2 + e*q1", "e*q1 + 1/2*k*(sqrt(a^2 + q1^2) - sqrt(2)*a)^2"),
        ("k*q1^2/2 - k*a*q1", "-a*k*q1 + 1/2*k*q1^2"),
        ("k*(sqrt(a^2 + q1^2) - b)*q1/sqrt(a^2 + q1^2) + e*q1", "e*q1 + k*q1*(sqrt(a^2 + q1^2) - b)/sqrt(a^2 + q1^2)"),
        ("k*(1 - 3/sqrt(a^2 + q1^2))*q1", "k*q1*(sqrt(a^2 + q1^2) - 3)/sqrt(a^2 + q1^2)"),
        ("e*q1 - 2*a*e*q1/sqrt(c + q3^2)", "e*q1*(sqrt(c + q3^2) - 2*a)/sqrt(c + q3^2)"),
        (
            "e*q1 + b*q2 - a*(e*q1 + 3*b*q2)/sqrt(c + q3^2)",
            "-a*(3*b*q2 + e*q1)/sqrt(c + q3^2) + b*q2 + e*q1",
        ),
        ("e*(b - a/sqrt(c + q1^2))*q1", "-a*e*q1/sqrt(c + q1^2) + b*e*q1"),
        # 1/2 and 1/3 stay where they are
        ("a*b*sin(q1)/2 + a*e*sin(q1)*cos(q2)/3", "a*sin(q1)*(1/2*b + 1/3*e*cos(q2))"),
    ],
)
def test_small_formulas(text: str, expected: str) -> None:
    assert formula(text, I="kg*m^2", J="kg*m^2", m="kg") == expected


@pytest.mark.parametrize(
    "text",
    [
        "(m1 + m2)*e*sin(q1)*cos(q1)*sin(q2)/(b + c)",
        "a*(b + q3)*sin(q1)*cos(q2)/(c + d*sin(q1)^2)",
        "a*sin(q1)*(c + d*cos(q2)^2)/(b + c)",
        "a*(1 - sin(q1)^2*cos(q2)^2)/(b + c)",
        "b - a*(1 - cos(q1)^2*cos(q2)^2)/(b + c)",
        "a*(1 - cos(q1))*(2 + cos(q1))/(b + c)",
    ],
)
def test_quotients_have_factors_as_other_formulas(text: str) -> None:
    """Total masses, atoms, sums of atoms, cosines and sines by their angles; 1 - x^2 for (1 - x)*(1 + x)."""
    assert formula(text, m1="kg", m2="kg") == text


@pytest.mark.parametrize(
    "text",
    [
        "e/((a + b)*(c + d) - b^2*cos(q1)^2)",
        "e/((a + b)*(c + d) - b^2*sin(q1)^2)",
        "e/((a + b)*(c + d + (a + b)*sin(q1)^2) - f^2*cos(q1)^2)",
        "e/((a + b)*(c + d) - (b + d)^2*cos(q1)^2)",
        "e/((a + b)*(c + d)*(c + d*cos(q2)^2) - b^2*d*sin(q1)^2)^2",
        # short as they are, or no product but for one term
        "e/(a + b*sin(q1)^2)",
        "e/(a*b + a*c + b*c + d^2 + c^2*cos(q1)^2*sin(q2)^2)",
    ],
)
def test_determinants_are_products_but_for_one_term(text: str) -> None:
    """As a person leaves them, M11*M22 - M12^2, not multiplied out."""
    assert formula(text) == text


def test_gravity_as_a_number_leaves_accelerations_as_they_are() -> None:
    gravity = {"gravity": [0, 0, "-9.81"], "instances": [{"name": "x", "substructure": "cart"}]}
    model = tree_model(gravity, {"cart": catalogue.load("cart-pendulum")})
    assert lines(derived(model, "forward_dynamics").select(["forward_dynamics"]))[0] == (
        "forward_dynamics[1] = (l0*tau_0 + tau_1*cos(q1) + 9.81*m1*l0*sin(q1)*cos(q1) - m1*l0^2*sin(q1)*q1'^2)"
        "/(l0*(m0 + m1*sin(q1)^2))"
    )


@pytest.mark.parametrize(
    ("name", "output", "part"),
    [
        ("quadruped-leg", "metric[1, 1]", "m3*(0.107388*cos(calf + thigh) + 0.006435*sin(calf + thigh))^2"),
        ("satellite", "metric[6, 6]", "Ixx + 2*mp*(1/3*lp^2 + r^2)"),
        ("satellite", "christoffel[4, 4, 5]", "+ Ixx - 1/6*mp*wp^2 - Izz*cos(roll)^2"),
        ("satellite", "christoffel[4, 4, 5]", "*(sin(left + roll)^2 + sin(right - roll)^2)"),
        ("puma560", "metric[1, 1]", "m6*cz6^2*(1 - (c23*c5 - s23*c4*s5)^2)"),
        ("puma560", "metric[1, 1]", "m3*(cy3 - d3)^2 + (m4 + m5 + m6)*d3^2"),
        ("excavator-arm", "metric[1, 1]", "(Itb + mb*cbx^2 + (mk + ms)*lb^2)*cos(boom)^2"),
        ("quadrotor", "christoffel[4, 4, 5]", "-Ixz*cos(roll)*cos(2*pitch) - Ixy*sin(roll)*cos(2*pitch)"),
        ("ball-pendulum", "bias[1]", " - cos(pitch)*(Ia*cos(2*roll) + 2*(It + m*l^2)*sin(roll)^2)*pitch'*roll'"),
        ("stewart-leg", "metric[1, 1]", "mr*(cr - l0 - extension)^2)*cos(beta)^2"),
    ],
)
def test_parts_of_long_lines(name: str, output: str, part: str) -> None:
    found = dict(line.split(" = ", 1) for line in lines(quantity(name, output.partition("[")[0])))
    assert part in found[output]


@pytest.mark.parametrize("format_", ["text", "latex", "latex-document", "mathml"])
def test_symbols_that_cancel_are_not_listed(format_: str) -> None:
    text = render(quantity("excavator-arm", "metric"), format_, "textbook")
    assert "Iz0" in text
    assert "Ix0" not in text
    assert "Ix0" in render(quantity("excavator-arm", "metric"), "text", "compact")


def test_a_length_that_occurs_often_has_a_name() -> None:
    printed = lines(quantity("flyball-governor", "forces"))
    assert printed[0] == "t1 = sqrt(a^2 + (hv - lift)^2 - 2*a*(hv - lift)*cos(right))"
    assert printed[1] == "t2 = sqrt(a^2 + (hv - lift)^2 - 2*a*(hv - lift)*cos(left))"
    line = "tau_right - mb*g*l*sin(right) - a*kl*(hv - lift)*sin(right)*(t1 - ll)/t1"
    assert f"forces[2] = {line}" in printed
    # formulas that stand alone have no names for their parts
    assert all(
        "t1" not in e["formula"] for e in entries(quantity("flyball-governor", "forces"), "forces", "text", "textbook")
    )


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


def test_what_does_not_fit_is_printed_compact_with_the_reason() -> None:
    program = quantity("kuka-iiwa-14", "metric")
    with pytest.raises(TooLarge):
        render(program, "text", "textbook")
    text = render(program, "text", "readable")
    reason = text.splitlines()[2]
    assert reason.startswith("# compact, since there is no textbook form: the textbook form (in terms")
    assert text.replace(f"{reason}\n", "") == render(program, "text")
    assert render(quantity("scara", "metric"), "text", "readable") == render(
        quantity("scara", "metric"), "text", "textbook"
    )


@pytest.mark.parametrize("taken", [False, True])
def test_abbreviations_leave_the_names_of_symbols_alone(taken: bool) -> None:
    """Where there are many angles, c2 is cos(q2), unless a parameter is called c2."""
    graph = Graph()
    angles = [f"q{n}" for n in range(1, 5)]
    known = {"a": "m", **dict.fromkeys(angles, "rad")} | ({"c2": "m"} if taken else {})
    exprs = [parse(graph, f"a*cos({name})" + "*c2" * taken, graph.symbol) for name in angles]
    symbols = {n: Symbol(n, "coordinate" if n in angles else "parameter", unit) for n, unit in known.items()}
    program = collect(graph, {"f": Formulas((4,), {(k,): e for k, e in enumerate(exprs)})}, symbols)
    text = render(program, "text", "textbook")
    assert ("c2 = cos(q2)\n" in text) is not taken
    assert ("f[2] = a*c2*cos(q2)\n" if taken else "f[2] = a*c2\n") in text
    three = collect(graph, {"f": Formulas((3,), {(k,): e for k, e in enumerate(exprs[:3])})}, symbols)
    assert "f[3] = a*" + "c2*" * taken + "cos(q3)\n" in render(three, "text", "textbook")
