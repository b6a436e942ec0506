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
import scipy
from closed_trees import tree_parts
from in_depth import deep
from random_trees import Plain, model_of

from substructures import Model, TreeSpec, catalogue, couple, evaluate
from substructures.analysis.report import influence, omission, rest, singular
from substructures.analysis.report.latex import latex_report, words
from substructures.analysis.report.page import page_report
from substructures.analysis.report.report import CONCLUSIONS, Heading, Report, report
from substructures.analysis.report.sizes import SMALL, sampled
from substructures.analysis.report.text import text_report
from substructures.part.part import Part
from substructures.pictures.latex import latex_picture
from substructures.pictures.tree import picture
from substructures.printers.mathml_names import named
from substructures.printers.names import latex_names, look
from substructures.printers.text import Text
from substructures.quantities.regressor import regressor
from substructures.tree.glossary import glossary

ADDRESS = "/v1/trees/t@1"
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


def figures(found: Report, code: str) -> list[dict[str, list[float]]]:
    """Of statements about rest with a code, by name."""
    several: list[dict[str, list[float]]] = []
    for each in (s for s in found.statements if s.about == "rest" and s.code == code):
        several.append({})
        for one in each.figures:
            several[-1].setdefault(one.name, []).append(one.value)
    return several


def test_rest_is_told_with_its_reason_and_closed_form_frequencies() -> None:
    """w^2 = g/l of one pendulum, (2 +- sqrt 2) g/l of two equal ones; the upright one grows as e^(w t)."""
    w = np.sqrt(9.81)
    single = told("simple-pendulum", heading=Heading("p", address=ADDRESS))
    (stable,), (unstable,) = figures(single, "stable"), figures(single, "unstable")
    assert stable == {
        "x.q1": [0],
        "frequency": [pytest.approx(w / 2 / np.pi)],
        "period": [pytest.approx(2 * np.pi / w)],
    }
    assert unstable == {"x.q1": [pytest.approx(np.pi)], "time_constant": [pytest.approx(1 / w)]}
    text = (
        "Rest at q1 = 0 rad is stable because the potential energy has a strict minimum (Lagrange, Dirichlet); small "
        "vibrations of 0.4985 Hz (period 2.006 s)."
    )
    assert f"* {text} More: POST {ADDRESS}/equilibria\n" in text_report(single)
    (stable,) = figures(told("double-pendulum"), "stable")
    expected = [w * np.sqrt(2 + sign * np.sqrt(2)) / 2 / np.pi for sign in (-1, 1)]
    assert stable["frequency"] == pytest.approx(expected)
    assert not any(s.request for s in told("double-pendulum").statements), "a part alone has no address"


def test_rest_of_a_damped_car() -> None:
    """Modes of M = diag(wheel, body) with the spring and damper between, and that of the tyre, by numpy alone."""
    found = told("quarter-car")
    (rest_figures,) = figures(found, "asymptotically-stable")
    values = {row.name: row.value or 0.0 for row in found.symbols}
    body, wheel, spring, tyre, damper, tyre_damper = (
        values[f"x.{name}"] for name in ("M1", "M2", "K1", "K2", "b1", "b2")
    )
    a = np.zeros((4, 4))
    a[:2, 2:] = np.eye(2)
    a[2, :] = np.array([-spring - tyre, spring, -damper - tyre_damper, damper]) / wheel
    a[3, :] = np.array([spring, -spring, damper, -damper]) / body
    roots = sorted((z for z in np.linalg.eigvals(a) if z.imag > 0), key=abs)
    assert rest_figures["frequency"] == pytest.approx([z.imag / 2 / np.pi for z in roots])
    assert rest_figures["damping_ratio"] == pytest.approx([-z.real / abs(z) for z in roots])
    assert rest_figures["time_constant"] == pytest.approx([-1 / max(z.real for z in roots)])


def test_what_cannot_be_said_of_rest_is_told(monkeypatch: pytest.MonkeyPatch) -> None:
    texts = [s.text for s in told("cart-pendulum").statements if s.about == "rest"]
    assert "No force depends on q0: rest is at any value." in texts
    assert any("is undecided because the eigenvalue 0 leaves the decision" in text for text in texts)
    # two joints on one axis: g = J [1 1; 1 1]
    shaft = {"name": "a", "parent": "base", "joint": {"type": "revolute", "coordinate": "q1"}}
    disc = {
        "name": "b",
        "parent": "a",
        "mass": 1,
        "inertia": {"xx": 1, "yy": 1, "zz": 0.3},
        "joint": {"type": "revolute"},
    }
    coaxial = report(model_of({"name": "coaxial", "bodies": [shaft, disc]}, (0, 0, -9.81)), {}, Heading("c"))
    (numbers,) = figures(coaxial, "failed")
    assert numbers["metric_condition"] == [pytest.approx(0, abs=1e-15)]
    assert any("is not judged because the metric is singular here" in s.text for s in coaxial.statements)
    monkeypatch.setattr(rest, "MOST_COORDINATES", 1)
    (small,) = [s.text for s in told("double-pendulum").statements if s.about == "rest"]
    assert re.fullmatch(r"Positions of rest were not looked for: 2 coordinates and .* limits are 1 and 4,000.", small)


def moved(found: Report, code: str) -> dict[str, list[float]]:
    """Of each ranked parameter, in their order, the changes that it makes 10 % less and more."""
    (each,) = [s for s in found.statements if s.about == "parameters" and s.code == code]
    base, *others = (one.value for one in each.figures)
    names = [one.name.partition(" ")[0] for one in each.figures[1::2]]
    return {n: [x / base - 1, y / base - 1] for n, x, y in zip(names, others[::2], others[1::2], strict=True)}


def test_parameters_are_ranked_as_closed_forms_are() -> None:
    """f = sqrt(g/l)/(2 pi), g_11 = m l^2, V = -m g l cos q."""
    found = told("simple-pendulum", heading=Heading("p", address=ADDRESS))
    less, more = 0.9, 1.1
    frequency = moved(found, "lowest-frequency")
    assert list(frequency) == ["x.l", "g"]
    assert frequency["x.l"] == pytest.approx([less**-0.5 - 1, more**-0.5 - 1])
    assert frequency["g"] == pytest.approx([less**0.5 - 1, more**0.5 - 1])
    element = moved(found, "largest-element")
    assert list(element) == ["x.l", "x.m"]
    assert element["x.l"] == pytest.approx([less**2 - 1, more**2 - 1])
    assert element["x.m"] == pytest.approx([-0.1, 0.1])
    potential = moved(found, "potential-range")
    assert set(potential) == {"g", "x.l", "x.m"}
    assert np.ravel(list(potential.values())) == pytest.approx([-0.1, 0.1] * 3)
    text = (
        "The lowest frequency beside the first position of rest, 0.4985 Hz, is moved most by l (+5.41 %, -4.65 %); "
        "then g (-5.13 %, +4.88 %): each parameter alone 10 % less, 10 % more than its default."
    )
    assert f"* {text} More: POST {ADDRESS}/root-loci\n" in text_report(found)
    assert "<h3>Which parameters matter most</h3>" in page_report(found)


def crooked(zz: float = 0.5, b: float = 0.2) -> Report:
    """About an arm of 2 kg that swings about the third axis, its mass centre at (0.3, b) m."""
    arm: Plain = {"name": "arm", "parent": "base", "mass": 2, "com": ["a", "b", 0]}
    arm |= {"joint": {"type": "revolute", "limits": [-2, 1]}, "inertia": {"xx": "J", "yy": "J", "zz": "J"}}
    values = {"a": {"value": 0.3, "unit": "m"}, "b": {"value": b, "unit": "m"}, "c": {"value": 0, "unit": "m"}}
    values["J"] = {"value": zz, "unit": "kg*m^2"}
    model = model_of({"name": "crooked", "parameters": values, "bodies": [arm]}, (0, -9.81, 0))
    return report(model, {}, Heading("crooked"))


def test_a_position_of_rest_is_followed() -> None:
    """A crooked arm, whose rest turns with its mass centre (a, b): w^2 = m G r/(J + m r^2), r^2 = a^2 + b^2."""
    found = crooked()

    def frequency(a: float, b: float) -> float:
        """In Hz."""
        r = np.hypot(a, b)
        return float(np.sqrt(2 * 9.81 * r / (0.5 + 2 * r * r)) / 2 / np.pi)

    changes = {name.rpartition(".")[2]: x for name, x in moved(found, "lowest-frequency").items()}
    base = frequency(0.3, 0.2)
    assert list(changes) == ["J", "a", "b"]
    # -pi/2 - atan2(b, a) is below -2
    (stable,) = [s.text for s in found.statements if s.code == "stable"]
    assert re.match(r"Rest at \w+ = -2.159 rad \(outside the limits of \w+\) is stable because ", stable)
    assert changes["a"] == pytest.approx([frequency(0.3 * x, 0.2) / base - 1 for x in (0.9, 1.1)])
    assert changes["b"] == pytest.approx([frequency(0.3, 0.2 * x) / base - 1 for x in (0.9, 1.1)])


def test_what_has_no_joint_has_no_rest() -> None:
    found = [s.text for s in told("flange-tool").statements if s.about in CONCLUSIONS[1:]]
    assert found == ["Positions of rest were not looked for: the tree has no joint: there is nothing that moves."]


def test_parameters_that_are_too_many_are_not_ranked(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(influence, "MOST_WORK", 10)
    (text,) = [s.text for s in told("simple-pendulum").statements if s.about == "parameters"]
    assert re.fullmatch(r"Parameters were not ranked: 3 of them times \d+ operations; the limit is 10.", text)


def test_a_small_inertia_may_be_left_out() -> None:
    """g = J + m r^2 without J: T is wrong by J/(J + m r^2), no force by anything; without a, too, by all."""
    (each,) = [s for s in crooked(0.001).statements if s.about == "omissions"]
    shares = {one.name: one.value for one in each.figures}
    whole = 0.001 + 2 * (0.3**2 + 0.2**2)
    assert each.code == "may-be-zero"
    assert re.search(r"J may be zero at 1 %, because no kinetic energy changes by more than 0.383 %", each.text)
    assert shares["energy_error"] == pytest.approx(0.001 / whole)
    assert shares["force_error"] == 0
    assert shares["next_energy_error"] == pytest.approx((0.001 + 2 * 0.2**2) / whole), "b comes next"
    (none,) = [s.code for s in crooked(0.5).statements if s.about == "omissions"]
    assert none == "none"


def test_what_may_be_zero_changes_no_energy_by_more_than_it_says() -> None:
    """T' - T over T is between the least and the largest root of det(g' - g - e g) = 0, by scipy."""
    _, _, model = subject("ur5")
    found = told("ur5")
    (each,) = [s for s in found.statements if s.about == "omissions"]
    names = {short: name for name, short in found.called.items()}
    zero = {names[short]: 0.0 for short in each.text.partition(" may ")[0].split(", ")}
    assert len(zero) > 1
    q = sampled(model)[0][:32]
    g = evaluate(model, ["metric"], q)["metric"]
    less = evaluate(model, ["metric"], q, parameters=zero)["metric"]
    roots = [scipy.linalg.eigh(b - a, a, eigvals_only=True) for a, b in zip(g, less, strict=True)]
    assert each.figures[0].value == pytest.approx(np.abs(roots).max(), rel=1e-6)
    assert each.figures[0].value < 0.01 < max(one.value for one in each.figures[2:])


def test_gimbal_lock_of_a_free_body_is_found() -> None:
    """At pitch +-pi/2 yaw and roll turn about one axis: rates in the ratio that is told move no mass."""
    _, _, model = subject("free-body")
    (each,) = [s for s in told("free-body").statements if s.about == "singular"]
    at = {one.name: one.value for one in each.figures}
    assert each.code == "singular"
    assert abs(at["x.pitch"]) == pytest.approx(np.pi / 2, abs=1e-3)
    rates = re.search(r"rates in the ratio yaw (\S+), roll (\S+) move no mass", each.text)
    assert rates is not None
    qd = {"x.yaw": float(rates[1]), "x.roll": float(rates[2])}
    turning = {"x.yaw": 1.0, "x.roll": -qd["x.roll"] / qd["x.yaw"]}
    for speeds, moves in ((qd, False), (turning, True)):
        q, v = (np.array([some.get(name, 0.0) for name in model.coordinates]) for some in (at, speeds))
        g = evaluate(model, ["metric"], q)["metric"]
        assert (v @ g @ v > 1e-6 * np.abs(g).max()) == moves


def test_a_regular_mass_matrix_has_its_worst_position() -> None:
    """g = [3 + 2 c, 1 + c; 1 + c, 1] is worst at c = 1: [1, 2/sqrt 5; 2/sqrt 5, 1] in units of its diagonal."""
    (each,) = [s for s in told("double-pendulum").statements if s.about == "singular"]
    at = {one.name: one.value for one in each.figures}
    assert each.code == "regular"
    assert at["x.q2"] == pytest.approx(0, abs=1e-3)
    assert at["least_eigenvalue"] == pytest.approx(1 - 2 / np.sqrt(5), rel=0.01)


def test_routh_decides_what_cyclic_coordinates_leave_open() -> None:
    """A pendulum that hangs from a cart: the cart may be anywhere, its momentum stays."""
    found = told("cart-pendulum", heading=Heading("p", address=ADDRESS))
    (text,) = [s.text for s in found.statements if s.code == "relative-stable"]
    assert text.startswith(
        "At constant momenta of the cyclic q0, rest of the others at q1 = 3.142 rad is stable because"
    )
    assert "(Routh, Salvadori)" in text
    assert not [s for s in told("simple-pendulum").statements if s.code.startswith("relative")]


def test_whole_bodies_that_may_be_left_out() -> None:
    """Of a rod of 1 kg and 1 m with a disc of 1 g at its end: T by (m + J/2)/(1/3 + m + J/2), weight by m/(1/2 + m)."""
    rod = {
        "name": "rod",
        "parent": "base",
        "mass": 1,
        "com": [0.5, 0, 0],
        "inertia": {"yy": "1/12", "zz": "1/12"},
        "joint": {"type": "revolute", "coordinate": "q", "axis": [0, 1, 0], "placement": {"position": [0, 0, 0]}},
    }
    joint = {"type": "revolute", "coordinate": "r", "axis": [1, 0, 0], "placement": {"position": [1, 0, 0]}}
    disc = {
        "name": "disc",
        "parent": "rod",
        "mass": "0.001",
        "inertia": {"xx": "0.001", "yy": "0.0005", "zz": "0.0005"},
        "joint": {**joint, "armature": 1},
    }
    tree = {"name": "t", "gravity": [0, 0, "-9.81"], "instances": [{"name": "x", "substructure": "a"}]}
    spec, parts = tree_parts(tree, {"a": {"name": "a", "bodies": [rod, disc]}})
    found = report(couple(spec, parts), {}, Heading("a"), None, regressor(spec, parts))
    (bodies,) = [s for s in found.statements if s.code == "bodies"]
    assert bodies.text.startswith("The inertia of x.disc may be left out at 1 %")
    numbers = {figure.name: figure.value for figure in bodies.figures}
    assert numbers["energy_error"] == pytest.approx(0.0015 / (1 / 3 + 0.0015))
    assert numbers["force_error"] == pytest.approx(0.001 / 0.501)
    assert numbers["next_force_error"] == pytest.approx(1)


def test_searches_that_were_not_made_are_told(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(singular, "MOST_COORDINATES", 1)
    monkeypatch.setattr(omission, "MOST_WORK", 1)
    texts = {s.text for s in told("double-pendulum").statements if s.code == "not-looked-for"}
    assert any(
        re.match(r"Singular positions were not looked for: 2 coordinates and .*are 1 and 4,000\.", t) for t in texts
    )
    assert any(re.match(r"Which parameters may be left out was not looked for: .* is 1\.", t) for t in texts)
