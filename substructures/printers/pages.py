"""LaTeX that fits a page: formulas are broken before the signs of sums, also of those in parentheses, and between
factors of products that are too wide for a line.

While a formula is written its possible breaks and its parentheses are marks; they are decided on when it is whole.
"""

from __future__ import annotations

import re
from typing import NamedTuple

#: before the sign of a term; parentheses of a sum
BREAK, OPENING, CLOSING = "\x1f", "\x1e", "\x1d"
#: points that a line of a formula may be wide, beside the name on its left
LINE = 365.0

_SIGN = re.compile(r"\\[A-Za-z]+|\\.|.", re.DOTALL)
_FACTOR, _SIGNS = re.compile(r"\\[A-Za-z]+|\\.|[{}()]", re.DOTALL), (r"\,", r"\cdot")
_MARKS = re.compile(f"([{OPENING}{CLOSING}])")
_COMMANDS = {r"\,": 1.7, r"\cdot": 7.2, r"\quad": 10.0, r"\\": 0.0, r"\ ": 4.0, r"\_": 5.0}
_SILENT = "left right bar bigl bigr Bigl Bigr frac mathrm mathit mathtt operatorname sqrt dot ddot dddot ddddot hat"
_INVISIBLE = frozenset("\\" + name for name in _SILENT.split(" "))


def solid(text: str) -> str:
    """A formula on one line."""
    return sized(text.replace(BREAK, " "), r"\left(", r"\right)")


def sized(text: str, opening: str = r"\Bigl(", closing: str = r"\Bigr)") -> str:
    """Parentheses instead of their marks: somewhat larger around others, and those given around what is high."""
    parts, starts = list[str](), list[int]()
    for part in _MARKS.split(text):
        if part == OPENING:
            starts.append(len(parts))
        if part == CLOSING and starts:
            start = starts.pop()
            inner = "".join(parts[start + 1 :])
            pair = (r"\bigl(", r"\bigr)") if "(" in inner else ("(", ")")
            parts[start], part = (opening, closing) if r"\frac" in inner or r"\sqrt" in inner else pair
        parts.append(part)
    return "".join(parts)


def broken(text: str) -> str:
    """A formula on as many lines as it needs, the others aligned under the first."""
    whole = solid(text)
    if width(whole) <= LINE:
        return whole
    lines: list[list[_Piece]] = [[]]
    depth = 0
    for part in text.split(BREAK):
        for sign, factor in _factors(part) if width(part) > LINE - 40 else [("", part)]:
            lines[-1].append(_Piece(factor, width(sign + factor), depth, sign))
            depth += factor.count(OPENING) - factor.count(CLOSING)
            while len(lines[-1]) > 1 and sum(p.width for p in lines[-1]) > LINE - 20 * (len(lines) > 1):
                at = _end(lines[-1])
                lines[-1:] = [lines[-1][:at], lines[-1][at:]]
    # parentheses that grow cannot be broken
    return sized(" \\\\\n&\\quad ".join(map(_joined, lines)))


class _Piece(NamedTuple):
    """What stands between two breaks; ``depth``: parentheses around the break before it; ``sign``: of a product before
    it, where it is a factor.
    """

    text: str
    width: float
    depth: int
    sign: str = ""


def _joined(line: list[_Piece]) -> str:
    """The pieces of a line; one that a factor begins begins with a dot."""
    first, *others = line
    start = r"{} \cdot " if first.sign else ""
    return " ".join([start + first.text, *(f"{p.sign} {p.text}" if p.sign else p.text for p in others)])


def _factors(text: str) -> list[tuple[str, str]]:
    """The factors of a product with the signs before them, where these stand in no fraction and no function."""
    found, sign, start, depth = list[tuple[str, str]](), "", 0, 0
    for match in _FACTOR.finditer(text):
        token = match.group()
        if token in _SIGNS and depth == 0:
            found.append((sign, text[start : match.start()].strip(" ")))
            sign, start = token, match.end()
        depth += (token in ("{", "(")) - (token in ("}", ")"))
    return [*found, (sign, text[start:].strip(" "))]


def _end(line: list[_Piece]) -> int:
    """Which piece of a line that is too long begins the next one: inside of few parentheses, and late."""
    best, filled = len(line) - 1, 0.0
    for n, piece in enumerate(line):
        if n and filled > LINE * 0.15 and (*_cost(piece), -n) < (*_cost(line[best]), -best):
            best = n
        filled += piece.width
    return best


def _cost(piece: _Piece) -> tuple[bool, int]:
    """Between factors only where no sum has a sign."""
    return bool(piece.sign), piece.depth


def width(text: str) -> float:
    """About how wide a formula is in points at a size of ten points; a fraction counts with all that is in it."""
    total, scales, next_scale = 0.0, [1.0], 1.0
    for sign in _SIGN.findall(text):
        if sign == "{":
            scales.append(scales[-1] * next_scale)
        elif sign == "}":
            scales = scales[:-1] if len(scales) > 1 else scales
        elif sign in "_^":
            next_scale = 0.7
            continue
        else:
            total += _glyph(sign) * scales[-1] * next_scale
        next_scale = 1.0
    return total


def _glyph(sign: str) -> float:
    if sign.startswith("\\"):
        if sign in _COMMANDS:
            return _COMMANDS[sign]
        # the name of a function, or a Greek letter
        return 0.0 if sign in _INVISIBLE else 17.5 if sign in (r"\cos", r"\sin", r"\tan") else 7.0
    if sign in "+-":
        return 12.5
    if sign.isupper() or sign in "mw":
        return 8.5
    # marks are white space to Python
    return 4.6 if sign in OPENING + CLOSING + "(),." else 0.0 if sign.isspace() else 5.5
