"""LaTeX: an ``aligned`` environment (for the inside of display mathematics)."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from typing import ClassVar

from substructures.expr.program import Output, Program
from substructures.printers.language import ATOM, NEGATION, POWER, PRODUCT, SUM, Language, Listing, Piece
from substructures.printers.meanings import Label
from substructures.printers.names import LETTERS, RAISED, comment, latex_names, letter_of, look
from substructures.printers.pages import BREAK, CLOSING, LINE, OPENING, broken, solid, width

_NAMED = {"sin": r"\sin", "cos": r"\cos", "tan": r"\tan", "asin": r"\arcsin", "acos": r"\arccos", "atan": r"\arctan"}
_NAMED |= {"atan2": r"\operatorname{atan2}", "exp": r"\exp", "log": r"\ln", "sign": r"\operatorname{sgn}"}
#: how a root ends that is too wide for a root sign
_ROOT = CLOSING + "^{1/2}"
_RULES = {
    "symmetric": "{ab} &= {ba}",
    "christoffel": r"{abc} &= {acb}, \quad {cba} = -{abc} \quad (b \le a)",
    "connection": "{abc} &= {acb}",
}


class Latex(Language):
    """LaTeX formulas. Indices count from 1, elements that are not listed are zero."""

    media = "application/x-latex; charset=utf-8"
    width = 300
    first = 1
    is_for_people = True
    bars = True
    functions: ClassVar[Mapping[str, str]] = _NAMED

    def __init__(self, program: Program) -> None:
        super().__init__(program)
        self.names = latex_names(s.name for s in program.symbols)
        # no symbol of the same look
        self.letter = next(x for x in ("t", "w", "z", r"\mathfrak{t}") if not any(n.startswith(x) for n in self.names))

    def symbol(self, n: int) -> Piece:
        """A name in italics with subscripts, dots for rates."""
        return Piece(self.names[n])

    def temporary(self, n: int) -> Piece:
        """A letter that no symbol begins with, with a number below."""
        return Piece(f"{self.letter}_{{{n}}}")

    def labelled(self, label: Label) -> Piece:
        """A letter with numbers and component below."""
        return Piece(label.latex)

    def look(self, text: str) -> str:
        """Letters and indices, upright or not."""
        return look(text)

    def lefts(self) -> Iterator[str]:
        """With their indices."""
        for output, array in self.program.outputs.items():
            yield from self._places(output, array)

    def pi(self) -> Piece:
        """The Greek letter."""
        return Piece(r"\pi")

    def parentheses(self, text: str) -> str:
        """Parentheses that grow with what they hold, unless a line ends in them."""
        return OPENING + text + CLOSING

    def add(self, a: Piece, b: Piece) -> Piece:
        """a + b, where a line may end before the sign."""
        if b.text.startswith("-"):
            return Piece(
                f"{a.text}{BREAK}- {b.text[1:]}"
                if b.precedence == NEGATION
                else f"{a.text}{BREAK}+ {self.parentheses(b.text)}",
                SUM,
            )
        return Piece(f"{a.text}{BREAK}+ {b.text}", SUM)

    def sub(self, a: Piece, b: Piece) -> Piece:
        """a - b, where a line may end before the sign."""
        return Piece(f"{a.text}{BREAK}- {self.inside(b, PRODUCT)}", SUM)

    def finished(self, text: str) -> str:
        """A whole formula on one line."""
        return solid(text)

    def fraction(self, above: int, below: int) -> Piece:
        """One above the other."""
        return Piece(rf"\frac{{{above}}}{{{below}}}", PRODUCT)

    def abbreviation(self, op: str, digits: str) -> Piece:
        """c_{12} of cos(q_1 + q_2)."""
        return Piece(f"{op[0]}_{{{digits}}}")

    def scientific(self, mantissa: str, exponent: int) -> Piece:
        """mantissa * 10^exponent."""
        if not exponent:
            return Piece(mantissa)
        power = f"10^{{{exponent}}}"
        return Piece(power, POWER) if mantissa == "1" else Piece(rf"{mantissa} \cdot {power}", PRODUCT)

    def trig(self, op: str, angle: Piece, power: int) -> Piece:
        """The exponent stands before the angle, which needs no parentheses as a single name that nothing follows."""
        head = self.functions[op] + (f"^{{{power}}}" if power != 1 else "")
        closed = head + _argument(angle.text)
        return Piece(f"{head} {angle.text}", POWER, closed) if angle.precedence == ATOM else Piece(closed, POWER)

    def begins_with_function(self, text: str) -> bool:
        """Whether it is a sine, a cosine or another one with a name."""
        return text.startswith(tuple(self.functions.values()))

    def mul(self, a: Piece, b: Piece) -> Piece:
        """A thin space, or a dot before digits."""
        right = self.inside(b, PRODUCT)
        sign = r" \cdot " if right[0].isdigit() or right.startswith(r"\frac") else r" \, "
        left = self.before(a, right) + sign
        return Piece(left + right, PRODUCT, left + b.closed if b.closed and right == b.text else "")

    def is_too_wide(self, above: Piece, below: Piece) -> bool:
        """Whether a line has no room for more than that."""
        return max(width(solid(x.text)) for x in (above, below)) > LINE - 50

    def div(self, a: Piece, b: Piece) -> Piece:
        """A fraction; what is too wide for one is multiplied by it."""
        above, below = solid(a.text), solid(b.text)
        if width(below) > LINE - 50:
            power = f"{self.parentheses(b.text)}^{{-1}}"
            if b.precedence == POWER and b.text.endswith(_ROOT):
                power = b.text.removesuffix(_ROOT) + CLOSING + "^{-1/2}"
            return Piece(power, POWER) if a.text == "1" else Piece(f"{self.before(a, power)} \\, {power}", PRODUCT)
        if width(above) > LINE - 50:
            return self.mul(Piece(rf"\frac{{1}}{{{below}}}", PRODUCT), a)
        return Piece(rf"\frac{{{above}}}{{{below}}}", PRODUCT)

    def power(self, a: Piece, n: int) -> Piece:
        """An exponent."""
        # a dotted or subscripted name needs no parentheses, a power does
        return Piece(f"{self.inside(a, ATOM)}^{{{n}}}", POWER)

    def call(self, op: str, args: list[Piece]) -> Piece:
        """A root sign, bars of an absolute value, or the function's name."""
        if op == "sqrt":
            if width(solid(args[0].text)) > LINE - 50:
                return Piece(f"{self.parentheses(args[0].text)}^{{1/2}}", POWER)
            return Piece(rf"\sqrt{{{solid(args[0].text)}}}")
        if op == "abs":
            return Piece(rf"\left|{solid(args[0].text)}\right|")
        if op in ("cos", "sin", "tan"):
            return self.trig(op, args[0], 1)
        return Piece(self.functions[op] + _argument(", ".join(a.text for a in args)))

    def render(self, listing: Listing, name: str) -> str:
        """An ``aligned`` environment; comments say what the symbols are."""
        lines = [f"% {comment(x)}" for x in (name, self.remark, *self.legend) if x]
        lines += [
            f"% {comment(s.name)}: {s.kind} [{comment(s.unit)}], written {self.names[n]}" for n, s in self.described
        ]
        if any(array.shape or "[" in output for output, array in self.program.outputs.items()):
            lines.append("% indices from 1; elements that are not listed are 0")
        lines += [f"% {name} stands for {comment(note)}" for name, _, note in listing.definitions if note]
        rows = [*self.defined(listing), *self.abbreviated(listing)]
        for output, array in self.program.outputs.items():
            rows += self.rows(output, array, listing.entries[output])
        return "\n".join([*lines, r"\begin{aligned}", " \\\\\n".join(rows), r"\end{aligned}"]) + "\n"

    def defined(self, listing: Listing) -> list[str]:
        """Rows of symbols that stand for formulas."""
        return [f"{name} &= {broken(text)}" for name, text, _ in listing.definitions]

    def abbreviated(self, listing: Listing) -> list[str]:
        """Rows of abbreviations and temporaries."""
        rows = [f"{name} &= {broken(text)}" for name, text in listing.abbreviations]
        return rows + [f"{self.step(n).text} &= {broken(text)}" for n, text in listing.temporaries]

    def rows(self, output: str, array: Output, texts: tuple[str, ...]) -> list[str]:
        """Rows of an output, its symmetry as the last one."""
        letter = self._letter(output, array)
        rows = [f"{left} &= {broken(text)}" for left, text in zip(self._places(output, array), texts, strict=True)]
        rows = rows or [f"{letter} &= 0"]
        if array.symmetry in _RULES:
            said = {x: self._indexed(letter, output, list(x), "") for x in ("ab", "ba", "abc", "acb", "cba")}
            rows.append(_RULES[array.symmetry].format(**said))
        return rows

    def _letter(self, output: str, array: Output) -> str:
        """The letter of a quantity; a longer name is one letter."""
        letter = letter_of(output, array, self.names)
        return letter if letter.isalpha() or letter == LETTERS.get(output) else f"{{{letter}}}"

    def _places(self, output: str, array: Output) -> list[str]:
        """The left sides of the elements of an output."""
        letter, separator = self._letter(output, array), "," if max(array.shape, default=0) > 9 else ""
        return [self._indexed(letter, output, [str(i + 1) for i in index], separator) for index in array.index]

    @staticmethod
    def _indexed(letter: str, output: str, index: Sequence[str], separator: str) -> str:
        """A letter with indices above and below."""
        up = RAISED.get(output, 0)
        above, below = (separator.join(part) for part in (index[:up], index[up:]))
        return letter + (f"^{{{above}}}" if above else "") + (f"_{{{below}}}" if below else "")


def _argument(text: str) -> str:
    return solid(OPENING + text + CLOSING)
