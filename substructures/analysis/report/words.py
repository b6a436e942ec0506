"""How the equations come about, in words: what stands in every report."""

from __future__ import annotations

EQUATION_LATEX = r"g_{ab}\,\ddot q^{b} + \Gamma_{abc}\,\dot q^{b}\dot q^{c} = Q_{a}"
METRIC_LATEX = r"g_{ac} = \sum_{k \ge c} m_k\, u_{ka}\cdot u_{kc} + \Omega_{ka}^{T}\,\Theta_k\,\Omega_{kc}"
GAMMA_LATEX = (
    r"\Gamma_{abc} = \sum_{k \ge c} m_k\, u_{ka}\cdot(\Omega_{kb}\times u_{kc})"
    r" + \Omega_{kb}^{T} J_k\,(\Omega_{kc}\times\Omega_{ka}) \qquad (a,\,b \le c)"
)
FORCES_LATEX = r"Q_{a} = \sum_{k \ge a} K_k\cdot u_{ka} + M_k\cdot\Omega_{ka}"


def _sub(letter: str, index: str) -> str:
    """A letter with indices in MathML."""
    return f"<msub><mi>{letter}</mi><mrow>{''.join(f'<mi>{i}</mi>' for i in index)}</mrow></msub>"


def _rate(dots: str, index: str) -> str:
    return f"<msup><mover><mi>q</mi><mo>{dots}</mo></mover><mi>{index}</mi></msup>"


def _sum(least: str) -> str:
    below = f"<mrow><mi>k</mi><mo>&#x2265;</mo><mi>{least}</mi></mrow>"
    return f"<mo>=</mo><munder><mo>&#x2211;</mo>{below}</munder>"


def _cross(one: str, other: str) -> str:
    return f"<mrow><mo>(</mo>{one}<mo>&#xD7;</mo>{other}<mo>)</mo></mrow>"


def _turned(index: str) -> str:
    """Omega transposed."""
    inner = "".join(f"<mi>{i}</mi>" for i in index)
    return f"<msubsup><mi>{_OMEGA}</mi><mrow>{inner}</mrow><mi>T</mi></msubsup>"


_OMEGA, _GAMMA, _THETA, _DOT, _PLUS = "&#x3A9;", "&#x393;", "&#x398;", "<mo>&#xB7;</mo>", "<mo>+</mo>"
_DISTANCE = '<mspace width="2em"/>'
EQUATION_MATHML = (
    f"{_sub('g', 'ab')}{_rate('..', 'b')}{_PLUS}{_sub(_GAMMA, 'abc')}{_rate('&#x2D9;', 'b')}{_rate('&#x2D9;', 'c')}"
    f"<mo>=</mo>{_sub('Q', 'a')}"
)
METRIC_MATHML = (
    f"{_sub('g', 'ac')}{_sum('c')}{_sub('m', 'k')}{_sub('u', 'ka')}{_DOT}{_sub('u', 'kc')}{_PLUS}"
    f"{_turned('ka')}{_sub(_THETA, 'k')}{_sub(_OMEGA, 'kc')}"
)
GAMMA_MATHML = (
    f"{_sub(_GAMMA, 'abc')}{_sum('c')}{_sub('m', 'k')}{_sub('u', 'ka')}{_DOT}"
    f"{_cross(_sub(_OMEGA, 'kb'), _sub('u', 'kc'))}{_PLUS}"
    f"{_turned('kb')}{_sub('J', 'k')}{_cross(_sub(_OMEGA, 'kc'), _sub(_OMEGA, 'ka'))}{_DISTANCE}"
    "<mrow><mo>(</mo><mi>a</mi><mo>,</mo><mi>b</mi><mo>&#x2264;</mo><mi>c</mi><mo>)</mo></mrow>"
)
FORCES_MATHML = (
    f"{_sub('Q', 'a')}{_sum('a')}{_sub('K', 'k')}{_DOT}{_sub('u', 'ka')}{_PLUS}{_sub('M', 'k')}{_DOT}"
    f"{_sub(_OMEGA, 'ka')}"
)
#: paragraphs, with names of quantities in dollar signs, and the equation behind each in LaTeX and in MathML
DERIVATION: tuple[tuple[str, str, str], ...] = (
    (
        "With relative joint coordinates on a tree every derivative that the Lagrange equations need is a cross "
        "product: nothing is differentiated (P. Maisser). The equations of motion are",
        EQUATION_LATEX,
        EQUATION_MATHML,
    ),
    (
        "The partial velocities $u$ of the mass centres and $Omega$ of rotation of every body $k$ follow from those of "
        "its parent by one recursion. The mass matrix is their quadratic form with mass $m$ and inertia tensor "
        "$Theta$,",
        METRIC_LATEX,
        METRIC_MATHML,
    ),
    (
        "the Christoffel symbols a cubic form of the same functions, with the second moments $J$,",
        GAMMA_LATEX,
        GAMMA_MATHML,
    ),
    (
        "and the generalised forces linear in them, with the applied forces $K$ and moments $M$:",
        FORCES_LATEX,
        FORCES_MATHML,
    ),
)
REFERENCE = (
    "P. Maisser, ZAMM 68 (1988), and Computeralgebra in der Mechanik (1990), for the formalism; the formulas were "
    "derived and compared with the definitions by the software substructures"
)
