"""What is printed for people: MathML that is what its schema allows, and documents that LaTeX compiles."""

from __future__ import annotations

import re
import shutil
import subprocess
import xml.etree.ElementTree as ElementTree
from pathlib import Path

import pytest
from closed_trees import tree_model

from substructures import Program, catalogue
from substructures.printers import render
from substructures.printers.mathml import named
from substructures.printers.names import latex_names
from substructures.printers.pages import BREAK, LINE, broken, width

MATH = "{http://www.w3.org/1998/Math/MathML}"
#: number of children in MathML Core, section 3; others have any number
CHILDREN = {"mfrac": 2, "msub": 2, "msup": 2, "mover": 2, "mspace": 0}
#: hold text, nothing else
TOKENS = {"mi", "mn", "mo", "mtext"}


def program(name: str, *outputs: str) -> Program:
    gravity = {"gravity": [0, 0, "-g"], "parameters": {"g": {"value": 9.81, "unit": "m/s^2"}}}
    whole = gravity | {"instances": [{"name": "x", "substructure": name}]}
    return tree_model(whole, {name: catalogue.load(name)}).program.select(outputs)


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
    return {"\u2062": "*", "\u2061": " ", "\u2212": "-", "\u00b7": "*"}.get(own, own) + "".join(parts)


def test_terms_of_mathml_are_those_of_the_text() -> None:
    text = render(program("furuta-pendulum", "metric"), "mathml", "textbook")
    paragraphs = re.findall(r"<p>(<math.*?)</p>", text, re.DOTALL)
    terms = [[read_back(m) for m in math_of(f"<html xmlns='x'>{p}</html>")] for p in paragraphs]
    assert terms[0] == ["g11=J1", "+m1*l1^2", "+m2*L1^2", "+(J2+m2*l2^2)*sin^2 q2"]
    assert terms[1] == ["g12=m2*L1*l2*cos q2"]


def test_names_in_mathml() -> None:
    written = [named(n) for n in latex_names(["theta", "q1'", "tau.arm.q1"])]
    assert written[0] == "<mi>&#952;</mi>"
    assert written[1] == "<msub><mover><mi>q</mi><mo>&#x2D9;</mo></mover><mrow><mn>1</mn></mrow></msub>"
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
        done = subprocess.run(command, cwd=tmp_path, capture_output=True, timeout=120, check=False)
        assert done.returncode == 0, done.stdout[-2000:]
    log = (tmp_path / "it.log").read_text(errors="replace")
    assert "Overfull" not in log
    assert "Missing character" not in log
    assert (tmp_path / "it.pdf").stat().st_size > 20_000


def test_products_are_broken_between_factors() -> None:
    factors = [rf"\cos \mathit{{elbow}}_{{{k}}}" for k in range(30)]
    lines = broken(r" \, ".join(factors) + BREAK + "+ a").split(" \\\\\n")
    assert len(lines) > 3
    assert all(width(line.replace("&", "")) <= LINE for line in lines)
    assert all(line.startswith((r"&\quad {} \cdot \cos", r"&\quad + a")) for line in lines[1:])
    kept = "".join(lines).replace(r"&\quad {} \cdot ", r" \, ")
    assert [f for f in factors if f in kept] == factors
    fraction = r"\frac{" + r" \, ".join(factors) + "}{b}"
    assert broken(fraction) == fraction, "nothing is broken inside of a fraction"
