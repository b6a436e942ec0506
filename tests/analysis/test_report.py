"""Reports: what is said is so, and what is printed compiles, or is a page."""

from __future__ import annotations

import re
import shutil
import subprocess
import xml.etree.ElementTree as ElementTree
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from closed_trees import tree_parts
from in_depth import deep

from substructures import Model, TreeSpec, catalogue, couple, evaluate
from substructures.analysis.report.latex import latex_report, words
from substructures.analysis.report.page import page_report
from substructures.analysis.report.report import Heading, Report, report
from substructures.analysis.report.sizes import SMALL, sampled
from substructures.analysis.report.text import text_report
from substructures.part.part import Part
from substructures.pictures.latex import latex_picture
from substructures.pictures.tree import picture
from substructures.printers.mathml_names import named
from substructures.printers.names import latex_names, look
from substructures.printers.text import Text
from substructures.tree.glossary import glossary

G = {"gravity": [0, 0, "-g"], "parameters": {"g": {"value": 9.81, "unit": "m/s^2"}}}
PRINTABLE = "Grüße: 100 % _{x}^2 \\end{document} ~ # $ & <b> \u2206 \x07"


def subject(name: str, more: Any = ()) -> tuple[TreeSpec, dict[str, Part], Model]:
    names = [name, *more]
    instances = [{"name": f"x{k}" if more else "x", "substructure": n} for k, n in enumerate(names)]
    spec, parts = tree_parts({"name": "t", **G, "instances": instances}, {n: catalogue.load(n) for n in names})
    return spec, parts, couple(spec, parts)


def told(name: str, more: Any = (), heading: Heading | None = None) -> Report:
    _, parts, model = subject(name, more)
    return report(model, {n: p.definition for n, p in parts.items()}, heading or Heading(name))


def test_the_double_pendulum_in_words() -> None:
    found = told("double-pendulum")
    texts = {each.text for each in found.statements}
    assert {
        "g[2,2] does not change.",
        "q1 changes no element of g.",
        "q2 changes g[1,1], g[1,2].",
        "Gamma[1,1,2], Gamma[1,2,2] are equal.",
        "On q1 gravity and the input tau_1 act.",
    } <= texts
    assert any(t.startswith("2 of 2 independent Christoffel symbols are not zero; Gamma[a, b, c]") for t in texts)
    assert any(t.startswith("Energy is constant while all inputs are zero: ") for t in texts)
    # names as in all other statements
    assert not any("x.q1" in t for t in [*texts, *(each.text for each in told("scara").statements)])
    shown = text_report(found)
    assert "metric[1, 1] = (m1 + m2)*l1^2 + m2*l2^2 + 2*m2*l1*l2*cos(q2)" in shown
    # m2 l2^2 over m2 l2^2 + m2 l1 l2 |cos q2|, with all ones: 1 where cos q2 = 0, and 1/2 where it is 1
    sizes = found.plain()["sizes"]["entries"]
    share = {term["formula"]: term["largest_share"] for term in sizes[1]["terms"]}
    assert share["m2*l2^2"] == pytest.approx(1, abs=0.02)
    assert share["m2*l1*l2*cos(q2)"] == pytest.approx(0.5, abs=0.001)


@pytest.mark.parametrize("name", ["scara", "puma560", "satellite", "gantry", "quarter-car", "furuta-pendulum"])
def test_statements_are_so_in_numbers(name: str) -> None:
    """What is said of elements and coordinates, at random states that differ in one coordinate."""
    _, _, model = subject(name)
    found = told(name)
    rng = np.random.default_rng(1)
    values = {n: float(rng.uniform(0.5, 1.5)) for n in sorted(model.parameters)}
    q = rng.uniform(-1, 1, (6, model.dof))
    g = evaluate(model, ["metric"], q, parameters=values)["metric"]
    for each in (s for s in found.statements if s.about == "metric"):
        for a, b in each.entries:
            if each.code == "zero":
                assert not g[:, a, b].any()
            if each.code == "constant":
                assert np.ptp(g[:, a, b]) <= 1e-12 * np.abs(g[:, a, b]).max()
            if each.code == "equal":
                assert g[:, a, b] == pytest.approx(g[(slice(None), *each.entries[0])], rel=1e-12)
        if each.code == "coordinate":
            moved = q.copy()
            moved[:, model.coordinates.index(each.coordinates[0])] += 0.7
            change = np.abs(evaluate(model, ["metric"], moved, parameters=values)["metric"] - g).max(axis=0)
            changed = {(a, b) for a, b in zip(*np.nonzero(change > 1e-12), strict=True) if a <= b}
            assert changed == {(a, b) for a, b in each.entries}, each.text
    gamma = evaluate(model, ["christoffel"], q, parameters=values)["christoffel"]
    still = {c for s in found.statements if s.code == "no-velocity-forces" for c in s.coordinates}
    for a, coordinate in enumerate(model.coordinates):
        assert gamma[:, a].any() != (coordinate in still)


def test_shares_are_of_the_terms_of_the_element() -> None:
    """Terms add up to the element, and what is small changes it by no more than it says."""
    found = told("puma560")
    assert found.plain()["sizes"]["reason"] is None
    sizes, _ = found.sizes(found.printed("metric", Text))
    assert len(sizes) > 10
    for element in sizes:
        shares = [t.share for t in element.terms]
        assert shares == sorted(shares, reverse=True)
        assert all(t.is_small == (t.share < SMALL) for t in element.terms)
        assert sum(shares) >= 1 - 1e-9, "at every state the shares add up to one"


def test_states_are_in_the_limits() -> None:
    _, _, model = subject("ur5")
    q, ranges = sampled(model)
    limits = evaluate(model, ["metric"], q).warnings
    assert not [w for w in limits if w["code"] == "limits-left"]
    assert set(ranges) == set(model.coordinates)
    _, _, rail = subject("linear-rail")
    assert all(np.isfinite(x).all() for x in sampled(rail)[1].values())


def test_independent_machines_are_told_apart() -> None:
    found = told("simple-pendulum", ["double-pendulum"])
    (blocks,) = [s for s in found.statements if s.code == "blocks"]
    assert blocks.text == "Inertia couples only coordinates within each of these groups: x0.q1; x1.q1, x1.q2."


def test_parameters_without_value_have_no_sizes() -> None:
    part = catalogue.load("double-pendulum")
    part["parameters"]["m1"] = {"unit": "kg"}
    spec, parts = tree_parts({"name": "t", **G, "instances": [{"name": "x", "substructure": "p"}]}, {"p": part})
    found = report(couple(spec, parts), {n: p.definition for n, p in parts.items()}, Heading("p")).plain()
    assert found["sizes"]["reason"] == "parameters without a value: x.m1"
    assert found["sizes"]["entries"] == []
    (rested,) = [each["text"] for each in found["statements"] if each["about"] == "rest"]
    assert "x.m1" in rested
    (ranked,) = [each["text"] for each in found["statements"] if each["about"] == "parameters"]
    assert ranked.startswith("Parameters were not ranked: ")


@pytest.mark.skipif(shutil.which("pdflatex") is None, reason="no LaTeX here")
@pytest.mark.parametrize("name", ["double-pendulum", "puma560", "kuka-iiwa-14", "humanoid-arm", "andrews-squeezer"])
def test_plain_latex_compiles_it_within_the_page(name: str, tmp_path: Path) -> None:
    spec, parts, model = subject(name)
    heading = Heading(name, PRINTABLE, PRINTABLE * 30, "", (PRINTABLE,))
    found = report(model, {n: p.definition for n, p in parts.items()}, heading)
    (tmp_path / "report.tex").write_text(latex_report(found, latex_picture(spec, parts, model)))
    command = ["pdflatex", "-interaction=nonstopmode", "-halt-on-error", "report.tex"]
    done = subprocess.run(command, cwd=tmp_path, capture_output=True, timeout=100)
    log = done.stdout.decode(errors="replace")
    assert done.returncode == 0, log[-2000:]
    assert "Overfull" not in log


def test_documents_and_pages_say_quantities_in_mathematics() -> None:
    """Lists of elements with their spaces, raised powers of units, and under which condition Gamma is what is said."""
    found = told("furuta-pendulum")
    text, page = latex_report(found), page_report(found)
    assert "$q_{2}$ changes $g_{11}$, $g_{12}$." in text
    assert "$\\Gamma_{abc}$ = $\\Gamma_{acb}$, and $\\Gamma_{cba}$ = -$\\Gamma_{abc}$ for b $<$= a" in text
    assert "On $q_{1}$ " in text
    for name in ("g[", "G[", "tau\\_", ">q2 "):
        assert name not in text + page
    assert "m/\\allowbreak s$^{2}$" in text
    assert "mass $m$ and inertia tensor $\\Theta$," in text
    assert "<sup>2</sup>" in page
    assert "kg*m" not in page + text
    assert "inertia tensor Theta" not in page
    least = "<mi>a</mi><mo>,</mo><mi>b</mi><mo>&#x2264;</mo><mi>c</mi>"
    assert least in page
    assert "<mi>k</mi><mo>&#x2265;</mo><mi>c</mi>" in page


def test_wide_symbols_are_told() -> None:
    """In rows of their own, since formulas have them."""
    text = latex_report(told("humanoid-arm"))
    assert "ldots" not in text.partition("subsection*{Derivation}")[0]
    assert r"\multicolumn{6}{@{}l}{$\mathit{shoulder}_{" in text


def test_the_body_alone_can_be_included() -> None:
    text = latex_report(told("double-pendulum"), document=False)
    assert "documentclass" not in text
    assert r"\end{document}" not in text


def test_texts_of_users_are_no_commands() -> None:
    shown = words(PRINTABLE)
    assert r"\end{document}" not in shown
    assert r"\textbackslash{}end\{document\}" in shown
    assert "Grüße: 100 \\%" in shown
    assert "U+2206" in shown


def test_the_page_is_xhtml_that_loads_nothing() -> None:
    spec, parts, model = subject("scara")
    heading = Heading("scara", "<script>alert(1)</script>", "a & b\x07", "", ("</p><img src='x'/>",))
    found = report(model, {n: p.definition for n, p in parts.items()}, heading)
    page = page_report(found, picture(spec, parts, model))
    root = ElementTree.fromstring(page.encode())  # noqa: S314 -- our own
    tags = {e.tag.split("}")[1] for e in root.iter()}
    assert {"math", "svg", "table", "h2"} <= tags
    assert not tags & {"script", "img", "link", "iframe", "object"}
    assert "".join(root.itertext()).count("<script>alert(1)</script>") == 2


@pytest.mark.parametrize("name", ["puma560", *deep("kuka-iiwa-14")])
def test_no_equation_of_a_report_is_false(name: str) -> None:
    """The mass that joint 6 carries is not written as that of link 6: m_{6} = m_{6} + m_{7}."""
    spec, parts, model = subject(name)
    names = glossary(spec, parts, model=model.program)
    found = report(model, {n: p.definition for n, p in parts.items()}, Heading(name), names)
    looks = {look(x) for x in latex_names(found.called.values())}
    pages = {named(x) for x in latex_names(found.called.values())}
    rows = [line.partition(" &= ")[0] for line in latex_report(found).splitlines() if " &= " in line]
    lines = re.findall(r"<p><math[^>]*><mrow>(.*?)<mo>=</mo>", page_report(found))
    assert len(rows) > 100 < len(lines)
    assert not looks.intersection(map(look, rows))
    assert not pages.intersection(lines)


def test_long_lines_are_a_derivation_and_terms_keep_their_sizes() -> None:
    spec, parts, model = subject("humanoid-arm")
    definitions = {n: p.definition for n, p in parts.items()}
    found = report(model, definitions, Heading("humanoid-arm"), glossary(spec, parts, model=model.program))
    printed = found.printed("metric", Text)
    assert printed.reason.startswith("a derivation, since the textbook form has lines of up to ")
    assert max(map(len, printed.listing.entries["metric"])) < 200
    sizes, reason = found.sizes(printed)
    assert sizes
    assert not reason
    assert "cos(shoulder_roll)" in text_report(found)


def moved(found: Report, code: str) -> dict[str, list[float]]:
    """Of each ranked parameter, in their order, the changes that it makes 10 % less and more."""
    (each,) = [s for s in found.statements if s.about == "parameters" and s.code == code]
    base, *others = (one.value for one in each.figures)
    names = [one.name.partition(" ")[0] for one in each.figures[1::2]]
    return {n: [x / base - 1, y / base - 1] for n, x, y in zip(names, others[::2], others[1::2], strict=True)}
