"""Conclusions of reports: rest, parameters that matter, what may be left out, singular positions."""

from __future__ import annotations

import re

import numpy as np
import pytest
import scipy
from closed_trees import tree_parts
from random_trees import Plain, model_of

from substructures import couple, evaluate
from substructures.analysis.report import influence, omission, rest, singular
from substructures.analysis.report.page import page_report
from substructures.analysis.report.report import CONCLUSIONS, Heading, Report, report
from substructures.analysis.report.sizes import sampled
from substructures.analysis.report.text import text_report
from substructures.quantities.regressor import regressor

from .test_report import moved, subject, told

ADDRESS = "/v1/trees/t@1"


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
