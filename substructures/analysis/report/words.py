"""How the equations come about, in words: what stands in every report."""

from __future__ import annotations

EQUATION_LATEX = r"g_{ab}\,\ddot q^{b} + \Gamma_{abc}\,\dot q^{b}\dot q^{c} = Q_{a}"
METRIC_LATEX = r"g_{ac} = \sum_{k \ge c} m_k\, u_{ka}\cdot u_{kc} + \Omega_{ka}^{T}\,\Theta_k\,\Omega_{kc}"
GAMMA_LATEX = (
    r"\Gamma_{abc} = \sum_{k \ge c} m_k\, u_{ka}\cdot(\Omega_{kb}\times u_{kc})"
    r" + \Omega_{kb}^{T} J_k\,(\Omega_{kc}\times\Omega_{ka}) \qquad (a,\,b \le c)"
)
FORCES_LATEX = r"Q_{a} = \sum_{k \ge a} K_k\cdot u_{ka} + M_k\cdot\Omega_{ka}"
#: paragraphs, and the equation behind each in LaTeX and in MathML
DERIVATION: tuple[tuple[str, str, str], ...] = (
    (
        "With relative joint coordinates on a tree every derivative that the Lagrange equations need is a cross "
        "product: nothing is differentiated (P. Maisser). The equations of motion are",
        EQUATION_LATEX,
        "<msub><mi>g</mi><mi>ab</mi></msub><mover><mi>q</mi><mo>..</mo></mover><msup><mi></mi><mi>b</mi></msup>"
        "<mo>+</mo><msub><mi>&#x393;</mi><mi>abc</mi></msub><msup><mover><mi>q</mi><mo>&#x2D9;</mo></mover><mi>b</mi></msup>"
        "<msup><mover><mi>q</mi><mo>&#x2D9;</mo></mover><mi>c</mi></msup><mo>=</mo><msub><mi>Q</mi><mi>a</mi></msub>",
    ),
    (
        "The partial velocities of the mass centres u and of rotation Omega of every body k follow from those of its "
        "parent by one recursion. The mass matrix is their quadratic form with mass m and inertia tensor Theta,",
        METRIC_LATEX,
        "<msub><mi>g</mi><mi>ac</mi></msub><mo>=</mo><munder><mo>&#x2211;</mo><mi>k</mi></munder><msub><mi>m</mi><mi>k</mi></msub>"
        "<msub><mi>u</mi><mi>ka</mi></msub><mo>&#xB7;</mo><msub><mi>u</mi><mi>kc</mi></msub><mo>+</mo>"
        "<msub><mi>&#x3A9;</mi><mi>ka</mi></msub><mo>&#xB7;</mo><msub><mi>&#x398;</mi><mi>k</mi></msub>"
        "<msub><mi>&#x3A9;</mi><mi>kc</mi></msub>",
    ),
    (
        "the Christoffel symbols a cubic form of the same functions, with the second moments J,",
        GAMMA_LATEX,
        "<msub><mi>&#x393;</mi><mi>abc</mi></msub><mo>=</mo><munder><mo>&#x2211;</mo><mi>k</mi></munder>"
        "<msub><mi>m</mi><mi>k</mi></msub><msub><mi>u</mi><mi>ka</mi></msub><mo>&#xB7;</mo><mo>(</mo>"
        "<msub><mi>&#x3A9;</mi><mi>kb</mi></msub><mo>&#xD7;</mo><msub><mi>u</mi><mi>kc</mi></msub><mo>)</mo><mo>+</mo>"
        "<msub><mi>&#x3A9;</mi><mi>kb</mi></msub><mo>&#xB7;</mo><msub><mi>J</mi><mi>k</mi></msub><mo>(</mo>"
        "<msub><mi>&#x3A9;</mi><mi>kc</mi></msub><mo>&#xD7;</mo><msub><mi>&#x3A9;</mi><mi>ka</mi></msub><mo>)</mo>",
    ),
    (
        "and the generalised forces linear in them, with the applied forces K and moments M:",
        FORCES_LATEX,
        "<msub><mi>Q</mi><mi>a</mi></msub><mo>=</mo><munder><mo>&#x2211;</mo><mi>k</mi></munder><msub><mi>K</mi><mi>k</mi></msub>"
        "<mo>&#xB7;</mo><msub><mi>u</mi><mi>ka</mi></msub><mo>+</mo><msub><mi>M</mi><mi>k</mi></msub><mo>&#xB7;</mo>"
        "<msub><mi>&#x3A9;</mi><mi>ka</mi></msub>",
    ),
)
REFERENCE = (
    "P. Maisser, ZAMM 68 (1988), and Computeralgebra in der Mechanik (1990), for the formalism; the formulas were "
    "derived and compared with the definitions by the software substructures"
)
