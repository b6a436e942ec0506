"""Presentation MathML in a page of XHTML: one ``<math>`` for every term of a sum, so that lines wrap.

Elements of MathML Core only, which browsers draw without help: math, mrow, mi, mn, mo, mtext, mspace, msub, msup,
msubsup, mfrac, msqrt, mover.
"""

from __future__ import annotations

import re
from collections.abc import Iterator, Sequence
from fractions import Fraction
from typing import ClassVar
from xml.sax.saxutils import escape

from substructures.expr.program import Output, Program
from substructures.printers.language import ATOM, NEGATION, POWER, PRODUCT, SUM, Language, Listing, Piece
from substructures.printers.mathml_names import named, operator, row
from substructures.printers.meanings import Label
from substructures.printers.names import RAISED, comment, latex_names, letter_of, prefix

#: before every term of a sum that stands in no parentheses or fraction
TERM = "\x1f"
_NAMED = {"asin": "arcsin", "acos": "arccos", "atan": "arctan", "log": "ln", "sign": "sgn"}
_FONT = re.compile(r"</?m(?:i|n|o|row|text)\b[^>]*>")
PAGE = """<?xml version="1.0" encoding="utf-8"?>
<html xmlns="http://www.w3.org/1999/xhtml"><head><title>{title}</title>
<meta name="viewport" content="width=device-width, initial-scale=1"/><style>
:root {{ color-scheme: light dark; }}
p {{ line-height: 2; padding-left: 2em; text-indent: -2em; }} math {{ font-size: 1.1em; }} td {{ padding-right: 2em; }}
</style></head><body><h1>{title}</h1>
{body}
</body></html>
"""


MINUS_SIGN = "&#x2212;"
MINUS, DOT = f'<mo form="prefix">{MINUS_SIGN}</mo>', operator("&#xB7;")
_EQUAL, _FOR = operator("="), '<mspace width="1em"/>'
#: rules of symmetry
_RULES = {
    "symmetric": (f"{{ab}}{_EQUAL}{{ba}}",),
    "christoffel": (
        f"{{abc}}{_EQUAL}{{acb}}{operator(',')}",
        f"{{cba}}{_EQUAL}{MINUS}{{abc}}{_FOR}<mi>b</mi>{operator('&#x2264;')}<mi>a</mi>",
    ),
    "connection": (f"{{abc}}{_EQUAL}{{acb}}",),
}
#: between factors: a thin space
TIMES = '<mo lspace="0" rspace="0.17em">&#x2062;</mo>'
#: between a function and its argument, and how a function with a name begins
APPLIED = operator("&#x2061;")
_FUNCTION = re.compile(r"<mrow>(?:<msup>)?<mi>[a-z0-9]+</mi>(?:<mn>\d+</mn></msup>)?<mo>&#x2061;")
#: parentheses between which lines may end
OPENING, CLOSING = '<mo stretchy="false">(</mo>', '<mo stretchy="false">)</mo>'
#: names, numbers and signs of a formula that is broken before the signs of sums wherever they stand
WIDE = 60
#: in fractions they are smaller
IN_FRACTION = 90


class MathML(Language):
    """Formulas as presentation MathML. Indices count from 1."""

    media = "application/xhtml+xml; charset=utf-8"
    width = 4000
    first = 1
    is_for_people = True
    bars = True
    functions: ClassVar = _NAMED

    def __init__(self, program: Program) -> None:
        super().__init__(program)
        self._latex = latex_names(s.name for s in program.symbols)
        self.names = [
            f"<mtext>{escape(comment(s.name))}</mtext>" if latex.startswith(r"\mathtt") else named(latex)
            for latex, s in zip(self._latex, program.symbols, strict=True)
        ]
        self.prefix = prefix(s.name for s in program.symbols)

    def symbol(self, n: int) -> Piece:
        """A name in italics with indices, dots for rates."""
        return Piece(self.names[n])

    def temporary(self, n: int) -> Piece:
        """A letter with a number below."""
        return Piece(f"<msub><mi>{self.prefix}</mi><mn>{n}</mn></msub>")

    def labelled(self, label: Label) -> Piece:
        """A letter with numbers and component below."""
        return Piece(named(label.latex))

    def look(self, text: str) -> str:
        """Letters and indices, upright or not."""
        return _FONT.sub("", text)

    def lefts(self) -> Iterator[str]:
        """With their indices."""
        for output, array in self.program.outputs.items():
            yield from self._places(output, array)

    def abbreviation(self, op: str, digits: str) -> Piece:
        """c with the numbers of the angles of cos(q1 + q2) below."""
        return Piece(f"<msub><mi>{op[0]}</mi><mn>{digits}</mn></msub>")

    def pi(self) -> Piece:
        """The Greek letter."""
        return Piece("<mi>&#x3C0;</mi>")

    def fraction(self, above: int, below: int) -> Piece:
        """One above the other."""
        return Piece(f"<mfrac><mn>{above}</mn><mn>{below}</mn></mfrac>", PRODUCT)

    def scientific(self, mantissa: str, exponent: int) -> Piece:
        """mantissa * 10^exponent."""
        if not exponent:
            return Piece(f"<mn>{mantissa}</mn>")
        shown = f"<mn>{exponent}</mn>" if exponent > 0 else row(MINUS, f"<mn>{-exponent}</mn>")
        power = f"<msup><mn>10</mn>{shown}</msup>"
        if mantissa == "1":
            return Piece(power, POWER)
        return Piece(f"<mn>{mantissa}</mn>{DOT}{power}", PRODUCT)

    def parentheses(self, text: str) -> str:
        """Parentheses that grow with what they hold, unless lines may end in it."""
        if _is_wide(text):
            return OPENING + text + CLOSING
        return row(operator("("), solid(text), operator(")"))

    def add(self, a: Piece, b: Piece) -> Piece:
        """a + b."""
        if b.precedence == NEGATION:
            return Piece(f"{a.text}{TERM}{operator(MINUS_SIGN, True)}{b.text.removeprefix(MINUS)}", SUM)
        return Piece(f"{a.text}{TERM}{operator('+', True)}{self.inside(b, PRODUCT)}", SUM)

    def sub(self, a: Piece, b: Piece) -> Piece:
        """a - b."""
        return Piece(f"{a.text}{TERM}{operator(MINUS_SIGN, True)}{self.inside(b, PRODUCT)}", SUM)

    def neg(self, a: Piece) -> Piece:
        """-a."""
        return Piece(MINUS + self.inside(a, PRODUCT), NEGATION)

    def mul(self, a: Piece, b: Piece) -> Piece:
        """A thin space, or a dot before digits."""
        right = self.inside(b, PRODUCT)
        sign = DOT if right.startswith(("<mn>", "<mfrac>")) else TIMES
        # a line may end before what is broken
        sign += TERM if right.startswith(OPENING) else ""
        left = self.before(a, right) + sign
        return Piece(left + right, PRODUCT, left + b.closed if b.closed and right == b.text else "")

    def is_too_wide(self, above: Piece, below: Piece) -> bool:
        """Whether a line that is not broken may have no room for one of them."""
        return any(_is_wide(row(solid(x.text), ""), IN_FRACTION) for x in (above, below))

    def div(self, a: Piece, b: Piece) -> Piece:
        """A fraction; what is too wide for one is multiplied by it."""
        above, below = row(solid(a.text), ""), row(solid(b.text), "")
        if _is_wide(below, IN_FRACTION):
            power = self.power(Piece(b.text, SUM), -1)
            return power if a.text == self.number(Fraction(1)).text else self.mul(a, power)
        if _is_wide(above, IN_FRACTION):
            return self.mul(Piece(f"<mfrac><mn>1</mn>{below}</mfrac>", PRODUCT), a)
        return Piece(f"<mfrac>{above}{below}</mfrac>", PRODUCT)

    def power(self, a: Piece, n: int) -> Piece:
        """An exponent."""
        return self._raised(a, f"<mn>{n}</mn>" if n >= 0 else row(MINUS, f"<mn>{-n}</mn>"))

    def _raised(self, a: Piece, exponent: str) -> Piece:
        """An exponent, at the closing parenthesis of what is broken."""
        text = self.inside(a, ATOM)
        if text.endswith(CLOSING):
            return Piece(f"{text.removesuffix(CLOSING)}<msup>{CLOSING}{exponent}</msup>", POWER)
        return Piece(f"<msup>{row(solid(text), '')}{exponent}</msup>", POWER)

    def trig(self, op: str, angle: Piece, power: int) -> Piece:
        """The exponent stands before the angle, which needs no parentheses as a single name that nothing follows."""
        head = f"<mi>{op}</mi>" if power == 1 else f"<msup><mi>{op}</mi><mn>{power}</mn></msup>"
        closed = row(head, APPLIED, self._argument(angle.text))
        if angle.precedence != ATOM:
            return Piece(closed, POWER)
        return Piece(row(head, APPLIED, '<mspace width="0.17em"/>' + angle.text), POWER, closed)

    def begins_with_function(self, text: str) -> bool:
        """Whether it is a sine, a cosine or another one with a name."""
        return _FUNCTION.match(text) is not None

    def call(self, op: str, args: list[Piece]) -> Piece:
        """A root sign, bars of an absolute value, or the function's name."""
        if op == "sqrt" and _is_wide(args[0].text):
            return self._raised(Piece(args[0].text, SUM), row("<mn>1</mn>", operator("/"), "<mn>2</mn>"))
        if op == "sqrt":
            return Piece(f"<msqrt>{solid(args[0].text)}</msqrt>")
        if op == "abs":
            return Piece(row(operator("|"), solid(args[0].text), operator("|")))
        inner = operator(",").join(solid(a.text) for a in args)
        return Piece(row(f"<mi>{self.functions.get(op, op)}</mi>", APPLIED, self._argument(inner)))

    def _argument(self, text: str) -> str:
        return row(operator("("), solid(text), operator(")"))

    def finished(self, text: str) -> str:
        """A formula as one element."""
        return f'<math xmlns="http://www.w3.org/1998/Math/MathML">{row(solid(text), "")}</math>'

    def render(self, listing: Listing, name: str) -> str:
        """A page: what the symbols are, then a paragraph for every element."""
        lines = [f"<p>{escape(comment(x))}</p>" for x in (self.remark, *self.legend) if x]
        described = [self._described(n) for n, _ in self.described]
        lines += ["<table>", *described, "</table>"] if described else []
        return PAGE.format(title=escape(comment(name)), body="\n".join([*lines, *self.formulas(listing)]))

    def formulas(self, listing: Listing) -> list[str]:
        """What symbols stand for, abbreviations, and a paragraph for every element."""
        return [*self.steps(listing), *self.elements(listing)]

    def steps(self, listing: Listing) -> list[str]:
        """What elements are written with: definitions, abbreviations, values between, a paragraph for each."""
        lines: list[str] = []
        for left, text, note in listing.definitions:
            lines += [f"<p>{self.finished(left)} stands for {escape(comment(note))}:</p>"] if note else []
            lines.append(self._line(left, text))
        lines += [self._line(left, text) for left, text in listing.abbreviations]
        return lines + [self._line(self.step(n).text, text) for n, text in listing.temporaries]

    def elements(self, listing: Listing) -> list[str]:
        """A heading for every output, and a paragraph for every element."""
        outputs = self.program.outputs.items()
        return [line for output, array in outputs for line in self._output(output, array, listing.entries[output])]

    def _described(self, n: int) -> str:
        symbol = self.program.symbols[n]
        words = "".join(f"<td>{escape(comment(x))}</td>" for x in (symbol.name, symbol.kind, symbol.unit))
        return f"<tr><td>{self.finished(self.names[n])}</td>{words}</tr>"

    def _output(self, output: str, array: Output, texts: Sequence[str]) -> list[str]:
        letter = self._letter(output, array)
        lines = [f"<h2>{escape(comment(output))}</h2>"]
        lines += ["<p>Indices from 1; elements that are not listed are 0.</p>"] if array.shape else []
        lines += [self._line(left, text) for left, text in zip(self._places(output, array), texts, strict=True)]
        lines += [] if texts else [self._line(letter, "<mn>0</mn>")]
        rules = [self.finished(rule.format(**_indices(letter, output))) for rule in _RULES.get(array.symmetry, ())]
        return [*lines, f"<p>{'<wbr/>'.join(rules)}</p>"] if rules else lines

    def _letter(self, output: str, array: Output) -> str:
        latex = letter_of(output, array, self._latex)
        return f"<mtext>{escape(comment(output))}</mtext>" if latex.startswith(r"\mathtt") else named(latex)

    def _places(self, output: str, array: Output) -> list[str]:
        """The left sides of the elements of an output."""
        letter, separator = self._letter(output, array), "," if max(array.shape, default=0) > 9 else ""
        return [_indexed(letter, output, [f"<mn>{i + 1}</mn>" for i in index], separator) for index in array.index]

    def _line(self, left: str, text: str) -> str:
        """One element; every term is a formula of its own."""
        first, *others = text.split(TERM)
        terms = [left + operator("=") + first, *others]
        return "<p>" + "<wbr/>".join(self.finished(term) for term in terms) + "</p>"


def _indexed(letter: str, output: str, index: Sequence[str], separator: str = "") -> str:
    """A letter with indices above and below."""
    up, between = RAISED.get(output, 0), operator(separator) if separator else ""
    above, below = (row(between.join(part), "") if part else "" for part in (index[:up], index[up:]))
    if above and below:
        return f"<msubsup>{letter}{below}{above}</msubsup>"
    tag = "msup" if above else "msub"
    return f"<{tag}>{letter}{above or below}</{tag}>" if index else letter


def _indices(letter: str, output: str) -> dict[str, str]:
    """A quantity with letters for indices."""
    found = ("ab", "ba", "abc", "acb", "cba")
    return {x: _indexed(letter, output, [f"<mi>{i}</mi>" for i in x]) for x in found}


def _is_wide(text: str, limit: int = WIDE) -> bool:
    found = text.count("<mi") + text.count("<mn") + text.count("<mo")
    return found - text.count(TIMES) - text.count("&#x2061;") > limit


def solid(text: str) -> str:
    """A sum as one formula."""
    return text.replace(TERM, "")
