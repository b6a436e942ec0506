"""LaTeX of formulas, beside what textbooks print: lines typed by hand; their sources stand in ``test_lines``."""

from __future__ import annotations

import pytest

from substructures.export import render

from .textbook_models import program

PUMA_22 = r"""
g_{22} &= I_{yy3} + I_{zz2} + J_{m2} G_{2}^{2} + m_{2} \bigl((a_{2} + c_{x2})^{2} + c_{y2}^{2}\bigr)
 + m_{3} \bigl(a_{2}^{2} + (a_{3} + c_{x3})^{2} + c_{z3}^{2}\bigr) \\ &\quad
 + m_{4} \bigl(a_{2}^{2} + a_{3}^{2} + (c_{y4} + d_{4})^{2}\bigr) + (m_{5} + m_{6}) (a_{2}^{2} + a_{3}^{2} + d_{4}^{2})
 \\ &\quad + 2 a_{2} \bigl((m_{3} + m_{4} + m_{5} + m_{6}) a_{3} + m_{3} c_{x3}\bigr) c_{3}
 - 2 m_{6} a_{2} c_{z6} (c_{3} c_{4} s_{5} + s_{3} c_{5}) \\ &\quad
 - 2 a_{2} \bigl(m_{3} c_{z3} + m_{4} c_{y4} + (m_{4} + m_{5} + m_{6}) d_{4}\bigr) s_{3}
 - 2 m_{6} a_{3} c_{z6} c_{4} s_{5} \\ &\quad + (I_{yy5} + I_{zz4}) c_{4}^{2}
 + m_{6} c_{z6}^{2} (c_{4}^{2} + s_{4}^{2} c_{5}^{2}) + I_{yy6} (c_{4} c_{6} - s_{4} c_{5} s_{6})^{2} \\ &\quad
 + I_{xx6} (c_{4} s_{6} + s_{4} c_{5} c_{6})^{2} + I_{xx4} s_{4}^{2} + I_{xx5} s_{4}^{2} c_{5}^{2}
 + (I_{zz5} + I_{zz6}) s_{4}^{2} s_{5}^{2} \\ &\quad + 2 m_{6} c_{z6} d_{4} c_{5}
"""

#: model, quantity, and its lines without thin spaces; sums that do not fit a line go on after ``&\quad``
LINES = {
    ("double-pendulum", "metric"): [
        r"g_{11} &= (m_{1} + m_{2}) l_{1}^{2} + m_{2} l_{2}^{2} + 2 m_{2} l_{1} l_{2} \cos q_{2}",
        r"g_{12} &= m_{2} l_{2}^{2} + m_{2} l_{1} l_{2} \cos q_{2}",
        r"g_{22} &= m_{2} l_{2}^{2}",
        r"g_{ab} &= g_{ba}",
    ],
    ("double-pendulum", "christoffel"): [
        r"\Gamma_{112} &= -m_{2} l_{1} l_{2} \sin q_{2}",
        r"\Gamma_{122} &= -m_{2} l_{1} l_{2} \sin q_{2}",
        r"\Gamma_{abc} &= \Gamma_{acb}, \quad \Gamma_{cba} = -\Gamma_{abc} \quad (b \le a)",
    ],
    ("double-pendulum", "forces"): [
        r"Q_{1} &= \tau_{1} - (m_{1} + m_{2}) g l_{1} \sin q_{1} - m_{2} g l_{2} \sin(q_{1} + q_{2})",
        r"Q_{2} &= \tau_{2} - m_{2} g l_{2} \sin(q_{1} + q_{2})",
    ],
    ("double-pendulum", "scalar_curvature"): [
        r"R &= \frac{2 m_{1} \cos q_{2}}{l_{1} l_{2} (m_{1} + m_{2} \sin^{2} q_{2})^{2}}"
    ],
    ("acrobot", "scalar_curvature"): [
        r"R &= \frac{2 m_{2} l_{1} l_{c2} \bigl((I_{c1} + m_{1} l_{c1}^{2}) (I_{c2} + m_{2} l_{c2}^{2})"
        r" + I_{c2} m_{2} l_{1}^{2}\bigr) \cos q_{2}}{\bigl((I_{c2} + m_{2} l_{c2}^{2})"
        r" (I_{c1} + m_{1} l_{c1}^{2} + m_{2} l_{1}^{2}) - m_{2}^{2} l_{1}^{2} l_{c2}^{2} \cos^{2} q_{2}\bigr)^{2}}"
    ],
    ("cart-pendulum", "metric"): [
        r"g_{11} &= m_{0} + m_{1}",
        r"g_{12} &= -m_{1} l_{0} \cos q_{1}",
        r"g_{22} &= m_{1} l_{0}^{2}",
        r"g_{ab} &= g_{ba}",
    ],
    ("cart-pendulum", "forward_dynamics"): [
        r"\ddot{q}_{1} &= \frac{l_{0} \tau_{0} + \tau_{1} \cos q_{1} + m_{1} g l_{0} \sin q_{1} \cos q_{1}"
        r" - m_{1} l_{0}^{2} \sin(q_{1}) \dot{q}_{1}^{2}}{l_{0} (m_{0} + m_{1} \sin^{2} q_{1})}",
        r"\ddot{q}_{2} &= \frac{1}{m_{1} l_{0}^{2} (m_{0} + m_{1} \sin^{2} q_{1})} \bigl((m_{0} + m_{1})"
        r" (\tau_{1} + m_{1} g l_{0} \sin q_{1}) \\ &\quad + m_{1} l_{0} \cos(q_{1}) \bigl(\tau_{0} - m_{1}"
        r" l_{0} \sin(q_{1}) \dot{q}_{1}^{2}\bigr)\bigr)",
    ],
    ("cart-pendulum", "energy"): [
        r"E &= m_{1} g l_{0} \cos q_{1} + \frac{1}{2} (m_{0} + m_{1}) \dot{q}_{0}^{2} - m_{1} l_{0}"
        r" \cos(q_{1}) \dot{q}_{0} \dot{q}_{1} + \frac{1}{2} m_{1} l_{0}^{2} \dot{q}_{1}^{2}",
    ],
    ("furuta-pendulum", "metric"): [
        r"g_{11} &= J_{1} + m_{1} l_{1}^{2} + m_{2} L_{1}^{2} + (J_{2} + m_{2} l_{2}^{2}) \sin^{2} q_{2}",
        r"g_{12} &= m_{2} L_{1} l_{2} \cos q_{2}",
        r"g_{22} &= J_{2} + m_{2} l_{2}^{2}",
        r"g_{ab} &= g_{ba}",
    ],
    ("furuta-pendulum", "christoffel"): [
        r"\Gamma_{112} &= (J_{2} + m_{2} l_{2}^{2}) \sin q_{2} \cos q_{2}",
        r"\Gamma_{122} &= -m_{2} L_{1} l_{2} \sin q_{2}",
        r"\Gamma_{abc} &= \Gamma_{acb}, \quad \Gamma_{cba} = -\Gamma_{abc} \quad (b \le a)",
    ],
    ("furuta-pendulum", "forward_dynamics"): [
        r"t_{1} &= (J_{2} + m_{2} l_{2}^{2}) \bigl(J_{1} + m_{1} l_{1}^{2} + m_{2} L_{1}^{2} + (J_{2} +"
        r" m_{2} l_{2}^{2}) \sin^{2} q_{2}\bigr) \\ &\quad - m_{2}^{2} L_{1}^{2} l_{2}^{2} \cos^{2} q_{2}",
        r"\ddot{q}_{1} &= \frac{1}{t_{1}} \bigl((J_{2} + m_{2} l_{2}^{2}) \bigl(\tau_{1} - b_{1}"
        r" \dot{q}_{1} - m_{2} L_{1} l_{2} \sin(q_{2}) \bigl(\cos^{2}(q_{2}) \dot{q}_{1}^{2} -"
        r" \dot{q}_{2}^{2}\bigr) \\ &\quad - 2 (J_{2} + m_{2} l_{2}^{2}) \sin q_{2} \cos(q_{2}) \dot{q}_{1}"
        r" \dot{q}_{2}\bigr) \\ &\quad - m_{2} L_{1} l_{2} \cos(q_{2}) (\tau_{2} - m_{2} g l_{2} \sin q_{2}"
        r" - b_{2} \dot{q}_{2})\bigr)",
        r"\ddot{q}_{2} &= \frac{1}{t_{1}} \bigl(\bigl(J_{1} + m_{1} l_{1}^{2} + m_{2} L_{1}^{2} + (J_{2} +"
        r" m_{2} l_{2}^{2}) \sin^{2} q_{2}\bigr) \bigl(\tau_{2} - m_{2} g l_{2} \sin q_{2} - b_{2}"
        r" \dot{q}_{2} \\ &\quad + (J_{2} + m_{2} l_{2}^{2}) \sin q_{2} \cos(q_{2}) \dot{q}_{1}^{2}\bigr)"
        r" \\ &\quad - m_{2} L_{1} l_{2} \cos(q_{2}) \bigl(\tau_{1} - b_{1} \dot{q}_{1} - 2 (J_{2} + m_{2}"
        r" l_{2}^{2}) \sin q_{2} \cos(q_{2}) \dot{q}_{1} \dot{q}_{2} \\ &\quad + m_{2} L_{1} l_{2}"
        r" \sin(q_{2}) \dot{q}_{2}^{2}\bigr)\bigr)",
    ],
    ("scara", "metric"): [
        r"g_{11} &= I_{1} + I_{2} + I_{a4} + m_{1} c_{1}^{2} + m_{2} (a_{1}^{2} + c_{2}^{2})"
        r" + (m_{3} + m_{4}) (a_{1}^{2} + a_{2}^{2}) \\ &\quad"
        r" + 2 a_{1} \bigl(m_{2} c_{2} + (m_{3} + m_{4}) a_{2}\bigr) \cos q_{2}",
        r"g_{12} &= I_{2} + I_{a4} + m_{2} c_{2}^{2} + (m_{3} + m_{4}) a_{2}^{2}"
        r" + a_{1} \bigl(m_{2} c_{2} + (m_{3} + m_{4}) a_{2}\bigr) \cos q_{2}",
        r"g_{14} &= -I_{a4}",
        r"g_{22} &= I_{2} + I_{a4} + m_{2} c_{2}^{2} + (m_{3} + m_{4}) a_{2}^{2}",
        r"g_{24} &= -I_{a4}",
        r"g_{33} &= m_{3} + m_{4}",
        r"g_{44} &= I_{a4}",
        r"g_{ab} &= g_{ba}",
    ],
    ("scara", "forces"): [
        r"Q_{1} &= \tau_{1}",
        r"Q_{2} &= \tau_{2}",
        r"Q_{3} &= \tau_{3} + (m_{3} + m_{4}) g",
        r"Q_{4} &= \tau_{4}",
    ],
    ("top", "routhian"): [
        r"R &= -m g l \cos \theta - \frac{p_{\phi}^{2}}{2 C} + \frac{1}{2} (A + m l^{2}) \dot{\theta}^{2}"
        r" - \frac{(p_{\psi} - p_{\phi} \cos \theta)^{2}}{2 (A + m l^{2}) \sin^{2} \theta}"
    ],
    ("acrobot", "hamiltonian"): [
        r"t_{1} &= (I_{c2} + m_{2} l_{c2}^{2}) (I_{c1} + m_{1} l_{c1}^{2} + m_{2} l_{1}^{2})"
        r" - m_{2}^{2} l_{1}^{2} l_{c2}^{2} \cos^{2} q_{2}",
        r"H &= g (m_{1} l_{c1} + m_{2} l_{1}) \sin q_{1} + m_{2} g l_{c2} \sin(q_{1} + q_{2}) \\ &\quad"
        r" + \frac{1}{2 t_{1}} \bigl((I_{c2} + m_{2} l_{c2}^{2}) (p_{1} - p_{2})^{2}"
        r" + (I_{c1} + m_{1} l_{c1}^{2} + m_{2} l_{1}^{2}) p_{2}^{2} \\ &\quad"
        r" - 2 m_{2} l_{1} l_{c2} p_{2} (p_{1} - p_{2}) \cos q_{2}\bigr)",
    ],
    ("symmetric-top", "energy"): [
        r"E &= m g l \cos \theta + \frac{1}{2} C \bigl(\dot{\phi} + \cos(\theta) \dot{\psi}\bigr)^{2} +"
        r" \frac{1}{2} (A + m l^{2}) \bigl(\sin^{2}(\theta) \dot{\psi}^{2} + \dot{\theta}^{2}\bigr)",
    ],
    ("sleigh", "bias"): [r"{\mathit{bias}}_{1} &= -m a w^{2}", r"{\mathit{bias}}_{2} &= m a u w"],
    ("four-bar", "metric"): [
        r"g_{11} &= \left(\frac{1}{3} m_{1} + m_{2}\right) l_{1}^{2} + \frac{1}{3} m_{2} l_{2}^{2}"
        r" + m_{2} l_{1} l_{2} \cos \mathit{coupler}",
        r"g_{12} &= \frac{1}{3} m_{2} l_{2}^{2} + \frac{1}{2} m_{2} l_{1} l_{2} \cos \mathit{coupler}",
        r"g_{22} &= \frac{1}{3} m_{2} l_{2}^{2}",
        r"g_{33} &= \frac{1}{3} m_{3} l_{3}^{2}",
        r"g_{ab} &= g_{ba}",
    ],
    ("trolley-crane", "metric"): [
        r"g_{11} &= m_{l} + m_{t}",
        r"g_{12} &= m_{l} (l_{0} + \mathit{hoist}) \cos \mathit{swing}",
        r"g_{13} &= m_{l} \sin \mathit{swing}",
        r"g_{22} &= m_{l} (l_{0} + \mathit{hoist})^{2}",
        r"g_{33} &= m_{d} + m_{l}",
        r"g_{ab} &= g_{ba}",
    ],
}


def _body(model: str, quantity: str) -> str:
    """What stands between ``aligned``, in one line, without thin spaces."""
    text = render(program(model, quantity), "latex", "textbook")
    inside = text.partition(r"\begin{aligned}")[2].partition(r"\end{aligned}")[0]
    return " ".join(inside.replace(r"\,", " ").split())


@pytest.mark.parametrize(("model", "quantity"), LINES, ids=" ".join)
def test_latex_of_textbooks(model: str, quantity: str) -> None:
    assert _body(model, quantity) == r" \\ ".join(LINES[model, quantity])


def test_a_long_line_of_puma() -> None:
    assert " ".join(PUMA_22.split()) in _body("puma560", "metric")


@pytest.mark.parametrize(
    ("quantity", "letter"),
    {
        "hamiltonian": "H",
        "energy": "E",
        "forward_dynamics": r"\ddot{q}_{1}",
        "potential_energy": "V",
        "nonlinear_effects": "h_{1}",
        "bias": r"{\mathit{bias}}_{1}",
    }.items(),
)
def test_letters_of_quantities(quantity: str, letter: str) -> None:
    assert _body("cart-pendulum", quantity).startswith(f"{letter} &= ")
