"""Numbers of formulas for people: as they were given, in one way in text, LaTeX and MathML."""

from __future__ import annotations

from decimal import Decimal
from fractions import Fraction

import pytest
from closed_trees import tree_model

from substructures import catalogue
from substructures.export import render
from substructures.expr.bind import bind
from substructures.printers.numbers import shortest_decimal

from .written_formula import formula


def test_decimals() -> None:
    assert shortest_decimal(Fraction("1200.50")) == ("1200.5", 0)
    assert shortest_decimal(Fraction("0.00001230")) == ("1.23", -5)
    assert shortest_decimal(Fraction(1, 7)) is None


@pytest.mark.parametrize(
    "text",
    [
        "(a - 9.81*b*sin(q1))/(c + d)",
        "-(a + 9.81*b - c)/(c + d)",
        "(0.3*a + 0.2*b + 0.7*e)/(c + d)",
        "(2*a + 0.6*b)/(c + d)",
        "(0.5*a + 9.81*b)/(c + d)",
        "(1/3*a + 9.81*b)/(c + d)",
        "(a + 9.81*b)^2/(c + d)",
        "a/(0.3*b + c)",
        "(a - b)/(0.3*c + 0.5*d)",
        "(a - b)/(0.0237*c - 0.019*d)",
        "0.3*(a + b)/(c + d)",
        "9.81*(a + b + 2*e)/(c + d)",
        "2*(a + b)/(c + d)",
        "(2*a + b)/(2*(c + d))",
        "(180*a + b + 900*c)/(180*(a + d))",
        "(8*a + 3*b)/(24*(a + d))",
    ],
)
def test_numbers_of_quotients_are_as_given(text: str) -> None:
    """Not 0.01*(100*a - 981*b*sin(q1)); a number is taken out of a sum where that leaves fewer digits in all."""
    assert formula(text) == text


@pytest.mark.parametrize(
    ("text", "expected"),
    [
        # a number below the line stays a decimal number where it was one
        ("a/0.024222337776", "a/0.024222337776"),
        ("a/(0.024222337776*b)", "a/(0.024222337776*b)"),
        ("a/(0.3*b)", "a/(0.3*b)"),
        ("0.49980*a/(0.34902504*b)", "4.25*a/(2.9679*b)"),
        ("0.05*a/b", "0.05*a/b"),
        # numbers that are not decimal numbers, neither above nor below
        ("5*a/(6*b)", "5*a/(6*b)"),
        ("5000*a/(3*b)", "5000*a/(3*b)"),
        ("20*a/3 + b", "20/3*a + b"),
        ("437/6000*a", "437/6000*a"),
        ("a/7", "1/7*a"),
        # halves beside decimal numbers, in the whole formula
        ("3*a/2 + 0.3*b + c^2/3", "1.5*a + 0.3*b + 1/3*c^2"),
        ("a*(b/2 + 0.7*q1)*cos(q2)", "a*(0.5*b + 0.7*q1)*cos(q2)"),
        ("3*a/2 + b/4", "3/2*a + 1/4*b"),
        # powers of ten
        ("1e-300*a", "1e-300*a"),
        ("1e30*a", "1e30*a"),
        ("-2.5e9*a + b", "-2.5e9*a + b"),
        ("250000*a", "250000*a"),
        # parts of a half turn
        ("a*cos(pi/5)", "a*cos(pi/5)"),
        ("a*cos(q1 + 2*pi/5)", "a*cos(q1 + 2*pi/5)"),
        ("a*sin(q1 + 3*pi/8)", "a*sin(q1 + 3*pi/8)"),
        ("a*cos(q1 + 0.123*pi)", "a*cos(q1 + 0.123*pi)"),
    ],
)
def test_small_formulas_with_numbers(text: str, expected: str) -> None:
    assert formula(text) == expected


@pytest.mark.parametrize("form", ["compact", "expanded", "textbook"])
@pytest.mark.parametrize(
    ("text", "latex", "mathml"),
    [
        ("a/2 + 0.3*b", r"0.5 \, a + 0.3 \, b", "<mn>0.5</mn>"),
        ("a/2 + 3*b/4", r"\frac{1}{2} \, a + \frac{3}{4} \, b", "<mfrac><mn>3</mn><mn>4</mn></mfrac>"),
        ("1e30*a + b", r"10^{30} \, a + b", "<msup><mn>10</mn><mn>30</mn></msup>"),
        ("1e-300*a + b", r"10^{-300} \, a + b", "<mn>300</mn>"),
    ],
)
def test_one_rule_in_all_languages_and_forms(text: str, latex: str, mathml: str, form: str) -> None:
    assert formula(text, "latex", form) == latex
    assert mathml in formula(text, "mathml", form)
    assert formula(formula(text, form=form), form=form) == formula(text, form=form)


def test_defaults_as_decimal_numbers() -> None:
    """Elements of an acrobot's and a SCARA's accelerations: no factors such as 625000 before them, nor 950625/4."""
    for name, output, expected in [
        ("acrobot", "metric", "metric[1, 2] = 0.58 + 0.5*cos(q2)"),
        ("excavator-arm", "metric", "metric[3, 4] = 536.875 + 1413.75*cos(bucket)"),
        ("compound-pendulum", "forces", "forces[1] = tau_q - 5.886*sin(q) - 0.02*q'"),
    ]:
        program = tree_model(
            {"gravity": [0, 0, "-9.81"], "instances": [{"name": "x", "substructure": name}]},
            {name: catalogue.load(name)},
        ).program.select([output])
        given = catalogue.load(name)["parameters"]
        values = {s.name: Decimal(str(given[s.name[2:]]["value"])) for s in program.symbols if s.name[2:] in given}
        assert expected in render(bind(program, values), "text", "textbook").splitlines()
