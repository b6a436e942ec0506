"""Names of quantities and signs as elements of MathML."""

from __future__ import annotations

import re

_LOWER = "alpha beta gamma delta epsilon zeta eta theta iota kappa lambda mu nu xi pi rho sigma tau upsilon phi chi psi"
_UPPER = "omega Gamma Delta Theta Lambda Xi Pi Sigma Upsilon Phi Psi Omega"
_CODES = [*range(0x3B1, 0x3BF), 0x3C0, 0x3C1, *range(0x3C3, 0x3CA)]
_CODES += [0x393, 0x394, 0x398, 0x39B, 0x39E, 0x3A0, 0x3A3, 0x3A5, 0x3A6, 0x3A8, 0x3A9]
_GREEK = dict(zip(f"{_LOWER} {_UPPER}".split(" "), (f"&#{code};" for code in _CODES), strict=True))
_PART = re.compile(r"\\(d+)ot\{|\\math(?:rm|it|tt)\{([^}]*)\}|\\([A-Za-z]+)|([A-Za-z]+|[0-9]+)|(.)", re.DOTALL)


def row(*parts: str) -> str:
    """Several elements as one."""
    return "<mrow>" + "".join(parts) + "</mrow>" if len(parts) != 1 else parts[0]


def operator(sign: str, between: bool = False) -> str:
    """A sign; ``between`` two terms, also where it begins a formula."""
    return f'<mo form="infix">{sign}</mo>' if between else f"<mo>{sign}</mo>"


def named(latex: str) -> str:
    """A name of :func:`substructures.printers.names.latex_names` in MathML."""
    if match := re.match(r"\\(?:(d+)ot|bar)\{(.*?)\}(?=_|$)", latex):
        dots, latex = len(match.group(1) or ""), match.group(2) + latex[match.end() :]
    base, _, below = latex.partition("_{")
    found = "".join(_pieces(base))
    if match:
        over = "&#x2D9;" if dots == 1 else "." * dots or "&#xAF;"
        found = f"<mover>{found}<mo>{over}</mo></mover>"
    return f"<msub>{found}{row(*_pieces(below[:-1]), '')}</msub>" if below else found


def _pieces(latex: str) -> list[str]:
    """Letters, numbers and signs of a name."""
    found = []
    for _, upright, command, plain, sign in _PART.findall(latex):
        word = upright or _GREEK.get(command, command)
        if plain:
            found += [f"<mi>{c}</mi>" for c in plain] if plain.isalpha() else [f"<mn>{plain}</mn>"]
        elif word:
            found.append(f"<mn>{word}</mn>" if word.isdigit() else f"<mi>{word}</mi>")
        elif sign in ",":
            found.append(operator(","))
    return found
