"""What is printed for people: MathML that is what its schema allows, and documents that LaTeX compiles."""

from __future__ import annotations

import re
import shutil
import subprocess
import xml.etree.ElementTree as ElementTree
from pathlib import Path

import pytest
from closed_trees import tree_model

from substructures import Model, Program, catalogue
from substructures.analysis.equations.curvature import curvature
from substructures.analysis.equations.first_integrals import first_integrals
from substructures.export import render
from substructures.expr.graph import Graph
from substructures.expr.operations import Symbol
from substructures.expr.parse import parse
from substructures.expr.program import Formulas
from substructures.expr.program import program as collect
from substructures.printers import entries
from substructures.printers.mathml_names import named
from substructures.printers.names import latex_names
from substructures.printers.pages import BREAK, CLOSING, LINE, OPENING, broken, width
from substructures.quantities.formulas import derived

MATH = "{http://www.w3.org/1998/Math/MathML}"
#: number of children in MathML Core, section 3; others have any number
CHILDREN = {"mfrac": 2, "msubsup": 3, "msub": 2, "msup": 2, "mover": 2, "mspace": 0}
#: hold text, nothing else
TOKENS = {"mi", "mn", "mo", "mtext"}


def model(name: str) -> Model:
    gravity = {"gravity": [0, 0, "-g"], "parameters": {"g": {"value": 9.81, "unit": "m/s^2"}}}
    whole = gravity | {"instances": [{"name": "x", "substructure": name}]}
    return tree_model(whole, {name: catalogue.load(name)})


def program(name: str, *outputs: str) -> Program:
    return model(name).program.select(outputs)


def math_of(text: str) -> list[ElementTree.Element]:
    root = ElementTree.fromstring(text.encode())  # noqa: S314 -- our own
    return [e for e in root.iter() if e.tag.split("}")[1] == "math"]


@pytest.mark.parametrize("form", ["textbook", "compact", "expanded"])
@pytest.mark.parametrize("name", ["scara", "furuta-pendulum", "satellite", "quarter-car"])
def test_mathml_is_what_its_schema_allows(name: str, form: str) -> None:
    found = math_of(render(program(name, "metric", "christoffel", "forces"), "mathml", form))
    assert len(found) > 5
    for math in found:
        for element in math.iter():
            assert element.tag.startswith(MATH)
            tag, children = element.tag.removeprefix(MATH), list(element)
            assert tag in {"math", "mrow", "msqrt", *CHILDREN, *TOKENS}
            assert len(children) == CHILDREN.get(tag, len(children))
            assert (tag in TOKENS) == bool(element.text)
            assert not (children and tag in TOKENS)
            assert not (element.tail or "").strip()


def read_back(element: ElementTree.Element) -> str:
    """Presentation MathML as text."""
    tag, parts = element.tag.removeprefix(MATH), [read_back(e) for e in element]
    if tag == "mfrac":
        return f"({parts[0]})/({parts[1]})"
    if tag in ("msub", "msup"):
        return parts[0] + ("^" if tag == "msup" else "") + parts[1]
    own = (element.text or "") if tag in TOKENS else ""
    return {"\u2062": "*", "\u2061": " ", "\u2212": "-", "\u00b7": "*", "\u02d9": "."}.get(own, own) + "".join(parts)


def test_terms_of_mathml_are_those_of_the_text() -> None:
    text = render(program("furuta-pendulum", "metric"), "mathml", "textbook")
    paragraphs = re.findall(r"<p>(<math.*?)</p>", text, re.DOTALL)
    terms = [[read_back(m) for m in math_of(f"<html xmlns='x'>{p}</html>")] for p in paragraphs]
    assert terms[0] == ["g11=J1", "+m1*l1^2", "+m2*L1^2", "+(J2+m2*l2^2)*sin^2 q2"]
    assert terms[1] == ["g12=m2*L1*l2*cos q2"]


def formulas_of(page: str) -> list[str]:
    """The paragraphs of formulas, as text."""
    paragraphs = re.findall(r"<p>(<math.*?)</p>", page, re.DOTALL)
    return ["".join(read_back(m) for m in math_of(f"<html xmlns='x'>{p}</html>")) for p in paragraphs]


def test_wide_fractions_wrap() -> None:
    """Every term of a wide numerator is a formula of its own, behind one over the denominator, which has a name."""
    page = render(derived(model("acrobot"), "forward_dynamics").select(["forward_dynamics"]), "mathml", "textbook")
    assert max(sum(1 for e in m.iter() if e.text) for m in math_of(page)) < 120
    determinant, first, second = formulas_of(page)
    assert determinant == "t1=(Ic2+m2*lc2^2)*(Ic1+m1*lc1^2+m2*l1^2)-m2^2*l1^2*lc2^2*cos^2 q2"
    assert first.startswith("q..1=(1)/(t1)*((Ic2+m2*lc2^2)*(")
    assert first.endswith("*q.1^2))")
    assert second.startswith("q..2=(1)/(t1)*(")


@pytest.mark.parametrize(("count", "power", "divisor"), [(40, "", "t1"), (6, "^2", "t1^2")])
def test_wide_factors_and_denominators_wrap(count: int, power: str, divisor: str) -> None:
    above, below = (" + ".join(f"{x}{n}*y{n}" for n in range(size)) for x, size in (("a", 40), ("b", count)))
    graph = Graph()
    formulas = {"f": Formulas((), {(): parse(graph, f"c*({above})/({below}){power}", graph.symbol)})}
    found = collect(graph, formulas, {n: Symbol(n, "parameter", "m") for n in graph.symbols})
    terms = [read_back(m) for m in math_of(render(found, "mathml", "textbook"))]
    assert max(map(len, terms)) < 30
    assert "t1=b0*y0" in terms
    assert f"f=(1)/({divisor})*c*" in terms


@pytest.mark.parametrize(
    ("format_", "written"),
    [
        (
            "latex",
            (
                r"\ddot{q}_{1} &=",
                r"\Gamma^{1}_{12} &=",
                "g^{12} &=",
                "g^{ab} &= g^{ba}",
                "R_{1212} &=",
                "R &=",
                "{L_{z}} &=",
                r"{p_{\mathrm{x},4}} &=",
                "E &=",
            ),
        ),
        ("mathml", ("q..1=", "\u0393121=", "g^12=", "g^ab=g^ba", "R1212=", "R=", "Lz=", "px,4=", "E=")),
    ],
)
def test_quantities_have_letters(format_: str, written: tuple[str, ...]) -> None:
    """Accelerations are q'', raised indices stand above, momenta are p and L."""
    wheel = model("reaction-wheel-pendulum")
    accelerations = derived(wheel, "forward_dynamics").select(["forward_dynamics"])
    programs = (accelerations, curvature(model("double-pendulum")), first_integrals(model("scara")).program)
    text = "\n".join(render(p, format_, "textbook") for p in programs)
    lines = formulas_of(text) if format_ == "mathml" else text.splitlines()
    for each in written:
        assert any(line.startswith(each) for line in lines), each


def test_names_in_mathml() -> None:
    written = [named(n) for n in latex_names(["theta", "q1'", "tau.arm.q1"])]
    assert written[0] == "<mi>&#952;</mi>"
    assert written[1] == "<msub><mover><mi>q</mi><mo>&#x2D9;</mo></mover><mrow><mn>1</mn></mrow></msub>"
    assert named("I_{xx5}") == "<msub><mi>I</mi><mrow><mi>x</mi><mi>x</mi><mn>5</mn></mrow></msub>"
    assert written[2] == "<msub><mi>&#964;</mi><mrow><mi>arm</mi><mo>,</mo><mn>1</mn></mrow></msub>"


@pytest.mark.parametrize("form", ["textbook", "compact"])
def test_lines_of_latex_fit(form: str) -> None:
    text = render(program("puma560", "metric", "forces"), "latex", form)
    rows = [r for r in text.split("\n") if "&" in r and not r.startswith("%")]
    assert len(rows) > 60
    assert max(width(r.partition("&")[2]) for r in rows) < LINE + 40


@pytest.mark.skipif(shutil.which("pdflatex") is None, reason="there is no LaTeX")
@pytest.mark.parametrize(
    ("name", "outputs", "form"),
    [
        ("puma560", ("metric", "christoffel", "forces"), "textbook"),
        ("kuka-iiwa-14", ("gravity", "position"), "textbook"),
        ("kuka-iiwa-14", ("metric",), "readable"),
        ("double-pendulum", ("metric", "christoffel", "forces"), "expanded"),
    ],
)
def test_documents_compile_and_nothing_is_too_wide(
    tmp_path: Path, name: str, outputs: tuple[str, ...], form: str
) -> None:
    (tmp_path / "it.tex").write_text(render(program(name, *outputs), "latex-document", form, name=name))
    command = ["pdflatex", "-no-shell-escape", "-interaction=nonstopmode", "-halt-on-error", "it.tex"]
    for _ in range(2):  # longtable
        done = subprocess.run(command, cwd=tmp_path, capture_output=True, timeout=900, check=False)
        assert done.returncode == 0, done.stdout[-2000:]
    log = (tmp_path / "it.log").read_text(errors="replace")
    assert "Overfull" not in log
    assert "Missing character" not in log
    assert (tmp_path / "it.pdf").stat().st_size > 20_000


def test_parentheses_are_as_large_as_they_need_to_be() -> None:
    """Those that grow leave a gap behind them, as in front of an angle."""
    lines = {x.split(" &= ")[0]: x for x in render(program("four-bar", "metric"), "latex", "textbook").splitlines()}
    assert lines["g_{11}"].startswith(r"g_{11} &= \left(\frac{1}{3} \, m_{1} + m_{2}\right) \, l_{1}^{2}")
    text = render(program("double-pendulum", "metric", "forces"), "latex", "textbook")
    assert r"g_{11} &= (m_{1} + m_{2}) \, l_{1}^{2}" in text
    assert r"\sin(q_{1} + q_{2})" in text
    assert r"\sin q_{2}" in render(program("double-pendulum", "christoffel"), "latex", "compact")
    sums = [OPENING + f"a_{{{k}}} + {OPENING}b + c{CLOSING} \\, d" + CLOSING for k in range(9)]
    assert broken(BREAK.join(["x", *(f"+ {s}" for s in sums)])).count(r"+ (b + c) \, d\bigr)") == 9


def test_products_are_broken_between_factors() -> None:
    factors = [rf"\cos \mathit{{elbow}}_{{{k}}}" for k in range(30)]
    lines = broken(r" \, ".join(factors) + BREAK + "+ a").split(" \\\\\n")
    assert len(lines) > 3
    assert all(width(line.replace("&", "")) <= LINE for line in lines)
    assert all(line.startswith((r"&\quad {} \cdot \cos", r"&\quad + a")) for line in lines[1:])
    kept = "".join(lines).replace(r"&\quad {} \cdot ", r" \, ")
    assert [f for f in factors if f in kept] == factors
    sums = [OPENING + f"a_{{{k}}} + b_{{{k}}}" + CLOSING for k in range(20)]
    assert broken(r" \, ".join(sums)).count("(") == broken(r" \, ".join(sums)).count(")") == 20
    fraction = r"\frac{" + r" \, ".join(factors) + "}{b}"
    assert broken(fraction) == fraction, "nothing is broken inside of a fraction"


def test_lines_end_outside_of_parentheses_where_they_can() -> None:
    long = f"+ {OPENING}{BREAK.join(f'+ m_{{{k}}} a_{{{k}}} d_{{{k}}}' for k in range(7))}{CLOSING} c_{{23}}"
    first, second = broken(f"m_{{6}} a_{{2}} s_{{4}} s_{{5}} s_{{6}} s_{{23}}{BREAK}{long}").split(" \\\\\n")
    assert first == "m_{6} a_{2} s_{4} s_{5} s_{6} s_{23}"
    assert second.endswith(") c_{23}")


def test_marks_of_parentheses_are_as_wide_as_parentheses() -> None:
    assert width(OPENING + "a" + CLOSING) == width("(a)")


@pytest.mark.parametrize(
    ("formula", "latex", "mathml"),
    [
        (
            "1/100000*x",
            r"10^{-5} \, x",
            '<msup><mn>10</mn><mrow><mo form="prefix">&#x2212;</mo><mn>5</mn></mrow></msup>',
        ),
        ("3/100000*x", r"3 \cdot 10^{-5} \, x", "<mn>3</mn><mo>&#xB7;</mo><msup><mn>10</mn>"),
    ],
)
def test_small_numbers(formula: str, latex: str, mathml: str) -> None:
    graph = Graph()
    formulas = {"f": Formulas((), {(): parse(graph, formula, graph.symbol)})}
    found = collect(graph, formulas, {"x": Symbol("x", "parameter", "m")})
    assert f"&= {latex}" in render(found, "latex", "textbook")
    assert mathml in render(found, "mathml", "textbook")


@pytest.mark.parametrize(("number", "text"), [("0.05", "0.05"), ("1/8", "0.125"), ("1/6", "1/6"), ("1/7", "1/7")])
@pytest.mark.parametrize("form", ["compact", "expanded", "textbook"])
def test_decimals_in_every_form(number: str, text: str, form: str) -> None:
    graph = Graph()
    formulas = {"f": Formulas((), {(): parse(graph, f"x + {number}", graph.symbol)})}
    found = collect(graph, formulas, {"x": Symbol("x", "parameter", "m")})
    is_decimal = "." in text
    above, _, below = text.partition("/")
    assert text in render(found, "text", form).splitlines()[-1]
    assert (text if is_decimal else rf"\frac{{{above}}}{{{below}}}") in render(found, "latex", form)
    assert (f"<mn>{text}</mn>" if is_decimal else f"<mfrac><mn>{above}</mn>") in render(found, "mathml", form)


@pytest.mark.parametrize("times", ["", "y*"])
def test_one_over_a_wide_root(times: str) -> None:
    graph = Graph()
    names = [f"lengthy_name_{n}" for n in range(9)]
    below = f"{times}sqrt(" + " + ".join(f"{n}^2" for n in names) + ")"
    symbols = {n: Symbol(n, "parameter", "m") for n in ["y", *names]}
    found = collect(graph, {"f": Formulas((), {(): parse(graph, f"1/({below})", graph.symbol)})}, symbols)
    (entry,) = entries(found, "f", "latex", "compact")
    text = entry["formula"]
    assert not text.startswith("1 ")
    assert text.count("^{-1/2}") == (not times)
    assert text.count("^{1/2}") == bool(times)
